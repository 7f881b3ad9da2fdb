//! Closest-point queries on the hierarchy.

use glam::DVec3;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_mm256_movemask_ps, _mm256_setr_ps};

use multiversion::multiversion;
use multiversion::target::match_target;
use shapeloom_core::{Closest, ClosestPoint, Exec, Stop};

use crate::TriangleBvh;
use crate::batch_order::{along_curve, answer_all};
use crate::stack::Stack;
use crate::triangle_block::{Block, RoughPlace};
use crate::triangle_point::{Foot, closest_on_triangle};
use crate::wide_node::{Lanes, Node, Signs, WIDTH, lanes_of, signs};

/// A child to be opened: a squared distance to its box, never too large, and what its node says in `first` and `place`.
type Open = (f32, u32, u32);

fn stack() -> Stack<Open> {
    Stack::new((0.0, 0, 0))
}

/// The best so far: the foot on a stored triangle, in scaled units.
#[derive(Clone, Copy)]
struct Best {
    foot: Foot,
    element: u32,
    corners: [DVec3; 3],
}

impl Best {
    fn key(&self) -> (f64, u32) {
        (self.foot.distance_squared, self.element)
    }
}

/// The closest point whose squared distance is at most `max_distance²`, by a walk that opens near boxes first. The
/// answer does not depend on `guess`, a triangle to start with; the better it is, the fewer boxes are opened.
#[inline(always)]
fn closest(
    bvh: &TriangleBvh,
    query: DVec3,
    max_distance: f64,
    guess: Option<Best>,
    open: &mut Stack<Open>,
    signs: impl Signs,
) -> Option<Best> {
    if !query.is_finite() || bvh.nodes.is_empty() || max_distance.is_nan() || max_distance < 0.0 {
        return None;
    }
    let units = &bvh.units;
    let query = query * units.per_unit;
    let local = query - units.center;
    // What rounding can do to the place of the query among the boxes.
    let slack = (query.abs().max_element() + units.center.abs().max_element()) * 2f64.powi(-48);
    let max_distance = max_distance * units.per_unit;
    let mut limit = max_distance * max_distance;
    if local.abs().max_element() > RoughPlace::FAR {
        return closest_from_far(bvh, query, limit, slack);
    }
    let mut best: Option<Best> = None;
    if let Some(guess) = guess {
        let foot = closest_on_triangle(&guess.corners, query);
        if foot.distance_squared <= limit {
            limit = foot.distance_squared;
            best = Some(Best { foot, ..guess });
        }
    }
    let mut rough = RoughPlace::new(local, units.center - units.block_origin(), slack);
    rough.set_limit(limit);
    open.clear();
    let mut next: Open = (0.0, 0, Node::INNER);
    loop {
        let (lower, first, place) = next;
        if lower > rough.limit {
        } else if place == Node::INNER {
            let node = &bvh.nodes[first as usize];
            let (lower, near) = rough.lower_bounds(node, signs);
            let child = |lane: usize| (lower[lane], node.first[lane], node.place[lane]);
            let mut lanes = lanes_of(near);
            if let Some(lane) = lanes.next() {
                next = child(lane);
                let bottom = open.len();
                for lane in lanes {
                    let mut other = child(lane);
                    if other.0 < next.0 {
                        std::mem::swap(&mut other, &mut next);
                    }
                    open.push_sorted(bottom, other, |a, b| a.0 > b.0);
                }
                continue;
            }
        } else {
            let block = &bvh.blocks[first as usize];
            for lane in lanes_of(block.may_be_within(&rough, signs)) {
                let corners = bvh.corners_at(block, place, lane);
                let foot = closest_on_triangle(&corners, query);
                let found = Best { foot, element: block.elements[lane], corners };
                let better = |best: &Best| found.key() < best.key();
                if foot.distance_squared <= limit && best.as_ref().is_none_or(better) {
                    limit = foot.distance_squared;
                    rough.set_limit(limit);
                    best = Some(found);
                }
            }
        }
        match open.pop() {
            Some(entry) => next = entry,
            None => return best,
        }
    }
}

