//! Tensor-product Bézier patches.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, Interval, Surface, SurfaceJet};

use crate::curvature_net::CurvatureNets;
use crate::de_casteljau::{self, MAX_DEGREE};
use crate::{BezierCurve, BezierError, PatchSide};

/// A tensor-product Bézier patch of any degrees up to 255 over `[0, 1]²`.
///
/// The control net has `degree_v + 1` rows of `degree_u + 1` points, u along a row. The patch meets the corners of the
/// net, its boundary curves are the Bézier curves of the net's sides, and it lies in the net's convex hull. Its front
/// is where `du × dv` points.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatch {
    degree_u: usize,
    degree_v: usize,
    control: Vec<DVec3>,
}

/// Bounds of the lengths of the second partial derivatives over a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondDerivativeBounds {
    /// Of ∂²/∂u².
    pub uu: f64,
    /// Of ∂²/∂u∂v.
    pub uv: f64,
    /// Of ∂²/∂v².
    pub vv: f64,
}

impl BezierPatch {
    /// The patch with this control net, row by row, u along a row.
    ///
    /// # Errors
    /// Another number of control points than the degrees ask for, a degree above 255, or a point that is not finite.
    pub fn try_new(degree_u: u32, degree_v: u32, control: Vec<DVec3>) -> Result<Self, BezierError> {
        let highest = degree_u.max(degree_v) as usize;
        if highest > MAX_DEGREE {
            return Err(BezierError::Degree { found: highest, max: MAX_DEGREE });
        }
        let (u, v) = (degree_u as usize, degree_v as usize);
        if control.len() != (u + 1) * (v + 1) {
            return Err(BezierError::Count { degree_u, degree_v, found: control.len() });
        }
        match control.iter().position(|point| !point.is_finite()) {
            Some(index) => Err(BezierError::NotFinite { index }),
            None => Ok(Self { degree_u: u, degree_v: v, control }),
        }
    }

    /// The degree in u.
    pub fn degree_u(&self) -> usize {
        self.degree_u
    }

    /// The degree in v.
    pub fn degree_v(&self) -> usize {
        self.degree_v
    }

    /// The control net, row by row, u along a row.
    pub fn control_points(&self) -> &[DVec3] {
        &self.control
    }

    /// The control point `i` along u and `j` along v.
    ///
    /// # Panics
    /// When there is no such control point.
    pub fn control_point(&self, i: usize, j: usize) -> DVec3 {
        assert!(i <= self.degree_u && j <= self.degree_v, "control point {i}, {j} is outside the net");
        self.control[j * (self.degree_u + 1) + i]
    }

    fn rows(&self) -> impl ExactSizeIterator<Item = &[DVec3]> {
        self.control.chunks_exact(self.degree_u + 1)
    }

    /// The boundary curve of a side, in the direction of rising u or v.
    pub fn side(&self, side: PatchSide) -> BezierCurve<DVec3> {
        let (u, v) = (self.degree_u, self.degree_v);
        let control = match side {
            PatchSide::Bottom => (0..=u).map(|i| self.control_point(i, 0)).collect(),
            PatchSide::Top => (0..=u).map(|i| self.control_point(i, v)).collect(),
            PatchSide::Left => (0..=v).map(|j| self.control_point(0, j)).collect(),
            PatchSide::Right => (0..=v).map(|j| self.control_point(u, j)).collect(),
        };
        BezierCurve::try_new(control).expect("a side of a valid net is valid")
    }

    /// The part over `[u0, u1] × [v0, v1]` within `[0, 1]²`, over `[0, 1]²` anew.
    #[must_use]
    pub fn restricted(&self, u: Interval, v: Interval) -> Self {
        let mut patch = self.clone();
        for row in patch.control.chunks_exact_mut(self.degree_u + 1) {
            de_casteljau::restrict(row, u.lo, u.hi);
        }
        patch.map_columns(|column| de_casteljau::restrict(column, v.lo, v.hi));
        patch
    }

