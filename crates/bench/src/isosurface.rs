//! Isosurfaces of the volumes vol_blend.f32 and vol_gyroid.f32, cubes of distances in single precision, or of one by formula.

use std::path::Path;

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, Exec, Options};
use shapeloom_isosurface::{Border, Lattice, MarchingCubes, MarchingTetrahedra, Topology};
use shapeloom_mesh::TriMesh;
use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let mut outcomes = Vec::new();
    let mut volumes = Vec::new();
    for name in ["vol_blend.f32", "vol_gyroid.f32"] {
        let path = setting.data.join(name);
        if path.exists() {
            volumes.push((name.to_owned(), load(&path)?));
        }
    }
    if volumes.is_empty() {
        volumes.push(("ripples".to_owned(), ripples(setting.size.clamp(2, 512))?));
    }
    for (name, grid) in &volumes {
        let cubes = MarchingCubes::new();
        let with_normals = MarchingCubes { normals: true, ..cubes.clone() };
        let exact = MarchingCubes { topology: Topology::Exact, ..cubes.clone() };
        // Peers leave the border open: those two are the same work.
        let open = MarchingCubes { border: Border::Open, ..cubes.clone() };
        let open_with_normals = MarchingCubes { border: Border::Open, ..with_normals.clone() };
        outcomes.push(measured(name, ", open", grid, &open, setting)?);
        outcomes.push(measured(name, ", open, with normals", grid, &open_with_normals, setting)?);
        outcomes.push(measured(name, "", grid, &cubes, setting)?);
        outcomes.push(measured(name, " with normals", grid, &with_normals, setting)?);
        outcomes.push(measured(name, " with exact topology", grid, &exact, setting)?);
        outcomes.push(measured(name, "", grid, &MarchingTetrahedra::new(), setting)?);
    }
    Ok(outcomes)
}

fn measured<C>(name: &str, how: &str, grid: &VoxelGrid, converter: &C, setting: &Setting) -> Result<Outcome, String>
where
    C: Convert<VoxelGrid, Output = TriMesh> + Options,
{
    let (made, times) = measure::fastest(setting.runs, || {
        converter.convert_with(grid, &Exec::default()).map_err(|error| error.to_string())
    })?;
    let mut figures = Map::new();
    figures.insert("samples".into(), json!(grid.lattice().samples()));
    figures.insert("vertices".into(), json!(made.value.positions().len()));
    figures.insert("triangles".into(), json!(made.value.triangles().len()));
    figures.insert("bytes_a_sample".into(), json!(made.report.find("bytes_a_sample")));
    figures.insert("samples_per_cpu_s".into(), json!(grid.lattice().samples() as f64 / times.cpu));
    Ok(Outcome { input: format!("{name}: {}{how}", C::NAME), times, figures })
}

/// A cube of samples from a file, between -1.5 and 1.5.
fn load(path: &Path) -> Result<VoxelGrid, String> {
    let said = |error: String| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| said(error.to_string()))?;
    let samples: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    grid((samples.len() as f64).cbrt().round() as u32, samples).map_err(said)
}

/// Waves in all directions.
fn ripples(side: u32) -> Result<VoxelGrid, String> {
    let at = |k: u32| (f64::from(k) / f64::from(side) * 12.0).sin();
    let rows = (0..side).flat_map(|k| (0..side).map(move |j| at(j) + at(k)));
    grid(side, rows.flat_map(|row| (0..side).map(move |i| (at(i) + row) as f32)).collect())
}

fn grid(side: u32, samples: Vec<f32>) -> Result<VoxelGrid, String> {
    let spacing = DVec3::splat(3.0 / f64::from(side.max(2) - 1));
    let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.5), spacing).map_err(|error| error.to_string())?;
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).map_err(|error| error.to_string())
}
