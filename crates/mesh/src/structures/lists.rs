//! Many short lists of numbers in two arrays: what is known as compressed sparse rows.

use std::ops::Range;

use shapeloom_core::{Exec, Stop};

use super::triangle_half_edges::NONE;

/// Numbers that are looked at between two polls.
const PART: usize = 1 << 16;

/// Lists of numbers, one after another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// List `i` is `items[starts[i]..starts[i + 1]]`; the caller has seen to it that the starts rise from 0 to the end.
    pub(crate) fn new(starts: Vec<u32>, items: Vec<u32>) -> Self {
        debug_assert!(starts.first() == Some(&0) && starts.last().is_some_and(|&end| end as usize == items.len()));
        Self { starts, items }
    }

    /// The numbers below `total`, each in the list that `list_of` names, or in none where it gives [`NONE`]; they rise in every
    /// list. Two passes.
    pub(crate) fn grouped(lists: usize, total: usize, list_of: impl Fn(u32) -> u32, exec: &Exec) -> Result<Self, Stop> {
        let mut starts = vec![0u32; lists + 1];
        let each = |f: &mut dyn FnMut(u32, usize)| {
            for part in 0..total.div_ceil(PART) {
                exec.check()?;
                for item in part * PART..((part + 1) * PART).min(total) {
                    let list = list_of(item as u32);
                    if list != NONE {
                        f(item as u32, list as usize);
                    }
                }
            }
            Ok::<_, Stop>(())
        };
        each(&mut |_, list| starts[list + 1] += 1)?;
        for list in 0..lists {
            starts[list + 1] += starts[list];
        }
        // While they are filled, `starts[i]` is where list i goes on; afterwards that is the start of the next one.
        let mut items = vec![0u32; starts[lists] as usize];
        each(&mut |item, list| {
            items[starts[list] as usize] = item;
            starts[list] += 1;
        })?;
        starts.rotate_right(1);
        starts[0] = 0;
        Ok(Self { starts, items })
    }

    /// The same lists with other items.
    #[must_use]
    pub(crate) fn map(mut self, f: impl Fn(u32) -> u32) -> Self {
        self.items.iter_mut().for_each(|item| *item = f(*item));
        self
    }

    /// How many lists there are.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where a list lies among all items.
    pub(crate) fn range(&self, list: u32) -> Range<usize> {
        self.starts[list as usize] as usize..self.starts[list as usize + 1] as usize
    }

    /// A list.
    pub(crate) fn of(&self, list: u32) -> &[u32] {
        &self.items[self.range(list)]
    }

    /// The list in which an item lies, by its place among all.
    pub(crate) fn list_of(&self, place: u32) -> u32 {
        self.starts.partition_point(|&start| start <= place) as u32 - 1
    }

    /// Where each list starts, and the number of items at the end.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The items of all lists.
    pub(crate) fn items(&self) -> &[u32] {
        &self.items
    }

    /// The memory that they take.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice()) + size_of_val(self.items.as_slice())
    }
}

impl Default for Lists {
    fn default() -> Self {
        Self { starts: vec![0], items: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_in_their_order() {
        let lists = Lists::grouped(4, 7, |i| [2, 0, NONE, 2, 3, 0, 2][i as usize], &Exec::default()).unwrap();
        assert_eq!((lists.starts(), lists.items()), (&[0, 2, 2, 5, 6][..], &[1, 5, 0, 3, 6, 4][..]));
        assert_eq!((0..6).map(|place| lists.list_of(place)).collect::<Vec<_>>(), [0, 0, 2, 2, 2, 3]);
        assert_eq!(Lists::grouped(0, 0, |i| i, &Exec::default()).unwrap(), Lists::default());
    }
}
