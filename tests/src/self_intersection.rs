//! Self-intersection of meshes: against rational arithmetic on small whole coordinates, on meshes with known answers, and
//! under maps that change nothing.

use shapeloom::core::glam::{DVec3, Vec3Swizzles};
use shapeloom::core::{CancelFlag, Convert, Exec, Stop, Threads};
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
        let corners = if turn & 1 == 0 { corners } else { [corners[2], corners[1], corners[0]] };
        let first = positions.len() as u32;
        // 0 and -0 are equal.
        positions.extend((0..3).map(|i| corners[(i + turn) % 3]));
        triangles.push([first, first + 1, first + 2]);
    }
    let soup = TriMesh::try_new(positions.iter().map(|&p| -p).collect(), triangles).expect("indices in range");
    let mut back: Vec<FacePair> = all_pairs(&judged(&soup))
        .into_iter()
        .map(|FacePair { faces, kind }| {
            let [a, b] = faces.map(|face| order[face as usize]);
            FacePair { faces: [a.min(b), a.max(b)], kind: either_way(kind) }
        })
        .collect();
    back.sort_unstable();
    let mut wanted: Vec<FacePair> = all_pairs(&found);
    wanted.iter_mut().for_each(|pair| pair.kind = either_way(pair.kind));
    wanted.sort_unstable();
    assert!(back == wanted);

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
    type Case = (&'static str, [[f64; 3]; 3], Option<PairKind>);
    let cases: &[Case] = &[
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
        ("a tile just below", [[0.0, 0.0, -1e-80], [4.0, 0.0, -1e-80], [0.0, 4.0, -1e-80]], None),
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
        let found = all_pairs(&judged(&soup(&[floor, other])));
        let wanted: Vec<FacePair> = kind.into_iter().map(|kind| FacePair { faces: [0, 1], kind }).collect();
        assert_eq!(found, wanted, "{what}");
    }
}

/// The meshes of a file beside the workspace; none where it is not there.
fn meshes(path: &str) -> Option<Vec<Geometry>> {
    let file = shared_data(path)?;
    let bytes = std::fs::read(&file).unwrap_or_else(|error| panic!("{path}: {error}"));
    let name = file.display().to_string();
    let format = detect(&bytes, Some(&name)).unwrap_or_else(|error| panic!("{path}: {error}"));
    let shape = read(&bytes, format, &ReadContext::named(name)).unwrap_or_else(|error| panic!("{path}: {error}")).shape;
    Some(shape.parts.iter().map(|part| (*part.geometry).clone()).collect())
}

fn as_triangles(geometry: &Geometry) -> TriMesh {
    match geometry {
        Geometry::TriMesh(mesh) => mesh.clone(),
        Geometry::PolyMesh(mesh) => TriangulatePolygons::new().convert(mesh).expect("a sound mesh").value,
        other => panic!("no mesh: {other:?}"),
    }
}

/// The first mesh of a file as it is, and as triangles.
fn judged_file(path: &str) -> Option<(SelfIntersections, SelfIntersections)> {
    let geometry = meshes(path)?.swap_remove(0);
    let triangles = judged(&as_triangles(&geometry));
    let found = match &geometry {
        Geometry::PolyMesh(mesh) => {
            self_intersections_of_polygons(mesh, usize::MAX, &Exec::default()).expect("a mesh that can be judged")
        }
        _ => triangles.clone(),
    };
    Some((found, triangles))
}

/// The kind, whichever way the faces look.
fn either_way(kind: PairKind) -> PairKind {
    match kind {
        PairKind::Contact => PairKind::Overlap,
        PairKind::Coincident => PairKind::Duplicate,
        other => other,
    }
}

fn counts(found: &SelfIntersections) -> [u64; 9] {
    PairKind::ALL.map(|kind| found.count(kind))
}

