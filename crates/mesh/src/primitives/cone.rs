//! Cones.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, Options, options};

use super::{BYTES_A_VERTEX, FaceList, LENGTH, around, finish, proven};
use crate::PolyMesh;

options! {
    /// A closed cone about the z axis, its base at `z = 0`: a pyramid with many sides.
    pub struct Cone("cone") {
        required {}
        optional {
            /// The radius of its base, in model units.
            radius: f64 [LENGTH] = 1.0,
            /// Its height, in model units.
            height: f64 [LENGTH] = 2.0,
            /// How many sides.
            segments: u32 [Bounds::closed(3.0, 1048576.0)] = 64,
        }
    }
}

impl Cone {
    /// The facets. The deviation is at most the sagitta of a side of the base. The normals at the tip are those in the
    /// middle of each side.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let segments = self.segments;
        let _memory = exec.reserve_elements(u64::from(segments), 2 * BYTES_A_VERTEX)?;
        let mut positions: Vec<DVec3> = (0..segments).map(|i| around(i, segments) * self.radius).collect();
        positions.push(DVec3::Z * self.height);
        let normal = |outward: DVec3| (outward * self.height + DVec3::Z * self.radius).normalize();
        let mut faces = FaceList::new();
        let mut normals = Vec::new();
        for i in 0..segments {
            let next = (i + 1) % segments;
            faces.push(&[i, next, segments]);
            let (a, b) = (around(i, segments), around(next, segments));
            normals.extend([normal(a), normal(b), normal((a + b).normalize())]);
        }
        let base: Vec<u32> = (0..segments).rev().collect();
        faces.push(&base);
        normals.extend(base.iter().map(|_| -DVec3::Z));
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
    use std::f64::consts::PI;

    #[test]
    fn it_is_the_pyramid_of_its_polygon() {
        let cone = Cone { radius: 2.0, height: 3.0, segments: 12 }.mesh(&Exec::default()).unwrap();
        let base = 12.0 * 2.0 * (PI / 6.0).sin();
        assert!((cone.value.volume() - base).abs() < 1e-13);
        let slant = 3f64.hypot(2.0 * (PI / 12.0).cos());
        assert!((cone.value.area() - (base + 12.0 * 2.0 * (PI / 12.0).sin() * slant)).abs() < 1e-13);
    }
}
