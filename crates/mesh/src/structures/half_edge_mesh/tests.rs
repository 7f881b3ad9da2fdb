use shapeloom_core::Exec;

use super::*;
use crate::primitives::{Grid, Platonic, Solid, Torus};
use crate::structures::{Incidence, IndexedPolygons, Query, StructureError};
use crate::{PolyMesh, TriangulatePolygons};
use shapeloom_core::Convert;

fn of<F: AsRef<[u32]>>(vertices: u32, faces: &[F]) -> HalfEdgeMesh {
    HalfEdgeMesh::try_from(&IndexedPolygons::from_faces(vertices, faces).unwrap()).unwrap()
}

fn of_mesh(mesh: &PolyMesh) -> HalfEdgeMesh {
    HalfEdgeMesh::try_from(&IndexedPolygons::from(mesh)).unwrap()
}

/// A torus of triangles.
fn torus(segments: u32, sides: u32) -> HalfEdgeMesh {
    let torus = Torus { segments, sides, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
    let torus = TriangulatePolygons::new().convert(&torus).unwrap().value;
    of(torus.positions().len() as u32, torus.triangles())
}

fn grid(columns: u32, rows: u32) -> HalfEdgeMesh {
    of_mesh(&Grid { columns, rows, ..Grid::new() }.mesh(&Exec::default()).unwrap().value)
}

fn edge(mesh: &HalfEdgeMesh, a: u32, b: u32) -> EdgeId {
    mesh.edge(mesh.find(VertexId(a), VertexId(b)).unwrap())
}

#[test]
fn walks_go_counter_clockwise_and_end_at_the_border() {
    // A fan of three triangles around 0, whose border runs 0 1 2 3 4.
    let mesh = of(5, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let around: Vec<u32> = mesh.around_vertex(VertexId(0)).map(|h| mesh.target(h).0).collect();
    assert_eq!(around, [1, 2, 3, 4]);
    let faces: Vec<Option<u32>> = mesh.around_vertex(VertexId(0)).map(|h| mesh.face(h).map(|f| f.0)).collect();
    assert_eq!(faces, [Some(0), Some(1), Some(2), None]);
    // The border has the surface to its right.
    let loops = mesh.border_loops();
    assert_eq!(loops.len(), 1);
    let mut border: Vec<u32> = mesh.around_loop(loops[0]).map(|h| mesh.origin(h).0).collect();
    let start = border.iter().position(|&v| v == 0).unwrap();
    border.rotate_left(start);
    assert_eq!(border, [0, 4, 3, 2, 1]);
    assert!(mesh.is_border_vertex(VertexId(2)) && !mesh.is_border_edge(edge(&mesh, 0, 2)));
    // Inside, once around.
    let inner = grid(2, 2);
    let center = inner.live_vertices().find(|&v| !inner.is_border_vertex(v)).unwrap();
    assert_eq!((inner.valence(center), inner.border_loops().len()), (4, 1));
    let turn: Vec<FaceId> = inner.around_vertex(center).filter_map(|h| inner.face(h)).collect();
    for pair in turn.windows(2) {
        assert!(inner.answer(Query::FF, pair[0].0).unwrap().contains(&pair[1].0));
    }
}

#[test]
fn faces_come_back_with_their_numbers_first_corners_and_isolated_vertices() {
    let faces = IndexedPolygons::from_faces(9, &[vec![2, 0, 1], vec![3, 0, 2, 5], vec![8, 6, 7]]).unwrap();
    let mesh = HalfEdgeMesh::try_from(&faces).unwrap();
    assert_eq!(IndexedPolygons::from(&mesh), faces);
    assert_eq!((mesh.valence(VertexId(4)), mesh.leaving(VertexId(4))), (0, None));
    assert_eq!(mesh.counts(), Counts { vertices: 9, edges: 9, faces: 3 });
    assert!(mesh.validate().is_empty());
    let nothing = HalfEdgeMesh::try_from(&IndexedPolygons::default()).unwrap();
    assert!(nothing.validate().is_empty() && IndexedPolygons::from(&nothing) == IndexedPolygons::default());
}

#[test]
fn what_cannot_be_held_is_named() {
    let refused = |vertices, faces: &[Vec<u32>]| {
        HalfEdgeMesh::try_from(&IndexedPolygons::from_faces(vertices, faces).unwrap()).unwrap_err()
    };
    let error = refused(5, &[vec![0, 1, 2], vec![1, 3, 4, 3], vec![2, 2, 3]]);
    assert_eq!(error, StructureError::RepeatedCorner { face: 1, vertex: 3, count: 2 });
    let error = refused(5, &[vec![0, 1, 2], vec![1, 0, 3], vec![0, 1, 4]]);
    assert_eq!(error, StructureError::NonManifoldEdge { vertices: [0, 1], faces: vec![0, 1, 2], count: 1 });
    let error = refused(4, &[vec![0, 1, 2], vec![0, 1, 3]]);
    assert_eq!(error, StructureError::Orientation { vertices: [0, 1], faces: [0, 1], count: 1 });
    let error = refused(7, &[vec![0, 1, 2], vec![0, 3, 4], vec![0, 5, 6]]);
    assert_eq!(error, StructureError::NonManifoldVertex { vertex: 0, fans: 3, count: 1 });
    // Two tetrahedra at one vertex: closed fans.
    let solid = |a: u32| [[0, a + 1, a], [0, a, a + 2], [0, a + 2, a + 1], [a, a + 1, a + 2]].map(|f| f.to_vec());
    let error = refused(7, &[solid(1), solid(4)].concat());
    assert_eq!(error, StructureError::NonManifoldVertex { vertex: 0, fans: 2, count: 1 });
    let small = Exec::default().with_memory(100);
    let faces = IndexedPolygons::from_faces(3, &[[0, 1, 2]]).unwrap();
    assert!(matches!(HalfEdgeMesh::try_build(&faces, &small), Err(StructureError::OverBudget(_))));
}

#[test]
fn the_budget_returns() {
    let exec = Exec::default().with_memory(1 << 20);
    for _ in 0..5 {
        let faces = IndexedPolygons::from(&grid(20, 20));
        HalfEdgeMesh::try_build(&faces, &exec).unwrap();
        assert_eq!(exec.memory_taken(), 0);
    }
}

/// Damages one entry at a time; every damage must be found.
#[test]
fn validation_finds_every_damage() {
    let whole = grid(3, 2);
    assert!(whole.validate().is_empty());
    let mut found = 0;
    for column in 0..6 {
        let length =
            [&whole.origin, &whole.next, &whole.previous, &whole.face, &whole.leaving, &whole.first][column].len();
        for at in 0..length {
            for value in [0, 1, 5, length as u32 - 1, 1000, GONE, NONE] {
                let mut mesh = whole.clone();
                let columns = [
                    &mut mesh.origin,
                    &mut mesh.next,
                    &mut mesh.previous,
                    &mut mesh.face,
                    &mut mesh.leaving,
                    &mut mesh.first,
                ];
                let entry = &mut columns.into_iter().nth(column).unwrap()[at];
                if *entry == value {
                    continue;
                }
                *entry = value;
                // Another half-edge of the same inner vertex, or another corner of the same face, is no damage.
                let harmless = (column == 4 && mesh.origin.get(value as usize) == Some(&(at as u32)) && {
                    let before = whole.leaving[at];
                    whole.face[before as usize] != NONE
                }) || (column == 5 && mesh.face.get(value as usize) == Some(&(at as u32)));
                assert_eq!(mesh.validate().is_empty(), harmless, "column {column}, entry {at}, value {value}");
                found += 1;
            }
        }
    }
    assert!(found > 1000);
    let mut mesh = whole.clone();
    mesh.counts.edges += 1;
    assert_eq!(mesh.validate().len(), 1);
    // Several findings are all listed.
    let mut mesh = whole;
    mesh.leaving[0] = NONE - 5;
    mesh.first[0] = NONE - 5;
    assert_eq!(mesh.validate().len(), 2);
}

#[test]
fn two_edges_between_the_same_vertices_are_found() {
    // Two squares glued along their border would be fine; the same with a chord on each side has it twice.
    let mut mesh = of(4, &[[0, 1, 2, 3], [3, 2, 1, 0]]);
    assert!(mesh.validate().is_empty());
    for (face, from, to) in [(0, 0, 2), (1, 2, 0)] {
        let at = |mesh: &HalfEdgeMesh, v: u32| {
            mesh.around_face(FaceId(face)).find(|&h| mesh.origin(h) == VertexId(v)).unwrap().0
        };
        let (from, to) = (at(&mesh, from), at(&mesh, to));
        mesh.cut(from, to);
    }
    let found = mesh.validate();
    assert_eq!(found.len(), 1);
    assert!(found[0].to_string().contains("another edge has the same vertices"), "{}", found[0]);
}

#[test]
fn two_flips_exchange_the_faces_and_four_change_nothing() {
    let source = torus(6, 5);
    for e in source.live_edges() {
        let mut mesh = source.clone();
        if mesh.flip_edge(e).is_err() {
            continue;
        }
        assert!(mesh.validate().is_empty() && mesh != source);
        mesh.flip_edge(e).unwrap();
        assert_eq!(mesh.ends(e), [source.ends(e)[1], source.ends(e)[0]]);
        mesh.flip_edge(e).unwrap();
        mesh.flip_edge(e).unwrap();
        assert_eq!(
            (&mesh.origin, &mesh.next, &mesh.previous, &mesh.face),
            (&source.origin, &source.next, &source.previous, &source.face)
        );
    }
}

#[test]
fn collapsing_a_split_edge_gives_back_the_faces() {
    let turned = |mesh: &HalfEdgeMesh| {
        let mut all: Vec<Vec<u32>> = mesh
            .live_faces()
            .map(|face| {
                let mut corners: Vec<u32> = mesh.corners(face).map(|v| v.0).collect();
                let least = (0..corners.len()).min_by_key(|&i| corners[i]).unwrap();
                corners.rotate_left(least);
                corners
            })
            .collect();
        all.sort();
        all
    };
    for source in [torus(5, 4), grid(3, 3), of(3, &[[0, 1, 2]]), of(5, &[[0, 1, 2], [0, 2, 3], [0, 3, 4]])] {
        for e in source.live_edges() {
            for (operator, towards) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let mut mesh = source.clone();
                let end = mesh.ends(e)[towards];
                let vertex = if operator == 0 { mesh.split_edge(e) } else { mesh.insert_on_edge(e) }.unwrap();
                assert!(mesh.validate().is_empty());
                // Faces still start where they did.
                let starts = |mesh: &HalfEdgeMesh, face| mesh.corners(face).next();
                assert!(operator == 0 || source.live_faces().all(|f| starts(&mesh, f) == starts(&source, f)));
                mesh.collapse_half_edge(mesh.find(vertex, end).unwrap()).unwrap();
                assert!(mesh.validate().is_empty());
                assert_eq!(turned(&mesh), turned(&source));
            }
        }
    }
}

#[test]
fn a_cut_face_is_joined_again() {
    let mut mesh = of(6, &[[0, 1, 2, 3, 4, 5]]);
    let around: Vec<HalfEdgeId> = mesh.around_face(FaceId(0)).collect();
    let half = mesh.cut_face(around[1], around[4]).unwrap();
    assert_eq!((mesh.origin(half), mesh.target(half), mesh.face(half)), (VertexId(4), VertexId(1), Some(FaceId(0))));
    assert_eq!(mesh.corners(FaceId(0)).map(|v| v.0).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert_eq!(mesh.corners(FaceId(1)).map(|v| v.0).collect::<Vec<_>>(), [4, 5, 0, 1]);
    assert!(mesh.validate().is_empty());
    mesh.join_faces(mesh.edge(half)).unwrap();
    assert!(mesh.validate().is_empty());
    assert_eq!(mesh.corners(FaceId(0)).count(), 6);
    assert_eq!(mesh.counts(), Counts { vertices: 6, edges: 6, faces: 1 });
}

#[test]
fn reasons_name_what_is_in_the_way() {
    let tetrahedron = of_mesh(&Platonic::new(Solid::Tetrahedron).mesh(&Exec::default()).unwrap().value);
    assert!(matches!(tetrahedron.can_flip(EdgeId(0)), Err(Illegal::DuplicateEdge { .. })));
    assert!(matches!(tetrahedron.can_collapse(HalfEdgeId(0)), Err(Illegal::DuplicateFace { .. })));
    assert!(matches!(tetrahedron.can_remove_vertex(VertexId(0), Hole::Triangles), Err(Illegal::DuplicateFace { .. })));
    // Two tetrahedra glued along a triangle 0 1 2 that is not there: its sides cannot be collapsed.
    let glued = of(5, &[[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]]);
    let side = glued.find(VertexId(0), VertexId(1)).unwrap();
    assert_eq!(glued.can_collapse(side), Err(Illegal::LinkCondition { vertex: VertexId(2) }));
    assert!(glued.can_collapse(glued.find(VertexId(3), VertexId(0)).unwrap()).is_ok());
    let triangle = of(3, &[[0, 1, 2]]);
    assert_eq!(triangle.can_flip(EdgeId(0)), Err(Illegal::BorderEdge { vertices: triangle.ends(EdgeId(0)) }));
    assert!(matches!(triangle.can_collapse(HalfEdgeId(0)), Err(Illegal::ClosesBorder { .. })));
    let strip = of(4, &[[0, 1, 2], [2, 1, 3]]);
    let inner = strip.find(VertexId(1), VertexId(2)).unwrap();
    assert_eq!(strip.can_collapse(inner), Err(Illegal::PinchesBorder { vertices: [VertexId(1), VertexId(2)] }));
    let low = Err(Illegal::ValenceTooLow { vertex: VertexId(0), valence: 2 });
    assert_eq!(strip.can_remove_vertex(VertexId(0), Hole::Polygon), low);
    // Numbers that are not there, or no longer, are refused and do not panic.
    let mut mesh = torus(5, 4);
    mesh.collapse_half_edge(HalfEdgeId(0)).unwrap();
    for gone in [0, 1, u32::MAX, u32::MAX - 1, 1 << 30] {
        assert!(matches!(mesh.collapse_half_edge(HalfEdgeId(gone)), Err(Illegal::Gone { .. })));
        assert!(matches!(mesh.cut_face(HalfEdgeId(gone), HalfEdgeId(9)), Err(Illegal::Gone { .. })));
    }
    let (vertex, face) = (u32::MAX - 1, u32::MAX);
    assert!(matches!(mesh.flip_edge(EdgeId(0)), Err(Illegal::Gone { kind: "edge", index: 0 })));
    assert!(mesh.split_edge(EdgeId(u32::MAX)).is_err() && mesh.insert_on_edge(EdgeId(1 << 31)).is_err());
    assert!(mesh.split_face(FaceId(face)).is_err() && mesh.triangulate_face(FaceId(face)).is_err());
    assert!(mesh.remove_vertex(VertexId(vertex), Hole::Polygon).is_err() && mesh.join_faces(EdgeId(0)).is_err());
    assert!(mesh.collapse_edge(EdgeId(0)).is_err());
}

#[test]
fn a_pillow_is_held_and_left_alone() {
    let mut pillow = of(3, &[[0, 1, 2], [2, 1, 0]]);
    let source = pillow.clone();
    assert!(pillow.validate().is_empty());
    for e in 0..3 {
        assert!(pillow.flip_edge(EdgeId(e)).is_err() && pillow.join_faces(EdgeId(e)).is_err());
        assert!(pillow.collapse_edge(EdgeId(e)).is_err());
        assert!(pillow.remove_vertex(VertexId(e), Hole::Triangles).is_err());
    }
    assert!(pillow == source);
    let mut square = of(4, &[[0, 1, 2, 3], [3, 2, 1, 0]]);
    assert!(matches!(square.collapse_half_edge(HalfEdgeId(0)), Err(Illegal::DuplicateFace { .. })));
}

#[test]
fn numbers_close_up_and_say_where_they_come_from() {
    let mut mesh = torus(8, 6);
    mesh.collapse_half_edge(HalfEdgeId(10)).unwrap();
    let face = mesh.live_faces().nth(3).unwrap();
    mesh.split_face(face).unwrap();
    mesh.collapse_half_edge(HalfEdgeId(60)).unwrap();
    let before = mesh.clone();
    let numbers = mesh.compact();
    assert!(mesh.validate().is_empty());
    assert_eq!(mesh.counts(), before.counts());
    assert_eq!(mesh.vertex_slots(), mesh.counts().vertices as usize);
    assert_eq!((mesh.edge_slots(), mesh.face_slots()), (mesh.counts().edges as usize, mesh.counts().faces as usize));
    for (new, &old) in numbers.faces.old().iter().enumerate() {
        let renamed = before.corners(FaceId(old)).map(|v| numbers.vertices.new_of(v.0).unwrap());
        assert!(renamed.eq(mesh.corners(FaceId(new as u32)).map(|v| v.0)));
        assert_eq!(numbers.faces.new_of(old), Some(new as u32));
    }
    for (new, &old) in numbers.edges.old().iter().enumerate() {
        let ends = before.ends(EdgeId(old)).map(|v| VertexId(numbers.vertices.new_of(v.0).unwrap()));
        assert_eq!(mesh.ends(EdgeId(new as u32)), ends);
    }
    let gone = (0..before.vertex_slots() as u32).filter(|&v| !before.has_vertex(VertexId(v)));
    assert!(gone.clone().count() == 2 && gone.into_iter().all(|v| numbers.vertices.new_of(v).is_none()));
    assert_eq!(numbers.vertices.origins(), crate::Origins::Copies(numbers.vertices.old().to_vec()));
    // Nothing left to do.
    let again = mesh.clone();
    mesh.compact();
    assert!(mesh == again);
}

#[test]
fn breadth_first_search_meets_each_face_once_at_its_distance() {
    // On a grid of cells the distance is that of steps along rows and columns.
    let mesh = grid(9, 6);
    let mut met = vec![None; 54];
    for reached in mesh.breadth_first([FaceId(0)]) {
        assert_eq!(met[reached.face.index()].replace(reached.distance), None);
        let (column, row) = (reached.face.0 % 9, reached.face.0 / 9);
        assert_eq!(reached.distance, column + row);
        let from = reached.over.map(|over| mesh.face(mesh.twin(over)).unwrap());
        assert_eq!(from.is_none(), reached.distance == 0);
        assert!(from.is_none_or(|from| met[from.index()] == Some(reached.distance - 1)));
    }
    assert!(met.iter().all(Option::is_some));
    // A fence between two columns keeps it on its side.
    let fence = |edge: EdgeId| {
        let columns: Vec<u32> = mesh.halves(edge).iter().filter_map(|&h| mesh.face(h)).map(|f| f.0 % 9).collect();
        !(columns.contains(&3) && columns.contains(&4))
    };
    let mut inside: Vec<u32> = mesh.breadth_first_within([FaceId(1), FaceId(1)], fence).map(|r| r.face.0).collect();
    inside.sort_unstable();
    assert_eq!(inside, (0..54).filter(|face| face % 9 < 4).collect::<Vec<_>>());
    // A visitor ends it; deleted and unknown faces are no start.
    let mut first = Vec::new();
    mesh.visit_breadth_first([FaceId(99), FaceId(20)], |_| true, &mut |reached| {
        first.push(reached.distance);
        if reached.distance > 0 { std::ops::ControlFlow::Break(()) } else { std::ops::ControlFlow::Continue(()) }
    });
    assert_eq!(first, [0, 1]);
    // Components do not touch; several starts are all at distance 0.
    let two = of(8, &[[0, 1, 2], [2, 1, 3], [4, 5, 6], [6, 5, 7]]);
    assert_eq!(two.breadth_first([FaceId(2)]).map(|r| r.face.0).collect::<Vec<_>>(), [2, 3]);
    assert_eq!(two.breadth_first([FaceId(2), FaceId(0)]).filter(|r| r.distance == 0).count(), 2);
}

/// How many entries of all arrays differ.
fn changed(a: &HalfEdgeMesh, b: &HalfEdgeMesh) -> usize {
    let pairs = [
        (&a.origin, &b.origin),
        (&a.next, &b.next),
        (&a.previous, &b.previous),
        (&a.face, &b.face),
        (&a.leaving, &b.leaving),
        (&a.first, &b.first),
    ];
    let count =
        |(x, y): (&Vec<u32>, &Vec<u32>)| x.iter().zip(y).filter(|(x, y)| x != y).count() + x.len().abs_diff(y.len());
    pairs.into_iter().map(count).sum()
}

#[test]
fn operators_touch_as_much_of_a_small_mesh_as_of_a_large_one() {
    let mut most = Vec::new();
    for (segments, sides) in [(10, 10), (100, 100), (400, 250)] {
        let mesh = torus(segments, sides);
        assert_eq!(mesh.counts().vertices, segments * sides);
        let mut touched = [0; 5];
        for k in 0..20 {
            let at = mesh.edge_slots() as u32 / 20 * k;
            let operators: [fn(&mut HalfEdgeMesh, u32); 5] = [
                |mesh, at| mesh.flip_edge(EdgeId(at)).unwrap(),
                |mesh, at| {
                    let _ = mesh.split_edge(EdgeId(at)).unwrap();
                },
                |mesh, at| {
                    let _ = mesh.collapse_edge(EdgeId(at)).unwrap();
                },
                |mesh, at| {
                    let _ = mesh.split_face(mesh.face(HalfEdgeId(2 * at)).unwrap()).unwrap();
                },
                |mesh, at| {
                    let _ = mesh.remove_vertex(mesh.origin(HalfEdgeId(2 * at)), Hole::Triangles).unwrap();
                },
            ];
            for (touched, operator) in touched.iter_mut().zip(operators) {
                let mut after = mesh.clone();
                operator(&mut after, at);
                *touched = changed(&mesh, &after).max(*touched);
            }
        }
        most.push(touched);
    }
    // A flip sets 2 origins, 6 next, 6 previous, 2 faces and up to 4 half-edges of vertices and faces. All vertices
    // have six edges; the rest are the counts of the least mesh, rounded up.
    for touched in most {
        assert!(
            touched.iter().zip([20, 45, 50, 40, 150]).all(|(&found, bound)| found > 10 && found <= bound),
            "{touched:?}"
        );
    }
}

#[test]
fn a_hub_of_very_many_edges_is_removed_and_made_again() {
    let ring: Vec<u32> = (0..5000).collect();
    let mut mesh = of(5000, &[ring]);
    let hub = mesh.split_face(FaceId(0)).unwrap();
    assert_eq!(mesh.valence(hub), 5000);
    // Finding an edge at the hub costs what the other end has.
    assert!(mesh.find(hub, VertexId(77)).is_some());
    mesh.remove_vertex(hub, Hole::Triangles).unwrap();
    assert!(mesh.validate().is_empty());
    assert_eq!(mesh.counts(), Counts { vertices: 5000, edges: 5000 + 4997, faces: 4998 });
    let tip = mesh.live_vertices().find(|&vertex| mesh.valence(vertex) == 4999).unwrap();
    mesh.remove_vertex(tip, Hole::Polygon).unwrap();
    assert!(mesh.validate().is_empty());
    assert_eq!(mesh.counts().faces, 1);
}

#[test]
#[should_panic(expected = "there is no")]
fn an_edge_that_is_not_there_has_no_halves() {
    let mesh = of(3, &[[0, 1, 2]]);
    mesh.halves(EdgeId(3));
}

/// Twice its number is 0, in 32 bits.
#[test]
#[should_panic(expected = "there is no")]
fn an_edge_that_is_not_there_is_taken_for_no_other() {
    let mesh = of(3, &[[0, 1, 2]]);
    mesh.ends(EdgeId(1 << 31));
}

#[test]
fn beyond_64_corners_it_is_fans_that_were_tried() {
    let mesh = torus(10, 10);
    // Each of these has six neighbours, of which two at most are beside it in the outline.
    let all: Vec<u32> = (0..100).collect();
    assert_eq!(mesh.plan_ears(&all), Err(Illegal::NoFan { corners: 100 }));
    assert!(Illegal::NoFan { corners: 100 }.to_string().contains("not tried"));
    // All of these are joined to each other: no triangulation has new edges.
    let solid = of(4, &[[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
    assert_eq!(solid.plan_ears(&[0, 1, 2, 3]), Err(Illegal::NoTriangulation { corners: 4 }));
}
