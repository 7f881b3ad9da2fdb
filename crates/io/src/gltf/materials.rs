//! Materials of a file.

use std::collections::BTreeSet;

use shapeloom_shape::Material;

use super::allowance::Allowance;
use super::ignored::Ignored;
use super::json::At;
use crate::memory::Memory;
use crate::placed::Losses;
use crate::{Fault, ReadError, SiblingName};

/// The materials of a document, with the defaults of glTF: white, metal, rough.
///
/// Of textures only the name of the file of the base colour is kept; what else materials say is named as lost.
pub(super) fn read<'j>(
    document: &At<'j>,
    memory: &mut Memory<'_>,
    allowance: &mut Allowance,
    losses: &mut Losses,
    ignored: &mut Ignored<'j>,
) -> Result<Vec<Material>, ReadError> {
    let mut materials = Vec::new();
    let mut kept = BTreeSet::new();
    if let Some(list) = document.get("materials")? {
        for material in list.elements()? {
            memory.take(1, 2 * size_of::<Material>())?;
            let read = from_json(&material, document, &mut kept)?;
            if let Some(name) = &read.texture {
                // Many materials may name the same one.
                allowance.take(name.len(), 1, &material)?;
                memory.take(name.len(), 1)?;
            }
            materials.push(read);
            unread(&material, losses)?;
            passed_over(&material, ignored)?;
        }
    }
    let lost = document.count("textures")?.saturating_sub(kept.len());
    if lost > 0 {
        let why =
            "of textures only the file name of the base colour is kept, and pictures inside the file are not read";
        losses.push(format!("{lost} textures"), why);
    }
    Ok(materials)
}

fn from_json(material: &At<'_>, document: &At<'_>, kept: &mut BTreeSet<u64>) -> Result<Material, Box<Fault>> {
    let mut read = Material { metallic: 1.0, ..Material::default() };
    if let Some(name) = material.get("name")? {
        read.name = name.text()?.to_owned();
    }
    if let Some(sided) = material.get("doubleSided")? {
        read.double_sided = sided.flag()?;
    }
    let Some(rough) = material.get("pbrMetallicRoughness")? else {
        return Ok(read);
    };
    if let Some(color) = rough.get("baseColorFactor")? {
        read.base_color = color.numbers::<4>()?.map(|value| value as f32);
    }
    if let Some(metallic) = rough.get("metallicFactor")? {
        read.metallic = metallic.number()? as f32;
    }
    if let Some(roughness) = rough.get("roughnessFactor")? {
        read.roughness = roughness.number()? as f32;
    }
    if let Some(texture) = rough.get("baseColorTexture")? {
        let index = texture.require("index")?;
        read.texture = file_of(&document.element("textures", &index)?, document)?;
        if read.texture.is_some() {
            kept.insert(index.count_value()?);
        }
    }
    Ok(read)
}

/// The name of the file that a texture is in; none for one that is inside the document.
fn file_of(texture: &At<'_>, document: &At<'_>) -> Result<Option<String>, Box<Fault>> {
    let Some(source) = texture.get("source")? else { return Ok(None) };
    let Some(address) = document.element("images", &source)?.get("uri")? else { return Ok(None) };
    let address = address.text()?;
    if address.starts_with("data:") {
        return Ok(None);
    }
    // It is not opened, so that one outside of the folder does no harm as a mere name.
    Ok(Some(SiblingName::from_uri(address).map_or(address.to_owned(), |name| name.as_str().to_owned())))
}

/// Takes down what a material has for other readers, and where its texture is looked up.
fn passed_over<'j>(material: &At<'j>, ignored: &mut Ignored<'j>) -> Result<(), Box<Fault>> {
    ignored.of("materials", material);
    let Some(rough) = material.get("pbrMetallicRoughness")? else { return Ok(()) };
    ignored.of("materials", &rough);
    let Some(texture) = rough.get("baseColorTexture")? else { return Ok(()) };
    ignored.of("textures of materials", &texture);
    if texture.count_or("texCoord", 0)? > 0 {
        ignored.texcoord();
    }
    Ok(())
}

/// Names what a material says beyond what shapes keep.
fn unread(material: &At<'_>, losses: &mut Losses) -> Result<(), Box<Fault>> {
    for (key, what) in [
        ("normalTexture", "normal textures"),
        ("occlusionTexture", "occlusion textures"),
        ("emissiveTexture", "emissive textures"),
    ] {
        if material.get(key)?.is_some() {
            losses.push(what, "materials of shapes have no place for them");
        }
    }
    if let Some(factor) = material.get("emissiveFactor")?
        && factor.numbers::<3>()? != [0.0; 3]
    {
        losses.push("emissive colours", "materials of shapes have no place for them");
    }
    if material.get("alphaMode")?.is_some_and(|mode| mode.value == "MASK") {
        losses.push("alpha masks", "materials of shapes have no place for them");
    }
    Ok(())
}
