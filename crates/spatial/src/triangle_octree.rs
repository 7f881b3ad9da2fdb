//! An octree over triangles.

use std::fmt;

use glam::DVec3;
use shapeloom_core::{Aabb, Exec, Hit, Ray, Rays, Reservation};

use crate::BvhError;
use crate::scaled_input::{Units, checked_bounds};
use crate::triangle_box::triangle_meets_box;
use crate::triangle_ray::Shear;

/// Triangles in a leaf that is not cut any more.
const LEAF: usize = 8;
/// The deepest octants. Deeper ones are 2^-16 of the shape.
const DEPTH: u32 = 16;
/// References for each triangle at most, on average: a heap of triangles that all meet in each octant would never be
/// cut small.
const REFERENCES: usize = 8;
/// What stands for the number of triangles of an octant that is cut.
const CUT: u32 = u32::MAX;
/// Octants between two polls.
const POLL: usize = 256;

/// An octant: eight children from `first` on, or the triangles that meet it.
#[derive(Clone, Copy, Debug)]
struct Node {
    first: u32,
    count: u32,
}

/// An octree over triangles, for rays and boxes.
///
/// Every leaf names all triangles that meet its octant, decided exactly; an octant of more than 8 is cut, down to 2^-16
/// of the shape, as long as there are fewer than 8 references for each triangle. Answers are those of
/// [`TriangleBvh`](crate::TriangleBvh), to the bit: rays are decided by the same watertight test on the same scaled
/// coordinates, and boxes exactly.
///
/// For what it is good beside the hierarchy: octants do not depend on the triangles, so two trees over one cube walk
/// side by side, and coarse levels say where anything is. For rays the hierarchy is faster and smaller. Memory: 104 to
/// 136 bytes a triangle, reserved as long as the tree lives.
pub struct TriangleOctree {
    nodes: Vec<Node>,
    references: Vec<u32>,
    corners: Vec<[DVec3; 3]>,
    bounds: Aabb,
    units: Units,
    root: Octant,
    _memory: Reservation,
}

/// The cube of an octant, in scaled units.
#[derive(Clone, Copy, Debug)]
struct Octant {
    center: DVec3,
    half: f64,
}

impl Octant {
    fn child(self, child: usize) -> Self {
        let half = self.half * 0.5;
        let side = |axis: usize| if child >> axis & 1 == 1 { half } else { -half };
        Self { center: self.center + DVec3::new(side(0), side(1), side(2)), half }
    }

    fn padded(self, margin: f64) -> Aabb {
        let half = DVec3::splat(self.half + margin);
        Aabb { min: self.center - half, max: self.center + half }
    }
}

/// Children's cubes reach over their common sides by this part of the root, so that rounding leaves no gap.
const OVERLAP: f64 = 1e-15;

