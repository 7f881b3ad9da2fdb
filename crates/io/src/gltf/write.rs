//! Writing GLB and JSON.

use std::io::Write;

use shapeloom_core::Report;
use shapeloom_mesh::{Domain, MATERIAL, Values};
use shapeloom_shape::{Part, Shape};

use super::document::{Document, document};
use super::{GLB, GLTF, base64};
use crate::options::Instances;
use crate::placed::columns_of;
use crate::{WriteContext, WriteError};

const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BIN_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

pub(super) fn write_glb(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(working_bytes(shape, context))?;
    let Document { members, bytes, mut report } = document(shape, context, &GLB, flatten(context))?;
    let json = with_buffer(&members.to_string(), bytes.len(), "");
    let total = file_length(json.len() as u64, bytes.len() as u64)?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    for (chunk, tag, pad) in [(json.as_bytes(), JSON_CHUNK, b' '), (bytes.as_slice(), BIN_CHUNK, 0)] {
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
    report.figure("bytes", f64::from(total));
    Ok(report)
}

/// The same document as JSON that holds its buffer in base64.
pub(super) fn write_gltf(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    const MARK: char = '\n';
    let _memory = context.exec.reserve(working_bytes(shape, context))?;
    let Document { members, bytes, mut report } = document(shape, context, &GLTF, flatten(context))?;
    // JSON escapes line ends in its strings, so that there is no other.
    let json = with_buffer(&members.to_string(), bytes.len(), "data:application/octet-stream;base64,\n");
    let (before, after) = json.split_once(MARK).unwrap_or((&json, ""));
    out.write_all(before.as_bytes())?;
    if !after.is_empty() {
        // A multiple of three, so that only the last block is padded.
        for block in bytes.chunks(3 << 18) {
            context.exec.check()?;
            base64::encode(block, out)?;
        }
    }
    out.write_all(after.as_bytes())?;
    out.write_all(b"\n")?;
    let text = if after.is_empty() { 0 } else { bytes.len().div_ceil(3) * 4 };
    report.figure("bytes", (before.len() + text + after.len() + 1) as f64);
    Ok(report)
}

fn flatten(context: &WriteContext) -> bool {
    context.options.instances == Instances::Flatten
}

/// What the values and text of a primitive with its node and accessors take, and of a material, in bytes: measured.
const PRIMITIVE: u64 = 8 << 10;
const MATERIAL_BYTES: u64 = 2 << 10;

/// About the bytes of the file's buffer, and beside it split vertices and those of each material; and of the document.
fn working_bytes(shape: &Shape, context: &WriteContext) -> u64 {
    let written = if flatten(context) {
        shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).fold(0, u64::saturating_add)
    } else {
        shape.memory_bytes() as u64
    };
    let primitives =
        |part: &Part| match columns_of(&part.geometry, Domain::Face).and_then(|columns| columns.get(MATERIAL)) {
            Some(column) => match column.values() {
                Values::Text { names, .. } => names.len() as u64,
                _ => 1,
            },
            None => 1,
        };
    let primitives = shape.parts.iter().map(primitives).fold(0, u64::saturating_add);
    let document = primitives.saturating_mul(PRIMITIVE).saturating_add(shape.materials.len() as u64 * MATERIAL_BYTES);
    written.saturating_mul(3).saturating_add(document)
}

/// A document with its one buffer; glTF has no buffers without bytes.
fn with_buffer(document: &str, length: usize, uri: &str) -> String {
    let Some(open) = document.strip_suffix('}').filter(|_| length > 0) else {
        return document.to_owned();
    };
    let uri = if uri.is_empty() { String::new() } else { format!(",\"uri\":\"{uri}\"") };
    format!("{open},\"buffers\":[{{\"byteLength\":{length}{uri}}}]}}")
}

/// The length of the file, if its header can say it.
fn file_length(json: u64, bin: u64) -> Result<u32, WriteError> {
    let chunk = |length: u64| if length == 0 { 0 } else { 8 + length.next_multiple_of(4) };
    let found = 12 + chunk(json) + chunk(bin);
    let max = u64::from(u32::MAX);
    u32::try_from(found).map_err(|_| WriteError::TooLarge { format: GLB.id, what: "bytes", found, max })
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
    fn buffers_without_bytes_are_left_out() {
        assert_eq!(with_buffer("{\"a\":1}", 0, "data:"), "{\"a\":1}");
        assert_eq!(with_buffer("{\"a\":1}", 3, ""), "{\"a\":1,\"buffers\":[{\"byteLength\":3}]}");
    }
}
