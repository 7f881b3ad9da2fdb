//! Dual contouring.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Affine, Bounds, Convert, ConvertError, Converted, Exec, Field, FromTolerance, Options, Place, Severity, options,
};
use shapeloom_mesh::TriMesh;

use crate::dual::{Cell, Crossing, Placed, VertexRule, extract};
use crate::qef::least_squares;
use crate::result::finish;
use crate::{Border, FieldSlabs, Inside, InsideChoice, IsoValue, Lattice, Level, Slabs};

options! {
    /// Dual contouring of samples or a field: a vertex for each piece of the surface in a cell, where the planes through its
    /// crossings come nearest to each other, so that edges and corners stay sharp (Ju, Losasso, Schaefer and Warren 2002).
    ///
    /// The surface has the vertices and triangles of manifold surface nets; only the vertices lie elsewhere, never outside of their
    /// cells. Slopes of samples are one-sided differences, the smaller one of each two, so that they do not reach across an edge;
    /// a field is asked for its gradients, and crossings are refined on it. Cost: linear in the samples, some microseconds a vertex.
    pub struct DualContouring("dual-contouring") {
        required {}
        optional {
            /// The value that the surface is drawn at; `auto` is 0 for distances, a half for occupancy, else Otsu's threshold.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of it the inside is; `auto` is below for distances, above for densities.
            inside: InsideChoice = InsideChoice::Auto,
            /// Whether the surface is closed where the inside reaches the border of the lattice.
            border: Border = Border::Closed,
            /// Whether vertices get normals, from the gradient there.
            normals: bool = false,
            /// Singular values up to this part of the largest do not count: larger values make smooth surfaces calmer and blunt edges
            /// rounder.
            singular_threshold: f64 [Bounds::closed(0.0, 1.0)] = 0.1,
        }
    }
}

impl<S: Slabs + ?Sized> FromTolerance<S> for DualContouring {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl<S: Slabs + ?Sized> Convert<S> for DualContouring {
    type Output = TriMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.contour::<S, NoField>(source, None, exec)
    }
}

impl DualContouring {
    /// Contours a field sampled on a lattice, with crossings and gradients of the field itself.
    ///
    /// # Errors
    /// As [`Convert::convert_with`].
    pub fn field<F: Field + ?Sized>(
        &self,
        field: &F,
        lattice: Lattice,
        exec: &Exec,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        self.contour(&FieldSlabs::new(field, lattice), Some(field), exec)
    }

    /// Contours samples of a field, with crossings and gradients of the field itself.
    ///
    /// # Errors
    /// As [`Convert::convert_with`].
    pub fn sampled_field<S: Slabs + ?Sized, F: Field + ?Sized>(
        &self,
        samples: &S,
        field: &F,
        exec: &Exec,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        self.contour(samples, Some(field), exec)
    }

    fn contour<S: Slabs + ?Sized, F: Field + ?Sized>(
        &self,
        source: &S,
        field: Option<&F>,
        exec: &Exec,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (level, how) = Level::settle(source, self.iso, self.inside, exec)?;
        let placement = *source.lattice().placement();
        let rule = NearestToPlanes { field, placement, threshold: self.singular_threshold };
        let surface = extract(source, &rule, level, self.border, self.normals, exec)?;
        let held = surface.held;
        let mut converted = finish(Self::NAME, source, surface, (level, how), self.border, exec)?;
        if held > 0 {
            let message = "vertices that would have left their cells were held at the border of the cell";
            converted.report.findings.push_many("W-dual-contouring-held", Severity::Note, Place::Whole, message, held);
        }
        Ok(converted)
    }
}

/// The field of a source that is none.
struct NoField;

impl Field for NoField {
    fn value(&self, _: DVec3) -> f64 {
        0.0
    }

    fn gradient(&self, _: DVec3) -> DVec3 {
        DVec3::ZERO
    }
}

/// Where the planes through the crossings come nearest to each other.
struct NearestToPlanes<'a, F: ?Sized> {
    field: Option<&'a F>,
    placement: Affine,
    threshold: f64,
}

impl<F: Field + ?Sized> VertexRule for NearestToPlanes<'_, F> {
    const MEAN_WILL_DO: bool = false;

    fn vertex(&self, cell: &Cell<'_>, edges: u16) -> Placed {
        let planes = || cell.crossings(edges).map(|crossing| self.plane(cell, crossing));
        let center = planes().map(|(_, point)| point).sum::<DVec3>() / f64::from(edges.count_ones().max(1));
        let wanted = least_squares(planes(), center, self.threshold);
        let place = wanted.clamp(DVec3::ZERO, DVec3::ONE);
        // Rounding is not leaving.
        Placed { place, held: place.distance(wanted) > 1e-9 }
    }

    fn outward(&self, cell: &Cell<'_>, edges: u16, place: DVec3) -> DVec3 {
        let Some(field) = self.field else { return cell.outward(edges, place) };
        let sign = if cell.level().inside == Inside::Below { 1.0 } else { -1.0 };
        let gradient = field.gradient(self.placement.point(cell.lattice_place() + place)) * sign;
        let gradient = self.to_lattice(gradient);
        if gradient.is_finite() && gradient != DVec3::ZERO { gradient } else { cell.outward(edges, place) }
    }
}

