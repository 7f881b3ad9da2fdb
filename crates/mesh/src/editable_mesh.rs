//! Meshes that can be edited, with positions and attributes.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Exec, Loss, Stop};

use crate::ear_clipping::clip_ears;
use crate::structures::{
    EdgeId, FaceId, HalfEdgeId, HalfEdgeMesh, Hole, Illegal, Incidence, IndexedPolygons, IndexedTriangles,
    StructureError, VertexId,
};
use crate::triangulate_polygons::project;
use crate::{MeshAttributes, MeshOrigins, Origins, PolyMesh, TriMesh, carry};

/// How many vertices of the source a vertex is mixed from at most.
const SOURCES: usize = 32;

/// Vertices of the source, rising, with weights of sum 1.
type Mixture = Box<[(u32, f64)]>;

/// A [`HalfEdgeMesh`] with positions, which refuses what would fold it over, and remembers where its vertices and
/// faces come from, so that attributes arrive.
///
/// A vertex that is split off or moved along an edge is a mixture of the edge's ends, one in a face a mixture of its
/// corners; mixtures are followed back to at most 32 vertices of the source, of which the heaviest are kept. A face that is
/// cut gives its attributes to its parts; an edge that is flipped leaves each of its faces those of its number. Attributes
/// of wedges are kept as long as no operator ran, and are then named in the losses: across a flip or collapse a
/// corner has no one place to come from.
///
/// Positions may be any numbers; where one is not finite, operators that would need it refuse.
#[derive(Clone, Debug)]
pub struct EditableMesh {
    connectivity: HalfEdgeMesh,
    positions: Vec<DVec3>,
    /// The least cosine of the angle by which a face may turn in one operator: 0 unless set, which is less than 90
    /// degrees. At −1 and below nothing but faces that lose all area is refused; NaN refuses everything.
    pub min_cosine: f64,
    attributes: MeshAttributes,
    /// What each vertex is mixed of; none for vertices that are those of the source.
    mixed: Vec<Option<Mixture>>,
    face_sources: Vec<u32>,
    changed: bool,
}

/// What a mesh is made of, without gaps.
struct Parts {
    faces: IndexedPolygons,
    positions: Vec<DVec3>,
    attributes: MeshAttributes,
    losses: Vec<Loss>,
}

/// Conversions, and what is there.
impl EditableMesh {
    /// A triangle mesh, to be edited.
    ///
    /// # Errors
    /// What [`HalfEdgeMesh::try_build`] cannot hold, with the elements at fault; the budget, or the reason to stop.
    pub fn try_from_triangles(mesh: &TriMesh, exec: &Exec) -> Result<Self, StructureError> {
        let _memory = exec.reserve_elements(mesh.triangles().len() as u64, 16)?;
        let faces = IndexedPolygons::from(&IndexedTriangles::from(mesh));
        Self::new(&faces, mesh.positions(), mesh.attributes(), exec)
    }

    /// A polygon mesh, to be edited.
    ///
    /// # Errors
    /// As [`EditableMesh::try_from_triangles`].
    pub fn try_from_polygons(mesh: &PolyMesh, exec: &Exec) -> Result<Self, StructureError> {
        let _memory = exec.reserve_elements(mesh.wedge_vertices().len() as u64, 8)?;
        Self::new(&IndexedPolygons::from(mesh), mesh.positions(), mesh.attributes(), exec)
    }

    fn new(
        faces: &IndexedPolygons,
        positions: &[DVec3],
        attributes: &MeshAttributes,
        exec: &Exec,
    ) -> Result<Self, StructureError> {
        let _memory = exec.reserve_elements(positions.len() as u64, size_of::<DVec3>() + 16)?;
        let _columns = exec.reserve(attributes.memory_bytes() as u64)?;
        let connectivity = HalfEdgeMesh::try_build(faces, exec)?;
        let face_sources = (0..connectivity.face_slots() as u32).collect();
        let mixed = vec![None; positions.len()];
        Ok(Self {
            connectivity,
            positions: positions.to_vec(),
            min_cosine: 0.0,
            attributes: attributes.clone(),
            mixed,
            face_sources,
            changed: false,
        })
    }

