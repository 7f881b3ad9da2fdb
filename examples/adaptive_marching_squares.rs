//! Level lines of two discs as one: R-functions of several α and a displaced blend. A torus, cut by planes and met by rays.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{Convert, Exec, Frame, Interval, Ray};
use shapeloom::implicit::{
    AdaptiveMarchingSquares, BlendForm, PlaneWindow, RayIntervals, SetOperation, SphereTracing, Tree, section,
};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::render::{Picture, Scene};
use shapeloom::shape::{Part, Shape};
use shapeloom_examples::{Output, rod};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let disc = |x: f64, radius: f64| Tree::circle(radius).translate(x, 0.0, 0.0);
    let alphas = [1.0, 0.5, 0.0];
    let mut forms: Vec<BlendForm> = alphas.map(|alpha| BlendForm::RFunction { alpha }).to_vec();
    forms.push(BlendForm::Displaced { alpha: 0.0, amount: 0.4, first: 0.5, second: 0.5 });

    let (mut scene, mut drawing) = (Scene::default(), Shape::default());
    println!("{:>28}  level  curves  points  cells", "blend");
    for (column, form) in forms.into_iter().enumerate() {
        let both = disc(-0.7, 0.8).blend(disc(0.75, 0.6), SetOperation::Union, form);
        let shift = DVec3::new((column % 2) as f64 * 4.3, (column / 2) as f64 * -3.1, 0.0);
        for level in [-0.4, -0.2, 0.0, 0.2, 0.4] {
            let program = (both.clone() - level).compile()?;
            let window = PlaneWindow::in_xy(&program, DVec2::new(-2.2, -1.5), DVec2::new(2.1, 1.5))?;
            let found = AdaptiveMarchingSquares::new(0.003).convert_with(&window, &exec)?;
            let count = |name: &str| found.report.find(name).unwrap_or(0.0);
            let name = format!("{form:?}").chars().take(28).collect::<String>();
            println!("{name:>28}  {level:5}  {:6}  {:6}  {:5}", count("curves"), count("points"), count("cells"));
            let (radius, color) = match level {
                0.0 => (0.04, [0.05, 0.05, 0.08]),
                below if below < 0.0 => (0.02, [0.75, 0.2, 0.08]),
                _ => (0.02, [0.1, 0.3, 0.7]),
            };
            for [a, b] in found.value.curves.iter().flat_map(|curve| curve.segments()) {
                scene.surfaces.push(rod(a + shift, b + shift, radius, color));
            }
            if column == 3 {
                let name = format!("level {level}");
                drawing.parts.extend(found.value.curves.into_iter().map(|curve| Part::new(curve).named(&name)));
            }
        }
    }
    let mut bytes = Vec::new();
    let _ = write(&drawing, format_by_id("svg")?, &WriteContext::default(), &mut bytes)?;
    println!("{}", output.write("adaptive_marching_squares.svg", &bytes)?.display());
    let look = Picture { ground: false, ..Picture::new() };
    println!("{}", output.draw("adaptive_marching_squares", &scene, [0.0, 90.0], look)?.display());

    let (major, minor): (f64, f64) = (2.0, 0.7);
    let torus = Tree::torus(major, minor).compile()?;
    let tilt = (minor / major).asin();
    for (name, toward) in [("level", DVec3::X), ("Villarceau's", DVec3::new(tilt.cos(), 0.0, tilt.sin()))] {
        let frame = Frame::new(DVec3::ZERO, DVec3::Y, toward)?;
        let found = section(&torus, frame, [DVec2::splat(-3.1), DVec2::splat(3.0)], 1e-3, &exec)?;
        let length: f64 = found.value.curves.iter().map(|curve| curve.length()).sum();
        println!("{name} plane: {} curves of length {length:.3}, {}", found.value.curves.len(), found.report.deviation);
    }
    let ray = Ray::new(DVec3::new(-4.0, 0.3, 0.1), DVec3::X)?.within(Interval::new(0.0, 8.0));
    let all = RayIntervals::new(1e-9).intersect(&torus, &ray, &exec)?;
    for crossing in &all.crossings {
        println!("{:?} at {:.12}, {:?}", crossing.kind(), crossing.distance, crossing.certainty);
    }
    let traced = SphereTracing::new(1e-9).trace(&torus, &ray, &exec)?;
    println!("sphere tracing: {} steps; intervals: {} pieces", traced.steps, all.steps);
    Ok(())
}
