//! Meshes named for their defect.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Place};
use shapeloom_mesh::{PolyMesh, TriMesh};

use super::*;
use crate::MeshRef;

const QUADS: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn corner(i: u32) -> DVec3 {
    DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))
}

/// Cubes of triangles: position of the smallest corner, size, and whether turned inside out.
fn cubes(each: &[(DVec3, f64, bool)]) -> TriMesh {
    let positions = each.iter().flat_map(|&(at, size, _)| (0..8).map(move |i| at + corner(i) * size)).collect();
    let triangles = each.iter().zip((0u32..).step_by(8)).flat_map(|(&(_, _, turned), base)| {
        let halves = QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        halves.map(move |[a, b, c]| if turned { [a, c, b] } else { [a, b, c] }.map(|corner| corner + base))
    });
    TriMesh::try_new(positions, triangles.collect()).unwrap()
}

fn cube() -> TriMesh {
    cubes(&[(DVec3::ZERO, 1.0, false)])
}

fn codes<'a>(mesh: impl Into<MeshRef<'a>>, profile: Profile) -> Vec<&'static str> {
    let verdict = Verdict::of(mesh, profile, &Exec::default()).unwrap();
    verdict.findings.iter().map(|finding| finding.code).collect()
}

fn edited(edit: impl FnOnce(&mut Vec<DVec3>, &mut Vec<[u32; 3]>)) -> TriMesh {
    let (mut positions, mut triangles) = (cube().positions().to_vec(), cube().triangles().to_vec());
    edit(&mut positions, &mut triangles);
    TriMesh::try_new(positions, triangles).unwrap()
}

#[test]
fn sound_meshes_are_found_sound() {
    let polygons = PolyMesh::from_faces((0..8).map(corner).collect(), &QUADS).unwrap();
    let cavity = cubes(&[(DVec3::ZERO, 4.0, false), (DVec3::ONE, 1.0, true)]);
    let apart = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::X * 3.0, 1.0, false)]);
    // A solid in a cavity of another.
    let nested = cubes(&[(DVec3::ZERO, 9.0, false), (DVec3::ONE, 7.0, true), (DVec3::splat(2.0), 2.0, false)]);
    // A cavity whose first vertex lies on the outer shell.
    let touching = cubes(&[(DVec3::ZERO, 4.0, false), (DVec3::new(0.0, 1.0, 1.0), 1.0, true)]);
    let verdict = Verdict::of(&touching, Profile::General, &Exec::default()).unwrap();
    assert_eq!(verdict.shells.iter().map(|shell| shell.depth).collect::<Vec<_>>(), [0, 1]);
    for profile in [Profile::General, Profile::Print, Profile::Simulation] {
        assert!(codes(&cube(), profile).is_empty() && codes(&polygons, profile).is_empty());
        assert!(codes(&cavity, profile).is_empty() && codes(&apart, profile).is_empty());
        assert!(codes(&nested, profile).is_empty());
    }
    assert_eq!(codes(&cube(), Profile::Game), ["W-check-normals"]);
    for size in [1e-9, 1e150, 2f64.powi(-900)] {
        assert!(codes(&cubes(&[(DVec3::ZERO, size, false)]), Profile::General).is_empty(), "{size}");
    }
    assert!(codes(&cubes(&[(DVec3::splat(5e6), 1.0, false)]), Profile::Print).is_empty());
}

