//! Room for results whose size is not known before.

use shapeloom_core::{Exec, OverBudget, Reservation};

/// How much more than what is expected is made room for. Where the parts of a lattice differ by less, nothing is copied; room that
/// is not written to is given back, and was never more than addresses.
const SPARE: f64 = 1.0625;

/// The largest step: a surface may begin with a single triangle, or end with the first layer.
const LARGEST_STEP: usize = 16;

/// Makes room for so many elements in all when a part of the lattice is done: first taken from the budget, and for as many as there
/// will be if it goes on like this, where the budget has that much. What grows often is copied often.
pub(crate) fn grow<T>(
    vector: &mut Vec<T>,
    needed: usize,
    part: f64,
    memory: &mut Vec<Reservation>,
    exec: &Exec,
) -> Result<(), OverBudget> {
    let held = vector.capacity();
    if needed > held {
        let expected = if part < 1.0 { (needed as f64 * SPARE / part) as usize } else { needed };
        let expected = expected.clamp(needed, needed.saturating_mul(LARGEST_STEP));
        let reserve = |capacity: usize| exec.reserve_elements((capacity - held) as u64, size_of::<T>());
        let (capacity, reserved) = match reserve(expected) {
            Ok(reserved) => (expected, reserved),
            Err(_) => (needed, reserve(needed)?),
        };
        memory.push(reserved);
        vector.reserve_exact(capacity - vector.len());
    }
    Ok(())
}

/// Gives back room that was made and not needed, where it is much: a little was never written to, and a block of the size that was
/// asked for serves the next surface again.
pub(crate) fn give_back<T>(vector: &mut Vec<T>) {
    if vector.capacity() - vector.len() > vector.len() / 4 {
        vector.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_for_what_is_expected_where_the_budget_has_it() {
        let mut memory = Vec::new();
        let mut numbers: Vec<u64> = Vec::new();
        let exec = Exec::default().with_memory(8000);
        grow(&mut numbers, 100, 0.25, &mut memory, &exec).unwrap();
        assert_eq!((numbers.capacity(), exec.memory_taken()), (425, 3400));
        // Twice as many are expected as the budget has: it has those that are needed.
        grow(&mut numbers, 800, 0.5, &mut memory, &exec).unwrap();
        assert_eq!((numbers.capacity(), exec.memory_taken()), (800, 6400));
        grow(&mut numbers, 700, 0.5, &mut memory, &exec).unwrap();
        assert_eq!(grow(&mut numbers, 1001, 1.0, &mut memory, &exec).unwrap_err().taken, 6400);
        assert_eq!(numbers.capacity(), 800);
    }

    #[test]
    fn a_few_at_the_start_do_not_take_everything() {
        let mut numbers: Vec<u8> = Vec::new();
        grow(&mut numbers, 10, 1e-9, &mut Vec::new(), &Exec::default()).unwrap();
        assert_eq!(numbers.capacity(), 160);
    }
}
