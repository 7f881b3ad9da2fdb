//! Typed views of a buffer.

use shapeloom_core::{Category, Limits, Place};

use super::bin::{BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use super::buffers::{Buffer, Strip};
use super::json::At;
use super::sparse::Sparse;
use crate::Fault;

/// What a document says of an accessor, before its bytes are looked for.
pub(super) struct Declared<'a> {
    at: At<'a>,
    /// The component type by its number in glTF.
    pub component_type: u64,
    pub width: usize,
    pub count: u64,
    normalized: bool,
}

impl<'a> Declared<'a> {
    /// The accessor that `index` names.
    pub fn read(document: &At<'a>, index: &At<'_>) -> Result<Self, Box<Fault>> {
        let at = document.element("accessors", index)?;
        let component_type = at.require("componentType")?;
        let number = component_type.count_value()?;
        if component_size(number).is_none() {
            return Err(component_type.fault("E-gltf-type", number.to_string(), "a component type of glTF"));
        }
        let kind = at.require("type")?;
        let width = match kind.text()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => {
                let found = crate::text::quoted(other.as_bytes());
                return Err(kind.fault("E-gltf-type", found, "SCALAR, VEC2, VEC3 or VEC4"));
            }
        };
        let count = at.require("count")?;
        if count.count_value()? == 0 {
            return Err(count.fault("E-gltf-count", "0", "a number from 1"));
        }
        let normalized = at.get("normalized")?.map_or(Ok(false), |flag| flag.flag())?;
        let count = count.count_value()?;
        Ok(Self { at, component_type: number, width, count, normalized })
    }

    /// An error about the accessor, or its member `key`.
    pub fn fault(&self, key: Option<&str>, code: &'static str, found: String, expected: &str) -> Box<Fault> {
        let path = key.map_or(self.at.path.clone(), |key| self.at.child(key));
        Fault::new(code, Place::Whole, found, expected).within(path)
    }

    /// The accessor with its bytes. The count is checked against those that are there.
    pub fn open(
        self,
        document: &At<'_>,
        buffers: &'a [Buffer<'_>],
        limits: &Limits,
    ) -> Result<Accessor<'a>, Box<Fault>> {
        let size = component_size(self.component_type).unwrap_or(4) * self.width as u64;
        let base = match self.at.get("bufferView")? {
            Some(_) => Some(Strip::open(document, &self.at, buffers, self.count, size)?),
            None => None,
        };
        if self.count > limits.max_elements {
            let expected = format!("at most {}", limits.max_elements);
            let fault = self.fault(Some("count"), "E-gltf-limit", self.count.to_string(), &expected);
            return Err(fault.category(Category::OverLimit));
        }
        let sparse = self.at.get("sparse")?;
        let sparse = sparse.map(|sparse| Sparse::open(document, &sparse, buffers, self.count, size)).transpose()?;
        Ok(Accessor {
            count: self.count as usize,
            path: self.at.path,
            component_type: self.component_type,
            width: self.width,
            normalized: self.normalized,
            base,
            sparse,
        })
    }
}

/// Whether the accessor that `index` names says that its elements are matrices.
pub(super) fn is_matrix(document: &At<'_>, index: &At<'_>) -> Result<bool, Box<Fault>> {
    let kind = document.element("accessors", index)?.require("type")?;
    Ok(matches!(kind.text()?, "MAT2" | "MAT3" | "MAT4"))
}

/// The bytes of a component.
pub(super) fn component_size(component_type: u64) -> Option<u64> {
    match component_type {
        BYTE | UNSIGNED_BYTE => Some(1),
        SHORT | UNSIGNED_SHORT => Some(2),
        UNSIGNED_INT | FLOAT => Some(4),
        _ => None,
    }
}

/// Elements of 1 to 4 numbers: within a buffer, or replaced one by one by those of a sparse list, or zero.
#[derive(Clone, Debug)]
pub(super) struct Accessor<'a> {
    /// The path in the document.
    pub path: String,
    /// The component type by its number in glTF.
    pub component_type: u64,
    pub width: usize,
    pub count: usize,
    normalized: bool,
    base: Option<Strip<'a>>,
    sparse: Option<Sparse<'a>>,
}

/// How many elements are taken for zeros without one in the file, and how many more for each that a sparse list has: far
/// above what files do that leave out zeros, and too few to fill memory from a few bytes.
const ZEROS: usize = 1 << 16;
const ZEROS_FOR_EACH: usize = 1 << 10;

impl Accessor<'_> {
    /// Refuses elements that are nearly all nowhere in the file: memory would be spent on a mere claim.
    pub fn expect_backed(&self) -> Result<(), Box<Fault>> {
        let stored = self.sparse.as_ref().map_or(0, Sparse::len);
        let most = ZEROS.saturating_add(stored.saturating_mul(ZEROS_FOR_EACH));
        if self.base.is_some() || self.count <= most {
            return Ok(());
        }
        let found = format!("{} elements, of which {stored} are in the file", self.count);
        let fault = self.fault("count", "E-gltf-limit", found, &format!("at most {most} where the others are zeros"));
        Err(fault.category(Category::OverLimit))
    }

    /// Where an element stands, and as which one there; none for a zero.
    fn stored(&self, element: usize) -> Option<(&Strip<'_>, usize)> {
        let replaced = self.sparse.as_ref().and_then(|sparse| Some((&sparse.values, sparse.find(element)?)));
        replaced.or_else(|| Some((self.base.as_ref()?, element)))
    }

    /// The place in the file where an element starts, if the buffer is a part of the file.
    pub fn place(&self, element: usize) -> Place {
        self.stored(element).map_or(Place::Whole, |(strip, at)| strip.place(at))
    }

    /// The byte of its buffer at which an element starts.
    pub fn byte(&self, element: usize) -> Option<usize> {
        self.stored(element).map(|(strip, at)| strip.byte(at))
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
        match (&self.base, &self.sparse) {
            // Nearly all accessors are so, and large.
            (Some(base), None) => base.bytes(element, component),
            _ => self.stored(element).map_or([0; N], |(strip, at)| strip.bytes(at, component)),
        }
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
        Fault::new(code, Place::Whole, found, expected).within(format!("{}/{key}", self.path))
    }
}
