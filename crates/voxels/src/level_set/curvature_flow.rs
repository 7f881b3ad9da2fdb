//! Surfaces that move by their mean curvature.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Report, options,
};
use shapeloom_isosurface::Lattice;

use super::{as_distances, check_scale, distance_grid, redistance_band};
use crate::sparse_bricks::{BRICK, Filled, SIDE, offset, samples_of};
use crate::{SparseBricks, VoxelError, VoxelGrid, morton};

/// Steps in one run at most.
const MOST_STEPS: u32 = 1_000_000;

options! {
    /// Smooths a surface by moving it along its normal by its mean curvature, the sum of both principal ones (Osher and
    /// Sethian 1988).
    ///
    /// A sphere of radius r shrinks to √(r² − 4t) and vanishes at t = r²/4, so features of radius r are gone by that
    /// time. Volume shrinks. The equation φ' = |∇φ| div(∇φ/|∇φ|) is solved by central differences and explicit steps on
    /// one lattice, also on a skewed one; values beyond the border are those at the border. Steps are at most `step`
    /// times the bound of stability of heat flow, 1/(2 Σ|Gij|) with the inverse metric G of the lattice: h²/6 for cubes
    /// of side h. Samples that are no finite signed distances are made so first, as `redistance` does; the result's are
    /// none any more, though near ones.
    ///
    /// First order in time, second in space where the surface is smooth. Cost: linear in samples and steps. More than a
    /// million steps are refused.
    pub struct CurvatureFlow("curvature-flow") {
        required {
            /// How long, in squared model units.
            time: f64 [Bounds::NON_NEGATIVE],
        }
        optional {
            /// The largest step as a part of the bound of stability.
            step: f64 [Bounds::closed(1e-3, 1.0)] = 0.9,
        }
    }
}

impl FromTolerance<VoxelGrid> for CurvatureFlow {
    /// The time in which a sphere of the tolerance's radius vanishes.
    fn from_tolerance(_: &VoxelGrid, tolerance: f64) -> Self {
        Self::new(tolerance * tolerance / 4.0)
    }
}

impl Convert<VoxelGrid> for CurvatureFlow {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &VoxelGrid, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let lattice = *source.lattice();
        check_scale(&lattice)?;
        let stencil = Stencil::new(&lattice)?;
        let (steps, length) = stencil.steps(self.time, self.step)?;
        let _memory = exec.reserve_elements(lattice.samples(), 2 * size_of::<f32>())?;
        let mut values = as_distances(source, exec)?;
        let mut next = values.clone();
        for step in 0..steps {
            exec.progress(f64::from(step) / f64::from(steps));
            let before = &values;
            let at = |sample: [u32; 3]| f64::from(before[lattice.index(sample) as usize]);
            fill_chunks(exec, &mut next, 2048, |first, part| {
                for (index, value) in (first as u64..).zip(part) {
                    let here = lattice.coordinates(index);
                    *value = (at(here) + length * stencil.speed(&at, here)) as f32;
                }
                Ok::<(), ConvertError>(())
            })?;
            std::mem::swap(&mut values, &mut next);
        }
        let basis = "how far the surface moves depends on its curvature";
        let mut report = Report::new(Self::NAME, Deviation::Unknown, basis);
        report.figure("steps", f64::from(steps));
        report.figure("step_length", length);
        Ok(Converted::new(distance_grid(lattice, values)?, report))
    }
}

/// [`CurvatureFlow`] on a narrow band: active samples move, and when the surface may have moved by a quarter of the
/// half width, the band is laid anew by [`redistance_band`], and so it is at the end. The half width should be three
/// cells or more. Laying the band moves the surface inward by about h²/8 times its curvature, as its pieces are flat.
///
/// # Errors
/// A time that is negative or not finite, a step outside of 0 to 1, more than a million steps, too little memory, or
/// the reason to stop.
pub fn curvature_flow_band(
    source: &SparseBricks,
    time: f64,
    step: f64,
    exec: &Exec,
) -> Result<SparseBricks, ConvertError> {
    CurvatureFlow { time, step }.validate()?;
    let lattice = *source.lattice();
    let stencil = Stencil::new(&lattice)?;
    let (steps, length) = stencil.steps(time, step)?;
    let mut band = redistance_band(source, exec)?;
    let near = lattice.cell_diagonal() as f32;
    let mut moved = 0.0f32;
    for done in 0..steps {
        exec.progress(f64::from(done) / f64::from(steps));
        let half_width = band.background();
        let mut next = SparseBricks::try_new(lattice, half_width, band.quantity())?;
        let _memory = exec.reserve_elements(band.keys().len() as u64, 2 * SparseBricks::BRICK_BYTES)?;
        let mut fastest = 0.0f32;
        for &key in band.keys() {
            exec.check()?;
            let before = band.filled(key);
            let around = Around::new(&band, key, &before);
            let at = |sample: [u32; 3]| around.value(sample);
            let mut filled = Filled { key, values: [half_width; BRICK], mask: before.mask };
            for (sample, place) in samples_of(key, lattice.dimensions()) {
                filled.values[place] = before.values[place];
                if before.mask[place / 64] >> (place % 64) & 1 == 1 {
                    let change = (length * stencil.speed(&at, sample)) as f32;
                    filled.values[place] = (before.values[place] + change).clamp(-half_width, half_width);
                    if before.values[place].abs() < near {
                        fastest = fastest.max(change.abs());
                    }
                }
            }
            next.push(filled);
        }
        moved += fastest;
        band = if moved > half_width * 0.25 || done + 1 == steps {
            moved = 0.0;
            redistance_band(&next, exec)?
        } else {
            next
        };
    }
    Ok(band)
}

