//! Local changes of lists of triangles, by looking at all of them.

use super::face_list::{FaceList, ordered};
use super::{FaceId, Illegal, IndexedTriangles, LocalUpdate, VertexId};

/// A triangle that has an edge: its number, the third corner, and the edge's ends in the triangle's order.
struct Beside {
    face: usize,
    third: u32,
    ends: [u32; 2],
}

impl IndexedTriangles {
    /// The triangles with an edge, one or two.
    fn beside(&self, vertices: [VertexId; 2]) -> Result<Vec<Beside>, Illegal> {
        let wanted = ordered([vertices[0].0, vertices[1].0]);
        let mut found = Vec::new();
        for (face, &[a, b, c]) in self.triangles().iter().enumerate() {
            let side = [([a, b], c), ([b, c], a), ([c, a], b)].into_iter().find(|&(ends, _)| ordered(ends) == wanted);
            found.extend(side.map(|(ends, third)| Beside { face, third, ends }));
        }
        match found.len() {
            0 => Err(Illegal::NoEdge { vertices }),
            1 | 2 => Ok(found),
            _ => Err(Illegal::NonManifoldEdge { vertices }),
        }
    }

    /// The vertices joined to a vertex, and how many triangles each of the edges has; rising.
    fn near(&self, vertex: u32) -> Vec<(u32, u32)> {
        let own = self.triangles().iter().filter(|triangle| triangle.contains(&vertex));
        let mut near: Vec<u32> = own.flatten().copied().filter(|&other| other != vertex).collect();
        near.sort_unstable();
        near.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u32)).collect()
    }

    fn check_collapse(&self, edge: [VertexId; 2]) -> Result<(), Illegal> {
        let beside = self.beside(edge)?;
        let [from, into] = edge.map(|vertex| self.near(vertex.0));
        let border = |near: &[(u32, u32)]| near.iter().filter(|&&(_, faces)| faces == 1).map(|&(v, _)| v).collect();
        let [from_border, into_border]: [Vec<u32>; 2] = [border(&from), border(&into)];
        if beside.len() == 1 {
            if let Some(&vertex) = from_border.iter().find(|&&vertex| into_border.contains(&vertex)) {
                return Err(Illegal::ClosesBorder { vertex: VertexId(vertex) });
            }
        } else if !from_border.is_empty() && !into_border.is_empty() {
            return Err(Illegal::PinchesBorder { vertices: edge });
        }
        if beside.len() == 2 && beside[0].third == beside[1].third {
            return Err(Illegal::DuplicateFace { face: FaceId(beside[0].face as u32) });
        }
        let common = |(vertex, _): &(u32, u32)| {
            beside.iter().all(|triangle| triangle.third != *vertex)
                && from.binary_search_by_key(vertex, |&(other, _)| other).is_ok()
        };
        if let Some(&(vertex, _)) = into.iter().find(|near| common(near)) {
            return Err(Illegal::LinkCondition { vertex: VertexId(vertex) });
        }
        // Two triangles besides, which would have the same corners: a tetrahedron.
        let rim = |near: &[(u32, u32)]| near.len() == 3 && near.iter().all(|&(_, faces)| faces == 2);
        if beside.len() == 2 && rim(&from) && rim(&into) {
            return Err(Illegal::DuplicateFace { face: FaceId(beside[0].face as u32) });
        }
        Ok(())
    }
}

/// Every change looks at all triangles; those of meshes that are not manifold are refused at their edge, or as if they
/// were.
impl LocalUpdate for IndexedTriangles {
    fn flip(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal> {
        let beside = self.beside(edge)?;
        let [left, right] = beside.as_slice() else { return Err(Illegal::BorderEdge { vertices: edge }) };
        let ([a, b], c, d) = (left.ends, left.third, right.third);
        if c == d {
            return Err(Illegal::DuplicateFace { face: FaceId(left.face as u32) });
        }
        if self.triangles().iter().any(|triangle| triangle.contains(&c) && triangle.contains(&d)) {
            return Err(Illegal::DuplicateEdge { vertices: [VertexId(c), VertexId(d)] });
        }
        let (left, right) = (left.face, right.face);
        self.triangles_mut()[left] = [d, c, a];
        self.triangles_mut()[right] = [c, d, b];
        Ok(())
    }

    fn split(&mut self, edge: [VertexId; 2]) -> Result<VertexId, Illegal> {
        let beside = self.beside(edge)?;
        if self.vertex_total() >= u32::MAX as usize - 1 || (self.triangles().len() + 2) * 3 >= u32::MAX as usize {
            return Err(Illegal::Full);
        }
        let vertex = self.push_vertex();
        for Beside { face, third, ends: [a, b] } in beside {
            self.triangles_mut()[face] = [vertex, b, third];
            self.triangles_mut().push([a, vertex, third]);
        }
        Ok(VertexId(vertex))
    }

    fn collapse(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal> {
        self.check_collapse(edge)?;
        let [from, into] = edge.map(|vertex| vertex.0);
        self.triangles_mut().retain(|triangle| !(triangle.contains(&from) && triangle.contains(&into)));
        for corner in self.triangles_mut().as_flattened_mut() {
            if *corner == from {
                *corner = into;
            }
        }
        Ok(())
    }
}
