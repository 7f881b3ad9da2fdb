//! A whole dual surface.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::parallel::{map_chunks, workers};
use shapeloom_core::{Affine, ConvertError, Exec, Reservation};

use super::VertexRule;
use super::block::{Made, Plan, make};
use super::sign_slice::{Frame, SignSlice};
use crate::{Border, Level, Slabs};

/// The vertices and triangles of a surface.
#[derive(Default)]
pub(crate) struct DualSurface {
    pub(crate) positions: Vec<DVec3>,
    /// Unit normals, if they were asked for.
    pub(crate) normals: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many samples are not finite.
    pub(crate) not_finite: u64,
    /// How many vertices would have left their cells.
    pub(crate) held: u64,
}

/// Layers of cells in a run of its own. Each run takes the signs of three more slices and the vertices of one more layer than it
/// has, a tenth here; the result does not depend on it.
const LAYERS: usize = 32;

/// Makes the surface. Results are the same for any number of threads: each vertex is made from its cell alone, and numbers and order
/// are those of the cells.
pub(crate) fn extract<S: Slabs + ?Sized, R: VertexRule>(
    slabs: &S,
    rule: &R,
    level: Level,
    border: Border,
    normals: bool,
    exec: &Exec,
) -> Result<DualSurface, ConvertError> {
    let lattice = slabs.lattice();
    let closed = border == Border::Closed;
    if !closed && lattice.dimensions().contains(&1) {
        return Ok(DualSurface { not_finite: not_finite(slabs, level, exec)?, ..DualSurface::default() });
    }
    let frame = Frame::new(lattice.dimensions(), closed);
    let placement = *lattice.placement();
    let cofactors = cofactors(&placement);
    let plan = Plan { frame, level, placement, normals, cofactors };
    let layers = frame.cells(2);
    let (mut surface, unused) = if workers(exec) > 1 && layers > LAYERS {
        let all = layers.div_ceil(LAYERS);
        let runs = map_chunks(exec, layers, LAYERS, |run| {
            let part = |at: usize| at as f64 / all as f64 / LAYERS as f64;
            let _memory = working_memory(&frame, exec)?;
            make(slabs, rule, &plan, run.clone(), &exec.part(part(run.start), part(run.end)))
        })?;
        joined(runs, exec)?
    } else {
        exec.check()?;
        let _memory = working_memory(&frame, exec)?;
        let made = make(slabs, rule, &plan, 0..layers, exec)?;
        let surface = DualSurface {
            positions: made.positions,
            normals: made.normals,
            triangles: made.triangles,
            not_finite: made.not_finite,
            held: made.held,
        };
        (surface, made.unused)
    };
    surface.drop_vertices(&unused, exec)?;
    Ok(surface)
}

