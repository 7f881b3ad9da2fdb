//! Grids of bricks, where most of space is one value.

use shapeloom_core::{ConvertError, Exec};
use shapeloom_isosurface::{Inside, Lattice, Slabs};

use crate::{Quantity, Samples, VoxelError, VoxelGrid, morton};

/// Samples along a side of a brick.
pub(crate) const SIDE: u32 = 8;
/// Samples in a brick.
pub(crate) const BRICK: usize = 512;

/// The form of the samples that a grid came with, which it is given again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Width {
    Bits,
    U8,
    U16,
    F32,
}

/// What a brick holds.
#[derive(Clone, Copy, Debug)]
enum Slot {
    /// One value.
    Uniform(f32),
    /// Samples of its own, at this place among those of all bricks.
    Own(u32),
}

/// Samples in bricks of 8 × 8 × 8, of which only those are kept that differ from a background.
///
/// A brick is named by the Morton code of its place (Morton 1966), and the codes lie in a sorted table. It has samples
/// of its own, with a bit for each that says whether it is active, or one value for all. What lies in no brick has the
/// background's value. For a grid as it is, active means different from the background; for a narrow band, within the
/// band.
///
/// Lookup: a binary search in the table, and none where the brick is known. Memory: 2124 bytes a brick with samples, 16
/// a brick of one value. Lattices have at most 2^24 samples in a direction.
#[derive(Clone, Debug)]
pub struct SparseBricks {
    lattice: Lattice,
    quantity: Quantity,
    width: Width,
    background: f32,
    keys: Vec<u64>,
    slots: Vec<Slot>,
    masks: Vec<[u64; 8]>,
    values: Vec<[f32; BRICK]>,
}

/// A brick that is handed over: its place, and its samples with what is active.
pub(crate) struct Filled {
    pub key: u64,
    pub values: [f32; BRICK],
    pub mask: [u64; 8],
}

/// The place of a sample in its brick.
pub(crate) fn offset([i, j, k]: [u32; 3]) -> usize {
    ((k % SIDE * SIDE + j % SIDE) * SIDE + i % SIDE) as usize
}

/// The Morton code of a sample's brick.
pub(crate) fn key_of(sample: [u32; 3]) -> u64 {
    morton::encode(sample.map(|at| at / SIDE))
}

/// The samples of a brick that lie in the lattice, each with its place in the brick.
pub(crate) fn samples_of(key: u64, dimensions: [u32; 3]) -> impl Iterator<Item = ([u32; 3], usize)> {
    let base = morton::decode(key).map(|at| at * SIDE);
    (0..BRICK as u32).filter_map(move |at| {
        let sample = [base[0] + at % SIDE, base[1] + at / SIDE % SIDE, base[2] + at / (SIDE * SIDE)];
        (0..3).all(|axis| sample[axis] < dimensions[axis]).then_some((sample, at as usize))
    })
}

impl SparseBricks {
    /// No bricks: the background everywhere.
    ///
    /// # Errors
    /// More than 2^24 samples in a direction.
    pub fn try_new(lattice: Lattice, background: f32, quantity: Quantity) -> Result<Self, VoxelError> {
        let (dimensions, most) = (lattice.dimensions(), SIDE << morton::BITS);
        if dimensions.iter().any(|&count| count > most) {
            return Err(VoxelError::TooLarge { structure: "sparse bricks", dimensions, most });
        }
        let (keys, slots, masks, values) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Ok(Self { lattice, quantity, width: Width::F32, background, keys, slots, masks, values })
    }

    /// The bricks of a grid: exactly its samples. Active are those whose bits differ from the background's.
    ///
    /// # Errors
    /// More than 2^24 samples in a direction, too little memory, or the reason to stop.
    pub fn from_grid(grid: &VoxelGrid, background: f32, exec: &Exec) -> Result<Self, ConvertError> {
        Self::gather(grid, background, exec, |sample| (sample, sample.to_bits() != background.to_bits()))
    }

