//! Cells of a window, halved until the curve in them is simple and flat.

use std::collections::HashMap;
use std::sync::Arc;

use shapeloom_core::glam::DVec2;
use shapeloom_core::{ConvertError, Exec, Field, Reservation, Restricted};

use super::error::SectionError;
use super::plane::{Lattice, PlaneWindow};
use crate::query::Side;
use crate::query::bounds::{Bounds, reach};
use crate::query::root::side_change;
use crate::query::survey::AsField;

/// A square of the plane that may hold a piece of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// The lower left corner on the finest lattice.
    pub(super) corner: [u64; 2],
    /// How often its root was halved.
    pub(super) level: u32,
    /// How many crossings its border had when it was found good; none before.
    good: Option<u32>,
}

/// A stretch between two corners next to each other, from the lower one; `up` if it goes along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Edge {
    pub(super) from: [u64; 2],
    pub(super) length: u64,
    pub(super) up: bool,
}

/// A place where the side changes on the border of a cell, which is walked counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    pub(super) edge: Edge,
    /// Whether the walk leaves the inside there.
    pub(super) leaving: bool,
}

/// How fine cells become.
pub(super) struct Fineness {
    /// Cells that may hold the curve are halved so often, whatever their corners are.
    pub(super) base: u32,
    /// Those without a change of sides on their border so often.
    pub(super) search: u32,
    pub(super) tolerance: f64,
    /// Whether all cells that the curve passes go down to the finest.
    pub(super) proven: bool,
    pub(super) max_cells: u32,
}

/// How many cells memory is reserved for at a time, and how much: a cell, four corners, two crossings, with room in the tables.
const BLOCK: u64 = 4096;
const CELL_BYTES: usize = 400;

pub(super) struct Cells<'a, F: ?Sized> {
    pub(super) window: &'a PlaneWindow<'a, F>,
    bounds: Bounds<'a, F>,
    pub(super) lattice: Lattice,
    fineness: Fineness,
    exec: &'a Exec,
    values: HashMap<[u64; 2], f64>,
    crossings: HashMap<Edge, DVec2>,
    pub(super) cells: Vec<Cell>,
    /// How many cells were looked at.
    pub(super) asked: u64,
    /// How many cells were kept at any time; their corners stay.
    kept: u64,
    reserved: Vec<Reservation>,
}

impl<'a, F: Field + ?Sized> Cells<'a, F> {
    pub(super) fn new(
        window: &'a PlaneWindow<'a, F>,
        lattice: Lattice,
        fineness: Fineness,
        exec: &'a Exec,
    ) -> Result<Self, ConvertError> {
        let mut all = Self {
            window,
            bounds: Bounds::new(window.field),
            lattice,
            fineness,
            exec,
            values: HashMap::new(),
            crossings: HashMap::new(),
            cells: Vec::new(),
            asked: 0,
            kept: 0,
            reserved: Vec::new(),
        };
        all.plant()?;
        while all.refine()? {}
        Ok(all)
    }

    /// The length of a cell's side on the finest lattice.
    fn side(&self, level: u32) -> u64 {
        1 << (self.lattice.depth - level)
    }

    /// Halves root cells down to the base, without those that are proven free.
    fn plant(&mut self) -> Result<(), ConvertError> {
        let root = self.side(0);
        let mut stack: Vec<(Cell, Option<Arc<dyn Field>>)> = Vec::new();
        for y in (0..self.lattice.roots[1]).rev() {
            for x in (0..self.lattice.roots[0]).rev() {
                stack.push((Cell { corner: [x * root, y * root], level: 0, good: None }, None));
            }
        }
        while let Some((cell, part)) = stack.pop() {
            let (free, simpler) = self.is_free(&cell, part.as_deref())?;
            if free {
                continue;
            }
            if cell.level < self.fineness.base {
                let part = simpler.or(part);
                stack.extend(self.quarters(&cell).into_iter().rev().map(|quarter| (quarter, part.clone())));
            } else {
                self.keep(cell)?;
            }
        }
        Ok(())
    }

