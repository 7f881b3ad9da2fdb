//! Affine maps of space.

use std::fmt;
use std::ops::Mul;

use glam::{DAffine3, DMat3, DMat4, DVec3};

use crate::{AxisAngle, Category, Diagnostic, Frame, Warp};

/// An affine map `p ↦ linear · p + translation`.
///
/// Points, vectors and normals are told apart by the method: [`Affine::point`], [`Affine::vector`],
/// [`Affine::normal`]. Maps compose from right to left: `(a * b).point(p) == a.point(b.point(p))` up to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The linear part; its columns are the images of the unit vectors.
    pub linear: DMat3,
    /// The image of the origin.
    pub translation: DVec3,
}

/// What an affine map keeps, from the most special class down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AffineClass {
    /// Keeps distances.
    Rigid,
    /// Scales all distances by the same factor.
    Similarity {
        /// The factor, positive.
        scale: f64,
    },
    /// Keeps parallels and ratios on a line.
    General,
    /// Flattens space; there is no inverse.
    Singular,
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// A linear map about the origin.
    pub const fn from_linear(linear: DMat3) -> Self {
        Self { linear, translation: DVec3::ZERO }
    }

    /// The translation by `offset`.
    pub const fn from_translation(offset: DVec3) -> Self {
        Self { linear: DMat3::IDENTITY, translation: offset }
    }

    /// The scaling by a factor along each axis, about the origin.
    pub fn from_scale(factors: DVec3) -> Self {
        Self::from_linear(DMat3::from_diagonal(factors))
    }

    /// The rotation by `turn` about the axis through the origin.
    pub fn from_rotation(turn: AxisAngle) -> Self {
        Self::from_linear(turn.to_matrix())
    }

    /// The shear that moves each point along `direction` by its signed height over the plane through the origin with
    /// unit normal `normal`: `p + direction · (normal · p)`. It keeps volumes when `direction` lies in the plane.
    pub fn from_shear(direction: DVec3, normal: DVec3) -> Self {
        let column = |unit: DVec3| unit + direction * normal.dot(unit);
        Self::from_linear(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
    }

    /// The map that takes `from` to `to`, axis onto axis and origin onto origin: the active map of a change of frames.
    ///
    /// Between frames with the same origin its matrix, in the coordinates of `from`, has the entries
    /// `T_ij = e_i · e'_j`. Coordinates of a fixed point change by the inverse: see [`Frame::coordinates`].
    pub fn between(from: &Frame, to: &Frame) -> Self {
        to.to_world() * from.to_local()
    }

    /// The same map with `center` in place of the origin: `T(center) · self · T(-center)`.
    #[must_use]
    pub fn about(self, center: DVec3) -> Self {
        Self::from_translation(center) * self * Self::from_translation(-center)
    }

    /// The image of a point.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.translation
    }

    /// The image of a vector: translations do not move it.
    pub fn vector(&self, vector: DVec3) -> DVec3 {
        self.linear * vector
    }

    /// The image of a unit normal under the inverse transpose, of unit length again.
    ///
    /// A normal of a surface stays the normal of the mapped surface on the same side, for maps that reverse
    /// orientation too. Zero where the map is singular and leaves no normal, and where `normal` is zero.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        // The cofactor matrix is det · inverse transpose and exists for singular maps too. Scaling the columns first
        // keeps it from overflowing or vanishing; positive factors do not change the direction.
        let size = self.linear.x_axis.abs().max(self.linear.y_axis.abs()).max(self.linear.z_axis.abs()).max_element();
        if !(size > 0.0 && size.is_finite()) {
            return DVec3::ZERO;
        }
        let [x, y, z] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis].map(|column| column / size);
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        let image = yz * normal.x + zx * normal.y + xy * normal.z;
        let flip = if x.dot(yz) < 0.0 { -1.0 } else { 1.0 };
        (image * flip).normalize_or_zero()
    }

    /// The factor by which signed volumes grow.
    pub fn determinant(&self) -> f64 {
        self.linear.determinant()
    }

    /// Whether the map mirrors: faces must then be reversed to keep their outside out.
    pub fn reverses_orientation(&self) -> bool {
        self.determinant() < 0.0
    }

    /// The most special class the map belongs to; deviations up to `tolerance`, relative to the map's size, count as
    /// rounding. Mirroring is told apart by [`Affine::reverses_orientation`].
    pub fn class(&self, tolerance: f64) -> AffineClass {
        let columns = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        let size = columns.iter().map(|column| column.abs().max_element()).fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return AffineClass::Singular;
        }
        let [x, y, z] = columns.map(|column| column / size);
        if x.dot(y.cross(z)).abs() <= tolerance {
            return AffineClass::Singular;
        }
        let square = x.length_squared();
        let same = |value: f64, wanted: f64| (value - wanted).abs() <= tolerance * square.max(1.0);
        let orthogonal = same(x.dot(y), 0.0) && same(y.dot(z), 0.0) && same(z.dot(x), 0.0);
        if !(orthogonal && same(y.length_squared(), square) && same(z.length_squared(), square)) {
            return AffineClass::General;
        }
        let scale = square.sqrt() * size;
        if (scale - 1.0).abs() <= tolerance { AffineClass::Rigid } else { AffineClass::Similarity { scale } }
    }

    /// The inverse map.
    ///
    /// # Errors
    /// The map is singular or not finite.
    pub fn inverse(&self) -> Result<Self, SingularMap> {
        let determinant = self.determinant();
        let linear = self.linear.inverse();
        let inverse = Self { linear, translation: -(linear * self.translation) };
        if determinant != 0.0 && inverse.is_finite() { Ok(inverse) } else { Err(SingularMap { determinant }) }
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.translation.is_finite()
    }

    /// The largest factor by which the map can stretch a distance, bounded from above by the Frobenius norm.
    pub fn stretch_bound(&self) -> f64 {
        let columns = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
    }

    /// The homogeneous 4 × 4 matrix.
    pub fn to_matrix(&self) -> DMat4 {
        DMat4::from(DAffine3 { matrix3: self.linear, translation: self.translation })
    }

    /// The map of a homogeneous 4 × 4 matrix whose last row is 0 0 0 1; none for a projective matrix.
    pub fn from_matrix(matrix: DMat4) -> Option<Self> {
        let last = matrix.row(3);
        (last.to_array() == [0.0, 0.0, 0.0, 1.0])
            .then(|| Self { linear: DMat3::from_mat4(matrix), translation: matrix.w_axis.truncate() })
    }
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Mul for Affine {
    type Output = Self;

    /// `self` after `first`.
    fn mul(self, first: Self) -> Self {
        Self { linear: self.linear * first.linear, translation: self.point(first.translation) }
    }
}

