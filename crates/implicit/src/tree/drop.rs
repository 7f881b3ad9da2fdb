//! Dropping deep trees on a small stack.

use std::sync::Arc;

use super::{Node, Operation};

impl Drop for Node {
    fn drop(&mut self) {
        let mut left = take(self);
        while let Some(tree) = left.pop() {
            if let Some(mut node) = Arc::into_inner(tree.0) {
                left.append(&mut take(&mut node));
            }
        }
    }
}

fn take(node: &mut Node) -> Vec<super::Tree> {
    std::mem::replace(&mut node.operation, Operation::Constant(0.0)).into_children()
}
