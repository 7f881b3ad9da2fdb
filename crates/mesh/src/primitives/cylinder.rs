//! Cylinders.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, Options, options};

use super::{BYTES_A_VERTEX, FaceList, LENGTH, around, finish, proven};
use crate::PolyMesh;

options! {
    /// A closed cylinder about the z axis, centred at the origin: a prism with many sides and two flat caps.
    pub struct Cylinder("cylinder") {
        required {}
        optional {
            /// Its radius, in model units.
            radius: f64 [LENGTH] = 1.0,
            /// Its height, in model units.
            height: f64 [LENGTH] = 2.0,
            /// How many sides.
            segments: u32 [Bounds::closed(3.0, 1048576.0)] = 64,
        }
    }
}

impl Cylinder {
    /// The facets. The deviation is the sagitta of a side.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let segments = self.segments;
        let _memory = exec.reserve_elements(2 * u64::from(segments), 2 * BYTES_A_VERTEX)?;
        let half = DVec3::Z * (self.height / 2.0);
        let ring = |z: DVec3| (0..segments).map(move |i| around(i, segments) * self.radius + z);
        let positions = ring(-half).chain(ring(half)).collect();
        let mut faces = FaceList::new();
        let mut normals = Vec::new();
        for i in 0..segments {
            let next = (i + 1) % segments;
            faces.push(&[i, next, segments + next, segments + i]);
            normals.extend([i, next, next, i].map(|i| around(i, segments)));
        }
        let bottom: Vec<u32> = (0..segments).rev().collect();
        let top: Vec<u32> = (segments..2 * segments).collect();
        faces.push(&bottom);
        faces.push(&top);
        normals.extend(bottom.iter().map(|_| -DVec3::Z));
        normals.extend(top.iter().map(|_| DVec3::Z));
        let sagitta = self.radius * (1.0 - (std::f64::consts::PI / f64::from(segments)).cos());
        finish(
            Self::NAME,
            positions,
            faces.into_parts(),
            Some(normals),
            proven(sagitta, self.radius + self.height),
            exec,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Deviation;
    use std::f64::consts::PI;

    #[test]
    fn it_is_the_prism_of_its_polygon() {
        let cylinder = Cylinder { radius: 2.0, height: 3.0, segments: 12 }.mesh(&Exec::default()).unwrap();
        let base = 12.0 * 2.0 * (PI / 6.0).sin();
        assert!((cylinder.value.volume() - base * 3.0).abs() < 1e-13);
        assert!((cylinder.value.area() - (2.0 * base + 12.0 * 4.0 * (PI / 12.0).sin() * 3.0)).abs() < 1e-13);
        let Deviation::AtMost(bound) = cylinder.report.deviation else { panic!("a bound") };
        let middle = cylinder.value.outline(0).sum::<DVec3>() / 4.0;
        assert!((2.0 - middle.length() - bound).abs() < 1e-13);
    }
}
