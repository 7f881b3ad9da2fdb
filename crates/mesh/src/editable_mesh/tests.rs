use super::*;
use crate::primitives::{Grid, Platonic, Solid};
use crate::{COLOR, Column, Domain, NORMAL, TEXCOORD, TriangulatePolygons, Values};
use shapeloom_core::Convert;

fn triangles(mesh: &PolyMesh) -> TriMesh {
    TriangulatePolygons::new().convert(mesh).unwrap().value
}

/// A square of four by four cells in the plane, with its coordinates as an attribute.
fn grid() -> TriMesh {
    let grid = Grid { columns: 4, rows: 4, ..Grid::new() }.mesh(&Exec::default()).unwrap().value;
    let mut mesh = TriMesh::try_new(grid.positions().to_vec(), triangles(&grid).triangles().to_vec()).unwrap();
    let places: Vec<f64> = mesh.positions().iter().flat_map(|p| p.to_array()).collect();
    mesh.insert_attribute(Domain::Vertex, Column::try_new("place", 3, Values::F64(places)).unwrap()).unwrap();
    let labels = (0..mesh.triangles().len() as u32).collect();
    mesh.insert_attribute(Domain::Face, Column::labels("face", labels)).unwrap();
    mesh
}

fn dice(state: &mut u64, below: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    ((*state >> 33) % below as u64) as usize
}

#[test]
fn an_untouched_mesh_comes_back_to_the_bit() {
    let cube = Platonic::new(Solid::Cube).mesh(&Exec::default()).unwrap().value;
    let back = EditableMesh::try_from(&cube).unwrap().to_polygons(&Exec::default()).unwrap();
    assert_eq!(back, (cube.clone(), vec![]));
    let mesh = triangles(&cube);
    let back = EditableMesh::try_from(&mesh).unwrap().to_triangles(&Exec::default()).unwrap();
    assert_eq!(back, (mesh, vec![]));
    let error = EditableMesh::try_from(&cube).unwrap().to_triangles(&Exec::default()).unwrap_err();
    assert!(matches!(error, StructureError::Mesh(crate::MeshError::NotTriangle { face: 0, found: 4 })), "{error}");
}

#[test]
fn area_and_linear_attributes_survive_any_operators_in_a_plane() {
    let source = grid();
    let mut mesh = EditableMesh::try_from(&source).unwrap();
    let (mut state, mut done) = (3, [0; 5]);
    for _ in 0..4000 {
        let edge = EdgeId(dice(&mut state, mesh.connectivity().edge_slots()) as u32);
        if !mesh.connectivity().has_edge(edge) {
            continue;
        }
        let ends = mesh.connectivity().ends(edge);
        let [a, b] = ends.map(|end| mesh.positions()[end.index()]);
        let inner = ends.map(|end| !mesh.connectivity().is_border_vertex(end));
        let operator = dice(&mut state, 5);
        let large = mesh.connectivity().counts().vertices > 60;
        let legal = match operator {
            0 => mesh.flip_edge(edge).is_ok(),
            1 if !large => mesh.split_edge(edge, a.lerp(b, 0.25)).is_ok(),
            // A border vertex must stay, or the square would change.
            2 if inner == [true; 2] => mesh.collapse_edge(edge, a.lerp(b, 0.75)).is_ok(),
            3 if inner[0] => mesh.remove_vertex(ends[0], Hole::Triangles).is_ok(),
            4 if !large => {
                let face = mesh.connectivity().face(mesh.connectivity().halves(edge)[0]);
                face.is_some_and(|face| {
                    let corners: Vec<DVec3> =
                        mesh.connectivity().corners(face).map(|v| mesh.positions()[v.index()]).collect();
                    let at = corners[0] * 0.5 + corners[1] * 0.25 + corners[2] * 0.25;
                    mesh.split_face(face, at).is_ok()
                })
            }
            _ => false,
        };
        done[operator] += usize::from(legal);
    }
    assert!(done.iter().all(|&count| count > 20), "{done:?}");
    assert_eq!(mesh.connectivity().validate(), []);
    let (result, losses) = mesh.to_triangles(&Exec::default()).unwrap();
    assert!(losses.is_empty());
    assert!((result.area() - source.area()).abs() < 1e-12, "{} {}", result.area(), source.area());
    for face in 0..result.triangles().len() {
        assert!(crate::triangle_normal(result.corners(face)).z > 0.999, "{:?}", result.corners(face));
    }
    // The coordinates as attributes are those of the place, where no mixture had to be cut short.
    let places = result.attribute(Domain::Vertex, "place").unwrap();
    let wrong = (0..result.positions().len()).filter(|&v| places.vector(v).distance(result.positions()[v]) > 1e-12);
    assert!(wrong.count() * 10 < result.positions().len());
    assert_eq!(result.attribute(Domain::Face, "face").unwrap().len(), result.triangles().len());
}

