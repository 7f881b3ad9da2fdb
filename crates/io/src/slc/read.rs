//! Reading SLC.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_voxels::{Quantity, Samples};

use crate::memory::Memory;
use crate::text::Scanner;
use crate::volumes::{Frame, Room, check_size, check_spacing, grid_shape};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// A run gives at most 127 bytes for two.
const MOST_FROM_A_BYTE: u64 = 64;

/// A whole number, after any line ends.
fn count(scan: &mut Scanner<'_>, within: &str) -> Result<u64, Box<Fault>> {
    while scan.at_line_end() && scan.next_line() {}
    let (place, found) = (scan.place(), scan.found());
    scan.count().map_err(|_| Fault::new("E-slc-count", place, found, "a whole number in digits alone").within(within))
}

/// A number of bytes and the mark `X` after it.
fn marked(scan: &mut Scanner<'_>, within: &str) -> Result<u64, Box<Fault>> {
    while scan.at_line_end() && scan.next_line() {}
    let (place, found) = (scan.place(), scan.found());
    let wrong =
        |found: String| Fault::new("E-slc-count", place.clone(), found, "a number of bytes and an X").within(within);
    let digits = scan.rest().iter().take(20).take_while(|byte| byte.is_ascii_digit()).count();
    let number = crate::text::parse_count(&scan.rest()[..digits]).map_err(|_| wrong(found))?;
    scan.advance(digits);
    while matches!(scan.peek(), Some(b' ' | b'\n' | b'\r' | b'\t')) {
        scan.advance(1);
    }
    if scan.peek() != Some(b'X') {
        return Err(wrong(scan.found()));
    }
    scan.advance(1);
    Ok(number)
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let mut scan = Scanner::new(input, 0);
    let mark = scan.found();
    if count(&mut scan, "mark")? != 11111 {
        return Err(Fault::new("E-slc-magic", Place::Byte(0), mark, "11111").into());
    }
    let sizes_at = scan.place();
    let sizes = [count(&mut scan, "sizes")?, count(&mut scan, "sizes")?, count(&mut scan, "sizes")?];
    let place = scan.place();
    let bits = count(&mut scan, "bits")?;
    if bits != 8 {
        let fault = Fault::new("E-slc-feature", place, format!("{bits} bits a sample"), "8");
        return Err(fault.category(Category::Unsupported).into());
    }
    while scan.at_line_end() && scan.next_line() {}
    let spacing_at = scan.place();
    let mut spacing = DVec3::ZERO;
    for axis in 0..3 {
        let (place, found) = (scan.place(), scan.found());
        spacing[axis] = match scan.number() {
            Ok(value) => value,
            Err(fault) => {
                return Err(Fault::new("E-slc-number", place, found, fault.to_string()).within("distances").into());
            }
        };
    }
    check_spacing(spacing, spacing_at.clone(), "distances")?;
    for what in ["unit", "origin", "modification"] {
        count(&mut scan, what)?;
    }
    let place = scan.place();
    let packed = match count(&mut scan, "compression")? {
        0 => false,
        1 => true,
        other => {
            let fault = Fault::new("E-slc-feature", place, format!("the compression {other}"), "0 or 1");
            return Err(fault.category(Category::Unsupported).into());
        }
    };
    let place = scan.place();
    let width = count(&mut scan, "picture")?;
    let height = marked(&mut scan, "picture")?;
    let picture = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(3));
    let left = scan.rest().len() as u64;
    let picture = picture.filter(|bytes| *bytes <= left).ok_or_else(|| {
        let fault = Fault::new(
            "E-volume-claim",
            place,
            format!("a picture of {width} × {height}"),
            format!("at most {left} bytes"),
        );
        fault.within("picture")
    })?;
    scan.advance(picture as usize);
    let room = Room {
        bytes: scan.rest().len() as u64,
        most_from_a_byte: if packed { MOST_FROM_A_BYTE } else { 1 },
        size: 1,
        stored_size: 1,
    };
    let dimensions = check_size(sizes, &room, sizes_at, "sizes", context)?;
    let frame = Frame::turned(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z], spacing);
    let lattice = frame.lattice(dimensions, spacing_at)?;
    let slab = lattice.slab_len();
    let count = usize::try_from(lattice.samples()).unwrap_or(usize::MAX);
    memory.take(count, 1)?;
    let mut samples = Vec::with_capacity(count);
    if packed {
        for slice in 0..dimensions[2] {
            context.exec.check()?;
            context.exec.progress(f64::from(slice) / f64::from(dimensions[2]));
            unpack(&mut scan, slice, slab, &mut samples)?;
        }
    } else {
        for piece in scan.rest()[..count].chunks(1 << 20) {
            context.exec.check()?;
            samples.extend_from_slice(piece);
        }
        scan.advance(count);
    }
    while scan.at_line_end() && scan.next_line() {}
    if !scan.rest().is_empty() {
        let message = format!("{} bytes follow after the last slice; they were not read", scan.rest().len());
        findings.push("W-volume-trailing", Severity::Warning, scan.place(), message);
    }
    let shape = grid_shape(lattice, Samples::U8(samples), Quantity::Density, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}

/// Adds the samples of a slice.
fn unpack(scan: &mut Scanner<'_>, slice: u32, slab: usize, samples: &mut Vec<u8>) -> Result<(), Box<Fault>> {
    let within = format!("slice {slice}");
    let size = marked(scan, &within)?;
    let (start, left) = (scan.offset() as u64, scan.rest().len() as u64);
    let wanted = samples.len() + slab;
    if size > left {
        let found = format!("{left} bytes to the end of the file");
        return Err(Fault::new("E-volume-truncated", Place::Byte(start), found, format!("{size} bytes")).within(within));
    }
    let bytes = &scan.rest()[..size as usize];
    scan.advance(bytes.len());
    let mut at = 0;
    while let Some(&head) = bytes.get(at).filter(|head| **head & 0x7f != 0) {
        let run = usize::from(head & 0x7f);
        let literal = head & 0x80 != 0;
        let end = at + if literal { 1 + run } else { 2 };
        let own = bytes.get(at + 1..end);
        let own = own.filter(|_| samples.len() + run <= wanted).ok_or_else(|| {
            let found = format!("a run of {run} bytes past the end of the slice");
            Fault::new("E-volume-data", Place::Byte(start + at as u64), found, format!("{slab} samples"))
                .within(within.clone())
        })?;
        match own {
            [byte] if !literal => samples.resize(samples.len() + run, *byte),
            own => samples.extend_from_slice(own),
        }
        at = end;
    }
    if samples.len() < wanted {
        let found = format!("{} samples", slab - (wanted - samples.len()));
        return Err(Fault::new("E-volume-data", Place::Byte(start + at as u64), found, format!("{slab} samples"))
            .within(within));
    }
    Ok(())
}
