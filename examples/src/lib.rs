//! What the examples share: where they write, how they draw, how they measure. The examples themselves lie beside this
//! folder.

mod boxes;
mod grids;
mod measure;
mod rod;
mod slice;

pub use boxes::boxes;
pub use grids::{blocks, sampled};
pub use measure::{measure_patch, triangles_of_patch};
pub use rod::rod;
pub use slice::Slice;

use std::error::Error;
use std::path::PathBuf;

use shapeloom::core::Exec;
use shapeloom::core::glam::DVec3;
use shapeloom::render::{Picture, Scene, camera_from};

/// Where an example writes, and how large its pictures are.
#[derive(Clone, Debug)]
pub struct Output {
    /// The folder, made if missing: the first argument, or `out/examples`.
    pub folder: PathBuf,
    /// Pixels in a row of a picture: the second argument, or 320. Pictures are three quarters as high as wide.
    pub width: u32,
}

impl Output {
    /// What the program's arguments say.
    ///
    /// # Errors
    /// A width that is no whole number, or a folder that cannot be made.
    pub fn from_arguments() -> Result<Self, Box<dyn Error>> {
        let mut arguments = std::env::args_os().skip(1);
        let folder = arguments.next().map_or(PathBuf::from("out/examples"), PathBuf::from);
        let width = match arguments.next() {
            Some(word) => {
                word.to_string_lossy().parse().map_err(|_| format!("width: found {word:?}, expected pixels"))?
            }
            None => 320,
        };
        std::fs::create_dir_all(&folder)?;
        Ok(Self { folder, width })
    }

    /// Writes a file into the folder and says where it is.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, Box<dyn Error>> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes)?;
        Ok(path)
    }

    /// Draws a scene with z up, seen from an azimuth and elevation in degrees, as `NAME.png` in the folder.
    ///
    /// # Errors
    /// An empty scene, or a picture that cannot be written.
    pub fn draw(&self, name: &str, scene: &Scene, view: [f64; 2], look: Picture) -> Result<PathBuf, Box<dyn Error>> {
        let [azimuth, elevation] = view.map(f64::to_radians);
        let camera = camera_from(&scene.bounds(), DVec3::Z, azimuth, elevation, 4.0 / 3.0)?;
        let picture = Picture { width: self.width, height: self.width.div_ceil(4) * 3, ..look };
        let image = picture.draw(scene, &camera, DVec3::Z, &Exec::default())?;
        self.write(&format!("{name}.png"), &image.to_png()?)
    }
}
