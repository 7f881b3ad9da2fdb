//! The converter.

use std::collections::BinaryHeap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Aabb, Affine, Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report,
    Reservation, Severity, options,
};

use super::difference::{Farthest, Heights};
use super::lattice_delaunay::{LatticeDelaunay, NONE};
use super::outline::WholeCells;
use super::twisted_cell::CellCut;
use crate::stray_samples::tell_strays;
use crate::{Column, Domain, HeightField, MeshError, TEXCOORD, TriMesh};

options! {
    /// Cuts a height field into few triangles within a proven tolerance: large ones where it is flat, small ones where it is
    /// not.
    ///
    /// Greedy insertion (Garland and Heckbert 1995): a Delaunay triangulation in plan starts with the corners of the
    /// grid and the outline of the holes, and gets the sample at which it is farthest from the surface until it is near
    /// enough everywhere. How far a triangle is from the bilinear surface is computed in closed form over all of it, not
    /// at samples alone. Where both triangles of a cell are still too far from it, because the cell is twisted, it is cut
    /// finer inside. Holes are those of `triangulate-height-field`: a cell that touches one is left out. In plan triangles
    /// cover the whole cells exactly, share whole sides and never turn over. Cost: about samples times the logarithm of
    /// the number of triangles.
    pub struct GreedyInsertion("greedy-insertion") {
        required {
            /// How far triangles may be from the bilinear surface of the samples, measured along the heights as the field is
            /// placed, in model units.
            tolerance: f64 [Bounds::NON_NEGATIVE],
        }
        optional {
            /// Into how many steps a side a twisted cell is cut at most: the triangles come within a quarter of the cell's
            /// twist, over the square of the steps.
            max_cell_steps: u32 [Bounds::closed(1.0, 1024.0)] = 16,
        }
    }
}

impl FromTolerance<HeightField> for GreedyInsertion {
    fn from_tolerance(_: &HeightField, tolerance: f64) -> Self {
        Self::new(tolerance)
    }
}

impl Convert<HeightField> for GreedyInsertion {
    type Output = TriMesh;

    fn convert_with(&self, source: &HeightField, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let largest = source.heights().iter().copied().map(f64::abs).fold(0.0, f64::max);
        // Differences of differences of heights stay finite.
        let scale = if largest > 1e150 { 2f64.powi(-600) } else { 1.0 };
        let heights = Heights { heights: source.heights(), columns: source.columns(), scale };
        // What rounding may do to a difference: a few roundings of numbers of the size of the heights.
        let rounding = 32.0 * f64::EPSILON * largest * scale;
        let stretch = source.placement().vector(DVec3::Z).length();
        let within = if stretch > 0.0 { self.tolerance / stretch * scale } else { f64::INFINITY };
        let threshold = (within - rounding).max(rounding);

        let mut refinement = Refinement::new(source, heights, exec)?;
        refinement.draw_outline(exec)?;
        refinement.refine(threshold, &exec.part(0.0, 0.9))?;
        let made = refinement.finish(self, threshold, &exec.part(0.9, 1.0))?;

        // Positions are rounded where they are placed: a few units in the last place of the largest coordinate. In the field's
        // own frame heights are as they were.
        let bounds = Aabb::from_points(made.mesh.positions().iter().copied());
        let placing = match made.mesh.positions().is_empty() || *source.placement() == Affine::IDENTITY {
            true => 0.0,
            false => 8.0 * f64::EPSILON * bounds.min.abs().max(bounds.max.abs()).max_element(),
        };
        let height_error = made.worst / scale;
        let deviation = match made.worst <= rounding || stretch == 0.0 {
            true => Deviation::Exact,
            false => Deviation::AtMost((made.worst + rounding) / scale * stretch * (1.0 + 1e-14) + placing),
        };
        let basis = "the largest difference along the heights from the bilinear surface, in closed form over every \
                     triangle; both are heights over the same cells, so neither is farther from the other";
        let mut report = Report::new(Self::NAME, deviation, basis);
        let message =
            "cells are twisted too much for the tolerance even cut most finely; they are as near as that gives";
        let places = made.missed.iter().map(|&cell| Place::element("cell", cell));
        report.findings.push_all("W-height-tolerance", Severity::Warning, message, made.missed_count, places);
        report.figure("vertices", made.mesh.positions().len() as f64);
        report.figure("triangles", made.mesh.triangles().len() as f64);
        report.figure("regular_triangles", 2.0 * refinement.cells.count() as f64);
        report.figure("height_error", height_error);
        report.figure("cells_cut_finer", made.cut_finer as f64);
        tell_strays(source, &mut report, exec)?;
        exec.progress(1.0);
        Ok(Converted::new(made.mesh, report))
    }
}

