//! Pictures by ray casting.

use std::sync::atomic::{AtomicUsize, Ordering};

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Bounds, Camera, Exec, Hit, Options, Projection, Ray, choice, options, parallel};

use crate::film::{Film, Pixel, REACH, Seen, add};
use crate::light::{KEY_SLOPE, Lights, back_color};
use crate::sampling::{cone_direction, cosine_direction, hash, shift, spread};
use crate::stage::Stage;
use crate::surface_point::SurfacePoint;
use crate::{Image, RenderError, Scene, wire};

choice! {
    /// How surfaces appear.
    pub enum Mode {
        /// Smooth, with interpolated normals and the shine of a glaze.
        Shaded = "shaded",
        /// Each triangle by its own normal, matt.
        Flat = "flat",
        /// The sides of triangles as lines on white; what lies behind is hidden.
        Wire = "wire",
        /// Near is light and far is dark, linear in the depth over the box of the shape.
        Depth = "depth",
    }
}

choice! {
    /// What stands behind the shape.
    pub enum Backdrop {
        /// A pale gradient, lighter in the middle.
        Studio = "studio",
        /// White.
        White = "white",
        /// A dark gradient.
        Dark = "dark",
        /// Nothing: the picture is transparent around the shape and the ground is left out.
        Transparent = "transparent",
    }
}

options! {
    /// Draws triangles by ray casting, in soft studio light.
    ///
    /// Primary rays are exact: no gap shows between triangles that share corners. Shadow rays are few and smoothed over
    /// neighbouring pixels. The same options give the same bytes for any number of threads. Cost: about
    /// `width * height * samples²` rays, and `ambient_rays + shadow_rays` more for each pixel that shows the shape or
    /// the ground near it. Memory: 120 bytes a pixel for 256 rows, 4 bytes a pixel for the others, and the hierarchy.
    pub struct Picture("picture") {
        required {}
        optional {
            /// Pixels in a row.
            width: u32 [Bounds::closed(1.0, 16384.0)] = 1280,
            /// Rows of pixels.
            height: u32 [Bounds::closed(1.0, 16384.0)] = 960,
            /// Samples along each side of a pixel: 3 makes nine a pixel.
            samples: u32 [Bounds::closed(1.0, 16.0)] = 3,
            /// How surfaces appear.
            mode: Mode = Mode::Shaded,
            /// Whether the sides of triangles are drawn over shaded and flat surfaces.
            wires: bool = false,
            /// The width of lines in pixels.
            wire_width: f64 [Bounds::closed(0.1, 100.0)] = 1.2,
            /// Rays a pixel that look how much of the surroundings is hidden (ambient occlusion); 0 hides nothing.
            ambient_rays: u32 [Bounds::closed(0.0, 4096.0)] = 16,
            /// Rays a pixel to the key light; 0 casts no shadows.
            shadow_rays: u32 [Bounds::closed(0.0, 4096.0)] = 8,
            /// Whether back faces have a colour of their own.
            show_back: bool = true,
            /// Whether the shape stands on a ground that shows its shadow. Not drawn from below.
            ground: bool = true,
            /// What stands behind the shape.
            backdrop: Backdrop = Backdrop::Studio,
            /// Changes the random part of shadow rays.
            seed: u32 = 0,
        }
    }
}

/// Rows that are in memory at a time.
const BAND: usize = 256;
/// Pixels between two polls: about a millisecond.
const CHUNK: usize = 128;
/// Lines on surfaces.
const LINE: DVec3 = DVec3::new(0.015, 0.022, 0.04);
/// Lines alone, and what they are drawn on.
const INK: DVec3 = DVec3::new(0.012, 0.045, 0.16);
const PAPER: DVec3 = DVec3::new(0.86, 0.88, 0.90);