    /// The connectivity.
    pub fn connectivity(&self) -> &HalfEdgeMesh {
        &self.connectivity
    }

    /// The position of each vertex number; those of deleted vertices mean nothing.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions, to be moved.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.positions
    }

    /// The polygons, without gaps in their numbers, and the attributes that could not be kept.
    ///
    /// # Errors
    /// The budget, or the reason to stop.
    pub fn to_polygons(&self, exec: &Exec) -> Result<(PolyMesh, Vec<Loss>), StructureError> {
        let Parts { faces, positions, attributes, losses } = self.parts(exec)?;
        let (starts, corners) = (faces.starts().to_vec(), faces.corners().to_vec());
        Ok((PolyMesh::with_attributes(positions, starts, corners, attributes)?, losses))
    }

    /// The triangles, without gaps in their numbers, and the attributes that could not be kept.
    ///
    /// # Errors
    /// A face that is no triangle, the budget, or the reason to stop.
    pub fn to_triangles(&self, exec: &Exec) -> Result<(TriMesh, Vec<Loss>), StructureError> {
        let Parts { faces, positions, attributes, losses } = self.parts(exec)?;
        let triangles = IndexedTriangles::try_from(&faces)?.into_triangles();
        Ok((TriMesh::with_attributes(positions, triangles, attributes)?, losses))
    }

    fn parts(&self, exec: &Exec) -> Result<Parts, StructureError> {
        exec.check()?;
        let _memory = exec.reserve(2 * self.connectivity.memory_bytes() as u64)?;
        let mut connectivity = self.connectivity.clone();
        let numbers = connectivity.compact();
        let positions = numbers.vertices.old().iter().map(|&old| self.positions[old as usize]).collect();
        let faces = IndexedPolygons::from(&connectivity);
        exec.check()?;
        let copies = numbers.faces.old().iter().map(|&old| self.face_sources[old as usize]).collect();
        let wedge = if self.changed {
            let why = "edges were changed, and corners have no one place to come from";
            Origins::Unknown { len: faces.corners().len(), why }
        } else {
            Origins::Same
        };
        let vertex = self.vertex_origins(numbers.vertices.old());
        let (attributes, losses) =
            carry(&self.attributes, &MeshOrigins { vertex, face: Origins::Copies(copies), wedge });
        Ok(Parts { faces, positions, attributes, losses })
    }

    fn vertex_origins(&self, old: &[u32]) -> Origins {
        if old.iter().all(|&vertex| self.mixed[vertex as usize].is_none()) {
            return Origins::Copies(old.to_vec());
        }
        let (mut starts, mut sources, mut weights) = (vec![0], Vec::new(), Vec::new());
        for &vertex in old {
            for (source, weight) in self.sources(vertex) {
                sources.push(source);
                weights.push(weight);
            }
            starts.push(sources.len() as u32);
        }
        Origins::Mixed { starts, sources, weights }
    }
}

/// Operators: those of [`HalfEdgeMesh`], refused where a face would turn over too.
impl EditableMesh {
    /// Flips an edge.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_flip`] and [`HalfEdgeMesh::flip_folds_over`].
    pub fn flip_edge(&mut self, edge: EdgeId) -> Result<(), Illegal> {
        self.connectivity.can_flip(edge)?;
        self.connectivity.flip_folds_over(edge, &self.positions, self.min_cosine)?;
        self.connectivity.flip_edge(edge)?;
        self.changed = true;
        Ok(())
    }

    /// Splits an edge at a place; the attributes are those of the nearest point of the edge.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_split_edge`] and [`HalfEdgeMesh::split_edge_folds_over`].
    pub fn split_edge(&mut self, edge: EdgeId, at: DVec3) -> Result<VertexId, Illegal> {
        self.connectivity.can_split_edge(edge)?;
        self.connectivity.split_edge_folds_over(edge, &self.positions, at, self.min_cosine)?;
        let ends = self.connectivity.ends(edge);
        let halves = self.connectivity.halves(edge);
        let mixture = self.along(ends, at);
        let parts = halves.map(|half| self.connectivity.face(half));
        let faces = self.connectivity.face_slots();
        let vertex = self.connectivity.split_edge(edge)?;
        self.positions.push(at);
        self.mixed.push(self.mix(&mixture));
        // New faces come from the left one first, if that was cut.
        let cut = self.connectivity.face_slots() - faces;
        let triangle = |face: &FaceId| self.connectivity.around_face(*face).nth(3).is_none();
        let of: Vec<FaceId> = parts.into_iter().flatten().filter(triangle).collect();
        for face in of.into_iter().take(cut) {
            self.face_sources.push(self.face_sources[face.index()]);
        }
        self.changed = true;
        Ok(vertex)
    }

