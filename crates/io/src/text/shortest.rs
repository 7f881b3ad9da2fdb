//! Numbers written as the shortest text that reads back to the same bits.

/// The shortest decimal text that reads back to the same bits: with an exponent where that is shorter and plain notation
/// takes more than five characters.
pub fn shortest(value: f64) -> String {
    let mut text = Vec::with_capacity(24);
    push_number(&mut text, value);
    text.into_iter().map(char::from).collect()
}

/// Appends the shortest text of a double. Infinite and not a number are the words `inf`, `-inf` and `nan`.
pub(crate) fn push_number(out: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        push_laid_out(out, value.abs(), zmij::Buffer::new().format_finite(value).as_bytes());
    } else {
        push_word(out, value);
    }
}

/// Appends the shortest text that reads back to the same single precision number.
pub(crate) fn push_single(out: &mut Vec<u8>, value: f32) {
    if value.is_finite() {
        push_laid_out(out, f64::from(value.abs()), zmij::Buffer::new().format_finite(value).as_bytes());
    } else {
        push_word(out, f64::from(value));
    }
}

/// Appends a whole number.
pub(crate) fn push_count(out: &mut Vec<u8>, value: u64) {
    out.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

/// Appends a whole number that may be negative.
pub(crate) fn push_integer(out: &mut Vec<u8>, value: i64) {
    out.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

#[cold]
fn push_word(out: &mut Vec<u8>, value: f64) {
    out.extend_from_slice(if value.is_nan() {
        b"nan"
    } else if value > 0.0 {
        b"inf"
    } else {
        b"-inf"
    });
}

/// Appends the text of a number of that size, which has the shortest digits.
#[inline]
fn push_laid_out(out: &mut Vec<u8>, size: f64, text: &[u8]) {
    // With digits after the point, and at most one zero between it and the first other digit, plain notation has at most
    // one character beside the digits and the point, and an exponent at least two. Such numbers are plain in `text`.
    if (0.01..1e7).contains(&size) && !text.ends_with(b".0") {
        out.extend_from_slice(text);
    } else {
        lay_out(out, text);
    }
}

/// Appends the number in plain notation or with an exponent, whichever is shorter. `text` has the shortest digits, in one
/// of the two notations.
fn lay_out(out: &mut Vec<u8>, text: &[u8]) {
    let text = match text.split_first() {
        Some((b'-', rest)) => {
            out.push(b'-');
            rest
        }
        _ => text,
    };
    let (mantissa, exponent) = match memchr::memchr(b'e', text) {
        Some(at) => (&text[..at], exponent(&text[at + 1..])),
        None => (text, 0),
    };
    let (whole, fraction) = match memchr::memchr(b'.', mantissa) {
        Some(at) => (&mantissa[..at], &mantissa[at + 1..]),
        None => (mantissa, &[][..]),
    };
    // What is plain already and short is written as it is: nothing beats it.
    if exponent == 0 && whole.len() < 4 && whole != b"0" && fraction != b"0" {
        out.extend_from_slice(mantissa);
        return;
    }
    let mut digits = [0u8; 40];
    let count = (whole.len() + fraction.len()).min(digits.len());
    for (slot, digit) in digits.iter_mut().zip(whole.iter().chain(fraction)) {
        *slot = *digit;
    }
    let leading = digits[..count].iter().take_while(|&&digit| digit == b'0').count();
    let trailing = digits[leading..count].iter().rev().take_while(|&&digit| digit == b'0').count();
    let significant = &digits[leading..count - trailing];
    // The number is 0.DIGITS times ten to this.
    let scale = exponent + whole.len() as i32 - leading as i32;
    if significant.is_empty() {
        out.push(b'0');
        return;
    }
    let length = significant.len() as i32;
    let plain = if scale <= 0 { 2 - scale + length } else { length.max(scale) + i32::from(scale < length) };
    let power = scale - 1;
    let power_length = i32::from(power < 0)
        + if power.abs() < 10 {
            1
        } else if power.abs() < 100 {
            2
        } else {
            3
        };
    let scientific = length + i32::from(length > 1) + 1 + power_length;
    // People read short plain numbers better.
    if scientific < plain && plain > 5 {
        out.push(significant[0]);
        if length > 1 {
            out.push(b'.');
            out.extend_from_slice(&significant[1..]);
        }
        out.push(b'e');
        push_integer(out, i64::from(power));
    } else if scale <= 0 {
        out.extend_from_slice(b"0.");
        out.resize(out.len() + scale.unsigned_abs() as usize, b'0');
        out.extend_from_slice(significant);
    } else if scale >= length {
        out.extend_from_slice(significant);
        out.resize(out.len() + (scale - length) as usize, b'0');
    } else {
        out.extend_from_slice(&significant[..scale as usize]);
        out.push(b'.');
        out.extend_from_slice(&significant[scale as usize..]);
    }
}

fn exponent(text: &[u8]) -> i32 {
    let (negative, digits) = match text.split_first() {
        Some((b'-', digits)) => (true, digits),
        Some((b'+', digits)) => (false, digits),
        _ => (false, text),
    };
    let size = digits.iter().fold(0, |sum, digit| sum * 10 + i32::from(digit.wrapping_sub(b'0')));
    if negative { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::parse_number;

    /// What the standard library writes, by the same rule.
    fn by_std(value: f64) -> String {
        let (plain, scientific) = (value.to_string(), format!("{value:e}"));
        let digits = plain.trim_start_matches('-').len();
        if scientific.len() < plain.len() && digits > 5 { scientific } else { plain }
    }

    #[test]
    fn shortest_text_reads_back_to_the_same_bits() {
        // A linear congruential generator over all bit patterns, and over sizes that occur.
        let mut bits = 1u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let small = (bits >> 33) as f64 / 10f64.powi((bits >> 60) as i32) - 1e4;
            for value in [f64::from_bits(bits), small, small.round(), f64::from(small as f32)] {
                if value.is_finite() {
                    let text = shortest(value);
                    assert_eq!(parse_number(text.as_bytes()).map(f64::to_bits), Ok(value.to_bits()), "{text}");
                    assert_eq!(text.len(), by_std(value).len(), "{text}");
                }
            }
            let single = f32::from_bits((bits >> 32) as u32);
            if single.is_finite() {
                let mut text = Vec::new();
                push_single(&mut text, single);
                let text = String::from_utf8(text).unwrap();
                assert_eq!(text.parse::<f32>().unwrap().to_bits(), single.to_bits());
                assert!(text.len() <= single.to_string().len());
            }
        }
    }

    #[test]
    fn the_shorter_notation_is_taken() {
        let values =
            [1e300, 1e-7, 1000.0, 0.1, -0.0, 1e6, 100.0, 123456.0, 0.001, 0.00123, 1.5e-9, 5e-324, 12.5, 1200.0];
        let texts = [
            "1e300", "1e-7", "1000", "0.1", "-0", "1e6", "100", "123456", "0.001", "0.00123", "1.5e-9", "5e-324",
            "12.5", "1200",
        ];
        assert_eq!(values.map(shortest), texts);
        assert_eq!(values.map(by_std), texts);
        assert_eq!([f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(shortest), ["nan", "inf", "-inf"]);
        let mut out = Vec::new();
        push_count(&mut out, u64::MAX);
        push_integer(&mut out, -7);
        assert_eq!(out, b"18446744073709551615-7");
    }

    #[test]
    fn the_short_way_writes_what_the_long_one_does() {
        let mut bits = 1u64;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let size = (bits >> 33) as f64 / 10f64.powi((bits >> 60) as i32 - 2);
            for value in [size, -size.floor(), f64::from(size as f32), (size * 100.0).round() / 1e4] {
                let (mut short, mut long) = (Vec::new(), Vec::new());
                push_number(&mut short, value);
                lay_out(&mut long, zmij::Buffer::new().format_finite(value).as_bytes());
                assert_eq!(short, long, "{value}");
            }
        }
    }
}
