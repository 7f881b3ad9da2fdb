//! A run of layers of cells, from samples to vertices and triangles.

use std::ops::Range;

use multiversion::multiversion;
use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Affine, ConvertError, Exec, Reservation};
use shapeloom_mesh::MeshError;

use super::batch::{BATCH, Batch, directions, gradients, means, place};
use super::cell::{Cell, Surroundings};
use super::cell_layer::{CellLayer, SplitCell};
use super::cell_tables::{PIECES, SIMPLE, double_face};
use super::quads::{Around, add_quads};
use super::sign_slice::{Frame, SignSlice};
use super::slab_ring::{KEPT, SlabRing};
use super::{Placed, VertexRule};
use crate::growth::{give_back, grow};
use crate::{Inside, Level, Slabs};

/// What does not change from layer to layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) frame: Frame,
    pub(super) level: Level,
    pub(super) placement: Affine,
    /// Whether normals are made, and the matrix that maps them, up to a positive factor.
    pub(super) normals: bool,
    pub(super) cofactors: DMat3,
}

/// The vertices and triangles of a run of layers.
#[derive(Default)]
pub(super) struct Made {
    /// Places of the vertices, those of the layer below the run before its own.
    pub(super) positions: Vec<DVec3>,
    /// Their normals, if they were asked for.
    pub(super) normals: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The vertices without triangles, in order: all edges that they stand for lie on an open border, but not all of their cell's.
    pub(super) unused: Vec<u32>,
    /// How many vertices belong to the layer below the run.
    pub(super) borrowed: usize,
    /// Samples of the run's slices that are not finite.
    pub(super) not_finite: u64,
    /// Vertices of the run's own layers that would have left their cells.
    pub(super) held: u64,
    /// The memory of all this.
    pub(super) memory: Vec<Reservation>,
}

/// Work between two polls, in words of signs.
const POLL: usize = 1 << 15;

/// The same, in cells that are looked at one by one.
const AT_ONCE: usize = 1024;

