//! A terrain made by formula to triangles: each cell in two, and as few as keep within a tolerance.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec2;
use shapeloom_core::{Convert, Exec, Options};
use shapeloom_mesh::{GreedyInsertion, HeightField, TriMesh, TriangulateHeightField};

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let field = terrain(setting.size)?;
    let regular = TriangulateHeightField::new();
    let adaptive = GreedyInsertion::new(setting.tolerance * field.bounds().diagonal());
    Ok(vec![measured(&field, &regular, setting)?, measured(&field, &adaptive, setting)?])
}

fn measured<C>(field: &HeightField, converter: &C, setting: &Setting) -> Result<Outcome, String>
where
    C: Convert<HeightField, Output = TriMesh> + Options,
{
    let (made, times) = measure::fastest(setting.runs, || {
        converter.convert_with(field, &Exec::default()).map_err(|error| error.to_string())
    })?;
    let diagonal = field.bounds().diagonal();
    let mut figures = Map::new();
    figures.insert("samples".into(), json!(field.heights().len()));
    figures.insert("vertices".into(), json!(made.value.positions().len()));
    figures.insert("triangles".into(), json!(made.value.triangles().len()));
    figures.insert("certificate_of_diagonal".into(), json!(made.report.deviation.value().map(|v| v / diagonal)));
    figures.insert("error_at_samples_of_diagonal".into(), json!(error_at_samples(field, &made.value) / diagonal));
    figures.insert("samples_per_cpu_s".into(), json!(field.heights().len() as f64 / times.cpu));
    Ok(Outcome { input: format!("terrain {0} x {0}: {1}", setting.size, C::NAME), times, figures })
}

/// The largest difference in height between the triangles and a sample, apart from the converter's own account: every
/// sample under every triangle.
fn error_at_samples(field: &HeightField, mesh: &TriMesh) -> f64 {
    let mut worst = 0.0f64;
    let columns = field.columns() as usize;
    for triangle in 0..mesh.triangles().len() {
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners.map(|corner| corner.truncate());
        let area = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).ceil(), a.max(b).max(c).floor());
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let p = DVec2::new(x as f64, y as f64);
                let weights = [(c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)];
                if weights.iter().all(|weight| *weight >= 0.0) {
                    let height: f64 = weights.iter().zip(corners).map(|(weight, corner)| weight * corner.z).sum();
                    worst = worst.max((height / area - field.heights()[y * columns + x]).abs());
                }
            }
        }
    }
    worst
}

/// Fractal noise: eleven octaves of smoothly mixed random values, each at twice the frequency and half the height.
fn terrain(size: u32) -> Result<HeightField, String> {
    let mut heights = vec![0.0; size as usize * size as usize];
    let mut wave = f64::from(size) / 2.0;
    for octave in 0..11u32 {
        let random = |i: u32, j: u32| {
            let mut word = u64::from(i) << 32 | u64::from(j) << 8 | u64::from(octave);
            for _ in 0..3 {
                word = (word ^ word >> 31).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            }
            (word >> 11) as f64 / (1u64 << 53) as f64
        };
        let smooth = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        for (k, height) in heights.iter_mut().enumerate() {
            let p = [k % size as usize, k / size as usize].map(|coordinate| coordinate as f64 / wave);
            let [i, j] = p.map(|coordinate| coordinate as u32);
            let [s, t] = p.map(|coordinate| smooth(coordinate.fract()));
            let low = random(i, j) * (1.0 - s) + random(i + 1, j) * s;
            let high = random(i, j + 1) * (1.0 - s) + random(i + 1, j + 1) * s;
            *height += (low * (1.0 - t) + high * t) * wave / 2.0;
        }
        wave /= 2.0;
    }
    HeightField::try_new(size, size, DVec2::ONE, heights).map_err(|error| error.to_string())
}
