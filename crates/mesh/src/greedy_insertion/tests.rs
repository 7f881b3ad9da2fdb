//! The converter as a whole.

use std::collections::HashMap;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Affine, Category, Convert, Deviation, Exec};

use crate::{GreedyInsertion, HeightField, TriMesh, TriangulateHeightField};

struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(bound)) as u32
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.below(1 << 24)) / f64::from(1 << 24)
    }
}

fn field(columns: u32, rows: u32, height: impl FnMut(u32) -> f64) -> HeightField {
    let heights = (0..columns * rows).map(height).collect();
    HeightField::try_new(columns, rows, DVec2::ONE, heights).unwrap()
}

/// Hills, noise or steps with holes; from 2 x 2 to 40 x 37 samples.
fn random_field(dice: &mut Dice, round: u32) -> HeightField {
    let (columns, rows) = (2 + dice.below(39), 2 + dice.below(36));
    let holes = [0.0, 0.02, 0.2, 0.5][round as usize % 4];
    let (a, b) = (dice.unit() * 0.6, dice.unit() * 0.6);
    let pond = DVec2::new(dice.unit() * f64::from(columns), dice.unit() * f64::from(rows));
    field(columns, rows, |k| {
        let (x, y) = (f64::from(k % columns), f64::from(k / columns));
        let hill = (a * x).sin() + (b * y).cos() * (a * x * 0.5).cos();
        let missing =
            if round.is_multiple_of(3) { pond.distance(DVec2::new(x, y)) < 20.0 * holes } else { dice.unit() < holes };
        match round % 5 {
            _ if missing => f64::NAN,
            0 | 1 => hill,
            2 => dice.unit(),
            3 => f64::from(u8::from(x > y)),
            _ => hill + 0.1 * dice.unit(),
        }
    })
}

/// Twice the area in plan, in cells, by the texture coordinates, which say where in the grid a vertex is.
fn in_plan(field: &HeightField, mesh: &TriMesh) -> Vec<DVec2> {
    let size = DVec2::new(f64::from(field.columns() - 1), f64::from(field.rows() - 1));
    let column = mesh.attribute(crate::Domain::Vertex, crate::TEXCOORD).unwrap();
    (0..mesh.positions().len()).map(|v| DVec2::new(column.number(v, 0), column.number(v, 1)) * size).collect()
}

fn whole_cells(field: &HeightField) -> Vec<(u32, u32)> {
    let cells = (0..field.rows() - 1).flat_map(|y| (0..field.columns() - 1).map(move |x| (x, y)));
    cells.filter(|&(x, y)| (0..4).all(|k| field.sample(x + k % 2, y + k / 2).is_some())).collect()
}

/// The bilinear surface at a point of the plan, in the field's own frame.
fn bilinear(field: &HeightField, p: DVec2) -> f64 {
    let at = |coordinate: f64, count: u32| (coordinate.floor().max(0.0) as u32).min(count - 2);
    // On a line of the grid, up to rounding, any cell beside will do that is whole.
    let mut found = f64::NAN;
    for (dx, dy) in [(1e-9, 1e-9), (1e-9, -1e-9), (-1e-9, 1e-9), (-1e-9, -1e-9)] {
        let (x, y) = (at(p.x - dx, field.columns()), at(p.y - dy, field.rows()));
        let (s, t) = (p.x - f64::from(x), p.y - f64::from(y));
        let h = |i: u32, j: u32| field.heights()[((y + j) * field.columns() + x + i) as usize];
        let value = (h(0, 0) * (1.0 - s) + h(1, 0) * s) * (1.0 - t) + (h(0, 1) * (1.0 - s) + h(1, 1) * s) * t;
        found = if value.is_nan() { found } else { value };
    }
    found
}

/// The largest difference at a lattice of points of every triangle.
fn sampled(field: &HeightField, mesh: &TriMesh, steps: u32) -> f64 {
    let plan = in_plan(field, mesh);
    let mut worst = 0.0f64;
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| plan[v as usize]);
        let [ha, hb, hc] = triangle.map(|v| mesh.positions()[v as usize].z);
        for k in 0..=steps {
            for l in 0..=steps - k {
                let (u, v) = (f64::from(k) / f64::from(steps), f64::from(l) / f64::from(steps));
                let p = a + (b - a) * u + (c - a) * v;
                let difference = bilinear(field, p) - (ha * (1.0 - u - v) + hb * u + hc * v);
                assert!(!difference.is_nan(), "a triangle over a hole");
                worst = worst.max(difference.abs());
            }
        }
    }
    worst
}

