//! Self-intersection of meshes: against rational arithmetic on small whole coordinates, on meshes with known answers, and
//! under maps that change nothing.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{CancelFlag, Exec, Stop, Threads};
use shapeloom::io::{ReadContext, detect, read};
use shapeloom::judge::{
    FacePair, JudgeError, PairKind, SelfIntersections, self_intersections, self_intersections_of_polygons,
};
use shapeloom::mesh::primitives::{Platonic, Solid, Torus};
use shapeloom::mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::shape::Geometry;

use crate::support::{Dice, shared_data};
use crate::triangle_pairs::kind_of_pair;

fn judged(mesh: &TriMesh) -> SelfIntersections {
    self_intersections(mesh, usize::MAX, &Exec::default()).expect("a mesh that can be judged")
}

fn all_pairs(found: &SelfIntersections) -> Vec<FacePair> {
    let lists = [&found.crossing, &found.overlapping, &found.touching];
    for list in lists {
        assert_eq!(list.total, list.listed.len() as u64);
        assert!(list.listed.is_sorted() && list.listed.iter().all(|pair| pair.faces[0] < pair.faces[1]));
    }
    let mut pairs: Vec<FacePair> = lists.iter().flat_map(|list| list.listed.iter().copied()).collect();
    pairs.sort_unstable();
    for kind in PairKind::ALL {
        assert_eq!(found.count(kind), pairs.iter().filter(|pair| pair.kind == kind).count() as u64);
    }
    pairs
}

/// Every two triangles, by rational arithmetic.
fn wanted(mesh: &TriMesh) -> Vec<FacePair> {
    let corners = |face: u32| mesh.corners(face as usize).map(|p| p.to_array().map(|c| c as i128));
    let count = mesh.triangles().len() as u32;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    pairs
        .filter_map(|faces| Some(FacePair { faces, kind: kind_of_pair(corners(faces[0]), corners(faces[1]))? }))
        .collect()
}

/// Random triangles over few lattice points: many share corners and sides, lie in one plane or have no area.
fn random_mesh(dice: &mut Dice, top: u64, points: u64, triangles: u64) -> TriMesh {
    let style = dice.next() % 6;
    let mut one = |_| {
        let [x, y, z] = [0; 3].map(|_: i32| (dice.next() % (top + 1)) as f64);
        match style {
            0 => DVec3::new(x, y, 0.0),
            1 => DVec3::new(x, y, 2.0 * x - y),
            2 => DVec3::new(x, 2.0 * x, -x),
            3 => DVec3::new(x, y, z.min(1.0)),
            _ => DVec3::new(x, y, z),
        }
    };
    let positions = (0..points).map(&mut one).collect();
    let triangles = (0..triangles).map(|_| [0; 3].map(|_: i32| (dice.next() % points) as u32)).collect();
    TriMesh::try_new(positions, triangles).expect("indices in range")
}

#[test]
fn every_pair_is_what_rational_arithmetic_says() {
    let mut dice = Dice(1);
    let mut seen = [0u64; PairKind::ALL.len()];
    for (top, points, triangles, rounds) in
        [(1, 6, 8, 1500), (2, 7, 9, 2500), (3, 9, 10, 2500), (8, 12, 12, 1500), (8, 90, 60, 40)]
    {
        for round in 0..rounds {
            let mesh = random_mesh(&mut dice, top, points, triangles);
            let found = all_pairs(&judged(&mesh));
            let wanted = wanted(&mesh);
            if found != wanted {
                let first = found.iter().zip(&wanted).find(|(a, b)| a != b);
                let named = first.map(|(a, b)| {
                    (a, b, b.faces.map(|f| mesh.corners(f as usize)), a.faces.map(|f| mesh.corners(f as usize)))
                });
                panic!("lattice {top}, round {round}: {named:?}\n{found:?}\n{wanted:?}\n{mesh:?}");
            }
            found.iter().for_each(|pair| seen[pair.kind as usize] += 1);
        }
    }
    // The random meshes are of use only if every kind occurs often.
    assert!(seen.iter().all(|&count| count > 500), "{seen:?}");
}

