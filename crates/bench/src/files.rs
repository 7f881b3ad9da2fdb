//! Mesh files of a million triangles, read and written.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Map, json};
use shapeloom_core::{Convert, Exec};
use shapeloom_io::{Format, ReadContext, WriteContext, detect, format_by_id, read, slurp_sized, write};
use shapeloom_mesh::{TriMesh, TriangulatePolygons};
use shapeloom_shape::{Geometry, Shape};

use crate::{Outcome, Setting, measure};

/// The inputs, as far as they are there.
fn inputs(setting: &Setting) -> Result<Vec<PathBuf>, String> {
    let names = ["ply", "stl", "obj", "off", "glb"].map(|extension| setting.data.join(format!("blob_1m.{extension}")));
    let found: Vec<PathBuf> = names.into_iter().filter(|path| path.exists()).collect();
    if found.is_empty() {
        let folder = setting.data.display();
        return Err(format!("{folder}: found no blob_1m.ply, .stl, .obj, .off or .glb, expected at least one"));
    }
    Ok(found)
}

/// The triangles of `blob_1m.ply`, and its name.
pub(crate) fn blob(setting: &Setting) -> Result<(TriMesh, String), String> {
    let path = setting.data.join("blob_1m.ply");
    let name = path.display().to_string();
    let (shape, ..) = load(&path)?;
    match shape.parts.first().map(|part| &*part.geometry) {
        Some(Geometry::TriMesh(mesh)) => Ok((mesh.clone(), name)),
        Some(Geometry::PolyMesh(mesh)) => {
            Ok((TriangulatePolygons::new().convert(mesh).map_err(|error| error.to_string())?.value, name))
        }
        _ => Err(format!("{name}: found no mesh")),
    }
}

/// A file's shape, its format and its length in bytes.
pub(crate) fn load(path: &PathBuf) -> Result<(Shape, &'static Format, u64), String> {
    let name = path.display().to_string();
    let said = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let file = std::fs::File::open(path).map_err(|error| said(&error))?;
    let length = file.metadata().map_or(0, |data| data.len());
    let context = ReadContext::named(name.as_str());
    let bytes = slurp_sized(file, length, &context.limits, &context.exec).map_err(|error| said(&error))?;
    let format = detect(&bytes, Some(&name)).map_err(|error| said(&error))?;
    let shape = read(&bytes, format, &context).map_err(|error| said(&error))?.shape;
    Ok((shape, format, bytes.len() as u64))
}

/// The first mesh of a file, as triangles.
pub(crate) fn load_triangles(path: &PathBuf) -> Result<TriMesh, String> {
    let (shape, _, _) = load(path)?;
    let part = shape.parts.first().ok_or_else(|| format!("{}: found no part", path.display()))?;
    match &*part.geometry {
        Geometry::TriMesh(mesh) => Ok(mesh.clone()),
        Geometry::PolyMesh(mesh) => {
            Ok(TriangulatePolygons::new().convert(mesh).map_err(|error| error.to_string())?.value)
        }
        other => Err(format!("{}: found a {}, expected a mesh", path.display(), other.kind())),
    }
}

fn sizes(shape: &Shape) -> (usize, usize) {
    shape.parts.iter().fold((0, 0), |(vertices, triangles), part| match &*part.geometry {
        Geometry::TriMesh(mesh) => (vertices + mesh.positions().len(), triangles + mesh.triangles().len()),
        Geometry::PolyMesh(mesh) => (vertices + mesh.positions().len(), triangles + mesh.triangle_count()),
        _ => (vertices, triangles),
    })
}

fn outcome(input: String, times: measure::Times, bytes: u64, shape: &Shape) -> Outcome {
    let (vertices, triangles) = sizes(shape);
    let mut figures = Map::new();
    figures.insert("bytes".into(), json!(bytes));
    figures.insert("vertices".into(), json!(vertices));
    figures.insert("triangles".into(), json!(triangles));
    figures.insert("mb_per_cpu_s".into(), json!(bytes as f64 / 1e6 / times.cpu));
    Outcome { input, times, figures }
}

/// From the file to the mesh.
pub(crate) fn read_files(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let one = |path: &PathBuf| {
        let ((shape, _, bytes), times) = measure::fastest(setting.runs, || load(path))?;
        Ok(outcome(path.display().to_string(), times, bytes, &shape))
    };
    inputs(setting)?.iter().map(one).collect()
}

/// From the mesh to bytes in memory, in every format.
pub(crate) fn write_files(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let path = &inputs(setting)?[0];
    let (mut shape, _, _) = load(path)?;
    for part in &mut shape.parts {
        if let Geometry::PolyMesh(mesh) = &*part.geometry {
            let triangles = TriangulatePolygons::new().convert(mesh).map_err(|error| error.to_string())?.value;
            part.geometry = Arc::new(triangles.into());
        }
    }
    let one = |id: &str| {
        let format = format_by_id(id).map_err(|error| error.to_string())?;
        let context = WriteContext { exec: Exec::default(), ..WriteContext::default() };
        let (bytes, times) = measure::fastest(setting.runs, || {
            let mut bytes = Vec::new();
            write(&shape, format, &context, &mut bytes).map_err(|error| error.to_string())?;
            Ok(bytes)
        })?;
        Ok(outcome(format!("{} as {id}", path.display()), times, bytes.len() as u64, &shape))
    };
    ["ply", "stl", "obj", "off", "glb"].into_iter().filter(|id| format_by_id(id).is_ok()).map(one).collect()
}
