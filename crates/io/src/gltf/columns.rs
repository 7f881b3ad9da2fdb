//! glTF attributes as columns.

use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{Blend, COLOR, Column, NORMAL, TEXCOORD, Values};

use super::accessor::Accessor;
use super::bin::{BYTE, SHORT, UNSIGNED_BYTE, UNSIGNED_SHORT};
use crate::{Fault, ReadError};

/// The column of an attribute, or why shapes have no place for it.
///
/// # Errors
/// The attribute has another type than glTF gives it.
pub(super) fn column(semantic: &str, accessor: &Accessor<'_>) -> Result<Result<Column, &'static str>, ReadError> {
    let values = accessor;
    let built = match semantic.split_once('_') {
        _ if semantic == "NORMAL" => {
            expect(accessor, "NORMAL", 3..=3, accessor.is_float() || accessor.is_fraction())?;
            let normal = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| accessor.fraction(i, axis)));
            Ok(Column::normals(NORMAL, &(0..accessor.count).map(normal).collect::<Vec<_>>()))
        }
        Some(("", name)) if !name.is_empty() => custom(name, accessor),
        Some(("TEXCOORD", set)) => {
            expect(accessor, semantic, 2..=2, accessor.is_float() || accessor.is_fraction())?;
            let coordinates = (0..values.count).map(|i| [values.fraction(i, 0), 1.0 - values.fraction(i, 1)]);
            Ok(Column::texcoords(numbered(TEXCOORD, set), &coordinates.collect::<Vec<_>>()))
        }
        Some(("COLOR", set)) => {
            expect(accessor, semantic, 3..=4, accessor.is_float() || accessor.is_fraction())?;
            let numbers = Values::F32(values.all(|element, component| values.fraction(element, component) as f32));
            Column::try_new(numbered(COLOR, set), values.width, numbers).map_err(|_| "it does not fit a column")
        }
        _ if semantic == "TANGENT" => Err("tangents follow from normals and texture coordinates"),
        Some(("JOINTS" | "WEIGHTS", _)) => Err("skins are not read"),
        _ => Err("glTF gives it no meaning"),
    };
    Ok(built)
}

/// Whether glTF says what the values of that attribute mean and shapes keep them.
pub(super) fn is_known(semantic: &str) -> bool {
    semantic == "NORMAL" || matches!(semantic.split_once('_'), Some(("TEXCOORD" | "COLOR", _)))
}

fn numbered(name: &str, set: &str) -> String {
    if set == "0" { name.to_owned() } else { format!("{name}_{set}") }
}

/// Whole numbers are labels, which are copied and never mixed; fractions and floating numbers are measures.
fn custom(name: &str, accessor: &Accessor<'_>) -> Result<Column, &'static str> {
    let at = |element: usize, component: usize| accessor.number(element, component);
    let values = match accessor.component_type {
        _ if accessor.is_fraction() => Values::F32(accessor.all(|e, c| accessor.fraction(e, c) as f32)),
        BYTE => Values::I8(accessor.all(|e, c| at(e, c) as i8)),
        UNSIGNED_BYTE => Values::U8(accessor.all(|e, c| at(e, c) as u8)),
        SHORT => Values::I16(accessor.all(|e, c| at(e, c) as i16)),
        UNSIGNED_SHORT => Values::U16(accessor.all(|e, c| at(e, c) as u16)),
        _ if accessor.is_float() => Values::F32(accessor.all(|e, c| at(e, c) as f32)),
        _ => Values::U32(accessor.all(|e, c| at(e, c) as u32)),
    };
    let blend = if matches!(values, Values::F32(_)) { Blend::Linear } else { Blend::Copy };
    let column = Column::try_new(name, accessor.width, values).map_err(|_| "it does not fit a column")?;
    Ok(column.with_blend(blend))
}

fn expect(
    accessor: &Accessor<'_>,
    semantic: &str,
    widths: std::ops::RangeInclusive<usize>,
    type_fits: bool,
) -> Result<(), Box<Fault>> {
    if !widths.contains(&accessor.width) {
        let found = format!("{} numbers an element", accessor.width);
        let expected = format!("{} to {} for {semantic}", widths.start(), widths.end());
        return Err(accessor.fault("type", "E-gltf-type", found, &expected));
    }
    if !type_fits {
        let found = format!("component type {}", accessor.component_type);
        let expected = format!("floating or normalized numbers for {semantic}");
        return Err(accessor.fault("componentType", "E-gltf-type", found, &expected));
    }
    Ok(())
}
