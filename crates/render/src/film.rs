//! What the samples of a pixel add up to, and how pixels become bytes.
//!
//! Shadow rays are few and random, so what they see is kept apart from the colours and smoothed over neighbouring pixels
//! of the same surface before both are joined (a joint bilateral filter: Eisemann and Durand 2004, Petschnigg et al.
//! 2004). Colours, lines and outlines stay sharp.

use shapeloom_core::glam::{DVec2, DVec3};

use crate::tone::{srgb, tone};

/// The filter reaches this many pixels.
pub(crate) const REACH: usize = 3;

/// The sums over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pixel {
    /// How many samples met the shape, the ground, nothing.
    pub surface: f32,
    pub ground: f32,
    pub empty: f32,
    /// Colours: what no shadow dims, what the surroundings light, what the key lights; the ground and the background.
    pub fixed: [f32; 3],
    pub ambient: [f32; 3],
    pub key: [f32; 3],
    pub ground_color: [f32; 3],
    pub empty_color: [f32; 3],
    /// Of the rays to the surroundings and to the key, the parts that got through, summed over samples with rays.
    pub seen: [Seen; 2],
    /// The sums of places (relative to the shape) and normals of the shape.
    pub place: [f32; 3],
    pub normal: [f32; 3],
}

/// Rays from one kind of place, the shape or the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    pub ambient_rays: f32,
    pub ambient_free: f32,
    pub key_rays: f32,
    pub key_free: f32,
}

impl Seen {
    fn add(&mut self, other: &Self, weight: f32) {
        self.ambient_rays += other.ambient_rays * weight;
        self.ambient_free += other.ambient_free * weight;
        self.key_rays += other.key_rays * weight;
        self.key_free += other.key_free * weight;
    }

    /// The free parts of the surroundings and the key; 1 without rays.
    fn free(&self) -> (f64, f64) {
        let part = |free: f32, rays: f32| if rays > 0.0 { f64::from(free / rays) } else { 1.0 };
        (part(self.ambient_free, self.ambient_rays), part(self.key_free, self.key_rays))
    }
}

pub(crate) fn add(sum: &mut [f32; 3], value: DVec3) {
    for (sum, value) in sum.iter_mut().zip(value.to_array()) {
        *sum += value as f32;
    }
}

fn mean(sum: &[f32; 3], count: f32) -> DVec3 {
    DVec3::from_array(sum.map(|x| f64::from(x / count)))
}

/// How dark the ground gets where it sees nothing of the surroundings, and of the key.
const GROUND_SHADOW: DVec2 = DVec2::new(0.80, 0.42);

/// Rows of pixels around the rows that are wanted.
pub(crate) struct Film<'a> {
    pub pixels: &'a [Pixel],
    pub width: usize,
    /// The size of a pixel at unit distance from the eye, or everywhere for a parallel view, in the places' unit.
    pub footprint: f32,
    /// The eye in the places' unit, where distance matters.
    pub eye: Option<[f32; 3]>,
    /// Whether shadow rays were cast, so that there is something to smooth.
    pub smooth: bool,
}

impl Film<'_> {
    /// The bytes of the pixel at a column and a row of this film.
    pub fn resolve(&self, x: usize, y: usize) -> [u8; 4] {
        let pixel = &self.pixels[y * self.width + x];
        let [surface_seen, ground_seen] = if self.smooth { self.smoothed(x, y) } else { pixel.seen };
        let mut light = DVec3::ZERO;
        if pixel.surface > 0.0 {
            let (ambient, key) = surface_seen.free();
            let sum = |sum: &[f32; 3]| mean(sum, pixel.surface);
            let color = sum(&pixel.fixed) + sum(&pixel.ambient) * ambient + sum(&pixel.key) * key;
            light += tone(color) * f64::from(pixel.surface);
        }
        if pixel.ground > 0.0 {
            let (ambient, key) = ground_seen.free();
            let dim = (1.0 - GROUND_SHADOW.x * (1.0 - ambient)) * (1.0 - GROUND_SHADOW.y * (1.0 - key));
            light += mean(&pixel.ground_color, 1.0) * dim;
        }
        light += mean(&pixel.empty_color, 1.0);
        let covered = f64::from(pixel.surface + pixel.ground + pixel.empty);
        let [r, g, b] = (light / covered.max(1.0)).to_array().map(srgb);
        [r, g, b, u8::MAX]
    }

    /// As [`Film::resolve`], with nothing but the shape, and its share of the pixel as opacity.
    pub fn resolve_cut_out(&self, x: usize, y: usize) -> [u8; 4] {
        let pixel = &self.pixels[y * self.width + x];
        if pixel.surface == 0.0 {
            return [0; 4];
        }
        let seen = if self.smooth { self.smoothed(x, y)[0] } else { pixel.seen[0] };
        let (ambient, key) = seen.free();
        let sum = |sum: &[f32; 3]| mean(sum, pixel.surface);
        let color = tone(sum(&pixel.fixed) + sum(&pixel.ambient) * ambient + sum(&pixel.key) * key);
        let [r, g, b] = color.to_array().map(srgb);
        let share = pixel.surface / (pixel.surface + pixel.ground + pixel.empty);
        [r, g, b, (share * 255.0 + 0.5) as u8]
    }

    fn smoothed(&self, x: usize, y: usize) -> [Seen; 2] {
        let here = &self.pixels[y * self.width + x];
        let rows = self.pixels.len() / self.width;
        let around = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
        let mut sums = [Seen::default(); 2];
        // The pixel itself counts even where its samples have no common normal.
        sums[0].add(&here.seen[0], 1e-3);
        let guide = (here.surface > 0.0).then(|| Guide::new(self, here));
        for row in around(y, rows) {
            for other in &self.pixels[row * self.width..][around(x, self.width)] {
                if let Some(guide) = guide.as_ref().filter(|_| other.surface > 0.0) {
                    sums[0].add(&other.seen[0], guide.weight(other));
                }
                if here.ground > 0.0 {
                    sums[1].add(&other.seen[1], 1.0);
                }
            }
        }
        sums
    }
}

