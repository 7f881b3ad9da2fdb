//! What is read from the rows of an element.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, OverBudget, Place};
use shapeloom_mesh::Values;

use super::header::Element;
use super::plan::Plan;
use super::types::{Type, with_values};
use crate::audit::DROP_ADVICE;
use crate::faces::Faces;
use crate::memory::{Memory, make_room};
use crate::{Fault, ReadError};

/// The rows of an element as its plan says. Faces of fewer than three corners are left out, with the rest of their row.
#[derive(Debug)]
pub(super) struct Rows {
    /// How many rows were kept.
    pub len: usize,
    pub positions: Vec<DVec3>,
    pub faces: Faces,
    /// The values of each column of the plan.
    pub columns: Vec<Values>,
    /// The lists of the plan.
    pub lists: Vec<Lists>,
    /// The rows that were left out, in order.
    pub skipped: Vec<u32>,
}

/// The lists of a property, one after the other.
#[derive(Debug)]
pub(super) struct Lists {
    /// Where each ends.
    pub ends: Vec<u32>,
    pub values: Values,
}

impl Rows {
    /// No rows, with room for so many that are known to have their bytes in the file.
    pub fn with_room(element: &Element, plan: &Plan, rows: usize, memory: &mut Memory<'_>) -> Result<Self, OverBudget> {
        let mut columns = Vec::with_capacity(plan.columns.len());
        for group in &plan.columns {
            let count = rows.saturating_mul(group.properties.len());
            memory.take(count, group.kind.size())?;
            columns.push(group.kind.with_room(count));
        }
        let mut lists = Vec::with_capacity(plan.lists.len());
        for &list in &plan.lists {
            memory.take(rows, size_of::<u32>())?;
            let kind = element.properties.get(list).map_or(Type::Int, |property| property.kind);
            lists.push(Lists { ends: Vec::with_capacity(rows), values: kind.with_room(0) });
        }
        let points = if plan.axes.is_some() { rows } else { 0 };
        memory.take(points, size_of::<DVec3>())?;
        let positions = Vec::with_capacity(points);
        Ok(Self { len: 0, positions, faces: Faces::default(), columns, lists, skipped: Vec::new() })
    }

    /// Adds the rows of another piece of the same element behind these.
    pub fn append(&mut self, other: Self, memory: &mut Memory<'_>) -> Result<(), ReadError> {
        self.len += other.len;
        append(&mut self.positions, &other.positions, memory)?;
        self.faces.append(memory, other.faces)?;
        for (values, more) in self.columns.iter_mut().zip(&other.columns) {
            append_values(values, more, memory)?;
        }
        for (list, more) in self.lists.iter_mut().zip(&other.lists) {
            let before = list.values.len() as u32;
            check_list_values(list.values.len() as u64 + more.values.len() as u64)?;
            append_values(&mut list.values, &more.values, memory)?;
            make_room(memory, &mut list.ends, more.ends.len())?;
            list.ends.extend(more.ends.iter().map(|end| before + end));
        }
        append(&mut self.skipped, &other.skipped, memory)
    }
}

fn append<T: Copy>(vector: &mut Vec<T>, more: &[T], memory: &mut Memory<'_>) -> Result<(), ReadError> {
    make_room(memory, vector, more.len())?;
    vector.extend_from_slice(more);
    Ok(())
}

fn append_values(values: &mut Values, more: &Values, memory: &mut Memory<'_>) -> Result<(), ReadError> {
    match (values, more) {
        (Values::F32(values), Values::F32(more)) => append(values, more, memory),
        (Values::F64(values), Values::F64(more)) => append(values, more, memory),
        (Values::I8(values), Values::I8(more)) => append(values, more, memory),
        (Values::U8(values), Values::U8(more)) => append(values, more, memory),
        (Values::I16(values), Values::I16(more)) => append(values, more, memory),
        (Values::U16(values), Values::U16(more)) => append(values, more, memory),
        (Values::I32(values), Values::I32(more)) => append(values, more, memory),
        (Values::U32(values), Values::U32(more)) => append(values, more, memory),
        // Pieces of one element have one plan.
        _ => Ok(()),
    }
}

/// Refuses more numbers in the lists of a property than 32 bits count.
pub(super) fn check_list_values(count: u64) -> Result<(), ReadError> {
    if count < u64::from(u32::MAX) {
        return Ok(());
    }
    let expected = format!("at most {} numbers in the lists of a property", u32::MAX - 1);
    let fault = Fault::new("E-ply-limit", Place::Whole, count.to_string(), expected);
    Err(fault.category(Category::OverLimit).into())
}

/// An index that no vertex has. `place` is that of the row.
pub(super) fn index_fault(place: Place, row: usize, found: impl ToString, vertices: usize) -> Box<Fault> {
    let expected = match vertices {
        0 => "no index, as there are no vertices".to_owned(),
        _ => format!("the index of a vertex, 0 to {}", vertices - 1),
    };
    Fault::new("E-ply-index", place, found.to_string(), expected)
        .within(format!("face {row}"))
        .advice("the program that wrote the file counted from 1, mixed byte orders, or lost vertices")
}

/// A vertex that is nowhere. `place` is that of the row.
pub(super) fn finite_fault(place: Place, row: usize, found: String) -> Box<Fault> {
    Fault::new("E-ply-finite", place, found, "finite coordinates").within(format!("vertex {row}")).advice(DROP_ADVICE)
}

/// A face of more corners than the limits allow.
pub(super) fn polygon_fault(place: Place, row: usize, corners: u64, most: u32) -> Box<Fault> {
    Fault::new("E-ply-limit", place, format!("{corners} corners"), format!("at most {most} corners of a face"))
        .within(format!("face {row}"))
        .category(Category::OverLimit)
}

/// The last row of a set of values taken back.
pub(super) fn drop_last(values: &mut Values, count: usize) {
    with_values!(values, vector => vector.truncate(vector.len().saturating_sub(count)), ());
}