#[test]
fn mixtures_are_what_they_say() {
    let mut source = TriMesh::try_new(vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0], vec![[0, 1, 2]]).unwrap();
    let add = |mesh: &mut TriMesh, domain, column| mesh.insert_attribute(domain, column).unwrap();
    add(&mut source, Domain::Vertex, Column::try_new(COLOR, 1, Values::F64(vec![0.0, 8.0, 16.0])).unwrap());
    add(&mut source, Domain::Vertex, Column::normals(NORMAL, &[DVec3::Z, DVec3::Z, DVec3::X * 0.5]));
    add(&mut source, Domain::Vertex, Column::labels("id", vec![5, 6, 7]));
    add(&mut source, Domain::Wedge, Column::texcoords(TEXCOORD, &[[0.0; 2]; 3]));
    let mut mesh = EditableMesh::try_from(&source).unwrap();
    let edge = mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap();
    let edge = mesh.connectivity().edge(edge);
    let on_edge = mesh.split_edge(edge, DVec3::X).unwrap();
    assert_eq!(on_edge, VertexId(3));
    // Inside the triangle 3, 1, 2, with different weights of all three.
    let in_face = mesh.split_face(FaceId(0), DVec3::new(2.0, 1.0, 0.0)).unwrap();
    let (result, losses) = mesh.to_triangles(&Exec::default()).unwrap();
    let color = result.attribute(Domain::Vertex, COLOR).unwrap();
    assert_eq!((color.number(3, 0), result.positions()[3]), (2.0, DVec3::X));
    // Linear: 2 a unit along x, 4 a unit along y.
    assert!((color.number(in_face.index(), 0) - 8.0).abs() < 1e-14);
    let normals = result.attribute(Domain::Vertex, NORMAL).unwrap();
    assert_eq!(normals.vector(2), DVec3::X * 0.5, "an untouched value keeps its bits");
    assert!((normals.vector(in_face.index()).length() - 1.0).abs() < 1e-15);
    let ids = result.attribute(Domain::Vertex, "id").unwrap();
    assert_eq!(ids.number(3, 0), 5.0);
    assert_eq!(losses.len(), 1);
    assert!(losses[0].what.contains(TEXCOORD), "{losses:?}");
}

#[test]
fn fold_overs_are_refused_at_any_size_and_place() {
    for (size, offset) in [(1.0, 0.0), (1e-9, 0.0), (1e-300, 0.0), (1e150, 0.0), (1e-2, 5e6)] {
        let place = |p: &DVec3| *p * size + DVec3::splat(offset);
        let source = grid();
        let positions: Vec<DVec3> = source.positions().iter().map(place).collect();
        let mut mesh =
            EditableMesh::try_from(&TriMesh::try_new(positions, source.triangles().to_vec()).unwrap()).unwrap();
        let center = source.positions().iter().position(|p| p.length() < 1e-9).unwrap() as u32;
        let ring: Vec<HalfEdgeId> = mesh.connectivity().around_vertex(VertexId(center)).collect();
        // Into a neighbour nothing folds; outside of the mesh something does.
        let edge = mesh.connectivity().edge(ring[0]);
        let far = place(&(source.positions()[0] * 1.9));
        assert!(matches!(mesh.clone().collapse_edge(edge, far), Err(Illegal::FoldsOver { .. })), "{size}");
        assert!(matches!(mesh.split_edge(edge, far), Err(Illegal::FoldsOver { .. })), "{size}");
        let face = mesh.connectivity().face(ring[0]).unwrap();
        assert!(matches!(mesh.split_face(face, far), Err(Illegal::FoldsOver { .. })), "{size}");
        assert!(matches!(mesh.split_face(face, DVec3::NAN), Err(Illegal::FoldsOver { .. })), "{size}");
        mesh.collapse_half_edge(ring[0]).unwrap();
        let removed = mesh.connectivity().live_vertices().filter(|&v| !mesh.connectivity().is_border_vertex(v));
        let inner: Vec<VertexId> = removed.collect();
        for vertex in inner {
            mesh.remove_vertex(vertex, Hole::Triangles).unwrap();
        }
        let (flat, _) = mesh.to_triangles(&Exec::default()).unwrap();
        assert!((0..flat.triangles().len()).all(|f| crate::triangle_normal(flat.corners(f)).z > 0.9), "{size}");
    }
}