/// Covers the whole cells exactly, upward, side to side.
fn check_plan(field: &HeightField, mesh: &TriMesh) {
    let plan = in_plan(field, mesh);
    let mut area = 0.0;
    let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| plan[v as usize]);
        let doubled = (b - a).perp_dot(c - a);
        assert!(doubled > 1e-9, "{triangle:?} is turned over");
        area += doubled / 2.0;
        for k in 0..3 {
            let count = sides.entry((triangle[k], triangle[(k + 1) % 3])).or_default();
            *count += 1;
            assert_eq!(*count, 1, "a side used twice the same way");
        }
    }
    let cells = whole_cells(field);
    assert!((area - cells.len() as f64).abs() < 1e-9 * (1.0 + area), "{area} {}", cells.len());
    // Sides without a neighbour are those between a whole cell and another: of the same length in all, and none has a
    // vertex inside.
    let border: Vec<(u32, u32)> = sides.keys().copied().filter(|&(a, b)| !sides.contains_key(&(b, a))).collect();
    let length: f64 = border.iter().map(|&(a, b)| plan[a as usize].distance(plan[b as usize])).sum();
    let whole: std::collections::HashSet<(u32, u32)> = cells.iter().copied().collect();
    let beside = |x: u32, y: u32| {
        [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)].map(|cell| !whole.contains(&cell))
    };
    let outline: usize = cells.iter().map(|&(x, y)| beside(x, y).iter().filter(|open| **open).count()).sum();
    assert!((length - outline as f64).abs() < 1e-9 * (1.0 + length), "{length} {outline}");
    let mut used = vec![false; plan.len()];
    mesh.triangles().as_flattened().iter().for_each(|&v| used[v as usize] = true);
    assert!(used.iter().all(|used| *used), "a vertex without triangles");
    for &(a, b) in &border {
        let (p, q) = (plan[a as usize], plan[b as usize]);
        for (v, &r) in plan.iter().enumerate() {
            let inside = (q - p).perp_dot(r - p) == 0.0 && (r - p).dot(r - q) < 0.0;
            assert!(!inside, "vertex {v} lies in the middle of side {a}-{b}");
        }
    }
}

#[test]
fn random_fields_are_covered_within_the_tolerance() {
    let mut dice = Dice(1);
    let mut sharpest = 0.0f64;
    for round in 0..120 {
        let field = random_field(&mut dice, round);
        let tolerance = [0.5, 0.1, 0.02, 0.004][dice.below(4) as usize];
        let made = GreedyInsertion::new(tolerance).convert(&field).unwrap();
        let context = format!("round {round}, {} x {}, {tolerance}", field.columns(), field.rows());
        check_plan(&field, &made.value);
        let nothing = made.value.triangles().is_empty();
        let strays = made.report.find("stray_samples").unwrap() > 0.0;
        assert_eq!(made.report.deviation == Deviation::Unknown, nothing && strays, "{context}");
        let bound = made.report.deviation.value().unwrap_or(0.0);
        assert!(bound <= tolerance, "{context}: {bound}");
        assert!(made.report.findings.iter().all(|finding| finding.code != "W-height-tolerance"), "{context}");
        let found = sampled(&field, &made.value, 24);
        assert!(found <= bound + 1e-14, "{context}: {found} over {bound}");
        if bound > 0.0 {
            sharpest = sharpest.max(found / bound);
        }
        assert_eq!(made.report.find("regular_triangles"), Some(2.0 * whole_cells(&field).len() as f64));
    }
    assert!(sharpest > 0.999, "{sharpest}");
}

