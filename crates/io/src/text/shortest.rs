//! Numbers as the shortest text that reads back to the same bits.

use std::io::Write;

/// The shortest decimal text that reads back to the same bits, with an exponent where that is shorter.
pub fn shortest(value: f64) -> String {
    let mut text = Vec::with_capacity(24);
    push_shortest(&mut text, value);
    String::from_utf8_lossy(&text).into_owned()
}

/// Appends [`shortest`].
pub(crate) fn push_shortest(out: &mut Vec<u8>, value: f64) {
    if !value.is_finite() {
        // Writing to a vector does not fail.
        let _ = write!(out, "{value}");
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value).as_bytes();
    if may_tie(value, text) {
        // Both neighbours of that many digits are as near; take the one that the standard library takes.
        let mut scientific = Vec::with_capacity(24);
        let _ = write!(scientific, "{value:e}");
        lay_out(out, &scientific);
        return;
    }
    // With digits after the point and few zeros before the first digit no exponent is shorter.
    if (1e-2..1e15).contains(&value.abs()) && !text.ends_with(b".0") {
        out.extend_from_slice(text);
        return;
    }
    lay_out(out, text);
}

/// Whether a value may lie in the middle between two decimal numbers of as many digits as its shortest text has.
///
/// Such a value has k digits after the point, the last of them a 5, and its text has one less. A number that ends in k
/// binary places has k decimal ones; beyond 25 of them seventeen digits do not reach so far.
#[inline]
fn may_tie(value: f64, text: &[u8]) -> bool {
    const MANTISSA: i32 = 52;
    let bits = value.to_bits();
    let exponent = ((bits >> MANTISSA) & 0x7ff) as i32;
    let mantissa = (bits & ((1 << MANTISSA) - 1)) | (1 << MANTISSA);
    let places = 1023 + MANTISSA - exponent - mantissa.trailing_zeros() as i32;
    (2..=25).contains(&places) && {
        let after = text.iter().rev().position(|&byte| byte == b'.').unwrap_or(0);
        after as i32 == places - 1 || text.contains(&b'e')
    }
}

/// Appends a whole number.
#[inline]
pub(crate) fn push_whole(out: &mut Vec<u8>, value: impl itoa::Integer) {
    out.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

/// Appends a number written in any decimal way in the shorter of the plain one and the one with an exponent.
fn lay_out(out: &mut Vec<u8>, text: &[u8]) {
    let (sign, text) = match text.strip_prefix(b"-") {
        Some(text) => (&b"-"[..], text),
        None => (&b""[..], text),
    };
    let mut digits = [0; 24];
    let mut count = 0;
    // The value is 0.d1d2d3... times ten to this.
    let mut point = 0i32;
    let mut after = false;
    let mut rest = text.iter();
    for &byte in rest.by_ref() {
        match byte {
            b'0'..=b'9' => {
                point +=
                    i32::from(!after && (count > 0 || byte > b'0')) - i32::from(after && count == 0 && byte == b'0');
                if (count > 0 || byte > b'0') && count < digits.len() {
                    digits[count] = byte;
                    count += 1;
                }
            }
            b'.' => after = true,
            _ => break,
        }
    }
    let exponent = rest.as_slice();
    let size =
        exponent.iter().filter(|byte| byte.is_ascii_digit()).fold(0, |sum, byte| sum * 10 + i32::from(byte - b'0'));
    point += if exponent.first() == Some(&b'-') { -size } else { size };
    let digits = &digits[..count];
    let digits = &digits[..digits.iter().rposition(|&digit| digit != b'0').map_or(0, |last| last + 1)];
    out.extend_from_slice(sign);
    let Some((&first, others)) = digits.split_first() else {
        out.push(b'0');
        return;
    };
    let count = digits.len() as i32;
    let plain = match point {
        ..=0 => 2 - point + count,
        1.. => {
            if point >= count {
                point
            } else {
                count + 1
            }
        }
    };
    let power = point - 1;
    let scientific = count + i32::from(count > 1) + 1 + itoa::Buffer::new().format(power).len() as i32;
    // Ordinary short numbers stay as they are; the sign counts with them.
    if plain + (sign.len() as i32) < 6 || plain <= scientific {
        if point <= 0 {
            out.extend_from_slice(b"0.");
            out.resize(out.len() + point.unsigned_abs() as usize, b'0');
            out.extend_from_slice(digits);
        } else if point >= count {
            out.extend_from_slice(digits);
            out.resize(out.len() + (point - count) as usize, b'0');
        } else {
            out.extend_from_slice(&digits[..point as usize]);
            out.push(b'.');
            out.extend_from_slice(&digits[point as usize..]);
        }
        return;
    }
    out.push(first);
    if !others.is_empty() {
        out.push(b'.');
        out.extend_from_slice(others);
    }
    out.push(b'e');
    push_whole(out, power);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::parse_number;

    /// The standard library's two ways, and the shorter one of them.
    fn by_the_standard_library(value: f64) -> String {
        let plain = value.to_string();
        let scientific = format!("{value:e}");
        if plain.len() < 6 || plain.len() <= scientific.len() { plain } else { scientific }
    }

    #[test]
    fn text_is_that_of_the_standard_library() {
        let mut bits = 1u64;
        let mut check =
            |value: f64| assert_eq!(shortest(value), by_the_standard_library(value), "{:x}", value.to_bits());
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            check(f64::from_bits(bits));
            check(f64::from(f32::from_bits((bits >> 32) as u32)));
            let whole = (bits >> 40) as f64;
            check(whole / 4096.0 - 2048.0);
            // Halves between numbers of fewer digits.
            check((bits >> 11) as f64 / 2f64.powi((bits >> 5) as i32 % 30));
            check((1u64 << (bits >> 59).min(47)) as f64 + 0.125);
            check(whole * 10f64.powi((bits >> 20) as i32 % 24));
            check(-(whole / 10f64.powi((bits >> 20) as i32 % 12)).round());
        }
        for power in -330..310 {
            for digits in ["1", "-1", "12", "1.5", "9.999", "-123456", "2.2250738585072014"] {
                check(format!("{digits}e{power}").parse().unwrap());
            }
        }
        for value in [0.0, -0.0, f64::NAN, f64::INFINITY, -f64::INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324] {
            check(value);
        }
    }

    #[test]
    fn shortest_text_reads_back_to_the_same_bits() {
        // A linear congruential generator over all bit patterns.
        let mut bits = 1u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(bits);
            if value.is_finite() {
                assert_eq!(parse_number(shortest(value).as_bytes()).map(f64::to_bits), Ok(bits));
            }
        }
        assert_eq!([1e300, 1e-7, 1000.0, 0.1, -0.0].map(shortest), ["1e300", "1e-7", "1000", "0.1", "-0"]);
        assert_eq!(shortest(1_000_000.0), "1e6");
    }
}