    fn map_columns(&mut self, f: impl Fn(&mut Vec<DVec3>)) {
        let width = self.degree_u + 1;
        let mut column = Vec::with_capacity(self.degree_v + 1);
        for i in 0..width {
            column.clear();
            column.extend((0..=self.degree_v).map(|j| self.control[j * width + i]));
            f(&mut column);
            for (j, &point) in column.iter().enumerate() {
                self.control[j * width + i] = point;
            }
        }
    }

    /// The same patch with u and v exchanged, and its front turned to the back.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let control =
            (0..=self.degree_u).flat_map(|i| (0..=self.degree_v).map(move |j| self.control_point(i, j))).collect();
        Self { degree_u: self.degree_v, degree_v: self.degree_u, control }
    }

    /// The same patch with one more control point in every row.
    ///
    /// # Errors
    /// The degree in u is the largest already.
    pub fn elevated_u(&self) -> Result<Self, BezierError> {
        let mut control = Vec::with_capacity(self.control.len() + self.degree_v + 1);
        for row in self.rows() {
            control.extend_from_slice(BezierCurve::try_new(row.to_vec())?.elevated()?.control_points());
        }
        Ok(Self { degree_u: self.degree_u + 1, degree_v: self.degree_v, control })
    }

    /// The same patch with one more row of control points.
    ///
    /// # Errors
    /// The degree in v is the largest already.
    pub fn elevated_v(&self) -> Result<Self, BezierError> {
        Ok(self.transposed().elevated_u()?.transposed())
    }

    /// The curve of constant v.
    pub fn isocurve_u(&self, v: f64) -> BezierCurve<DVec3> {
        self.transposed().isocurve_v(v)
    }

    /// The curve of constant u.
    pub fn isocurve_v(&self, u: f64) -> BezierCurve<DVec3> {
        let control = self.rows().map(|row| de_casteljau::evaluate(&mut row.to_vec(), u)).collect();
        BezierCurve::try_new(control).expect("points of a finite net are finite within the domain")
    }

    /// The image under an affine map: the patch of the mapped net. A map that mirrors turns the front to the other side
    /// of space, so the net is transposed to keep the outside out.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let moved = Self { control: self.control.iter().map(|&point| map.point(point)).collect(), ..self.clone() };
        if map.reverses_orientation() { moved.transposed() } else { moved }
    }

    /// The curve of constant v, and the curve of the derivatives by v along it.
    pub(crate) fn row_with_derivative(&self, v: f64) -> [Vec<DVec3>; 2] {
        let width = self.degree_u + 1;
        let (mut row, mut derivative) = (Vec::with_capacity(width), Vec::with_capacity(width));
        let mut column = Vec::with_capacity(self.degree_v + 1);
        for i in 0..width {
            column.clear();
            column.extend(self.control.iter().skip(i).step_by(width));
            let [point, slope] = de_casteljau::evaluate_with_derivative(&mut column, v);
            row.push(point);
            derivative.push(slope);
        }
        [row, derivative]
    }

    /// The box around the control net, which holds the patch.
    pub fn hull_bounds(&self) -> Aabb {
        Aabb::from_points(self.control.iter().copied())
    }

    /// Bounds of the second derivatives over the whole patch, from the second differences of the control net: each
    /// derivative lies in the convex hull of its differences. The rounding of the differences is counted in.
    pub fn second_derivative_bounds(&self) -> SecondDerivativeBounds {
        CurvatureNets::new(self).whole()
    }

    /// The unit normal at `(u, v)`, or where the patch degenerates there the limit towards its middle, found by
    /// stepping inward. None if the patch has no tangent plane near either.
    pub fn normal_or_limit(&self, u: f64, v: f64) -> Option<DVec3> {
        let size = self.hull_bounds().diagonal();
        let cross = |u: f64, v: f64| {
            let jet = self.jet(u, v);
            tangent_normal(jet.du, jet.dv, size)
        };
        // The limit at a pole is approached at first order: 1e-6 of the way in leaves an angle of about 1e-6.
        [0.0, 1e-6, 1e-4, 1e-2].into_iter().find_map(|inward| {
            let toward = |t: f64| t + (0.5 - t) * inward;
            cross(toward(u), toward(v))
        })
    }
}

