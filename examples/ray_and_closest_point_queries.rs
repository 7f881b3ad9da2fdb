//! Rays and closest points of a mesh: a picture by first hits and occlusion, and the distance to the mesh on a plane.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{ClosestPoint, Convert, Exec, Ray, Rays};
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::parametric::{BezierSurface, TessellatePatches};
use shapeloom::render::{Image, camera_from};
use shapeloom::shape::Representation;
use shapeloom::spatial::TriangleBvh;
use shapeloom_examples::Output;

/// Rays to the sky from each point that is seen.
const SKY: u32 = 64;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/teapot.bpt");
    let teapot = read(&std::fs::read(path)?, format_by_id("bpt")?, &ReadContext::named("teapot.bpt"))?.shape;
    let mesh = TessellatePatches::new(0.002).convert(BezierSurface::from_geometry(&teapot.parts[0].geometry)?)?.value;
    let (positions, triangles) = (mesh.positions(), mesh.triangles());
    let bvh = TriangleBvh::build(positions, triangles, &exec)?;
    let (half, height) = (output.width / 2, output.width * 3 / 8);
    let pixels = || (0..half * height).map(|k| DVec2::new(f64::from(k % half), f64::from(k / half)) + 0.5);
    let size = DVec2::new(f64::from(half), f64::from(height));

    // The left half: what a camera sees, each point as bright as the part of the sky that it sees.
    let camera = camera_from(&bvh.bounds(), DVec3::Z, 0.5, 0.5, size.x / size.y)?;
    let rays: Vec<Ray> = pixels().map(|pixel| camera.ray(pixel, size)).collect();
    let mut hits = vec![None; rays.len()];
    bvh.first_hits(&rays, &mut hits, &exec)?;
    let mut sky = Vec::new();
    for (ray, hit) in rays.iter().zip(&hits) {
        let Some(hit) = hit else { continue };
        let [a, b, c] = triangles[hit.element as usize].map(|corner| positions[corner as usize]);
        let normal = (b - a).cross(c - a).normalize() * if hit.back { -1.0 } else { 1.0 };
        let (s, t) = normal.any_orthonormal_pair();
        for k in 0..SKY {
            // Spread over the hemisphere as light falls on a matt surface.
            let (sin, cos) = (TAU * (f64::from(k) * 0.618_034).fract()).sin_cos();
            let radius = ((f64::from(k) + 0.5) / f64::from(SKY)).sqrt();
            let up = normal * (1.0 - radius * radius).sqrt() + s * (radius * cos) + t * (radius * sin);
            sky.push(Ray::new(ray.at(hit.distance) + normal * 1e-3, up)?);
        }
    }
    let mut met = vec![false; sky.len()];
    bvh.any_hits(&sky, &mut met, &exec)?;
    println!("{} rays from the eye, {} from what it sees to the sky", rays.len(), sky.len());

    // The right half: the distance to the mesh on the upright plane through the spout, a line for each 0.2.
    let (center, scale) = (bvh.bounds().center(), 8.0 / size.x);
    let place = |pixel: DVec2| center + DVec3::new(pixel.x - size.x / 2.0, 0.0, size.y / 2.0 - pixel.y) * scale;
    let places: Vec<DVec3> = pixels().map(place).collect();
    let mut closest = vec![None; places.len()];
    bvh.closest_points(&places, &mut closest, &exec)?;

    let mut open =
        met.chunks(SKY as usize).map(|rays| rays.iter().filter(|&&met| !met).count() as f64 / f64::from(SKY));
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (hit, closest) in hits.iter().zip(&closest) {
        let light = hit.and_then(|_| open.next()).unwrap_or(1.0).powf(0.45);
        left.push([(light * 255.0) as u8; 3]);
        let distance = closest.map_or(0.0, |found| found.distance_squared.sqrt());
        let line = if (distance * 5.0).fract() < 0.1 { 0.6 } else { 1.0 };
        right.push([0.2 + 0.3 * distance, 0.4 + 0.2 * distance, 0.75].map(|part| (part * line * 255.0) as u8));
    }
    let rows = left.chunks(half as usize).zip(right.chunks(half as usize));
    let pixels = rows.flat_map(|(left, right)| [left, right].concat()).map(|[r, g, b]| [r, g, b, 255]).collect();
    let image = Image::try_new(2 * half, height, pixels).ok_or("the pixels fill the picture")?;
    println!("{}", output.write("ray_and_closest_point_queries.png", &image.to_png()?)?.display());
    Ok(())
}
