//! Inside and outside of a surface among samples.

use std::fmt;

use shapeloom_core::{ConvertError, Exec, Place, Report, Severity, Words, choice};

use crate::{IsoValue, Otsu, Slabs, otsu_threshold, sample_range};

/// On which side of the iso value the inside is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inside {
    /// Values smaller than the iso value, as of distances.
    Below,
    /// Values larger than the iso value, as of densities.
    Above,
}

choice! {
    /// On which side of the iso value the inside is, as an option.
    pub enum InsideChoice {
        /// As the samples say of themselves: below for distances, above for densities.
        Auto = "auto",
        /// Smaller values.
        Below = "below",
        /// Larger values.
        Above = "above",
    }
}

/// Where an iso value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum IsoOrigin {
    Given,
    KindOfSamples,
    Otsu(Otsu),
}

/// How a level was found, in words by [`Display`](fmt::Display).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsoWords {
    level: Level,
    origin: IsoOrigin,
}

impl fmt::Display for IsoWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let origin = match self.origin {
            IsoOrigin::Given => "as given",
            IsoOrigin::KindOfSamples => "as the kind of samples says",
            IsoOrigin::Otsu(_) => "Otsu's threshold",
        };
        let side = match self.level.inside {
            Inside::Below => "below",
            Inside::Above => "above",
        };
        write!(f, "iso value {} ({origin}), inside {side}", self.level.iso)
    }
}

/// What is inside: samples strictly on one side of a value. A sample that equals it is outside, and so is one that is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The iso value.
    pub iso: f32,
    /// On which side the inside is.
    pub inside: Inside,
}

impl Level {
    /// Whether a sample is inside.
    pub fn holds(&self, sample: f32) -> bool {
        sample.is_finite()
            && match self.inside {
                Inside::Below => sample < self.iso,
                Inside::Above => sample > self.iso,
            }
    }

    /// A sample less the iso value, with the sign that is negative inside.
    pub(crate) fn depth(&self, sample: f32) -> f64 {
        let above = f64::from(sample) - f64::from(self.iso);
        if self.inside == Inside::Below { above } else { -above }
    }

    /// Where between two samples, of which one is inside, their line reaches the iso value: 0 at `a`, 1 at `b`. In the middle
    /// where one is not finite.
    pub fn crossing(&self, a: f32, b: f32) -> f64 {
        let (from, to, iso) = (f64::from(a), f64::from(b), f64::from(self.iso));
        let part = (iso - from) / (to - from);
        if part.is_finite() && a.is_finite() && b.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 }
    }

    /// The level for what was asked for, and how it was found.
    ///
    /// # Errors
    /// A slab cannot be had, or the reason to stop.
    pub fn settle<S: Slabs + ?Sized>(
        slabs: &S,
        iso: IsoValue,
        inside: InsideChoice,
        exec: &Exec,
    ) -> Result<(Self, IsoWords), ConvertError> {
        let inside = match inside {
            InsideChoice::Auto => slabs.inside(),
            InsideChoice::Below => Inside::Below,
            InsideChoice::Above => Inside::Above,
        };
        let (iso, origin) = match (iso, slabs.default_iso()) {
            (IsoValue::At(value), _) => (value, IsoOrigin::Given),
            (IsoValue::Auto, Some(value)) => (value, IsoOrigin::KindOfSamples),
            (IsoValue::Auto, None) => {
                let otsu = otsu_threshold(slabs, exec)?;
                (otsu.threshold, IsoOrigin::Otsu(otsu))
            }
        };
        let level = Self { iso: iso as f32, inside };
        Ok((level, IsoWords { level, origin }))
    }

    /// Tells of an iso value that was guessed, of samples that are not finite, and of a surface without triangles with the range of
    /// the samples.
    ///
    /// # Errors
    /// A slab cannot be had, or the reason to stop.
    pub fn tell<S: Slabs + ?Sized>(
        &self,
        slabs: &S,
        how: &IsoWords,
        not_finite: u64,
        triangles: u64,
        report: &mut Report,
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        report.figure("iso_value", f64::from(self.iso));
        if let IsoOrigin::Otsu(otsu) = how.origin {
            let message = format!(
                "the iso value was guessed: {} is Otsu's threshold; parting the samples there leaves {:.0} % of their variance \
                 within the two classes",
                self.iso,
                100.0 * (1.0 - otsu.separability)
            );
            report.findings.push("W-iso-otsu", Severity::Warning, Place::Whole, message);
        }
        if not_finite > 0 {
            let message = "samples that are NaN or infinite count as outside";
            report.findings.push_many("W-iso-not-finite", Severity::Warning, Place::Whole, message, not_finite);
        }
        if triangles == 0 {
            let message = self.empty_words(sample_range(slabs, exec)?.finite);
            report.findings.push("W-iso-empty", Severity::Warning, Place::Whole, message);
        }
        Ok(())
    }

    /// Why a surface has no triangles, and what gives it some.
    fn empty_words(&self, range: Option<[f32; 2]>) -> String {
        let iso = Words(self.iso.into());
        match range {
            None => "no surface: no sample is finite, so the mesh is empty".to_owned(),
            Some([low, high]) if low == high => {
                format!("no surface: all samples are {}, so the mesh is empty", Words(low.into()))
            }
            Some([low, high]) if self.holds(low) == self.holds(high) => format!(
                "no surface: all samples are on one side of the iso value {iso}, so the mesh is empty; they run from {} to {}: \
                 set iso to a value between",
                Words(low.into()),
                Words(high.into())
            ),
            // A closed border would have closed it.
            Some(_) => format!(
                "no surface: samples are on both sides of the iso value {iso}, but none is drawn at an open border, so the mesh is \
                 empty; border=closed closes it"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_and_strange_samples_are_outside() {
        for inside in [Inside::Below, Inside::Above] {
            let level = Level { iso: 2.0, inside };
            for sample in [2.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                assert!(!level.holds(sample), "{sample}");
            }
            assert_eq!(level.holds(1.0), inside == Inside::Below);
            assert_eq!(level.holds(3.0), inside == Inside::Above);
        }
    }

    #[test]
    fn crossings_divide_as_the_values_do() {
        let level = Level { iso: 1.0, inside: Inside::Below };
        assert_eq!(level.crossing(0.0, 4.0), 0.25);
        assert_eq!(level.crossing(4.0, 0.0), 0.75);
        assert_eq!(level.crossing(0.0, f32::INFINITY), 0.5);
        assert_eq!(level.crossing(f32::NAN, 0.0), 0.5);
        assert!(level.crossing(f32::MIN, f32::MAX) == 0.5);
    }

    #[test]
    fn an_empty_surface_is_told_with_what_gives_it_triangles() {
        let level = Level { iso: 1e9, inside: Inside::Above };
        for (iso, range, words) in [
            (
                1e9,
                Some([0.0, 255.0]),
                "one side of the iso value 1000000000, so the mesh is empty; they run from 0 to 255",
            ),
            (255.0, Some([0.0, 255.0]), "one side of the iso value 255,"),
            (0.0, Some([1.0, 2.0]), "one side of the iso value 0,"),
            (1.5, Some([1.0, 2.0]), "border=closed"),
            (0.0, Some([3.0; 2]), "all samples are 3,"),
            (0.0, None, "no sample is finite"),
        ] {
            let told = Level { iso, ..level }.empty_words(range);
            assert!(told.contains(words), "{told}");
        }
    }
}
