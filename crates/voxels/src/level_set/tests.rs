use super::*;
use crate::{GridField, Interpolation, SparseBricks};
use shapeloom_core::glam::DMat3;
use shapeloom_core::{Convert, Deviation, Field};

fn exec() -> Exec {
    Exec::default()
}

fn grid_on(lattice: Lattice, value: impl Fn(DVec3) -> f64) -> VoxelGrid {
    let at = |at: u64| value(lattice.position(lattice.coordinates(at))) as f32;
    let samples = (0..lattice.samples()).map(at).collect();
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).unwrap()
}

/// A cube of `n` samples a side around the origin, from -1 to 1, moved so that nothing lies on samples.
fn cube(n: u32) -> Lattice {
    let spacing = 2.0 / f64::from(n - 1);
    Lattice::along_axes([n; 3], DVec3::splat(-1.0) + DVec3::new(0.31, 0.17, 0.43) * spacing, DVec3::splat(spacing))
        .unwrap()
}

fn sphere(p: DVec3, radius: f64) -> f64 {
    p.length() - radius
}

fn cuboid(p: DVec3) -> f64 {
    let q = p.abs() - DVec3::new(0.6, 0.5, 0.4);
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn torus(p: DVec3) -> f64 {
    (p.x.hypot(p.y) - 0.55).hypot(p.z) - 0.2
}

/// Something with the sign and the zeros of a distance, whose slope changes from place to place.
fn bent(p: DVec3, distance: f64) -> f64 {
    distance * (1.5 + (3.0 * p.x).sin() * 0.5 + p.z * 0.3)
}

fn worst(grid: &VoxelGrid, truth: impl Fn(DVec3) -> f64, counts: impl Fn(f64) -> bool) -> f64 {
    let lattice = grid.lattice();
    let error = |at: u64| {
        let wanted = truth(lattice.position(lattice.coordinates(at)));
        if counts(wanted) { (f64::from(grid.samples().get(at)) - wanted).abs() } else { 0.0 }
    };
    (0..lattice.samples()).map(error).fold(0.0, f64::max)
}

/// Smooth surfaces are second order in the spacing, edges first: halving it divides errors by four, and by two.
#[test]
fn distances_come_back_from_bent_values_at_the_order_stated() {
    type Shape = fn(DVec3) -> f64;
    let shapes: [(&str, Shape, f64, f64); 3] =
        [("sphere", |p| sphere(p, 0.7), 1.7, 0.3), ("torus", torus, 1.6, 1.5), ("box", cuboid, 0.8, 1.0)];
    for (name, shape, order, most) in shapes {
        let error = |n: u32| {
            let source = grid_on(cube(n), |p| bent(p, shape(p)));
            let converted = Redistance::new().convert(&source).unwrap();
            worst(&converted.value, shape, |_| true)
        };
        let (coarse, fine) = (error(17), error(33));
        let measured = (coarse / fine).log2();
        assert!(measured > order, "{name}: order {measured}");
        assert!(fine < most * 2.0 / 32.0, "{name}: {fine}");
    }
}

/// The march against every piece for every sample: never less, and within a hundredth of a cell.
#[test]
fn marched_distances_are_those_to_all_pieces() {
    let steps = [DVec3::new(0.3, 0.1, 0.0), DVec3::new(-0.1, 0.25, 0.0), DVec3::new(0.0, 0.05, 0.4)];
    let linear = DMat3::from_cols(steps[0], steps[1], steps[2]);
    let lattice = Lattice::try_new([13, 12, 10], Affine { linear, translation: DVec3::splat(7.0) }).unwrap();
    let center = lattice.position([6, 6, 5]);
    let source = grid_on(lattice, |p| torus((p - center) * 0.6) + 0.05 * (9.0 * p.x).sin());
    let level = Level { iso: 0.0, inside: Inside::Below };
    let mut all = Vec::new();
    for k in 0..9 {
        for j in 0..11 {
            for i in 0..12 {
                let corner = |c: usize| [i + (c & 1) as u32, j + (c >> 1 & 1) as u32, k + (c >> 2) as u32];
                let samples = std::array::from_fn(|c| source.sample(corner(c)));
                let corners = std::array::from_fn(|c| lattice.position(corner(c)));
                pieces::for_each_piece(&samples, &corners, level, |piece| all.push(piece));
            }
        }
    }
    let found = Redistance::new().convert(&source).unwrap().value;
    let mut exact = 0u64;
    for at in 0..lattice.samples() {
        let p = lattice.position(lattice.coordinates(at));
        let wanted = all.iter().map(|piece| pieces::distance_squared(p, piece)).fold(f64::INFINITY, f64::min).sqrt();
        let value = f64::from(found.samples().get(at));
        assert_eq!(value < 0.0, source.samples().get(at) < 0.0);
        assert!(value.abs() >= wanted - 1e-6, "{value} {wanted}");
        assert!(value.abs() <= wanted + 0.01 * lattice.cell_diagonal(), "{value} {wanted}");
        exact += u64::from((value.abs() - wanted).abs() < 1e-6);
    }
    assert!(exact * 100 > lattice.samples() * 98, "{exact} of {}", lattice.samples());
}

#[test]
fn points_segments_and_triangles_have_their_distances() {
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    for (p, wanted) in [
        (DVec3::new(0.2, 0.2, 3.0), 9.0),
        (DVec3::new(0.5, -2.0, 0.0), 4.0),
        (DVec3::new(-3.0, -4.0, 0.0), 25.0),
        (DVec3::ONE.with_z(0.0), 0.5),
    ] {
        assert!((pieces::distance_squared(p, &triangle) - wanted).abs() < 1e-14);
    }
    assert_eq!(pieces::distance_squared(DVec3::Z * 2.0, &[DVec3::ZERO; 3]), 4.0);
    assert_eq!(pieces::distance_squared(DVec3::Y * 2.0, &[DVec3::ZERO, DVec3::X, DVec3::X * 0.5]), 4.0);
}

#[test]
fn a_band_has_the_distances_of_the_dense_grid() {
    let source = grid_on(cube(41), |p| bent(p, torus(p)));
    let half_width = 0.21f32;
    let dense = Redistance { band: f64::from(half_width), ..Redistance::new() }.convert(&source).unwrap().value;
    let cut = SparseBricks::narrow_band(&source, half_width, &exec()).unwrap();
    let band = redistance_band(&cut, &exec()).unwrap();
    for at in 0..source.lattice().samples() {
        let place = source.lattice().coordinates(at);
        let (found, wanted) = (band.sample(place), dense.samples().get(at));
        assert!((found - wanted).abs() < 1e-6, "{place:?}: {found} {wanted}");
        assert_eq!(band.is_active(place), found.abs() < half_width);
    }
    // From values that fill less of the band than there is: bricks are added.
    let thin = grid_on(cube(41), |p| (4.0 * torus(p)).clamp(-0.25, 0.25));
    let thin = SparseBricks::narrow_band(&thin, half_width, &exec()).unwrap();
    let wide = redistance_band(&thin, &exec()).unwrap();
    assert!(wide.active() > 2 * thin.active());
    let error = worst(&wide.to_grid(&exec()).unwrap(), torus, |wanted| wanted.abs() < 0.2);
    assert!(error < 0.01, "{error}");
}

/// One sample inside, the first of its brick: most cells around it begin in bricks that are not stored.
#[test]
fn surface_that_reaches_out_of_the_stored_bricks_is_found() {
    let lattice = cube(17);
    let middle = lattice.position([8, 8, 8]);
    let source = grid_on(lattice, |p| if p == middle { -0.3 } else { 0.5 });
    let dense = Redistance { band: 0.5, ..Redistance::new() }.convert(&source).unwrap().value;
    let band = redistance_band(&SparseBricks::narrow_band(&source, 0.5, &exec()).unwrap(), &exec()).unwrap();
    for at in 0..lattice.samples() {
        let place = lattice.coordinates(at);
        assert!((band.sample(place) - dense.samples().get(at)).abs() < 1e-6, "{place:?}");
    }
}

/// The volume where a sample counts by how far its cell lies inside.
fn volume(grid: &VoxelGrid) -> f64 {
    let spacing = grid.lattice().spacing().x;
    let part = |at: u64| (0.5 - f64::from(grid.samples().get(at)) / spacing).clamp(0.0, 1.0);
    (0..grid.lattice().samples()).map(part).sum::<f64>() * spacing.powi(3)
}

#[test]
fn offsets_have_the_volumes_of_larger_and_smaller_shapes() {
    let source = grid_on(cube(41), |p| sphere(p, 0.6));
    for distance in [0.2, -0.25] {
        let moved = OffsetLevelSet::new(distance).convert(&source).unwrap();
        // Counting parts of cells adds the spacing squared, a 24th of it, by the second derivative of the volume.
        let (pi, radius) = (std::f64::consts::PI, 0.6f64 + distance);
        let wanted = 4.0 / 3.0 * pi * radius.powi(3) + 0.05f64.powi(2) / 24.0 * 8.0 * pi * radius;
        let found = volume(&moved.value);
        assert!((found / wanted - 1.0).abs() < 0.001, "{distance}: {found} {wanted}");
        assert_eq!(moved.report.deviation, Deviation::Estimated(distance.abs()));
    }
    // Outward a cuboid becomes the rounded one (Steiner): V + A d + (sum of edges / 4) pi d^2 ... + 4/3 pi d^3.
    let source = grid_on(cube(41), cuboid);
    let (a, b, c, d) = (1.2, 1.0, 0.8, 0.15);
    let pi = std::f64::consts::PI;
    let wanted = a * b * c + 2.0 * (a * b + b * c + c * a) * d + (a + b + c) * pi * d * d + 4.0 / 3.0 * pi * d.powi(3);
    let found = volume(&OffsetLevelSet::new(d).convert(&source).unwrap().value);
    assert!((found / wanted - 1.0).abs() < 0.004, "{found} {wanted}");
}

/// The radius along the axes, from the crossings.
fn radius(grid: &VoxelGrid) -> [f64; 3] {
    let level = Level { iso: 0.0, inside: Inside::Below };
    let field = GridField::try_new(grid, level, Interpolation::Tricubic, &exec()).unwrap();
    DVec3::AXES.map(|axis| {
        let (mut low, mut high) = (0.05, 0.9);
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if field.value(axis * middle) < 0.0 { low = middle } else { high = middle }
        }
        low
    })
}

