//! The triangles of a cell for each choice of its inside corners, in the form that marching needs.

use std::sync::LazyLock;

use crate::cube_cycles::{CUBE_EDGES, Outlines};

/// An edge of a cell: the corner that it starts from and its direction, both as the number `x + 2y + 4z` of a corner.
pub(crate) type CellEdge = (u8, u8);

/// Where marching goes along a row of cells, it counts the crossed edges that it meets: one counter for each direction of edges and
/// each of the four rows of samples at the cell from which such edges start. What a counter says before a cell is the number of
/// the vertex on the cell's edge at `x = 0`; what it says after it is that of the edge at `x = 1`. Cells without surface have no
/// crossed edges and may be left out.
///
/// `D` is the number of directions, `C` the number of counters, a power of two. The places of a cell are `0..C` for counters
/// before it, `C..2C` after it.
#[derive(Debug)]
pub(crate) struct Pattern<const D: usize, const C: usize> {
    /// The directions of edges, as numbers of corners.
    pub(crate) directions: [u8; D],
    /// For each counter the place of its direction in `directions`, and the `y` and `z` of its row at the cell; then unused ones.
    pub(crate) counters: [(u8, u8, u8); C],
    /// For each choice of corners how far each counter goes.
    pub(crate) steps: Box<[[u32; C]; 256]>,
    /// Where the triangles of each choice of corners start; and the end.
    starts: [u16; 257],
    /// Triangles, their corners as places.
    triangles: Vec<[u8; 3]>,
}

impl<const D: usize, const C: usize> Pattern<D, C> {
    pub(crate) fn new(directions: [u8; D], triangles_of: impl Fn(u8) -> Vec<[CellEdge; 3]>) -> Self {
        let mut counters = [(0, 0, 0); C];
        let rows = directions.iter().enumerate().flat_map(|(number, &direction)| {
            let row = move |at: u8| (number as u8, at & 1, at >> 1);
            (0..4).filter(move |at| at & direction >> 1 == 0).map(row)
        });
        let used = counters.iter_mut().zip(rows).map(|(counter, row)| *counter = row).count();
        let mut pattern = Self {
            directions,
            counters,
            steps: vec![[0; C]; 256].try_into().expect("256 choices"),
            starts: [0; 257],
            triangles: Vec::new(),
        };
        for mask in 0..256usize {
            for (step, &(number, y, z)) in pattern.steps[mask].iter_mut().zip(&counters[..used]) {
                let from = 2 * y + 4 * z;
                *step = ((mask >> from ^ mask >> (from + directions[number as usize])) & 1) as u32;
            }
            for triangle in triangles_of(mask as u8) {
                let places = triangle.map(|edge| pattern.place(edge));
                pattern.triangles.push(places);
            }
            pattern.starts[mask + 1] = pattern.triangles.len() as u16;
        }
        pattern
    }

    /// The place of the number of the vertex on an edge.
    pub(crate) fn place(&self, (from, direction): CellEdge) -> u8 {
        let wanted =
            |&(number, y, z): &(u8, u8, u8)| self.directions[number as usize] == direction && 2 * y + 4 * z == from & 6;
        let counter = self.counters.iter().position(wanted).expect("each edge of a cell has a counter");
        counter as u8 + if from & 1 == 1 { C as u8 } else { 0 }
    }

    /// The triangles of a cell.
    #[inline(always)]
    pub(crate) fn triangles(&self, mask: u8) -> &[[u8; 3]] {
        &self.triangles[self.starts[mask as usize] as usize..self.starts[mask as usize + 1] as usize]
    }

    /// How many triangles a cell has.
    #[inline(always)]
    pub(crate) fn count(&self, mask: u8) -> u32 {
        u32::from(self.starts[mask as usize + 1] - self.starts[mask as usize])
    }
}

fn turned(triangles: Vec<[CellEdge; 3]>, mirrored: bool) -> Vec<[CellEdge; 3]> {
    let turn = |[a, b, c]: [CellEdge; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
    triangles.into_iter().map(turn).collect()
}

fn cubes(mirrored: bool) -> Pattern<3, 8> {
    Pattern::new([1, 2, 4], |mask| {
        let triangles = Outlines::new(mask, 0).triangles;
        turned(triangles.into_iter().map(|t| t.map(|edge| CUBE_EDGES[edge as usize])).collect(), mirrored)
    })
}

fn tetrahedra(mirrored: bool) -> Pattern<7, 16> {
    Pattern::new([1, 2, 4, 3, 5, 6, 7], |mask| turned(tetrahedra_of(mask), mirrored))
}

static CUBES: LazyLock<[Pattern<3, 8>; 2]> = LazyLock::new(|| [cubes(false), cubes(true)]);
static TETRAHEDRA: LazyLock<[Pattern<7, 16>; 2]> = LazyLock::new(|| [tetrahedra(false), tetrahedra(true)]);

/// Marching cubes with inside corners across a face separated; its triangles turned around where space is mirrored.
pub(crate) fn cube_pattern(mirrored: bool) -> &'static Pattern<3, 8> {
    &CUBES[usize::from(mirrored)]
}

