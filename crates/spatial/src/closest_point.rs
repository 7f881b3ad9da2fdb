//! Closest-point queries on the hierarchy.

use glam::DVec3;
use shapeloom_core::{Closest, ClosestPoint};

use crate::TriangleBvh;
use crate::hierarchy::{Node, WIDTH};
use crate::stack::Stack;
use crate::triangle_point::closest_on_triangle;

impl ClosestPoint for TriangleBvh {
    /// The closest point whose squared distance is at most `max_distance²`, by a walk that opens near boxes first.
    fn closest_within(&self, query: DVec3, max_distance: f64) -> Option<Closest> {
        if !query.is_finite() || self.nodes.is_empty() || max_distance.is_nan() || max_distance < 0.0 {
            return None;
        }
        let units = &self.units;
        let query = query * units.per_unit;
        let local = query - units.center;
        // What rounding can do to the place of the query among the boxes.
        let slack = (query.abs().max_element() + units.center.abs().max_element()) * 2f64.powi(-48);
        let max_distance = max_distance * units.per_unit;
        let mut limit = max_distance * max_distance;
        let mut best: Option<Closest> = None;
        let mut open: Stack<(f64, u32, u32)> = Stack::new((0.0, 0, 0));
        open.push((0.0, 0, 0));
        while let Some((lower, first, count)) = open.pop() {
            if lower > limit {
                continue;
            }
            for place in first..first + count {
                let foot = closest_on_triangle(&self.corners[place as usize], query);
                let found = Closest {
                    point: foot.point,
                    distance_squared: foot.distance_squared,
                    element: self.elements_at(place)[0],
                    parameters: foot.weights,
                };
                let key = |closest: &Closest| (closest.distance_squared, closest.element);
                if found.distance_squared <= limit && best.as_ref().is_none_or(|best| key(&found) < key(best)) {
                    limit = found.distance_squared;
                    best = Some(found);
                }
            }
            if count > 0 {
                continue;
            }
            let node = &self.nodes[first as usize];
            let lower = lower_bounds(node, local, slack);
            let bottom = open.len();
            for lane in (0..WIDTH).filter(|&lane| lower[lane] <= limit) {
                open.push_sorted(bottom, (lower[lane], node.first[lane], node.count[lane]), |a, b| a.0 > b.0);
            }
        }
        best.map(|best| Closest {
            point: best.point * units.unit,
            distance_squared: best.distance_squared * units.unit * units.unit,
            ..best
        })
    }
}

/// Squared distances to the boxes of a node, never too large.
fn lower_bounds(node: &Node, local: DVec3, slack: f64) -> [f64; WIDTH] {
    std::array::from_fn(|lane| {
        if node.sides[0][0][lane] > node.sides[1][0][lane] {
            return f64::NAN;
        }
        let mut sum = 0.0;
        for axis in 0..3 {
            let [low, high] = [0, 1].map(|side| f64::from(node.sides[side][axis][lane]));
            let gap = ((low - local[axis]).max(local[axis] - high) - slack).max(0.0);
            sum += gap * gap;
        }
        sum * (1.0 - 1e-14)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Draws, bumpy_ball};
    use shapeloom_core::Exec;

    fn brute_force(positions: &[DVec3], triangles: &[[u32; 3]], query: DVec3) -> Closest {
        let mut best: Option<Closest> = None;
        for (element, corners) in triangles.iter().enumerate() {
            let foot = closest_on_triangle(&corners.map(|c| positions[c as usize]), query);
            if best.is_none_or(|best| foot.distance_squared < best.distance_squared) {
                best = Some(Closest {
                    point: foot.point,
                    distance_squared: foot.distance_squared,
                    element: element as u32,
                    parameters: foot.weights,
                });
            }
        }
        best.expect("triangles")
    }

    fn assert_laws(positions: &[DVec3], triangles: &[[u32; 3]], queries: &[DVec3]) {
        let bvh = TriangleBvh::build(positions, triangles, &Exec::default()).unwrap();
        for &query in queries {
            let wanted = brute_force(positions, triangles, query);
            let found = bvh.closest(query).unwrap();
            assert_eq!(found, wanted, "{query}");
            let [a, b, c] = triangles[found.element as usize].map(|c| positions[c as usize]);
            let on_element = a + (b - a) * found.parameters.x + (c - a) * found.parameters.y;
            assert!((on_element - found.point).length() <= 1e-14 * (1.0 + a.length()));
            let distance = found.distance_squared.sqrt();
            assert_eq!(bvh.closest_within(query, distance * (1.0 + 1e-12)), Some(found));
            if distance > 0.0 {
                assert_eq!(bvh.closest_within(query, distance * (1.0 - 1e-12)), None);
            }
        }
        let mut batch = vec![None; queries.len()];
        bvh.closest_points(queries, &mut batch, &Exec::default()).unwrap();
        assert!(queries.iter().zip(&batch).all(|(&query, closest)| *closest == bvh.closest(query)));
    }

    #[test]
    fn agrees_with_brute_force_on_random_triangles() {
        let mut draws = Draws::new(21);
        for center in [DVec3::ZERO, DVec3::new(5e6, -3e6, 4.2e6)] {
            let (positions, triangles) = draws.soup(300, |draws, _| center + draws.point());
            let far: Vec<DVec3> = (0..400).map(|i| center + draws.point() * f64::from(1 + i % 9)).collect();
            assert_laws(&positions, &triangles, &far);
        }
        let (positions, triangles) = bumpy_ball(16, DVec3::ZERO, 1.0, 0.1);
        let queries: Vec<DVec3> = (0..400).map(|_| draws.point() * 1.2).collect();
        assert_laws(&positions, &triangles, &queries);
    }

    #[test]
    fn agrees_with_brute_force_where_everything_ties() {
        let mut draws = Draws::new(22);
        let (positions, triangles) = draws.soup(300, |draws, _| draws.lattice(4));
        let queries: Vec<DVec3> = (0..1000).map(|_| draws.lattice(12) * 0.5 - DVec3::ONE).collect();
        assert_laws(&positions, &triangles, &queries);
    }

    #[test]
    fn wild_queries_have_no_answer_or_a_true_one() {
        let (positions, triangles) = bumpy_ball(6, DVec3::ZERO, 1.0, 0.1);
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        for query in [DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NEG_INFINITY, 0.0)] {
            assert_eq!(bvh.closest(query), None);
        }
        for distance in [f64::NAN, -1.0, f64::NEG_INFINITY, 0.0] {
            assert_eq!(bvh.closest_within(DVec3::ZERO, distance), None);
        }
        assert!(bvh.closest(DVec3::splat(1e300)).is_some());
        assert_eq!(bvh.closest_within(positions[3], 0.0).unwrap().point, positions[3]);
    }
}
