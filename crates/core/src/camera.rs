//! Cameras.

use std::fmt;

use glam::{DVec2, DVec3};

use crate::{Aabb, Category, Diagnostic, Frame, Ray, VectorWords};

/// How a camera maps directions to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays from the eye; `fov_y` is the full vertical angle in radians, in `(0, π)`.
    Perspective {
        /// The full vertical angle of view in radians.
        fov_y: f64,
    },
    /// Parallel rays; `height` is the height of the view in model units.
    Orthographic {
        /// The height of the view in model units.
        height: f64,
    },
}

/// Where a point appears: pixels from the upper left corner, and depth along the view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Pixels to the right and down of the upper left corner of the picture.
    pub pixel: DVec2,
    /// Distance from the eye along the view direction, negative behind it.
    pub depth: f64,
}

/// A pinhole or parallel camera: a right-handed frame (right, up, backward) at the eye, and a projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    frame: Frame,
    projection: Projection,
}

impl Camera {
    /// The camera at `eye` that looks at `target`, with `up` upward in the picture.
    ///
    /// # Errors
    /// The view direction is zero, parallel to `up` or not finite; or the projection's angle or height is out of range.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, projection: Projection) -> Result<Self, CameraError> {
        match projection {
            Projection::Perspective { fov_y } if !(fov_y > 0.0 && fov_y < std::f64::consts::PI) => {
                return Err(CameraError::FieldOfView { found: fov_y });
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                return Err(CameraError::Height { found: height });
            }
            _ => {}
        }
        let backward = eye - target;
        let right = up.cross(backward);
        let frame = Frame::new(eye, right, up.reject_from_normalized(backward.normalize_or_zero()))
            .map_err(|_| CameraError::View { eye, target, up })?;
        Ok(Self { frame, projection })
    }

    /// A camera that sees the whole of `bounds`: its centre from the direction of `azimuth` and `elevation` (radians,
    /// about the `up` axis from a fixed axis perpendicular to it), so far away that the bounding sphere fits a picture
    /// of that `aspect` (width over height), with `fov_y` as the angle of view.
    ///
    /// # Errors
    /// As [`Camera::look_at`]; an empty or infinite box; an aspect that is not positive.
    pub fn fit(
        bounds: &Aabb,
        up: DVec3,
        azimuth: f64,
        elevation: f64,
        fov_y: f64,
        aspect: f64,
    ) -> Result<Self, CameraError> {
        let up = up.try_normalize().ok_or(CameraError::View { eye: DVec3::ZERO, target: DVec3::ZERO, up })?;
        if bounds.is_empty() || !bounds.diagonal().is_finite() || !(aspect > 0.0 && aspect.is_finite()) {
            return Err(CameraError::Bounds { bounds: *bounds, aspect });
        }
        // Azimuth 0 looks from the front: from -y where z is up, from +z where y is up.
        let front = if up.y.abs() > 0.9 { DVec3::Z } else { DVec3::NEG_Y };
        let front = front.reject_from_normalized(up).normalize();
        let side = up.cross(front);
        // Straight up and down would leave the picture's up direction open.
        let steepest = std::f64::consts::FRAC_PI_2 - 1e-4;
        let elevation = elevation.clamp(-steepest, steepest);
        let toward_eye = (front * azimuth.cos() + side * azimuth.sin()) * elevation.cos() + up * elevation.sin();
        let half = (fov_y / 2.0).tan().min((fov_y / 2.0).tan() * aspect).atan();
        let radius = (bounds.diagonal() / 2.0).max(f64::MIN_POSITIVE.sqrt());
        let target = bounds.center();
        let eye = target + toward_eye * (radius / half.sin());
        Self::look_at(eye, target, up, Projection::Perspective { fov_y })
    }

    /// The eye.
    pub fn eye(&self) -> DVec3 {
        self.frame.origin()
    }

    /// The unit vectors to the right, up, and backward (from the scene to the eye).
    pub fn axes(&self) -> [DVec3; 3] {
        self.frame.axes()
    }

    /// The projection.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The ray through a position of a picture of `size` pixels, counted from its upper left corner; pixel centres are
    /// at halves.
    pub fn ray(&self, pixel: DVec2, size: DVec2) -> Ray {
        let x = (2.0 * pixel.x - size.x) / size.y;
        let y = 1.0 - 2.0 * pixel.y / size.y;
        let [right, up, backward] = self.axes();
        let (origin, direction) = match self.projection {
            Projection::Perspective { fov_y } => {
                let half = (fov_y / 2.0).tan();
                (self.eye(), (right * x + up * y) * half - backward)
            }
            Projection::Orthographic { height } => (self.eye() + (right * x + up * y) * (height / 2.0), -backward),
        };
        Ray::new(origin, direction).expect("a camera's axes are unit vectors and its eye is finite")
    }

    /// Where a point appears in a picture of `size` pixels: the inverse of [`Camera::ray`] with the depth. Pixels of
    /// points in or behind the plane of a perspective eye mean nothing.
    pub fn project(&self, point: DVec3, size: DVec2) -> Screen {
        let local = self.frame.coordinates(point);
        let half_height = match self.projection {
            Projection::Perspective { fov_y } => -local.z * (fov_y / 2.0).tan(),
            Projection::Orthographic { height } => height / 2.0,
        };
        let (x, y) = (local.x / half_height, local.y / half_height);
        Screen { pixel: DVec2::new((x * size.y + size.x) / 2.0, (1.0 - y) * size.y / 2.0), depth: -local.z }
    }
}

