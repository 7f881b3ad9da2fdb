//! Everything that the judge knows of a mesh, and what it says to a purpose.

use shapeloom_core::{Exec, Findings, Place, Severity};
use shapeloom_mesh::{Domain, NORMAL, PolyMesh};

use super::angles::{SMALLEST, slivers};
use super::shells::shells;
use super::{Profile, Shell};
use crate::self_intersection::{
    PairKind, PairList, SelfIntersections, self_intersections, self_intersections_of_polygons,
};
use crate::triangulated::triangulated;
use crate::{JudgeError, Measures, MeshRef, PolygonReport, Topology};

/// What is known of a mesh, and what of it is against the rules of a purpose.
#[derive(Debug)]
pub struct Verdict {
    /// What is against the rules: each with its code, how often, and the first places.
    pub findings: Findings,
    /// The topology.
    pub topology: Topology,
    /// Area, volume and what has none.
    pub measures: Measures,
    /// Where the mesh meets itself: all pairs are counted, the first of each class listed.
    pub self_intersections: SelfIntersections,
    /// The closed shells, where the purpose asks which way they face.
    pub shells: Vec<Shell>,
}

/// What else the rules ask about.
struct Details {
    /// Faces with a sliver.
    thin: Vec<u32>,
    /// Polygons that meet themselves.
    tangled: Vec<u32>,
    /// Whether there are normals.
    normals: bool,
}

/// Why a mesh is no polyhedron, with a witness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotPolyhedron {
    /// There is no face.
    Empty,
    /// An edge with one face, or more than two.
    Edge([u32; 2]),
    /// A vertex whose faces are not one fan.
    Vertex(u32),
    /// Faces of different components.
    Apart([u32; 2]),
    /// Two vertices of faces in one place.
    Doubled([u32; 2]),
    /// Faces that meet beyond shared sides and corners.
    Meeting([u32; 2]),
}

impl Verdict {
    /// How many places of a kind are told.
    const LISTED: usize = Findings::PLACES_KEPT;

