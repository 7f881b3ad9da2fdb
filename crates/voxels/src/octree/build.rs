//! Octrees from samples and fields.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, ConvertError, Exec, Field};
use shapeloom_isosurface::{Lattice, Level, Slabs};

use super::{EMPTY, FULL, Growing, Node, Octree, POLL_LEVEL, child_base, depth_of};
use crate::full_cells::FullCells;

impl Octree {
    /// The cells whose samples are inside. Cost: linear in the samples.
    ///
    /// # Errors
    /// More than 2^21 samples in a direction, a slab that cannot be had, too little memory, or the reason to stop.
    pub fn from_slabs<S: Slabs + ?Sized>(slabs: &S, level: Level, exec: &Exec) -> Result<Self, ConvertError> {
        exec.check()?;
        let lattice = *slabs.lattice();
        let depth = depth_of(&lattice)?;
        let _bits = exec.reserve(FullCells::bytes(lattice.samples()))?;
        let cells = FullCells::of(slabs, level, exec)?;
        let dimensions = lattice.dimensions();
        let mut growing = Growing::new(exec);
        let decide = |base: [u32; 3], level: u32| {
            if (0..3).any(|axis| base[axis] >= dimensions[axis]) {
                Some(EMPTY)
            } else if level == 0 {
                Some(if cells.is_full(base.map(i64::from)) { FULL } else { EMPTY })
            } else {
                None
            }
        };
        let root = build(&decide, [0; 3], depth, &mut growing)?;
        Ok(Self { lattice, depth, root, children: growing.children })
    }

    /// The cells whose centres have a negative value. Octants over which the field's [`range`](Field::range) has one
    /// sign are decided as a whole, so a field that knows its range costs its surface's cells, any other all cells.
    ///
    /// # Errors
    /// More than 2^21 samples in a direction, too little memory, or the reason to stop.
    pub fn from_field<F: Field + ?Sized>(field: &F, lattice: Lattice, exec: &Exec) -> Result<Self, ConvertError> {
        exec.check()?;
        let depth = depth_of(&lattice)?;
        let dimensions = lattice.dimensions();
        let mut growing = Growing::new(exec);
        let decide = |base: [u32; 3], level: u32| {
            if (0..3).any(|axis| base[axis] >= dimensions[axis]) {
                return Some(EMPTY);
            }
            if level == 0 {
                return Some(if field.value(lattice.position(base)) < 0.0 { FULL } else { EMPTY });
            }
            // Samples rounded to their positions may lie beside the box around the corners' positions.
            let end: [u32; 3] = std::array::from_fn(|axis| base[axis] + (1 << level) - 1);
            let corners = Aabb::from_corners(DVec3::from(base.map(f64::from)), DVec3::from(end.map(f64::from)));
            let region = corners.transformed(lattice.placement());
            let rounding = region.min.abs().max(region.max.abs()).max_element() * 1e-14;
            let range = field.range(&region.padded(rounding));
            let whole = (0..3).all(|axis| end[axis] < dimensions[axis]);
            if range.lo >= 0.0 {
                Some(EMPTY)
            } else if whole && range.hi < 0.0 {
                Some(FULL)
            } else {
                None
            }
        };
        let root = build(&decide, [0; 3], depth, &mut growing)?;
        Ok(Self { lattice, depth, root, children: growing.children })
    }
}

/// Builds an octant, from its cells up. `decide` gives the leaf where it knows, and always at level 0. Depth is at most
/// 21.
fn build(
    decide: &impl Fn([u32; 3], u32) -> Option<Node>,
    base: [u32; 3],
    level: u32,
    growing: &mut Growing<'_>,
) -> Result<Node, ConvertError> {
    if let Some(leaf) = decide(base, level) {
        return Ok(leaf);
    }
    if level >= POLL_LEVEL {
        growing.exec.check()?;
    }
    let mut children = [EMPTY; 8];
    for (child, node) in children.iter_mut().enumerate() {
        *node = build(decide, child_base(base, 1 << (level - 1), child), level - 1, growing)?;
    }
    growing.node(children)
}
