//! Inputs of the query tasks: the million triangles, and rays and points from files or by a formula.

use std::f64::consts::TAU;
use std::path::Path;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Ray};
use shapeloom_mesh::TriMesh;
use shapeloom_spatial::TriangleBvh;

use crate::{Setting, files};

/// How many rays or points the formulas give where there are no files.
const BY_FORMULA: u32 = 10_000;

/// What queries run on.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) mesh: TriMesh,
}

/// The triangles of `blob_1m.ply`.
pub(crate) fn scene(setting: &Setting) -> Result<Scene, String> {
    let (mesh, name) = files::blob(setting)?;
    Ok(Scene { name, mesh })
}

impl Scene {
    pub(crate) fn hierarchy(&self) -> Result<TriangleBvh, String> {
        TriangleBvh::build(self.mesh.positions(), self.mesh.triangles(), &Exec::default())
            .map_err(|error| error.to_string())
    }

    /// The name of an outcome's input: the mesh, then what is asked of it.
    pub(crate) fn input(&self, words: &str) -> String {
        format!("{}: {words}", self.name)
    }
}

/// Where queries come from.
pub(crate) struct Queries<T> {
    pub(crate) items: Vec<T>,
    pub(crate) source: &'static str,
}

/// Numbers of a file of little-endian `f32`, in rows; none where the file is not there.
fn rows<const N: usize>(path: &Path) -> Result<Option<Vec<[f64; N]>>, String> {
    if !path.exists() {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let (rows, rest) = bytes.as_chunks::<4>();
    if !rest.is_empty() || !rows.len().is_multiple_of(N) {
        return Err(format!("{}: found {} bytes, expected rows of {N} numbers", path.display(), bytes.len()));
    }
    let numbers = rows.as_chunks::<N>().0;
    Ok(Some(numbers.iter().map(|row| row.map(|number| f64::from(f32::from_le_bytes(number)))).collect()))
}

/// Rays of a file: origin and direction.
pub(crate) fn rays(
    setting: &Setting,
    name: &str,
    formula: impl Fn(u32) -> (DVec3, DVec3),
) -> Result<Queries<Ray>, String> {
    let path = setting.data.join(name);
    let given: Option<Vec<[f64; 6]>> = rows(&path)?;
    let source = if given.is_some() { "file" } else { "formula" };
    let pairs: Vec<(DVec3, DVec3)> = match given {
        Some(rows) => rows.iter().map(|&[a, b, c, d, e, f]| (DVec3::new(a, b, c), DVec3::new(d, e, f))).collect(),
        None => (0..BY_FORMULA).map(formula).collect(),
    };
    let items = pairs.into_iter().map(|(origin, direction)| Ray::new(origin, direction));
    let items = items.collect::<Result<Vec<Ray>, _>>().map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(Queries { items, source })
}

/// Points of a file.
pub(crate) fn points(setting: &Setting, name: &str, formula: impl Fn(u32) -> DVec3) -> Result<Queries<DVec3>, String> {
    let given: Option<Vec<[f64; 3]>> = rows(&setting.data.join(name))?;
    Ok(match given {
        Some(rows) => Queries { items: rows.into_iter().map(DVec3::from).collect(), source: "file" },
        None => Queries { items: (0..BY_FORMULA).map(formula).collect(), source: "formula" },
    })
}

/// A number in `[0, 1)` for a place in a sequence (Weyl), another sequence for each `axis`.
pub(crate) fn spread(index: u32, axis: u32) -> f64 {
    (f64::from(index + 1) * f64::from(axis + 2).sqrt()).fract()
}

/// A point of the unit sphere.
pub(crate) fn on_sphere(index: u32, axis: u32) -> DVec3 {
    let z = 2.0 * spread(index, axis) - 1.0;
    let (sin, cos) = (TAU * spread(index, axis + 1)).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}