/// Counts of the kinds in the order of [`PairKind::ALL`], for the faces of the file and for its triangles.
#[test]
fn known_meshes_have_their_known_answers() {
    let none = [0; 9];
    let cases = [
        // A closed surface with one side cannot lie in space without passing through itself.
        ("synthetic/klein_24x12.off", [49, 0, 0, 0, 0, 0, 0, 1, 13], [96, 0, 0, 0, 0, 0, 0, 2, 18]),
        ("synthetic/moebius_24x12.off", none, none),
        ("synthetic/nested_cubes.obj", none, none),
        ("synthetic/two_cubes_share_vertex.obj", none, none),
        ("synthetic/two_cubes_share_edge.obj", none, none),
        ("synthetic/two_cubes_share_face.obj", [0, 0, 0, 0, 0, 0, 2, 0, 0], [0, 0, 0, 0, 0, 0, 2, 0, 0]),
        ("synthetic/cube_duplicate_face.obj", [0, 0, 0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 0, 0, 1, 0, 0, 0]),
        ("synthetic/cube_unwelded.obj", none, none),
        ("synthetic/torus_quads_24x12.obj", none, none),
        ("synthetic/slab_genus_9.obj", none, none),
    ];
    for (path, faces, triangles) in cases {
        let Some((found, cut)) = judged_file(path) else { continue };
        assert_eq!((counts(&found), counts(&cut)), (faces, triangles), "{path}");
        assert_eq!(found.crosses(), path.contains("klein"), "{path}");
        assert_eq!(found.is_embedded(), faces == none, "{path}");
    }
}

/// How many pairs of triangles meet in more than what they share and have different corners, as libigl 2.6.3 finds them by
/// the exact kernel of CGAL (`remesh_self_intersections`, to detect only). The pairs were compared one by one as well.
#[test]
fn another_implementation_finds_as_many_pairs() {
    let cases = [
        ("off/camelhead.off", 5),
        ("off/3holes.off", 0),
        ("off/fertility.off", 0),
        ("obj/boot.obj", 0),
        ("obj/wingnut.obj", 3),
        ("obj/hand_lowres.obj", 0),
        ("ply/cube_with_fold.ply", 11),
        ("ply/two-boxes-bad-self-union.ply", 346),
        ("stl/featuretype.STL", 1216),
        ("stl/soup.stl", 1248),
        ("stl/busted.STL", 0),
        ("synthetic/cube_near_weld.obj", 15),
    ];
    for (path, wanted) in cases {
        let Some((_, found)) = judged_file(path) else { continue };
        let all: u64 = counts(&found).iter().sum();
        assert_eq!(all - found.count(PairKind::Coincident) - found.count(PairKind::Duplicate), wanted, "{path}");
    }
}

fn solid(solid: Solid, at: DVec3) -> PolyMesh {
    let mesh = Platonic { ..Platonic::new(solid) }.mesh(&Exec::default()).expect("a solid").value;
    let positions = mesh.positions().iter().map(|&p| p + at).collect();
    PolyMesh::from_faces(positions, &mesh.faces().collect::<Vec<_>>()).expect("the same faces")
}

fn both(a: &PolyMesh, b: &PolyMesh) -> PolyMesh {
    let first = a.positions().len() as u32;
    let mut faces: Vec<Vec<u32>> = a.faces().map(<[u32]>::to_vec).collect();
    faces.extend(b.faces().map(|face| face.iter().map(|vertex| vertex + first).collect()));
    let positions = a.positions().iter().chain(b.positions()).copied().collect();
    PolyMesh::from_faces(positions, &faces).expect("two meshes are one")
}

fn judged_polygons(mesh: &PolyMesh) -> SelfIntersections {
    self_intersections_of_polygons(mesh, usize::MAX, &Exec::default()).expect("a mesh that can be judged")
}

/// Two boxes from corner to corner.
fn boxes(first: [DVec3; 2], second: [DVec3; 2]) -> PolyMesh {
    let one = |[low, high]: [DVec3; 2]| {
        let cube = solid(Solid::Cube, DVec3::ZERO);
        let corner = |p: DVec3| [0, 1, 2].map(|axis| if p[axis] > 0.0 { high[axis] } else { low[axis] });
        let positions = cube.positions().iter().map(|&p| DVec3::from_array(corner(p))).collect();
        PolyMesh::from_faces(positions, &cube.faces().collect::<Vec<_>>()).expect("the same faces")
    };
    both(&one(first), &one(second))
}

