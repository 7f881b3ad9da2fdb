//! The answers by definition, over the plain list of faces; it shares no code with any structure.

use std::collections::{BTreeMap, BTreeSet};

use crate::structures::{IndexedPolygons, Query, StructureKind};

/// An edge by its vertices, the smaller first.
pub type Edge = [u32; 2];

/// Faces, and every edge with the faces that pass it and in which direction, as often as they do.
pub struct Truth {
    pub vertices: u32,
    pub faces: Vec<Vec<u32>>,
    pub edges: BTreeMap<Edge, Vec<(u32, bool)>>,
}

/// A set of vertices, edges or faces: a vertex or face `v` is `[v, v]`, which no edge is.
pub type Found = BTreeSet<Edge>;

impl Truth {
    pub fn new(mesh: &IndexedPolygons, vertices: u32) -> Self {
        let starts = mesh.starts().windows(2);
        let faces: Vec<Vec<u32>> =
            starts.map(|pair| mesh.corners()[pair[0] as usize..pair[1] as usize].to_vec()).collect();
        let mut edges: BTreeMap<Edge, Vec<(u32, bool)>> = BTreeMap::new();
        for (number, face) in faces.iter().enumerate() {
            for i in 0..face.len() {
                let (a, b) = (face[i], face[(i + 1) % face.len()]);
                if a != b {
                    edges.entry([a.min(b), a.max(b)]).or_default().push((number as u32, a < b));
                }
            }
        }
        Self { vertices, faces, edges }
    }

    fn edges_of(&self, face: u32) -> BTreeSet<Edge> {
        let corners = &self.faces[face as usize];
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        sides.filter(|(a, b)| a != b).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
    }

    /// The answer to a question about a vertex or face `[v, v]`, or an edge.
    pub fn answer(&self, query: Query, of: Edge) -> Found {
        let one = |number: u32| [number, number];
        let with = |vertex: u32| self.edges.keys().filter(move |edge| edge.contains(&vertex)).copied();
        let vertex = of[0];
        match query {
            Query::VV => with(vertex).map(|[a, b]| one(if a == vertex { b } else { a })).collect(),
            Query::VE => with(vertex).collect(),
            Query::VF => {
                let numbered = (0..).zip(&self.faces);
                numbered.filter(|(_, face)| face.contains(&vertex)).map(|(number, _)| one(number)).collect()
            }
            Query::EV => of.map(one).into(),
            Query::EE => of.into_iter().flat_map(with).filter(|&other| other != of).collect(),
            Query::EF => self.edges[&of].iter().map(|&(face, _)| one(face)).collect(),
            Query::FV => self.faces[vertex as usize].iter().map(|&vertex| one(vertex)).collect(),
            Query::FE => self.edges_of(vertex),
            Query::FF => {
                let beside = self.edges_of(vertex).into_iter().flat_map(|edge| &self.edges[&edge]);
                beside.map(|&(face, _)| one(face)).filter(|&face| face != of).collect()
            }
        }
    }

    /// The faces that name a vertex twice.
    pub fn repeating(&self) -> Vec<u32> {
        let repeats = |face: &Vec<u32>| face.iter().collect::<BTreeSet<_>>().len() < face.len();
        (0..).zip(&self.faces).filter(|(_, face)| repeats(face)).map(|(number, _)| number).collect()
    }

    /// The edges with more than two sides.
    pub fn crowded(&self) -> Vec<Edge> {
        self.edges.iter().filter(|(_, sides)| sides.len() > 2).map(|(&edge, _)| edge).collect()
    }

    /// The edges with two sides in the same direction.
    pub fn turned(&self) -> Vec<Edge> {
        let same = |sides: &Vec<(u32, bool)>| sides.len() == 2 && sides[0].1 == sides[1].1;
        self.edges.iter().filter(|(_, sides)| same(sides)).map(|(&edge, _)| edge).collect()
    }

    /// The number of fans at each vertex that has several: faces there, put together while an edge at the vertex joins them.
    pub fn pinched(&self) -> Vec<(u32, usize)> {
        let mut sides_at: Vec<BTreeMap<u32, Vec<Edge>>> = vec![BTreeMap::new(); self.vertices as usize];
        for (number, face) in (0..).zip(&self.faces) {
            for &vertex in face {
                sides_at[vertex as usize].entry(number).or_default();
            }
            for edge in self.edges_of(number) {
                edge.iter().for_each(|&vertex| sides_at[vertex as usize].entry(number).or_default().push(edge));
            }
        }
        let mut fans = Vec::new();
        for (vertex, sides) in (0..).zip(&sides_at) {
            let mut left: BTreeSet<u32> = sides.keys().copied().collect();
            let mut count = 0;
            while let Some(first) = left.pop_first() {
                count += 1;
                let mut open = vec![first];
                while let Some(face) = open.pop() {
                    for &(other, _) in sides[&face].iter().flat_map(|edge| &self.edges[edge]) {
                        if left.remove(&other) {
                            open.push(other);
                        }
                    }
                }
            }
            if count > 1 {
                fans.push((vertex, count));
            }
        }
        fans
    }

    /// Whether a structure should hold these faces.
    pub fn fits(&self, kind: StructureKind) -> bool {
        let triangles = || self.faces.iter().all(|face| face.len() == 3);
        let sides = || self.repeating().is_empty() && self.crowded().is_empty() && self.turned().is_empty();
        match kind {
            StructureKind::TriangleSoup | StructureKind::IndexedTriangles => triangles(),
            StructureKind::EdgeList
            | StructureKind::IndexedPolygons
            | StructureKind::FaceVertex
            | StructureKind::AdjacencyMatrix => true,
            StructureKind::IncidenceMatrices => self.repeating().is_empty(),
            StructureKind::ExtendedEdgeList => sides(),
            StructureKind::WingedEdge | StructureKind::HalfEdgeMesh => sides() && self.pinched().is_empty(),
            StructureKind::TriangleHalfEdges | StructureKind::CornerTable => {
                triangles() && sides() && self.pinched().is_empty()
            }
        }
    }
}
