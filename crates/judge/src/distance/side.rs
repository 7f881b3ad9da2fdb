//! Two shapes made ready: on one scale, each with its hierarchy.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Closest, ClosestPoint, Exec, Reservation, Stop, parallel};
use shapeloom_spatial::TriangleBvh;

use super::Simplices;
use super::foot::{FootError, PAD, up};
use super::sums::times;
use crate::JudgeError;
use crate::scaled::{exponent_of, times_power};

/// A shape in scaled units.
pub(super) struct Side<'a> {
    pub positions: Vec<DVec3>,
    pub triangles: &'a [[u32; 3]],
    pub diagonal: f64,
    pub bvh: TriangleBvh,
    foot_error: FootError,
    _memory: Reservation,
}

/// The distance from a place to a shape, from both sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// As computed.
    pub distance: f64,
    /// The true distance is no less, and no more.
    pub lower: f64,
    pub upper: f64,
    /// The element on which the closest point was found.
    pub element: u32,
    pub point: DVec3,
}

/// The power of two by which both shapes are multiplied, so that no coordinate exceeds 1 in magnitude and the largest
/// exceeds 1/2: then no square overflows, and what underflows is far below the rounding that is accounted for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    exponent: i32,
}

impl Scale {
    pub fn of(shapes: [&Simplices<'_>; 2]) -> Self {
        let mut largest = 0.0f64;
        for shape in shapes {
            let corners = shape.triangles.iter().flatten();
            for position in corners.filter_map(|&corner| shape.positions.get(corner as usize)) {
                largest = largest.max(position.abs().max_element());
            }
        }
        let exponent = if largest > 0.0 && largest.is_finite() { -(exponent_of(largest) + 1) } else { 0 };
        Self { exponent }
    }

    /// The scale on which lengths are multiplied by a power of two.
    pub fn by(exponent: i32) -> Self {
        Self { exponent }
    }

    pub fn scaled(self, position: DVec3) -> DVec3 {
        times_power(position, self.exponent)
    }

    pub fn point(self, scaled: DVec3) -> DVec3 {
        times_power(scaled, -self.exponent)
    }

    pub fn length(self, scaled: f64) -> f64 {
        times(scaled, -self.exponent)
    }

    /// Lengths among the smallest numbers are rounded when they are scaled back; those beyond the largest are more than it.
    pub fn length_down(self, scaled: f64) -> f64 {
        let length = self.length(scaled);
        if length > 0.0 && length < f64::MIN_POSITIVE { length.next_down() } else { length.min(f64::MAX) }
    }

    pub fn length_up(self, scaled: f64) -> f64 {
        let length = self.length(scaled);
        if scaled > 0.0 && length < f64::MIN_POSITIVE { length.next_up() } else { length }
    }
}

impl<'a> Side<'a> {
    /// Scales a shape and builds its hierarchy. `which` is 0 for the first shape, 1 for the second.
    pub fn new(shape: &'a Simplices<'_>, which: usize, scale: Scale, exec: &Exec) -> Result<Self, JudgeError> {
        if shape.triangles.is_empty() {
            return Err(JudgeError::NothingToCompare { shape: which });
        }
        let memory = exec.reserve_elements(shape.positions.len() as u64, size_of::<DVec3>())?;
        let positions: Vec<DVec3> = shape.positions.iter().map(|&position| scale.scaled(position)).collect();
        let bvh = TriangleBvh::build(&positions, &shape.triangles, exec)?;
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| positions[corner as usize]);
        let errors = parallel::map_chunks(exec, shape.triangles.len(), parallel::CHUNK, |range| {
            let mut error = FootError::none();
            shape.triangles[range].iter().for_each(|triangle| error.include(&corners(triangle)));
            Ok::<_, Stop>(error)
        })?;
        let foot_error = errors.iter().fold(FootError::none(), FootError::union);
        let diagonal = bvh.bounds().diagonal();
        Ok(Self { positions, triangles: &shape.triangles, diagonal, bvh, foot_error, _memory: memory })
    }

    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// The distance from a place to this shape. The shape has triangles and the place is finite, so there is one.
    pub fn probe(&self, place: DVec3) -> Probe {
        self.probed(place, self.bvh.closest(place))
    }

    /// The same where the distance is known to be no more than `upper`: less of the hierarchy is looked at.
    pub fn probe_within(&self, place: DVec3, upper: f64) -> Probe {
        // A little more than the rounding of either distance.
        let found = self.bvh.closest_within(place, upper * (1.0 + 1e-14) + 4.0 * PAD);
        self.probed(place, found.or_else(|| self.bvh.closest(place)))
    }

    fn probed(&self, place: DVec3, found: Option<Closest>) -> Probe {
        match found {
            Some(closest) => {
                // The hierarchy works in units of its own: beside a tiny shape a square can be beyond the numbers. It is
                // then 1e-150 of the distance across, so that any of its points is the nearest, the rounding of a
                // distance aside.
                let near = closest.distance_squared.is_finite();
                let squared = if near { closest.distance_squared } else { (closest.point - place).length_squared() };
                let distance = squared.sqrt();
                let corner = distance == 0.0 && self.corners(closest.element).contains(&place);
                let upper = if corner { 0.0 } else { up(distance) };
                Probe {
                    distance,
                    lower: self.foot_error.down(distance),
                    upper,
                    element: closest.element,
                    point: closest.point,
                }
            }
            None => Probe { distance: f64::INFINITY, lower: 0.0, upper: f64::INFINITY, element: 0, point: place },
        }
    }

    /// The probes of another shape's positions that its triangles name; nothing is known of the others.
    pub fn probe_corners(&self, other: &Side<'_>, exec: &Exec) -> Result<Corners, JudgeError> {
        let memory = exec.reserve_elements(other.positions.len() as u64, size_of::<Probe>() + 1)?;
        let mut named = vec![false; other.positions.len()];
        other.triangles.iter().flatten().for_each(|&corner| named[corner as usize] = true);
        let nothing =
            Probe { distance: f64::INFINITY, lower: 0.0, upper: f64::INFINITY, element: 0, point: DVec3::ZERO };
        let mut probes = vec![nothing; other.positions.len()];
        parallel::fill_chunks(exec, &mut probes, 256, |first, part| {
            for (index, probe) in (first..).zip(part) {
                if named[index] {
                    *probe = self.probe(other.positions[index]);
                }
            }
            Ok::<_, Stop>(())
        })?;
        Ok(Corners { probes, _memory: memory })
    }
}

/// What is known of the positions of one shape.
pub(super) struct Corners {
    pub probes: Vec<Probe>,
    _memory: Reservation,
}
