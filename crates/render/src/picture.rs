//! Pictures by ray casting.

use std::sync::atomic::{AtomicUsize, Ordering};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, Camera, Exec, Options, choice, options, parallel};

use crate::film::{Pixel, REACH};
use crate::painter::{Painter, TILE};
use crate::stage::Stage;
use crate::{Image, RenderError, Scene};

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
    /// the ground near it. Memory: 128 bytes a pixel for 256 rows, 4 bytes a pixel for the others, and the hierarchy.
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
/// Pixels between two polls: about a millisecond at the default number of rays, up to a second at the largest.
const CHUNK: usize = 128;
impl Picture {
    /// Draws the scene as the camera sees it. `up` says where the ground lies and where light comes from.
    ///
    /// # Errors
    /// An option out of range, an empty or malformed scene, an `up` without a length, too little memory in the budget,
    /// or the reason to stop.
    pub fn draw(&self, scene: &Scene, camera: &Camera, up: DVec3, exec: &Exec) -> Result<Image, RenderError> {
        self.draw_in_bands(scene, camera, up, exec, BAND)
    }

    /// Draws with `band` rows in memory at a time; the picture does not depend on it.
    fn draw_in_bands(
        &self,
        scene: &Scene,
        camera: &Camera,
        up: DVec3,
        exec: &Exec,
        band_height: usize,
    ) -> Result<Image, RenderError> {
        self.validate()?;
        exec.check()?;
        let up = up.try_normalize().ok_or(RenderError::Up { found: up })?;
        let (width, height) = (self.width as usize, self.height as usize);
        let _image_memory = exec.reserve_elements((width * height) as u64, size_of::<[u8; 4]>())?;
        let band_rows = band_height.min(height) + 2 * REACH;
        let _band_memory = exec.reserve_elements((width * band_rows) as u64, size_of::<Pixel>())?;
        let rays = u64::from(TILE * TILE) * u64::from(self.ambient_rays + self.shadow_rays);
        let _ray_memory = exec.reserve_elements(rays, size_of::<DVec3>())?;
        let stage = Stage::new(scene, &exec.part(0.0, 0.1))?;
        let painter = Painter::new(self, &stage, camera, up);
        let mut bytes = vec![[0u8; 4]; width * height];
        let mut pixels = vec![Pixel::default(); width * band_rows.min(height)];
        let done = AtomicUsize::new(0);
        let rest = exec.part(0.1, 1.0);
        for (band, out) in bytes.chunks_mut(band_height * width).enumerate() {
            // The filter looks beyond the band; rows are drawn twice there.
            let top = band * band_height;
            let first = top.saturating_sub(REACH);
            let last = (top + out.len() / width + REACH).min(height);
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
            let offset = top - first;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneMesh;
    use crate::fixtures::{ball, from_above, plain, scene, square};
    use crate::painter::INK;
    use crate::tone::{srgb, tone};
    use crate::views::sensible_camera;
    use shapeloom_core::glam::DVec2;
    use shapeloom_core::{CancelFlag, Projection, Stop, Threads};
    use std::sync::{Arc, Mutex};

    fn draw(picture: &Picture, scene: &Scene, camera: &Camera) -> Image {
        picture.draw(scene, camera, DVec3::Z, &Exec::default()).unwrap()
    }

    /// Whether a pixel is tinted like the back faces of the usual blue: red above blue.
    fn reddish(pixel: &&[u8; 4]) -> bool {
        i32::from(pixel[0]) > i32::from(pixel[2]) + 20
    }

    #[test]
    fn a_ball_covers_the_area_of_its_circle() {
        let picture = Picture { samples: 4, backdrop: Backdrop::Transparent, ..plain(200, 150) };
        let image = draw(&picture, &scene(ball(96)), &from_above(2.5));
        let covered: f64 = image.pixels().iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum();
        let radius = 150.0 / 2.5;
        // A polygon of 192 sides lacks 2e-4 of the circle; sixteen samples a pixel do the rest.
        let circle = std::f64::consts::PI * radius * radius;
        assert!((covered / circle - 1.0).abs() < 2e-3, "{covered} {circle}");
        // In perspective the outline is the tangent cone's.
        let projection = Projection::Perspective { fov_y: 0.8 };
        let camera = Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, projection).unwrap();
        let image = draw(&picture, &scene(ball(96)), &camera);
        let covered: f64 = image.pixels().iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum();
        let radius = (1.0f64 / 4.0).asin().tan() / 0.4f64.tan() * 75.0;
        let circle = std::f64::consts::PI * radius * radius;
        assert!((covered / circle - 1.0).abs() < 4e-3, "{covered} {circle}");
    }

    /// A facet that faces the camera and the sky, worked out by hand.
    #[test]
    fn a_facet_has_the_colour_of_its_light() {
        let mesh = SceneMesh { color: [0.5, 0.25, 0.125], ..square() };
        let camera = from_above(1.0);
        let image = draw(&Picture { samples: 1, ..plain(1, 1) }, &scene(mesh), &camera);
        // Key (-0.62, -0.60, 0.95) and fill (0.85, -0.45, 0.25): their cosines with z.
        let key = 0.95 / (0.62f64 * 0.62 + 0.60 * 0.60 + 0.95 * 0.95).sqrt();
        let fill = 0.25 / (0.85f64 * 0.85 + 0.45 * 0.45 + 0.25 * 0.25).sqrt();
        let light = [(0.36, 1.16, 0.13), (0.40, 1.09, 0.15), (0.46, 1.00, 0.18)]
            .map(|(sky, lamp, side)| sky + lamp * key + side * fill);
        let wanted = tone(DVec3::from_array(light) * DVec3::new(0.5, 0.25, 0.125)).to_array().map(srgb);
        assert_eq!(image.pixels()[0], [wanted[0], wanted[1], wanted[2], 255]);
    }

    #[test]
    fn back_faces_show_on_inside_out_shapes_alone() {
        let right = ball(24);
        let mut wrong = ball(24);
        wrong.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        wrong.normals = None;
        wrong.edges = Some(vec![[false; 3]; wrong.triangles.len()]);
        let camera = sensible_camera(&scene(ball(24)).bounds(), DVec3::Z, 1.0).unwrap();
        for mode in [Mode::Shaded, Mode::Flat, Mode::Wire] {
            let picture = Picture { mode, ..plain(64, 64) };
            assert_eq!(draw(&picture, &scene(right.clone()), &camera).pixels().iter().filter(reddish).count(), 0);
            assert!(
                draw(&picture, &scene(wrong.clone()), &camera).pixels().iter().filter(reddish).count() > 400,
                "{mode:?}"
            );
            let one_colour = Picture { show_back: false, ..picture };
            assert_eq!(draw(&one_colour, &scene(wrong.clone()), &camera).pixels().iter().filter(reddish).count(), 0);
        }
    }

    #[test]
    fn lines_have_their_width_and_hidden_sides_have_none() {
        let camera = from_above(2.0);
        // 101 pixels for two units: the diagonal runs through the middle pixel.
        let measure = |width: f64, drawn: bool| {
            let mut mesh = square();
            mesh.edges = Some(vec![[false, false, drawn], [drawn, false, false]]);
            let picture = Picture { mode: Mode::Wire, wire_width: width, samples: 8, ..plain(101, 101) };
            let image = draw(&picture, &scene(mesh), &camera);
            let red: Vec<f64> = (0..101).map(|x| f64::from(image.pixel(x, 50).unwrap()[0])).collect();
            let (paper, ink) = (red[5], f64::from(srgb(INK.x)));
            let linear = |byte: f64| {
                let toned = ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
                // Undoes the tone curve.
                if toned > 0.7 { 0.7 + (toned - 0.7) / (1.0 - (toned - 0.7) / 0.3) } else { toned }
            };
            let dark = |byte: &f64| (linear(paper) - linear(*byte)) / (linear(paper) - linear(ink));
            red.iter().map(dark).sum::<f64>() / std::f64::consts::SQRT_2
        };
        for width in [1.0, 2.0, 5.0] {
            // A row crosses the diagonal line at 45 degrees. Bytes of bright paper are coarse.
            assert!((measure(width, true) / width - 1.0).abs() < 0.04, "{width} {}", measure(width, true));
        }
        assert!(measure(3.0, false).abs() < 1e-9);
    }

    #[test]
    fn shadows_darken_the_ground_and_hollows_only() {
        let shape = scene(ball(24));
        let camera = sensible_camera(&shape.bounds(), DVec3::Z, 1.0).unwrap();
        let without = Picture { mode: Mode::Shaded, ground: true, ..plain(96, 96) };
        let with = Picture { ambient_rays: 16, shadow_rays: 8, ..without.clone() };
        let (plain, shadowed) = (draw(&without, &shape, &camera), draw(&with, &shape, &camera));
        let sum = |image: &Image| image.pixels().iter().map(|pixel| u64::from(pixel[1])).sum::<u64>();
        assert!(sum(&shadowed) + 20_000 < sum(&plain));
        // The place on which the ball stands.
        let below = camera.project(DVec3::new(0.9, 0.5, -1.0), DVec2::splat(96.0)).pixel;
        assert!(shadowed.pixel(below.x as u32, below.y as u32).unwrap()[1] < 190);
        assert!(shadowed.pixel(1, 1).unwrap() == [255; 4] && plain.pixel(1, 1).unwrap() == [255; 4]);
        // A convex shape in the air has no hollows: nothing is hidden but what faces away from the key.
        let alone = Picture { ground: false, ..with };
        let unlit = Picture { ground: false, ..without };
        let (alone, unlit) = (draw(&alone, &shape, &camera), draw(&unlit, &shape, &camera));
        let differ = alone.pixels().iter().zip(unlit.pixels()).filter(|(a, b)| a[1].abs_diff(b[1]) > 6).count();
        // Rays of the soft key's rim graze the ball near the terminator.
        assert!(differ < 96 * 96 / 40, "{differ}");
    }

    #[test]
    fn bytes_do_not_depend_on_threads_and_bands() {
        let shape = scene(ball(16));
        let camera = sensible_camera(&shape.bounds(), DVec3::Z, 0.25).unwrap();
        // Taller than a band.
        let picture = Picture { width: 72, height: 290, samples: 2, wires: true, ..Picture::new() };
        let wanted =
            picture.draw(&shape, &camera, DVec3::Z, &Exec::default().with_threads(Threads::Sequential)).unwrap();
        for band in [1, 7, 100, 290] {
            let found = picture.draw_in_bands(&shape, &camera, DVec3::Z, &Exec::default(), band).unwrap();
            assert!(found == wanted, "{band}");
        }
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| draw(&picture, &shape, &camera)) == wanted, "{threads}");
        }
        assert_eq!(wanted.to_png().unwrap(), draw(&picture, &shape, &camera).to_png().unwrap());
    }

    #[test]
    fn depth_is_light_before_and_dark_behind() {
        let mut mesh = square();
        mesh.positions.extend([DVec3::new(1.0, -1.0, -2.0), DVec3::new(3.0, -1.0, -2.0), DVec3::new(1.0, 1.0, -2.0)]);
        mesh.triangles.push([4, 5, 6]);
        let camera = from_above(4.0);
        let image = draw(&Picture { mode: Mode::Depth, ..plain(64, 64) }, &scene(mesh), &camera);
        let at = |x: f64, y: f64, z: f64| {
            let place = camera.project(DVec3::new(x, y, z), DVec2::splat(64.0)).pixel;
            image.pixel(place.x as u32, place.y as u32).unwrap()[0]
        };
        assert_eq!((at(0.0, 0.0, 0.0), at(1.2, -0.9, -2.0)), (srgb(0.69), srgb(0.02)));
    }

    #[test]
    fn any_unit_any_place_and_triangles_without_area_draw_the_same_picture() {
        let mut mesh = ball(12);
        mesh.triangles.push([3, 3, 3]);
        mesh.triangles.push([3, 4, 3]);
        mesh.normals.as_mut().unwrap().extend([DVec3::ZERO; 6]);
        let picture = Picture { width: 64, height: 48, samples: 2, ..Picture::new() };
        let images = [(1.0, 0.0), (1e-9, 0.0), (1e9, 0.0), (1.0, 5e6)].map(|(scale, offset)| {
            let mut mesh = mesh.clone();
            mesh.positions.iter_mut().for_each(|p| *p = *p * scale + DVec3::splat(offset));
            let shape = scene(mesh);
            draw(&picture, &shape, &sensible_camera(&shape.bounds(), DVec3::Z, 4.0 / 3.0).unwrap())
        });
        for other in &images[1..] {
            let far = images[0].pixels().iter().zip(other.pixels());
            assert!(far.filter(|(a, b)| a[1].abs_diff(b[1]) > 3).count() < 30);
        }
    }

    #[test]
    fn shapes_without_area_draw_nothing_and_do_not_fail() {
        for positions in [vec![DVec3::ONE; 3], vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0]] {
            let shape = scene(SceneMesh::new(positions, vec![[0, 1, 2]]));
            let camera = sensible_camera(&shape.bounds(), DVec3::Z, 1.0).unwrap();
            for mode in [Mode::Shaded, Mode::Flat, Mode::Wire, Mode::Depth] {
                draw(
                    &Picture { mode, wires: true, ..Picture { width: 16, height: 16, ..Picture::new() } },
                    &shape,
                    &camera,
                );
            }
        }
    }

    #[test]
    fn several_meshes_keep_their_colours() {
        let mut right = SceneMesh { color: [0.8, 0.0, 0.0], ..square() };
        right.positions.iter_mut().for_each(|p| p.x += 2.0);
        let left = SceneMesh { color: [0.0, 0.8, 0.0], ..square() };
        let shape = Scene { surfaces: vec![left, SceneMesh::new(vec![], vec![]), right] };
        let camera =
            Camera::look_at(DVec3::new(1.0, 0.0, 5.0), DVec3::X, DVec3::Y, Projection::Orthographic { height: 4.0 });
        let image = draw(&plain(40, 40), &shape, &camera.unwrap());
        let (a, b) = (image.pixel(10, 20).unwrap(), image.pixel(30, 20).unwrap());
        assert!(a[1] > 150 && a[0] == 0 && b[0] > 150 && b[1] == 0);
    }

    #[test]
    fn colours_of_corners_are_blended_and_show_on_both_sides() {
        let green = |p: &DVec3| [0.0, (0.5 + 0.4 * p.x) as f32, 0.0];
        let mesh = SceneMesh { colors: Some(square().positions.iter().map(green).collect()), ..square() };
        let mut under = mesh.clone();
        under.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        for mesh in [mesh, under] {
            let image = draw(&plain(40, 40), &scene(mesh), &from_above(2.0));
            for x in [4, 12, 20, 35] {
                let color = [0.0, 0.1 + 0.8 * (f64::from(x) + 0.5) / 40.0, 0.0];
                let uniform = SceneMesh { color: color.map(|c| c as f32), ..square() };
                let wanted = draw(&plain(40, 40), &scene(uniform), &from_above(2.0)).pixel(x, 20).unwrap();
                let found = image.pixel(x, 20).unwrap();
                assert!(found[1].abs_diff(wanted[1]) <= 1 && found[0] == wanted[0], "{x}: {found:?} {wanted:?}");
            }
        }
    }

    #[test]
    fn wrong_requests_are_refused() {
        let camera = from_above(2.0);
        let fail = |picture: &Picture, scene: &Scene, up: DVec3, exec: &Exec| {
            picture.draw(scene, &camera, up, exec).unwrap_err()
        };
        let exec = Exec::default();
        assert_eq!(fail(&plain(4, 4), &Scene::default(), DVec3::Z, &exec), RenderError::Empty);
        for (width, height) in [(0, 4), (4, 0), (16385, 4)] {
            assert!(matches!(fail(&plain(width, height), &scene(square()), DVec3::Z, &exec), RenderError::Option(_)));
        }
        let wide = Picture { wire_width: f64::NAN, ..plain(4, 4) };
        assert!(matches!(fail(&wide, &scene(square()), DVec3::Z, &exec), RenderError::Option(_)));
        assert!(matches!(fail(&plain(4, 4), &scene(square()), DVec3::NAN, &exec), RenderError::Up { .. }));
        let mut broken = square();
        broken.positions[1].z = f64::NAN;
        assert!(matches!(
            fail(&plain(4, 4), &scene(broken), DVec3::Z, &exec),
            RenderError::NotFinite { position: 1, .. }
        ));
        let small = Exec::default().with_memory(1 << 20);
        assert!(matches!(fail(&plain(1000, 1000), &scene(square()), DVec3::Z, &small), RenderError::OverBudget(_)));
        assert_eq!(small.memory_taken(), 0);
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = fail(&plain(4, 4), &scene(square()), DVec3::Z, &Exec::default().with_cancel(&flag));
        assert_eq!(stopped, RenderError::Stop(Stop::Cancelled));
        // Cancelled in the middle, by the progress.
        let late = CancelFlag::default();
        let switch = late.clone();
        let exec = Exec::default().with_cancel(&late).with_progress(move |done| {
            if done > 0.3 {
                switch.cancel();
            }
        });
        assert_eq!(fail(&plain(100, 100), &scene(square()), DVec3::Z, &exec), RenderError::Stop(Stop::Cancelled));
    }

    #[test]
    fn progress_ends_at_one() {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let log = Arc::clone(&seen);
        let exec = Exec::default().with_progress(move |fraction| log.lock().unwrap().push(fraction));
        plain(50, 50).draw(&scene(square()), &from_above(2.0), DVec3::Z, &exec).unwrap();
        let seen = seen.lock().unwrap();
        assert!(seen.len() > 10 && seen.last() == Some(&1.0) && seen.iter().all(|f| (0.0..=1.0).contains(f)));
    }

    /// From below, along the ground, from within: every view gives a picture.
    #[test]
    fn odd_views_draw() {
        let shape = scene(ball(8));
        let picture = Picture { width: 16, height: 16, samples: 1, wires: true, ..Picture::new() };
        let projection = Projection::Perspective { fov_y: 2.5 };
        for eye in [DVec3::Z * -3.0, DVec3::new(4.0, 0.0, -1.0), DVec3::splat(0.1), DVec3::X, DVec3::splat(1e12)] {
            let camera = Camera::look_at(eye, DVec3::splat(0.01), DVec3::Y, projection).unwrap();
            draw(&picture, &shape, &camera);
        }
    }
}
