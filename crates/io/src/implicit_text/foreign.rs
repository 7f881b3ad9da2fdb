//! Shapes in files beside a text, as nodes of its tree.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Convert, Exec, Field};
use shapeloom_implicit::CurveDistance;
use shapeloom_implicit::{ForeignCall, Resolved};
use shapeloom_mesh::{TriMesh, TriangulatePolygons};
use shapeloom_parametric::TessellatePatches;
use shapeloom_shape::{Geometry, Shape};
use shapeloom_spatial::SignedDistance;
use shapeloom_voxels::isosurface::{InsideChoice, IsoValue, Level};
use shapeloom_voxels::{GridField, Interpolation};

use crate::{ReadContext, SiblingName, detect, read};

/// The functions that name a file.
pub(super) const FUNCTIONS: [&str; 3] = ["mesh", "volume", "tube"];

/// The field that a call names.
///
/// # Errors
/// In words: an unknown number, a file that is missing, unreadable or holds nothing of the kind that is wanted.
pub(super) fn resolve(call: &ForeignCall, context: &ReadContext) -> Result<Resolved, String> {
    let known: &[&str] = match call.function.as_str() {
        "mesh" => &["tolerance"],
        "volume" => &["iso"],
        "tube" => &["radius", "tolerance"],
        other => {
            return Err(format!("found {other} with the name of a file, expected one of: {}", FUNCTIONS.join(", ")));
        }
    };
    if let Some((name, _)) = call.numbers.iter().find(|(name, _)| !known.contains(&name.as_str())) {
        return Err(format!("found {name}, expected {}", known.join(" or ")));
    }
    let shape = open(&call.argument, context)?;
    let size = placed(&shape).map(|geometry| geometry.bounds()).fold(Aabb::EMPTY, Aabb::union).diagonal();
    // A thousandth of the size is less than a pixel of most pictures.
    let tolerance = call.number("tolerance").unwrap_or(if size > 0.0 { size * 1e-3 } else { 1.0 });
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(format!("found tolerance {tolerance}, expected a finite number above 0"));
    }
    let (field, exact) = match call.function.as_str() {
        "mesh" => mesh(&shape, tolerance, &context.exec)?,
        "volume" => (volume(&shape, call.number("iso"), &context.exec)?, false),
        _ => {
            let radius = call.number("radius").ok_or("found no radius, expected one")?;
            (tube(&shape, radius, tolerance)?, false)
        }
    };
    Ok(Resolved { field, exact })
}

fn open(file: &str, context: &ReadContext) -> Result<Shape, String> {
    let name = SiblingName::try_new(file)
        .map_err(|_| format!("found \"{file}\", expected the name of a file in the folder of the text"))?;
    let siblings = context
        .siblings
        .as_ref()
        .ok_or_else(|| format!("found \"{file}\", expected no files: the text is read alone, not by its path"))?;
    let room = context.exec.memory_limit().saturating_sub(context.exec.memory_taken());
    let most = context.limits.max_bytes.min(room);
    let bytes =
        siblings.open(&name, most).map_err(|error| format!("found \"{file}\": {error}, expected a readable file"))?;
    if bytes.len() as u64 >= most {
        return Err(format!("found \"{file}\" of {most} bytes or more, expected fewer"));
    }
    let format = detect(&bytes, Some(file)).map_err(|error| error.to_string())?;
    if format.kinds == [shapeloom_shape::Kind::Implicit] {
        return Err(format!("found \"{file}\", another text of implicits, expected a mesh, a volume or curves"));
    }
    let inner = ReadContext { name: file.to_owned(), ..context.clone() };
    Ok(read(&bytes, format, &inner).map_err(|error| error.to_string())?.shape)
}

fn placed(shape: &Shape) -> impl Iterator<Item = Arc<Geometry>> {
    shape.parts.iter().map(|part| part.placed())
}

/// The signed distance of everything in the file that has a surface; exact where it is closed and made of triangles.
fn mesh(shape: &Shape, tolerance: f64, exec: &Exec) -> Result<(Arc<dyn Field>, bool), String> {
    let mut positions: Vec<DVec3> = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut exact = true;
    for geometry in placed(shape) {
        let said = |error: shapeloom_core::ConvertError| error.to_string();
        let converted: TriMesh;
        let made = match &*geometry {
            Geometry::TriMesh(mesh) => mesh,
            Geometry::PolyMesh(mesh) => {
                converted = TriangulatePolygons::new().convert_with(mesh, exec).map_err(said)?.value;
                &converted
            }
            Geometry::BezierSurface(surface) => {
                exact = false;
                converted = TessellatePatches::new(tolerance).convert_with(surface, exec).map_err(said)?.value;
                &converted
            }
            other => return Err(format!("found a {}, expected a mesh or a surface", other.kind())),
        };
        let first = u32::try_from(positions.len()).map_err(|_| "found more than 2^32 vertices, expected fewer")?;
        positions.extend_from_slice(made.positions());
        triangles.extend(made.triangles().iter().map(|triangle| triangle.map(|vertex| first.saturating_add(vertex))));
    }
    if triangles.is_empty() {
        return Err("found no triangles, expected a mesh or a surface".to_owned());
    }
    let distance = SignedDistance::build(&positions, &triangles, exec).map_err(|error| error.to_string())?;
    exact &= distance.is_closed();
    Ok((Arc::new(distance), exact))
}

/// The samples between the cells' corners, less the iso value: given, the samples' own, or Otsu's threshold.
fn volume(shape: &Shape, iso: Option<f64>, exec: &Exec) -> Result<Arc<dyn Field>, String> {
    let mut parts = placed(shape);
    let (Some(geometry), None) = (parts.next(), parts.next()) else {
        return Err(format!("found {} parts, expected one volume", shape.parts.len()));
    };
    let Geometry::VoxelGrid(grid) = &*geometry else {
        return Err(format!("found a {}, expected a volume", geometry.kind()));
    };
    let iso = iso.map_or(IsoValue::Auto, IsoValue::At);
    let (level, _) = Level::settle(grid, iso, InsideChoice::Auto, exec).map_err(|error| error.to_string())?;
    let field = GridField::try_new(grid, level, Interpolation::Trilinear, exec).map_err(|error| error.to_string())?;
    Ok(Arc::new(field))
}

/// The generalised cylinder about every curve in the file.
fn tube(shape: &Shape, radius: f64, tolerance: f64) -> Result<Arc<dyn Field>, String> {
    let mut pieces: Vec<Vec<DVec3>> = Vec::new();
    for geometry in placed(shape) {
        match &*geometry {
            Geometry::BezierCurve(curve) => pieces.push(curve.control_points().to_vec()),
            Geometry::Polyline(line) => {
                pieces.extend(line.segments().map(|ends| ends.to_vec()));
                pieces.extend(line.points().first().filter(|_| line.points().len() == 1).map(|&point| vec![point]));
            }
            Geometry::GeometricGraph(graph) => {
                pieces
                    .extend(graph.edges().iter().map(|ends| ends.map(|end| graph.positions()[end as usize]).to_vec()));
            }
            other => return Err(format!("found a {}, expected curves", other.kind())),
        }
    }
    let field = CurveDistance::try_new(&pieces, radius, tolerance).map_err(|error| error.to_string())?;
    Ok(Arc::new(field))
}
