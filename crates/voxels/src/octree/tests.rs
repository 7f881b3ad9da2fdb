use super::*;
use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Interval};
use shapeloom_isosurface::{Inside, Level};

const HALF: Level = Level { iso: 0.5, inside: Inside::Above };

struct Dice(u64);

impl Dice {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }
}

fn exec() -> Exec {
    Exec::default()
}

fn grid(dimensions: [u32; 3], mut full: impl FnMut([u32; 3]) -> bool) -> VoxelGrid {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).unwrap();
    let mut words = vec![0u64; lattice.samples().div_ceil(64) as usize];
    for at in 0..lattice.samples() {
        words[at as usize / 64] |= u64::from(full(lattice.coordinates(at))) << (at % 64);
    }
    VoxelGrid::try_new(lattice, Samples::Bits(words), Quantity::Occupancy).unwrap()
}

/// A random grid of random density; blocks of cells are equal, so that there are large octants too.
fn random(dice: &mut Dice, dimensions: [u32; 3]) -> VoxelGrid {
    let (density, block) = (dice.next(11), 1 << dice.next(3));
    let seed = dice.0;
    grid(dimensions, |place| {
        let [x, y, z] = place.map(|at| u64::from(at / block));
        let mut own = Dice(seed ^ (x | y << 20 | z << 40));
        own.next(2);
        own.next(10) < density
    })
}

#[test]
fn thousands_of_random_grids_come_back_exactly() {
    let mut dice = Dice(1);
    for round in 0..3000 {
        let dimensions = std::array::from_fn(|_| 1 + dice.next(if round % 10 == 0 { 33 } else { 9 }) as u32);
        let source = random(&mut dice, dimensions);
        let tree = Octree::from_slabs(&source, HALF, &exec()).unwrap();
        assert!(tree.to_grid(&exec()).unwrap() == source, "{dimensions:?}");
        let full = (0..source.lattice().samples()).filter(|&at| source.samples().get(at) == 1.0).count();
        assert_eq!(tree.full_cells(), full as u64);
        let bits = tree.encode(&exec()).unwrap();
        assert!(Octree::decode(&bits, *source.lattice(), &exec()).unwrap() == tree);
        let octants = tree.full_octants();
        assert_eq!(octants.iter().map(|(_, side)| u64::from(*side).pow(3)).sum::<u64>(), full as u64);
        assert!(octants.iter().all(|(base, _)| source.sample(*base) == 1.0));
        let counts = tree.counts();
        assert_eq!(counts.full + counts.empty, 7 * counts.mixed + 1);
        assert!(bits.len() as u64 * 8 <= 2 * counts.nodes() + 7);
        for _ in 0..20 {
            let cell = std::array::from_fn(|axis| dice.next(u64::from(dimensions[axis]) + 3) as u32);
            let within = (0..3).all(|axis| cell[axis] < dimensions[axis]);
            assert_eq!(tree.is_full(cell), within && source.sample(cell) == 1.0);
        }
    }
}

/// Every operation against the bits of the grids, and trees as those that the resulting grids give.
#[test]
fn set_operations_are_those_of_each_cell() {
    let mut dice = Dice(2);
    type Operation = (fn(&Octree, &Octree) -> Octree, fn(bool, bool) -> bool);
    let operations: [Operation; 4] = [
        (|a, b| a.union(b, &exec()).unwrap(), |a, b| a || b),
        (|a, b| a.intersection(b, &exec()).unwrap(), |a, b| a && b),
        (|a, b| a.difference(b, &exec()).unwrap(), |a, b| a && !b),
        (|a, b| a.symmetric_difference(b, &exec()).unwrap(), |a, b| a != b),
    ];
    for _ in 0..300 {
        let dimensions = std::array::from_fn(|_| 1 + dice.next(12) as u32);
        let grids = [random(&mut dice, dimensions), random(&mut dice, dimensions)];
        let [a, b] = [0, 1].map(|n: usize| Octree::from_slabs(&grids[n], HALF, &exec()).unwrap());
        for (operation, full) in operations {
            let wanted = grid(dimensions, |at| full(grids[0].sample(at) == 1.0, grids[1].sample(at) == 1.0));
            let found = operation(&a, &b);
            assert!(found == Octree::from_slabs(&wanted, HALF, &exec()).unwrap());
        }
        let not = a.complement();
        let wanted = grid(dimensions, |at| grids[0].sample(at) == 0.0);
        assert!(not.to_grid(&exec()).unwrap() == wanted);
        assert_eq!(not.full_cells() + a.full_cells(), 1 << (3 * a.depth()));
        assert!(not.complement() == a);
        // De Morgan, for whole cubes.
        let union = a.complement().intersection(&b.complement(), &exec()).unwrap().complement();
        assert!(union == a.union(&b, &exec()).unwrap());
    }
}

