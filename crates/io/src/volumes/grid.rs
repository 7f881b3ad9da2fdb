//! Sizes that are checked before anything is made, and grids made of samples.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Affine, Category, Findings, Place, Severity, Words};
use shapeloom_shape::{Part, Shape};
use shapeloom_voxels::isosurface::Lattice;
use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

use super::Payload;
use crate::{Fault, ReadContext};

/// What a size is checked against.
pub(crate) struct Room {
    /// The bytes that hold the samples, packed or not.
    pub(crate) bytes: u64,
    /// How many unpacked bytes one of them gives at most.
    pub(crate) most_from_a_byte: u64,
    /// The bytes of a sample when unpacked, and in memory.
    pub(crate) size: u64,
    pub(crate) stored_size: u64,
}

impl Room {
    /// Checks a size as [`check_size`] does; a file that merely lost its end is told as cut off.
    ///
    /// # Errors
    /// As [`check_size`].
    pub(crate) fn check(
        &self,
        dimensions: [u64; 3],
        place: Place,
        within: &str,
        payload: &Payload<'_>,
        context: &ReadContext,
    ) -> Result<[u32; 3], Box<Fault>> {
        let count = dimensions.iter().fold(1u128, |product, size| product.saturating_mul(u128::from(*size)));
        let wanted = count.saturating_mul(u128::from(self.size));
        check_size(dimensions, self, place, within, context).map_err(|fault| {
            // One that has less than half of it never had it.
            let nearly = wanted <= 2 * u128::from(self.bytes) * u128::from(self.most_from_a_byte);
            if fault.code != "E-volume-claim" || !nearly || self.most_from_a_byte > 1 {
                return fault;
            }
            let found = format!("{} bytes", self.bytes);
            let expected = format!("{wanted} bytes for {count} samples");
            let end = payload.place(payload.len());
            Fault::new("E-volume-truncated", end, found, expected).within(payload.name.clone())
        })
    }
}

/// Checks the size that a header claims against what follows and against the limits, before memory is taken.
///
/// # Errors
/// No samples in a direction; more than can be in the bytes that follow; more than the limits allow for compressed samples
/// of so many bytes, or than any lattice has.
pub(crate) fn check_size(
    dimensions: [u64; 3],
    room: &Room,
    place: Place,
    within: &str,
    context: &ReadContext,
) -> Result<[u32; 3], Box<Fault>> {
    let found = || format!("{} × {} × {} samples", dimensions[0], dimensions[1], dimensions[2]);
    let fault = |code, expected: String| Fault::new(code, place.clone(), found(), expected).within(within);
    if dimensions.contains(&0) {
        return Err(fault("E-volume-size", "at least one in each direction".into()));
    }
    let count = dimensions.iter().try_fold(1u64, |product, size| product.checked_mul(*size));
    let most = u128::from(room.bytes) * u128::from(room.most_from_a_byte) / u128::from(room.size.max(1));
    let Some(count) = count.filter(|count| u128::from(*count) <= most) else {
        return Err(fault("E-volume-claim", format!("at most {most}, as many as can be in {} bytes", room.bytes)));
    };
    // What a kilobyte unpacks to is limited whatever the header says; large files may have as much as they are large.
    let in_proportion = room.bytes.max(room.bytes.saturating_mul(32) / room.stored_size.max(1));
    let most = context.limits.max_samples.max(in_proportion).min(context.limits.max_elements).min(1 << 40);
    let limit = |most| fault("E-volume-limit", format!("at most {most}")).category(Category::OverLimit);
    if count > most {
        return Err(limit(most));
    }
    if dimensions[0] * dimensions[1] > 1 << 31 {
        return Err(limit(1 << 31).within(format!("{within}, a slab of which")));
    }
    Ok(dimensions.map(|size| u32::try_from(size).unwrap_or(u32::MAX)))
}

/// Where samples are, as a header has it.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: DVec3,
    pub(crate) steps: [DVec3; 3],
}

impl Frame {
    /// Steps of these lengths in these directions.
    pub(crate) fn turned(origin: DVec3, directions: [DVec3; 3], spacing: DVec3) -> Self {
        let scaled = |axis: usize| {
            // Products with 0 and 1 keep their bits, but for the sign of zero.
            let direction = directions[axis];
            direction * spacing[axis]
        };
        Self { origin, steps: [scaled(0), scaled(1), scaled(2)] }
    }

    /// The same with the first sample moved by so many steps.
    pub(crate) fn moved(mut self, steps: DVec3) -> Self {
        if steps != DVec3::ZERO {
            self.origin += self.steps[0] * steps.x + self.steps[1] * steps.y + self.steps[2] * steps.z;
        }
        self
    }

    /// The lattice of as many samples.
    ///
    /// # Errors
    /// Steps that are no numbers, 0 or lie in one plane, places that are no numbers, or so large that neighbours are at the
    /// same one.
    pub(crate) fn lattice(&self, dimensions: [u32; 3], place: Place) -> Result<Lattice, Box<Fault>> {
        let wrong = |found: String| {
            Fault::new("E-volume-grid", place.clone(), found, "three directions with finite places and steps")
        };
        let placement =
            Affine { linear: DMat3::from_cols(self.steps[0], self.steps[1], self.steps[2]), translation: self.origin };
        let lattice = Lattice::try_new(dimensions, placement).map_err(|error| {
            let steps = self.steps.map(|step| format!("({}, {}, {})", Words(step.x), Words(step.y), Words(step.z)));
            let error = error.to_string();
            let what = error.split(": ").nth(1).and_then(|rest| rest.split(", expected").next()).unwrap_or(&error);
            wrong(format!("{}: steps {}", what.trim_start_matches("found "), steps.join(", ")))
        })?;
        let far = lattice.bounds();
        let largest = far.min.abs().max(far.max.abs());
        let reach = self.steps.iter().fold(DVec3::ZERO, |most, step| most.max(step.abs()));
        if !largest.is_finite() || (0..3).any(|axis| reach[axis] > 0.0 && reach[axis] < largest[axis] * f64::EPSILON) {
            return Err(wrong("places so large that neighbouring samples would be at the same one".into()));
        }
        Ok(lattice)
    }
}

