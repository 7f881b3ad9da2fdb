//! Points to densities.

use std::f64::consts::PI;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Loss, Options, Place, Report, Severity,
    choice, options, parallel,
};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::PointCloud;

use crate::{Quantity, Samples, VoxelError, VoxelGrid, cubes};

choice! {
    /// What samples say of the points around them.
    pub enum PointWeight {
        /// How many points are in the cell around a sample, as whole numbers up to 65535.
        Count = "count",
        /// Points a volume, spread smoothly.
        Kernel = "kernel",
    }
}

options! {
    /// Counts points in cells, or spreads them smoothly.
    ///
    /// With `count` each sample says how many points are in the cube around it (half a step to each side; the lower face belongs to
    /// the cell), at most 65535: the report says how many points were above that. With `kernel` each point is spread over a ball by
    /// Wendland's C² function (1995) (1 − q)⁴ (4q + 1), q = distance / radius, each scaled so that its sum over samples times the volume of a cell
    /// is 1: the sum of all samples times the volume of a cell is the number of points, up to rounding. So that a ball is never between samples,
    /// the radius is at least a cell's diagonal.
    ///
    /// Where a surface is in such samples nothing says, so the deviation is unknown.
    ///
    /// Memory: 2 bytes a sample for counts and 4 more meanwhile, 4 bytes and 8 for densities; 4 bytes a point and slab that its ball reaches.
    /// Cost: linear; for densities the samples in the ball of each point.
    ///
    /// Errors: positions that are not finite; cells smaller than 1e-30 or larger than 1e30, for densities
    /// 1e-12 and 1e12, where squares and volumes leave single precision; too little memory in the budget.
    pub struct PointsToGrid("points-to-grid") {
        required {}
        optional {
            /// The side of a cell, in model units; 0 for what `resolution` says.
            cell_size: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many cells the longest side of the box has.
            resolution: u32 [Bounds::closed(1.0, 1e6)] = 64,
            /// How many cells are around the box; for densities the ball's radius comes on top.
            margin: u32 [Bounds::closed(0.0, 1e6)] = 1,
            /// What samples say of the points around them.
            weight: PointWeight = PointWeight::Kernel,
            /// The radius of the ball that a point is spread over, in model units; 0 for two cells.
            radius: f64 [Bounds::NON_NEGATIVE] = 0.0,
        }
    }
}

impl FromTolerance<PointCloud> for PointsToGrid {
    /// The tolerance sets nothing.
    fn from_tolerance(_: &PointCloud, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<PointCloud> for PointsToGrid {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &PointCloud, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        check(source)?;
        let bounds = source.bounds();
        let (plain, cell_size) = cubes::around(&bounds, self.cell_size, self.resolution, self.margin)?;
        let lattice = match self.weight {
            PointWeight::Count => plain,
            PointWeight::Kernel => {
                let more = (self.reach(cell_size) / cell_size).ceil().min(1e9) as u32;
                cubes::around(&bounds, self.cell_size, self.resolution, self.margin.saturating_add(more))?.0
            }
        };
        self.onto(source, lattice, exec)
    }
}

fn check(cloud: &PointCloud) -> Result<(), VoxelError> {
    match cloud.positions().iter().position(|position| !position.is_finite()) {
        Some(point) => Err(VoxelError::Position { element: point as u64 }),
        None => Ok(()),
    }
}

impl PointsToGrid {
    /// The radius of a point's ball.
    fn reach(&self, cell_size: f64) -> f64 {
        let asked = if self.radius > 0.0 { self.radius } else { 2.0 * cell_size };
        asked.max(1.733 * cell_size)
    }

    /// The samples of a given lattice, whose cells must be cubes along the axes; the options that place a lattice are not used. Points
    /// outside count nothing, and what is left of balls that the lattice cuts counts as much as a whole one.
    ///
    /// # Errors
    /// Another lattice, or whatever conversion gives.
    pub fn onto(
        &self,
        cloud: &PointCloud,
        lattice: Lattice,
        exec: &Exec,
    ) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        check(cloud)?;
        let cell_size = cubes::cell_size_of(&lattice)?;
        let mut report = Report::new(Self::NAME, Deviation::Unknown, "points have no surface until one is chosen");
        // Points a volume would leave single precision.
        if self.weight == PointWeight::Kernel && !(1e-12..=1e12).contains(&cell_size) {
            let cells = lattice.dimensions().into_iter().max().unwrap_or(0);
            let expected = "a size from 1e-12 to 1e12 for densities";
            return Err(VoxelError::CellSize { found: cell_size, cells: f64::from(cells), expected }.into());
        }
        let names = cloud.attributes().iter().map(|column| format!("vertex attribute \"{}\"", column.name()));
        let lists = cloud.attributes().lists().iter().map(|list| format!("vertex list \"{}\"", list.name()));
        report.losses.extend(names.chain(lists).map(|what| Loss::new(what, "a grid of densities has no attributes")));
        let points = Points { cloud, lattice: &lattice, cell_size };
        let samples = match self.weight {
            PointWeight::Count => points.count(&mut report, exec)?,
            PointWeight::Kernel => points.spread(self.reach(cell_size) / cell_size, &mut report, exec)?,
        };
        report.figure("cell_size", cell_size);
        report.figure("samples", lattice.samples() as f64);
        report.figure("points", cloud.positions().len() as f64);
        exec.progress(1.0);
        Ok(Converted::new(VoxelGrid::try_new(lattice, samples, Quantity::Density)?, report))
    }
}

