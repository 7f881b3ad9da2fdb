//! Decimal numbers, read fast and exactly.

use super::numbers::{NumberFault, parse_number};

/// Powers of ten that a double holds exactly.
const TEN_TO: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Up to here every whole number is a double.
const LARGEST_EXACT: u64 = 1 << 53;

/// The double nearest to the decimal number at the start of `bytes`, and the number of bytes that it takes.
///
/// The grammar is that of [`parse_number`], and so is the value, to the last bit: a number of few digits is one exact
/// whole number times or over one exact power of ten, which a single operation rounds right (W. D. Clinger, "How to
/// read floating point numbers accurately", 1990); all others go the long way. What follows the number is the caller's
/// to look at.
///
/// # Errors
/// As [`parse_number`], for the bytes up to the next white space.
#[inline]
pub(crate) fn decimal(bytes: &[u8]) -> Result<(f64, usize), NumberFault> {
    let (negative, start) = match bytes.first() {
        Some(b'-') => (true, 1),
        Some(b'+') => (false, 1),
        _ => (false, 0),
    };
    let (mut mantissa, mut at) = digits(bytes, start, 0);
    let mut count = at - start;
    let mut exponent = 0i32;
    if bytes.get(at) == Some(&b'.') {
        let first = at + 1;
        (mantissa, at) = digits(bytes, first, mantissa);
        count += at - first;
        exponent = -((at - first).min(1 << 20) as i32);
    }
    if count == 0 {
        return slow(bytes);
    }
    if let Some(b'e' | b'E') = bytes.get(at) {
        let (down, first) = match bytes.get(at + 1) {
            Some(b'-') => (true, at + 2),
            Some(b'+') => (false, at + 2),
            _ => (false, at + 1),
        };
        let (power, end) = digits(bytes, first, 0);
        if end == first || end - first > 4 {
            return slow(bytes);
        }
        exponent += if down { -(power as i32) } else { power as i32 };
        at = end;
    }
    // More than 19 digits may have wrapped.
    if count > 19 || mantissa > LARGEST_EXACT || exponent.unsigned_abs() > 22 {
        return match parse_number(&bytes[..at]) {
            Ok(value) => Ok((value, at)),
            Err(fault) => Err(fault),
        };
    }
    let whole = mantissa as f64;
    let power = TEN_TO[exponent.unsigned_abs() as usize];
    let size = if exponent < 0 { whole / power } else { whole * power };
    Ok((if negative { -size } else { size }, at))
}

/// The value after further digits from `at` on, wrapping, and where they end.
#[inline]
pub(super) fn digits(bytes: &[u8], mut at: usize, mut value: u64) -> (u64, usize) {
    // Eight at a time where there are eight: text from machines has long fractions.
    while let Some(eight) = bytes.get(at..at + 8).and_then(|part| <[u8; 8]>::try_from(part).ok()) {
        let Some(number) = eight_digits(u64::from_le_bytes(eight)) else { break };
        value = value.wrapping_mul(100_000_000).wrapping_add(number);
        at += 8;
    }
    while let Some(digit) = bytes.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (value, at)
}

/// The number that eight ASCII digits write, the first in the lowest byte; none where a byte is no digit. Neighbours are
/// joined to pairs, pairs to fours, fours to eight.
#[inline]
fn eight_digits(word: u64) -> Option<u64> {
    const ZEROS: u64 = 0x3030_3030_3030_3030;
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    // A digit has 3 in its high half, and still after adding 6 to it.
    if (word & HIGH) != ZEROS || (word.wrapping_add(0x0606_0606_0606_0606) & HIGH) != ZEROS {
        return None;
    }
    let ones = word & 0x0f0f_0f0f_0f0f_0f0f;
    let pairs = (ones * 10 + (ones >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs * 100 + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
    Some((fours * 10_000 + (fours >> 32)) & 0xffff_ffff)
}

#[cold]
fn slow(bytes: &[u8]) -> Result<(f64, usize), NumberFault> {
    let end = bytes.iter().position(u8::is_ascii_whitespace).unwrap_or(bytes.len());
    parse_number(&bytes[..end]).map(|value| (value, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard library rounds right: the same bits on every route.
    #[test]
    fn values_are_those_of_the_standard_library() {
        let mut texts: Vec<String> = [
            "0",
            "-0",
            "1",
            "+1",
            ".5",
            "5.",
            "-1.25e2",
            "1e22",
            "1e23",
            "1e-22",
            "1e-23",
            "9007199254740993",
            "9007199254740992e22",
            "0.1",
            "123456789012345678901234567890",
            "0.00000000000000000000000000012345678",
            "2.2250738585072011e-308",
            "4.9e-324",
            "1e-999",
            "1.7976931348623157e308",
            "8.5e0001",
            "12345678",
            "1234567812345678",
        ]
        .map(str::to_owned)
        .to_vec();
        let mut state = 1u64;
        for _ in 0..200_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(state);
            if value.is_finite() {
                texts.push(format!("{value:e}"));
                texts.push(format!("{:.*}", (state >> 60) as usize, (value % 1e6)));
            }
            texts.push(format!("{}", f64::from((state >> 40) as u32) / 1e4));
        }
        for text in texts {
            let wanted: f64 = text.parse().unwrap();
            let (value, end) = decimal(format!("{text} 7").as_bytes()).unwrap();
            assert_eq!((value.to_bits(), end), (wanted.to_bits(), text.len()), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told() {
        for text in ["", "-", ".", "e5", "x", "-.e3", "1e", "1e+", "1e+x", "\u{661}"] {
            assert_eq!(decimal(text.as_bytes()), Err(NumberFault::Syntax), "{text}");
        }
        assert_eq!(decimal(b"nan"), Err(NumberFault::NotFinite));
        assert_eq!(decimal(b"1e400"), Err(NumberFault::Overflow));
        assert_eq!(decimal(b"1e99999999999"), Err(NumberFault::Overflow));
        // What follows is the caller's.
        assert_eq!(decimal(b"1,5"), Ok((1.0, 1)));
        assert_eq!(decimal(b"0x10"), Ok((0.0, 1)));
    }

    #[test]
    fn eight_digits_are_read_at_once() {
        let read = |text: &[u8; 8]| eight_digits(u64::from_le_bytes(*text));
        assert_eq!(read(b"12345678"), Some(12_345_678));
        assert_eq!(read(b"99999999"), Some(99_999_999));
        assert_eq!(read(b"00000001"), Some(1));
        for wrong in [b"1234567:", b"/2345678", b"1234 678", b"12345.78", b"\xb12345678"] {
            assert_eq!(read(wrong), None);
        }
    }
}
