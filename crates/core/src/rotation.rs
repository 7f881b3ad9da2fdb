//! Rotations by axis and angle, and by yaw, pitch and roll.

use std::fmt;

use glam::{DMat3, DQuat, DVec3};

use crate::{Category, Diagnostic};

/// A rotation by an angle about an axis through the origin, counter-clockwise seen against the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngle {
    axis: DVec3,
    angle: f64,
}

impl AxisAngle {
    /// The rotation by `angle` radians about `axis`, which is scaled to unit length.
    ///
    /// # Errors
    /// An axis of no length, or anything that is not finite.
    pub fn new(axis: DVec3, angle: f64) -> Result<Self, RotationError> {
        let unit = axis.try_normalize().or_else(|| {
            // Axes so short or long that their square underflows or overflows still have a direction.
            let size = axis.abs().max_element();
            if size > 0.0 && size.is_finite() { (axis / size).try_normalize() } else { None }
        });
        match unit {
            Some(axis) if angle.is_finite() => Ok(Self { axis, angle }),
            Some(_) => Err(RotationError::Angle { found: angle }),
            None => Err(RotationError::Axis { found: axis }),
        }
    }

    /// The axis, of unit length.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The angle in radians.
    pub fn angle(&self) -> f64 {
        self.angle
    }

    /// The rotation matrix (Rodrigues' formula).
    pub fn to_matrix(&self) -> DMat3 {
        DMat3::from_axis_angle(self.axis, self.angle)
    }

    /// The axis and the angle in `[0, π]` of a rotation matrix, accurate for every angle.
    ///
    /// At angle 0 every axis is right and `X` is returned; at π both directions are right and one is returned.
    ///
    /// # Errors
    /// The matrix is no rotation: its columns are not orthonormal within 1e-9, or it mirrors.
    pub fn from_matrix(matrix: &DMat3) -> Result<Self, RotationError> {
        check_rotation(matrix)?;
        let turn = DQuat::from_mat3(matrix);
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let sine = turn.xyz().length();
        let angle = 2.0 * sine.atan2(turn.w);
        let axis = turn.xyz().try_normalize().unwrap_or(DVec3::X);
        Ok(Self { axis, angle })
    }
}

/// Angles of a rotation `R_y(yaw) · R_x(pitch) · R_z(roll)`, with y up: roll is applied first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YawPitchRoll {
    /// About y, in radians.
    pub yaw: f64,
    /// About x, in radians.
    pub pitch: f64,
    /// About z, in radians.
    pub roll: f64,
}

impl YawPitchRoll {
    /// The rotation matrix.
    pub fn to_matrix(&self) -> DMat3 {
        DMat3::from_rotation_y(self.yaw) * DMat3::from_rotation_x(self.pitch) * DMat3::from_rotation_z(self.roll)
    }

    /// The angles of a rotation matrix, pitch in `[-π/2, π/2]`, and whether it is in gimbal lock: with the pitch at
    /// ±π/2 (cosine under 1e-9) only yaw ∓ roll is determined; roll is then 0.
    ///
    /// # Errors
    /// The matrix is no rotation: its columns are not orthonormal within 1e-9, or it mirrors.
    pub fn from_matrix(matrix: &DMat3) -> Result<(Self, bool), RotationError> {
        check_rotation(matrix)?;
        let entry = |row: usize, column: usize| matrix.col(column)[row];
        let cosine = entry(1, 0).hypot(entry(1, 1));
        let pitch = (-entry(1, 2)).atan2(cosine);
        if cosine < 1e-9 {
            let yaw = (-entry(2, 0)).atan2(entry(0, 0));
            return Ok((Self { yaw, pitch, roll: 0.0 }, true));
        }
        let yaw = entry(0, 2).atan2(entry(2, 2));
        let roll = entry(1, 0).atan2(entry(1, 1));
        Ok((Self { yaw, pitch, roll }, false))
    }
}

fn check_rotation(matrix: &DMat3) -> Result<(), RotationError> {
    let gram = matrix.transpose() * *matrix - DMat3::IDENTITY;
    let worst = gram.to_cols_array().iter().fold(0.0f64, |worst, entry| worst.max(entry.abs()));
    let determinant = matrix.determinant();
    if matrix.is_finite() && worst <= 1e-9 && determinant > 0.0 {
        Ok(())
    } else {
        Err(RotationError::Matrix { deviation: worst, determinant })
    }
}

