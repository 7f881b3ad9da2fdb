//! Ray queries on the hierarchy.

use shapeloom_core::{Hit, Ray, Rays};

use crate::TriangleBvh;
use crate::hierarchy::{Node, WIDTH};
use crate::stack::Stack;
use crate::triangle_bvh::Units;
use crate::triangle_ray::{Crossing, Shear};

/// A ray against boxes: in local units, from a start close to the shape, in `f32` with room for every rounding.
struct Slabs {
    /// The start moved against and along the direction, by axis: the first makes boxes begin too early, the second end
    /// too late, by more than the start's and the boxes' coordinates can be off.
    early: [f32; 3],
    late: [f32; 3],
    inverse: [f32; 3],
    /// Which side of a box is met first, by axis.
    near: [usize; 3],
    slack: f64,
    /// The distance of the start along the ray, in scaled units.
    start: f64,
}

impl Slabs {
    fn new(ray: &Ray, units: &Units) -> Self {
        let direction = ray.direction();
        let origin = ray.origin() * units.per_unit - units.center;
        // The shape lies within the ball of radius 4 about the local origin.
        let start = (-origin.dot(direction) - 4.0).max(ray.reach.lo * units.per_unit);
        let from = origin + direction * start;
        let size = origin.abs().max_element() + units.center.abs().max_element() + start.abs();
        // 2^-21 covers f32 at magnitudes up to 4, 2^-46 the f64 arithmetic before, with a factor of 8 each.
        let slack = (2f64.powi(-21) + size * 2f64.powi(-46)).min(1e30);
        let mut slabs = Self { early: [0.0; 3], late: [0.0; 3], inverse: [0.0; 3], near: [0; 3], slack, start };
        for axis in 0..3 {
            let backward = direction[axis] < 0.0;
            let sign = if backward { -1.0 } else { 1.0 };
            // A direction of less than 1e-18 moves nothing within the shape; a finite inverse keeps NaN away.
            slabs.inverse[axis] = (sign / direction[axis].abs().max(1e-18)) as f32;
            slabs.near[axis] = usize::from(backward);
            slabs.early[axis] = (from[axis] + sign * slack).clamp(-1e30, 1e30) as f32;
            slabs.late[axis] = (from[axis] - sign * slack).clamp(-1e30, 1e30) as f32;
        }
        slabs
    }

    /// A distance along the ray, in scaled units, as one from the start, no less.
    fn limit(&self, distance: f64) -> f32 {
        ((distance - self.start) * (1.0 + 1e-6) + 2.0 * self.slack) as f32
    }

    /// Where the ray enters each box of a node, and which boxes it may meet before `limit`.
    #[inline]
    fn enter(&self, node: &Node, limit: f32) -> ([f32; WIDTH], [bool; WIDTH]) {
        let mut entry = [0f32; WIDTH];
        let mut exit = [limit; WIDTH];
        for axis in 0..3 {
            let first = &node.sides[self.near[axis]][axis];
            let last = &node.sides[1 - self.near[axis]][axis];
            let (early, late, inverse) = (self.early[axis], self.late[axis], self.inverse[axis]);
            for lane in 0..WIDTH {
                let begin = (first[lane] - early) * inverse;
                let end = (last[lane] - late) * inverse;
                entry[lane] = if begin > entry[lane] { begin } else { entry[lane] };
                exit[lane] = if end < exit[lane] { end } else { exit[lane] };
            }
        }
        // Ize: Robust BVH Ray Traversal, JCGT 2013: three roundings on either side.
        (entry, std::array::from_fn(|lane| entry[lane] <= exit[lane] * (1.0 + 1e-6)))
    }
}

