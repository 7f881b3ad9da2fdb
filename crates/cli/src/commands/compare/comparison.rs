//! What comparing two shapes found.

use serde_json::{Map, Value, json};
use shapeloom_core::{Deviation, Exec};
use shapeloom_judge::{DirectedHausdorff, Distances, Estimate, MeanDistance, Measured};

use super::{Subject, apart, short};
use crate::account;
use crate::failure::Failure;

/// What comparing the first shape with another found.
pub(crate) struct Comparison {
    /// The place of the other shape among the subjects; that of the first is 0.
    pub(crate) other: usize,
    /// Between the triangles, segments and points that both became.
    pub(crate) measured: Measured,
    /// How far those may be from the shapes themselves; none where nothing is proven about that.
    pub(crate) slack: Option<f64>,
    pub(crate) limit: Option<f64>,
    pub(crate) verdict: Option<Verdict>,
}

/// How a distance compares with the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Proven to be within it.
    Within,
    /// Proven to be above it.
    Above,
    /// The limit lies between the bounds.
    Undecided,
}

impl Verdict {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Above => "above",
            Self::Undecided => "not decided",
        }
    }
}

impl Comparison {
    pub(crate) fn measure(
        subjects: &[Subject],
        other: usize,
        options: &Distances,
        limit: Option<f64>,
        exec: &Exec,
    ) -> Result<Self, Failure> {
        let (first, second) = (&subjects[0], &subjects[other]);
        let measured = options.measure(&first.simplices, &second.simplices, exec)?;
        let proven = |deviation: Deviation| match deviation {
            Deviation::Exact => Some(0.0),
            Deviation::AtMost(bound) => Some(bound),
            Deviation::Estimated(_) | Deviation::Unknown => None,
        };
        let slack = proven(first.deviation).zip(proven(second.deviation)).map(|(a, b)| a + b);
        let mut comparison = Self { other, measured, slack, limit, verdict: None };
        comparison.verdict = limit.map(|limit| match comparison.bounds() {
            (_, upper) if comparison.slack.is_some() && upper <= limit => Verdict::Within,
            (lower, _) if comparison.slack.is_some() && lower > limit => Verdict::Above,
            _ => Verdict::Undecided,
        });
        Ok(comparison)
    }

