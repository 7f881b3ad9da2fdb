//! Disjoint sets (Tarjan 1975), with the parity of the way to each set's representative.

/// Sets of the numbers below a length. The representative of a set is its smallest member.
#[derive(Debug)]
pub(crate) struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Each number alone.
    pub fn new(len: usize) -> Self {
        Self((0..len as u32).collect())
    }

    /// The smallest member of the set of `item`.
    pub fn find(&mut self, mut item: u32) -> u32 {
        loop {
            let parent = self.0[item as usize];
            let above = self.0[parent as usize];
            if parent == above {
                return parent;
            }
            // Halves the way for those who come later.
            self.0[item as usize] = above;
            item = above;
        }
    }

    /// Joins the sets of two members.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        // Parents are smaller than their children: ways stay short by halving, and the smallest represents.
        if a < b {
            self.0[b as usize] = a;
        } else {
            self.0[a as usize] = b;
        }
    }

    /// Whether an item represents its set.
    pub fn is_first(&self, item: u32) -> bool {
        self.0[item as usize] == item
    }
}

/// Sets whose members are of one of two kinds relative to each other.
#[derive(Debug)]
pub(crate) struct TwoColoring {
    parents: Vec<u32>,
    /// Whether an item differs from its parent.
    differs: Vec<bool>,
}

impl TwoColoring {
    /// Each number alone.
    pub fn new(len: usize) -> Self {
        Self { parents: (0..len as u32).collect(), differs: vec![false; len] }
    }

    /// The representative of the set of `item`, and whether the item differs from it.
    pub fn find(&mut self, mut item: u32) -> (u32, bool) {
        let mut parity = false;
        loop {
            let at = item as usize;
            let parent = self.parents[at];
            if parent == item {
                return (item, parity);
            }
            let above = self.parents[parent as usize];
            if above != parent {
                self.differs[at] ^= self.differs[parent as usize];
                self.parents[at] = above;
            }
            parity ^= self.differs[at];
            item = self.parents[at];
        }
    }

    /// Says that two items are of different kinds, or of the same. False if that contradicts what was said before.
    pub fn relate(&mut self, a: u32, b: u32, different: bool) -> bool {
        let ((a, a_differs), (b, b_differs)) = (self.find(a), self.find(b));
        let parity = a_differs ^ b_differs ^ different;
        if a == b {
            return !parity;
        }
        let (root, child) = (a.min(b), a.max(b));
        self.parents[child as usize] = root;
        self.differs[child as usize] = parity;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_member_represents_its_set() {
        let mut sets = DisjointSets::new(8);
        for (a, b) in [(5, 6), (6, 7), (3, 7), (0, 1)] {
            sets.join(a, b);
        }
        let found: Vec<u32> = (0..8).map(|item| sets.find(item)).collect();
        assert_eq!(found, [0, 0, 2, 3, 4, 3, 3, 3]);
        assert!(sets.is_first(3) && !sets.is_first(5));
    }

    #[test]
    fn an_odd_cycle_contradicts_and_an_even_one_does_not() {
        for (length, sound) in [(4u32, true), (5, false), (1000, true), (1001, false)] {
            let mut coloring = TwoColoring::new(length as usize);
            let fits = (0..length).all(|item| coloring.relate(item, (item + 1) % length, true));
            assert_eq!(fits, sound, "{length}");
        }
        assert!(!TwoColoring::new(1).relate(0, 0, true));
    }
}
