//! What tests of several formats use.

use std::path::{Path, PathBuf};

use shapeloom_core::Report;
use shapeloom_shape::Shape;

use crate::{Encoding, Format, WriteContext, WriteOptions};

/// A shape as a file of a format in an encoding, and what the writer said of it.
pub(crate) fn written_as(format: &Format, shape: &Shape, encoding: Encoding) -> (Vec<u8>, Report) {
    let context = WriteContext { options: WriteOptions { encoding, ..WriteOptions::default() }, ..Default::default() };
    let mut out = Vec::new();
    let report = crate::write(shape, format, &context, &mut out).unwrap();
    (out, report)
}

/// What a report names as lost.
pub(crate) fn whats(report: &Report) -> Vec<&str> {
    report.losses.iter().map(|loss| loss.what.as_str()).collect()
}

/// The path of a file of the shared collection beside the workspace; none where the collection is not there, and the
/// test that asked has nothing to look at.
pub(crate) fn shared_data(name: &str) -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = ["../shared/data", "../../shared/data"].map(|folder| workspace.join(folder).join(name));
    candidates.into_iter().find(|path| path.exists())
}

/// Texts made of the lines of another one, left out, repeated, exchanged and cut: as many as asked for, the same each
/// time.
pub(crate) fn shuffled_lines(text: &str, count: usize, mut check: impl FnMut(&str)) {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let mut state = 7u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    for _ in 0..count {
        let mut some = lines.clone();
        for _ in 0..=random(4) {
            let (from, to) = (random(some.len()), random(some.len()));
            match random(5) {
                0 => _ = some.remove(from),
                1 => some.insert(to, lines[random(lines.len())]),
                2 => some.swap(from, to),
                3 => some[from] = lines[random(lines.len())],
                // The line end goes, or the end of a word.
                _ => some[from] = &some[from][..some[from].len().saturating_sub(1 + random(2))],
            }
            if some.is_empty() {
                some.push("\n");
            }
        }
        check(&some.concat());
    }
}

/// Inputs with one to four bytes of another one changed, put in or left out, or the end cut off: as many as asked for, the same each
/// time. `check` says whether the input was taken; some must be and some not.
pub(crate) fn shake(input: &[u8], count: usize, mut check: impl FnMut(&[u8]) -> bool) {
    let mut state = 11u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let signs = b"0123456789 .-+eE\n\r\tABHX\0\xff";
    let mut taken = 0;
    for _ in 0..count {
        let mut bytes = input.to_vec();
        for _ in 0..=random(4) {
            let at = random(bytes.len());
            let sign = signs[random(signs.len())];
            match random(8) {
                0 => bytes.truncate(at),
                1 | 2 => bytes.insert(at, sign),
                3 if !bytes.is_empty() => drop(bytes.remove(at)),
                _ if !bytes.is_empty() => bytes[at] = sign,
                _ => {}
            }
        }
        taken += usize::from(check(&bytes));
    }
    assert!(taken > count / 20 && taken < count - count / 20, "{taken} of {count}");
}
