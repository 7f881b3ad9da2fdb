//! Numbers written into text.

/// Appends the shortest decimal text that reads back to the same double, with an exponent where numbers are very large
/// or very small; `nan`, `inf` and `-inf` where it is none.
pub(crate) fn print_f64(value: f64, out: &mut Vec<u8>) {
    if value.is_finite() {
        print(zmij::Buffer::new().format_finite(value), out);
    } else {
        print_odd(value, out);
    }
}

/// Appends the shortest decimal text that reads back to the same float; words as [`print_f64`].
pub(crate) fn print_f32(value: f32, out: &mut Vec<u8>) {
    if value.is_finite() {
        print(zmij::Buffer::new().format_finite(value), out);
    } else {
        print_odd(f64::from(value), out);
    }
}

fn print(text: &str, out: &mut Vec<u8>) {
    out.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
}

#[cold]
fn print_odd(value: f64, out: &mut Vec<u8>) {
    let word: &[u8] = match value {
        f64::INFINITY => b"inf",
        f64::NEG_INFINITY => b"-inf",
        _ => b"nan",
    };
    out.extend_from_slice(word);
}

/// Appends a whole number.
pub(crate) fn print_whole(value: i64, out: &mut Vec<u8>) {
    let mut digits = [0; 20];
    let mut first = digits.len();
    let mut rest = value.unsigned_abs();
    loop {
        first -= 1;
        digits[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    if value < 0 {
        out.push(b'-');
    }
    out.extend_from_slice(&digits[first..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(print: impl Fn(&mut Vec<u8>)) -> String {
        let mut out = Vec::new();
        print(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_read_back_to_the_same_bits_and_are_no_longer_than_those_of_the_standard_library() {
        let mut bits = 1u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (double, float) = (f64::from_bits(bits), f32::from_bits((bits >> 32) as u32));
            // Zeros before the first other digit and after the last one say nothing.
            let digits = |text: &str| {
                let mantissa = text.split('e').next().unwrap_or("");
                let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
                digits.trim_matches('0').len()
            };
            if double.is_finite() {
                let text = text(|out| print_f64(double, out));
                assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(bits), "{text}");
                assert!(digits(&text) <= digits(&format!("{double:e}")), "{text}");
            }
            if float.is_finite() {
                let text = text(|out| print_f32(float, out));
                assert_eq!(text.parse::<f32>().map(f32::to_bits), Ok(float.to_bits()), "{text}");
            }
            let whole = bits as i64 >> (bits % 64);
            assert_eq!(text(|out| print_whole(whole, out)), whole.to_string());
        }
        for (value, wanted) in [(0.1, "0.1"), (-0.0, "-0"), (1000.0, "1000"), (1e300, "1e300"), (1e-7, "1e-7")] {
            assert_eq!(text(|out| print_f64(value, out)).replace('+', ""), wanted);
        }
        assert_eq!(text(|out| print_f32(f32::NEG_INFINITY, out)), "-inf");
        assert_eq!(text(|out| print_f64(f64::NAN, out)), "nan");
        assert_eq!(text(|out| print_whole(i64::MIN, out)), i64::MIN.to_string());
    }
}
