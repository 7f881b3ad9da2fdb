//! From points, edges and wishes to a triangle mesh, for every converter of this folder.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{ConvertError, Converted, Deviation, Exec, Findings, Place, Report, Severity};
use spade::Triangulation as _;
use spade::handles::FixedVertexHandle;

use super::constraints::{Constraints, constrain};
use super::error::PlaneError;
use super::inside::inside;
use super::mixtures::{self, Mixture};
use super::projection::Projection;
use super::refine::{BOX, Reached, Refinement, Wanted};
use super::triangle_shape::Shape;
use super::triangulation::{Cdt, Triangulation, position};
use crate::{Attributes, MeshAttributes, MeshError, MeshOrigins, Origins, TriMesh, carry};

/// Which triangles are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// All within the convex hull.
    Hull,
    /// Those that edges enclose: behind an odd number of them.
    Enclosed,
    /// Those inside closed loops by the even-odd rule. An edge that loops have in common counts as often as they do.
    EvenOdd,
}

/// How triangles are to be improved by new vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refine {
    /// The smallest angle wanted, in degrees; 0 for any.
    pub(crate) angle: f64,
    /// The largest area wanted, in the units of the source; 0 for any.
    pub(crate) area: f64,
    /// How many vertices may be added.
    pub(crate) most: u32,
    /// Whether edges of the source may be split.
    pub(crate) split_edges: bool,
}

