//! The Hausdorff distance by branch and bound.
//!
//! Guthe, Borodin and Klein: Fast and accurate Hausdorff distance calculation between meshes, Journal of WSCG 2005; Tang,
//! Lee and Kim: Interactive Hausdorff distance computation for general polygonal models, SIGGRAPH 2009; Sacht and Jacobson:
//! Cascading upper bounds for triangle soup Pompeiu-Hausdorff distance, Computer Graphics Forum 2024, for trying cheap
//! bounds before dear ones. Cutting cells along the borders of the other shape's triangles is this module's own.

use std::collections::BTreeMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Reservation, Stop, parallel};

use super::cell::{Cell, Farthest, Goal, Search};
use super::measure::Distances;
use super::side::{Corners, Scale, Side};
use crate::JudgeError;

/// A point of one shape and the nearest point of the other that shows how far apart the shapes are at least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Witness {
    /// A point of the one shape, within rounding.
    pub point: DVec3,
    /// The triangle that it lies on.
    pub element: u32,
    /// The nearest point of the other shape.
    pub nearest: DVec3,
    /// The triangle that it lies on.
    pub nearest_element: u32,
}

/// The directed Hausdorff distance: the largest distance of a point of one shape from the other shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectedHausdorff {
    /// It is no less than this: the witness is that far away.
    pub lower: f64,
    /// It is no more than this: proven for every point.
    pub upper: f64,
    /// The farthest point that was found.
    pub witness: Witness,
    /// Whether the bounds are as near to each other as was asked for. If not, they hold all the same.
    pub converged: bool,
    /// How many closest points were looked for.
    pub queries: u64,
    /// How many pieces were cut.
    pub splits: u64,
    /// How many rounds of cutting there were.
    pub rounds: u64,
}

/// The Hausdorff distance between two shapes: the larger of both directed ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hausdorff {
    /// From the first shape to the second.
    pub a_to_b: DirectedHausdorff,
    /// From the second shape to the first.
    pub b_to_a: DirectedHausdorff,
}

impl Hausdorff {
    /// It is no less than this.
    pub fn lower(&self) -> f64 {
        self.a_to_b.lower.max(self.b_to_a.lower)
    }

    /// It is no more than this.
    pub fn upper(&self) -> f64 {
        self.a_to_b.upper.max(self.b_to_a.upper)
    }

    /// Whether both directions are as exact as was asked for.
    pub fn converged(&self) -> bool {
        self.a_to_b.converged && self.b_to_a.converged
    }
}

/// Cells that are cut in one round: enough for many threads, few enough that the farthest ones lead.
const ROUND: usize = 1024;
/// Cells in one piece of parallel work.
const CHUNK: usize = 16;
/// Cells for which memory is taken at a time.
const CELLS: u64 = 1 << 16;

/// Cells by their bounds, in classes an eighth of an octave wide: the farthest class leads, which is all the order that
/// the search needs, at a fraction of a heap's cost.
#[derive(Default)]
struct Queue {
    classes: BTreeMap<u64, Vec<Cell>>,
    len: usize,
}

impl Queue {
    fn push(&mut self, cell: Cell) {
        // Positive numbers are in the order of their bits; three bits of the fraction are kept.
        self.classes.entry(cell.upper.to_bits() >> 49).or_default().push(cell);
        self.len += 1;
    }

    /// Takes cells of the farthest classes that miss the goal, and returns the largest bound of those that meet it.
    fn take(&mut self, goal: &Goal, count: usize, batch: &mut Vec<Cell>) -> f64 {
        let mut settled = 0.0f64;
        while let Some(mut class) = self.classes.last_entry() {
            while let Some(cell) = class.get_mut().pop() {
                self.len -= 1;
                if goal.is_met(cell.upper) {
                    settled = settled.max(cell.upper);
                    continue;
                }
                batch.push(cell);
                if batch.len() == count {
                    return settled;
                }
            }
            class.remove();
        }
        settled
    }

    fn worst(&self) -> f64 {
        self.classes.last_key_value().map_or(0.0, |(_, class)| class.iter().map(|cell| cell.upper).fold(0.0, f64::max))
    }
}

/// What cutting some cells found.
struct Found {
    cells: Vec<Cell>,
    /// The largest bound of a piece that is as exact as asked for, and of one that cannot be cut further.
    settled: f64,
    farthest: Option<Farthest>,
    queries: u64,
}

impl Found {
    fn new() -> Self {
        Self { cells: Vec::new(), settled: 0.0, farthest: None, queries: 0 }
    }

    fn sort(&mut self, cell: &Cell, goal: &Goal) {
        if goal.is_met(cell.upper) {
            self.settled = self.settled.max(cell.upper);
        } else {
            self.cells.push(*cell);
        }
    }

    fn take(&mut self, search: &Search<'_>) {
        self.farthest = search.farthest;
        self.queries = search.queries;
    }
}

