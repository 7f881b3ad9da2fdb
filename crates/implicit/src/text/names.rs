//! Names that are not known where they are used.

use std::collections::{HashMap, HashSet};

use super::error::{TextProblem, line_of};
use super::tokens::{Token, Tokens};

/// How many names are looked through: a second's work at most.
const MOST_NAMES: usize = 10_000;

/// The name among `known` that differs least from `name`, where that is by a third of its letters at most. Of equals
/// the first by the alphabet.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    // Longer names are not worth the time: the distance takes the product of the lengths.
    if name.len() > 64 {
        return None;
    }
    let most = (name.len() / 3).max(1);
    let alike: Vec<&str> =
        known.into_iter().filter(|other| other.len().abs_diff(name.len()) <= most).take(MOST_NAMES + 1).collect();
    // Not even of the first so many: a hash map's order must not show.
    if alike.len() > MOST_NAMES {
        return None;
    }
    alike
        .into_iter()
        .map(|other| (edit_distance(name.as_bytes(), other.as_bytes()), other))
        .filter(|(distance, _)| *distance <= most)
        .min()
        .map(|(_, other)| other.to_owned())
}

/// How many letters must be changed, added, removed or swapped with their neighbour (the optimal string alignment
/// distance).
fn edit_distance(a: &[u8], b: &[u8]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for (i, &from) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, &to) in b.iter().enumerate() {
            let changed = above[j] + usize::from(from != to);
            let mut least = changed.min(above[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && from == b[j - 1] && a[i - 1] == to {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

/// Why `name` is not known within the definition `inside` (empty for the shape itself), which begins at the byte
/// `from`.
pub(super) fn unknown<'a>(
    text: &str,
    from: usize,
    inside: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> TextProblem {
    let later = definitions(text, from);
    match later.get(name) {
        Some(&(at, _)) => {
            let cyclic = !inside.is_empty() && reaches(&later, name, inside);
            TextProblem::Early { name: name.to_owned(), defined: line_of(text.as_bytes(), at), cyclic }
        }
        None => TextProblem::UnknownName {
            name: super::error::shortened(name),
            nearest: nearest(name, known.into_iter().chain(["x", "y", "z", "pi"])),
        },
    }
}

/// Where each later definition begins, and the names that follow it up to its end.
fn definitions(text: &str, from: usize) -> HashMap<&str, (usize, Vec<&str>)> {
    let mut tokens = Tokens::new(text, from);
    let mut all: HashMap<&str, (usize, Vec<&str>)> = HashMap::new();
    let mut current = None;
    let mut first: Option<(&str, usize)> = None;
    let mut at_start = true;
    // A fault further on is not what is told: it ends the search.
    while let Ok(placed) = tokens.next() {
        match placed.token {
            Token::End => break,
            Token::Sign(';') => {
                (current, first, at_start) = (None, None, true);
                continue;
            }
            Token::Sign('=') => {
                if let Some((name, at)) = first.take() {
                    all.entry(name).or_insert((at, Vec::new()));
                    current = Some(name);
                }
            }
            Token::Name(name) => {
                first = at_start.then_some((name, placed.at));
                if let Some((_, uses)) = current.and_then(|current| all.get_mut(current)) {
                    uses.push(name);
                }
            }
            _ => first = None,
        }
        at_start = false;
    }
    all
}

/// Whether the definition of `from` needs that of `to`.
fn reaches<'a>(all: &HashMap<&'a str, (usize, Vec<&'a str>)>, from: &'a str, to: &str) -> bool {
    let mut seen = HashSet::new();
    let mut stack = vec![from];
    while let Some(name) = stack.pop() {
        if name == to {
            return true;
        }
        if seen.insert(name) {
            stack.extend(all.get(name).into_iter().flat_map(|(_, uses)| uses.iter().copied()));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_changes() {
        for (a, b, expected) in
            [("", "", 0), ("shpere", "sphere", 1), ("kitten", "sitting", 3), ("", "abc", 3), ("unon", "union", 1)]
        {
            assert_eq!(edit_distance(a.as_bytes(), b.as_bytes()), expected, "{a} {b}");
            assert_eq!(edit_distance(b.as_bytes(), a.as_bytes()), expected, "{b} {a}");
        }
        assert_eq!(nearest("shpere", ["cone", "sphere", "spheres"]).as_deref(), Some("sphere"));
        assert_eq!(nearest("tetrahedron", ["cone", "sphere"]), None);
    }
}
