//! The report against counting by definition on random faces, and on surfaces with known numbers.

use std::collections::{BTreeMap, BTreeSet};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{CancelFlag, Exec, Stop};
use shapeloom_mesh::PolyMesh;

use super::*;
use crate::JudgeError;

struct Draws(u64);

impl Draws {
    fn below(&mut self, top: u64) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % top) as u32
    }
}

fn polygons(vertices: usize, faces: &[Vec<u32>]) -> PolyMesh {
    PolyMesh::from_faces(vec![DVec3::ZERO; vertices], faces).unwrap()
}

fn report(vertices: usize, faces: &[Vec<u32>]) -> Topology {
    Topology::of(&polygons(vertices, faces), &Exec::default()).unwrap()
}

fn sides(face: &[u32]) -> Vec<[u32; 2]> {
    (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]).collect()
}

fn rising([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Numbers the classes of `count` things under a relation, by flooding.
fn classes(count: usize, related: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut class = vec![usize::MAX; count];
    for start in 0..count {
        let mut open = vec![start];
        while let Some(one) = open.pop() {
            if class[one] == usize::MAX {
                class[one] = start;
                open.extend((0..count).filter(|&other| related(one, other)));
            }
        }
    }
    class
}

fn distinct(class: &[usize]) -> usize {
    class.iter().collect::<BTreeSet<_>>().len()
}

/// Everything by its definition, with all orientations tried.
fn assert_by_definition(vertices: usize, faces: &[Vec<u32>]) {
    let found = report(vertices, faces);
    let mut uses: BTreeMap<[u32; 2], Vec<(usize, [u32; 2])>> = BTreeMap::new();
    for (face, cycle) in faces.iter().enumerate() {
        for side in sides(cycle).into_iter().filter(|[a, b]| a != b) {
            uses.entry(rising(side)).or_default().push((face, side));
        }
    }
    let with = |wanted: fn(usize) -> bool| -> Vec<[u32; 2]> {
        uses.iter().filter(|(_, uses)| wanted(uses.len())).map(|(&edge, _)| edge).collect()
    };
    assert_eq!(found.edges, uses.len(), "{faces:?}");
    assert_eq!(found.non_manifold_edges, with(|count| count > 2));
    let border = with(|count| count == 1);
    let mut listed: Vec<[u32; 2]> = found.boundary.edges().iter().map(|&side| rising(side)).collect();
    listed.sort_unstable();
    assert_eq!(listed, border);
    let loops = classes(border.len(), |a, b| border[a].iter().any(|vertex| border[b].contains(vertex)));
    assert_eq!(found.boundary.len(), distinct(&loops), "{faces:?}");
    for edges in found.boundary.iter() {
        assert!(edges.iter().all(|side| uses[&rising(*side)][0].1 == *side));
    }
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let isolated: Vec<u32> = (0..vertices as u32).filter(|vertex| !used.contains(vertex)).collect();
    assert_eq!(found.isolated_vertices, isolated);
    assert_eq!(found.euler_characteristic(), used.len() as i64 - uses.len() as i64 + faces.len() as i64);
    // Fans: corners of one vertex, joined where sides on one edge, or a side to itself, touch both.
    let corners: Vec<(usize, usize)> =
        faces.iter().enumerate().flat_map(|(face, cycle)| (0..cycle.len()).map(move |k| (face, k))).collect();
    let at = |&(face, k): &(usize, usize)| faces[face][k];
    let around = |&(face, k): &(usize, usize)| {
        let cycle = &faces[face];
        let before = (k + cycle.len() - 1) % cycle.len();
        // The sides at this corner with the place of the corner's vertex in each.
        [(before, [cycle[before], cycle[k]]), (k, [cycle[k], cycle[(k + 1) % cycle.len()]])]
            .map(|(place, side)| (face, place, rising(side)))
    };
    let joined = |a: usize, b: usize| {
        at(&corners[a]) == at(&corners[b])
            && around(&corners[a]).iter().any(|one| {
                around(&corners[b]).iter().any(|other| {
                    let loops = one.2[0] == one.2[1];
                    one.2 == other.2 && (!loops || (one.0, one.1) == (other.0, other.1))
                })
            })
    };
    let fans = classes(corners.len(), joined);
    let crowded: Vec<u32> = used
        .iter()
        .copied()
        .filter(|vertex| {
            let here: BTreeSet<usize> =
                (0..corners.len()).filter(|&c| at(&corners[c]) == *vertex).map(|c| fans[c]).collect();
            here.len() > 1
        })
        .collect();
    assert_eq!(found.non_manifold_vertices, crowded, "{faces:?}");
    // Components.
    let shared = |a: usize, b: usize| {
        uses.values().any(|uses| uses.iter().any(|one| one.0 == a) && uses.iter().any(|one| one.0 == b))
    };
    let parts = classes(faces.len(), shared);
    assert_eq!(found.components.len(), distinct(&parts));
    let firsts: BTreeSet<u32> = parts.iter().map(|&first| first as u32).collect();
    assert!(found.components.iter().map(|component| component.first_face).eq(firsts));
    for component in &found.components {
        let own = |face: usize| parts[face] == component.first_face as usize;
        let corners: BTreeSet<u32> =
            (0..faces.len()).filter(|&face| own(face)).flat_map(|face| faces[face].clone()).collect();
        let edges = uses.values().filter(|uses| own(uses[0].0)).count();
        let count = (0..faces.len()).filter(|&face| own(face)).count();
        assert_eq!(component.euler_characteristic, corners.len() as i64 - edges as i64 + count as i64);
        assert_eq!(component.faces as usize, count);
        assert!(
            (0..faces.len()).filter(|&face| own(face)).all(|face| {
                found.components[found.face_components[face] as usize].first_face == component.first_face
            })
        );
    }
    // Orientation, by trying every way to turn faces over.
    let pairs: Vec<&Vec<(usize, [u32; 2])>> = uses.values().filter(|uses| uses.len() == 2).collect();
    let fits = |turned: usize| {
        pairs.iter().all(|pair| {
            let [one, other] = [pair[0], pair[1]].map(|(face, side)| (side[0] < side[1]) ^ (turned >> face & 1 == 1));
            one != other
        })
    };
    assert_eq!(found.is_oriented(), fits(0), "{faces:?}");
    assert_eq!(found.is_orientable(), (0..1 << faces.len()).any(fits), "{faces:?}");
    assert_eq!(found.inconsistent_edges.len(), pairs.iter().filter(|pair| pair[0].1 == pair[1].1).count());
    if !found.is_orientable() {
        assert_twisted(&found.orientation_witness, &pairs);
    }
    assert_eq!(found.components.iter().all(|component| component.orientable), found.is_orientable());
    // Duplicates: the first face with a rotation or reflection of the same cycle.
    let same = |a: &[u32], b: &[u32]| {
        let reversed: Vec<u32> = b.iter().rev().copied().collect();
        a.len() == b.len() && (0..b.len()).any(|k| [b, &reversed[..]].iter().any(|b| [&b[k..], &b[..k]].concat() == a))
    };
    let repeats: Vec<[u32; 2]> = (0..faces.len())
        .filter_map(|later| {
            let first = (0..later).find(|&first| same(&faces[first], &faces[later]))?;
            Some([first as u32, later as u32])
        })
        .collect();
    assert_eq!(found.duplicate_faces, repeats, "{faces:?}");
    let repeating = |cycle: &[u32]| cycle.iter().collect::<BTreeSet<_>>().len() < cycle.len();
    let repeating: Vec<u32> = (0..faces.len() as u32).filter(|&face| repeating(&faces[face as usize])).collect();
    assert_eq!(found.repeating_faces, repeating);
}

/// There is a choice of shared edges along the ring whose number of equal directions is odd.
fn assert_twisted(ring: &[u32], pairs: &[&Vec<(usize, [u32; 2])>]) {
    assert!(!ring.is_empty());
    let mut reachable = BTreeSet::from([false]);
    for k in 0..ring.len() {
        let [a, b] = [ring[k] as usize, ring[(k + 1) % ring.len()] as usize];
        let steps: BTreeSet<bool> = pairs
            .iter()
            .filter(|pair| [pair[0].0, pair[1].0] == [a, b] || [pair[1].0, pair[0].0] == [a, b])
            .map(|pair| pair[0].1 == pair[1].1)
            .collect();
        reachable = reachable.iter().flat_map(|odd| steps.iter().map(move |turn| odd ^ turn)).collect();
    }
    assert!(reachable.contains(&true), "{ring:?}");
}

#[test]
fn random_faces_agree_with_counting_by_definition() {
    let mut draws = Draws(1);
    for round in 0..4000u64 {
        let vertices = 4 + draws.below(6) as usize;
        let count = 1 + draws.below(8);
        let faces: Vec<Vec<u32>> = (0..count)
            .map(|_| {
                let corners = if round % 3 == 0 { 3 + draws.below(4) } else { 3 };
                (0..corners).map(|_| draws.below(vertices as u64)).collect()
            })
            .collect();
        assert_by_definition(vertices, &faces);
    }
}

#[test]
fn pieces_of_a_torus_agree_with_counting_by_definition() {
    let mut draws = Draws(2);
    for _ in 0..600 {
        let torus = grid(3, 3, |_, _| false);
        let faces: Vec<Vec<u32>> = torus.into_iter().filter(|_| draws.below(4) > 0).collect();
        let faces = faces.into_iter().map(|mut face| {
            if draws.below(3) == 0 {
                face.reverse();
            }
            face
        });
        assert_by_definition(9, &faces.collect::<Vec<_>>());
    }
}

/// Squares over a torus of `m` by `n`, or where `twist` says so for (last column, last row) over what comes of a glueing
/// with a turn.
fn grid(m: u32, n: u32, twist: impl Fn(bool, bool) -> bool) -> Vec<Vec<u32>> {
    let at = |i: u32, j: u32| {
        let (mut a, mut b) = (i, j);
        if i == m {
            a = 0;
            b = if twist(true, false) { (n - j % n) % n } else { j };
        }
        if b == n {
            b = 0;
        }
        a * n + b
    };
    (0..m).flat_map(|i| (0..n).map(move |j| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])).collect()
}

#[test]
fn known_surfaces_have_their_numbers() {
    let torus = report(60, &grid(10, 6, |_, _| false));
    assert_eq!((torus.euler_characteristic(), torus.genus(), torus.crosscaps()), (0, Some(1), Some(0)));
    assert!(torus.is_closed() && torus.is_manifold() && torus.is_oriented());
    let klein = report(60, &grid(10, 6, |_, _| true));
    assert_eq!((klein.euler_characteristic(), klein.genus(), klein.crosscaps()), (0, Some(0), Some(2)));
    assert!(klein.is_closed() && klein.is_manifold() && !klein.is_orientable() && !klein.is_oriented());
    // The projective plane on six vertices (half an icosahedron).
    let plane =
        [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3]];
    let plane: Vec<Vec<u32>> = plane.iter().map(|face| face.to_vec()).collect();
    let found = report(6, &plane);
    assert_eq!((found.euler_characteristic(), found.genus(), found.crosscaps()), (1, Some(0), Some(1)));
    assert!(found.is_closed() && found.is_manifold() && !found.is_orientable());
    // Without a face it is the Möbius strip: χ = 0, one loop.
    let strip = report(6, &plane[1..]);
    assert_eq!((strip.euler_characteristic(), strip.crosscaps(), strip.boundary.len()), (0, Some(1), 1));
    assert_eq!(strip.boundary.edges().len(), 3);
    // A torus and a projective plane beside it.
    let mut both = grid(3, 3, |_, _| false);
    both.extend(plane.iter().map(|face| face.iter().map(|vertex| vertex + 9).collect()));
    let both = report(15, &both);
    assert_eq!((both.components.len(), both.genus(), both.crosscaps()), (2, Some(1), Some(1)));
    assert_eq!(both.euler_characteristic(), 2 * 2 - 2 - 1);
}

