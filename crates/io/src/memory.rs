//! Memory that grows with an input.

use shapeloom_core::{Exec, OverBudget, Reservation};

/// The smallest amount asked of the budget at once, so that small amounts do not each cost a reservation.
const BLOCK: u64 = 1 << 14;

/// What a reader has reserved so far; all of it returns when this is dropped.
pub(crate) struct Memory<'e> {
    exec: &'e Exec,
    held: Vec<Reservation>,
    total: u64,
    room: u64,
}

impl<'e> Memory<'e> {
    pub(crate) fn new(exec: &'e Exec) -> Self {
        Self { exec, held: Vec::new(), total: 0, room: 0 }
    }

    /// Reserves `count` elements of `size` bytes before they are allocated.
    pub(crate) fn take(&mut self, count: usize, size: usize) -> Result<(), OverBudget> {
        let bytes = (count as u64).saturating_mul(size as u64);
        if bytes > self.room {
            let missing = bytes - self.room;
            // An eighth more than is held keeps the number of reservations logarithmic; near the limit ask exactly.
            let generous = missing.max(BLOCK).max(self.total / 8);
            let more = self.exec.reserve(generous).or_else(|_| self.exec.reserve(missing))?;
            self.room += more.bytes();
            self.total += more.bytes();
            self.held.push(more);
        }
        self.room -= bytes;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_is_used_to_the_last_byte_and_returned() {
        let exec = Exec::default().with_memory(100_000);
        let mut memory = Memory::new(&exec);
        for _ in 0..100 {
            memory.take(250, 4).unwrap();
        }
        assert!(memory.take(1, 1).is_err());
        assert!(memory.held.len() < 20);
        drop(memory);
        assert_eq!(exec.memory_taken(), 0);
        assert!(Memory::new(&exec).take(usize::MAX, 8).is_err());
    }
}