/// Checks that spacings are above 0 and finite.
///
/// # Errors
/// The first that is not.
pub(crate) fn check_spacing(spacing: DVec3, place: Place, within: &str) -> Result<(), Box<Fault>> {
    for axis in 0..3 {
        if !(spacing[axis] > 0.0 && spacing[axis].is_finite()) {
            let found = format!("{} along {}", Words(spacing[axis]), ["x", "y", "z"][axis]);
            return Err(Fault::new("E-volume-spacing", place, found, "a finite number above 0").within(within));
        }
    }
    Ok(())
}

/// The quantity of that name, which files of this project say; density for all others.
pub(crate) fn quantity_of(name: &[u8]) -> Quantity {
    [Quantity::Occupancy, Quantity::SignedDistance]
        .into_iter()
        .find(|quantity| quantity.name().as_bytes() == name)
        .unwrap_or(Quantity::Density)
}

/// A shape of one grid. Occupancy of bytes 0 and 1 becomes bits.
///
/// # Errors
/// The lattice has another number of samples, which its readers rule out.
pub(crate) fn grid_shape(
    lattice: Lattice,
    samples: Samples,
    quantity: Quantity,
    findings: &mut Findings,
) -> Result<Shape, Box<Fault>> {
    let (samples, quantity) = match (samples, quantity) {
        (Samples::U8(bytes), Quantity::Occupancy) => match bits_of(&bytes) {
            Some(words) => (Samples::Bits(words), quantity),
            None => (Samples::U8(bytes), not_occupancy(findings)),
        },
        (samples @ Samples::Bits(_), quantity) => (samples, quantity),
        (samples, Quantity::Occupancy) => (samples, not_occupancy(findings)),
        (samples, quantity) => (samples, quantity),
    };
    let grid = VoxelGrid::try_new(lattice, samples, quantity)
        .map_err(|error| Fault::new("E-volume-grid", Place::Whole, error.to_string(), "as many samples as places"))?;
    Ok(Shape::new(Part::new(grid)))
}

fn not_occupancy(findings: &mut Findings) -> Quantity {
    let message = "the file calls its samples occupancy, but not all are 0 or 1: they were taken as density";
    findings.push("W-volume-quantity", Severity::Warning, Place::Whole, message);
    Quantity::Density
}

/// Bytes of 0 and 1 as bits; none if there are others.
fn bits_of(bytes: &[u8]) -> Option<Vec<u64>> {
    bytes
        .chunks(64)
        .map(|chunk| {
            let word = chunk.iter().enumerate().fold(0u64, |word, (at, &byte)| word | u64::from(byte & 1) << at);
            chunk.iter().all(|&byte| byte <= 1).then_some(word)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked_before_anything_is_made() {
        let context = ReadContext::default();
        let check = |dimensions, bytes, ratio| {
            let room = Room { bytes, most_from_a_byte: ratio, size: 2, stored_size: 2 };
            check_size(dimensions, &room, Place::Whole, "sizes", &context).map_err(|fault| fault.code)
        };
        assert_eq!(check([4, 5, 6], 240, 1), Ok([4, 5, 6]));
        for (dimensions, bytes, ratio, code) in [
            ([4, 5, 6], 239, 1, "E-volume-claim"),
            ([u64::MAX, 2, 1], 1000, 1032, "E-volume-claim"),
            ([1 << 32, 1 << 32, 1], u64::MAX, 1, "E-volume-claim"),
            ([0, 5, 6], 240, 1, "E-volume-size"),
            ([1 << 9, 1 << 9, 1 << 10], 1 << 20, 1032, "E-volume-limit"),
            ([1 << 20, 1 << 12, 1], u64::MAX, 1, "E-volume-limit"),
        ] {
            assert_eq!(check(dimensions, bytes, ratio), Err(code), "{dimensions:?}");
        }
        // As large as its file is.
        assert!(check([1 << 9, 1 << 9, 1 << 10], 1 << 25, 1032).is_ok());
    }

    #[test]
    fn occupancy_of_bytes_becomes_bits() {
        let lattice = Lattice::along_axes([5, 13, 1], DVec3::ZERO, DVec3::ONE).unwrap();
        let bytes: Vec<u8> = (0..65).map(|at| u8::from(at % 3 == 0)).collect();
        let mut findings = Findings::default();
        let shape = grid_shape(lattice, Samples::U8(bytes.clone()), Quantity::Occupancy, &mut findings).unwrap();
        let shapeloom_shape::Geometry::VoxelGrid(grid) = &*shape.parts[0].geometry else { panic!("a grid") };
        assert!(matches!(grid.samples(), Samples::Bits(_)) && findings.is_empty());
        assert!((0..65).all(|at| grid.samples().get(at) == f32::from(bytes[at as usize])));
        let shape = grid_shape(lattice, Samples::U8(vec![2; 65]), Quantity::Occupancy, &mut findings).unwrap();
        let shapeloom_shape::Geometry::VoxelGrid(grid) = &*shape.parts[0].geometry else { panic!("a grid") };
        assert_eq!((grid.quantity(), findings.iter().count()), (Quantity::Density, 1));
    }
}
