//! Ray queries on the hierarchy.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_mm256_movemask_ps, _mm256_setr_ps};

use multiversion::multiversion;
use multiversion::target::match_target;
use shapeloom_core::{Exec, Hit, Ray, Rays, Stop};

use crate::TriangleBvh;
use crate::batch_order::{answer_all, together};
use crate::stack::Stack;
use crate::triangle_block::RoughShear;
use crate::triangle_ray::{Crossing, Shear};
use crate::wide_node::{Lanes, Node, Signs, Slabs, lanes_of, signs};

/// A child to be opened: where the ray enters its box, and what [`Node::first`] and [`Node::place`] say.
type Open = (f32, u32, u32);

fn stack() -> Stack<Open> {
    Stack::new((0.0, 0, 0))
}

/// Calls `visit` with the element, the place and the crossing of each stored triangle within reach, near boxes first,
/// until it says that it needs none beyond a distance in model units, and none at all where it says NaN.
#[inline(always)]
fn walk(
    bvh: &TriangleBvh,
    ray: &Ray,
    open: &mut Stack<Open>,
    signs: impl Signs,
    mut visit: impl FnMut(u32, Crossing) -> f64,
) {
    if bvh.nodes.is_empty() || ray.reach.is_empty() {
        return;
    }
    let units = &bvh.units;
    let slabs = Slabs::new(ray, units);
    let shear = Shear::new(ray.origin() * units.per_unit, ray.direction());
    let rough = RoughShear::new(&slabs, &shear, units.center - units.block_origin());
    let mut limit = slabs.limit(ray.reach.hi * units.per_unit);
    open.clear();
    let (mut first, mut place) = (0, Node::INNER);
    loop {
        if place == Node::INNER {
            let node = &bvh.nodes[first as usize];
            let (entry, met) = slabs.enter(node, limit, signs);
            let child = |lane: usize| (entry[lane], node.first[lane], node.place[lane]);
            let mut lanes = lanes_of(met);
            if let Some(lane) = lanes.next() {
                let mut next: Open = child(lane);
                let bottom = open.len();
                for lane in lanes {
                    let mut other = child(lane);
                    if other.0 < next.0 {
                        std::mem::swap(&mut other, &mut next);
                    }
                    open.push_sorted(bottom, other, |a, b| a.0 > b.0);
                }
                (_, first, place) = next;
                continue;
            }
        } else {
            let block = &bvh.blocks[first as usize];
            for lane in lanes_of(block.may_cross(&rough, signs)) {
                let Some(crossing) = shear.cross(&bvh.corners_at(block, place, lane)) else { continue };
                let crossing = Crossing { distance: crossing.distance * units.unit, ..crossing };
                if ray.reach.contains(crossing.distance) {
                    let wanted = visit(block.elements[lane], crossing);
                    if wanted.is_nan() {
                        return;
                    }
                    let wanted = slabs.limit(wanted * units.per_unit);
                    limit = if wanted < limit { wanted } else { limit };
                }
            }
        }
        loop {
            let Some(next) = open.pop() else { return };
            if next.0 <= limit {
                (_, first, place) = next;
                break;
            }
        }
    }
}

fn hit(element: u32, crossing: Crossing) -> Hit {
    Hit { distance: crossing.distance, element, parameters: crossing.weights, back: crossing.back }
}

#[inline(always)]
fn first_hit(bvh: &TriangleBvh, ray: &Ray, open: &mut Stack<Open>, signs: impl Signs) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    walk(bvh, ray, open, signs, |element, crossing| {
        let found = hit(element, crossing);
        let better = |best: &Hit| (found.distance, found.element) < (best.distance, best.element);
        if best.as_ref().is_none_or(better) {
            best = Some(found);
        }
        best.map_or(f64::INFINITY, |best| best.distance)
    });
    best
}

#[inline(always)]
fn any_hit(bvh: &TriangleBvh, ray: &Ray, open: &mut Stack<Open>, signs: impl Signs) -> bool {
    let mut met = false;
    walk(bvh, ray, open, signs, |_, _| {
        met = true;
        f64::NAN
    });
    met
}