/// The same from far away, where `f32` tells too little apart: boxes are measured in `f64`.
#[cold]
fn closest_from_far(bvh: &TriangleBvh, query: DVec3, mut limit: f64, slack: f64) -> Option<Best> {
    let local = query - bvh.units.center;
    let mut best: Option<Best> = None;
    let mut open: Stack<(f64, u32, u32)> = Stack::new((0.0, 0, 0));
    open.push((0.0, 0, Node::INNER));
    while let Some((lower, first, place)) = open.pop() {
        if lower > limit {
            continue;
        }
        if place == Node::INNER {
            let node = &bvh.nodes[first as usize];
            let bottom = open.len();
            for lane in (0..WIDTH).filter(|&lane| node.is_used(lane)) {
                let mut sum = 0.0;
                for axis in 0..3 {
                    let [low, high] = [0, 1].map(|side| f64::from(node.sides[side][axis][lane]));
                    let gap = ((low - local[axis]).max(local[axis] - high) - slack).max(0.0);
                    sum += gap * gap;
                }
                let lower = sum * (1.0 - 1e-14);
                if lower <= limit {
                    open.push_sorted(bottom, (lower, node.first[lane], node.place[lane]), |a, b| a.0 > b.0);
                }
            }
            continue;
        }
        let block = &bvh.blocks[first as usize];
        for lane in (0..WIDTH).filter(|&lane| block.elements[lane] != Block::NONE) {
            let corners = bvh.corners_at(block, place, lane);
            let found = Best { foot: closest_on_triangle(&corners, query), element: block.elements[lane], corners };
            let better = |best: &Best| found.key() < best.key();
            if found.foot.distance_squared <= limit && best.as_ref().is_none_or(better) {
                limit = found.foot.distance_squared;
                best = Some(found);
            }
        }
    }
    best
}

impl Best {
    fn answer(&self, unit: f64) -> Closest {
        Closest {
            point: self.foot.point * unit,
            distance_squared: self.foot.distance_squared * unit * unit,
            element: self.element,
            parameters: self.foot.weights,
        }
    }
}

// The same arithmetic for processors with and without wide registers: nothing is contracted, so the bits are the same.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn closest_points(bvh: &TriangleBvh, queries: &[DVec3], max_distance: f64, out: &mut [Option<Closest>]) {
    let signs = |lanes: &Lanes| {
        match_target! {
            "x86_64+avx" => {
                let [a, b, c, d, e, f, g, h] = *lanes;
                _mm256_movemask_ps(_mm256_setr_ps(a, b, c, d, e, f, g, h)) as u32
            }
            _ => signs(lanes),
        }
    };
    let mut open = stack();
    let mut guess = None;
    for (&query, out) in queries.iter().zip(out) {
        let best = closest(bvh, query, max_distance, guess, &mut open, signs);
        guess = best.or(guess);
        *out = best.map(|best| best.answer(bvh.units.unit));
    }
}

impl ClosestPoint for TriangleBvh {
    fn closest_within(&self, query: DVec3, max_distance: f64) -> Option<Closest> {
        let mut out = [None];
        closest_points(self, &[query], max_distance, &mut out);
        out[0]
    }

    /// The closest point to each query, in parallel. Queries are taken along a space-filling curve, each starting with
    /// the triangle that is closest to the one before; the answers stand in the order of the queries.
    fn closest_points(&self, queries: &[DVec3], out: &mut [Option<Closest>], exec: &Exec) -> Result<(), Stop> {
        let keys = |queries: &[DVec3], keys: &mut [u64]| {
            queries.iter().zip(keys).for_each(|(&query, key)| *key = along_curve(query, &self.units));
        };
        answer_all(queries, out, true, exec, keys, |queries, out| closest_points(self, queries, f64::INFINITY, out))
    }
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

    /// Blocks then hold the corners themselves.
    #[test]
    fn agrees_with_brute_force_on_coordinates_of_single_precision() {
        let mut draws = Draws::new(25);
        let narrow = |p: DVec3| p.as_vec3().as_dvec3();
        let (positions, triangles) =
            draws.soup(300, |draws, i| narrow(draws.point() * if i < 600 { 1.0 } else { 0.1 }));
        let queries: Vec<DVec3> = (0..600).map(|i| draws.point() * f64::from(1 + i % 9)).collect();
        assert_laws(&positions, &triangles, &queries);
    }

    #[test]
    fn agrees_with_brute_force_from_afar() {
        let mut draws = Draws::new(26);
        let (positions, triangles) = draws.soup(200, |draws, _| draws.point());
        let scales = [1e2, 9e2, 1e3, 1.1e3, 1e5, 1e9, 1e14, 1e30];
        let queries: Vec<DVec3> = (0..400).map(|i| draws.point() * scales[i % scales.len()]).collect();
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        for query in queries {
            assert_eq!(bvh.closest(query), Some(brute_force(&positions, &triangles, query)), "{query}");
        }
    }

    /// The versions for wide registers and the portable one give the same bits.
    #[test]
    fn every_processor_finds_the_same() {
        let (positions, triangles) = bumpy_ball(40, DVec3::ZERO, 1.0, 0.1);
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        let mut draws = Draws::new(27);
        for _ in 0..2000 {
            let query = draws.point() * 1.5;
            let portable = closest(&bvh, query, f64::INFINITY, None, &mut stack(), signs);
            assert_eq!(bvh.closest(query), portable.map(|best| best.answer(bvh.units.unit)));
        }
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