    /// Whether a cell is proven to lie on one side; if not, the field restricted to it where that is simpler.
    fn is_free(
        &mut self,
        cell: &Cell,
        part: Option<&dyn Field>,
    ) -> Result<(bool, Option<Arc<dyn Field>>), ConvertError> {
        self.asked += 1;
        if self.asked > u64::from(self.fineness.max_cells) {
            return Err(SectionError::Cells { most: self.fineness.max_cells }.into());
        }
        if self.asked.is_multiple_of(256) {
            self.exec.check()?;
        }
        let side = self.side(cell.level);
        let [x, y] = cell.corner;
        let (lo, hi) = (self.lattice.place(cell.corner), self.lattice.place([x + side, y + side]));
        let region = self.window.region(lo, hi);
        let restricted = match part {
            Some(part) => part.restrict(&region),
            None => AsField(self.window.field).restrict(&region),
        };
        let simpler = match restricted {
            Restricted::Positive | Restricted::Negative => return Ok((true, None)),
            Restricted::Same => None,
            Restricted::Simpler(part) => Some(part),
        };
        let middle = self.window.frame.position(((lo + hi) * 0.5).extend(0.0));
        // Half the diagonal of the cell, or of a box that rounding has made a little larger.
        let radius = ((hi - lo).length() * 0.5 * (1.0 + 1e-12))
            .max(if self.window.frame == shapeloom_core::Frame::WORLD { reach(&region, middle) } else { 0.0 });
        Ok((Side::of_bounds(self.bounds.by_slope(middle, radius)).is_some(), simpler))
    }

    fn quarters(&self, cell: &Cell) -> [Cell; 4] {
        let half = self.side(cell.level + 1);
        let [x, y] = cell.corner;
        [[x, y], [x + half, y], [x, y + half], [x + half, y + half]].map(|corner| Cell {
            corner,
            level: cell.level + 1,
            good: None,
        })
    }

    fn keep(&mut self, cell: Cell) -> Result<(), ConvertError> {
        if self.kept.is_multiple_of(BLOCK) {
            self.reserved.push(self.exec.reserve_elements(BLOCK, CELL_BYTES)?);
        }
        self.kept += 1;
        let side = self.side(cell.level);
        let [x, y] = cell.corner;
        for corner in [[x, y], [x + side, y], [x, y + side], [x + side, y + side]] {
            let (window, lattice) = (self.window, self.lattice);
            self.values.entry(corner).or_insert_with(|| window.value(lattice.place(corner)));
        }
        self.cells.push(cell);
        Ok(())
    }

    /// Halves the cells that are not good yet; whether there were any.
    fn refine(&mut self) -> Result<bool, ConvertError> {
        let mut changed = false;
        let old = std::mem::take(&mut self.cells);
        let mut border = Vec::new();
        for (i, cell) in old.into_iter().enumerate() {
            if i.is_multiple_of(256) {
                self.exec.check()?;
            }
            self.border(&cell, &mut border);
            let count = border.len() as u32;
            if cell.good == Some(count) {
                self.cells.push(cell);
            } else if self.is_good(&cell, &border) {
                self.cells.push(Cell { good: Some(count), ..cell });
            } else {
                changed = true;
                for quarter in self.quarters(&cell) {
                    if !self.is_free(&quarter, None)?.0 {
                        self.keep(quarter)?;
                    }
                }
            }
        }
        Ok(changed)
    }

