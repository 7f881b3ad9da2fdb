//! Input checked and brought to a size of about 1.

use std::ops::Range;

use glam::DVec3;
use shapeloom_core::{Aabb, Exec, parallel};

use crate::BvhError;

/// Scaled units, a power of two apart from the model's so that scaling is exact, in which the shape has a size of about
/// 1: nothing overflows whatever the model's unit is. Local units are these about the centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Units {
    /// The model's length of one unit.
    pub unit: f64,
    pub per_unit: f64,
    /// In scaled units.
    pub center: DVec3,
}

impl Units {
    pub fn new(bounds: &Aabb) -> Self {
        let center = bounds.center();
        let half = (bounds.max * 0.5 - bounds.min * 0.5).max_element();
        // A shape that is tiny beside its coordinates must not scale them beyond the numbers.
        let size = half.max(center.abs().max_element() * 2f64.powi(-60));
        let size = if size > 0.0 { size.max(2f64.powi(-1000)) } else { 1.0 };
        // Clearing the fraction leaves the power of two.
        let unit = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
        Self { unit, per_unit: 1.0 / unit, center: center / unit }
    }
}

/// The box around the triangles, if every corner exists and is finite.
pub(crate) fn checked_bounds(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<Aabb, BvhError> {
    if triangles.len() >= u32::MAX as usize {
        return Err(BvhError::TooMany { found: triangles.len() });
    }
    let parts = parallel::map_chunks(exec, triangles.len(), 1 << 14, |range: Range<usize>| {
        let mut bounds = Aabb::EMPTY;
        for triangle in range {
            for (corner, &found) in triangles[triangle].iter().enumerate() {
                let (triangle, corner) = (triangle as u32, corner as u8);
                let Some(&position) = positions.get(found as usize) else {
                    return Err(BvhError::Index { triangle, corner, found, positions: positions.len() });
                };
                if !position.is_finite() {
                    return Err(BvhError::NotFinite { triangle, position: found, found: position });
                }
                bounds = Aabb { min: bounds.min.min(position), max: bounds.max.max(position) };
            }
        }
        Ok(bounds)
    })?;
    Ok(parts.into_iter().fold(Aabb::EMPTY, Aabb::union))
}
