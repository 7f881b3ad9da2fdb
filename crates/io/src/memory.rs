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

/// Makes room for more elements in a plain vector, as [`Growing`] does in its own.
#[inline]
pub(crate) fn make_room<T>(memory: &mut Memory<'_>, vector: &mut Vec<T>, more: usize) -> Result<(), OverBudget> {
    if vector.capacity() - vector.len() < more {
        let more = more.max(vector.len()).max(64);
        memory.take(more, size_of::<T>())?;
        vector.reserve_exact(more);
    }
    Ok(())
}

impl<'e> Memory<'e> {
    /// Holds what others have reserved.
    pub(crate) fn adopt(&mut self, others: impl IntoIterator<Item = Memory<'e>>) {
        for other in others {
            self.held.extend(other.held);
            self.total += other.total;
        }
    }
}

/// A vector that reserves memory before it grows.
#[derive(Debug)]
pub(crate) struct Growing<T>(Vec<T>);

impl<T> Default for Growing<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Growing<T> {
    /// An empty vector with room for `count` elements that are known to be there, not merely claimed.
    pub(crate) fn with_room(memory: &mut Memory<'_>, count: usize) -> Result<Self, OverBudget> {
        memory.take(count, size_of::<T>())?;
        Ok(Self(Vec::with_capacity(count)))
    }

    /// A vector whose memory was reserved elsewhere.
    pub(crate) fn from_vec(elements: Vec<T>) -> Self {
        Self(elements)
    }

    #[inline]
    pub(crate) fn push(&mut self, memory: &mut Memory<'_>, element: T) -> Result<(), OverBudget> {
        if self.0.len() == self.0.capacity() {
            self.grow(memory, 1)?;
        }
        self.0.push(element);
        Ok(())
    }

    #[inline]
    pub(crate) fn extend(&mut self, memory: &mut Memory<'_>, elements: &[T]) -> Result<(), OverBudget>
    where
        T: Copy,
    {
        if self.0.capacity() - self.0.len() < elements.len() {
            self.grow(memory, elements.len())?;
        }
        self.0.extend_from_slice(elements);
        Ok(())
    }

    /// Adds the elements of an iterator that knows how many there are.
    #[inline]
    pub(crate) fn extend_exact(
        &mut self,
        memory: &mut Memory<'_>,
        elements: impl ExactSizeIterator<Item = T>,
    ) -> Result<(), OverBudget> {
        if self.0.capacity() - self.0.len() < elements.len() {
            self.grow(memory, elements.len())?;
        }
        self.0.extend(elements);
        Ok(())
    }

    /// Makes room for `count` elements in all, which are known to be there.
    pub(crate) fn reserve(&mut self, memory: &mut Memory<'_>, count: usize) -> Result<(), OverBudget> {
        let more = count.saturating_sub(self.0.capacity());
        if more > 0 {
            memory.take(more, size_of::<T>())?;
            self.0.reserve_exact(count - self.0.len());
        }
        Ok(())
    }

    #[cold]
    fn grow(&mut self, memory: &mut Memory<'_>, more: usize) -> Result<(), OverBudget> {
        make_room(memory, &mut self.0, more)
    }

    /// Adds the elements of another vector; that one itself where this is empty.
    pub(crate) fn append(&mut self, memory: &mut Memory<'_>, other: Self) -> Result<(), OverBudget>
    where
        T: Copy,
    {
        if self.0.is_empty() {
            *self = other;
            return Ok(());
        }
        self.extend(memory, &other.0)
    }

    /// Forgets all but the first elements; the memory stays.
    pub(crate) fn truncate(&mut self, count: usize) {
        self.0.truncate(count);
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        &self.0
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.0
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn into_vec(self) -> Vec<T> {
        self.0
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

    #[test]
    fn vectors_reserve_before_they_grow() {
        let exec = Exec::default().with_memory(100_000);
        let mut memory = Memory::new(&exec);
        let mut numbers = Growing::default();
        let fits = (0u64..).take_while(|&number| numbers.push(&mut memory, number).is_ok()).count();
        assert!((4096..=12_500).contains(&fits), "{fits}");
        assert_eq!(numbers.len(), fits);
        assert!(exec.memory_taken() >= 8 * fits as u64);
    }
}
