//! Editable half-edges against lists of faces: what is legal is decided there by definition, by making the change and
//! looking.

use std::collections::{BTreeMap, BTreeSet};

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::judge::Topology;
use shapeloom::mesh::primitives::{Grid, Platonic, Solid, Torus};
use shapeloom::mesh::structures::{
    EdgeId, FaceId, HalfEdgeId, HalfEdgeMesh, Hole, Illegal, Incidence, IndexedPolygons, IndexedTriangles, LocalUpdate,
    Query, StructureError, StructureKind, Update, VertexId,
};
use shapeloom::mesh::{PolyMesh, TriangulatePolygons};
use shapeloom::shape::Geometry;

use crate::collection::read_file;
use crate::face_list_operators::{
    Faces, collapsed, cut, flipped, joined, removed, same_faces, sides, surface, unordered,
};
use crate::support::{Dice, shared_data};

fn faces_of(mesh: &HalfEdgeMesh) -> Faces {
    let polygons = IndexedPolygons::from(mesh);
    polygons.starts().windows(2).map(|w| polygons.corners()[w[0] as usize..w[1] as usize].to_vec()).collect()
}

fn build(faces: &Faces) -> Result<HalfEdgeMesh, StructureError> {
    let vertices = faces.iter().flatten().max().map_or(0, |&last| last + 1);
    HalfEdgeMesh::try_from(&IndexedPolygons::from_faces(vertices, faces).expect("faces"))
}

/// How often operators were done and refused.
#[derive(Default, Debug)]
struct Tally {
    done: BTreeMap<&'static str, u32>,
    refused: BTreeMap<String, u32>,
}

impl Tally {
    /// Holds what an operator did against what the list of faces says.
    fn hold<T>(
        &mut self,
        what: &'static str,
        source: &HalfEdgeMesh,
        truth: Option<Faces>,
        exact: bool,
        operate: impl FnOnce(&mut HalfEdgeMesh) -> Result<T, Illegal>,
    ) {
        let mut mesh = source.clone();
        match operate(&mut mesh) {
            Ok(_) => {
                *self.done.entry(what).or_default() += 1;
                let truth =
                    truth.unwrap_or_else(|| panic!("{what} was done: {:?} to {:?}", faces_of(source), faces_of(&mesh)));
                assert_eq!(mesh.validate(), [], "{what}: {:?}", faces_of(source));
                let found = faces_of(&mesh);
                assert!(
                    !exact || same_faces(&found, &truth),
                    "{what}: {:?}: {found:?}, not {truth:?}",
                    faces_of(source)
                );
                assert_eq!(surface(&found), surface(&truth), "{what}: {:?} to {found:?}", faces_of(source));
                assert_eq!(found.len(), truth.len());
            }
            Err(illegal) => {
                let name = format!("{illegal:?}").split([' ', '{']).next().unwrap_or_default().to_owned();
                *self.refused.entry(format!("{what}: {name}")).or_default() += 1;
                assert!(truth.is_none(), "{what}: {illegal:?} of {:?}", faces_of(source));
                assert!(mesh == *source, "{what}: refused, and changed");
            }
        }
    }

    /// Every operator at every element.
    fn try_all(&mut self, faces: &Faces) {
        let mesh = build(faces).unwrap_or_else(|error| panic!("{error}: {faces:?}"));
        assert_eq!(mesh.validate(), [], "{faces:?}");
        assert_eq!(&faces_of(&mesh), faces);
        for edge in mesh.live_edges() {
            let ends = unordered(mesh.ends(edge).map(|vertex| vertex.0));
            self.hold("flip", &mesh, flipped(faces, ends), true, |mesh| mesh.flip_edge(edge));
            self.hold("join", &mesh, joined(faces, ends), true, |mesh| mesh.join_faces(edge));
            for half in mesh.halves(edge) {
                let truth = collapsed(faces, mesh.origin(half).0, mesh.target(half).0);
                self.hold("collapse", &mesh, truth, true, |mesh| mesh.collapse_half_edge(half));
            }
            let mut split = mesh.clone();
            split.split_edge(edge).expect("always legal");
            assert_eq!(split.validate(), []);
            assert_eq!(surface(&faces_of(&split)), surface(faces), "{faces:?}");
        }
        for vertex in mesh.live_vertices().filter(|&vertex| mesh.leaving(vertex).is_some()) {
            for hole in [Hole::Polygon, Hole::Triangles] {
                let truth = removed(faces, vertex.0, hole);
                let exact = hole == Hole::Polygon;
                self.hold("remove", &mesh, truth, exact, |mesh| mesh.remove_vertex(vertex, hole));
            }
        }
        for (index, face) in faces.iter().enumerate() {
            let around: Vec<HalfEdgeId> = mesh.around_face(FaceId(index as u32)).collect();
            for i in 0..face.len() {
                for j in i + 1..face.len() {
                    let truth = cut(faces, index, i, j);
                    self.hold("cut", &mesh, truth, true, |mesh| mesh.cut_face(around[i], around[j]));
                }
            }
            let id = FaceId(index as u32);
            let mut split = mesh.clone();
            let vertex = split.split_face(id).expect("always legal");
            assert_eq!(split.validate(), []);
            assert_eq!(surface(&faces_of(&split)), surface(faces), "{faces:?}");
            // The inverse gives back the very faces, but for where they start.
            split.remove_vertex(vertex, Hole::Polygon).expect("there was a face before");
            assert!(same_faces(&faces_of(&split), faces));
        }
    }
}

