//! The pieces of the surface in a cell, for each choice of its corners.
//!
//! Corner `x + 2y + 4z` of a cell is at `(x, y, z)`. Edge `4a + n` runs along axis `a`; with `b` and `c` the axes that follow `a` in
//! turn, `n` is the coordinate along `b` plus twice that along `c`. Face `2a + s` is at coordinate `s` of axis `a`.

/// No piece.
const NONE: u8 = u8::MAX;

/// The pieces of the surface in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces {
    /// How many there are: at most 4.
    pub(super) count: u8,
    /// The piece that crosses each edge.
    of_edge: [u8; 12],
    /// The edges that each piece crosses, a bit each.
    pub(super) edges: [u16; 4],
}

impl Pieces {
    /// The piece that crosses an edge; the first if none does.
    pub(super) fn at(&self, edge: usize) -> u8 {
        self.of_edge.get(edge).copied().filter(|&piece| piece != NONE).unwrap_or(0)
    }
}

/// The pieces for each choice of inside corners, first with inside corners parted that are diagonal across a face, then with those of
/// the cell's [`double_face`] joined instead.
pub(super) static PIECES: [Pieces; 512] = all_pieces();

/// The face that both segments of one piece cross, plus one; 0 if there is none.
static DOUBLE_FACE: [u8; 256] = all_double_faces();

/// Cells of one piece without a double face.
pub(super) static SIMPLE: [bool; 256] = all_simple();

/// The face of a cell on which inside corners are diagonal and both segments belong to one piece. No cell has two: a test counts.
pub(super) fn double_face(corners: u8) -> Option<usize> {
    usize::from(DOUBLE_FACE[usize::from(corners)]).checked_sub(1)
}

/// The corners at both ends of an edge, the lower one first.
pub(super) const fn edge_corners(edge: usize) -> [usize; 2] {
    let (axis, n) = (edge / 4, edge % 4);
    let low = (n & 1) << ((axis + 1) % 3) | (n >> 1) << ((axis + 2) % 3);
    [low, low | 1 << axis]
}

/// The edges of each face, a bit each: face `2 * axis`, and one more at its upper side.
pub(super) const FACE_EDGES: [u16; 6] = face_edges();

const fn face_edges() -> [u16; 6] {
    let mut faces = [0; 6];
    let mut at = 0;
    while at < 72 {
        let (face, edge) = (at / 12, at % 12);
        let [p, q] = edge_corners(edge);
        let (p, q) = (p >> (face / 2) & 1, q >> (face / 2) & 1);
        if p == face % 2 && q == face % 2 {
            faces[face] |= 1 << edge;
        }
        at += 1;
    }
    faces
}

/// The four corners of a face in turn.
const fn face_corners(face: usize) -> [usize; 4] {
    let (axis, side) = (face / 2, face % 2);
    let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let first = side << axis;
    [first, first | b, first | b | c, first | c]
}

/// The edge between two neighbouring corners.
const fn edge_between(p: usize, q: usize) -> usize {
    let axis = (p ^ q).trailing_zeros() as usize;
    let low = p & q;
    axis * 4 + (low >> ((axis + 1) % 3) & 1) + 2 * (low >> ((axis + 2) % 3) & 1)
}

const fn inside(corners: usize, corner: usize) -> bool {
    corners >> corner & 1 == 1
}

/// Whether the inside corners of a face are two that are diagonal.
const fn ambiguous(corners: usize, face: usize) -> bool {
    let [p, q, r, s] = face_corners(face);
    inside(corners, p) == inside(corners, r)
        && inside(corners, q) == inside(corners, s)
        && inside(corners, p) != inside(corners, q)
}

/// The pieces: edges that a segment on a face joins belong to one. On the face `joined` inside corners that are diagonal are joined.
const fn pieces(corners: usize, joined: usize) -> Pieces {
    let mut name = [0; 12];
    let mut edge = 0;
    while edge < 12 {
        name[edge] = edge;
        edge += 1;
    }
    let mut face = 0;
    while face < 6 {
        let around = face_corners(face);
        let mut crossed = [0; 4];
        let mut count = 0;
        let mut k = 0;
        while k < 4 {
            let (p, q) = (around[k], around[(k + 1) % 4]);
            if inside(corners, p) != inside(corners, q) {
                crossed[count] = edge_between(p, q);
                count += 1;
            }
            k += 1;
        }
        if count == 2 {
            name = merged(name, crossed[0], crossed[1]);
        } else if count == 4 {
            // Edge k lies between corners k and k + 1: edges 0 and 1 meet at corner 1, edges 3 and 0 at corner 0.
            let around_first = inside(corners, around[0]) != (face == joined);
            let (a, b) = if around_first { ([3, 0], [1, 2]) } else { ([0, 1], [2, 3]) };
            name = merged(name, crossed[a[0]], crossed[a[1]]);
            name = merged(name, crossed[b[0]], crossed[b[1]]);
        }
        face += 1;
    }
    let mut found = Pieces { count: 0, of_edge: [NONE; 12], edges: [0; 4] };
    let mut edge = 0;
    while edge < 12 {
        let [p, q] = edge_corners(edge);
        if inside(corners, p) != inside(corners, q) {
            // A piece has the name of its first edge.
            if name[edge] == edge {
                found.of_edge[edge] = found.count;
                found.count += 1;
            } else {
                found.of_edge[edge] = found.of_edge[name[edge]];
            }
            found.edges[found.of_edge[edge] as usize] |= 1 << edge;
        }
        edge += 1;
    }
    found
}

