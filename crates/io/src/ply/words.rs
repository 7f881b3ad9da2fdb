//! Words of a text as numbers of the types of properties.

use super::types::Type;
use crate::Fault;
use crate::text::{NumberFault, Scanner};

/// A coordinate as its type holds it; infinite where the type does not reach so far.
#[inline]
pub(super) fn coordinate(scan: &mut Scanner<'_>, kind: Type) -> Result<f64, Box<Fault>> {
    match kind {
        Type::Float => f32::parse(scan).map(f64::from),
        Type::Double => f64::parse(scan),
        other => {
            let (least, most) = other.bounds().unwrap_or((i64::MIN, i64::MAX));
            whole_within(scan, least, most).map(|number| number as f64)
        }
    }
}

/// A number that is read from text.
pub(super) trait Parse: Sized {
    /// The next word as a number. On failure the fault names it.
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>>;
}

impl Parse for f64 {
    #[inline]
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
        scan.number().or_else(|fault| odd_number(scan, fault))
    }
}

impl Parse for f32 {
    #[inline]
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
        let before = scan.clone();
        let value = f64::parse(scan)?;
        // The float nearest to the double is that nearest to the text, unless the double is halfway between two floats.
        let halfway = value.to_bits() & 0x1fff_ffff == 0x1000_0000;
        if halfway || (value != 0.0 && value.abs() < f64::from(Self::MIN_POSITIVE)) {
            let word = before.clone().word();
            if let Some(exact) = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
                return Ok(exact);
            }
        }
        Ok(value as Self)
    }
}

macro_rules! parse_whole {
    ($($type:ty),*) => {
        $(impl Parse for $type {
            #[inline]
            fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
                let ahead = scan.clone();
                match scan.count() {
                    Ok(count) if count <= Self::MAX as u64 => Ok(count as Self),
                    _ => {
                        *scan = ahead;
                        whole_within(scan, i64::from(Self::MIN), i64::from(Self::MAX)).map(|number| number as Self)
                    }
                }
            }
        })*
    };
}

parse_whole!(i8, u8, i16, u16, i32, u32);

/// A whole number. `2.0` is one too.
pub(super) fn whole(scan: &mut Scanner<'_>) -> Result<f64, Box<Fault>> {
    scan.skip_blanks();
    let before = scan.clone();
    scan.number()
        .ok()
        .filter(|number| number.fract() == 0.0)
        .ok_or_else(|| Fault::new("E-ply-number", before.place(), before.found(), "a whole number"))
}

/// A whole number within bounds.
fn whole_within(scan: &mut Scanner<'_>, least: i64, most: i64) -> Result<i64, Box<Fault>> {
    scan.skip_blanks();
    let before = scan.clone();
    match whole(scan) {
        Ok(number) if number >= least as f64 && number <= most as f64 => Ok(number as i64),
        _ => {
            let expected = format!("a whole number from {least} to {most}");
            Err(Fault::new("E-ply-number", before.place(), before.found(), expected))
        }
    }
}

/// Infinity and what is no number, which columns may hold.
#[cold]
fn odd_number(scan: &mut Scanner<'_>, fault: NumberFault) -> Result<f64, Box<Fault>> {
    let before = scan.clone();
    let word = scan.word();
    if fault == NumberFault::NotFinite {
        let lower = word.to_ascii_lowercase();
        let negative = lower.starts_with(b"-");
        let size = if lower.windows(3).any(|part| part == b"inf") { f64::INFINITY } else { f64::NAN };
        return Ok(if negative { -size } else { size });
    }
    if fault == NumberFault::Overflow {
        // A position of this size is refused as one that is not finite, with its line.
        return Ok(if word.starts_with(b"-") { f64::NEG_INFINITY } else { f64::INFINITY });
    }
    Err(Fault::new("E-ply-number", before.place(), before.found(), fault.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_rounded_once() {
        let mut state = 1u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Halfway between two floats, and a little above and below.
            let float = f32::from_bits((state >> 33) as u32 & 0x7eff_ffff);
            let middle = (f64::from(float) + f64::from(float.next_up())) / 2.0;
            for text in [format!("{middle}"), format!("{middle}000000000000000000001"), format!("{float:e}")] {
                let text = if text.contains('.') || text.contains('e') { text } else { text + ".0" };
                let read = f32::parse(&mut Scanner::new(text.as_bytes(), 0)).unwrap();
                assert_eq!(read.to_bits(), text.parse::<f32>().unwrap().to_bits(), "{text}");
            }
        }
    }
}