/// The unit normal across two tangents of a patch of that size; none where they do not span a plane.
pub(crate) fn tangent_normal(du: DVec3, dv: DVec3, size: f64) -> Option<DVec3> {
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let (du, dv) = (du / size, dv / size);
    // A tangent of this length relative to the patch is rounding: collapsed sides evaluate to about 1e-16.
    let long = |tangent: DVec3| tangent.length() > 1e-12;
    if long(du) && long(dv) { du.cross(dv).try_normalize() } else { None }
}

impl Surface for BezierPatch {
    fn domain(&self) -> [Interval; 2] {
        [Interval::UNIT; 2]
    }

    fn point(&self, u: f64, v: f64) -> DVec3 {
        let mut row = vec![DVec3::ZERO; self.degree_u + 1];
        let mut column = Vec::with_capacity(self.degree_v + 1);
        for source in self.rows() {
            row.copy_from_slice(source);
            column.push(de_casteljau::evaluate(&mut row, u));
        }
        de_casteljau::evaluate(&mut column, v)
    }

    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        // Along u first: the point, first and second derivative of every row; then the same along v.
        let mut columns = [const { Vec::new() }; 3];
        let mut scratch = Vec::with_capacity(self.degree_u + 1);
        for source in self.rows() {
            let mut control = source.to_vec();
            for column in &mut columns {
                scratch.clear();
                scratch.extend_from_slice(&control);
                column.push(if scratch.is_empty() { DVec3::ZERO } else { de_casteljau::evaluate(&mut scratch, u) });
                let count = if control.is_empty() { 0 } else { de_casteljau::hodograph(&mut control) };
                control.truncate(count);
            }
        }
        let along_v = |column: &[DVec3], order: usize| {
            let mut control = column.to_vec();
            for _ in 0..order {
                let count = if control.is_empty() { 0 } else { de_casteljau::hodograph(&mut control) };
                control.truncate(count);
            }
            if control.is_empty() { DVec3::ZERO } else { de_casteljau::evaluate(&mut control, v) }
        };
        SurfaceJet {
            point: along_v(&columns[0], 0),
            du: along_v(&columns[1], 0),
            dv: along_v(&columns[0], 1),
            duu: along_v(&columns[2], 0),
            duv: along_v(&columns[1], 1),
            dvv: along_v(&columns[0], 2),
        }
    }

    fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        self.normal_or_limit(u, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z = x² - 3xy + y³ over the unit square, as a patch of degrees 2 × 3: derivatives in closed form.
    pub(crate) fn saddle() -> BezierPatch {
        let mut control = Vec::new();
        for j in 0..=3 {
            for i in 0..=2 {
                let (x, y) = (f64::from(i) / 2.0, f64::from(j) / 3.0);
                // Polar forms of x² and y³.
                let (xx, yyy) = (f64::from(u8::from(i == 2)), f64::from(u8::from(j == 3)));
                control.push(DVec3::new(x, y, xx - 3.0 * x * y + yyy));
            }
        }
        BezierPatch::try_new(2, 3, control).unwrap()
    }

    #[test]
    fn jets_are_those_of_the_polynomial() {
        let patch = saddle();
        for (u, v) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (1.0, 1.0)] {
            let jet = patch.jet(u, v);
            let close = |a: DVec3, b: [f64; 3]| (a - DVec3::from(b)).length() < 1e-14;
            assert!(close(jet.point, [u, v, u * u - 3.0 * u * v + v * v * v]));
            assert!(close(patch.point(u, v), [u, v, u * u - 3.0 * u * v + v * v * v]));
            assert!(close(jet.du, [1.0, 0.0, 2.0 * u - 3.0 * v]));
            assert!(close(jet.dv, [0.0, 1.0, -3.0 * u + 3.0 * v * v]));
            assert!(close(jet.duu, [0.0, 0.0, 2.0]));
            assert!(close(jet.duv, [0.0, 0.0, -3.0]));
            assert!(close(jet.dvv, [0.0, 0.0, 6.0 * v]));
        }
    }

    #[test]
    fn bounds_hold_and_are_sharp_for_low_degrees() {
        let bounds = saddle().second_derivative_bounds();
        assert!((bounds.uu - 2.0).abs() < 1e-13 && (bounds.uv - 3.0).abs() < 1e-13 && (bounds.vv - 6.0).abs() < 1e-13);
        let part = saddle().restricted(Interval::new(0.0, 0.5), Interval::new(0.0, 0.5)).second_derivative_bounds();
        // Halving both domains quarters the derivatives; y³ has half its second derivative there.
        assert!((part.uu - 0.5).abs() < 1e-13 && (part.uv - 0.75).abs() < 1e-13 && (part.vv - 0.75).abs() < 1e-13);
    }

    #[test]
    fn parts_sides_and_elevations_are_the_same_surface() {
        let patch = saddle();
        let part = patch.restricted(Interval::new(0.25, 0.75), Interval::new(0.5, 1.0));
        let raised = patch.elevated_u().unwrap().elevated_v().unwrap();
        assert_eq!((raised.degree_u(), raised.degree_v()), (3, 4));
        for i in 0..=4 {
            for j in 0..=4 {
                let (u, v) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
                assert!((part.point(u, v) - patch.point(0.25 + u / 2.0, 0.5 + v / 2.0)).length() < 1e-14);
                assert!((raised.point(u, v) - patch.point(u, v)).length() < 1e-14);
                assert!((patch.transposed().point(v, u) - patch.point(u, v)).length() < 1e-15);
                use shapeloom_core::Curve;
                assert!((patch.isocurve_u(v).point(u) - patch.point(u, v)).length() < 1e-14);
                assert!((patch.isocurve_v(u).point(v) - patch.point(u, v)).length() < 1e-14);
                assert_eq!(patch.side(PatchSide::Top).point(u), patch.point(u, 1.0));
                assert_eq!(patch.side(PatchSide::Left).point(v), patch.point(0.0, v));
            }
        }
    }

    #[test]
    fn poles_have_limit_normals() {
        // An octant-like patch whose top row is one point: the normal there is straight up.
        let row = |z: f64, r: f64| [(r, 0.0, z), (r, r, z), (0.0, r, z)].map(DVec3::from);
        let control = [row(0.0, 1.0), row(1.0, 1.0), row(1.0, 0.0)].concat();
        let patch = BezierPatch::try_new(2, 2, control).unwrap();
        for u in [0.0, 0.5, 1.0] {
            let normal = patch.normal(u, 1.0).unwrap();
            assert!((normal - DVec3::Z).length() < 1e-5, "{normal}");
        }
        let flat = BezierPatch::try_new(1, 1, vec![DVec3::ZERO; 4]).unwrap();
        assert_eq!(flat.normal(0.5, 0.5), None);
    }

    #[test]
    fn mirrored_patches_keep_their_outside() {
        let patch = saddle();
        let mirror = patch.transformed(&Affine::from_scale(DVec3::new(1.0, 1.0, -1.0)));
        let (before, after) = (patch.normal(0.2, 0.3).unwrap(), mirror.normal(0.3, 0.2).unwrap());
        assert!((after - before * DVec3::new(1.0, 1.0, -1.0)).length() < 1e-14);
    }

    #[test]
    fn nets_that_do_not_fit_are_refused() {
        assert!(matches!(BezierPatch::try_new(3, 3, vec![DVec3::ZERO; 15]), Err(BezierError::Count { .. })));
        assert!(matches!(BezierPatch::try_new(u32::MAX, 3, vec![]), Err(BezierError::Degree { .. })));
        assert!(BezierPatch::try_new(1, 0, vec![DVec3::ZERO, DVec3::INFINITY]).is_err());
        let point = BezierPatch::try_new(0, 0, vec![DVec3::X]).unwrap();
        assert_eq!((point.point(0.5, 0.5), point.jet(0.5, 0.5).duv), (DVec3::X, DVec3::ZERO));
    }
}