/// The directed distance from `from` to `to`. `corners` are what is known of the corners of `from`; `absolute` is in
/// scaled units.
pub(super) fn directed(
    from: &Side<'_>,
    to: &Side<'_>,
    corners: &Corners,
    options: &Distances,
    (absolute, scale): (f64, Scale),
    exec: &Exec,
) -> Result<DirectedHausdorff, JudgeError> {
    let mut goal = Goal { lower: 0.0, relative: options.relative_gap, absolute };
    let mut farthest = farthest_corner(from, corners);
    goal.lower = farthest.lower;
    let (mut settled, mut queries, mut splits, mut rounds) = (0.0f64, from.positions.len() as u64, 0u64, 0u64);
    // Whole elements first. As many cells as there are elements may be left.
    let mut memory = vec![exec.reserve_elements(from.triangles.len() as u64, 2 * size_of::<Cell>())?];
    let mut room = from.triangles.len() as u64;
    let start = exec.part(0.0, 0.3);
    let whole = parallel::map_chunks(&start, from.triangles.len(), 256, |range| {
        let (mut search, mut found) = (Search::new(to, goal), Found::new());
        for triangle in range {
            let probes = from.triangles[triangle].map(|corner| &corners.probes[corner as usize]);
            let cell = search.whole(from.corners(triangle as u32), probes, triangle as u32);
            found.sort(&cell, &goal);
        }
        found.take(&search);
        Ok::<_, Stop>(found)
    })?;
    let mut queue = Queue::default();
    let mut collect = |parts: Vec<Found>, queue: &mut Queue, settled: &mut f64, queries: &mut u64| {
        for part in parts {
            *settled = settled.max(part.settled);
            *queries += part.queries;
            farthest = part.farthest.map_or(farthest, |other| farthest.or(other));
            part.cells.into_iter().for_each(|cell| queue.push(cell));
        }
        farthest
    };
    goal.lower = collect(whole, &mut queue, &mut settled, &mut queries).lower;
    let rest = exec.part(0.3, 1.0);
    let mut batch: Vec<Cell> = Vec::with_capacity(ROUND);
    let mut open = 0.0f64;
    loop {
        batch.clear();
        settled = settled.max(queue.take(&goal, ROUND, &mut batch));
        if batch.is_empty() {
            break;
        }
        rest.progress((goal.lower / batch[0].upper).clamp(0.0, 1.0));
        // Each cell becomes three at most, for which there must be room.
        let needed = (queue.len + 3 * ROUND) as u64;
        if splits >= u64::from(options.max_splits) || !make_room(needed, &mut room, &mut memory, exec) {
            open = batch.iter().map(|cell| cell.upper).fold(queue.worst(), f64::max);
            break;
        }
        splits += batch.len() as u64;
        rounds += 1;
        let parts = parallel::map_chunks(&rest, batch.len(), CHUNK, |range| {
            let (mut search, mut found) = (Search::new(to, goal), Found::new());
            let mut pieces = Vec::new();
            for cell in &batch[range] {
                search.split(cell, &mut pieces);
                if pieces.is_empty() {
                    found.settled = found.settled.max(cell.upper);
                }
                pieces.iter().for_each(|piece| found.sort(piece, &goal));
            }
            found.take(&search);
            Ok::<_, Stop>(found)
        })?;
        goal.lower = collect(parts, &mut queue, &mut settled, &mut queries).lower;
    }
    drop(memory);
    exec.progress(1.0);
    let farthest = collect(Vec::new(), &mut queue, &mut settled, &mut queries);
    let upper = settled.max(open).max(farthest.lower);
    Ok(DirectedHausdorff {
        lower: scale.length_down(farthest.lower),
        upper: scale.length_up(upper),
        witness: Witness {
            point: scale.point(farthest.place),
            element: farthest.root,
            nearest: scale.point(farthest.probe.point),
            nearest_element: farthest.probe.element,
        },
        converged: goal.is_met(upper),
        queries,
        splits,
        rounds,
    })
}

/// Takes memory for more cells where there is none left; false where the budget has none.
fn make_room(needed: u64, room: &mut u64, memory: &mut Vec<Reservation>, exec: &Exec) -> bool {
    while *room < needed {
        match exec.reserve_elements(CELLS, 2 * size_of::<Cell>()) {
            Ok(more) => memory.push(more),
            Err(_) => return false,
        }
        *room += CELLS;
    }
    true
}

/// The corner that is farthest away, with the first triangle that names it. There is a triangle.
fn farthest_corner(from: &Side<'_>, corners: &Corners) -> Farthest {
    let at = |triangle: usize, corner: u32| {
        let corner = corner as usize;
        Farthest::new(from.positions[corner], triangle as u32, corners.probes[corner], 0)
    };
    let mut farthest = at(0, from.triangles[0][0]);
    for (triangle, named) in from.triangles.iter().enumerate() {
        farthest = named.iter().fold(farthest, |farthest, &corner| farthest.or(at(triangle, corner)));
    }
    farthest
}