impl Picture {
    /// Draws the scene as the camera sees it. `up` says where the ground lies and where light comes from.
    ///
    /// # Errors
    /// An option out of range, an empty or malformed scene, an `up` without a length, too little memory in the budget,
    /// or the reason to stop.
    pub fn draw(&self, scene: &Scene, camera: &Camera, up: DVec3, exec: &Exec) -> Result<Image, RenderError> {
        self.validate()?;
        exec.check()?;
        let up = up.try_normalize().ok_or(RenderError::Up { found: up })?;
        let (width, height) = (self.width as usize, self.height as usize);
        let _image_memory = exec.reserve_elements((width * height) as u64, size_of::<[u8; 4]>())?;
        let band_rows = BAND.min(height) + 2 * REACH;
        let _band_memory = exec.reserve_elements((width * band_rows) as u64, size_of::<Pixel>())?;
        let stage = Stage::new(scene, &exec.part(0.0, 0.1))?;
        let painter = Painter::new(self, &stage, camera, up);
        let mut bytes = vec![[0u8; 4]; width * height];
        let mut pixels = vec![Pixel::default(); width * band_rows.min(height)];
        let done = AtomicUsize::new(0);
        let rest = exec.part(0.1, 1.0);
        for (band, out) in bytes.chunks_mut(BAND * width).enumerate() {
            // The filter looks beyond the band; rows are drawn twice there.
            let first = (band * BAND).saturating_sub(REACH);
            let last = (band * BAND + out.len() / width + REACH).min(height);
            let pixels = &mut pixels[..(last - first) * width];
            parallel::fill_chunks(exec, pixels, CHUNK, |start, part| {
                for (i, pixel) in part.iter_mut().enumerate() {
                    let (x, y) = ((start + i) % width, first + (start + i) / width);
                    *pixel = painter.pixel(x as u32, y as u32);
                }
                let count = done.fetch_add(part.len(), Ordering::Relaxed) + part.len();
                rest.progress(count as f64 / (width * height) as f64);
                Ok::<(), RenderError>(())
            })?;
            let film = painter.film(pixels, width);
            let offset = band * BAND - first;
            parallel::fill_chunks(exec, out, CHUNK * 8, |start, part| {
                for (i, bytes) in part.iter_mut().enumerate() {
                    let (x, y) = ((start + i) % width, offset + (start + i) / width);
                    *bytes = match self.backdrop {
                        Backdrop::Transparent => film.resolve_cut_out(x, y),
                        _ => film.resolve(x, y),
                    };
                }
                Ok::<(), RenderError>(())
            })?;
        }
        exec.progress(1.0);
        Ok(Image::try_new(self.width, self.height, bytes).expect("one pixel for each place"))
    }
}

/// What all samples of a picture share.
struct Painter<'a> {
    options: &'a Picture,
    stage: &'a Stage<'a>,
    camera: &'a Camera,
    size: DVec2,
    up: DVec3,
    lights: Lights,
    center: DVec3,
    diagonal: f64,
    /// The height of the ground along `up`, where it is drawn.
    ground: Option<f64>,
    /// The nearest and farthest depth of the shape's box.
    depths: (f64, f64),
}

impl<'a> Painter<'a> {
    fn new(options: &'a Picture, stage: &'a Stage<'a>, camera: &'a Camera, up: DVec3) -> Self {
        let bounds = stage.bounds;
        let size = DVec2::new(f64::from(options.width), f64::from(options.height));
        let lowest = bounds.corners().iter().map(|corner| corner.dot(up)).fold(f64::INFINITY, f64::min);
        let ground = lowest - stage.lift;
        let lit = matches!(options.mode, Mode::Shaded | Mode::Flat);
        let wanted = options.ground && lit && options.backdrop != Backdrop::Transparent;
        let depths = bounds.corners().map(|corner| camera.project(corner, size).depth);
        // A point has no size to measure by; any positive number serves.
        let diagonal = if bounds.diagonal() > 0.0 { bounds.diagonal() } else { 1.0 };
        Self {
            options,
            stage,
            camera,
            size,
            up,
            lights: Lights::new(camera, up),
            center: bounds.center(),
            diagonal,
            ground: (wanted && camera.eye().dot(up) > ground).then_some(ground),
            depths: (
                depths.into_iter().fold(f64::INFINITY, f64::min),
                depths.into_iter().fold(f64::NEG_INFINITY, f64::max),
            ),
        }
    }

