//! Vertices split where the corners around them differ.

use shapeloom_mesh::Column;

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

/// Splits vertices exactly where the values of these wedge columns differ in any bit.
///
/// A vertex keeps its index for the values of its first corner; further values are appended in the order of their first
/// corner. A mesh whose corners agree keeps its vertices. None when 32 bits cannot tell the vertices apart.
pub(super) fn split(vertex_count: usize, triangles: &[[u32; 3]], columns: &[&Column]) -> Option<Split> {
    const END: u32 = u32::MAX;
    let mut vertices: Vec<u32> = (0..vertex_count as u32).collect();
    let mut wedges = vec![NO_WEDGE; vertex_count];
    // The next vertex that was split off the same one.
    let mut next = vec![END; vertex_count];
    let mut corners = Vec::with_capacity(triangles.len());
    for (face, triangle) in triangles.iter().enumerate() {
        let mut corner = *triangle;
        for (side, vertex) in corner.iter_mut().enumerate() {
            let wedge = face * 3 + side;
            let mut at = *vertex;
            loop {
                if wedges[at as usize] == NO_WEDGE {
                    wedges[at as usize] = wedge as u32;
                    break;
                }
                if columns.iter().all(|column| same(column, wedges[at as usize] as usize, wedge)) {
                    break;
                }
                if next[at as usize] == END {
                    let fresh = u32::try_from(vertices.len()).ok().filter(|&fresh| fresh < END - 1)?;
                    next[at as usize] = fresh;
                    vertices.push(*vertex);
                    wedges.push(wedge as u32);
                    next.push(END);
                    at = fresh;
                    break;
                }
                at = next[at as usize];
            }
            *vertex = at;
        }
        corners.push(corner);
    }
    Some(Split { vertices, wedges, triangles: corners })
}

fn same(column: &Column, a: usize, b: usize) -> bool {
    (0..column.width()).all(|component| column.number(a, component).to_bits() == column.number(b, component).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
