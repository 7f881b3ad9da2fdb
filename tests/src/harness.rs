//! The conversion harness: what every entry of the registry must do, on shapes of its kind.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use shapeloom::convert::{Converter, Effect, Request, registry};
use shapeloom::core::glam::DVec3;
use shapeloom::core::{Category, Deviation, Exec, OptionKind, Stop, Threads};
use shapeloom::isosurface::Slabs;
use shapeloom::mesh::{Column, Domain, MeshAttributes};
use shapeloom::shape::{Geometry, Kind};
use shapeloom::voxels::VoxelGrid;

use crate::oracles::{self, Pieces};
use crate::shapes;
use crate::support::{Dice, files_below, root, text};

fn cases() -> impl Iterator<Item = (&'static Converter, &'static str, Geometry)> {
    registry().iter().flat_map(|converter| {
        shapes::of_kind(converter.from).into_iter().map(move |(name, shape)| (converter, name, shape))
    })
}

fn request(geometry: &Geometry) -> Request<'static> {
    let diagonal = geometry.bounds().diagonal();
    Request { tolerance: if diagonal > 0.0 { diagonal / 200.0 } else { 1.0 }, settings: &[] }
}

/// The two-sided distance that brute force finds. From the source to the result it is no more than the true one, being
/// sampled; the way back to a curved source is found by descent, to a millionth of its size.
fn measured(source: &Geometry, result: &Geometry) -> f64 {
    if let (Geometry::VoxelGrid(grid), false) = (result, source.kind() == Kind::VoxelGrid) {
        return measured_on_lattice(source, grid);
    }
    // A grid's surface by points on it: that is no less than the distance.
    let pieces = match result {
        Geometry::VoxelGrid(_) => Pieces::Points(oracles::samples(result)),
        _ => Pieces::of(result).expect("every other result so far is made of straight pieces"),
    };
    let mut dice = Dice(7);
    // Every sample against every piece: of large sets a fixed choice.
    let mut some = |points: Vec<_>, most: usize| {
        let keep = most as f64 / points.len().max(1) as f64;
        points.into_iter().filter(|_| dice.unit() < keep).collect::<Vec<_>>()
    };
    let there = some(oracles::samples(source), 3000).into_iter().map(|p| pieces.distance(p)).fold(0.0, f64::max);
    let straight = Pieces::of(source);
    let back = some(pieces.samples(), 2000).into_iter().map(|p| match &straight {
        Some(source) => source.distance(p),
        None => oracles::to_curved(source, p).unwrap_or(0.0) - 1e-6 * source.bounds().diagonal(),
    });
    there.max(back.fold(0.0, f64::max))
}

#[test]
fn promised_bounds_hold_by_brute_force() {
    for (converter, name, source) in cases() {
        let request = request(&source);
        let converted = converter.run(&source, &request, &Exec::default()).unwrap_or_else(|error| {
            panic!("{} on {name}: {error}", converter.name);
        });
        assert_eq!(converted.value.kind(), converter.to, "{}", converter.name);
        let found = if oracles::samples(&source).is_empty() { 0.0 } else { measured(&source, &converted.value) };
        let rounding = 1e-13 * source.bounds().diagonal();
        match converted.report.deviation {
            Deviation::Exact => assert!(found <= rounding, "{} on {name}: exact, but {found}", converter.name),
            Deviation::AtMost(bound) => {
                assert!(found <= bound + rounding, "{} on {name}: {found} over the bound {bound}", converter.name);
            }
            Deviation::Estimated(_) | Deviation::Unknown => {}
        }
        match converter.effect {
            Effect::Exact => assert_eq!(converted.report.deviation, Deviation::Exact, "{} on {name}", converter.name),
            Effect::WithinTolerance => assert!(
                converted.report.deviation.is_within(request.tolerance),
                "{} on {name}: {:?} over {}",
                converter.name,
                converted.report.deviation,
                request.tolerance
            ),
            Effect::Reported => {}
        }
    }
}

