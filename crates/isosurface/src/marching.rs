//! Marching over the cells of a lattice: what cubes and tetrahedra have in common.
//!
//! First every sample becomes a bit. From the bits follow, by operations on whole words, how many vertices each row of edges and how
//! many triangles each layer of cells has, hence the numbers of all vertices. Then blocks of layers write their vertices and
//! triangles, at the same time, to where they belong.

use std::ops::Range;

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{fill_chunks, map_chunks};
use shapeloom_core::{ConvertError, Exec, Stop};
use shapeloom_mesh::MeshError;

use crate::cell_topology::CellTopology;
use crate::growth::grow;
use crate::lattice_bits::LatticeBits;
use crate::lattice_vertices::{EdgeRow, Samples, Site, bits_below, next_bits};
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

/// Where a block writes to.
struct Block<'a> {
    first_layer: usize,
    last_plane: usize,
    first_vertex: u32,
    positions: &'a mut [[f64; 3]],
    normals: Option<&'a mut [[f64; 3]]>,
    triangles: &'a mut [[u32; 3]],
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

    /// Writes the triangles of the layer. `special` writes those of cells that the pattern does not decide: it gets the cell, its
    /// mask, the numbers of its vertices and the room that is left, and says how much it took.
    #[inline(always)]
    fn write(
        &self,
        out: &mut [[u32; 3]],
        mut special: impl FnMut([usize; 2], u8, &[[u32; C]; 2], &mut [[u32; 3]]) -> Option<usize>,
    ) {
        let mut at = 0;
        for j in 0..self.bits.dimensions[1] - 1 {
            let mut counters = self.counters(j);
            visit_cells(self.bits, j, self.k, |i, mask| {
                let before = counters;
                for (counter, step) in counters.iter_mut().zip(&self.pattern.steps[mask as usize]) {
                    *counter += step;
                }
                let numbers = [before, counters];
                if let Some(taken) = special([i, j], mask, &numbers, &mut out[at..]) {
                    at += taken;
                    return;
                }
                let numbers = numbers.as_flattened();
                let triangles = self.pattern.triangles(mask);
                for (out, &[a, b, c]) in out[at..at + triangles.len()].iter_mut().zip(triangles) {
                    let (a, b, c) = (a as usize % (2 * C), b as usize % (2 * C), c as usize % (2 * C));
                    *out = [numbers[a], numbers[b], numbers[c]];
                }
                at += triangles.len();
            });
        }
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn write_triangles<const D: usize, const C: usize>(layer: &Layer<'_, D, C>, out: &mut [[u32; 3]]) {
    layer.write(out, |_, _, _, _| None);
}

/// Writes the vertices on the edges that start in a plane of samples; `first` is the number of the first that there is room for.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn write_vertices<const D: usize, const C: usize>(
    layer: &Layer<'_, D, C>,
    site: &Site,
    samples: &Samples<'_>,
    first: u32,
    positions: &mut [[f64; 3]],
    mut normals: Option<&mut [[f64; 3]]>,
) {
    let (bits, k) = (layer.bits, layer.k);
    let row_count = bits.dimensions[1];
    for j in 0..row_count {
        let row = &layer.rows[k * row_count + j];
        for (number, &direction) in layer.pattern.directions.iter().enumerate() {
            let end = if number + 1 < D { row.edges[number + 1] } else { row.inner };
            let (start, end) = ((row.edges[number] - first) as usize, (end - first) as usize);
            if start == end {
                continue;
            }
            let Some(edges) = edge_row(bits, direction, j, k) else { continue };
            let positions = &mut positions[start..end];
            let normals = normals.as_mut().map(|normals| &mut normals[start..end]);
            match direction {
                1 => edges.vertices::<1>(site, samples, [j, k], positions, normals),
                2 => edges.vertices::<2>(site, samples, [j, k], positions, normals),
                3 => edges.vertices::<3>(site, samples, [j, k], positions, normals),
                4 => edges.vertices::<4>(site, samples, [j, k], positions, normals),
                5 => edges.vertices::<5>(site, samples, [j, k], positions, normals),
                6 => edges.vertices::<6>(site, samples, [j, k], positions, normals),
                _ => edges.vertices::<7>(site, samples, [j, k], positions, normals),
            }
        }
    }
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
        let (mut counted, mut written, mut vertices, mut triangles) = (0..0, 0..0, 0, 0);
        let wave = (WAVE_SAMPLES / self.slabs.lattice().slab_len()).clamp(LEAST_WAVE, MOST_WAVE);
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
            triangles += layers[written.clone()].iter().sum::<u64>();
            if triangles.saturating_mul(3) >= u64::from(u32::MAX) {
                return Err(MeshError::TooMany { kind: "wedges", found: triangles.saturating_mul(3) }.into());
            }
            let known = starts.get(written.end).map_or(vertices, |&start| u64::from(start)) as usize;
            let part = written.end as f64 / planes as f64;
            grow(&mut surface.positions, known, part, &mut memory, exec)?;
            grow(&mut surface.triangles, triangles as usize, part, &mut memory, exec)?;
            if let Some(normals) = &mut surface.normals {
                grow(normals, known, part, &mut memory, exec)?;
            }
            let mut blocks = surface.blocks(written.clone(), &starts, &layers, (known, triangles as usize));
            fill_chunks(exec, &mut blocks, 1, |_, block| {
                block.iter_mut().try_for_each(|block| self.write_block(block, &rows, &layers, exec))
            })?;
        }
        surface.positions.shrink_to_fit();
        surface.triangles.shrink_to_fit();
        surface.normals.iter_mut().for_each(Vec::shrink_to_fit);
        surface.working_bytes = size_of_val(rows.as_slice()) as u64;
        Ok(surface)
    }

    /// Counts crossed edges and inner vertices of each row, and triangles of each layer.
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
                **triangles = match &self.topology {
                    None => count_triangles(&self.bits, self.pattern, k),
                    Some(topology) => self.count_special(topology, k, rows, &mut window)?,
                };
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

    fn write_block(
        &self,
        block: &mut Block<'_>,
        rows: &[Row<D>],
        layers: &[u64],
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        let site = Site::new(self.slabs.lattice(), self.level, self.bits.margin, self.bits.tame);
        let mut window = SlabWindow::new(self.slabs);
        let mut triangles = 0;
        for k in block.first_layer..=block.last_plane {
            exec.check()?;
            let layer = Layer { bits: &self.bits, pattern: self.pattern, rows, k };
            let room = triangles..triangles + layers[k] as usize;
            triangles = room.end;
            let out = &mut block.triangles[room];
            let (positions, normals) = (&mut *block.positions, block.normals.as_deref_mut());
            let mut vertices = Vertices { site: &site, first: block.first_vertex, positions, normals };
            if self.topology.is_none() {
                if !out.is_empty() {
                    write_triangles(&layer, out);
                }
                let row_count = self.bits.dimensions[1];
                let next = rows.get((k + 1) * row_count).map_or(usize::MAX, |row| row.edges[0] as usize);
                let end = block.first_vertex as usize + vertices.positions.len();
                if rows[k * row_count].edges[0] as usize == next.min(end) {
                    continue;
                }
            }
            self.with_samples(&mut window, k, self.normals, |samples| {
                let normals = vertices.normals.as_deref_mut();
                write_vertices(&layer, &site, samples, block.first_vertex, vertices.positions, normals);
                if let Some(topology) = &self.topology {
                    self.write_special(topology, &layer, samples, &mut vertices, out);
                }
            })?;
        }
        Ok(())
    }

    /// Writes the triangles of a layer where samples decide, and the inner vertices.
    fn write_special(
        &self,
        topology: &CellTopology,
        layer: &Layer<'_, D, C>,
        samples: &Samples<'_>,
        vertices: &mut Vertices<'_>,
        out: &mut [[u32; 3]],
    ) {
        if out.is_empty() {
            return;
        }
        let row_count = self.bits.dimensions[1];
        let (mut row, mut inner) = (usize::MAX, 0);
        layer.write(out, |[i, j], mask, numbers, out| {
            if row != j {
                (row, inner) = (j, layer.rows[layer.k * row_count + j].inner);
            }
            let surface = topology.surface(mask, || self.corners(samples, i, j))?;
            for (out, triangle) in out.iter_mut().zip(&surface.triangles) {
                let [a, b, c] = triangle.map(|corner| match topology.place(corner) {
                    Ok(place) => numbers.as_flattened()[place as usize],
                    Err(vertex) => inner + u32::from(vertex),
                });
                *out = if self.mirrored { [a, c, b] } else { [a, b, c] };
            }
            for &place in &surface.inner {
                vertices.write_inner(samples, [i, j, layer.k], inner, place);
                inner += 1;
            }
            Some(surface.triangles.len())
        });
    }
}

