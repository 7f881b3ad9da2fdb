//! Trees by methods and operators.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Affine, AxisAngle, Field};

use super::{Axis, Foreign, Operation, Tree};
use crate::blobs::Blobs;
use crate::operator::{Binary, Unary};
use crate::shapes::{Blend, BlendForm, Domain, Primitive, Quadric, SetOperation};

impl From<f64> for Tree {
    fn from(value: f64) -> Self {
        Self::new(Operation::Constant(value))
    }
}

impl From<Primitive> for Tree {
    fn from(primitive: Primitive) -> Self {
        Self::new(Operation::Primitive(primitive))
    }
}

impl From<Quadric> for Tree {
    fn from(quadric: Quadric) -> Self {
        Primitive::Quadric(quadric).into()
    }
}

/// Coordinates and formulas.
impl Tree {
    /// A number.
    pub fn constant(value: f64) -> Self {
        value.into()
    }

    /// The coordinate along x.
    pub fn x() -> Self {
        Self::new(Operation::Coordinate(Axis::X))
    }

    /// The coordinate along y.
    pub fn y() -> Self {
        Self::new(Operation::Coordinate(Axis::Y))
    }

    /// The coordinate along z.
    pub fn z() -> Self {
        Self::new(Operation::Coordinate(Axis::Z))
    }

    /// An operator of one operand.
    #[must_use]
    pub fn unary(self, operator: Unary) -> Self {
        Self::new(Operation::Unary(operator, self))
    }

    /// An operator of two operands.
    #[must_use]
    pub fn binary(self, operator: Binary, other: impl Into<Self>) -> Self {
        Self::new(Operation::Binary(operator, self, other.into()))
    }

    /// A whole power.
    #[must_use]
    pub fn power(self, exponent: i32) -> Self {
        Self::new(Operation::Power(self, exponent))
    }

    /// The square.
    #[must_use]
    pub fn square(self) -> Self {
        self.unary(Unary::Square)
    }

    /// The square root.
    #[must_use]
    pub fn square_root(self) -> Self {
        self.unary(Unary::SquareRoot)
    }

    /// The size without the sign.
    #[must_use]
    pub fn absolute(self) -> Self {
        self.unary(Unary::Absolute)
    }

    /// The smaller of two values.
    #[must_use]
    pub fn minimum(self, other: impl Into<Self>) -> Self {
        self.binary(Binary::Minimum, other)
    }

    /// The larger of two values.
    #[must_use]
    pub fn maximum(self, other: impl Into<Self>) -> Self {
        self.binary(Binary::Maximum, other)
    }

    /// The tree asked at the place that three others give.
    #[must_use]
    pub fn substitute(self, x: impl Into<Self>, y: impl Into<Self>, z: impl Into<Self>) -> Self {
        Self::new(Operation::Substitute([x.into(), y.into(), z.into()], self))
    }

    /// The tree under a name.
    #[must_use]
    pub fn named(self, name: impl Into<Arc<str>>) -> Self {
        Self::new(Operation::Named(name.into(), self))
    }

    /// A field of blobs.
    pub fn blobs(blobs: impl Into<Arc<Blobs>>) -> Self {
        Self::new(Operation::Blobs(blobs.into()))
    }

    /// A field from elsewhere; see [`Foreign::new`].
    pub fn foreign(source: impl Into<Arc<str>>, field: Arc<dyn Field>, exact: bool) -> Self {
        Self::new(Operation::Foreign(Foreign::new(source, field, exact)))
    }
}

/// Solids.
impl Tree {
    /// Below a plane; see [`Primitive::Plane`].
    pub fn plane(normal: DVec3, offset: f64) -> Self {
        Primitive::Plane { normal, offset }.into()
    }

    /// A ball about the origin.
    pub fn sphere(radius: f64) -> Self {
        Primitive::Sphere { center: DVec3::ZERO, radius }.into()
    }

    /// The distance to a point.
    pub fn distance_to(point: DVec3) -> Self {
        let along = |axis: Self, at: f64| (axis - at).square();
        (along(Self::x(), point.x) + along(Self::y(), point.y) + along(Self::z(), point.z)).square_root()
    }

