//! The meshes of an input: parts with faces, one by one or as one.

use std::iter;
use std::sync::Arc;

use serde_json::{Map, Value, json};
use shapeloom_convert::{Job, PlanError, convert_shape, plan};
use shapeloom_core::{Category, Convert, Exec, Finding, Severity};
use shapeloom_mesh::{PolyMesh, TriMesh, Weld};
use shapeloom_shape::{Geometry, Kind, Shape};

use crate::failure::Failure;

/// A mesh of the input.
pub(crate) struct Subject {
    /// What messages call it.
    pub(crate) named: String,
    /// Which part it is, as keys of JSON.
    pub(crate) keys: Map<String, Value>,
    pub(crate) mesh: Arc<Geometry>,
    /// What was done to it.
    pub(crate) remarks: Vec<String>,
}

/// What is done to the meshes before anything else.
#[derive(Clone, Copy)]
pub(crate) struct Gathering {
    /// Vertices at the same position are merged.
    pub(crate) weld: bool,
    /// All parts become one mesh.
    pub(crate) together: bool,
}

/// That a shape has nothing with a surface.
pub(crate) fn no_surface(command: &str, shape: &Shape) -> Failure {
    let kinds: Vec<&str> = shape.kinds().into_iter().map(Kind::name).collect();
    let found = if kinds.is_empty() { "nothing".to_owned() } else { kinds.join(", ") };
    Failure::Own {
        code: "E-check-kind",
        category: Category::Unsupported,
        message: format!("{command}: found {found}, expected something with a surface"),
        advice: None,
    }
}

/// The parts that have faces, or all of them as one; what has none is said.
pub(crate) fn subjects(
    shape: &Shape,
    job: &Job,
    gathering: Gathering,
    exec: &Exec,
    words: &mut Vec<String>,
) -> Result<Vec<Subject>, Failure> {
    let is_mesh = |kind: Kind| matches!(kind, Kind::TriMesh | Kind::PolyMesh);
    if !shape.parts.is_empty() && shape.kinds().into_iter().all(is_mesh) {
        nothing_to_convert(job)?;
    }
    let mut found = Vec::new();
    for (index, part) in shape.parts.iter().enumerate() {
        let named = match part.name.is_empty() {
            true => format!("part {index}"),
            false => format!("part {index} \"{}\"", part.name),
        };
        let kind = part.geometry.kind();
        let Some((mesh, remarks)) = meshed(shape, index, job, exec)? else {
            words.push(format!("{named}: a {kind} has no faces, and was passed over"));
            continue;
        };
        let keys = [("part", json!(index)), ("name", json!(part.name)), ("kind", json!(kind.name()))];
        let keys = keys.map(|(key, value)| (key.to_owned(), value)).into_iter().collect();
        found.push(Subject { named, keys, mesh, remarks });
    }
    if gathering.together && found.len() > 1 {
        let named = format!("{} parts together", found.len());
        let keys = Map::from_iter([("together".to_owned(), json!(found.len()))]);
        let mesh = Arc::new(joined(&found, exec)?);
        let remarks = found.iter().flat_map(|one| one.remarks.iter().map(|remark| format!("{}: {remark}", one.named)));
        let remarks = remarks.collect();
        found = vec![Subject { named, keys, mesh, remarks }];
    }
    if gathering.weld {
        for subject in &mut found {
            let merged = weld(subject, exec)?;
            subject.remarks.push(format!("{merged} vertices were merged with others at the same position"));
        }
    }
    Ok(found)
}

/// Refuses what says how to convert where meshes are taken as they are.
fn nothing_to_convert(job: &Job) -> Result<(), Failure> {
    let found = match (&job.wish.method, job.settings.first()) {
        (Some(method), _) => format!("--method {method}"),
        (None, Some((key, _))) => format!("--set {key}"),
        (None, None) => return Ok(()),
    };
    let message = format!("found {found}, expected none: the input is a mesh already, and is taken as it is");
    Err(Failure::usage("E-usage-setting", message))
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
            let welded = Weld::new().convert_with(mesh, exec)?.value;
            (mesh.positions().len() - welded.positions().len(), welded.into())
        }
        _ => return Ok(0),
    };
    subject.mesh = Arc::new(welded);
    Ok(merged)
}

/// A part as a mesh where it is placed, and what was done to it for that, with warnings; none where it has no faces.
type Meshed = (Arc<Geometry>, Vec<String>);

fn meshed(shape: &Shape, index: usize, job: &Job, exec: &Exec) -> Result<Option<Meshed>, Failure> {
    let part = &shape.parts[index];
    match part.geometry.kind() {
        Kind::TriMesh | Kind::PolyMesh => Ok(Some((part.placed(), Vec::new()))),
        kind => {
            match plan(kind, &job.wish) {
                Err(error @ PlanError::UnknownMethod { .. }) => return Err(error.into()),
                Err(_) => return Ok(None),
                Ok(_) => {}
            }
            let alone = Shape { parts: vec![part.clone()], ..shape.clone() };
            let conversion = convert_shape(&alone, job, exec)?;
            let taken = format!("the {kind} is taken as triangles, error {}", conversion.deviation);
            let findings = conversion.steps.iter().flat_map(|step| step.report.findings.iter());
            let warnings = findings.filter(|finding| finding.severity == Severity::Warning).map(Finding::to_string);
            let remarks = iter::once(taken).chain(warnings).collect();
            Ok(conversion.shape.parts.first().map(|part| (part.placed(), remarks)))
        }
    }
}
