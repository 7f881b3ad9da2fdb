//! The topology of a mesh, apart from its coordinates.

mod boundary;
mod component;
mod duplicates;
mod edges;
mod fans;
mod orientation;
#[cfg(test)]
mod tests;

use shapeloom_core::{Exec, Reservation};

pub use boundary::BoundaryLoops;
pub use component::Component;

use crate::{Faces, JudgeError, MeshRef};
use component::components;
use duplicates::duplicate_faces;
use edges::{Edges, EdgesError};
use fans::fan_counts;
use orientation::Orientation;

/// What is known of a mesh without its coordinates, with the elements that show it.
///
/// The report takes faces as they are, without merging vertices: where triangles repeat a vertex's position instead of
/// its index, every triangle is a component of its own. Edges join two different vertices; each is counted once.
///
/// Cost: O(n log d) time for n corners of faces and d edges at one vertex, about 60 bytes a corner while it is made.
#[derive(Debug)]
pub struct Topology {
    /// Vertices, named by a face or not.
    pub vertices: usize,
    /// Faces.
    pub faces: usize,
    /// Edges.
    pub edges: usize,
    /// Vertices that no face names, rising.
    pub isolated_vertices: Vec<u32>,
    /// Edges with one face.
    pub boundary: BoundaryLoops,
    /// Edges with more than two faces, by their vertices. A face that passes an edge twice counts twice.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Vertices at which faces form more than one fan, as where two cones meet in their apex, rising. Faces are in one fan
    /// if edges at the vertex join them, however many faces the edges have; so the ends of a non-manifold edge are not
    /// here for that alone.
    pub non_manifold_vertices: Vec<u32>,
    /// Edges with two faces that both have it in the same direction, as the first face has it.
    pub inconsistent_edges: Vec<[u32; 2]>,
    /// Where the mesh is not orientable: faces in a ring, each sharing an edge of two faces with the next, and the last
    /// with the first; orienting one after the other alike turns the first over. Empty where the mesh is orientable.
    pub orientation_witness: Vec<u32>,
    /// Faces that name a vertex twice, rising.
    pub repeating_faces: Vec<u32>,
    /// Faces with the same cycle of vertices as an earlier one, either way around: the first such face and the later one.
    pub duplicate_faces: Vec<[u32; 2]>,
    /// The parts that are joined through edges, by their smallest face.
    pub components: Vec<Component>,
    /// The component of each face.
    pub face_components: Vec<u32>,
    _memory: [Reservation; 2],
}