impl TriangleOctree {
    /// Builds the tree over `triangles`, index triples into `positions`. On one thread.
    ///
    /// # Errors
    /// An index out of range, a corner that is not finite, more than `u32::MAX / 8` triangles, too little memory in the
    /// budget, or the reason to stop.
    pub fn build(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<Self, BvhError> {
        exec.check()?;
        let bounds = checked_bounds(positions, triangles, exec)?;
        let most = triangles.len().saturating_mul(REFERENCES).max(64);
        if most > u32::MAX as usize {
            return Err(BvhError::TooMany { found: triangles.len() });
        }
        let _building = exec.reserve_elements(most as u64, 2 * size_of::<u32>())?;
        let memory = exec.reserve_elements(
            triangles.len() as u64,
            size_of::<[DVec3; 3]>() + REFERENCES * size_of::<u32>() + 4 * size_of::<Node>(),
        )?;
        let units = Units::new(&bounds);
        let scaled = |vertex: u32| positions[vertex as usize] * units.per_unit;
        let corners: Vec<[DVec3; 3]> = triangles.iter().map(|triangle| triangle.map(scaled)).collect();
        let reach = corners.as_flattened().iter().map(|&p| (p - units.center).abs().max_element()).fold(0.0, f64::max);
        let root = Octant { center: units.center, half: (reach * (1.0 + 1e-12)).max(f64::MIN_POSITIVE) };
        let mut tree =
            Self { nodes: Vec::new(), references: Vec::new(), corners, bounds, units, root, _memory: memory };
        tree.cut(most, exec)?;
        exec.progress(1.0);
        Ok(tree)
    }

    /// Level by level, so that what room there is for references goes to all parts alike.
    fn cut(&mut self, most: usize, exec: &Exec) -> Result<(), BvhError> {
        // Where octants meet boxes of the outside world both are rounded: see `reach`.
        let margin = self.slack();
        self.nodes.push(Node { first: 0, count: CUT });
        let mut level: Vec<(usize, Octant, Vec<u32>)> = vec![(0, self.root, (0..self.corners.len() as u32).collect())];
        let mut total = self.corners.len();
        let mut polled = 0usize;
        for depth in 0..=DEPTH {
            exec.progress(f64::from(depth) / f64::from(DEPTH));
            let mut next = Vec::new();
            for (node, octant, inside) in level {
                polled += 1 + inside.len() / 64;
                if polled >= POLL {
                    polled = 0;
                    exec.check()?;
                }
                let room = total + 7 * inside.len() <= most;
                // A node is 8 bytes: at most half as many as there are references.
                if inside.len() <= LEAF || depth == DEPTH || !room || self.nodes.len() + 8 > most / 2 {
                    self.nodes[node] = Node { first: self.references.len() as u32, count: inside.len() as u32 };
                    self.references.extend(inside);
                    continue;
                }
                total -= inside.len();
                let first = self.nodes.len();
                self.nodes[node] = Node { first: first as u32, count: CUT };
                for child in 0..8 {
                    let octant = octant.child(child);
                    let region = octant.padded(margin);
                    let meets = |&&triangle: &&u32| triangle_meets_box(&self.corners[triangle as usize], &region);
                    let kept: Vec<u32> = inside.iter().filter(meets).copied().collect();
                    total += kept.len();
                    self.nodes.push(Node { first: 0, count: CUT });
                    next.push((first + child, octant, kept));
                }
            }
            level = next;
        }
        Ok(())
    }

    fn slack(&self) -> f64 {
        OVERLAP * (self.root.half + self.root.center.abs().max_element())
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The box around the triangles; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many octants there are, and how many references to triangles.
    pub fn counts(&self) -> [usize; 2] {
        [self.nodes.len(), self.references.len()]
    }

    /// The memory that the tree takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.references.as_slice())
            + size_of_val(self.corners.as_slice())
    }

    /// Every triangle that has a point in common with a box, rising; decided exactly, touching counts. What `found`
    /// held before is gone.
    pub fn overlapping(&self, region: &Aabb, found: &mut Vec<u32>) {
        found.clear();
        if self.nodes.is_empty() || region.is_empty() || region.min.is_nan() || region.max.is_nan() {
            return;
        }
        let scaled = Aabb { min: region.min * self.units.per_unit, max: region.max * self.units.per_unit };
        let slack = 4.0 * self.slack();
        let meets = |octant: Octant| {
            let cube = octant.padded(slack);
            cube.min.cmple(scaled.max).all() && scaled.min.cmple(cube.max).all()
        };
        let mut open = vec![(0u32, self.root)];
        while let Some((node, octant)) = open.pop() {
            if !meets(octant) {
                continue;
            }
            let Node { first, count } = self.nodes[node as usize];
            if count == CUT {
                open.extend((0..8).map(|child| (first + child, octant.child(child as usize))));
            } else {
                found.extend_from_slice(&self.references[first as usize..(first + count) as usize]);
            }
        }
        found.sort_unstable();
        found.dedup();
        found.retain(|&triangle| triangle_meets_box(&self.corners[triangle as usize], &scaled));
    }

    /// Calls `visit` for the triangles of leaves that the ray may meet, near ones first, with their element and hit,
    /// until it says that it needs none beyond a distance in model units. Triangles in several leaves come more than
    /// once.
    fn walk(&self, ray: &Ray, mut visit: impl FnMut(Hit) -> f64) {
        if self.nodes.is_empty() || ray.reach.is_empty() {
            return;
        }
        let origin = ray.origin() * self.units.per_unit;
        let shear = Shear::new(origin, ray.direction());
        // A hit may lie beside its triangle by the rounding of corners seen from the origin.
        let size = (origin - self.root.center).abs().max_element() + self.root.half;
        let margin = 1e-14 * size + 4.0 * self.slack();
        let inverse = DVec3::ONE / ray.direction();
        let enter = |octant: Octant| -> Option<f64> {
            let cube = octant.padded(margin);
            let (a, b) = ((cube.min - origin) * inverse, (cube.max - origin) * inverse);
            let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
            for axis in 0..3 {
                // NaN, of a ray within a side, passes.
                from = from.max(a[axis].min(b[axis]));
                to = to.min(a[axis].max(b[axis]));
            }
            (from <= to + margin).then_some(from - margin)
        };
        let per_unit = self.units.per_unit;
        let mut limit = ray.reach.hi * per_unit;
        let mut open = vec![(f64::NEG_INFINITY, 0u32, self.root)];
        while let Some((from, node, octant)) = open.pop() {
            if from > limit + limit.abs() * 1e-14 {
                continue;
            }
            let Node { first, count } = self.nodes[node as usize];
            if count == CUT {
                let bottom = open.len();
                for child in 0..8u32 {
                    let octant = octant.child(child as usize);
                    if let Some(from) = enter(octant) {
                        open.push((from, first + child, octant));
                    }
                }
                open[bottom..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
                continue;
            }
            for &element in &self.references[first as usize..(first + count) as usize] {
                let Some(crossing) = shear.cross(&self.corners[element as usize]) else { continue };
                let distance = crossing.distance * self.units.unit;
                if ray.reach.contains(distance) {
                    let parameters = crossing.weights;
                    let wanted = visit(Hit { distance, element, parameters, back: crossing.back }) * per_unit;
                    if wanted < limit {
                        limit = wanted;
                    }
                }
            }
        }
    }
}

impl Rays for TriangleOctree {
    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.walk(ray, |found| {
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
        self.walk(ray, |found| {
            hits.push(found);
            f64::INFINITY
        });
        hits.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.element.cmp(&b.element)));
        // One triangle met in several leaves has one hit, the same bits each time.
        hits.dedup_by_key(|hit| hit.element);
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let mut met = false;
        self.walk(ray, |_| {
            met = true;
            f64::NEG_INFINITY
        });
        met
    }
}

impl fmt::Debug for TriangleOctree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TriangleOctree")
            .field("triangles", &self.len())
            .field("octants", &self.nodes.len())
            .field("references", &self.references.len())
            .field("bounds", &self.bounds)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriangleBvh;
    use crate::fixtures::{Draws, bumpy_ball};
    use shapeloom_core::Interval;