/// Boxes against each other: which faces meet is known without computing.
#[test]
fn boxes_cross_touch_or_stay_apart() {
    let unit = [DVec3::ZERO, DVec3::splat(4.0)];
    let at = |low: [f64; 3], high: [f64; 3]| [DVec3::from_array(low), DVec3::from_array(high)];
    // A corner inside: three faces of each cross, each pair but the three parallel ones.
    let found = judged_polygons(&boxes(unit, at([1.0; 3], [7.0; 3])));
    assert_eq!(counts(&found), [6, 0, 0, 0, 0, 0, 0, 0, 0]);
    // A bar right through two faces: its four long sides cross both.
    let found = judged_polygons(&boxes(unit, at([1.0, 1.0, -1.0], [2.0, 2.0, 5.0])));
    assert_eq!(counts(&found), [8, 0, 0, 0, 0, 0, 0, 0, 0]);
    // Stacked with faces that lie on each other in part: the four sides of the small box stand on the large one.
    let found = judged_polygons(&boxes(unit, at([1.0, 1.0, 4.0], [2.0, 2.0, 5.0])));
    assert_eq!(counts(&found), [0, 0, 0, 0, 1, 0, 0, 4, 0]);
    assert!(!found.crosses() && !found.is_embedded());
    // The same face: coincident, whatever diagonals it is cut along. The corner of one on another's face: it touches.
    let found = judged_polygons(&boxes(unit, at([0.0, 0.0, 4.0], [4.0, 4.0, 8.0])));
    assert_eq!(counts(&found), [0, 0, 0, 0, 0, 0, 1, 0, 0]);
    assert!(judged_polygons(&boxes(unit, at([1.0; 3], [3.0; 3]))).is_embedded());
    assert!(judged_polygons(&boxes(unit, at([5.0; 3], [6.0; 3]))).is_embedded());
    // The very same box: every face twice, and nothing more.
    let found = judged_polygons(&boxes(unit, unit));
    assert_eq!(counts(&found), [0, 0, 0, 0, 0, 6, 0, 0, 0]);
}

/// Copies of a square that start elsewhere, run the other way and are cut along the other diagonal.
#[test]
fn equal_polygons_are_coincident_however_they_are_listed() {
    let square = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let faces = [[0, 1, 2, 3], [1, 2, 3, 0], [3, 2, 1, 0], [2, 1, 0, 3]];
    let found = judged_polygons(&PolyMesh::from_faces(square, &faces).expect("squares"));
    assert_eq!(counts(&found), [0, 0, 0, 0, 0, 2, 4, 0, 0]);
    assert_eq!(found.touching.listed[3].faces, [1, 2]);
}

/// Triangles are polygons: the way of polygons, which finds pairs of faces by another list, gives the same answer.
#[test]
fn triangles_as_polygons_have_the_same_pairs() {
    let mut dice = Dice(5);
    for round in 0..300 {
        let mesh = random_mesh(&mut dice, 3, 9, 14);
        assert_eq!(judged_polygons(&mesh.clone().into()), judged(&mesh), "round {round}: {mesh:?}");
    }
}

/// A pentagram's triangles lie over one another, and they are one face; a second one above shares nothing with it.
#[test]
fn a_polygon_is_not_compared_with_itself() {
    let corner = |i: u32| {
        let angle = f64::from(i % 5 * 2) * std::f64::consts::TAU / 5.0;
        DVec3::new(angle.cos(), angle.sin(), f64::from(i / 5))
    };
    let star = PolyMesh::from_faces((0..10).map(corner).collect(), &[[0, 1, 2, 3, 4], [5, 6, 7, 8, 9]]).expect("stars");
    assert!(judged_polygons(&star).is_embedded());
    let cut = TriangulatePolygons::new().convert(&star).expect("stars").value;
    assert!(!judged(&cut).is_embedded(), "the triangles of a star overlap");
}

/// Linked rings are apart; moved into each other they cross.
#[test]
fn linked_rings_do_not_cross() {
    let ring = Torus { segments: 48, sides: 24, ..Torus::new() }.mesh(&Exec::default()).expect("a torus").value;
    let (inner, outer) = ring.positions().iter().fold((f64::MAX, 0.0f64), |(inner, outer), p| {
        let radius = p.truncate().length();
        (inner.min(radius), outer.max(radius))
    });
    let moved = |shift: f64| {
        let positions = ring.positions().iter().map(|p| DVec3::new(p.x + shift, p.z, p.y)).collect();
        both(&ring, &PolyMesh::from_faces(positions, &ring.faces().collect::<Vec<_>>()).expect("the same faces"))
    };
    assert!(judged_polygons(&moved((inner + outer) / 2.0)).is_embedded());
    assert!(judged_polygons(&moved(inner / 2.0)).crosses());
}

