//! Implicit shapes in text: the shape language, and lists of arithmetic steps.
//!
//! The shape language is described in docs/formats/shape_language.md. Its texts may name files beside them: meshes, volumes and
//! curves become nodes of the tree. Lists of steps, `.vm`, are those of the program fidget: a line for each node, `name opcode
//! operands`, the last one the result.

mod foreign;
mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// The shape language. Its texts have no mark: they are told by their extension.
pub(crate) const SHAPE: Format = Format {
    id: "shape",
    name: "Shape language",
    extensions: &["shape"],
    media_type: "text/plain",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::Implicit],
    keeps: &[],
    read_options: &[],
    write_options: &[],
    sniff: |_| Sniff::No,
    reads: Some(read::shape),
    writes: Some(write::shape),
};

/// Lists of steps.
pub(crate) const VM: Format = Format {
    id: "vm",
    name: "Lists of arithmetic steps",
    extensions: &["vm"],
    media_type: "text/plain",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::Implicit],
    keeps: &[],
    read_options: &[],
    write_options: &[],
    sniff: sniff_vm,
    reads: Some(read::vm),
    writes: Some(write::vm),
};

/// The first line that is no comment gives a name to a number or a coordinate: nothing else can stand there.
fn sniff_vm(input: &[u8]) -> Sniff {
    let head = crate::detect::head(input);
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
    let mut words =
        first.into_iter().flat_map(|line| line.split(u8::is_ascii_whitespace)).filter(|word| !word.is_empty());
    match (words.next(), words.next()) {
        (Some(_), Some(b"const" | b"var-x" | b"var-y" | b"var-z")) => Sniff::Likely,
        _ => Sniff::No,
    }
}
