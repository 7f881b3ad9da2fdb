//! Affine maps in the language.

use std::fmt::Write;

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Affine, AxisAngle};

use super::bind::Bound;
use super::printer::listed;
use crate::program::ParameterError;
use crate::tree::Tree;

pub(super) fn moved(bound: &Bound) -> Result<Tree, ParameterError> {
    Ok(bound.field(0).transform(Affine::from_translation(bound.vector(1))))
}

pub(super) fn turned(bound: &Bound, axis: DVec3, angle: f64) -> Result<Tree, ParameterError> {
    match AxisAngle::new(axis, angle) {
        Ok(turn) => Ok(bound.field(0).rotate(turn)),
        Err(_) => {
            let (parameter, found, expected) = if angle.is_finite() {
                ("an axis of length", axis.length(), "a finite length above 0")
            } else {
                ("angle", angle, "a finite number")
            };
            Err(ParameterError { operation: bound.function, parameter, found, expected, part: None })
        }
    }
}

/// By one factor or by three.
pub(super) fn scaled(bound: &Bound) -> Result<Tree, ParameterError> {
    let x = bound.number(1);
    let factors = match (bound.optional(2), bound.optional(3)) {
        (None, None) => DVec3::splat(x),
        (Some(y), Some(z)) => DVec3::new(x, y, z),
        (y, _) => {
            let parameter = if y.is_none() { "y" } else { "z" };
            let expected = "one factor or three";
            return Err(ParameterError { operation: "scale", parameter, found: f64::NAN, expected, part: None });
        }
    };
    Ok(bound.field(0).transform(Affine::from_scale(factors)))
}

/// By the three rows of the matrix, each with its entry of the translation.
pub(super) fn mapped(bound: &Bound) -> Result<Tree, ParameterError> {
    let [xx, xy, xz, tx, yx, yy, yz, ty, zx, zy, zz, tz] = bound.numbers(1);
    let linear = DMat3::from_cols_array(&[xx, yx, zx, xy, yy, zy, xz, yz, zz]);
    Ok(bound.field(0).transform(Affine { linear, translation: DVec3::new(tx, ty, tz) }))
}

/// The method that gives the map back, such as `move(1, 2, 3)`.
pub(super) fn written(map: &Affine) -> String {
    let [x, y, z] = map.linear.transpose().to_cols_array_2d();
    let factors = DVec3::new(x[0], y[1], z[2]);
    let [tx, ty, tz] = map.translation.to_array();
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = if map.linear == DMat3::IDENTITY {
        write!(out, "move({})", listed(&[tx, ty, tz]))
    } else if *map != Affine::from_scale(factors) {
        let rows = [x[0], x[1], x[2], tx, y[0], y[1], y[2], ty, z[0], z[1], z[2], tz];
        write!(out, "matrix({})", listed(&rows))
    } else if factors == DVec3::splat(factors.x) {
        write!(out, "scale({})", listed(&[factors.x]))
    } else {
        write!(out, "scale({})", listed(&factors.to_array()))
    };
    out
}
