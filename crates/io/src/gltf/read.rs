//! Reading glTF.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::Value;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_shape::{Geometry, Part, Shape, Units, UpAxis};

use super::allowance::Allowance;
use super::ignored::Ignored;
use super::json::{self, At};
use super::primitive::Primitives;
use super::{buffers, container, materials, scene};
use crate::memory::Memory;
use crate::placed::Losses;
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read_glb(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let container = container::open(input, &mut findings)?;
    let mut memory = Memory::new(&context.exec);
    let start = container.json_start;
    let document = json::parse(container.json, &mut memory, |_, _, offset| Place::Byte((start + offset) as u64))??;
    read_document(&document, container.bin, Allowance::new(input.len()), memory, findings, context)
}

pub(super) fn read_gltf(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let text = input.strip_prefix(b"\xef\xbb\xbf").unwrap_or(input);
    if text.len() < input.len() {
        let message = "the file begins with a byte order mark, which glTF forbids; it was passed over";
        findings.push("W-gltf-mark", Severity::Warning, Place::Byte(0), message);
    }
    let mut memory = Memory::new(&context.exec);
    let line = |line, column, _| Place::Line { line, column: Some(column) };
    let document = json::parse(text, &mut memory, line)??;
    read_document(&document, None, Allowance::new(input.len()), memory, findings, context)
}

fn read_document<'e>(
    document: &Value,
    bin: Option<(&[u8], usize)>,
    mut allowance: Allowance,
    mut memory: Memory<'e>,
    mut findings: Findings,
    context: &'e ReadContext,
) -> Result<ReadShape, ReadError> {
    context.exec.check()?;
    let root = At::root(document);
    check_asset(&root)?;
    let buffers = buffers::open(&root, bin, &mut memory, &mut allowance, context)?;
    let mut ignored = Ignored::default();
    ignored.of("the document", &root);
    let placed = scene::placed_nodes(&root, &mut memory, &allowance, &mut ignored, &mut findings, context)?;

    let mut shape = Shape { units: Some(Units::METERS), up: Some(UpAxis::Y), ..Shape::default() };
    let mut losses = document_losses(&root)?;
    shape.materials = materials::read(&root, &mut memory, &mut allowance, &mut losses, &mut ignored)?;
    let mut primitives =
        Primitives { document: root.clone(), buffers: &buffers, context, memory, allowance, findings, losses, ignored };
    let mut meshes = Meshes::default();
    let count = placed.len();
    for (done, placed) in placed.iter().enumerate() {
        context.exec.check()?;
        context.exec.progress(done as f64 / count as f64);
        let node = &placed.node;
        if node.get("skin")?.is_some() {
            primitives.losses.push("skins", "shapes have one form: the mesh was read as it is");
        }
        let index = node.require("mesh")?;
        let mesh = root.element("meshes", &index)?;
        let [own, name] = [node.get("name")?, mesh.get("name")?].map(|name| name.map(|name| name.text()).transpose());
        let (own, name) = (own?, name?);
        if let (Some(own), Some(name)) = (own, name)
            && own != name
        {
            primitives.ignored.name(index.count_value()?, name);
        }
        let name = own.or(name).unwrap_or("");
        for (geometry, material) in meshes.read(index.count_value()?, &mesh, &mut primitives)? {
            let bytes = name.len() + 2 * size_of::<Part>();
            primitives.take(1, bytes, node)?;
            primitives.allowance.part(node)?;
            let (geometry, placement) = (Arc::clone(geometry), placed.placement);
            shape.parts.push(Part { name: name.to_owned(), geometry, placement, material: *material });
        }
    }
    let unseen = root.count("meshes")?.saturating_sub(meshes.shown.len());
    if unseen > 0 {
        primitives.losses.push(format!("{unseen} meshes"), "no node of the scene shows them");
    }
    let mut losses = primitives.losses.into_vec();
    losses.extend(primitives.ignored.into_losses());
    Ok(ReadShape { shape, findings: primitives.findings, losses })
}