impl Warp for Affine {
    fn position(&self, point: DVec3) -> DVec3 {
        self.point(point)
    }

    fn jacobian(&self, _: DVec3) -> DMat3 {
        self.linear
    }
}

/// An affine map without an inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingularMap {
    /// The determinant of the linear part.
    pub determinant: f64,
}

impl fmt::Display for SingularMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "affine map: found determinant {}, expected an invertible map", self.determinant)
    }
}

impl std::error::Error for SingularMap {}

impl Diagnostic for SingularMap {
    fn code(&self) -> &'static str {
        "E-affine-singular"
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn some_map() -> Affine {
        let linear =
            DMat3::from_cols(DVec3::new(1.0, 2.0, -1.0), DVec3::new(0.5, -1.0, 3.0), DVec3::new(2.0, 0.0, 1.0));
        Affine { linear, translation: DVec3::new(3.0, -4.0, 5.0) }
    }

    #[test]
    fn composes_from_right_to_left() {
        let turn = Affine::from_rotation(AxisAngle::new(DVec3::Z, FRAC_PI_2).unwrap());
        let shift = Affine::from_translation(DVec3::X);
        assert!(((turn * shift).point(DVec3::ZERO) - DVec3::Y).length() < 1e-15);
        assert!(((shift * turn).point(DVec3::ZERO) - DVec3::X).length() < 1e-15);
        let p = DVec3::new(0.3, 0.7, -0.2);
        assert!(((some_map() * turn).point(p) - some_map().point(turn.point(p))).length() < 1e-14);
    }

