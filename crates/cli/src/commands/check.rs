//! `check`: whether a shape is sound for a purpose.

use std::sync::Arc;

use serde_json::{Map, Value, json};
use shapeloom_convert::{Job, convert_shape, plan};
use shapeloom_core::{Category, ChoiceOption, Convert, Exec, Findings, Place};
use shapeloom_judge::{Measures, MeshRef, NotPolyhedron, PairKind, Profile, Verdict};
use shapeloom_mesh::{MeshOrigins, Origins, PolyMesh, TriMesh, Weld, carry};
use shapeloom_shape::{Geometry, Kind, Shape};

use super::convert::{absolute, wish};
use crate::account;
use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::soundness::{Soundness, witnesses};

pub(crate) fn run(arguments: &CheckArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let tolerance = arguments.way.tolerance()?;
    let settings = Settings::sort(&arguments.way.settings);
    settings.no_writing()?;
    let profile = Profile::from_name(&arguments.profile).unwrap_or(Profile::General);
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    let wish = wish(&arguments.way, &[Kind::TriMesh])?;
    let tolerance = absolute(tolerance, &input.read.shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.converting(input.format) };
    session.stage("checking");
    let mut words = Vec::new();
    let subjects = subjects(&input.read.shape, &job, arguments, &session.exec(), &mut words)?;
    if subjects.is_empty() {
        let kinds: Vec<&str> = input.read.shape.kinds().into_iter().map(Kind::name).collect();
        let found = if kinds.is_empty() { "nothing".to_owned() } else { kinds.join(", ") };
        return Err(Failure::Own {
            code: "E-check-kind",
            category: Category::Unsupported,
            message: format!("check: found {found}, expected something with a surface"),
            advice: None,
        });
    }
    let (mut parts, mut sound) = (Vec::new(), true);
    for subject in &subjects {
        let exec = session.exec();
        let judged = match &*subject.mesh {
            Geometry::TriMesh(mesh) => judged(mesh, profile, &exec),
            Geometry::PolyMesh(mesh) => judged(mesh, profile, &exec),
            _ => continue,
        };
        let (verdict, mut object) = judged.map_err(|failure| failure.about(&arguments.input))?;
        sound &= verdict.findings.is_empty();
        object.extend(subject.keys.clone());
        words.extend(subject.remarks.iter().map(|remark| format!("{}: {remark}", subject.named)));
        for finding in &verdict.findings {
            words.push(format!("{}: {}", subject.named, told(finding, session.globals.verbose)));
        }
        parts.push(Value::Object(object));
    }
    if session.globals.json {
        session.print_json(&json!({
            "schema": "shapeloom.check/1",
            "file": input.name,
            "format": input.format.id,
            "profile": profile.name(),
            "rules": profile.rules().map(|rule| json!({ "code": rule.code, "wants": rule.wants })).collect::<Vec<_>>(),
            "sound": sound,
            "parts": parts,
        }))?;
    } else {
        let outcome = if sound { "is sound" } else { "is not sound" };
        words.push(format!("{}: {outcome} by the profile {}", input.name, profile.name()));
        session.print(words.join("\n"))?;
    }
    if sound { Ok(()) } else { Err(Failure::Found) }
}

/// A mesh to be judged.
struct Subject {
    named: String,
    keys: Map<String, Value>,
    mesh: Arc<Geometry>,
    /// What was done to it.
    remarks: Vec<String>,
}