    fn compare(positions: &[DVec3], triangles: &[[u32; 3]], draws: &mut Draws) -> [usize; 2] {
        let exec = Exec::default();
        let tree = TriangleOctree::build(positions, triangles, &exec).unwrap();
        let bvh = TriangleBvh::build(positions, triangles, &exec).unwrap();
        let (center, size) = (tree.bounds().center(), tree.bounds().size().max_element().max(1e-3));
        let (mut hits, mut wanted) = (Vec::new(), Vec::new());
        let mut met = [0; 2];
        for round in 0..300 {
            // Through corners, along axes, and anywhere.
            let from = center + draws.point() * size;
            let target = match round % 3 {
                0 => positions[round % positions.len()],
                _ => center + draws.point() * size * 0.5,
            };
            let direction = if round % 5 == 0 { DVec3::AXES[round % 3] } else { target - from };
            let Ok(ray) = Ray::new(from, direction) else { continue };
            let ray = if round % 4 == 0 { ray.within(Interval::new(-0.5 * size, 0.7 * size)) } else { ray };
            tree.all_hits(&ray, &mut hits);
            bvh.all_hits(&ray, &mut wanted);
            assert_eq!(hits, wanted, "{ray:?}");
            assert_eq!(tree.first_hit(&ray), bvh.first_hit(&ray), "{ray:?}");
            assert_eq!(tree.any_hit(&ray), !wanted.is_empty());
            met[0] += hits.len();

            let middle = center + draws.point() * size * 0.5;
            let half = (draws.point() * size * 0.2).abs();
            let region = if round % 7 == 0 {
                let corner = positions[round % positions.len()];
                Aabb { min: corner, max: corner + half }
            } else {
                Aabb { min: middle - half, max: middle + half }
            };
            let mut found = Vec::new();
            tree.overlapping(&region, &mut found);
            let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
            let meets = |(_, triangle): &(u32, &[u32; 3])| triangle_meets_box(&corners(triangle), &region);
            let wanted: Vec<u32> = (0..).zip(triangles).filter(meets).map(|(element, _)| element).collect();
            assert_eq!(found, wanted, "{region:?}");
            bvh.overlapping(&region, &mut found);
            assert_eq!(found, wanted, "{region:?}");
            met[1] += found.len();
        }
        met
    }

