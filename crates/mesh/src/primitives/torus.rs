//! Tori.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, Options, options};

use super::{BYTES_A_VERTEX, FaceList, LENGTH, around, finish, proven};
use crate::PolyMesh;

options! {
    /// A torus about the z axis.
    ///
    /// Faces are flat quadrilaterals; vertices and normals are the torus's own.
    pub struct Torus("torus") {
        required {}
        optional {
            /// The radius of the circle in the middle of the tube, in model units.
            major_radius: f64 [LENGTH] = 1.0,
            /// The radius of the tube, in model units.
            minor_radius: f64 [LENGTH] = 0.4,
            /// How many facets around the axis.
            segments: u32 [Bounds::closed(3.0, 32768.0)] = 96,
            /// How many facets around the tube.
            sides: u32 [Bounds::closed(3.0, 32768.0)] = 48,
        }
    }
}

impl Torus {
    /// The facets. The deviation follows from the second derivatives (Filip, Magedson and Markot 1986). A tube wider
    /// than its circle makes a torus that crosses itself.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let (segments, sides) = (self.segments, self.sides);
        let _memory = exec.reserve_elements(u64::from(segments) * u64::from(sides), BYTES_A_VERTEX)?;
        let (mut positions, mut outward) = (Vec::new(), Vec::new());
        for i in 0..segments {
            exec.check()?;
            let ahead = around(i, segments);
            for j in 0..sides {
                let turn = around(j, sides);
                let normal = ahead * turn.x + DVec3::Z * turn.y;
                positions.push(ahead * self.major_radius + normal * self.minor_radius);
                outward.push(normal);
            }
        }
        let vertex = |i: u32, j: u32| (i % segments) * sides + j % sides;
        let mut faces = FaceList::new();
        for i in 0..segments {
            for j in 0..sides {
                faces.push(&[vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
            }
        }
        let (u, v) = (std::f64::consts::TAU / f64::from(segments), std::f64::consts::TAU / f64::from(sides));
        let (wide, tube) = (self.major_radius + self.minor_radius, self.minor_radius);
        let bound = (wide * u * u + 2.0 * tube * u * v + tube * v * v) / 8.0;
        let faces = faces.into_parts();
        let normals = faces.1.iter().map(|&vertex| outward[vertex as usize]).collect();
        finish(Self::NAME, positions, faces, Some(normals), proven(bound, wide), exec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Deviation;
    use std::f64::consts::PI;

    #[test]
    fn area_and_volume_approach_the_closed_forms() {
        let torus = Torus { segments: 400, sides: 200, ..Torus::new() }.mesh(&Exec::default()).unwrap();
        assert!((torus.value.volume() / (2.0 * PI * PI * 0.16) - 1.0).abs() < 3e-4);
        assert!((torus.value.area() / (4.0 * PI * PI * 0.4) - 1.0).abs() < 2e-4);
        assert!((0..80_000).all(|face| torus.value.planarity(face) < 1e-15));
    }

    #[test]
    fn facets_stay_within_the_deviation() {
        let torus = Torus { segments: 9, sides: 5, ..Torus::new() }.mesh(&Exec::default()).unwrap();
        let Deviation::AtMost(bound) = torus.report.deviation else { panic!("a bound") };
        let mut deepest = 0.0f64;
        for face in 0..torus.value.face_count() {
            let middle = torus.value.outline(face).sum::<DVec3>() / 4.0;
            let from_circle = (middle.truncate().length() - 1.0).hypot(middle.z);
            deepest = deepest.max((from_circle - 0.4).abs());
        }
        assert!(deepest <= bound && deepest > bound / 4.0, "{deepest} {bound}");
    }
}