/// Surfaces glued at random from triangles and some larger polygons on few vertices.
fn random_surface(dice: &mut Dice) -> Faces {
    let vertices = 4 + dice.next() % 6;
    let polygons = dice.next().is_multiple_of(2);
    let mut faces = Faces::new();
    let mut taken: BTreeSet<[u32; 2]> = BTreeSet::new();
    let wanted = 1 + dice.next() % (2 * vertices);
    for _ in 0..60 {
        if faces.len() as u64 == wanted {
            break;
        }
        let corners = if polygons { 3 + dice.next() % 4 } else { 3 };
        let mut face: Vec<u32> = Vec::new();
        // Next to a face that is there, so that surfaces are large rather than many.
        if let Some(&[a, b]) = taken.iter().nth((dice.next() % (taken.len() as u64 + 1)) as usize) {
            face.extend([b, a]);
        }
        while (face.len() as u64) < corners {
            let next = (dice.next() % vertices) as u32;
            if face.contains(&next) {
                break;
            }
            face.push(next);
        }
        if face.len() < 3 || sides(&face).any(|side| taken.contains(&side)) {
            continue;
        }
        taken.extend(sides(&face));
        faces.push(face);
    }
    // What does not make a surface goes, the last first.
    while surface(&faces).is_none() && !faces.is_empty() {
        faces.pop();
    }
    faces
}

fn known_surfaces() -> Vec<Faces> {
    let platonic = |solid| {
        let mesh = Platonic::new(solid).mesh(&Exec::default()).expect("a solid").value;
        mesh.faces().map(<[u32]>::to_vec).collect::<Faces>()
    };
    let prism = |n: u32| -> Faces {
        let side = |i: u32| vec![i, (i + 1) % n, n + (i + 1) % n, n + i];
        let ends = [(0..n).rev().collect(), (n..2 * n).collect()];
        (0..n).map(side).chain(ends).collect()
    };
    // Every two of the seven vertices are joined (Moebius 1861): nothing can be removed, flipped or collapsed.
    let torus = (0..7).flat_map(|i| [vec![i, (i + 1) % 7, (i + 3) % 7], vec![i, (i + 3) % 7, (i + 2) % 7]]).collect();
    let annulus = |n: u32| -> Faces { prism(n)[..n as usize].to_vec() };
    let pyramid =
        |n: u32| -> Faces { (0..n).map(|i| vec![i, (i + 1) % n, n]).chain([(0..n).rev().collect()]).collect() };
    vec![
        platonic(Solid::Tetrahedron),
        platonic(Solid::Octahedron),
        platonic(Solid::Icosahedron),
        platonic(Solid::Cube),
        prism(3),
        prism(5),
        annulus(3),
        annulus(4),
        pyramid(4),
        pyramid(6),
        torus,
        vec![vec![0, 1, 2]],
        vec![vec![0, 1, 2, 3]],
        vec![vec![0, 1, 2], vec![0, 2, 3]],
        vec![vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 4]],
    ]
}