/// The 7-vertex torus of Möbius (1886): the smallest number of vertices.
#[test]
fn the_torus_of_seven_vertices_is_one() {
    let faces: Vec<Vec<u32>> =
        (0..7).flat_map(|i| [vec![i, (i + 1) % 7, (i + 3) % 7], vec![i, (i + 3) % 7, (i + 2) % 7]]).collect();
    let found = report(7, &faces);
    assert_eq!((found.edges, found.faces, found.genus()), (21, 14, Some(1)));
    assert!(found.is_manifold() && found.is_closed() && found.is_oriented());
}

/// Misprints of textbooks.
#[test]
fn misprinted_meshes_are_seen_through() {
    // A face-vertex table of a box of which the faces at v8 name the wrong corners.
    let corners = [
        [0, 4, 5],
        [0, 5, 1],
        [1, 5, 6],
        [1, 6, 2],
        [2, 6, 7],
        [2, 7, 3],
        [3, 7, 4],
        [3, 4, 0],
        [8, 5, 4],
        [8, 6, 5],
        [8, 7, 6],
        [8, 4, 7],
        [9, 5, 4],
        [9, 6, 5],
        [9, 7, 6],
        [9, 4, 7],
    ];
    let faces: Vec<Vec<u32>> = corners.iter().map(|face| face.to_vec()).collect();
    let found = report(10, &faces);
    assert_eq!((found.non_manifold_edges.len(), found.boundary.edges().len()), (4, 4));
    assert_eq!(found.non_manifold_edges, [[4, 5], [4, 7], [5, 6], [6, 7]]);
    assert!(!found.is_manifold() && !found.is_closed());
    let mut mended = faces.clone();
    for (face, wanted) in mended[8..12].iter_mut().zip([[8, 0, 1], [8, 1, 2], [8, 2, 3], [8, 3, 0]]) {
        *face = wanted.to_vec();
    }
    let found = report(10, &mended);
    assert!(found.is_manifold() && found.is_closed() && found.is_orientable());
    assert_eq!((found.genus(), found.euler_characteristic()), (Some(0), 2));
    // A cube whose faces do not all turn the same way.
    let cube = ["0123", "0154", "1265", "2376", "3047", "4567"];
    let faces: Vec<Vec<u32>> =
        cube.iter().map(|face| face.bytes().map(|digit| u32::from(digit - b'0')).collect()).collect();
    let found = report(8, &faces);
    assert!(found.is_closed() && found.is_manifold() && found.is_orientable() && !found.is_oriented());
    assert_eq!((found.vertices, found.edges, found.faces, found.euler_characteristic()), (8, 12, 6, 2));
    // A diagonal added: 8, 13, 7.
    let mut split = faces;
    split[0] = vec![0, 1, 2];
    split.push(vec![0, 2, 3]);
    let found = report(8, &split);
    assert_eq!((found.vertices, found.edges, found.faces, found.euler_characteristic()), (8, 13, 7, 2));
    // 8, 16, 8: no sphere but a torus.
    let faces: Vec<Vec<u32>> = (0..8).map(|i| vec![i, (i + 1) % 8, (i + 4) % 8, (i + 3) % 8]).collect();
    let found = report(8, &faces);
    assert_eq!((found.vertices, found.edges, found.faces, found.euler_characteristic()), (8, 16, 8, 0));
    assert!(found.is_closed() && found.is_manifold() && found.is_oriented());
    assert_eq!(found.genus(), Some(1));
}

