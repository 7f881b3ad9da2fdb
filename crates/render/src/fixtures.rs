//! Inputs of tests.

use std::f64::consts::{PI, TAU};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Camera, Projection};

use crate::{Backdrop, Mode, Picture, Scene, SceneMesh};

/// A closed ball of radius 1 about the origin, outward, with smooth normals.
pub(crate) fn ball(rings: u32) -> SceneMesh {
    let sectors = 2 * rings;
    let mut positions = Vec::new();
    for ring in 0..=rings {
        for sector in 0..sectors {
            let (polar, turn) = (PI * f64::from(ring) / f64::from(rings), TAU * f64::from(sector) / f64::from(sectors));
            let level = if ring == 0 || ring == rings { 0.0 } else { polar.sin() };
            positions.push(DVec3::new(level * turn.cos(), level * turn.sin(), polar.cos()));
        }
    }
    let mut triangles = Vec::new();
    for (ring, sector) in (0..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector))) {
        let at = |ring: u32, sector: u32| ring * sectors + sector % sectors;
        let (a, b, c, d) = (at(ring, sector), at(ring, sector + 1), at(ring + 1, sector), at(ring + 1, sector + 1));
        triangles.extend([[a, c, d], [a, d, b]]);
    }
    let normals = triangles.iter().flatten().map(|&corner| positions[corner as usize]).collect();
    SceneMesh { normals: Some(normals), ..SceneMesh::new(positions, triangles) }
}

/// The square from -1 to 1 at z = 0, facing up, of two triangles.
pub(crate) fn square() -> SceneMesh {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    SceneMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])
}

pub(crate) fn scene(mesh: SceneMesh) -> Scene {
    Scene { surfaces: vec![mesh] }
}

/// A parallel view down the z axis; the picture shows `height` model units.
pub(crate) fn from_above(height: f64) -> Camera {
    let projection = Projection::Orthographic { height };
    Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, projection).expect("a view")
}

/// A small matt picture without shadows, on white.
pub(crate) fn plain(width: u32, height: u32) -> Picture {
    Picture {
        width,
        height,
        mode: Mode::Flat,
        ambient_rays: 0,
        shadow_rays: 0,
        ground: false,
        backdrop: Backdrop::White,
        ..Picture::new()
    }
}