#[test]
fn operators_are_refused_exactly_where_lists_of_faces_say_so() {
    let mut tally = Tally::default();
    for faces in known_surfaces() {
        assert!(surface(&faces).is_some(), "{faces:?}");
        tally.try_all(&faces);
    }
    let mut dice = Dice(1);
    let mut tried = BTreeSet::new();
    while tried.len() < 4000 {
        let faces = random_surface(&mut dice);
        if tried.insert(faces.clone()) {
            tally.try_all(&faces);
        }
    }
    for what in ["flip", "join", "collapse", "remove", "cut"] {
        assert!(tally.done[what] > 1000, "{tally:?}");
    }
    let reasons = [
        "flip: BorderEdge",
        "flip: NotTriangle",
        "flip: DuplicateEdge",
        "collapse: LinkCondition",
        "collapse: SharedFace",
        "collapse: ClosesBorder",
        "collapse: PinchesBorder",
        "collapse: DuplicateFace",
        "remove: RepeatedCorner",
        "remove: DuplicateEdge",
        "remove: DuplicateFace",
        "remove: NoTriangulation",
        "remove: ValenceTooLow",
        "join: RepeatedCorner",
        "join: DuplicateFace",
        "cut: NotApart",
        "cut: DuplicateEdge",
    ];
    for reason in reasons {
        assert!(tally.refused.contains_key(reason), "{reason}: {tally:?}");
    }
}

/// The judge's report of the faces, with positions that mean nothing.
fn judged(mesh: &HalfEdgeMesh) -> Topology {
    let faces = IndexedPolygons::from(mesh);
    let positions = vec![DVec3::ZERO; mesh.vertex_slots()];
    let mesh = PolyMesh::try_new(positions, faces.starts().to_vec(), faces.corners().to_vec()).expect("a mesh");
    Topology::of(&mesh, &Exec::default()).expect("a report")
}

fn triangles(mesh: &PolyMesh) -> PolyMesh {
    let mesh = TriangulatePolygons::new().convert(mesh).expect("a sound mesh").value;
    PolyMesh::from_faces(mesh.positions().to_vec(), mesh.triangles()).expect("triangles")
}

fn half_edges(mesh: &PolyMesh) -> HalfEdgeMesh {
    HalfEdgeMesh::try_from(&IndexedPolygons::from(mesh)).expect("a manifold mesh")
}

/// One operator at a place, by chance.
fn any_operator(mesh: &mut HalfEdgeMesh, dice: &mut Dice, grows: bool) -> (&'static str, Result<(), Illegal>) {
    let mut below = |count: usize| (dice.next() % count.max(1) as u64) as u32;
    let edge = EdgeId(below(mesh.edge_slots()));
    let half = HalfEdgeId(below(2 * mesh.edge_slots()));
    let vertex = VertexId(below(mesh.vertex_slots()));
    let face = FaceId(below(mesh.face_slots()));
    let hole = if below(2) == 0 { Hole::Polygon } else { Hole::Triangles };
    let other =
        if mesh.has_half_edge(half) { mesh.around_loop(half).nth(2 + below(3) as usize).unwrap_or(half) } else { half };
    match below(10) {
        0 | 1 => ("flip", mesh.flip_edge(edge)),
        2 if grows => ("split edge", mesh.split_edge(edge).map(drop)),
        3 if grows => ("split face", mesh.split_face(face).map(drop)),
        4 if grows => ("insert", mesh.insert_on_edge(edge).map(drop)),
        5 => ("cut", mesh.cut_face(half, other).map(drop)),
        6 => ("join", mesh.join_faces(edge).map(drop)),
        7 => ("triangulate", mesh.triangulate_face(face)),
        8 => ("remove", mesh.remove_vertex(vertex, hole).map(drop)),
        _ => ("collapse", mesh.collapse_half_edge(half).map(drop)),
    }
}

/// Operators by chance until so many were legal; the counts of each kind.
fn wander(mesh: &mut HalfEdgeMesh, dice: &mut Dice, legal: u32, size: u32, every: u32) -> BTreeMap<&'static str, u32> {
    let wanted = judged(mesh);
    let kind = |topology: &Topology| {
        let mut all: Vec<_> = topology.components.iter().map(|c| (c.euler_characteristic, c.boundary_loops)).collect();
        all.sort_unstable();
        all
    };
    let mut done = BTreeMap::new();
    let mut count = 0;
    while count < legal {
        let grows = mesh.counts().faces < size;
        let before = if every == 1 { Some(mesh.clone()) } else { None };
        let (what, result) = any_operator(mesh, dice, grows);
        match result {
            Ok(()) => {
                *done.entry(what).or_default() += 1;
                count += 1;
                if count % every == 0 {
                    assert_eq!(mesh.validate(), [], "{what}");
                }
                if count % (100 * every) == 0 {
                    let found = judged(mesh);
                    assert!(found.is_manifold() && found.is_oriented() && found.repeating_faces.is_empty(), "{what}");
                    assert_eq!(kind(&found), kind(&wanted));
                    let counts = mesh.counts();
                    assert_eq!((found.faces, found.edges), (counts.faces as usize, counts.edges as usize));
                    assert_eq!(found.boundary.len(), mesh.border_loops().len());
                }
            }
            Err(_) => assert!(before.is_none_or(|before| before == *mesh), "{what}: refused, and changed"),
        }
        if mesh.edge_slots() as u32 > 8 * (mesh.counts().edges + 20) {
            mesh.compact();
        }
    }
    done
}