/// Maps that keep every answer: powers of two, far translations, integer shears that make slivers, mirrors and turns of
/// the axes. All are exact in the coordinates used, so the expected answer is the one of the small mesh.
#[test]
fn exact_maps_change_no_answer() {
    let mut dice = Dice(2);
    for round in 0..400 {
        let mesh = random_mesh(&mut dice, 3, 9, 12);
        let wanted = wanted(&mesh);
        let shear = |p: DVec3| {
            let p = DVec3::new(p.x + 1021.0 * p.y, p.y, p.z - 509.0 * p.x - 519689.0 * p.y);
            DVec3::new(p.x + 4093.0 * p.z, p.y - 2039.0 * p.x - 8345627.0 * p.z, p.z)
        };
        let maps: [&dyn Fn(DVec3) -> DVec3; 11] = [
            &|p| p * 2f64.powi(500),
            &|p| p * 2f64.powi(-500),
            &|p| p * 2f64.powi(-1070),
            &|p| p / 1024.0 + DVec3::new(5e6, -5e6, 5e6 + 0.5),
            &|p| p + DVec3::splat(2f64.powi(50)),
            &|p| p.yzx(),
            &|p| p.yxz(),
            &|p| -p,
            &|p| DVec3::new(-p.x, p.y, p.z),
            &shear,
            &|p| shear(p.zxy()) * 2f64.powi(-40),
        ];
        for (k, map) in maps.iter().enumerate() {
            let moved = mesh.positions().iter().map(|&p| map(p)).collect();
            let moved = TriMesh::try_new(moved, mesh.triangles().to_vec()).expect("the same triangles");
            assert_eq!(all_pairs(&judged(&moved)), wanted, "round {round}, map {k}: {mesh:?}");
        }
    }
}

trait Swizzle {
    fn yzx(self) -> DVec3;
    fn zxy(self) -> DVec3;
    fn yxz(self) -> DVec3;
}

impl Swizzle for DVec3 {
    fn yzx(self) -> DVec3 {
        DVec3::new(self.y, self.z, self.x)
    }
    fn zxy(self) -> DVec3 {
        DVec3::new(self.z, self.x, self.y)
    }
    fn yxz(self) -> DVec3 {
        DVec3::new(self.y, self.x, self.z)
    }
}

/// Other numbers of faces and vertices, other first corners, corners of one's own, other numbers of threads.
#[test]
fn numbering_and_threads_change_no_answer() {
    let mut dice = Dice(3);
    let mesh = random_mesh(&mut dice, 8, 300, 400);
    let found = judged(&mesh);
    assert!(PairKind::ALL.into_iter().filter(|&kind| found.count(kind) > 0).count() >= 4);
    let mut order: Vec<u32> = (0..400).collect();
    (1..400).rev().for_each(|i| order.swap(i, dice.next() as usize % (i + 1)));
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for &face in &order {
        let turn = dice.next() as usize;
        let corners = mesh.corners(face as usize);
        let corners = if turn % 2 == 0 { corners } else { [corners[2], corners[1], corners[0]] };
        let first = positions.len() as u32;
        // 0 and -0 are equal.
        positions.extend((0..3).map(|i| corners[(i + turn) % 3] * 1.0 - DVec3::ZERO));
        triangles.push([first, first + 1, first + 2]);
    }
    let soup = TriMesh::try_new(positions.iter().map(|&p| -p).collect(), triangles).expect("indices in range");
    let mut back: Vec<FacePair> = all_pairs(&judged(&soup))
        .into_iter()
        .map(|FacePair { faces, kind }| {
            let [a, b] = faces.map(|face| order[face as usize]);
            FacePair { faces: [a.min(b), a.max(b)], kind }
        })
        .collect();
    back.sort_unstable();
    assert_eq!(back, all_pairs(&found));

    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        assert_eq!(pool.install(|| judged(&mesh)), found);
    }
    let alone = Exec::default().with_threads(Threads::Sequential);
    assert_eq!(self_intersections(&mesh, usize::MAX, &alone).expect("a sound run"), found);
    // Limits shorten the lists and nothing else.
    for limit in [0, 1, 17] {
        let short = self_intersections(&mesh, limit, &alone).expect("a sound run");
        let lists =
            |found: &SelfIntersections| [&found.crossing, &found.overlapping, &found.touching].map(Clone::clone);
        for (short, long) in lists(&short).iter().zip(lists(&found)) {
            assert_eq!(short.total, long.total);
            assert_eq!(short.listed, long.listed[..limit.min(long.listed.len())]);
        }
    }
}

