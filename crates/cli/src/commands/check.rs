//! `check`: whether a shape is sound for a purpose.

use serde_json::{Map, Value, json};
use shapeloom_convert::Job;
use shapeloom_core::{ChoiceOption, Exec, Findings, Place};
use shapeloom_judge::{MeshRef, NotPolyhedron, PairKind, Profile, Verdict};
use shapeloom_shape::{Geometry, Kind};

use super::convert::{absolute, wish};
use crate::account;
use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::soundness::{Soundness, witnesses};
use crate::subjects::{Gathering, no_surface, subjects};

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
    let gathering = Gathering { weld: arguments.weld, together: arguments.together };
    let subjects = subjects(&input.read.shape, &job, gathering, &session.exec(), &mut words)?;
    if subjects.is_empty() {
        return Err(no_surface("check", &input.read.shape));
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