#[test]
fn ten_thousand_operators_keep_structure_and_topology() {
    let exec = Exec::default();
    let solid = |solid| Platonic::new(solid).mesh(&exec).expect("a solid").value;
    let torus = Torus { segments: 7, sides: 5, ..Torus::new() }.mesh(&exec).expect("a torus").value;
    let grid = Grid { columns: 5, rows: 4, ..Grid::new() }.mesh(&exec).expect("a grid").value;
    // A strip closed to a ring has two borders.
    let ring: Vec<[u32; 4]> = (0..6).map(|i| [i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i]).collect();
    let ring = PolyMesh::from_faces(vec![DVec3::ZERO; 12], &ring).expect("a ring");
    let sources = [
        solid(Solid::Icosahedron),
        solid(Solid::Dodecahedron),
        torus.clone(),
        triangles(&torus),
        grid.clone(),
        triangles(&grid),
        ring,
    ];
    let mut dice = Dice(11);
    let mut done: BTreeMap<&str, u32> = BTreeMap::new();
    for source in &sources {
        let mut mesh = half_edges(source);
        for (what, count) in wander(&mut mesh, &mut dice, 1500, 60, 1) {
            *done.entry(what).or_default() += count;
        }
    }
    assert!(done.values().sum::<u32>() >= 10_000 && done.len() == 9, "{done:?}");
    assert!(done.values().all(|&count| count > 100), "{done:?}");
    // A larger one, looked at now and then.
    let torus = Torus { segments: 40, sides: 30, ..Torus::new() }.mesh(&exec).expect("a torus").value;
    wander(&mut half_edges(&triangles(&torus)), &mut dice, 10_000, 2500, 100);
}

/// All nine answers, for each vertex, edge (by its vertices) and face.
fn answers(structure: &dyn Incidence) -> BTreeMap<(Query, Vec<u32>), Vec<Vec<u32>>> {
    let ends = |edge: u32| {
        let mut ends = structure.answer(Query::EV, edge).expect("vertices");
        ends.sort_unstable();
        ends
    };
    let edges: Vec<u32> = structure.edges().expect("edges").iter().map(|edge| edge.0).collect();
    let mut all = BTreeMap::new();
    for query in Query::ALL {
        let (of, wanted) = query.name().split_at(1);
        let elements: Vec<u32> = match of {
            "V" => (0..structure.vertex_count() as u32).collect(),
            "E" => edges.clone(),
            _ => (0..structure.face_count() as u32).collect(),
        };
        for element in elements {
            let name = if of == "E" { ends(element) } else { vec![element] };
            let found = structure.answer(query, element).expect("an answer");
            let mut found: Vec<Vec<u32>> =
                found.into_iter().map(|e| if wanted == "E" { ends(e) } else { vec![e] }).collect();
            if query != Query::FV {
                found.sort();
            }
            all.insert((query, name), found);
        }
    }
    all
}

#[test]
fn the_nine_queries_are_answered_as_by_looking_at_all_faces() {
    let mut dice = Dice(4);
    let mut sources = known_surfaces();
    sources.extend((0..300).map(|_| random_surface(&mut dice)).filter(|faces| !faces.is_empty()));
    for faces in sources {
        let vertices = faces.iter().flatten().max().map_or(0, |&last| last + 3);
        let polygons = IndexedPolygons::from_faces(vertices, &faces).expect("faces");
        let mesh = StructureKind::HalfEdgeMesh.build(&polygons, &Exec::default()).expect("a manifold mesh");
        assert_eq!(answers(&*mesh), answers(&polygons), "{faces:?}");
    }
}

