//! Pieces of the curve in cells, joined to polylines.

use std::collections::HashMap;

use shapeloom_core::Field;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_mesh::Polyline;

use super::cells::{Cells, Change, Edge};
use crate::query::Side;

const NONE: u32 = u32::MAX;

/// The polylines of a window with what is known of them.
#[derive(Default)]
pub(super) struct Chains {
    pub(super) curves: Vec<Polyline>,
    /// The largest diagonal of a cell with a piece of the curve.
    pub(super) diagonal: f64,
    /// Cells with more than one piece of the curve, which were paired by the side of their middle.
    pub(super) ambiguous: u64,
    /// Cells without a piece that were not proven free.
    pub(super) uncertain: u64,
    /// The middle of the first of these.
    pub(super) first_uncertain: Option<DVec2>,
    /// Crossings where the field is not a number on one side.
    pub(super) undefined: u64,
}

/// Joins the pieces in all cells. With the inside on the left a piece goes from where the border's counter-clockwise walk leaves the inside
/// to where it enters it.
pub(super) fn chains<F: Field + ?Sized>(cells: &mut Cells<'_, F>) -> Chains {
    let mut all = Chains::default();
    let mut points: Vec<DVec2> = Vec::new();
    let mut next: Vec<u32> = Vec::new();
    let mut has_previous: Vec<bool> = Vec::new();
    let mut numbers: HashMap<Edge, u32> = HashMap::new();
    let mut border: Vec<Change> = Vec::new();
    for at in 0..cells.cells.len() {
        let cell = cells.cells[at];
        cells.border(&cell, &mut border);
        if border.is_empty() {
            all.uncertain += 1;
            all.first_uncertain.get_or_insert_with(|| cells.lattice.place(cell.corner));
            continue;
        }
        all.diagonal = all.diagonal.max(cells.lattice.diagonal(cell.level));
        let ids: Vec<u32> = border
            .iter()
            .map(|change| {
                *numbers.entry(change.edge).or_insert_with(|| {
                    points.push(cells.crossing(change.edge));
                    next.push(NONE);
                    has_previous.push(false);
                    all.undefined += u64::from(cells.is_undefined(&change.edge));
                    points.len() as u32 - 1
                })
            })
            .collect();
        // Entering and leaving take turns. If the middle is inside, pieces cut off what is outside: a piece leads on to the entry behind
        // its start. If it is outside, they cut off what is inside: it leads back to the entry before.
        let several = border.len() > 2;
        all.ambiguous += u64::from(several);
        let forward = several && cells.middle_side(&cell) == Side::Inside;
        for (i, _) in border.iter().enumerate().filter(|(_, change)| change.leaving) {
            let to = if forward { (i + 1) % ids.len() } else { (i + ids.len() - 1) % ids.len() };
            next[ids[i] as usize] = ids[to];
            has_previous[ids[to] as usize] = true;
        }
    }
    let mut done = vec![false; points.len()];
    let starts = (0..points.len()).filter(|&id| !has_previous[id]).chain(0..points.len());
    for start in starts.collect::<Vec<usize>>() {
        if done[start] {
            continue;
        }
        let (mut line, mut id, mut closed) = (Vec::new(), start, false);
        loop {
            done[id] = true;
            let point = points[id].extend(0.0);
            if line.last() != Some(&point) {
                line.push(point);
            }
            match next[id] {
                NONE => break,
                after if after as usize == start => {
                    closed = true;
                    break;
                }
                after if done[after as usize] => break,
                after => id = after as usize,
            }
        }
        push(&mut all.curves, line, closed);
    }
    all
}

fn push(curves: &mut Vec<Polyline>, mut line: Vec<DVec3>, closed: bool) {
    if closed && line.len() > 1 && line.first() == line.last() {
        line.pop();
    }
    if line.len() > 1 {
        curves.push(Polyline::new(line, closed));
    }
}
