//! How the triangles of one patch lie in its parameter square.

use crate::PatchSide;

/// A vertex of a patch's mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// The `k`-th sample of a side.
    Side(PatchSide, u32),
    /// The grid point of column `i` and row `j`, inside the patch.
    Inner(u32, u32),
}

/// A cell or triangle, counter-clockwise in the parameter square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    Cell([Node; 4]),
    Triangle([Node; 3]),
}

impl Piece {
    pub(super) fn nodes(&self) -> &[Node] {
        match self {
            Self::Cell(nodes) => nodes,
            Self::Triangle(nodes) => nodes,
        }
    }
}

/// A grid of `columns × rows` cells inside four sides that are sampled on their own.
///
/// Where a side has as many segments as the grid, the grid runs up to it; elsewhere a strip of triangles joins the side
/// to the first line of the grid inside. So every sample of every side is a vertex, and no other point of a side is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) columns: u32,
    pub(super) rows: u32,
    /// Segments of the bottom, top, left and right side.
    pub(super) sides: [u32; 4],
}

impl Layout {
    pub(super) fn segments(&self, side: PatchSide) -> u32 {
        self.sides[side as usize]
    }

    /// The number of grid cells along a side.
    pub(super) fn cells_along(&self, side: PatchSide) -> u32 {
        match side {
            PatchSide::Bottom | PatchSide::Top => self.columns,
            PatchSide::Left | PatchSide::Right => self.rows,
        }
    }

    fn matched(&self, side: PatchSide) -> bool {
        self.segments(side) == self.cells_along(side)
    }

    /// Makes room for a strip on both of two opposite sides where that is needed.
    pub(super) fn widened(mut self) -> Self {
        // Two columns may unmatch the bottom and top, two rows the left and right: each happens at most once.
        for _ in 0..2 {
            if !self.matched(PatchSide::Left) && !self.matched(PatchSide::Right) {
                self.columns = self.columns.max(2);
            }
            if !self.matched(PatchSide::Bottom) && !self.matched(PatchSide::Top) {
                self.rows = self.rows.max(2);
            }
        }
        self
    }

    /// The parameters of a node.
    pub(super) fn parameters(&self, node: Node) -> [f64; 2] {
        let part = |k: u32, count: u32| f64::from(k) / f64::from(count);
        match node {
            Node::Side(side, k) => {
                let t = part(k, self.segments(side));
                match side {
                    PatchSide::Bottom => [t, 0.0],
                    PatchSide::Top => [t, 1.0],
                    PatchSide::Left => [0.0, t],
                    PatchSide::Right => [1.0, t],
                }
            }
            Node::Inner(i, j) => [part(i, self.columns), part(j, self.rows)],
        }
    }

    /// The number of inner nodes.
    pub(super) fn inner_count(&self) -> u64 {
        u64::from(self.columns - 1) * u64::from(self.rows - 1)
    }

    /// No fewer triangles than the pieces make.
    pub(super) fn triangle_bound(&self) -> u64 {
        2 * u64::from(self.columns) * u64::from(self.rows) + self.sides.iter().map(|&n| u64::from(n)).sum::<u64>()
    }

    fn grid(&self, i: u32, j: u32) -> Node {
        if i == 0 {
            Node::Side(PatchSide::Left, j)
        } else if i == self.columns {
            Node::Side(PatchSide::Right, j)
        } else if j == 0 {
            Node::Side(PatchSide::Bottom, i)
        } else if j == self.rows {
            Node::Side(PatchSide::Top, i)
        } else {
            Node::Inner(i, j)
        }
    }