#[test]
fn spheres_shrink_as_they_must_under_curvature_flow() {
    let lattice = cube(33);
    let source = grid_on(lattice, |p| sphere(p, 0.7));
    let time = 0.06;
    let wanted = (0.7f64 * 0.7 - 4.0 * time).sqrt();
    let converted = CurvatureFlow::new(time).convert(&source).unwrap();
    for found in radius(&converted.value) {
        assert!((found - wanted).abs() < 0.006, "dense: {found} {wanted}");
    }
    let band = SparseBricks::narrow_band(&source, 0.3, &exec()).unwrap();
    let band = curvature_flow_band(&band, time, 0.9, &exec()).unwrap();
    for found in radius(&band.to_grid(&exec()).unwrap()) {
        assert!((found - wanted).abs() < 0.012, "band: {found} {wanted}");
    }
    // Steps are as long as the bound says, a sixth of the squared spacing.
    let spacing = lattice.spacing().x;
    let length = converted.report.find("step_length").unwrap();
    assert!(length <= 0.9 * spacing * spacing / 6.0 * (1.0 + 1e-12) && length > 0.8 * spacing * spacing / 6.0);
}

/// On a lattice that is skewed, and twice as fine along one direction.
#[test]
fn flow_does_not_see_the_lattice() {
    let linear = DMat3::from_cols(DVec3::new(0.07, 0.0, 0.0), DVec3::new(0.03, 0.06, 0.0), DVec3::new(0.0, 0.02, 0.04));
    let placement = Affine { linear, translation: linear * DVec3::new(-18.0, -16.0, -22.0) };
    let lattice = Lattice::try_new([37, 33, 45], placement).unwrap();
    let source = grid_on(lattice, |p| sphere(p, 0.5));
    let converted = CurvatureFlow::new(0.03).convert(&source).unwrap();
    let wanted = (0.25f64 - 0.12).sqrt();
    for found in radius(&converted.value) {
        assert!((found - wanted).abs() < 0.008, "{found} {wanted}");
    }
}

