//! What the judge says of meshes, as the keys of `info` and `check`.

use serde_json::{Map, Value, json};
use shapeloom_core::{Diagnostic, Exec, Findings, Place, Severity};
use shapeloom_judge::{JudgeError, Measures, MeshRef, Topology};

use crate::account::number;
use crate::failure::Failure;

/// The most elements of a kind that are listed as witnesses.
const LISTED: usize = 100;

/// The elements that show what a mesh is not, by kind: the first of each, and all of a ring that turns over.
pub(crate) fn witnesses(topology: &Topology, measures: Option<&Measures>) -> Value {
    fn first<T: Clone + Into<Value>>(list: &[T]) -> Value {
        list[..list.len().min(LISTED)].to_vec().into()
    }
    let mut loops = Vec::new();
    for edges in topology.boundary.iter().take(LISTED) {
        loops.push(json!({ "edges": edges.len(), "first": edges[0] }));
    }
    let lists = [
        ("boundary_loops", Value::Array(loops)),
        ("non_manifold_edges", first(&topology.non_manifold_edges)),
        ("non_manifold_vertices", first(&topology.non_manifold_vertices)),
        ("inconsistent_edges", first(&topology.inconsistent_edges)),
        ("one_sided_ring", json!(topology.orientation_witness)),
        ("repeating_faces", first(&topology.repeating_faces)),
        ("flat_faces", measures.map_or(json!([]), |measures| first(&measures.flat_faces))),
        ("duplicate_faces", first(&topology.duplicate_faces)),
        ("isolated_vertices", first(&topology.isolated_vertices)),
        ("coincident_vertices", measures.map_or(json!([]), |measures| first(&measures.coincident_vertices))),
    ];
    let found = lists.into_iter().filter(|(_, list)| list.as_array().is_some_and(|list| !list.is_empty()));
    Value::Object(found.map(|(key, list)| (key.to_owned(), list)).collect())
}

/// The numbers of one mesh, or of several together.
#[derive(Clone, Debug)]
pub(crate) struct Soundness {
    vertices: usize,
    edges: usize,
    faces: usize,
    components: usize,
    boundary_loops: usize,
    boundary_edges: usize,
    non_manifold_edges: usize,
    non_manifold_vertices: usize,
    inconsistent_edges: usize,
    manifold: bool,
    closed: bool,
    orientable: bool,
    euler_characteristic: i64,
    handles: Option<u64>,
    crosscaps: Option<u64>,
    duplicate_faces: usize,
    isolated_vertices: usize,
    /// None where exact arithmetic cannot tell.
    degenerate_faces: Option<usize>,
    coincident_vertices: Option<usize>,
    area: Option<f64>,
    volume: Option<f64>,
}

