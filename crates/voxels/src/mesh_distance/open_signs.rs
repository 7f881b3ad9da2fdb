//! Inside and outside of meshes that are not closed.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec};

use super::clusters::{Clusters, LANES as CLUSTERS, Taylor, add_all, look};
use super::in_cells::InCells;
use super::near_triangle::LANES;
use super::turns::{Places, turns, turns_around};

/// The side of cubes of samples that are looked at as one, a power of two at most 16.
const CUBE: usize = 16;

/// Cubes of this side are not halved any more: their samples are looked at one by one.
const LAST: u32 = 4;

/// What a cluster may be wrong by to be taken whole, in turns, each as long as samples are left open by the one before it. As
/// triangles to be measured grow in number with its power -2/5 or so, a few steps are better than one.
const TOLERANCES: [f64; 5] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7];

/// Tells inside from outside by winding numbers above 1/2.
///
/// Mesh and closing triangles together are closed: their winding number is whole, and counted by crossings. From it that
/// of the closing triangles alone is taken, which is smooth away from them and less than 1/2 where holes are far.
pub(super) struct OpenSigns<'a> {
    /// The triangles of the mesh, for samples on the border of closing triangles.
    pub mesh: &'a InCells<'a>,
    pub closing: &'a Clusters,
}

/// Samples of a block of slabs.
pub(super) struct Samples<'a> {
    /// Distances: signs are given to those above 0.
    pub values: &'a mut [f32],
    /// Winding numbers of the closed mesh.
    pub windings: &'a [i32],
    pub columns: usize,
    pub rows: usize,
    pub first_slab: usize,
}

impl Samples<'_> {
    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        (z as usize * self.rows + y as usize) * self.columns + x as usize
    }

    fn place(&self, [x, y, z]: [u32; 3]) -> DVec3 {
        DVec3::new(f64::from(x), f64::from(y), f64::from(z) + self.first_slab as f64)
    }

    fn give(&mut self, sample: [u32; 3], inside: bool) {
        if inside {
            let at = self.index(sample);
            self.values[at] = -self.values[at];
        }
    }
}

/// What the look at one cube of samples needs.
#[derive(Default)]
struct Work {
    /// Samples, by cube: those of the cubes around one come before its own.
    samples: Vec<[u32; 3]>,
    /// Clusters that are near a cube; as above.
    near: Vec<u32>,
    /// Clusters to be looked at.
    waiting: Vec<u32>,
    /// Clusters that are far from the cube.
    far: Vec<u32>,
    /// Samples that a tolerance leaves open.
    open: Vec<[u32; 3]>,
    /// Which tolerance is tried first.
    first_step: usize,
}

/// The part of the lists of [`Work`] that are a cube's.
#[derive(Clone, Copy)]
struct Cube {
    side: u32,
    samples: usize,
    near: usize,
}

