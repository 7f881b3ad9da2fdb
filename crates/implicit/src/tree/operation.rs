//! What a node of a tree does.

use std::fmt;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Field};

use super::{Nature, Tree};
use crate::blobs::Blobs;
use crate::operator::{Binary, Unary};
use crate::shapes::{Blend, Domain, Primitive, SetOperation};

/// What a node does, with its parameters and the trees that it is made of.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Operation {
    /// A number.
    Constant(f64),
    /// The coordinate along axis 0, 1 or 2.
    Coordinate(Axis),
    /// An operator of one operand.
    Unary(Unary, Tree),
    /// An operator of two operands.
    Binary(Binary, Tree, Tree),
    /// A whole power.
    Power(Tree, i32),
    /// A solid given by numbers.
    Primitive(Primitive),
    /// Several solids as one; of a difference, the first without the others.
    Set(SetOperation, Vec<Tree>),
    /// Everything outside: `-f`.
    Complement(Tree),
    /// Two solids, blended.
    Blend(Blend, Tree, Tree),
    /// Grown by a distance, or shrunk by a negative one: `f - d`.
    Offset(f64, Tree),
    /// The hull of a thickness around the surface: `|f| - t / 2`.
    Shell(f64, Tree),
    /// The values of one tree added to another's: `f + g`.
    Displace(Tree, Tree),
    /// The image of a solid under an affine map. Values are multiplied by the least stretch of the map, so that distances
    /// under a similarity stay distances, and bounds stay bounds.
    Transform(Affine, Tree),
    /// Space bent before the tree is asked.
    Domain(Domain, Tree),
    /// The last tree, asked at the place that the three others give.
    Substitute([Tree; 3], Tree),
    /// A name for a part.
    Named(Arc<str>, Tree),
    /// A field from elsewhere.
    Foreign(Foreign),
    /// A field of blobs.
    Blobs(Arc<Blobs>),
}

/// One of the three coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
}

impl Axis {
    /// All three.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The unit vector.
    pub fn vector(self) -> DVec3 {
        DVec3::AXES[self.index()]
    }
}

/// A field that another crate made, with the words that name it in text.
#[derive(Clone)]
pub struct Foreign {
    source: Arc<str>,
    field: Arc<dyn Field>,
    nature: Nature,
}

impl Foreign {
    /// The field, and the words that bring it back when text is read, such as `mesh("tooth.stl")`.
    ///
    /// Two are equal when their words are. `exact` says that the values are distances up to rounding; whether they are bounds of
    /// distances follows from [`Field::lipschitz`].
    pub fn new(source: impl Into<Arc<str>>, field: Arc<dyn Field>, exact: bool) -> Self {
        let nature = Nature { exact, lipschitz: field.lipschitz() };
        Self { source: source.into(), field, nature }
    }

    /// The words that name it.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The field.
    pub fn field(&self) -> &Arc<dyn Field> {
        &self.field
    }

    /// What is known of its values.
    pub fn nature(&self) -> Nature {
        self.nature
    }
}

impl fmt::Debug for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Foreign").field(&self.source).finish()
    }
}

impl Operation {
    /// The name in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Constant(_) => "constant",
            Self::Coordinate(_) => "coordinate",
            Self::Unary(operator, _) => operator.name(),
            Self::Binary(operator, ..) => operator.name(),
            Self::Power(..) => "power",
            Self::Primitive(primitive) => primitive.name(),
            Self::Set(operation, _) => operation.name(),
            Self::Complement(_) => "complement",
            Self::Blend(blend, ..) => blend.name(),
            Self::Offset(..) => "offset",
            Self::Shell(..) => "shell",
            Self::Displace(..) => "displace",
            Self::Transform(..) => "transform",
            Self::Domain(domain, _) => domain.name(),
            Self::Substitute(..) => "substitute",
            Self::Named(..) => "named",
            Self::Foreign(_) => "foreign",
            Self::Blobs(blobs) => blobs.form().name(),
        }
    }

    /// The trees that it is made of, in order.
    pub fn children(&self) -> impl DoubleEndedIterator<Item = &Tree> {
        let (few, many): ([Option<&Tree>; 4], &[Tree]) = match self {
            Self::Constant(_) | Self::Coordinate(_) | Self::Primitive(_) | Self::Foreign(_) | Self::Blobs(_) => {
                ([None; 4], &[])
            }
            Self::Unary(_, a)
            | Self::Power(a, _)
            | Self::Complement(a)
            | Self::Offset(_, a)
            | Self::Shell(_, a)
            | Self::Transform(_, a)
            | Self::Domain(_, a)
            | Self::Named(_, a) => ([Some(a), None, None, None], &[]),
            Self::Binary(_, a, b) | Self::Blend(_, a, b) | Self::Displace(a, b) => {
                ([Some(a), Some(b), None, None], &[])
            }
            Self::Substitute([x, y, z], of) => ([Some(x), Some(y), Some(z), Some(of)], &[]),
            Self::Set(_, parts) => ([None; 4], parts),
        };
        few.into_iter().flatten().chain(many)
    }

    /// The trees that it is made of, taken out.
    pub(super) fn into_children(self) -> Vec<Tree> {
        match self {
            Self::Constant(_) | Self::Coordinate(_) | Self::Primitive(_) | Self::Foreign(_) | Self::Blobs(_) => {
                Vec::new()
            }
            Self::Unary(_, a)
            | Self::Power(a, _)
            | Self::Complement(a)
            | Self::Offset(_, a)
            | Self::Shell(_, a)
            | Self::Transform(_, a)
            | Self::Domain(_, a)
            | Self::Named(_, a) => vec![a],
            Self::Binary(_, a, b) | Self::Blend(_, a, b) | Self::Displace(a, b) => vec![a, b],
            Self::Substitute([x, y, z], of) => vec![x, y, z, of],
            Self::Set(_, parts) => parts,
        }
    }
}
