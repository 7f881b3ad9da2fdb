//! What is left of triangles that collapse.

/// Whether every collapsed triangle leaves a trace: what it shrank to, a point or a segment between its two different
/// corners, is still a corner or side of a triangle that is left.
///
/// Then dropping the collapsed ones takes nothing from the surface, and a bound that held for them holds for what is left.
/// Cost: the triangles left times the logarithm of the number of collapsed ones.
pub fn collapsed_leave_traces(collapsed: &[[u32; 3]], left: &[[u32; 3]]) -> bool {
    leave_traces(collapsed, left.iter().map(<[u32; 3]>::as_slice))
}

/// The same where faces of any number of corners are left.
pub(crate) fn leave_traces<'a>(collapsed: &[[u32; 3]], left: impl Iterator<Item = &'a [u32]>) -> bool {
    if collapsed.is_empty() {
        return true;
    }
    let shrunk = |&[a, b, c]: &[u32; 3]| [a.min(b).min(c), a.max(b).max(c)];
    let mut traces: Vec<[u32; 2]> = collapsed.iter().map(shrunk).collect();
    traces.sort_unstable();
    traces.dedup();
    let mut seen = vec![false; traces.len()];
    for face in left {
        for (&p, &q) in face.iter().zip(face.iter().cycle().skip(1)) {
            for trace in [[p.min(q), p.max(q)], [p, p]] {
                if let Ok(found) = traces.binary_search(&trace) {
                    seen[found] = true;
                }
            }
        }
    }
    seen.into_iter().all(|seen| seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_corners_are_traces_and_nothing_else() {
        let left = [[0, 1, 2]];
        for (gone, trace) in [([1, 2, 2], true), ([2, 2, 2], true), ([0, 3, 3], false), ([3, 3, 3], false)] {
            assert_eq!(collapsed_leave_traces(&[gone], &left), trace, "{gone:?}");
        }
        assert!(collapsed_leave_traces(&[], &[]));
    }
}
