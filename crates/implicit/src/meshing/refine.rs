//! Vertices moved to the zero of a field.

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{CHUNK, fill_chunks};
use shapeloom_core::{Exec, Field, Stop};
use shapeloom_isosurface::Lattice;

/// How near to a sample a vertex counts as on it, in cells.
const AT_SAMPLE: f64 = 1e-6;

/// How many vertices are moved a chunk.
const VERTICES: usize = CHUNK / 8;

/// Where the vertices of a surface may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// Along the edge between two samples, in any direction.
    Edge,
    /// Along the gradient, within the cell.
    Cell,
}

/// Moves vertices to where the field is zero. They stay where they are on the outermost samples of the lattice, where the solid may be cut off.
pub(super) fn refine<F: Field + ?Sized>(
    positions: &mut [DVec3],
    field: &F,
    lattice: &Lattice,
    path: Path,
    exec: &Exec,
) -> Result<(), Stop> {
    let (origin, step) = (lattice.position([0; 3]), lattice.spacing());
    let last = DVec3::from(lattice.dimensions().map(|count| f64::from(count - 1)));
    fill_chunks(exec, positions, VERTICES, |_, part| {
        for position in part {
            let place = (*position - origin) / step;
            if (place.min_element() < AT_SAMPLE) || (last - place).min_element() < AT_SAMPLE {
                continue;
            }
            match path {
                Path::Edge => {
                    let (low, high) = ends(place);
                    if low != high
                        && let Some(found) = root(field, origin + low * step, origin + high * step)
                    {
                        *position = found;
                    }
                }
                Path::Cell => {
                    let low = origin + place.floor() * step;
                    *position = descend(field, *position, low, low + step);
                }
            }
        }
        Ok(())
    })
}

/// The samples at the ends of the edge on which a vertex lies: whole coordinates are the same at both.
fn ends(place: DVec3) -> (DVec3, DVec3) {
    let near = place.round();
    let is_whole = (place - near).abs().cmplt(DVec3::splat(AT_SAMPLE));
    (DVec3::select(is_whole, near, place.floor()), DVec3::select(is_whole, near, place.ceil()))
}

/// A zero between two points with values of different signs: regula falsi with halved weights (Illinois; Dowell and Jarratt 1971).
fn root<F: Field + ?Sized>(field: &F, a: DVec3, b: DVec3) -> Option<DVec3> {
    let (at_a, at_b) = (field.value(a), field.value(b));
    if !(at_a.is_finite() && at_b.is_finite() && (at_a < 0.0) != (at_b < 0.0)) {
        return None;
    }
    let at = |part: f64| a + (b - a) * part;
    let (mut low, mut high, mut at_low, mut at_high) = (0.0, 1.0, at_a, at_b);
    let mut last = 0;
    for _ in 0..40 {
        let part = (low * at_high - high * at_low) / (at_high - at_low);
        let part = if part > low && part < high { part } else { 0.5 * (low + high) };
        let found = field.value(at(part));
        if found == 0.0 || high - low < 1e-13 {
            return Some(at(part));
        }
        // What is not a number is outside.
        if (found < 0.0) == (at_a < 0.0) {
            (low, at_low) = (part, found);
            at_high *= if last == 1 { 0.5 } else { 1.0 };
            last = 1;
        } else {
            (high, at_high) = (part, found);
            at_low *= if last == -1 { 0.5 } else { 1.0 };
            last = -1;
        }
    }
    Some(at(0.5 * (low + high)))
}

/// Newton's steps along the gradient, kept within a cell; the best place that was met.
fn descend<F: Field + ?Sized>(field: &F, start: DVec3, low: DVec3, high: DVec3) -> DVec3 {
    let (mut place, mut value) = (start, field.value(start));
    let (mut best, mut least) = (place, value.abs());
    for _ in 0..8 {
        let gradient = field.gradient(place);
        let next = place - gradient * (value / gradient.length_squared());
        if !next.is_finite() || value == 0.0 {
            break;
        }
        place = next.clamp(low, high);
        value = field.value(place);
        // Steps that gain nothing are the end of what rounding allows, or of the way.
        if value.is_nan() || value.abs() >= least {
            break;
        }
        (best, least) = (place, value.abs());
    }
    best
}