/// What a primitive adds to each node that shows it: its geometry and its material.
type Shown = (Arc<Geometry>, Option<u32>);

/// Meshes that were read, each once.
#[derive(Default)]
struct Meshes {
    shown: BTreeMap<u64, Vec<Shown>>,
    geometries: BTreeMap<String, Option<Arc<Geometry>>>,
}

impl Meshes {
    /// The primitives of the mesh with that number that have a geometry.
    fn read<'a>(
        &mut self,
        number: u64,
        mesh: &At<'a>,
        primitives: &mut Primitives<'a, '_>,
    ) -> Result<&[Shown], ReadError> {
        if !self.shown.contains_key(&number) {
            primitives.ignored.of("meshes", mesh);
            let mut shown = Vec::new();
            for primitive in mesh.require("primitives")?.elements()? {
                primitives.ignored.of("primitives", &primitive);
                let geometry = self.geometry(&primitive, primitives)?;
                let material = match primitive.get("material")? {
                    Some(index) => {
                        primitives.document.element("materials", &index)?;
                        Some(index.count_value()? as u32)
                    }
                    None => None,
                };
                if let Some(geometry) = geometry {
                    primitives.memory.take(2, size_of::<Shown>())?;
                    shown.push((geometry, material));
                }
            }
            self.shown.insert(number, shown);
        }
        Ok(self.shown.get(&number).map_or(&[], Vec::as_slice))
    }

    fn geometry<'a>(
        &mut self,
        primitive: &At<'a>,
        primitives: &mut Primitives<'a, '_>,
    ) -> Result<Option<Arc<Geometry>>, ReadError> {
        primitives.context.exec.check()?;
        let key = geometry_key(primitive.value);
        if let Some(known) = self.geometries.get(&key) {
            return Ok(known.clone());
        }
        let read = primitives.read(primitive)?;
        primitives.memory.take(key.len() + 128, 1)?;
        self.geometries.insert(key, read.clone());
        Ok(read)
    }
}

/// What of a primitive makes its geometry: primitives that agree in it share one, whatever their material.
fn geometry_key(primitive: &Value) -> String {
    let part = |key: &str| primitive.get(key).map_or(String::new(), Value::to_string);
    ["attributes", "indices", "mode", "extensions"].map(part).join(";")
}

fn check_asset(root: &At<'_>) -> Result<(), Box<Fault>> {
    let asset = root.require("asset")?;
    let version = asset.require("version")?;
    let least = asset.get("minVersion")?;
    for said in [Some(&version), least.as_ref()].into_iter().flatten() {
        let text = said.text()?;
        let supported = text
            .split_once('.')
            .is_some_and(|(major, minor)| major == "2" && (said.path == version.path || minor == "0"));
        if !supported {
            let fault = said.fault("E-gltf-version", quoted(text.as_bytes()), "version 2.0");
            return Err(fault.category(Category::Unsupported));
        }
    }
    if let Some(required) = root.get("extensionsRequired")?
        && let Some(extension) = required.elements()?.next()
    {
        let found = quoted(extension.text()?.as_bytes());
        return Err(extension
            .fault("E-gltf-extension", found, "no extension that a reader must know")
            .category(Category::Unsupported)
            .advice("write the file anew with another program, without this extension"));
    }
    Ok(())
}

/// What shapes have no place for, by the lists of the document.
fn document_losses(root: &At<'_>) -> Result<Losses, Box<Fault>> {
    let mut losses = Losses::default();
    for (list, why) in [("animations", "shapes do not move"), ("cameras", "shapes have no cameras")] {
        let count = root.count(list)?;
        if count > 0 {
            losses.push(format!("{count} {list}"), why);
        }
    }
    let scenes = root.count("scenes")?;
    if scenes > 1 {
        losses.push(format!("{} other scenes", scenes - 1), "a shape is one scene: the one that the file shows");
    }
    Ok(losses)
}
