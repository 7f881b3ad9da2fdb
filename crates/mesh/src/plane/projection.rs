//! From space to a plane and back.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Frame, choice};

use super::scale::Scale;

choice! {
    /// The plane in which points are triangulated.
    pub enum ProjectionPlane {
        /// Along z: x and y count, and triangles face +z.
        Xy = "xy",
        /// Along y: x and z count, and triangles face +y.
        Xz = "xz",
        /// Along x: y and z count, and triangles face +x.
        Yz = "yz",
        /// Along the normal of the plane that fits the points best, on the side of its largest component.
        Fit = "fit",
    }
}

/// How points get into the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Projection {
    /// Two of the coordinates as they are; the third is left.
    Axes([usize; 2]),
    /// A frame whose third axis is the normal, for points times a power of two.
    Frame(Frame, Scale),
}

impl Projection {
    /// The projection for these points.
    pub(crate) fn new(plane: ProjectionPlane, points: &[DVec3]) -> Self {
        match plane {
            ProjectionPlane::Xy => Self::Axes([0, 1]),
            ProjectionPlane::Xz => Self::Axes([2, 0]),
            ProjectionPlane::Yz => Self::Axes([1, 2]),
            ProjectionPlane::Fit => fit(points),
        }
    }

    /// Along the largest component of a normal, so that what runs counter-clockwise around the normal does so in the plane.
    pub(crate) fn along(normal: DVec3) -> Self {
        let size = normal.abs();
        let drop = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (i, j) = ((drop + 1) % 3, (drop + 2) % 3);
        Self::Axes(if normal[drop] >= 0.0 { [i, j] } else { [j, i] })
    }

    /// The direction in which triangles face.
    pub(crate) fn normal(&self) -> DVec3 {
        match self {
            Self::Axes([i, j]) => DVec3::AXES[*i].cross(DVec3::AXES[*j]),
            Self::Frame(frame, _) => frame.axes()[2],
        }
    }

    /// A point in the plane.
    pub(crate) fn flat(&self, point: DVec3) -> DVec2 {
        match self {
            Self::Axes([i, j]) => DVec2::new(point[*i], point[*j]),
            Self::Frame(frame, scale) => frame.coordinates(scale.apply_to_space(point)).truncate(),
        }
    }

    /// How far a point lies from the plane through the origin, along its normal.
    pub(crate) fn height(&self, point: DVec3) -> f64 {
        match self {
            Self::Axes([i, j]) => point[3 - i - j],
            Self::Frame(frame, scale) => scale.length(frame.coordinates(scale.apply_to_space(point)).z),
        }
    }

    /// A point near `about` that lies at a place of the plane: exactly where the plane has the coordinates of space.
    pub(crate) fn place(&self, at: DVec2, about: DVec3) -> DVec3 {
        match self {
            Self::Axes([i, j]) => {
                let mut placed = about;
                (placed[*i], placed[*j]) = (at.x, at.y);
                placed
            }
            Self::Frame(..) => about,
        }
    }
}

/// The plane through the mean with the least sum of squared distances.
fn fit(points: &[DVec3]) -> Projection {
    let scale = Scale::to_one(points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max));
    let count = points.len().max(1) as f64;
    let mean = points.iter().map(|&point| scale.apply_to_space(point)).sum::<DVec3>() / count;
    let mut moments = [[0.0; 3]; 3];
    for &point in points {
        let offset = scale.apply_to_space(point) - mean;
        for (i, row) in moments.iter_mut().enumerate() {
            for (j, moment) in row.iter_mut().enumerate() {
                *moment += offset[i] * offset[j];
            }
        }
    }
    let normal = least_direction(moments);
    let largest = normal.abs().max_position();
    let normal = if normal[largest] < 0.0 { -normal } else { normal };
    Projection::Frame(Frame::with_normal(mean, normal), scale)
}

/// The eigenvector of the smallest eigenvalue of a symmetric matrix, by Jacobi's rotations.
fn least_direction(mut m: [[f64; 3]; 3]) -> DVec3 {
    let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..32 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let ratio = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let tangent = 1f64.copysign(ratio) / (ratio.abs() + (ratio * ratio + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            let turned = |a: f64, b: f64| (cosine * a - sine * b, sine * a + cosine * b);
            for row in &mut m {
                (row[p], row[q]) = turned(row[p], row[q]);
            }
            let (upper, lower) = (m[p], m[q]);
            let turned: [(f64, f64); 3] = std::array::from_fn(|k| turned(upper[k], lower[k]));
            (m[p], m[q]) = (turned.map(|pair| pair.0), turned.map(|pair| pair.1));
            let (a, b) = (vectors[p], vectors[q]);
            (vectors[p], vectors[q]) = (a * cosine - b * sine, a * sine + b * cosine);
        }
    }
    let least = (0..3).min_by(|&a, &b| m[a][a].total_cmp(&m[b][b])).unwrap_or(2);
    vectors[least].try_normalize().unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_face_along_the_axis_that_is_dropped() {
        let triangle = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 2.5, -1.0), DVec3::new(2.0, 7.0, 5.0)];
        let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        for (plane, axis) in [(ProjectionPlane::Xy, 2), (ProjectionPlane::Xz, 1), (ProjectionPlane::Yz, 0)] {
            let projection = Projection::new(plane, &triangle);
            let [a, b, c] = triangle.map(|point| projection.flat(point));
            assert_eq!((b - a).perp_dot(c - a), normal[axis]);
            assert_eq!(projection.height(triangle[0]), triangle[0][axis]);
            assert_eq!(projection.place(a, DVec3::splat(9.0))[axis], 9.0);
        }
        for normal in [normal, -normal, DVec3::new(-5.0, 1.0, 2.0)] {
            let [a, b, c] = triangle.map(|point| Projection::along(normal).flat(point));
            let facing = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
            let axis = normal.abs().max_position();
            assert_eq!((b - a).perp_dot(c - a), facing[axis] * normal[axis].signum());
        }
    }

    /// Points on a tilted plane, of any size, fit it: their heights are rounding, and distances stay.
    #[test]
    fn a_plane_is_fitted_at_any_size() {
        let normal = DVec3::new(1.0, -2.0, 4.0).normalize();
        let frame = Frame::with_normal(DVec3::new(3.0, 1.0, 2.0), normal);
        for size in [1e-300, 1.0, 1e150] {
            let at = |k: i32| frame.position(DVec3::new(f64::from(k % 7), f64::from(k * 3 % 11), 0.0)) * size;
            let points: Vec<DVec3> = (0..40).map(at).collect();
            let projection = Projection::new(ProjectionPlane::Fit, &points);
            let heights: Vec<f64> = points.iter().map(|&point| projection.height(point) / size).collect();
            assert!(heights.iter().all(|height| (height - heights[0]).abs() < 1e-13), "{heights:?}");
            let Projection::Frame(found, _) = projection else { panic!("a frame") };
            assert!(found.axes()[2].dot(normal) > 1.0 - 1e-14);
        }
        let line: Vec<DVec3> = (0..5).map(|k| DVec3::X * f64::from(k)).collect();
        assert!(Projection::new(ProjectionPlane::Fit, &line).flat(line[3]).is_finite());
        assert!(Projection::new(ProjectionPlane::Fit, &[]).flat(DVec3::ONE).is_finite());
    }
}
