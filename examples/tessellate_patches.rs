//! The teapot's patches as triangles, with the proven error of each patch beside one that is measured.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::{Convert, Tolerance};
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::parametric::{BezierSurface, TessellatePatches};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::shape::Representation;
use shapeloom_examples::{Output, measure_patch, triangles_of_patch};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/teapot.bpt");
    let teapot = read(&std::fs::read(path)?, format_by_id("bpt")?, &ReadContext::named("teapot.bpt"))?.shape;
    let surface = BezierSurface::from_geometry(&teapot.parts[0].geometry)?;
    let tolerance = Tolerance::OfDiagonal(0.001).resolve(surface.bounds().diagonal())?;
    let converted = TessellatePatches::new(tolerance).convert(surface)?;
    let (mesh, report) = (converted.value, converted.report);
    println!("tolerance {tolerance:.4e}: {} triangles, error {}", mesh.triangles().len(), report.deviation);

    println!("patch  certificate  measured     ratio  ratio if only curvature counted");
    let (mut scene, mut ratios, mut worst) = (Scene::default(), Vec::new(), 0.0f64);
    for (index, patch) in surface.patches.iter().enumerate() {
        let (measured, curved) = measure_patch(patch, &mesh, index)?;
        let certificate = report.certificates[index];
        let ratio = certificate / measured;
        println!("{index:5}  {certificate:.4e}   {measured:.4e}  {ratio:6.2}  {:6.2}", curved / measured);
        worst = worst.max(measured);
        ratios.push(ratio);
        // The more cautious the bound, the warmer the colour.
        let color = [0.07 + 0.2 * (ratio as f32 - 1.0), 0.22, 0.48 - 0.16 * (ratio as f32 - 1.0)];
        let triangles = triangles_of_patch(&mesh, index).map(|triangle| mesh.triangles()[triangle]).collect();
        scene.surfaces.push(SceneMesh { color, ..SceneMesh::new(mesh.positions().to_vec(), triangles) });
    }
    // The bound counts acceleration along the surface, which does no harm, as much as curvature.
    let above: Vec<usize> = (0..ratios.len()).filter(|&patch| ratios[patch] > 4.0).collect();
    println!("above 4, from tangential acceleration: {above:?}");
    ratios.sort_by(f64::total_cmp);
    let median = (ratios[ratios.len() / 2 - 1] + ratios[ratios.len() / 2]) / 2.0;
    let whole = report.deviation.value().unwrap_or(f64::NAN) / worst;
    println!("whole: measured {worst:.4e}, ratio {whole:.2}; median of the patches' ratios {median:.2}");
    let look = Picture { wires: true, wire_width: 0.6, ..Picture::new() };
    println!("{}", output.draw("tessellate_patches", &scene, [32.0, 23.0], look)?.display());
    Ok(())
}