// The same arithmetic for processors with and without wide registers: nothing is contracted, so the bits are the same.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn first_hits(bvh: &TriangleBvh, rays: &[Ray], out: &mut [Option<Hit>]) {
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
    for (ray, out) in rays.iter().zip(out) {
        *out = first_hit(bvh, ray, &mut open, signs);
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn any_hits(bvh: &TriangleBvh, rays: &[Ray], out: &mut [bool]) {
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
    for (ray, out) in rays.iter().zip(out) {
        *out = any_hit(bvh, ray, &mut open, signs);
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn all_hits(bvh: &TriangleBvh, ray: &Ray, hits: &mut Vec<Hit>) {
    let signs = |lanes: &Lanes| {
        match_target! {
            "x86_64+avx" => {
                let [a, b, c, d, e, f, g, h] = *lanes;
                _mm256_movemask_ps(_mm256_setr_ps(a, b, c, d, e, f, g, h)) as u32
            }
            _ => signs(lanes),
        }
    };
    walk(bvh, ray, &mut stack(), signs, |element, crossing| {
        hits.push(hit(element, crossing));
        hits.extend(bvh.twins_of(element).map(|twin| hit(twin, crossing)));
        f64::INFINITY
    });
}

/// A number for each ray that tells where it comes to the shape: the boxes that it enters first, down some levels.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn approach(bvh: &TriangleBvh, rays: &[Ray], keys: &mut [u64]) {
    /// Boxes at this depth hold some hundred triangles of a million, and the nodes down to it stay in the caches.
    const LEVELS: u32 = 4;
    if bvh.nodes.is_empty() {
        return;
    }
    for (ray, key) in rays.iter().zip(keys) {
        let slabs = Slabs::new(ray, &bvh.units);
        let limit = slabs.limit(ray.reach.hi * bvh.units.per_unit);
        let (mut node, mut path) = (0, 0);
        for level in 1..=LEVELS {
            let children = &bvh.nodes[node as usize];
            let Some(lane) = slabs.nearest(children, limit) else { break };
            path |= (lane as u64 + 1) << (4 * (LEVELS - level));
            node = children.first[lane];
            if children.place[lane] != Node::INNER {
                break;
            }
        }
        *key = path;
    }
}

impl Rays for TriangleBvh {
    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut out = [None];
        first_hits(self, std::slice::from_ref(ray), &mut out);
        out[0]
    }

    /// Every hit within the ray's reach, by (distance, element). What `hits` held before is gone.
    fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        all_hits(self, ray, hits);
        hits.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.element.cmp(&b.element)));
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let mut out = [false];
        any_hits(self, std::slice::from_ref(ray), &mut out);
        out[0]
    }

    /// The first hit of each ray, in parallel. Scattered rays are taken in an order in which neighbours meet the same
    /// boxes, as memory is slower than arithmetic; the answers stand in the order of the rays.
    fn first_hits(&self, rays: &[Ray], out: &mut [Option<Hit>], exec: &Exec) -> Result<(), Stop> {
        let keys = |rays: &[Ray], keys: &mut [u64]| approach(self, rays, keys);
        answer_all(rays, out, !together(rays, near), exec, keys, |rays, out| first_hits(self, rays, out))
    }

    /// Whether each ray has a hit, in parallel and in an order as for first hits.
    fn any_hits(&self, rays: &[Ray], out: &mut [bool], exec: &Exec) -> Result<(), Stop> {
        let keys = |rays: &[Ray], keys: &mut [u64]| approach(self, rays, keys);
        answer_all(rays, out, !together(rays, near), exec, keys, |rays, out| any_hits(self, rays, out))
    }
}

/// Whether rays run side by side, as those of a camera.
fn near(a: &Ray, b: &Ray) -> bool {
    let turn = (a.direction() - b.direction()).length_squared();
    turn < 1e-4 && a.origin() == b.origin() || turn == 0.0
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
        let mut any = vec![false; rays.len()];
        bvh.any_hits(rays, &mut any, &Exec::default()).unwrap();
        assert!(batch.iter().zip(&any).all(|(hit, &any)| hit.is_some() == any));
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

    /// Blocks then hold the corners themselves.
    #[test]
    fn agrees_with_brute_force_on_coordinates_of_single_precision() {
        let mut draws = Draws::new(3);
        let narrow = |p: DVec3| p.as_vec3().as_dvec3();
        let mut middle = DVec3::ZERO;
        let (positions, triangles) = draws.soup(400, |draws, i| {
            if i % 3 == 0 {
                middle = draws.point();
            }
            narrow(middle + draws.point() * 0.3)
        });
        let aim = |draws: &mut Draws| positions[draws.next() as usize % positions.len()];
        let mut rays = Vec::new();
        for i in 0..900 {
            let origin = if i % 2 == 0 { draws.point() * 3.0 } else { narrow(draws.point()) };
            let target = (aim(&mut draws) + aim(&mut draws) * f64::from(i % 3)) / f64::from(1 + i % 3);
            rays.push(Ray::new(origin, target - origin).unwrap());
        }
        assert!(assert_laws(&positions, &triangles, &rays) > 1000);
    }

    /// The versions for wide registers and the portable one give the same bits.
    #[test]
    fn every_processor_finds_the_same() {
        let (positions, triangles) = bumpy_ball(40, DVec3::ZERO, 1.0, 0.1);
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        let mut draws = Draws::new(27);
        for _ in 0..2000 {
            let ray = Ray::new(draws.point() * 2.0, draws.point()).unwrap();
            assert_eq!(bvh.first_hit(&ray), first_hit(&bvh, &ray, &mut stack(), signs));
            assert_eq!(bvh.any_hit(&ray), any_hit(&bvh, &ray, &mut stack(), signs));
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
