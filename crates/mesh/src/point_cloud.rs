//! Point clouds.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::{AttributeError, Attributes, Column, ListColumn};

/// Points in no order, with attribute columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud {
    positions: Vec<DVec3>,
    attributes: Attributes,
}

impl PointCloud {
    /// Points without attributes.
    pub fn new(positions: Vec<DVec3>) -> Self {
        let attributes = Attributes::new(positions.len());
        Self { positions, attributes }
    }

    /// The positions.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions, to be moved.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.positions
    }

    /// The attribute columns.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// Adds a column.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_attribute(&mut self, column: Column) -> Result<(), AttributeError> {
        self.attributes.insert(column)
    }

    /// Adds a column of lists.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_list(&mut self, list: ListColumn) -> Result<(), AttributeError> {
        self.attributes.insert_list(list)
    }

    /// The smallest box around the points.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.positions.iter().copied())
    }

    /// The image under an affine map; attributes move by their rules.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let positions = self.positions.iter().map(|&position| map.point(position)).collect();
        Self { positions, attributes: self.attributes.transformed(map) }
    }

    /// The memory that the cloud takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice()) + self.attributes.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NORMAL;

    #[test]
    fn clouds_move_with_their_normals() {
        let mut cloud = PointCloud::new(vec![DVec3::X]);
        cloud.insert_attribute(Column::normals(NORMAL, &[DVec3::X])).unwrap();
        let moved = cloud.transformed(&Affine::from_translation(DVec3::Y));
        assert_eq!(moved.positions(), [DVec3::new(1.0, 1.0, 0.0)]);
        assert_eq!(moved.attributes().get(NORMAL).unwrap().vector(0), DVec3::X);
    }
}