/// Which neighbours lie on the same smooth piece of surface.
struct Guide {
    place: [f32; 3],
    normal: [f32; 3],
    tolerance: f32,
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: &[f32; 3]) -> [f32; 3] {
    let length = dot(v, v).sqrt().max(f32::MIN_POSITIVE);
    v.map(|x| x / length)
}

impl Guide {
    fn new(film: &Film<'_>, pixel: &Pixel) -> Self {
        let place = pixel.place.map(|x| x / pixel.surface);
        let far = film.eye.map_or(1.0, |eye| {
            let d: [f32; 3] = std::array::from_fn(|i| place[i] - eye[i]);
            dot(&d, &d).sqrt()
        });
        // Neighbours three pixels away on a surface seen at a slant are off the tangent plane by its curvature alone.
        Self { place, normal: unit(&pixel.normal), tolerance: 3.0 * film.footprint * far }
    }

    fn weight(&self, other: &Pixel) -> f32 {
        let offset: [f32; 3] = std::array::from_fn(|i| other.place[i] / other.surface - self.place[i]);
        let off_plane = dot(&offset, &self.normal).abs();
        let near = (1.0 - off_plane / self.tolerance).max(0.0);
        let alike = dot(&self.normal, &unit(&other.normal)).max(0.0);
        let alike = alike * alike;
        let alike = alike * alike;
        let alike = alike * alike;
        near * alike * alike
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lit(free: f32, normal: [f32; 3], place: [f32; 3]) -> Pixel {
        let seen = Seen { ambient_rays: 1.0, ambient_free: free, ..Seen::default() };
        Pixel { surface: 1.0, ambient: [0.5; 3], seen: [seen, Seen::default()], place, normal, ..Pixel::default() }
    }

    fn film(pixels: &[Pixel]) -> Film<'_> {
        Film { pixels, width: pixels.len(), footprint: 0.1, eye: None, smooth: true }
    }

    #[test]
    fn shadows_are_averaged_on_a_surface_and_not_across_its_outline() {
        let up = [0.0, 0.0, 1.0];
        let noisy: Vec<Pixel> = (0..7).map(|i| lit((i % 2) as f32, up, [i as f32 * 0.1, 0.0, 0.0])).collect();
        let middle = film(&noisy).smoothed(3, 0)[0].free().0;
        assert!((middle - 3.0 / 7.0).abs() < 1e-3, "{middle}");
        let mut stepped = noisy.clone();
        for pixel in &mut stepped[4..] {
            *pixel = lit(1.0, up, [0.5, 0.0, 5.0]);
        }
        assert!((film(&stepped).smoothed(3, 0)[0].free().0 - 0.5).abs() < 1e-3);
        let mut folded = noisy;
        for pixel in &mut folded[4..] {
            *pixel = lit(1.0, [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]);
        }
        assert!((film(&folded).smoothed(3, 0)[0].free().0 - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_pixel_without_samples_is_black_and_finite() {
        let pixels = [Pixel::default()];
        assert_eq!(film(&pixels).resolve(0, 0), [0, 0, 0, 255]);
        assert_eq!(film(&pixels).resolve_cut_out(0, 0), [0; 4]);
    }
}
