//! Space bent, folded and repeated before a field is asked.

use shapeloom_core::glam::DVec3;

use super::{ParameterError, finite, finite_vector, not_negative, positive};
use crate::operator::Unary;
use crate::program::Value;
use crate::program::builder::{Builder, Place};
use crate::tree::{Axis, Nature};

/// A change of space: the solid that results holds a point when the given one holds the point's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// Turned about the z axis, by an angle that grows with z. The sign is right; values grow with the way from the axis.
    Twist {
        /// Radians a unit of length.
        rate: f64,
    },
    /// The x axis bent towards y into a circle of radius 1 / rate: a bar along x becomes an arc. The sign is right.
    Bend {
        /// The curvature: radians a unit of length. Positive bends towards +y.
        rate: f64,
    },
    /// Scaled across z by a factor that runs from 1 at z = 0 to `factor` at z = `height`, and stays beyond. The sign is right.
    Taper {
        /// The height over which the factor runs.
        height: f64,
        /// The factor there; above 0.
        factor: f64,
    },
    /// Copies side by side, each in a cell centred on a multiple of the spacing. Right in sign where the part stays within its cell;
    /// what reaches beyond is cut off.
    Repeat {
        /// From copy to copy; 0 along an axis that is not repeated.
        spacing: DVec3,
        /// How many copies lie on each side of the middle one; infinitely many for `None`.
        copies: Option<[u32; 3]>,
    },
    /// What lies on the positive side of the plane through the origin is mirrored onto the other.
    Mirror {
        /// Along which the mirror faces.
        axis: Axis,
    },
    /// Cut apart at the origin and pulled apart by `size` along each axis, the gap filled by what lies on the cut.
    Elongate {
        /// The whole length added along each axis; not negative.
        size: DVec3,
    },
    /// The shape in the plane z = 0, from -height / 2 to height / 2. Exact where the shape is.
    Extrude {
        /// The whole height; above 0.
        height: f64,
    },
    /// The shape in the plane z = 0 where x ≥ 0, turned about the y axis, which becomes z.
    Revolve {
        /// Added to the radius: how far the shape's own origin lies from the axis.
        offset: f64,
    },
}

