//! Geometries in the buffer of a file.

use serde_json::{Map, Value};
use shapeloom_core::Affine;
use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{Column, Domain, triangle_normal};
use shapeloom_shape::{Geometry, Part};

use super::by_material::{by_material, material_column};
use super::document::Builder;
use super::encode::{Elements, Encoder, Sets, Source};
use super::looks::Looks;
use super::origin::{about, single_precision};
use super::split::{Split, split};
use crate::WriteError;
use crate::placed::{Losses, columns_of, placed_part, points_of};

const POINTS: u64 = 0;
const LINES: u64 = 1;
const LINE_LOOP: u64 = 2;
const LINE_STRIP: u64 = 3;
const TRIANGLES: u64 = 4;

/// A geometry in the buffer: primitives that lack only the material of the part.
#[derive(Clone)]
pub(super) struct Stored {
    primitives: Vec<Primitive>,
    pub origin: DVec3,
    pub rounding: f64,
}

#[derive(Clone)]
struct Primitive {
    members: Map<String, Value>,
    /// The name of its own material, which goes before that of the part.
    material: Option<String>,
    has_texcoords: bool,
}

impl Stored {
    /// The primitives for a part of that material.
    pub fn primitives(self, material: Option<u32>, looks: &mut Looks<'_>, losses: &mut Losses) -> Value {
        let finished = self.primitives.into_iter().map(|mut primitive| {
            let own = primitive.material.map(|name| looks.named(&name));
            if let Some(mut material) = own.or(material) {
                if !primitive.has_texcoords {
                    material = looks.without_texture(material, losses);
                }
                primitive.members.insert("material".into(), material.into());
            }
            sorted(primitive.members)
        });
        Value::Array(finished.collect())
    }
}

/// Puts a geometry into the buffer; none if glTF has no way to hold one so small.
pub(super) fn store(builder: &mut Builder<'_>, index: usize, part: &Part) -> Result<Option<Stored>, WriteError> {
    let local = Part { placement: Affine::IDENTITY, ..part.clone() };
    let geometry = placed_part(builder.format, index, &local)?;
    let points = points_of(&geometry).unwrap_or(&[]);
    let (mode, least, too_small) = match &*geometry {
        Geometry::TriMesh(mesh) => (TRIANGLES, "one triangle", mesh.triangles().is_empty()),
        Geometry::Polyline(line) if line.is_closed() => (LINE_LOOP, "two points", points.len() < 2),
        Geometry::Polyline(_) => (LINE_STRIP, "two points", points.len() < 2),
        Geometry::GeometricGraph(graph) => (LINES, "one edge", graph.edges().is_empty()),
        _ => (POINTS, "one point", points.is_empty()),
    };
    if too_small {
        let kind = geometry.kind();
        let what = match points.len() {
            0 => format!("the {kind} of part {index}, which is empty"),
            count => format!("{count} points of the {kind} of part {index}"),
        };
        let why = format!("glTF holds none of less than {least}; the node of the part is kept");
        builder.losses.push(what, why);
        return Ok(None);
    }
    let single = single_precision(points).map_err(|at| WriteError::NotFinite {
        format: builder.format,
        part: index,
        name: part.name.clone(),
        element: "vertex",
        index: at,
    })?;
    let mut primitives = Vec::new();
    if let Geometry::TriMesh(mesh) = &*geometry {
        let split =
            split(points.len(), mesh.triangles(), &wedge_columns(&geometry), builder.exec)?.ok_or_else(|| {
                let (found, max) = (mesh.triangles().len() as u64 * 3, u64::from(u32::MAX) - 1);
                WriteError::TooLarge { format: builder.format, what: "split vertices", found, max }
            })?;
        for (material, split) in by_material(split, material_column(mesh)) {
            let points: Vec<DVec3> = split.vertices.iter().map(|&vertex| points[vertex as usize]).collect();
            let mut primitive = primitive(builder, mode, &geometry, Some(&split), &points, single.origin);
            let indices = builder.bin.indices(split.triangles.as_flattened(), points.len());
            primitive.members.insert("indices".into(), indices);
            primitives.push(Primitive { material: material.map(str::to_owned), ..primitive });
        }
    } else {
        let mut primitive = primitive(builder, mode, &geometry, None, points, single.origin);
        if let Geometry::GeometricGraph(graph) = &*geometry {
            let indices = builder.bin.indices(graph.edges().as_flattened(), points.len());
            primitive.members.insert("indices".into(), indices);
        }
        primitives.push(primitive);
    }
    Ok(Some(Stored { primitives, origin: single.origin, rounding: single.rounding }))
}

