//! MetaImage by hand.

use std::sync::Arc;

use shapeloom_shape::Geometry;

use crate::{ReadContext, ReadError, SiblingError, SiblingName, Siblings, format_by_id, read};

/// A file beside the header.
struct Beside(Vec<u8>);

impl Siblings for Beside {
    fn open(&self, _: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        Ok(self.0[..self.0.len().min(usize::try_from(max_bytes).unwrap_or(usize::MAX))].to_vec())
    }
}

/// The samples of a header of two samples and a file beside it.
fn samples(fields: &str, data: &[u8]) -> Result<[f32; 2], ReadError> {
    let context = ReadContext { siblings: Some(Arc::new(Beside(data.to_vec()))), ..ReadContext::named("a.mhd") };
    let header = format!("NDims = 3\nDimSize = 2 1 1\n{fields}\nElementDataFile = a.raw\n");
    let read = read(header.as_bytes(), format_by_id("mha").unwrap(), &context)?;
    let Geometry::VoxelGrid(grid) = &*read.shape.parts[0].geometry else { panic!("a grid") };
    Ok([0, 1].map(|at| grid.samples().get(at)))
}

/// The documentation of MetaIO: lengths of types, what comes before the samples, and -1 for the last bytes of the file.
#[test]
fn types_orders_and_what_comes_before_the_samples() {
    for (fields, data, wanted) in [
        ("ElementType = MET_UCHAR\nHeaderSize = 3", &b"???\x05\x06"[..], [5.0, 6.0]),
        ("ElementType = MET_UCHAR\nHeaderSize = -1", b"?????\x05\x06", [5.0, 6.0]),
        ("ElementType = MET_CHAR", b"\xff\x80", [-1.0, -128.0]),
        ("ElementType = MET_SHORT\nElementByteOrderMSB = True", b"\x01\x02\xff\xfe", [258.0, -2.0]),
        ("ElementType = MET_SHORT\nBinaryDataByteOrderMSB = False", b"\x01\x02\xff\xfe", [513.0, -257.0]),
        ("ElementType = MET_USHORT\nBinaryDataByteOrderMSB = True", b"\x01\x02\xff\xfe", [258.0, 65534.0]),
        ("ElementType = MET_LONG", b"\x01\0\0\0\xfe\xff\xff\xff", [1.0, -2.0]),
        ("ElementType = MET_ULONG", b"\x01\0\0\0\0\0\0\x80", [1.0, 2_147_483_648.0]),
        ("ElementType = MET_LONG_LONG", b"\x01\0\0\0\0\0\0\0\xfe\xff\xff\xff\xff\xff\xff\xff", [1.0, -2.0]),
    ] {
        assert_eq!(samples(fields, data).unwrap_or_else(|error| panic!("{fields}: {error}")), wanted, "{fields}");
    }
}
