//! Fast winding numbers: a walk that takes far clusters whole.

use std::f64::consts::PI;

use multiversion::multiversion;

use super::near::{Block, WIDTH, total};
use super::sum::Sum;
use super::tree::WindingTree;

/// Levels of nodes that four billion triangles can have, and nodes that wait: seven siblings on each.
pub(super) const WAITING: usize = 12 * WIDTH;

/// The winding number of a query given in scaled and in local units.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn winding_number(tree: &WindingTree, scaled: [f64; 3], local: [f64; 3]) -> f64 {
    let Some(top) = tree.levels.len().checked_sub(1) else {
        return 0.0;
    };
    let high = local.map(|x| x as f32);
    let low = [0, 1, 2].map(|axis| (local[axis] - f64::from(high[axis])) as f32);
    let accuracy_squared = tree.accuracy * tree.accuracy;
    let mut far = [0.0f64; WIDTH];
    let mut near = 0.0;
    let mut waiting = [(0u32, 0u32); WAITING];
    waiting[0] = (top as u32, 0);
    let mut count = 1;
    while count > 0 {
        count -= 1;
        let (level, index) = waiting[count];
        let (angles, mut open) = tree.levels[level as usize][index as usize].far(high, low, accuracy_squared);
        for lane in 0..WIDTH {
            far[lane] += f64::from(angles[lane]);
        }
        while open != 0 {
            let child = index * WIDTH as u32 + open.trailing_zeros();
            open &= open - 1;
            if level == 0 {
                near += tree.blocks[child as usize].turns(scaled);
            } else {
                waiting[count] = (level - 1, child);
                count += 1;
            }
        }
    }
    near + total(&far) * (1.0 / (4.0 * PI))
}

/// Adds every triangle.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn visit_all(blocks: &[Block], scaled: [f64; 3], sum: &mut Sum, bound: &mut f64) {
    for block in blocks {
        let (turns, error) = block.turns_within(scaled);
        sum.add(turns);
        *bound += error;
    }
}
