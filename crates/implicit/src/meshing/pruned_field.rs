//! Fields, sampled near their surface only.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Aabb, ConvertError, Exec, Field, Reservation, Restricted};
use shapeloom_isosurface::{Lattice, Slabs};

/// How many samples a block has along each side. Smaller ones leave out more, larger ones cost less each.
const SIDE: usize = 8;

const BLOCK: usize = SIDE * SIDE * SIDE;

/// Boxes of at most so many blocks along each side are worked on by themselves.
const TASK: usize = 4;

/// What is kept of a block.
const POSITIVE: u32 = 0;
const NEGATIVE: u32 = 1;
const FIRST_SAMPLED: u32 = 2;

/// A field, sampled on a lattice in blocks of 8³ where it may be zero; other blocks are filled with 1 outside and -1 inside.
///
/// A block is filled only if the field's bounds prove one sign over it and the cells around it, so every cell whose corners differ in sign
/// has real samples at all its corners: what reads such cells alone draws the same surface as from all samples. Gradients by
/// differences of samples do not.
///
/// Blocks are found by halving the lattice's box; in each part the field is what [`Field::restrict`] leaves of it there.
pub struct PrunedField {
    lattice: Lattice,
    /// How many blocks there are in each direction.
    blocks: [usize; 3],
    /// What each block is: positive, negative, or the number of its samples, from 2.
    kinds: Vec<u32>,
    samples: Vec<[f32; BLOCK]>,
    _memory: Vec<Reservation>,
}

/// A box of blocks in which the sign is open, with what is left of the field.
struct Part {
    first: [usize; 3],
    end: [usize; 3],
    field: Option<Arc<dyn Field>>,
}

/// What became of the blocks of a part.
#[derive(Default)]
struct Done {
    negative: Vec<usize>,
    sampled: Vec<usize>,
    samples: Vec<[f32; BLOCK]>,
    /// Held until the samples are in one place.
    _memory: Option<Reservation>,
}

impl PrunedField {
    /// Samples a field on a lattice along the axes.
    ///
    /// # Errors
    /// More memory than there is, or the reason to stop.
    pub fn sample<F: Field + ?Sized>(field: &F, lattice: Lattice, exec: &Exec) -> Result<Self, ConvertError> {
        let blocks = lattice.dimensions().map(|count| (count as usize).div_ceil(SIDE));
        let count = blocks.iter().fold(1_u64, |count, &side| count.saturating_mul(side as u64));
        let mut memory = vec![exec.reserve_elements(count, size_of::<u32>())?];
        let mut kinds = vec![POSITIVE; count as usize];
        let sampler = Sampler { whole: field, lattice: &lattice, blocks };
        let (tasks, negative) = sampler.tasks(exec)?;
        negative.into_iter().for_each(|block| kinds[block] = NEGATIVE);
        let total = tasks.len().max(1) as f64;
        let done = map_chunks(exec, tasks.len(), 1, |range| {
            exec.progress(range.start as f64 / total);
            range.map(|task| sampler.run(&tasks[task], exec)).collect::<Result<Vec<Done>, ConvertError>>()
        })?;
        let done: Vec<Done> = done.into_iter().flatten().collect();
        let sampled: usize = done.iter().map(|done| done.samples.len()).sum();
        memory.push(exec.reserve_elements(sampled as u64, size_of::<[f32; BLOCK]>())?);
        let mut samples = Vec::with_capacity(sampled);
        for part in done {
            part.negative.into_iter().for_each(|block| kinds[block] = NEGATIVE);
            for (block, of_block) in part.sampled.into_iter().zip(part.samples) {
                kinds[block] = samples.len() as u32 + FIRST_SAMPLED;
                samples.push(of_block);
            }
        }
        Ok(Self { lattice, blocks, kinds, samples, _memory: memory })
    }

    /// How many samples were asked of the field, those beyond the lattice in its last blocks included.
    pub fn evaluations(&self) -> u64 {
        (self.samples.len() * BLOCK) as u64
    }
}

impl Slabs for PrunedField {
    fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    fn slab<'a>(&'a self, k: u32, buffer: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
        let [columns, rows, _] = self.lattice.dimensions().map(|count| count as usize);
        buffer.resize(columns * rows, 0.0);
        let (layer, k) = (k as usize / SIDE, k as usize % SIDE);
        for (j, row) in buffer.chunks_exact_mut(columns).enumerate() {
            let first = (layer * self.blocks[1] + j / SIDE) * self.blocks[0];
            for (part, &kind) in row.chunks_mut(SIDE).zip(&self.kinds[first..first + self.blocks[0]]) {
                match kind {
                    POSITIVE => part.fill(1.0),
                    NEGATIVE => part.fill(-1.0),
                    sampled => {
                        let start = (k * SIDE + j % SIDE) * SIDE;
                        let samples = &self.samples[(sampled - FIRST_SAMPLED) as usize];
                        part.copy_from_slice(&samples[start..start + part.len()]);
                    }
                }
            }
        }
        Ok(buffer)
    }
}

