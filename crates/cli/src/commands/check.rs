//! `check`: whether a shape is sound for a purpose.

use std::borrow::Cow;
use std::sync::Arc;

use serde_json::{Map, Value, json};
use shapeloom_convert::{Job, convert_shape, plan};
use shapeloom_core::{Category, ChoiceOption, Convert, Exec, Findings, Place};
use shapeloom_judge::{MeshRef, NotPolyhedron, PairKind, Profile, Verdict};
use shapeloom_mesh::{TriMesh, TriangulatePolygons, Weld};
use shapeloom_shape::{Geometry, Kind, Shape};

use super::convert::{absolute, wish};
use crate::account;
use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::soundness::Soundness;

pub(crate) fn run(arguments: &CheckArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let tolerance = arguments.way.tolerance()?;
    let settings = Settings::sort(&arguments.way.settings);
    settings.no_writing()?;
    let profile = Profile::from_name(&arguments.profile).unwrap_or(Profile::General);
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    let wish = wish(&arguments.way, &[Kind::TriMesh])?;
    let tolerance = absolute(tolerance, &input.read.shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.others };
    session.stage("checking");
    let mut parts = Vec::new();
    let (mut words, mut sound, mut checked) = (Vec::new(), true, 0);
    for (index, part) in input.read.shape.parts.iter().enumerate() {
        let named = match part.name.is_empty() {
            true => format!("part {index}"),
            false => format!("part {index} \"{}\"", part.name),
        };
        let Some(Meshed { mesh, remark }) = meshed(&input.read.shape, index, &job, arguments.weld, &session.exec())?
        else {
            words.push(format!("{named}: a {} has no faces, and was not checked", part.geometry.kind()));
            continue;
        };
        checked += 1;
        let exec = session.exec();
        let (verdict, mut object) = match &*mesh {
            Geometry::TriMesh(mesh) => judged(mesh, profile, &exec)?,
            Geometry::PolyMesh(mesh) => judged(mesh, profile, &exec)?,
            _ => continue,
        };
        sound &= verdict.findings.is_empty();
        object.insert("part".into(), json!(index));
        object.insert("name".into(), json!(part.name));
        object.insert("kind".into(), json!(part.geometry.kind().name()));
        words.extend(remark.map(|remark| format!("{named}: {remark}")));
        for finding in &verdict.findings {
            words.push(format!("{named}: {}", told(finding, session.globals.verbose)));
        }
        parts.push(Value::Object(object));
    }
    if checked == 0 {
        let kinds: Vec<&str> = input.read.shape.kinds().into_iter().map(Kind::name).collect();
        let found = if kinds.is_empty() { "nothing".to_owned() } else { kinds.join(", ") };
        return Err(Failure::Own {
            code: "E-check-kind",
            category: Category::Unsupported,
            message: format!("check: found {found}, expected something with a surface"),
            advice: None,
        });
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

/// A part as a mesh where it is placed.
struct Meshed {
    mesh: Arc<Geometry>,
    /// What was done to it for that.
    remark: Option<String>,
}

/// Makes a part a mesh; none where it has no faces.
fn meshed(shape: &Shape, index: usize, job: &Job, weld: bool, exec: &Exec) -> Result<Option<Meshed>, Failure> {
    let part = &shape.parts[index];
    let mut remark = None;
    let mut mesh = match part.geometry.kind() {
        Kind::TriMesh | Kind::PolyMesh => part.placed(),
        kind if plan(kind, &job.wish).is_err() => return Ok(None),
        kind => {
            let alone = Shape { parts: vec![part.clone()], ..shape.clone() };
            let conversion = convert_shape(&alone, job, exec)?;
            remark = Some(format!("the {kind} is judged as triangles, error {}", conversion.deviation));
            let Some(part) = conversion.shape.parts.first() else { return Ok(None) };
            part.placed()
        }
    };
    if weld {
        let triangles: Cow<'_, TriMesh> = match &*mesh {
            Geometry::TriMesh(mesh) => Cow::Borrowed(mesh),
            Geometry::PolyMesh(mesh) => Cow::Owned(TriangulatePolygons::new().convert_with(mesh, exec)?.value),
            _ => return Ok(None),
        };
        let welded = Weld::new().convert_with(&*triangles, exec)?.value;
        let merged = triangles.positions().len() - welded.positions().len();
        remark = Some(format!("{merged} vertices were merged with others at the same position"));
        mesh = Arc::new(welded.into());
    }
    Ok(Some(Meshed { mesh, remark }))
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
    object.insert("findings".into(), account::findings(&verdict.findings));
    Ok((verdict, object))
}

fn why_not(why: NotPolyhedron) -> String {
    match why {
        NotPolyhedron::Empty => "there is no face".into(),
        NotPolyhedron::Edge([a, b]) => format!("{} has not two faces", Place::edge(a, b)),
        NotPolyhedron::Vertex(vertex) => format!("the faces at vertex {vertex} are not one fan"),
        NotPolyhedron::Apart([a, b]) => format!("{} are not joined", Place::pair("faces", a, b)),
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
    format!("{}[{}]: {}{places}", "warning", finding.code, finding.message)
}