/// The same for samples on a lattice: to places where the interpolant reaches its iso value. Such places are found on lines a quarter
/// of a cell apart, so from the source to them it is no more than the true one when as much is taken away.
fn measured_on_lattice(source: &Geometry, grid: &VoxelGrid) -> f64 {
    // Where samples do not say where the surface is, nothing can be promised.
    if grid.default_iso().is_none() {
        return 0.0;
    }
    let source = Pieces::of(source).expect("every source so far is made of straight pieces");
    let surface = oracles::trilinear_surface(grid);
    let mut dice = Dice(7);
    let keep = |count: usize, most: f64| most / count.max(1) as f64;
    let samples = source.samples();
    let part = keep(samples.len(), 300.0);
    let there = samples
        .into_iter()
        .filter(|_| dice.unit() < part)
        .map(|p| surface.iter().map(|q| q.distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt());
    let there = there.fold(0.0, f64::max) - grid.lattice().cell_diagonal() / 2.0;
    let part = keep(surface.len(), 2000.0);
    let back = surface.iter().filter(|_| dice.unit() < part).map(|&p| source.distance(p));
    back.fold(there.max(0.0), f64::max)
}

/// The oracle must notice a result that is wrong: a mesh moved by more than its bound.
#[test]
fn the_harness_notices_a_moved_result() {
    let source: Geometry = shapeloom::parametric::BezierSurface::new(vec![shapes::bent_patch()]).into();
    let converter = shapeloom::convert::converter("tessellate-patches").expect("it is in the registry");
    let converted = converter.run(&source, &request(&source), &Exec::default()).expect("a bent patch is sound");
    let bound = converted.report.deviation.value().expect("a bound");
    let shift = shapeloom::core::Affine::from_translation(shapeloom::core::glam::DVec3::Z * (3.0 * bound));
    assert!(measured(&source, &converted.value.transformed(&shift)) > bound);
}

fn attributes(geometry: &Geometry) -> Option<&MeshAttributes> {
    match geometry {
        Geometry::TriMesh(mesh) => Some(mesh.attributes()),
        Geometry::PolyMesh(mesh) => Some(mesh.attributes()),
        _ => None,
    }
}

/// Where the element with a tag lies in the source: a vertex's or corner's position, a face's corners.
fn tagged_places(source: &Geometry, domain: Domain, tag: usize) -> Vec<DVec3> {
    let (positions, faces): (&[DVec3], Vec<&[u32]>) = match source {
        Geometry::TriMesh(mesh) => (mesh.positions(), mesh.triangles().iter().map(|face| face.as_slice()).collect()),
        Geometry::PolyMesh(mesh) => (mesh.positions(), mesh.faces().collect()),
        other => panic!("a {} has no tags", other.kind()),
    };
    let at = |vertex: &u32| positions[*vertex as usize];
    match domain {
        Domain::Vertex => vec![positions[tag]],
        Domain::Wedge => vec![at(faces.concat().get(tag).expect("a corner"))],
        Domain::Face => faces[tag].iter().map(at).collect(),
    }
}

/// A result's positions, and of each corner its vertex and face.
fn corners_of(result: &Geometry) -> (&[DVec3], Vec<(u32, usize)>) {
    match result {
        Geometry::TriMesh(mesh) => {
            let corners = mesh.triangles().as_flattened().iter().enumerate().map(|(wedge, &v)| (v, wedge / 3));
            (mesh.positions(), corners.collect())
        }
        Geometry::PolyMesh(mesh) => {
            let corners = mesh.faces().enumerate().flat_map(|(face, corners)| corners.iter().map(move |&v| (v, face)));
            (mesh.positions(), corners.collect())
        }
        other => panic!("a {} has no corners", other.kind()),
    }
}

/// Checks that every tag in a column of the result lies where the tagged element of the source lies, up to how far a
/// vertex may have moved.
fn check_tags(source: &Geometry, result: (&Geometry, f64), before: Domain, after: Domain, column: &Column) -> bool {
    let (result, moved) = result;
    let (positions, corners) = corners_of(result);
    corners.into_iter().enumerate().all(|(wedge, (vertex, face))| {
        let element = match after {
            Domain::Vertex => vertex as usize,
            Domain::Face => face,
            Domain::Wedge => wedge,
        };
        let tag = column.number(element, 0) as usize;
        tagged_places(source, before, tag).iter().any(|place| place.distance(positions[vertex as usize]) <= moved)
    })
}

#[test]
fn tagged_attributes_arrive_where_they_belong_or_are_listed_as_lost() {
    let (mut checked, mut noticed) = (0, 0);
    for (converter, name, source) in cases() {
        let Some(before) = attributes(&source) else { continue };
        let converted = converter.run(&source, &request(&source), &Exec::default()).expect("it ran before");
        let moved = if let Deviation::AtMost(bound) = converted.report.deviation { bound } else { 0.0 };
        let result = (&converted.value, moved);
        let of_result = attributes(result.0);
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            let Some(tags) = before.of(domain).get("tag") else { continue };
            // A vertex attribute may move to the corners; each kind of element has a tag of the same name, so the
            // values tell which one arrived.
            let arrived = [domain, Domain::Wedge].into_iter().find_map(|after| {
                let column = of_result?.of(after).get("tag")?;
                check_tags(&source, result, domain, after, column).then_some((after, column))
            });
            let Some((after, column)) = arrived else {
                let what = format!("{domain} attribute \"{}\"", tags.name());
                let lost = converted.report.losses.iter().any(|loss| loss.what == what);
                assert!(lost, "{} on {name}: {what}", converter.name);
                continue;
            };
            checked += 1;
            // The check itself notices values that are shuffled.
            let shuffled: Vec<u32> = (0..column.len() as u32).rev().collect();
            let wrong = Column::labels("tag", shuffled.iter().map(|&i| column.number(i as usize, 0) as u32).collect());
            noticed += usize::from(!check_tags(&source, result, domain, after, &wrong));
        }
    }
    assert!(checked >= 6 && noticed == checked, "{checked} checked, {noticed} noticed");
}