/// Bytes for each triangle while the triangulation grows, its share of the points and of the queue with it, and room to
/// move to larger arrays.
const BYTES_A_TRIANGLE: usize = 192;

/// What is known of a triangle.
#[derive(Clone, Copy, Default)]
struct Known {
    farthest: Farthest,
    /// How often it changed: what the queue says of earlier ones does not count.
    version: u32,
    in_hole: bool,
}

struct Refinement<'a> {
    field: &'a HeightField,
    heights: Heights<'a>,
    cells: WholeCells,
    mesh: LatticeDelaunay,
    known: Vec<Known>,
    /// A bit for each sample: whether it is a point of the triangulation.
    taken: Vec<u64>,
    room: usize,
    memory: Vec<Reservation>,
}

struct Made {
    mesh: TriMesh,
    worst: f64,
    missed: Vec<u64>,
    missed_count: u64,
    cut_finer: u64,
}

/// First the triangle with the largest error; between equal ones that with the lowest number.
type Ticket = (u64, u32, u32);

impl<'a> Refinement<'a> {
    fn new(field: &'a HeightField, heights: Heights<'a>, exec: &Exec) -> Result<Self, ConvertError> {
        let words = field.heights().len().div_ceil(64);
        let memory = vec![exec.reserve_elements(words as u64, 8)?];
        let cells = WholeCells::of(field, exec)?;
        let mesh = LatticeDelaunay::new(field.columns() - 1, field.rows() - 1);
        let mut made = Self { field, heights, cells, mesh, known: Vec::new(), taken: vec![0; words], room: 0, memory };
        for point in made.mesh.points().to_vec() {
            let sample = made.sample(point);
            made.taken[sample / 64] |= 1 << (sample % 64);
        }
        Ok(made)
    }

    fn sample(&self, [x, y]: [u32; 2]) -> usize {
        y as usize * self.field.columns() as usize + x as usize
    }

    fn is_taken(&self, point: [u32; 2]) -> bool {
        let sample = self.sample(point);
        self.taken[sample / 64] >> (sample % 64) & 1 == 1
    }

    /// Inserts a sample, with memory for what it makes, and returns the number of its point.
    fn insert(&mut self, point: [u32; 2], near: Option<u32>, exec: &Exec) -> Result<u32, ConvertError> {
        if self.mesh.triangles().len() + 2 > self.room {
            let more = self.room.max(64);
            self.memory.push(exec.reserve_elements(more as u64, BYTES_A_TRIANGLE)?);
            self.room += more;
        }
        let sample = self.sample(point);
        self.taken[sample / 64] |= 1 << (sample % 64);
        Ok(self.mesh.insert(point, near))
    }

    /// Makes the outline of the holes sides that stay: its corners are inserted, then the middles of runs that are no sides
    /// yet. This ends, because the circle over a side of length 1 holds no other point of the lattice: it is in every
    /// Delaunay triangulation of its ends and others.
    fn draw_outline(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let runs = self.cells.runs(exec)?;
        // The runs, and the sides that they become.
        let _memory = exec.reserve_elements(runs.len() as u64, 2 * 16 + 3 * 16)?;
        let mut sides = Vec::with_capacity(runs.len());
        for (number, [p, q]) in runs.into_iter().enumerate() {
            if number % 256 == 0 {
                exec.check()?;
            }
            sides.push([self.insert(p, None, exec)?, self.insert(q, None, exec)?]);
        }
        let mut steps = 0u32;
        while let Some([a, b]) = sides.pop() {
            if steps.is_multiple_of(256) {
                exec.check()?;
            }
            steps = steps.wrapping_add(1);
            if self.mesh.fix(a, b) {
                continue;
            }
            let [p, q] = [a, b].map(|point| self.mesh.points()[point as usize]);
            let middle = [p[0].midpoint(q[0]), p[1].midpoint(q[1])];
            assert!(middle != p && middle != q, "a side of length 1 is in every Delaunay triangulation");
            let middle = self.insert(middle, None, exec)?;
            sides.extend([[a, middle], [middle, b]]);
        }
        Ok(())
    }

    /// Whether a triangle lies in a hole. No outline crosses it, so the cell at its centroid tells.
    fn is_in_hole(&self, corners: [[u32; 2]; 3]) -> bool {
        let [x, y] = [0, 1].map(|axis| (corners.iter().map(|corner| u64::from(corner[axis])).sum::<u64>() / 3) as u32);
        !self.cells.has(x, y)
    }

    fn place(&self, triangle: u32) -> [[u32; 2]; 3] {
        self.mesh.triangles()[triangle as usize].corners.map(|point| self.mesh.points()[point as usize])
    }