impl<F: Field + ?Sized> NearestToPlanes<'_, F> {
    /// A gradient in space as one in lattice coordinates.
    fn to_lattice(&self, gradient: DVec3) -> DVec3 {
        DVec3::from(DVec3::AXES.map(|axis| self.placement.vector(axis).dot(gradient)))
    }

    /// The plane through a crossing, in the cell's coordinates: its normal times an offset is a distance in space.
    fn plane(&self, cell: &Cell<'_>, crossing: Crossing) -> (DVec3, DVec3) {
        let along = DVec3::AXES[crossing.axis];
        let on_border = crossing.ends.iter().any(|&end| cell.corner(end).is_none());
        let (point, gradient) = match self.field {
            _ if on_border => (crossing.place, along),
            Some(field) => {
                let place = refined(field, cell, &crossing, &self.placement);
                (place, self.to_lattice(field.gradient(self.placement.point(cell.lattice_place() + place))))
            }
            None => (crossing.place, slope(cell, &crossing)),
        };
        let normal = |gradient: DVec3| {
            // The length in space of what the gradient is there: 1 over the distance of unit level sets.
            let steps = DVec3::AXES.map(|axis| self.placement.vector(axis));
            let volume = steps[0].dot(steps[1].cross(steps[2]));
            let in_space = steps[1].cross(steps[2]) * gradient.x
                + steps[2].cross(steps[0]) * gradient.y
                + steps[0].cross(steps[1]) * gradient.z;
            gradient * (volume / in_space.length())
        };
        // Distances in cells of the longest step's size: squares neither overflow nor vanish.
        let size = DVec3::AXES.map(|axis| self.placement.vector(axis).length()).into_iter().fold(0.0, f64::max);
        let found = normal(gradient) / size;
        let found = if found.is_finite() { found } else { normal(along) / size };
        (if found.is_finite() { found } else { along }, point)
    }
}

/// The slope of the samples at a crossing, in cells: along the edge the difference of its ends; across, at each end, the smaller one of
/// the differences to both sides, mixed as the crossing divides the edge.
fn slope(cell: &Cell<'_>, crossing: &Crossing) -> DVec3 {
    let sample = |at: [isize; 3]| cell.sample(at).filter(|sample| sample.is_finite()).map(f64::from);
    let [p, q] = crossing.ends.map(|corner| [corner & 1, corner >> 1 & 1, corner >> 2].map(|bit| bit as isize));
    let part = crossing.place[crossing.axis];
    let mut slope = DVec3::ZERO;
    let (Some(low), Some(high)) = (sample(p), sample(q)) else { return DVec3::AXES[crossing.axis] };
    slope[crossing.axis] = high - low;
    for axis in (0..3).filter(|&axis| axis != crossing.axis) {
        let across = |at: [isize; 3], here: f64| {
            let beside = |by: isize| {
                let mut other = at;
                other[axis] += by;
                sample(other).map(|there| (there - here) * by as f64)
            };
            match (beside(-1), beside(1)) {
                (Some(a), Some(b)) => {
                    if a.abs() <= b.abs() {
                        a
                    } else {
                        b
                    }
                }
                (a, b) => a.or(b).unwrap_or(0.0),
            }
        };
        slope[axis] = across(p, low) * (1.0 - part) + across(q, high) * part;
    }
    slope
}

/// Where the field reaches the iso value on the edge of a crossing: bisection between ends of different signs.
fn refined<F: Field + ?Sized>(field: &F, cell: &Cell<'_>, crossing: &Crossing, placement: &Affine) -> DVec3 {
    let axis = crossing.axis;
    let at = |part: f64| {
        let mut place = crossing.place;
        place[axis] = part;
        place
    };
    let iso = f64::from(cell.level().iso);
    let value = |part: f64| field.value(placement.point(cell.lattice_place() + at(part))) - iso;
    let (mut low, mut high) = (0.0, 1.0);
    let (below, above) = (value(low), value(high));
    if !((below < 0.0) != (above < 0.0) && below.is_finite() && above.is_finite()) {
        return crossing.place;
    }
    let (mut at_low, mut at_high) = (below, above);
    // Regula falsi with halved weights (Illinois): a dozen steps reach rounding on smooth fields, and never leave the bracket.
    let mut last = 0;
    for _ in 0..24 {
        let part = (low * at_high - high * at_low) / (at_high - at_low);
        let part = if part > low && part < high { part } else { 0.5 * (low + high) };
        let found = value(part);
        if found == 0.0 || high - low < 1e-12 {
            return at(part);
        }
        if (found < 0.0) == (below < 0.0) {
            (low, at_low) = (part, found);
            at_high *= if last == 1 { 0.5 } else { 1.0 };
            last = 1;
        } else {
            (high, at_high) = (part, found);
            at_low *= if last == -1 { 0.5 } else { 1.0 };
            last = -1;
        }
    }
    at(0.5 * (low + high))
}
