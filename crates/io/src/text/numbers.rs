//! Numbers in text.

use std::fmt;

/// Why a token is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFault {
    /// It does not read as a number.
    Syntax,
    /// It is a word for infinity or for no number.
    NotFinite,
    /// It is larger than the largest double.
    Overflow,
}

impl fmt::Display for NumberFault {
    /// What was expected instead.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Syntax => "a number",
            Self::NotFinite => "a finite number",
            Self::Overflow => "a number of at most 1.8e308",
        })
    }
}

/// The double nearest to a decimal number: a sign, digits with at most one point and at least one digit, an exponent.
///
/// # Errors
/// Anything else: words such as `nan`, hexadecimal, a comma, stray characters, numbers beyond the largest double.
/// Numbers too small become zero.
pub fn parse_number(token: &[u8]) -> Result<f64, NumberFault> {
    let word = token.strip_prefix(b"-").or_else(|| token.strip_prefix(b"+")).unwrap_or(token);
    let (whole, rest) = split_digits(word);
    let (fraction, rest) = match rest.strip_prefix(b".") {
        Some(rest) => split_digits(rest),
        None => (&[][..], rest),
    };
    let exponent_ok = match rest.split_first() {
        None => true,
        Some((b'e' | b'E', exponent)) => {
            let digits = exponent.strip_prefix(b"-").or_else(|| exponent.strip_prefix(b"+")).unwrap_or(exponent);
            !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
        }
        Some(_) => false,
    };
    if (whole.is_empty() && fraction.is_empty()) || !exponent_ok {
        let lower = word.to_ascii_lowercase();
        let names_none = lower == b"nan" || lower == b"inf" || lower == b"infinity" || lower.starts_with(b"1.#");
        return Err(if names_none { NumberFault::NotFinite } else { NumberFault::Syntax });
    }
    let text = std::str::from_utf8(token).map_err(|_| NumberFault::Syntax)?;
    let value: f64 = text.parse().map_err(|_| NumberFault::Syntax)?;
    if value.is_finite() { Ok(value) } else { Err(NumberFault::Overflow) }
}

fn split_digits(text: &[u8]) -> (&[u8], &[u8]) {
    text.split_at(text.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(text.len()))
}

/// Why a token is no count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountFault {
    /// It is not a row of digits.
    Syntax,
    /// It is a row of digits that 64 bits cannot hold.
    Overflow,
}

/// A whole number from 0, written in digits alone.
///
/// # Errors
/// A sign, a point, an exponent or anything else but digits; more than 64 bits.
pub fn parse_count(token: &[u8]) -> Result<u64, CountFault> {
    if token.is_empty() {
        return Err(CountFault::Syntax);
    }
    token.iter().try_fold(0u64, |sum, byte| match byte {
        b'0'..=b'9' => {
            let grown = sum.checked_mul(10).and_then(|sum| sum.checked_add(u64::from(byte - b'0')));
            grown.ok_or(CountFault::Overflow)
        }
        _ => Err(CountFault::Syntax),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grammar_is_strict() {
        for (text, value) in
            [("1", 1.0), ("-1.5e3", -1500.0), (".5", 0.5), ("5.", 5.0), ("+2E-2", 0.02), ("1e-999", 0.0)]
        {
            assert_eq!(parse_number(text.as_bytes()), Ok(value), "{text}");
        }
        for text in ["", "-", ".", "e5", "1e", "1e+", "1.2.3", "0x10", "1,5", "1_000", "--1", "1f", "\u{661}", "1 "] {
            assert_eq!(parse_number(text.as_bytes()), Err(NumberFault::Syntax), "{text}");
        }
        for text in ["nan", "-NaN", "inf", "+Infinity", "1.#QNAN", "-1.#IND"] {
            assert_eq!(parse_number(text.as_bytes()), Err(NumberFault::NotFinite), "{text}");
        }
        assert_eq!(parse_number(b"1e400"), Err(NumberFault::Overflow));
        assert_eq!(parse_number(b"-1e309"), Err(NumberFault::Overflow));
        assert_eq!(parse_number(b"\xff"), Err(NumberFault::Syntax));
        assert_eq!(parse_number(b"-0").map(f64::to_bits), Ok((-0.0f64).to_bits()));
    }

    #[test]
    fn counts_do_not_wrap() {
        assert_eq!(parse_count(b"4294967297"), Ok(4_294_967_297));
        assert_eq!(parse_count(b"18446744073709551615"), Ok(u64::MAX));
        assert_eq!(parse_count(b"18446744073709551616"), Err(CountFault::Overflow));
        for text in ["", "-1", "+1", "1e3", "1.0", "0x1"] {
            assert_eq!(parse_count(text.as_bytes()), Err(CountFault::Syntax), "{text}");
        }
    }
}
