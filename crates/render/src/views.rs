//! Cameras that show a shape well.

use std::f64::consts::TAU;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Camera, CameraError, Projection};

/// The vertical angle of view: long enough a lens that forms are not distorted.
const FOV_Y: f64 = 0.45;
/// The part of the half picture that stays free on each side.
const MARGIN: f64 = 0.03;
const AZIMUTH: f64 = 0.56;
const ELEVATION: f64 = 0.40;

/// A three-quarter view from the front, the right and above, as near as the corners of the box allow.
///
/// The front is as in [`Camera::fit`]: seen from -y where z is up, from +z where y is up. `aspect` is the picture's width
/// over its height.
///
/// # Errors
/// An empty or infinite box, an up direction without a length, an aspect that is not positive.
pub fn sensible_camera(bounds: &Aabb, up: DVec3, aspect: f64) -> Result<Camera, CameraError> {
    camera_from(bounds, up, AZIMUTH, ELEVATION, aspect)
}

/// A view from an azimuth and elevation in radians, as near as the corners of the box allow.
///
/// # Errors
/// As [`sensible_camera`].
pub fn camera_from(bounds: &Aabb, up: DVec3, azimuth: f64, elevation: f64, aspect: f64) -> Result<Camera, CameraError> {
    let (bounds, axes) = view(bounds, up, azimuth, elevation, aspect)?;
    let [right, above, backward] = axes;
    let center = bounds.center();
    let corners = bounds.corners().map(|corner| (corner - center).to_array()).map(DVec3::from_array);
    let slope_y = (FOV_Y / 2.0).tan() * (1.0 - MARGIN);
    // A point at (x, z) is in the picture if |x - eye_x| <= slope (eye_z - z): two half-planes a point for the eye.
    let fit = |axis: DVec3, slope: f64| {
        let most = |sign: f64| {
            let bound = |corner: &DVec3| sign * corner.dot(axis) + slope * corner.dot(backward);
            corners.iter().map(bound).fold(f64::NEG_INFINITY, f64::max)
        };
        let (high, low) = (most(1.0), most(-1.0));
        ((high - low) / 2.0, (high + low) / (2.0 * slope))
    };
    let (x, far_x) = fit(right, slope_y * aspect);
    let (y, far_y) = fit(above, slope_y);
    let nearest = corners.iter().map(|corner| corner.dot(backward)).fold(f64::NEG_INFINITY, f64::max);
    // Keeps the eye off a shape without width.
    let far = far_x.max(far_y).max(nearest + 0.1 * bounds.diagonal());
    let eye = center + right * x + above * y + backward * far;
    Camera::look_at(eye, eye - backward * far, up, Projection::Perspective { fov_y: FOV_Y })
}

/// Cameras on a circle around the shape, evenly spaced from the view of [`sensible_camera`] on, turning to the right.
///
/// All look at the centre from one distance, so that the shape does not jump from frame to frame; the box fits each.
///
/// # Errors
/// As [`sensible_camera`].
pub fn turntable(bounds: &Aabb, up: DVec3, aspect: f64, frames: u32) -> Result<Vec<Camera>, CameraError> {
    let azimuths = (0..frames).map(|frame| AZIMUTH + TAU * f64::from(frame) / f64::from(frames));
    let views = azimuths.map(|azimuth| view(bounds, up, azimuth, ELEVATION, aspect)).collect::<Result<Vec<_>, _>>()?;
    let slope_y = (FOV_Y / 2.0).tan() * (1.0 - MARGIN);
    let distance = |(bounds, [right, above, backward]): &(Aabb, [DVec3; 3])| {
        let needed = |corner: DVec3| {
            let local = corner - bounds.center();
            let across = (local.dot(*right).abs() / aspect).max(local.dot(*above).abs());
            local.dot(*backward) + across / slope_y
        };
        bounds.corners().map(needed).into_iter().fold(0.6 * bounds.diagonal(), f64::max)
    };
    let far = views.iter().map(distance).fold(0.0, f64::max);
    let camera = |(bounds, [_, _, backward]): &(Aabb, [DVec3; 3])| {
        let center = bounds.center();
        Camera::look_at(center + *backward * far, center, up, Projection::Perspective { fov_y: FOV_Y })
    };
    views.iter().map(camera).collect()
}