impl Soundness {
    /// Judges a mesh, and lists its [`witnesses`]. What cannot be told is said in the findings.
    pub(crate) fn of<'a>(
        mesh: impl Into<MeshRef<'a>>,
        exec: &Exec,
        findings: &mut Findings,
    ) -> Result<(Self, Value), Failure> {
        let mesh = mesh.into();
        let topology = Topology::of(mesh, &exec.part(0.0, 0.7))?;
        let measures = match Measures::of(mesh, &exec.part(0.7, 1.0)) {
            Ok(measures) => Some(measures),
            Err(error @ (JudgeError::NotFinite { .. } | JudgeError::Underflow { .. })) => {
                findings.push(error.code(), Severity::Warning, Place::Whole, error.to_string());
                None
            }
            Err(error) => return Err(error.into()),
        };
        let found = Self::new(&topology, measures.as_ref());
        let shown = witnesses(&topology, measures.as_ref());
        if let Some(measures) = measures
            && (measures.area.is_none() || measures.volume.is_none())
        {
            let message = "the area or volume is beyond the numbers, or so small that it vanishes: scale the shape";
            findings.push("W-info-size", Severity::Warning, Place::Whole, message);
        }
        if found.faces > 0 && !(found.closed && found.is_oriented()) {
            let message = "the surface is open or its faces do not turn alike: the volume is that of the cones to the centre \
                           of the bounding box, and encloses nothing";
            findings.push("W-info-open", Severity::Note, Place::Whole, message);
        }
        Ok((found, shown))
    }

    /// The numbers of what the judge found.
    pub(crate) fn new(topology: &Topology, measures: Option<&Measures>) -> Self {
        let degenerate = |measures: &Measures| {
            // Both lists rise.
            let flat = &measures.flat_faces;
            flat.len() + topology.repeating_faces.iter().filter(|&face| flat.binary_search(face).is_err()).count()
        };
        Self {
            vertices: topology.vertices,
            edges: topology.edges,
            faces: topology.faces,
            components: topology.components.len(),
            boundary_loops: topology.boundary.len(),
            boundary_edges: topology.boundary.edges().len(),
            non_manifold_edges: topology.non_manifold_edges.len(),
            non_manifold_vertices: topology.non_manifold_vertices.len(),
            inconsistent_edges: topology.inconsistent_edges.len(),
            manifold: topology.is_manifold(),
            closed: topology.is_closed(),
            orientable: topology.is_orientable(),
            euler_characteristic: topology.euler_characteristic(),
            handles: topology.genus(),
            crosscaps: topology.crosscaps(),
            duplicate_faces: topology.duplicate_faces.len(),
            isolated_vertices: topology.isolated_vertices.len(),
            degenerate_faces: measures.map(degenerate),
            coincident_vertices: measures.map(|measures| measures.coincident_vertices.len()),
            area: measures.and_then(|measures| measures.area),
            volume: measures.and_then(|measures| measures.volume),
        }
    }

    /// The area; none where it is beyond the numbers or vanishes.
    pub(crate) fn area(&self) -> Option<f64> {
        self.area
    }

    /// The volume of the cones under the faces; none as the area.
    pub(crate) fn volume(&self) -> Option<f64> {
        self.volume
    }

    fn is_oriented(&self) -> bool {
        self.inconsistent_edges == 0
    }

    /// The two together, as parts of one shape.
    pub(crate) fn with(self, other: &Self) -> Self {
        let both = |a: Option<u64>, b: Option<u64>| Some(a? + b?);
        let counts = |a: Option<usize>, b: Option<usize>| Some(a? + b?);
        let sizes = |a: Option<f64>, b: Option<f64>| Some(a? + b?).filter(|sum| sum.is_finite());
        Self {
            vertices: self.vertices + other.vertices,
            edges: self.edges + other.edges,
            faces: self.faces + other.faces,
            components: self.components + other.components,
            boundary_loops: self.boundary_loops + other.boundary_loops,
            boundary_edges: self.boundary_edges + other.boundary_edges,
            non_manifold_edges: self.non_manifold_edges + other.non_manifold_edges,
            non_manifold_vertices: self.non_manifold_vertices + other.non_manifold_vertices,
            inconsistent_edges: self.inconsistent_edges + other.inconsistent_edges,
            manifold: self.manifold && other.manifold,
            closed: self.closed && other.closed,
            orientable: self.orientable && other.orientable,
            euler_characteristic: self.euler_characteristic + other.euler_characteristic,
            handles: both(self.handles, other.handles),
            crosscaps: both(self.crosscaps, other.crosscaps),
            duplicate_faces: self.duplicate_faces + other.duplicate_faces,
            isolated_vertices: self.isolated_vertices + other.isolated_vertices,
            degenerate_faces: counts(self.degenerate_faces, other.degenerate_faces),
            coincident_vertices: counts(self.coincident_vertices, other.coincident_vertices),
            area: sizes(self.area, other.area),
            volume: sizes(self.volume, other.volume),
        }
    }

    /// Whether it is closed, its components and its genus, in words.
    pub(crate) fn brief(&self) -> [String; 3] {
        let (genus, genus_is) = self.genus();
        let genus = genus.map_or_else(|| genus_is.to_owned(), |genus| format!("{genus} {genus_is}"));
        [if self.closed { "yes" } else { "no" }.to_owned(), self.components.to_string(), genus]
    }

    /// The genus and what it counts: of surfaces that are not orientable it is the number of crosscaps.
    fn genus(&self) -> (Option<u64>, &'static str) {
        match (self.handles, self.crosscaps) {
            (Some(handles), Some(0)) => (Some(handles), "handles"),
            (Some(0), Some(crosscaps)) => (Some(crosscaps), "crosscaps"),
            (Some(_), Some(_)) => (None, "handles and crosscaps"),
            _ => (None, "unknown: not a manifold"),
        }
    }

    /// Adds the keys of a part among very many.
    pub(crate) fn tell_briefly(&self, object: &mut Map<String, Value>) {
        let counts = [("vertices", self.vertices), ("edges", self.edges), ("faces", self.faces)];
        object.extend(counts.map(|(key, count)| (key.to_owned(), json!(count))));
    }

    /// Adds all keys to an object.
    pub(crate) fn tell(&self, object: &mut Map<String, Value>) {
        let size = |value: Option<f64>| value.map_or(Value::Null, number);
        let (genus, genus_is) = self.genus();
        let keys = [
            ("vertices", json!(self.vertices)),
            ("edges", json!(self.edges)),
            ("faces", json!(self.faces)),
            ("components", json!(self.components)),
            ("boundary_loops", json!(self.boundary_loops)),
            ("boundary_edges", json!(self.boundary_edges)),
            ("non_manifold_edges", json!(self.non_manifold_edges)),
            ("non_manifold_vertices", json!(self.non_manifold_vertices)),
            ("inconsistent_edges", json!(self.inconsistent_edges)),
            ("manifold", json!(self.manifold)),
            ("closed", json!(self.closed)),
            ("orientable", json!(self.orientable)),
            ("oriented", json!(self.is_oriented())),
            ("euler_characteristic", json!(self.euler_characteristic)),
            ("genus", json!(genus)),
            ("genus_is", json!(genus_is)),
            ("handles", json!(self.handles)),
            ("crosscaps", json!(self.crosscaps)),
            ("degenerate_faces", json!(self.degenerate_faces)),
            ("duplicate_faces", json!(self.duplicate_faces)),
            ("isolated_vertices", json!(self.isolated_vertices)),
            ("coincident_vertices", json!(self.coincident_vertices)),
            ("area", size(self.area)),
            ("volume", size(self.volume)),
        ];
        object.extend(keys.map(|(key, value)| (key.to_owned(), value)));
    }
}