const fn merged(mut name: [usize; 12], p: usize, q: usize) -> [usize; 12] {
    let (p, q) = (name[p], name[q]);
    let (kept, gone) = if p < q { (p, q) } else { (q, p) };
    let mut edge = 0;
    while edge < 12 {
        if name[edge] == gone {
            name[edge] = kept;
        }
        edge += 1;
    }
    name
}

/// Whether all four edges of a face belong to one piece.
const fn one_piece(pieces: &Pieces, face: usize) -> bool {
    let around = face_corners(face);
    let first = pieces.of_edge[edge_between(around[0], around[1])];
    let mut k = 1;
    while k < 4 {
        if pieces.of_edge[edge_between(around[k], around[(k + 1) % 4])] != first {
            return false;
        }
        k += 1;
    }
    true
}

const fn all_double_faces() -> [u8; 256] {
    let mut faces = [0; 256];
    let mut corners = 0;
    while corners < 256 {
        let plain = pieces(corners, 6);
        let mut face = 0;
        while face < 6 {
            if ambiguous(corners, face) && one_piece(&plain, face) {
                faces[corners] = face as u8 + 1;
            }
            face += 1;
        }
        corners += 1;
    }
    faces
}

const fn all_pieces() -> [Pieces; 512] {
    let faces = all_double_faces();
    let mut all = [Pieces { count: 0, of_edge: [NONE; 12], edges: [0; 4] }; 512];
    let mut corners = 0;
    while corners < 256 {
        all[corners] = pieces(corners, 6);
        let face = if faces[corners] == 0 { 6 } else { faces[corners] as usize - 1 };
        all[256 + corners] = pieces(corners, face);
        corners += 1;
    }
    all
}

const fn all_simple() -> [bool; 256] {
    let faces = all_double_faces();
    let mut simple = [false; 256];
    let mut corners = 0;
    while corners < 256 {
        simple[corners] = pieces(corners, 6).count == 1 && faces[corners] == 0;
        corners += 1;
    }
    simple
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crossed_edge_belongs_to_one_piece() {
        for (index, pieces) in PIECES.iter().enumerate() {
            let corners = index % 256;
            let mut seen = 0u16;
            for piece in 0..usize::from(pieces.count) {
                assert_eq!(seen & pieces.edges[piece], 0);
                assert!(pieces.edges[piece].count_ones() >= 3);
                seen |= pieces.edges[piece];
            }
            for edge in 0..12 {
                let [p, q] = edge_corners(edge);
                assert_eq!(edge_between(q, p), edge);
                assert_eq!(seen >> edge & 1 == 1, inside(corners, p) != inside(corners, q), "{corners:08b} {edge}");
            }
        }
    }

    /// Inside corners that cell edges join lie on one side of their pieces; with none diagonal across a face, a component of inside
    /// corners and a component of outside ones (joined across faces too) meet in one piece.
    #[test]
    fn pieces_part_each_inside_component_from_each_outside_one() {
        for (corners, pieces) in PIECES[..256].iter().enumerate() {
            let mut name: Vec<usize> = (0..8).collect();
            let mut join = |p: usize, q: usize| {
                let (p, q) = (name[p], name[q]);
                name.iter_mut().filter(|name| **name == q).for_each(|name| *name = p);
            };
            for p in 0..8usize {
                for q in 0..p {
                    let apart = (p ^ q).count_ones();
                    let alike = inside(corners, p) == inside(corners, q);
                    if alike && (apart == 1 || apart == 2 && !inside(corners, p)) {
                        join(p, q);
                    }
                }
            }
            let mut pairs: Vec<[usize; 2]> = (0..12)
                .map(edge_corners)
                .filter(|&[p, q]| inside(corners, p) != inside(corners, q))
                .map(|[p, q]| if inside(corners, p) { [name[p], name[q]] } else { [name[q], name[p]] })
                .collect();
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!(usize::from(pieces.count), pairs.len(), "{corners:08b}");
        }
    }

    /// What the repair of double edges rests on.
    #[test]
    fn a_cell_with_a_double_face_has_one_ambiguous_face_and_splits_in_two() {
        let mut found = 0;
        for corners in 0..256usize {
            let ambiguous_faces: Vec<usize> = (0..6).filter(|&face| ambiguous(corners, face)).collect();
            let double: Vec<usize> =
                ambiguous_faces.iter().copied().filter(|&face| one_piece(&PIECES[corners], face)).collect();
            assert_eq!(double_face(corners as u8), double.first().copied());
            if let [face] = double[..] {
                found += 1;
                assert_eq!(ambiguous_faces, [face], "{corners:08b}");
                assert_eq!((PIECES[corners].count, PIECES[corners + 256].count), (1, 2));
                // The two segments on the face now belong to different pieces.
                let around = face_corners(face);
                let pieces: Vec<u8> =
                    (0..4).map(|k| PIECES[corners + 256].at(edge_between(around[k], around[(k + 1) % 4]))).collect();
                assert_eq!(pieces.iter().filter(|&&piece| piece == 0).count(), 2);
            } else {
                assert!(double.is_empty(), "{corners:08b}");
            }
        }
        // Two outside corners diagonal across a face (12), and the same with one more of the four beside them outside, where the face
        // opposite keeps three (24 and their like).
        assert_eq!(found, (0..256).filter(|&corners| double_face(corners as u8).is_some()).count());
        assert!(found >= 12, "{found}");
    }
}