/// The same result, report and all, on one, two and three threads and on none but the caller's.
#[test]
fn every_converter_gives_the_same_bits_on_any_number_of_threads() {
    for (converter, name, source) in cases() {
        let alone = Exec::default().with_threads(Threads::Sequential);
        let wanted = converter.run(&source, &request(&source), &alone).expect("it ran before");
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let found = pool.install(|| converter.run(&source, &request(&source), &Exec::default()));
            assert!(found.expect("it ran before") == wanted, "{} on {name}, {threads} threads", converter.name);
        }
    }
}

/// Counts the polls of a run, then stops at some of them.
#[test]
fn cancelling_at_any_tick_gives_a_typed_error() {
    let mut dice = Dice(11);
    for (converter, name, source) in cases() {
        let polls = Arc::new(AtomicU64::new(0));
        let counter = Arc::clone(&polls);
        let counting = Exec::default().with_watch(move || {
            counter.fetch_add(1, Ordering::Relaxed);
            None
        });
        let _ = converter.run(&source, &request(&source), &counting).expect("it ran before");
        let total = polls.load(Ordering::Relaxed);
        assert!(total > 0 || source.bounds().is_empty(), "{} on {name} never polls", converter.name);
        let some = (0..8).map(|_| dice.next() % total.max(1));
        let ticks: Vec<u64> = if total <= 64 { (0..total).collect() } else { some.chain([0, total - 1]).collect() };
        for stop_at in ticks {
            let seen = AtomicU64::new(0);
            let stopping = Exec::default()
                .with_watch(move || (seen.fetch_add(1, Ordering::Relaxed) >= stop_at).then_some(Stop::Cancelled));
            let error = converter.run(&source, &request(&source), &stopping).expect_err("it was cancelled");
            assert_eq!(error.category(), Category::Cancelled, "{} on {name} at {stop_at}", converter.name);
            assert_eq!(stopping.memory_taken(), 0, "{} on {name} keeps memory", converter.name);
        }
    }
}