impl OpenSigns<'_> {
    /// Gives each distance in a block its sign: negative where the winding number is above 1/2.
    pub fn give(&self, samples: &mut Samples<'_>, exec: &Exec) -> Result<(), ConvertError> {
        let (columns, rows) = (samples.columns, samples.rows);
        let slabs = samples.values.len() / (columns * rows);
        let mut work = Work::default();
        for k in (0..slabs).step_by(CUBE) {
            for j in (0..rows).step_by(CUBE) {
                for i in (0..columns).step_by(CUBE) {
                    exec.check()?;
                    work.open.clear();
                    for z in k..slabs.min(k + CUBE) {
                        for y in j..rows.min(j + CUBE) {
                            let all = (i..columns.min(i + CUBE)).map(|x| [x as u32, y as u32, z as u32]);
                            work.open.extend(all.filter(|&sample| samples.values[samples.index(sample)] > 0.0));
                        }
                    }
                    self.cube(&mut work, samples, exec)?;
                }
            }
        }
        Ok(())
    }

    /// Settles the open samples of a cube.
    fn cube(&self, work: &mut Work, samples: &mut Samples<'_>, exec: &Exec) -> Result<(), ConvertError> {
        let (all, first) = (work.open.len(), work.first_step);
        for (step, &tolerance) in TOLERANCES.iter().enumerate().skip(first) {
            if work.open.is_empty() {
                return Ok(());
            }
            work.samples.clear();
            work.near.clear();
            work.samples.append(&mut work.open);
            work.near.push(0);
            let cube = Cube { side: CUBE as u32, samples: 0, near: 0 };
            self.settle(cube, None, tolerance, work, samples, exec)?;
            // Cubes side by side are alike: what was in vain for one is not tried for the next.
            if step == first {
                if 2 * work.open.len() > all && step < 2 {
                    work.first_step += 1;
                } else if 16 * work.open.len() < all && step > 0 {
                    work.first_step -= 1;
                }
            }
        }
        for at in 0..work.open.len() {
            let sample = work.open[at];
            let place = samples.place(sample);
            let whole = f64::from(samples.windings[samples.index(sample)]);
            let closing = &self.closing.triangles;
            let (winding, error) = sum(closing.len(), |at| closing[at], place, exec)?;
            let winding = match error < 0.5 {
                true => whole - winding,
                false => sum(self.mesh.triangles.len(), |at| self.mesh.corners(at as u32), place, exec)?.0,
            };
            samples.give(sample, winding > 0.5);
        }
        Ok(())
    }

    /// Settles what can be settled of a cube, the last in the lists, with a tolerance. `around` is what was found far from the cube that
    /// it was cut from, about a place.
    fn settle(
        &self,
        cube: Cube,
        around: Option<(Taylor, DVec3)>,
        tolerance: f64,
        work: &mut Work,
        samples: &mut Samples<'_>,
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        let own = &work.samples[cube.samples..];
        let Some(&first) = own.first() else { return Ok(()) };
        let (mut low, mut high) = (first, first);
        for sample in own {
            for axis in 0..3 {
                low[axis] = low[axis].min(sample[axis]);
                high[axis] = high[axis].max(sample[axis]);
            }
        }
        let (low, high) = (samples.place(low), samples.place(high));
        let place = (low + high) * 0.5;
        let radius = (high - place).length() * (1.0 + 1e-12);
        let mut far = around.map_or(Taylor::ZERO, |(taylor, about)| taylor.moved(place - about));
        let is_last = cube.side <= LAST;
        let end = work.near.len();
        let mut near = 0.0;
        work.far.clear();
        work.waiting.clear();
        work.waiting.extend_from_slice(&work.near[cube.near..]);
        while !work.waiting.is_empty() {
            let mut some = [0; CLUSTERS];
            let count = work.waiting.len().min(CLUSTERS);
            some[..count].copy_from_slice(&work.waiting[work.waiting.len() - count..]);
            work.waiting.truncate(work.waiting.len() - count);
            let found = look(&self.closing.all, &some[..count], place, radius);
            for (lane, &at) in some[..count].iter().enumerate() {
                let cluster = &self.closing.all[at as usize];
                if cluster.area == 0.0 {
                    continue;
                }
                if found.errors[lane] <= tolerance {
                    far.error += found.errors[lane];
                    work.far.push(at);
                } else if let Some(triangle) = self.closing.triangle(at) {
                    near += found.most[lane].min(0.5);
                    work.near.push(if is_last { triangle } else { at });
                } else if is_last || cluster.radius > radius {
                    self.closing.open(at, &mut work.waiting);
                } else {
                    near += found.most[lane];
                    work.near.push(at);
                }
            }
        }
        add_all(&mut far, &self.closing.all, &work.far, place);
        let spread = far.change(radius) + far.error + near;
        let nearest = far.value.round();
        if (far.value - nearest).abs() + spread < 0.5 {
            for at in cube.samples..work.samples.len() {
                let sample = work.samples[at];
                let whole = samples.windings[samples.index(sample)];
                samples.give(sample, f64::from(whole) - nearest > 0.5);
            }
        } else if is_last {
            self.each(&work.samples[cube.samples..], &work.near[end..], (&far, place), &mut work.open, samples, exec)?;
        } else {
            let half = cube.side / 2;
            let last = work.samples.len();
            for octant in 0..8u32 {
                for at in cube.samples..last {
                    let sample = work.samples[at];
                    // Cubes begin at multiples of their side.
                    let part = (0..3).map(|axis| u32::from(sample[axis] & half != 0) << axis).sum::<u32>();
                    if part == octant {
                        work.samples.push(sample);
                    }
                }
                let part = Cube { side: half, samples: last, near: end };
                self.settle(part, Some((far, place)), tolerance, work, samples, exec)?;
                work.samples.truncate(last);
            }
        }
        work.near.truncate(end);
        Ok(())
    }

    /// Settles samples one by one, with near triangles; those that this tolerance leaves open are listed.
    fn each(
        &self,
        own: &[[u32; 3]],
        near: &[u32],
        (far, about): (&Taylor, DVec3),
        open: &mut Vec<[u32; 3]>,
        samples: &mut Samples<'_>,
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        for eight in own.chunks(LANES) {
            exec.check()?;
            // Lanes without a sample repeat the first.
            let mut lanes = [samples.place(eight[0]); LANES];
            lanes.iter_mut().zip(eight).for_each(|(lane, &sample)| *lane = samples.place(sample));
            let places: Places = [0, 1, 2].map(|axis| lanes.map(|place| place[axis]));
            let (windings, errors) = turns_around(&self.closing.triangles, near, &places);
            for (lane, &sample) in eight.iter().enumerate() {
                let whole = f64::from(samples.windings[samples.index(sample)]);
                let above = whole - (windings[lane] + far.at(samples.place(sample) - about)) - 0.5;
                if above.abs() > errors[lane] + far.error {
                    samples.give(sample, above > 0.0);
                } else {
                    open.push(sample);
                }
            }
        }
        Ok(())
    }
}

/// The winding number of all triangles, with compensated summation (Neumaier 1974), and what rounding may change.
fn sum(
    count: usize,
    corners: impl Fn(usize) -> [DVec3; 3],
    place: DVec3,
    exec: &Exec,
) -> Result<(f64, f64), ConvertError> {
    let (mut sum, mut lost, mut error) = (0.0f64, 0.0, 0.0);
    for at in 0..count {
        if at % 4096 == 0 {
            exec.check()?;
        }
        let (value, wrong) = turns(&corners(at), place);
        let next = sum + value;
        lost += if sum.abs() >= value.abs() { (sum - next) + value } else { (value - next) + sum };
        sum = next;
        error += wrong;
    }
    Ok((sum + lost, error))
}
