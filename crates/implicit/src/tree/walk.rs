//! Visiting every node once.

use std::collections::HashSet;

use super::Tree;

/// Every node once, parts before what is made of them.
pub fn post_order(root: &Tree) -> Vec<&Tree> {
    let mut seen = HashSet::new();
    let mut order = Vec::new();
    let mut stack = vec![(root, false)];
    while let Some((tree, parts_done)) = stack.pop() {
        if parts_done {
            order.push(tree);
        } else if seen.insert(tree.address()) {
            stack.push((tree, true));
            stack.extend(tree.operation().children().rev().map(|child| (child, false)));
        }
    }
    order
}