#[test]
fn a_small_budget_gives_a_typed_error_or_is_enough() {
    let mut refused = 0;
    for (converter, name, source) in cases() {
        for bytes in [0, 1 << 10, 1 << 20] {
            let exec = Exec::default().with_memory(bytes);
            match converter.run(&source, &request(&source), &exec) {
                Ok(_) => {}
                Err(error) => {
                    assert_eq!(error.category(), Category::OverLimit, "{} on {name}: {error}", converter.name);
                    refused += 1;
                }
            }
            assert_eq!(exec.memory_taken(), 0, "{} on {name} keeps memory", converter.name);
        }
    }
    assert!(refused > registry().len(), "{refused}");
}

#[test]
fn numeric_options_survive_absurd_values() {
    for (converter, name, source) in cases() {
        for spec in converter.specs() {
            if !matches!(spec.kind, OptionKind::Float | OptionKind::Integer) {
                continue;
            }
            for value in ["NaN", "inf", "-inf", "0", "-1", "1e300", "1e-300"] {
                let settings = [(spec.name.to_owned(), value.to_owned())];
                let request = Request { settings: &settings, ..request(&source) };
                match converter.run(&source, &request, &Exec::default()) {
                    Ok(converted) => {
                        let bounds = converted.value.bounds();
                        let finite = bounds.is_empty() || (bounds.min.is_finite() && bounds.max.is_finite());
                        let bound = converted.report.deviation.value().unwrap_or(0.0);
                        assert!(finite && !bound.is_nan(), "{} on {name} with {}={value}", converter.name, spec.name);
                    }
                    Err(error) => {
                        let told = [Category::Usage, Category::OverLimit, Category::Failed].contains(&error.category());
                        assert!(told, "{} on {name} with {}={value}: {error}", converter.name, spec.name);
                    }
                }
            }
        }
    }
}

/// Converters whose source is no kind of geometry, with their names: a window of a plane in which a field is seen.
const UNREGISTERED: [(&str, &str); 1] = [("AdaptiveMarchingSquares", "adaptive-marching-squares")];

#[test]
fn every_converter_is_registered_documented_and_shown() {
    let mut found = Vec::new();
    for path in files_below("crates", ".rs") {
        let source = std::fs::read_to_string(&path).expect("a source file");
        for line in source.lines().filter(|line| line.starts_with("impl") && line.contains(" for ")) {
            if line.contains("Convert<") && !line.contains("FromTolerance<") {
                let name = line.split(" for ").nth(1).unwrap_or_default();
                found.push(name.trim_end_matches(['{', ' ']).to_owned());
            }
        }
    }
    assert!(found.len() >= registry().len());
    for name in found {
        let known = registry().iter().any(|converter| converter.type_name == name);
        assert!(
            known || UNREGISTERED.iter().any(|(other, ..)| *other == name),
            "{name} converts but is not in the registry"
        );
    }
    let examples = text("examples/Cargo.toml");
    let registered = registry().iter().map(|converter| converter.name);
    for name in registered.chain(UNREGISTERED.iter().map(|(_, name)| *name)) {
        let word = name.replace('-', "_");
        for path in [format!("docs/algorithms/{word}.md"), format!("examples/{word}.rs")] {
            assert!(root().join(&path).exists(), "{name} has no {path}");
        }
        assert!(examples.contains(&format!("path = \"{word}.rs\"")), "examples/Cargo.toml lacks {word}");
        let pages = text(&format!("docs/algorithms/{word}.md"));
        assert!(pages.contains(name), "docs/algorithms/{word}.md does not name {name}");
    }
}
