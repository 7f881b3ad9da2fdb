//! Closed shells: which way they face, and how they lie in one another.

use std::collections::BTreeMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec};
use shapeloom_mesh::TriMesh;

use crate::scaled::exact_middle;
use crate::solid::Met;
use crate::{JudgeError, Solid, Topology};

/// A closed component whose faces turn alike and which encloses a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Its smallest face.
    pub first_face: u32,
    /// Whether its faces look outward: its signed volume, in floating point, is above 0.
    pub outward: bool,
    /// How many other shells it lies in, decided exactly.
    pub depth: u32,
}

impl Shell {
    /// Whether it faces the wrong way: a shell in an even number of others bounds a solid from outside, one in an odd number
    /// a cavity.
    pub fn is_inverted(&self) -> bool {
        self.outward != self.depth.is_multiple_of(2)
    }
}

/// The shells of a mesh of triangles with that report.
///
/// Whether one lies in another is asked at its vertices, the middles of its sides and points in its faces, until one is
/// not on the other. Middles that are no numbers exactly are passed over; a shell of which no point tells is taken to be
/// outside.
///
/// Cost: a ray for each shell, and more where shells touch.
pub(super) fn shells(mesh: &TriMesh, topology: &Topology, exec: &Exec) -> Result<Vec<Shell>, JudgeError> {
    let triangles = mesh.triangles();
    let _memory = exec.reserve(triangles.len() as u64 * 8 + topology.components.len() as u64 * 64)?;
    let members = Members::new(topology);
    let solid = Solid::new(mesh, exec)?;
    let mut found = Vec::new();
    let mut boxes = Vec::new();
    let mut number = vec![None; topology.components.len()];
    for (component, part) in topology.components.iter().enumerate().filter(|(_, part)| part.is_shell()) {
        exec.check()?;
        let volume = solid.volume_of(members.of(component as u32));
        if volume != 0.0 {
            let vertices = members.of(component as u32).iter().flat_map(|&face| triangles[face as usize]);
            boxes.push(Aabb::from_points(vertices.map(|vertex| solid.position(vertex))));
            number[component] = Some(found.len());
            found.push(Shell { first_face: part.first_face, outward: volume > 0.0, depth: 0 });
        }
    }
    // The shells met by the ray from a point: how often they wind around it, none where it lies on one.
    let mut met: BTreeMap<usize, Option<i64>> = BTreeMap::new();
    let around = |point: DVec3, met: &mut BTreeMap<usize, Option<i64>>| {
        met.clear();
        solid.each_met(point, |triangle, how| {
            let Some(shell) = number[topology.face_components[triangle as usize] as usize] else { return };
            let winding = met.entry(shell).or_insert(Some(0));
            *winding = match how {
                Met::On => None,
                Met::Ahead(turns) => winding.map(|winding| winding + turns),
            };
        });
    };
    let numbered = number.iter().enumerate().filter_map(|(component, own)| Some((component as u32, (*own)?)));
    for (component, own) in numbered {
        exec.check()?;
        let faces = members.of(component);
        around(solid.position(triangles[faces[0] as usize][0]), &mut met);
        // What crosses another is not in it: a shell in another has its box in the other's.
        let held = |other: usize| {
            other != own && boxes[other].contains(boxes[own].min) && boxes[other].contains(boxes[own].max)
        };
        let holding = met.iter().filter(|&(&other, _)| held(other));
        let (touching, apart): (Vec<_>, Vec<_>) = holding.partition(|(_, winding)| winding.is_none());
        let mut depth = apart.iter().filter(|&&(_, winding)| *winding != Some(0)).count();
        let touching: Vec<usize> = touching.into_iter().map(|(&other, _)| other).collect();
        for other in touching {
            for (count, point) in points_of(faces.iter().map(|&face| triangles[face as usize]), &solid).enumerate() {
                if count.is_multiple_of(64) {
                    exec.check()?;
                }
                around(point, &mut met);
                match met.get(&other) {
                    Some(None) => continue,
                    Some(&Some(winding)) => depth += usize::from(winding != 0),
                    None => {}
                }
                break;
            }
        }
        found[own].depth = depth as u32;
    }
    Ok(found)
}

/// Points of triangles: the corners of all, the middles of their sides, and a point inside each.
fn points_of<'a>(
    triangles: impl Iterator<Item = [u32; 3]> + Clone + 'a,
    solid: &'a Solid<'_>,
) -> impl Iterator<Item = DVec3> + 'a {
    let placed = triangles.map(|triangle| triangle.map(|vertex| solid.position(vertex)));
    let sides = placed.clone().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).filter_map(|[a, b]| exact_middle(a, b));
    let inner = placed.clone().filter_map(|[a, b, c]| exact_middle(exact_middle(a, b)?, c));
    placed.flatten().chain(sides).chain(inner)
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
