//! Writing GLB.

use std::collections::HashMap;
use std::io::Write;
use std::sync::Arc;

use serde_json::{Map, Value};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Deviation, Findings, Place, Report, Severity};
use shapeloom_mesh::{Column, Domain, triangle_normal};
use shapeloom_shape::{Geometry, Material, Part, Shape, UpAxis};

use super::bin::{Bin, array, object};
use super::encode::{Elements, Encoder, Source};
use super::origin::single_precision;
use super::split::{Split, split};
use super::{GLB, materials};
use crate::placed::{Losses, columns_of, frame_losses, placed_part, points_of};
use crate::{WriteContext, WriteError};

const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BIN_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

const TRIANGLES: u64 = 4;
const LINE_STRIP: u64 = 3;
const LINE_LOOP: u64 = 2;
const LINES: u64 = 1;
const POINTS: u64 = 0;

pub(super) fn write_glb(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let mut writer = Writer { losses: Losses::from(frame_losses(shape, &GLB)), ..Writer::default() };
    // Split vertices and attributes beside the bytes of the buffer, once each.
    let _memory = context.exec.reserve((shape.memory_bytes() as u64).saturating_mul(2))?;
    writer.root(shape);
    for (index, part) in shape.parts.iter().enumerate() {
        context.exec.check()?;
        writer.part(index, part, shape)?;
        context.exec.progress(index as f64 / shape.parts.len() as f64);
    }
    writer.materials(&shape.materials);

    let vertices = writer.vertices;
    let report = writer.report();
    let (json, bytes) = writer.into_chunks();
    let total = file_length(json.len() as u64, bytes.len() as u64)?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    for (chunk, tag, pad) in [(json.as_slice(), JSON_CHUNK, b' '), (bytes.as_slice(), BIN_CHUNK, 0)] {
        if tag == BIN_CHUNK && chunk.is_empty() {
            continue;
        }
        let padding = chunk.len().next_multiple_of(4) - chunk.len();
        out.write_all(&((chunk.len() + padding) as u32).to_le_bytes())?;
        out.write_all(&tag.to_le_bytes())?;
        for block in chunk.chunks(1 << 20) {
            context.exec.check()?;
            out.write_all(block)?;
        }
        out.write_all(&[pad; 3][..padding])?;
    }
    let mut report = report;
    report.figure("vertices", vertices as f64);
    report.figure("bytes", f64::from(total));
    Ok(report)
}

/// The length of the file, if its header can say it.
fn file_length(json: u64, bin: u64) -> Result<u32, WriteError> {
    let chunk = |length: u64| if length == 0 { 0 } else { 8 + length.next_multiple_of(4) };
    let found = 12 + chunk(json) + chunk(bin);
    let max = u64::from(u32::MAX);
    u32::try_from(found).map_err(|_| WriteError::TooLarge { format: GLB.id, what: "bytes", found, max })
}

/// A geometry in the buffer: all of a primitive but its material.
#[derive(Clone)]
struct Stored {
    primitive: Map<String, Value>,
    origin: DVec3,
    rounding: f64,
}

#[derive(Default)]
struct Writer {
    bin: Bin,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    turned: bool,
    stored: HashMap<*const Geometry, Option<Stored>>,
    mesh_of: HashMap<(*const Geometry, Option<u32>), usize>,
    rounding: f64,
    vertices: usize,
    losses: Losses,
    findings: Findings,
}

impl Writer {
    /// The node that turns the shape to y up and scales it to metres, where it must be.
    fn root(&mut self, shape: &Shape) {
        if shape.up.is_none() {
            let message = "the up axis is not known; the shape is written as it is, and readers of glTF take y as up";
            self.findings.push("W-glb-up", Severity::Note, Place::Whole, message);
        }
        let meters = shape.units.map_or(1.0, |units| units.meters());
        let turn = shape.up.map_or(Affine::IDENTITY, |up| up.rotation_to(UpAxis::Y));
        let root = Affine::from_linear(turn.linear * meters);
        self.turned = root.linear != Affine::IDENTITY.linear && !shape.parts.is_empty();
        if self.turned {
            let children: Vec<usize> = (1..=shape.parts.len()).collect();
            let matrix = matrix_of(&root);
            self.nodes.push(object([("children", children.into()), ("matrix", matrix)]));
        }
    }

