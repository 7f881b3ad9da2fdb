//! Materials.

/// How a part looks: what most formats can say.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name.
    pub name: String,
    /// Base colour, linear, red green blue alpha from 0 to 1.
    pub base_color: [f32; 4],
    /// From 0 for insulators to 1 for metals.
    pub metallic: f32,
    /// From 0 for mirrors to 1 for chalk.
    pub roughness: f32,
    /// The name of the base colour texture, if the file named one.
    pub texture: Option<String>,
    /// Whether back faces are meant to be seen.
    pub double_sided: bool,
}

impl Default for Material {
    /// A white, rough insulator without a name.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            metallic: 0.0,
            roughness: 1.0,
            texture: None,
            double_sided: false,
        }
    }
}