    /// Splits a face at a place. The attributes are those of the nearest point of a triangle, and the mean of a larger
    /// polygon's corners.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_split_face`] and [`HalfEdgeMesh::split_face_folds_over`].
    pub fn split_face(&mut self, face: FaceId, at: DVec3) -> Result<VertexId, Illegal> {
        self.connectivity.can_split_face(face)?;
        self.connectivity.split_face_folds_over(face, &self.positions, at, self.min_cosine)?;
        let corners: Vec<VertexId> = self.connectivity.corners(face).collect();
        let mixture: Vec<(VertexId, f64)> = match corners.as_slice() {
            &[a, b, c] => [a, b, c].into_iter().zip(self.barycentric([a, b, c], at)).collect(),
            all => all.iter().map(|&corner| (corner, 1.0 / all.len() as f64)).collect(),
        };
        let vertex = self.connectivity.split_face(face)?;
        self.positions.push(at);
        self.mixed.push(self.mix(&mixture));
        self.face_sources.resize(self.connectivity.face_slots(), self.face_sources[face.index()]);
        self.changed = true;
        Ok(vertex)
    }

    /// Collapses an edge into one vertex at a place; the attributes are those of the nearest point of the edge.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_collapse`] and [`HalfEdgeMesh::collapse_folds_over`].
    pub fn collapse_edge(&mut self, edge: EdgeId, to: DVec3) -> Result<VertexId, Illegal> {
        if !self.connectivity.has_edge(edge) {
            return Err(Illegal::Gone { kind: "edge", index: edge.0 });
        }
        let half = self.connectivity.halves(edge)[0];
        self.check_collapse(half, to)?;
        let mixed = self.mix(&self.along(self.connectivity.ends(edge), to));
        let vertex = self.connectivity.collapse_half_edge(half)?;
        self.positions[vertex.index()] = to;
        self.mixed[vertex.index()] = mixed;
        self.changed = true;
        Ok(vertex)
    }

    /// Moves the vertex that a half-edge leaves into the one that it leads to, which keeps its place and attributes.
    ///
    /// # Errors
    /// As [`EditableMesh::collapse_edge`].
    pub fn collapse_half_edge(&mut self, half: HalfEdgeId) -> Result<VertexId, Illegal> {
        if !self.connectivity.has_half_edge(half) {
            return Err(Illegal::Gone { kind: "half-edge", index: half.0 });
        }
        self.check_collapse(half, self.positions[self.connectivity.target(half).index()])?;
        let vertex = self.connectivity.collapse_half_edge(half)?;
        self.changed = true;
        Ok(vertex)
    }

    fn check_collapse(&self, half: HalfEdgeId, to: DVec3) -> Result<(), Illegal> {
        self.connectivity.can_collapse(half)?;
        self.connectivity.collapse_folds_over(half, &self.positions, to, self.min_cosine)
    }

