//! Ready shapes with closed-form facts: each is a struct of options whose `mesh` gives polygons and a report.
//!
//! The deviation in the report is proven against the exact shape: the sphere, not its facets.

mod cone;
mod cylinder;
mod ellipsoid;
mod grid;
mod platonic;
mod quadric;
mod sphere;
mod torus;

pub use cone::Cone;
pub use cylinder::Cylinder;
pub use ellipsoid::{Ellipsoid, SphereCut};
pub use grid::Grid;
pub use platonic::{Platonic, Solid};
pub use quadric::{Quadric, QuadricShape};
pub use sphere::Sphere;
pub use torus::Torus;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Deviation, Exec, Report};

use crate::{Column, Domain, MeshError, NORMAL, PolyMesh};

/// The point at `index` of `count` around the z axis, exact at the quarters so that shapes close without rounding.
fn around(index: u32, count: u32) -> DVec3 {
    let index = index % count;
    match (4 * u64::from(index)).checked_rem(u64::from(count)) {
        Some(0) => [DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y][(4 * u64::from(index) / u64::from(count)) as usize],
        _ => {
            let angle = std::f64::consts::TAU * f64::from(index) / f64::from(count);
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        }
    }
}

/// Lengths that shapes are made with: products of three of them are still numbers.
const LENGTH: Bounds = Bounds { min: 1e-100, above: false, max: 1e100 };

/// Bytes that a quad mesh with normals takes for each vertex while it is built.
const BYTES_A_VERTEX: usize = 160;

/// A bound from a closed form, with room for the rounding of coordinates of that size.
fn proven(bound: f64, size: f64) -> Deviation {
    Deviation::AtMost(bound + 16.0 * f64::EPSILON * size)
}

/// Puts a primitive together, with the unit normals of its wedges if it has any.
fn finish(
    name: &'static str,
    positions: Vec<DVec3>,
    faces: (Vec<u32>, Vec<u32>),
    normals: Option<Vec<DVec3>>,
    deviation: Deviation,
    exec: &Exec,
) -> Result<Converted<PolyMesh>, ConvertError> {
    exec.check()?;
    let mut mesh = PolyMesh::try_new(positions, faces.0, faces.1)?;
    if let Some(normals) = normals {
        mesh.insert_attribute(Domain::Wedge, Column::normals(NORMAL, &normals)).map_err(MeshError::from)?;
    }
    let mut report = Report::new(name, deviation, "the facets' distance from the exact shape, in closed form");
    report.figure("faces", mesh.face_count() as f64);
    Ok(Converted::new(mesh, report))
}

/// Faces of any number of corners, built one at a time.
struct FaceList {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl FaceList {
    fn new() -> Self {
        Self { starts: vec![0], corners: Vec::new() }
    }

    fn push(&mut self, face: &[u32]) {
        self.corners.extend_from_slice(face);
        self.starts.push(self.corners.len() as u32);
    }

    fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        (self.starts, self.corners)
    }
}
