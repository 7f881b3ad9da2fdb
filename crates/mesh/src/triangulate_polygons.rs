//! Polygon meshes to triangles.

use std::cmp::Ordering;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{
    Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Severity, choice, options,
};

use crate::ear_clipping::clip_ears;
use crate::{MeshError, MeshOrigins, Origins, PolyMesh, TriMesh, carry, newell_vector, triangle_normal};

choice! {
    /// Which diagonal cuts a quadrilateral, where both are inside it.
    pub enum QuadDiagonal {
        /// The shorter one.
        Shorter = "shorter",
        /// From the first corner to the third.
        First = "first",
        /// From the second corner to the fourth.
        Second = "second",
        /// The one whose triangles have less area together.
        SmallerArea = "smaller-area",
        /// The one at which the triangles make the flatter edge.
        Flatter = "flatter",
        /// The one whose triangles have the larger smallest angle, as in a Delaunay triangulation.
        LargerAngle = "larger-angle",
    }
}

options! {
    /// Cuts polygons, concave ones too, into triangles without new vertices.
    ///
    /// Each polygon is projected along the largest component of its Newell vector and its ears are clipped by exact
    /// signs (Meisters 1975); a quadrilateral takes the better of its diagonals by `quad_diagonal`, and a concave one the only one inside. Corners on straight sides are
    /// kept, so neighbours meet without gaps. Polygons that cross themselves or have no area are cut all the same and
    /// listed as findings. A polygon that is not flat has no surface of its own: the report then estimates the
    /// deviation by the largest distance of a corner from its polygon's mean plane. Cost: linear for convex polygons,
    /// corners times reflex corners in general.
    pub struct TriangulatePolygons("triangulate-polygons") {
        required {}
        optional {
            /// Which diagonal cuts a quadrilateral, where both are inside it; between equal ones the first.
            quad_diagonal: QuadDiagonal = QuadDiagonal::Shorter,
        }
    }
}