/// Why something is no rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RotationError {
    /// An axis without a direction.
    Axis {
        /// The axis as given.
        found: DVec3,
    },
    /// An angle that is not finite.
    Angle {
        /// The angle as given.
        found: f64,
    },
    /// A matrix that is not orthonormal, or mirrors.
    Matrix {
        /// The largest entry of `MᵀM - 1`.
        deviation: f64,
        /// The determinant.
        determinant: f64,
    },
}

impl fmt::Display for RotationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axis { found } => write!(f, "rotation axis: found {found}, expected a finite vector with a length"),
            Self::Angle { found } => write!(f, "rotation angle: found {found}, expected a finite number"),
            Self::Matrix { deviation, determinant } => write!(
                f,
                "rotation matrix: found columns that differ from orthonormal by {deviation:.3e} and determinant \
                 {determinant}, expected an orthonormal matrix with determinant 1"
            ),
        }
    }
}

impl std::error::Error for RotationError {}

impl Diagnostic for RotationError {
    fn code(&self) -> &'static str {
        match self {
            Self::Axis { .. } => "E-rotation-axis",
            Self::Angle { .. } => "E-rotation-angle",
            Self::Matrix { .. } => "E-rotation-matrix",
        }
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn close(a: &DMat3, b: &DMat3) -> bool {
        a.abs_diff_eq(*b, 1e-12)
    }

    #[test]
    fn axis_and_angle_come_back_at_every_angle() {
        let axis = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        for angle in [1e-12, 1e-6, 0.5, FRAC_PI_2, 3.0, PI - 1e-9, PI] {
            let turn = AxisAngle::new(axis, angle).unwrap();
            let back = AxisAngle::from_matrix(&turn.to_matrix()).unwrap();
            assert!((back.angle() - angle).abs() < 1e-12, "{angle}");
            // At π both directions are right.
            let same = (back.axis() - axis).length().min((back.axis() + axis).length());
            assert!(same < 1e-3 * 1e-12 / angle.min(1e-12) && close(&back.to_matrix(), &turn.to_matrix()), "{angle}");
        }
        assert_eq!(AxisAngle::from_matrix(&DMat3::IDENTITY).unwrap().angle(), 0.0);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let half = AxisAngle::new(axis, PI).unwrap();
            assert!((AxisAngle::from_matrix(&half.to_matrix()).unwrap().angle() - PI).abs() < 1e-12);
        }
    }

    #[test]
    fn yaw_pitch_roll_is_the_product_in_its_order() {
        let angles = YawPitchRoll { yaw: FRAC_PI_2, pitch: 0.0, roll: FRAC_PI_2 };
        // Roll takes x to y, which yaw leaves; yaw takes z to x.
        assert!((angles.to_matrix() * DVec3::X - DVec3::Y).length() < 1e-15);
        assert!((angles.to_matrix() * DVec3::Z - DVec3::X).length() < 1e-15);
    }

    #[test]
    fn yaw_pitch_roll_comes_back() {
        for yaw in [-3.0, -1.0, 0.0, 0.4, 2.9] {
            for pitch in [-1.5, -0.3, 0.0, 1.2] {
                for roll in [-2.8, 0.0, 1.7] {
                    let angles = YawPitchRoll { yaw, pitch, roll };
                    let (back, lock) = YawPitchRoll::from_matrix(&angles.to_matrix()).unwrap();
                    assert!(!lock);
                    assert!((back.yaw - yaw).abs() < 1e-12 && (back.pitch - pitch).abs() < 1e-12);
                    assert!((back.roll - roll).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn gimbal_lock_is_said_and_the_matrix_is_kept() {
        for pitch in [FRAC_PI_2, -FRAC_PI_2] {
            let angles = YawPitchRoll { yaw: 0.7, pitch, roll: 0.4 };
            let (back, lock) = YawPitchRoll::from_matrix(&angles.to_matrix()).unwrap();
            assert!(lock && back.roll == 0.0);
            assert!(close(&back.to_matrix(), &angles.to_matrix()));
        }
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        assert!(AxisAngle::new(DVec3::ZERO, 1.0).is_err());
        assert!(AxisAngle::new(DVec3::X, f64::NAN).is_err());
        assert!(AxisAngle::new(DVec3::new(1e-200, 0.0, 0.0), 1.0).is_ok());
        assert!(AxisAngle::from_matrix(&DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))).is_err());
        assert!(YawPitchRoll::from_matrix(&(DMat3::IDENTITY * 2.0)).is_err());
        assert!(YawPitchRoll::from_matrix(&DMat3::NAN).is_err());
    }
}