impl TriangleBvh {
    /// Calls `visit` with the crossings within reach, near boxes first, until it says that it needs none beyond a
    /// distance in scaled units, and none at all where it says NaN.
    #[inline]
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(u32, Crossing) -> f64) {
        if self.nodes.is_empty() || ray.reach.is_empty() {
            return;
        }
        let units = &self.units;
        let slabs = Slabs::new(ray, units);
        let shear = Shear::new(ray.origin() * units.per_unit, ray.direction());
        let mut limit = slabs.limit(ray.reach.hi * units.per_unit);
        let mut open: Stack<(f32, u32, u32)> = Stack::new((0.0, 0, 0));
        open.push((0.0, 0, 0));
        while let Some((entry, first, count)) = open.pop() {
            if entry > limit {
                continue;
            }
            for place in first..first + count {
                let Some(crossing) = shear.cross(&self.corners[place as usize]) else { continue };
                let crossing = Crossing { distance: crossing.distance * units.unit, ..crossing };
                if ray.reach.contains(crossing.distance) {
                    let wanted = visit(place, crossing);
                    if wanted.is_nan() {
                        return;
                    }
                    limit = limit.min(slabs.limit(wanted * units.per_unit));
                }
            }
            if count > 0 {
                continue;
            }
            let node = &self.nodes[first as usize];
            let (entry, met) = slabs.enter(node, limit);
            let bottom = open.len();
            for lane in (0..WIDTH).filter(|&lane| met[lane]) {
                open.push_sorted(bottom, (entry[lane], node.first[lane], node.count[lane]), |a, b| a.0 > b.0);
            }
        }
    }
}

fn hit(element: u32, crossing: Crossing) -> Hit {
    Hit { distance: crossing.distance, element, parameters: crossing.weights, back: crossing.back }
}