    /// The band of a grid of signed distances within `half_width` of the surface: samples nearer are active and kept,
    /// all others are cut to the half width with their sign, and the background is the half width.
    ///
    /// # Errors
    /// A half width that is not positive and finite, more than 2^24 samples in a direction, too little memory, or the
    /// reason to stop.
    pub fn narrow_band(grid: &VoxelGrid, half_width: f32, exec: &Exec) -> Result<Self, ConvertError> {
        if !(half_width > 0.0 && half_width.is_finite()) {
            return Err(VoxelError::Overflow { what: "a half width", found: f64::from(half_width) }.into());
        }
        let cut = |sample: f32| match sample.is_nan() {
            true => (half_width, false),
            false => (sample.clamp(-half_width, half_width), sample.abs() < half_width),
        };
        Self::gather(grid, half_width, exec, cut)
    }

    fn gather(
        grid: &VoxelGrid,
        background: f32,
        exec: &Exec,
        keep: impl Fn(f32) -> (f32, bool),
    ) -> Result<Self, ConvertError> {
        exec.check()?;
        let mut bricks = Self::try_new(*grid.lattice(), background, grid.quantity())?;
        bricks.width = match grid.samples() {
            Samples::Bits(_) => Width::Bits,
            Samples::U8(_) => Width::U8,
            Samples::U16(_) => Width::U16,
            Samples::F32(_) => Width::F32,
        };
        let dimensions = grid.lattice().dimensions();
        let counts = dimensions.map(|count| count.div_ceil(SIDE));
        let total = counts.iter().map(|&count| u64::from(count)).product::<u64>();
        let _memory = exec.reserve_elements(total, size_of::<u64>())?;
        let mut keys = Vec::new();
        for z in 0..counts[2] {
            exec.check()?;
            for y in 0..counts[1] {
                keys.extend((0..counts[0]).map(|x| morton::encode([x, y, z])));
            }
        }
        keys.sort_unstable();
        let mut reserved = Vec::new();
        for (done, key) in keys.into_iter().enumerate() {
            if done % 8 == 0 {
                exec.check()?;
                exec.progress(done as f64 / total as f64);
            }
            let mut filled = Filled { key, values: [background; BRICK], mask: [0; 8] };
            for (sample, at) in samples_of(key, dimensions) {
                let (value, active) = keep(grid.samples().get(grid.lattice().index(sample)));
                filled.values[at] = value;
                filled.mask[at / 64] |= u64::from(active) << (at % 64);
            }
            if bricks.values.len() == bricks.values.capacity() {
                let more = bricks.values.len().max(16);
                reserved.push(exec.reserve_elements(more as u64, Self::BRICK_BYTES)?);
                bricks.values.reserve_exact(more);
            }
            bricks.push(filled);
        }
        Ok(bricks)
    }

    /// The bytes of a brick with samples: those, their mask, its name and slot.
    pub(crate) const BRICK_BYTES: usize = 4 * BRICK + 64 + 8 + size_of::<Slot>();

    /// Adds a brick after all others, as one value if it is one.
    pub(crate) fn push(&mut self, brick: Filled) {
        debug_assert!(self.keys.last().is_none_or(|&last| last < brick.key), "bricks come in order");
        let mut samples = samples_of(brick.key, self.lattice.dimensions()).map(|(_, at)| brick.values[at].to_bits());
        let first = samples.next().unwrap_or(self.background.to_bits());
        if brick.mask == [0; 8] && samples.all(|bits| bits == first) {
            if first != self.background.to_bits() {
                self.keys.push(brick.key);
                self.slots.push(Slot::Uniform(f32::from_bits(first)));
            }
            return;
        }
        self.keys.push(brick.key);
        self.slots.push(Slot::Own(self.values.len() as u32));
        self.masks.push(brick.mask);
        self.values.push(brick.values);
    }

    /// The same samples as a dense grid, as wide as those of the grid that they came from.
    ///
    /// # Errors
    /// Too little memory, or the reason to stop.
    pub fn to_grid(&self, exec: &Exec) -> Result<VoxelGrid, ConvertError> {
        exec.check()?;
        let samples = self.lattice.samples();
        let _memory = exec.reserve_elements(samples, 2 * size_of::<f32>())?;
        let mut values = vec![self.background; samples as usize];
        let mut buffer = Vec::new();
        for (k, slab) in (0..).zip(values.chunks_mut(self.lattice.slab_len())) {
            exec.check()?;
            slab.copy_from_slice(self.slab(k, &mut buffer)?);
        }
        let samples = match self.width {
            Width::F32 => Samples::F32(values),
            Width::U8 => Samples::U8(values.into_iter().map(|value| value as u8).collect()),
            Width::U16 => Samples::U16(values.into_iter().map(|value| value as u16).collect()),
            Width::Bits => {
                let word = |part: &[f32]| (0..).zip(part).fold(0, |word, (at, &one)| word | u64::from(one > 0.5) << at);
                Samples::Bits(values.chunks(64).map(word).collect())
            }
        };
        Ok(VoxelGrid::try_new(self.lattice, samples, self.quantity)?)
    }

