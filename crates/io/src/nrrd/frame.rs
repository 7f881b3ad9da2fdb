//! Axes: how many, of which kind, and where their samples are.

use shapeloom_core::Category;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::Units;

use super::fields::{Field, Fields};
use crate::Fault;
use crate::text::{CountFault, NumberFault, parse_count, parse_number, quoted};
use crate::volumes::{Frame, check_spacing};

/// The axes of the file that are kept: three.
pub(super) struct Axes {
    pub(super) sizes: [u64; 3],
    /// Which of the file's axes they are.
    which: [usize; 3],
    /// The sizes of all.
    pub(super) all_sizes: Vec<u64>,
    all: usize,
}

/// The words of a value; `"quoted ones"` are one each.
fn words<'a>(value: &'a [u8]) -> Vec<&'a [u8]> {
    let mut words: Vec<&'a [u8]> = Vec::new();
    let mut rest = value.trim_ascii();
    // No file has more than 16 axes; more words are of no use.
    while !rest.is_empty() && words.len() < 64 {
        let end = match rest.strip_prefix(b"\"") {
            Some(inner) => memchr::memchr(b'"', inner).map_or(rest.len(), |end| end + 2),
            None => rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len()),
        };
        words.push(&rest[..end]);
        rest = rest[end..].trim_ascii();
    }
    words
}

impl Axes {
    pub(super) fn read(fields: &Fields<'_>) -> Result<Self, Box<Fault>> {
        let dimension = fields.require("dimension")?;
        let count = parse_count(dimension.value).ok().filter(|count| (1..=16).contains(count));
        let count = count
            .ok_or_else(|| dimension.fault("E-nrrd-count", quoted(dimension.value), "a number of axes from 1 to 16"))?
            as usize;
        let field = fields.require("sizes")?;
        let mut sizes = Vec::new();
        for word in words(field.value) {
            sizes.push(parse_count(word).map_err(|fault| match fault {
                CountFault::Syntax => field.fault("E-nrrd-count", quoted(word), "whole numbers in digits alone"),
                CountFault::Overflow => field.fault("E-nrrd-count", quoted(word), "numbers of 64 bits"),
            })?);
        }
        if sizes.len() != count {
            let found = format!("{} numbers", sizes.len());
            return Err(field.fault("E-nrrd-count", found, format!("{count}, as the field dimension says")));
        }
        let kinds = fields.find("kinds").map(|field| (field, words(field.value)));
        let spatial = |axis: usize| {
            let kind = kinds.as_ref().and_then(|(_, words)| words.get(axis));
            kind.is_none_or(|kind| [&b"domain"[..], b"space", b"time", b"???", b"none"].contains(kind))
        };
        // Axes of one sample add nothing, whatever they are.
        let mut which: Vec<usize> = (0..count).collect();
        while which.len() > 3 {
            let Some(at) = which.iter().position(|&axis| sizes[axis] == 1) else { break };
            which.remove(at);
        }
        let unlike = which.iter().find(|&&axis| !spatial(axis));
        if let (Some(&axis), Some((field, words))) = (unlike, &kinds) {
            let found = format!("the axis {axis} of kind {}, {} values a sample", quoted(words[axis]), sizes[axis]);
            let fault = field.fault("E-nrrd-dimension", found, "one number a sample: three axes of space");
            return Err(fault.category(Category::Unsupported));
        }
        let Ok(which) = <[usize; 3]>::try_from(which) else {
            let found = format!("{count} axes of {} samples", crate::volumes::joined(&sizes, " × "));
            let fault = dimension.fault("E-nrrd-dimension", found, "three axes of space");
            return Err(fault.category(Category::Unsupported));
        };
        Ok(Self { sizes: which.map(|axis| sizes[axis]), which, all_sizes: sizes, all: count })
    }

    /// A number for each axis, where the file has them; not a number for axes without.
    fn numbers(&self, fields: &Fields<'_>, name: &str) -> Result<Option<DVec3>, Box<Fault>> {
        let Some(field) = fields.find(name) else { return Ok(None) };
        let words = words(field.value);
        if words.len() != self.all {
            let found = format!("{} numbers", words.len());
            return Err(field.fault("E-nrrd-count", found, format!("{}, one for each axis", self.all)));
        }
        let mut numbers = [0.0; 3];
        for (number, axis) in numbers.iter_mut().zip(self.which) {
            *number = match parse_number(words[axis]) {
                Ok(value) => value,
                Err(NumberFault::NotFinite) => f64::NAN,
                Err(fault) => return Err(field.fault("E-nrrd-number", quoted(words[axis]), fault.to_string())),
            };
        }
        Ok(Some(DVec3::from(numbers)))
    }