    /// Removes a vertex; triangles that fill the hole are ears of its outline in the plane, where that doubles no edge, else
    /// any that double none. Faces that fill it have the attributes of one that was there.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_remove_vertex`]; a face around it that does not look to the side of the hole, or a new one
    /// that does not.
    pub fn remove_vertex(&mut self, vertex: VertexId, hole: Hole) -> Result<Option<FaceId>, Illegal> {
        let corners = self.connectivity.removal(vertex)?;
        let mut ears = Vec::new();
        if hole == Hole::Triangles && corners.len() > 3 {
            ears = self.ears(&corners);
            let folds = |ears: &[[u32; 3]]| {
                self.connectivity.removal_folds_over(vertex, &self.positions, ears, self.min_cosine)
            };
            if ears.is_empty() || self.connectivity.refuse_doubled(&corners, &ears).is_err() || folds(&ears).is_err() {
                ears = self.connectivity.plan_ears(&corners)?;
            }
            folds(&ears)?;
        } else if !corners.is_empty() {
            self.connectivity.refuse_double_hole(vertex.0)?;
            self.connectivity.removal_folds_over(vertex, &self.positions, &[], self.min_cosine)?;
        }
        let face = self.connectivity.remove_with(vertex, &ears);
        if let Some(face) = face {
            self.face_sources.resize(self.connectivity.face_slots(), self.face_sources[face.index()]);
        }
        self.changed = true;
        Ok(face)
    }

    /// The ears of a hole's outline, seen along its vector area.
    fn ears(&self, corners: &[u32]) -> Vec<[u32; 3]> {
        let at = |vertex: u32| self.positions[vertex as usize];
        let spokes = corners.iter().map(|&corner| at(corner) - at(corners[0]));
        let size = spokes.clone().map(|spoke| spoke.abs().max_element()).fold(0.0, f64::max);
        let (mut flat, mut ears) = (Vec::<DVec2>::new(), Vec::new());
        // As large as one, so that no product overflows or vanishes.
        project(spokes.map(|spoke| spoke / size), &mut flat);
        if flat.iter().any(|corner| !corner.is_finite()) {
            return ears;
        }
        match clip_ears(&flat, &Exec::default(), &mut ears) {
            Ok(_) => ears,
            Err(Stop::Cancelled | Stop::TimeLimit) => Vec::new(),
        }
    }

    /// The ends of an edge with the weights of its point nearest to a place.
    fn along(&self, ends: [VertexId; 2], at: DVec3) -> [(VertexId, f64); 2] {
        let [a, b] = ends.map(|end| self.positions[end.index()]);
        let size = (b - a).abs().max_element();
        let (along, offset) = ((b - a) / size, (at - a) / size);
        let t = along.dot(offset) / along.length_squared();
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 };
        [(ends[0], 1.0 - t), (ends[1], t)]
    }

    /// The weights of a triangle's corners at a place, none negative; equal where the triangle has no area.
    fn barycentric(&self, corners: [VertexId; 3], at: DVec3) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| self.positions[corner.index()]);
        let size = (b - a).abs().max((c - a).abs()).max_element();
        let [ab, ac, ap] = [b - a, c - a, at - a].map(|spoke| spoke / size);
        let normal = ab.cross(ac);
        let share = |u: DVec3, v: DVec3| (u.cross(v).dot(normal) / normal.length_squared()).max(0.0);
        let parts = [share(ab - ap, ac - ap), share(ap, ac), share(ab, ap)];
        let sum: f64 = parts.iter().sum();
        if sum.is_finite() && sum > 0.0 { parts.map(|part| part / sum) } else { [1.0 / 3.0; 3] }
    }

    /// The vertices of the source that a vertex is mixed of.
    fn sources(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let own = &self.mixed[vertex as usize];
        let itself = own.is_none().then_some((vertex, 1.0));
        own.iter().flat_map(|own| own.iter().copied()).chain(itself)
    }

    /// A mixture of vertices as one of vertices of the source.
    fn mix(&self, parts: &[(VertexId, f64)]) -> Option<Mixture> {
        let whole = |&&(_, weight): &&(VertexId, f64)| weight > 0.0;
        let mut all: Vec<(u32, f64)> = Vec::new();
        for &(vertex, weight) in parts.iter().filter(whole) {
            all.extend(self.sources(vertex.0).map(|(source, share)| (source, share * weight)));
        }
        all.sort_by_key(|&(source, _)| source);
        all.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        if all.len() > SOURCES {
            all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            all.truncate(SOURCES);
            all.sort_by_key(|&(source, _)| source);
            let sum: f64 = all.iter().map(|&(_, weight)| weight).sum();
            all.iter_mut().for_each(|(_, weight)| *weight /= sum);
        }
        Some(all.into_boxed_slice())
    }
}