/// Makes a run of layers. Each needs the signs of the slices around it and of those next to them.
pub(super) fn make<S: Slabs + ?Sized, R: VertexRule>(
    slabs: &S,
    rule: &R,
    plan: &Plan,
    layers: Range<usize>,
    exec: &Exec,
) -> Result<Made, ConvertError> {
    let frame = &plan.frame;
    let start = layers.start.saturating_sub(1);
    let last_slice = frame.padded(2) - 1;
    let mut made = Made::default();
    let mut ring = SlabRing::default();
    let mut signs: [SignSlice; KEPT] = Default::default();
    let mut spare: [Vec<f32>; KEPT] = Default::default();
    let [mut below, mut layer] = [CellLayer::default(), CellLayer::default()];
    let mut collector = Collector::new(plan);
    let mut next_slice = start.saturating_sub(1);
    let rows_at_once = (POLL / frame.stride).max(1);
    for k in start..layers.end {
        exec.check()?;
        let done = (k + 1 - start) as f64 / (layers.end - start) as f64;
        while next_slice <= (k + 2).min(last_slice) {
            let slice = &mut signs[next_slice % KEPT];
            match frame.slab(next_slice) {
                Some(slab) => {
                    let not_finite = ring.fetch(slabs, slab, |samples| slice.fill(samples, plan.level, frame))?;
                    // Every slice is counted by one run: that with the layer above it.
                    let own = layers.contains(&next_slice) || next_slice == layers.end && layers.end == last_slice;
                    made.not_finite += if own { not_finite } else { 0 };
                }
                None => slice.clear(frame),
            }
            next_slice += 1;
        }
        let (lower, upper) = (&signs[k % KEPT], &signs[(k + 1) % KEPT]);
        let count = layer.find(frame, k, lower, upper);
        let before = made.positions.len();
        // At most four vertices a cell; the numbers of one run must fit.
        let found = before as u64 + 4 * count;
        if found >= u64::from(u32::MAX) {
            return Err(MeshError::TooMany { kind: "vertices", found }.into());
        }
        layer.number_from(before as u32);
        if count > 0 {
            grow(&mut made.positions, before + count as usize, done, &mut made.memory, exec)?;
            if plan.normals {
                grow(&mut made.normals, before + count as usize, done, &mut made.memory, exec)?;
            }
            let slice = |from_layer: usize| (k + from_layer).checked_sub(1).and_then(|slice| frame.slab(slice));
            let slabs_around = ring.views(slabs, &mut spare, [0, 1, 2, 3].map(slice))?;
            collector.begin(k);
            for rows in parts(frame.cells(1), rows_at_once) {
                exec.check()?;
                collect(&mut collector, plan, &layer, [lower, upper], slabs_around, rows, !R::MEAN_WILL_DO, &mut made);
            }
            collector.flush(plan, !R::MEAN_WILL_DO, &mut made);
            let surroundings = Surroundings { slabs: slabs_around, frame: *frame, level: plan.level, layer: k };
            revise(
                &mut layer,
                &collector.special,
                rule,
                plan,
                &signs,
                &surroundings,
                &mut made,
                (k >= layers.start, done),
                exec,
            )?;
        }
        if k >= layers.start {
            let around = Around {
                frame: *frame,
                lower,
                upper,
                layer: &layer,
                below: (k > 0).then_some(&below),
                positions: &made.positions,
                mirrored: plan.placement.reverses_orientation(),
            };
            if count > 0 {
                for rows in parts(frame.cells(1), rows_at_once) {
                    exec.check()?;
                    // Each cell has three edges of its own.
                    let (from, to) = (rows.start * frame.stride, rows.end * frame.stride);
                    let cells: usize = layer.active[from..to].iter().map(|word| word.count_ones() as usize).sum();
                    let needed = made.triangles.len() + 6 * cells;
                    grow(&mut made.triangles, needed, done, &mut made.memory, exec)?;
                    add_quads(&around, rows, &mut made.triangles);
                }
            }
            exec.progress((k - layers.start + 1) as f64 / layers.len() as f64);
        } else {
            made.borrowed = made.positions.len();
        }
        std::mem::swap(&mut below, &mut layer);
    }
    made.unused.sort_unstable();
    give_back(&mut made.positions);
    give_back(&mut made.normals);
    give_back(&mut made.triangles);
    Ok(made)
}

/// Ranges of so many rows at most.
fn parts(rows: usize, size: usize) -> impl Iterator<Item = Range<usize>> {
    (0..rows).step_by(size).map(move |from| from..(from + size).min(rows))
}

/// A cell that is looked at on its own.
#[derive(Clone, Copy, Debug)]
struct Special {
    key: u64,
    cell: [u32; 2],
    vertex: u32,
}

/// Gathers cells and makes their first vertices, many at once.
struct Collector {
    batch: Box<Batch>,
    /// The iso value where smaller is inside, and the sign that makes it so.
    iso: f32,
    sign: f32,
    layer: usize,
    special: Vec<Special>,
    /// For each row of the layer's cells whether none of their samples is large or not finite.
    tame: Vec<bool>,
    /// A row of outside samples.
    outside: Vec<f32>,
}

impl Collector {
    fn new(plan: &Plan) -> Self {
        let sign = if plan.level.inside == Inside::Below { 1.0 } else { -1.0 };
        let iso = plan.level.iso * sign;
        let outside = vec![f32::INFINITY * sign; plan.frame.samples[0]];
        Self { batch: Batch::new(), iso, sign, layer: 0, special: Vec::new(), tame: Vec::new(), outside }
    }

    fn begin(&mut self, layer: usize) {
        self.layer = layer;
        self.special.clear();
        self.tame.clear();
    }

