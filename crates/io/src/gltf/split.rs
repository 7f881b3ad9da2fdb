//! Vertices split where the corners around them differ.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

use shapeloom_core::Exec;
use shapeloom_mesh::Column;

use crate::WriteError;
use crate::memory::Memory;

/// Where vertices of a file come from that has one set of values a vertex.
#[derive(Debug, PartialEq)]
pub(super) struct Split {
    /// The vertex of the mesh from which each one comes.
    pub vertices: Vec<u32>,
    /// A corner of the mesh at each one; [`NO_WEDGE`] where no triangle uses it.
    pub wedges: Vec<u32>,
    /// The triangles over the new vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// No corner uses the vertex.
pub(super) const NO_WEDGE: u32 = u32::MAX;

/// How many vertices split off the same one are compared one after the other. Seams have two or three; beyond this a table
/// is asked, so that a vertex with very many values takes no time in proportion to their square.
const NEAR: usize = 8;

/// Splits vertices exactly where the values of these wedge columns differ in any bit.
///
/// A vertex keeps its index for the values of its first corner; further values are appended in the order of their first
/// corner. A mesh whose corners agree keeps its vertices. None when 32 bits cannot tell the vertices apart.
///
/// # Errors
/// The caller stopped it, or the budget does not have the memory for a table of values.
pub(super) fn split(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    columns: &[&Column],
    exec: &Exec,
) -> Result<Option<Split>, WriteError> {
    const END: u32 = u32::MAX;
    let mut vertices: Vec<u32> = (0..vertex_count as u32).collect();
    let mut wedges = vec![NO_WEDGE; vertex_count];
    // The next vertex that was split off the same one; beyond the nearest, off one whose values have the same hash.
    let mut next = vec![END; vertex_count];
    let mut corners = Vec::with_capacity(triangles.len());
    // The first of the vertices whose vertex and values have this hash. Its order shows nowhere.
    let mut far: HashMap<u64, u32> = HashMap::new();
    let state = RandomState::new();
    let mut memory = Memory::new(exec);
    for (face, triangle) in triangles.iter().enumerate() {
        if face.is_multiple_of(4096) {
            exec.check()?;
        }
        let mut corner = *triangle;
        for (side, vertex) in corner.iter_mut().enumerate() {
            let wedge = face * 3 + side;
            let agrees = |wedges: &[u32], at: u32| {
                columns.iter().all(|column| same(column, wedges[at as usize] as usize, wedge))
            };
            if wedges[*vertex as usize] == NO_WEDGE {
                wedges[*vertex as usize] = wedge as u32;
                continue;
            }
            // Where the chain ends that a new vertex goes to; none where it begins one in the table.
            let (mut at, mut tail) = (*vertex, None);
            let mut hash = None;
            let mut steps = 0;
            let found = loop {
                if vertices[at as usize] == *vertex && agrees(&wedges, at) {
                    break Some(at);
                }
                steps += 1;
                let following = if hash.is_none() && steps == NEAR {
                    let own = *hash.insert(hashed(&state, *vertex, columns, wedge));
                    tail = None;
                    far.get(&own).copied()
                } else {
                    tail = Some(at);
                    Some(next[at as usize]).filter(|&next| next != END)
                };
                match following {
                    Some(following) => at = following,
                    None => break None,
                }
            };
            let at = match found {
                Some(at) => at,
                None => {
                    let Some(fresh) = u32::try_from(vertices.len()).ok().filter(|&fresh| fresh < END - 1) else {
                        return Ok(None);
                    };
                    match (tail, hash) {
                        (Some(tail), _) => next[tail as usize] = fresh,
                        (None, Some(hash)) => {
                            memory.take(4, size_of::<(u64, u32)>())?;
                            far.insert(hash, fresh);
                        }
                        (None, None) => {}
                    }
                    vertices.push(*vertex);
                    wedges.push(wedge as u32);
                    next.push(END);
                    fresh
                }
            };
            *vertex = at;
        }
        corners.push(corner);
    }
    Ok(Some(Split { vertices, wedges, triangles: corners }))
}

/// A hash of a vertex and the bits of the values at one of its corners.
fn hashed(state: &RandomState, vertex: u32, columns: &[&Column], wedge: usize) -> u64 {
    let mut hasher = state.build_hasher();
    hasher.write_u32(vertex);
    for column in columns {
        (0..column.width()).for_each(|component| hasher.write_u64(column.number(wedge, component).to_bits()));
    }
    hasher.finish()
}

fn same(column: &Column, a: usize, b: usize) -> bool {
    (0..column.width()).all(|component| column.number(a, component).to_bits() == column.number(b, component).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::CancelFlag;

    fn split(vertex_count: usize, triangles: &[[u32; 3]], columns: &[&Column]) -> Option<Split> {
        super::split(vertex_count, triangles, columns, &Exec::default()).unwrap()
    }

    const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];

    #[test]
    fn corners_that_agree_keep_the_vertices() {
        let uv = Column::texcoords("uv", &[0.0, 1.0, 2.0, 2.0, 1.0, 3.0].map(|u| [u, 0.0]));
        let split = split(5, &SQUARE, &[&uv]).unwrap();
        assert_eq!((split.vertices, split.triangles), (vec![0, 1, 2, 3, 4], SQUARE.to_vec()));
        assert_eq!(split.wedges, [0, 1, 2, 5, NO_WEDGE]);
    }

    #[test]
    fn corners_that_differ_are_appended_in_order_of_first_use() {
        let uv = Column::texcoords("uv", &[0.0, 1.0, 2.0, 7.0, 1.0, 3.0].map(|u| [u, 0.0]));
        let label = Column::labels("label", vec![0, 0, 0, 0, 9, 0]);
        let one = split(4, &SQUARE, &[&uv]).unwrap();
        assert_eq!((one.vertices, one.triangles), (vec![0, 1, 2, 3, 2], vec![[0, 1, 2], [4, 1, 3]]));
        let two = split(4, &SQUARE, &[&uv, &label]).unwrap();
        assert_eq!((two.vertices, two.triangles), (vec![0, 1, 2, 3, 2, 1], vec![[0, 1, 2], [4, 5, 3]]));
        assert_eq!(two.wedges, [0, 1, 2, 5, 3, 4]);
    }

    /// Compared with every corner before, one by one.
    fn brute_force(vertex_count: usize, triangles: &[[u32; 3]], columns: &[&Column]) -> Split {
        let mut vertices: Vec<u32> = (0..vertex_count as u32).collect();
        let mut wedges = vec![NO_WEDGE; vertex_count];
        let mut corners = triangles.to_vec();
        for (wedge, vertex) in corners.as_flattened_mut().iter_mut().enumerate() {
            let bits = |wedge: usize| -> Vec<u64> {
                let of = |column: &&Column| (0..column.width()).map(|i| column.number(wedge, i).to_bits()).collect();
                columns.iter().flat_map(|column| -> Vec<u64> { of(column) }).collect()
            };
            let own = (0..vertices.len()).filter(|&at| vertices[at] == *vertex);
            let known = own.clone().find(|&at| wedges[at] != NO_WEDGE && bits(wedges[at] as usize) == bits(wedge));
            let free = own.clone().find(|&at| wedges[at] == NO_WEDGE);
            let at = known.or(free).unwrap_or(vertices.len());
            if at == vertices.len() {
                vertices.push(*vertex);
                wedges.push(NO_WEDGE);
            }
            if wedges[at] == NO_WEDGE {
                wedges[at] = wedge as u32;
            }
            *vertex = at as u32;
        }
        Split { vertices, wedges, triangles: corners }
    }

    #[test]
    fn few_and_many_values_at_a_vertex_split_as_by_brute_force() {
        let mut state = 1u64;
        let mut next = |below: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as u32 % below
        };
        for values in [1, 3, 8, 9, 40, 1000] {
            let triangles: Vec<[u32; 3]> = (0..400).map(|_| [next(3), 3 + next(3), 6 + next(100)]).collect();
            let uv: Vec<[f64; 2]> = (0..1200).map(|_| [f64::from(next(values)), 0.5]).collect();
            let labels = Column::labels("label", (0..1200).map(|_| next(2)).collect());
            let columns = [&Column::texcoords("uv", &uv), &labels];
            assert_eq!(split(106, &triangles, &columns).unwrap(), brute_force(106, &triangles, &columns), "{values}");
        }
    }

    #[test]
    fn a_hub_with_a_value_for_every_corner_takes_no_time_in_proportion_to_their_square() {
        // The square would be minutes; and the way is stopped when the caller stops it.
        let rim = 200_000;
        let triangles: Vec<[u32; 3]> = (0..rim).map(|i| [0, 1 + i, 1 + (i + 1) % rim]).collect();
        let uv: Vec<[f64; 2]> = (0..3 * rim).map(|i| [f64::from(i), 0.0]).collect();
        let uv = Column::texcoords("uv", &uv);
        let split = split(rim as usize + 1, &triangles, &[&uv]).unwrap();
        assert_eq!(split.vertices.len(), 3 * rim as usize);
        let flag = CancelFlag::default();
        let stopped = Exec::default().with_cancel(&flag);
        flag.cancel();
        assert!(matches!(super::split(9, &triangles[..5], &[&uv], &stopped), Err(WriteError::Stop(_))));
        let poor = Exec::default().with_memory(1 << 20);
        let error = super::split(rim as usize + 1, &triangles, &[&uv], &poor);
        assert!(matches!(error, Err(WriteError::OverBudget(_))));
    }
}
