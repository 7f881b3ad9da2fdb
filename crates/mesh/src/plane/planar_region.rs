//! Regions of a plane, bounded by loops.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::poly_mesh::check_count;
use crate::{Attributes, MeshError, Polyline};

/// A region of a plane in space that closed loops bound by the even-odd rule: a point is inside if a way to it from
/// outside crosses an odd number of sides.
///
/// So a loop within another is a hole, one within the hole an island, and a loop beside the others a region of its own,
/// whatever their order and directions. Loops do not repeat their first point. Nothing else is promised: loops may cross or
/// touch themselves and each other, and the points need not lie on one plane; [`TriangulateRegion`](crate::TriangulateRegion)
/// says what it found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanarRegion {
    points: Vec<DVec3>,
    /// Where each loop starts in `points`, and at last their number.
    starts: Vec<u32>,
    attributes: Attributes,
}

impl PlanarRegion {
    /// A region bounded by these loops, each a list of points.
    ///
    /// # Errors
    /// More points than 32 bits can tell apart.
    pub fn try_new<L: AsRef<[DVec3]>>(loops: &[L]) -> Result<Self, MeshError> {
        let count = loops.iter().map(|points| points.as_ref().len()).sum();
        check_count("points", count)?;
        let points: Vec<DVec3> = loops.iter().flat_map(|points| points.as_ref().iter().copied()).collect();
        let lengths = loops.iter().map(|points| points.as_ref().len() as u32);
        let starts = std::iter::once(0).chain(lengths.scan(0, |end, length| {
            *end += length;
            Some(*end)
        }));
        Ok(Self { attributes: Attributes::new(points.len()), starts: starts.collect(), points })
    }

    /// The points of all loops, one loop after the other.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The loops in order.
    pub fn loops(&self) -> impl Iterator<Item = &[DVec3]> {
        self.ranges().map(|range| &self.points[range])
    }

    /// The two points of each side, numbered through all loops: side `i` starts at point `i`.
    pub fn sides(&self) -> Vec<[u32; 2]> {
        let side = |range: std::ops::Range<usize>| {
            let (first, last) = (range.start as u32, range.end as u32);
            (first..last).map(move |from| [from, if from + 1 == last { first } else { from + 1 }])
        };
        self.ranges().flat_map(side).collect()
    }

    /// The attribute columns of the points.
    pub fn attributes(&self) -> &Attributes {
        &self.attributes
    }

    /// The smallest box around the points.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.points.iter().copied())
    }

    /// The image under an affine map; attributes move by their rules.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let points = self.points.iter().map(|&point| map.point(point)).collect();
        Self { points, starts: self.starts.clone(), attributes: self.attributes.transformed(map) }
    }

    pub(crate) fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        self.starts.windows(2).map(|pair| pair[0] as usize..pair[1] as usize)
    }
}

/// The region inside one polyline, which is closed by a straight side if it is open; attributes and all.
///
/// # Panics
/// When the polyline has more points than 32 bits can tell apart.
impl From<&Polyline> for PlanarRegion {
    fn from(line: &Polyline) -> Self {
        let count = u32::try_from(line.points().len()).expect("a polyline of fewer points than 32 bits can tell apart");
        Self { points: line.points().to_vec(), starts: vec![0, count], attributes: line.attributes().clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;

    #[test]
    fn sides_are_numbered_through_all_loops() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
        let region = PlanarRegion::try_new(&[&square[..], &square[..0], &square[..3], &square[..1]]).unwrap();
        let wanted = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 4], [7, 7]];
        assert_eq!(region.sides(), wanted);
        assert_eq!(region.loops().map(<[DVec3]>::len).collect::<Vec<_>>(), [4, 0, 3, 1]);
        assert_eq!(region.bounds().max, DVec3::ONE);
        assert_eq!(PlanarRegion::default().sides(), [[0u32; 2]; 0]);
        let mut line = Polyline::new(square.to_vec(), true);
        line.insert_attribute(Column::labels("id", vec![4, 5, 6, 7])).unwrap();
        let region = PlanarRegion::from(&line);
        assert_eq!((region.points(), region.attributes()), (line.points(), line.attributes()));
        let moved = region.transformed(&Affine::from_translation(DVec3::Z));
        assert_eq!((moved.points()[1], moved.sides()), (DVec3::X + DVec3::Z, region.sides()));
    }
}
