//! Building the tree.

use glam::DVec3;
use shapeloom_core::{Exec, parallel};

use super::cluster::Cluster;
use super::far::Node;
use super::near::{Block, WIDTH};
use super::pack::{Item, pack};
use super::tree::WindingTree;
use crate::BvhError;
use crate::scaled_input::{Units, checked_bounds};

impl WindingTree {
    /// Builds the tree over `triangles`, index triples into `positions`.
    ///
    /// Positions that no triangle names may be anything. Cost: O(n log n), a quarter of a second for a million
    /// triangles.
    ///
    /// # Errors
    /// An index out of range, a corner that is not finite, more than `u32::MAX - 1` triangles, too little memory in the
    /// budget, or the reason to stop.
    pub fn build(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<Self, BvhError> {
        exec.check()?;
        let count = triangles.len();
        let eights = count.div_ceil(WIDTH) as u64;
        // Each level has an eighth of the one before, rounded up.
        let stored = size_of::<Block>() + size_of::<Node>() / WIDTH * 8 / 7;
        let memory = exec.reserve_elements(eights + 16, stored)?;
        let scratch = exec.reserve(count as u64 * size_of::<Item>() as u64)?;
        let bounds = checked_bounds(positions, triangles, exec)?;
        let units = Units::new(&bounds);
        exec.progress(0.1);
        let scaled =
            |triangle: u32| triangles[triangle as usize].map(|corner| positions[corner as usize] * units.per_unit);
        let mut items = vec![Item { place: [0; 3], element: 0 }; count];
        parallel::fill_chunks(exec, &mut items, parallel::CHUNK, |first, part| {
            for (element, item) in (first as u32..).zip(part) {
                let [a, b, c] = scaled(element).map(|corner| corner - units.center);
                // Local units reach from −2 to 2; a cast to an integer stops at its ends.
                let place = ((a + b + c) / 3.0 + DVec3::splat(2.0)) * 2f64.powi(30);
                *item = Item { place: place.to_array().map(|x| x as u32), element };
            }
            Ok::<_, BvhError>(())
        })?;
        pack(&mut items, &exec.part(0.2, 0.6))?;
        exec.progress(0.6);
        let _clusters = exec.reserve_elements(eights + 16, 2 * size_of::<Cluster>())?;
        let eighths = items.len().div_ceil(WIDTH);
        let members = |block: usize| &items[block * WIDTH..(block * WIDTH + WIDTH).min(items.len())];
        let mut blocks = vec![Block { corners: [[[0.0; WIDTH]; 3]; 3] }; eighths];
        parallel::fill_chunks(exec, &mut blocks, 512, |first, part| {
            for (index, block) in (first..).zip(part) {
                *block = block_of(members(index).iter().map(|item| scaled(item.element)));
            }
            Ok::<_, BvhError>(())
        })?;
        exec.progress(0.7);
        let mut clusters = chunked(exec, eighths, |index| {
            let mut triangles = [[DVec3::ZERO; 3]; WIDTH];
            let members = members(index);
            for (corners, item) in triangles.iter_mut().zip(members) {
                *corners = scaled(item.element);
            }
            Cluster::of_triangles(&triangles[..members.len()], units.center)
        })?;
        drop(items);
        drop(scratch);
        exec.progress(0.9);
        let mut levels = Vec::new();
        while !clusters.is_empty() {
            let children = |node: usize| &clusters[node * WIDTH..(node * WIDTH + WIDTH).min(clusters.len())];
            let nodes = clusters.len().div_ceil(WIDTH);
            levels.push(chunked(exec, nodes, |node| Node::of(children(node)))?);
            if nodes == 1 {
                break;
            }
            clusters = chunked(exec, nodes, |node| Cluster::of_clusters(children(node)))?;
        }
        exec.progress(1.0);
        let accuracy = Self::DEFAULT_ACCURACY;
        Ok(Self { blocks, levels, triangles: count, bounds, units, accuracy, _memory: memory })
    }
}

fn block_of(triangles: impl ExactSizeIterator<Item = [DVec3; 3]>) -> Block {
    let mut block = Block { corners: [[[0.0; WIDTH]; 3]; 3] };
    let count = triangles.len();
    for (lane, corners) in triangles.enumerate() {
        for (out, corner) in block.corners.iter_mut().zip(corners) {
            for (out, x) in out.iter_mut().zip(corner.to_array()) {
                out[lane] = x;
            }
        }
    }
    // Lanes without a triangle are the first one's first corner, three times.
    for axis in 0..3 {
        let filler = block.corners[0][axis][0];
        for out in &mut block.corners {
            out[axis][count..].fill(filler);
        }
    }
    block
}

/// `f(0), f(1), ...` in parallel.
fn chunked<T: Send>(exec: &Exec, len: usize, f: impl Fn(usize) -> T + Sync) -> Result<Vec<T>, BvhError> {
    let parts = parallel::map_chunks(exec, len, 512, |range| Ok::<_, BvhError>(range.map(&f).collect::<Vec<T>>()))?;
    let mut all = Vec::with_capacity(len);
    parts.into_iter().for_each(|part| all.extend(part));
    Ok(all)
}
