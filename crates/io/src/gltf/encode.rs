//! Attribute columns as glTF attributes.

use serde_json::{Map, Value};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, TEXCOORD, Values};

use super::bin::{BYTE, Bin, SHORT, UNSIGNED_BYTE, UNSIGNED_SHORT};
use super::changes::{Change, Changes};
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

/// The columns of a primitive that are numbered sets of texture coordinates and of colours.
pub(super) struct Sets<'a> {
    texcoords: Vec<&'a str>,
    colors: Vec<&'a str>,
}

impl<'a> Sets<'a> {
    /// Sets from 0 on without a gap, as glTF asks: a column beyond one is an attribute of its own.
    pub fn of(columns: &[&'a Column]) -> Self {
        let fitting = |name: &str, fits: fn(&Column) -> bool| {
            let mut sets: Vec<(u32, &'a str)> = columns
                .iter()
                .filter(|column| fits(column))
                .filter_map(|column| Some((set_of(column.name(), name)?, column.name())))
                .collect();
            sets.sort_unstable();
            let whole = sets.into_iter().zip(0..).take_while(|&((set, _), number)| set == number);
            whole.map(|((_, name), _)| name).collect()
        };
        let is_color = |column: &Column| {
            let has_range = matches!(column.values(), Values::U8(_) | Values::U16(_)) || is_floating(column);
            has_range && matches!(column.width(), 3 | 4)
        };
        Self {
            texcoords: fitting(TEXCOORD, |column| is_floating(column) && column.width() == 2),
            colors: fitting(COLOR, is_color),
        }
    }
}

fn is_floating(column: &Column) -> bool {
    matches!(column.values(), Values::F32(_) | Values::F64(_))
}

/// The set that a column of that name is: `texcoord` is 0, `texcoord_1` is 1.
fn set_of(column: &str, name: &str) -> Option<u32> {
    let rest = column.strip_prefix(name)?;
    if rest.is_empty() {
        return Some(0);
    }
    let digits = rest.strip_prefix('_')?;
    // Only as reading names them: 1 and not 01.
    digits.parse().ok().filter(|&set: &u32| set > 0 && set.to_string() == digits)
}

/// Writes columns as attributes of one primitive, and says what does not fit.
pub(super) struct Encoder<'a> {
    pub bin: &'a mut Bin,
    pub losses: &'a mut Losses,
    pub findings: &'a mut Findings,
    pub sets: Sets<'a>,
    /// What was changed to fit, by column.
    pub changes: &'a mut Changes,
    /// Normals for vertices whose own has no direction.
    pub spare_normals: &'a dyn Fn() -> Option<Vec<DVec3>>,
}

impl Encoder<'_> {
    pub fn column(&mut self, attributes: &mut Map<String, Value>, source: Source<'_>) {
        let column = source.column;
        let (name, accessor) = match (column.name(), column.width()) {
            (NORMAL, 3) if is_floating(column) => ("NORMAL".to_owned(), self.normals(source)),
            (name, _) if self.sets.texcoords.contains(&name) => {
                let set = set_of(name, TEXCOORD).unwrap_or_default();
                (format!("TEXCOORD_{set}"), Some(self.texcoords(source)))
            }
            (name, _) if self.sets.colors.contains(&name) => {
                let set = set_of(name, COLOR).unwrap_or_default();
                (format!("COLOR_{set}"), self.colors(source))
            }
            (COLOR, 3 | 4) => {
                let why = format!("colours of type {} have no known range", column.values().type_name());
                self.losses.column(source.domain, COLOR, why);
                return;
            }
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
        let mut change = Change::default();
        for vertex in 0..count {
            let normal = source.elements.get(vertex).map_or(DVec3::ZERO, |element| source.column.vector(element));
            let direction = unit(normal);
            let is_direction = direction.is_some();
            let unit = match direction {
                Some(unit) => unit,
                None => {
                    let spare = spare.get_or_insert_with(self.spare_normals);
                    let Some(normals) = spare else {
                        let why = format!("vertex {vertex} has a normal without direction, which glTF does not allow");
                        self.losses.column(source.domain, source.column.name(), why);
                        return None;
                    };
                    // An unused vertex has none to lose.
                    change.replaced += u64::from(source.elements.get(vertex).is_some());
                    self.findings.push(
                        "W-glb-normal",
                        Severity::Note,
                        Place::element("vertex", vertex as u64),
                        "normals without direction were replaced by that of a facet, or by z where no facet has one",
                    );
                    unit(normals[vertex]).unwrap_or([0.0, 0.0, 1.0])
                }
            };
            let written = DVec3::from_array(unit.map(f64::from));
            rounded |= written != normal;
            if is_direction {
                change.scaled = change.scaled.max((written - normal).abs().max_element());
            }
            values.extend_from_slice(&unit);
        }
        self.changes.add(source.domain, source.column.name(), change);
        self.note_rounding(rounded, source);
        Some(self.bin.floats(3, &values, false))
    }

    fn texcoords(&mut self, source: Source<'_>) -> Value {
        let at = |element: usize, component: usize| source.column.number(element, component);
        let flip = |number: f64, component: usize| if component == 1 { 1.0 - number } else { number };
        self.rounded(source, 2, at, flip)
    }

    fn colors(&mut self, source: Source<'_>) -> Option<Value> {
        let column = source.column;
        let whole = match column.values() {
            Values::F32(_) | Values::F64(_) => None,
            Values::U8(_) => Some(f64::from(u8::MAX)),
            Values::U16(_) => Some(f64::from(u16::MAX)),
            // No set, by its type.
            _ => return None,
        };
        if let Some(largest) = whole {
            let message = "colours in whole numbers were taken as sRGB and written linear, as glTF has them";
            self.findings.push("W-glb-color", Severity::Note, Place::Whole, message);
            let at = |element: usize, component: usize| {
                let value = column.number(element, component) / largest;
                if component < 3 { linear(value) } else { value }
            };
            // Linear single precision tells all 2¹⁶ values apart, so that nothing is lost by rounding.
            return Some(self.floats(source, column.width(), at, plain).0);
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
        Some(self.rounded(source, column.width(), at, plain))
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
            None => self.rounded(source, width, at, plain),
            Some(component_type) => {
                self.bin.whole(width, component_type, source.elements.len(), |vertex, component| {
                    source.elements.get(vertex).map_or(0.0, |element| at(element, component))
                })
            }
        })
    }

