//! How the values of columns were changed to be written.

use std::collections::BTreeMap;

use shapeloom_mesh::Domain;

use crate::placed::Losses;

/// What became of the values of a column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Change {
    /// The largest change of a number by rounding it to single precision.
    pub rounded: f64,
    /// The same of normals, which are scaled to unit length too.
    pub scaled: f64,
    /// How many normals had no direction.
    pub replaced: u64,
    /// How many numbers are not finite in single precision.
    pub not_finite: u64,
}

/// The changes of all columns, those of one name together.
#[derive(Default)]
pub(super) struct Changes(BTreeMap<String, Change>);

impl Changes {
    pub fn add(&mut self, domain: Domain, name: &str, change: Change) {
        if change == Change::default() {
            return;
        }
        let all = self.0.entry(format!("{domain} attribute \"{name}\"")).or_default();
        all.rounded = all.rounded.max(change.rounded);
        all.scaled = all.scaled.max(change.scaled);
        all.replaced += change.replaced;
        all.not_finite += change.not_finite;
    }

    /// One loss for each column and kind of change.
    pub fn say(&self, losses: &mut Losses) {
        for (column, change) in &self.0 {
            let Change { rounded, scaled, replaced, not_finite } = change;
            if *rounded > 0.0 {
                losses.push(column, format!("its values were rounded to single precision, by at most {rounded:e}"));
            }
            if *scaled > 0.0 {
                let why = "its normals were scaled to unit length and rounded to single precision";
                losses.push(column, format!("{why}, by at most {scaled:e}"));
            }
            if *replaced > 0 {
                let why = "of its normals have no direction, which glTF does not allow";
                losses.push(column, format!("{replaced} {why}: they were replaced by those of facets"));
            }
            if *not_finite > 0 {
                let why = "of its numbers are not finite in single precision";
                losses.push(column, format!("{not_finite} {why}: they were written as infinite or not a number"));
            }
        }
    }
}