/// The matrix that maps normals, up to a positive factor: the cofactors of the map, scaled to neither overflow nor vanish.
fn cofactors(placement: &Affine) -> DMat3 {
    let steps = placement.linear;
    let size = steps.x_axis.abs().max(steps.y_axis.abs()).max(steps.z_axis.abs()).max_element();
    let [x, y, z] = [steps.x_axis, steps.y_axis, steps.z_axis].map(|column| column / size);
    let sign = if placement.reverses_orientation() { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}

/// What a run needs beside its result: slabs that are not in memory, four slices of signs, two layers of cells.
fn working_memory(frame: &Frame, exec: &Exec) -> Result<Reservation, ConvertError> {
    let words = frame.slice_words() as u64;
    let slab = frame.samples[0] as u64 * frame.samples[1] as u64;
    Ok(exec.reserve((words * (4 * 8 + 2 * 20)).saturating_add(slab.saturating_mul(16)).saturating_add(1 << 14))?)
}

/// The surface of runs, and the vertices without triangles.
fn joined(runs: Vec<Made>, exec: &Exec) -> Result<(DualSurface, Vec<u32>), ConvertError> {
    let vertices: usize = runs.iter().map(|run| run.positions.len() - run.borrowed).sum();
    let triangles: usize = runs.iter().map(|run| run.triangles.len()).sum();
    check_count(vertices)?;
    let normals = if runs.iter().any(|run| !run.normals.is_empty()) { vertices } else { 0 };
    let unused = runs.iter().map(|run| run.unused.len()).sum();
    let _memory = [
        exec.reserve_elements(unused as u64, size_of::<u32>())?,
        exec.reserve_elements((vertices + normals) as u64, size_of::<DVec3>())?,
        exec.reserve_elements(triangles as u64, size_of::<[u32; 3]>())?,
    ];
    let mut surface = DualSurface {
        positions: Vec::with_capacity(vertices),
        normals: Vec::with_capacity(normals),
        triangles: Vec::with_capacity(triangles),
        not_finite: 0,
        held: 0,
    };
    let mut all_unused = Vec::with_capacity(unused);
    for run in runs {
        exec.check()?;
        // Numbers of a run begin with the last of the run before.
        let shift = (surface.positions.len() as u32).wrapping_sub(run.borrowed as u32);
        surface.positions.extend_from_slice(&run.positions[run.borrowed..]);
        surface.normals.extend(run.normals.iter().skip(run.borrowed));
        let moved = |corners: &[u32; 3]| corners.map(|corner| corner.wrapping_add(shift));
        surface.triangles.extend(run.triangles.iter().map(moved));
        let own = run.unused.iter().filter(|&&vertex| vertex as usize >= run.borrowed);
        all_unused.extend(own.map(|vertex| vertex.wrapping_add(shift)));
        surface.not_finite += run.not_finite;
        surface.held += run.held;
    }
    Ok((surface, all_unused))
}

fn check_count(vertices: usize) -> Result<(), ConvertError> {
    match u32::try_from(vertices) {
        Ok(count) if count < u32::MAX => Ok(()),
        _ => Err(shapeloom_mesh::MeshError::TooMany { kind: "vertices", found: vertices as u64 }.into()),
    }
}

impl DualSurface {
    /// Takes away the vertices without triangles, which are looked for.
    pub(crate) fn drop_unused(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let _memory = exec.reserve_elements(self.positions.len() as u64, 1 + size_of::<u32>())?;
        let mut used = vec![false; self.positions.len()];
        for corners in self.triangles.chunks(1 << 16) {
            exec.check()?;
            corners.as_flattened().iter().for_each(|&corner| used[corner as usize] = true);
        }
        let unused: Vec<u32> = (0u32..).zip(&used).filter(|&(_, &used)| !used).map(|(at, _)| at).collect();
        self.drop_vertices(&unused, exec)
    }

    /// Takes away vertices that no triangle has; they are in order.
    fn drop_vertices(&mut self, unused: &[u32], exec: &Exec) -> Result<(), ConvertError> {
        let Some(&first) = unused.first() else { return Ok(()) };
        let _memory = exec.reserve_elements(self.positions.len() as u64, size_of::<u32>())?;
        let mut number: Vec<u32> = (0..first).collect();
        number.reserve_exact(self.positions.len() - number.len());
        for (at, &gone) in unused.iter().enumerate() {
            exec.check()?;
            let next = unused.get(at + 1).map_or(self.positions.len(), |&next| next as usize);
            let (start, end) = (gone as usize + 1, next);
            let kept = start - at - 1;
            number.push(u32::MAX);
            number.extend(kept as u32..(kept + end - start) as u32);
            self.positions.copy_within(start..end, kept);
            if !self.normals.is_empty() {
                self.normals.copy_within(start..end, kept);
            }
        }
        let kept = self.positions.len() - unused.len();
        self.positions.truncate(kept);
        self.normals.truncate(kept);
        for triangles in self.triangles.chunks_mut(1 << 16) {
            exec.check()?;
            triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner = number[*corner as usize]);
        }
        Ok(())
    }
}

/// How many samples are not finite.
fn not_finite<S: Slabs + ?Sized>(slabs: &S, level: Level, exec: &Exec) -> Result<u64, ConvertError> {
    let frame = Frame::new(slabs.lattice().dimensions(), true);
    let _memory = working_memory(&frame, exec)?;
    let (mut slice, mut buffer) = (SignSlice::default(), Vec::new());
    let mut count = 0;
    for k in 0..frame.samples[2] as u32 {
        exec.check()?;
        count += slice.fill(slabs.slab(k, &mut buffer)?, level, &frame);
    }
    Ok(count)
}
