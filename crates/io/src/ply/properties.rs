//! Columns as PLY properties.

use shapeloom_mesh::{Attributes, COLOR, Column, ListColumn, NORMAL, TEXCOORD, Values};

use super::color::{fraction, fraction_type, is_byte, single_fraction, single_type};
use super::encode::{Laid, Written};
use super::types::{Type, with_values};
use crate::color::srgb;
use crate::placed::Losses;

/// Columns of the file, and lists behind them.
#[derive(Clone, Debug, Default)]
pub(super) struct Properties {
    pub columns: Vec<Property>,
    pub lists: Vec<ListProperty>,
}

/// A column of the file.
#[derive(Clone, Debug)]
pub(super) struct Property {
    /// The name of the column in the shape.
    column: String,
    /// The names of its numbers in the file.
    names: Vec<String>,
    kind: Type,
    stored: Stored,
}

/// Lists of the file.
#[derive(Clone, Debug)]
pub(super) struct ListProperty {
    /// The name of the column in the shape.
    column: String,
    name: String,
    count: Type,
    kind: Type,
}

/// What numbers become on their way into the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stored {
    /// They stay.
    Same,
    /// Linear intensities become sRGB bytes.
    SrgbBytes,
    /// Linear intensities become fractions in sRGB.
    SrgbFractions,
}

/// The columns of one part, or of a table: how many elements, and what they have.
pub(super) type Set<'a> = (usize, Option<&'a Attributes>);

impl Properties {
    /// The properties for the columns that all sets with elements have; the others are lost. `taken` are the names that
    /// the element has already; `label` is what a loss calls the elements.
    pub fn new(sets: &[Set<'_>], label: &str, taken: &[&str], losses: &mut Losses) -> Self {
        let mut taken: Vec<String> = taken.iter().map(|name| (*name).to_owned()).collect();
        let having: Vec<Option<&Attributes>> =
            sets.iter().filter(|(count, _)| *count > 0).map(|(_, set)| *set).collect();
        let mut properties = Self::default();
        let mut lose = |name: &str, why: &str| losses.push(format!("{label} attribute \"{name}\""), why);
        for column in having.iter().copied().flatten().flat_map(|columns| columns.iter()) {
            if properties.columns.iter().any(|property| property.column == column.name()) {
                continue;
            }
            let everywhere: Option<Vec<&Column>> =
                having.iter().map(|other| other.and_then(|set| set.get(column.name()))).collect();
            let alike = everywhere.filter(|all| {
                all.iter().all(|other| {
                    other.width() == column.width() && other.values().type_name() == column.values().type_name()
                })
            });
            let Some(all) = alike else {
                lose(column.name(), "not every part has it in the same type");
                continue;
            };
            match property(&all, &mut lose) {
                Some(property) if property.names.iter().all(|name| !taken.contains(name)) => {
                    taken.extend(property.names.iter().cloned());
                    properties.columns.push(property);
                }
                Some(_) => lose(column.name(), "another property of the file has its name"),
                None => lose(column.name(), "PLY properties are numbers, not text"),
            }
        }
        for list in having.iter().copied().flatten().flat_map(|columns| columns.lists()) {
            if properties.lists.iter().any(|property| property.column == list.name()) {
                continue;
            }
            let everywhere: Option<Vec<&ListColumn>> =
                having.iter().map(|other| other.and_then(|set| set.list(list.name()))).collect();
            let same = |other: &&ListColumn| other.values().type_name() == list.values().type_name();
            let Some(all) = everywhere.filter(|all| all.iter().all(same)) else {
                lose(list.name(), "not every part has it in the same type");
                continue;
            };
            let Some(kind) = Type::of_values(list.values()) else {
                lose(list.name(), "PLY properties are numbers, not text");
                continue;
            };
            let name = safe(list.name());
            if name.is_empty() || taken.contains(&name) {
                lose(list.name(), "another property of the file has its name");
                continue;
            }
            if name != list.name() {
                lose(list.name(), &format!("its name in the file is \"{name}\""));
            }
            taken.push(name.clone());
            let most = all.iter().flat_map(|list| list.starts().windows(2)).map(|pair| pair[1] - pair[0]).max();
            let count = count_type(most.unwrap_or(0) as usize);
            properties.lists.push(ListProperty { column: list.name().to_owned(), name, count, kind });
        }
        properties
    }

    /// The lines of the header.
    pub fn declare(&self, out: &mut String) {
        for property in &self.columns {
            for name in &property.names {
                out.push_str(&format!("property {} {name}\n", property.kind.name()));
            }
        }
        for list in &self.lists {
            out.push_str(&format!("property list {} {} {}\n", list.count.name(), list.kind.name(), list.name));
        }
    }

    /// The values of these properties in a set.
    pub fn of<'a>(&'a self, set: Option<&'a Attributes>) -> Sources<'a> {
        let columns = self.columns.iter().filter_map(|property| Some((property, set?.get(&property.column)?)));
        let lists = self.lists.iter().filter_map(|property| Some((property, set?.list(&property.column)?)));
        Sources { columns: columns.collect(), lists: lists.collect() }
    }
}

/// Where the values of properties come from.
pub(super) struct Sources<'a> {
    columns: Vec<(&'a Property, &'a Column)>,
    lists: Vec<(&'a ListProperty, &'a ListColumn)>,
}