/// Why numbers make no camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraError {
    /// No view direction, or one along `up`.
    View {
        /// The eye.
        eye: DVec3,
        /// What it looks at.
        target: DVec3,
        /// The up direction.
        up: DVec3,
    },
    /// An angle of view outside `(0, π)`.
    FieldOfView {
        /// The angle in radians.
        found: f64,
    },
    /// A height of a parallel view that is not positive.
    Height {
        /// The height in model units.
        found: f64,
    },
    /// Nothing to fit into the picture, or a picture without size.
    Bounds {
        /// The box to see.
        bounds: Aabb,
        /// Width over height.
        aspect: f64,
    },
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::View { eye, target, up } => write!(
                f,
                "camera: found eye {}, target {} and up {}, expected finite points apart and an up direction across the view",
                VectorWords(*eye),
                VectorWords(*target),
                VectorWords(*up)
            ),
            Self::FieldOfView { found } => {
                write!(f, "camera: found an angle of view of {found} radians, expected one between 0 and pi")
            }
            Self::Height { found } => {
                write!(f, "camera: found a view height of {found}, expected a finite number above 0")
            }
            Self::Bounds { bounds, aspect } => write!(
                f,
                "camera: found bounds {} to {} and aspect {aspect}, expected a finite box and a positive aspect",
                VectorWords(bounds.min),
                VectorWords(bounds.max)
            ),
        }
    }
}

impl std::error::Error for CameraError {}

impl Diagnostic for CameraError {
    fn code(&self) -> &'static str {
        match self {
            Self::View { .. } => "E-camera-view",
            Self::FieldOfView { .. } => "E-camera-fov",
            Self::Height { .. } => "E-camera-height",
            Self::Bounds { .. } => "E-camera-bounds",
        }
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: DVec2 = DVec2::new(640.0, 480.0);

    #[test]
    fn projecting_a_point_of_a_ray_gives_its_pixel() {
        for projection in [Projection::Perspective { fov_y: 0.8 }, Projection::Orthographic { height: 3.0 }] {
            let eye = DVec3::new(3.0, -5.0, 2.0);
            let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, projection).unwrap();
            for pixel in [DVec2::new(0.5, 0.5), DVec2::new(320.0, 240.0), DVec2::new(611.0, 17.0)] {
                let back = camera.project(camera.ray(pixel, SIZE).at(4.0), SIZE);
                assert!((back.pixel - pixel).length() < 1e-9 && back.depth > 0.0, "{projection:?} {pixel}");
            }
            assert!((camera.project(DVec3::ZERO, SIZE).pixel - SIZE / 2.0).length() < 1e-9);
            // Up in space is up in the picture, which is down in pixels.
            assert!(camera.project(DVec3::Z, SIZE).pixel.y < 240.0);
        }
    }

    #[test]
    fn fit_shows_the_whole_box_from_everywhere() {
        let bounds = Aabb::from_corners(DVec3::new(-1.0, 0.0, 4.0), DVec3::new(2.0, 0.5, 9.0));
        for up in [DVec3::Z, DVec3::Y] {
            for (azimuth, elevation) in [(0.0, 0.0), (1.0, 0.5), (4.0, -1.2), (2.0, 1.6)] {
                let camera = Camera::fit(&bounds, up, azimuth, elevation, 0.6, 640.0 / 480.0).unwrap();
                for corner in bounds.corners() {
                    let seen = camera.project(corner, SIZE);
                    assert!(seen.depth > 0.0 && seen.pixel.cmpge(DVec2::ZERO).all() && seen.pixel.cmple(SIZE).all());
                }
            }
        }
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let view = Projection::Perspective { fov_y: 1.0 };
        assert!(Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Z, view).is_err());
        assert!(Camera::look_at(DVec3::Z, DVec3::Z, DVec3::Y, view).is_err());
        assert!(Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Perspective { fov_y: 0.0 }).is_err());
        assert!(
            Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, Projection::Orthographic { height: f64::NAN }).is_err()
        );
        assert!(Camera::fit(&Aabb::EMPTY, DVec3::Z, 0.0, 0.0, 1.0, 1.0).is_err());
    }
}
