//! Reading raw samples.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place};
use shapeloom_voxels::Quantity;

use crate::memory::Memory;
use crate::text::{parse_count, parse_number, quoted};
use crate::volumes::{Coding, Frame, Packing, Payload, Room, Scalar, check_spacing, grid_shape};
use crate::{ByteOrder, Fault, ReadContext, ReadError, ReadOptions, ReadShape, ScalarType};

fn usage(name: &str, found: &str, expected: &str) -> Box<Fault> {
    let found = format!("the option {name} = {}", quoted(found.as_bytes()));
    Fault::new("E-volume-option", Place::Whole, found, expected).category(Category::Usage)
}

/// The three parts of a text such as `4x5x6`.
fn parts(text: &str) -> Option<[&str; 3]> {
    let mut parts = text.split(['x', '×', ',']).map(str::trim);
    let three = [parts.next()?, parts.next()?, parts.next()?];
    parts.next().is_none().then_some(three)
}

fn dimensions(options: &ReadOptions, bytes: usize) -> Result<[u64; 3], Box<Fault>> {
    let text = &options.dimensions;
    let advice = "say how many samples there are with --set dimensions=XxYxZ, such as 256x256x128, and of which type with \
                  --set scalar=TYPE where it is not u8";
    if text.is_empty() {
        let found = format!("{bytes} bytes without a header, and no option dimensions");
        let expected = "the option dimensions: how many samples there are along x, y and z";
        let fault = Fault::new("E-volume-option", Place::Whole, found, expected);
        return Err(fault.category(Category::Usage).advice(advice));
    }
    let wrong = || usage("dimensions", text, "three whole numbers, such as 256x256x128").advice(advice);
    let mut sizes = [0; 3];
    for (size, part) in sizes.iter_mut().zip(parts(text).ok_or_else(wrong)?) {
        *size = parse_count(part.as_bytes()).map_err(|_| wrong())?;
    }
    Ok(sizes)
}

/// The distances between samples that the options say.
///
/// # Errors
/// A text of another form, or numbers that are not above 0.
pub(crate) fn voxel_size(options: &ReadOptions) -> Result<DVec3, Box<Fault>> {
    let text = &options.voxel_size;
    let wrong = || usage("voxel_size", text, "one or three numbers above 0, such as 0.5x0.5x2");
    let number = |part: &str| parse_number(part.as_bytes()).map_err(|_| wrong());
    let size = match parts(text) {
        Some([x, y, z]) => DVec3::new(number(x)?, number(y)?, number(z)?),
        None => DVec3::splat(number(text.trim())?),
    };
    check_spacing(size, Place::Whole, "voxel_size").map_err(|_| wrong())?;
    Ok(size)
}

fn scalar_of(scalar: ScalarType) -> Scalar {
    match scalar {
        ScalarType::I8 => Scalar::I8,
        ScalarType::U8 => Scalar::U8,
        ScalarType::I16 => Scalar::I16,
        ScalarType::U16 => Scalar::U16,
        ScalarType::I32 => Scalar::I32,
        ScalarType::U32 => Scalar::U32,
        ScalarType::I64 => Scalar::I64,
        ScalarType::U64 => Scalar::U64,
        ScalarType::F32 => Scalar::F32,
        ScalarType::F64 => Scalar::F64,
    }
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let options = &context.options;
    let sizes = dimensions(options, input.len())?;
    let frame = Frame::turned(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z], voxel_size(options)?);
    let scalar = scalar_of(options.scalar);
    let payload = Payload::attached(input, 0);
    let room = Room {
        bytes: payload.len().saturating_sub(u64::from(options.skip)),
        most_from_a_byte: 1,
        size: scalar.size() as u64,
        stored_size: scalar.stored_size() as u64,
    };
    let dimensions = room.check(sizes, Place::Whole, "option dimensions", &payload, context).map_err(|fault| {
        let ours = ["E-volume-claim", "E-volume-truncated"].contains(&fault.code);
        let advice = "mend the options dimensions, scalar and skip, or get a complete copy of the file";
        if ours { fault.advice(advice) } else { fault }
    })?;
    let lattice = frame.lattice(dimensions, Place::Whole)?;
    let coding = Coding {
        packing: Packing::Plain,
        scalar,
        big: options.byte_order == ByteOrder::Big,
        skip: u64::from(options.skip),
    };
    let samples = payload.samples(lattice.samples(), &coding, context, &mut memory, &mut findings)?;
    let shape = grid_shape(lattice, samples, Quantity::Density, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}
