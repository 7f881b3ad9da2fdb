//! Reading USGS DEM.

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Findings, Loss, Place, Severity, Words};
use shapeloom_shape::Units;

use super::header::{Block, Ground, Header};
use crate::heights::{DEGREES, NorthFirst, check_options, check_size, room, shape_of};
use crate::memory::{Growing, Memory};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// The international foot in metres.
const FOOT: f64 = 0.3048;

/// What a sample without a height has.
const VOID: i64 = -32767;

/// A profile as it is in the file.
#[derive(Clone, Copy, Debug)]
struct Profile {
    /// Its first sample.
    first: DVec2,
    /// Its heights among all.
    start: usize,
    count: usize,
    /// Where its record begins.
    offset: usize,
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    check_options(&context.options)?;
    let mut findings = Findings::default();
    let Some((block, next)) = Block::at(input, 0) else {
        return Err(
            Fault::new("E-dem-truncated", Place::Byte(0), "the end of the file", "a record A of 1024 bytes").into()
        );
    };
    let header = Header::read(&block)?;
    let mut memory = Memory::new(&context.exec);
    let mut profiles = Profiles::default();
    profiles.read(input, next, &header, context, &mut memory)?;
    let grid = profiles.grid(&header, input.len(), context, &mut memory, &mut findings)?;
    say(&header, &grid, &profiles, &mut findings);
    let field = grid.into_field(context, &mut findings)?;
    let mut shape = shape_of(field);
    for part in &mut shape.parts {
        part.name.clone_from(&header.name);
    }
    shape.units = match header.ground {
        Ground::Meters => Some(Units::METERS),
        Ground::Feet => Units::from_meters(FOOT).ok(),
        Ground::Radians | Ground::ArcSeconds => None,
    };
    let losses = vec![Loss::new("map projection and accuracy", "shapes have no place for them")];
    Ok(ReadShape { findings, losses, ..ReadShape::new(shape) })
}

/// What is odd about units and heights.
fn say(header: &Header, grid: &NorthFirst, profiles: &Profiles, findings: &mut Findings) {
    let place = Place::Byte(528);
    match header.ground {
        Ground::Radians | Ground::ArcSeconds => {
            let unit = if header.ground == Ground::Radians { "radians" } else { "seconds of arc" };
            let message = format!("places are in {unit}: {DEGREES}");
            findings.push("W-heights-degrees", Severity::Warning, place, message);
        }
        Ground::Feet if !header.feet => {
            let message = "heights in metres were turned into feet, as places are";
            findings.push("W-dem-units", Severity::Note, place, message);
        }
        Ground::Meters if header.feet => {
            let message = "heights in feet were turned into metres, as places are";
            findings.push("W-dem-units", Severity::Note, place, message);
        }
        Ground::Feet | Ground::Meters => {}
    }
    let factor = height_factor(header);
    let known = grid.heights.iter().filter(|height| !height.is_nan());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(*height), high.max(*height)));
    let [said_low, said_high] = header.range;
    // Heights are whole steps.
    let step = header.resolution[2] * factor;
    if low <= high && ((low - said_low * factor).abs() > step || (high - said_high * factor).abs() > step) {
        let message = format!(
            "the heights are from {} to {}, the header says from {} to {}",
            Words(low),
            Words(high),
            Words(said_low * factor),
            Words(said_high * factor)
        );
        findings.push("W-dem-range", Severity::Warning, Place::Byte(738), message);
    }
    if profiles.off_grid > 0.01 {
        let message = format!(
            "profiles lie up to {:.3} of a step beside the grid; their samples were moved to the nearest places of it",
            profiles.off_grid
        );
        findings.push("W-dem-grid", Severity::Warning, Place::Byte(816), message);
    }
}

/// What heights are multiplied by to be in the unit of places.
fn height_factor(header: &Header) -> f64 {
    match (header.ground, header.feet) {
        (Ground::Meters, true) => FOOT,
        (Ground::Feet, false) => 1.0 / FOOT,
        // In angles there is no such unit: metres.
        (Ground::Radians | Ground::ArcSeconds, true) => FOOT,
        _ => 1.0,
    }
}

#[derive(Default)]
struct Profiles {
    all: Growing<Profile>,
    heights: Growing<f64>,
    /// How far the farthest profile is beside the grid, in steps of it.
    off_grid: f64,
}

