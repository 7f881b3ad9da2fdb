//! Normals of vertices.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, Convert, ConvertError, Converted, Exec, FromTolerance, Options, Report, choice, options};

use crate::{Column, Domain, MeshError, NORMAL, TriMesh, face_normals};

choice! {
    /// How the normals of the faces around a vertex are weighted.
    pub enum NormalWeight {
        /// By the angle of the face at the vertex (Thürmer and Wüthrich 1998): independent of how flat regions are cut
        /// into triangles.
        Angle = "angle",
        /// By the area of the face.
        Area = "area",
        /// All the same.
        Uniform = "uniform",
    }
}

options! {
    /// Gives a mesh unit normals from the faces around each vertex.
    ///
    /// With a crease angle of 180 degrees each vertex has one normal; below it each corner averages only the faces
    /// whose normals differ from its own face's by no more than that, and normals are stored on wedges. Normals that
    /// were there are replaced. Vertices without faces of non-zero area get a zero normal. Cost: linear for one normal
    /// a vertex; for creases the sum of squared valences.
    pub struct VertexNormals("vertex-normals") {
        required {}
        optional {
            /// How the faces around a vertex are weighted.
            weight: NormalWeight = NormalWeight::Angle,
            /// Faces that meet at a larger angle than this, in degrees, do not share a normal.
            crease_angle: f64 [Bounds::closed(0.0, 180.0)] = 180.0,
        }
    }
}

impl FromTolerance<TriMesh> for VertexNormals {
    fn from_tolerance(_: &TriMesh, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<TriMesh> for VertexNormals {
    type Output = TriMesh;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        if let Some(vertex) = source.first_non_finite() {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        let wedges = source.triangles().len() as u64 * 3;
        let _memory = exec.reserve_elements(wedges * 3 + source.positions().len() as u64, size_of::<DVec3>())?;
        exec.check()?;
        let faces = face_normals(source);
        let weighted: Vec<DVec3> =
            (0..source.triangles().len() * 3).map(|wedge| faces[wedge / 3] * self.weight_of(source, wedge)).collect();
        exec.check()?;

        let mut mesh = source.clone();
        mesh.remove_attribute(Domain::Vertex, NORMAL);
        mesh.remove_attribute(Domain::Wedge, NORMAL);
        if self.crease_angle >= 180.0 {
            let mut sums = vec![DVec3::ZERO; source.positions().len()];
            for (&vertex, &normal) in source.triangles().as_flattened().iter().zip(&weighted) {
                sums[vertex as usize] += normal;
            }
            let normals: Vec<DVec3> = sums.into_iter().map(DVec3::normalize_or_zero).collect();
            mesh.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &normals)).map_err(MeshError::from)?;
        } else {
            let normals = creased(source, &faces, &weighted, self.crease_angle.to_radians().cos(), exec)?;
            mesh.insert_attribute(Domain::Wedge, Column::normals(NORMAL, &normals)).map_err(MeshError::from)?;
        }
        let report = Report::exact(Self::NAME, "positions and triangles are kept");
        Ok(Converted::new(mesh, report))
    }
}

impl VertexNormals {
    fn weight_of(&self, mesh: &TriMesh, wedge: usize) -> f64 {
        let corners = mesh.corners(wedge / 3);
        let [at, next, previous] = [0, 1, 2].map(|step| corners[(wedge + step) % 3]);
        let (a, b) = (next - at, previous - at);
        match self.weight {
            NormalWeight::Uniform => 1.0,
            NormalWeight::Area => a.cross(b).length(),
            NormalWeight::Angle => a.cross(b).length().atan2(a.dot(b)),
        }
    }
}

/// The normal of each wedge: the weighted sum over the faces at its vertex within the crease angle of its own face.
fn creased(
    mesh: &TriMesh,
    faces: &[DVec3],
    weighted: &[DVec3],
    cosine: f64,
    exec: &Exec,
) -> Result<Vec<DVec3>, ConvertError> {
    let corners = mesh.triangles().as_flattened();
    let mut starts = vec![0u32; mesh.positions().len() + 1];
    for &vertex in corners {
        starts[vertex as usize + 1] += 1;
    }
    for vertex in 0..mesh.positions().len() {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut around = vec![0u32; corners.len()];
    for (wedge, &vertex) in corners.iter().enumerate() {
        around[next[vertex as usize] as usize] = wedge as u32;
        next[vertex as usize] += 1;
    }
    let mut normals = Vec::with_capacity(corners.len());
    for (wedge, &vertex) in corners.iter().enumerate() {
        if wedge % 4096 == 0 {
            exec.check()?;
        }
        let own = faces[wedge / 3];
        let fan = &around[starts[vertex as usize] as usize..starts[vertex as usize + 1] as usize];
        // Rounding must not part faces that meet at just the crease angle.
        let near = fan.iter().filter(|&&other| faces[other as usize / 3].dot(own) >= cosine - 1e-12);
        normals.push(near.map(|&other| weighted[other as usize]).sum::<DVec3>().normalize_or_zero());
    }
    Ok(normals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriangulatePolygons;
    use crate::poly_mesh::tests::unit_cube;

    fn cube() -> TriMesh {
        TriangulatePolygons::new().convert(&unit_cube()).unwrap().value
    }

    #[test]
    fn angle_weights_do_not_see_the_diagonals_of_a_cube() {
        let mesh = VertexNormals::new().convert(&cube()).unwrap().value;
        let normals = mesh.attribute(Domain::Vertex, NORMAL).unwrap();
        for (vertex, position) in mesh.positions().iter().enumerate() {
            let outward = (*position - DVec3::splat(0.5)).normalize();
            assert!((normals.vector(vertex) - outward).length() < 1e-15, "{vertex}");
        }
        // Uniform weights do see them.
        let uniform = VertexNormals { weight: NormalWeight::Uniform, ..VertexNormals::new() };
        let mesh = uniform.convert(&cube()).unwrap().value;
        let normals = mesh.attribute(Domain::Vertex, NORMAL).unwrap();
        let outward = |vertex: usize| (mesh.positions()[vertex] - DVec3::splat(0.5)).normalize();
        assert!((0..8).any(|vertex| (normals.vector(vertex) - outward(vertex)).length() > 0.1));
    }

    #[test]
    fn creases_keep_the_sides_of_a_cube_flat() {
        let sharp = VertexNormals { crease_angle: 45.0, ..VertexNormals::new() };
        let mesh = sharp.convert(&cube()).unwrap().value;
        let normals = mesh.attribute(Domain::Wedge, NORMAL).unwrap();
        let faces = face_normals(&mesh);
        for wedge in 0..36 {
            assert!((normals.vector(wedge) - faces[wedge / 3]).length() < 1e-15);
        }
        // At exactly 90 degrees all faces join again.
        let joined = VertexNormals { crease_angle: 90.0, ..VertexNormals::new() }.convert(&cube()).unwrap().value;
        let normal = joined.attribute(Domain::Wedge, NORMAL).unwrap().vector(0);
        assert!((normal.abs() - DVec3::splat(1.0 / 3f64.sqrt())).length() < 1e-15);
    }

    #[test]
    fn options_and_positions_are_checked() {
        let wrong = VertexNormals { crease_angle: f64::NAN, ..VertexNormals::new() };
        assert!(wrong.convert(&cube()).is_err());
        let mut mesh = cube();
        mesh.positions_mut()[3].x = f64::INFINITY;
        assert!(VertexNormals::new().convert(&mesh).is_err());
    }
}