/// Marching tetrahedra; its triangles turned around where space is mirrored.
pub(crate) fn tetrahedra_pattern(mirrored: bool) -> &'static Pattern<7, 16> {
    &TETRAHEDRA[usize::from(mirrored)]
}

/// The triangles in the six tetrahedra of a cell around its diagonal from corner 0 to corner 7.
fn tetrahedra_of(mask: u8) -> Vec<[CellEdge; 3]> {
    let mut triangles = Vec::new();
    for (first, second) in [(1, 2), (2, 4), (4, 1), (2, 1), (4, 2), (1, 4)] {
        let corners: [u8; 4] = [0, first, first + second, 7];
        let (inside, outside): (Vec<u8>, Vec<u8>) = corners.into_iter().partition(|corner| mask >> corner & 1 == 1);
        let edge = |a: u8, b: u8| (a.min(b), a ^ b);
        match (inside.as_slice(), outside.as_slice()) {
            (&[p], &[a, b, c]) | (&[a, b, c], &[p]) => triangles.push([edge(p, a), edge(p, b), edge(p, c)]),
            (&[p, q], &[a, b]) => {
                triangles.push([edge(p, a), edge(p, b), edge(q, b)]);
                triangles.push([edge(p, a), edge(q, b), edge(q, a)]);
            }
            _ => continue,
        }
        let from = if outside.len() == 2 { 2 } else { 1 };
        let first = triangles.len() - from;
        for triangle in &mut triangles[first..] {
            if !faces_outward(triangle, &inside, &outside) {
                triangle.swap(1, 2);
            }
        }
    }
    triangles
}

/// Whether the normal of a triangle between the middles of edges points from the inside corners to the outside ones.
fn faces_outward(triangle: &[CellEdge; 3], inside: &[u8], outside: &[u8]) -> bool {
    let at = |corner: u8| [0, 1, 2].map(|axis| i32::from(corner >> axis & 1));
    let middle = |(from, direction): CellEdge| {
        let (a, b) = (at(from), at(from ^ direction));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    };
    let minus = |a: [i32; 3], b: [i32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let [a, b, c] = triangle.map(middle);
    let (u, v) = (minus(b, a), minus(c, a));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let sum = |corners: &[u8], axis: usize| corners.iter().map(|&corner| at(corner)[axis]).sum::<i32>();
    let (of_inside, of_outside) = (inside.len() as i32, outside.len() as i32);
    (0..3).map(|axis| normal[axis] * (sum(outside, axis) * of_inside - sum(inside, axis) * of_outside)).sum::<i32>() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every vertex of a triangle lies on a crossed edge, and every crossed edge has one.
    fn vertices_are_crossings<const D: usize, const C: usize>(pattern: &Pattern<D, C>, edges: &[CellEdge]) {
        for mask in 0..=255u8 {
            let mut held = pattern.triangles(mask).as_flattened().to_vec();
            held.sort_unstable();
            held.dedup();
            let crossed = edges.iter().filter(|(from, d)| mask >> from & 1 != mask >> (from + d) & 1);
            let mut wanted: Vec<u8> = crossed.map(|&edge| pattern.place(edge)).collect();
            wanted.sort_unstable();
            assert_eq!(held, wanted, "{mask:08b}");
        }
    }

    #[test]
    fn each_crossed_edge_has_a_vertex_and_no_other() {
        vertices_are_crossings(cube_pattern(false), &CUBE_EDGES);
        let edges: Vec<CellEdge> =
            (0..8u8).flat_map(|from| (1..8u8).map(move |d| (from, d))).filter(|(from, d)| from & d == 0).collect();
        assert_eq!(edges.len(), 19);
        vertices_are_crossings(tetrahedra_pattern(true), &edges);
    }

    /// What the room for triangles is made from, see `most_triangles`.
    #[test]
    fn triangles_are_few_beside_crossed_edges() {
        let crossed = |mask: u8, a: u8, b: u8| mask >> a & 1 != mask >> b & 1;
        for mask in 0..=255u8 {
            let of_cube = CUBE_EDGES.iter().filter(|(from, d)| crossed(mask, *from, from + d)).count() as u32;
            assert!(7 * cube_pattern(false).count(mask) <= 5 * of_cube, "{mask:08b}");
            let mut of_tetrahedra = 0;
            for (first, second) in [(1, 2), (2, 4), (4, 1), (2, 1), (4, 2), (1, 4)] {
                let corners = [0, first, first + second, 7];
                let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
                of_tetrahedra += pairs.iter().filter(|&&(a, b)| crossed(mask, corners[a], corners[b])).count() as u32;
            }
            assert!(2 * tetrahedra_pattern(false).count(mask) <= of_tetrahedra, "{mask:08b}");
        }
    }

    #[test]
    fn tetrahedra_of_one_corner_are_counted() {
        // The corner 0 is in all six, the corner 1 in two.
        assert_eq!((tetrahedra_of(1).len(), tetrahedra_of(2).len()), (6, 2));
        assert!(tetrahedra_of(0).is_empty() && tetrahedra_of(255).is_empty());
    }
}
