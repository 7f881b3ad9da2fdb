//! Answers that have each element once.

use std::collections::HashSet;

/// What was seen so far. Most answers are short: then it takes nothing from the heap.
#[derive(Default)]
pub(crate) struct Once {
    few: [u32; 16],
    count: usize,
    many: HashSet<u32>,
}

impl Once {
    /// Whether a number comes for the first time.
    pub(crate) fn is_new(&mut self, number: u32) -> bool {
        if self.few[..self.count].contains(&number) {
            return false;
        }
        if self.count < self.few.len() {
            self.few[self.count] = number;
            self.count += 1;
            return true;
        }
        self.many.insert(number)
    }
}

/// The numbers without those that came before.
pub(crate) fn once(numbers: impl Iterator<Item = u32>) -> impl Iterator<Item = u32> {
    let mut seen = Once::default();
    numbers.filter(move |&number| seen.is_new(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_comes_once_in_the_order_of_the_first() {
        let numbers = (0..300).map(|i| i * 7 % 100);
        assert!(once(numbers).eq((0..100).map(|i| i * 7 % 100)));
    }
}