    /// Whether the pieces of the curve in a cell are told apart, and are near their chords.
    fn is_good(&mut self, cell: &Cell, border: &[Change]) -> bool {
        if cell.level >= self.lattice.depth {
            return true;
        }
        match border {
            [] => cell.level >= self.fineness.search,
            [a, b] => {
                if self.fineness.proven {
                    return false;
                }
                let (start, end) = if a.leaving { (a.edge, b.edge) } else { (b.edge, a.edge) };
                let (start, end) = (self.crossing(start), self.crossing(end));
                let chord = end - start;
                // A corner of the curve between two of the places lies at most a third farther off than the places show.
                let arm = chord.perp().normalize_or_zero() * (self.fineness.tolerance * 0.75);
                // Shorter arms are for what is thinner than the tolerance.
                let passes = |place: DVec2, arm: DVec2| {
                    self.window.side(place + arm) == Side::Inside && self.window.side(place - arm) == Side::Outside
                };
                [0.5, 0.25, 0.75].into_iter().all(|part| {
                    let place = start + chord * part;
                    (0..7).any(|halvings| passes(place, arm * 0.25_f64.powi(halvings)))
                })
            }
            // Two pieces of the curve or more: which belong together shows in smaller cells.
            _ => false,
        }
    }

    /// The changes of sides on the border of a cell, counter-clockwise; where neighbours are smaller, with their corners.
    pub(super) fn border(&self, cell: &Cell, border: &mut Vec<Change>) {
        border.clear();
        let length = self.side(cell.level);
        let [x, y] = cell.corner;
        let sides = [
            (Edge { from: [x, y], length, up: false }, false),
            (Edge { from: [x + length, y], length, up: true }, false),
            (Edge { from: [x, y + length], length, up: false }, true),
            (Edge { from: [x, y], length, up: true }, true),
        ];
        for (edge, backward) in sides {
            self.walk(edge, backward, border);
        }
    }

    fn walk(&self, edge: Edge, backward: bool, border: &mut Vec<Change>) {
        let mut stack = vec![edge];
        while let Some(edge) = stack.pop() {
            let half = edge.length / 2;
            let middle = edge.along(half);
            if half > 0 && self.values.contains_key(&middle) {
                let parts = [Edge { length: half, ..edge }, Edge { from: middle, length: half, ..edge }];
                let [first, second] = if backward { [parts[1], parts[0]] } else { parts };
                stack.extend([second, first]);
                continue;
            }
            let (a, b) = (self.side_of(edge.from), self.side_of(edge.along(edge.length)));
            if a != b {
                border.push(Change { edge, leaving: (a == Side::Inside) != backward });
            }
        }
    }

    fn side_of(&self, corner: [u64; 2]) -> Side {
        self.values.get(&corner).map_or(Side::Outside, |value| Side::of(*value))
    }

    /// Where the side changes on an edge.
    pub(super) fn crossing(&mut self, edge: Edge) -> DVec2 {
        if let Some(known) = self.crossings.get(&edge) {
            return *known;
        }
        let (window, ends) = (self.window, [edge.from, edge.along(edge.length)]);
        let [a, b] = ends.map(|end| self.lattice.place(end));
        let [at_a, at_b] = ends.map(|end| self.values.get(&end).copied().unwrap_or(f64::NAN));
        let axis = usize::from(edge.up);
        let on = |along: f64| if edge.up { DVec2::new(a.x, along) } else { DVec2::new(along, a.y) };
        let place = on(side_change(|along| window.value(on(along)), (a[axis], at_a), (b[axis], at_b)));
        self.crossings.insert(edge, place);
        place
    }

    /// Whether a corner's value is not a number.
    pub(super) fn is_undefined(&self, edge: &Edge) -> bool {
        [edge.from, edge.along(edge.length)].iter().any(|end| self.values.get(end).is_none_or(|value| value.is_nan()))
    }

    /// The side of the middle of a cell.
    pub(super) fn middle_side(&self, cell: &Cell) -> Side {
        let side = self.side(cell.level);
        let [x, y] = cell.corner;
        let place = (self.lattice.place(cell.corner) + self.lattice.place([x + side, y + side])) * 0.5;
        self.window.side(place)
    }
}

impl Edge {
    fn along(&self, steps: u64) -> [u64; 2] {
        let [x, y] = self.from;
        if self.up { [x, y + steps] } else { [x + steps, y] }
    }
}
