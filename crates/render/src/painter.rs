//! The rays of a picture: what each pixel sees and what light falls there.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Camera, Frame, Hit, Projection, Ray};

use crate::film::{Film, Pixel, REACH, Seen, add};
use crate::light::{KEY_SLOPE, Lights, back_color};
use crate::sampling::{cone_direction, cosine_direction, hash, shift, spread};
use crate::stage::Stage;
use crate::surface_point::SurfacePoint;
use crate::{Backdrop, Mode, Picture, wire};

/// The width of the filter.
pub(crate) const TILE: u32 = 2 * REACH as u32 + 1;
/// Lines on surfaces.
const LINE: DVec3 = DVec3::new(0.015, 0.022, 0.04);
/// Lines alone, and what they are drawn on.
pub(crate) const INK: DVec3 = DVec3::new(0.012, 0.045, 0.16);
const PAPER: DVec3 = DVec3::new(0.86, 0.88, 0.90);

/// What all samples of a picture share.
pub(crate) struct Painter<'a> {
    options: &'a Picture,
    stage: &'a Stage<'a>,
    camera: &'a Camera,
    size: DVec2,
    up: DVec3,
    lights: Lights,
    /// Directions to the surroundings, about the third axis, and directions to the key.
    around: Vec<DVec3>,
    to_key: Vec<DVec3>,
    center: DVec3,
    diagonal: f64,
    /// The height of the ground along `up`, where it is drawn.
    ground: Option<f64>,
    /// The nearest and farthest depth of the shape's box.
    depths: (f64, f64),
}

impl<'a> Painter<'a> {
    /// Prepares the tables of directions, the lights and the ground. `up` is a unit vector.
    pub fn new(options: &'a Picture, stage: &'a Stage<'a>, camera: &'a Camera, up: DVec3) -> Self {
        let bounds = stage.bounds;
        let size = DVec2::new(f64::from(options.width), f64::from(options.height));
        let lowest = bounds.corners().iter().map(|corner| corner.dot(up)).fold(f64::INFINITY, f64::min);
        let ground = lowest - stage.lift;
        let lit = matches!(options.mode, Mode::Shaded | Mode::Flat);
        let wanted = options.ground && lit && options.backdrop != Backdrop::Transparent;
        let depths = bounds.corners().map(|corner| camera.project(corner, size).depth);
        // A point has no size to measure by; any positive number serves.
        let diagonal = if bounds.diagonal() > 0.0 { bounds.diagonal() } else { 1.0 };
        let lights = Lights::new(camera, up);
        let start = |stream: u32| shift(hash(options.seed, stream));
        let [x, y, z] = Frame::with_normal(DVec3::ZERO, lights.key).axes();
        let around = |ray| cosine_direction(spread(ray, start(1)));
        let to_key = |ray| {
            let local = cone_direction(KEY_SLOPE, spread(ray, start(2)));
            x * local.x + y * local.y + z * local.z
        };
        Self {
            options,
            stage,
            camera,
            size,
            up,
            lights,
            around: (0..TILE * TILE * options.ambient_rays).map(around).collect(),
            to_key: (0..TILE * TILE * options.shadow_rays).map(to_key).collect(),
            center: bounds.center(),
            diagonal,
            ground: (wanted && camera.eye().dot(up) > ground).then_some(ground),
            depths: (
                depths.into_iter().fold(f64::INFINITY, f64::min),
                depths.into_iter().fold(f64::NEG_INFINITY, f64::max),
            ),
        }
    }

    /// The film over finished pixels.
    pub fn film<'b>(&self, pixels: &'b [Pixel], width: usize) -> Film<'b> {
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

    /// Casts the rays of a pixel.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        let side = self.options.samples;
        let count = side * side;
        let run = run(x, y);
        let mut pixel = Pixel::default();
        for sample in 0..count {
            let place = DVec2::new(f64::from(sample % side) + 0.5, f64::from(sample / side) + 0.5) / f64::from(side);
            let at = DVec2::new(f64::from(x), f64::from(y)) + place;
            // The rays of a pixel are dealt out to its samples.
            let deal = |rays: u32| run * rays + rays * sample / count..run * rays + rays * (sample + 1) / count;
            let rays = Dealt { ambient: deal(self.options.ambient_rays), key: deal(self.options.shadow_rays) };
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
        let front = match &mesh.colors {
            Some(colors) => {
                let [a, b, c] =
                    mesh.triangles[triangle].map(|corner| DVec3::from_array(colors[corner as usize].map(f64::from)));
                a + (b - a) * hit.parameters.x + (c - a) * hit.parameters.y
            }
            None => DVec3::from_array(mesh.color.map(f64::from)),
        };
        let front = front.max(DVec3::ZERO);
        // Colours that say something say it on both sides.
        let back = hit.back && self.options.show_back && mesh.colors.is_none();
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
        let out_of_reach = self.stage.bounds.distance_squared(from) > self.diagonal * self.diagonal;
        let [x, y, z] = Frame::with_normal(from, point.normal).axes();
        for ray in rays.ambient.clone() {
            seen.ambient_rays += 1.0;
            if out_of_reach {
                seen.ambient_free += 1.0;
                continue;
            }
            let local = self.around[ray as usize];
            let direction = x * local.x + y * local.y + z * local.z;
            if !self.stage.shadowed(from, direction, self.diagonal) {
                seen.ambient_free += self.ground_light(from, direction);
            }
        }
        // What faces away from the key gets none of it anyway.
        if point.normal.dot(self.lights.key) <= 0.0 {
            return;
        }
        for ray in rays.key.clone() {
            let hidden = self.stage.shadowed(from, self.to_key[ray as usize], f64::INFINITY);
            seen.key_rays += 1.0;
            seen.key_free += if hidden { 0.0 } else { 1.0 };
        }
    }

    /// The part of the surroundings' light that comes along a free ray: less from the ground close by, which lies in the
    /// shape's own shade.
    fn ground_light(&self, from: DVec3, direction: DVec3) -> f32 {
        let fall = -direction.dot(self.up);
        let Some(ground) = self.ground.filter(|_| fall > 0.0) else { return 1.0 };
        let distance = (from.dot(self.up) - ground) / fall / self.diagonal;
        (0.25 + 0.75 * distance / (distance + 0.12)) as f32
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

/// Which run of the tables belongs to a pixel.
///
/// Pixels of a tile as wide as the filter share one sequence, each a run of it: the filter sees all of it wherever it
/// stands, so that its result has no noise where nothing stops it.
fn run(x: u32, y: u32) -> u32 {
    x % TILE + TILE * (y % TILE)
}

/// The rays that a sample casts, by their numbers in the tables.
struct Dealt {
    ambient: std::ops::Range<u32>,
    key: std::ops::Range<u32>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_filter_sees_every_run_once_wherever_it_stands() {
        for (left, top) in [(0, 0), (3, 11), (100, 6)] {
            let seen: BTreeSet<u32> = (0..TILE * TILE).map(|i| run(left + i % TILE, top + i / TILE)).collect();
            assert!(seen.into_iter().eq(0..TILE * TILE));
        }
    }
}
