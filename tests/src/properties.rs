//! Properties of random shapes, the same ones each time.

use std::collections::BTreeSet;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Deviation, Surface};
use shapeloom::mesh::{Domain, TEXCOORD, TriMesh};
use shapeloom::parametric::{BezierPatch, BezierSurface, PatchSide, TessellatePatches};
use shapeloom::shape::Geometry;

use crate::oracles::{self, Pieces};
use crate::support::Dice;

fn point(dice: &mut Dice) -> DVec3 {
    DVec3::new(dice.unit(), dice.unit(), dice.unit())
}

fn below(dice: &mut Dice, bound: u64) -> usize {
    (dice.next() % bound) as usize
}

/// A patch of random degrees from 1 to 5 with its `side` given, in the direction of rising parameters.
fn patch_with(dice: &mut Dice, side: PatchSide, control: &[DVec3]) -> BezierPatch {
    let along = control.len() - 1;
    let across = 1 + below(dice, 5);
    let (m, n) = match side {
        PatchSide::Bottom | PatchSide::Top => (along, across),
        PatchSide::Left | PatchSide::Right => (across, along),
    };
    let net = (0..=n).flat_map(|j| (0..=m).map(move |i| (i, j))).map(|(i, j)| match side {
        PatchSide::Bottom if j == 0 => control[i],
        PatchSide::Top if j == n => control[i],
        PatchSide::Left if i == 0 => control[j],
        PatchSide::Right if i == m => control[j],
        _ => point(dice),
    });
    let net = net.collect();
    BezierPatch::try_new(m as u32, n as u32, net).expect("a finite net of the right size")
}

/// Vertices less edges plus faces: 1 for a disk, and 0 for two disks that share only two vertices.
fn euler(mesh: &TriMesh) -> i64 {
    let used: BTreeSet<u32> = mesh.triangles().as_flattened().iter().copied().collect();
    let edges: BTreeSet<(u32, u32)> = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    used.len() as i64 - edges.len() as i64 + mesh.triangles().len() as i64
}

#[test]
fn bounds_hold_on_random_patches() {
    let mut dice = Dice(41);
    for case in 0..60 {
        let control: Vec<DVec3> = (0..2 + below(&mut dice, 4)).map(|_| point(&mut dice)).collect();
        let patch = patch_with(&mut dice, PatchSide::Bottom, &control);
        let surface = BezierSurface::new(vec![patch]);
        let tolerance = [0.3, 0.05, 0.01][below(&mut dice, 3)];
        let converted = TessellatePatches::new(tolerance).convert(&surface).expect("a sound patch");
        let Deviation::AtMost(bound) = converted.report.deviation else { panic!("case {case}: a bound") };
        assert!(bound <= tolerance, "case {case}");
        // From the triangles back, by the theorem: at equal parameters, found by interpolating the corners' own.
        let uv = converted.value.attribute(Domain::Wedge, TEXCOORD).expect("parameters");
        for face in 0..converted.value.triangles().len() {
            let corners = converted.value.corners(face);
            for weights in [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [1.0 / 3.0; 3], [0.6, 0.3, 0.1]] {
                let p: DVec3 = (0..3).map(|k| corners[k] * weights[k]).sum();
                let at = |axis: usize| (0..3).map(|k| uv.number(3 * face + k, axis) * weights[k]).sum::<f64>();
                let apart = surface.patches[0].point(at(0), at(1)).distance(p);
                assert!(apart <= bound + 1e-14, "case {case}: {apart} {bound}");
            }
        }
        let (source, result) = (Geometry::from(surface), Geometry::from(converted.value));
        let pieces = Pieces::of(&result).expect("triangles");
        for p in oracles::samples(&source) {
            assert!(pieces.distance(p) <= bound + 1e-14, "case {case}");
        }
    }
}

#[test]
fn random_neighbours_meet_without_cracks_whichever_sides_they_share() {
    let mut dice = Dice(43);
    for case in 0..200 {
        let control: Vec<DVec3> = (0..2 + below(&mut dice, 4)).map(|_| point(&mut dice)).collect();
        let backward: Vec<DVec3> = control.iter().rev().copied().collect();
        let sides = [PatchSide::ALL[below(&mut dice, 4)], PatchSide::ALL[below(&mut dice, 4)]];
        let first = patch_with(&mut dice, sides[0], &control);
        let second = patch_with(&mut dice, sides[1], if case % 2 == 0 { &control } else { &backward });
        let surface = BezierSurface::new(vec![first, second]);
        let converted = TessellatePatches::new(0.02).convert(&surface).expect("sound patches");
        assert_eq!(converted.report.find("edges_shared"), Some(1.0), "case {case}");
        assert_eq!(euler(&converted.value), 1, "case {case}: {sides:?}");
    }
}
