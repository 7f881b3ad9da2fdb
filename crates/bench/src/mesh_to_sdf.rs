//! A mesh to signed distances on a lattice.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, Exec};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::primitives::Torus;
use shapeloom_mesh::{TriMesh, TriangulatePolygons};
use shapeloom_spatial::SignedDistance;
use shapeloom_voxels::{FarField, MeshToDistance, VoxelGrid};

use crate::{Outcome, Setting, files, measure};

/// How many samples are compared with distances found one by one.
const CHECKED: u64 = 20_000;

/// blob_1m.ply, else a torus made by formula, on as many samples each way as `--size` says, 256 at most, from -1.5 to 1.5: the
/// band alone, and with the far field swept.
pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let (mesh, input) = match setting.data.join("blob_1m.ply").exists() {
        true => files::blob(setting)?,
        false => (formula()?, "torus".to_owned()),
    };
    let count = setting.size.min(256);
    let step = 3.0 / f64::from(count - 1);
    let lattice = Lattice::along_axes([count; 3], DVec3::splat(-1.5), DVec3::splat(step));
    let lattice = lattice.map_err(|error| error.to_string())?;
    let truth = SignedDistance::build(mesh.positions(), mesh.triangles(), &Exec::default());
    let truth = truth.map_err(|error| error.to_string())?;
    let mut outcomes = Vec::new();
    for (name, far) in [("band 3", FarField::Clamp), ("swept", FarField::Sweep)] {
        let method = MeshToDistance { far, ..MeshToDistance::new() };
        let work = || method.onto(&mesh, lattice, &Exec::default()).map_err(|error| error.to_string());
        let (made, times) = measure::fastest(setting.runs, work)?;
        let mut figures = Map::new();
        figures.insert("triangles".into(), json!(mesh.triangles().len()));
        figures.insert("samples".into(), json!(lattice.samples()));
        figures.insert("band_samples".into(), json!(made.report.find("band_samples")));
        figures.insert("deviation".into(), json!(made.report.deviation.to_string()));
        compare(&made.value, &truth, 3.0 * step, &mut figures);
        outcomes.push(Outcome { input: format!("{input}: {name}"), times, figures });
    }
    Ok(outcomes)
}

fn formula() -> Result<TriMesh, String> {
    let torus = Torus::new().mesh(&Exec::default()).map_err(|error| error.to_string())?.value;
    Ok(TriangulatePolygons::new().convert(&torus).map_err(|error| error.to_string())?.value)
}

/// The largest errors in the band and beyond, and how many signs are wrong.
fn compare(grid: &VoxelGrid, truth: &SignedDistance, band: f64, figures: &mut Map<String, serde_json::Value>) {
    let lattice = grid.lattice();
    let (mut near, mut far, mut wrong) = (0.0f64, 0.0f64, 0);
    for n in 0..CHECKED.min(lattice.samples()) {
        let at = n.wrapping_mul(0x9e37_79b9_7f4a_7c15) % lattice.samples();
        let coordinates = lattice.coordinates(at);
        let (found, expected) = (f64::from(grid.sample(coordinates)), truth.distance(lattice.position(coordinates)));
        let error = (found.abs() - expected.abs()).abs();
        let worst = if expected.abs() <= band { &mut near } else { &mut far };
        *worst = worst.max(error);
        wrong += u32::from((found < 0.0) != (expected < 0.0));
    }
    figures.insert("max_error_in_band".into(), json!(near));
    figures.insert("max_error_beyond".into(), json!(far));
    figures.insert("wrong_signs".into(), json!(wrong));
}
