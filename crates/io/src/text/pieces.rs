//! Text cut into pieces that can be read at the same time.

use std::ops::Range;

use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Exec, Stop, Threads};

/// Large enough that what a piece costs apart from its text does not count.
const PIECE: usize = 1 << 20;

/// Cuts the part of a text from `from` on after line ends, into pieces of about a mebibyte; one piece where one thread
/// works. `joined` says whether a line, without its end, goes on in the next.
///
/// What is read from the pieces must not depend on where they were cut.
pub(crate) fn pieces(text: &[u8], from: usize, exec: &Exec, joined: fn(&[u8]) -> bool) -> Vec<Range<usize>> {
    let size = if exec.threads() == Threads::Sequential { usize::MAX } else { PIECE };
    cut(text, from, size, joined)
}

pub(crate) fn cut(text: &[u8], from: usize, size: usize, joined: fn(&[u8]) -> bool) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = from.min(text.len());
    while start < text.len() {
        let mut end = start.saturating_add(size).min(text.len());
        while end < text.len() {
            let Some(line_end) = memchr::memchr2(b'\n', b'\r', &text[end..]).map(|at| end + at) else {
                end = text.len();
                break;
            };
            let crlf = text[line_end] == b'\r' && text.get(line_end + 1) == Some(&b'\n');
            // The feed alone, when the return before it was passed by: it is the same line end.
            let line = if line_end > 0 && text[line_end] == b'\n' && text[line_end - 1] == b'\r' {
                &text[start..line_end - 1]
            } else {
                &text[start..line_end]
            };
            end = line_end + if crlf { 2 } else { 1 };
            if !joined(line) {
                break;
            }
        }
        found.push(start..end);
        start = end;
    }
    found
}

/// For each piece how many rows come before it and how many it has, by a count of the rows of a piece: reading a piece
/// needs to know which row its first is.
pub(crate) fn rows_before(
    exec: &Exec,
    cuts: &[Range<usize>],
    count: impl Fn(&Range<usize>) -> u64 + Sync,
) -> Result<Vec<(u64, u64)>, Stop> {
    let counts = map_chunks(exec, cuts.len(), 1, |range| Ok::<_, Stop>(cuts[range].iter().map(&count).sum::<u64>()))?;
    let mut before = 0;
    let with_sum = |count| {
        before += count;
        (before - count, count)
    };
    Ok(counts.into_iter().map(with_sum).collect())
}

/// No line goes on in the next.
pub(crate) fn never_joined(_: &[u8]) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &[u8], size: usize, joined: fn(&[u8]) -> bool) -> Vec<&[u8]> {
        cut(text, 0, size, joined).into_iter().map(|range| &text[range]).collect()
    }

    #[test]
    fn pieces_end_with_lines_and_cover_the_text() {
        let text = b"one\r\ntwo\rthree\nfour";
        for size in 1..30 {
            let parts = texts(text, size, never_joined);
            assert_eq!(parts.concat(), text);
            for part in &parts[..parts.len() - 1] {
                assert!(part.ends_with(b"\n") || part.ends_with(b"\r"), "{size}");
                assert!(!part.starts_with(b"\n"), "{size}");
            }
        }
        assert!(texts(b"", 4, never_joined).is_empty());
    }

    #[test]
    fn lines_that_go_on_stay_together() {
        let joined = |line: &[u8]| line.ends_with(b"\\");
        assert_eq!(texts(b"f 1 \\\r\n2\\\n3\nf 4\n", 1, joined), [&b"f 1 \\\r\n2\\\n3\n"[..], b"f 4\n"]);
        for size in 1..9 {
            let parts = texts(b"f 1 \\\r\n2\nf 4\n", size, joined);
            assert!(parts[0].starts_with(b"f 1 \\\r\n2\n"), "{size} {parts:?}");
        }
    }
}
