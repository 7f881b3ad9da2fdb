//! Why a file with free-form curves or surfaces is refused.

use shapeloom_core::{Category, Limits, Place};

use crate::Fault;
use crate::text::{Scanner, end_place, parse_count, quoted};

/// The first thing wrong with the free-form statements of a text, or else that they are not read.
pub(super) fn refusal(text: &[u8], limits: &Limits) -> Box<Fault> {
    let mut scan = Scanner::new(text, 0);
    let mut degree: Option<(Vec<u64>, Place)> = None;
    let mut first: Option<(Place, Vec<u8>)> = None;
    while scan.skip_empty_lines() {
        let place = scan.place();
        match scan.word() {
            b"deg" => {
                let degrees = words(&mut scan).iter().filter_map(|word| parse_count(word).ok()).collect();
                degree = Some((degrees, place));
            }
            word @ (b"curv" | b"curv2" | b"surf") => {
                // A curve has two parameters before its control points, a surface four, a curve in a surface none.
                let before = match word {
                    b"curv" => 2,
                    b"surf" => 4,
                    _ => 0,
                };
                let points = words(&mut scan).len().saturating_sub(before) as u64;
                if let Some((degrees, at)) = &degree {
                    let needed = degrees.iter().fold(1u64, |all, degree| all.saturating_mul(degree.saturating_add(1)));
                    let most = degrees.iter().copied().max().unwrap_or(0);
                    if needed > points || most > u64::from(limits.max_degree) {
                        let shown: Vec<String> = degrees.iter().map(u64::to_string).collect();
                        let found = format!("degree {} with {points} control points", shown.join(" x "));
                        let expected = format!("at least {needed} control points for it");
                        return Fault::new("E-obj-degree", at.clone(), found, expected);
                    }
                }
                first.get_or_insert_with(|| (place, word.to_vec()));
            }
            b"end" => {
                if let Some((place, word)) = first {
                    return unsupported(place, &word);
                }
            }
            _ => {}
        }
        scan.next_line();
    }
    let found = "the end of the file";
    let opened = first.map_or("a curve or surface".to_owned(), |(_, word)| String::from_utf8_lossy(&word).into_owned());
    Fault::new("E-obj-truncated", end_place(text), found, format!("parm and end after {opened}"))
        .advice("free-form curves and surfaces are not read yet: export the file as polygons")
}

fn unsupported(place: Place, word: &[u8]) -> Box<Fault> {
    Fault::new("E-obj-freeform", place, quoted(word), "polygons, lines and points")
        .category(Category::Unsupported)
        .advice("free-form curves and surfaces are not read yet: export the file as polygons")
}

fn words<'t>(scan: &mut Scanner<'t>) -> Vec<&'t [u8]> {
    let mut words = Vec::new();
    while !scan.at_line_end_or_comment() {
        words.push(scan.word());
    }
    words
}