struct Points<'a> {
    cloud: &'a PointCloud,
    lattice: &'a Lattice,
    cell_size: f64,
}

/// How many points are looked at before asking whether to stop.
const STEP: usize = 1 << 14;

impl Points<'_> {
    fn in_cells(&self, point: DVec3) -> DVec3 {
        (point - self.lattice.placement().translation) / self.cell_size
    }

    fn tell_outside(report: &mut Report, outside: u64) {
        if outside > 0 {
            let message = "points outside of the lattice count nothing";
            report.findings.push_many("W-points-outside", Severity::Warning, Place::Whole, message, outside);
        }
    }

    fn count(&self, report: &mut Report, exec: &Exec) -> Result<Samples, ConvertError> {
        let _memory = exec.reserve_elements(self.lattice.samples(), size_of::<u32>() + size_of::<u16>())?;
        let mut counts = vec![0u32; self.lattice.samples() as usize];
        let top = self.lattice.dimensions().map(f64::from);
        let mut outside = 0;
        let positions = self.cloud.positions();
        for (part, points) in positions.chunks(STEP).enumerate() {
            exec.check()?;
            exec.progress(part as f64 * STEP as f64 / positions.len() as f64);
            for &point in points {
                let cell = (self.in_cells(point) + 0.5).floor().to_array();
                if (0..3).all(|axis| cell[axis] >= 0.0 && cell[axis] < top[axis]) {
                    counts[self.lattice.index(cell.map(|x| x as u32)) as usize] += 1;
                } else {
                    outside += 1;
                }
            }
        }
        let beyond: u64 = counts.iter().map(|&count| u64::from(count.saturating_sub(u32::from(u16::MAX)))).sum();
        if beyond > 0 {
            let message = "points in cells that hold more than 65535 are not counted";
            report.findings.push_many("W-points-saturated", Severity::Warning, Place::Whole, message, beyond);
        }
        Self::tell_outside(report, outside);
        let narrow = counts.into_iter().map(|count| count.min(u32::from(u16::MAX)) as u16);
        Ok(Samples::U16(narrow.collect()))
    }

    /// Balls of `reach` cells, added in the order of points for each sample: slabs are done apart.
    fn spread(&self, reach: f64, report: &mut Report, exec: &Exec) -> Result<Samples, ConvertError> {
        let _memory = exec.reserve_elements(self.lattice.samples(), size_of::<f32>())?;
        let mut values = vec![0f32; self.lattice.samples() as usize];
        let [columns, rows, slabs] = self.lattice.dimensions();
        let top = DVec3::from_array([columns, rows, slabs].map(|count| f64::from(count - 1)));
        let volume = self.cell_size.powi(3);
        let positions = self.cloud.positions();
        let _weights = exec.reserve_elements(positions.len() as u64, size_of::<f64>())?;
        // What each ball's samples sum up to: first, so that slabs need know nothing of each other.
        let mut scales = vec![0f64; positions.len()];
        let balls = parallel::map_chunks(exec, positions.len(), 1 << 10, |range| {
            let mut sums = Vec::with_capacity(range.len());
            for &point in &positions[range] {
                exec.check()?;
                let mut sum = 0.0;
                Ball { center: self.in_cells(point), reach }.visit(top, None, exec, |_, weight| sum += weight)?;
                sums.push(sum);
            }
            Ok::<_, ConvertError>(sums)
        })?;
        exec.progress(0.3);
        let mut outside = 0;
        for (scale, sum) in scales.iter_mut().zip(balls.into_iter().flatten()) {
            *scale = if sum > 0.0 { 1.0 / (sum * volume) } else { 0.0 };
            outside += u64::from(sum <= 0.0);
        }
        // Points by the slab below them.
        let slab_of = |point: DVec3| self.in_cells(point).z.floor().clamp(-1.0, f64::from(slabs)) as i64 + 1;
        let _order = exec.reserve_elements(positions.len() as u64, size_of::<u32>())?;
        let _starts = exec.reserve_elements(u64::from(slabs) + 3, 2 * size_of::<usize>())?;
        let mut starts = vec![0usize; slabs as usize + 3];
        positions.iter().for_each(|&point| starts[slab_of(point) as usize + 1] += 1);
        for slab in 1..starts.len() {
            starts[slab] += starts[slab - 1];
        }
        let (mut order, mut next) = (vec![0u32; positions.len()], starts.clone());
        for (index, &point) in positions.iter().enumerate() {
            let place = &mut next[slab_of(point) as usize];
            order[*place] = index as u32;
            *place += 1;
        }
        exec.check()?;
        let whole = exec.part(0.3, 1.0);
        let far = reach.ceil().min(f64::from(slabs) + 2.0) as usize;
        parallel::fill_chunks(exec, &mut values, self.lattice.slab_len(), |first, part| {
            let k = first / self.lattice.slab_len();
            let _memory = exec.reserve_elements(part.len() as u64, size_of::<f64>())?;
            let mut sums = vec![0f64; part.len()];
            let (from, to) = (starts[(k + 1).saturating_sub(far + 1)], starts[(k + 2 + far).min(starts.len() - 1)]);
            for &index in &order[from..to] {
                exec.check()?;
                let (ball, scale) =
                    (Ball { center: self.in_cells(positions[index as usize]), reach }, scales[index as usize]);
                ball.visit(top, Some(k as u32), exec, |[i, j, _], weight| {
                    sums[j as usize * columns as usize + i as usize] += weight * scale;
                })?;
            }
            part.iter_mut().zip(&sums).for_each(|(value, &sum)| *value = sum as f32);
            whole.progress(k as f64 / f64::from(slabs));
            Ok::<_, ConvertError>(())
        })?;
        Self::tell_outside(report, outside);
        report.figure("radius", reach * self.cell_size);
        // The height of the kernel of one point far from the samples' lattice: a hint for iso values.
        report.figure("kernel_peak", 21.0 / (2.0 * PI * (reach * self.cell_size).powi(3)));
        Ok(Samples::F32(values))
    }
}

