//! What meets at a place between eight cells.

use crate::full_cells::FullCells;

/// Edges at a place: edge `2 * axis + side`, side 1 in the direction of the axis.
pub(super) const EDGES: usize = 6;

/// Which of the eight cells around a place are full: bit `x + 2 y + 4 z`, with 1 for the cells beyond the place.
pub(super) fn around(cells: &FullCells, place: [u32; 3]) -> u8 {
    (0..8u8).fold(0, |mask, octant| {
        let cell = std::array::from_fn(|axis| i64::from(place[axis]) - 1 + i64::from(octant >> axis & 1));
        mask | u8::from(cells.is_full(cell)) << octant
    })
}

/// The four octants around an edge, in a circle.
fn circle(edge: usize) -> [u8; 4] {
    let (axis, side) = (edge / 2, (edge % 2) as u8);
    let (u, v) = (1u8 << ((axis + 1) % 3), 1u8 << ((axis + 2) % 3));
    let base = side << axis;
    [base, base | u, base | u | v, base | v]
}

/// The edges around which full and empty cells alternate, a bit each.
pub(super) fn crossed_edges(mask: u8) -> u8 {
    (0..EDGES).fold(0, |crossed, edge| {
        let [a, b, c, d] = circle(edge).map(|octant| mask >> octant & 1);
        crossed | u8::from(a == c && b == d && a != b) << edge
    })
}

/// The number of the quarter face between two neighbouring octants: `4 * axis` and the two other coordinates.
fn quarter(octant: u8, axis: usize) -> usize {
    let (u, v) = (octant >> ((axis + 1) % 3) & 1, octant >> ((axis + 2) % 3) & 1);
    4 * axis + usize::from(u) + 2 * usize::from(v)
}

/// The fans of faces at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fans {
    /// How many.
    pub count: u8,
    /// The fan of each quarter face; 0 where there is none.
    fan: [u8; 12],
}

impl Fans {
    /// The fans where faces at an edge of four are paired by full cell, or by gap where `by_gap` has the edge's bit.
    pub fn new(mask: u8, by_gap: u8) -> Self {
        let mut parent: [u8; 12] = std::array::from_fn(|quarter| quarter as u8);
        fn root(parent: &[u8; 12], mut at: u8) -> u8 {
            while parent[usize::from(at)] != at {
                at = parent[usize::from(at)];
            }
            at
        }
        let full = |octant: u8| mask >> octant & 1 == 1;
        for edge in 0..EDGES {
            let ring = circle(edge);
            // The quarter face between places n and n + 1 of the ring.
            let faces: [usize; 4] = std::array::from_fn(|n| {
                let (a, b) = (ring[n], ring[(n + 1) % 4]);
                quarter(a.min(b), usize::from((a ^ b).trailing_zeros() as u8))
            });
            let shown = |n: usize| full(ring[n]) != full(ring[(n + 1) % 4]);
            let mut join = |a: usize, b: usize| {
                let (a, b) = (root(&parent, a as u8), root(&parent, b as u8));
                parent[usize::from(a.max(b))] = a.min(b);
            };
            if crossed_edges(mask) >> edge & 1 == 1 {
                // The faces n - 1 and n are those of cell n.
                let wanted = by_gap >> edge & 1 == 0;
                for n in (0..4).filter(|&n| full(ring[n]) == wanted) {
                    join(faces[(n + 3) % 4], faces[n]);
                }
            } else {
                let two: [Option<usize>; 4] = std::array::from_fn(|n| shown(n).then(|| faces[n]));
                let mut two = two.into_iter().flatten();
                if let (Some(a), Some(b)) = (two.next(), two.next()) {
                    join(a, b);
                }
            }
        }
        let mut fan = [0u8; 12];
        let mut count = 0;
        for axis in 0..3 {
            for octant in
                (0..8u8).filter(|octant| octant >> axis & 1 == 0 && full(*octant) != full(*octant | 1 << axis))
            {
                let at = quarter(octant, axis);
                // A root is the smallest of its fan, so it comes first.
                let first = usize::from(root(&parent, at as u8));
                if first == at {
                    fan[at] = count;
                    count += 1;
                } else {
                    fan[at] = fan[first];
                }
            }
        }
        Self { count, fan }
    }

    /// One vertex for all, if there is a face.
    pub fn together(mask: u8) -> Self {
        Self { count: u8::from(mask != 0 && mask != u8::MAX), fan: [0; 12] }
    }

    /// The fan of the face of a cell across an axis, at a place that is one of its corners.
    pub fn of_face(&self, cell: [u32; 3], axis: usize, place: [u32; 3]) -> u32 {
        let octant = (0..3).fold(0u8, |octant, other| octant | u8::from(cell[other] == place[other]) << other);
        u32::from(self.fan[quarter(octant, axis)])
    }

    /// Whether all four faces at an edge of four belong to one fan.
    pub fn same_at(&self, edge: usize) -> bool {
        let ring = circle(edge);
        let fans: [u8; 4] = std::array::from_fn(|n| {
            let (a, b) = (ring[n], ring[(n + 1) % 4]);
            self.fan[quarter(a.min(b), (a ^ b).trailing_zeros() as usize)]
        });
        fans.iter().all(|&fan| fan == fans[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_corners_that_cells_share_part_their_fans() {
        // Two cells along an edge, two at a corner, one, and all but one.
        assert_eq!(Fans::new(0b0000_1001, 0).count, 2);
        assert_eq!(Fans::new(0b1000_0001, 0).count, 2);
        assert_eq!(Fans::new(0b0000_0001, 0).count, 1);
        assert_eq!(Fans::new(0b1111_1110, 0).count, 1);
        assert_eq!((Fans::new(0, 0).count, Fans::new(255, 0).count), (0, 0));
        // Two empty cells at opposite corners, and a checkerboard.
        assert_eq!(Fans::new(0b0111_1110, 0).count, 2);
        assert_eq!(Fans::new(0b0110_1001, 0).count, 4);
    }

    /// Four full cells over two that touch along an edge: by cell one fan of six faces, by gap two of three.
    #[test]
    fn an_edge_pairs_its_faces_one_way_or_the_other() {
        let mask = 0b1111_1001;
        assert_eq!(crossed_edges(mask), 1 << 4);
        let by_cell = Fans::new(mask, 0);
        assert_eq!(by_cell.count, 1);
        assert!(by_cell.same_at(4));
        let by_gap = Fans::new(mask, 1 << 4);
        assert_eq!(by_gap.count, 2);
        assert!(!by_gap.same_at(4));
    }

    /// Pairing the other way parts a fan that has all four faces, and never joins any others: what the order of
    /// decisions rests on.
    #[test]
    fn pairing_the_other_way_only_parts_fans() {
        for mask in 0..=255u8 {
            let crossed = crossed_edges(mask);
            for by_gap in (0..64u8).filter(|by_gap| by_gap & !crossed == 0) {
                let fans = Fans::new(mask, by_gap);
                for edge in (0..EDGES).filter(|edge| crossed >> edge & 1 == 1) {
                    let other = Fans::new(mask, by_gap ^ 1 << edge);
                    if fans.same_at(edge) {
                        assert_eq!(other.count, fans.count + 1);
                        for a in 0..12 {
                            for b in 0..12 {
                                assert!(fans.fan[a] == fans.fan[b] || other.fan[a] != other.fan[b]);
                            }
                        }
                        assert!(!other.same_at(edge));
                    }
                }
            }
        }
    }
}