    /// Calls `f` with every piece: the cells row by row, then the strips.
    ///
    /// # Errors
    /// The first error of `f`.
    pub(super) fn pieces<E>(&self, mut f: impl FnMut(Piece) -> Result<(), E>) -> Result<(), E> {
        let matched = |side: PatchSide| u32::from(!self.matched(side));
        let (i0, i1) = (matched(PatchSide::Left), self.columns - matched(PatchSide::Right));
        let (j0, j1) = (matched(PatchSide::Bottom), self.rows - matched(PatchSide::Top));
        for j in j0..j1 {
            for i in i0..i1 {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                f(Piece::Cell(corners.map(|(i, j)| self.grid(i, j))))?;
            }
        }
        let row = |j: u32| (i0..=i1).map(|i| self.grid(i, j)).collect::<Vec<_>>();
        let column = |i: u32| (j0..=j1).map(|j| self.grid(i, j)).collect::<Vec<_>>();
        let samples = |side: PatchSide| (0..=self.segments(side)).map(|k| Node::Side(side, k)).collect::<Vec<_>>();
        for side in PatchSide::ALL.into_iter().filter(|&side| !self.matched(side)) {
            // Seen along rising parameters, with the right chain and the left chain beside the strip.
            let (right, left, axis) = match side {
                PatchSide::Bottom => (samples(side), row(j0), 0),
                PatchSide::Top => (row(j1), samples(side), 0),
                PatchSide::Left => (column(i0), samples(side), 1),
                PatchSide::Right => (samples(side), column(i1), 1),
            };
            self.zip(&right, &left, axis, &mut f)?;
        }
        Ok(())
    }

    /// Fills the strip between two chains, always going on along the one whose next segment has its middle first.
    fn zip<E>(
        &self,
        right: &[Node],
        left: &[Node],
        axis: usize,
        f: &mut impl FnMut(Piece) -> Result<(), E>,
    ) -> Result<(), E> {
        let at = |chain: &[Node], k: usize| self.parameters(chain[k])[axis];
        let middle = |chain: &[Node], k: usize| {
            if k + 1 < chain.len() { at(chain, k) + at(chain, k + 1) } else { f64::INFINITY }
        };
        let (mut r, mut l) = (0, 0);
        while r + 1 < right.len() || l + 1 < left.len() {
            if middle(right, r) <= middle(left, l) {
                f(Piece::Triangle([right[r], right[r + 1], left[l]]))?;
                r += 1;
            } else {
                f(Piece::Triangle([right[r], left[l + 1], left[l]]))?;
                l += 1;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Corners have a name on each of their two sides; one of them stands for both.
    fn unified(layout: &Layout, node: Node) -> [u64; 2] {
        layout.parameters(node).map(f64::to_bits)
    }

    #[test]
    fn pieces_cover_the_square_once_and_meet_along_whole_edges() {
        for code in 0..6u32.pow(4) {
            let sides = [0, 1, 2, 3].map(|k| [1, 2, 3, 4, 5, 7][(code / 6u32.pow(k) % 6) as usize]);
            for (columns, rows) in [(1, 1), (1, 3), (2, 2), (4, 3), (5, 7)] {
                let layout = Layout { columns, rows, sides }.widened();
                let mut area = 0.0;
                let mut edges: HashMap<([u64; 2], [u64; 2]), i32> = HashMap::new();
                layout
                    .pieces(|piece| {
                        let nodes = piece.nodes();
                        let [ux, uy] = layout.parameters(nodes[0]);
                        let spokes: Vec<[f64; 2]> = nodes.iter().map(|&node| layout.parameters(node)).collect();
                        for pair in spokes[1..].windows(2) {
                            let cross = (pair[0][0] - ux) * (pair[1][1] - uy) - (pair[0][1] - uy) * (pair[1][0] - ux);
                            assert!(cross > 0.0, "{layout:?} {piece:?}");
                            area += cross / 2.0;
                        }
                        for (k, &node) in nodes.iter().enumerate() {
                            let next = nodes[(k + 1) % nodes.len()];
                            let (a, b) = (unified(&layout, node), unified(&layout, next));
                            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
                        }
                        Ok::<(), ()>(())
                    })
                    .unwrap();
                assert!((area - 1.0).abs() < 1e-12, "{layout:?}");
                let border = edges.values().filter(|&&count| count != 0).count();
                assert_eq!(border, layout.sides.iter().sum::<u32>() as usize, "{layout:?}");
            }
        }
    }
}