/// Where the vertices of a block go to.
struct Vertices<'a> {
    site: &'a Site,
    first: u32,
    positions: &'a mut [[f64; 3]],
    normals: Option<&'a mut [[f64; 3]]>,
}

impl Vertices<'_> {
    /// Writes a vertex inside a cell.
    fn write_inner(&mut self, samples: &Samples<'_>, cell: [usize; 3], number: u32, [x, y, z]: [f64; 3]) {
        let margin = self.site.margin as f64;
        let at = (number - self.first) as usize;
        let [i, j, k] = cell.map(|start| start as f64 - margin);
        self.positions[at] = self.site.place(i + x, j + y, k + z);
        let Some(normals) = self.normals.as_deref_mut() else { return };
        let [i, j] = [cell[0], cell[1]].map(|start| start.wrapping_sub(self.site.margin));
        let corners = (0..8usize).filter_map(|corner| {
            let (column, row) = (i.wrapping_add(corner & 1), j.wrapping_add(corner >> 1 & 1));
            samples.get(column, row, corner >> 2)?;
            let part = |bit: usize, x: f64| if corner >> bit & 1 == 1 { x } else { 1.0 - x };
            Some(samples.gradient(column, row, corner >> 2) * (part(0, x) * part(1, y) * part(2, z)))
        });
        normals[at] = self.site.normal(corners.sum(), DVec3::Z);
    }
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
    /// Makes room for so many vertices and triangles in all, and cuts what is new into what each block of layers writes.
    fn blocks(
        &mut self,
        planes: Range<usize>,
        starts: &[u32],
        layers: &[u64],
        (vertices, triangles): (usize, usize),
    ) -> Vec<Block<'_>> {
        let (first_vertex, first_triangle) = (self.positions.len(), self.triangles.len());
        self.positions.resize(vertices, [0.0; 3]);
        self.triangles.resize(triangles, [0; 3]);
        let mut positions = &mut self.positions[first_vertex..];
        let mut triangles = &mut self.triangles[first_triangle..];
        let mut normals = self.normals.as_mut().map(|normals| {
            normals.resize(vertices, [0.0; 3]);
            &mut normals[first_vertex..]
        });
        let mut blocks = Vec::new();
        for first_layer in planes.clone().step_by(LAYERS) {
            let end = (first_layer + LAYERS).min(planes.end);
            let end_vertex = starts.get(end).map_or(vertices, |&start| start as usize);
            let own = end_vertex - starts[first_layer] as usize;
            let faces = layers[first_layer..end].iter().sum::<u64>() as usize;
            blocks.push(Block {
                first_layer,
                last_plane: end - 1,
                first_vertex: starts[first_layer],
                positions: positions.split_off_mut(..own).unwrap_or_default(),
                normals: normals.as_mut().and_then(|normals| normals.split_off_mut(..own)),
                triangles: triangles.split_off_mut(..faces).unwrap_or_default(),
            });
        }
        blocks
    }
}
