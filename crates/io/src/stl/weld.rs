//! Vertices found again by their position.

use std::collections::HashMap;

use shapeloom_core::OverBudget;
use shapeloom_core::glam::DVec3;

use crate::memory::{Growing, Memory};

/// How many corners are looked up together: enough that their reads of the table overlap, few enough that what was read
/// is still at hand.
pub(super) const BATCH: usize = 192;

const EMPTY: u32 = u32::MAX;

/// With at most half of the slots in use the longest run of a million positions is about forty; a longer one than this
/// means positions that were made to collide.
const LONGEST_RUN: usize = 256;

/// Positions numbered in the order in which each first comes; -0 equals 0. Every number is that of the first position
/// equal to it, whatever the table does.
///
/// An open table with linear probing. The hash is cheap and known, so positions can be made to collide: when a run gets
/// too long, a map with a secret key takes over.
pub(super) struct Welder {
    slots: Vec<u32>,
    /// How far a hash is shifted right to give a slot.
    shift: u32,
    positions: Growing<DVec3>,
    keyed: Option<HashMap<[u64; 3], u32>>,
}

impl Welder {
    /// An empty one that expects as many facets.
    pub(super) fn new(memory: &mut Memory<'_>, facets: usize) -> Result<Self, OverBudget> {
        // A closed surface has half as many vertices as facets.
        let slots = facets.next_power_of_two().clamp(1 << 6, 1 << 31);
        memory.take(slots, size_of::<u32>())?;
        let positions = Growing::with_room(memory, facets / 2 + 2)?;
        Ok(Self { slots: vec![EMPTY; slots], shift: 64 - slots.trailing_zeros(), positions, keyed: None })
    }

    /// The numbers of as many positions, in turn. Positions that are not finite are never equal to another.
    pub(super) fn number(
        &mut self,
        memory: &mut Memory<'_>,
        points: &[DVec3],
        numbers: &mut [u32],
    ) -> Result<(), OverBudget> {
        let mut hashes = [0u64; BATCH];
        let mut guesses = [EMPTY; BATCH];
        for (points, numbers) in points.chunks(BATCH).zip(numbers.chunks_mut(BATCH)) {
            // First all hashes and all reads of the table, so that the waits for memory overlap.
            for (hash, point) in hashes.iter_mut().zip(points) {
                *hash = hash_of(point);
            }
            for (guess, hash) in guesses.iter_mut().zip(&hashes[..points.len()]) {
                *guess = self.slots.get((hash >> self.shift) as usize).copied().unwrap_or(EMPTY);
            }
            for ((point, number), (&guess, &hash)) in points.iter().zip(numbers).zip(guesses.iter().zip(&hashes)) {
                *number = match self.positions.as_slice().get(guess as usize) {
                    Some(known) if known == point => guess,
                    _ => self.look_up(memory, *point, hash)?,
                };
            }
        }
        Ok(())
    }

    #[inline]
    fn look_up(&mut self, memory: &mut Memory<'_>, point: DVec3, hash: u64) -> Result<u32, OverBudget> {
        if self.keyed.is_some() {
            return self.look_up_keyed(memory, point);
        }
        let mask = self.slots.len() - 1;
        let mut slot = (hash >> self.shift) as usize & mask;
        for _ in 0..LONGEST_RUN {
            let known = self.slots[slot];
            if known == EMPTY {
                let number = self.positions.len() as u32;
                self.positions.push(memory, point)?;
                self.slots[slot] = number;
                if self.positions.len() * 2 > self.slots.len() {
                    self.grow(memory)?;
                }
                return Ok(number);
            }
            if self.positions.as_slice()[known as usize] == point {
                return Ok(known);
            }
            slot = (slot + 1) & mask;
        }
        self.key(memory)?;
        self.look_up_keyed(memory, point)
    }

    #[cold]
    fn grow(&mut self, memory: &mut Memory<'_>) -> Result<(), OverBudget> {
        let slots = self.slots.len() * 2;
        memory.take(slots, size_of::<u32>())?;
        self.slots = vec![EMPTY; slots];
        self.shift -= 1;
        let mask = slots - 1;
        for (number, point) in self.positions.as_slice().iter().enumerate() {
            if !point.is_finite() {
                continue;
            }
            let mut slot = (hash_of(point) >> self.shift) as usize & mask;
            let mut run = 0;
            while self.slots[slot] != EMPTY {
                slot = (slot + 1) & mask;
                run += 1;
                if run > LONGEST_RUN {
                    return self.key(memory);
                }
            }
            self.slots[slot] = number as u32;
        }
        Ok(())
    }

    /// Goes over to the map with a secret key. Its order never shows.
    #[cold]
    fn key(&mut self, memory: &mut Memory<'_>) -> Result<(), OverBudget> {
        memory.take(self.positions.len(), KEYED_BYTES)?;
        let finite = self.positions.as_slice().iter().enumerate().filter(|(_, point)| point.is_finite());
        self.keyed = Some(finite.map(|(number, point)| (key_of(point), number as u32)).collect());
        // Guesses find nothing from now on.
        self.slots = Vec::new();
        Ok(())
    }