#[test]
fn each_defect_has_its_finding() {
    let general = |mesh: &TriMesh| codes(mesh, Profile::General);
    assert_eq!(general(&TriMesh::default()), ["W-check-empty"]);
    assert_eq!(general(&edited(|_, triangles| triangles.truncate(11))), ["W-check-open"]);
    assert_eq!(general(&edited(|_, triangles| triangles[3].swap(0, 1))), ["W-check-orientation"]);
    let inside_out = cubes(&[(DVec3::ZERO, 1.0, true)]);
    assert_eq!(general(&inside_out), ["W-check-inverted"]);
    assert_eq!(codes(&inside_out, Profile::Print), ["W-check-inverted", "W-check-volume"]);
    let solid_in_solid = cubes(&[(DVec3::ZERO, 4.0, false), (DVec3::ONE, 1.0, false)]);
    assert_eq!(general(&solid_in_solid), ["W-check-inverted"]);
    assert_eq!(general(&edited(|positions, _| positions.push(DVec3::ONE))), ["W-check-isolated"]);
    let duplicate = edited(|_, triangles| triangles.push(triangles[0]));
    assert_eq!(general(&duplicate), ["W-check-edge", "W-check-duplicate"]);
    let crossing = cubes(&[(DVec3::ZERO, 2.0, false), (DVec3::new(1.0, 0.5, 0.25), 2.0, false)]);
    assert_eq!(general(&crossing), ["W-check-crossing"]);
    // Solids that share a volume, but only along planes that they have in common: no face passes through another.
    let half = cubes(&[(DVec3::ZERO, 2.0, false), (DVec3::X, 2.0, false)]);
    assert_eq!(general(&half), ["W-check-overlap"]);
    // A solid that shares a volume and touches with its vertices alone: its six lie within the sides of a cube.
    let octahedron = |turned: bool| {
        let mesh = cubes(&[(DVec3::ZERO, 2.0, false)]);
        let (mut positions, mut triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
        positions.extend([DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].map(|p| p + DVec3::ONE));
        for (x, y, z) in (0..8).map(|k| (8 + (k & 1), 10 + (k >> 1 & 1), 12 + (k >> 2))) {
            let outward = (x + y + z) % 2 == 0;
            triangles.push(if outward != turned { [x, y, z] } else { [y, x, z] });
        }
        TriMesh::try_new(positions, triangles).unwrap()
    };
    assert_eq!(general(&octahedron(false)), ["W-check-inverted"]);
    assert!(general(&octahedron(true)).is_empty());
    // Two cubes that share an edge by index, and two cones in one vertex.
    let edge = edited(|positions, triangles| {
        let more = cubes(&[(DVec3::new(1.0, 1.0, 0.0), 1.0, false)]);
        let seam = |corner: u32| match corner {
            0 => 3,
            4 => 7,
            other => other + 8,
        };
        positions.extend_from_slice(more.positions());
        triangles.extend(more.triangles().iter().map(|triangle| triangle.map(seam)));
    });
    assert!(general(&edge).contains(&"W-check-edge"));
    let vertex = edited(|positions, triangles| {
        let more = cubes(&[(DVec3::ONE, 1.0, false)]);
        positions.extend_from_slice(more.positions());
        triangles.extend(more.triangles().iter().map(|t| t.map(|corner| if corner == 0 { 7 } else { corner + 8 })));
    });
    assert_eq!(codes(&vertex, Profile::Print), ["W-check-vertex"]);
    // Contact is no crossing, but no mesher's friend.
    let contact = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::X, 1.0, false)]);
    assert!(general(&contact).is_empty());
    assert!(codes(&contact, Profile::Simulation).contains(&"W-check-contact"));
    let partly = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::new(1.0, 0.5, 0.25), 1.0, false)]);
    assert!(general(&partly).is_empty() && codes(&partly, Profile::Simulation) == ["W-check-contact"]);
    // A fin without thickness: neighbours folded onto each other.
    let positions = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::new(1.0, 3.0, 0.0), DVec3::new(2.0, 2.0, 0.0)];
    let fin = TriMesh::try_new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
    assert_eq!(general(&fin), ["W-check-open", "W-check-overlap"]);
    // The same at every size, in triangles and in squares.
    for size in [1e-170, 1e-85, 1e-9, 1e150] {
        for (at, wanted) in [(1.0, &["W-check-overlap"][..]), (2.0, &[])] {
            let two = cubes(&[(DVec3::ZERO, 2.0 * size, false), (DVec3::new(at, 0.0, 0.0) * size, 2.0 * size, false)]);
            assert_eq!(general(&two), wanted, "{size} {at}");
            let squares: Vec<[u32; 4]> =
                [0, 8].iter().flat_map(|&base| QUADS.map(|quad| quad.map(|c| c + base))).collect();
            let squares = PolyMesh::from_faces(two.positions().to_vec(), &squares).unwrap();
            assert_eq!(codes(&squares, Profile::General), wanted, "{size} {at}");
        }
    }
    // The very same cube twice.
    let twice = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::ZERO, 1.0, false)]);
    assert!(general(&twice).contains(&"W-check-duplicate"));
    let sliver = edited(|positions, _| positions[7].z = 1e-3);
    assert!(codes(&sliver, Profile::Simulation).contains(&"W-check-sliver"));
    let flat = edited(|_, triangles| triangles.push([0, 1, 0]));
    assert!(general(&flat).contains(&"W-check-degenerate"));
    let bow = PolyMesh::from_faces((0..4).map(corner).collect(), &[[0, 1, 2, 3]]).unwrap();
    assert_eq!(codes(&bow, Profile::Game), ["W-check-polygon", "W-check-normals"]);
}

