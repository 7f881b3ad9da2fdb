//! What was found: exact counts, and the first pairs of each class.

use shapeloom_core::{Exec, OverBudget, Reservation};

use super::equal_faces::Groups;
use super::{FacePair, PairKind};

/// Pairs of one class: how many there are, and the first of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PairList {
    /// How many pairs there are, listed or not.
    pub total: u64,
    /// The pairs with the smallest face numbers, sorted; at most as many as the caller asked for.
    pub listed: Vec<FacePair>,
}

/// Where a mesh meets itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SelfIntersections {
    /// Pairs of which one passes through the other: [`PairKind::Crossing`] and [`PairKind::CrossingAtCorner`].
    pub crossing: PairList,
    /// Pairs in one plane that overlap in an area: [`PairKind::Folded`] and [`PairKind::Overlap`].
    pub overlapping: PairList,
    /// Pairs that only touch: [`PairKind::Contact`], [`PairKind::Duplicate`], [`PairKind::Coincident`],
    /// [`PairKind::TouchAlongSegment`] and [`PairKind::TouchAtPoint`].
    pub touching: PairList,
    counts: [u64; PairKind::ALL.len()],
}

impl SelfIntersections {
    /// Whether the inside of a face passes through the inside of another: the pairs of [`SelfIntersections::crossing`]
    /// alone. Faces that lie on one another, as in the contact of two solids, do not cross.
    ///
    /// A surface that passes through another exactly along its own sides or through its own corners consists of pairs
    /// that only touch; [`SelfIntersections::is_embedded`] is false then.
    pub fn crosses(&self) -> bool {
        self.crossing.total > 0
    }

    /// Whether faces meet in nothing but corners and sides that they share: no pair of any kind.
    pub fn is_embedded(&self) -> bool {
        self.counts.iter().all(|&count| count == 0)
    }

    /// How many pairs there are of a kind.
    pub fn count(&self, kind: PairKind) -> u64 {
        self.counts[kind as usize]
    }
}

/// Counts and lists in the making.
#[derive(Debug)]
pub(super) struct Tally<'a> {
    counts: [u64; PairKind::ALL.len()],
    lists: [Smallest<'a>; 3],
}

impl<'a> Tally<'a> {
    pub fn new(limit: usize, exec: &'a Exec) -> Self {
        let list = || Smallest { limit, exec, pairs: Vec::new(), _memory: None };
        Self { counts: Default::default(), lists: [list(), list(), list()] }
    }

    /// Adds every pair of a face of one group and a face of another, which meet as the first face of each does but that
    /// some look the other way: overlap and contact change places for them.
    pub fn add_turned(
        &mut self,
        groups: [&[u32]; 2],
        kind: PairKind,
        turned: impl Fn(u32, u32) -> bool,
    ) -> Result<(), OverBudget> {
        let other = match kind {
            PairKind::Overlap => PairKind::Contact,
            PairKind::Contact => PairKind::Overlap,
            _ => return self.add(groups, kind),
        };
        if groups.iter().all(|group| group.len() == 1) {
            return self.add(groups, kind);
        }
        let parts = groups.map(|group| group.iter().partition::<Vec<u32>, _>(|&&face| !turned(group[0], face)));
        let [(a, a_turned), (b, b_turned)] = &parts;
        for (one, two, kind) in [(a, b, kind), (a_turned, b_turned, kind), (a, b_turned, other), (a_turned, b, other)] {
            self.add([one, two], kind)?;
        }
        Ok(())
    }

    /// Adds every pair of a face of one group and a face of another.
    pub fn add(&mut self, groups: [&[u32]; 2], kind: PairKind) -> Result<(), OverBudget> {
        let count = groups.iter().fold(1, |count: u64, group| count.saturating_mul(group.len() as u64));
        self.count(kind, count);
        let limit = self.lists[class(kind)].limit;
        for (i, &a) in groups[0].iter().enumerate().take(limit) {
            // With i and j elements before them, a and b have (i + 1) (j + 1) - 1 smaller pairs.
            for &b in groups[1].iter().take(limit / (i + 1)) {
                self.list(FacePair { faces: [a.min(b), a.max(b)], kind })?;
            }
        }
        Ok(())
    }

    /// Adds the pairs inside a group of faces with equal corners, of which some look the other way.
    pub fn add_coincident(&mut self, group: &[u32], turned: impl Fn(u32, u32) -> bool) -> Result<(), OverBudget> {
        let (same, opposite) = group.iter().partition::<Vec<u32>, _>(|&&face| !turned(group[0], face));
        for part in [&same, &opposite] {
            let count = part.len() as u64;
            let kind = PairKind::Duplicate;
            self.count(kind, count * count.saturating_sub(1) / 2);
            let pairs = part.iter().enumerate().flat_map(|(i, &a)| part[i + 1..].iter().map(move |&b| [a, b]));
            pairs.take(self.lists[class(kind)].limit).try_for_each(|faces| self.list(FacePair { faces, kind }))?;
        }
        self.add([&same, &opposite], PairKind::Coincident)
    }

    /// Adds what another has counted and listed.
    pub fn merge(&mut self, other: Self) -> Result<(), OverBudget> {
        for (mine, count) in self.counts.iter_mut().zip(other.counts) {
            *mine = mine.saturating_add(count);
        }
        for (mine, theirs) in self.lists.iter_mut().zip(other.lists) {
            theirs.pairs.into_iter().try_for_each(|pair| mine.push(pair))?;
        }
        Ok(())
    }