impl Sources<'_> {
    /// Appends the values of an element.
    #[inline]
    pub fn put<L: Laid>(&self, element: usize, out: &mut Vec<u8>) {
        for (property, column) in &self.columns {
            property.put::<L>(column, element, out);
        }
        for (property, list) in &self.lists {
            let range = list.range(element);
            put_count::<L>(property.count, range.len(), out);
            with_values!(list.values(), values => put_all::<L, _>(values.get(range), out), ());
        }
    }
}

/// Appends the length of a list.
#[inline]
pub(super) fn put_count<L: Laid>(kind: Type, count: usize, out: &mut Vec<u8>) {
    match kind {
        Type::Uchar => L::put(count as u8, out),
        _ => L::put(count as u32, out),
    }
}

#[inline]
fn put_all<L: Laid, T: Written>(values: Option<&[T]>, out: &mut Vec<u8>) {
    values.unwrap_or(&[]).iter().for_each(|&value| L::put(value, out));
}

impl Property {
    #[inline]
    fn put<L: Laid>(&self, column: &Column, element: usize, out: &mut Vec<u8>) {
        let width = column.width();
        let range = element * width..(element + 1) * width;
        match (self.stored, column.values()) {
            (Stored::Same, Values::F64(values)) if self.kind == Type::Float => {
                values.get(range).unwrap_or(&[]).iter().for_each(|&value| L::put(value as f32, out));
            }
            (Stored::Same, values) => {
                with_values!(values, values => put_all::<L, _>(values.get(range), out), ());
            }
            (Stored::SrgbBytes, _) => {
                for component in 0..width {
                    let fraction = column.number(element, component).clamp(0.0, 1.0).max(0.0);
                    L::put((255.0 * if component < 3 { srgb(fraction) } else { fraction }).round() as u8, out);
                }
            }
            (Stored::SrgbFractions, Values::F32(values)) if self.kind == Type::Float => {
                for (component, &number) in values.get(range).unwrap_or(&[]).iter().enumerate() {
                    L::put(if component < 3 { single_fraction(number) } else { number }, out);
                }
            }
            (Stored::SrgbFractions, _) => {
                for component in 0..width {
                    let number = column.number(element, component);
                    let stored = if component < 3 { fraction(number) } else { number };
                    if self.kind == Type::Float { L::put(stored as f32, out) } else { L::put(stored, out) }
                }
            }
        }
    }
}

/// The type of the length of lists.
pub(super) fn count_type(most: usize) -> Type {
    if most <= usize::from(u8::MAX) { Type::Uchar } else { Type::Uint }
}

/// A name without white space, which ends names in a header.
pub(super) fn safe(name: &str) -> String {
    name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect()
}

fn property(columns: &[&Column], lose: &mut impl FnMut(&str, &str)) -> Option<Property> {
    let column = *columns.first()?;
    let floats = || {
        columns.iter().flat_map(|column| {
            (0..column.len() * column.width()).map(|i| column.number(i / column.width(), i % column.width()))
        })
    };
    let kind = Type::of_values(column.values())?;
    let plain = Property { column: column.name().to_owned(), names: Vec::new(), kind, stored: Stored::Same };
    let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    let narrow = || if kind == Type::Double { Type::of_floats(floats()) } else { kind };
    Some(match (column.name(), column.width()) {
        (NORMAL, 3) if kind.is_floating() => Property { names: named(&["nx", "ny", "nz"]), kind: narrow(), ..plain },
        (TEXCOORD, 2) if kind.is_floating() => Property { names: named(&["s", "t"]), kind: narrow(), ..plain },
        (COLOR, width @ (3 | 4)) if kind.is_floating() || matches!(kind, Type::Uchar | Type::Ushort) => {
            let names = named(&["red", "green", "blue", "alpha"][..width]);
            let (kind, stored) = match kind {
                Type::Float => {
                    let values = || {
                        columns.iter().flat_map(|column| match column.values() {
                            Values::F32(values) => values.iter().enumerate(),
                            _ => [].iter().enumerate(),
                        })
                    };
                    let is_color = |at: usize| at % width < 3;
                    let byte = |(at, &value): (usize, &f32)| {
                        let value = f64::from(value);
                        is_byte(if is_color(at) && value > 0.0 { srgb(value) } else { value })
                    };
                    if values().all(byte) {
                        (Type::Uchar, Stored::SrgbBytes)
                    } else {
                        let colors = values().filter(|(at, _)| is_color(*at)).map(|(_, &value)| value);
                        (single_type(colors), Stored::SrgbFractions)
                    }
                }
                Type::Double => {
                    let colors = fraction_type(columns.iter().flat_map(|column| {
                        (0..column.len()).flat_map(move |i| (0..3).map(move |component| column.number(i, component)))
                    }));
                    let exact = |number: f64| number.is_nan() || f64::from(number as f32) == number;
                    let mut alphas = columns.iter().flat_map(|column| {
                        (0..column.len())
                            .flat_map(move |i| (3..column.width()).map(move |alpha| column.number(i, alpha)))
                    });
                    (if alphas.all(exact) { colors } else { Type::Double }, Stored::SrgbFractions)
                }
                other => (other, Stored::Same),
            };
            Property { names, kind, stored, ..plain }
        }
        (name, width) => {
            let safe = safe(name);
            if safe != name || safe.is_empty() {
                lose(name, &format!("its name in the file is \"{safe}\""));
            }
            if safe.is_empty() {
                return None;
            }
            let names = if width == 1 { vec![safe] } else { (0..width).map(|i| format!("{safe}_{i}")).collect() };
            Property { names, ..plain }
        }
    })
}