    fn part(&mut self, index: usize, part: &Part, shape: &Shape) -> Result<(), WriteError> {
        if !part.placement.is_finite() {
            let (format, name) = (GLB.id, part.name.clone());
            return Err(WriteError::NotFinite { format, part: index, name, element: "placement", index: 0 });
        }
        let material = part.material.filter(|&material| (material as usize) < shape.materials.len());
        let baked = (!is_node_matrix(&part.placement)).then(|| {
            let why = "glTF nodes cannot shear or flatten: the placement was applied to the coordinates";
            self.losses.push(format!("placement of part {index}"), why);
            Part { placement: Affine::IDENTITY, geometry: part.placed(), ..part.clone() }
        });
        let part = baked.as_ref().unwrap_or(part);
        let key = Arc::as_ptr(&part.geometry);
        // A baked geometry dies with this call, and its address may come again.
        if baked.is_some() {
            self.stored.remove(&key);
            self.mesh_of.remove(&(key, material));
        }
        if !self.stored.contains_key(&key) {
            let stored = self.store(index, part)?;
            self.stored.insert(key, stored);
        }
        let stored = self.stored.get(&key).cloned().flatten();
        let mut placement = part.placement;
        let mut mesh = Value::Null;
        if let Some(stored) = stored {
            self.rounding = self.rounding.max(stored.rounding * stretch(&placement));
            if stored.origin != DVec3::ZERO {
                placement = placement * Affine::from_translation(stored.origin);
            }
            let number = *self.mesh_of.entry((key, material)).or_insert_with(|| {
                let mut primitive = stored.primitive;
                if let Some(material) = material {
                    primitive.insert("material".into(), material.into());
                }
                self.meshes.push(object([("primitives", Value::Array(vec![sorted(primitive)]))]));
                self.meshes.len() - 1
            });
            mesh = number.into();
        }
        if baked.is_some() {
            self.stored.remove(&key);
            self.mesh_of.remove(&(key, material));
        }
        let name = if part.name.is_empty() { Value::Null } else { part.name.as_str().into() };
        let (mut translation, mut matrix) = (Value::Null, Value::Null);
        if placement.linear != Affine::IDENTITY.linear {
            matrix = matrix_of(&placement);
        } else if placement.translation != DVec3::ZERO {
            translation = placement.translation.to_array().to_vec().into();
        }
        self.nodes.push(object([("name", name), ("mesh", mesh), ("translation", translation), ("matrix", matrix)]));
        Ok(())
    }

    /// Puts a geometry into the buffer; none if glTF has no way to hold one so small.
    fn store(&mut self, index: usize, part: &Part) -> Result<Option<Stored>, WriteError> {
        let local = Part { placement: Affine::IDENTITY, ..part.clone() };
        let geometry = placed_part(GLB.id, index, &local)?;
        let points = points_of(&geometry).unwrap_or(&[]);
        let (mode, least, too_small) = match &*geometry {
            Geometry::TriMesh(mesh) => (TRIANGLES, 1, mesh.triangles().is_empty()),
            Geometry::Polyline(line) if line.is_closed() => (LINE_LOOP, 2, points.len() < 2),
            Geometry::Polyline(_) => (LINE_STRIP, 2, points.len() < 2),
            Geometry::GeometricGraph(graph) => (LINES, 1, graph.edges().is_empty()),
            _ => (POINTS, 1, points.is_empty()),
        };
        if too_small {
            let kind = geometry.kind();
            let what = format!("{} points of the {kind} of part {index}", points.len());
            self.losses
                .push(what, format!("a glTF primitive needs at least {least} element of its own; the node is kept"));
            return Ok(None);
        }
        let columns = self.wedge_columns(&geometry);
        let split = match &*geometry {
            Geometry::TriMesh(mesh) => Some(split(points.len(), mesh.triangles(), &columns).ok_or_else(|| {
                let found = mesh.triangles().len() as u64 * 3;
                WriteError::TooLarge { format: GLB.id, what: "split vertices", found, max: u64::from(u32::MAX) - 1 }
            })?),
            _ => None,
        };
        let gathered: Vec<DVec3>;
        let points = match &split {
            Some(split) if split.vertices.len() > points.len() => {
                gathered = split.vertices.iter().map(|&vertex| points[vertex as usize]).collect();
                &gathered
            }
            _ => points,
        };
        let single = single_precision(points).map_err(|at| WriteError::NotFinite {
            format: GLB.id,
            part: index,
            name: part.name.clone(),
            element: "vertex",
            index: split.as_ref().map_or(at, |split| split.vertices[at] as usize),
        })?;
        let mut attributes = Map::new();
        attributes.insert("POSITION".into(), self.bin.floats(3, &single.positions, true));
        self.attributes(&mut attributes, &geometry, split.as_ref(), points);
        let mut primitive = Map::new();
        primitive.insert("attributes".into(), sorted(attributes));
        if let Some(split) = &split {
            primitive.insert("indices".into(), self.bin.indices(split.triangles.as_flattened(), points.len()));
        }
        if let Geometry::GeometricGraph(graph) = &*geometry {
            primitive.insert("indices".into(), self.bin.indices(graph.edges().as_flattened(), points.len()));
        }
        primitive.insert("mode".into(), mode.into());
        self.vertices += points.len();
        Ok(Some(Stored { primitive, origin: single.origin, rounding: single.rounding }))
    }