/// A ball around a point, in lattice coordinates.
struct Ball {
    center: DVec3,
    reach: f64,
}

impl Ball {
    /// Tells `each` the samples in the ball and their weights; of one slab or of all.
    fn visit(
        &self,
        top: DVec3,
        slab: Option<u32>,
        exec: &Exec,
        mut each: impl FnMut([u32; 3], f64),
    ) -> Result<(), ConvertError> {
        let low = (self.center - self.reach).ceil().max(DVec3::ZERO);
        let high = (self.center + self.reach).floor().min(top);
        if !low.cmple(high).all() {
            return Ok(());
        }
        let range = |axis: usize| low[axis] as u32..high[axis] as u32 + 1;
        let slabs = match slab {
            Some(k) if range(2).contains(&k) => k..k + 1,
            Some(_) => return Ok(()),
            None => range(2),
        };
        for k in slabs {
            for j in range(1) {
                let (dy, dz) = (f64::from(j) - self.center.y, f64::from(k) - self.center.z);
                for i in range(0) {
                    let dx = f64::from(i) - self.center.x;
                    let q = (dx * dx + dy * dy + dz * dz).sqrt() / self.reach;
                    if q < 1.0 {
                        let left = (1.0 - q) * (1.0 - q);
                        each([i, j, k], left * left * (4.0 * q + 1.0));
                    }
                }
                exec.check()?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Dice;
    use shapeloom_core::{Category, Threads};
    use shapeloom_isosurface::{SampleRange, sample_range};

    fn cloud(count: usize) -> PointCloud {
        let mut dice = Dice(3);
        PointCloud::new((0..count).map(|_| dice.point() * DVec3::new(2.0, 1.0, 0.5) + 3.0).collect())
    }

    #[test]
    fn counts_are_those_of_looking_at_each_point() {
        let cloud = cloud(5000);
        let method = PointsToGrid { weight: PointWeight::Count, resolution: 17, ..PointsToGrid::new() };
        let grid = method.convert(&cloud).unwrap().value;
        let lattice = grid.lattice();
        let half = lattice.spacing() * 0.5;
        let mut sum = 0;
        for at in 0..lattice.samples() {
            let center = lattice.position(lattice.coordinates(at));
            let inside = |p: &&DVec3| p.cmpge(center - half).all() && p.cmplt(center + half).all();
            let wanted = cloud.positions().iter().filter(inside).count();
            assert_eq!(grid.samples().get(at), wanted as f32);
            sum += wanted;
        }
        assert_eq!(sum, 5000);
    }

    #[test]
    fn densities_sum_to_the_number_of_points() {
        for (count, radius) in [(1, 0.0), (700, 0.0), (50, 0.9)] {
            let method = PointsToGrid { resolution: 15, radius, ..PointsToGrid::new() };
            let method = if count == 1 { PointsToGrid { cell_size: 0.3, ..method } } else { method };
            let made = method.convert(&cloud(count)).unwrap();
            let volume = made.value.lattice().placement().determinant();
            let sum: f64 = (0..made.value.lattice().samples()).map(|at| f64::from(made.value.samples().get(at))).sum();
            assert!((sum * volume / count as f64 - 1.0).abs() < 1e-5, "{count}: {}", sum * volume);
        }
    }

    /// The kernel as published, its integral over the ball (2π/21 times radius³), and no sample that differs from the sum over all points
    /// by more than the lattice's sum differs from the integral.
    #[test]
    fn densities_are_those_of_the_kernel() {
        let cloud = cloud(200);
        let method = PointsToGrid { resolution: 20, radius: 1.0, ..PointsToGrid::new() };
        let made = method.convert(&cloud).unwrap();
        let lattice = made.value.lattice();
        let mut worst = 0.0f64;
        for at in (0..lattice.samples()).step_by(17) {
            let place = lattice.position(lattice.coordinates(at));
            let kernel = |p: &DVec3| {
                let q = p.distance(place);
                if q < 1.0 { 21.0 / (2.0 * PI) * (1.0 - q).powi(4) * (4.0 * q + 1.0) } else { 0.0 }
            };
            let wanted: f64 = cloud.positions().iter().map(kernel).sum();
            worst = worst.max((f64::from(made.value.samples().get(at)) - wanted).abs() / 21.0 * 2.0 * PI);
        }
        assert!(worst < 1e-3, "{worst}");
        assert!((made.report.find("kernel_peak").unwrap() - 21.0 / (2.0 * PI)).abs() < 1e-12);
    }

    fn range(grid: &VoxelGrid) -> SampleRange {
        sample_range(grid, &Exec::default()).unwrap()
    }

    #[test]
    fn full_cells_and_points_outside_are_told() {
        let many = PointCloud::new(vec![DVec3::ONE; 70_000]);
        let method = PointsToGrid { weight: PointWeight::Count, ..PointsToGrid::new() };
        let made = method.convert(&many).unwrap();
        assert_eq!(range(&made.value).finite, Some([0.0, 65535.0]));
        assert_eq!(made.report.findings.iter().map(|finding| finding.count).sum::<u64>(), 70_000 - 65_535);
        let lattice = Lattice::along_axes([3; 3], DVec3::ZERO, DVec3::splat(0.1)).unwrap();
        for weight in [PointWeight::Count, PointWeight::Kernel] {
            let made = PointsToGrid { weight, ..PointsToGrid::new() }.onto(&many, lattice, &Exec::default()).unwrap();
            assert_eq!(range(&made.value).finite, Some([0.0, 0.0]));
            assert_eq!(made.report.findings.iter().next().unwrap().code, "W-points-outside");
        }
    }

    #[test]
    fn bad_clouds_and_sizes_are_told() {
        for weight in [PointWeight::Count, PointWeight::Kernel] {
            let method = PointsToGrid { weight, ..PointsToGrid::new() };
            let error = method.convert(&PointCloud::new(vec![DVec3::NAN])).unwrap_err();
            assert_eq!(error.category(), Category::Malformed);
            let wide = PointCloud::new(vec![DVec3::ZERO, DVec3::splat(1e150)]);
            assert_eq!(method.convert(&wide).unwrap_err().category(), Category::OverLimit);
            let small = PointCloud::new(vec![DVec3::ZERO, DVec3::splat(1e-300)]);
            assert_eq!(method.convert(&small).unwrap_err().category(), Category::OverLimit);
            let fine = PointsToGrid { resolution: 100_000, ..method.clone() };
            assert_eq!(fine.convert(&cloud(10)).unwrap_err().category(), Category::OverLimit);
            assert_eq!(range(&method.convert(&PointCloud::default()).unwrap().value).finite, Some([0.0, 0.0]));
            assert_eq!(range(&method.convert(&PointCloud::new(vec![DVec3::ONE])).unwrap().value).not_finite, 0);
        }
    }

    #[test]
    fn the_same_bits_on_any_number_of_threads() {
        let (cloud, method) = (cloud(3000), PointsToGrid { resolution: 40, ..PointsToGrid::new() });
        let alone = method.convert_with(&cloud, &Exec::default().with_threads(Threads::Sequential)).unwrap();
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| method.convert(&cloud).unwrap()) == alone, "{threads} threads");
        }
    }
}
