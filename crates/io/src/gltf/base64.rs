//! Base64 (RFC 4648).

use std::io::{self, Write};

/// Writes standard base64 with padding.
pub(super) fn encode(bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    const SYMBOLS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = Vec::with_capacity(4 << 10);
    for block in bytes.chunks(3 << 10) {
        text.clear();
        for group in block.chunks(3) {
            let byte = |at: usize| u32::from(group.get(at).copied().unwrap_or(0));
            let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
            let symbol = |at: usize| SYMBOLS[(bits >> (18 - 6 * at)) as usize & 63];
            text.extend((0..4).map(|at| if at <= group.len() { symbol(at) } else { b'=' }));
        }
        out.write_all(&text)?;
    }
    Ok(())
}

/// Decodes standard base64, padded or not; none for any other character, white space included, and for cut groups.
pub(super) fn decode(text: &[u8]) -> Option<Vec<u8>> {
    let unpadded = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    let mut bytes = Vec::with_capacity(unpadded.len() / 4 * 3 + 2);
    for group in unpadded.chunks(4) {
        let mut bits = 0u32;
        for &symbol in group {
            bits = bits << 6 | u32::from(value(symbol)?);
        }
        match group.len() {
            4 => bytes.extend_from_slice(&bits.to_be_bytes()[1..]),
            3 => bytes.extend_from_slice(&(bits << 6).to_be_bytes()[1..3]),
            2 => bytes.extend_from_slice(&(bits << 12).to_be_bytes()[1..2]),
            _ => return None,
        }
    }
    Some(bytes)
}

fn value(symbol: u8) -> Option<u8> {
    match symbol {
        b'A'..=b'Z' => Some(symbol - b'A'),
        b'a'..=b'z' => Some(symbol - b'a' + 26),
        b'0'..=b'9' => Some(symbol - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vectors_of_the_rfc_decode() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
            ("Zg", "f"),
        ] {
            assert_eq!(decode(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
            let mut encoded = Vec::new();
            encode(bytes.as_bytes(), &mut encoded).unwrap();
            assert!(encoded.len().is_multiple_of(4) && encoded.starts_with(text.as_bytes()), "{text}");
        }
        let long: Vec<u8> = (0..10_000u32).map(|i| (i * i % 251) as u8).collect();
        let mut encoded = Vec::new();
        encode(&long, &mut encoded).unwrap();
        assert_eq!(decode(&encoded), Some(long));
        assert_eq!(decode(b"+/+/"), Some(vec![0xfb, 0xff, 0xbf]));
        for text in ["Z", "Zm9vZ", "Zm 9v", "Z=g=", "Zm9v\n", "===="] {
            assert_eq!(decode(text.as_bytes()), None, "{text}");
        }
    }
}
