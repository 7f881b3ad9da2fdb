//! What may be made of a document of some length.

use shapeloom_core::Category;

use super::json::At;
use crate::Fault;

/// A part takes a few hundred bytes: beyond this many, and one for every 32 bytes of the input, they would take memory out
/// of proportion to it. A part with a triangle of its own takes more of the input.
const MANY_PARTS: u64 = 1 << 14;
const BYTES_FOR_PART: u64 = 32;

/// What is made may be so large whatever the input, and so many times as large as it. Tightly packed bytes as fractions
/// become eight times as large, shared indices and vertices of well-made files at most three or four times.
const MADE: u64 = 32 << 20;
const MADE_FOR_BYTE: u64 = 24;

/// Keeps the shape in proportion to the bytes of the document and its buffers.
///
/// In glTF a few bytes may say again and again what is large: nodes show the same mesh, accessors the same view. A memory
/// budget would stop that too, but not every caller has one.
pub(super) struct Allowance {
    bytes: u64,
    parts: u64,
    made: u64,
}

impl Allowance {
    /// For an input of so many bytes.
    pub fn new(bytes: usize) -> Self {
        Self { bytes: bytes as u64, parts: 0, made: 0 }
    }

    /// The same for an input that has more bytes beside it.
    pub fn extend(&mut self, bytes: usize) {
        self.bytes = self.bytes.saturating_add(bytes as u64);
    }

    /// How many parts there may be.
    pub fn most_parts(&self) -> u64 {
        MANY_PARTS + self.bytes / BYTES_FOR_PART
    }

    /// One more part.
    ///
    /// # Errors
    /// There are too many.
    pub fn part(&mut self, at: &At<'_>) -> Result<(), Box<Fault>> {
        self.parts += 1;
        let most = self.most_parts();
        if self.parts > most {
            let found = format!("more than {most} parts, one for every primitive below every node");
            let expected = format!("at most that many from {} bytes", self.bytes);
            let fault = at.fault("E-gltf-limit", found, expected).category(Category::OverLimit);
            return Err(fault.advice("write the file anew with fewer nodes for the same mesh"));
        }
        Ok(())
    }

    /// `count` elements of `size` bytes more.
    ///
    /// # Errors
    /// Too much is made in all.
    pub fn take(&mut self, count: usize, size: usize, at: &At<'_>) -> Result<(), Box<Fault>> {
        self.made = self.made.saturating_add((count as u64).saturating_mul(size as u64));
        let most = MADE.saturating_add(self.bytes.saturating_mul(MADE_FOR_BYTE));
        if self.made <= most {
            return Ok(());
        }
        let found = format!("{} bytes when it is decoded, with all before", self.made);
        let expected = format!("at most {most} from {} bytes of document and buffers", self.bytes);
        let fault = at.fault("E-gltf-limit", found, expected).category(Category::OverLimit);
        Err(fault.advice("write the file anew so that every primitive has its own vertices and no others"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn parts_and_bytes_are_allowed_in_proportion() {
        let at = At::root(&Value::Null);
        let mut allowance = Allowance::new(1600);
        allowance.extend(1600);
        for _ in 0..16_384 + 100 {
            allowance.part(&at).unwrap();
        }
        assert_eq!(allowance.part(&at).unwrap_err().code, "E-gltf-limit");
        allowance.take(3200, 24, &at).unwrap();
        allowance.take(32 << 20, 1, &at).unwrap();
        assert_eq!(allowance.take(1, 1, &at).unwrap_err().category, Category::OverLimit);
        assert!(allowance.take(usize::MAX, usize::MAX, &at).is_err());
    }
}