/// A primitive without its indices and material.
fn primitive(
    builder: &mut Builder<'_>,
    mode: u64,
    geometry: &Geometry,
    split: Option<&Split>,
    points: &[DVec3],
    origin: DVec3,
) -> Primitive {
    let mut attributes = Map::new();
    attributes.insert("POSITION".into(), builder.bin.floats(3, &about(points, origin), true));
    encode(builder, &mut attributes, geometry, split, points);
    let has_texcoords = attributes.contains_key("TEXCOORD_0");
    let mut members = Map::new();
    members.insert("attributes".into(), sorted(attributes));
    members.insert("mode".into(), mode.into());
    builder.vertices += points.len();
    Primitive { members, material: None, has_texcoords }
}

/// The wedge columns that can be written.
fn wedge_columns(geometry: &Geometry) -> Vec<&Column> {
    let columns = columns_of(geometry, Domain::Wedge).into_iter().flatten();
    columns.filter(|column| column.width() <= 4 && column.values().type_name() != "text").collect()
}

fn encode(
    builder: &mut Builder<'_>,
    attributes: &mut Map<String, Value>,
    geometry: &Geometry,
    split: Option<&Split>,
    points: &[DVec3],
) {
    let materials = if let Geometry::TriMesh(mesh) = geometry { material_column(mesh) } else { None };
    for column in columns_of(geometry, Domain::Face).into_iter().flatten() {
        if materials.is_none_or(|materials| materials.name() != column.name()) {
            builder.losses.column(Domain::Face, column.name(), "glTF has no values on faces");
        }
    }
    let spare_normals = || split.map(|split| facet_normals(split, points));
    let wedge = columns_of(geometry, Domain::Wedge);
    let hidden = |column: &&Column| wedge.is_some_and(|wedge| wedge.get(column.name()).is_some());
    let vertex = || columns_of(geometry, Domain::Vertex).into_iter().flatten();
    let written: Vec<&Column> = vertex().filter(|column| !hidden(column)).chain(wedge.into_iter().flatten()).collect();
    let mut encoder = Encoder {
        bin: &mut builder.bin,
        losses: &mut builder.losses,
        findings: &mut builder.findings,
        changes: &mut builder.changes,
        sets: Sets::of(&written),
        spare_normals: &spare_normals,
    };
    for column in vertex() {
        if hidden(&column) {
            let why = "glTF has one attribute of that name, and the wedge attribute took it";
            encoder.losses.column(Domain::Vertex, column.name(), why);
            continue;
        }
        let elements = match split {
            Some(split) => Elements::At(&split.vertices),
            None => Elements::Same(points.len()),
        };
        encoder.column(attributes, Source { domain: Domain::Vertex, column, elements });
    }
    if let (Some(wedge), Some(split)) = (wedge, split) {
        for column in wedge {
            let elements = Elements::At(&split.wedges);
            encoder.column(attributes, Source { domain: Domain::Wedge, column, elements });
        }
    }
}

/// The same members in the order of their keys.
fn sorted(members: Map<String, Value>) -> Value {
    let mut members: Vec<(String, Value)> = members.into_iter().collect();
    members.sort_by(|a, b| a.0.cmp(&b.0));
    Value::Object(members.into_iter().collect())
}

/// For each vertex the normal of its first triangle that has one.
fn facet_normals(split: &Split, points: &[DVec3]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; points.len()];
    for triangle in &split.triangles {
        let normal = triangle_normal(triangle.map(|vertex| points[vertex as usize]));
        for &vertex in triangle {
            if normals[vertex as usize] == DVec3::ZERO {
                normals[vertex as usize] = normal;
            }
        }
    }
    normals
}