    /// Measures a triangle that is new or changed.
    fn measure(&mut self, triangle: u32, exec: &Exec) -> Result<Option<Ticket>, ConvertError> {
        let corners = self.place(triangle);
        let in_hole = self.is_in_hole(corners);
        let farthest = if in_hole { Farthest::default() } else { self.heights.farthest(corners, exec)? };
        let index = triangle as usize;
        if index >= self.known.len() {
            self.known.resize(index + 1, Known::default());
        }
        let version = self.known[index].version.wrapping_add(1);
        self.known[index] = Known { farthest, version, in_hole };
        Ok((!in_hole).then_some((farthest.error.to_bits(), !triangle, version)))
    }

    fn refine(&mut self, threshold: f64, exec: &Exec) -> Result<(), ConvertError> {
        let worth = |ticket: &Ticket| f64::from_bits(ticket.0) > threshold;
        let mut queue: BinaryHeap<Ticket> = BinaryHeap::new();
        for triangle in 0..self.mesh.triangles().len() as u32 {
            if triangle.is_multiple_of(256) {
                exec.check()?;
            }
            queue.extend(self.measure(triangle, exec)?.filter(worth));
        }
        let first = queue.peek().map_or(threshold, |ticket| f64::from_bits(ticket.0));
        let mut changed = Vec::new();
        let mut steps = 0u64;
        while let Some((error, number, version)) = queue.pop() {
            let triangle = !number;
            let known = self.known[triangle as usize];
            if known.version != version {
                continue;
            }
            if steps.is_multiple_of(256) {
                exec.check()?;
                exec.progress((first / f64::from_bits(error)).ln() / (first / threshold).ln());
            }
            steps += 1;
            let Some(point) = self.next_point(&known.farthest, threshold) else { continue };
            self.insert(point, Some(triangle), exec)?;
            changed.clear();
            changed.extend_from_slice(self.mesh.changed());
            changed.sort_unstable();
            changed.dedup();
            for &triangle in &changed {
                queue.extend(self.measure(triangle, exec)?.filter(worth));
            }
            // A corner of the cell may lie in another triangle, and leave this one as it was: its turn comes again. This ends, as
            // every turn takes a sample.
            if changed.binary_search(&triangle).is_err() {
                queue.push((error, number, version));
            }
        }
        Ok(())
    }

    /// The sample to insert: the farthest one; where only points between samples are too far, a corner of their cell.
    /// None when all of these are points: then the triangle is half of the cell, as the cell's sides of length 1 are in
    /// the triangulation.
    fn next_point(&self, farthest: &Farthest, threshold: f64) -> Option<[u32; 2]> {
        if farthest.at_samples > threshold {
            return Some(farthest.sample);
        }
        let [x, y] = farthest.cell;
        [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].into_iter().find(|&corner| !self.is_taken(corner))
    }