    fn film<'b>(&self, pixels: &'b [Pixel], width: usize) -> Film<'b> {
        let (view_height, eye) = match self.camera.projection() {
            Projection::Perspective { fov_y } => {
                let eye = ((self.camera.eye() - self.center) / self.diagonal).to_array().map(|x| x as f32);
                (2.0 * (fov_y / 2.0).tan(), Some(eye))
            }
            Projection::Orthographic { height } => (height / self.diagonal, None),
        };
        let lit = matches!(self.options.mode, Mode::Shaded | Mode::Flat);
        let smooth = lit && self.options.ambient_rays + self.options.shadow_rays > 0;
        Film { pixels, width, footprint: (view_height / self.size.y) as f32, eye, smooth }
    }

    fn pixel(&self, x: u32, y: u32) -> Pixel {
        let side = self.options.samples;
        let count = side * side;
        let random = hash(x, y, self.options.seed);
        let shifts = [shift(random), shift(hash(y, x, !self.options.seed))];
        let mut pixel = Pixel::default();
        for sample in 0..count {
            let place = DVec2::new(f64::from(sample % side) + 0.5, f64::from(sample / side) + 0.5) / f64::from(side);
            let at = DVec2::new(f64::from(x), f64::from(y)) + place;
            // The rays of a pixel are dealt out to its samples.
            let deal = |rays: u32| rays * sample / count..rays * (sample + 1) / count;
            let rays = Dealt { ambient: deal(self.options.ambient_rays), key: deal(self.options.shadow_rays), shifts };
            let ray = self.camera.ray(at, self.size);
            match self.stage.first_hit(&ray) {
                Some(hit) => self.surface(&mut pixel, at, &ray, &hit, &rays),
                None => self.beyond(&mut pixel, at, &ray, &rays),
            }
        }
        pixel
    }

    fn surface(&self, pixel: &mut Pixel, at: DVec2, ray: &Ray, hit: &Hit, rays: &Dealt) {
        let point = self.stage.surface_point(ray, hit, self.options.mode == Mode::Shaded);
        let (mesh, triangle) = self.stage.owner(hit.element);
        let front = DVec3::from_array(mesh.color.map(f64::from)).max(DVec3::ZERO);
        let back = hit.back && self.options.show_back;
        let color = if back { back_color(front) } else { front };
        pixel.surface += 1.0;
        let line = if self.options.wires || self.options.mode == Mode::Wire {
            let sides = mesh.edges.as_ref().map_or([true; 3], |edges| edges[triangle]);
            let corners = self.stage.corners(hit.element);
            wire::coverage(self.camera, self.size, at, &corners, hit, sides, self.options.wire_width)
        } else {
            0.0
        };
        match self.options.mode {
            Mode::Wire => {
                let paper = PAPER * if back { color * 0.6 + DVec3::splat(0.4) } else { DVec3::ONE };
                let paper = paper * (0.80 + 0.20 * point.normal.dot(point.to_viewer).max(0.0));
                add(&mut pixel.fixed, paper.lerp(INK, line));
            }
            Mode::Depth => {
                let depth = self.camera.project(point.position, self.size).depth;
                let (near, far) = self.depths;
                let part = if far > near { ((depth - near) / (far - near)).clamp(0.0, 1.0) } else { 0.0 };
                add(&mut pixel.fixed, DVec3::splat(0.69 - 0.67 * part).lerp(LINE, line));
            }
            Mode::Shaded | Mode::Flat => {
                let parts = self.lights.shade(&point, color, self.options.mode == Mode::Shaded);
                // Lines cover most of the surface below, so that its light still shows in them.
                let cover = 0.85 * line;
                add(&mut pixel.fixed, LINE * cover);
                add(&mut pixel.ambient, parts.ambient * (1.0 - cover));
                add(&mut pixel.key, parts.key * (1.0 - cover));
                let away = point.smooth_position + point.facet * self.stage.lift;
                self.look(&mut pixel.seen[0], away, &point, rays);
                add(&mut pixel.place, (point.position - self.center) / self.diagonal);
                add(&mut pixel.normal, point.normal);
            }
        }
    }

    /// Looks from a place to the surroundings and the key light.
    fn look(&self, seen: &mut Seen, from: DVec3, point: &SurfacePoint, rays: &Dealt) {
        for ray in rays.ambient.clone() {
            let direction = cosine_direction(point.normal, spread(ray, rays.shifts[0]));
            let hidden = self.stage.shadowed(from, direction, self.diagonal);
            seen.ambient_rays += 1.0;
            seen.ambient_free += if hidden { 0.0 } else { 1.0 };
        }
        // What faces away from the key gets none of it anyway.
        if point.normal.dot(self.lights.key) <= 0.0 {
            return;
        }
        for ray in rays.key.clone() {
            let direction = cone_direction(self.lights.key, KEY_SLOPE, spread(ray, rays.shifts[1]));
            seen.key_rays += 1.0;
            seen.key_free += if self.stage.shadowed(from, direction, f64::INFINITY) { 0.0 } else { 1.0 };
        }
    }

    /// A ray that meets no surface: the ground near the shape, or the background.
    fn beyond(&self, pixel: &mut Pixel, at: DVec2, ray: &Ray, rays: &Dealt) {
        let color = self.background(at);
        let fall = ray.direction().dot(self.up);
        let place = self.ground.filter(|_| fall < 0.0).map(|ground| {
            let distance = (ground - ray.origin().dot(self.up)) / fall;
            ray.at(distance)
        });
        // Shadows are too faint to see farther out.
        let far = place.map_or(f64::INFINITY, |place| place.distance(self.center) / self.diagonal);
        match place.filter(|_| far < 4.0) {
            Some(place) => {
                let point = SurfacePoint {
                    position: place,
                    facet: self.up,
                    normal: self.up,
                    smooth_position: place,
                    to_viewer: -ray.direction(),
                };
                pixel.ground += 1.0;
                add(&mut pixel.ground_color, color);
                self.look(&mut pixel.seen[1], place, &point, rays);
            }
            None => {
                pixel.empty += 1.0;
                add(&mut pixel.empty_color, color);
            }
        }
    }

    fn background(&self, at: DVec2) -> DVec3 {
        let place = at / self.size;
        let off_center = (place - DVec2::new(0.5, 0.55)) * DVec2::new(1.0, 1.15);
        let glow = (1.0 - 1.6 * off_center.length_squared()).max(0.0);
        match self.options.backdrop {
            Backdrop::White | Backdrop::Transparent => DVec3::ONE,
            Backdrop::Studio => DVec3::new(0.52, 0.56, 0.61).lerp(DVec3::new(0.86, 0.87, 0.88), glow),
            Backdrop::Dark => DVec3::new(0.010, 0.012, 0.016).lerp(DVec3::new(0.055, 0.062, 0.075), glow),
        }
    }
}

/// The rays that a sample casts of its pixel's, and the pixel's random shifts.
struct Dealt {
    ambient: std::ops::Range<u32>,
    key: std::ops::Range<u32>,
    shifts: [DVec2; 2],
}
