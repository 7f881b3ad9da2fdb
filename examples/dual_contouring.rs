//! A block with a round hole: by surface nets, which round its edges, and by dual contouring, which keeps them.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec, Field};
use shapeloom::isosurface::{DualContouring, FieldSlabs, Lattice, ManifoldSurfaceNets};
use shapeloom::mesh::TriMesh;
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

/// The larger one of the distances to a block and, negative inside, to a cylinder along y through it.
struct Block;

const HALF: DVec3 = DVec3::new(0.8, 0.55, 0.7);
const HOLE: f64 = 0.4;

impl Field for Block {
    fn value(&self, p: DVec3) -> f64 {
        (p.abs() - HALF).max_element().max(HOLE - p.x.hypot(p.z))
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        let beyond = p.abs() - HALF;
        if HOLE - p.x.hypot(p.z) > beyond.max_element() {
            return -DVec3::new(p.x, 0.0, p.z).normalize_or_zero();
        }
        let axis = (0..3).fold(0, |best, axis| if beyond[axis] > beyond[best] { axis } else { best });
        DVec3::AXES[axis] * p[axis].signum()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let volume = 8.0 * HALF.x * HALF.y * HALF.z - std::f64::consts::PI * HOLE * HOLE * 2.0 * HALF.y;
    let mut shown = Vec::new();
    for side in [12, 24, 48] {
        let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.0), DVec3::splat(2.0 / f64::from(side - 1)))?;
        let samples = FieldSlabs::new(&Block, lattice);
        let nets = ManifoldSurfaceNets::new().convert(&samples)?.value;
        let sampled = DualContouring::new().convert(&samples)?.value;
        let exact = DualContouring::new().field(&Block, lattice, &Exec::default())?.value;
        let error = |mesh: &TriMesh| 100.0 * (mesh.volume() / volume - 1.0);
        println!(
            "{side}^3 samples, {} triangles: volume off by {:.3} % by surface nets, {:.4} % by dual contouring of the samples, \
             {:.4} % of the field",
            nets.triangles().len(),
            error(&nets),
            error(&sampled),
            error(&exact)
        );
        if side == 24 {
            shown = vec![moved(&nets, -1.05), moved(&exact, 1.05)];
        }
    }
    let picture = Picture { wires: true, ..Picture::new() };
    println!("{}", output.draw("dual_contouring", &Scene { surfaces: shown }, [-30.0, 30.0], picture)?.display());
    Ok(())
}

fn moved(mesh: &TriMesh, x: f64) -> SceneMesh {
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    SceneMesh::new(positions, mesh.triangles().to_vec())
}
