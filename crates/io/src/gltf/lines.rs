//! Segments as a line or as a graph.

/// The points of one line through all segments, in which each starts where the one before ended, and whether it ends
/// where it began, which it then does not repeat; none if the segments are no such chain.
pub(super) fn chain(segments: &[[u32; 2]]) -> Option<(Vec<u32>, bool)> {
    let first = segments.first()?;
    if segments.windows(2).any(|pair| pair[0][1] != pair[1][0]) {
        return None;
    }
    let mut points = vec![first[0]];
    points.extend(segments.iter().map(|segment| segment[1]));
    // A closed line of one point would have no segment.
    let closed = points.len() > 2 && points.first() == points.last();
    if closed {
        points.pop();
    }
    Some((points, closed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_meet_become_one_line() {
        assert_eq!(chain(&[[0, 1], [1, 2], [2, 5]]), Some((vec![0, 1, 2, 5], false)));
        assert_eq!(chain(&[[3, 3]]), Some((vec![3, 3], false)));
        assert_eq!(chain(&[[0, 1], [1, 2], [2, 0]]), Some((vec![0, 1, 2], true)));
        assert_eq!(chain(&[[0, 1], [1, 0]]), Some((vec![0, 1], true)));
        assert_eq!(chain(&[[0, 1], [2, 1]]), None);
        assert_eq!(chain(&[]), None);
    }
}