    fn rounded(
        &mut self,
        source: Source<'_>,
        width: usize,
        at: impl Fn(usize, usize) -> f64,
        turn: impl Fn(f64, usize) -> f64,
    ) -> Value {
        let (accessor, change) = self.floats(source, width, at, turn);
        self.note_rounding(change.rounded > 0.0, source);
        self.changes.add(source.domain, source.column.name(), change);
        accessor
    }

    /// Values in single precision, zero where a vertex has none, and how they were changed. The file has them as `turn`
    /// gives them, which is its own inverse.
    fn floats(
        &mut self,
        source: Source<'_>,
        width: usize,
        at: impl Fn(usize, usize) -> f64,
        turn: impl Fn(f64, usize) -> f64,
    ) -> (Value, Change) {
        let mut values = Vec::with_capacity(source.elements.len() * width);
        let mut change = Change::default();
        for vertex in 0..source.elements.len() {
            for component in 0..width {
                let Some(element) = source.elements.get(vertex) else {
                    values.push(0.0);
                    continue;
                };
                let wanted = at(element, component);
                let single = turn(wanted, component) as f32;
                values.push(single);
                if single.is_finite() {
                    change.rounded = change.rounded.max((turn(f64::from(single), component) - wanted).abs());
                } else {
                    change.not_finite += 1;
                }
            }
        }
        if change.not_finite > 0 {
            let (domain, name) = (source.domain, source.column.name());
            let message =
                format!("the {domain} attribute \"{name}\" has values that are not finite in single precision");
            self.findings.push("W-glb-finite", Severity::Warning, Place::Whole, message);
        }
        (self.bin.floats(width, &values, false), change)
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

/// What the file has as it is.
fn plain(number: f64, _: usize) -> f64 {
    number
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
