//! The files that hold the samples of a detached header.

use super::fields::{Field, Fields, is_list};
use super::frame::Axes;
use crate::Fault;
use crate::text::{parse_count, quoted};

/// The files of samples in their order, each with as many of them.
#[derive(Debug, PartialEq)]
pub(super) enum DataFiles<'a> {
    One(&'a str),
    /// One name a line.
    Listed(Vec<&'a str>),
    /// A pattern: what stands before and after the number, its least digits, with blanks or zeros before, and the numbers.
    Numbered {
        before: &'a str,
        after: &'a str,
        digits: usize,
        zeros: bool,
        first: u64,
        step: i64,
        count: u64,
    },
}

impl<'a> DataFiles<'a> {
    /// What the field says, which is checked against the sizes before any file is opened.
    ///
    /// # Errors
    /// Names that are no UTF-8, a pattern of another form, another number of files than the sizes ask for.
    pub(super) fn read(field: &Field<'a>, fields: &Fields<'a>, axes: &Axes) -> Result<Self, Box<Fault>> {
        let text = |name: &'a [u8]| {
            std::str::from_utf8(name).map_err(|_| field.fault("E-nrrd-header", quoted(name), "a name in UTF-8"))
        };
        let value = text(field.value)?;
        let (files, dimension) = if is_list(field.value) {
            let names = fields.listed.iter().map(|name| text(name)).collect::<Result<Vec<_>, _>>()?;
            let dimension = Some(value["LIST".len()..].trim()).filter(|word| !word.is_empty());
            (Self::Listed(names), dimension)
        } else if let Some((pattern, words)) = numbered(value) {
            let wrong = || {
                let expected =
                    "a name, LIST, or a pattern such as slice%03d.raw with the first number, the last and the step";
                field.fault("E-nrrd-header", quoted(field.value), expected)
            };
            let (before, after, digits, zeros) = conversion(pattern).ok_or_else(wrong)?;
            let [first, last, step, dimension @ ..] = words.as_slice() else { return Err(wrong()) };
            let number = |word: &str| parse_count(word.as_bytes()).map_err(|_| wrong());
            let (first, last, step) = (number(first)?, number(last)?, step.parse::<i64>().map_err(|_| wrong())?);
            let forward = if step < 0 { first.checked_sub(last) } else { last.checked_sub(first) };
            let count = forward.and_then(|span| span.checked_div(step.unsigned_abs())).ok_or_else(wrong)?;
            let count = count.saturating_add(1);
            (Self::Numbered { before, after, digits, zeros, first, step, count }, dimension.first().copied())
        } else {
            return Ok(Self::One(value));
        };
        let all = axes.all_sizes.len();
        let own = match dimension {
            Some(word) => {
                parse_count(word.as_bytes()).ok().filter(|own| (1..=all as u64).contains(own)).ok_or_else(|| {
                    let expected = format!("axes in each file from 1 to {all}");
                    field.fault("E-nrrd-count", quoted(word.as_bytes()), expected)
                })? as usize
            }
            None => all - 1,
        };
        let last = axes.all_sizes.last().copied().unwrap_or(1);
        let wanted = axes.all_sizes[own.min(all)..].iter().fold(1u64, |product, size| product.saturating_mul(*size));
        let count = files.count();
        // Files of all axes are equal parts along the last.
        let fits = if own == all { count > 0 && last.is_multiple_of(count) } else { count == wanted };
        if fits {
            return Ok(files);
        }
        let expected = if own == all {
            format!("a number that divides the last of the sizes, {last}")
        } else {
            format!("{wanted}, as the sizes beyond the first {own} axes say")
        };
        Err(field.fault("E-nrrd-count", format!("{count} files"), expected))
    }

    /// Whether several may be there: also one of a list.
    pub(super) fn are_several(&self) -> bool {
        !matches!(self, Self::One(_))
    }

    pub(super) fn count(&self) -> u64 {
        match self {
            Self::One(_) => 1,
            Self::Listed(names) => names.len() as u64,
            Self::Numbered { count, .. } => *count,
        }
    }

    /// The name of a file, counted from 0.
    pub(super) fn name(&self, index: u64) -> String {
        match self {
            Self::One(name) => (*name).to_owned(),
            Self::Listed(names) => names.get(index as usize).copied().unwrap_or_default().to_owned(),
            Self::Numbered { before, after, digits, zeros, first, step, .. } => {
                let moved = step.unsigned_abs().saturating_mul(index);
                let number = if *step < 0 { first.saturating_sub(moved) } else { first.saturating_add(moved) };
                match zeros {
                    true => format!("{before}{number:0digits$}{after}"),
                    false => format!("{before}{number:digits$}{after}"),
                }
            }
        }
    }
}

/// A pattern and the numbers after it; none for the name of one file.
fn numbered(value: &str) -> Option<(&str, Vec<&str>)> {
    let mut rest = value;
    let mut words = Vec::new();
    while let Some((before, word)) = rest.rsplit_once(|char: char| char.is_ascii_whitespace())
        && words.len() < 4
        && is_number(word)
    {
        words.insert(0, word);
        rest = before.trim_end();
    }
    (conversion(rest).is_some() || (words.len() >= 3 && rest.contains('%'))).then_some((rest, words))
}

/// Digits, maybe behind a minus.
fn is_number(word: &str) -> bool {
    let digits = word.strip_prefix('-').unwrap_or(word);
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// What stands before and after the one number of a pattern, its least digits, and whether zeros fill them.
fn conversion(pattern: &str) -> Option<(&str, &str, usize, bool)> {
    let (before, rest) = pattern.split_once('%')?;
    let end = rest.find(|char: char| !char.is_ascii_digit())?;
    let (digits, after) = rest.split_at(end);
    let after = after.strip_prefix(['d', 'i', 'u'])?;
    let least = if digits.is_empty() { 0 } else { digits.parse().ok().filter(|least| *least <= 20)? };
    (!after.contains('%')).then_some((before, after, least, digits.starts_with('0')))
}
