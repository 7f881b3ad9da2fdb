//! Little memory, little time, much input.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Convert, Exec, Stop};

use super::Dice;
use crate::{ConstrainedDelaunay, DelaunayTriangulation, GeometricGraph, PointCloud};

/// A hub of 5000 spokes, and long edges across: every step is polled, memory returns, budgets hold.
#[test]
fn hubs_are_cancelled_and_limited_like_all_else() {
    let mut points = vec![DVec3::ZERO];
    let spoke = |k: u32| {
        let angle = f64::from(k) / 5000.0 * std::f64::consts::TAU;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    };
    points.extend((0..5000).map(spoke));
    let mut edges: Vec<[u32; 2]> = (1..=5000).map(|k| [0, k]).collect();
    edges.push([1, 1700]);
    let graph = GeometricGraph::try_new(points, edges).unwrap();
    let polls = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&polls);
    let counting = Exec::default().with_watch(move || {
        counter.fetch_add(1, Ordering::Relaxed);
        None
    });
    let converted = ConstrainedDelaunay::new().convert_with(&graph, &counting).unwrap();
    // The long edge crosses the spokes between its ends.
    assert_eq!(converted.report.find("crossings"), Some(1698.0));
    let total = polls.load(Ordering::Relaxed);
    assert!(total > 25, "{total}");
    for stop_at in [0, total / 2, total - 1] {
        let seen = AtomicU64::new(0);
        let stopping = Exec::default()
            .with_watch(move || (seen.fetch_add(1, Ordering::Relaxed) >= stop_at).then_some(Stop::Cancelled));
        let error = ConstrainedDelaunay::new().convert_with(&graph, &stopping).unwrap_err();
        assert_eq!((error.category(), stopping.memory_taken()), (Category::Cancelled, 0));
    }
    for bytes in [1 << 10, 1 << 20, 3 << 20] {
        let exec = Exec::default().with_memory(bytes);
        let error = ConstrainedDelaunay::new().convert_with(&graph, &exec).unwrap_err();
        assert_eq!((error.category(), exec.memory_taken()), (Category::OverLimit, 0), "{bytes}");
    }
}

/// Many points on few lines, on one circle, and in one place: none takes more than its share of time.
#[test]
fn large_sets_of_every_kind_go_through() {
    let mut dice = Dice(1);
    let count = 20_000;
    let circle = |k: u32| {
        let angle = f64::from(k) / f64::from(count) * std::f64::consts::TAU;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let sets: [Vec<DVec3>; 5] = [
        (0..count).map(circle).collect(),
        (0..count).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)).chain([DVec3::Y]).collect(),
        (0..count).map(|k| DVec3::new(f64::from(k % 2), f64::from(k / 2), 0.0)).collect(),
        (0..count).map(|k| DVec3::new(f64::from(k), f64::from(k).powi(2), 0.0)).collect(),
        (0..count).map(|_| DVec3::new(dice.whole(20), dice.whole(20), 0.0)).collect(),
    ];
    for points in sets {
        let cloud = PointCloud::new(points);
        let found = DelaunayTriangulation::new().convert(&cloud).unwrap();
        assert!(!found.value.triangles().is_empty());
    }
}
