//! Cutting polygons into triangles by edges that are not there yet, without coordinates.

use super::{HalfEdgeMesh, Illegal};
use crate::structures::{FaceId, VertexId};

/// Up to this many corners every triangulation is considered, with a bit for each corner; beyond, fans alone.
const EXACT: usize = 64;

/// Triangulation of single faces.
impl HalfEdgeMesh {
    /// Whether [`HalfEdgeMesh::triangulate_face`] is possible.
    ///
    /// # Errors
    /// No such face, or every triangulation doubles an edge; beyond 64 corners, every fan.
    pub fn can_triangulate_face(&self, face: FaceId) -> Result<(), Illegal> {
        self.known_face(face)?;
        let corners: Vec<u32> = self.corners(face).map(|vertex| vertex.0).collect();
        self.plan_ears(&corners).map(drop)
    }

    /// Cuts a face into triangles by edges that are not there yet, whatever its shape: a fan if one will do, else any
    /// triangulation; beyond 64 corners fans alone are tried. The last triangle keeps the face's number.
    ///
    /// Cost: the valences of the corners, times the logarithm of their number; where no fan will do, the third power of
    /// it.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_triangulate_face`].
    pub fn triangulate_face(&mut self, face: FaceId) -> Result<(), Illegal> {
        self.known_face(face)?;
        let corners: Vec<u32> = self.corners(face).map(|vertex| vertex.0).collect();
        let ears = self.plan_ears(&corners)?;
        self.cut_ears(face.0, &ears);
        Ok(())
    }

    /// Ears in the order in which they can be cut off an outline: its corners before, at and after the tip. The last is
    /// what is left.
    pub(crate) fn plan_ears(&self, corners: &[u32]) -> Result<Vec<[u32; 3]>, Illegal> {
        let count = corners.len();
        if count <= 3 {
            return Ok(if count == 3 { vec![[0, 1, 2]] } else { Vec::new() });
        }
        self.room(0, count - 3, count - 3)?;
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_unstable_by_key(|&i| corners[i as usize]);
        // The corners that an edge joins to a corner and that are not its neighbours in the outline.
        let joined = |i: usize| {
            let order = &order;
            let (before, after) = ((i + count - 1) % count, (i + 1) % count);
            self.fan(corners[i]).filter_map(move |out| {
                let found = order.binary_search_by_key(&self.end(out.0), |&j| corners[j as usize]).ok()?;
                Some(order[found] as usize).filter(|&j| j != before && j != after)
            })
        };
        if let Some(tip) = (0..count).find(|&i| joined(i).next().is_none()) {
            let at = |k: usize| ((tip + k) % count) as u32;
            return Ok((1..count - 1).map(|k| [at(0), at(k), at(k + 1)]).collect());
        }
        if count > EXACT {
            return Err(Illegal::NoFan { corners: count as u32 });
        }
        let barred: Vec<u64> = (0..count).map(|i| joined(i).fold(0, |bits, j| bits | 1 << j)).collect();
        any_triangulation(&barred).ok_or(Illegal::NoTriangulation { corners: count as u32 })
    }

    /// The first diagonal of these ears that is an edge already.
    pub(crate) fn refuse_doubled(&self, corners: &[u32], ears: &[[u32; 3]]) -> Result<(), Illegal> {
        for &[before, _, after] in &ears[..ears.len().saturating_sub(1)] {
            let ends = [before, after].map(|i| corners[i as usize]);
            if self.between(ends[0], ends[1]).is_some() {
                return Err(Illegal::DuplicateEdge { vertices: ends.map(VertexId) });
            }
        }
        Ok(())
    }

    /// Cuts ears off a face, all but the last, which keeps its number. Corners are counted from the face's first.
    pub(super) fn cut_ears(&mut self, face: u32, ears: &[[u32; 3]]) {
        let mut at: Vec<u32> = self.around_face(FaceId(face)).map(|side| side.0).collect();
        for &[before, _, after] in &ears[..ears.len().saturating_sub(1)] {
            at[before as usize] = self.cut(at[after as usize], at[before as usize]);
        }
    }
}

/// A triangulation of an outline without the barred diagonals, if there is one: by dynamic programming over the
/// stretches of the outline (as Klincsek 1980 does for the least weight).
fn any_triangulation(barred: &[u64]) -> Option<Vec<[u32; 3]>> {
    let count = barred.len();
    let allowed = |i: usize, j: usize| j == i + 1 || (i == 0 && j + 1 == count) || barred[i] >> j & 1 == 0;
    // The third corner of the triangle at each chord, where the stretch between its ends can be filled.
    let mut third = vec![[0u8; EXACT]; count];
    for length in 2..count {
        for i in 0..count - length {
            let j = i + length;
            let filled = |i: usize, j: usize| j == i + 1 || third[i][j] != 0;
            if allowed(i, j) {
                third[i][j] = (i + 1..j).find(|&k| filled(i, k) && filled(k, j)).unwrap_or(0) as u8;
            }
        }
    }
    if third[0][count - 1] == 0 {
        return None;
    }
    // Triangles in an order in which each is an ear once those before it are gone.
    let mut ears = Vec::with_capacity(count - 2);
    let mut stack = vec![(0, count - 1)];
    while let Some((i, j)) = stack.pop() {
        if j > i + 1 {
            let k = third[i][j] as usize;
            ears.push([i as u32, k as u32, j as u32]);
            stack.extend([(i, k), (k, j)]);
        }
    }
    ears.reverse();
    Some(ears)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether diagonals of an outline can be chosen one after another, by trying all.
    fn tried(barred: &[u64], i: usize, j: usize) -> bool {
        let count = barred.len();
        let allowed = |i: usize, j: usize| j == i + 1 || (i == 0 && j + 1 == count) || barred[i] >> j & 1 == 0;
        j == i + 1 || (allowed(i, j) && (i + 1..j).any(|k| tried(barred, i, k) && tried(barred, k, j)))
    }

    #[test]
    fn a_triangulation_is_found_where_there_is_one() {
        let mut state = 5u64;
        let (mut found, mut none) = (0, 0);
        for round in 0..3000u64 {
            let count = 4 + (round % 6) as usize;
            let mut barred = vec![0u64; count];
            for i in 0..count {
                for j in i + 2..count {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    if (i, j) != (0, count - 1) && state >> 60 < 3 + round % 6 {
                        barred[i] |= 1 << j;
                        barred[j] |= 1 << i;
                    }
                }
            }
            let ears = any_triangulation(&barred);
            assert_eq!(ears.is_some(), tried(&barred, 0, count - 1), "{barred:?}");
            let Some(ears) = ears else {
                none += 1;
                continue;
            };
            found += 1;
            assert_eq!(ears.len(), count - 2);
            // Every ear is cut off what is left, and along no barred diagonal.
            let mut ring: Vec<u32> = (0..count as u32).collect();
            for &[before, tip, after] in &ears[..count - 3] {
                let at = ring.iter().position(|&corner| corner == tip).unwrap();
                assert_eq!(ring[(at + ring.len() - 1) % ring.len()], before);
                assert_eq!(ring[(at + 1) % ring.len()], after);
                assert_eq!(barred[before as usize] >> after & 1, 0);
                ring.remove(at);
            }
        }
        assert!(found > 500 && none > 300, "{found} {none}");
    }
}
