//! Height fields.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Aabb, Affine};

use crate::MeshError;

/// Heights over a regular grid, bilinear between the samples.
///
/// Sample `(i, j)`, with `i` along the columns and `j` along the rows, is at `(i · spacing.x, j · spacing.y, height)` in
/// the field's own frame, which `placement` puts into space. A height of NaN is a hole: cells that touch it are not
/// part of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    columns: u32,
    rows: u32,
    spacing: DVec2,
    heights: Vec<f64>,
    placement: Affine,
}

impl HeightField {
    /// A field of `columns × rows` heights, row by row, at the origin.
    ///
    /// # Errors
    /// Fewer than two columns or rows, another number of heights, a height that is infinite, or a spacing that is not
    /// positive and finite (named as position of sample 0).
    pub fn try_new(columns: u32, rows: u32, spacing: DVec2, heights: Vec<f64>) -> Result<Self, MeshError> {
        let wanted = u64::from(columns) * u64::from(rows);
        if columns < 2 || rows < 2 || wanted != heights.len() as u64 {
            let (columns, rows) = (u64::from(columns), u64::from(rows));
            return Err(MeshError::GridSize { columns, rows, found: heights.len() as u64 });
        }
        crate::poly_mesh::check_count("samples", heights.len())?;
        if !(spacing.is_finite() && spacing.min_element() > 0.0) {
            return Err(MeshError::NotFinite { kind: "sample", index: 0 });
        }
        if let Some(index) = heights.iter().position(|height| height.is_infinite()) {
            return Err(MeshError::NotFinite { kind: "sample", index: index as u64 });
        }
        Ok(Self { columns, rows, spacing, heights, placement: Affine::IDENTITY })
    }

    /// The same field placed in space.
    #[must_use]
    pub fn placed(mut self, placement: Affine) -> Self {
        self.placement = placement;
        self
    }

    /// The number of samples along the first direction.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// The number of samples along the second direction.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// The distance between samples in both directions.
    pub fn spacing(&self) -> DVec2 {
        self.spacing
    }

    /// The heights, row by row; NaN for holes.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The map from the field's frame to space.
    pub fn placement(&self) -> &Affine {
        &self.placement
    }

    /// The sample at a column and row in space; none for a hole.
    ///
    /// # Panics
    /// When there is no such column or row.
    pub fn sample(&self, column: u32, row: u32) -> Option<DVec3> {
        assert!(column < self.columns && row < self.rows, "sample {column}, {row} is outside the grid");
        let height = self.heights[row as usize * self.columns as usize + column as usize];
        let local = DVec3::new(f64::from(column) * self.spacing.x, f64::from(row) * self.spacing.y, height);
        (!height.is_nan()).then(|| self.placement.point(local))
    }

    /// The smallest box around the samples.
    pub fn bounds(&self) -> Aabb {
        let samples = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        Aabb::from_points(samples.filter_map(|(column, row)| self.sample(column, row)))
    }

    /// The image under an affine map.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self { placement: *map * self.placement, ..self.clone() }
    }

    /// The memory that the field takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.heights.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_where_the_grid_says() {
        let heights = vec![0.0, 1.0, 2.0, 3.0, 4.0, f64::NAN];
        let field = HeightField::try_new(3, 2, DVec2::new(10.0, 20.0), heights).unwrap();
        assert_eq!(field.sample(1, 1), Some(DVec3::new(10.0, 20.0, 4.0)));
        assert_eq!(field.sample(2, 1), None);
        assert_eq!(field.bounds().max, DVec3::new(20.0, 20.0, 4.0));
    }

    #[test]
    fn impossible_grids_are_refused() {
        assert!(HeightField::try_new(2, 2, DVec2::ONE, vec![0.0; 3]).is_err());
        assert!(HeightField::try_new(1, 3, DVec2::ONE, vec![0.0; 3]).is_err());
        assert!(HeightField::try_new(2, 2, DVec2::new(1.0, 0.0), vec![0.0; 4]).is_err());
        assert!(HeightField::try_new(2, 2, DVec2::ONE, vec![0.0, f64::INFINITY, 0.0, 0.0]).is_err());
        assert!(HeightField::try_new(u32::MAX, u32::MAX, DVec2::ONE, vec![]).is_err());
    }
}
