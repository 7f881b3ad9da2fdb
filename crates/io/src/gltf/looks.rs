//! Materials of a file that is written.

use std::collections::HashMap;

use serde_json::Value;
use shapeloom_shape::Material;

use super::bin::{array, object};
use crate::SiblingName;
use crate::placed::Losses;

/// Materials, textures and images: first those of the shape in their order, then those that only parts of it ask for.
pub(super) struct Looks<'s> {
    given: &'s [Material],
    /// The first of the shape's materials with each name.
    first: HashMap<&'s str, u32>,
    materials: Vec<Value>,
    textures: Vec<Value>,
    images: Vec<Value>,
    /// Materials without properties, by name.
    plain: HashMap<String, u32>,
    /// Materials of the shape without their texture.
    bare: HashMap<u32, u32>,
    /// The texture of each material of the shape.
    texture_of: Vec<Option<u32>>,
}

impl<'s> Looks<'s> {
    pub fn new(given: &'s [Material], losses: &mut Losses) -> Self {
        let mut looks = Self {
            given,
            first: HashMap::with_capacity(given.len()),
            materials: Vec::new(),
            textures: Vec::new(),
            images: Vec::new(),
            plain: HashMap::new(),
            bare: HashMap::new(),
            texture_of: Vec::new(),
        };
        let mut known: HashMap<String, u32> = HashMap::new();
        for (number, material) in given.iter().enumerate() {
            looks.first.entry(&material.name).or_insert(number as u32);
            let uri = material.texture.as_deref().and_then(|name| {
                let uri = uri_of(name);
                if uri.is_none() {
                    let why = "glTF names pictures in the folder of the file or below";
                    losses.push(format!("texture \"{name}\""), why);
                }
                uri
            });
            let texture = uri.map(|uri| {
                *known.entry(uri).or_insert_with_key(|uri| {
                    let image = looks.images.len();
                    looks.images.push(object([("uri", uri.as_str().into())]));
                    looks.textures.push(object([("source", image.into())]));
                    image as u32
                })
            });
            looks.texture_of.push(texture);
            looks.materials.push(to_json(material, texture));
        }
        looks
    }

    /// The material of that name: the first of the shape's, or else one that has nothing but the name.
    pub fn named(&mut self, name: &str) -> u32 {
        if let Some(&given) = self.first.get(name) {
            return given;
        }
        let materials = &mut self.materials;
        *self.plain.entry(name.to_owned()).or_insert_with(|| {
            materials.push(to_json(&Material { name: name.to_owned(), ..Material::default() }, None));
            materials.len() as u32 - 1
        })
    }

    /// The material for a primitive without texture coordinates, which may have no texture: the same, or a copy without.
    pub fn without_texture(&mut self, material: u32, losses: &mut Losses) -> u32 {
        let at = material as usize;
        if self.texture_of.get(at).copied().flatten().is_none() {
            return material;
        }
        let name = self.given[at].texture.as_deref().unwrap_or_default();
        let why = "glTF allows none there: the material is written once more without it";
        losses.push(format!("texture \"{name}\" where a part has no texture coordinates"), why);
        let materials = &mut self.materials;
        *self.bare.entry(material).or_insert_with(|| {
            materials.push(to_json(&self.given[at], None));
            materials.len() as u32 - 1
        })
    }

    /// The members of the document.
    pub fn into_members(self) -> [(&'static str, Value); 3] {
        [("materials", array(self.materials)), ("textures", array(self.textures)), ("images", array(self.images))]
    }
}

/// A material as glTF has it: numbers that are no colour or fraction are put into range.
fn to_json(material: &Material, texture: Option<u32>) -> Value {
    // Clamping leaves NaN; the maximum makes it 0.
    let fraction = |value: f32| f64::from(value.clamp(0.0, 1.0).max(0.0));
    let alpha = material.base_color[3];
    object([
        ("name", if material.name.is_empty() { Value::Null } else { material.name.as_str().into() }),
        (
            "pbrMetallicRoughness",
            object([
                ("baseColorFactor", material.base_color.map(fraction).to_vec().into()),
                ("baseColorTexture", texture.map_or(Value::Null, |texture| object([("index", texture.into())]))),
                ("metallicFactor", fraction(material.metallic).into()),
                ("roughnessFactor", fraction(material.roughness).into()),
            ]),
        ),
        ("doubleSided", if material.double_sided { true.into() } else { Value::Null }),
        ("alphaMode", if alpha < 1.0 { "BLEND".into() } else { Value::Null }),
    ])
}

/// The URI of a file in the folder of the document (RFC 3986); none for a name that leaves it.
fn uri_of(name: &str) -> Option<String> {
    let name = SiblingName::try_new(name).ok()?;
    let mut uri = String::new();
    for &byte in name.as_str().as_bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri += &format!("%{byte:02X}");
        }
    }
    Some(uri)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_survive_as_addresses() {
        for name in ["brick.png", "a b/ü 100%.png", "%20.png", "q?#&.jpg", "100%25"] {
            let uri = uri_of(name).unwrap();
            assert!(uri.is_ascii() && !uri.contains([' ', '?', '#']), "{uri}");
            assert_eq!(SiblingName::from_uri(&uri).unwrap().as_str(), name);
        }
        assert_eq!(uri_of("a b.png").unwrap(), "a%20b.png");
        for name in ["../a.png", "/a.png", "http://a/b.png", ""] {
            assert_eq!(uri_of(name), None, "{name}");
        }
    }

    #[test]
    fn many_materials_are_found_in_no_time_in_proportion_to_their_square() {
        let given: Vec<Material> =
            (0..100_000).map(|i| Material { name: format!("m{}", i % 99_999), ..Material::default() }).collect();
        let mut looks = Looks::new(&given, &mut Losses::default());
        for number in (0..99_999).rev() {
            assert_eq!(looks.named(&format!("m{number}")), number);
        }
        assert_eq!(looks.materials.len(), 100_000);
    }

    #[test]
    fn materials_are_added_once_and_after_those_of_the_shape() {
        let given = ["a.png", "a.png", "../b.png"].map(|texture| Material {
            name: texture[..1].into(),
            texture: Some(texture.into()),
            ..Material::default()
        });
        let mut losses = Losses::default();
        let mut looks = Looks::new(&given, &mut losses);
        assert_eq!((looks.named("oak"), looks.named("a"), looks.named("oak"), looks.named("elm")), (3, 0, 3, 4));
        assert_eq!([1, 2, 3, 1].map(|material| looks.without_texture(material, &mut losses)), [5, 2, 3, 5]);
        assert_eq!((looks.materials.len(), looks.textures.len(), looks.images.len()), (6, 1, 1));
        let whats: Vec<String> = losses.into_vec().into_iter().map(|loss| loss.what).collect();
        assert_eq!(whats, ["texture \"../b.png\"", "texture \"a.png\" where a part has no texture coordinates"]);
    }
}