fn soup(triangles: &[[[f64; 3]; 3]]) -> TriMesh {
    let positions = triangles.as_flattened().iter().map(|&p| DVec3::from_array(p)).collect();
    let count = triangles.len() as u32;
    TriMesh::try_new(positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).expect("a soup")
}

/// Pairs that anyone can check by looking, one of each kind and its near misses.
#[test]
fn pairs_drawn_by_hand_have_their_kinds() {
    let floor = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let cases: &[(&str, [[f64; 3]; 3], Option<PairKind>)] = &[
        ("a spike through the floor", [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 2.0]], Some(PairKind::Crossing)),
        (
            "a spike that stands on it",
            [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 2.0]],
            Some(PairKind::TouchAtPoint),
        ),
        ("a wall on it", [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0, 2.0]], Some(PairKind::TouchAlongSegment)),
        ("a wall on its side", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 0.0, 2.0]], None),
        (
            "a wall on half of its side",
            [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 2.0]],
            Some(PairKind::TouchAlongSegment),
        ),
        (
            "a blade from its corner",
            [[0.0, 0.0, 0.0], [2.0, 2.0, -1.0], [2.0, 2.0, 1.0]],
            Some(PairKind::CrossingAtCorner),
        ),
        ("a blade away from its corner", [[0.0, 0.0, 0.0], [-2.0, -2.0, -1.0], [-2.0, -2.0, 1.0]], None),
        ("folded over its side", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0]], Some(PairKind::Folded)),
        ("beside its side", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, -1.0, 0.0]], None),
        ("a tile that overlaps", [[1.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 9.0, 0.0]], Some(PairKind::Overlap)),
        ("the same, turned over", [[0.0, 4.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 0.0]], Some(PairKind::Coincident)),
        ("a tile at the corner", [[4.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 1.0, 0.0]], None),
        ("a tile below", [[0.0, 0.0, -1e-300], [4.0, 0.0, -1e-9], [0.0, 4.0, -1e-9]], None),
        ("a needle through it", [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 3.0]], Some(PairKind::Crossing)),
        (
            "a needle through its side",
            [[1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 3.0]],
            Some(PairKind::TouchAtPoint),
        ),
        ("a needle on its side", [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]], None),
        (
            "a needle that sticks out of its side",
            [[1.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]],
            Some(PairKind::TouchAlongSegment),
        ),
        ("a point in it", [[1.0, 1.0, 0.0]; 3], Some(PairKind::TouchAtPoint)),
        ("a point at its corner", [[4.0, 0.0, 0.0]; 3], None),
    ];
    for &(what, other, kind) in cases {
        if what == "a tile below" {
            // Coordinates that exact arithmetic cannot hold beside the others are refused, not guessed.
            assert!(matches!(
                self_intersections(&soup(&[floor, other]), 9, &Exec::default()),
                Err(JudgeError::Underflow { vertex: 3, .. })
            ));
            continue;
        }
        let found = all_pairs(&judged(&soup(&[floor, other])));
        let wanted: Vec<FacePair> = kind.into_iter().map(|kind| FacePair { faces: [0, 1], kind }).collect();
        assert_eq!(found, wanted, "{what}");
    }
}
