//! The teapot's 32 Bézier patches to triangles.

use serde_json::{Map, json};
use shapeloom_core::{Convert, Exec};
use shapeloom_io::{ReadContext, format_by_id, read};
use shapeloom_parametric::{BezierSurface, TessellatePatches};
use shapeloom_shape::Representation;

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Outcome, String> {
    let path = setting.data.join("teapot.bpt");
    let name = path.display().to_string();
    let bytes = std::fs::read(&path).map_err(|error| format!("{name}: {error}"))?;
    let format = format_by_id("bpt").map_err(|error| error.to_string())?;
    let shape = read(&bytes, format, &ReadContext::named(name.as_str())).map_err(|error| error.to_string())?.shape;
    let part = shape.parts.first().ok_or_else(|| format!("{name}: found no part"))?;
    let surface = BezierSurface::from_geometry(&part.geometry).map_err(|error| error.to_string())?;
    let diagonal = surface.bounds().diagonal();
    let converter = TessellatePatches::new(setting.tolerance * diagonal);
    let (converted, times) = measure::fastest(setting.runs, || {
        converter.convert_with(surface, &Exec::default()).map_err(|error| error.to_string())
    })?;
    let mut figures = Map::new();
    figures.insert("patches".into(), json!(surface.patches.len()));
    figures.insert("vertices".into(), json!(converted.value.positions().len()));
    figures.insert("triangles".into(), json!(converted.value.triangles().len()));
    figures.insert("certificate_of_diagonal".into(), json!(converted.report.deviation.value().map(|v| v / diagonal)));
    figures.insert("triangles_per_cpu_s".into(), json!(converted.value.triangles().len() as f64 / times.cpu));
    Ok(Outcome { input: name, times, figures })
}
