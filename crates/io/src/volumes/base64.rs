//! Base64 as VTK has it: pieces that are padded each, one after another, with white space anywhere.

use shapeloom_core::Exec;

use crate::ReadError;
use crate::memory::Memory;

/// The bytes of a text, and how much of it was read: up to the first character that is none of base64, or a group that is
/// cut.
pub(crate) fn decode_base64(text: &[u8], exec: &Exec, memory: &mut Memory<'_>) -> Result<(Vec<u8>, usize), ReadError> {
    let most = text.len() / 4 * 3;
    memory.take(most, 1)?;
    let mut bytes = Vec::with_capacity(most);
    let (mut bits, mut symbols, mut padding) = (0u32, 0, 0);
    let mut whole = 0;
    for (at, &byte) in text.iter().enumerate() {
        if at % (1 << 16) == 0 {
            exec.check()?;
        }
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' if symbols >= 2 => {
                padding += 1;
                0
            }
            b' ' | b'\t' | b'\n' | b'\r' => continue,
            _ => break,
        };
        if padding > 0 && byte != b'=' {
            break;
        }
        bits = bits << 6 | u32::from(value);
        symbols += 1;
        if symbols == 4 {
            bytes.extend_from_slice(&bits.to_be_bytes()[1..4 - padding]);
            (bits, symbols, padding) = (0, 0, 0);
            whole = at + 1;
        }
    }
    Ok((bytes, whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padded_pieces_follow_each_other() {
        let exec = Exec::default();
        let decoded = |text: &str| decode_base64(text.as_bytes(), &exec, &mut Memory::new(&exec)).unwrap();
        assert_eq!(decoded(" Zg==\nZm9vYmE=Zm9v "), (b"ffoobafoo".to_vec(), 18));
        assert_eq!(decoded("Zm9v<Zm9v"), (b"foo".to_vec(), 4));
        assert_eq!(decoded("Zm9vZm"), (b"foo".to_vec(), 4));
        for wrong in ["=", "Z===", "Zg=a"] {
            assert_eq!(decoded(wrong), (Vec::new(), 0), "{wrong}");
        }
    }
}
