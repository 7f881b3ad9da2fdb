//! Which side of the triangles a point is on.

use glam::DVec3;

use super::SignedDistance;

/// Which winding numbers are inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InsideRule {
    /// Above 1/2: what outward faces wrap around.
    #[default]
    Positive,
    /// Above 1/2 or below −1/2: also what faces that look inward wrap around, as in inverted shells.
    NonZero,
    /// Nearest to an odd number: each shell inside another turns inside out, whichever way its faces look.
    Odd,
}

impl InsideRule {
    /// Whether a winding number is inside. False for NaN.
    pub fn holds(self, winding_number: f64) -> bool {
        self.margin(winding_number) > 0.0
    }

    /// How far a winding number is from the nearest one that counts otherwise: positive inside.
    fn margin(self, winding_number: f64) -> f64 {
        match self {
            Self::Positive => winding_number - 0.5,
            Self::NonZero => winding_number.abs() - 0.5,
            Self::Odd => 0.5 - (winding_number.abs() % 2.0 - 1.0).abs(),
        }
    }
}

/// Tolerances to try where the mesh is open: most points are far from the threshold.
const TOLERANCES: [f64; 3] = [0.2, 0.02, 0.002];

impl SignedDistance {
    /// Whether a point is inside, by its winding number. False where the point is not finite.
    ///
    /// On a closed mesh the winding number is a whole number off the surface, so a proven bound below 1/2 is enough. Else
    /// it is refined until the bound keeps clear of the threshold, at last exactly; where rounding alone decides, on the
    /// threshold itself or closer to an edge than about 1e-13 of its length, the value is taken as it is.
    pub fn is_inside(&self, query: DVec3) -> bool {
        if self.closed {
            let found = self.winding.winding_number_within(query, 0.45);
            if found.bound < 0.5 {
                return self.rule.holds(found.value.round());
            }
        } else {
            for tolerance in TOLERANCES {
                let found = self.winding.winding_number_within(query, tolerance);
                let margin = self.rule.margin(found.value);
                if margin.abs() > found.bound {
                    return margin > 0.0;
                }
            }
        }
        self.rule.holds(self.winding.winding_number_exact(query).value)
    }
}
