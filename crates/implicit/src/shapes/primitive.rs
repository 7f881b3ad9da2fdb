//! Solids given by numbers.

use std::f64::consts::TAU;

use shapeloom_core::glam::{DVec2, DVec3};

use super::domain::wedge;
use super::parameter::expect;
use super::profile::convex_polygon;
use super::{ParameterError, Quadric, finite, finite_vector, not_negative, positive};
use crate::program::Value;
use crate::program::builder::{Builder, Place};
use crate::tree::Nature;

/// A solid given by numbers. Those without a place lie about the origin, along z; all but two have the exact signed distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// Below a plane: `normal · p - offset`, with the normal made a unit vector.
    Plane {
        /// Points outward; any length above 0.
        normal: DVec3,
        /// How far from the origin, along the unit normal.
        offset: f64,
    },
    /// A ball.
    Sphere {
        /// Its centre.
        center: DVec3,
        /// Above 0.
        radius: f64,
    },
    /// A box with its edges along the axes.
    Box {
        /// The whole lengths; above 0.
        size: DVec3,
    },
    /// A box with rounded edges and corners.
    RoundedBox {
        /// The whole lengths, rounding included; above 0.
        size: DVec3,
        /// From 0 up to half the least length.
        radius: f64,
    },
    /// A round cylinder along z.
    Cylinder {
        /// Above 0.
        radius: f64,
        /// The whole height; above 0.
        height: f64,
    },
    /// A cone along z, cut off at its top unless that has radius 0.
    Cone {
        /// The radius at the bottom.
        bottom: f64,
        /// The radius at the top; one of the two is above 0.
        top: f64,
        /// The whole height; above 0.
        height: f64,
    },
    /// What lies within a distance of a segment. The ends may be equal.
    Capsule {
        /// One end.
        start: DVec3,
        /// The other end.
        end: DVec3,
        /// Above 0.
        radius: f64,
    },
    /// A ring about z: what lies within a distance of a circle.
    Torus {
        /// The radius of the circle; above 0.
        major: f64,
        /// The distance; above 0. Above `major` the hole closes and the value inside is a bound.
        minor: f64,
    },
    /// The same ring as a surface of the fourth degree, (p² + R² - r²)² - 4R²(x² + y²): the sign alone is right.
    QuarticTorus {
        /// R; above 0.
        major: f64,
        /// r; above 0.
        minor: f64,
    },
    /// A prism along z over a regular polygon with a corner on the x axis.
    Prism {
        /// From 3 to 360.
        sides: u32,
        /// From the axis to a corner; above 0.
        radius: f64,
        /// The whole height; above 0.
        height: f64,
    },
    /// A surface of the second degree: the sign alone is right.
    Quadric(Quadric),
    /// A disc in the plane, for extrusion and revolution: all along z.
    Circle {
        /// Above 0.
        radius: f64,
    },
    /// A rectangle in the plane, for extrusion and revolution: all along z.
    Rectangle {
        /// The whole lengths; above 0.
        size: DVec2,
    },
}

