//! Winding numbers within a tolerance: clusters are opened until the proven bounds of the others are small enough.

use std::f64::consts::PI;

use multiversion::multiversion;

use super::near::total;
use super::reference::WindingNumber;
use super::sum::Sum;
use super::tree::WindingTree;
use super::walk::Waiting;

/// The share of the tolerance that one cluster may use up at first. About as many are left whole around a query.
const FIRST_SHARE: f64 = 1.0 / 40.0;
/// After so many walks that were not good enough every triangle is visited.
const WALKS: u32 = 6;

/// The winding number of a query given in scaled and in local units.
///
/// One threshold holds for all clusters: for a given sum of bounds that opens about the fewest. A walk whose sum is too
/// large is done again with a smaller threshold; the sum falls about with its power 3/5 (a cluster's bound falls with
/// the fifth power of its distance in radii, the sum with the third).
pub(super) fn winding_number(tree: &WindingTree, scaled: [f64; 3], local: [f64; 3], tolerance: f64) -> WindingNumber {
    let tolerance = if tolerance > 0.0 { tolerance } else { 0.0 };
    let mut threshold = tolerance * FIRST_SHARE;
    for _ in 0..WALKS {
        let found = walk(tree, scaled, local, threshold * (4.0 * PI));
        if found.bound <= tolerance || threshold == 0.0 {
            return found;
        }
        let wanted = (0.7 * tolerance / found.bound).min(0.7);
        threshold *= wanted.powf(5.0 / 3.0);
    }
    walk(tree, scaled, local, 0.0)
}

/// Takes whole what is wrong by at most `threshold`, a solid angle.
#[multiversion(targets("x86_64+avx2"))]
fn walk(tree: &WindingTree, scaled: [f64; 3], local: [f64; 3], threshold: f64) -> WindingNumber {
    let reach = local.into_iter().fold(0.0, |reach: f64, x| reach.max(x.abs()));
    let (mut sum, mut bound) = (Sum::default(), 0.0);
    let mut waiting = Waiting::at_root(tree);
    while let Some((node, place)) = waiting.next() {
        let (out, open) = node.far_within(local, reach, threshold);
        // Lanes are eight numbers of the size of the largest: their sum is wrong by a few ulps, which `rounding` holds.
        sum.add(total(&out[0]) * (1.0 / (4.0 * PI)));
        bound += (total(&out[1]) + total(&out[2])) * (1.0 / (4.0 * PI));
        for block in waiting.open(place, open) {
            let (turns, error) = block.turns_within(scaled);
            sum.add(turns);
            bound += error;
        }
    }
    WindingNumber { value: sum.total(), bound: (bound + sum.error()) * (1.0 + 1e-6) }
}