    #[test]
    fn rays_are_answered_as_by_the_hierarchy_and_boxes_as_by_brute_force() {
        let mut draws = Draws::new(6);
        let mut met = [0; 2];
        for center in [DVec3::ZERO, DVec3::new(5e6, -3e6, 4.2e6)] {
            let (positions, triangles) = draws.soup(400, |draws, _| center + draws.point());
            let found = compare(&positions, &triangles, &mut draws);
            let (positions, triangles) = bumpy_ball(24, center, 1.0, 0.1);
            let more = compare(&positions, &triangles, &mut draws);
            met = [met[0] + found[0] + more[0], met[1] + found[1] + more[1]];
        }
        let (flat, triangles) = draws.soup(100, |draws, _| draws.point() * DVec3::new(1.0, 1.0, 0.0));
        compare(&flat, &triangles, &mut draws);
        assert!(met[0] > 5000 && met[1] > 5000, "{met:?}");
    }

    #[test]
    fn heaps_fans_and_nothing_stay_small() {
        let exec = Exec::default();
        let heap: Vec<[u32; 3]> = vec![[0, 1, 2]; 20_000];
        let tree = TriangleOctree::build(&[DVec3::ZERO, DVec3::X, DVec3::Y], &heap, &exec).unwrap();
        assert!(tree.counts()[1] <= 8 * 20_000);
        let mut hits = Vec::new();
        tree.all_hits(&Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z).unwrap(), &mut hits);
        assert!(hits.iter().map(|hit| hit.element).eq(0..20_000));
        let mut rim: Vec<DVec3> = (0..5000).map(|k| DVec3::new(f64::from(k).cos(), f64::from(k).sin(), 0.1)).collect();
        rim.push(DVec3::ZERO);
        let fan: Vec<[u32; 3]> = (0..4999).map(|k| [k, k + 1, 5000]).collect();
        assert!(TriangleOctree::build(&rim, &fan, &exec).unwrap().counts()[1] <= 8 * 5000);
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut found = vec![7];
        for (positions, triangles) in [(vec![], vec![]), (vec![DVec3::ONE], vec![[0, 0, 0]])] {
            let tree = TriangleOctree::build(&positions, &triangles, &exec).unwrap();
            assert!(tree.first_hit(&ray).is_none());
            let region = Aabb { min: DVec3::ZERO, max: DVec3::splat(2.0) };
            tree.overlapping(&region, &mut found);
            assert_eq!(found.len(), triangles.len());
            TriangleBvh::build(&positions, &triangles, &exec).unwrap().overlapping(&region, &mut found);
            assert_eq!(found.len(), triangles.len());
        }
        let bad = TriangleOctree::build(&[DVec3::splat(f64::NAN)], &[[0, 0, 0]], &exec);
        assert!(matches!(bad, Err(BvhError::NotFinite { .. })));
        let small = Exec::default().with_memory(1000);
        assert!(matches!(TriangleOctree::build(&rim, &fan, &small), Err(BvhError::OverBudget(_))));
    }
}