#[test]
fn flips_in_a_plane_are_legal_where_the_quadrilateral_is_strictly_convex() {
    let (mut state, mut legal) = (9, 0);
    for _ in 0..2000 {
        let mut point = || DVec2::new(dice(&mut state, 9) as f64, dice(&mut state, 9) as f64);
        let quad = [point(), point(), point(), point()];
        let turn = |a: usize, b: usize, c: usize| (quad[b] - quad[a]).perp_dot(quad[c] - quad[a]);
        if turn(0, 1, 2) <= 0.0 || turn(0, 2, 3) <= 0.0 {
            continue;
        }
        let positions = quad.map(|p| p.extend(0.0)).to_vec();
        let source = TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let mut mesh = EditableMesh::try_from(&source).unwrap();
        let half = mesh.connectivity().find(VertexId(0), VertexId(2)).unwrap();
        let convex = turn(3, 0, 1) > 0.0 && turn(1, 2, 3) > 0.0;
        assert_eq!(mesh.flip_edge(mesh.connectivity().edge(half)).is_ok(), convex, "{quad:?}");
        legal += usize::from(convex);
    }
    assert!(legal > 100);
}

#[test]
fn a_triangle_without_area_may_be_flipped_away_but_not_made() {
    // 2 lies on the edge from 0 to 1.
    let positions = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let source = TriMesh::try_new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
    let mut mesh = EditableMesh::try_from(&source).unwrap();
    let half = mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap();
    let edge = mesh.connectivity().edge(half);
    mesh.flip_edge(edge).unwrap();
    assert!(matches!(mesh.flip_edge(edge), Err(Illegal::FoldsOver { .. })));
}

#[test]
fn parts_of_a_face_have_its_attributes() {
    let mut mesh = EditableMesh::try_from(&grid()).unwrap();
    let inner = mesh.connectivity().live_edges().filter(|&edge| !mesh.connectivity().is_border_edge(edge));
    let edge = inner.last().unwrap();
    let [a, b] = mesh.connectivity().ends(edge).map(|end| mesh.positions()[end.index()]);
    let mut beside: Vec<u32> =
        mesh.connectivity().halves(edge).map(|half| mesh.connectivity().face(half).unwrap().0).to_vec();
    let vertex = mesh.split_edge(edge, (a + b) / 2.0).unwrap();
    let parts: Vec<usize> =
        mesh.connectivity().around_vertex(vertex).map(|h| mesh.connectivity().face(h).unwrap().index()).collect();
    let (result, _) = mesh.to_triangles(&Exec::default()).unwrap();
    let labels = result.attribute(Domain::Face, "face").unwrap();
    let mut found: Vec<u32> = parts.iter().map(|&face| labels.number(face, 0) as u32).collect();
    found.sort_unstable();
    beside.extend_from_within(..);
    beside.sort_unstable();
    assert_eq!(found, beside);
    // Each part lies inside the face whose label it has.
    let source = grid();
    for (face, &label) in parts.iter().zip(&parts.iter().map(|&f| labels.number(f, 0) as usize).collect::<Vec<_>>()) {
        let center = result.corners(*face).iter().sum::<DVec3>() / 3.0;
        let [p, q, r] = source.corners(label);
        assert!([[p, q], [q, r], [r, p]].iter().all(|[a, b]| (*b - *a).cross(center - *a).z > 0.0));
    }
}

