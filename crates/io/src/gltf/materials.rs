//! Materials.

use serde_json::Value;
use shapeloom_shape::Material;

use super::bin::object;
use super::json::At;
use crate::Fault;

/// A material as glTF has it: numbers that are no colour or fraction are put into range.
pub(super) fn to_json(material: &Material) -> Value {
    // Clamping leaves NaN; the maximum makes it 0.
    let fraction = |value: f32| f64::from(value.clamp(0.0, 1.0).max(0.0));
    let alpha = material.base_color[3];
    object([
        ("name", if material.name.is_empty() { Value::Null } else { material.name.as_str().into() }),
        (
            "pbrMetallicRoughness",
            object([
                ("baseColorFactor", material.base_color.map(fraction).to_vec().into()),
                ("metallicFactor", fraction(material.metallic).into()),
                ("roughnessFactor", fraction(material.roughness).into()),
            ]),
        ),
        ("doubleSided", if material.double_sided { true.into() } else { Value::Null }),
        ("alphaMode", if alpha < 1.0 { "BLEND".into() } else { Value::Null }),
    ])
}

/// A material of a file, with the defaults of glTF: white, metal, rough.
pub(super) fn from_json(material: &At<'_>, document: &At<'_>) -> Result<Material, Box<Fault>> {
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
        let texture = document.element("textures", &texture.require("index")?)?;
        if let Some(source) = texture.get("source")? {
            let image = document.element("images", &source)?;
            let name = match image.get("name")? {
                Some(name) => Some(name),
                None => image.get("uri")?,
            };
            // A picture inside the file has a long address that is no name.
            let name = name.map(|name| name.text()).transpose()?.filter(|name| !name.starts_with("data:"));
            read.texture = name.map(str::to_owned);
        }
    }
    Ok(read)
}
