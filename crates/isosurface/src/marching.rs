//! Marching over the cells of a lattice: what cubes and tetrahedra have in common.
//!
//! First every sample becomes a bit. From the bits follow, by operations on whole words, how many vertices each row of edges has,
//! hence the numbers of all vertices. Then vertices and triangles are written in order: by one thread to where they stay, by several
//! in blocks of layers that are put behind each other.

use std::ops::Range;

use multiversion::multiversion;
use shapeloom_core::parallel::{fill_chunks, map_chunks, workers};
use shapeloom_core::{ConvertError, Exec, Stop};
use shapeloom_mesh::MeshError;

use crate::cell_topology::CellTopology;
use crate::edge_batch::EdgeBatch;
use crate::growth::{give_back, grow};
use crate::lattice_bits::LatticeBits;
use crate::lattice_vertices::{EdgeRow, PLACES, Samples, Site, Vertices, bits_below, next_bits};
use crate::pattern::Pattern;
use crate::slab_window::SlabWindow;
use crate::{Level, Slabs};

/// How many layers of cells make a block. Larger ones leave less to do at the same time, smaller ones read more slabs twice.
const LAYERS: usize = 4;

/// How many samples a wave has, about: those of smaller ones are nearer when they are looked at again, larger ones have more
/// to do at the same time.
const WAVE_SAMPLES: usize = 1 << 20;

/// The planes of a wave: enough for four blocks, and so many that small lattices have few waves.
const LEAST_WAVE: usize = 16;
const MOST_WAVE: usize = 256;

/// Triangles that wait to be written together: a pattern has no more than twelve for a cell.
const WAITING: usize = 512;

/// Vertices and triangles, as they become a mesh.
#[derive(Debug, Default)]
pub(crate) struct Surface {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) normals: Option<Vec<[f64; 3]>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many vertices lie inside cells.
    pub(crate) inner_vertices: u64,
    /// The memory that the numbers of rows took, in bytes.
    pub(crate) working_bytes: u64,
}

/// The numbers of the first vertices in a row: on the edges of each direction that start there, and inside the cells.
#[derive(Clone, Copy, Debug)]
struct Row<const D: usize> {
    edges: [u32; D],
    inner: u32,
}

/// What marches: cubes or tetrahedra.
pub(crate) struct Marching<'a, S: ?Sized, const D: usize, const C: usize> {
    pub(crate) slabs: &'a S,
    pub(crate) level: Level,
    pub(crate) bits: LatticeBits,
    pub(crate) pattern: &'static Pattern<D, C>,
    /// Cells whose topology the samples decide; none where the pattern decides all.
    pub(crate) topology: Option<CellTopology>,
    /// Whether triangles are turned around, as those of the pattern are.
    pub(crate) mirrored: bool,
    pub(crate) normals: bool,
}

/// A layer of cells and where its rows' vertices are.
struct Layer<'a, const D: usize, const C: usize> {
    bits: &'a LatticeBits,
    pattern: &'a Pattern<D, C>,
    rows: &'a [Row<D>],
    k: usize,
}

/// Calls `visit` for the cells of a row that the surface goes through, with their place and which corners are inside.
#[inline(always)]
fn visit_cells(bits: &LatticeBits, j: usize, k: usize, mut visit: impl FnMut(usize, u8)) {
    let [a, b, c, d] = [bits.row(j, k), bits.row(j + 1, k), bits.row(j, k + 1), bits.row(j + 1, k + 1)];
    let cells = bits.dimensions[0] - 1;
    // Closures and adapters are not compiled for the wider vectors of the caller, so none here.
    for w in 0..a.len() {
        let left = [a[w], b[w], c[w], d[w]];
        let right = [next_bits(a, w), next_bits(b, w), next_bits(c, w), next_bits(d, w)];
        let any = left[0] | left[1] | left[2] | left[3] | right[0] | right[1] | right[2] | right[3];
        let all = left[0] & left[1] & left[2] & left[3] & right[0] & right[1] & right[2] & right[3];
        let mut active = any & !all & bits_below(cells, w);
        while active != 0 {
            let at = active.trailing_zeros();
            active &= active - 1;
            let mut mask = 0;
            for row in 0..4 {
                mask |= (left[row] >> at & 1) << (2 * row) | (right[row] >> at & 1) << (2 * row + 1);
            }
            visit(64 * w + at as usize, mask as u8);
        }
    }
}