    /// The bounds of the Hausdorff distance between the shapes as they were read, if anything is proven about those, else
    /// between their triangles.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        self.widened(self.measured.hausdorff.lower(), self.measured.hausdorff.upper())
    }

    /// Those of one direction.
    pub(crate) fn bounds_of(&self, way: &DirectedHausdorff) -> (f64, f64) {
        self.widened(way.lower, way.upper)
    }

    fn widened(&self, lower: f64, upper: f64) -> (f64, f64) {
        match self.slack.unwrap_or(0.0) {
            0.0 => (lower, upper),
            slack => ((lower - slack).next_down().max(0.0), (upper + slack).next_up()),
        }
    }

    pub(crate) fn account(&self, subjects: &[Subject]) -> Map<String, Value> {
        let found = &self.measured;
        let (lower, upper) = self.bounds();
        let hausdorff = json!({
            "lower": account::number(lower),
            "upper": account::number(upper),
            "proven": self.slack.is_some(),
            "converged": found.hausdorff.converged(),
            "of_triangles": {
                "lower": account::number(found.hausdorff.lower()),
                "upper": account::number(found.hausdorff.upper()),
            },
        });
        let shape = |index: usize| Value::Object(subjects[index].account());
        let value = json!({
            "a": shape(0),
            "b": shape(self.other),
            "hausdorff": hausdorff,
            "a_to_b": self.way(&found.hausdorff.a_to_b, &found.a_to_b),
            "b_to_a": self.way(&found.hausdorff.b_to_a, &found.b_to_a),
            "chamfer": {
                "mean": account::number(found.chamfer()),
                "mean_square": account::number(found.chamfer_squared()),
            },
            "diagonal": account::number(subjects[0].simplices.bounds().diagonal()),
            "error_of_tessellation": self.slack.map(account::number),
            "verdict": self.verdict.map(Verdict::name),
        });
        match value {
            Value::Object(object) => object,
            _ => Map::new(),
        }
    }

    /// One direction. `max` is a distance that some point has: the proven lower bound of the directed Hausdorff distance.
    fn way(&self, farthest: &DirectedHausdorff, mean: &MeanDistance) -> Value {
        let estimate =
            |found: &Estimate| json!({ "lower": account::number(found.lower), "upper": account::number(found.upper) });
        let (lower, upper) = self.bounds_of(farthest);
        let point = |p: [f64; 3]| Value::Array(p.into_iter().map(account::number).collect());
        let witness = &farthest.witness;
        json!({
            "mean": account::number(mean.mean.value),
            "rms": account::number(mean.rms.value),
            "max": account::number(farthest.lower),
            "mean_bounds": estimate(&mean.mean),
            "rms_bounds": estimate(&mean.rms),
            "samples": mean.samples,
            "hausdorff": { "lower": account::number(lower), "upper": account::number(upper) },
            "converged": farthest.converged,
            "witness": {
                "point": point(witness.point.to_array()),
                "element": witness.element,
                "nearest": point(witness.nearest.to_array()),
                "nearest_element": witness.nearest_element,
            },
            "queries": farthest.queries,
            "splits": farthest.splits,
        })
    }

    /// A limit and the bounds, with as many digits as tell them apart.
    fn told_apart(&self, limit: f64) -> [String; 3] {
        let (lower, upper) = self.bounds();
        apart([limit, lower, upper])
    }

    /// The bounds in words: where there is a limit, with digits that tell them from it.
    pub(crate) fn bounds_words(&self) -> [String; 2] {
        let (lower, _) = self.bounds();
        let [_, low, high] = self.told_apart(self.limit.unwrap_or(lower));
        [low, high]
    }

    /// The verdict in words.
    pub(crate) fn verdict_words(&self) -> Option<String> {
        let (limit, verdict) = self.limit.zip(self.verdict)?;
        let [limit, _, _] = self.told_apart(limit);
        Some(match verdict {
            Verdict::Within => format!("within the limit of {limit}"),
            Verdict::Above => format!("above the limit of {limit}"),
            Verdict::Undecided => format!(
                "not decided: the limit of {limit} lies between what is proven from below and from above; a smaller \
                 --accuracy or --tolerance may decide"
            ),
        })
    }

    /// Everything in lines of words.
    pub(crate) fn words(&self, subjects: &[Subject]) -> String {
        let (a, b) = (&subjects[0], &subjects[self.other]);
        let (_, upper) = self.bounds();
        let diagonal = a.simplices.bounds().diagonal();
        let found = &self.measured;
        let mut lines = vec![format!("{} and {}", a.name, b.name)];
        let share = if diagonal > 0.0 {
            format!(" ({}% of the diagonal)", short(upper / diagonal * 100.0))
        } else {
            String::new()
        };
        let proof = if self.slack.is_some() { "" } else { "; of their triangles, whose own error is not proven" };
        let [low, high] = self.bounds_words();
        lines.push(format!("  Hausdorff distance: from {low} to {high}{share}{proof}"));
        if !found.hausdorff.converged() {
            lines.push(
                "  not converged: splits or memory ran out; the bounds hold, but are wider than asked for".into(),
            );
        }
        let ways = [("to", &found.a_to_b, &found.hausdorff.a_to_b), ("back", &found.b_to_a, &found.hausdorff.b_to_a)];
        for (name, mean, farthest) in ways {
            lines.push(format!(
                "  {name}: mean {} (from {} to {}), rms {}, largest found {}",
                short(mean.mean.value),
                short(mean.mean.lower),
                short(mean.mean.upper),
                short(mean.rms.value),
                short(farthest.lower)
            ));
        }
        lines.push(format!("  chamfer distance: {} (mean of both means)", short(found.chamfer())));
        for (what, values) in [("area", [a.area(), b.area()]), ("volume", [a.volume(), b.volume()])] {
            if values.iter().any(Option::is_some) {
                let [a, b] = values.map(|value| value.map_or("none".to_owned(), short));
                lines.push(format!("  {what}: {a} and {b}"));
            }
        }
        lines.push(format!("  error of tessellation: {} and {}", a.deviation, b.deviation));
        lines.push(format!("  diagonal of {}: {}", a.name, short(diagonal)));
        lines.extend(self.verdict_words().map(|words| format!("  {words}")));
        lines.join("\n")
    }
}