#[test]
fn findings_name_their_elements() {
    let open = edited(|_, triangles| triangles.truncate(11));
    let verdict = Verdict::of(&open, Profile::General, &Exec::default()).unwrap();
    let finding = verdict.findings.iter().next().unwrap();
    assert_eq!((finding.count, finding.places.len()), (3, 1));
    assert!(matches!(finding.places[0], Place::Edge { .. }) && finding.message.contains("in 1 loop"));
    let crossing = cubes(&[(DVec3::ZERO, 2.0, false), (DVec3::new(1.0, 0.5, 0.25), 2.0, false)]);
    let verdict = Verdict::of(&crossing, Profile::General, &Exec::default()).unwrap();
    let finding = verdict.findings.iter().next().unwrap();
    assert_eq!(finding.count, verdict.self_intersections.crossing.total);
    assert!(matches!(finding.places[0], Place::Pair { kind: "faces", indices: [a, b] } if a < 12 && b >= 12));
}

#[test]
fn a_polyhedron_is_told_from_what_is_none() {
    let of = |mesh: &TriMesh| Verdict::of(mesh, Profile::General, &Exec::default()).unwrap().polyhedron();
    assert_eq!(of(&cube()), Ok(()));
    assert_eq!(of(&TriMesh::default()), Err(NotPolyhedron::Empty));
    assert!(matches!(of(&edited(|_, triangles| triangles.truncate(11))), Err(NotPolyhedron::Edge(_))));
    let apart = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::X * 3.0, 1.0, false)]);
    assert_eq!(of(&apart), Err(NotPolyhedron::Apart([0, 12])));
    let corner = cubes(&[(DVec3::ZERO, 1.0, false), (DVec3::ONE, 1.0, false)]);
    assert!(codes(&corner, Profile::Simulation) == ["W-check-contact"]);
    // A cube whose top is pushed through its bottom.
    let pushed = edited(|positions, _| positions[4].z = -1.0);
    assert!(matches!(of(&pushed), Err(NotPolyhedron::Meeting(_))), "{:?}", of(&pushed));
}

/// No closed surface that is not orientable lies in space without meeting itself: this one is found out.
#[test]
fn a_klein_bottle_is_not_orientable_and_crosses_itself() {
    let (m, n) = (24u32, 12u32);
    let at = |i: u32, j: u32| if i == m { (n - j % n) % n } else { i * n + j % n };
    let positions = (0..m * n).map(|k| {
        let (u, v) = (f64::from(k / n) / f64::from(m), f64::from(k % n) / f64::from(n));
        let (u, v) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
        // The figure-eight immersion; the point opposite in v comes back after one turn in u.
        let r = 2.0 + (u / 2.0).cos() * v.sin() - (u / 2.0).sin() * (2.0 * v).sin();
        DVec3::new(r * u.cos(), r * u.sin(), (u / 2.0).sin() * v.sin() + (u / 2.0).cos() * (2.0 * v).sin())
    });
    let quads = (0..m).flat_map(|i| (0..n).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let klein = TriMesh::try_new(positions.collect(), triangles).unwrap();
    let verdict = Verdict::of(&klein, Profile::General, &Exec::default()).unwrap();
    assert!(verdict.topology.is_closed() && verdict.topology.is_manifold() && !verdict.topology.is_orientable());
    assert_eq!(verdict.topology.crosscaps(), Some(2));
    assert!(verdict.self_intersections.crosses());
    assert!(matches!(verdict.polyhedron(), Err(NotPolyhedron::Meeting(_))));
    // Of what does not turn alike no volume is asked.
    assert!(!codes(&klein, Profile::Print).contains(&"W-check-volume"));
}

#[test]
fn every_rule_is_asked_for_by_someone() {
    for rule in &RULES {
        let profiles = [Profile::General, Profile::Print, Profile::Game, Profile::Simulation];
        assert!(profiles.iter().any(|profile| profile.asks_for(rule.code)), "{}", rule.code);
    }
}