    /// A box about the origin, of these whole lengths.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Primitive::Box { size: DVec3::new(x, y, z) }.into()
    }

    /// A box with rounded edges; see [`Primitive::RoundedBox`].
    pub fn rounded_box(size: DVec3, radius: f64) -> Self {
        Primitive::RoundedBox { size, radius }.into()
    }

    /// A cylinder about the z axis.
    pub fn cylinder(radius: f64, height: f64) -> Self {
        Primitive::Cylinder { radius, height }.into()
    }

    /// A cone about the z axis, cut off where `top` is above 0.
    pub fn cone(bottom: f64, top: f64, height: f64) -> Self {
        Primitive::Cone { bottom, top, height }.into()
    }

    /// What lies within a distance of a segment.
    pub fn capsule(start: DVec3, end: DVec3, radius: f64) -> Self {
        Primitive::Capsule { start, end, radius }.into()
    }

    /// A ring about the z axis.
    pub fn torus(major: f64, minor: f64) -> Self {
        Primitive::Torus { major, minor }.into()
    }

    /// A prism over a regular polygon.
    pub fn prism(sides: u32, radius: f64, height: f64) -> Self {
        Primitive::Prism { sides, radius, height }.into()
    }

    /// A disc in the plane, for [`Tree::extrude`] and [`Tree::revolve`].
    pub fn circle(radius: f64) -> Self {
        Primitive::Circle { radius }.into()
    }

    /// A rectangle in the plane, for [`Tree::extrude`] and [`Tree::revolve`].
    pub fn rectangle(x: f64, y: f64) -> Self {
        Primitive::Rectangle { size: DVec2::new(x, y) }.into()
    }
}

/// Sets.
impl Tree {
    /// What lies in any of the parts.
    pub fn union_of(parts: impl IntoIterator<Item = Self>) -> Self {
        Self::new(Operation::Set(SetOperation::Union, parts.into_iter().collect()))
    }

    /// What lies in all of the parts.
    pub fn intersection_of(parts: impl IntoIterator<Item = Self>) -> Self {
        Self::new(Operation::Set(SetOperation::Intersection, parts.into_iter().collect()))
    }

    /// What lies in either.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self::union_of([self, other])
    }

    /// What lies in both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self::intersection_of([self, other])
    }

    /// What lies in this one and not in the other.
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        Self::new(Operation::Set(SetOperation::Difference, vec![self, other]))
    }

    /// Everything outside.
    #[must_use]
    pub fn complement(self) -> Self {
        Self::new(Operation::Complement(self))
    }

    /// The two as one, blended.
    #[must_use]
    pub fn blend(self, other: Self, set: SetOperation, form: BlendForm) -> Self {
        Self::new(Operation::Blend(Blend { set, form }, self, other))
    }

    /// The union with the quadratic smooth minimum; see [`BlendForm::Smooth`].
    #[must_use]
    pub fn smooth_union(self, other: Self, radius: f64) -> Self {
        self.blend(other, SetOperation::Union, BlendForm::Smooth { radius })
    }

    /// Grown by a distance, or shrunk by a negative one.
    #[must_use]
    pub fn offset(self, distance: f64) -> Self {
        Self::new(Operation::Offset(distance, self))
    }

    /// The hull of a thickness around the surface.
    #[must_use]
    pub fn shell(self, thickness: f64) -> Self {
        Self::new(Operation::Shell(thickness, self))
    }

    /// With the values of another field added: its surface moves inward where they are above 0.
    #[must_use]
    pub fn displace(self, by: Self) -> Self {
        Self::new(Operation::Displace(self, by))
    }
}

/// Placing and bending.
impl Tree {
    /// The image under an affine map; see [`Operation::Transform`].
    #[must_use]
    pub fn transform(self, map: Affine) -> Self {
        Self::new(Operation::Transform(map, self))
    }

    /// Moved.
    #[must_use]
    pub fn translate(self, x: f64, y: f64, z: f64) -> Self {
        self.transform(Affine::from_translation(DVec3::new(x, y, z)))
    }

    /// Turned about an axis through the origin, in radians.
    #[must_use]
    pub fn rotate(self, turn: AxisAngle) -> Self {
        self.transform(Affine::from_rotation(turn))
    }

    /// Scaled alike along all axes.
    #[must_use]
    pub fn scale(self, factor: f64) -> Self {
        self.transform(Affine::from_scale(DVec3::splat(factor)))
    }

    /// In space bent or folded; see [`Domain`].
    #[must_use]
    pub fn in_domain(self, domain: Domain) -> Self {
        Self::new(Operation::Domain(domain, self))
    }

    /// The plane shape, extruded along z; see [`Domain::Extrude`].
    #[must_use]
    pub fn extrude(self, height: f64) -> Self {
        self.in_domain(Domain::Extrude { height })
    }

    /// The plane shape, turned about an axis; see [`Domain::Revolve`].
    #[must_use]
    pub fn revolve(self, offset: f64) -> Self {
        self.in_domain(Domain::Revolve { offset })
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $operator:ident,)*) => {$(
        impl<T: Into<Tree>> $trait<T> for Tree {
            type Output = Tree;

            fn $method(self, other: T) -> Tree {
                self.binary(Binary::$operator, other)
            }
        }

        impl $trait<Tree> for f64 {
            type Output = Tree;

            fn $method(self, other: Tree) -> Tree {
                Tree::from(self).binary(Binary::$operator, other)
            }
        }
    )*};
}

operators! {
    Add add Add,
    Sub sub Subtract,
    Mul mul Multiply,
    Div div Divide,
}

impl Neg for Tree {
    type Output = Self;

    fn neg(self) -> Self {
        self.unary(Unary::Negate)
    }
}