/// The bound is no more than what dense sampling finds, up to the step of the sampling.
#[test]
fn the_bound_is_sharp() {
    let mut dice = Dice(5);
    for round in [0, 1, 2, 4, 6, 7] {
        let field = random_field(&mut dice, round);
        let made = GreedyInsertion { max_cell_steps: 1, ..GreedyInsertion::new(0.3) }.convert(&field).unwrap();
        let Deviation::AtMost(bound) = made.report.deviation else { continue };
        let found = sampled(&field, &made.value, 240);
        assert!(found <= bound && found > 0.97 * bound, "{round}: {found} {bound}");
    }
}

#[test]
fn planes_are_two_triangles_and_steps_are_followed() {
    let plane = field(40, 23, |k| 0.3 * f64::from(k % 40) - 0.7 * f64::from(k / 40));
    for tolerance in [0.0, 1e-300, 1.0, 1e300] {
        let made = GreedyInsertion::new(tolerance).convert(&plane).unwrap();
        assert_eq!((made.value.triangles().len(), made.report.deviation), (2, Deviation::Exact), "{tolerance}");
    }
    // A cliff straight along the grid: its two edges are lines, so that slivers suffice.
    let cliff = field(40, 23, |k| f64::from(u8::from(k % 40 > 17)));
    let made = GreedyInsertion::new(0.01).convert(&cliff).unwrap();
    check_plan(&cliff, &made.value);
    assert!(made.value.triangles().len() < 200, "{}", made.value.triangles().len());
    assert!(sampled(&cliff, &made.value, 40) <= 0.01);
}

#[test]
fn tolerance_zero_takes_every_sample_and_says_what_it_misses() {
    let mut dice = Dice(9);
    let noise = field(9, 7, |_| dice.unit());
    let made = GreedyInsertion { max_cell_steps: 1, ..GreedyInsertion::new(0.0) }.convert(&noise).unwrap();
    let regular = TriangulateHeightField::new().convert(&noise).unwrap();
    assert_eq!((made.value.positions().len(), made.value.triangles().len()), (63, 96));
    let [found, wanted] = [&made, &regular].map(|made| made.report.deviation.value().unwrap());
    assert!((found / wanted - 1.0).abs() < 1e-13, "{found} {wanted}");
    let finding = made.report.findings.iter().next().unwrap();
    assert_eq!((finding.code, finding.count), ("W-height-tolerance", 48));
    // Cut finer, the error falls with the square of the steps.
    for steps in [2, 5] {
        let fine = GreedyInsertion { max_cell_steps: steps, ..GreedyInsertion::new(0.0) }.convert(&noise).unwrap();
        let bound = fine.report.deviation.value().unwrap();
        assert!((bound * f64::from(steps * steps) / wanted - 1.0).abs() < 1e-12);
        check_plan(&noise, &fine.value);
        assert!(sampled(&noise, &fine.value, 20) <= bound);
    }
}

/// Along the heights as placed: a field that stands on its side, scaled and mirrored, far away.
#[test]
fn placements_stretch_the_tolerance_and_keep_the_outside() {
    let mut dice = Dice(2);
    let plain = random_field(&mut dice, 0);
    let scale = Affine::from_scale(DVec3::new(-2.0, 3.0, 10.0));
    let made = GreedyInsertion::new(1.0).convert(&plain.clone().placed(scale)).unwrap();
    let wanted = GreedyInsertion::new(0.1).convert(&plain).unwrap();
    assert_eq!(made.value.triangles().len(), wanted.value.triangles().len());
    assert!(made.report.deviation.is_within(1.0));
    let [found, before] = [&made, &wanted].map(|made| made.report.deviation.value().unwrap());
    assert!((found / before / 10.0 - 1.0).abs() < 1e-12);
    assert!(crate::face_normals(&made.value).iter().all(|normal| normal.z > 0.0));
    let far = Affine::from_translation(DVec3::splat(5e6));
    let moved = GreedyInsertion::new(0.1).convert(&plain.placed(far)).unwrap();
    assert_eq!(moved.value.triangles(), wanted.value.triangles());
}

