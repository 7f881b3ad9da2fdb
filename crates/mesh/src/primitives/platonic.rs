//! The five platonic solids.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Converted, Deviation, Exec, Options, choice, options};

use super::{FaceList, LENGTH, finish};
use crate::PolyMesh;

choice! {
    /// One of the five regular convex polyhedra.
    pub enum Solid {
        /// Four triangles.
        Tetrahedron = "tetrahedron",
        /// Six squares.
        Cube = "cube",
        /// Eight triangles.
        Octahedron = "octahedron",
        /// Twelve pentagons.
        Dodecahedron = "dodecahedron",
        /// Twenty triangles.
        Icosahedron = "icosahedron",
    }
}

options! {
    /// A platonic solid centred at the origin.
    pub struct Platonic("platonic") {
        required {
            /// Which solid.
            solid: Solid,
        }
        optional {
            /// The length of its edges, in model units.
            edge: f64 [LENGTH] = 1.0,
        }
    }
}

/// The golden ratio.
const PHI: f64 = 1.618_033_988_749_895;

impl Platonic {
    /// The polygons of the solid, exact up to rounding.
    ///
    /// # Errors
    /// An edge that is not positive and finite; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let (corners, edge) = match self.solid {
            Solid::Tetrahedron => {
                (vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]], 8f64.sqrt())
            }
            Solid::Cube => (cube_corners(), 2.0),
            Solid::Octahedron => (cyclic(&[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]), 2f64.sqrt()),
            Solid::Icosahedron => (cyclic(&signs(0.0, 1.0, PHI)), 2.0),
            Solid::Dodecahedron => {
                let mut corners = cube_corners();
                corners.extend(cyclic(&signs(0.0, 1.0 / PHI, PHI)));
                (corners, 2.0 / PHI)
            }
        };
        // Faces are found at a size where distances neither vanish nor overflow.
        let corners: Vec<DVec3> = corners.into_iter().map(DVec3::from).collect();
        let faces = convex_faces(&corners, edge);
        let positions = corners.into_iter().map(|corner| corner * (self.edge / edge)).collect();
        finish(self.solid_name(), positions, faces.into_parts(), None, Deviation::Exact, exec)
    }

    fn solid_name(&self) -> &'static str {
        shapeloom_core::ChoiceOption::name(self.solid)
    }
}

fn cube_corners() -> Vec<[f64; 3]> {
    (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 })).collect()
}

fn signs(x: f64, y: f64, z: f64) -> Vec<[f64; 3]> {
    [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].iter().map(|(s, t)| [x, s * y, t * z]).collect()
}

fn cyclic(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    (0..3)
        .flat_map(|turn| points.iter().map(move |p| [p[(3 - turn) % 3], p[(4 - turn) % 3], p[(5 - turn) % 3]]))
        .collect()
}

/// The faces of a regular polyhedron from its corners: walks along edges, turning as little as the outside allows.
fn convex_faces(positions: &[DVec3], edge: f64) -> FaceList {
    let near = |a: DVec3, b: DVec3| (a.distance(b) / edge - 1.0).abs() < 1e-6;
    let neighbours = |v: usize| (0..positions.len()).filter(move |&w| near(positions[v], positions[w]));
    let mut faces = FaceList::new();
    let mut used = std::collections::HashSet::new();
    for start in 0..positions.len() {
        for second in neighbours(start) {
            if used.contains(&(start, second)) {
                continue;
            }
            // The face to the left of an edge goes on to the neighbour that is most to the left, seen from outside.
            let mut face = vec![start as u32];
            let (mut from, mut to) = (start, second);
            loop {
                used.insert((from, to));
                if to == start {
                    break;
                }
                face.push(to as u32);
                let (out, ahead) = (positions[to].normalize(), positions[to] - positions[from]);
                let left = out.cross(ahead);
                let turn = |w: usize| {
                    let step = positions[w] - positions[to];
                    step.dot(left).atan2(step.dot(ahead))
                };
                let next = neighbours(to).filter(|&w| w != from).max_by(|&a, &b| turn(a).total_cmp(&turn(b)));
                (from, to) = (to, next.unwrap_or(start));
            }
            faces.push(&face);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces, corners a face, vertices, surface area and volume for edge 1, as published.
    #[test]
    fn counts_areas_and_volumes_are_as_published() {
        let facts = [
            (Solid::Tetrahedron, 4, 3, 4, 3f64.sqrt(), 2f64.sqrt() / 12.0),
            (Solid::Cube, 6, 4, 8, 6.0, 1.0),
            (Solid::Octahedron, 8, 3, 6, 2.0 * 3f64.sqrt(), 2f64.sqrt() / 3.0),
            (
                Solid::Dodecahedron,
                12,
                5,
                20,
                3.0 * (25.0 + 10.0 * 5f64.sqrt()).sqrt(),
                (15.0 + 7.0 * 5f64.sqrt()) / 4.0,
            ),
            (Solid::Icosahedron, 20, 3, 12, 5.0 * 3f64.sqrt(), 5.0 * (3.0 + 5f64.sqrt()) / 12.0),
        ];
        for (solid, faces, corners, vertices, area, volume) in facts {
            for edge in [1.0, 0.125] {
                let mesh = Platonic { edge, ..Platonic::new(solid) }.mesh(&Exec::default()).unwrap().value;
                assert_eq!((mesh.face_count(), mesh.positions().len()), (faces, vertices), "{solid:?}");
                assert!(mesh.faces().all(|face| face.len() == corners), "{solid:?}");
                assert!((mesh.area() / (area * edge * edge) - 1.0).abs() < 1e-14, "{solid:?}");
                assert!((mesh.volume() / (volume * edge.powi(3)) - 1.0).abs() < 1e-14, "{solid:?}");
                assert!((0..faces).all(|face| mesh.planarity(face) < 1e-15), "{solid:?}");
            }
        }
    }
}