#[test]
fn set_operations_are_those_of_each_sample() {
    let lattice = Lattice::along_axes([19, 20, 21], DVec3::ZERO, DVec3::ONE).unwrap();
    let random = |seed: f64| grid_on(lattice, |p| (p.dot(DVec3::new(12.9, 78.2, 37.7)) * seed).sin() * 3.0);
    let (a, b) = (random(1.0), random(1.7));
    type Rule = fn(bool, bool) -> bool;
    let rules: [(Blend, Rule); 3] =
        [(Blend::Union, |a, b| a || b), (Blend::Intersection, |a, b| a && b), (Blend::Difference, |a, b| a && !b)];
    let bands = [&a, &b].map(|grid| SparseBricks::narrow_band(grid, 2.0, &exec()).unwrap());
    for (how, rule) in rules {
        let found = blend(&a, &b, how, &exec()).unwrap();
        let band = blend_bands(&bands[0], &bands[1], how, &exec()).unwrap();
        for at in 0..lattice.samples() {
            let inside = |grid: &VoxelGrid| grid.samples().get(at) < 0.0;
            assert_eq!(inside(&found), rule(inside(&a), inside(&b)));
            let value = band.sample(lattice.coordinates(at));
            assert_eq!(value, found.samples().get(at).clamp(-2.0, 2.0));
        }
    }
}

