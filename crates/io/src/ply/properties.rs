//! Columns as PLY properties.

use std::sync::Arc;

use shapeloom_mesh::{Attributes, COLOR, Column, Domain, NORMAL, TEXCOORD, Values};
use shapeloom_shape::Geometry;

use crate::color::srgb;
use crate::placed::{Losses, columns_of};

/// The type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Char,
    Uchar,
    Short,
    Ushort,
    Int,
    Uint,
    Float,
    Double,
}

impl Type {
    pub fn name(self) -> &'static str {
        match self {
            Self::Char => "char",
            Self::Uchar => "uchar",
            Self::Short => "short",
            Self::Ushort => "ushort",
            Self::Int => "int",
            Self::Uint => "uint",
            Self::Float => "float",
            Self::Double => "double",
        }
    }

    /// Appends a number of this type.
    pub fn put(self, number: f64, out: &mut Vec<u8>) {
        match self {
            Self::Char => out.extend_from_slice(&(number as i8).to_le_bytes()),
            Self::Uchar => out.push(number as u8),
            Self::Short => out.extend_from_slice(&(number as i16).to_le_bytes()),
            Self::Ushort => out.extend_from_slice(&(number as u16).to_le_bytes()),
            Self::Int => out.extend_from_slice(&(number as i32).to_le_bytes()),
            Self::Uint => out.extend_from_slice(&(number as u32).to_le_bytes()),
            Self::Float => out.extend_from_slice(&(number as f32).to_le_bytes()),
            Self::Double => out.extend_from_slice(&number.to_le_bytes()),
        }
    }

    /// The narrowest floating type that holds all numbers.
    pub fn of_floats(numbers: impl IntoIterator<Item = f64>) -> Self {
        let exact = |number: f64| number.is_nan() || f64::from(number as f32) == number;
        if numbers.into_iter().all(exact) { Self::Float } else { Self::Double }
    }
}

/// A column of the file.
#[derive(Clone, Debug)]
pub(super) struct Property {
    /// The name of the column in the shape.
    pub column: String,
    /// The names of its numbers in the file.
    pub names: Vec<String>,
    pub kind: Type,
    stored: Stored,
}

/// What numbers become on their way into the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stored {
    /// They stay.
    Same,
    /// Linear intensities become sRGB bytes.
    SrgbBytes,
    /// Whole numbers up to 65535 become bytes.
    HighBytes,
}

impl Property {
    /// One number of an element as the file has it.
    pub fn number(&self, column: &Column, element: usize, component: usize) -> f64 {
        let number = column.number(element, component);
        match self.stored {
            Stored::Same => number,
            Stored::HighBytes => (number / 257.0).round(),
            Stored::SrgbBytes => {
                let fraction = number.clamp(0.0, 1.0).max(0.0);
                (255.0 * if component < 3 { srgb(fraction) } else { fraction }).round()
            }
        }
    }
}

/// The properties for the columns that all of these geometries have; the others are lost.
pub(super) fn properties(geometries: &[Arc<Geometry>], domain: Domain, losses: &mut Losses) -> Vec<Property> {
    let mut taken: Vec<String> = match domain {
        Domain::Vertex => ["x", "y", "z"].map(str::to_owned).to_vec(),
        _ => ["vertex_indices", TEXCOORD].map(str::to_owned).to_vec(),
    };
    let having: Vec<&Arc<Geometry>> =
        geometries.iter().filter(|geometry| columns_of(geometry, domain).map_or(0, Attributes::len) > 0).collect();
    let mut properties: Vec<Property> = Vec::new();
    for geometry in &having {
        for column in columns_of(geometry, domain).into_iter().flatten() {
            if properties.iter().any(|property| property.column == column.name()) {
                continue;
            }
            let everywhere: Option<Vec<&Column>> = having
                .iter()
                .map(|other| columns_of(other, domain).and_then(|columns| columns.get(column.name())))
                .collect();
            let alike = everywhere.filter(|all| {
                all.iter().all(|other| {
                    other.width() == column.width() && other.values().type_name() == column.values().type_name()
                })
            });
            let Some(all) = alike else {
                losses.column(domain, column.name(), "not every part has it in the same type");
                continue;
            };
            match property(&all, domain, losses) {
                Some(property) if property.names.iter().all(|name| !taken.contains(name)) => {
                    taken.extend(property.names.iter().cloned());
                    properties.push(property);
                }
                Some(_) => losses.column(domain, column.name(), "another property of the file has its name"),
                None => losses.column(domain, column.name(), "PLY properties are numbers, not text"),
            }
        }
    }
    properties
}

fn property(columns: &[&Column], domain: Domain, losses: &mut Losses) -> Option<Property> {
    let column = *columns.first()?;
    let floats = || {
        columns.iter().flat_map(|column| {
            (0..column.len() * column.width()).map(|i| column.number(i / column.width(), i % column.width()))
        })
    };
    let kind = match column.values() {
        Values::F32(_) => Type::Float,
        Values::F64(_) => Type::of_floats(floats()),
        Values::I8(_) => Type::Char,
        Values::U8(_) => Type::Uchar,
        Values::I16(_) => Type::Short,
        Values::U16(_) => Type::Ushort,
        Values::I32(_) => Type::Int,
        Values::U32(_) => Type::Uint,
        Values::Text { .. } => return None,
    };
    let plain = Property { column: column.name().to_owned(), names: Vec::new(), kind, stored: Stored::Same };
    let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    let floating = matches!(kind, Type::Float | Type::Double);
    Some(match (column.name(), column.width()) {
        (NORMAL, 3) => Property { names: named(&["nx", "ny", "nz"]), ..plain },
        (TEXCOORD, 2) => Property { names: named(&["s", "t"]), ..plain },
        (COLOR, width @ (3 | 4)) if floating || matches!(kind, Type::Uchar | Type::Ushort) => {
            if kind != Type::Uchar {
                losses.column(domain, COLOR, "colours were rounded to bytes, linear ones as sRGB");
            }
            let names = named(&["red", "green", "blue", "alpha"][..width]);
            let stored = match kind {
                Type::Uchar => Stored::Same,
                Type::Ushort => Stored::HighBytes,
                _ => Stored::SrgbBytes,
            };
            Property { names, kind: Type::Uchar, stored, ..plain }
        }
        (name, width) => {
            let safe: String =
                name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' }).collect();
            if safe != name || safe.is_empty() {
                losses.column(domain, name, format!("its name in the file is \"{safe}\""));
            }
            if safe.is_empty() {
                return None;
            }
            let names = if width == 1 { vec![safe] } else { (0..width).map(|i| format!("{safe}_{i}")).collect() };
            Property { names, ..plain }
        }
    })
}
