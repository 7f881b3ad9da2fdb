//! A stack that allocates only when it grows deep.

/// A stack whose first entries lie in place. Trees over awkward shapes may be deep, so depth has no bound.
pub(crate) struct Stack<T> {
    near: [T; NEAR],
    len: usize,
    deep: Vec<T>,
}

/// Eight-wide trees over a million triangles keep under 60 entries open.
const NEAR: usize = 64;

impl<T: Copy> Stack<T> {
    pub fn new(filler: T) -> Self {
        Self { near: [filler; NEAR], len: 0, deep: Vec::new() }
    }

    pub fn clear(&mut self) {
        self.len = 0;
        self.deep.clear();
    }

    pub fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub fn push(&mut self, entry: T) {
        if self.len < NEAR {
            self.near[self.len] = entry;
        } else {
            self.deep.push(entry);
        }
        self.len += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        if self.len < NEAR { Some(self.near[self.len]) } else { self.deep.pop() }
    }

    /// Pushes an entry below those from `bottom` on that must leave before it: `after(a, b)` says that `a` leaves
    /// after `b`.
    #[inline(always)]
    pub fn push_sorted(&mut self, bottom: usize, entry: T, after: impl Fn(&T, &T) -> bool) {
        self.push(entry);
        let mut place = self.len - 1;
        while place > bottom && after(&entry, self.at(place - 1)) {
            *self.at(place) = *self.at(place - 1);
            place -= 1;
        }
        *self.at(place) = entry;
    }

    #[inline(always)]
    fn at(&mut self, place: usize) -> &mut T {
        if place < NEAR { &mut self.near[place] } else { &mut self.deep[place - NEAR] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_leave_in_order_however_deep() {
        let mut stack = Stack::new(0);
        for round in 0..50 {
            let bottom = stack.len();
            for key in [3, 1, 4, 2] {
                stack.push_sorted(bottom, round * 10 + key, |a, b| a > b);
            }
        }
        for round in (0..50).rev() {
            for key in 1..=4 {
                assert_eq!(stack.pop(), Some(round * 10 + key));
            }
        }
        assert_eq!(stack.pop(), None);
    }
}
