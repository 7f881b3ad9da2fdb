//! Closed shells: which way they face, and how they lie in one another.

use shapeloom_core::{Aabb, Exec};
use shapeloom_mesh::TriMesh;

use crate::{JudgeError, Location, Solid, Topology};

/// A closed component whose faces turn alike and which encloses a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// The component, as numbered in [`Topology::components`].
    pub component: u32,
    /// Whether its faces look outward: its signed volume, in floating point, is above 0.
    pub outward: bool,
    /// How many other shells it lies in; decided exactly at one of its vertices.
    pub depth: u32,
}

impl Shell {
    /// Whether it faces the wrong way: a shell in an even number of others bounds a solid from outside, one in an odd number
    /// a cavity.
    pub fn is_inverted(&self) -> bool {
        self.outward != self.depth.is_multiple_of(2)
    }
}

/// The shells of a mesh of triangles with that report. A shell whose every vertex lies on another is taken to be outside it.
///
/// Cost: for each shell the triangles of those whose boxes hold its own.
pub(super) fn shells(mesh: &TriMesh, topology: &Topology, exec: &Exec) -> Result<Vec<Shell>, JudgeError> {
    let (triangles, positions) = (mesh.triangles(), mesh.positions());
    let _memory = exec.reserve(triangles.len() as u64 * 4 + topology.components.len() as u64 * 80)?;
    let members = Members::new(topology);
    // A vertex of an edge with one face, with many or with faces that do not turn alike is on no shell.
    let edges =
        topology.boundary.edges().iter().chain(&topology.non_manifold_edges).chain(&topology.inconsistent_edges);
    let mut faulty: Vec<u32> = edges.flatten().copied().collect();
    faulty.sort_unstable();
    faulty.dedup();
    let solid = Solid::new(mesh, exec)?;
    let mut found = Vec::new();
    let mut boxes = Vec::new();
    for component in 0..topology.components.len() as u32 {
        exec.check()?;
        let faces = members.of(component);
        let vertices = || faces.iter().flat_map(|&face| triangles[face as usize]);
        if vertices().any(|vertex| faulty.binary_search(&vertex).is_ok()) {
            continue;
        }
        let volume = solid.volume_of(faces);
        if volume != 0.0 {
            found.push(Shell { component, outward: volume > 0.0, depth: 0 });
            boxes.push(Aabb::from_points(vertices().map(|vertex| positions[vertex as usize])));
        }
    }
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|&a, &b| boxes[a].min.x.total_cmp(&boxes[b].min.x).then(a.cmp(&b)));
    for inner in 0..found.len() {
        let own = members.of(found[inner].component);
        let held = |outer: usize| boxes[outer].contains(boxes[inner].min) && boxes[outer].contains(boxes[inner].max);
        let around = order.iter().take_while(|&&outer| boxes[outer].min.x <= boxes[inner].min.x);
        for &outer in around.filter(|&&outer| outer != inner && held(outer)) {
            exec.check()?;
            let faces = members.of(found[outer].component);
            for vertex in own.iter().flat_map(|&face| triangles[face as usize]) {
                match solid.locate_among(positions[vertex as usize], faces.iter().copied())? {
                    Location::On(_) => continue,
                    location => found[inner].depth += u32::from(location.is_inside()),
                }
                break;
            }
        }
    }
    Ok(found)
}

/// The faces of each component.
struct Members {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Members {
    fn new(topology: &Topology) -> Self {
        let mut starts = vec![0];
        starts.extend(topology.components.iter().scan(0, |total, component| {
            *total += component.faces;
            Some(*total)
        }));
        let mut next = starts.clone();
        let mut faces = vec![0; topology.face_components.len()];
        for (face, &component) in topology.face_components.iter().enumerate() {
            let place = &mut next[component as usize];
            faces[*place as usize] = face as u32;
            *place += 1;
        }
        Self { starts, faces }
    }

    fn of(&self, component: u32) -> &[u32] {
        let component = component as usize;
        &self.faces[self.starts[component] as usize..self.starts[component + 1] as usize]
    }
}
