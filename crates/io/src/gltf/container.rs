//! The chunks of a GLB file.

use shapeloom_core::{Category, Findings, Place, Severity};

use crate::Fault;
use crate::text::quoted;

/// The two chunks that glTF knows, with where they start in the file.
#[derive(Debug, PartialEq)]
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    pub json_start: usize,
    /// The binary chunk and its start.
    pub bin: Option<(&'a [u8], usize)>,
}

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Takes a file apart. Lengths are checked against each other and the file before anything is believed.
pub(super) fn open<'a>(file: &'a [u8], findings: &mut Findings) -> Result<Container<'a>, Box<Fault>> {
    let word = |at: usize| {
        let bytes: Option<[u8; 4]> = file.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        let end = "the end of the file";
        bytes.map(u32::from_le_bytes).ok_or_else(|| {
            let expected = if at < HEADER { "the header of a GLB file, 12 bytes" } else { "the header of a chunk" };
            Fault::new("E-glb-truncated", Place::Byte(file.len().min(at) as u64), end, expected)
        })
    };
    if !file.starts_with(b"glTF") && file.len() >= 4 {
        return Err(Fault::new("E-glb-magic", Place::Byte(0), quoted(&file[..4]), "\"glTF\""));
    }
    word(0)?;
    let version = word(4)?;
    if version != 2 {
        return Err(Fault::new("E-glb-version", Place::Byte(4), format!("version {version}"), "version 2")
            .category(Category::Unsupported)
            .advice("convert the file to glTF 2.0 with another program"));
    }
    let total = word(8)? as usize;
    if total < HEADER {
        return Err(Fault::new("E-glb-length", Place::Byte(8), format!("a length of {total} bytes"), "at least 12"));
    }
    let end = total.min(file.len());
    let mut chunks = Vec::new();
    let mut at = HEADER;
    while at < end {
        let length = word(at)? as usize;
        let kind = word(at + 4)?;
        let start = at + CHUNK_HEADER;
        if length > total.saturating_sub(start) {
            let found = format!("a chunk of {length} bytes");
            let expected =
                format!("at most {}, the rest of the {total} bytes of the header", total.saturating_sub(start));
            return Err(Fault::new("E-glb-chunk", Place::Byte(at as u64), found, expected));
        }
        let Some(bytes) = file.get(start..start + length) else {
            let found = format!("the end of the file after {} bytes", file.len());
            let expected = format!("{length} bytes of the chunk at byte {at}");
            return Err(Fault::new("E-glb-truncated", Place::Byte(file.len() as u64 - 1), found, expected)
                .advice("the file was cut off: get it again"));
        };
        if !length.is_multiple_of(4) {
            let message = "a chunk's length is no multiple of four; it was taken as it is";
            findings.push("W-glb-padding", Severity::Warning, Place::Byte(at as u64), message);
        }
        chunks.push((kind.to_le_bytes(), start, bytes));
        at = start + length;
    }
    if total > file.len() {
        let found = format!("a length of {total} bytes");
        let expected = format!("{}, the length of the file", file.len());
        return Err(Fault::new("E-glb-length", Place::Byte(8), found, expected).advice("the file may be cut off"));
    }
    if file.len() > total {
        let message = format!("the header says {total} bytes; what follows was not read");
        findings.push("W-glb-trailing", Severity::Warning, Place::Byte(total as u64), message);
    }
    let mut chunks = chunks.into_iter();
    let (json, json_start) = match chunks.next() {
        Some((tag, start, bytes)) if &tag == b"JSON" => (bytes, start),
        Some((tag, start, _)) => {
            let place = Place::Byte(start as u64 - 4);
            return Err(Fault::new(
                "E-glb-order",
                place,
                format!("a chunk {}", quoted(&tag)),
                "the chunk \"JSON\" first",
            ));
        }
        None => {
            return Err(Fault::new("E-glb-truncated", Place::Byte(HEADER as u64), "no chunks", "the chunk \"JSON\""));
        }
    };
    let mut bin = None;
    for (index, (tag, start, bytes)) in chunks.enumerate() {
        if index == 0 && &tag == b"BIN\0" {
            bin = Some((bytes, start));
        } else {
            let message =
                format!("the chunk {} is not of glTF 2.0, or not in its place; it was passed over", quoted(&tag));
            findings.push("W-glb-chunk", Severity::Note, Place::Byte(start as u64 - 8), message);
        }
    }
    Ok(Container { json, json_start, bin })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (tag, bytes) in chunks {
            body.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
            body.extend_from_slice(*tag);
            body.extend_from_slice(bytes);
        }
        [b"glTF", &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), body.as_slice()].concat()
    }

    fn fault(file: &[u8]) -> (&'static str, Place) {
        let fault = open(file, &mut Findings::default()).unwrap_err();
        (fault.code, fault.place)
    }

    #[test]
    fn chunks_come_apart() {
        let mut findings = Findings::default();
        let bytes = file(&[(b"JSON", b"{}  "), (b"BIN\0", b"1234"), (b"XTRA", b"")]);
        let container = open(&bytes, &mut findings).unwrap();
        assert_eq!((container.json, container.json_start, container.bin), (&b"{}  "[..], 20, Some((&b"1234"[..], 32))));
        assert_eq!(findings.iter().next().unwrap().code, "W-glb-chunk");
    }

    #[test]
    fn lengths_that_lie_are_placed() {
        let good = file(&[(b"JSON", b"{}  "), (b"BIN\0", b"1234")]);
        let with = |at: usize, value: u32| {
            let mut bytes = good.clone();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            bytes
        };
        assert_eq!(fault(&with(0, 7)), ("E-glb-magic", Place::Byte(0)));
        assert_eq!(fault(&with(4, 1)), ("E-glb-version", Place::Byte(4)));
        assert_eq!(fault(&with(8, 11)), ("E-glb-length", Place::Byte(8)));
        assert_eq!(fault(&with(8, 1000)), ("E-glb-length", Place::Byte(8)));
        assert_eq!(fault(&with(12, u32::MAX)), ("E-glb-chunk", Place::Byte(12)));
        assert_eq!(fault(&with(16, 7)), ("E-glb-order", Place::Byte(16)));
        assert_eq!(fault(&with(24, 5)), ("E-glb-chunk", Place::Byte(24)));
        assert_eq!(fault(&good[..good.len() - 1]), ("E-glb-truncated", Place::Byte(34)));
        assert_eq!(fault(&good[..10]), ("E-glb-truncated", Place::Byte(8)));
        assert_eq!(fault(&with(8, 12)[..12]), ("E-glb-truncated", Place::Byte(12)));
    }
}
