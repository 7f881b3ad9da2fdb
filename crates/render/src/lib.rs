//! Pictures of triangle meshes on the CPU, by ray casting: no display, no graphics driver, the same bytes for any number
//! of threads.
//!
//! A [`Scene`] is triangles with colours, made by hand or from a shape by [`scene_of_shape`]; [`sensible_camera`] finds a
//! view of it; [`Picture`] holds how it is drawn; the [`Image`] is encoded by [`Image::to_png`].
//!
//! ```
//! use shapeloom_core::Exec;
//! use shapeloom_core::glam::DVec3;
//! use shapeloom_render::{Picture, Scene, SceneMesh, sensible_camera};
//!
//! let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let scene = Scene { surfaces: vec![SceneMesh::new(positions, triangles)] };
//! let camera = sensible_camera(&scene.bounds(), DVec3::Z, 4.0 / 3.0)?;
//! let picture = Picture { width: 80, height: 60, ..Picture::new() };
//! let image = picture.draw(&scene, &camera, DVec3::Z, &Exec::default())?;
//! assert_eq!(image.pixels().len(), 80 * 60);
//! let png: Vec<u8> = image.to_png()?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod color_map;
mod error;
mod film;
#[cfg(test)]
mod fixtures;
mod image;
mod light;
mod painter;
mod picture;
mod refine;
mod sampling;
mod scene;
mod shape_scene;
mod stage;
mod surface_point;
mod tone;
mod views;
mod wire;

pub use crate::image::Image;
pub use color_map::sequential_color;
pub use error::RenderError;
pub use picture::{Backdrop, Mode, Picture};
pub use refine::Refinement;
pub use scene::{Scene, SceneMesh};
pub use shape_scene::scene_of_shape;
pub use views::{camera_from, sensible_camera, turntable};