    /// Where the samples are.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// What the samples are.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The value of what lies in no brick.
    pub fn background(&self) -> f32 {
        self.background
    }

    /// How many bricks have samples of their own, and how many one value that is not the background.
    pub fn bricks(&self) -> [usize; 2] {
        [self.values.len(), self.keys.len() - self.values.len()]
    }

    /// How many samples are active.
    pub fn active(&self) -> u64 {
        self.masks.as_flattened().iter().map(|word| u64::from(word.count_ones())).sum()
    }

    fn slot(&self, key: u64) -> Slot {
        match self.keys.binary_search(&key) {
            Ok(at) => self.slots[at],
            Err(_) => Slot::Uniform(self.background),
        }
    }

    /// The sample at lattice coordinates; the background outside of the lattice.
    pub fn sample(&self, at: [u32; 3]) -> f32 {
        if (0..3).any(|axis| at[axis] >= self.lattice.dimensions()[axis]) {
            return self.background;
        }
        match self.slot(key_of(at)) {
            Slot::Uniform(value) => value,
            Slot::Own(brick) => self.values[brick as usize][offset(at)],
        }
    }

    /// Whether the sample at lattice coordinates is active; not outside of the lattice.
    pub fn is_active(&self, at: [u32; 3]) -> bool {
        let within = (0..3).all(|axis| at[axis] < self.lattice.dimensions()[axis]);
        match self.slot(key_of(at)) {
            Slot::Own(brick) if within => self.masks[brick as usize][offset(at) / 64] >> (offset(at) % 64) & 1 == 1,
            _ => false,
        }
    }

    /// The names of all bricks that are not background, rising.
    pub(crate) fn keys(&self) -> &[u64] {
        &self.keys
    }

    /// The samples of a brick, and which are active.
    pub(crate) fn filled(&self, key: u64) -> Filled {
        match self.slot(key) {
            Slot::Uniform(value) => Filled { key, values: [value; BRICK], mask: [0; 8] },
            Slot::Own(at) => Filled { key, values: self.values[at as usize], mask: self.masks[at as usize] },
        }
    }

    /// The memory that the bricks take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.keys.as_slice())
            + size_of_val(self.slots.as_slice())
            + size_of_val(self.masks.as_slice())
            + size_of_val(self.values.as_slice())
    }
}

