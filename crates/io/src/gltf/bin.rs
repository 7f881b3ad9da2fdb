//! The binary buffer of a file that is written, with its views and accessors.

use serde_json::Value;

/// Component types by their numbers in glTF.
pub(super) const BYTE: u64 = 5120;
pub(super) const UNSIGNED_BYTE: u64 = 5121;
pub(super) const SHORT: u64 = 5122;
pub(super) const UNSIGNED_SHORT: u64 = 5123;
pub(super) const UNSIGNED_INT: u64 = 5125;
pub(super) const FLOAT: u64 = 5126;

const ARRAY_BUFFER: u64 = 34962;
const ELEMENT_ARRAY_BUFFER: u64 = 34963;

/// A JSON object without the members that are null. Keys are put in order here because the order of serde_json's maps
/// depends on features that other crates may turn on.
pub(super) fn object(members: impl IntoIterator<Item = (&'static str, Value)>) -> Value {
    let mut members: Vec<(&str, Value)> = members.into_iter().filter(|(_, value)| !value.is_null()).collect();
    members.sort_by_key(|(key, _)| *key);
    Value::Object(members.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

/// An array, or null if it is empty: glTF has no empty arrays.
pub(super) fn array(values: Vec<Value>) -> Value {
    if values.is_empty() { Value::Null } else { Value::Array(values) }
}

#[derive(Default)]
pub(super) struct Bin {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Bin {
    /// Vertex data in single precision; positions must say their box.
    pub fn floats(&mut self, width: usize, values: &[f32], is_position: bool) -> Value {
        let start = self.bytes.len();
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        let view = self.view(start, ARRAY_BUFFER, None);
        let (mut min, mut max) = (Value::Null, Value::Null);
        if is_position {
            let fold = |pick: fn(f32, f32) -> f32| {
                let along = |axis: usize| values.iter().skip(axis).step_by(width).copied().reduce(pick);
                Value::from((0..width).filter_map(along).map(f64::from).collect::<Vec<f64>>())
            };
            (min, max) = (fold(f32::min), fold(f32::max));
        }
        self.accessor(view, FLOAT, values.len() / width, type_name(width), min, max)
    }

    /// Vertex data in whole numbers of one or two bytes, each element padded to a multiple of four bytes.
    pub fn whole(
        &mut self,
        width: usize,
        component_type: u64,
        count: usize,
        at: impl Fn(usize, usize) -> f64,
    ) -> Value {
        let size = if matches!(component_type, BYTE | UNSIGNED_BYTE) { 1 } else { 2 };
        let stride = (width * size).next_multiple_of(4);
        let start = self.bytes.len();
        for element in 0..count {
            for component in 0..width {
                // The two's complement of the low bytes is the same for signed and unsigned types.
                let number = at(element, component) as i32;
                self.bytes.extend_from_slice(&number.to_le_bytes()[..size]);
            }
            self.bytes.resize(start + (element + 1) * stride, 0);
        }
        let view = self.view(start, ARRAY_BUFFER, Some(stride));
        self.accessor(view, component_type, count, type_name(width), Value::Null, Value::Null)
    }

    /// Indices below `vertex_count`, 16 bits where they fit without the largest number, which restarts primitives.
    pub fn indices(&mut self, indices: &[u32], vertex_count: usize) -> Value {
        let start = self.bytes.len();
        let short = vertex_count <= usize::from(u16::MAX);
        if short {
            self.bytes.extend(indices.iter().flat_map(|&index| (index as u16).to_le_bytes()));
        } else {
            self.bytes.extend(indices.iter().flat_map(|index| index.to_le_bytes()));
        }
        let view = self.view(start, ELEMENT_ARRAY_BUFFER, None);
        let component_type = if short { UNSIGNED_SHORT } else { UNSIGNED_INT };
        self.accessor(view, component_type, indices.len(), "SCALAR", Value::Null, Value::Null)
    }

    fn view(&mut self, start: usize, target: u64, stride: Option<usize>) -> Value {
        let length = self.bytes.len() - start;
        // Every view starts at a multiple of four: no component is wider.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(object([
            ("buffer", 0.into()),
            ("byteOffset", start.into()),
            ("byteLength", length.into()),
            ("byteStride", stride.map_or(Value::Null, Value::from)),
            ("target", target.into()),
        ]));
        (self.views.len() - 1).into()
    }

    fn accessor(&mut self, view: Value, component: u64, count: usize, of: &str, min: Value, max: Value) -> Value {
        self.accessors.push(object([
            ("bufferView", view),
            ("componentType", component.into()),
            ("count", count.into()),
            ("type", of.into()),
            ("min", min),
            ("max", max),
        ]));
        (self.accessors.len() - 1).into()
    }
}

fn type_name(width: usize) -> &'static str {
    ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_short_index_is_not_used() {
        let mut bin = Bin::default();
        let indices = [65_534, 0, 1];
        bin.indices(&indices, 65_535);
        bin.indices(&[65_535, 0, 1], 65_536);
        let types: Vec<&Value> = bin.accessors.iter().map(|accessor| &accessor["componentType"]).collect();
        assert_eq!(types, [&Value::from(UNSIGNED_SHORT), &Value::from(UNSIGNED_INT)]);
        // Six bytes of indices, two of padding, then twelve.
        assert_eq!((bin.views[1]["byteOffset"].as_u64(), bin.bytes.len()), (Some(8), 20));
    }

    #[test]
    fn whole_numbers_are_padded_element_by_element() {
        let mut bin = Bin::default();
        bin.whole(3, BYTE, 2, |element, component| [-1.0, 2.0, -128.0][component] + element as f64);
        assert_eq!(bin.bytes, [255, 2, 128, 0, 0, 3, 129, 0]);
        assert_eq!(bin.views[0]["byteStride"].as_u64(), Some(4));
        assert_eq!(bin.views[0]["byteLength"].as_u64(), Some(8));
    }

    #[test]
    fn positions_say_their_box() {
        let mut bin = Bin::default();
        bin.floats(3, &[1.0, 5.0, -2.0, 0.5, 6.0, -3.0], true);
        assert_eq!(bin.accessors[0]["min"], Value::from(vec![0.5, 5.0, -3.0]));
        assert_eq!(bin.accessors[0]["max"], Value::from(vec![1.0, 6.0, -2.0]));
    }

    #[test]
    fn objects_are_in_order_without_nulls() {
        let value = object([("b", 1.into()), ("n", Value::Null), ("a", array(vec![]))]);
        assert_eq!(value.to_string(), r#"{"b":1}"#);
    }
}
