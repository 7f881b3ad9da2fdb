//! Equality of trees.

use std::collections::HashSet;
use std::mem::discriminant;

use super::{Operation, Tree};

/// Equal when the nodes are, whether they are shared or not. Numbers are compared by value, and not a number equals itself.
impl PartialEq for Tree {
    fn eq(&self, other: &Self) -> bool {
        let mut seen = HashSet::new();
        let mut stack = vec![(self, other)];
        while let Some((a, b)) = stack.pop() {
            if a.address() == b.address() || !seen.insert((a.address(), b.address())) {
                continue;
            }
            let (a, b) = (a.operation(), b.operation());
            if !same_but_for_children(a, b) || a.children().count() != b.children().count() {
                return false;
            }
            stack.extend(a.children().zip(b.children()));
        }
        true
    }
}

fn same_but_for_children(a: &Operation, b: &Operation) -> bool {
    use Operation::*;
    let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
    match (a, b) {
        (Constant(a), Constant(b)) => same(*a, *b),
        (Coordinate(a), Coordinate(b)) => a == b,
        (Unary(a, _), Unary(b, _)) => a == b,
        (Binary(a, ..), Binary(b, ..)) => a == b,
        (Power(_, a), Power(_, b)) => a == b,
        (Primitive(a), Primitive(b)) => a == b,
        (Set(a, _), Set(b, _)) => a == b,
        (Blend(a, ..), Blend(b, ..)) => a == b,
        (Offset(a, _), Offset(b, _)) | (Shell(a, _), Shell(b, _)) => same(*a, *b),
        (Transform(a, _), Transform(b, _)) => a == b,
        (Domain(a, _), Domain(b, _)) => a == b,
        (Named(a, _), Named(b, _)) => a == b,
        (Foreign(a), Foreign(b)) => a.source() == b.source(),
        (Blobs(a), Blobs(b)) => a == b,
        (Complement(_) | Displace(..) | Substitute(..), _) => discriminant(a) == discriminant(b),
        _ => false,
    }
}