    #[test]
    fn rotation_about_an_axis_through_a_point_keeps_the_axis() {
        let (axis, through) = (DVec3::new(1.0, 2.0, 2.0) / 3.0, DVec3::new(5.0, -1.0, 2.0));
        let turn = Affine::from_rotation(AxisAngle::new(axis, 1.2).unwrap()).about(through);
        for step in [-2.0, 0.0, 3.5] {
            let on_axis = through + axis * step;
            assert!((turn.point(on_axis) - on_axis).length() < 1e-14);
        }
        assert_eq!(turn.class(1e-12), AffineClass::Rigid);
    }

    #[test]
    fn classes_are_told_apart() {
        let mirror = Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        assert_eq!(mirror.class(1e-12), AffineClass::Rigid);
        assert!(mirror.reverses_orientation());
        assert_eq!(Affine::from_scale(DVec3::splat(2.0)).class(1e-12), AffineClass::Similarity { scale: 2.0 });
        assert_eq!(Affine::from_scale(DVec3::new(1.0, 1.0, 2.0)).class(1e-12), AffineClass::General);
        assert_eq!(Affine::from_shear(DVec3::X, DVec3::Z).class(1e-12), AffineClass::General);
        assert_eq!(Affine::from_scale(DVec3::new(1.0, 1.0, 0.0)).class(1e-12), AffineClass::Singular);
        assert_eq!(Affine::from_scale(DVec3::splat(1e-200)).class(1e-12), AffineClass::Similarity { scale: 1e-200 });
    }

    #[test]
    fn shear_keeps_volume_and_its_plane() {
        let shear = Affine::from_shear(DVec3::new(2.0, 1.0, 0.0), DVec3::Z);
        assert_eq!(shear.determinant(), 1.0);
        assert_eq!(shear.point(DVec3::new(3.0, 4.0, 0.0)), DVec3::new(3.0, 4.0, 0.0));
        assert_eq!(shear.point(DVec3::new(0.0, 0.0, 2.0)), DVec3::new(4.0, 2.0, 2.0));
    }

    #[test]
    fn normals_stay_perpendicular_and_on_their_side() {
        for map in [some_map(), some_map() * Affine::from_scale(DVec3::new(1.0, 1.0, -1.0))] {
            let (s, t) = (DVec3::new(1.0, 0.2, -0.4), DVec3::new(-0.3, 1.0, 0.6));
            let normal = s.cross(t).normalize();
            let image = map.normal(normal);
            assert!(image.dot(map.vector(s)).abs() < 1e-14 && image.dot(map.vector(t)).abs() < 1e-14);
            // The outer side stays the outer side.
            assert!(image.dot(map.vector(normal)) > 0.0);
            assert!((image.length() - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn inverse_undoes_and_singular_maps_say_so() {
        let p = DVec3::new(0.1, 0.2, 0.3);
        let back = some_map().inverse().unwrap();
        assert!((back.point(some_map().point(p)) - p).length() < 1e-14);
        assert!(Affine::from_scale(DVec3::new(0.0, 1.0, 1.0)).inverse().is_err());
        assert!(Affine::from_scale(DVec3::NAN).inverse().is_err());
    }

    #[test]
    fn active_map_of_frames_has_the_dot_products_as_entries() {
        let from = Frame::WORLD;
        let to = Frame::new(DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 0.0, 0.0)).unwrap();
        let map = Affine::between(&from, &to);
        for (i, e) in from.axes().into_iter().enumerate() {
            for (j, e_new) in to.axes().into_iter().enumerate() {
                assert!((map.linear.col(j)[i] - e.dot(e_new)).abs() < 1e-15);
                assert!((map.vector(from.axes()[j]) - e_new).length() < 1e-15);
            }
        }
        // Coordinates change by the inverse, which is the transpose.
        let p = DVec3::new(1.0, 2.0, 3.0);
        assert!((to.coordinates(p) - map.linear.transpose() * p).length() < 1e-14);
    }

    #[test]
    fn matrices_survive_the_round_trip() {
        assert_eq!(Affine::from_matrix(some_map().to_matrix()), Some(some_map()));
        let mut projective = some_map().to_matrix();
        projective.z_axis.w = -1.0;
        assert_eq!(Affine::from_matrix(projective), None);
    }
}
