//! Blends of two solids.

use super::parameter::expect;
use super::{ParameterError, SetOperation, finite, positive};
use crate::program::Value;
use crate::program::builder::Builder;
use crate::tree::Nature;

/// Two solids as one, with a soft transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// What is blended.
    pub set: SetOperation,
    /// How.
    pub form: BlendForm,
}

/// The form of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlendForm {
    /// The R-function (f + g ∓ √(f² + g² - 2αfg)) / (1 + α), minus for the union and plus for the intersection (Pasko and
    /// Savchenko, 1994, after Rvachev). For every α the zero set is that of the minimum or maximum; the field is smooth but
    /// where f = g = 0.
    RFunction {
        /// Above -1, at most 1; at 1 it is the minimum or maximum, at 0 values grow up to 2 + √2 times as fast.
        alpha: f64,
    },
    /// The R-function minus a₀ / (1 + (f / a₁)² + (g / a₂)²): a surface that is smooth itself. a₀ above 0 adds matter.
    Displaced {
        /// As for the R-function.
        alpha: f64,
        /// How much: the value taken off where both are 0.
        amount: f64,
        /// How far along the first.
        first: f64,
        /// How far along the second.
        second: f64,
    },
    /// The quadratic smooth minimum: the minimum where the values differ by `radius` or more, and elsewhere less by at most a
    /// quarter of it. Values change no faster than the faster part does.
    Smooth {
        /// Above 0.
        radius: f64,
    },
}

impl Blend {
    /// The name in messages.
    pub fn name(&self) -> &'static str {
        match (self.form, self.set) {
            (BlendForm::RFunction { .. }, SetOperation::Union) => "r_union",
            (BlendForm::RFunction { .. }, SetOperation::Intersection) => "r_intersection",
            (BlendForm::RFunction { .. }, SetOperation::Difference) => "r_difference",
            (BlendForm::Displaced { .. }, SetOperation::Union) => "blend_union",
            (BlendForm::Displaced { .. }, SetOperation::Intersection) => "blend_intersection",
            (BlendForm::Displaced { .. }, SetOperation::Difference) => "blend_difference",
            (BlendForm::Smooth { .. }, SetOperation::Union) => "smooth_union",
            (BlendForm::Smooth { .. }, SetOperation::Intersection) => "smooth_intersection",
            (BlendForm::Smooth { .. }, SetOperation::Difference) => "smooth_difference",
        }
    }

    /// Whether the parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let name = self.name();
        let fits =
            |alpha: f64| expect(alpha > -1.0 && alpha <= 1.0, name, "alpha", alpha, "a number above -1 and at most 1");
        match self.form {
            BlendForm::RFunction { alpha } => fits(alpha),
            BlendForm::Displaced { alpha, amount, first, second } => {
                fits(alpha)?;
                finite(name, "amount", amount)?;
                positive(name, "first", first)?;
                positive(name, "second", second)
            }
            BlendForm::Smooth { radius } => positive(name, "radius", radius),
        }
    }

    pub(crate) fn nature(&self, parts: Nature) -> Nature {
        let of_alpha = |alpha: f64| (2.0 + (2.0 * (1.0 - alpha)).max(0.0).sqrt()) / (1.0 + alpha);
        let lipschitz = parts.lipschitz.map(|bound| match self.form {
            BlendForm::RFunction { alpha } => bound * of_alpha(alpha),
            // The displacement falls fastest where f = a₁/√3, by 3√3/8 · a₀/a₁; so along both.
            BlendForm::Displaced { alpha, amount, first, second } => {
                let steepest = 3.0 * 3.0_f64.sqrt() / 8.0 * amount.abs();
                bound * (of_alpha(alpha) + steepest / first + steepest / second)
            }
            BlendForm::Smooth { .. } => bound,
        });
        Nature { exact: false, lipschitz }
    }

    pub(crate) fn lower(&self, builder: &mut Builder, f: Value, g: Value) -> Value {
        let sign = if self.set == SetOperation::Union { -1.0 } else { 1.0 };
        let g = if self.set == SetOperation::Difference { builder.negate(g) } else { g };
        match self.form {
            BlendForm::RFunction { alpha } => r_function(builder, f, g, alpha, sign),
            BlendForm::Displaced { alpha, amount, first, second } => {
                let sharp = r_function(builder, f, g, alpha, sign);
                let along_f = builder.times(f, 1.0 / first);
                let along_g = builder.times(g, 1.0 / second);
                let (along_f, along_g) = (builder.square(along_f), builder.square(along_g));
                let sum = builder.add(along_f, along_g);
                let divisor = builder.plus(sum, 1.0);
                let amount = builder.constant(amount);
                let displacement = builder.divide(amount, divisor);
                builder.subtract(sharp, displacement)
            }
            BlendForm::Smooth { radius } => {
                let difference = builder.subtract(f, g);
                let apart = builder.absolute(difference);
                let radius_value = builder.constant(radius);
                let left = builder.subtract(radius_value, apart);
                let overlap = builder.positive_part(left);
                let square = builder.square(overlap);
                let bulge = builder.times(square, sign * 0.25 / radius);
                let sharp = if sign < 0.0 { builder.minimum(f, g) } else { builder.maximum(f, g) };
                builder.add(sharp, bulge)
            }
        }
    }
}

/// The radicand as (f - g)² + 2(1 - α)fg, which cancels less than f² + g² - 2αfg.
fn r_function(builder: &mut Builder, f: Value, g: Value, alpha: f64, sign: f64) -> Value {
    if alpha == 1.0 {
        return if sign < 0.0 { builder.minimum(f, g) } else { builder.maximum(f, g) };
    }
    let difference = builder.subtract(f, g);
    let square = builder.square(difference);
    let product = builder.multiply(f, g);
    let product = builder.times(product, 2.0 * (1.0 - alpha));
    let radicand = builder.add(square, product);
    // Rounding may leave it a little below 0 where f = g and α = -1 comes near.
    let radicand = builder.positive_part(radicand);
    let root = builder.square_root(radicand);
    let root = builder.times(root, sign);
    let sum = builder.add(f, g);
    let sum = builder.add(sum, root);
    builder.times(sum, 1.0 / (1.0 + alpha))
}
