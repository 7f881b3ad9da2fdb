//! Columns of vertices and corners.

use shapeloom_core::{Findings, Place, Severity};
use shapeloom_mesh::{Blend, COLOR, Column, Domain, NORMAL, TEXCOORD, TransformRule, Values};
use shapeloom_shape::Geometry;

use super::assemble::{WEIGHT, no_mesh, unfit};
use super::read::Whole;
use super::statements::{NONE, Side};
use crate::ReadError;
use crate::color::linear;
use crate::placed::insert_column;

/// Colours and weights as columns of all vertices.
pub(super) struct VertexColumns {
    pub list: Vec<Column>,
    /// The vertices without a colour, where others have one; else empty.
    pub colorless: Vec<bool>,
}

impl VertexColumns {
    pub fn take(whole: &mut Whole<'_>, findings: &mut Findings) -> Result<Self, ReadError> {
        let mut list = Vec::new();
        let mut colorless = Vec::new();
        let mut colors = std::mem::take(&mut whole.colors);
        let missing = |color: &[f64; 4]| color.iter().any(|number| !number.is_finite());
        if !colors.values.is_empty() {
            let count = colors.values.as_slice().iter().filter(|color| missing(color)).count();
            if count > 0 {
                let message =
                    format!("{count} vertices have no colour, or one that is not finite, where others have one");
                findings.push("W-obj-color", Severity::Note, Place::Whole, message);
                colorless = colors.values.as_slice().iter().map(missing).collect();
                colors
                    .values
                    .as_mut_slice()
                    .iter_mut()
                    .filter(|color| missing(color))
                    .for_each(|color| *color = [1.0; 4]);
            }
            list.push(color_column(&colors, findings)?);
        }
        let weights = std::mem::take(&mut whole.weights).values.into_vec();
        if weights.iter().any(|&weight| weight != 1.0) {
            list.push(Column::try_new(WEIGHT, 1, Values::F64(weights)).map_err(unfit)?);
        }
        Ok(Self { list, colorless })
    }

    /// The columns that a part of these vertices has: no colours where none of them has one.
    pub fn of(&self, vertices: &[u32]) -> impl Iterator<Item = &Column> {
        let plain = all_colorless(&self.colorless, vertices);
        self.list.iter().filter(move |column| !(plain && column.name() == COLOR))
    }
}

pub(super) fn all_colorless(colorless: &[bool], vertices: &[u32]) -> bool {
    !colorless.is_empty() && vertices.iter().all(|&vertex| colorless[vertex as usize])
}

/// Fractions that are 255ths up to the digits that programs write are bytes; others are made linear.
fn color_column(colors: &Side<[f64; 4]>, findings: &mut Findings) -> Result<Column, ReadError> {
    let width = usize::from(colors.numbers);
    let numbers = || colors.values.as_slice().iter().flat_map(move |color| color[..width].iter().copied());
    let bytes = |scale: f64, slack: f64| -> Option<Vec<u8>> {
        let byte = |number: f64| {
            let scaled = number * scale;
            let near = scaled.round();
            ((scaled - near).abs() <= slack && (0.0..=255.0).contains(&near)).then_some(near as u8)
        };
        numbers().map(byte).collect()
    };
    let values = if numbers().all(|number| number <= 1.0) {
        // Six digits of a 255th are off by less than this.
        bytes(255.0, 2e-4)
    } else {
        let whole = bytes(1.0, 0.0);
        if whole.is_some() {
            let message = "colours are whole numbers up to 255 instead of fractions, and were taken as such";
            findings.push("W-obj-color", Severity::Warning, Place::Whole, message);
        }
        whole
    };
    let values = values.map(Values::U8).unwrap_or_else(|| {
        let of = |(at, number): (usize, f64)| if at % width == 3 { number } else { linear(number) };
        Values::F64(numbers().enumerate().map(of).collect())
    });
    Column::try_new(COLOR, width, values).map_err(unfit)
}

/// All faces over all vertices, with every column but labels.
pub(super) fn whole_mesh(
    whole: &mut Whole<'_>,
    columns: Vec<Column>,
    findings: &mut Findings,
) -> Result<Geometry, ReadError> {
    let mut found: Vec<(Domain, Column)> = columns.into_iter().map(|column| (Domain::Vertex, column)).collect();
    let corners = whole.faces.corners();
    let vertices = whole.positions.len();
    if !whole.face_texcoords.is_empty() {
        let uv = &whole.texcoords;
        found.push(corner_column(TEXCOORD, 2, &whole.face_texcoords, corners, vertices, findings, |index, out| {
            out.extend_from_slice(&uv[index]);
        })?);
    }
    if !whole.face_normals.is_empty() {
        let normals = &whole.normals;
        let (domain, column) =
            corner_column(NORMAL, 3, &whole.face_normals, corners, vertices, findings, |index, out| {
                out.extend_from_slice(&normals[index].to_array());
            })?;
        let column = column.with_blend(Blend::Direction).with_transform(TransformRule::Normal);
        found.push((domain, column));
    }
    for large in [&mut whole.face_texcoords, &mut whole.face_normals] {
        *large = Vec::new();
    }
    let positions = std::mem::take(&mut whole.positions);
    let mut mesh = std::mem::take(&mut whole.faces).into_geometry(positions).map_err(no_mesh)?;
    for (domain, column) in found {
        insert_column(&mut mesh, domain, column).map_err(unfit)?;
    }
    Ok(mesh)
}

/// Values named by corners: of vertices where all corners at a vertex name the same, else of corners.
fn corner_column(
    name: &str,
    width: usize,
    named: &[u32],
    corners: &[u32],
    vertices: usize,
    findings: &mut Findings,
    put: impl Fn(usize, &mut Vec<f64>),
) -> Result<(Domain, Column), ReadError> {
    let missing = named.iter().filter(|&&index| index == NONE).count();
    if missing > 0 {
        let message = format!("{missing} corners of faces have no {name}: 0 was taken");
        findings.push("W-obj-corner", Severity::Note, Place::Whole, message);
    }
    let mut of_vertex = vec![NONE; vertices];
    let mut used = vec![false; vertices];
    let mut agree = true;
    for (&corner, &index) in corners.iter().zip(named) {
        let corner = corner as usize;
        if used[corner] && of_vertex[corner] != index {
            agree = false;
            break;
        }
        used[corner] = true;
        of_vertex[corner] = index;
    }
    let gather = |indices: &[u32]| {
        let mut values = Vec::with_capacity(indices.len() * width);
        for &index in indices {
            if index == NONE { values.resize(values.len() + width, 0.0) } else { put(index as usize, &mut values) }
        }
        Values::F64(values)
    };
    let (domain, values) = if agree { (Domain::Vertex, gather(&of_vertex)) } else { (Domain::Wedge, gather(named)) };
    Ok((domain, Column::try_new(name, width, values).map_err(unfit)?))
}
