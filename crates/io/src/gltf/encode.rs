//! Attribute columns as glTF attributes.

use serde_json::{Map, Value};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, TEXCOORD, Values};

use super::bin::{BYTE, Bin, SHORT, UNSIGNED_BYTE, UNSIGNED_SHORT};
use super::split::NO_WEDGE;
use crate::color::linear;
use crate::placed::Losses;

/// Where the values of a file's vertices stand in a column.
#[derive(Clone, Copy)]
pub(super) enum Elements<'a> {
    /// In the same order.
    Same(usize),
    /// At these elements; none for [`NO_WEDGE`].
    At(&'a [u32]),
}

impl Elements<'_> {
    fn len(self) -> usize {
        match self {
            Self::Same(len) => len,
            Self::At(elements) => elements.len(),
        }
    }

    fn get(self, index: usize) -> Option<usize> {
        match self {
            Self::Same(_) => Some(index),
            Self::At(elements) => Some(elements[index]).filter(|&element| element != NO_WEDGE).map(|e| e as usize),
        }
    }
}

/// A column with the place of each vertex's value in it.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub domain: Domain,
    pub column: &'a Column,
    pub elements: Elements<'a>,
}

/// Writes columns as attributes of one primitive, and says what does not fit.
pub(super) struct Encoder<'a> {
    pub bin: &'a mut Bin,
    pub losses: &'a mut Losses,
    pub findings: &'a mut Findings,
    /// Normals for vertices whose own has no direction.
    pub spare_normals: &'a dyn Fn() -> Option<Vec<DVec3>>,
}

