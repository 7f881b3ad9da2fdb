//! Remarks on input that is imperfect but usable.

use std::fmt;

use crate::Place;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; the result is what the input meant.
    Note,
    /// The input was repaired or guessed at; the result may not be what was meant.
    Warning,
}

/// One kind of imperfection, with the first places where it was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// A stable code such as `W-bpt-trailing`.
    pub code: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// What was found and what was made of it.
    pub message: String,
    /// The first places, at most [`Findings::PLACES_KEPT`].
    pub places: Vec<Place>,
    /// How often it was seen.
    pub count: u64,
}

/// What a reader or converter noticed. Memory stays bounded: findings with the same code are counted together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings(Vec<Finding>);

impl Findings {
    /// How many places are kept for each code.
    pub const PLACES_KEPT: usize = 16;

    /// Adds one observation; the message of the first with the same code is kept.
    pub fn push(&mut self, code: &'static str, severity: Severity, place: Place, message: impl Into<String>) {
        self.push_many(code, severity, place, message, 1);
    }

    /// Adds as many observations as `count`, of which the place of the first is known.
    pub fn push_many(
        &mut self,
        code: &'static str,
        severity: Severity,
        place: Place,
        message: impl Into<String>,
        count: u64,
    ) {
        match self.0.iter_mut().find(|finding| finding.code == code) {
            Some(known) => {
                known.count += count;
                known.severity = known.severity.max(severity);
                if known.places.len() < Self::PLACES_KEPT {
                    known.places.push(place);
                }
            }
            None => self.0.push(Finding { code, severity, message: message.into(), places: vec![place], count }),
        }
    }

    /// Adds as many observations as `count`, of which the first places are given; none if `count` is 0.
    pub fn push_all(
        &mut self,
        code: &'static str,
        severity: Severity,
        message: impl Into<String>,
        count: u64,
        places: impl IntoIterator<Item = Place>,
    ) {
        if count > 0 {
            let places = places.into_iter().take(Self::PLACES_KEPT).collect();
            let finding = Finding { code, severity, message: message.into(), places, count };
            self.extend(Self(vec![finding]));
        }
    }

    /// The same with every place made another.
    #[must_use]
    pub fn with_places(mut self, f: impl Fn(Place) -> Place) -> Self {
        for finding in &mut self.0 {
            for place in &mut finding.places {
                *place = f(std::mem::replace(place, Place::Whole));
            }
        }
        self
    }

    /// Adds all of `other`.
    pub fn extend(&mut self, other: Self) {
        for finding in other.0 {
            match self.0.iter_mut().find(|known| known.code == finding.code) {
                Some(known) => {
                    known.count += finding.count;
                    known.severity = known.severity.max(finding.severity);
                    let room = Self::PLACES_KEPT.saturating_sub(known.places.len());
                    known.places.extend(finding.places.into_iter().take(room));
                }
                None => self.0.push(finding),
            }
        }
    }

    /// The findings in the order in which their codes first appeared.
    pub fn iter(&self) -> std::slice::Iter<'_, Finding> {
        self.0.iter()
    }

    /// Whether nothing was noticed.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<'a> IntoIterator for &'a Findings {
    type Item = &'a Finding;
    type IntoIter = std::slice::Iter<'a, Finding>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = match self.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
        };
        write!(f, "{word}[{}]: {}", self.code, self.message)?;
        if let Some(place) = self.places.first()
            && *place != Place::Whole
        {
            write!(f, " (at {place}")?;
            if self.count > 1 {
                write!(f, " and {} more", self.count - 1)?;
            }
            f.write_str(")")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_findings_keep_few_places() {
        let mut findings = Findings::default();
        for line in 0..1_000_000 {
            findings.push("W-test", Severity::Note, Place::line(line), "odd");
        }
        let only = findings.iter().next().unwrap();
        assert_eq!((only.count, only.places.len()), (1_000_000, Findings::PLACES_KEPT));
        let mut twice = findings.clone();
        twice.extend(findings);
        assert_eq!(twice.iter().next().unwrap().count, 2_000_000);
        assert_eq!(twice.iter().next().unwrap().places.len(), Findings::PLACES_KEPT);
    }
}