/// What is to be triangulated, and how.
pub(crate) struct Sheet<'a> {
    /// The converter.
    pub(crate) name: &'static str,
    /// What its points and edges are called.
    pub(crate) words: [&'static str; 2],
    pub(crate) positions: &'a [DVec3],
    pub(crate) attributes: &'a Attributes,
    pub(crate) edges: &'a [[u32; 2]],
    pub(crate) projection: Projection,
    pub(crate) kept: Kept,
    /// Whether edges that cross are an error.
    pub(crate) refuse_crossings: bool,
    pub(crate) refine: Refine,
    pub(crate) deviation: (Deviation, &'static str),
}

/// The triangles of a sheet by the vertices of its triangulation, and what those are made of.
struct Cut {
    triangles: Vec<[u32; 3]>,
    /// Vertices beyond the points, in the triangulation's scale, and their mixtures.
    places: Vec<DVec2>,
    mixtures: Vec<Mixture>,
}

impl Sheet<'_> {
    pub(crate) fn triangulate(&self, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        if let Some(index) = self.positions.iter().position(|position| !position.is_finite()) {
            return Err(MeshError::NotFinite { kind: self.words[0], index: index as u64 }.into());
        }
        let points = self.positions.len();
        let (deviation, basis) = self.deviation;
        let mut report = Report::new(self.name, deviation, basis);
        report.figure(format!("{}s", plural(self.words[0])), points as f64);
        let own = (self.attributes.memory_bytes() as u64).saturating_add(size_of_val(self.positions) as u64);
        let _memory = exec.reserve(Triangulation::bytes(points).saturating_add(own.saturating_mul(2)))?;
        let flat: Vec<DVec2> = self.positions.iter().map(|&position| self.projection.flat(position)).collect();
        let Some(mut triangulation) = Triangulation::new(&flat, &exec.part(0.0, 0.5))? else {
            return self.line(report);
        };
        drop(flat);
        self.tell_points(&triangulation, &mut report.findings);
        let constraints = constrain(&mut triangulation, self.edges, &exec.part(0.5, 0.7))?;
        if let Some(first) = constraints.crossings.first().filter(|_| self.refuse_crossings) {
            let (edges, count) = (first.edges.map(u64::from), constraints.crossings.len() as u64);
            return Err(PlaneError::Crossing { kind: self.edge_kinds(), edges, count }.into());
        }
        if self.kept == Kept::EvenOdd {
            drop_even(&mut triangulation.cdt, &constraints);
        }
        self.tell_edges(&triangulation, &constraints, &mut report);
        let cut = self.cut(&mut triangulation, &constraints, &exec.part(0.7, 1.0), &mut report)?;
        self.lift(&triangulation, cut, report)
    }

    /// Points on one line: no triangles, the points as they are.
    fn line(&self, mut report: Report) -> Result<Converted<TriMesh>, ConvertError> {
        if !self.positions.is_empty() {
            let message = "all points lie on one line of the plane, so there is no triangle";
            report.findings.push("W-plane-collinear", Severity::Warning, Place::Whole, message);
        }
        report.figure("triangles", 0);
        let vertex = self.attributes.clone();
        let attributes = MeshAttributes { vertex, ..MeshAttributes::new(self.positions.len(), 0, 0) };
        let mesh = TriMesh::with_attributes(self.positions.to_vec(), Vec::new(), attributes)?;
        Ok(Converted::new(mesh, report))
    }

    /// Points that share a place, and coordinates that were too small.
    fn tell_points(&self, triangulation: &Triangulation, findings: &mut Findings) {
        let element = |index: u32| Place::element(self.words[0], u64::from(index));
        if let Some((first, count)) = triangulation.vanished {
            let message = "coordinates below about 1e-100 of the largest were taken as 0 in deciding what is where";
            findings.push_many("W-plane-tiny", Severity::Warning, element(first), message, count);
        }
        if triangulation.point_of.len() == self.positions.len() {
            return;
        }
        let (mut same, mut above) = (Vec::new(), Vec::new());
        for (index, &vertex) in (0u32..).zip(&triangulation.vertex_of) {
            let kept = triangulation.point_of[vertex as usize];
            if kept != index {
                let equal = self.positions[kept as usize] == self.positions[index as usize];
                if equal { same.push(index) } else { above.push(index) }
            }
        }
        let what = plural(self.words[0]);
        let message = format!("{what}s at the place of another: the first was kept");
        findings.push_all(
            "W-plane-duplicate",
            Severity::Note,
            message,
            same.len() as u64,
            same.into_iter().map(element),
        );
        let message = format!("{what}s at the place of another in the plane, but not in space: the first was kept");
        let count = above.len() as u64;
        findings.push_all("W-plane-height", Severity::Warning, message, count, above.into_iter().map(element));
    }

    fn edge_kinds(&self) -> &'static str {
        if self.words[1] == "side" { "sides" } else { "edges" }
    }

    /// What became of the edges.
    fn tell_edges(&self, triangulation: &Triangulation, constraints: &Constraints, report: &mut Report) {
        if self.edges.is_empty() {
            return;
        }
        let word = self.words[1];
        let element = |&edge: &u32| Place::element(word, u64::from(edge));
        let mut tell = |code, severity, what: &str, edges: &[u32]| {
            let message = format!("{word}s {what}");
            report.findings.push_all(code, severity, message, edges.len() as u64, edges.iter().map(element));
        };
        tell("W-plane-point", Severity::Note, "without length in the plane were left out", &constraints.without_length);
        tell("W-plane-overlap", Severity::Note, "over others count once where they overlap", &constraints.overlapping);
        tell(
            "W-plane-through",
            Severity::Note,
            "that pass through a vertex were split there",
            &constraints.through_points,
        );
        report.figure(format!("{word}s"), self.edges.len() as f64);
        report.figure("constraint_edges", triangulation.cdt.num_constraints() as f64);
        let ends = |edge: u32| self.edges[edge as usize];
        let led = &constraints.led_through;
        if !led.is_empty() {
            let places = led.iter().map(|near| Place::element(word, u64::from(near.edges[0])));
            let message =
                format!("{word}s that cross another one within rounding of its end were led through that end");
            report.findings.push_all("W-plane-near", Severity::Note, message, led.len() as u64, places);
            let off = led.iter().map(|near| mixtures::off_edge(triangulation, ends(near.edges[0]), near.vertex));
            report.figure("led_through_rounding", triangulation.scale.length(off.fold(0.0, f64::max)));
        }
        let crossings = &constraints.crossings;
        if crossings.is_empty() {
            return;
        }
        let places =
            crossings.iter().map(|crossing| Place::pair(self.edge_kinds(), crossing.edges[0], crossing.edges[1]));
        let message = format!("{word}s that cross were split at a vertex in the crossing");
        report.findings.push_all("W-plane-crossing", Severity::Warning, message, crossings.len() as u64, places);
        let (mut off, mut gap) = (0.0f64, 0.0f64);
        for crossing in crossings {
            let ends = crossing.edges.map(ends);
            off = ends
                .map(|ends| mixtures::off_edge(triangulation, ends, crossing.vertex))
                .into_iter()
                .fold(off, f64::max);
            let [one, other] = ends.map(|ends| {
                let parts = mixtures::on_edge(triangulation, ends, crossing.vertex);
                self.projection.height(self.mixed(&parts))
            });
            gap = gap.max((one - other).abs());
        }
        report.figure("crossings", crossings.len() as f64);
        let new = triangulation.cdt.num_vertices() - triangulation.point_of.len();
        report.figure("crossing_vertices", new as f64);
        report.figure("crossing_rounding", triangulation.scale.length(off));
        report.figure("crossing_height_gap", gap);
    }

    /// The triangles that are kept, refined if that is wanted.
    fn cut(
        &self,
        triangulation: &mut Triangulation,
        constraints: &Constraints,
        exec: &Exec,
        report: &mut Report,
    ) -> Result<Cut, ConvertError> {
        let Refine { angle, area, most, split_edges } = self.refine;
        let points = triangulation.point_of.len();
        if angle == 0.0 && area == 0.0 {
            let cdt = &triangulation.cdt;
            let is_inside = match self.kept {
                Kept::Hull => None,
                Kept::Enclosed | Kept::EvenOdd => Some(inside(cdt, exec, |edge| edge.is_constraint_edge())?),
            };
            let mixtures = match cdt.num_vertices() > points {
                true => mixtures::of_vertices(triangulation, self.edges, &constraints.crossings).split_off(points),
                false => Vec::new(),
            };
            return Ok(Cut { triangles: faces(cdt, is_inside.as_deref()), places: places(cdt, points), mixtures });
        }
        let before = triangulation.cdt.num_vertices();
        let _memory = exec.reserve(Triangulation::bytes(before))?;
        let mut mixtures = mixtures::of_vertices(triangulation, self.edges, &constraints.crossings);
        let sine = angle.to_radians().sin();
        let side = if area == 0.0 { f64::INFINITY } else { triangulation.scale.length_there(area.sqrt()) };
        let wanted = Wanted { sine_squared: sine * sine, side, most, split_edges };
        let scale = triangulation.scale;
        let mut refinement = Refinement::prepare(triangulation, self.kept == Kept::Hull, wanted, exec)?;
        // In its box, outside of which nothing is looked for.
        let unrefined = refinement.cdt().clone();
        let reached = refinement.run(exec)?;
        let is_inside = refinement.inside(exec)?;
        let cdt = refinement.cdt();
        let triangles = faces(cdt, Some(&is_inside));
        let corner = |vertex: u32| position(cdt, FixedVertexHandle::from_index(vertex as usize));
        let shapes = triangles.iter().map(|triangle| Shape::of(triangle.map(corner)));
        let (least, largest) = shapes.fold((0.75f64, 0.0f64), |(least, largest), shape| {
            (least.min(shape.sine_squared), largest.max(shape.side))
        });
        // The corners of the box are no vertex of a triangle that is kept.
        let added = places(cdt, before + BOX);
        mixtures.resize(before + BOX, Mixture::new());
        for (vertex, (place, near)) in added.into_iter().zip(refinement.beside()).enumerate() {
            if vertex % 256 == 0 {
                exec.check()?;
            }
            let near = if near.index() < before { *near } else { FixedVertexHandle::from_index(0) };
            mixtures.push(mixtures::at(&unrefined, &mixtures, place, near));
        }
        if !triangles.is_empty() {
            report.figure("smallest_angle", least.sqrt().asin().to_degrees());
            let side = scale.length(largest);
            report.figure("largest_area", side * side);
        }
        tell_refinement(&reached, report);
        Ok(Cut { triangles, places: places(cdt, points), mixtures: mixtures.split_off(points) })
    }

    /// The mesh: points that are corners of triangles, in their order, then the new vertices.
    fn lift(
        &self,
        triangulation: &Triangulation,
        Cut { mut triangles, places, mixtures }: Cut,
        report: Report,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        let points = triangulation.point_of.len();
        let mut is_used = vec![self.kept == Kept::Hull; points];
        is_used.resize(points + places.len(), false);
        triangles.as_flattened().iter().for_each(|&vertex| is_used[vertex as usize] = true);
        let is_kept = |point: u32, vertex: u32| triangulation.point_of[vertex as usize] == point;
        let mut new_index = vec![u32::MAX; is_used.len()];
        let mut copies: Vec<u32> = Vec::with_capacity(points);
        for (point, &vertex) in (0u32..).zip(&triangulation.vertex_of) {
            if is_used[vertex as usize] && is_kept(point, vertex) {
                new_index[vertex as usize] = copies.len() as u32;
                copies.push(point);
            }
        }
        let left_out = points - copies.len();
        let mut new: Vec<(DVec3, &Mixture)> = Vec::new();
        for (offset, (&place, mixture)) in places.iter().zip(&mixtures).enumerate() {
            if is_used[points + offset] {
                new_index[points + offset] = (copies.len() + new.len()) as u32;
                new.push((self.projection.place(triangulation.scale.undo(place), self.mixed(mixture)), mixture));
            }
        }
        triangles.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = new_index[*vertex as usize]);
        self.assemble(triangles, copies, &new, left_out, report)
    }

    /// The mesh of triangles between the points themselves.
    pub(crate) fn of_triangles(&self, mut triangles: Vec<[u32; 3]>) -> Result<Converted<TriMesh>, ConvertError> {
        let (deviation, basis) = self.deviation;
        let mut report = Report::new(self.name, deviation, basis);
        report.figure(format!("{}s", plural(self.words[0])), self.positions.len() as f64);
        let mut new_index = vec![u32::MAX; self.positions.len()];
        triangles.as_flattened().iter().for_each(|&point| new_index[point as usize] = 0);
        let copies: Vec<u32> =
            (0..).zip(&new_index).filter(|(_, index)| **index == 0).map(|(point, _)| point).collect();
        (0u32..).zip(&copies).for_each(|(index, &point)| new_index[point as usize] = index);
        triangles.as_flattened_mut().iter_mut().for_each(|point| *point = new_index[*point as usize]);
        let left_out = self.positions.len() - copies.len();
        self.assemble(triangles, copies, &[], left_out, report)
    }

    fn assemble(
        &self,
        triangles: Vec<[u32; 3]>,
        copies: Vec<u32>,
        new: &[(DVec3, &Mixture)],
        left_out: usize,
        mut report: Report,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        let mut positions: Vec<DVec3> = copies.iter().map(|&point| self.positions[point as usize]).collect();
        positions.extend(new.iter().map(|(position, _)| position));
        let source =
            MeshAttributes { vertex: self.attributes.clone(), ..MeshAttributes::new(self.positions.len(), 0, 0) };
        let none = |len: usize| Origins::Unknown { len, why: "the faces are new" };
        let origins = MeshOrigins {
            vertex: if new.is_empty() { Origins::Copies(copies) } else { mixed_origins(&copies, new) },
            face: none(triangles.len()),
            wedge: none(3 * triangles.len()),
        };
        let (attributes, losses) = carry(&source, &origins);
        report.losses.extend(losses);
        if left_out > 0 {
            let message = format!("{}s that no triangle needs were left out", plural(self.words[0]));
            report.findings.push_many("W-plane-outside", Severity::Note, Place::Whole, message, left_out as u64);
        }
        if triangles.is_empty() {
            let message = format!("the {}s enclose nothing, so there is no triangle", self.words[1]);
            report.findings.push("W-plane-empty", Severity::Warning, Place::Whole, message);
        }
        report.figure("vertices", positions.len() as f64);
        report.figure("triangles", triangles.len() as f64);
        let mesh = TriMesh::with_attributes(positions, triangles, attributes)?;
        Ok(Converted::new(mesh, report))
    }

    /// A mixture in space. Relative to its first point, so that what all have in common stays what it is.
    fn mixed(&self, mixture: &[(u32, f64)]) -> DVec3 {
        let at = |point: u32| self.positions[point as usize];
        let first = mixture.first().map_or(DVec3::ZERO, |&(point, _)| at(point));
        mixture.iter().fold(first, |sum, &(point, weight)| sum + (at(point) - first) * weight)
    }
}

