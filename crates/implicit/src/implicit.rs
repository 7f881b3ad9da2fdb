//! An implicit shape as a value: its tree, compiled, and where it lies.

use std::fmt;
use std::sync::{Arc, OnceLock};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, Category, Diagnostic, Exec, Field, Interval, Restricted};

use crate::{CompileError, Nature, Program, Tree, find_bounds};

/// A tree with its program and, where it was given, the box that holds the shape. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Implicit {
    tree: Tree,
    program: Program,
    given: Option<Aabb>,
    found: Arc<OnceLock<Aabb>>,
}

impl Implicit {
    /// The shape of a tree.
    ///
    /// # Errors
    /// Whatever [`Tree::compile`] finds.
    pub fn new(tree: Tree) -> Result<Self, CompileError> {
        let program = tree.compile()?;
        Ok(Self { tree, program, given: None, found: Arc::default() })
    }

    /// The shape, to be looked at in a box alone.
    ///
    /// # Errors
    /// The box is empty, flat or not finite.
    pub fn within(self, bounds: Aabb) -> Result<Self, BoundsError> {
        let size = bounds.size();
        if bounds.min.is_finite() && bounds.max.is_finite() && size.min_element() > 0.0 && size.is_finite() {
            Ok(Self { given: Some(bounds), ..self })
        } else {
            Err(BoundsError { found: bounds })
        }
    }

    /// What the shape is.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The compiled form.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The box that was given.
    pub fn given_bounds(&self) -> Option<Aabb> {
        self.given
    }

    /// The box that was given, else one found by [`find_bounds`], once; empty where the shape is, or has no end.
    pub fn bounds(&self) -> Aabb {
        let find = || find_bounds(&self.program, &Exec::default()).map_or(Aabb::EMPTY, |found| found.bounds);
        self.given.unwrap_or_else(|| *self.found.get_or_init(find))
    }

    /// What is known of the values.
    pub fn nature(&self) -> Nature {
        self.program.nature()
    }

    /// The image under an affine map. Under a singular one, which no tree can express, nothing changes.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let given = self.given.map(|bounds| bounds.transformed(map));
        match Self::new(self.tree.clone().transform(*map)) {
            Ok(moved) => Self { given, ..moved },
            Err(_) => self.clone(),
        }
    }

    /// About how much memory the tree and the program take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.tree.node_count() * size_of::<crate::Operation>() + self.program.memory_bytes()
    }
}

/// Equal trees in equal boxes.
impl PartialEq for Implicit {
    fn eq(&self, other: &Self) -> bool {
        self.given == other.given && self.tree == other.tree
    }
}

impl Field for Implicit {
    fn value(&self, point: DVec3) -> f64 {
        self.program.value(point)
    }

    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        self.program.values(origin, x, y, z, out);
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        self.program.gradient(point)
    }

    fn range(&self, region: &Aabb) -> Interval {
        self.program.range(region)
    }

    fn lipschitz(&self) -> Option<f64> {
        self.program.lipschitz()
    }

    fn extent(&self) -> Option<Aabb> {
        self.given
    }

    fn restrict(&self, region: &Aabb) -> Restricted {
        self.program.restrict(region)
    }
}

/// A box in which no shape can be looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundsError {
    /// The box.
    pub found: Aabb,
}

impl fmt::Display for BoundsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = [self.found.min, self.found.max];
        write!(
            f,
            "bounds: found corners ({}, {}, {}) and ({}, {}, {}), expected finite ones, the second larger along each axis",
            a.x, a.y, a.z, b.x, b.y, b.z
        )
    }
}

impl std::error::Error for BoundsError {}

impl Diagnostic for BoundsError {
    fn code(&self) -> &'static str {
        "E-implicit-bounds"
    }

    fn category(&self) -> Category {
        Category::Malformed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_without_room_are_refused() {
        let ball = || Implicit::new(Tree::sphere(1.0)).unwrap();
        let corners = |lo: f64, hi: f64| Aabb { min: DVec3::splat(lo), max: DVec3::splat(hi) };
        assert_eq!(ball().within(corners(-1.0, 2.0)).unwrap().given_bounds(), Some(corners(-1.0, 2.0)));
        for (lo, hi) in [(1.0, -1.0), (0.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-1e308, 1e308)] {
            assert!(ball().within(corners(lo, hi)).is_err(), "{lo} {hi}");
        }
    }

    #[test]
    fn images_move_field_and_box() {
        let bounds = Aabb { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let ball = Implicit::new(Tree::sphere(1.0)).unwrap().within(bounds).unwrap();
        let moved = ball.transformed(&Affine::from_translation(DVec3::X * 3.0));
        assert!((moved.value(DVec3::X * 2.0)).abs() < 1e-15);
        assert_eq!(moved.given_bounds().unwrap().min, DVec3::new(2.0, -1.0, -1.0));
        assert_ne!(moved, ball);
    }
}
