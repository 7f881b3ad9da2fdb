//! The document of a file that is written, and its buffer.

use std::collections::HashMap;
use std::sync::Arc;

use serde_json::Value;
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Deviation, Exec, Findings, Place, Report, Severity};
use shapeloom_shape::{Geometry, Part, Shape, UpAxis};

use super::GLB;
use super::bin::{Bin, array, object};
use super::changes::Changes;
use super::looks::Looks;
use super::stored::{Stored, store};
use crate::placed::{Losses, frame_losses};
use crate::{Format, WriteContext, WriteError};

/// A document, all but its buffers, with the bytes of its one buffer.
pub(super) struct Document {
    pub members: Value,
    pub bytes: Vec<u8>,
    pub report: Report,
}

/// Makes the document of a shape.
///
/// With `flatten` every part is written out where it is: no node but the root, which turns and scales the whole, and the
/// local origins of parts far away has a transform, and no two parts share data.
pub(super) fn document(
    shape: &Shape,
    context: &WriteContext,
    format: &Format,
    flatten: bool,
) -> Result<Document, WriteError> {
    let mut losses = Losses::from(frame_losses(shape, format));
    let looks = Looks::new(&shape.materials, &mut losses);
    let mut builder = Builder {
        exec: &context.exec,
        format: format.id,
        flatten,
        looks,
        losses,
        changes: Changes::default(),
        bin: Bin::default(),
        nodes: Vec::new(),
        meshes: Vec::new(),
        turned: false,
        stored: HashMap::new(),
        mesh_of: HashMap::new(),
        rounding: 0.0,
        vertices: 0,
        findings: Findings::default(),
    };
    builder.root(shape);
    for (index, part) in shape.parts.iter().enumerate() {
        context.exec.check()?;
        builder.part(index, part, shape)?;
        context.exec.progress(index as f64 / shape.parts.len() as f64);
    }
    let mut report = builder.report();
    report.figure("vertices", builder.vertices as f64);
    let (members, bytes) = builder.into_members();
    Ok(Document { members, bytes, report })
}

/// What is written so far.
pub(super) struct Builder<'s> {
    pub exec: &'s Exec,
    /// The id of the format.
    pub format: &'static str,
    flatten: bool,
    pub looks: Looks<'s>,
    pub losses: Losses,
    pub changes: Changes,
    pub findings: Findings,
    pub bin: Bin,
    pub vertices: usize,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    turned: bool,
    stored: HashMap<*const Geometry, Option<Stored>>,
    mesh_of: HashMap<(*const Geometry, Option<u32>), usize>,
    rounding: f64,
}

impl Builder<'_> {
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
            let (format, name) = (self.format, part.name.clone());
            return Err(WriteError::NotFinite { format, part: index, name, element: "placement", index: 0 });
        }
        let material = part.material.filter(|&material| (material as usize) < shape.materials.len());
        let baked = if self.flatten {
            true
        } else if is_node_matrix(&part.placement) {
            false
        } else {
            let why = "glTF nodes cannot shear or flatten: the placement was applied to the coordinates";
            self.losses.push(format!("placement of part {index}"), why);
            true
        };
        let baked = baked.then(|| Part { placement: Affine::IDENTITY, geometry: part.placed(), ..part.clone() });
        let part = baked.as_ref().unwrap_or(part);
        let key = Arc::as_ptr(&part.geometry);
        if !self.stored.contains_key(&key) {
            let stored = store(self, index, part)?;
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
            let number = match self.mesh_of.get(&(key, material)) {
                Some(&number) => number,
                None => {
                    let primitives = stored.primitives(material, &mut self.looks, &mut self.losses);
                    self.meshes.push(object([("primitives", primitives)]));
                    self.mesh_of.insert((key, material), self.meshes.len() - 1);
                    self.meshes.len() - 1
                }
            };
            mesh = number.into();
        }
        // A baked geometry is this part's alone; it may die with this call, and its address may come again.
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

    fn report(&mut self) -> Report {
        let (deviation, basis) = if self.rounding > 0.0 {
            (Deviation::AtMost(self.rounding), "the largest rounding of a position to single precision, measured")
        } else {
            (Deviation::Exact, "every position is a number of single precision")
        };
        let name = if self.format == GLB.id { "write-glb" } else { "write-gltf" };
        let mut report = Report::new(name, deviation, basis);
        if self.rounding > 0.0 {
            let why = format!("they were rounded to single precision, by at most {:e}", self.rounding);
            self.losses.push("positions", why);
        }
        self.changes.say(&mut self.losses);
        report.losses = std::mem::take(&mut self.losses).into_vec();
        report.findings = std::mem::take(&mut self.findings);
        report
    }

    fn into_members(self) -> (Value, Vec<u8>) {
        let top = if self.turned { vec![0] } else { (0..self.nodes.len()).collect::<Vec<usize>>() };
        let top = array(top.into_iter().map(Value::from).collect());
        let generator = concat!("shapeloom ", env!("CARGO_PKG_VERSION"));
        let members = [
            ("asset", object([("generator", generator.into()), ("version", "2.0".into())])),
            ("scene", 0.into()),
            ("scenes", Value::Array(vec![object([("nodes", top)])])),
            ("nodes", array(self.nodes)),
            ("meshes", array(self.meshes)),
            ("accessors", array(self.bin.accessors)),
            ("bufferViews", array(self.bin.views)),
        ];
        (object(members.into_iter().chain(self.looks.into_members())), self.bin.bytes)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shears_and_flat_maps_are_no_node_matrices() {
        let scale = Affine::from_scale(DVec3::new(1.0, -2.0, 1e-9));
        assert!(is_node_matrix(&scale) && stretch(&scale) >= 2.0 && stretch(&scale) < 2.0001);
        assert!(!is_node_matrix(&Affine::from_shear(DVec3::X, DVec3::Y)));
        assert!(!is_node_matrix(&Affine::from_scale(DVec3::new(1.0, 0.0, 1.0))));
    }
}