/// What several are called, but for the s.
fn plural(word: &str) -> &str {
    if word == "vertex" { "vertice" } else { word }
}

/// Takes the constraint off edges that an even number of loops have in common: both of their sides are inside, or neither.
fn drop_even(cdt: &mut Cdt, constraints: &Constraints) {
    let is_even = |index: usize| constraints.pieces.get(index).is_some_and(|piece| piece.copies % 2 == 0);
    let even: Vec<_> = cdt
        .undirected_edges()
        .filter(|edge| edge.is_constraint_edge() && edge.data().data().index().is_some_and(is_even))
        .map(|edge| edge.fix())
        .collect();
    for edge in even {
        cdt.remove_constraint_edge(edge);
    }
}

fn faces(cdt: &Cdt, is_inside: Option<&[bool]>) -> Vec<[u32; 3]> {
    let kept = cdt.inner_faces().filter(|face| is_inside.is_none_or(|is_inside| is_inside[face.fix().index()]));
    kept.map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32)).collect()
}

/// The positions of the vertices from one on, in the triangulation's scale.
fn places(cdt: &Cdt, first: usize) -> Vec<DVec2> {
    (first..cdt.num_vertices()).map(|vertex| position(cdt, FixedVertexHandle::from_index(vertex))).collect()
}

