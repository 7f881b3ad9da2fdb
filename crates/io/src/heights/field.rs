//! Rows of samples, the northern one first, made a height field.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Affine, Category, Findings, Place, Severity, Words};
use shapeloom_mesh::HeightField;

use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError};

/// What to do about heights that are infinite in a file.
pub(crate) const HOLE_ADVICE: &str =
    "mend the height, or make such heights holes with the option drop_non_finite (--drop-non-finite)";

/// Heights as files have them: row by row, the northern row first.
pub(crate) struct NorthFirst {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) spacing: DVec2,
    /// Where the south-western sample is.
    pub(crate) south_west: DVec2,
    pub(crate) heights: Vec<f64>,
}

impl NorthFirst {
    /// The field, with heights multiplied by the option for that, and what there is to say of its holes.
    ///
    /// # Errors
    /// A height beyond the largest double, unless such are to be dropped; a place or distance that is no number.
    pub(crate) fn into_field(
        mut self,
        context: &ReadContext,
        findings: &mut Findings,
    ) -> Result<HeightField, ReadError> {
        let columns = self.columns as usize;
        let (mut holes, mut dropped) = (0u64, 0u64);
        for (row, heights) in self.heights.chunks_mut(columns.max(1)).enumerate() {
            context.exec.check()?;
            for (column, height) in heights.iter_mut().enumerate() {
                let own = *height;
                *height *= context.options.exaggeration;
                if height.is_infinite() {
                    if !context.options.drop_non_finite {
                        let fault = infinite(own, context.options.exaggeration);
                        return Err(fault.within(format!("row {row}, column {column}")).into());
                    }
                    *height = f64::NAN;
                    dropped += 1;
                }
                holes += u64::from(height.is_nan());
            }
        }
        if dropped > 0 {
            let message = "heights that are infinite became holes";
            findings.push_many("W-read-dropped", Severity::Warning, Place::Whole, message, dropped);
        }
        if holes == self.heights.len() as u64 {
            let message = "every sample is a hole: there is no surface";
            findings.push("W-heights-empty", Severity::Warning, Place::Whole, message);
        } else if holes > 0 {
            let message = format!("{holes} of {} samples have no height: they are holes", self.heights.len());
            findings.push_many("W-heights-holes", Severity::Note, Place::Whole, message, holes);
        }
        turn_over(&mut self.heights, columns);
        let built = HeightField::try_new(self.columns, self.rows, self.spacing, self.heights);
        let field = built.map_err(|error| grid_fault(error.to_string()))?;
        let placement = Affine::from_translation(DVec3::new(self.south_west.x, self.south_west.y, 0.0));
        let far = DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1)) * self.spacing;
        if !(self.south_west + far).is_finite() || !self.south_west.is_finite() {
            return Err(grid_fault("samples at places that are no numbers".into()).into());
        }
        // The gaps between numbers are widest at the largest ones.
        let largest = self.south_west.abs().max((self.south_west + far).abs());
        if self.spacing.cmplt(largest * f64::EPSILON).any() {
            let found = "places so large that neighbouring samples would be at the same one";
            return Err(grid_fault(found.into()).into());
        }
        Ok(field.placed(placement))
    }
}

/// A height that is infinite in the file, or becomes so where heights are multiplied.
#[cold]
fn infinite(own: f64, exaggeration: f64) -> Box<Fault> {
    let fault = |found: String| Fault::new("E-heights-finite", Place::Whole, found, "finite heights");
    if own.is_infinite() {
        fault("a height that is infinite or beyond 1.8e308".into()).advice(HOLE_ADVICE)
    } else {
        fault(format!("the height {} times the option exaggeration = {}", Words(own), Words(exaggeration)))
            .advice("choose a smaller exaggeration with --set exaggeration=...")
    }
}

fn grid_fault(found: String) -> Box<Fault> {
    Fault::new("E-heights-grid", Place::Whole, found, "a grid with finite places and distances above 0")
}