/// The samples of a brick and one layer around it, so that each is looked up once.
struct Around {
    /// One less than the brick's first sample; wraps at the border, where it is never asked for.
    first: [u32; 3],
    values: [f32; 10 * 10 * 10],
}

impl Around {
    fn new(band: &SparseBricks, key: u64, brick: &Filled) -> Self {
        let first = morton::decode(key).map(|at| (at * SIDE).wrapping_sub(1));
        let mut values = [band.background(); 1000];
        for (at, value) in (0..).zip(&mut values) {
            let to: [u32; 3] = [at % 10, at / 10 % 10, at / 100];
            let sample = std::array::from_fn(|axis| first[axis].wrapping_add(to[axis]));
            let own = to.iter().all(|step| (1..=SIDE).contains(step));
            *value = if own { brick.values[offset(sample)] } else { band.sample(sample) };
        }
        Self { first, values }
    }

    fn value(&self, sample: [u32; 3]) -> f64 {
        let [i, j, k]: [usize; 3] = std::array::from_fn(|axis| sample[axis].wrapping_sub(self.first[axis]) as usize);
        f64::from(self.values[(k * 10 + j) * 10 + i])
    }
}

/// Differences on a lattice, and what makes derivatives in space of them.
struct Stencil {
    dimensions: [u32; 3],
    /// Maps derivatives by lattice coordinates to those by position.
    to_space: DMat3,
    /// The bound of stability.
    stable: f64,
    /// The largest curvature that the lattice shows.
    sharpest: f64,
}

impl Stencil {
    fn new(lattice: &Lattice) -> Result<Self, ConvertError> {
        let to_space = lattice.placement().inverse()?.linear.transpose();
        let metric = to_space.transpose() * to_space;
        let sum = metric.to_cols_array().iter().map(|entry| entry.abs()).sum::<f64>();
        let sharpest = 2.0 / lattice.spacing().min_element();
        Ok(Self { dimensions: lattice.dimensions(), to_space, stable: 0.5 / sum, sharpest })
    }

    /// How many steps, and how long each.
    fn steps(&self, time: f64, part: f64) -> Result<(u32, f64), VoxelError> {
        let found = (time / (self.stable * part)).ceil();
        if !(0.0..=f64::from(MOST_STEPS)).contains(&found) {
            return Err(VoxelError::Steps { found, most: MOST_STEPS });
        }
        Ok((found as u32, if found > 0.0 { time / found } else { 0.0 }))
    }

    /// The curvature times the length of the gradient.
    fn speed(&self, at: &impl Fn([u32; 3]) -> f64, here: [u32; 3]) -> f64 {
        let value = |steps: [i32; 3]| {
            at(std::array::from_fn(|axis| here[axis].saturating_add_signed(steps[axis]).min(self.dimensions[axis] - 1)))
        };
        let one = |axis: usize, length: i32| {
            let mut steps = [0; 3];
            steps[axis] = length;
            steps
        };
        let middle = value([0; 3]);
        let mut gradient = DVec3::ZERO;
        let mut hessian = DMat3::ZERO;
        for axis in 0..3 {
            let (before, after) = (value(one(axis, -1)), value(one(axis, 1)));
            gradient[axis] = (after - before) * 0.5;
            hessian.col_mut(axis)[axis] = after - 2.0 * middle + before;
            let other = (axis + 1) % 3;
            let corner = |a: i32, b: i32| {
                let mut steps = one(axis, a);
                steps[other] = b;
                value(steps)
            };
            let mixed = (corner(1, 1) - corner(1, -1) - corner(-1, 1) + corner(-1, -1)) * 0.25;
            hessian.col_mut(axis)[other] = mixed;
            hessian.col_mut(other)[axis] = mixed;
        }
        let gradient = self.to_space * gradient;
        let hessian = self.to_space * hessian * self.to_space.transpose();
        let squared = gradient.length_squared();
        if squared == 0.0 {
            return 0.0;
        }
        let trace = hessian.x_axis.x + hessian.y_axis.y + hessian.z_axis.z;
        let speed = trace - gradient.dot(hessian * gradient) / squared;
        let most = self.sharpest * squared.sqrt();
        speed.clamp(-most, most)
    }
}
