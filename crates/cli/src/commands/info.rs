//! `info`: what a file holds.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};
use shapeloom_core::{Diagnostic, Exec, Findings, Place, Severity};
use shapeloom_judge::{JudgeError, MeshRef, NotConvex, PolygonReport};
use shapeloom_mesh::{Attributes, Domain, MeshAttributes, Polyline};
use shapeloom_shape::{Geometry, Kind, Part, Shape};
use shapeloom_voxels::isosurface::sample_range;

use crate::account;
use crate::arguments::InfoArguments;
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::soundness::Soundness;

pub(crate) fn run(arguments: &InfoArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let settings = Settings::sort(&arguments.settings);
    settings.no_writing()?;
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    if let Some((key, _)) = settings.converting(input.format).first() {
        let message = format!("found --set {key}, expected an option of the input");
        return Err(Failure::usage("E-usage-setting", message));
    }
    let mut findings = input.read.findings.clone();
    let described = describe(&input.read.shape, &mut findings, &session.exec());
    let mut object = described.map_err(|failure| failure.about(&arguments.input))?;
    object.insert("schema".into(), json!("shapeloom.info/1"));
    object.insert("file".into(), json!(input.name));
    object.insert("format".into(), json!(input.format.id));
    object.insert("bytes".into(), json!(input.bytes));
    object.insert("findings".into(), account::findings(&findings));
    object.insert("losses".into(), account::losses(&input.read.losses));
    if session.globals.json { session.print_json(&Value::Object(object)) } else { session.print(words(&object)) }
}

/// The most parts of which each has the whole report: all of it takes some three kilobytes as JSON.
const FULLY_TOLD: usize = 1000;

/// Everything about a shape as one object: counts are sums over the parts as they are placed.
fn describe(shape: &Shape, findings: &mut Findings, exec: &Exec) -> Result<Map<String, Value>, Failure> {
    let mut object = Map::new();
    let kinds = shape.kinds();
    let kind = match kinds.as_slice() {
        [only] => only.name(),
        [] => "empty",
        _ => "mixed",
    };
    object.insert("kind".into(), json!(kind));
    let meshes = kinds.iter().any(|kind| matches!(kind, Kind::TriMesh | Kind::PolyMesh));
    let brief = shape.parts.len() > FULLY_TOLD;
    if brief {
        let message = format!("more than {FULLY_TOLD} parts: each is told by its counts alone");
        findings.push("W-info-parts", Severity::Note, Place::Whole, message);
    }
    let mut totals = Totals { meshes, brief, ..Totals::default() };
    let mut parts = Vec::new();
    for part in &shape.parts {
        exec.check()?;
        parts.push(totals.add(part, shape, findings, exec)?);
    }
    totals.tell(&mut object);
    object.insert("parts".into(), Value::Array(parts));
    let bounds = shape.bounds();
    if !bounds.is_empty() {
        object.insert("bounds".into(), account::bounds(&bounds));
        object.insert("diagonal".into(), account::number(bounds.diagonal()));
    }
    object.insert("memory_bytes".into(), json!(shape.memory_bytes()));
    if let Some(up) = shape.up {
        object.insert("up".into(), json!(up.name()));
    }
    if let Some(units) = shape.units {
        object.insert("unit_in_meters".into(), account::number(units.meters()));
    }
    let materials: Vec<&str> = shape.materials.iter().map(|material| material.name.as_str()).collect();
    object.insert("materials".into(), json!(materials));
    let tables = shape.tables.iter().map(|table| {
        let columns = table.columns.iter().map(|column| column.name());
        let lists = table.columns.lists().iter().map(|list| list.name());
        let names: Vec<&str> = columns.chain(lists).collect();
        json!({ "name": table.name, "rows": table.columns.len(), "columns": names })
    });
    object.insert("tables".into(), tables.collect());
    object.insert("comments".into(), json!(shape.comments));
    Ok(object)
}

/// Counts that add up over parts; those of kinds that do not occur stay away.
#[derive(Default)]
struct Totals {
    meshes: bool,
    /// Whether parts are told in few words.
    brief: bool,
    counts: Map<String, Value>,
    soundness: Option<Soundness>,
    /// Domain, name, width (none for lists) and type.
    attributes: BTreeSet<(String, String, Option<usize>, String)>,
}