    /// Makes the vertices of the cells that are waiting.
    fn flush(&mut self, plan: &Plan, everywhere: bool, made: &mut Made) {
        let batch = &mut *self.batch;
        means(&batch.corners, self.iso, &mut batch.places, &mut batch.insides);
        if plan.normals {
            gradients(&batch.corners, &batch.places, &mut batch.gradients);
        }
        let pad = plan.frame.pad as f64;
        let from = DVec3::new(-pad, -pad, self.layer as f64 - pad);
        place(batch, from, &plan.placement.linear, plan.placement.translation);
        let first = made.positions.len() as u32;
        let [x, y, z] = &batch.positions;
        made.positions.extend((0..batch.len).map(|n| DVec3::new(x[n], y[n], z[n])));
        if plan.normals {
            directions(batch, &plan.cofactors);
            let [x, y, z] = &batch.normals;
            made.normals.extend((0..batch.len).map(|n| [x[n], y[n], z[n]]));
        }
        for n in 0..batch.len {
            let [column, row] = [batch.cells[0][n], batch.cells[1][n]];
            let simple = SIMPLE[(batch.insides[n] & 255) as usize] && self.tame[row as usize];
            if everywhere || !simple || plan.normals && !batch.sloped[n] {
                let vertex = first + n as u32;
                self.special.push(Special { key: batch.keys[n], cell: [column, row], vertex });
            }
        }
        batch.len = 0;
    }
}

/// Gathers the cells of some rows that the surface passes through.
#[allow(clippy::too_many_arguments)]
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn collect(
    collector: &mut Collector,
    plan: &Plan,
    layer: &CellLayer,
    slices: [&SignSlice; 2],
    slabs: [Option<&[f32]>; KEPT],
    rows: Range<usize>,
    everywhere: bool,
    made: &mut Made,
) {
    let frame = &plan.frame;
    let (columns, pad, stride) = (frame.samples[0], frame.pad, frame.stride);
    let sign = collector.sign;
    let outside = std::mem::take(&mut collector.outside);
    let tame_iso = collector.iso.abs() < crate::inside_bits::LARGE;
    for row in rows {
        let samples = |slab: Option<&'_ [f32]>, row: usize| -> Option<Range<usize>> {
            let j = row.checked_sub(pad).filter(|&j| j < frame.samples[1])?;
            slab.map(|_| j * columns..(j + 1) * columns)
        };
        let row_of = |slab: usize, row: usize| match (slabs[slab], samples(slabs[slab], row)) {
            (Some(values), Some(range)) => &values[range],
            _ => outside.as_slice(),
        };
        // Corners 0, 2, 4, 6 begin the four rows around the cells.
        let around = [row_of(1, row), row_of(1, row + 1), row_of(2, row), row_of(2, row + 1)];
        let tame = |slice: &SignSlice| slice.tame[row] && slice.tame[row + 1];
        collector.tame.push(tame_iso && tame(slices[0]) && tame(slices[1]));
        for word in 0..stride {
            let f = row * stride + word;
            let mut active = layer.active[f];
            while active != 0 {
                let bit = active.trailing_zeros();
                active &= active - 1;
                let column = word * 64 + bit as usize;
                let n = collector.batch.len;
                let left = column.wrapping_sub(pad);
                for (r, samples) in around.iter().enumerate() {
                    let [low, high] = match samples.get(left..left.wrapping_add(2)) {
                        Some(&[low, high]) => [low, high],
                        _ => [left, left.wrapping_add(1)].map(|i| samples.get(i).copied().unwrap_or(outside[0])),
                    };
                    collector.batch.corners[2 * r][n] = low * sign;
                    collector.batch.corners[2 * r + 1][n] = high * sign;
                }
                collector.batch.cells[0][n] = column as u32;
                collector.batch.cells[1][n] = row as u32;
                collector.batch.keys[n] = f as u64 * 64 + u64::from(bit);
                collector.batch.len = n + 1;
                if n + 1 == BATCH {
                    collector.flush(plan, everywhere, made);
                }
            }
        }
    }
    collector.outside = outside;
}

