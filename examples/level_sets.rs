//! Two level sets made one, in several ways; how far a cube's edges stay open on a lattice.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Affine, AxisAngle, Exec, Field};
use shapeloom::isosurface::{Inside, Level};
use shapeloom::render::{Picture, Scene};
use shapeloom::voxels::{Blend, GridField, Interpolation, blend};
use shapeloom_examples::{Output, blocks, sampled};

fn cube(p: DVec3) -> f64 {
    let q = p.abs() - DVec3::splat(0.45);
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let a = sampled(56, 1.0, |p| cube(p + DVec3::new(0.25, 0.0, 0.25)))?;
    let b = sampled(56, 1.0, |p| p.distance(DVec3::new(0.3, 0.0, 0.3)) - 0.5)?;
    let ways = [
        Blend::Union,
        Blend::SmoothUnion { radius: 0.4 },
        Blend::Difference,
        Blend::Intersection,
        Blend::Morph { fraction: 0.5 },
    ];
    let mut scene = Scene::default();
    for (place, how) in ways.into_iter().enumerate() {
        let shift = DVec3::X * 1.45 * (place as f64 - 2.0);
        scene.surfaces.push(blocks(&blend(&a, &b, how, &exec)?, shift, [0.45, 0.65, 0.5])?);
    }
    println!("{}", output.draw("level_sets", &scene, [0.0, 15.0], Picture::new())?.display());

    println!("how far the zeros stay from a cube's edges and corners, in cells");
    for interpolation in [Interpolation::Trilinear, Interpolation::Tricubic] {
        for count in [16, 32, 64] {
            let [edge, corner] = aliasing(count, interpolation)?;
            println!("{interpolation:?} {count}^3: edges {edge:.2}, corners {corner:.2}");
        }
    }
    Ok(())
}

/// The largest gaps over several turns of the cube, from its edges and corners inward to the first zero.
fn aliasing(count: u32, interpolation: Interpolation) -> Result<[f64; 2], Box<dyn Error>> {
    let mut worst = [0.0f64; 2];
    for turn in 0..6 {
        let axis = DVec3::new(1.0, 2.0, f64::from(turn));
        let turn = Affine::from_rotation(AxisAngle::new(axis, f64::from(turn) * 0.37)?);
        let back = turn.inverse()?;
        let grid = sampled(count, 1.0, |p| cube(back.point(p)))?;
        let spacing = grid.lattice().spacing().x;
        let level = Level { iso: 0.0, inside: Inside::Below };
        let field = GridField::try_new(&grid, level, interpolation, &Exec::default())?;
        let gap = |place: DVec3, inward: DVec3| {
            let at = |k: u32| turn.point(place + inward.normalize() * spacing * f64::from(k) / 200.0);
            (0..600).find(|&k| field.value(at(k)) <= 0.0).map_or(f64::INFINITY, |k| f64::from(k) / 200.0)
        };
        for k in 0..=80 {
            let place = DVec3::new(-0.4 + 0.01 * f64::from(k), 0.45, 0.45);
            worst[0] = worst[0].max(gap(place, DVec3::new(0.0, -1.0, -1.0)));
        }
        worst[1] = worst[1].max(gap(DVec3::splat(0.45), DVec3::NEG_ONE));
    }
    Ok(worst)
}