/// Heaps that would take hours or all memory if every pair were enumerated.
#[test]
fn coincident_heaps_are_counted_and_not_enumerated() {
    let (count, few) = (16_000u32, 100u32);
    let positions = vec![
        DVec3::ZERO,
        DVec3::X * 4.0,
        DVec3::Y * 4.0,
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(2.0, 1.0, 1.0),
    ];
    let mut triangles: Vec<[u32; 3]> = (0..count).map(|i| if i % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] }).collect();
    triangles.extend((0..few).map(|_| [3, 4, 5]));
    let mesh = TriMesh::try_new(positions, triangles).expect("a heap");
    let exec = Exec::default().with_memory(64 << 20);
    let found = self_intersections(&mesh, 1000, &exec).expect("a small heap");
    let pairs = |n: u64| n * (n - 1) / 2;
    assert_eq!(
        found.count(PairKind::Coincident) + found.count(PairKind::Duplicate),
        pairs(u64::from(count)) + pairs(u64::from(few))
    );
    assert_eq!(found.crossing.total, u64::from(count * few));
    assert_eq!(found.crossing.listed[101].faces, [1, count + 1]);
    assert_eq!(found.touching.listed[999].faces, [0, 1000]);
    assert_eq!(exec.memory_taken(), 0);

    let squares = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let faces: Vec<[u32; 4]> = (0..count).map(|i| [0, 1, 2, 3].map(|k| (k + i) % 4)).collect();
    let heap = PolyMesh::from_faces(squares, &faces).expect("a heap");
    let found = self_intersections_of_polygons(&heap, 10, &exec).expect("a small heap");
    assert_eq!((found.touching.total, found.touching.listed.len()), (pairs(u64::from(count)), 10));
    assert!(!found.crosses() && found.overlapping.total == 0);
}

/// A cone of 1200 triangles around a corner: all pairs share it, and none meets beyond. Folded flat they all overlap.
#[test]
fn corners_of_high_valence_are_decided_pair_by_pair() {
    let count = 1200u32;
    let cone = |height: f64, turns: f64| {
        let rim = (0..count).map(|i| {
            let angle = std::f64::consts::TAU * turns * f64::from(i) / f64::from(count);
            DVec3::new(angle.cos(), angle.sin(), height)
        });
        let positions = std::iter::once(DVec3::ZERO).chain(rim).collect();
        let triangles = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        TriMesh::try_new(positions, triangles).expect("a cone")
    };
    assert!(judged(&cone(1.0, 1.0)).is_embedded());
    assert!(judged(&cone(0.0, 1.0)).is_embedded());
    // Twice around in a plane: each triangle lies over others.
    let twice = judged(&cone(0.0, 2.0));
    assert!(twice.overlapping.total >= u64::from(count) / 2 && !twice.crosses());
}

#[test]
fn it_stops_keeps_to_its_memory_and_names_what_it_refuses() {
    let mut dice = Dice(4);
    // Long thin triangles whose boxes all meet.
    let positions: Vec<DVec3> = (0..9000)
        .map(|i| {
            DVec3::new(dice.unit(), dice.unit(), dice.unit()) + DVec3::splat(if i % 3 == 0 { 1000.0 } else { 0.0 })
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..3000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriMesh::try_new(positions, triangles).expect("a soup");
    let flag = CancelFlag::default();
    let inside = flag.clone();
    let polls = std::sync::atomic::AtomicU32::new(0);
    let exec = Exec::default().with_cancel(&flag).with_watch(move || {
        if polls.fetch_add(1, std::sync::atomic::Ordering::Relaxed) == 200 {
            inside.cancel();
        }
        None
    });
    assert_eq!(self_intersections(&mesh, 10, &exec), Err(JudgeError::Stop(Stop::Cancelled)));
    let small = Exec::default().with_memory(100_000);
    assert!(matches!(self_intersections(&mesh, 10, &small), Err(JudgeError::OverBudget(_))));

    for bad in [f64::NAN, f64::INFINITY] {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, bad, 0.0)];
        let mesh = TriMesh::try_new(positions, vec![[0, 1, 2]]).expect("indices in range");
        let refused = self_intersections(&mesh, 10, &Exec::default());
        assert!(matches!(refused, Err(JudgeError::NotFinite { vertex: 2, .. })));
        let refused = self_intersections_of_polygons(&mesh.into(), 10, &Exec::default());
        assert!(matches!(refused, Err(JudgeError::NotFinite { vertex: 2, .. })));
    }
    assert!(judged(&TriMesh::default()).is_embedded());
    assert!(judged_polygons(&PolyMesh::default()).is_embedded());
    let point = TriMesh::try_new(vec![DVec3::ONE; 3], vec![[0, 1, 2], [0, 0, 0]]).expect("points");
    assert_eq!(counts(&judged(&point)), [0, 0, 0, 0, 0, 1, 0, 0, 0]);
}
