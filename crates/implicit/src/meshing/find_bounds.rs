//! Where a shape is.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, ConvertError, Exec, Field, Restricted};

use super::MeshingError;

/// A box outside of which a field is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundBounds {
    /// The box; empty where the field is positive everywhere.
    pub bounds: Aabb,
    /// The box that was searched: infinite where bounds over infinite boxes prove that the shape ends, else up to 2²⁰.
    pub searched: Aabb,
}

impl FoundBounds {
    /// Whether the field is proven to be positive everywhere outside of the box, not only where it was searched.
    pub fn is_proven(&self) -> bool {
        self.searched.min == DVec3::NEG_INFINITY && self.searched.max == DVec3::INFINITY
    }
}

/// How far is searched along an axis where bounds over infinite boxes prove nothing.
const LIMIT: f64 = (1_u32 << 20) as f64;

/// The powers of two that are tried as ends of a shape.
const EXPONENTS: std::ops::RangeInclusive<i32> = -1000..=1000;

/// How many boxes are asked about at most: so many that a box's flat faces are found to a 32nd of its size.
const MOST_BOXES: usize = 20_000;

/// At this part of the whole box's size, boxes are not divided further.
const FINEST: f64 = 1.0 / 48.0;

/// A box where the field may be negative or zero, with what is left of the field there.
struct Open {
    region: Aabb,
    field: Option<Arc<dyn Field>>,
    /// Whether the field is negative in all of it.
    inside: bool,
}

/// A box outside of which the field is proven to be positive, not more than about a 20th larger than needed where its bounds are good.
///
/// Along each of the six directions a half-space is sought over which the field's bounds are positive; where there is none, the search
/// is limited to coordinates of 2²⁰. Then the box is divided (bounds by interval arithmetic, simpler fields for its parts), parts
/// without the shape are dropped, and only those at the sides of what is left are divided again.
///
/// # Errors
/// [`MeshingError::Unbounded`] if the shape reaches the limit of the search or cannot be excluded there, and the reason to stop.
pub fn find_bounds<F: Field + ?Sized>(field: &F, exec: &Exec) -> Result<FoundBounds, ConvertError> {
    let (mut whole, mut searched) = (Aabb { min: DVec3::ZERO, max: DVec3::ZERO }, Aabb::EMPTY);
    for axis in 0..3 {
        for upward in [false, true] {
            let end = half_space(field, axis, upward);
            exec.check()?;
            let (whole, searched) =
                if upward { (&mut whole.max, &mut searched.max) } else { (&mut whole.min, &mut searched.min) };
            let sign = if upward { 1.0 } else { -1.0 };
            whole[axis] = sign * end.unwrap_or(LIMIT);
            searched[axis] = sign * if end.is_some() { f64::INFINITY } else { LIMIT };
        }
    }
    let mut open = Vec::new();
    ask(field, None, whole, &mut open);
    let mut asked = 0;
    while asked < MOST_BOXES {
        exec.check()?;
        let hull = hull_of(&open);
        let at_side =
            |region: &Aabb| (0..3).any(|axis| region.min[axis] <= hull.min[axis] || region.max[axis] >= hull.max[axis]);
        let finest = hull.size() * FINEST;
        let divides = |part: &Open| {
            !part.inside
                && at_side(&part.region)
                && (0..3).any(|axis| part.region.size()[axis] > finest[axis])
                // Between neighbouring numbers there is no middle.
                && part.region.center().cmpgt(part.region.min).all()
                && part.region.center().cmplt(part.region.max).all()
        };
        if !open.iter().any(divides) {
            break;
        }
        let mut next = Vec::new();
        for part in open {
            if !divides(&part) {
                next.push(part);
                continue;
            }
            for region in halves(&part.region, hull.size()) {
                ask(field, part.field.clone(), region, &mut next);
                asked += 1;
            }
        }
        open = next;
    }
    let bounds = hull_of(&open);
    if !bounds.is_empty() {
        for axis in 0..3 {
            for upward in [false, true] {
                let (end, limit) = match upward {
                    false => (bounds.min[axis], searched.min[axis]),
                    true => (bounds.max[axis], searched.max[axis]),
                };
                if end == limit {
                    return Err(MeshingError::Unbounded { searched, axis, upward }.into());
                }
            }
        }
    }
    Ok(FoundBounds { bounds, searched })
}

/// The least power of two beyond which the field is positive.
fn half_space<F: Field + ?Sized>(field: &F, axis: usize, upward: bool) -> Option<f64> {
    let is_positive = |exponent: i32| {
        let mut region = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        let end = 2.0_f64.powi(exponent);
        if upward {
            region.min[axis] = end
        } else {
            region.max[axis] = -end
        };
        field.range(&region).lo > 0.0
    };
    // Squares and higher powers of very large coordinates overflow, so begin where shapes are.
    let mut known = [60, 20, 200, 505, 900].into_iter().find(|&exponent| is_positive(exponent))?;
    let mut below = *EXPONENTS.start();
    while known - below > 1 {
        let middle = below + (known - below) / 2;
        if is_positive(middle) {
            known = middle
        } else {
            below = middle
        };
    }
    Some(2.0_f64.powi(known))
}

fn ask<F: Field + ?Sized>(whole: &F, field: Option<Arc<dyn Field>>, region: Aabb, open: &mut Vec<Open>) {
    let restricted = match &field {
        Some(field) => field.restrict(&region),
        None => whole.restrict(&region),
    };
    match restricted {
        Restricted::Positive => {}
        Restricted::Negative => open.push(Open { region, field, inside: true }),
        Restricted::Same => open.push(Open { region, field, inside: false }),
        Restricted::Simpler(simpler) => open.push(Open { region, field: Some(simpler), inside: false }),
    }
}

fn hull_of(open: &[Open]) -> Aabb {
    open.iter().fold(Aabb::EMPTY, |hull, part| hull.union(part.region))
}

/// The halves of a box along the axes on which it is longest beside the hull, so that a shape that is small and far away is found
/// along one axis without ado along the others.
fn halves(region: &Aabb, hull: DVec3) -> impl Iterator<Item = Aabb> {
    let shares = region.size() / hull;
    let most = shares.max_element();
    let splits = [0, 1, 2].map(|axis| shares[axis] >= 0.75 * most);
    let (region, middle) = (*region, region.center());
    (0..8).filter_map(move |octant| {
        let mut part = region;
        for axis in 0..3 {
            match (splits[axis], octant >> axis & 1) {
                (true, 0) => part.max[axis] = middle[axis],
                (true, _) => part.min[axis] = middle[axis],
                (false, 0) => {}
                (false, _) => return None,
            }
        }
        Some(part)
    })
}
