//! The conversion harness: what every entry of the registry must do, on shapes of its kind.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use shapeloom::convert::{Converter, Effect, Request, registry};
use shapeloom::core::{Category, Deviation, Exec, OptionKind, Stop};
use shapeloom::mesh::{Domain, MeshAttributes};
use shapeloom::shape::Geometry;

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
    let pieces = Pieces::of(result).expect("every result so far is made of straight pieces");
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

#[test]
fn tagged_attributes_arrive_or_are_listed_as_lost() {
    for (converter, name, source) in cases() {
        let converted = converter.run(&source, &request(&source), &Exec::default()).expect("it ran before");
        let (Some(before), Some(after)) = (attributes(&source), attributes(&converted.value)) else { continue };
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            for column in before.of(domain) {
                let arrived = [Domain::Vertex, Domain::Face, Domain::Wedge]
                    .into_iter()
                    .any(|domain| after.of(domain).get(column.name()).is_some());
                let named = |loss: &shapeloom::core::Loss| loss.what.contains(column.name());
                let lost = converted.report.losses.iter().any(named);
                assert!(arrived || lost, "{} on {name}: {domain} attribute {}", converter.name, column.name());
            }
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
        for _ in 0..8.min(total) {
            let stop_at = dice.next() % total;
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
                if let Err(error) = converter.run(&source, &request, &Exec::default()) {
                    let told = [Category::Usage, Category::OverLimit, Category::Failed].contains(&error.category());
                    assert!(told, "{} on {name} with {}={value}: {error}", converter.name, spec.name);
                }
            }
        }
    }
}

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
        assert!(known, "{name} converts but is not in the registry");
    }
    let examples = text("examples/Cargo.toml");
    for converter in registry() {
        let word = converter.name.replace('-', "_");
        for path in [format!("docs/algorithms/{word}.md"), format!("examples/{word}.rs")] {
            assert!(root().join(&path).exists(), "{} has no {path}", converter.name);
        }
        assert!(examples.contains(&format!("path = \"{word}.rs\"")), "examples/Cargo.toml lacks {word}");
        let pages = text(&format!("docs/algorithms/{word}.md"));
        assert!(pages.contains(converter.name), "docs/algorithms/{word}.md does not name {}", converter.name);
    }
}
