//! Height fields as writers of grids need them: along the axes, the northern row first.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Affine, Exec};
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Geometry, Shape, UpAxis};

use crate::placed::only_part;
use crate::{Format, WriteError};

/// The one height field of a shape, seen from above.
pub(crate) struct Level<'a> {
    field: &'a HeightField,
    /// How a height of the field becomes one of space.
    factor: f64,
    offset: f64,
    /// Whether columns run to the west, rows to the south.
    flipped: [bool; 2],
    pub(crate) spacing: DVec2,
    /// Where the south-western sample is.
    pub(crate) south_west: DVec2,
}

impl<'a> Level<'a> {
    /// # Errors
    /// A shape of no part or several, a field that is turned or sheared, or places that are not finite.
    pub(crate) fn try_new(shape: &'a Shape, format: &Format) -> Result<Self, WriteError> {
        let part = only_part(shape, format, "height fields")?;
        let Geometry::HeightField(field) = &*part.geometry else {
            let kind = part.geometry.kind();
            return Err(WriteError::Unsupported { format: format.id, part: 0, kind, holds: format.kinds });
        };
        let turn = shape.up.map_or(Affine::IDENTITY, |up| up.rotation_to(UpAxis::Z));
        // Products with the identity may turn -0 into 0, and round.
        let place = [turn, part.placement]
            .into_iter()
            .rev()
            .fold(*field.placement(), |inner, outer| if outer == Affine::IDENTITY { inner } else { outer * inner });
        let DVec3 { x, y, z } = DVec3::new(place.linear.x_axis.x, place.linear.y_axis.y, place.linear.z_axis.z);
        let across = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];
        let level = across.iter().all(|&(column, row)| place.linear.col(column)[row] == 0.0);
        if !level || x == 0.0 || y == 0.0 {
            return Err(WriteError::Turned { format: format.id, part: 0, name: part.name.clone() });
        }
        let spacing = field.spacing() * DVec2::new(x, y);
        let far = DVec2::new(f64::from(field.columns() - 1), f64::from(field.rows() - 1)) * spacing;
        let origin = place.translation.truncate();
        let not_finite = |index| WriteError::NotFinite {
            format: format.id,
            part: 0,
            name: part.name.clone(),
            element: "sample",
            index,
        };
        let upward = z.is_finite() && place.translation.z.is_finite();
        if !(upward
            && origin.is_finite()
            && (origin + far).is_finite()
            && spacing.is_finite()
            && spacing.min_element() != 0.0)
        {
            return Err(not_finite(0));
        }
        let found = Self {
            field,
            factor: z,
            offset: place.translation.z,
            flipped: [x < 0.0, y < 0.0],
            spacing: spacing.abs(),
            south_west: DVec2::new(
                if x < 0.0 { origin.x + far.x } else { origin.x },
                if y < 0.0 { origin.y + far.y } else { origin.y },
            ),
        };
        match field.heights().iter().position(|&height| found.placed(height).is_infinite()) {
            Some(index) => Err(not_finite(index)),
            None => Ok(found),
        }
    }

    pub(crate) fn columns(&self) -> u32 {
        self.field.columns()
    }

    pub(crate) fn rows(&self) -> u32 {
        self.field.rows()
    }

    /// The heights of a row, counted from the northern one, from west to east; not a number for holes.
    pub(crate) fn row(&self, row: u32) -> impl Iterator<Item = f64> + '_ {
        let (columns, rows) = (self.columns() as usize, self.rows() as usize);
        let row = if self.flipped[1] { row as usize } else { rows - 1 - row as usize };
        let heights = &self.field.heights()[row * columns..(row + 1) * columns];
        let west = self.flipped[0];
        (0..columns).map(move |column| self.placed(heights[if west { columns - 1 - column } else { column }]))
    }

    /// The lowest and the highest height; none if all are holes.
    pub(crate) fn range(&self, exec: &Exec) -> Result<Option<(f64, f64)>, WriteError> {
        let mut range: Option<(f64, f64)> = None;
        for row in 0..self.rows() {
            exec.check()?;
            for height in self.row(row).filter(|height| !height.is_nan()) {
                let (low, high) = range.unwrap_or((height, height));
                range = Some((low.min(height), high.max(height)));
            }
        }
        Ok(range)
    }

    pub(crate) fn has_holes(&self) -> bool {
        self.field.heights().iter().any(|height| height.is_nan())
    }

    fn placed(&self, height: f64) -> f64 {
        // As it is, where nothing changes it: -0 too.
        if self.factor == 1.0 && self.offset == 0.0 { height } else { height * self.factor + self.offset }
    }
}