struct Sampler<'a, F: ?Sized> {
    whole: &'a F,
    lattice: &'a Lattice,
    blocks: [usize; 3],
}

impl<F: Field + ?Sized> Sampler<'_, F> {
    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.blocks[1] + j) * self.blocks[0] + i
    }

    /// Parts of at most so many blocks that each suits a thread, and the blocks that are inside for certain.
    fn tasks(&self, exec: &Exec) -> Result<(Vec<Part>, Vec<usize>), ConvertError> {
        let mut done = Done::default();
        let (mut tasks, mut open) = (Vec::new(), vec![Part { first: [0; 3], end: self.blocks, field: None }]);
        while let Some(part) = open.pop() {
            exec.check()?;
            let Some(part) = self.restricted(part, &mut done) else { continue };
            if (0..3).all(|axis| part.end[axis] - part.first[axis] <= TASK) {
                tasks.push(part);
            } else {
                open.extend(part.halves());
            }
        }
        Ok((tasks, done.negative))
    }

    /// Samples a part.
    fn run(&self, task: &Part, exec: &Exec) -> Result<Done, ConvertError> {
        let blocks = (0..3).map(|axis| task.end[axis] - task.first[axis]).product::<usize>();
        let mut done =
            Done { _memory: Some(exec.reserve_elements(blocks as u64, size_of::<[f32; BLOCK]>())?), ..Done::default() };
        let mut open: Vec<Part> = match task.is_block() {
            true => vec![Part { first: task.first, end: task.end, field: task.field.clone() }],
            false => task.halves().collect(),
        };
        let mut offsets: Option<[Vec<f32>; 3]> = None;
        while let Some(part) = open.pop() {
            exec.check()?;
            let Some(part) = self.restricted(part, &mut done) else { continue };
            if !part.is_block() {
                open.extend(part.halves());
                continue;
            }
            let [x, y, z] = offsets.get_or_insert_with(|| self.offsets());
            let mut samples = [0.0; BLOCK];
            let origin = self.lattice.position(part.first.map(|block| (block * SIDE) as u32));
            match &part.field {
                Some(field) => field.values(origin, x, y, z, &mut samples),
                None => self.whole.values(origin, x, y, z, &mut samples),
            }
            done.sampled.push(self.number(part.first));
            done.samples.push(samples);
        }
        Ok(done)
    }

    /// The places of a block's samples, relative to the first.
    fn offsets(&self) -> [Vec<f32>; 3] {
        let step = self.lattice.spacing();
        let along = |axis: usize, stride: usize| {
            (0..BLOCK).map(|n| ((n / stride % SIDE) as f64 * step[axis]) as f32).collect::<Vec<f32>>()
        };
        [along(0, 1), along(1, SIDE), along(2, SIDE * SIDE)]
    }

    /// The part with the field as it is there; none where its sign is known.
    fn restricted(&self, part: Part, done: &mut Done) -> Option<Part> {
        // The samples of the part and the next ones around it.
        let at = |block: usize, more: f64| (block * SIDE) as f64 + more;
        let first = DVec3::from(part.first.map(|block| at(block, -1.0)));
        let last = DVec3::from(part.end.map(|block| at(block, 0.0)));
        let place = self.lattice.placement();
        let region = Aabb::from_corners(place.point(first), place.point(last));
        let restricted = match &part.field {
            Some(field) => field.restrict(&region),
            None => self.whole.restrict(&region),
        };
        match restricted {
            Restricted::Positive => None,
            Restricted::Negative => {
                for k in part.first[2]..part.end[2] {
                    for j in part.first[1]..part.end[1] {
                        done.negative.extend((part.first[0]..part.end[0]).map(|i| self.number([i, j, k])));
                    }
                }
                None
            }
            Restricted::Same => Some(part),
            Restricted::Simpler(field) => Some(Part { field: Some(field), ..part }),
        }
    }
}

impl Part {
    fn is_block(&self) -> bool {
        (0..3).all(|axis| self.end[axis] - self.first[axis] == 1)
    }

    /// Two to eight parts of about half the size.
    fn halves(&self) -> impl Iterator<Item = Self> {
        let middle: [usize; 3] = std::array::from_fn(|axis| {
            let length = self.end[axis] - self.first[axis];
            // Whole powers of two, so that parts of all sizes fit the blocks well.
            self.first[axis] + length.next_power_of_two() / 2
        });
        (0..8).filter_map(move |octant| {
            let (mut first, mut end) = (self.first, self.end);
            for axis in 0..3 {
                let single = end[axis] - first[axis] == 1;
                match octant >> axis & 1 {
                    0 if !single => end[axis] = middle[axis],
                    1 if single => return None,
                    1 => first[axis] = middle[axis],
                    _ => {}
                }
            }
            Some(Self { first, end, field: self.field.clone() })
        })
    }
}