/// The rows in the opposite order.
fn turn_over(heights: &mut [f64], columns: usize) {
    let rows = heights.len() / columns.max(1);
    for row in 0..rows / 2 {
        let (south, north) = heights.split_at_mut((rows - 1 - row) * columns);
        south[row * columns..(row + 1) * columns].swap_with_slice(&mut north[..columns]);
    }
}

/// Checks the size that a header claims, and takes memory for as many heights. The caller has seen that so many can be in
/// the file at all.
///
/// # Errors
/// Fewer than two columns or rows; more samples than the limits allow for a file of so many bytes; a budget that does not
/// have them.
pub(crate) fn check_size(
    columns: u64,
    rows: u64,
    place: Place,
    within: &str,
    bytes: usize,
    context: &ReadContext,
) -> Result<(u32, u32), Box<Fault>> {
    let named = |fault: Box<Fault>| if within.is_empty() { fault } else { fault.within(within) };
    let found = format!("{columns} × {rows} samples");
    let most = context.limits.max_samples.max(bytes as u64).min(context.limits.max_elements);
    if columns.checked_mul(rows).is_none_or(|count| count > most) {
        let fault = Fault::new("E-heights-limit", place, found, format!("at most {most}"));
        return Err(named(fault.category(Category::OverLimit)));
    }
    match (u32::try_from(columns), u32::try_from(rows)) {
        (Ok(columns), Ok(rows)) if columns >= 2 && rows >= 2 => Ok((columns, rows)),
        _ => Err(named(Fault::new("E-heights-size", place, found, "at least 2 × 2"))),
    }
}

/// Room for the heights of a grid whose size was checked.
pub(crate) fn room(count: usize, memory: &mut Memory<'_>) -> Result<Vec<f64>, ReadError> {
    memory.take(count, size_of::<f64>())?;
    Ok(Vec::with_capacity(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_is_the_northern_one() {
        let heights = (0..6).map(f64::from).collect();
        let grid = NorthFirst {
            columns: 2,
            rows: 3,
            spacing: DVec2::new(10.0, 5.0),
            south_west: DVec2::new(100.0, 7.0),
            heights,
        };
        let field = grid.into_field(&ReadContext::default(), &mut Findings::default()).unwrap();
        assert_eq!(field.heights(), [4.0, 5.0, 2.0, 3.0, 0.0, 1.0]);
        assert_eq!(field.sample(1, 2), Some(DVec3::new(110.0, 17.0, 1.0)));
    }

    #[test]
    fn places_that_fall_together_are_refused() {
        for (south_west, sound) in
            [(DVec2::new(1e20, 0.0), false), (DVec2::new(0.0, -1e17), false), (DVec2::splat(1e15), true)]
        {
            let grid = NorthFirst { columns: 2, rows: 2, spacing: DVec2::ONE, south_west, heights: vec![0.0; 4] };
            let field = grid.into_field(&ReadContext::default(), &mut Findings::default());
            assert_eq!(field.is_ok(), sound, "{south_west}");
        }
    }

    #[test]
    fn rows_are_turned_over_whatever_their_number() {
        for rows in 0..6 {
            let mut heights: Vec<f64> = (0..3 * rows).map(f64::from).collect();
            let wanted: Vec<f64> = heights.chunks(3).rev().flatten().copied().collect();
            turn_over(&mut heights, 3);
            assert_eq!(heights, wanted);
        }
    }

    #[test]
    fn sizes_are_checked_before_anything_is_made() {
        let context = ReadContext::default();
        let check =
            |columns, rows| check_size(columns, rows, Place::Whole, "", 100, &context).map_err(|fault| fault.code);
        assert_eq!(check(8192, 8192), Ok((8192, 8192)));
        for (columns, rows, code) in [
            (8193, 8192, "E-heights-limit"),
            (u64::MAX, 3, "E-heights-limit"),
            (1, 9, "E-heights-size"),
            (0, 0, "E-heights-size"),
        ] {
            assert_eq!(check(columns, rows), Err(code));
        }
        assert!(check_size(30_000, 30_000, Place::Whole, "", 900_000_000, &context).is_ok());
    }
}