    fn look_up_keyed(&mut self, memory: &mut Memory<'_>, point: DVec3) -> Result<u32, OverBudget> {
        let next = self.positions.len() as u32;
        let number = *self.keyed.get_or_insert_default().entry(key_of(&point)).or_insert(next);
        if number == next {
            memory.take(1, KEYED_BYTES)?;
            self.positions.push(memory, point)?;
        }
        Ok(number)
    }

    /// A position that is equal to no other, not even to itself.
    pub(super) fn apart(&mut self, memory: &mut Memory<'_>, point: DVec3) -> Result<u32, OverBudget> {
        self.positions.push(memory, point)?;
        Ok(self.positions.len() as u32 - 1)
    }

    /// The positions in the order of their numbers.
    pub(super) fn into_positions(self) -> Vec<DVec3> {
        self.positions.into_vec()
    }
}

/// What an entry of the keyed map takes, with the room that the map leaves and its double while it grows.
const KEYED_BYTES: usize = 128;

/// Bits that are equal where positions are.
fn key_of(point: &DVec3) -> [u64; 3] {
    // Adding zero makes 0 of -0.
    (*point + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Mixes the bits of the coordinates so that the high bits depend on all of them. The multipliers are odd, without
/// pattern and unrelated, so that no lattice of positions lies on few slots.
#[inline]
fn hash_of(point: &DVec3) -> u64 {
    let [x, y, z] = key_of(point);
    let sum = x.wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ y.wrapping_mul(0xd6e8_feb8_6659_fd93).rotate_left(23)
        ^ z.wrapping_mul(0xa076_1d64_78bd_642f).rotate_left(46);
    (sum ^ (sum >> 32)).wrapping_mul(0xe703_7ed1_a0b4_28db)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Exec;
    use std::collections::BTreeMap;

    /// By an ordered map, which knows nothing of hashes.
    fn wanted(points: &[DVec3]) -> Vec<u32> {
        let mut known = BTreeMap::new();
        points
            .iter()
            .map(|point| {
                let next = known.len() as u32;
                *known.entry(key_of(point)).or_insert(next)
            })
            .collect()
    }

    fn found(points: &[DVec3], expected: usize) -> (Vec<u32>, Welder) {
        let exec = Exec::default();
        let memory = &mut Memory::new(&exec);
        let mut welder = Welder::new(memory, expected).unwrap();
        let mut numbers = vec![0; points.len()];
        welder.number(memory, points, &mut numbers).unwrap();
        (numbers, welder)
    }

    #[test]
    fn positions_are_numbered_as_they_first_come() {
        let mut state = 7u64;
        let mut next = |range: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % range) as f64
        };
        for (range, scale, expected) in [(3, 1.0, 0), (20, 0.1, 5), (20, 1e-300, 9000), (1000, 1e30, 10)] {
            let points: Vec<DVec3> =
                (0..9000).map(|_| DVec3::new(next(range), -next(range), next(2)) * scale).collect();
            let (numbers, welder) = found(&points, expected);
            assert_eq!(numbers, wanted(&points));
            assert!(welder.keyed.is_none());
            for (number, point) in numbers.iter().zip(&points) {
                assert_eq!(welder.positions.as_slice()[*number as usize], *point);
            }
        }
    }

    #[test]
    fn the_first_of_equal_positions_stays_and_zero_has_no_sign() {
        let points = [DVec3::new(-0.0, 1.0, 0.0), DVec3::new(0.0, 1.0, -0.0), DVec3::NAN, DVec3::NAN];
        let (numbers, welder) = found(&points, 2);
        assert_eq!(numbers, [0, 0, 1, 2]);
        assert!(welder.into_positions()[0].x.is_sign_negative());
    }

    /// An inverse of an odd number modulo 2⁶⁴ (Newton's iteration doubles the number of right bits).
    fn inverse(odd: u64) -> u64 {
        (0..6).fold(odd, |x, _| x.wrapping_mul(2u64.wrapping_sub(odd.wrapping_mul(x))))
    }

    /// Positions whose hashes differ only in bits that no table looks at.
    fn colliding(count: u64) -> Vec<DVec3> {
        let back = inverse(0xe703_7ed1_a0b4_28db);
        let x_back = inverse(0x9e37_79b9_7f4a_7c15);
        let made = (0..).map(|low: u64| {
            let mixed = low.wrapping_mul(back);
            let sum = mixed ^ (mixed >> 32);
            DVec3::new(f64::from_bits(sum.wrapping_mul(x_back)), 0.0, 0.0)
        });
        made.filter(|point| point.is_finite() && point.x != 0.0).take(count as usize).collect()
    }

    #[test]
    fn positions_made_to_collide_are_numbered_as_fast_as_others() {
        let mut points = colliding(60_000);
        assert!(points.iter().all(|point| hash_of(point) < 1 << 20), "they collide");
        points.extend_from_slice(&points.clone());
        points.push(-DVec3::ZERO);
        points.push(DVec3::ZERO);
        let (numbers, welder) = found(&points, 30_000);
        assert_eq!(numbers, wanted(&points));
        // Without the keyed map every look-up would pass by thousands of others.
        assert!(welder.keyed.is_some());
        assert_eq!(welder.positions.len(), 60_001);
    }
}
