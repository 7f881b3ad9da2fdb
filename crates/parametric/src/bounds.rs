//! Tight boxes around curves and patches.

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

use crate::de_casteljau;

/// How far the box may be from tight, relative to its size.
const SLACK: f64 = 1e-9;

/// The deepest subdivision. Each level quarters the distance of a hull from its surface, so that 20 would do; more guard
/// against nets of extreme proportions.
const MAX_DEPTH: u32 = 64;

/// The box around Bézier nets, each given with its width; a curve is a net of one row.
///
/// Corners of a net lie on its surface, so their box is inside the true one; the hull of a net is outside it. Nets whose
/// hull reaches beyond the box known so far are split until it does not.
///
/// Cost: bounded, see the budget inside; a handful of splits for each of six directions in practice.
pub(crate) fn tight_bounds<'a>(nets: impl IntoIterator<Item = (usize, &'a [DVec3])> + Clone) -> Aabb {
    let corners = |width: usize, net: &[DVec3]| {
        let last = net.len() - 1;
        [net[0], net[width - 1], net[last + 1 - width], net[last]]
    };
    let known = nets.clone().into_iter().flat_map(|(width, net)| corners(width, net));
    let mut inner = Aabb::from_points(known);
    let mut outer = inner;
    let hulls =
        nets.clone().into_iter().map(|(_, net)| Aabb::from_points(net.iter().copied())).fold(inner, Aabb::union);
    let slack = SLACK * hulls.diagonal();
    // Nets of very high degree take long to split: past this much work hulls are taken as they are, which is safe.
    let points: usize = nets.clone().into_iter().map(|(_, net)| net.len()).sum();
    let mut budget = (1usize << 28) + 1024 * points;
    let mut stack: Vec<(u32, usize, Vec<DVec3>)> = Vec::new();
    for (width, net) in nets {
        stack.push((0, width, net.to_vec()));
        while let Some((depth, width, net)) = stack.pop() {
            inner = corners(width, &net).into_iter().fold(inner, Aabb::including);
            let hull = Aabb::from_points(net.iter().copied());
            let room = inner.padded(slack);
            let work = net.len() * (width + net.len() / width);
            if depth >= MAX_DEPTH || work > budget || (room.contains(hull.min) && room.contains(hull.max)) {
                outer = outer.union(hull);
                continue;
            }
            budget -= work;
            let (width, after) = split(width, net, &mut stack, depth);
            stack.push((depth + 1, width, after));
        }
    }
    outer.union(inner)
}

/// Splits a net in the middle of its longer direction; pushes one half and returns the other.
fn split(
    width: usize,
    mut net: Vec<DVec3>,
    stack: &mut Vec<(u32, usize, Vec<DVec3>)>,
    depth: u32,
) -> (usize, Vec<DVec3>) {
    let height = net.len() / width;
    let along: f64 = net.chunks_exact(width).flat_map(|row| row.windows(2)).map(|w| w[0].distance(w[1])).sum();
    let across: f64 = (width..net.len()).map(|k| net[k].distance(net[k - width])).sum();
    // The mean length of rows against that of columns.
    if along * width as f64 >= across * height as f64 {
        let mut after = Vec::with_capacity(net.len());
        for row in net.chunks_exact_mut(width) {
            after.extend(de_casteljau::split(row, 0.5));
        }
        stack.push((depth + 1, width, net));
        (width, after)
    } else {
        let mut after = net.clone();
        for i in 0..width {
            let mut column: Vec<DVec3> = net.iter().skip(i).step_by(width).copied().collect();
            let rest = de_casteljau::split(&mut column, 0.5);
            for j in 0..height {
                net[j * width + i] = column[j];
                after[j * width + i] = rest[j];
            }
        }
        stack.push((depth + 1, width, net));
        (width, after)
    }
}

#[cfg(test)]
mod tests {
    use crate::{BezierCurve, BezierPatch, BezierSurface};
    use shapeloom_core::Aabb;
    use shapeloom_core::glam::DVec3;

    #[test]
    fn a_parabola_has_its_own_height_not_that_of_its_hull() {
        let curve = BezierCurve::try_new(vec![DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0), DVec3::X * 2.0]).unwrap();
        let bounds = curve.bounds();
        assert!(bounds.max.y >= 1.0 && bounds.max.y < 1.0 + 1e-8);
        assert_eq!((curve.hull_bounds().max.y, bounds.max.x), (2.0, 2.0));
    }

    #[test]
    fn a_bulge_has_its_own_height() {
        let net = (0..9).map(|k| DVec3::new(f64::from(k % 3), f64::from(k / 3), f64::from(u8::from(k == 4)) * 4.0));
        let patch = BezierPatch::try_new(2, 2, net.collect()).unwrap();
        let bounds = BezierSurface::new(vec![patch.clone(), patch]).bounds();
        // B₁² takes 1/2 in the middle of each direction: 4/4.
        assert!(bounds.max.z >= 1.0 && bounds.max.z < 1.0 + 1e-8, "{}", bounds.max.z);
        assert_eq!(BezierSurface::default().bounds(), Aabb::EMPTY);
    }
}
