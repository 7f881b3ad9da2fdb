//! Zlib streams that tell whether they are whole.

use std::io::{Error, ErrorKind, Result};

use flate2::{Decompress, FlushDecompress, Status};

/// Unpacks a zlib stream piece by piece. Unlike flate2's reader, it says when the input ends before the stream does, if only within
/// the checksum.
pub(crate) struct ZlibStream<'a> {
    inflate: Decompress,
    rest: &'a [u8],
    ended: bool,
}

impl<'a> ZlibStream<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { inflate: Decompress::new(true), rest: bytes, ended: false }
    }

    /// Packed bytes that were not looked at.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Some bytes at the front of a buffer that is not empty; none after the end, where the checksum was right.
    ///
    /// # Errors
    /// [`ErrorKind::UnexpectedEof`] where the input ends too early, another for damaged bytes or a wrong checksum.
    pub(crate) fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        while !self.ended {
            let (taken, given) = (self.inflate.total_in(), self.inflate.total_out());
            let status = self.inflate.decompress(self.rest, buffer, FlushDecompress::None)?;
            let taken = usize::try_from(self.inflate.total_in() - taken).unwrap_or(usize::MAX);
            let given = usize::try_from(self.inflate.total_out() - given).unwrap_or(usize::MAX);
            self.rest = self.rest.get(taken..).unwrap_or_default();
            self.ended = status == Status::StreamEnd;
            if given > 0 {
                return Ok(given);
            }
            if !self.ended && (self.rest.is_empty() || taken == 0) {
                return Err(Error::new(ErrorKind::UnexpectedEof, "the end of the packed data"));
            }
        }
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn unpacked(bytes: &[u8], piece: usize) -> (Vec<u8>, Option<ErrorKind>, usize) {
        let mut stream = ZlibStream::new(bytes);
        let (mut all, mut buffer) = (Vec::new(), vec![0; piece]);
        loop {
            match stream.read(&mut buffer) {
                Ok(0) => return (all, None, stream.rest().len()),
                Ok(count) => all.extend_from_slice(&buffer[..count]),
                Err(error) => return (all, Some(error.kind()), stream.rest().len()),
            }
        }
    }

    #[test]
    fn streams_end_where_their_checksum_does() {
        let bytes: Vec<u8> = (0..5000u32).map(|at| (at * at / 7) as u8).collect();
        let whole = packed(&bytes);
        for piece in [1, 17, 4096, 10_000] {
            assert_eq!(unpacked(&whole, piece), (bytes.clone(), None, 0));
            assert_eq!(unpacked(&[&whole[..], b"more"].concat(), piece), (bytes.clone(), None, 4));
            for cut in 1..=4 {
                let (found, error, _) = unpacked(&whole[..whole.len() - cut], piece);
                assert_eq!((found.len(), error), (5000, Some(ErrorKind::UnexpectedEof)), "{piece} {cut}");
            }
            for cut in (0..whole.len() - 20).step_by(97) {
                let (found, error, _) = unpacked(&whole[..cut], piece);
                assert!(bytes.starts_with(&found) && error == Some(ErrorKind::UnexpectedEof), "{piece} {cut}");
            }
        }
        let mut wrong = whole;
        *wrong.last_mut().unwrap() ^= 1;
        let (_, error, _) = unpacked(&wrong, 4096);
        assert!(error.is_some_and(|kind| kind != ErrorKind::UnexpectedEof));
    }
}