impl Domain {
    /// The name in text.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Twist { .. } => "twist",
            Self::Bend { .. } => "bend",
            Self::Taper { .. } => "taper",
            Self::Repeat { .. } => "repeat",
            Self::Mirror { .. } => "mirror",
            Self::Elongate { .. } => "elongate",
            Self::Extrude { .. } => "extrude",
            Self::Revolve { .. } => "revolve",
        }
    }

    /// Whether the parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let name = self.name();
        match *self {
            Self::Twist { rate } | Self::Bend { rate } => finite(name, "rate", rate),
            Self::Taper { height, factor } => {
                positive(name, "height", height)?;
                positive(name, "factor", factor)
            }
            Self::Repeat { spacing, .. } => [("x", spacing.x), ("y", spacing.y), ("z", spacing.z)]
                .into_iter()
                .try_for_each(|(parameter, found)| not_negative(name, parameter, found)),
            Self::Mirror { .. } => Ok(()),
            Self::Elongate { size } => {
                finite_vector(name, ["x", "y", "z"], size)?;
                [("x", size.x), ("y", size.y), ("z", size.z)]
                    .into_iter()
                    .try_for_each(|(parameter, found)| not_negative(name, parameter, found))
            }
            Self::Extrude { height } => positive(name, "height", height),
            Self::Revolve { offset } => finite(name, "offset", offset),
        }
    }

    pub(crate) fn nature(&self, of: Nature) -> Nature {
        match self {
            Self::Twist { rate } | Self::Bend { rate } if *rate == 0.0 => of,
            Self::Twist { .. } | Self::Bend { .. } | Self::Taper { .. } | Self::Repeat { .. } => Nature::SIGN,
            Self::Mirror { .. } | Self::Elongate { .. } | Self::Revolve { .. } => of.inexact(),
            // Where the slab's value counts it changes as fast as a distance.
            Self::Extrude { .. } => Nature { exact: of.exact, lipschitz: of.lipschitz.map(|bound| bound.max(1.0)) },
        }
    }

    /// The place at which the given field is asked.
    pub(crate) fn lower_place(&self, builder: &mut Builder, [x, y, z]: Place) -> Place {
        match *self {
            Self::Twist { rate } => {
                let angle = builder.times(z, -rate);
                turned(builder, x, y, angle, z)
            }
            Self::Bend { rate: 0.0 } => [x, y, z],
            Self::Bend { rate } => {
                // The circle's centre lies on the y axis. Along the arc runs x, across it y.
                let center = 1.0 / rate;
                let below = builder.times(y, -1.0);
                let toward = builder.plus(below, center);
                let toward = if rate < 0.0 { builder.negate(toward) } else { toward };
                let along = if rate < 0.0 { builder.negate(x) } else { x };
                let radius = builder.length(&[x, toward]);
                let angle = builder.binary(crate::operator::Binary::ArcTangent2, along, toward);
                let arc = builder.times(angle, center);
                let across = builder.times(radius, -center.signum());
                let across = builder.plus(across, center);
                [arc, across, z]
            }
            Self::Taper { height, factor } => {
                let part = builder.times(z, 1.0 / height);
                let part = builder.clamp(part, 0.0, 1.0);
                let scale = builder.times(part, factor - 1.0);
                let scale = builder.plus(scale, 1.0);
                [builder.divide(x, scale), builder.divide(y, scale), z]
            }
            Self::Repeat { spacing, copies } => {
                let mut place = [x, y, z];
                for (axis, coordinate) in place.iter_mut().enumerate() {
                    let step = spacing[axis];
                    if step == 0.0 {
                        continue;
                    }
                    let cells = builder.times(*coordinate, 1.0 / step);
                    let mut cell = builder.unary(Unary::Round, cells);
                    if let Some(copies) = copies {
                        let most = f64::from(copies[axis]);
                        cell = builder.clamp(cell, -most, most);
                    }
                    let shift = builder.times(cell, step);
                    *coordinate = builder.subtract(*coordinate, shift);
                }
                place
            }
            Self::Mirror { axis } => {
                let mut place = [x, y, z];
                place[axis.index()] = builder.absolute(place[axis.index()]);
                place
            }
            Self::Elongate { size } => {
                let mut place = [x, y, z];
                for (axis, coordinate) in place.iter_mut().enumerate() {
                    let half = size[axis] / 2.0;
                    if half != 0.0 {
                        let gap = builder.clamp(*coordinate, -half, half);
                        *coordinate = builder.subtract(*coordinate, gap);
                    }
                }
                place
            }
            Self::Extrude { .. } => {
                let zero = builder.constant(0.0);
                [x, y, zero]
            }
            Self::Revolve { offset } => {
                let radius = builder.length(&[x, y]);
                let zero = builder.constant(0.0);
                [builder.plus(radius, -offset), z, zero]
            }
        }
    }

    /// The value, from that of the given field.
    pub(crate) fn lower_value(&self, builder: &mut Builder, [_, _, z]: Place, value: Value) -> Value {
        match *self {
            Self::Extrude { height } => {
                let away = builder.absolute(z);
                let slab = builder.plus(away, -height / 2.0);
                wedge(builder, value, slab)
            }
            _ => value,
        }
    }
}

/// The distance to the intersection of two solids at right angles, from the distances to each.
pub(super) fn wedge(builder: &mut Builder, a: Value, b: Value) -> Value {
    let most = builder.maximum(a, b);
    let inside = builder.negative_part(most);
    let (a, b) = (builder.positive_part(a), builder.positive_part(b));
    let outside = builder.length(&[a, b]);
    builder.add(inside, outside)
}

/// A place turned about the z axis.
fn turned(builder: &mut Builder, x: Value, y: Value, angle: Value, z: Value) -> Place {
    let cosine = builder.unary(Unary::Cosine, angle);
    let sine = builder.unary(Unary::Sine, angle);
    let (xc, ys) = (builder.multiply(x, cosine), builder.multiply(y, sine));
    let (xs, yc) = (builder.multiply(x, sine), builder.multiply(y, cosine));
    [builder.subtract(xc, ys), builder.add(xs, yc), z]
}
