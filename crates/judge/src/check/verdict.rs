//! Everything that the judge knows of a mesh, and what it says to a purpose.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{Exec, Findings, Place, Severity};
use shapeloom_mesh::{Domain, NORMAL, PolyMesh, newell_vector};

use super::angles::{SMALLEST, slivers};
use super::shells::shells;
use super::{Profile, Shell};
use crate::self_intersection::{
    FacePair, PairKind, PairList, SelfIntersections, self_intersections, self_intersections_of_polygons,
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
    /// Where the mesh meets itself; of each class the first 65,536 pairs are listed.
    pub self_intersections: SelfIntersections,
    /// The closed shells.
    pub shells: Vec<Shell>,
}

/// What else the rules ask about.
struct Details {
    /// Slivers, by triangle.
    thin: Vec<u32>,
    /// Polygons that meet themselves.
    tangled: Vec<u32>,
    /// Whether there are normals.
    normals: bool,
    /// Pairs that overlap and look the same way, or are folded onto each other.
    alike: Vec<[u32; 2]>,
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
    /// Faces that meet beyond shared sides and corners.
    Meeting([u32; 2]),
}

impl Verdict {
    /// How many places of a kind are told.
    const LISTED: usize = Findings::PLACES_KEPT;
    /// How many pairs of a kind are listed, to be looked at one by one.
    const PAIRS: usize = 1 << 16;

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
            MeshRef::Triangles(mesh) => self_intersections(mesh, Self::PAIRS, &crossings)?,
            MeshRef::Polygons(mesh) => self_intersections_of_polygons(mesh, Self::PAIRS, &crossings)?,
        };
        let (shells, thin, tangled) = match mesh {
            MeshRef::Triangles(mesh) => {
                (shells(mesh, &topology, &exec.part(0.8, 1.0))?, slivers(mesh, exec)?, Vec::new())
            }
            MeshRef::Polygons(mesh) => {
                let tangled = tangled(mesh, exec)?;
                let triangles = triangulated(mesh, exec)?;
                let topology = Topology::of(&triangles, exec)?;
                (shells(&triangles, &topology, &exec.part(0.8, 1.0))?, slivers(&triangles, exec)?, tangled)
            }
        };
        let normals = [Domain::Vertex, Domain::Wedge].iter().any(|&domain| match mesh {
            MeshRef::Triangles(mesh) => mesh.attribute(domain, NORMAL).is_some(),
            MeshRef::Polygons(mesh) => mesh.attribute(domain, NORMAL).is_some(),
        });
        let unsound = |pair: &&FacePair| pair.kind == PairKind::Folded || look_alike(mesh, pair.faces);
        let alike = self_intersections.overlapping.listed.iter().filter(unsound).map(|pair| pair.faces).collect();
        let mut verdict = Self { findings: Findings::default(), topology, measures, self_intersections, shells };
        verdict.findings = verdict.against(profile, &Details { thin, tangled, normals, alike });
        exec.progress(1.0);
        Ok(verdict)
    }

    /// What is against the rules of a purpose.
    fn against(&self, profile: Profile, details: &Details) -> Findings {
        let Self { topology, measures, self_intersections, shells, .. } = self;
        let Details { thin, tangled, normals, .. } = details;
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
            "the surface is open: {border} edges have only one face, in {loops} {}",
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
        let message = "the surface is not orientable: these faces in a ring turn the first one over";
        rule("W-check-orientable", message, usize::from(!ring.is_empty()), &mut ring.iter().map(face));
        let inverted: Vec<&Shell> = shells.iter().filter(|shell| shell.is_inverted()).collect();
        let mut places = inverted.iter().map(|shell| Place::element("component", shell.component.into()));
        let message = "a closed shell faces the wrong way: an outer one inward, or one within another outward";
        rule("W-check-inverted", message, inverted.len(), &mut places);
        let no_volume = t.is_closed() && t.is_oriented() && measures.volume.is_some_and(|volume| volume <= 0.0);
        rule("W-check-volume", "the volume enclosed is not above 0", usize::from(no_volume), &mut whole());
        let mut degenerate: Vec<u32> = measures.flat_faces.iter().chain(&t.repeating_faces).copied().collect();
        degenerate.sort_unstable();
        degenerate.dedup();
        let message = "a face has no area or names a vertex twice";
        rule("W-check-degenerate", message, degenerate.len(), &mut degenerate.iter().map(face));
        let again = &t.duplicate_faces;
        rule("W-check-duplicate", "a face repeats another", again.len(), &mut again.iter().map(pair));
        rule("W-check-polygon", "a polygon meets itself", tangled.len(), &mut tangled.iter().map(face));
        let first = |list: &PairList| list.listed.iter().take(Self::LISTED).map(|pair| pair.faces).collect::<Vec<_>>();
        let SelfIntersections { crossing, overlapping, touching, .. } = self_intersections;
        let message = "a face passes through another";
        rule("W-check-crossing", message, crossing.total as usize, &mut first(crossing).iter().map(pair));
        let message = match overlapping.total > overlapping.listed.len() as u64 {
            true => "two faces overlap in a plane, at least so often",
            false => "two faces overlap in a plane",
        };
        rule("W-check-overlap", message, details.alike.len(), &mut details.alike.iter().map(pair));
        // Faces that lie on each other and look at each other are in contact.
        let facing = overlapping.total as usize - details.alike.len();
        let contacts = touching.total as usize + facing;
        let message = "two faces touch beside shared sides and corners";
        let mut places: Vec<[u32; 2]> = first(touching);
        places.extend(first(overlapping).into_iter().filter(|pair| !details.alike.contains(pair)).take(Self::LISTED));
        rule("W-check-contact", message, contacts, &mut places.iter().map(pair));
        let lonely = &t.isolated_vertices;
        rule("W-check-isolated", "a vertex has no face", lonely.len(), &mut lonely.iter().map(vertex));
        let message = format!("a triangle has an angle below {SMALLEST} degree");
        let mut places = thin.iter().map(|&triangle| Place::element("triangle", triangle.into()));
        rule("W-check-sliver", &message, thin.len(), &mut places);
        rule("W-check-normals", "there are no normals to shade with", usize::from(!normals), &mut whole());
        findings
    }

    /// Whether the mesh is the surface of one polyhedron: every edge has two faces, the faces at every vertex are one fan,
    /// all faces are joined, and none meet beyond shared sides and corners. Such a surface is orientable.
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
        let SelfIntersections { crossing, overlapping, touching, .. } = &self.self_intersections;
        let listed = [crossing, overlapping, touching].into_iter().find_map(|list| list.listed.first());
        listed.map_or(Ok(()), |pair| Err(NotPolyhedron::Meeting(pair.faces)))
    }
}

/// Whether two faces in one plane look the same way. Exact for triangles; for polygons by their Newell vectors.
fn look_alike(mesh: MeshRef<'_>, faces: [u32; 2]) -> bool {
    let normals = match mesh {
        MeshRef::Triangles(mesh) => {
            let [a, b] = faces.map(|face| mesh.corners(face as usize));
            let turn = |corners: [DVec3; 3], [i, j]: [usize; 2]| {
                let [a, b, c] = corners.map(|p| DVec2::new(p[i], p[j]));
                orient2d(a, b, c)
            };
            let planes = [[0, 1], [1, 2], [2, 0]].into_iter();
            return planes.map(|plane| [turn(a, plane), turn(b, plane)]).all(|[one, other]| one == other);
        }
        MeshRef::Polygons(mesh) => faces.map(|face| newell_vector(mesh.outline(face as usize)).normalize_or_zero()),
    };
    normals[0].dot(normals[1]) > 0.0
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