    /// The triangles that are not in holes, twisted cells cut finer.
    fn finish(&self, options: &GreedyInsertion, threshold: f64, exec: &Exec) -> Result<Made, ConvertError> {
        let count = self.mesh.triangles().len();
        let mut total = [self.mesh.points().len() as u64, count as u64];
        let (mut worst, mut cut_finer) = (0.0f64, 0);
        let (mut missed, mut missed_count) = (Vec::new(), 0);
        for (index, known) in self.known.iter().enumerate() {
            if index % 4096 == 0 {
                exec.check()?;
            }
            if known.in_hole || known.farthest.error <= threshold {
                worst = worst.max(known.farthest.error);
                continue;
            }
            let Some(cell) = self.cell_of(index) else { continue };
            let (cut, twist) = self.cut(cell, options, threshold);
            let error = cut.error(twist);
            worst = worst.max(error);
            total = [0, 1].map(|i| total[i] + cut.counts()[i]);
            cut_finer += 1;
            if error > threshold {
                missed_count += 1;
                if missed.len() < 16 {
                    missed.push(u64::from(cell[1]) * u64::from(self.field.columns() - 1) + u64::from(cell[0]));
                }
            }
        }
        // Positions and texture coordinates, triangles, and once more for turning all round.
        let [points, triangles] = total;
        let _memory =
            exec.reserve(points.saturating_mul(40).saturating_add(triangles.saturating_mul(12)).saturating_mul(2))?;
        let mut output = Output::new(self.field, total);
        let mut vertex_of = vec![NONE; self.mesh.points().len()];
        let mut polled = None;
        for index in 0..count {
            // A cell may be millions of triangles.
            let done = (index + output.triangles.len()) / 4096;
            if polled.replace(done) != Some(done) {
                exec.check()?;
                exec.progress(index as f64 / count as f64);
            }
            let known = &self.known[index];
            if known.in_hole {
                continue;
            }
            let corners = self.mesh.triangles()[index].corners;
            let mut vertex = |point: u32, output: &mut Output<'_>| {
                let vertex = &mut vertex_of[point as usize];
                if *vertex == NONE {
                    *vertex = output.sample(self.mesh.points()[point as usize]);
                }
                *vertex
            };
            if known.farthest.error <= threshold {
                let triangle = corners.map(|point| vertex(point, &mut output));
                output.triangles.push(triangle);
                continue;
            }
            let Some(cell) = self.cell_of(index) else { continue };
            let (other, cut) = (self.other_half(index), self.cut(cell, options, threshold).0);
            let ring = self.ring(cell, corners, self.mesh.triangles()[other as usize].corners);
            let mut ids = ring.map(|point| vertex(point, &mut output)).to_vec();
            ids.extend(cut.vertices().into_iter().map(|part| output.inside(cell, part)));
            output.triangles.extend(cut.triangles().into_iter().map(|t| t.map(|i| ids[i as usize])));
        }
        Ok(Made { mesh: output.into_mesh()?, worst, missed, missed_count, cut_finer })
    }

    fn cut(&self, [x, y]: [u32; 2], options: &GreedyInsertion, threshold: f64) -> (CellCut, f64) {
        let twist = self.heights.twist(x, y);
        (CellCut::new(twist, threshold, options.max_cell_steps), twist)
    }

    /// The triangle beside the slanted side of half a cell.
    fn other_half(&self, half: usize) -> u32 {
        let triangle = self.mesh.triangles()[half];
        let corners = self.place(half as u32);
        let slanted = (0..3).find(|&side| {
            let (p, q) = (corners[(side + 1) % 3], corners[(side + 2) % 3]);
            p[0] != q[0] && p[1] != q[1]
        });
        slanted.map_or(NONE, |side| triangle.beside[side])
    }

    /// The cell of which a triangle is a half, named by the half with the lower number alone.
    fn cell_of(&self, half: usize) -> Option<[u32; 2]> {
        let corners = self.place(half as u32);
        let least = [0, 1].map(|axis| corners[0][axis].min(corners[1][axis]).min(corners[2][axis]));
        (self.other_half(half) > half as u32).then_some(least)
    }

    /// The points at the corners of a cell, going round from the lowest.
    fn ring(&self, cell: [u32; 2], half: [u32; 3], other: [u32; 3]) -> [u32; 4] {
        [[0, 0], [1, 0], [1, 1], [0, 1]].map(|step| {
            let corner = [cell[0] + step[0], cell[1] + step[1]];
            let found = half.into_iter().chain(other).find(|&point| self.mesh.points()[point as usize] == corner);
            found.expect("a triangle that stays too far is half of a cell")
        })
    }
}

/// The mesh as it grows.
struct Output<'a> {
    field: &'a HeightField,
    positions: Vec<DVec3>,
    coordinates: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Output<'a> {
    fn new(field: &'a HeightField, [points, triangles]: [u64; 2]) -> Self {
        Self {
            field,
            positions: Vec::with_capacity(points as usize),
            coordinates: Vec::with_capacity(points as usize),
            triangles: Vec::with_capacity(triangles as usize),
        }
    }

    fn push(&mut self, x: f64, y: f64, height: f64) -> u32 {
        let spacing = self.field.spacing();
        let vertex = self.positions.len() as u32;
        self.positions.push(self.field.placement().point(DVec3::new(x * spacing.x, y * spacing.y, height)));
        self.coordinates.push([x / f64::from(self.field.columns() - 1), y / f64::from(self.field.rows() - 1)]);
        vertex
    }

    fn height(&self, x: u32, y: u32) -> f64 {
        self.field.heights()[y as usize * self.field.columns() as usize + x as usize]
    }

    fn sample(&mut self, [x, y]: [u32; 2]) -> u32 {
        self.push(f64::from(x), f64::from(y), self.height(x, y))
    }

    /// A point of the bilinear surface inside a cell.
    fn inside(&mut self, [x, y]: [u32; 2], [s, t]: [f64; 2]) -> u32 {
        let row = |y: u32| self.height(x, y) * (1.0 - s) + self.height(x + 1, y) * s;
        let height = row(y) * (1.0 - t) + row(y + 1) * t;
        self.push(f64::from(x) + s, f64::from(y) + t, height)
    }

    fn into_mesh(self) -> Result<TriMesh, MeshError> {
        let mut mesh = TriMesh::try_new(self.positions, self.triangles)?;
        mesh.insert_attribute(Domain::Vertex, Column::texcoords(TEXCOORD, &self.coordinates))?;
        Ok(if self.field.placement().reverses_orientation() { mesh.reversed() } else { mesh })
    }
}