impl FromTolerance<PolyMesh> for TriangulatePolygons {
    fn from_tolerance(_: &PolyMesh, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<PolyMesh> for TriangulatePolygons {
    type Output = TriMesh;

    fn convert_with(&self, source: &PolyMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        if let Some(vertex) = source.first_non_finite() {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        let count = source.triangle_count();
        let _memory =
            exec.reserve((count as u64).saturating_mul(2 * 12 + 4).saturating_add(2 * source.memory_bytes() as u64))?;
        exec.check()?;
        let mut report = Report::exact(Self::NAME, "flat polygons are cut without new vertices");
        let (mut wedges, mut faces) = (Vec::with_capacity(count * 3), Vec::with_capacity(count));
        let (mut local, mut flat) = (Vec::new(), Vec::new());
        let mut bend = 0.0f64;
        for face in 0..source.face_count() {
            if face % 1024 == 0 {
                exec.check()?;
                exec.progress(face as f64 / source.face_count() as f64);
            }
            local.clear();
            let simple = triangulate_face(source, face, self.quad_diagonal, &mut flat, &mut local, exec)?;
            let first = source.wedges(face).start as u32;
            wedges.extend(local.as_flattened().iter().map(|corner| first + corner));
            faces.extend(std::iter::repeat_n(face as u32, local.len()));
            if !simple {
                let place = Place::element("face", face as u64);
                let message = "polygons that cross themselves or have no area were cut as well as possible";
                report.findings.push("W-polygon-simple", Severity::Warning, place, message);
            }
            bend = bend.max(out_of_plane(source, face));
        }
        if bend > 0.0 {
            report.deviation = Deviation::Estimated(bend);
            report.basis = "the largest distance of a corner from its polygon's mean plane".to_owned();
        }
        let corner = |wedge: u32| source.wedge_vertices()[wedge as usize];
        let triangles = wedges.as_chunks::<3>().0.iter().map(|triangle| triangle.map(corner)).collect();
        let origins =
            MeshOrigins { vertex: Origins::Same, face: Origins::Copies(faces), wedge: Origins::Copies(wedges) };
        let (attributes, losses) = carry(source.attributes(), &origins);
        report.losses.extend(losses);
        report.figure("triangles", count as f64);
        let mesh = TriMesh::with_attributes(source.positions().to_vec(), triangles, attributes)?;
        Ok(Converted::new(mesh, report))
    }
}

/// How far a face's corners are from flat; zero when that is within the rounding of its coordinates.
fn out_of_plane(mesh: &PolyMesh, face: usize) -> f64 {
    if mesh.face(face).len() == 3 {
        return 0.0;
    }
    let size = mesh.outline(face).map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    let bend = mesh.planarity(face);
    if bend <= 16.0 * f64::EPSILON * size { 0.0 } else { bend }
}

/// Cuts one face into triangles of local corner indices; false when the outline is not simple.
fn triangulate_face(
    mesh: &PolyMesh,
    face: usize,
    quad_diagonal: QuadDiagonal,
    flat: &mut Vec<DVec2>,
    out: &mut Vec<[u32; 3]>,
    exec: &Exec,
) -> Result<bool, ConvertError> {
    let count = mesh.face(face).len();
    if count == 3 {
        out.push([0, 1, 2]);
        return Ok(true);
    }
    project(mesh.outline(face), flat);
    if count == 4 {
        let corners: Vec<DVec3> = mesh.outline(face).collect();
        let valid = |a: usize, b: usize, c: usize, d: usize| {
            orient2d(flat[a], flat[b], flat[c]) == Ordering::Greater
                && orient2d(flat[a], flat[c], flat[d]) == Ordering::Greater
        };
        let (first, second) = (valid(0, 1, 2, 3), valid(1, 2, 3, 0));
        if first && (!second || quad_diagonal.is_first([corners[0], corners[1], corners[2], corners[3]])) {
            out.extend([[0, 1, 2], [0, 2, 3]]);
            return Ok(true);
        }
        if second {
            out.extend([[1, 2, 3], [1, 3, 0]]);
            return Ok(true);
        }
    }
    Ok(clip_ears(flat, exec, out)?)
}

impl QuadDiagonal {
    /// Whether the first diagonal of a quadrilateral is better than the second, or as good.
    fn is_first(self, [a, b, c, d]: [DVec3; 4]) -> bool {
        // The cost of the cut from the first to the third corner given.
        let cost = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| {
            let triangles = [[a, b, c], [a, c, d]];
            match self {
                Self::Shorter => a.distance_squared(c),
                Self::First | Self::Second => 0.0,
                Self::SmallerArea => triangles.map(|[a, b, c]| (b - a).cross(c - a).length()).iter().sum(),
                Self::Flatter => {
                    let [one, other] = triangles.map(triangle_normal);
                    -one.dot(other)
                }
                Self::LargerAngle => triangles.map(largest_cosine).into_iter().fold(-1.0, f64::max),
            }
        };
        match self {
            Self::First => true,
            Self::Second => false,
            _ => cost(a, b, c, d) <= cost(b, c, d, a),
        }
    }
}

/// The cosine of a triangle's smallest angle.
fn largest_cosine([a, b, c]: [DVec3; 3]) -> f64 {
    let cosine = |a: DVec3, b: DVec3, c: DVec3| (b - a).normalize_or_zero().dot((c - a).normalize_or_zero());
    cosine(a, b, c).max(cosine(b, c, a)).max(cosine(c, a, b))
}

/// Projects an outline along the largest component of its Newell vector, turned so that it is counter-clockwise.
pub(crate) fn project(outline: impl Iterator<Item = DVec3> + Clone, flat: &mut Vec<DVec2>) {
    let normal = newell_vector(outline.clone());
    let size = normal.abs();
    let drop = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (i, j) = ((drop + 1) % 3, (drop + 2) % 3);
    let (i, j) = if normal[drop] >= 0.0 { (i, j) } else { (j, i) };
    flat.clear();
    flat.extend(outline.map(|corner| DVec2::new(corner[i], corner[j])));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::poly_mesh::tests::unit_cube;
    use crate::{Column, Domain, Values};

    #[test]
    fn a_cube_becomes_twelve_triangles_of_the_same_volume() {
        let mut cube = unit_cube();
        cube.insert_attribute(Domain::Face, Column::labels("side", (0..6).collect())).unwrap();
        cube.insert_attribute(Domain::Wedge, Column::labels("corner", cube.wedge_vertices().to_vec())).unwrap();
        let converted = TriangulatePolygons::new().convert(&cube).unwrap();
        let mesh = converted.value;
        assert_eq!((mesh.triangles().len(), mesh.volume(), mesh.area()), (12, 1.0, 6.0));
        assert_eq!(converted.report.deviation, Deviation::Exact);
        let corners = mesh.attribute(Domain::Wedge, "corner").unwrap();
        assert_eq!(corners.values(), &Values::U32(mesh.triangles().as_flattened().to_vec()));
        assert_eq!(mesh.attribute(Domain::Face, "side").unwrap().number(11, 0), 5.0);
    }

    #[test]
    fn concave_faces_keep_their_area_in_every_plane_and_orientation() {
        let outline = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)].map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
        for axis in 0..3 {
            for reversed in [false, true] {
                let mut positions = vec![DVec3::ZERO; 5];
                for (position, corner) in positions.iter_mut().zip(outline) {
                    position[(axis + 1) % 3] = corner.x;
                    position[(axis + 2) % 3] = corner.y;
                }
                let mut face = [0, 1, 2, 3, 4];
                if reversed {
                    face.reverse();
                }
                let polygon = PolyMesh::from_faces(positions, &[face]).unwrap();
                let mesh = TriangulatePolygons::new().convert(&polygon).unwrap().value;
                assert!((mesh.area() - polygon.area()).abs() < 1e-14 && (mesh.area() - 8.0).abs() < 1e-14);
                let side = if reversed { -1.0 } else { 1.0 };
                assert!(crate::face_normals(&mesh).iter().all(|normal| normal[axis] == side));
            }
        }
    }

    #[test]
    fn an_arrowhead_takes_its_only_diagonal() {
        let arrow = [(0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (2.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let mesh = PolyMesh::from_faces(arrow.to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let triangles = TriangulatePolygons::new().convert(&mesh).unwrap().value;
        assert_eq!(triangles.triangles(), [[0, 1, 2], [0, 2, 3]]);
    }

    /// A convex quadrilateral on which the criteria disagree, and an arrowhead on which all must agree.
    #[test]
    fn criteria_choose_among_diagonals_that_are_inside() {
        use QuadDiagonal::{First, Flatter, LargerAngle, Second, Shorter, SmallerArea};
        let cut = |corners: [(f64, f64, f64); 4], quad_diagonal: QuadDiagonal| {
            let mesh = PolyMesh::from_faces(corners.map(DVec3::from).to_vec(), &[[0, 1, 2, 3]]).unwrap();
            let triangles = TriangulatePolygons { quad_diagonal }.convert(&mesh).unwrap().value;
            assert!(crate::face_normals(&triangles).iter().all(|normal| normal.z > 0.0), "{quad_diagonal:?}");
            let diagonal = |t: &[u32; 3]| t.contains(&0) && t.contains(&2);
            (triangles.triangles().iter().all(diagonal), triangles)
        };
        // A kite: the short diagonal makes two slivers, the long one two fair triangles.
        let kite = [(0.0, 0.0, 0.0), (2.0, -0.3, 0.0), (2.5, 0.0, 0.0), (2.0, 0.3, 0.0)];
        assert!(cut(kite, First).0 && !cut(kite, Second).0 && !cut(kite, Shorter).0);
        // Angles by hand: 0-2 gives atan(0.3/2) = 8.5 degrees; 1-3 gives atan(0.3/0.5) = 31 and, at corner 0, 17.1.
        assert!(!cut(kite, LargerAngle).0);
        let long = [(0.0, 0.0, 0.0), (1.0, -0.9, 0.0), (2.0, 0.0, 0.0), (1.0, 0.9, 0.0)];
        assert!(!cut(long, Shorter).0 && !cut(long, LargerAngle).0);
        // A sliver beside an equilateral triangle, or two halves: the smallest angle of both decides.
        let flat = [(0.0, 0.0, 0.0), (1.0, -0.15, 0.0), (2.0, 0.0, 0.0), (1.0, 1.73, 0.0)];
        assert!(!cut(flat, LargerAngle).0);
        // One corner is lifted: cutting it off keeps the other triangle flat and folds at the other diagonal.
        let lifted = [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)];
        let area = |diagonal| cut(lifted, diagonal).1.area();
        assert_eq!(area(SmallerArea), area(First).min(area(Second)));
        let fold = |diagonal| {
            let normals = crate::face_normals(&cut(lifted, diagonal).1);
            normals[0].dot(normals[1])
        };
        assert_eq!(fold(Flatter), fold(First).max(fold(Second)));
        assert!(fold(First) != fold(Second) && area(First) != area(Second));
        let arrow = [(0.0, 0.0, 0.0), (2.0, -1.0, 0.0), (0.5, 0.0, 0.1), (2.0, 1.0, 0.0)];
        for diagonal in [First, Second, Shorter, SmallerArea, Flatter, LargerAngle] {
            assert!(cut(arrow, diagonal).0);
            let turned = [arrow[1], arrow[2], arrow[3], arrow[0]];
            assert!(!cut(turned, diagonal).0);
        }
    }

    #[test]
    fn bent_and_crossing_polygons_are_told() {
        let bent = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.4), (0.0, 1.0, 0.0)];
        let mesh = PolyMesh::from_faces(bent.map(DVec3::from).to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let report = TriangulatePolygons::new().convert(&mesh).unwrap().report;
        assert!(matches!(report.deviation, Deviation::Estimated(bend) if bend > 0.05 && bend < 0.4));
        let bow = [(0.0, 0.0, 0.0), (2.0, 2.0, 0.0), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)];
        let mesh = PolyMesh::from_faces(bow.map(DVec3::from).to_vec(), &[[0, 1, 2, 3]]).unwrap();
        assert_eq!(TriangulatePolygons::new().convert(&mesh).unwrap().report.findings.iter().count(), 1);
    }
}
