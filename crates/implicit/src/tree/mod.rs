//! Trees of fields: what a shape is, apart from how it is evaluated.

mod build;
mod drop;
mod equal;
mod nature;
mod operation;
mod walk;

use std::fmt;
use std::sync::Arc;

pub use nature::{Meaning, Nature};
pub use operation::{Axis, Foreign, Operation};
pub use walk::post_order;

/// A field as an expression: immutable, cheap to clone, with subtrees that may be shared.
///
/// Negative inside, zero on the surface, positive outside. Built by methods and operators; [`Tree::compile`](crate::Tree::compile)
/// makes a [`Program`](crate::Program) of it, which evaluates. Parameters are not looked at before that: a tree may hold a sphere
/// of radius -1, and compiling says so.
///
/// Dropping, comparing and compiling take no more stack for deep trees than for flat ones.
#[derive(Clone)]
pub struct Tree(pub(crate) Arc<Node>);

/// An operation with what is known of its result.
pub(crate) struct Node {
    pub(crate) operation: Operation,
    pub(crate) nature: Nature,
}

impl Tree {
    /// The tree of one operation.
    pub fn new(operation: Operation) -> Self {
        let nature = Nature::of(&operation);
        Self(Arc::new(Node { operation, nature }))
    }

    /// What the root does.
    pub fn operation(&self) -> &Operation {
        &self.0.operation
    }

    /// What is known of the values: whether they are distances, and how fast they change.
    pub fn nature(&self) -> Nature {
        self.0.nature
    }

    /// How many different nodes there are; a shared subtree counts once.
    pub fn node_count(&self) -> usize {
        post_order(self).len()
    }

    /// Where the node lies in memory: the same for clones, different for others while they live.
    pub(crate) fn address(&self) -> usize {
        Arc::as_ptr(&self.0).addr()
    }
}

/// The root's name and the number of nodes.
impl fmt::Debug for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tree({}, {} nodes)", self.operation().name(), self.node_count())
    }
}
