//! Polylines.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::sums::compensated;
use crate::{AttributeError, Attributes, Column, ListColumn};

/// Points joined by straight segments, open or closed, with attribute columns on the points.
///
/// A closed polyline does not repeat its first point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    points: Vec<DVec3>,
    closed: bool,
    attributes: Attributes,
}

impl Polyline {
    /// A polyline without attributes.
    pub fn new(points: Vec<DVec3>, closed: bool) -> Self {
        let attributes = Attributes::new(points.len());
        Self { points, closed, attributes }
    }

    /// The points in order.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Whether the last point is joined to the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The attribute columns of the points.
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

    /// The segments in order.
    pub fn segments(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        let last =
            if self.closed && self.points.len() > 1 { self.points.last().zip(self.points.first()) } else { None };
        self.points.windows(2).map(|pair| [pair[0], pair[1]]).chain(last.map(|(&a, &b)| [a, b]))
    }

    /// The sum of the lengths of the segments.
    pub fn length(&self) -> f64 {
        compensated(self.segments().map(|[a, b]| a.distance(b)))
    }

    /// The smallest box around the points.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.points.iter().copied())
    }

    /// The image under an affine map; attributes move by their rules.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let points = self.points.iter().map(|&point| map.point(point)).collect();
        Self { points, closed: self.closed, attributes: self.attributes.transformed(map) }
    }

    /// The memory that the polyline takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.points.as_slice()) + self.attributes.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_a_square_adds_its_last_side() {
        let square = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        assert_eq!(Polyline::new(square.clone(), false).length(), 3.0);
        assert_eq!(Polyline::new(square, true).length(), 4.0);
        assert_eq!(Polyline::new(vec![DVec3::X], true).length(), 0.0);
        assert_eq!(Polyline::default().length(), 0.0);
    }
}