#[test]
fn lists_and_half_edges_allow_the_same_updates_and_come_to_the_same_faces() {
    let exec = Exec::default();
    let torus = Torus { segments: 5, sides: 4, ..Torus::new() }.mesh(&exec).expect("a torus").value;
    let grid = Grid { columns: 4, rows: 3, ..Grid::new() }.mesh(&exec).expect("a grid").value;
    let mut dice = Dice(8);
    let mut counts = [[0; 2]; 3];
    let mut sources = vec![triangles(&torus), triangles(&grid)];
    for faces in known_surfaces() {
        if faces.iter().all(|face| face.len() == 3) {
            sources.push(PolyMesh::from_faces(vec![DVec3::ZERO; 20], &faces).expect("triangles"));
        }
    }
    for source in &sources {
        let polygons = IndexedPolygons::from(source);
        let mut list = IndexedTriangles::try_from(&polygons).expect("triangles");
        let mut mesh = HalfEdgeMesh::try_from(&polygons).expect("a manifold mesh");
        for _ in 0..600 {
            let vertices = list.vertex_count() as u64;
            let edge = [dice.next(), dice.next()].map(|roll| VertexId((roll % vertices) as u32));
            // Mostly edges that are there.
            let count = u64::from(mesh.counts().edges.max(1));
            let edge = match mesh.live_edges().nth((dice.next() % count) as usize) {
                Some(there) if !dice.next().is_multiple_of(4) => mesh.ends(there),
                _ => edge,
            };
            let which = (dice.next() % if vertices < 60 { 3 } else { 2 }) as usize;
            let update = [Update::FlipEdge, Update::CollapseEdge, Update::SplitEdge][which];
            let [one, other] = [&mut list as &mut dyn LocalUpdate, &mut mesh].map(|structure| match update {
                Update::FlipEdge => structure.flip(edge).map(|()| None),
                Update::CollapseEdge => structure.collapse(edge).map(|()| None),
                Update::SplitEdge => structure.split(edge).map(Some),
            });
            let reason = |result: &Result<Option<VertexId>, Illegal>| result.map_err(|e| std::mem::discriminant(&e));
            assert_eq!(reason(&one), reason(&other), "{update} of {edge:?}: {one:?} {other:?}");
            counts[which][usize::from(one.is_ok())] += 1;
            let triangles: Faces = list.triangles().iter().map(|triangle| triangle.to_vec()).collect();
            assert!(same_faces(&triangles, &faces_of(&mesh)), "{update} of {edge:?}");
        }
    }
    assert!(counts.as_flattened().iter().all(|&count| count > 100), "{counts:?}");
    for kind in StructureKind::ALL {
        for update in Update::ALL {
            let faces = IndexedPolygons::from(&sources[0]);
            let built = kind.build_for_updates(&faces, &exec).expect("a manifold mesh of triangles");
            let answered = kind.update_cost(update) != shapeloom::mesh::structures::Cost::Unanswered;
            assert_eq!(built.is_some(), answered, "{kind}: {update}");
        }
    }
}

#[test]
fn a_klein_bottle_is_refused_at_an_edge_that_shows_it() {
    // Cells of which the last column is glued to the first with a turn.
    let (m, n) = (6, 5);
    let id = |i: u32, j: u32| if i == m { (n - j) % n } else { i * n + j % n };
    let cells: Vec<[u32; 4]> =
        (0..m).flat_map(|i| (0..n).map(move |j| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)])).collect();
    let faces = IndexedPolygons::from_faces(m * n, &cells).expect("cells");
    let error = HalfEdgeMesh::try_from(&faces).expect_err("one-sided");
    let StructureError::Orientation { vertices: [a, b], faces: [f, g], count } = error else { panic!("{error}") };
    assert_eq!(count, n as usize);
    for face in [f, g] {
        let face = &cells[face as usize];
        assert_eq!(sides(face).filter(|&side| side == [a, b] || side == [b, a]).count(), 1);
    }
    let passes = |face: u32, side: [u32; 2]| sides(&cells[face as usize]).any(|other| other == side);
    assert!(passes(f, [a, b]) == passes(g, [a, b]), "both pass it in the same direction");
}