#[test]
fn densities_count_from_their_level_and_bands_have_the_smaller_width() {
    let lattice = cube(9);
    let distance = |p: DVec3| sphere(p, 0.6);
    let at = |at: u64| u8::from(distance(lattice.position(lattice.coordinates(at))) < 0.0);
    let samples = Samples::U8((0..lattice.samples()).map(at).collect());
    let full = VoxelGrid::try_new(lattice, samples, Quantity::Occupancy).unwrap();
    let [a, b] = [&full, &grid_on(lattice, |_| 9.0)].map(|grid| grid.clone());
    let found = blend(&a, &b, Blend::Union, &exec()).unwrap();
    for at in 0..lattice.samples() {
        let wanted = if distance(lattice.position(lattice.coordinates(at))) < 0.0 { -0.5 } else { 0.5 };
        assert_eq!(found.samples().get(at), wanted);
    }
    let band = |width: f32| SparseBricks::narrow_band(&grid_on(lattice, distance), width, &exec()).unwrap();
    let both = blend_bands(&band(0.2), &band(0.4), Blend::Union, &exec()).unwrap();
    assert_eq!(both.background(), 0.2);
}

#[test]
fn redistancing_has_the_same_bits_on_any_number_of_threads() {
    let source = grid_on(cube(37), |p| bent(p, torus(p)));
    let alone = Exec::default().with_threads(shapeloom_core::Threads::Sequential);
    let wanted = Redistance::new().convert_with(&source, &alone).unwrap();
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| Redistance::new().convert(&source).unwrap()) == wanted, "{threads} threads");
    }
}

#[test]
fn smooth_unions_stay_within_a_quarter_of_the_radius() {
    let how = Blend::SmoothUnion { radius: 0.8 };
    for i in -20..=20 {
        for j in -20..=20 {
            let (a, b) = (i as f32 * 0.1, j as f32 * 0.1);
            let (found, plain) = (how.value(a, b), a.min(b));
            assert!(found <= plain && found >= plain - 0.2 - 1e-6);
            assert_eq!(found, how.value(b, a));
            assert!((a - b).abs() < 0.8 || found == plain);
        }
    }
    assert!((how.value(1.0, 1.0) - 0.8).abs() < 1e-6);
    // Half way to the radius a quarter of that is left: the polynomial is quadratic.
    assert!((how.value(1.0, 1.4) - 0.95).abs() < 1e-6);
}

#[test]
fn spheres_morph_with_their_radius() {
    let [a, b] = [0.3, 0.8].map(|radius| grid_on(cube(33), |p| sphere(p, radius)));
    let found = blend(&a, &b, Blend::Morph { fraction: 0.4 }, &exec()).unwrap();
    assert!(worst(&found, |p| sphere(p, 0.5), |_| true) < 1e-6);
}

/// How far the zeros of the interpolant stay away from the edges and corners of a cube, in cells.
#[test]
fn edges_of_a_cube_are_cut_by_less_than_a_cell() {
    let found = aliasing(24, Interpolation::Trilinear);
    let halved = aliasing(48, Interpolation::Trilinear);
    assert!(found[0] > 0.05 && found[0] < 0.6 && found[1] < 1.0, "{found:?}");
    // The same in cells on a lattice twice as fine: first order.
    assert!((halved[0] / found[0]).log2().abs() < 0.5, "{found:?} {halved:?}");
}