#[test]
fn holes_avoid_edges_that_are_there_and_refuse_what_would_fold() {
    // A vertex in a quadrilateral, one diagonal of which is an edge of another face.
    let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [2, 1, 3]];
    let mesh = |places: [(f64, f64); 5]| {
        let positions = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
        EditableMesh::try_from(&TriMesh::try_new(positions, faces.clone()).unwrap()).unwrap()
    };
    let mut convex = mesh([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)]);
    convex.remove_vertex(VertexId(4), Hole::Triangles).unwrap();
    assert_eq!(convex.connectivity().validate(), []);
    assert!(convex.connectivity().find(VertexId(0), VertexId(2)).is_some());
    // Concave: the diagonal that is left lies outside.
    let mut arrow = mesh([(2.0, 1.0), (0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (0.3, 0.0)]);
    let refused = arrow.remove_vertex(VertexId(4), Hole::Triangles);
    assert!(matches!(refused, Err(Illegal::FoldsOver { .. })), "{refused:?}");
    assert!(arrow.remove_vertex(VertexId(4), Hole::Polygon).is_ok());
}

#[test]
fn a_face_may_get_area_by_a_collapse_but_not_lose_it() {
    let faces = vec![[0, 1, 2], [1, 3, 2], [1, 4, 3]];
    let mesh = |x: f64, y: f64| {
        let places = [(0.0, 0.0), (x, y), (0.0, 1.0), (1.0, 1.0), (2.0, 0.0)];
        let positions = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
        EditableMesh::try_from(&TriMesh::try_new(positions, faces.clone()).unwrap()).unwrap()
    };
    let (good, flat) = (DVec3::X, DVec3::new(0.5, 1.0, 0.0));
    let edge =
        |mesh: &EditableMesh| mesh.connectivity().edge(mesh.connectivity().find(VertexId(0), VertexId(1)).unwrap());
    let mut sound = mesh(1.0, 0.0);
    let face = FaceId(1);
    assert_eq!(sound.collapse_edge(edge(&sound), flat), Err(Illegal::FoldsOver { face }));
    assert!(sound.collapse_edge(edge(&sound), good * 0.75).is_ok());
    let mut without = mesh(0.5, 1.0);
    assert!(without.clone().collapse_edge(edge(&without), flat).is_ok());
    assert!(without.collapse_edge(edge(&without), good).is_ok());
}