impl Profiles {
    fn read(
        &mut self,
        input: &[u8],
        mut at: usize,
        header: &Header,
        context: &ReadContext,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let factor = height_factor(header);
        for number in 0..header.profiles {
            context.exec.check()?;
            context.exec.progress(at as f64 / input.len().max(1) as f64);
            let truncated = |wanted: String| {
                let found = format!("the end of the file after {number} complete profiles");
                let place = Place::Byte(input.len() as u64);
                let expected = format!("{wanted} and {} profiles as the header says", header.profiles);
                Fault::new("E-dem-truncated", place, found, expected)
            };
            let (mut block, mut next) = Block::at(input, at).ok_or_else(|| truncated("a record B".into()))?;
            let offset = block.start;
            let count = block.integer(12, 6, "number of samples")?;
            let across = block.integer(18, 6, "number of samples across")?;
            let place = |column: u64| Place::Byte(offset as u64 + column);
            let within = |fault: Box<Fault>| fault.within(format!("profile {number}"));
            if across != 1 {
                let fault =
                    Fault::new("E-dem-profile", place(18), across.to_string(), "1, as profiles are one sample wide");
                return Err(within(fault).into());
            }
            let count = usize::try_from(count).ok().filter(|count| *count > 0 && *count <= input.len() / 6 + 1);
            let count = count.ok_or_else(|| {
                let found = format!("{} samples", block.integer(12, 6, "").unwrap_or(0));
                within(Fault::new("E-dem-claim", place(12), found, "a number above 0 that can be in the file"))
            })?;
            let first = DVec2::new(block.real(24, 24, "first place, x")?, block.real(48, 24, "first place, y")?);
            let datum = block.real(72, 24, "height of the datum")?;
            let start = self.heights.len();
            let mut column = 144;
            let mut left = Block::heights_after(column);
            for sample in 0..count {
                if left == 0 {
                    context.exec.check()?;
                    let more = Block::at(input, next);
                    (block, next) = more.ok_or_else(|| truncated(format!("{count} samples of profile {number}")))?;
                    (column, left) = (0, Block::heights_after(0));
                }
                let step = block.integer(column, 6, "height").map_err(|fault| {
                    // A block that is not complete is the last one.
                    if block.start + column + 6 > input.len() {
                        truncated(format!("{count} samples of profile {number}"))
                    } else {
                        fault.within(format!("profile {number}, sample {sample}"))
                    }
                })?;
                let height =
                    if step == VOID { f64::NAN } else { (datum + step as f64 * header.resolution[2]) * factor };
                self.heights.push(memory, height)?;
                column += 6;
                left -= 1;
            }
            self.all.push(memory, Profile { first, start, count, offset })?;
            at = next;
        }
        Ok(())
    }

    /// The profiles as columns of one grid, with holes where they do not reach.
    fn grid(
        &mut self,
        header: &Header,
        bytes: usize,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<NorthFirst, ReadError> {
        let spacing = DVec2::new(header.resolution[0], header.resolution[1]);
        let firsts = self.all.as_slice().iter().map(|profile| profile.first);
        let low = firsts.fold(DVec2::INFINITY, DVec2::min);
        // Steps from the south-western corner; what is beyond every limit stays there.
        let step = |profile: &Profile| (profile.first - low) / spacing;
        let (mut columns, mut rows) = (0u64, 0u64);
        for profile in self.all.as_slice() {
            let steps = step(profile);
            columns = columns.max((steps.x.round() as u64).saturating_add(1));
            rows = rows.max((steps.y.round() as u64).saturating_add(profile.count as u64));
            let beside = (steps - steps.round()).abs().max_element();
            self.off_grid = self.off_grid.max(beside);
        }
        // Quadrangles lean by a few degrees: a grid of mostly holes has profiles that are nowhere near each other.
        let most = 16 * self.heights.len() as u64 + 4096;
        if columns.checked_mul(rows).is_none_or(|count| count > most) {
            let found = format!("profiles spread over {columns} × {rows} places");
            let expected = format!("at most {most} for {} samples", self.heights.len());
            return Err(Fault::new("E-dem-spread", Place::Byte(816), found, expected).into());
        }
        let size = check_size(columns, rows, Place::Byte(858), "number of profiles", bytes, context)?;
        let count = (columns * rows) as usize;
        let mut heights = room(count, memory)?;
        heights.resize(count, f64::NAN);
        let (mut twice, mut twice_at) = (0u64, 0usize);
        let mut taken = Growing::with_room(memory, size.0 as usize)?;
        taken.extend_exact(memory, (0..size.0).map(|_| false))?;
        for profile in self.all.as_slice() {
            context.exec.check()?;
            let steps = step(profile).round();
            let (column, south) = (steps.x as usize, steps.y as usize);
            if std::mem::replace(&mut taken.as_mut_slice()[column], true) {
                (twice, twice_at) = (twice + 1, profile.offset);
            }
            let samples = &self.heights.as_slice()[profile.start..profile.start + profile.count];
            for (sample, &height) in samples.iter().enumerate() {
                let row = rows as usize - 1 - (south + sample);
                heights[row * columns as usize + column] = height;
            }
        }
        if twice > 0 {
            let message = format!("{twice} profiles lie on others: the later one counts");
            findings.push("W-dem-twice", Severity::Warning, Place::Byte(twice_at as u64), message);
        }
        Ok(NorthFirst { columns: size.0, rows: size.1, spacing, south_west: low, heights })
    }
}