    pub fn finish(self) -> SelfIntersections {
        let counts = self.counts;
        let mut lists = self.lists.into_iter().map(Smallest::finish);
        let mut next = |of: fn(PairKind) -> bool| PairList {
            total: PairKind::ALL
                .into_iter()
                .filter(|&kind| of(kind))
                .fold(0, |total: u64, kind| total.saturating_add(counts[kind as usize])),
            listed: lists.next().unwrap_or_default(),
        };
        SelfIntersections {
            crossing: next(PairKind::crosses),
            overlapping: next(PairKind::overlaps),
            touching: next(PairKind::touches),
            counts,
        }
    }

    fn count(&mut self, kind: PairKind, count: u64) {
        let mine = &mut self.counts[kind as usize];
        *mine = mine.saturating_add(count);
    }

    fn list(&mut self, pair: FacePair) -> Result<(), OverBudget> {
        self.lists[class(pair.kind)].push(pair)
    }
}

/// Which list a kind goes to, in the order of [`SelfIntersections`].
fn class(kind: PairKind) -> usize {
    match kind {
        kind if kind.crosses() => 0,
        kind if kind.overlaps() => 1,
        _ => 2,
    }
}

/// The smallest pairs of those seen, in memory for twice as many.
#[derive(Debug)]
struct Smallest<'a> {
    limit: usize,
    exec: &'a Exec,
    pairs: Vec<FacePair>,
    _memory: Option<Reservation>,
}

impl Smallest<'_> {
    fn push(&mut self, pair: FacePair) -> Result<(), OverBudget> {
        if self.limit == 0 {
            return Ok(());
        }
        if self.pairs.len() == self.pairs.capacity() {
            let most = self.limit.saturating_mul(2).max(64);
            if self.pairs.len() >= most {
                self.pairs.select_nth_unstable(self.limit);
                self.pairs.truncate(self.limit);
            } else {
                let wanted = self.pairs.len().saturating_mul(2).clamp(64, most);
                // Beside the old one while the pairs move.
                let memory = self.exec.reserve_elements(wanted as u64, size_of::<FacePair>())?;
                self.pairs.reserve_exact(wanted - self.pairs.len());
                self._memory = Some(memory);
            }
        }
        self.pairs.push(pair);
        Ok(())
    }

    fn finish(mut self) -> Vec<FacePair> {
        self.pairs.sort_unstable();
        self.pairs.truncate(self.limit);
        self.pairs.shrink_to_fit();
        self.pairs
    }
}

/// Every pair inside the groups of equal faces.
pub(super) fn add_equal_faces(
    tally: &mut Tally,
    groups: &Groups,
    turned: impl Fn(u32, u32) -> bool,
    exec: &Exec,
) -> Result<(), crate::JudgeError> {
    for group in 0..groups.len() as u32 {
        if group % 4096 == 0 {
            exec.check()?;
        }
        if groups.get(group).len() > 1 {
            tally.add_coincident(groups.get(group), &turned)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever order pairs come in and wherever they are cut, the smallest are listed.
    #[test]
    fn the_smallest_pairs_are_listed_and_all_are_counted() {
        let exec = Exec::default();
        let all: Vec<[u32; 2]> = (0..40u32).flat_map(|a| (a + 1..40).map(move |b| [a, b])).collect();
        for limit in [0, 1, 7, 100, 10_000] {
            let mut tally = Tally::new(limit, &exec);
            for part in 0..5 {
                let mut one = Tally::new(limit, &exec);
                for (k, _) in all.iter().enumerate().filter(|(k, _)| k % 5 == part) {
                    let [a, b] = all[k * 7919 % all.len()];
                    one.add([&[b], &[a]], PairKind::Overlap).unwrap();
                }
                tally.merge(one).unwrap();
            }
            let found = tally.finish().overlapping;
            assert_eq!(found.total, 780);
            let listed: Vec<[u32; 2]> = found.listed.iter().map(|pair| pair.faces).collect();
            assert_eq!(listed, all[..limit.min(780)]);
        }
        assert_eq!(exec.memory_taken(), 0);
    }

    #[test]
    fn groups_are_listed_by_their_smallest_pairs() {
        let exec = Exec::default();
        let (first, second) = ([2, 3, 10, 40], [1, 5, 6, 30, 31]);
        let mut all: Vec<[u32; 2]> =
            first.iter().flat_map(|&a| second.iter().map(move |&b| [a.min(b), a.max(b)])).collect();
        all.sort_unstable();
        for limit in 0..25 {
            let mut tally = Tally::new(limit, &exec);
            tally.add([&first, &second], PairKind::Crossing).unwrap();
            tally.add_coincident(&first, |_, _| false).unwrap();
            let found = tally.finish();
            assert_eq!((found.crossing.total, found.touching.total), (20, 6));
            let listed: Vec<[u32; 2]> = found.crossing.listed.iter().map(|pair| pair.faces).collect();
            assert_eq!(listed, all[..limit.min(20)]);
            assert_eq!(found.touching.listed.len(), limit.min(6));
        }
    }

    #[test]
    fn lists_keep_to_the_memory() {
        let exec = Exec::default().with_memory(10_000);
        let mut tally = Tally::new(usize::MAX, &exec);
        let faces: Vec<u32> = (0..2000).collect();
        assert!(tally.add([&[5000], &faces], PairKind::Crossing).is_err());
        let mut tally = Tally::new(100, &exec);
        assert!(tally.add([&[5000], &faces], PairKind::Crossing).is_ok());
        assert_eq!(tally.finish().crossing.total, 2000);
    }
}
