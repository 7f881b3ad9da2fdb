//! Numbers over a plane, as a grid of coloured squares.

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::render::SceneMesh;

/// A part of a plane of equal z, in squares.
#[derive(Clone, Copy, Debug)]
pub struct Slice {
    /// The corner with the smallest x and y.
    pub from: DVec2,
    /// The opposite corner.
    pub to: DVec2,
    /// The z of the plane.
    pub height: f64,
    /// How many squares lie along x.
    pub columns: usize,
}

impl Slice {
    fn side(&self) -> f64 {
        (self.to.x - self.from.x) / self.columns as f64
    }

    /// The centres of the squares, row by row.
    pub fn points(&self) -> Vec<DVec3> {
        let rows = ((self.to.y - self.from.y) / self.side()).ceil() as usize;
        let place = |i: usize| DVec2::new((i % self.columns) as f64 + 0.5, (i / self.columns) as f64 + 0.5);
        (0..rows * self.columns).map(|i| (self.from + place(i) * self.side()).extend(self.height)).collect()
    }

    /// The squares in as many colours, one surface each: `shade` says where a number lies between warm (0), pale (1/2)
    /// and blue (1).
    pub fn colored(&self, numbers: &[f64], shade: impl Fn(f64) -> f64, colors: usize) -> Vec<SceneMesh> {
        let mut meshes: Vec<SceneMesh> = (0..colors)
            .map(|i| {
                let color = color(i as f64 / (colors.max(2) - 1) as f64);
                SceneMesh { color, ..SceneMesh::new(Vec::new(), Vec::new()) }
            })
            .collect();
        let half = self.side() * 0.5;
        for (&point, &number) in self.points().iter().zip(numbers) {
            let place = shade(number).clamp(0.0, 1.0) * (colors.max(1) - 1) as f64;
            if let Some(mesh) = meshes.get_mut(place.round() as usize) {
                let first = mesh.positions.len() as u32;
                let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
                mesh.positions.extend(corners.map(|(x, y)| point + DVec3::new(x, y, 0.0)));
                mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
        meshes.retain(|mesh| !mesh.triangles.is_empty());
        meshes
    }
}

/// Warm, pale, blue, in linear sRGB.
fn color(at: f64) -> [f32; 3] {
    let (warm, pale, blue) = ([0.60, 0.13, 0.03], [0.75, 0.72, 0.66], [0.03, 0.15, 0.50]);
    let (from, to, part) = if at < 0.5 { (warm, pale, at * 2.0) } else { (pale, blue, at * 2.0 - 1.0) };
    std::array::from_fn(|i| (from[i] * (1.0 - part) + to[i] * part) as f32)
}
