//! Meshes that can be edited, with positions and attributes.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Exec, Loss, Stop, parallel};

use crate::ear_clipping::clip_ears;
use crate::poly_mesh::check_count;
use crate::structures::{
    EdgeId, FaceId, HalfEdgeId, HalfEdgeMesh, Hole, Illegal, Incidence, IndexedPolygons, IndexedTriangles,
    StructureError, VertexId,
};
use crate::triangulate_polygons::project;
use crate::{Attributes, MeshAttributes, MeshOrigins, Origins, PolyMesh, TriMesh, carry};

/// How many vertices of the source a vertex is mixed from at most.
const SOURCES: usize = 32;

/// Vertices of the source, rising, with weights of sum 1.
type Mixture = Box<[(u32, f64)]>;

/// A [`HalfEdgeMesh`] with positions, which refuses what would fold it over, and remembers where its vertices and
/// faces come from, so that attributes arrive.
///
/// A vertex that is split off or moved along an edge is a mixture of the edge's ends, one in a face a mixture of its
/// corners; mixtures are followed back to at most 32 vertices of the source, of which the heaviest are kept. A face
/// that is cut gives its attributes to its parts; an edge that is flipped leaves each of its faces those of its number.
/// Attributes of wedges are kept as long as no operator ran, and are then named in the losses: across a flip or
/// collapse a corner has no one place to come from.
///
/// Positions may be any numbers; where one is not finite, operators that would need it refuse.
#[derive(Clone, Debug)]
pub struct EditableMesh {
    connectivity: HalfEdgeMesh,
    positions: Vec<DVec3>,
    /// The least cosine of the angle by which a face may turn in one operator: 0 unless set, which is less than 90
    /// degrees. Below −1 faces may turn over, and only these are refused: faces that lose all area, positions that are
    /// not finite, and flips between triangles whose vector areas cancel. NaN refuses whatever changes a face.
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
        let sources = self.source_total(exec)?;
        let _memory = exec.reserve(self.bytes_of_parts(sources))?;
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
        let vertex = self.vertex_origins(numbers.vertices.old(), sources);
        let (attributes, losses) =
            carry(&self.attributes, &MeshOrigins { vertex, face: Origins::Copies(copies), wedge });
        Ok(Parts { faces, positions, attributes, losses })
    }

    /// How many sources the vertices have together.
    fn source_total(&self, exec: &Exec) -> Result<usize, StructureError> {
        let mut total = 0;
        for (i, vertex) in self.connectivity.live_vertices().enumerate() {
            if i.is_multiple_of(parallel::CHUNK) {
                exec.check()?;
            }
            total += self.mixed[vertex.index()].as_ref().map_or(1, |own| own.len());
        }
        check_count("sources of vertices", total)?;
        Ok(total)
    }

    /// What [`EditableMesh::parts`] takes, result included. Lists are taken to be as long as in the source on average.
    fn bytes_of_parts(&self, sources: usize) -> u64 {
        let connectivity = &self.connectivity;
        let slots = connectivity.vertex_slots() + connectivity.edge_slots() + connectivity.face_slots();
        let counts = connectivity.counts();
        let (vertices, faces) = (u64::from(counts.vertices), u64::from(counts.faces));
        let columns = |of: &Attributes, count: u64| {
            (of.memory_bytes() as u64).div_ceil(of.len().max(1) as u64).saturating_mul(count)
        };
        let wedge = if self.changed { 0 } else { self.attributes.wedge.memory_bytes() as u64 };
        // The copy with gaps and the one without, the numbers of either in the other.
        let compacted = 2 * connectivity.memory_bytes() as u64 + 2 * size_of::<u32>() as u64 * slots as u64;
        let origins = vertices * size_of::<u32>() as u64
            + sources as u64 * (size_of::<u32>() + size_of::<f64>()) as u64
            + faces * size_of::<u32>() as u64;
        let attributes = columns(&self.attributes.vertex, vertices)
            .saturating_add(columns(&self.attributes.face, faces))
            .saturating_add(wedge);
        attributes.saturating_add(compacted + origins + vertices * size_of::<DVec3>() as u64)
    }

    /// Where vertices come from, that have so many sources together.
    fn vertex_origins(&self, old: &[u32], total: usize) -> Origins {
        if old.iter().all(|&vertex| self.mixed[vertex as usize].is_none()) {
            return Origins::Copies(old.to_vec());
        }
        let mut starts = Vec::with_capacity(old.len() + 1);
        let (mut sources, mut weights) = (Vec::with_capacity(total), Vec::with_capacity(total));
        starts.push(0);
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

    /// Removes a vertex; triangles that fill the hole are ears of its outline in the plane, where that doubles no edge,
    /// else any that double none. Faces that fill it have the attributes of one that was there.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_remove_vertex`]; a face around it that does not look to the side of the hole, or a new
    /// one that does not.
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
mod tests;