#[test]
fn strange_fields_are_taken() {
    let exec = Exec::default();
    let hole = field(5, 4, |_| f64::NAN);
    let made = GreedyInsertion::new(0.1).convert(&hole).unwrap();
    assert!(made.value.triangles().is_empty() && made.value.positions().is_empty());
    for size in [1e-300, 1e-9, 1e150, 1e308] {
        let mut dice = Dice(4);
        let noise = field(7, 8, |_| (dice.unit() * 2.0 - 1.0) * size);
        let made = GreedyInsertion::new(0.1 * size).convert(&noise).unwrap();
        assert!(made.report.deviation.is_within(0.1 * size), "{size}");
        check_plan(&noise, &made.value);
        let small = GreedyInsertion::new(1e-300).convert(&noise).unwrap();
        assert!(!small.report.deviation.value().unwrap().is_nan());
    }
    let flat = field(3, 3, |k| f64::from(k % 2)).placed(Affine::from_scale(DVec3::new(1.0, 1.0, 0.0)));
    assert_eq!(GreedyInsertion::new(0.0).convert(&flat).unwrap().report.deviation, Deviation::Exact);
    // A row of cells; twice as long as 16 bits.
    let row = field(1 << 17, 2, |k| (f64::from(k) * 1e-3).sin());
    let made = GreedyInsertion::new(0.01).convert_with(&row, &exec).unwrap();
    assert!(made.report.deviation.is_within(0.01) && made.value.triangles().len() < 40_000);
    let refused = GreedyInsertion::new(0.01).convert_with(&row, &Exec::default().with_memory(100_000)).unwrap_err();
    assert_eq!(refused.category(), Category::OverLimit);
    assert!(GreedyInsertion::new(f64::NAN).convert(&row).is_err());
}

/// That triangles cover the whole cells of a field without holes, upward, and within the bound.
fn assert_covered(field: &HeightField, tolerance: f64) {
    let (columns, rows) = (field.columns(), field.rows());
    let converted = GreedyInsertion::new(tolerance).convert(field).unwrap();
    let plan = in_plan(field, &converted.value);
    let mut area = 0.0;
    for corners in converted.value.triangles() {
        let [a, b, c] = corners.map(|vertex| plan[vertex as usize]);
        let doubled = (b - a).perp_dot(c - a);
        assert!(doubled > 1e-9, "{columns} x {rows}, {tolerance}: {a} {b} {c}");
        area += doubled / 2.0;
    }
    assert!((area - f64::from((columns - 1) * (rows - 1))).abs() < 1e-9, "{columns} x {rows}, {tolerance}: {area}");
    let bound = converted.report.deviation.value().unwrap();
    let found = sampled(field, &converted.value, 4);
    assert!(found <= bound, "{columns} x {rows}, {tolerance}: {found} {bound}");
}

/// Where only points between samples are too far, the sample that goes in may leave the triangle as it was: it must not be
/// forgotten. Saddles and fields of few heights have many triangles that are equally far.
#[test]
fn no_triangle_is_forgotten() {
    let heights = [2, 1, 1, 1, 3, 3, 0, 0, 0, 2, 3, 1, 1, 3, 1, 2, 0, 2];
    assert_covered(&field(9, 2, |k| f64::from(heights[k as usize])), 2.1);
    for columns in 3..20u32 {
        for rows in (3..20u32).chain([33]) {
            let saddle = field(columns, rows, |k| f64::from(k % columns) * f64::from(k / columns));
            let size = f64::from(columns - 1) * f64::from(rows - 1);
            for part in [0.01, 0.001] {
                assert_covered(&saddle, part * size.hypot(f64::from(columns)));
            }
        }
    }
    let mut dice = Dice(5);
    for _ in 0..1500 {
        let (columns, rows, few) = (2 + dice.below(9), 2 + dice.below(9), 2 + dice.below(4));
        let steps = field(columns, rows, |_| f64::from(dice.below(few)));
        assert_covered(&steps, f64::from(few - 1) * (0.05 + dice.unit()));
    }
}

/// A few cells of many triangles.
#[test]
fn polls_are_as_many_as_triangles() {
    let mut dice = Dice(9);
    let noise = field(5, 4, |_| dice.unit());
    let polls = |max_cell_steps| {
        let options = GreedyInsertion { max_cell_steps, ..GreedyInsertion::new(0.0) };
        crate::poll_count::polls(&|exec| drop(options.convert_with(&noise, exec).unwrap()))
    };
    // Each of the 12 cells becomes 20 thousand triangles.
    assert!(polls(100) >= polls(1) + 10, "{} {}", polls(100), polls(1));
}