#[test]
fn the_number_of_sources_is_bounded() {
    let mut mesh = EditableMesh::try_from(&grid()).unwrap();
    mesh.min_cosine = -2.0;
    let vertices: Vec<VertexId> = mesh.connectivity().live_vertices().collect();
    let all: Vec<(VertexId, f64)> = vertices.iter().map(|&v| (v, 1.0 + f64::from(v.0))).collect();
    let mixture = mesh.mix(&all).unwrap();
    assert_eq!((all.len(), mixture.len()), (25, 25));
    let twice: Vec<(VertexId, f64)> = (0..99).map(|i| (VertexId(i % 25), 0.01)).collect();
    assert_eq!(mesh.mix(&twice).unwrap().len(), 25);
    mesh.positions.resize(60, DVec3::ZERO);
    mesh.mixed.resize(60, None);
    let many: Vec<(VertexId, f64)> = (0..60).map(|i| (VertexId(i), f64::from(i + 1) / 1830.0)).collect();
    let mixture = mesh.mix(&many).unwrap();
    assert_eq!((mixture.len(), mixture[0].0), (SOURCES, 28));
    assert!((mixture.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-14);
}

#[test]
fn a_hub_of_very_many_edges_is_removed() {
    let count = 5000u32;
    let rim = |i: u32| DVec3::from((DVec2::from_angle(f64::from(i) / f64::from(count) * std::f64::consts::TAU), 0.0));
    let positions = (0..count).map(rim).chain([DVec3::ZERO]).collect();
    let faces = (0..count).map(|i| [i, (i + 1) % count, count]).collect();
    let mut mesh = EditableMesh::try_from(&TriMesh::try_new(positions, faces).unwrap()).unwrap();
    let hub = VertexId(count);
    assert_eq!(mesh.connectivity().valence(hub), count as usize);
    mesh.remove_vertex(hub, Hole::Triangles).unwrap();
    assert_eq!(mesh.connectivity().counts().faces, count - 2);
    assert_eq!(mesh.connectivity().validate(), []);
}

/// Two triangles in a plane that make a quadrilateral which is not convex, and the edge between them.
fn dart() -> (EditableMesh, EdgeId) {
    let places = [(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)];
    let positions = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let mesh = EditableMesh::try_from(&TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()).unwrap();
    let half = mesh.connectivity().find(VertexId(0), VertexId(2)).unwrap();
    let edge = mesh.connectivity().edge(half);
    (mesh, edge)
}

#[test]
fn a_face_that_turns_over_exactly_is_admitted_below_minus_one_only() {
    let (mut mesh, edge) = dart();
    for least in [0.0, -1.0] {
        mesh.min_cosine = least;
        assert!(matches!(mesh.flip_edge(edge), Err(Illegal::FoldsOver { .. })), "{least}");
    }
    mesh.min_cosine = -1.5;
    mesh.flip_edge(edge).unwrap();
}

#[test]
fn nan_refuses_whatever_changes_a_face() {
    // With area, and without any.
    for height in [1.0, 0.0] {
        let places = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)];
        let positions = places.map(|(x, y)| DVec3::new(x, y * height, 0.0)).to_vec();
        let faces = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mut mesh = EditableMesh::try_from(&TriMesh::try_new(positions, faces).unwrap()).unwrap();
        let half = mesh.connectivity().find(VertexId(4), VertexId(0)).unwrap();
        let edge = mesh.connectivity().edge(half);
        let at = mesh.positions()[4] * 0.75;
        let refusals = |mesh: &EditableMesh| {
            [
                mesh.clone().flip_edge(edge).err(),
                mesh.clone().split_edge(edge, at).err(),
                mesh.clone().split_face(FaceId(0), DVec3::new(1.0, 0.5 * height, 0.0)).err(),
                mesh.clone().collapse_half_edge(half).err(),
                mesh.clone().remove_vertex(VertexId(4), Hole::Triangles).err(),
                mesh.clone().remove_vertex(VertexId(4), Hole::Polygon).err(),
            ]
        };
        mesh.min_cosine = -2.0;
        assert!(refusals(&mesh)[1..].iter().all(Option::is_none), "{height}: {:?}", refusals(&mesh));
        mesh.min_cosine = f64::NAN;
        for (operator, refusal) in refusals(&mesh).into_iter().enumerate() {
            assert!(matches!(refusal, Some(Illegal::FoldsOver { .. })), "{height} {operator}: {refusal:?}");
        }
    }
}

#[test]
fn mixtures_and_columns_count_against_the_budget() {
    let refused = |mesh: &EditableMesh, bytes: usize| {
        let result = mesh.to_triangles(&Exec::default().with_memory(bytes as u64));
        matches!(result, Err(StructureError::OverBudget(_)))
    };
    let mut mixed = EditableMesh::try_from(&grid()).unwrap();
    let many: Mixture = (0..25).map(|source| (source, 0.04)).collect();
    mixed.mixed.fill(Some(many));
    assert_eq!(mixed.source_total(&Exec::default()).unwrap(), 25 * 25);
    let connectivity = mixed.connectivity().memory_bytes();
    assert!(refused(&mixed, 2 * connectivity + 25 * 25 * 12));
    let mut wide = grid();
    let values = Values::F64(vec![0.5; 25 * 100]);
    wide.insert_attribute(Domain::Vertex, Column::try_new("wide", 100, values).unwrap()).unwrap();
    let wide = EditableMesh::try_from(&wide).unwrap();
    assert!(refused(&wide, 2 * connectivity + 25 * 100 * 8));
    // Little more will do, and comes back.
    let exec = Exec::default().with_memory((3 * connectivity + 25 * 100 * 8 + 5000) as u64);
    assert!(wide.to_triangles(&exec).is_ok() && mixed.to_triangles(&exec).is_ok());
    assert_eq!(exec.memory_taken(), 0);
}
