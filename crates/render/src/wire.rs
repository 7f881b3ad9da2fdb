//! Lines along the sides of triangles, of a width in pixels.

use shapeloom_core::glam::DVec2;
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Camera, Hit, Ray};

/// How much of a sample the lines along the drawn sides cover, from 0 to 1.
///
/// The distance to a side in the picture is the corner weight that vanishes on it over the length of that weight's
/// gradient in pixels, found by the rays of the neighbouring pixels: exact for a parallel camera, and to first order for
/// perspective, where corners may even lie behind the eye. Lines fade on triangles that are thin against the line, so
/// that dense meshes stay readable.
pub(crate) fn coverage(
    camera: &Camera,
    size: DVec2,
    pixel: DVec2,
    corners: &[DVec3; 3],
    hit: &Hit,
    sides: [bool; 3],
    width: f64,
) -> f64 {
    let here = weights(hit.parameters);
    let across = neighbour(&camera.ray(pixel + DVec2::X, size), corners);
    let down = neighbour(&camera.ray(pixel + DVec2::Y, size), corners);
    let (Some(across), Some(down)) = (across, down) else { return 0.0 };
    let mut most = 0.0f64;
    for (side, _) in sides.iter().enumerate().filter(|(_, drawn)| **drawn) {
        // Side i runs from corner i to the next; the weight of the remaining corner vanishes on it.
        let opposite = (side + 2) % 3;
        let gradient = DVec2::new(across[opposite] - here[opposite], down[opposite] - here[opposite]).length();
        if gradient <= 0.0 || !gradient.is_finite() {
            continue;
        }
        let distance = here[opposite] / gradient;
        let altitude = 1.0 / gradient;
        let fade = (altitude / (3.0 * width)).min(1.0);
        most = most.max((width / 2.0 + 0.5 - distance).clamp(0.0, 1.0) * fade);
    }
    most
}

fn weights(parameters: DVec2) -> [f64; 3] {
    [1.0 - parameters.x - parameters.y, parameters.x, parameters.y]
}

/// The corner weights where a ray meets the plane of a triangle; none if it runs along it.
fn neighbour(ray: &Ray, corners: &[DVec3; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = *corners;
    let scale = (b - a).abs().max((c - a).abs()).max_element();
    let (u, v, from) = ((b - a) / scale, (c - a) / scale, (ray.origin() - a) / scale);
    let normal = u.cross(v);
    let steep = normal.dot(ray.direction());
    let at = from - ray.direction() * (normal.dot(from) / steep);
    let area = normal.length_squared();
    let found = weights(DVec2::new(at.cross(v).dot(normal) / area, u.cross(at).dot(normal) / area));
    found.iter().all(|weight| weight.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Projection;

    /// The weights' gradients give the distance to the projected side.
    #[test]
    fn distances_are_those_of_projected_sides() {
        let corners = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.5, -0.5, 0.3), DVec3::new(0.0, 1.0, -0.2)];
        let size = DVec2::new(400.0, 300.0);
        let projection = Projection::Orthographic { height: 3.0 };
        let camera = Camera::look_at(DVec3::new(1.0, -0.5, 6.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
        let screen = corners.map(|corner| camera.project(corner, size).pixel);
        for (v, w) in [(0.2, 0.3), (0.01, 0.5), (0.49, 0.5), (0.4, 0.01)] {
            let place = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
            let pixel = camera.project(place, size).pixel;
            let hit = Hit { distance: 1.0, element: 0, parameters: DVec2::new(v, w), back: false };
            for side in 0..3 {
                let (from, to) = (screen[side], screen[(side + 1) % 3]);
                let distance = (to - from).perp_dot(pixel - from).abs() / (to - from).length();
                let mut sides = [false; 3];
                sides[side] = true;
                let found = |width| coverage(&camera, size, pixel, &corners, &hit, sides, width);
                let altitude = (to - from).perp_dot(screen[(side + 2) % 3] - from).abs() / (to - from).length();
                let fade = (altitude / (6.0 * distance)).min(1.0);
                assert!((found(2.0 * distance) - 0.5 * fade).abs() < 1e-9, "{side} {distance}");
                assert_eq!(found((2.0 * distance - 1.1).max(0.0)), 0.0);
            }
        }
    }

    #[test]
    fn triangles_without_area_have_no_lines() {
        let camera =
            Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: 1.0 }).unwrap();
        let hit = Hit { distance: 1.0, element: 0, parameters: DVec2::ZERO, back: false };
        let flat = [DVec3::ZERO; 3];
        assert_eq!(coverage(&camera, DVec2::splat(9.0), DVec2::ONE, &flat, &hit, [true; 3], 1.0), 0.0);
    }
}
