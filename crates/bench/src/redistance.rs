//! Volumes to signed distances.

use serde_json::{Map, json};
use shapeloom_core::{Convert, Exec};
use shapeloom_io::{ReadContext, format_by_id, read};
use shapeloom_shape::Geometry;
use shapeloom_voxels::{Redistance, SparseBricks, VoxelGrid, redistance_band};

use crate::{Outcome, Setting, measure, surface_nets};

/// The volumes of the peers and a tooth (tooth.nrrd), else a small one of a formula: all distances, and those of a
/// narrow band of three cells.
pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let mut volumes = surface_nets::volumes(setting)?;
    volumes.extend(tooth(setting)?.map(|tooth| ("tooth.nrrd".to_owned(), tooth)));
    let mut outcomes = Vec::new();
    for (name, volume) in volumes {
        let lattice = *volume.lattice();
        let work = || Redistance::new().convert_with(&volume, &Exec::default()).map_err(|error| error.to_string());
        let (all, times) = measure::fastest(setting.runs, work)?;
        let mut figures = Map::new();
        figures.insert("samples".into(), json!(lattice.samples()));
        figures.insert("triangles".into(), json!(all.report.find("triangles")));
        figures.insert("mean".into(), json!(mean(&all.value)));
        outcomes.push(Outcome { input: format!("{name}: all"), times, figures });

        let half_width = (3.0 * lattice.spacing().max_element()) as f32;
        let bricks = SparseBricks::narrow_band(&all.value, half_width, &Exec::default());
        let bricks = bricks.map_err(|error| error.to_string())?;
        let work = || redistance_band(&bricks, &Exec::default()).map_err(|error| error.to_string());
        let (band, times) = measure::fastest(setting.runs, work)?;
        let mut figures = Map::new();
        figures.insert("samples".into(), json!(band.active()));
        figures.insert("triangles".into(), json!(all.report.find("triangles")));
        outcomes.push(Outcome { input: format!("{name}: band"), times, figures });
    }
    Ok(outcomes)
}

/// The mean of all sizes, by which results can be told apart.
fn mean(grid: &VoxelGrid) -> f64 {
    let samples = grid.lattice().samples();
    (0..samples).map(|at| f64::from(grid.samples().get(at).abs())).sum::<f64>() / samples as f64
}

fn tooth(setting: &Setting) -> Result<Option<VoxelGrid>, String> {
    let path = setting.data.join("tooth.nrrd");
    if !path.exists() {
        return Ok(None);
    }
    let said = |error: String| format!("{}: {error}", path.display());
    let bytes = std::fs::read(&path).map_err(|error| said(error.to_string()))?;
    let format = format_by_id("nrrd").map_err(|error| said(error.to_string()))?;
    let context = ReadContext::named(path.display().to_string());
    let shape = read(&bytes, format, &context).map_err(|error| said(error.to_string()))?.shape;
    match shape.parts.first().map(|part| &*part.geometry) {
        Some(Geometry::VoxelGrid(grid)) => Ok(Some(grid.clone())),
        _ => Err(said("found no grid".into())),
    }
}