/// Looks at special cells one by one: more vertices where the surface has several pieces in a cell, and places by the rule.
#[allow(clippy::too_many_arguments)]
fn revise<R: VertexRule>(
    layer: &mut CellLayer,
    special: &[Special],
    rule: &R,
    plan: &Plan,
    signs: &[SignSlice; KEPT],
    surroundings: &Surroundings<'_>,
    made: &mut Made,
    (own, done): (bool, f64),
    exec: &Exec,
) -> Result<(), ConvertError> {
    let frame = &plan.frame;
    for (count, special) in special.iter().enumerate() {
        if count % AT_ONCE == 0 {
            exec.check()?;
            // A cell has four vertices at most, and one of them already.
            let more = made.positions.len() + 3 * AT_ONCE;
            grow(&mut made.positions, more, done, &mut made.memory, exec)?;
            if plan.normals {
                grow(&mut made.normals, more, done, &mut made.memory, exec)?;
            }
            let more = made.unused.len() + 4 * AT_ONCE;
            grow(&mut made.unused, more, done, &mut made.memory, exec)?;
        }
        let [column, row] = special.cell.map(|at| at as usize);
        let corners = corners_at(frame, signs, [column, row, surroundings.layer]).unwrap_or(0);
        let joined = double_face(corners).is_some_and(|face| {
            let mut beside = [column, row, surroundings.layer];
            let other = match face % 2 {
                0 => beside[face / 2].checked_sub(1),
                _ => Some(beside[face / 2] + 1),
            };
            // Where both cells would have two edges between the same vertices.
            other.is_some_and(|at| {
                beside[face / 2] = at;
                corners_at(frame, signs, beside).and_then(double_face) == Some(face ^ 1)
            })
        });
        let index = usize::from(corners) + if joined { 256 } else { 0 };
        let pieces = &PIECES[index];
        let cell = Cell::new(surroundings, column, row, corners);
        let second = made.positions.len() as u32;
        let at_border = frame.edges_at_border([column, row, surroundings.layer]);
        for piece in 0..usize::from(pieces.count) {
            let edges = pieces.edges[piece];
            let Placed { place, held } = rule.vertex(&cell, edges);
            made.held += u64::from(held && own);
            let position = plan.placement.point(cell.lattice_place() + place);
            let vertex = if piece == 0 { special.vertex } else { second + piece as u32 - 1 } as usize;
            if edges & !at_border == 0 {
                made.unused.push(vertex as u32);
            }
            let normal = plan.normals.then(|| plan.placement.normal(rule.outward(&cell, edges, place)));
            if piece == 0 {
                made.positions[vertex] = position;
                if let Some(normal) = normal {
                    made.normals[vertex] = normal.to_array();
                }
            } else {
                made.positions.push(position);
                if let Some(normal) = normal {
                    made.normals.push(normal.to_array());
                }
            }
        }
        if pieces.count > 1 {
            layer.several[(special.key / 64) as usize] |= 1 << (special.key % 64);
            layer.splits.push(SplitCell { key: special.key, pieces: index as u16, second });
        }
    }
    Ok(())
}

/// The inside corners of a cell, a bit each; none if there is no such cell.
fn corners_at(frame: &Frame, signs: &[SignSlice; KEPT], [column, row, layer]: [usize; 3]) -> Option<u8> {
    if column >= frame.cells(0) || row >= frame.cells(1) || layer >= frame.cells(2) {
        return None;
    }
    let inside = |corner: usize| {
        let slice = &signs[(layer + (corner >> 2)) % KEPT];
        slice.at(frame, column + (corner & 1), row + (corner >> 1 & 1))
    };
    Some((0..8).filter(|&corner| inside(corner)).fold(0, |corners, corner| corners | 1 << corner))
}
