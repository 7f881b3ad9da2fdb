//! Distances made of samples that are none, and how fast the error falls with the spacing.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::render::{Picture, Scene};
use shapeloom::voxels::{Redistance, VoxelGrid};
use shapeloom_examples::{Output, blocks, sampled};

fn torus(p: DVec3) -> f64 {
    (p.x.hypot(p.y) - 0.55).hypot(p.z) - 0.2
}

fn cuboid(p: DVec3) -> f64 {
    let q = p.abs() - DVec3::new(0.61, 0.52, 0.43);
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // The right sign and zeros, but slopes between 0.7 and 2.3.
    let bent = |p: DVec3| 1.5 + (3.0 * p.x).sin() * 0.5 + p.z * 0.3;
    type Shape = fn(DVec3) -> f64;
    let shapes: [(&str, Shape); 3] = [("ball", |p| p.length() - 0.7), ("torus", torus), ("box", cuboid)];
    for (name, shape) in shapes {
        let mut before = f64::NAN;
        for count in [16, 32, 64] {
            let found = Redistance::new().convert(&sampled(count, 1.0, |p| bent(p) * shape(p))?)?;
            let error = worst(&found.value, shape);
            println!("{name:>6} {count:>3}^3: largest error {error:.1e}, order {:.2}", (before / error).log2());
            before = error;
        }
    }

    // The same level of both: of the bent samples an egg, of the distances a torus that is thicker everywhere.
    let source = sampled(48, 1.0, |p| bent(p) * torus(p) - 0.1)?;
    let distances = Redistance::new().convert(&sampled(48, 1.0, |p| bent(p) * torus(p))?)?.value;
    let thicker = sampled(48, 1.0, |p| f64::from(nearest(&distances, p)) - 0.1)?;
    let scene = Scene {
        surfaces: vec![
            blocks(&source, DVec3::X * -1.0, [0.8, 0.5, 0.3])?,
            blocks(&thicker, DVec3::X * 1.0, [0.4, 0.6, 0.8])?,
        ],
    };
    println!("{}", output.draw("redistance", &scene, [0.0, 35.0], Picture::new())?.display());
    Ok(())
}

fn worst(grid: &VoxelGrid, truth: impl Fn(DVec3) -> f64) -> f64 {
    let lattice = grid.lattice();
    let error = |at: u64| {
        let wanted = truth(lattice.position(lattice.coordinates(at)));
        (f64::from(grid.samples().get(at)) - wanted).abs()
    };
    (0..lattice.samples()).map(error).fold(0.0, f64::max)
}

fn nearest(grid: &VoxelGrid, p: DVec3) -> f32 {
    let at = ((p + 1.0) / grid.lattice().spacing()).round();
    grid.sample([at.x as u32, at.y as u32, at.z as u32])
}