#[test]
fn two_cones_that_meet_in_their_apex_are_told() {
    let cone = |base: u32| {
        (0..4).flat_map(move |k| {
            let [a, b] = [base + k, base + (k + 1) % 4];
            [vec![0, a, b]]
        })
    };
    let faces: Vec<Vec<u32>> = cone(1).chain(cone(5)).collect();
    let found = report(9, &faces);
    assert_eq!(found.non_manifold_vertices, [0]);
    assert!(found.non_manifold_edges.is_empty() && !found.is_manifold());
    assert_eq!((found.components.len(), found.boundary.len(), found.genus()), (2, 2, None));
}

#[test]
fn loops_run_as_their_faces_do() {
    let torus = grid(5, 4, |_, _| false);
    let open: Vec<Vec<u32>> =
        torus.into_iter().enumerate().filter(|(k, _)| *k != 3 && *k != 10).map(|(_, face)| face).collect();
    let found = report(20, &open);
    assert_eq!((found.boundary.len(), found.genus()), (2, Some(1)));
    for edges in found.boundary.iter() {
        assert!(edges.len() == 4 && (0..4).all(|k| edges[k][1] == edges[(k + 1) % 4][0]));
    }
}

#[test]
fn nothing_and_large_valences_are_taken() {
    let nothing = report(0, &[]);
    assert!(!nothing.is_closed() && nothing.is_manifold() && nothing.is_orientable() && nothing.components.is_empty());
    assert_eq!(report(3, &[]).isolated_vertices, [0, 1, 2]);
    // A fan of 20,000 faces, and 16,000 faces on one edge.
    let fan: Vec<Vec<u32>> = (0..20_000).map(|k| vec![0, 1 + k, 1 + (k + 1) % 20_000]).collect();
    let found = report(20_001, &fan);
    assert_eq!((found.euler_characteristic(), found.boundary.len()), (1, 1));
    assert!(found.is_manifold() && found.is_oriented());
    let book: Vec<Vec<u32>> = (0..16_000).map(|k| vec![0, 1, 2 + k]).collect();
    let found = report(16_002, &book);
    assert_eq!((found.non_manifold_edges.len(), found.components.len(), found.boundary.len()), (1, 1, 1));
    let same: Vec<Vec<u32>> = (0..16_000).map(|k| if k % 2 == 0 { vec![0, 1, 2] } else { vec![1, 0, 2] }).collect();
    assert_eq!(report(3, &same).duplicate_faces.len(), 15_999);
}

#[test]
fn budgets_and_cancelling_are_kept() {
    let mesh = polygons(60, &grid(10, 6, |_, _| false));
    assert!(matches!(Topology::of(&mesh, &Exec::default().with_memory(2000)), Err(JudgeError::OverBudget(_))));
    let flag = CancelFlag::default();
    flag.cancel();
    let stopped = Topology::of(&mesh, &Exec::default().with_cancel(&flag));
    assert!(matches!(stopped, Err(JudgeError::Stop(Stop::Cancelled))));
    let exec = Exec::default();
    drop(Topology::of(&mesh, &exec).unwrap());
    assert_eq!(exec.memory_taken(), 0);
}