fn mixed_origins(copies: &[u32], new: &[(DVec3, &Mixture)]) -> Origins {
    let mut starts: Vec<u32> = (0..=copies.len() as u32).collect();
    let (mut sources, mut weights) = (copies.to_vec(), vec![1.0; copies.len()]);
    for (_, mixture) in new {
        sources.extend(mixture.iter().map(|&(point, _)| point));
        weights.extend(mixture.iter().map(|&(_, weight)| weight));
        starts.push(sources.len() as u32);
    }
    Origins::Mixed { starts, sources, weights }
}

fn tell_refinement(reached: &Reached, report: &mut Report) {
    let complete = !reached.out_of_vertices && reached.blocked == 0 && reached.too_small == 0;
    report.figure("vertices_added", f64::from(reached.added));
    report.figure("edges_split", f64::from(reached.on_edges));
    report.figure("triangles_at_small_angles", reached.at_small_angles as f64);
    report.figure("refinement_complete", f64::from(u8::from(complete)));
    let mut tell = |code, severity, count: u64, message: &str| {
        if count > 0 {
            report.findings.push_many(code, severity, Place::Whole, message, count);
        }
    };
    let message = "the refinement ended when the vertices that it may add were used up";
    tell("W-refine-limit", Severity::Warning, u64::from(reached.out_of_vertices), message);
    let message = "triangles are not as wanted, because edges must not be split";
    tell("W-refine-blocked", Severity::Warning, reached.blocked, message);
    let message = "triangles are not as wanted, because they are as small as rounding";
    tell("W-refine-small", Severity::Warning, reached.too_small, message);
    let message = "triangles at the hull that are flat but for rounding were left out";
    tell("W-refine-flat", Severity::Note, reached.peeled, message);
    let message = "triangles between edges that meet in a small angle stay sharper than wanted";
    tell("W-refine-angle", Severity::Note, reached.at_small_angles, message);
}
