//! The bytes behind a document's buffers.

use std::borrow::Cow;
use std::collections::BTreeSet;

use shapeloom_core::{Category, Place};

use super::allowance::Allowance;
use super::base64;
use super::json::At;
use crate::memory::Memory;
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError, SiblingName};

/// A buffer, and where it starts in the file if it is a part of it.
pub(super) struct Buffer<'a> {
    bytes: Cow<'a, [u8]>,
    start: Option<usize>,
}

/// Finds every buffer: the binary chunk, data URIs, files beside the input.
pub(super) fn open<'a>(
    document: &At<'_>,
    bin: Option<(&'a [u8], usize)>,
    memory: &mut Memory<'_>,
    allowance: &mut Allowance,
    context: &ReadContext,
) -> Result<Vec<Buffer<'a>>, ReadError> {
    let mut buffers = Vec::new();
    let mut beside = BTreeSet::new();
    let Some(list) = document.get("buffers")? else {
        return Ok(buffers);
    };
    for (index, buffer) in list.elements()?.enumerate() {
        context.exec.check()?;
        let length = buffer.require("byteLength")?.count_value()?;
        let (bytes, start) = match (buffer.get("uri")?, bin) {
            (Some(uri), _) => {
                let is_new = beside.insert(uri.text()?);
                if !is_new {
                    allowance.take(usize::try_from(length).unwrap_or(usize::MAX), 1, &uri)?;
                }
                let bytes = from_uri(&uri, length, memory, context)?;
                if is_new && !uri.text()?.starts_with("data:") {
                    allowance.extend(bytes.len());
                }
                (Cow::Owned(bytes), None)
            }
            (None, Some((bytes, start))) if index == 0 => (Cow::Borrowed(bytes), Some(start)),
            (None, _) => {
                let fault = buffer.fault("E-gltf-buffer", "no address and no binary chunk", "bytes for the buffer");
                return Err(fault.into());
            }
        };
        if (bytes.len() as u64) < length {
            let found = format!("{} bytes", bytes.len());
            return Err(buffer.fault("E-gltf-buffer", found, format!("{length} as its byteLength says")).into());
        }
        buffers.push(Buffer { bytes, start });
    }
    Ok(buffers)
}

fn from_uri(uri: &At<'_>, length: u64, memory: &mut Memory<'_>, context: &ReadContext) -> Result<Vec<u8>, ReadError> {
    let address = uri.text()?;
    if let Some(data) = address.strip_prefix("data:") {
        let encoded = data.split_once(',').and_then(|(head, encoded)| head.ends_with(";base64").then_some(encoded));
        memory.take(encoded.map_or(0, str::len), 1)?;
        let decoded = encoded.and_then(|encoded| base64::decode(encoded.as_bytes()));
        return Ok(decoded.ok_or_else(|| uri.fault("E-gltf-uri", quoted(address.as_bytes()), "base64 data"))?);
    }
    let found = || quoted(address.as_bytes());
    let name = SiblingName::from_uri(address)
        .map_err(|_| uri.fault("E-sibling-path", found(), "the name of a file in the folder of the input"))?;
    let Some(siblings) = &context.siblings else {
        let fault = uri.fault("E-sibling-missing", found(), "a buffer inside the input, which is read alone");
        return Err(fault.category(Category::Unsupported).advice("read it by its path, or as one GLB file").into());
    };
    let most = length.min(context.limits.max_bytes);
    memory.take(usize::try_from(most).unwrap_or(usize::MAX), 1)?;
    // A file that is longer than the buffer is no error, but what the buffer does not declare is not read.
    context.exec.check()?;
    let opened = siblings.open(&name, most);
    Ok(opened.map_err(|error| uri.fault("E-sibling-missing", format!("{}: {error}", found()), "a readable file"))?)
}

/// Elements of equal size at equal distances, all of them within a buffer.
#[derive(Clone, Debug)]
pub(super) struct Strip<'a> {
    /// From the first element on.
    bytes: &'a [u8],
    /// Where the first element starts in its buffer, and where the buffer starts in the file if it is a part of it.
    in_buffer: usize,
    in_file: Option<usize>,
    stride: usize,
}

impl<'a> Strip<'a> {
    /// The `count` elements of `size` bytes at the byteOffset and in the bufferView of `holder`.
    pub fn open(
        document: &At<'_>,
        holder: &At<'_>,
        buffers: &'a [Buffer<'_>],
        count: u64,
        size: u64,
    ) -> Result<Self, Box<Fault>> {
        let view: View<'a> = view(document, &holder.require("bufferView")?, buffers)?;
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            let found = format!("a byteStride of {stride} in its view");
            return Err(holder.fault("E-gltf-bounds", found, format!("at least {size}, the size of an element")));
        }
        let offset = holder.count_or("byteOffset", 0)?;
        let (wide, len) = (u128::from, view.bytes.len());
        let end = wide(offset) + wide(count.saturating_sub(1)) * wide(stride) + wide(size);
        if end > len as u128 {
            let found = format!("{count} elements, which end at byte {end} of the view");
            return Err(holder.fault("E-gltf-bounds", found, format!("elements within the {len} bytes of the view")));
        }
        let (in_buffer, offset) = (view.in_buffer + offset as usize, offset as usize);
        Ok(Self { bytes: &view.bytes[offset..], in_buffer, in_file: view.in_file, stride: stride as usize })
    }

    /// The byte of its buffer at which an element starts.
    pub fn byte(&self, element: usize) -> usize {
        self.in_buffer + element * self.stride
    }

    /// The place in the file where an element starts, if the buffer is a part of the file.
    pub fn place(&self, element: usize) -> Place {
        self.in_file.map_or(Place::Whole, |start| Place::Byte((start + self.byte(element)) as u64))
    }

    /// A component of `N` bytes of an element.
    pub fn bytes<const N: usize>(&self, element: usize, component: usize) -> [u8; N] {
        let at = element * self.stride + component * N;
        // Opening checked the last element.
        self.bytes[at..at + N].try_into().unwrap_or([0; N])
    }
}

/// The bytes of a view, where they start in their buffer, where that starts in the file, and the distance of elements.
struct View<'a> {
    bytes: &'a [u8],
    in_buffer: usize,
    in_file: Option<usize>,
    stride: Option<u64>,
}

/// The view that `index` names.
fn view<'a>(document: &At<'_>, index: &At<'_>, buffers: &'a [Buffer<'_>]) -> Result<View<'a>, Box<Fault>> {
    let view = document.element("bufferViews", index)?;
    if view.value.pointer("/extensions/EXT_meshopt_compression").is_some() {
        return Err(view.fault("E-gltf-feature", "meshopt compression", "plain data").category(Category::Unsupported));
    }
    document.element("buffers", &view.require("buffer")?)?;
    let buffer = &buffers[view.require("buffer")?.count_value()? as usize];
    let offset = view.count_or("byteOffset", 0)?;
    let length = view.require("byteLength")?.count_value()?;
    let end = offset.checked_add(length).filter(|&end| end <= buffer.bytes.len() as u64);
    let Some(end) = end else {
        let found = format!("{length} bytes from byte {offset}");
        let expected = format!("a part of the {} bytes of the buffer", buffer.bytes.len());
        return Err(view.fault("E-gltf-bounds", found, expected));
    };
    let stride = view.get("byteStride")?.map(|stride| stride.count_value()).transpose()?;
    let bytes = &buffer.bytes[offset as usize..end as usize];
    Ok(View { bytes, in_buffer: offset as usize, in_file: buffer.start, stride })
}
