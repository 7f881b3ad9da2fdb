//! Samples of height fields that border no whole cell.

use shapeloom_core::{ConvertError, Deviation, Exec, Place, Report, Severity};

use crate::HeightField;

/// Counts samples with a height of which each cell around touches a hole: no triangle has them.
fn count_strays(field: &HeightField, exec: &Exec) -> Result<u64, ConvertError> {
    let (columns, rows) = (field.columns() as usize, field.rows() as usize);
    let has = |x: usize, y: usize| !field.heights()[y * columns + x].is_nan();
    let whole = |x: usize, y: usize| has(x, y) && has(x + 1, y) && has(x, y + 1) && has(x + 1, y + 1);
    let mut strays = 0;
    for y in 0..rows {
        exec.check()?;
        for x in 0..columns {
            let mut around = (y.saturating_sub(1)..=y.min(rows - 2))
                .flat_map(|v| (x.saturating_sub(1)..=x.min(columns - 2)).map(move |u| (u, v)));
            strays += u64::from(has(x, y) && !around.any(|(u, v)| whole(u, v)));
        }
    }
    Ok(strays)
}

/// Says in the report of a conversion into triangles which samples it left out. The surface of a field is over its whole cells,
/// so that a bound stands; where nothing is left of samples that there are, none does.
pub(crate) fn tell_strays(field: &HeightField, report: &mut Report, exec: &Exec) -> Result<(), ConvertError> {
    let strays = count_strays(field, exec)?;
    report.figure("stray_samples", strays as f64);
    let nothing = report.figures.iter().any(|figure| figure.name == "triangles" && figure.value == 0.0);
    if nothing {
        let message = "no cell has heights at all four corners: nothing is left";
        report.findings.push("W-height-no-cell", Severity::Warning, Place::Whole, message);
    }
    if strays > 0 {
        let message = "samples border no cell with heights at all four corners: no triangle has them";
        report.findings.push_many("W-height-stray", Severity::Note, Place::Whole, message, strays);
        if nothing {
            report.deviation = Deviation::Unknown;
            report.basis = "there are samples, but none of them borders a whole cell".into();
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GreedyInsertion, TriangulateHeightField};
    use shapeloom_core::Convert;
    use shapeloom_core::glam::DVec2;

    #[test]
    fn samples_without_a_whole_cell_are_told() {
        let mut heights = vec![1.0; 9];
        heights[4] = f64::NAN;
        let ring = HeightField::try_new(3, 3, DVec2::ONE, heights).unwrap();
        let mut heights = vec![1.0; 12];
        heights[1] = f64::NAN;
        let corner = HeightField::try_new(4, 3, DVec2::ONE, heights).unwrap();
        for (field, strays, codes) in
            [(ring, 8.0, &["W-height-no-cell", "W-height-stray"][..]), (corner, 1.0, &["W-height-stray"])]
        {
            let regular = TriangulateHeightField::new().convert(&field).unwrap().report;
            let greedy = GreedyInsertion::new(0.1).convert(&field).unwrap().report;
            for report in [regular, greedy] {
                assert_eq!(report.deviation == Deviation::Unknown, codes.len() == 2);
                assert!(report.figures.iter().any(|figure| figure.name == "stray_samples" && figure.value == strays));
                assert_eq!(report.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), codes);
            }
        }
    }
}
