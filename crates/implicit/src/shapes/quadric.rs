//! Quadrics.

use shapeloom_core::glam::DVec3;

use super::{ParameterError, finite, positive};
use crate::program::Value;
use crate::program::builder::{Builder, Place};

/// A surface of the second degree about the origin. Values are those of the equation, not distances, but for their sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quadric {
    /// (x/a)² + (y/b)² + (z/c)² - 1.
    Ellipsoid(DVec3),
    /// (x/a)² + (y/b)² - 1.
    EllipticCylinder([f64; 2]),
    /// (x/a)² + (y/b)² - (z/c)²: both halves.
    Cone(DVec3),
    /// (x/a)² + (y/b)² - (z/c)² - 1.
    OneSheetHyperboloid(DVec3),
    /// (x/a)² + (y/b)² - (z/c)² + 1: inside both sheets.
    TwoSheetHyperboloid(DVec3),
    /// (x/a)² + (y/b)² - z.
    EllipticParaboloid([f64; 2]),
    /// (x/a)² - (y/b)² - z.
    HyperbolicParaboloid([f64; 2]),
    /// The coefficients of x², y², z², xy, yz, zx, x, y, z and 1.
    General([f64; 10]),
}

impl Quadric {
    /// The name in text.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ellipsoid(_) => "ellipsoid",
            Self::EllipticCylinder(_) => "elliptic_cylinder",
            Self::Cone(_) => "elliptic_cone",
            Self::OneSheetHyperboloid(_) => "hyperboloid",
            Self::TwoSheetHyperboloid(_) => "two_sheet_hyperboloid",
            Self::EllipticParaboloid(_) => "paraboloid",
            Self::HyperbolicParaboloid(_) => "hyperbolic_paraboloid",
            Self::General(_) => "quadric",
        }
    }

    /// Whether the parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let name = self.name();
        match self {
            Self::Ellipsoid(axes)
            | Self::Cone(axes)
            | Self::OneSheetHyperboloid(axes)
            | Self::TwoSheetHyperboloid(axes) => ["a", "b", "c"]
                .into_iter()
                .zip(axes.to_array())
                .try_for_each(|(axis, found)| positive(name, axis, found)),
            Self::EllipticCylinder(axes) | Self::EllipticParaboloid(axes) | Self::HyperbolicParaboloid(axes) => {
                ["a", "b"].into_iter().zip(*axes).try_for_each(|(axis, found)| positive(name, axis, found))
            }
            Self::General(coefficients) => {
                let names = ["xx", "yy", "zz", "xy", "yz", "zx", "x", "y", "z", "one"];
                names.into_iter().zip(*coefficients).try_for_each(|(of, found)| finite(name, of, found))
            }
        }
    }

    pub(super) fn lower(&self, builder: &mut Builder, [x, y, z]: Place) -> Value {
        let mut square = |value: Value, axis: f64| {
            let part = builder.times(value, 1.0 / axis);
            builder.square(part)
        };
        match *self {
            Self::Ellipsoid(axes) => {
                let parts = [square(x, axes.x), square(y, axes.y), square(z, axes.z)];
                combined(builder, &parts, &[1.0; 3], -1.0)
            }
            Self::EllipticCylinder([a, b]) => {
                let parts = [square(x, a), square(y, b)];
                combined(builder, &parts, &[1.0; 2], -1.0)
            }
            Self::Cone(axes) | Self::OneSheetHyperboloid(axes) | Self::TwoSheetHyperboloid(axes) => {
                let parts = [square(x, axes.x), square(y, axes.y), square(z, axes.z)];
                let offset = match self {
                    Self::Cone(_) => 0.0,
                    Self::OneSheetHyperboloid(_) => -1.0,
                    _ => 1.0,
                };
                combined(builder, &parts, &[1.0, 1.0, -1.0], offset)
            }
            Self::EllipticParaboloid([a, b]) => {
                let parts = [square(x, a), square(y, b), z];
                combined(builder, &parts, &[1.0, 1.0, -1.0], 0.0)
            }
            Self::HyperbolicParaboloid([a, b]) => {
                let parts = [square(x, a), square(y, b), z];
                combined(builder, &parts, &[1.0, -1.0, -1.0], 0.0)
            }
            Self::General([xx, yy, zz, xy, yz, zx, a, b, c, one]) => {
                let squares = [x, y, z].map(|value| builder.square(value));
                let products = [(x, y), (y, z), (z, x)].map(|(a, b)| builder.multiply(a, b));
                let second = combined(builder, &squares, &[xx, yy, zz], 0.0);
                let mixed = combined(builder, &products, &[xy, yz, zx], 0.0);
                let linear = builder.linear_at([x, y, z], DVec3::new(a, b, c), one);
                let sum = builder.add(second, mixed);
                builder.add(sum, linear)
            }
        }
    }
}

fn combined(builder: &mut Builder, parts: &[Value], factors: &[f64], offset: f64) -> Value {
    let mut sum = builder.constant(0.0);
    for (&part, &factor) in parts.iter().zip(factors) {
        if factor == 0.0 {
            continue;
        }
        let part = builder.times(part, factor);
        sum = builder.add(sum, part);
    }
    builder.plus(sum, offset)
}