    /// Judges a mesh for a purpose.
    ///
    /// Cost: that of the topology report and of all self-intersections. Polygons are cut into triangles where a question
    /// needs it; places name polygons.
    ///
    /// # Errors
    /// A position that is not finite or loses bits (see [`Scaled`](crate::Scaled)), the memory budget, or the reason to
    /// stop.
    pub fn of<'a>(mesh: impl Into<MeshRef<'a>>, profile: Profile, exec: &Exec) -> Result<Self, JudgeError> {
        let mesh = mesh.into();
        let topology = Topology::of(mesh, &exec.part(0.0, 0.2))?;
        let measures = Measures::of(mesh, &exec.part(0.2, 0.3))?;
        let crossings = exec.part(0.3, 0.8);
        let self_intersections = match mesh {
            MeshRef::Triangles(mesh) => self_intersections(mesh, Self::LISTED, &crossings)?,
            MeshRef::Polygons(mesh) => self_intersections_of_polygons(mesh, Self::LISTED, &crossings)?,
        };
        let cut;
        let (triangles, owners, tangled) = match mesh {
            MeshRef::Triangles(mesh) => (mesh, None, Vec::new()),
            MeshRef::Polygons(mesh) => {
                cut = triangulated(mesh, &exec.part(0.8, 0.85))?;
                (&cut.0, Some(&cut.1), tangled(mesh, exec)?)
            }
        };
        let owner = |triangle: u32| owners.map_or(triangle, |owners| owners[triangle as usize]);
        let mut thin = match profile.asks_for("W-check-sliver") {
            true => slivers(triangles, exec)?.into_iter().map(owner).collect(),
            false => Vec::new(),
        };
        thin.dedup();
        let mut found = Vec::new();
        if profile.asks_for("W-check-inverted") {
            let cut = owners.map(|_| Topology::of(triangles, exec)).transpose()?;
            found = shells(triangles, cut.as_ref().unwrap_or(&topology), &exec.part(0.85, 1.0))?;
            found.iter_mut().for_each(|shell| shell.first_face = owner(shell.first_face));
        }
        let normals = [Domain::Vertex, Domain::Wedge].iter().any(|&domain| match mesh {
            MeshRef::Triangles(mesh) => mesh.attribute(domain, NORMAL).is_some(),
            MeshRef::Polygons(mesh) => mesh.attribute(domain, NORMAL).is_some(),
        });
        let mut verdict = Self { findings: Findings::default(), topology, measures, self_intersections, shells: found };
        verdict.findings = verdict.against(profile, &Details { thin, tangled, normals });
        exec.progress(1.0);
        Ok(verdict)
    }

    /// What is against the rules of a purpose.
    fn against(&self, profile: Profile, details: &Details) -> Findings {
        let Self { topology, measures, self_intersections, shells, .. } = self;
        let Details { thin, tangled, normals } = details;
        let mut findings = Findings::default();
        let mut rule = |code, message: &str, count: usize, places: &mut dyn Iterator<Item = Place>| {
            if profile.asks_for(code) {
                findings.push_all(code, Severity::Warning, message, count as u64, places);
            }
        };
        let t = topology;
        let vertex = |&vertex: &u32| Place::element("vertex", vertex.into());
        let face = |&face: &u32| Place::element("face", face.into());
        let edge = |&[a, b]: &[u32; 2]| Place::edge(a, b);
        let pair = |&[a, b]: &[u32; 2]| Place::pair("faces", a, b);
        let whole = || std::iter::once(Place::Whole);
        rule("W-check-empty", "there is no face", usize::from(t.faces == 0), &mut whole());
        let loops = t.boundary.len();
        let border = t.boundary.edges().len();
        let mut open = format!(
            "an edge has only one face, so the surface is open, in {loops} {}",
            if loops == 1 { "loop" } else { "loops" }
        );
        if !measures.coincident_vertices.is_empty() {
            let equal = measures.coincident_vertices.len();
            open += &format!("; {equal} vertices lie exactly where others do, and may only need welding");
        }
        // An edge of each loop first.
        let mut firsts = t.boundary.iter().filter_map(|edges| edges.first()).map(edge);
        rule("W-check-open", &open, border, &mut firsts);
        let crowded = &t.non_manifold_edges;
        rule("W-check-edge", "an edge has more than two faces", crowded.len(), &mut crowded.iter().map(edge));
        let pinched = &t.non_manifold_vertices;
        rule("W-check-vertex", "the faces at a vertex are not one fan", pinched.len(), &mut pinched.iter().map(vertex));
        let turned = &t.inconsistent_edges;
        let message = "two faces run along their edge in the same direction, so one of them is turned over";
        rule("W-check-orientation", message, turned.len(), &mut turned.iter().map(edge));
        let ring = &t.orientation_witness;
        let message = "a face of a ring that turns the first one over: the surface is one-sided";
        rule("W-check-orientable", message, ring.len(), &mut ring.iter().map(face));
        let inverted: Vec<&Shell> = shells.iter().filter(|shell| shell.is_inverted()).collect();
        let mut places = inverted.iter().map(|shell| face(&shell.first_face));
        let message =
            "the closed shell with this face looks the wrong way: an outer one inward, or one within another outward";
        rule("W-check-inverted", message, inverted.len(), &mut places);
        let no_volume = t.is_closed() && t.is_oriented() && measures.volume.is_some_and(|volume| volume <= 0.0);
        rule("W-check-volume", "the volume enclosed is not above 0", usize::from(no_volume), &mut whole());
        let mut degenerate: Vec<u32> = measures.flat_faces.iter().chain(&t.repeating_faces).copied().collect();
        degenerate.sort_unstable();
        degenerate.dedup();
        let message = "a face has no area or names a vertex twice";
        rule("W-check-degenerate", message, degenerate.len(), &mut degenerate.iter().map(face));
        let pairs = self_intersections;
        let mut again = t.duplicate_faces.clone();
        let equal = pairs.touching.listed.iter().filter(|pair| pair.kind == PairKind::Duplicate);
        again.extend(equal.map(|pair| pair.faces));
        again.sort_unstable();
        again.dedup();
        let message = "a face has the corners of another and looks the same way, or has its vertices";
        let count = (again.len() as u64).max(pairs.count(PairKind::Duplicate)) as usize;
        rule("W-check-duplicate", message, count, &mut again.iter().map(pair));
        rule("W-check-polygon", "a polygon meets itself", tangled.len(), &mut tangled.iter().map(face));
        let listed = |list: &PairList| list.listed.iter().map(|pair| pair.faces).collect::<Vec<_>>();
        for (code, message, list) in [
            ("W-check-crossing", "a face passes through another", &pairs.crossing),
            ("W-check-overlap", "two faces overlap in a plane", &pairs.overlapping),
        ] {
            rule(code, message, list.total as usize, &mut listed(list).iter().map(pair));
        }
        let doubled = self.doubled_vertices();
        let count = pairs.touching.total as usize + doubled.len();
        let vertices = doubled.iter().map(|&[a, b]| Place::pair("vertices", a, b));
        let message = "two faces touch beside shared sides and corners, or two vertices lie in one place";
        rule("W-check-contact", message, count, &mut listed(&pairs.touching).iter().map(pair).chain(vertices));
        let lonely = &t.isolated_vertices;
        rule("W-check-isolated", "a vertex has no face", lonely.len(), &mut lonely.iter().map(vertex));
        let message = format!("a face has an angle below {SMALLEST} degree, once it is cut into triangles");
        rule("W-check-sliver", &message, thin.len(), &mut thin.iter().map(face));
        rule("W-check-normals", "there are no normals to shade with", usize::from(!normals), &mut whole());
        findings
    }

    /// Vertices of faces at the place of an earlier one.
    fn doubled_vertices(&self) -> Vec<[u32; 2]> {
        let named = |vertex: &u32| self.topology.isolated_vertices.binary_search(vertex).is_err();
        let doubled = self.measures.coincident_vertices.iter().filter(|pair| pair.iter().all(named));
        doubled.copied().collect()
    }

    /// Whether the mesh is the surface of one polyhedron: every edge has two faces, the faces at every vertex are one fan,
    /// all faces are joined, no two vertices lie in one place, and no faces meet beyond shared sides and corners. Such a
    /// surface is orientable.
    ///
    /// # Errors
    /// The first of these that is not so, with a witness.
    pub fn polyhedron(&self) -> Result<(), NotPolyhedron> {
        let topology = &self.topology;
        if topology.faces == 0 {
            return Err(NotPolyhedron::Empty);
        }
        if let Some(&edge) = topology.boundary.edges().first().or(topology.non_manifold_edges.first()) {
            return Err(NotPolyhedron::Edge(edge));
        }
        if let Some(&vertex) = topology.non_manifold_vertices.first() {
            return Err(NotPolyhedron::Vertex(vertex));
        }
        if let [first, second, ..] = topology.components[..] {
            return Err(NotPolyhedron::Apart([first.first_face, second.first_face]));
        }
        // What meets in a place but not in a vertex is pinched there.
        if let Some(&vertices) = self.doubled_vertices().first() {
            return Err(NotPolyhedron::Doubled(vertices));
        }
        let SelfIntersections { crossing, overlapping, touching, .. } = &self.self_intersections;
        let listed = [crossing, overlapping, touching].into_iter().find_map(|list| list.listed.first());
        listed.map_or(Ok(()), |pair| Err(NotPolyhedron::Meeting(pair.faces)))
    }
}

/// The polygons with more than three corners that are not simple, rising.
fn tangled(mesh: &PolyMesh, exec: &Exec) -> Result<Vec<u32>, JudgeError> {
    let mut found = Vec::new();
    let mut outline = Vec::new();
    for face in (0..mesh.face_count()).filter(|&face| mesh.face(face).len() > 3) {
        outline.clear();
        outline.extend(mesh.outline(face));
        if !PolygonReport::of(&outline, true, exec)?.is_simple() {
            found.push(face as u32);
        }
    }
    Ok(found)
}