/// [`EditableMesh::try_from_triangles`] with the default [`Exec`].
impl TryFrom<&TriMesh> for EditableMesh {
    type Error = StructureError;

    fn try_from(mesh: &TriMesh) -> Result<Self, StructureError> {
        Self::try_from_triangles(mesh, &Exec::default())
    }
}

/// [`EditableMesh::try_from_polygons`] with the default [`Exec`].
impl TryFrom<&PolyMesh> for EditableMesh {
    type Error = StructureError;

    fn try_from(mesh: &PolyMesh) -> Result<Self, StructureError> {
        Self::try_from_polygons(mesh, &Exec::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{Grid, Platonic, Solid};
    use crate::{COLOR, Column, Domain, NORMAL, TEXCOORD, TriangulatePolygons, Values};
    use shapeloom_core::Convert;

    fn triangles(mesh: &PolyMesh) -> TriMesh {
        TriangulatePolygons::new().convert(mesh).unwrap().value
    }

    /// A square of four by four cells in the plane, with its coordinates as an attribute.
    fn grid() -> TriMesh {
        let grid = Grid { columns: 4, rows: 4, ..Grid::new() }.mesh(&Exec::default()).unwrap().value;
        let mut mesh = TriMesh::try_new(grid.positions().to_vec(), triangles(&grid).triangles().to_vec()).unwrap();
        let places: Vec<f64> = mesh.positions().iter().flat_map(|p| p.to_array()).collect();
        mesh.insert_attribute(Domain::Vertex, Column::try_new("place", 3, Values::F64(places)).unwrap()).unwrap();
        let labels = (0..mesh.triangles().len() as u32).collect();
        mesh.insert_attribute(Domain::Face, Column::labels("face", labels)).unwrap();
        mesh
    }

    fn dice(state: &mut u64, below: usize) -> usize {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 33) % below as u64) as usize
    }

    #[test]
    fn an_untouched_mesh_comes_back_to_the_bit() {
        let cube = Platonic::new(Solid::Cube).mesh(&Exec::default()).unwrap().value;
        let back = EditableMesh::try_from(&cube).unwrap().to_polygons(&Exec::default()).unwrap();
        assert_eq!(back, (cube.clone(), vec![]));
        let mesh = triangles(&cube);
        let back = EditableMesh::try_from(&mesh).unwrap().to_triangles(&Exec::default()).unwrap();
        assert_eq!(back, (mesh, vec![]));
        let error = EditableMesh::try_from(&cube).unwrap().to_triangles(&Exec::default()).unwrap_err();
        assert!(matches!(error, StructureError::Mesh(crate::MeshError::NotTriangle { face: 0, found: 4 })), "{error}");
    }

    #[test]
    fn area_and_linear_attributes_survive_any_operators_in_a_plane() {
        let source = grid();
        let mut mesh = EditableMesh::try_from(&source).unwrap();
        let (mut state, mut done) = (3, [0; 5]);
        for _ in 0..4000 {
            let edge = EdgeId(dice(&mut state, mesh.connectivity().edge_slots()) as u32);
            if !mesh.connectivity().has_edge(edge) {
                continue;
            }
            let ends = mesh.connectivity().ends(edge);
            let [a, b] = ends.map(|end| mesh.positions()[end.index()]);
            let inner = ends.map(|end| !mesh.connectivity().is_border_vertex(end));
            let operator = dice(&mut state, 5);
            let large = mesh.connectivity().counts().vertices > 60;
            let legal = match operator {
                0 => mesh.flip_edge(edge).is_ok(),
                1 if !large => mesh.split_edge(edge, a.lerp(b, 0.25)).is_ok(),
                // A border vertex must stay, or the square would change.
                2 if inner == [true; 2] => mesh.collapse_edge(edge, a.lerp(b, 0.75)).is_ok(),
                3 if inner[0] => mesh.remove_vertex(ends[0], Hole::Triangles).is_ok(),
                4 if !large => {
                    let face = mesh.connectivity().face(mesh.connectivity().halves(edge)[0]);
                    face.is_some_and(|face| {
                        let corners: Vec<DVec3> =
                            mesh.connectivity().corners(face).map(|v| mesh.positions()[v.index()]).collect();
                        let at = corners[0] * 0.5 + corners[1] * 0.25 + corners[2] * 0.25;
                        mesh.split_face(face, at).is_ok()
                    })
                }
                _ => false,
            };
            done[operator] += usize::from(legal);
        }
        assert!(done.iter().all(|&count| count > 20), "{done:?}");
        assert_eq!(mesh.connectivity().validate(), []);
        let (result, losses) = mesh.to_triangles(&Exec::default()).unwrap();
        assert!(losses.is_empty());
        assert!((result.area() - source.area()).abs() < 1e-12, "{} {}", result.area(), source.area());
        for face in 0..result.triangles().len() {
            assert!(crate::triangle_normal(result.corners(face)).z > 0.999, "{:?}", result.corners(face));
        }
        // The coordinates as attributes are those of the place, where no mixture had to be cut short.
        let places = result.attribute(Domain::Vertex, "place").unwrap();
        let wrong = (0..result.positions().len()).filter(|&v| places.vector(v).distance(result.positions()[v]) > 1e-12);
        assert!(wrong.count() * 10 < result.positions().len());
        assert_eq!(result.attribute(Domain::Face, "face").unwrap().len(), result.triangles().len());
    }