/// The parts that have faces, or all of them as one; what has none is said.
fn subjects(
    shape: &Shape,
    job: &Job,
    arguments: &CheckArguments,
    exec: &Exec,
    words: &mut Vec<String>,
) -> Result<Vec<Subject>, Failure> {
    let mut found = Vec::new();
    for (index, part) in shape.parts.iter().enumerate() {
        let named = match part.name.is_empty() {
            true => format!("part {index}"),
            false => format!("part {index} \"{}\"", part.name),
        };
        let kind = part.geometry.kind();
        let Some((mesh, remark)) = meshed(shape, index, job, exec)? else {
            words.push(format!("{named}: a {kind} has no faces, and was not checked"));
            continue;
        };
        let keys = [("part", json!(index)), ("name", json!(part.name)), ("kind", json!(kind.name()))];
        let keys = keys.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
        found.push(Subject { named, keys, mesh, remarks: remark.into_iter().collect() });
    }
    if arguments.together && found.len() > 1 {
        let named = format!("{} parts together", found.len());
        let keys = Map::from_iter([("together".to_owned(), json!(found.len()))]);
        let mesh = Arc::new(joined(&found, exec)?);
        let remarks = found.iter().flat_map(|one| one.remarks.iter().map(|remark| format!("{}: {remark}", one.named)));
        let remarks = remarks.collect();
        found = vec![Subject { named, keys, mesh, remarks }];
    }
    if arguments.weld {
        for subject in &mut found {
            let merged = weld(subject, exec)?;
            subject.remarks.push(format!("{merged} vertices were merged with others at the same position"));
        }
    }
    Ok(found)
}

/// One mesh of all, numbered on from one to the next.
fn joined(subjects: &[Subject], exec: &Exec) -> Result<Geometry, Failure> {
    let bytes: u64 = subjects.iter().map(|subject| subject.mesh.memory_bytes() as u64).sum();
    let _memory = exec.reserve(2 * bytes)?;
    let (mut positions, mut starts, mut corners) = (Vec::new(), vec![0], Vec::new());
    for subject in subjects {
        let first = positions.len() as u32;
        let mut add = |face: &[u32]| {
            corners.extend(face.iter().map(|corner| first.wrapping_add(*corner)));
            starts.push(corners.len() as u32);
        };
        match &*subject.mesh {
            Geometry::TriMesh(mesh) => {
                mesh.triangles().iter().for_each(|face| add(face));
                positions.extend_from_slice(mesh.positions());
            }
            Geometry::PolyMesh(mesh) => {
                mesh.faces().for_each(add);
                positions.extend_from_slice(mesh.positions());
            }
            _ => {}
        }
    }
    // More corners than numbers are refused here.
    let polygons = PolyMesh::try_new(positions, starts, corners)?;
    Ok(match TriMesh::try_from(polygons.clone()) {
        Ok(triangles) => triangles.into(),
        Err(_) => polygons.into(),
    })
}

/// Merges vertices at the same position, and returns how many went. Polygons stay polygons.
fn weld(subject: &mut Subject, exec: &Exec) -> Result<usize, Failure> {
    let (merged, welded): (usize, Geometry) = match &*subject.mesh {
        Geometry::TriMesh(mesh) => {
            let welded = Weld::new().convert_with(mesh, exec)?.value;
            (mesh.positions().len() - welded.positions().len(), welded.into())
        }
        Geometry::PolyMesh(mesh) => {
            let _memory = exec.reserve(mesh.memory_bytes() as u64)?;
            let doubled = Measures::of(mesh, exec)?.coincident_vertices;
            let mut number: Vec<u32> = (0..mesh.positions().len() as u32).collect();
            doubled.iter().for_each(|&[first, later]| number[later as usize] = first);
            let kept: Vec<u32> = (0..number.len() as u32).filter(|&vertex| number[vertex as usize] == vertex).collect();
            let place = |vertex: u32| kept.partition_point(|&kept| kept < number[vertex as usize]) as u32;
            let corners = mesh.wedge_vertices().iter().map(|&vertex| place(vertex)).collect();
            let positions = kept.iter().map(|&vertex| mesh.positions()[vertex as usize]).collect();
            let origins = MeshOrigins { vertex: Origins::Copies(kept), face: Origins::Same, wedge: Origins::Same };
            let (attributes, _) = carry(mesh.attributes(), &origins);
            let welded = PolyMesh::with_attributes(positions, mesh.face_starts().to_vec(), corners, attributes)?;
            (doubled.len(), welded.into())
        }
        _ => return Ok(0),
    };
    subject.mesh = Arc::new(welded);
    Ok(merged)
}