/// The largest distance of the cube's edges and corners from the interpolant's zeros, over several turns, in cells:
/// along the outward diagonal, where it is largest by symmetry.
fn aliasing(n: u32, interpolation: Interpolation) -> [f64; 2] {
    let lattice = cube(n);
    let spacing = lattice.spacing().x;
    let mut worst = [0.0f64; 2];
    for turn in 0..4 {
        let axis = DVec3::new(1.0, 2.0, f64::from(turn)).normalize();
        let turn = shapeloom_core::AxisAngle::new(axis, f64::from(turn) * 0.37).unwrap();
        let turn = Affine::from_rotation(turn);
        let back = turn.inverse().unwrap();
        let distance = |p: DVec3| {
            let q = back.point(p).abs() - DVec3::splat(0.45);
            q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
        };
        let grid = grid_on(lattice, distance);
        let level = Level { iso: 0.0, inside: Inside::Below };
        let field = GridField::try_new(&grid, level, interpolation, &exec()).unwrap();
        let gap = |place: DVec3, inward: DVec3| {
            // From the true edge inward to the first zero.
            let steps = 400;
            let step = |k: i32| spacing * 2.0 * f64::from(k) / f64::from(steps);
            let hit = (0..steps).find(|&k| field.value(turn.point(place + inward * step(k))) <= 0.0);
            hit.map_or(f64::INFINITY, |k| step(k) / spacing)
        };
        for k in 0..=40 {
            let along = -0.4 + 0.02 * f64::from(k);
            let inward = DVec3::new(0.0, -1.0, -1.0).normalize();
            worst[0] = worst[0].max(gap(DVec3::new(along, 0.45, 0.45), inward));
        }
        worst[1] = worst[1].max(gap(DVec3::splat(0.45), DVec3::splat(-1.0).normalize()));
    }
    worst
}

#[test]
fn strange_grids_are_refused_or_get_finite_distances() {
    let sized = |spacing: f64| {
        let lattice = Lattice::along_axes([4, 4, 4], DVec3::splat(5e6), DVec3::splat(spacing)).unwrap();
        grid_on(lattice, |p| p.x - 5e6 - spacing * 1.5)
    };
    for spacing in [1e-95, 1e95] {
        let refused = Redistance::new().convert(&sized(spacing)).unwrap_err();
        assert_eq!(refused.diagnostic().code(), "E-voxels-overflow");
        assert!(OffsetLevelSet::new(0.1).convert(&sized(spacing)).is_err());
        assert!(CurvatureFlow::new(0.1).convert(&sized(spacing)).is_err());
    }
    // Far from the origin distances lose nothing.
    let found = Redistance::new().convert(&sized(1e-3)).unwrap().value;
    assert!((found.sample([0, 2, 2]) + 1.5e-3).abs() < 1e-9, "{}", found.sample([0, 2, 2]));
    let lattice = cube(9);
    let holes = grid_on(lattice, |p| if p.x > 0.3 { f64::NAN } else { sphere(p, 0.5) });
    for converted in [Redistance::new().convert(&holes).unwrap(), CurvatureFlow::new(1e-4).convert(&holes).unwrap()] {
        assert_eq!(converted.report.deviation, Deviation::Unknown);
        assert_eq!(shapeloom_isosurface::sample_range(&converted.value, &Exec::default()).unwrap().not_finite, 0);
    }
    let empty = Redistance::new().convert(&grid_on(lattice, |_| 1.0)).unwrap();
    assert_eq!(empty.report.findings.iter().next().unwrap().code, "W-iso-empty");
    assert!(empty.value.samples().get(0) > 3.0);
    let refused = CurvatureFlow::new(1e9).convert(&holes).unwrap_err();
    assert_eq!(refused.diagnostic().code(), "E-voxels-steps");
    for background in [0.0, -1.0, f32::NAN] {
        let bricks = SparseBricks::from_grid(&holes, background, &exec()).unwrap();
        assert!(redistance_band(&bricks, &exec()).is_err());
        assert!(blend_bands(&bricks, &bricks, Blend::Union, &exec()).is_err());
        assert!(curvature_flow_band(&bricks, 1e-4, 0.5, &exec()).is_err());
    }
    let other = grid_on(cube(8), |_| 1.0);
    let refused = blend(&holes, &other, Blend::Union, &exec()).unwrap_err();
    assert_eq!(refused.diagnostic().code(), "E-voxels-lattices");
    assert!(blend(&other, &other, Blend::SmoothUnion { radius: 0.0 }, &exec()).is_err());
    assert!(blend(&other, &other, Blend::Morph { fraction: f32::NAN }, &exec()).is_err());
}