impl Slabs for SparseBricks {
    fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    fn slab<'a>(&'a self, k: u32, buffer: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
        let [columns, rows, _] = self.lattice.dimensions();
        buffer.clear();
        buffer.resize(self.lattice.slab_len(), self.background);
        for y in 0..rows.div_ceil(SIDE) {
            for x in 0..columns.div_ceil(SIDE) {
                let slot = self.slot(morton::encode([x, y, k / SIDE]));
                let across = x * SIDE..columns.min((x + 1) * SIDE);
                for j in y * SIDE..rows.min((y + 1) * SIDE) {
                    let start = (j * columns) as usize;
                    let row = &mut buffer[start + across.start as usize..start + across.end as usize];
                    match slot {
                        Slot::Uniform(value) => row.fill(value),
                        Slot::Own(brick) => {
                            let from = offset([0, j, k]);
                            row.copy_from_slice(&self.values[brick as usize][from..from + row.len()]);
                        }
                    }
                }
            }
        }
        Ok(buffer)
    }

    fn inside(&self) -> Inside {
        self.quantity.inside()
    }

    fn default_iso(&self) -> Option<f64> {
        self.quantity.default_iso()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;

    fn draws(count: u64, seed: u64) -> impl Iterator<Item = u64> {
        let mut state = seed;
        (0..count).map(move |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 40
        })
    }

    #[test]
    fn random_grids_of_any_width_come_back_bit_by_bit() {
        for (round, dimensions) in [[1, 1, 1], [8, 8, 8], [9, 17, 5], [20, 3, 33], [64, 1, 2]].into_iter().enumerate() {
            let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).unwrap();
            let count = lattice.samples();
            // Half of the samples are the background, in runs of some length.
            let numbers: Vec<u64> = draws(count, 5 + round as u64)
                .zip(0..count)
                .map(|(draw, at)| if at / 300 % 2 == 0 { 7 } else { draw })
                .collect();
            let mut words = vec![0; count.div_ceil(64) as usize];
            (0..).zip(&numbers).for_each(|(at, number): (usize, _)| words[at / 64] |= (number & 1) << (at % 64));
            let special = [f32::NAN, f32::INFINITY, -0.0, 0.0];
            let floats = numbers.iter().map(|&number| match number {
                7 => 7.0,
                number => special.get(number as usize % 9).copied().unwrap_or(number as f32 / 3.0),
            });
            for samples in [
                Samples::Bits(words),
                Samples::U8(numbers.iter().map(|&number| number as u8).collect()),
                Samples::U16(numbers.iter().map(|&number| number as u16).collect()),
                Samples::F32(floats.collect()),
            ] {
                let grid = VoxelGrid::try_new(lattice, samples, Quantity::Density).unwrap();
                for background in [0.0, 1.0, 7.0] {
                    let bricks = SparseBricks::from_grid(&grid, background, &Exec::default()).unwrap();
                    let back = bricks.to_grid(&Exec::default()).unwrap();
                    let bits = |grid: &VoxelGrid| -> Vec<u32> {
                        (0..count).map(|at| grid.samples().get(at).to_bits()).collect()
                    };
                    assert_eq!(bits(&back), bits(&grid));
                    assert_eq!(back.samples().name(), grid.samples().name());
                    let mut active = 0;
                    for at in 0..count {
                        let (place, value) = (lattice.coordinates(at), grid.samples().get(at));
                        assert_eq!(bricks.sample(place).to_bits(), value.to_bits());
                        assert_eq!(bricks.is_active(place), value.to_bits() != background.to_bits());
                        active += u64::from(bricks.is_active(place));
                    }
                    assert_eq!(bricks.active(), active);
                    assert!(!bricks.is_active(dimensions) && bricks.sample(dimensions) == background);
                }
            }
        }
    }

    #[test]
    fn a_band_keeps_what_is_near_and_cuts_the_rest() {
        let lattice = Lattice::along_axes([40, 41, 42], DVec3::splat(-20.0), DVec3::ONE).unwrap();
        let distance = |at: u64| (lattice.position(lattice.coordinates(at)).length() - 14.0) as f32;
        let samples = Samples::F32((0..lattice.samples()).map(distance).collect());
        let grid = VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance).unwrap();
        let band = SparseBricks::narrow_band(&grid, 2.5, &Exec::default()).unwrap();
        for at in 0..lattice.samples() {
            let place = lattice.coordinates(at);
            assert_eq!(band.sample(place), distance(at).clamp(-2.5, 2.5));
            assert_eq!(band.is_active(place), distance(at).abs() < 2.5);
        }
        // The middle of the ball is bricks of one value.
        assert!(band.bricks()[1] > 0 && band.memory_bytes() < grid.memory_bytes());
        // A jump within a brick, with nothing in the band: both sides stay.
        let jump = |at: u64| if lattice.coordinates(at)[0] < 13 { -9.0 } else { 9.0 };
        let samples = Samples::F32((0..lattice.samples()).map(jump).collect());
        let jump = VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance).unwrap();
        let band = SparseBricks::narrow_band(&jump, 2.5, &Exec::default()).unwrap();
        assert_eq!([12, 13].map(|i| band.sample([i, 4, 4])), [-2.5, 2.5]);
        assert!(SparseBricks::narrow_band(&grid, f32::NAN, &Exec::default()).is_err());
        let small = Exec::default().with_memory(1 << 10);
        assert!(SparseBricks::narrow_band(&grid, 2.5, &small).is_err());
    }

    #[test]
    fn lattices_beyond_the_codes_are_refused() {
        let lattice = Lattice::along_axes([1, 1, (1 << 24) + 1], DVec3::ZERO, DVec3::ONE).unwrap();
        let refused = SparseBricks::try_new(lattice, 0.0, Quantity::Density);
        assert!(matches!(refused, Err(VoxelError::TooLarge { .. })));
    }
}
