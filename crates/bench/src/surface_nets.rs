//! Surface nets of volumes of 256³ samples, beside the crate fast-surface-nets on the same samples.

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, Exec};
use shapeloom_isosurface::{Border, Lattice, ManifoldSurfaceNets};
use shapeloom_judge::Topology;
use shapeloom_mesh::TriMesh;
use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let mut outcomes = Vec::new();
    for (name, volume) in volumes(setting)? {
        let bare = bare(&name, &volume, setting)?;
        let of_bare = bare.times.cpu;
        outcomes.push(bare);
        let nets = ManifoldSurfaceNets { border: Border::Open, ..ManifoldSurfaceNets::new() };
        let with_normals = ManifoldSurfaceNets { normals: true, ..nets.clone() };
        for (way, nets) in [("open", nets), ("open, normals", with_normals), ("closed", ManifoldSurfaceNets::new())] {
            let work = || nets.convert_with(&volume, &Exec::default()).map_err(|error| error.to_string());
            let (converted, times) = measure::fastest(setting.runs, work)?;
            let mut figures = figures(&converted.value)?;
            figures.insert("cpu_of_fast_surface_nets_over_ours".into(), json!(of_bare / times.cpu));
            outcomes.push(Outcome { input: format!("{name}: {way}"), times, figures });
        }
    }
    Ok(outcomes)
}

/// The crate fast-surface-nets by itself, into a buffer of its own for each run: positions and normals in single precision, which it
/// always makes, an open border, no look at its samples before.
fn bare(name: &str, volume: &VoxelGrid, setting: &Setting) -> Result<Outcome, String> {
    let dimensions = volume.lattice().dimensions();
    let shape = RuntimeShape::<u32, 3>::new(dimensions);
    let Samples::F32(samples) = volume.samples() else { return Err(format!("{name}: not single precision")) };
    let (buffer, times) = measure::fastest(setting.runs, || {
        let mut buffer = SurfaceNetsBuffer::default();
        surface_nets(samples, &shape, [0; 3], dimensions.map(|count| count - 1), &mut buffer);
        Ok(buffer)
    })?;
    let mut figures = Map::new();
    figures.insert("vertices".into(), json!(buffer.positions.len()));
    figures.insert("triangles".into(), json!(buffer.indices.len() / 3));
    Ok(Outcome { input: format!("{name}: fast-surface-nets alone"), times, figures })
}

/// The volumes of the peers, which are 256³ distances on the cube from -1.5 to 1.5; else a small one of a formula.
pub(crate) fn volumes(setting: &Setting) -> Result<Vec<(String, VoxelGrid)>, String> {
    let mut volumes = Vec::new();
    for name in ["vol_blend.f32", "vol_gyroid.f32"] {
        let path = setting.data.join(name);
        if path.exists() {
            let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
            let samples = bytes.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
            volumes.push((name.to_owned(), grid(256, samples)?));
        }
    }
    if volumes.is_empty() {
        const SIDE: u32 = 33;
        let at = |k: u32| f64::from(k) * 6.0 / f64::from(SIDE);
        let sample = |index: u32| {
            let (x, y, z) = (at(index % SIDE), at(index / SIDE % SIDE), at(index / SIDE / SIDE));
            (x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()) as f32
        };
        volumes.push(("a gyroid of 33^3 samples".to_owned(), grid(SIDE, (0..SIDE.pow(3)).map(sample).collect())?));
    }
    Ok(volumes)
}

fn grid(side: u32, samples: Vec<f32>) -> Result<VoxelGrid, String> {
    let spacing = DVec3::splat(3.0 / f64::from(side - 1));
    let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.5), spacing);
    let lattice = lattice.map_err(|error| error.to_string())?;
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).map_err(|error| error.to_string())
}

fn figures(mesh: &TriMesh) -> Result<Map<String, serde_json::Value>, String> {
    let topology = Topology::of(mesh, &Exec::default()).map_err(|error| error.to_string())?;
    let mut figures = Map::new();
    figures.insert("vertices".into(), json!(mesh.positions().len()));
    figures.insert("quads".into(), json!(mesh.triangles().len() / 2));
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("boundary_edges".into(), json!(topology.boundary.edges().len()));
    figures.insert("non_manifold_edges".into(), json!(topology.non_manifold_edges.len()));
    figures.insert("non_manifold_vertices".into(), json!(topology.non_manifold_vertices.len()));
    Ok(figures)
}
