//! Spheres by latitude and longitude.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, Options, options};

use super::{BYTES_A_VERTEX, FaceList, LENGTH, around, finish, proven};
use crate::PolyMesh;

options! {
    /// A sphere about the origin, cut along meridians and parallels, with its poles on the z axis.
    ///
    /// Faces are flat quadrilaterals, triangles at the poles; vertices and normals are the sphere's own.
    pub struct Sphere("sphere") {
        required {}
        optional {
            /// Its radius, in model units.
            radius: f64 [LENGTH] = 1.0,
            /// How many meridians.
            segments: u32 [Bounds::closed(3.0, 32768.0)] = 64,
            /// How many bands between the poles.
            bands: u32 [Bounds::closed(2.0, 32768.0)] = 32,
        }
    }
}

impl Sphere {
    /// The facets. The deviation is the largest distance between a facet and the sphere: the radius less the distance
    /// of the facet's plane from the centre.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let (segments, bands) = (self.segments, self.bands);
        let _memory = exec.reserve_elements(u64::from(segments) * u64::from(bands), BYTES_A_VERTEX)?;
        let mut unit = vec![DVec3::Z];
        for band in 1..bands {
            exec.check()?;
            // Symmetric about the equator, and on it exactly.
            let lower = 2 * band > bands;
            let from_pole = if lower { bands - band } else { band };
            let angle = std::f64::consts::PI * f64::from(from_pole) / f64::from(bands);
            let (radius, height) = if 2 * from_pole == bands { (1.0, 0.0) } else { (angle.sin(), angle.cos()) };
            let height = if lower { -height } else { height };
            unit.extend((0..segments).map(|i| around(i, segments) * radius + DVec3::Z * height));
        }
        unit.push(-DVec3::Z);
        let ring = |band: u32, i: u32| 1 + (band - 1) * segments + i % segments;
        let south = unit.len() as u32 - 1;
        let mut faces = FaceList::new();
        for i in 0..segments {
            faces.push(&[0, ring(1, i), ring(1, i + 1)]);
        }
        for band in 1..bands - 1 {
            exec.check()?;
            for i in 0..segments {
                faces.push(&[ring(band, i), ring(band + 1, i), ring(band + 1, i + 1), ring(band, i + 1)]);
            }
        }
        for i in 0..segments {
            faces.push(&[ring(bands - 1, i), south, ring(bands - 1, i + 1)]);
        }
        // One facet of each band stands for all: its plane's distance from the centre is the least of the facet, unless
        // the foot of the centre lies outside, when the true distance is larger and the bound still holds.
        let (starts, corners) = faces.into_parts();
        let mut nearest = 1.0f64;
        for band in 0..bands {
            let face = (band * segments) as usize;
            let facet = &corners[starts[face] as usize..starts[face + 1] as usize];
            let [a, b, c] = [facet[0], facet[1], facet[2]].map(|vertex| unit[vertex as usize]);
            nearest = nearest.min((b - a).cross(c - a).normalize_or_zero().dot(a).abs());
        }
        let deviation = proven((1.0 - nearest) * self.radius, self.radius);
        let normals = corners.iter().map(|&vertex| unit[vertex as usize]).collect();
        let positions = unit.into_iter().map(|direction| direction * self.radius).collect();
        finish(Self::NAME, positions, (starts, corners), Some(normals), deviation, exec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Deviation;
    use std::f64::consts::PI;

    #[test]
    fn area_and_volume_converge_from_below() {
        let mut before = f64::INFINITY;
        for segments in [8, 32, 128] {
            let sphere = Sphere { radius: 2.0, segments, bands: segments / 2 }.mesh(&Exec::default()).unwrap();
            let volume = 32.0 * PI / 3.0;
            let missing = volume - sphere.value.volume();
            assert!(missing > 0.0 && missing < before / 10.0 && sphere.value.area() < 16.0 * PI, "{segments}");
            before = missing;
        }
    }

    #[test]
    fn facets_stay_within_the_deviation_and_touch_it() {
        let sphere = Sphere { radius: 3.0, segments: 12, bands: 7 }.mesh(&Exec::default()).unwrap();
        let Deviation::AtMost(bound) = sphere.report.deviation else { panic!("a bound") };
        let mut deepest = 0.0f64;
        for face in 0..sphere.value.face_count() {
            let outline: Vec<DVec3> = sphere.value.outline(face).collect();
            assert!(sphere.value.planarity(face) < 1e-15);
            for i in 0..=40 {
                for j in 0..=40 {
                    let (s, t) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                    let last = outline[outline.len() - 1];
                    let p = outline[0].lerp(outline[1], s).lerp(last.lerp(outline[2], s), t);
                    deepest = deepest.max(3.0 - p.length());
                }
            }
        }
        assert!(deepest <= bound && deepest > 0.98 * bound, "{deepest} {bound}");
    }

    #[test]
    fn budgets_and_bounds_are_kept() {
        let big = Sphere { segments: 32768, bands: 32768, ..Sphere::new() };
        assert!(big.mesh(&Exec::default()).is_err());
        assert!(Sphere { radius: f64::NAN, ..Sphere::new() }.mesh(&Exec::default()).is_err());
        assert!(Sphere { bands: 1, ..Sphere::new() }.mesh(&Exec::default()).is_err());
        assert_eq!(
            Sphere { bands: 2, segments: 3, ..Sphere::new() }.mesh(&Exec::default()).unwrap().value.face_count(),
            6
        );
    }
}