/// A box with a size, and the axes (right, up, backward) of the view from an azimuth.
fn view(
    bounds: &Aabb,
    up: DVec3,
    azimuth: f64,
    elevation: f64,
    aspect: f64,
) -> Result<(Aabb, [DVec3; 3]), CameraError> {
    let scale = bounds.min.abs().max(bounds.max.abs()).max_element();
    let bounds = match bounds.diagonal() {
        // A point is seen from a distance that its coordinates can tell apart.
        0.0 if !bounds.is_empty() => bounds.padded(if scale > 0.0 { scale * 1e-3 } else { 1.0 }),
        _ => *bounds,
    };
    let axes = Camera::fit(&bounds, up, azimuth, elevation, FOV_Y, aspect)?.axes();
    Ok((bounds, axes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    fn boxes() -> Vec<Aabb> {
        let mut boxes = Vec::new();
        for scale in [1e-9, 1.0, 1e9] {
            for size in [DVec3::ONE, DVec3::new(9.0, 1.0, 0.2), DVec3::new(0.0, 0.0, 3.0), DVec3::new(1.0, 1.0, 0.0)] {
                let min = DVec3::new(5.0, -3.0, 1.0) * scale;
                boxes.push(Aabb::from_corners(min, min + size * scale));
            }
        }
        boxes.push(Aabb::from_points([DVec3::ONE]));
        boxes.push(Aabb::from_points([DVec3::ZERO]));
        boxes
    }

    #[test]
    fn every_corner_is_seen_and_the_view_is_tight() {
        for (bounds, up, aspect) in
            boxes().into_iter().flat_map(|b| [(b, DVec3::Z, 4.0 / 3.0), (b, DVec3::Y, 0.5), (b, DVec3::X, 3.0)])
        {
            let size = DVec2::new(600.0 * aspect, 600.0);
            let camera = sensible_camera(&bounds, up, aspect).unwrap();
            let seen = bounds.corners().map(|corner| camera.project(corner, size));
            let free = size * (MARGIN / 2.0) - DVec2::splat(1e-3);
            assert!(seen.iter().all(|s| s.depth > 0.0), "{bounds:?}");
            let inside = |s: &DVec2| s.cmpge(free).all() && s.cmple(size - free).all();
            assert!(seen.iter().all(|s| inside(&s.pixel)), "{bounds:?} {up} {seen:?}");
            if bounds.size().min_element() > 0.0 {
                let touches = |s: &DVec2| (*s - free).min_element().min((size - free - *s).min_element()) < 0.1;
                assert!(seen.iter().any(|s| touches(&s.pixel)), "{bounds:?} {up}");
            }
        }
    }

    #[test]
    fn a_turntable_sees_all_corners_from_one_distance() {
        let bounds = Aabb::from_corners(DVec3::ZERO, DVec3::new(4.0, 1.0, 2.0));
        let size = DVec2::new(800.0, 600.0);
        let cameras = turntable(&bounds, DVec3::Z, 4.0 / 3.0, 12).unwrap();
        assert_eq!(cameras.len(), 12);
        for camera in &cameras {
            assert!((camera.eye().distance(bounds.center()) - cameras[0].eye().distance(bounds.center())).abs() < 1e-9);
            for corner in bounds.corners() {
                let seen = camera.project(corner, size);
                assert!(seen.pixel.cmpge(DVec2::ZERO).all() && seen.pixel.cmple(size).all());
            }
        }
        assert!(turntable(&bounds, DVec3::Z, 1.0, 0).unwrap().is_empty());
    }

    #[test]
    fn impossible_views_are_refused() {
        assert!(sensible_camera(&Aabb::EMPTY, DVec3::Z, 1.0).is_err());
        assert!(sensible_camera(&boxes()[0], DVec3::ZERO, 1.0).is_err());
        assert!(sensible_camera(&boxes()[0], DVec3::Z, f64::NAN).is_err());
        assert!(turntable(&Aabb::EMPTY, DVec3::Z, 1.0, 3).is_err());
    }
}