    #[test]
    fn mixtures_are_what_they_say() {
        let mut source = TriMesh::try_new(vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0], vec![[0, 1, 2]]).unwrap();
        let add = |mesh: &mut TriMesh, domain, column| mesh.insert_attribute(domain, column).unwrap();
        add(&mut source, Domain::Vertex, Column::try_new(COLOR, 1, Values::F64(vec![0.0, 8.0, 16.0])).unwrap());
        add(&mut source, Domain::Vertex, Column::normals(NORMAL, &[DVec3::Z, DVec3::Z, DVec3::X * 0.5]));
        add(&mut source, Domain::Vertex, Column::labels("id", vec![5, 6, 7]));
        add(&mut source, Domain::Wedge, Column::texcoords(TEXCOORD, &[[0.0; 2]; 3]));
        let mut mesh = EditableMesh::try_from(&source).unwrap();
        let edge = mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap();
        let edge = mesh.connectivity().edge(edge);
        let on_edge = mesh.split_edge(edge, DVec3::X).unwrap();
        assert_eq!(on_edge, VertexId(3));
        // Inside the triangle 3, 1, 2, with different weights of all three.
        let in_face = mesh.split_face(FaceId(0), DVec3::new(2.0, 1.0, 0.0)).unwrap();
        let (result, losses) = mesh.to_triangles(&Exec::default()).unwrap();
        let color = result.attribute(Domain::Vertex, COLOR).unwrap();
        assert_eq!((color.number(3, 0), result.positions()[3]), (2.0, DVec3::X));
        // Linear: 2 a unit along x, 4 a unit along y.
        assert!((color.number(in_face.index(), 0) - 8.0).abs() < 1e-14);
        let normals = result.attribute(Domain::Vertex, NORMAL).unwrap();
        assert_eq!(normals.vector(2), DVec3::X * 0.5, "an untouched value keeps its bits");
        assert!((normals.vector(in_face.index()).length() - 1.0).abs() < 1e-15);
        let ids = result.attribute(Domain::Vertex, "id").unwrap();
        assert_eq!(ids.number(3, 0), 5.0);
        assert_eq!(losses.len(), 1);
        assert!(losses[0].what.contains(TEXCOORD), "{losses:?}");
    }

    #[test]
    fn fold_overs_are_refused_at_any_size_and_place() {
        for (size, offset) in [(1.0, 0.0), (1e-9, 0.0), (1e-300, 0.0), (1e150, 0.0), (1e-2, 5e6)] {
            let place = |p: &DVec3| *p * size + DVec3::splat(offset);
            let source = grid();
            let positions: Vec<DVec3> = source.positions().iter().map(place).collect();
            let mut mesh =
                EditableMesh::try_from(&TriMesh::try_new(positions, source.triangles().to_vec()).unwrap()).unwrap();
            let center = source.positions().iter().position(|p| p.length() < 1e-9).unwrap() as u32;
            let ring: Vec<HalfEdgeId> = mesh.connectivity().around_vertex(VertexId(center)).collect();
            // Into a neighbour nothing folds; outside of the mesh something does.
            let edge = mesh.connectivity().edge(ring[0]);
            let far = place(&(source.positions()[0] * 1.9));
            assert!(matches!(mesh.clone().collapse_edge(edge, far), Err(Illegal::FoldsOver { .. })), "{size}");
            assert!(matches!(mesh.split_edge(edge, far), Err(Illegal::FoldsOver { .. })), "{size}");
            let face = mesh.connectivity().face(ring[0]).unwrap();
            assert!(matches!(mesh.split_face(face, far), Err(Illegal::FoldsOver { .. })), "{size}");
            assert!(matches!(mesh.split_face(face, DVec3::NAN), Err(Illegal::FoldsOver { .. })), "{size}");
            mesh.collapse_half_edge(ring[0]).unwrap();
            let removed = mesh.connectivity().live_vertices().filter(|&v| !mesh.connectivity().is_border_vertex(v));
            let inner: Vec<VertexId> = removed.collect();
            for vertex in inner {
                mesh.remove_vertex(vertex, Hole::Triangles).unwrap();
            }
            let (flat, _) = mesh.to_triangles(&Exec::default()).unwrap();
            assert!((0..flat.triangles().len()).all(|f| crate::triangle_normal(flat.corners(f)).z > 0.9), "{size}");
        }
    }

    #[test]
    fn flips_in_a_plane_are_legal_where_the_quadrilateral_is_strictly_convex() {
        let (mut state, mut legal) = (9, 0);
        for _ in 0..2000 {
            let mut point = || DVec2::new(dice(&mut state, 9) as f64, dice(&mut state, 9) as f64);
            let quad = [point(), point(), point(), point()];
            let turn = |a: usize, b: usize, c: usize| (quad[b] - quad[a]).perp_dot(quad[c] - quad[a]);
            if turn(0, 1, 2) <= 0.0 || turn(0, 2, 3) <= 0.0 {
                continue;
            }
            let positions = quad.map(|p| p.extend(0.0)).to_vec();
            let source = TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
            let mut mesh = EditableMesh::try_from(&source).unwrap();
            let half = mesh.connectivity().find(VertexId(0), VertexId(2)).unwrap();
            let convex = turn(3, 0, 1) > 0.0 && turn(1, 2, 3) > 0.0;
            assert_eq!(mesh.flip_edge(mesh.connectivity().edge(half)).is_ok(), convex, "{quad:?}");
            legal += usize::from(convex);
        }
        assert!(legal > 100);
    }

    #[test]
    fn a_triangle_without_area_may_be_flipped_away_but_not_made() {
        // 2 lies on the edge from 0 to 1.
        let positions = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
        let source = TriMesh::try_new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
        let mut mesh = EditableMesh::try_from(&source).unwrap();
        let half = mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap();
        let edge = mesh.connectivity().edge(half);
        mesh.flip_edge(edge).unwrap();
        assert!(matches!(mesh.flip_edge(edge), Err(Illegal::FoldsOver { .. })));
    }

    #[test]
    fn parts_of_a_face_have_its_attributes() {
        let mut mesh = EditableMesh::try_from(&grid()).unwrap();
        let inner = mesh.connectivity().live_edges().filter(|&edge| !mesh.connectivity().is_border_edge(edge));
        let edge = inner.last().unwrap();
        let [a, b] = mesh.connectivity().ends(edge).map(|end| mesh.positions()[end.index()]);
        let mut beside: Vec<u32> =
            mesh.connectivity().halves(edge).map(|half| mesh.connectivity().face(half).unwrap().0).to_vec();
        let vertex = mesh.split_edge(edge, (a + b) / 2.0).unwrap();
        let parts: Vec<usize> =
            mesh.connectivity().around_vertex(vertex).map(|h| mesh.connectivity().face(h).unwrap().index()).collect();
        let (result, _) = mesh.to_triangles(&Exec::default()).unwrap();
        let labels = result.attribute(Domain::Face, "face").unwrap();
        let mut found: Vec<u32> = parts.iter().map(|&face| labels.number(face, 0) as u32).collect();
        found.sort_unstable();
        beside.extend_from_within(..);
        beside.sort_unstable();
        assert_eq!(found, beside);
        // Each part lies inside the face whose label it has.
        let source = grid();
        for (face, &label) in parts.iter().zip(&parts.iter().map(|&f| labels.number(f, 0) as usize).collect::<Vec<_>>())
        {
            let center = result.corners(*face).iter().sum::<DVec3>() / 3.0;
            let [p, q, r] = source.corners(label);
            assert!([[p, q], [q, r], [r, p]].iter().all(|[a, b]| (*b - *a).cross(center - *a).z > 0.0));
        }
    }

    #[test]
    fn holes_avoid_edges_that_are_there_and_refuse_what_would_fold() {
        // A vertex in a quadrilateral, one diagonal of which is an edge of another face.
        let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [2, 1, 3]];
        let mesh = |places: [(f64, f64); 5]| {
            let positions = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
            EditableMesh::try_from(&TriMesh::try_new(positions, faces.clone()).unwrap()).unwrap()
        };
        let mut convex = mesh([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)]);
        convex.remove_vertex(VertexId(4), Hole::Triangles).unwrap();
        assert_eq!(convex.connectivity().validate(), []);
        assert!(convex.connectivity().find(VertexId(0), VertexId(2)).is_some());
        // Concave: the diagonal that is left lies outside.
        let mut arrow = mesh([(2.0, 1.0), (0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (0.3, 0.0)]);
        let refused = arrow.remove_vertex(VertexId(4), Hole::Triangles);
        assert!(matches!(refused, Err(Illegal::FoldsOver { .. })), "{refused:?}");
        assert!(arrow.remove_vertex(VertexId(4), Hole::Polygon).is_ok());
    }

    #[test]
    fn a_face_may_get_area_by_a_collapse_but_not_lose_it() {
        let faces = vec![[0, 1, 2], [1, 3, 2], [1, 4, 3]];
        let mesh = |x: f64, y: f64| {
            let places = [(0.0, 0.0), (x, y), (0.0, 1.0), (1.0, 1.0), (2.0, 0.0)];
            let positions = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
            EditableMesh::try_from(&TriMesh::try_new(positions, faces.clone()).unwrap()).unwrap()
        };
        let (good, flat) = (DVec3::X, DVec3::new(0.5, 1.0, 0.0));
        let edge =
            |mesh: &EditableMesh| mesh.connectivity().edge(mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap());
        let mut sound = mesh(1.0, 0.0);
        let face = FaceId(1);
        assert_eq!(sound.collapse_edge(edge(&sound), flat), Err(Illegal::FoldsOver { face }));
        assert!(sound.collapse_edge(edge(&sound), good * 0.75).is_ok());
        let mut without = mesh(0.5, 1.0);
        assert!(without.clone().collapse_edge(edge(&without), flat).is_ok());
        assert!(without.collapse_edge(edge(&without), good).is_ok());
    }

    #[test]
    fn the_number_of_sources_is_bounded() {
        let mut mesh = EditableMesh::try_from(&grid()).unwrap();
        mesh.min_cosine = -2.0;
        let vertices: Vec<VertexId> = mesh.connectivity().live_vertices().collect();
        let all: Vec<(VertexId, f64)> = vertices.iter().map(|&v| (v, 1.0 + f64::from(v.0))).collect();
        let mixture = mesh.mix(&all).unwrap();
        assert_eq!((all.len(), mixture.len()), (25, 25));
        let twice: Vec<(VertexId, f64)> = (0..99).map(|i| (VertexId(i % 25), 0.01)).collect();
        assert_eq!(mesh.mix(&twice).unwrap().len(), 25);
        mesh.positions.resize(60, DVec3::ZERO);
        mesh.mixed.resize(60, None);
        let many: Vec<(VertexId, f64)> = (0..60).map(|i| (VertexId(i), f64::from(i + 1) / 1830.0)).collect();
        let mixture = mesh.mix(&many).unwrap();
        assert_eq!((mixture.len(), mixture[0].0), (SOURCES, 28));
        assert!((mixture.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