/// The row of edges in a direction that starts at samples `(.., j, k)`, if the lattice has one.
#[inline(always)]
fn edge_row(bits: &LatticeBits, direction: u8, j: usize, k: usize) -> Option<EdgeRow<'_>> {
    let (y, z) = (j + usize::from(direction >> 1 & 1), k + usize::from(direction >> 2));
    let [columns, rows, slabs] = bits.dimensions;
    if y < rows && z < slabs { Some(EdgeRow { own: bits.row(j, k), other: bits.row(y, z), columns }) } else { None }
}

/// Counts the crossed edges of each row of a plane.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn count_edges<const D: usize>(bits: &LatticeBits, directions: &[u8; D], k: usize, rows: &mut [Row<D>]) {
    for (j, row) in rows.iter_mut().enumerate() {
        for (count, &direction) in row.edges.iter_mut().zip(directions) {
            if let Some(edges) = edge_row(bits, direction, j, k) {
                *count = edges.count(direction);
            }
        }
    }
}

/// Counts the triangles of a layer that the pattern decides.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn count_triangles<const D: usize, const C: usize>(bits: &LatticeBits, pattern: &Pattern<D, C>, k: usize) -> u64 {
    let mut triangles = 0;
    for j in 0..bits.dimensions[1] - 1 {
        visit_cells(bits, j, k, |_, mask| triangles += u64::from(pattern.count(mask)));
    }
    triangles
}

/// How many triangles a pattern gives in all.
pub(crate) fn count_all<const D: usize, const C: usize>(
    bits: &LatticeBits,
    pattern: &Pattern<D, C>,
    exec: &Exec,
) -> Result<u64, Stop> {
    if bits.dimensions.iter().any(|&count| count < 2) {
        return Ok(0);
    }
    let layers = map_chunks(exec, bits.dimensions[2] - 1, LAYERS, |layers| {
        Ok::<u64, Stop>(layers.map(|k| count_triangles(bits, pattern, k)).sum())
    })?;
    Ok(layers.into_iter().sum())
}

impl<const D: usize, const C: usize> Layer<'_, D, C> {
    /// What the counters say at the start of a row of cells.
    #[inline(always)]
    fn counters(&self, j: usize) -> [u32; C] {
        let rows = self.bits.dimensions[1];
        self.pattern
            .counters
            .map(|(direction, y, z)| self.rows[(self.k + z as usize) * rows + j + y as usize].edges[direction as usize])
    }

    /// Adds the triangles of the layer. `special` adds those of cells that the pattern does not decide: it gets the cell, its
    /// mask, the numbers of its vertices and where to write, and says whether it did; asked only where `SPECIAL`.
    #[inline(always)]
    fn write<const SPECIAL: bool>(
        &self,
        out: &mut Vec<[u32; 3]>,
        mut special: impl FnMut([usize; 2], u8, &[[u32; C]; 2], &mut Vec<[u32; 3]>) -> bool,
    ) {
        let mut waiting = [[0; 3]; WAITING];
        let mut count = 0;
        for j in 0..self.bits.dimensions[1] - 1 {
            let mut counters = self.counters(j);
            visit_cells(self.bits, j, self.k, |i, mask| {
                let before = counters;
                for (counter, step) in counters.iter_mut().zip(&self.pattern.steps[mask as usize]) {
                    *counter += step;
                }
                let numbers = [before, counters];
                let own = self.pattern.triangles(mask);
                // Before a cell by itself, too: triangles are in the order of the cells.
                if SPECIAL || count + own.len() > WAITING {
                    out.extend_from_slice(&waiting[..count]);
                    count = 0;
                }
                if SPECIAL && special([i, j], mask, &numbers, out) {
                    return;
                }
                let numbers = numbers.as_flattened();
                for (to, &[a, b, c]) in waiting[count..].iter_mut().zip(own) {
                    let (a, b, c) = (a as usize % (2 * C), b as usize % (2 * C), c as usize % (2 * C));
                    *to = [numbers[a], numbers[b], numbers[c]];
                }
                count += own.len();
            });
        }
        out.extend_from_slice(&waiting[..count]);
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn write_triangles<const D: usize, const C: usize>(layer: &Layer<'_, D, C>, out: &mut Vec<[u32; 3]>) {
    layer.write::<false>(out, |_, _, _, _| false);
}

/// Adds the vertices on the edges that start in a plane of samples, and room for those inside the cells of each row.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn write_vertices<const D: usize, const C: usize>(
    layer: &Layer<'_, D, C>,
    samples: &Samples<'_>,
    end: u32,
    vertices: &mut Vertices<'_>,
) {
    let (bits, k) = (layer.bits, layer.k);
    let row_count = bits.dimensions[1];
    let rows = &layer.rows[k * row_count..(k + 1) * row_count];
    for (j, row) in rows.iter().enumerate() {
        for (number, &direction) in layer.pattern.directions.iter().enumerate() {
            let end = if number + 1 < D { row.edges[number + 1] } else { row.inner };
            if row.edges[number] == end {
                continue;
            }
            let Some(edges) = edge_row(bits, direction, j, k) else { continue };
            match direction {
                1 => edges.vertices::<1>(samples, [j, k], vertices),
                2 => edges.vertices::<2>(samples, [j, k], vertices),
                3 => edges.vertices::<3>(samples, [j, k], vertices),
                4 => edges.vertices::<4>(samples, [j, k], vertices),
                5 => edges.vertices::<5>(samples, [j, k], vertices),
                6 => edges.vertices::<6>(samples, [j, k], vertices),
                _ => edges.vertices::<7>(samples, [j, k], vertices),
            }
        }
        vertices.skip(rows.get(j + 1).map_or(end, |next| next.edges[0]) - row.inner);
    }
    vertices.flush();
}

