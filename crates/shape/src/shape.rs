//! Shapes and their parts.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use shapeloom_core::{Aabb, Affine};

use crate::{Geometry, Kind, Material, Table, Units, UpAxis};

/// A geometry placed in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The name; empty if it has none.
    pub name: String,
    /// The geometry, in its own coordinates. Parts with the same one are instances of it.
    pub geometry: Arc<Geometry>,
    /// Where the geometry is.
    pub placement: Affine,
    /// Which of the shape's materials it has.
    pub material: Option<u32>,
}

impl Part {
    /// A part without a name, where its coordinates say.
    pub fn new(geometry: impl Into<Geometry>) -> Self {
        Self { name: String::new(), geometry: Arc::new(geometry.into()), placement: Affine::IDENTITY, material: None }
    }

    /// The same part with a name.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The geometry in the coordinates of the shape.
    pub fn placed(&self) -> Arc<Geometry> {
        if self.placement == Affine::IDENTITY {
            Arc::clone(&self.geometry)
        } else {
            Arc::new(self.geometry.transformed(&self.placement))
        }
    }

    /// A box that holds the part: around the placed box of its geometry.
    pub fn bounds(&self) -> Aabb {
        self.geometry.bounds().transformed(&self.placement)
    }
}

/// Parts of any representation, with what is common to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// The parts.
    pub parts: Vec<Part>,
    /// The materials that parts refer to.
    pub materials: Vec<Material>,
    /// How long one unit is, if that is known.
    pub units: Option<Units>,
    /// Which way is up, if that is known.
    pub up: Option<UpAxis>,
    /// Rows of the file that are no elements of a part.
    pub tables: Vec<Table>,
    /// What the file says in words to its reader, a line or paragraph each.
    pub comments: Vec<String>,
}

impl Shape {
    /// A shape of one part.
    pub fn new(part: Part) -> Self {
        Self { parts: vec![part], ..Self::default() }
    }

    /// A box that holds all parts; exact up to rounding where placements do not turn.
    pub fn bounds(&self) -> Aabb {
        let mut known = HashMap::new();
        let placed = self.parts.iter().map(|part| {
            let own = known.entry(Arc::as_ptr(&part.geometry)).or_insert_with(|| part.geometry.bounds());
            own.transformed(&part.placement)
        });
        placed.fold(Aabb::EMPTY, Aabb::union)
    }

    /// The kinds of the parts, each once, in the order of [`Kind`].
    pub fn kinds(&self) -> Vec<Kind> {
        let mut kinds: Vec<Kind> = self.parts.iter().map(|part| part.geometry.kind()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    }

    /// The image under an affine map: the placements change, the geometries stay shared.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let mut moved = self.clone();
        for part in &mut moved.parts {
            part.placement = *map * part.placement;
        }
        moved
    }

    /// The memory that the geometries and tables take, in bytes; shared geometries counted once.
    pub fn memory_bytes(&self) -> usize {
        let mut seen = HashSet::new();
        let first_seen = self.parts.iter().filter(|part| seen.insert(Arc::as_ptr(&part.geometry)));
        let geometries: usize = first_seen.map(|part| part.geometry.memory_bytes()).sum();
        geometries + self.tables.iter().map(Table::memory_bytes).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;
    use shapeloom_mesh::PointCloud;

    #[test]
    fn instances_share_their_memory_and_move_apart() {
        let part = Part::new(PointCloud::new(vec![DVec3::ZERO, DVec3::ONE]));
        let mut shape = Shape::new(part.clone());
        let single = shape.memory_bytes();
        shape.parts.push(Part { placement: Affine::from_translation(DVec3::X * 9.0), ..part });
        assert_eq!(shape.memory_bytes(), single);
        assert_eq!(shape.bounds().max, DVec3::new(10.0, 1.0, 1.0));
        assert_eq!(shape.kinds(), [Kind::PointCloud]);
        assert_eq!(shape.transformed(&Affine::from_translation(DVec3::Y)).bounds().min, DVec3::Y);
    }
}