/// A part as a mesh where it is placed, and what was done to it for that; none where it has no faces.
type Meshed = (Arc<Geometry>, Option<String>);

fn meshed(shape: &Shape, index: usize, job: &Job, exec: &Exec) -> Result<Option<Meshed>, Failure> {
    let part = &shape.parts[index];
    match part.geometry.kind() {
        Kind::TriMesh | Kind::PolyMesh => Ok(Some((part.placed(), None))),
        kind if plan(kind, &job.wish).is_err() => Ok(None),
        kind => {
            let alone = Shape { parts: vec![part.clone()], ..shape.clone() };
            let conversion = convert_shape(&alone, job, exec)?;
            let remark = format!("the {kind} is judged as triangles, error {}", conversion.deviation);
            Ok(conversion.shape.parts.first().map(|part| (part.placed(), Some(remark))))
        }
    }
}

fn judged<'a>(
    mesh: impl Into<MeshRef<'a>>,
    profile: Profile,
    exec: &Exec,
) -> Result<(Verdict, Map<String, Value>), Failure> {
    let mesh = mesh.into();
    let verdict = Verdict::of(mesh, profile, exec)?;
    let mut object = Map::new();
    Soundness::new(&verdict.topology, Some(&verdict.measures)).tell(&mut object);
    let pairs = &verdict.self_intersections;
    let kinds = PairKind::ALL.map(|kind| (kind.name().replace(' ', "_"), json!(pairs.count(kind))));
    object.insert(
        "self_intersections".into(),
        json!({
            "crossing": pairs.crossing.total,
            "overlapping": pairs.overlapping.total,
            "touching": pairs.touching.total,
            "kinds": kinds.into_iter().collect::<Map<_, _>>(),
        }),
    );
    object.insert("shells".into(), json!(verdict.shells.len()));
    object.insert(
        "polyhedron".into(),
        match verdict.polyhedron() {
            Ok(()) => json!({ "is": true }),
            Err(why) => json!({ "is": false, "why": why_not(why) }),
        },
    );
    object.insert("witnesses".into(), witnesses(&verdict.topology, Some(&verdict.measures)));
    object.insert("findings".into(), account::findings(&verdict.findings));
    Ok((verdict, object))
}

fn why_not(why: NotPolyhedron) -> String {
    match why {
        NotPolyhedron::Empty => "there is no face".into(),
        NotPolyhedron::Edge([a, b]) => format!("{} has not two faces", Place::edge(a, b)),
        NotPolyhedron::Vertex(vertex) => format!("the faces at vertex {vertex} are not one fan"),
        NotPolyhedron::Apart([a, b]) => format!("{} are not joined", Place::pair("faces", a, b)),
        NotPolyhedron::Doubled([a, b]) => format!("{} lie in one place", Place::pair("vertices", a, b)),
        NotPolyhedron::Meeting([a, b]) => format!("{} meet", Place::pair("faces", a, b)),
    }
}

/// A finding with its first places, or with all that are kept.
fn told(finding: &shapeloom_core::Finding, all: bool) -> String {
    let most = if all { Findings::PLACES_KEPT } else { 4 };
    let places: Vec<String> =
        finding.places.iter().filter(|place| **place != Place::Whole).take(most).map(Place::to_string).collect();
    let rest = finding.count.saturating_sub(places.len() as u64);
    let places = match (places.is_empty(), rest) {
        (true, _) => String::new(),
        (false, 0) => format!(" ({})", places.join(", ")),
        (false, rest) => format!(" ({} and {rest} more)", places.join(", ")),
    };
    let times = if finding.count > 1 { format!(" {} times", finding.count) } else { String::new() };
    format!("[{}]{times}: {}{places}", finding.code, finding.message)
}
