//! BPT: Bézier patches in text.
//!
//! The number of patches; for each patch two degrees and the control points, one `x y z` a line, in rows. The first
//! degree runs across the rows (our v), the second along a row (our u): with this the teapot's patches face outward.
//! All patches are one surface. Anything between white space is a token, wherever lines end; comments run from `#` to
//! the end of the line. The format says nothing of directions; the sets of Newell (1975), for which it is used, have z
//! up, and so has what is read from it.

mod read;
mod write;

use shapeloom_shape::{Kind, UpAxis};

use crate::text::{Text, parse_count, parse_number};
use crate::{Format, Keeps, Precision, Sniff};

/// BPT.
pub(crate) const FORMAT: Format = Format {
    id: "bpt",
    name: "BPT Bézier patches",
    extensions: &["bpt"],
    media_type: "text/plain",
    text: true,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::BezierSurface],
    keeps: &[Keeps::UpAxis],
    read_options: &[],
    write_options: &[],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

/// A count alone on its line, two small counts on the next, three numbers on the third.
fn sniff(input: &[u8]) -> Sniff {
    let head = crate::detect::head(input);
    let Ok(text) = Text::try_new(head, &Default::default()) else {
        return Sniff::No;
    };
    let mut tokens = text.tokens();
    let mut shape = Vec::new();
    for _ in 0..6 {
        match tokens.next_token() {
            Ok(Some(token)) => shape.push(token),
            _ => return Sniff::No,
        }
    }
    let lines: Vec<u64> = shape.iter().map(|token| token.line).collect();
    let apart = lines[0] < lines[1] && lines[1] == lines[2] && lines[2] < lines[3] && lines[3] == lines[5];
    let degree = |bytes: &[u8]| parse_count(bytes).is_ok_and(|degree| (1..256).contains(&degree));
    let counts = parse_count(shape[0].bytes).is_ok() && degree(shape[1].bytes) && degree(shape[2].bytes);
    if apart && counts && shape[3..].iter().all(|token| parse_number(token.bytes).is_ok()) {
        Sniff::Likely
    } else {
        Sniff::No
    }
}
