//! What readers may pass over, and this one does.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use shapeloom_core::Loss;

use super::json::At;

/// How many extensions are named one by one; files have a handful.
const NAMED: usize = 64;

/// Extensions and extra data that were passed over, each by what it is and where such things stand.
#[derive(Default)]
pub(super) struct Ignored<'j> {
    extensions: BTreeSet<(&'static str, &'j str)>,
    extras: BTreeSet<&'static str>,
    /// Names of meshes whose nodes have another, by the numbers of the meshes.
    names: BTreeMap<u64, &'j str>,
    /// Whether the base colour of a material looks up another than the first set of coordinates.
    texcoord: bool,
}

impl<'j> Ignored<'j> {
    /// Takes down what `value`, one of the `kind`, has of them.
    pub fn of(&mut self, kind: &'static str, value: &At<'j>) {
        if let Some(extensions) = value.value.get("extensions").and_then(Value::as_object) {
            self.extensions.extend(extensions.keys().map(|key| (kind, key.as_str())));
        }
        if value.value.get("extras").is_some() {
            self.extras.insert(kind);
        }
    }

    /// The mesh with that number has a name, and a node with it has another.
    pub fn name(&mut self, mesh: u64, name: &'j str) {
        self.names.insert(mesh, name);
    }

    /// The base colour of a material looks up another than the first set of coordinates.
    pub fn texcoord(&mut self) {
        self.texcoord = true;
    }

    pub fn into_losses(self) -> Vec<Loss> {
        let mut losses = Vec::new();
        for (kind, key) in self.extensions.iter().take(NAMED) {
            losses.push(Loss::new(format!("extension {key} of {kind}"), "it is not read"));
        }
        if let Some(more) = self.extensions.len().checked_sub(NAMED).filter(|&more| more > 0) {
            losses.push(Loss::new(format!("{more} more extensions"), "they are not read"));
        }
        let extras = self.extras.iter().map(|kind| format!("extras of {kind}"));
        losses.extend(extras.map(|what| Loss::new(what, "data of other programs has no place in shapes")));
        if let Some(first) = self.names.values().next() {
            let count = self.names.len();
            let what = if count == 1 { format!("mesh name \"{first}\"") } else { format!("names of {count} meshes") };
            let first = if count == 1 { String::new() } else { format!("; the first is \"{first}\"") };
            losses.push(Loss::new(what, format!("parts have the names of their nodes{first}")));
        }
        if self.texcoord {
            let why = "textures of shapes are looked up by the first set";
            losses.push(Loss::new("sets of texture coordinates that textures name", why));
        }
        losses
    }
}