impl Encoder<'_> {
    pub fn column(&mut self, attributes: &mut Map<String, Value>, source: Source<'_>) {
        let column = source.column;
        let floating = matches!(column.values(), Values::F32(_) | Values::F64(_));
        let (name, accessor) = match (column.name(), column.width()) {
            (NORMAL, 3) if floating => ("NORMAL".to_owned(), self.normals(source)),
            (TEXCOORD, 2) if floating => ("TEXCOORD_0".to_owned(), Some(self.texcoords(source))),
            (COLOR, 3 | 4) => ("COLOR_0".to_owned(), self.colors(source)),
            (name, 1..=4) => (format!("_{name}"), self.custom(source)),
            (name, width) => {
                self.losses.column(source.domain, name, format!("glTF attributes have 1 to 4 numbers, not {width}"));
                return;
            }
        };
        if let Some(accessor) = accessor {
            attributes.insert(name, accessor);
        }
    }

    fn normals(&mut self, source: Source<'_>) -> Option<Value> {
        let count = source.elements.len();
        let mut values = Vec::with_capacity(count * 3);
        let mut spare = None;
        let mut rounded = false;
        for vertex in 0..count {
            let normal = source.elements.get(vertex).map_or(DVec3::ZERO, |element| source.column.vector(element));
            let unit = match unit(normal) {
                Some(unit) => unit,
                None => {
                    let spare = spare.get_or_insert_with(self.spare_normals);
                    let Some(normals) = spare else {
                        let why = format!("vertex {vertex} has a normal without direction, which glTF does not allow");
                        self.losses.column(source.domain, source.column.name(), why);
                        return None;
                    };
                    self.findings.push(
                        "W-glb-normal",
                        Severity::Note,
                        Place::element("vertex", vertex as u64),
                        "normals without direction were replaced by that of a facet, or by z where no facet has one",
                    );
                    unit(normals[vertex]).unwrap_or([0.0, 0.0, 1.0])
                }
            };
            rounded |= DVec3::from_array(unit.map(f64::from)) != normal;
            values.extend_from_slice(&unit);
        }
        self.note_rounding(rounded, source);
        Some(self.bin.floats(3, &values, false))
    }

    fn texcoords(&mut self, source: Source<'_>) -> Value {
        let at = |element: usize, component: usize| {
            let value = source.column.number(element, component);
            if component == 1 { 1.0 - value } else { value }
        };
        self.rounded(source, 2, at)
    }

    fn colors(&mut self, source: Source<'_>) -> Option<Value> {
        let column = source.column;
        let whole = match column.values() {
            Values::F32(_) | Values::F64(_) => None,
            Values::U8(_) => Some(f64::from(u8::MAX)),
            Values::U16(_) => Some(f64::from(u16::MAX)),
            other => {
                let why = format!("colours of type {} have no known range", other.type_name());
                self.losses.column(source.domain, column.name(), why);
                return None;
            }
        };
        if let Some(largest) = whole {
            let message = "colours in whole numbers were taken as sRGB and written linear, as glTF has them";
            self.findings.push("W-glb-color", Severity::Note, Place::Whole, message);
            let at = |element: usize, component: usize| {
                let value = column.number(element, component) / largest;
                if component < 3 { linear(value) } else { value }
            };
            // Linear single precision tells all 2¹⁶ values apart, so that nothing is lost by rounding.
            return Some(self.floats(source, column.width(), at).0);
        }
        let outside = (0..column.len() * column.width()).any(|i| {
            let value = column.number(i / column.width(), i % column.width());
            !(0.0..=1.0).contains(&value)
        });
        if outside {
            self.losses.column(source.domain, column.name(), "values outside 0 to 1 were clamped, as glTF asks");
        }
        // NaN becomes 0.
        let at = |element: usize, component: usize| column.number(element, component).clamp(0.0, 1.0).max(0.0);
        Some(self.rounded(source, column.width(), at))
    }

    fn custom(&mut self, source: Source<'_>) -> Option<Value> {
        let column = source.column;
        let width = column.width();
        let range = || {
            let all = (0..column.len() * width).map(|i| column.number(i / width, i % width));
            all.fold((0.0f64, 0.0f64), |(low, high), value| (low.min(value), high.max(value)))
        };
        let component_type = match column.values() {
            Values::Text { .. } => {
                self.losses.column(source.domain, column.name(), "glTF attributes are numbers, not text");
                return None;
            }
            Values::F32(_) | Values::F64(_) => None,
            Values::I8(_) => Some(BYTE),
            Values::U8(_) => Some(UNSIGNED_BYTE),
            Values::I16(_) => Some(SHORT),
            Values::U16(_) => Some(UNSIGNED_SHORT),
            Values::I32(_) | Values::U32(_) => match range() {
                (low, high) if low >= 0.0 && high <= f64::from(u16::MAX) => Some(UNSIGNED_SHORT),
                (low, high) if low >= f64::from(i16::MIN) && high <= f64::from(i16::MAX) => Some(SHORT),
                // Single precision holds every whole number up to here.
                (low, high) if low >= -16_777_216.0 && high <= 16_777_216.0 => None,
                (_, high) => {
                    let why = format!("glTF attributes cannot hold whole numbers as large as {high}");
                    self.losses.column(source.domain, column.name(), why);
                    return None;
                }
            },
        };
        let at = |element: usize, component: usize| column.number(element, component);
        Some(match component_type {
            None => self.rounded(source, width, at),
            Some(component_type) => {
                self.bin.whole(width, component_type, source.elements.len(), |vertex, component| {
                    source.elements.get(vertex).map_or(0.0, |element| at(element, component))
                })
            }
        })
    }

    fn rounded(&mut self, source: Source<'_>, width: usize, at: impl Fn(usize, usize) -> f64) -> Value {
        let (accessor, rounded) = self.floats(source, width, at);
        self.note_rounding(rounded, source);
        accessor
    }

    /// Values in single precision, zero where a vertex has none, and whether any was rounded.
    fn floats(&mut self, source: Source<'_>, width: usize, at: impl Fn(usize, usize) -> f64) -> (Value, bool) {
        let mut values = Vec::with_capacity(source.elements.len() * width);
        let (mut rounded, mut finite) = (false, true);
        for vertex in 0..source.elements.len() {
            for component in 0..width {
                let value = source.elements.get(vertex).map_or(0.0, |element| at(element, component));
                values.push(value as f32);
                rounded |= f64::from(value as f32) != value && !value.is_nan();
                finite &= (value as f32).is_finite();
            }
        }
        if !finite {
            let (domain, name) = (source.domain, source.column.name());
            let message =
                format!("the {domain} attribute \"{name}\" has values that are not finite in single precision");
            self.findings.push("W-glb-finite", Severity::Warning, Place::Whole, message);
        }
        (self.bin.floats(width, &values, false), rounded)
    }

    fn note_rounding(&mut self, rounded: bool, source: Source<'_>) {
        if rounded {
            let (domain, name) = (source.domain, source.column.name());
            let message =
                format!("attributes were rounded to single precision, first the {domain} attribute \"{name}\"");
            self.findings.push("W-glb-single", Severity::Note, Place::Whole, message);
        }
    }
}

/// A normal of unit length in single precision; none if it has no direction. What is a rounded unit normal already
/// stays as it is, so that a file read and written again keeps its bits.
fn unit(normal: DVec3) -> Option<[f32; 3]> {
    let single = normal.as_vec3();
    if single.as_dvec3() == normal && (normal.length() - 1.0).abs() < 1e-6 {
        return Some(single.to_array());
    }
    let size = normal.abs().max_element();
    let scaled = if size > 0.0 && size.is_finite() { normal / size } else { return None };
    scaled.try_normalize().map(|unit| unit.as_vec3().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_normals_stay_and_others_become_units() {
        let third = unit(DVec3::splat(1.0)).unwrap();
        assert_eq!(unit(DVec3::from_array(third.map(f64::from))), Some(third));
        for normal in [DVec3::splat(1e-200), DVec3::new(0.0, 3.0, 4.0), DVec3::X * 1e300] {
            let length = DVec3::from_array(unit(normal).unwrap().map(f64::from)).length();
            assert!((length - 1.0).abs() < 1e-7);
        }
        assert_eq!(unit(DVec3::ZERO), None);
        assert_eq!(unit(DVec3::new(f64::NAN, 1.0, 0.0)), None);
    }
}
