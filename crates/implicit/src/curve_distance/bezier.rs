//! Bézier pieces: points, flattening, the nearest point.

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

/// A Bézier curve over [0, 1].
#[derive(Clone, Debug)]
pub(super) struct Piece {
    control: Vec<DVec3>,
    /// Control points of the first and second derivative.
    first: Vec<DVec3>,
    second: Vec<DVec3>,
}

impl Piece {
    pub(super) fn new(control: Vec<DVec3>) -> Self {
        let first = hodograph(&control);
        let second = hodograph(&first);
        Self { control, first, second }
    }

    pub(super) fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// The box of the control points, which holds the curve.
    pub(super) fn hull(&self) -> Aabb {
        Aabb::from_points(self.control.iter().copied())
    }

    pub(super) fn point(&self, t: f64) -> DVec3 {
        de_casteljau(&self.control, t)
    }
}

/// Control points of the derivative.
fn hodograph(control: &[DVec3]) -> Vec<DVec3> {
    let degree = control.len().saturating_sub(1) as f64;
    control.windows(2).map(|pair| (pair[1] - pair[0]) * degree).collect()
}

fn de_casteljau(control: &[DVec3], t: f64) -> DVec3 {
    if t == 1.0 {
        return control.last().copied().unwrap_or(DVec3::ZERO);
    }
    let mut small = [DVec3::ZERO; 8];
    let mut large = Vec::new();
    let points = match small.get_mut(..control.len()) {
        Some(points) => points,
        None => {
            large.resize(control.len(), DVec3::ZERO);
            &mut large[..]
        }
    };
    points.copy_from_slice(control);
    for count in (1..points.len()).rev() {
        for i in 0..count {
            points[i] = points[i] * (1.0 - t) + points[i + 1] * t;
        }
    }
    points.first().copied().unwrap_or(DVec3::ZERO)
}

/// How many equal steps of the parameter keep the chords within a tolerance of the curve: a chord over a step h lies within
/// h² / 8 of the largest second derivative, which is at most that of its control points (Filip, Magedson and Markot, 1986). None
/// where the count is not representable.
pub(super) fn flatten(piece: &Piece, tolerance: f64) -> Option<usize> {
    let bend = piece.second.iter().map(|point| point.length()).fold(0.0, f64::max);
    let count = (bend / (8.0 * tolerance)).sqrt().ceil().max(1.0);
    (count < 1e9).then_some(count as usize)
}

/// The point of the curve nearest to `point`, sought from `place` within the chord over [from, to], and a chord's length beyond it.
///
/// Newton's method on the derivative of the squared distance; a step that leads farther away ends it.
pub(super) fn closest_near(piece: &Piece, point: DVec3, from: f64, to: f64, place: f64) -> DVec3 {
    let step = to - from;
    let (least, most) = ((from - step).max(0.0), (to + step).min(1.0));
    let mut t = from + step * place;
    let mut nearest = piece.point(t);
    let mut distance = nearest.distance_squared(point);
    for _ in 0..8 {
        let away = nearest - point;
        let along = de_casteljau(&piece.first, t);
        let bend = de_casteljau(&piece.second, t);
        let slope = away.dot(along);
        let curvature = along.length_squared() + away.dot(bend);
        if curvature <= 0.0 || curvature.is_nan() {
            break;
        }
        let next = (t - slope / curvature).clamp(least, most);
        let candidate = piece.point(next);
        let found = candidate.distance_squared(point);
        if found >= distance || found.is_nan() {
            break;
        }
        (t, nearest, distance) = (next, candidate, found);
    }
    nearest
}