    /// The wedge columns that can be written.
    fn wedge_columns<'g>(&mut self, geometry: &'g Geometry) -> Vec<&'g Column> {
        let columns = columns_of(geometry, Domain::Wedge).into_iter().flatten();
        columns.filter(|column| column.width() <= 4 && column.values().type_name() != "text").collect()
    }

    fn attributes(
        &mut self,
        attributes: &mut Map<String, Value>,
        geometry: &Geometry,
        split: Option<&Split>,
        points: &[DVec3],
    ) {
        for column in columns_of(geometry, Domain::Face).into_iter().flatten() {
            self.losses.column(Domain::Face, column.name(), "glTF has no values on faces");
        }
        let spare_normals = || split.map(|split| facet_normals(split, points));
        let mut encoder = Encoder {
            bin: &mut self.bin,
            losses: &mut self.losses,
            findings: &mut self.findings,
            spare_normals: &spare_normals,
        };
        let wedge = columns_of(geometry, Domain::Wedge);
        for column in columns_of(geometry, Domain::Vertex).into_iter().flatten() {
            if wedge.is_some_and(|wedge| wedge.get(column.name()).is_some()) {
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

    fn materials(&mut self, materials: &[Material]) {
        for material in materials {
            if let Some(texture) = &material.texture {
                self.losses.push(format!("texture \"{texture}\""), "pictures are not put into the file");
            }
            self.materials.push(materials::to_json(material));
        }
    }

    fn report(&mut self) -> Report {
        let (deviation, basis) = if self.rounding > 0.0 {
            (Deviation::AtMost(self.rounding), "the largest rounding of a position to single precision, measured")
        } else {
            (Deviation::Exact, "every position is a number of single precision")
        };
        let mut report = Report::new("write-glb", deviation, basis);
        report.losses = std::mem::take(&mut self.losses).into_vec();
        report.findings = std::mem::take(&mut self.findings);
        report
    }

    fn into_chunks(self) -> (Vec<u8>, Vec<u8>) {
        let top = if self.turned { vec![0] } else { (0..self.nodes.len()).collect::<Vec<usize>>() };
        let top = array(top.into_iter().map(Value::from).collect());
        let buffers = if self.bin.bytes.is_empty() {
            Value::Null
        } else {
            Value::Array(vec![object([("byteLength", self.bin.bytes.len().into())])])
        };
        let generator = concat!("shapeloom ", env!("CARGO_PKG_VERSION"));
        let document = object([
            ("asset", object([("generator", generator.into()), ("version", "2.0".into())])),
            ("scene", 0.into()),
            ("scenes", Value::Array(vec![object([("nodes", top)])])),
            ("nodes", array(self.nodes)),
            ("meshes", array(self.meshes)),
            ("materials", array(self.materials)),
            ("accessors", array(self.bin.accessors)),
            ("bufferViews", array(self.bin.views)),
            ("buffers", buffers),
        ]);
        (document.to_string().into_bytes(), self.bin.bytes)
    }
}

/// The same members in the order of their keys.
fn sorted(members: Map<String, Value>) -> Value {
    let mut members: Vec<(String, Value)> = members.into_iter().collect();
    members.sort_by(|a, b| a.0.cmp(&b.0));
    Value::Object(members.into_iter().collect())
}

fn matrix_of(map: &Affine) -> Value {
    map.to_matrix().to_cols_array().to_vec().into()
}

/// Whether a node may have this map: glTF asks for a product of translation, rotation and scaling.
fn is_node_matrix(map: &Affine) -> bool {
    // What readers of single precision take for orthogonal.
    const TOLERANCE: f64 = 1e-6;
    let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis].map(DVec3::try_normalize);
    let [Some(x), Some(y), Some(z)] = columns else { return false };
    [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cosine| cosine.abs() <= TOLERANCE)
}

/// The largest factor by which a map with orthogonal columns stretches.
fn stretch(map: &Affine) -> f64 {
    if map.linear == Affine::IDENTITY.linear {
        return 1.0;
    }
    let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis];
    // Room for columns that are orthogonal only up to the tolerance, and for rounding.
    columns.map(DVec3::length).into_iter().fold(0.0, f64::max) * (1.0 + 4e-6)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_the_header_cannot_say_are_refused() {
        assert_eq!(file_length(10, 0).unwrap(), 12 + 8 + 12);
        assert_eq!(file_length(12, 5).unwrap(), 12 + 8 + 12 + 8 + 8);
        let error = file_length(100, 1 << 32).unwrap_err();
        assert!(error.to_string().starts_with("glb: found 4294967424 bytes, expected at most 4294967295"), "{error}");
    }

    #[test]
    fn shears_and_flat_maps_are_no_node_matrices() {
        let scale = Affine::from_scale(DVec3::new(1.0, -2.0, 1e-9));
        assert!(is_node_matrix(&scale) && stretch(&scale) >= 2.0 && stretch(&scale) < 2.0001);
        assert!(!is_node_matrix(&Affine::from_shear(DVec3::X, DVec3::Y)));
        assert!(!is_node_matrix(&Affine::from_scale(DVec3::new(1.0, 0.0, 1.0))));
    }
}