impl Primitive {
    /// The name in text.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Sphere { .. } => "sphere",
            Self::Box { .. } => "box",
            Self::RoundedBox { .. } => "rounded_box",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Capsule { .. } => "capsule",
            Self::Torus { .. } => "torus",
            Self::QuarticTorus { .. } => "quartic_torus",
            Self::Prism { .. } => "prism",
            Self::Quadric(quadric) => quadric.name(),
            Self::Circle { .. } => "circle",
            Self::Rectangle { .. } => "rectangle",
        }
    }

    /// Whether the parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let name = self.name();
        let lengths = |size: DVec3| {
            ["x", "y", "z"].into_iter().zip(size.to_array()).try_for_each(|(axis, found)| positive(name, axis, found))
        };
        match *self {
            Self::Plane { normal, offset } => {
                finite_vector(name, ["x", "y", "z"], normal)?;
                let length = normal.length();
                expect(length > 0.0 && length.is_finite(), name, "normal of length", length, "a length above 0")?;
                finite(name, "offset", offset)
            }
            Self::Sphere { center, radius } => {
                finite_vector(name, ["x", "y", "z"], center)?;
                positive(name, "radius", radius)
            }
            Self::Box { size } => lengths(size),
            Self::RoundedBox { size, radius } => {
                lengths(size)?;
                not_negative(name, "radius", radius)?;
                let fits = radius <= size.min_element() / 2.0;
                expect(fits, name, "radius", radius, "at most half the least length")
            }
            Self::Cylinder { radius, height } => {
                positive(name, "radius", radius)?;
                positive(name, "height", height)
            }
            Self::Cone { bottom, top, height } => {
                not_negative(name, "bottom", bottom)?;
                not_negative(name, "top", top)?;
                expect(bottom > 0.0 || top > 0.0, name, "top", top, "one radius above 0")?;
                positive(name, "height", height)
            }
            Self::Capsule { start, end, radius } => {
                finite_vector(name, ["x of the start", "y of the start", "z of the start"], start)?;
                finite_vector(name, ["x of the end", "y of the end", "z of the end"], end)?;
                positive(name, "radius", radius)
            }
            Self::Torus { major, minor } | Self::QuarticTorus { major, minor } => {
                positive(name, "major", major)?;
                positive(name, "minor", minor)
            }
            Self::Prism { sides, radius, height } => {
                let fits = (3..=360).contains(&sides);
                expect(fits, name, "sides", f64::from(sides), "a whole number from 3 to 360")?;
                positive(name, "radius", radius)?;
                positive(name, "height", height)
            }
            Self::Quadric(quadric) => quadric.check(),
            Self::Circle { radius } => positive(name, "radius", radius),
            Self::Rectangle { size } => {
                positive(name, "x", size.x)?;
                positive(name, "y", size.y)
            }
        }
    }

    pub(crate) fn nature(&self) -> Nature {
        match self {
            Self::QuarticTorus { .. } | Self::Quadric(_) => Nature::SIGN,
            // Near the axis the nearest point of such a ring lies inside it.
            Self::Torus { major, minor } if minor > major => Nature::BOUND,
            _ => Nature::EXACT,
        }
    }

    pub(crate) fn lower(&self, builder: &mut Builder, place: Place) -> Value {
        let [x, y, z] = place;
        match *self {
            Self::Plane { normal, offset } => {
                let unit = normal.normalize_or_zero();
                builder.linear_at(place, unit, -offset)
            }
            Self::Sphere { center, radius } => {
                let parts = moved(builder, place, -center);
                let distance = builder.length(&parts);
                builder.plus(distance, -radius)
            }
            Self::Box { size } => cuboid(builder, place, size, 0.0),
            Self::RoundedBox { size, radius } => cuboid(builder, place, size, radius),
            Self::Cylinder { radius, height } => {
                let from_axis = builder.length(&[x, y]);
                let side = builder.plus(from_axis, -radius);
                let away = builder.absolute(z);
                let caps = builder.plus(away, -height / 2.0);
                wedge(builder, side, caps)
            }
            Self::Cone { bottom, top, height } => {
                let half = height / 2.0;
                let from_axis = builder.length(&[x, y]);
                let corners =
                    [DVec2::new(0.0, -half), DVec2::new(bottom, -half), DVec2::new(top, half), DVec2::new(0.0, half)];
                // The side on the axis is no surface.
                convex_polygon(builder, [from_axis, z], &corners, &[3])
            }
            Self::Capsule { start, end, radius } => {
                let along = end - start;
                let square = along.length_squared();
                let mut parts = moved(builder, place, -start);
                if square > 0.0 {
                    let fraction = builder.linear_at(place, along / square, -start.dot(along) / square);
                    let fraction = builder.clamp(fraction, 0.0, 1.0);
                    for (part, step) in parts.iter_mut().zip(along.to_array()) {
                        let shift = builder.times(fraction, step);
                        *part = builder.subtract(*part, shift);
                    }
                }
                let distance = builder.length(&parts);
                builder.plus(distance, -radius)
            }
            Self::Torus { major, minor } => {
                let from_axis = builder.length(&[x, y]);
                let from_circle = builder.plus(from_axis, -major);
                let distance = builder.length(&[from_circle, z]);
                builder.plus(distance, -minor)
            }
            Self::QuarticTorus { major, minor } => {
                let squares = place.map(|value| builder.square(value));
                let across = builder.add(squares[0], squares[1]);
                let all = builder.add(across, squares[2]);
                let sum = builder.plus(all, major * major - minor * minor);
                let square = builder.square(sum);
                let ring = builder.times(across, 4.0 * major * major);
                builder.subtract(square, ring)
            }
            Self::Prism { sides, radius, height } => {
                let corner = |i: u32| DVec2::from_angle(TAU * f64::from(i) / f64::from(sides)) * radius;
                let corners: Vec<DVec2> = (0..sides).map(corner).collect();
                let side = convex_polygon(builder, [x, y], &corners, &[]);
                let away = builder.absolute(z);
                let caps = builder.plus(away, -height / 2.0);
                wedge(builder, side, caps)
            }
            Self::Quadric(quadric) => quadric.lower(builder, place),
            Self::Circle { radius } => {
                let from_axis = builder.length(&[x, y]);
                builder.plus(from_axis, -radius)
            }
            Self::Rectangle { size } => {
                let sides = [(x, size.x), (y, size.y)].map(|(value, length)| {
                    let away = builder.absolute(value);
                    builder.plus(away, -length / 2.0)
                });
                wedge(builder, sides[0], sides[1])
            }
        }
    }
}

fn moved(builder: &mut Builder, place: Place, by: DVec3) -> Place {
    let [x, y, z] = place;
    [builder.plus(x, by.x), builder.plus(y, by.y), builder.plus(z, by.z)]
}

fn cuboid(builder: &mut Builder, place: Place, size: DVec3, radius: f64) -> Value {
    let mut sides = place;
    for (side, length) in sides.iter_mut().zip(size.to_array()) {
        let away = builder.absolute(*side);
        *side = builder.plus(away, radius - length / 2.0);
    }
    let most = builder.maximum(sides[1], sides[2]);
    let most = builder.maximum(sides[0], most);
    let inside = builder.negative_part(most);
    let outside = sides.map(|side| builder.positive_part(side));
    let outside = builder.length(&outside);
    let sum = builder.add(inside, outside);
    builder.plus(sum, -radius)
}