    /// Where the samples are.
    pub(super) fn frame(&self, fields: &Fields<'_>) -> Result<Frame, Box<Fault>> {
        let origin = match fields.find("space origin") {
            Some(field) => {
                let mut rest = field.value;
                let origin = vector(field, &mut rest)?;
                if rest.trim_ascii().is_empty() { Ok(Some(origin)) } else { Err(unlike_vector(field, rest)) }
            }
            None => Ok(None),
        }?;
        if let Some(field) = fields.find("space directions") {
            let mut rest = field.value;
            let mut directions = Vec::new();
            for axis in 0..self.all {
                let trimmed = rest.trim_ascii_start();
                if let Some(after) = trimmed.strip_prefix(b"none") {
                    rest = after;
                    directions.push(None);
                    if self.which.contains(&axis) {
                        let found = format!("none for the axis {axis}");
                        let fault =
                            field.fault("E-nrrd-dimension", found, "a direction for each of three axes of space");
                        return Err(fault.category(Category::Unsupported));
                    }
                } else {
                    directions.push(Some(vector(field, &mut rest)?));
                }
            }
            if !rest.trim_ascii().is_empty() {
                return Err(unlike_vector(field, rest));
            }
            let steps = self.which.map(|axis| directions.get(axis).copied().flatten().unwrap_or_default());
            return Ok(Frame { origin: origin.unwrap_or(DVec3::ZERO), steps });
        }
        let (spacings, lows, highs) =
            (self.numbers(fields, "spacings")?, self.numbers(fields, "axis mins")?, self.numbers(fields, "axis maxs")?);
        let centers = fields.find("centers").map(|field| words(field.value)).unwrap_or_default();
        let (mut spacing, mut first) = (DVec3::ONE, DVec3::ZERO);
        for (axis, own) in self.which.into_iter().enumerate() {
            let low = lows.map(|lows| lows[axis]).filter(|low| low.is_finite());
            let high = highs.map(|highs| highs[axis]).filter(|high| high.is_finite());
            let center = centers.get(own).copied().unwrap_or_default();
            let (cell, node) = (center == b"cell", center == b"node");
            let count = self.sizes[axis] as f64;
            if let Some(spacings) = spacings {
                spacing[axis] = spacings[axis];
            } else if let (Some(low), Some(high)) = (low, high) {
                // Teem's documentation: cells where nothing is said.
                spacing[axis] = (high - low) / if node { (count - 1.0).max(1.0) } else { count };
            }
            if let Some(low) = low {
                let cells = cell || (spacings.is_none() && high.is_some() && !node);
                first[axis] = if cells { low + spacing[axis] / 2.0 } else { low };
            }
        }
        let said = ["spacings", "axis maxs", "axis mins", "sizes"].into_iter().find_map(|name| fields.find(name));
        let place = said.map_or(shapeloom_core::Place::Whole, Field::place);
        check_spacing(spacing, place, "spacings")?;
        Ok(Frame::turned(origin.unwrap_or(first), [DVec3::X, DVec3::Y, DVec3::Z], spacing))
    }
}

fn unlike_vector(field: &Field<'_>, rest: &[u8]) -> Box<Fault> {
    field.fault("E-nrrd-number", quoted(rest.trim_ascii()), "vectors of three numbers, such as (1,0,0)")
}

/// A vector in brackets at the start of some text, which is passed over.
fn vector(field: &Field<'_>, rest: &mut &[u8]) -> Result<DVec3, Box<Fault>> {
    let text = rest.trim_ascii_start();
    let inside = text.strip_prefix(b"(").ok_or_else(|| unlike_vector(field, text))?;
    let end = memchr::memchr(b')', inside).ok_or_else(|| unlike_vector(field, text))?;
    *rest = &inside[end + 1..];
    let mut numbers = [0.0; 3];
    let mut count = 0;
    for part in inside[..end].split(|byte| *byte == b',') {
        let part = part.trim_ascii();
        let value = parse_number(part).map_err(|fault| match fault {
            NumberFault::NotFinite => field.fault("E-volume-grid", quoted(part), "a finite number"),
            fault => field.fault("E-nrrd-number", quoted(part), fault.to_string()),
        })?;
        if let Some(number) = numbers.get_mut(count) {
            *number = value;
        }
        count += 1;
    }
    if count != 3 {
        let found = format!("a vector of {count} numbers");
        let fault = field.fault("E-nrrd-dimension", found, "vectors of space, which have three");
        return Err(fault.category(Category::Unsupported));
    }
    Ok(DVec3::from(numbers))
}

/// The unit of space, where all axes have the same one.
pub(super) fn units(fields: &Fields<'_>) -> Option<Units> {
    let words = words(fields.find("space units").or_else(|| fields.find("units"))?.value);
    let mut known = words.iter().map(|word| word.trim_ascii());
    let first = known.find(|word| unit_of(word).is_some())?;
    words.iter().all(|word| *word == first || *word == b"none" || *word == b"\"\"").then(|| unit_of(first)).flatten()
}

/// Words for units with their lengths in metres.
pub(super) const UNITS: [(&str, f64); 7] =
    [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9), ("km", 1e3), ("in", 0.0254)];

fn unit_of(word: &[u8]) -> Option<Units> {
    let word = word.strip_prefix(b"\"").and_then(|word| word.strip_suffix(b"\"")).unwrap_or(word);
    let word = match word {
        b"\xc2\xb5m" | b"\xce\xbcm" | b"micron" | b"microns" => b"um".as_slice(),
        b"meter" | b"meters" => b"m",
        b"millimeter" | b"millimeters" => b"mm",
        word => word,
    };
    if let Some(length) = word.strip_suffix(b" m") {
        return Units::from_meters(parse_number(length).ok()?).ok();
    }
    let (_, meters) = UNITS.iter().find(|(name, _)| name.as_bytes() == word)?;
    Units::from_meters(*meters).ok()
}