#[test]
fn a_checkerboard_is_the_worst_case() {
    let board = grid([32; 3], |[i, j, k]| (i + j + k) % 2 == 0);
    let tree = Octree::from_slabs(&board, HALF, &exec()).unwrap();
    let cells = 1u64 << 15;
    assert_eq!(tree.counts().nodes(), (8 * cells - 1) / 7);
    let bits = tree.encode(&exec()).unwrap().len() as u64 * 8;
    // A bit a cell, and one for each octant above.
    assert_eq!(bits, (cells + (cells - 1) / 7).div_ceil(8) * 8);
    let solid = Octree::from_slabs(&grid([32; 3], |_| true), HALF, &exec()).unwrap();
    assert_eq!((solid.counts().nodes(), solid.encode(&exec()).unwrap()), (1, vec![2]));
}

#[test]
fn damaged_bits_are_refused_and_never_panic() {
    let mut dice = Dice(3);
    let source = random(&mut dice, [11, 9, 14]);
    let tree = Octree::from_slabs(&source, HALF, &exec()).unwrap();
    let lattice = *source.lattice();
    let bits = tree.encode(&exec()).unwrap();
    let code = |bytes: &[u8]| Octree::decode(bytes, lattice, &exec()).unwrap_err().diagnostic().code();
    for end in 0..bits.len() {
        assert_eq!(code(&bits[..end]), "E-octree-end");
    }
    assert_eq!(code(&[bits.as_slice(), &[0]].concat()), "E-octree-trailing");
    assert_eq!(code(&[0b100]), "E-octree-trailing");
    // A cut octant with eight empty ones.
    assert_eq!(code(&[1, 0, 0]), "E-octree-equal");
    for _ in 0..3000 {
        let mut damaged = bits.clone();
        for _ in 0..=dice.next(3) {
            let at = dice.next(bits.len() as u64 * 8) as usize;
            damaged[at / 8] ^= 1 << (at % 8);
        }
        if let Ok(other) = Octree::decode(&damaged, lattice, &exec()) {
            assert!(other.encode(&exec()).unwrap() == damaged, "no two codes for one tree");
        }
    }
    let small = Exec::default().with_memory(100);
    assert!(Octree::decode(&bits, lattice, &small).is_err());
}

struct Ball {
    radius: f64,
    knows_range: bool,
}

impl Field for Ball {
    fn value(&self, point: DVec3) -> f64 {
        point.length() - self.radius
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        point.normalize_or_zero()
    }

    fn range(&self, region: &Aabb) -> Interval {
        if !self.knows_range {
            return Interval::ALL;
        }
        let far = region.corners().map(DVec3::length).into_iter().fold(0.0, f64::max);
        Interval::new(region.distance_squared(DVec3::ZERO).sqrt() - self.radius, far - self.radius)
    }
}

#[test]
fn fields_with_and_without_a_range_give_the_same_tree() {
    let lattice = Lattice::along_axes([40, 33, 20], DVec3::splat(-1.0), DVec3::splat(0.06)).unwrap();
    let slow = Ball { radius: 0.9, knows_range: false };
    let fast = Ball { radius: 0.9, knows_range: true };
    let [slow, fast] = [slow, fast].map(|ball| Octree::from_field(&ball, lattice, &exec()).unwrap());
    assert!(slow == fast);
    let inside = |at: u64| lattice.position(lattice.coordinates(at)).length() - 0.9 < 0.0;
    assert_eq!(fast.full_cells(), (0..lattice.samples()).filter(|&at| inside(at)).count() as u64);
}

#[test]
fn other_lattices_and_too_long_ones_are_refused() {
    let [a, b] = [[4, 4, 4], [4, 4, 5]].map(|n| Octree::from_slabs(&grid(n, |_| true), HALF, &exec()).unwrap());
    assert_eq!(a.union(&b, &exec()).unwrap_err().diagnostic().code(), "E-voxels-lattices");
    let long = Lattice::along_axes([1, 1, (1 << 21) + 1], DVec3::ZERO, DVec3::ONE).unwrap();
    assert_eq!(Octree::decode(&[2], long, &exec()).unwrap_err().diagnostic().code(), "E-voxels-size");
}