impl<S: Slabs + ?Sized, const D: usize, const C: usize> Marching<'_, S, D, C> {
    /// Runs, a wave of planes after the other, so that samples are looked at again while they are near.
    pub(crate) fn run(&mut self, exec: &Exec) -> Result<Surface, ConvertError> {
        let [_, row_count, planes] = self.bits.dimensions;
        let mut surface = Surface { normals: self.normals.then(Vec::new), ..Surface::default() };
        if self.bits.dimensions.iter().any(|&count| count < 2) {
            self.bits.read(self.slabs, self.level, 0..planes, exec)?;
            return Ok(surface);
        }
        let _of_rows = exec.reserve_elements((row_count * planes) as u64, size_of::<Row<D>>())?;
        let mut rows = vec![Row { edges: [0; D], inner: 0 }; row_count * planes];
        let mut layers = vec![0; planes];
        let mut starts = Vec::with_capacity(planes + 1);
        let mut memory = Vec::new();
        let (mut counted, mut written, mut vertices) = (0..0, 0..0, 0);
        let mut window = SlabWindow::new(self.slabs);
        let alone = workers(exec) == 1;
        let wave = match alone {
            true => LAYERS,
            false => (WAVE_SAMPLES / self.slabs.lattice().slab_len()).clamp(LEAST_WAVE, MOST_WAVE),
        };
        for first in (0..planes).step_by(wave) {
            exec.progress(first as f64 / planes as f64);
            let end = (first + wave).min(planes);
            self.bits.read(self.slabs, self.level, first..end, exec)?;
            // Edges reach to the next plane, and triangles to edges of the next plane.
            counted = counted.end..if end == planes { planes } else { end - 1 };
            self.count(counted.clone(), &mut rows, &mut layers, exec)?;
            let of_planes = &mut rows[counted.start * row_count..counted.end * row_count];
            // Numbering turns the counts into where they begin.
            surface.inner_vertices += of_planes.iter().map(|row| u64::from(row.inner)).sum::<u64>();
            vertices = number(of_planes, row_count, vertices, &mut starts)?;
            written = written.end..if end == planes { planes } else { counted.end - 1 };
            let faces = surface.triangles.len() as u64 + most_triangles(written.clone(), &starts, vertices, &layers);
            let known = first_of(&starts, written.end, vertices) as usize;
            let part = written.end as f64 / planes as f64;
            grow(&mut surface.positions, known, part, &mut memory, exec)?;
            grow(&mut surface.triangles, faces as usize, part, &mut memory, exec)?;
            if let Some(normals) = &mut surface.normals {
                grow(normals, known, part, &mut memory, exec)?;
            }
            if alone {
                self.write(written.clone(), 0, (&rows, &starts, vertices), &mut window, &mut surface, exec)?;
            } else {
                let of_blocks = (known - surface.positions.len()) as u64 * if self.normals { 48 } else { 24 };
                let _of_blocks = exec.reserve(of_blocks + 12 * (faces - surface.triangles.len() as u64))?;
                let blocks = map_chunks(exec, written.len(), LAYERS, |layers_of| {
                    let own = written.start + layers_of.start..written.start + layers_of.end;
                    let most = most_triangles(own.clone(), &starts, vertices, &layers);
                    let [first, end] = [own.start, own.end].map(|k| first_of(&starts, k, vertices));
                    let mut block = Surface::with_room((end - first) as usize, most as usize, self.normals);
                    let mut window = SlabWindow::new(self.slabs);
                    self.write(own, first, (&rows, &starts, vertices), &mut window, &mut block, exec)?;
                    Ok::<Surface, ConvertError>(block)
                })?;
                blocks.into_iter().for_each(|block| surface.append(block));
            }
            let wedges = 3 * surface.triangles.len() as u64;
            if wedges >= u64::from(u32::MAX) {
                return Err(MeshError::TooMany { kind: "wedges", found: wedges }.into());
            }
        }
        give_back(&mut surface.positions);
        give_back(&mut surface.triangles);
        surface.normals.iter_mut().for_each(give_back);
        surface.working_bytes = size_of_val(rows.as_slice()) as u64;
        Ok(surface)
    }

    /// Counts crossed edges and inner vertices of each row, and triangles of each layer where samples decide.
    fn count(
        &self,
        planes: Range<usize>,
        rows: &mut [Row<D>],
        layers: &mut [u64],
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        let row_count = self.bits.dimensions[1];
        let last = self.bits.dimensions[2] - 1;
        let rows = rows[planes.start * row_count..planes.end * row_count].chunks_mut(row_count);
        let mut counts: Vec<(&mut [Row<D>], &mut u64)> = rows.zip(&mut layers[planes.clone()]).collect();
        fill_chunks(exec, &mut counts, LAYERS, |first, part| {
            let mut window = SlabWindow::new(self.slabs);
            for (k, (rows, triangles)) in part.iter_mut().enumerate() {
                exec.check()?;
                let k = planes.start + first + k;
                count_edges(&self.bits, &self.pattern.directions, k, rows);
                if k == last {
                    continue;
                }
                if let Some(topology) = &self.topology {
                    **triangles = self.count_special(topology, k, rows, &mut window)?;
                }
            }
            Ok::<(), ConvertError>(())
        })
    }

    /// Calls `visit` with the samples around a layer of cells: beyond the two at it for gradients only.
    fn with_samples<T>(
        &self,
        window: &mut SlabWindow<'_, S>,
        k: usize,
        around: bool,
        visit: impl FnOnce(&Samples<'_>) -> T,
    ) -> Result<T, ConvertError> {
        let [columns, rows, slab_count] = self.slabs.lattice().dimensions();
        let wanted = [0, 1, 2, 3].map(|place| {
            let real = (k + place).checked_sub(1 + self.bits.margin).filter(|&real| real < slab_count as usize);
            real.filter(|_| around || place == 1 || place == 2).map(|real| real as u32)
        });
        for real in wanted.into_iter().flatten() {
            window.load(real)?;
        }
        let mut spare: [Vec<f32>; 4] = Default::default();
        let mut slabs = [None; 4];
        for ((slab, real), spare) in slabs.iter_mut().zip(wanted).zip(&mut spare) {
            if let Some(real) = real {
                *slab = Some(window.get(real, spare)?);
            }
        }
        Ok(visit(&Samples { slabs, columns: columns as usize, rows: rows as usize }))
    }

    /// As [`count_triangles`], where samples decide; and the inner vertices.
    fn count_special(
        &self,
        topology: &CellTopology,
        k: usize,
        rows: &mut [Row<D>],
        window: &mut SlabWindow<'_, S>,
    ) -> Result<u64, ConvertError> {
        let mut triangles = 0;
        self.with_samples(window, k, false, |samples| {
            for (j, row) in rows.iter_mut().enumerate().take(self.bits.dimensions[1] - 1) {
                visit_cells(&self.bits, j, k, |i, mask| {
                    let [own, inner] = topology.count(mask, || self.corners(samples, i, j));
                    triangles += u64::from(own);
                    row.inner += inner;
                });
            }
        })?;
        Ok(triangles)
    }

    /// The samples at the corners of a cell less the iso value, negative inside.
    fn corners(&self, samples: &Samples<'_>, i: usize, j: usize) -> [Option<f64>; 8] {
        let margin = self.bits.margin;
        [0, 1, 2, 3, 4, 5, 6, 7].map(|corner: usize| {
            let (x, y) = (i + (corner & 1), j + (corner >> 1 & 1));
            let sample = samples.get(x.wrapping_sub(margin), y.wrapping_sub(margin), corner >> 2);
            sample.filter(|sample| sample.is_finite()).map(|sample| self.level.depth(sample))
        })
    }

    /// Adds the vertices of planes and the triangles of the layers above them. The vertex `first` is at the start of the positions.
    fn write(
        &self,
        planes: Range<usize>,
        first: u32,
        (rows, starts, total): (&[Row<D>], &[u32], u64),
        window: &mut SlabWindow<'_, S>,
        out: &mut Surface,
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        let site = Site::new(self.slabs.lattice(), self.level, self.bits.margin, self.bits.tame);
        let last = self.bits.dimensions[2] - 1;
        let Surface { positions, normals, triangles, .. } = out;
        let (batch, normals) = (EdgeBatch::new(), normals.as_mut());
        let mut vertices = Vertices { site: &site, batch, places: [0; PLACES], first, positions, normals };
        for k in planes {
            exec.check()?;
            let layer = Layer { bits: &self.bits, pattern: self.pattern, rows, k };
            let [start, end, next] = [k, k + 1, k + 2].map(|k| first_of(starts, k, total));
            if start == next {
                continue;
            }
            if self.topology.is_none() {
                if k < last {
                    write_triangles(&layer, triangles);
                }
                if start == end {
                    continue;
                }
            }
            self.with_samples(window, k, self.normals, |samples| {
                write_vertices(&layer, samples, end, &mut vertices);
                if let Some(topology) = self.topology.as_ref().filter(|_| k < last) {
                    self.write_special(topology, &layer, samples, &mut vertices, triangles);
                }
            })?;
        }
        Ok(())
    }

    /// Adds the triangles of a layer where samples decide, and writes the inner vertices.
    fn write_special(
        &self,
        topology: &CellTopology,
        layer: &Layer<'_, D, C>,
        samples: &Samples<'_>,
        vertices: &mut Vertices<'_>,
        out: &mut Vec<[u32; 3]>,
    ) {
        let row_count = self.bits.dimensions[1];
        let (mut row, mut inner) = (usize::MAX, 0);
        layer.write::<true>(out, |[i, j], mask, numbers, out| {
            if row != j {
                (row, inner) = (j, layer.rows[layer.k * row_count + j].inner);
            }
            let Some(surface) = topology.surface(mask, || self.corners(samples, i, j)) else { return false };
            out.extend(surface.triangles.iter().map(|triangle| {
                let [a, b, c] = triangle.map(|corner| match topology.place(corner) {
                    Ok(place) => numbers.as_flattened()[place as usize],
                    Err(vertex) => inner + u32::from(vertex),
                });
                if self.mirrored { [a, c, b] } else { [a, b, c] }
            }));
            for &place in &surface.inner {
                vertices.write_inner(samples, [i, j, layer.k], inner, place);
                inner += 1;
            }
            true
        });
    }
}

