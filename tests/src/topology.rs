//! The topology report on real files, against the facts that an independent program found.

use std::collections::BTreeMap;

use shapeloom::core::Exec;
use shapeloom::judge::{Measures, Topology};
use shapeloom::shape::{Geometry, Shape};

use crate::collection::{Facts, facts, read_file};

/// Files that the facts call not orientable, though their faces can be turned so that every edge with two faces is run
/// along in both directions: the facts took edges with three faces into account. The proof is a test below.
const NOT_SO: [&str; 1] = ["obj/triple_vierbein.obj"];

/// The reports on all meshes of a shape.
fn reports(shape: &Shape) -> Vec<(Topology, Measures)> {
    let exec = Exec::default();
    let one = |geometry: &Geometry| match geometry {
        Geometry::TriMesh(mesh) => Some((Topology::of(mesh, &exec), Measures::of(mesh, &exec))),
        Geometry::PolyMesh(mesh) => Some((Topology::of(mesh, &exec), Measures::of(mesh, &exec))),
        _ => None,
    };
    let judged = shape.parts.iter().filter_map(|part| one(&part.geometry));
    judged.map(|(topology, measures)| (topology.expect("memory enough"), measures.expect("finite numbers"))).collect()
}

/// The number right before or after a phrase in the facts.
fn number(words: &str, phrase: &str) -> Option<i64> {
    let at = words.find(phrase)?;
    let after = words[at + phrase.len()..].trim_start().split(|c: char| !c.is_ascii_digit() && c != '-').next();
    let before = words[..at].trim_end().rsplit(|c: char| !c.is_ascii_digit()).next();
    after.and_then(|digits| digits.parse().ok()).or_else(|| before?.parse().ok())
}

/// Compares every fact that the line has; returns how many it had and which are not so.
fn check(facts: &Facts) -> (usize, Vec<String>) {
    let name = facts.name();
    let reports = reports(&read_file(&facts.path).expect("a sound file").shape);
    let total = |count: fn(&(Topology, Measures)) -> usize| reports.iter().map(count).sum::<usize>() as i64;
    let all = |flag: fn(&Topology) -> bool| reports.iter().all(|(topology, _)| flag(topology));
    let words = facts.words.as_str();
    let (mut known, mut wrong) = (0, Vec::new());
    let mut same = |phrase: &str, found: i64, otherwise: Option<i64>| {
        let wanted = if words.contains(phrase) { number(words, phrase) } else { otherwise };
        if let Some(wanted) = wanted {
            known += 1;
            if found != wanted {
                wrong.push(format!("{name}: {phrase} {wanted}, found {found}"));
            }
        }
    };
    same("E=", total(|(topology, _)| topology.edges), None);
    same("chi=", reports.iter().map(|(topology, _)| topology.euler_characteristic()).sum(), None);
    same("comps=", total(|(topology, _)| topology.components.len()), None);
    // What the facts do not mention they found to be none.
    same("non-manifold edges", total(|(topology, _)| topology.non_manifold_edges.len()), Some(0));
    same("non-manifold vertices", total(|(topology, _)| topology.non_manifold_vertices.len()), Some(0));
    let border = total(|(topology, _)| topology.boundary.edges().len());
    match words.contains("open: ") {
        true => same("open: ", border, None),
        false => same("boundary edges", border, Some(0)),
    }
    if words.contains("loop(s)") {
        same("boundary edges in", total(|(topology, _)| topology.boundary.len()), None);
    }
    same(
        "genus(sum)=",
        reports.iter().map(|(topology, _)| topology.genus().map_or(-1000, |genus| genus as i64)).sum(),
        None,
    );
    same("duplicate faces", total(|(topology, _)| topology.duplicate_faces.len()), Some(0));
    same("faces with repeated vertex", total(|(topology, _)| topology.repeating_faces.len()), Some(0));
    same("unreferenced vertices", total(|(topology, _)| topology.isolated_vertices.len()), Some(0));
    // Of surfaces that cannot be oriented the facts do not tell how many edges are at fault.
    let oriented = (!words.contains("NON-orientable")).then_some(0);
    same("inconsistently oriented edges", total(|(topology, _)| topology.inconsistent_edges.len()), oriented);
    same("zero-area faces", total(|(_, measures)| measures.flat_faces.len()), None);
    same("duplicate positions", total(|(_, measures)| measures.coincident_vertices.len()), None);
    let crowded = ["non-manifold edges", "non-manifold vertices"].iter().any(|phrase| words.contains(phrase));
    let mut holds = |what: &str, found: bool, wanted: bool| {
        known += 1;
        if found != wanted {
            wrong.push(format!("{name}: {what} {wanted}, found {found}"));
        }
    };
    let wrong_line = NOT_SO.iter().any(|file| name.ends_with(file));
    holds("orientable", all(Topology::is_orientable), !words.contains("NON-orientable") || wrong_line);
    holds("manifold", all(Topology::is_manifold), !crowded);
    if words.contains("watertight") {
        holds("closed", all(Topology::is_closed), true);
    }
    (known, wrong)
}