impl Totals {
    fn count(&mut self, part: &mut Map<String, Value>, name: &str, found: usize) {
        part.insert(name.into(), json!(found));
        let before = self.counts.get(name).and_then(Value::as_u64).unwrap_or(0);
        self.counts.insert(name.into(), json!(before + found as u64));
    }

    fn attributes(&mut self, domain: &str, attributes: &Attributes) {
        for column in attributes {
            let (name, kind) = (column.name().to_owned(), column.values().type_name());
            self.attributes.insert((domain.to_owned(), name, Some(column.width()), kind.to_owned()));
        }
        for list in attributes.lists() {
            let (name, kind) = (list.name().to_owned(), format!("list of {}", list.values().type_name()));
            self.attributes.insert((domain.to_owned(), name, None, kind));
        }
    }

    fn mesh_attributes(&mut self, attributes: &MeshAttributes) {
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            self.attributes(&domain.to_string(), attributes.of(domain));
        }
    }

    fn mesh<'a>(
        &mut self,
        part: &mut Map<String, Value>,
        mesh: impl Into<MeshRef<'a>>,
        findings: &mut Findings,
        exec: &Exec,
    ) -> Result<(), Failure> {
        let (found, witnesses) = Soundness::of(mesh, exec, findings)?;
        if self.brief {
            found.tell_briefly(part);
        } else {
            found.tell(part);
            part.insert("witnesses".into(), witnesses);
        }
        self.soundness = Some(match self.soundness.take() {
            Some(before) => before.with(&found),
            None => found,
        });
        Ok(())
    }

    fn add(&mut self, part: &Part, shape: &Shape, findings: &mut Findings, exec: &Exec) -> Result<Value, Failure> {
        let mut object = Map::new();
        object.insert("name".into(), json!(part.name));
        object.insert("kind".into(), json!(part.geometry.kind().name()));
        if let Some(material) = part.material.and_then(|index| shape.materials.get(index as usize)) {
            object.insert("material".into(), json!(material.name));
        }
        let placed = part.placed();
        match &*placed {
            Geometry::TriMesh(mesh) => {
                self.mesh(&mut object, mesh, findings, exec)?;
                self.count(&mut object, "triangles", mesh.triangles().len());
                self.mesh_attributes(mesh.attributes());
            }
            Geometry::PolyMesh(mesh) => {
                self.mesh(&mut object, mesh, findings, exec)?;
                self.count(&mut object, "triangles", mesh.triangle_count());
                self.mesh_attributes(mesh.attributes());
            }
            Geometry::PointCloud(cloud) => {
                self.count(&mut object, "points", cloud.positions().len());
                self.attributes("vertex", cloud.attributes());
            }
            Geometry::Polyline(line) => {
                self.count(&mut object, "points", line.points().len());
                self.count(&mut object, "segments", line.segments().count());
                object.insert("length".into(), account::number(line.length()));
                object.insert("closed".into(), json!(line.is_closed()));
                if !self.brief {
                    polygon(&mut object, line, findings, exec)?;
                }
                self.attributes("vertex", line.attributes());
            }
            Geometry::GeometricGraph(graph) => {
                // Beside meshes the totals are those of the meshes.
                let (vertices, edges) =
                    if self.meshes { ("graph_vertices", "graph_edges") } else { ("vertices", "edges") };
                self.count(&mut object, vertices, graph.positions().len());
                self.count(&mut object, edges, graph.edges().len());
                object.insert("length".into(), account::number(graph.length()));
                self.attributes("vertex", graph.vertex_attributes());
                self.attributes("edge", graph.edge_attributes());
            }
            Geometry::HeightField(field) => {
                self.count(&mut object, "samples", field.heights().len());
                object.insert("columns".into(), json!(field.columns()));
                object.insert("rows".into(), json!(field.rows()));
                object.insert("spacing".into(), json!([field.spacing().x, field.spacing().y]));
                let holes = field.heights().iter().filter(|height| height.is_nan()).count();
                self.count(&mut object, "holes", holes);
                let known = field.heights().iter().filter(|height| !height.is_nan());
                let (low, high) =
                    known.fold((f64::MAX, f64::MIN), |(low, high), height| (low.min(*height), high.max(*height)));
                if low <= high {
                    object.insert("lowest".into(), account::number(low));
                    object.insert("highest".into(), account::number(high));
                }
            }
            Geometry::Implicit(implicit) => {
                self.count(&mut object, "nodes", implicit.tree().node_count());
                self.count(&mut object, "steps", implicit.program().len());
                object.insert("values".into(), json!(implicit.nature().meaning().name()));
                let lipschitz = implicit.nature().lipschitz.map_or(Value::Null, account::number);
                object.insert("lipschitz".into(), lipschitz);
            }
            Geometry::VoxelGrid(grid) => {
                self.count(&mut object, "samples", grid.lattice().samples() as usize);
                object.insert("dimensions".into(), json!(grid.lattice().dimensions()));
                object.insert("spacing".into(), json!(grid.lattice().spacing().to_array()));
                object.insert("sample_type".into(), json!(grid.samples().name()));
                object.insert("quantity".into(), json!(grid.quantity().name()));
                let range = sample_range(grid, exec)?;
                if let Some([low, high]) = range.finite {
                    object.insert("lowest".into(), account::number(f64::from(low)));
                    object.insert("highest".into(), account::number(f64::from(high)));
                }
                self.count(&mut object, "not_finite", range.not_finite as usize);
            }
            Geometry::BezierCurve(curve) => {
                self.count(&mut object, "control_points", curve.control_points().len());
                object.insert("degree".into(), json!(curve.degree()));
            }
            Geometry::BezierSurface(surface) => {
                self.count(&mut object, "patches", surface.patches.len());
                self.count(&mut object, "control_points", surface.control_point_count());
                let degrees: BTreeSet<(usize, usize)> =
                    surface.patches.iter().map(|patch| (patch.degree_u(), patch.degree_v())).collect();
                object.insert("degrees".into(), degrees.into_iter().map(|(u, v)| json!([u, v])).collect());
            }
            _ => {}
        }
        Ok(Value::Object(object))
    }

    fn tell(self, object: &mut Map<String, Value>) {
        object.extend(self.counts);
        if let Some(soundness) = self.soundness {
            soundness.tell(object);
        }
        let one = |(domain, name, width, kind): (String, String, Option<usize>, String)| match width {
            Some(width) => json!({ "domain": domain, "name": name, "width": width, "type": kind }),
            None => json!({ "domain": domain, "name": name, "type": kind }),
        };
        object.insert("attributes".into(), self.attributes.into_iter().map(one).collect());
    }
}