impl Rays for TriangleBvh {
    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(ray, |place, crossing| {
            let found = hit(self.elements_at(place)[0], crossing);
            let better = |best: &Hit| (found.distance, found.element) < (best.distance, best.element);
            if best.as_ref().is_none_or(better) {
                best = Some(found);
            }
            best.map_or(f64::INFINITY, |best| best.distance)
        });
        best
    }

    /// Every hit within the ray's reach, by (distance, element). What `hits` held before is gone.
    fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.walk(ray, |place, crossing| {
            hits.extend(self.elements_at(place).iter().map(|&element| hit(element, crossing)));
            f64::INFINITY
        });
        hits.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.element.cmp(&b.element)));
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let mut met = false;
        self.walk(ray, |_, _| {
            met = true;
            f64::NAN
        });
        met
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Draws, bumpy_ball};
    use glam::DVec3;
    use shapeloom_core::{Exec, Interval};

    fn brute_force(positions: &[DVec3], triangles: &[[u32; 3]], ray: &Ray) -> Vec<Hit> {
        let shear = Shear::new(ray.origin(), ray.direction());
        let mut hits: Vec<Hit> = triangles
            .iter()
            .enumerate()
            .filter_map(|(i, corners)| {
                shear.cross(&corners.map(|c| positions[c as usize])).map(|crossing| hit(i as u32, crossing))
            })
            .filter(|hit| ray.reach.contains(hit.distance))
            .collect();
        hits.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.element.cmp(&b.element)));
        hits
    }

    fn assert_laws(positions: &[DVec3], triangles: &[[u32; 3]], rays: &[Ray]) -> usize {
        let bvh = TriangleBvh::build(positions, triangles, &Exec::default()).unwrap();
        let mut hits = Vec::new();
        let mut met = 0;
        for ray in rays {
            // Scaling by powers of two is exact, so answers agree to the bit.
            let wanted = brute_force(positions, triangles, ray);
            bvh.all_hits(ray, &mut hits);
            assert_eq!(hits, wanted, "{ray:?}");
            assert_eq!(bvh.first_hit(ray), wanted.first().copied(), "{ray:?}");
            assert_eq!(bvh.any_hit(ray), !wanted.is_empty(), "{ray:?}");
            met += wanted.len();
        }
        let mut batch = vec![None; rays.len()];
        bvh.first_hits(rays, &mut batch, &Exec::default()).unwrap();
        assert!(rays.iter().zip(&batch).all(|(ray, hit)| *hit == bvh.first_hit(ray)));
        met
    }

    #[test]
    fn agrees_with_brute_force_on_random_triangles() {
        let mut draws = Draws::new(1);
        for center in [DVec3::ZERO, DVec3::new(5e6, -3e6, 4.2e6)] {
            let mut middle = DVec3::ZERO;
            let (positions, triangles) = draws.soup(400, |draws, i| {
                if i % 3 == 0 {
                    middle = draws.point();
                }
                center + middle + draws.point() * 0.3
            });
            let rays: Vec<Ray> = (0..600)
                .map(|i| {
                    let ray = Ray::new(center + draws.point() * 1.5, draws.point()).unwrap();
                    if i % 3 == 0 { ray.within(Interval::new(-0.5, 0.7)) } else { ray }
                })
                .collect();
            assert!(assert_laws(&positions, &triangles, &rays) > 300);
        }
    }

    #[test]
    fn agrees_with_brute_force_where_everything_ties() {
        let mut draws = Draws::new(2);
        let (positions, triangles) = draws.soup(300, |draws, _| draws.lattice(3));
        let mut rays = Vec::new();
        while rays.len() < 3000 {
            let origin = draws.lattice(4) - DVec3::ONE * 0.5 * (draws.next() % 2) as f64;
            let Ok(ray) = Ray::new(origin, draws.lattice(2) - DVec3::ONE) else { continue };
            rays.push(if draws.next().is_multiple_of(2) { ray.within(Interval::new(0.0, 2.0)) } else { ray });
        }
        assert!(assert_laws(&positions, &triangles, &rays) > 10_000);
    }

    #[test]
    fn far_origins_and_wild_reaches_are_kept() {
        let (positions, triangles) = bumpy_ball(12, DVec3::ZERO, 1.0, 0.1);
        let mut draws = Draws::new(4);
        let mut rays = Vec::new();
        for far in [1e3, 1e9, 1e15, 1e100, 1e300] {
            for _ in 0..50 {
                let direction = draws.point().normalize();
                rays.push(Ray::new(direction * -far + draws.point() * 0.5, direction).unwrap());
            }
        }
        for reach in [
            Interval::ALL,
            Interval::new(f64::NEG_INFINITY, 0.0),
            Interval::new(f64::NAN, 1.0),
            Interval::new(0.0, f64::NAN),
            Interval::new(3.0, 2.0),
            Interval::new(f64::INFINITY, f64::INFINITY),
        ] {
            rays.push(Ray::new(DVec3::splat(0.1), DVec3::X).unwrap().within(reach));
        }
        assert_laws(&positions, &triangles, &rays);
    }

    /// From inside a closed mesh every ray gets out: none slips through a side, a corner or between boxes.
    #[test]
    fn a_closed_mesh_does_not_leak() {
        for center in [DVec3::ZERO, DVec3::new(5e6, -3e6, 4.2e6)] {
            let (positions, triangles) = bumpy_ball(60, center, 1.0, 0.05);
            let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
            let mut draws = Draws::new(9);
            let mut hits = Vec::new();
            for round in 0..6 {
                let eye = center + if round == 0 { DVec3::ZERO } else { draws.point() * 0.3 };
                for triangle in &triangles {
                    let [a, b, _] = triangle.map(|c| positions[c as usize]);
                    for target in [a, a + (b - a) * 0.5, a + (b - a) * (0.5 + 0.5 * draws.signed())] {
                        let ray = Ray::new(eye, target - eye).unwrap();
                        let first = bvh.first_hit(&ray).expect("no way out");
                        assert!(bvh.any_hit(&ray));
                        // From elsewhere bumps hide each other, and a ray may graze their outlines.
                        let error = first.distance - (target - eye).length();
                        assert!(round > 0 || first.back && error.abs() < 1e-6);
                        bvh.all_hits(&ray, &mut hits);
                        assert!(!hits.is_empty());
                    }
                }
            }
        }
    }

    /// Axis-parallel rays between lattice points through corners, sides and along faces of a cube.
    #[test]
    fn a_cube_on_the_lattice_does_not_leak() {
        let positions: Vec<DVec3> =
            (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        for x in -10..=10 {
            for y in -10..=10 {
                for z in -10..=10 {
                    let direction = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                    let Ok(ray) = Ray::new(DVec3::ONE, direction) else { continue };
                    let hit = bvh.first_hit(&ray).expect("no way out");
                    let wanted = direction.length() / direction.abs().max_element();
                    assert!(hit.back && (hit.distance - wanted).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn batches_do_not_depend_on_threads() {
        let (positions, triangles) = bumpy_ball(20, DVec3::ZERO, 1.0, 0.1);
        let mut draws = Draws::new(6);
        let rays: Vec<Ray> = (0..2000).map(|_| Ray::new(draws.point() * 2.0, draws.point()).unwrap()).collect();
        let answers = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let exec = Exec::default();
                let bvh = TriangleBvh::build(&positions, &triangles, &exec).unwrap();
                let mut out = vec![None; rays.len()];
                bvh.first_hits(&rays, &mut out, &exec).unwrap();
                out
            })
        });
        assert!(answers[0] == answers[1] && answers[1] == answers[2]);
    }
}