#[test]
fn every_mesh_of_the_collection_has_its_known_topology() {
    let all = facts(&["off/", "obj/", "ply/", "stl/", "synthetic/", "subdiv-golden/"]);
    let checks: Vec<(usize, Vec<String>)> = all.iter().map(check).collect();
    let known: usize = checks.iter().map(|(known, _)| known).sum();
    let wrong: Vec<String> = checks.into_iter().flat_map(|(_, wrong)| wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // Where the collection is there, no file and no fact may fall away.
    assert!(all.is_empty() || (all.len() >= 77 && known >= 700), "{} files, {known} facts", all.len());
}

/// Turns faces over by flooding across edges with two faces, then looks at each such edge.
#[test]
fn what_is_called_not_orientable_against_the_facts_can_be_oriented() {
    for file in facts(&NOT_SO) {
        let shape = read_file(&file.path).expect("a sound file").shape;
        let mut faces: Vec<Vec<u32>> = match &*shape.parts[0].geometry {
            Geometry::TriMesh(mesh) => mesh.triangles().iter().map(|face| face.to_vec()).collect(),
            Geometry::PolyMesh(mesh) => mesh.faces().map(<[u32]>::to_vec).collect(),
            other => panic!("{}", other.kind()),
        };
        assert_eq!((shape.parts.len(), faces.len()), (1, file.faces));
        let uses = |faces: &[Vec<u32>]| {
            let mut uses: BTreeMap<[u32; 2], Vec<(usize, bool)>> = BTreeMap::new();
            for (face, cycle) in faces.iter().enumerate() {
                for (k, &a) in cycle.iter().enumerate() {
                    let b = cycle[(k + 1) % cycle.len()];
                    uses.entry([a.min(b), a.max(b)]).or_default().push((face, a < b));
                }
            }
            uses.into_values().filter(|uses| uses.len() == 2).collect::<Vec<_>>()
        };
        let pairs = uses(&faces);
        let mut turned: Vec<Option<bool>> = vec![None; faces.len()];
        for start in 0..faces.len() {
            let mut open = if turned[start].is_none() { vec![(start, false)] } else { Vec::new() };
            while let Some((face, turn)) = open.pop() {
                if turned[face].is_some() {
                    continue;
                }
                turned[face] = Some(turn);
                for pair in &pairs {
                    for [one, other] in [[pair[0], pair[1]], [pair[1], pair[0]]] {
                        if one.0 == face {
                            open.push((other.0, turn ^ (one.1 == other.1)));
                        }
                    }
                }
            }
        }
        for (face, turned) in faces.iter_mut().zip(turned) {
            if turned == Some(true) {
                face.reverse();
            }
        }
        assert!(uses(&faces).iter().all(|pair| pair[0].1 != pair[1].1), "{}", file.name());
    }
}