#[test]
fn very_large_faces_and_fans_are_taken() {
    let polygon: Vec<u32> = (0..20_000).collect();
    let mut mesh = build(&vec![polygon]).expect("one face");
    assert_eq!(mesh.border_loops().len(), 1);
    assert_eq!(mesh.answer(Query::FF, 0), Ok(vec![]));
    mesh.triangulate_face(FaceId(0)).expect("a fan");
    assert_eq!((mesh.validate(), mesh.counts().faces), (vec![], 19_998));
    // A wheel of 5000 spokes, and two caps on one ring: every edge of it has the same neighbour twice.
    let n = 5000;
    let wheel: Faces = (0..n).map(|i| vec![i, (i + 1) % n, n]).collect();
    let caps: Faces = (0..n).map(|i| vec![(i + 1) % n, i, n + 1]).collect();
    let mut mesh = build(&[wheel, caps].concat()).expect("a closed surface");
    assert_eq!(mesh.valence(VertexId(n)), 5000);
    assert_eq!(mesh.answer(Query::VF, n).map(|faces| faces.len()), Ok(5000));
    let rim = mesh.find(VertexId(0), VertexId(1)).expect("an edge");
    mesh.collapse_half_edge(rim).expect("a ring of thousands");
    let spoke = mesh.find(VertexId(n), VertexId(9)).expect("an edge");
    assert!(mesh.can_flip(mesh.edge(spoke)).is_ok());
    assert_eq!(mesh.can_flip(mesh.edge(mesh.find(VertexId(8), VertexId(9)).expect("an edge"))), Ok(()));
    assert!(mesh.can_remove_vertex(VertexId(n), Hole::Triangles).is_ok());
    mesh.collapse_half_edge(spoke).expect("a hub may go into its ring");
    assert_eq!((mesh.validate(), mesh.counts().euler_characteristic()), (vec![], 2));
}

#[test]
fn every_mesh_of_the_collection_is_held_exactly_or_refused_rightly() {
    let (mut held, mut refused) = (0, BTreeMap::<&str, u32>::new());
    let mut folders: Vec<_> = ["mesh", "off", "obj", "ply", "stl", "synthetic", "malformed", "gltf"]
        .iter()
        .filter_map(|folder| shared_data(folder))
        .collect();
    let there = !folders.is_empty();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let large = path.metadata().is_ok_and(|data| data.len() > 4 << 20);
            let known = path.extension().is_some_and(|ending| {
                ["off", "obj", "ply", "stl", "glb", "gltf"].iter().any(|known| ending.eq_ignore_ascii_case(known))
            });
            if large || !known {
                continue;
            }
            let Ok(read) = read_file(&path) else { continue };
            for part in &read.shape.parts {
                let faces = match &*part.geometry {
                    Geometry::TriMesh(mesh) => IndexedPolygons::from(&IndexedTriangles::from(mesh)),
                    Geometry::PolyMesh(mesh) => IndexedPolygons::from(mesh),
                    _ => continue,
                };
                let positions = vec![DVec3::ZERO; faces.vertex_count()];
                let mesh = PolyMesh::try_new(positions, faces.starts().to_vec(), faces.corners().to_vec());
                let report = Topology::of(&mesh.expect("a mesh"), &Exec::default()).expect("a report");
                let name = path.display();
                match HalfEdgeMesh::try_from(&faces) {
                    Ok(mesh) => {
                        held += 1;
                        assert_eq!(mesh.validate(), [], "{name}");
                        assert_eq!(IndexedPolygons::from(&mesh), faces, "{name}");
                        assert!(report.is_manifold() && report.inconsistent_edges.is_empty(), "{name}");
                        assert_eq!(report.boundary.len(), mesh.border_loops().len(), "{name}");
                    }
                    Err(StructureError::RepeatedCorner { count, .. }) => {
                        *refused.entry("corner").or_default() += 1;
                        assert_eq!(count, report.repeating_faces.len(), "{name}");
                    }
                    Err(StructureError::NonManifoldEdge { count, .. }) => {
                        *refused.entry("edge").or_default() += 1;
                        assert_eq!(count, report.non_manifold_edges.len(), "{name}");
                    }
                    Err(StructureError::Orientation { count, .. }) => {
                        *refused.entry("orientation").or_default() += 1;
                        assert_eq!(count, report.inconsistent_edges.len(), "{name}");
                    }
                    Err(StructureError::NonManifoldVertex { count, vertex, .. }) => {
                        *refused.entry("vertex").or_default() += 1;
                        assert_eq!(
                            (count, Some(&vertex)),
                            (report.non_manifold_vertices.len(), report.non_manifold_vertices.first())
                        );
                    }
                    Err(error) => panic!("{name}: {error}"),
                }
            }
        }
    }
    assert!(!there || (held > 50 && refused.len() >= 3), "{held} {refused:?}");
}