impl Topology {
    /// The report on a mesh.
    ///
    /// # Errors
    /// The memory budget, or the reason to stop.
    pub fn of<'a>(mesh: impl Into<MeshRef<'a>>, exec: &Exec) -> Result<Self, JudgeError> {
        Self::new(&mesh.into().faces(exec)?, exec)
    }

    /// The report on faces.
    ///
    /// # Errors
    /// The memory budget, or the reason to stop.
    pub fn new(faces: &Faces<'_>, exec: &Exec) -> Result<Self, JudgeError> {
        let corners = faces.corners().len() as u64;
        // What is kept: at worst each side is a boundary edge and each face a component.
        let kept = exec.reserve_elements(corners + faces.vertex_count() as u64, 12)?;
        let per_component = size_of::<Component>() as u64 * faces.len() as u64;
        let components_kept = exec.reserve(per_component)?;
        // Sets of corners and of faces, keys of faces.
        let _scratch = exec.reserve_elements(corners + faces.vertex_count() as u64, 16)?;
        let part = |from: f64, to: f64| exec.part(from, to);
        let edges = Edges::new(faces, &part(0.0, 0.5)).map_err(|error| match error {
            EdgesError::OverBudget(error) => JudgeError::OverBudget(error),
            EdgesError::Stop(stop) => JudgeError::Stop(stop),
        })?;
        exec.progress(0.5);
        let fans = fan_counts(faces, &edges, exec)?;
        exec.check()?;
        exec.progress(0.65);
        let orientation = Orientation::new(faces, &edges, exec)?;
        exec.check()?;
        exec.progress(0.75);
        let of_count = |wanted: fn(u32) -> bool| -> Vec<u32> {
            let numbered = fans.iter().enumerate().filter(|&(_, &count)| wanted(count));
            numbered.map(|(vertex, _)| vertex as u32).collect()
        };
        let crowded = edges.iter().filter(|uses| uses.len() > 2).map(|uses| {
            let [a, b] = faces.side(uses[0]);
            [a.min(b), a.max(b)]
        });
        let non_manifold_edges: Vec<[u32; 2]> = crowded.collect();
        let non_manifold_vertices = of_count(|count| count > 1);
        let boundary = BoundaryLoops::new(faces, &edges);
        let manifold = non_manifold_edges.is_empty() && non_manifold_vertices.is_empty();
        let (components, face_components) = components(faces, &edges, &boundary, &orientation.twisted, manifold);
        exec.check()?;
        exec.progress(0.9);
        let duplicate_faces = duplicate_faces(faces);
        let mut repeating_faces = Vec::new();
        let mut seen = Vec::new();
        for face in 0..faces.len() as u32 {
            let cycle = faces.face(face);
            let repeats = match *cycle {
                [a, b, c] => a == b || b == c || c == a,
                _ => {
                    seen.clear();
                    seen.extend_from_slice(cycle);
                    seen.sort_unstable();
                    seen.windows(2).any(|pair| pair[0] == pair[1])
                }
            };
            if repeats {
                repeating_faces.push(face);
            }
        }
        exec.progress(1.0);
        Ok(Self {
            vertices: faces.vertex_count(),
            faces: faces.len(),
            edges: edges.len(),
            isolated_vertices: of_count(|count| count == 0),
            boundary,
            non_manifold_edges,
            non_manifold_vertices,
            inconsistent_edges: orientation.inconsistent,
            orientation_witness: orientation.witness,
            repeating_faces,
            duplicate_faces,
            components,
            face_components,
            _memory: [kept, components_kept],
        })
    }

    /// Whether every edge has one or two faces, and the faces at every vertex one fan.
    pub fn is_manifold(&self) -> bool {
        self.non_manifold_edges.is_empty() && self.non_manifold_vertices.is_empty()
    }

    /// Whether there is a face, and no edge with only one.
    pub fn is_closed(&self) -> bool {
        self.faces > 0 && self.boundary.is_empty()
    }

    /// Whether the faces can be turned so that every two that share an edge run along it in opposite directions. Edges
    /// with more than two faces say nothing.
    pub fn is_orientable(&self) -> bool {
        self.orientation_witness.is_empty()
    }

    /// Whether every two faces that share an edge run along it in opposite directions. Edges with more than two faces say
    /// nothing.
    pub fn is_oriented(&self) -> bool {
        self.inconsistent_edges.is_empty()
    }

    /// V − E + F, where V counts the vertices that faces name.
    pub fn euler_characteristic(&self) -> i64 {
        let named = self.vertices - self.isolated_vertices.len();
        named as i64 - self.edges as i64 + self.faces as i64
    }

    /// The number of handles: of all orientable components together. None where the mesh is not manifold, or a
    /// number of handles is not whole because faces touch themselves.
    pub fn genus(&self) -> Option<u64> {
        self.sum(|component| if component.orientable { component.genus } else { Some(0) })
    }

    /// The number of crosscaps: of all components together that are not orientable. None as for [`Topology::genus`].
    pub fn crosscaps(&self) -> Option<u64> {
        self.sum(|component| if component.orientable { Some(0) } else { component.genus })
    }

    fn sum(&self, number: impl Fn(&Component) -> Option<u64>) -> Option<u64> {
        self.components.iter().map(number).sum()
    }
}
