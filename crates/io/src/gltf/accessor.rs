//! Typed views of a buffer.

use shapeloom_core::{Category, Limits, Place};

use super::bin::{BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use super::buffers::{self, Buffer, View};
use super::json::At;
use crate::Fault;

/// Elements of 1 to 4 numbers, all of them within the buffer.
#[derive(Clone, Debug)]
pub(super) struct Accessor<'a> {
    /// The path in the document.
    pub path: String,
    /// The component type by its number in glTF.
    pub component_type: u64,
    pub width: usize,
    pub count: usize,
    normalized: bool,
    bytes: &'a [u8],
    start: usize,
    stride: usize,
    in_file: Place,
}

impl<'a> Accessor<'a> {
    /// The accessor that `index` names. Its count is checked against the bytes that are there.
    pub fn open(
        document: &At<'_>,
        index: &At<'_>,
        buffers: &'a [Buffer<'_>],
        limits: &Limits,
    ) -> Result<Self, Box<Fault>> {
        let at = document.element("accessors", index)?;
        if let Some(sparse) = at.get("sparse")? {
            return Err(unsupported(&sparse, "a sparse accessor", "an accessor with all of its values"));
        }
        let component_type = at.require("componentType")?;
        let size = match component_type.count_value()? {
            BYTE | UNSIGNED_BYTE => 1u64,
            SHORT | UNSIGNED_SHORT => 2,
            UNSIGNED_INT | FLOAT => 4,
            other => return Err(component_type.fault("E-gltf-type", other.to_string(), "a component type of glTF")),
        };
        let kind = at.require("type")?;
        let width = match kind.text()? {
            "SCALAR" => 1u64,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => {
                let found = crate::text::quoted(other.as_bytes());
                return Err(kind.fault("E-gltf-type", found, "SCALAR, VEC2, VEC3 or VEC4"));
            }
        };
        let count_at = at.require("count")?;
        let count = count_at.count_value()?;
        if count == 0 {
            return Err(count_at.fault("E-gltf-count", "0", "a number from 1"));
        }
        let Some(view) = at.get("bufferView")? else {
            return Err(unsupported(&at, "no bufferView, which stands for zeros", "an accessor with a bufferView"));
        };
        let view: View<'a> = buffers::view(document, &view, buffers)?;
        let stride = view.stride.unwrap_or(size * width);
        if stride < size * width {
            let found = format!("a byteStride of {stride} in its view");
            return Err(at.fault("E-gltf-bounds", found, format!("at least {}, the size of an element", size * width)));
        }
        let offset = at.count_or("byteOffset", 0)?;
        let (wide, len) = (u128::from, view.bytes.len());
        let end = wide(offset) + wide(count - 1) * wide(stride) + wide(size * width);
        if end > len as u128 {
            let found = format!("{count} elements, which end at byte {end} of the view");
            return Err(count_at.fault("E-gltf-bounds", found, format!("elements within the {len} bytes of the view")));
        }
        if count > limits.max_elements {
            let fault = count_at.fault("E-gltf-limit", count.to_string(), format!("at most {}", limits.max_elements));
            return Err(fault.category(Category::OverLimit));
        }
        let normalized = at.get("normalized")?.map_or(Ok(false), |flag| flag.flag())?;
        Ok(Self {
            path: at.path,
            component_type: component_type.count_value()?,
            width: width as usize,
            count: count as usize,
            normalized,
            bytes: view.bytes,
            start: offset as usize,
            stride: stride as usize,
            in_file: view.place(offset as usize),
        })
    }

    /// The place in the file where an element starts, if the buffer is a part of the file.
    pub fn place(&self, element: usize) -> Place {
        match self.in_file {
            Place::Byte(start) => Place::Byte(start + (element * self.stride) as u64),
            _ => Place::Whole,
        }
    }

    /// Whether the numbers are in single precision.
    pub fn is_float(&self) -> bool {
        self.component_type == FLOAT
    }

    /// Whether whole numbers stand for fractions.
    pub fn is_fraction(&self) -> bool {
        self.normalized && !self.is_float()
    }

    fn bytes<const N: usize>(&self, element: usize, component: usize) -> [u8; N] {
        let at = self.start + element * self.stride + component * N;
        // Opening checked the last element.
        self.bytes[at..at + N].try_into().unwrap_or([0; N])
    }

    /// A number as it is stored.
    pub fn number(&self, element: usize, component: usize) -> f64 {
        match self.component_type {
            BYTE => f64::from(i8::from_le_bytes(self.bytes(element, component))),
            UNSIGNED_BYTE => f64::from(u8::from_le_bytes(self.bytes(element, component))),
            SHORT => f64::from(i16::from_le_bytes(self.bytes(element, component))),
            UNSIGNED_SHORT => f64::from(u16::from_le_bytes(self.bytes(element, component))),
            UNSIGNED_INT => f64::from(u32::from_le_bytes(self.bytes(element, component))),
            _ => f64::from(f32::from_le_bytes(self.bytes(element, component))),
        }
    }

    /// A number, or the fraction for which it stands.
    pub fn fraction(&self, element: usize, component: usize) -> f64 {
        let number = self.number(element, component);
        if !self.is_fraction() {
            return number;
        }
        match self.component_type {
            BYTE => (number / 127.0).max(-1.0),
            UNSIGNED_BYTE => number / 255.0,
            SHORT => (number / 32767.0).max(-1.0),
            UNSIGNED_SHORT => number / 65535.0,
            _ => number / f64::from(u32::MAX),
        }
    }

    /// An element as an index.
    pub fn index(&self, element: usize) -> u32 {
        match self.component_type {
            UNSIGNED_BYTE => u32::from(u8::from_le_bytes(self.bytes(element, 0))),
            UNSIGNED_SHORT => u32::from(u16::from_le_bytes(self.bytes(element, 0))),
            _ => u32::from_le_bytes(self.bytes(element, 0)),
        }
    }

    /// All numbers, element by element.
    pub fn all<T>(&self, number: impl Fn(usize, usize) -> T) -> Vec<T> {
        let number = &number;
        (0..self.count).flat_map(|element| (0..self.width).map(move |component| number(element, component))).collect()
    }

    /// An error about the member `key`.
    pub fn fault(&self, key: &str, code: &'static str, found: String, expected: &str) -> Box<Fault> {
        Fault::new(code, Place::Whole, found, expected).within(format!("{}.{key}", self.path))
    }
}

fn unsupported(at: &At<'_>, found: &str, expected: &str) -> Box<Fault> {
    at.fault("E-gltf-feature", found, expected)
        .category(Category::Unsupported)
        .advice("write the file anew with another program, without this feature")
}