/// The number of the first vertex of a plane, or of all where the plane is not counted yet.
fn first_of(starts: &[u32], plane: usize, total: u64) -> u32 {
    starts.get(plane).copied().unwrap_or(total as u32)
}

/// No fewer triangles than layers have: as counted where samples decide. A pattern gives no more than half as many in a cell as the
/// sum over its tetrahedra of their crossed edges, or five for seven crossed edges of a cube; so three for each vertex of the planes
/// below and above, as no edge has more than six tetrahedra or four cubes.
fn most_triangles(layers: Range<usize>, starts: &[u32], total: u64, counted: &[u64]) -> u64 {
    let of_layer = |k: usize| 3 * u64::from(first_of(starts, k + 2, total) - first_of(starts, k, total));
    layers.map(|k| if counted[k] > 0 { counted[k] } else { of_layer(k) }).sum()
}

/// Makes counts numbers, from `total` on: those of the first vertices of each row. Adds the first of each plane to `starts`.
fn number<const D: usize>(
    rows: &mut [Row<D>],
    row_count: usize,
    mut total: u64,
    starts: &mut Vec<u32>,
) -> Result<u64, MeshError> {
    for (at, row) in rows.iter_mut().enumerate() {
        if at % row_count == 0 {
            starts.push(total as u32);
        }
        for count in row.edges.iter_mut().chain([&mut row.inner]) {
            let own = u64::from(*count);
            *count = total as u32;
            total += own;
        }
    }
    if total >= u64::from(u32::MAX) { Err(MeshError::TooMany { kind: "vertices", found: total }) } else { Ok(total) }
}

impl Surface {
    fn with_room(vertices: usize, triangles: usize, normals: bool) -> Self {
        Self {
            positions: Vec::with_capacity(vertices),
            normals: normals.then(|| Vec::with_capacity(vertices)),
            triangles: Vec::with_capacity(triangles),
            ..Self::default()
        }
    }

    /// Adds what comes next, for which there is room.
    fn append(&mut self, mut next: Self) {
        self.positions.append(&mut next.positions);
        self.triangles.append(&mut next.triangles);
        if let (Some(normals), Some(next)) = (&mut self.normals, &mut next.normals) {
            normals.append(next);
        }
    }
}