/// What is known of a polyline as a polygon; why it cannot be told goes into the findings.
fn polygon(
    object: &mut Map<String, Value>,
    line: &Polyline,
    findings: &mut Findings,
    exec: &Exec,
) -> Result<(), Failure> {
    let report = match PolygonReport::of(line.points(), line.is_closed(), exec) {
        Ok(report) => report,
        Err(error @ (JudgeError::NotFinite { .. } | JudgeError::Underflow { .. })) => {
            findings.push(error.code(), Severity::Warning, Place::Whole, error.to_string());
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    object.insert("closed".into(), json!(report.is_closed()));
    object.insert("gap".into(), json!(report.open));
    object.insert("planar".into(), json!(report.is_planar()));
    object.insert("flatness".into(), account::number(report.flatness));
    object.insert("simple".into(), json!(report.is_simple()));
    object.insert("convex".into(), json!(report.is_convex()));
    let mut witnesses = Map::new();
    if let Some(corners) = report.not_planar {
        witnesses.insert("not_planar".into(), json!({ "corners": corners }));
    }
    if let Some(sides) = report.not_simple {
        witnesses.insert("not_simple".into(), json!({ "sides": sides }));
    }
    if let Some(why) = report.not_convex {
        let why = match why {
            NotConvex::NoRegion => json!("it is open, meets itself, or lies on one line"),
            NotConvex::NotPlanar => json!("it is not planar"),
            NotConvex::Corner(corner) => json!({ "corner": corner }),
        };
        witnesses.insert("not_convex".into(), why);
    }
    object.insert("witnesses".into(), Value::Object(witnesses));
    Ok(())
}

/// The order in which a reader wants to know; the rest follows by name.
const ORDER: [&str; 29] = [
    "bytes",
    "memory_bytes",
    "up",
    "unit_in_meters",
    "bounds",
    "diagonal",
    "vertices",
    "edges",
    "faces",
    "triangles",
    "area",
    "volume",
    "components",
    "closed",
    "manifold",
    "orientable",
    "oriented",
    "euler_characteristic",
    "genus",
    "genus_is",
    "handles",
    "crosscaps",
    "boundary_loops",
    "boundary_edges",
    "non_manifold_edges",
    "non_manifold_vertices",
    "inconsistent_edges",
    "degenerate_faces",
    "duplicate_faces",
];

/// The object in lines of words: single values first, then what has a line each.
fn words(object: &Map<String, Value>) -> String {
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut lines: Vec<String> = ["file", "format", "kind"]
        .into_iter()
        .filter_map(|key| Some(format!("{key}: {}", text(object.get(key)?))))
        .collect();
    let rank = |key: &str| ORDER.iter().position(|known| *known == key).unwrap_or(ORDER.len());
    let mut keys: Vec<(&String, &Value)> = object.iter().filter(|(_, value)| !value.is_array()).collect();
    keys.sort_by_key(|(key, _)| rank(key));
    for (key, value) in keys {
        if ["schema", "file", "format", "kind"].contains(&key.as_str()) {
            continue;
        }
        let value = match value {
            Value::Object(fields) => {
                fields.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ")
            }
            other => text(other),
        };
        lines.push(format!("{}: {value}", key.replace('_', " ")));
    }
    for (key, value) in object.iter().filter_map(|(key, value)| Some((key, value.as_array()?))) {
        // The only mesh is what was told above.
        if key == "parts" && value.len() == 1 && value[0].get("faces").is_some() {
            continue;
        }
        for item in value {
            let item = match item {
                Value::Object(_) if key == "findings" => {
                    lines.push(format!(
                        "{}[{}]: {}",
                        text(&item["severity"]),
                        text(&item["code"]),
                        text(&item["message"])
                    ));
                    continue;
                }
                Value::Object(fields) => {
                    let shown = fields.iter().filter(|(_, value)| **value != json!(""));
                    shown.map(|(name, value)| format!("{name} {}", text(value))).collect::<Vec<_>>().join(", ")
                }
                other => text(other),
            };
            let one = if key == "losses" { "lost" } else { key.strip_suffix('s').unwrap_or(key) };
            lines.push(format!("{one}: {item}"));
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;
    use shapeloom_mesh::{Column, GeometricGraph, ListColumn, Values};
    use shapeloom_shape::Table;

    #[test]
    fn graphs_lists_tables_and_comments_are_told() {
        let mut graph = GeometricGraph::try_new(vec![DVec3::ZERO, DVec3::X], vec![[0, 1]]).unwrap();
        graph.insert_edge_attribute(Column::labels("street", vec![7])).unwrap();
        let houses = ListColumn::try_new("houses", vec![0, 2, 3], Values::U8(vec![1, 2, 3])).unwrap();
        graph.insert_vertex_list(houses).unwrap();
        let mut columns = Attributes::new(4);
        columns.insert(Column::labels("size", vec![0; 4])).unwrap();
        let tables = vec![Table { name: "rows".into(), columns }];
        let shape = Shape { tables, comments: vec!["made by hand".into()], ..Shape::new(Part::new(graph)) };
        let told = Value::Object(describe(&shape, &mut Findings::default(), &Exec::default()).unwrap());
        assert_eq!((&told["kind"], &told["edges"]), (&json!("geometric-graph"), &json!(1)));
        assert_eq!(
            told["attributes"],
            json!([
                {"domain": "edge", "name": "street", "width": 1, "type": "u32"},
                {"domain": "vertex", "name": "houses", "type": "list of u8"}
            ])
        );
        assert_eq!(told["tables"], json!([{"name": "rows", "rows": 4, "columns": ["size"]}]));
        assert_eq!(told["comments"], json!(["made by hand"]));
    }
}
