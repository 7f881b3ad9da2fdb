//! Binary OFF: big endian, whole numbers of 32 bits with sign, single precision.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Place, Severity};

use super::NO_INDEX;
use super::body::{Body, Layout};
use super::color::{Channel, stored};
use super::counts::{Counts, checked_dimension};
use super::header::Header;
use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// The bytes of every number.
const NUMBER: u64 = 4;

pub(super) fn read(input: &[u8], header: &Header, start: usize, context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut bytes = Bytes { input, at: start };
    let dimension = match header.dimensioned {
        false => 3,
        true => {
            let place = bytes.place();
            let found = bytes.count("the number of coordinates")?;
            checked_dimension(found, header, place, found.to_string())?
        }
    };
    // Colours of vertices always have four channels here.
    let layout = Layout::new(header, dimension, if header.color { 4 } else { 0 });
    let place = bytes.place();
    let vertices = bytes.count("the number of vertices")?;
    let faces = bytes.count("the number of faces")?;
    bytes.take("the number of edges")?;
    let counts = Counts { vertices, faces };
    let left = (input.len() - bytes.at) as u64;
    counts.check(layout.numbers() as u64 * NUMBER, 2 * NUMBER, left, &context.limits, place)?;

    let mut memory = Memory::new(&context.exec);
    let mut body = Body::default();
    body.reserve(&mut memory, &counts, &layout)?;
    for vertex in 0..vertices {
        if vertex % 4096 == 0 {
            context.exec.check()?;
        }
        bytes.vertex(vertex, &layout, context, &mut memory, &mut body)?;
    }
    let first_face = bytes.at;
    let mut corners = Vec::new();
    for face in 0..faces {
        if face % 4096 == 0 {
            context.exec.check()?;
        }
        bytes.face(face, &counts, context, &mut memory, &mut body, &mut corners)?;
    }
    if bytes.at < input.len() {
        let message = format!("{} bytes follow after the last face; they were not read", input.len() - bytes.at);
        body.findings.push("W-off-trailing", Severity::Warning, bytes.place(), message);
    }
    let place = |face: usize| place_of_face(input, first_face, face);
    body.into_shape(&layout, &mut memory, context, place)
}

struct Bytes<'a> {
    input: &'a [u8],
    at: usize,
}

impl Bytes<'_> {
    fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    #[inline]
    fn take(&mut self, what: &str) -> Result<[u8; 4], Box<Fault>> {
        match self.input.get(self.at..self.at + 4).and_then(|bytes| bytes.try_into().ok()) {
            Some(bytes) => {
                self.at += 4;
                Ok(bytes)
            }
            None => {
                let place = Place::Byte(self.input.len() as u64);
                let fault = Fault::new("E-off-truncated", place, "the end of the file", what);
                Err(fault.advice("get the file again"))
            }
        }
    }

    #[inline]
    fn count(&mut self, what: &str) -> Result<u64, Box<Fault>> {
        let number = i32::from_be_bytes(self.take(what)?);
        u64::try_from(number).map_err(|_| {
            let place = Place::Byte(self.at as u64 - NUMBER);
            Fault::new("E-off-count", place, number.to_string(), format!("{what}, not below zero"))
        })
    }

    #[inline]
    fn float(&mut self, what: &str) -> Result<f64, Box<Fault>> {
        Ok(f64::from(f32::from_be_bytes(self.take(what)?)))
    }

    fn vertex(
        &mut self,
        vertex: u64,
        layout: &Layout,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        body: &mut Body,
    ) -> Result<(), ReadError> {
        let place = self.place();
        let mut numbers = [0.0; 13];
        let numbers = &mut numbers[..layout.numbers()];
        for number in &mut *numbers {
            *number = self.float("the numbers of a vertex")?;
        }
        let within = || format!("vertex {vertex}");
        let spatial = layout.dimension + usize::from(layout.weight);
        if let Some(odd) = numbers[..spatial].iter().find(|number| !number.is_finite())
            && !context.options.drop_non_finite
        {
            let fault = Fault::new("E-off-finite", place, odd.to_string(), "finite numbers").within(within());
            return Err(fault.advice(crate::audit::DROP_ADVICE).into());
        }
        let mut position = [0.0; 3];
        position[..layout.dimension].copy_from_slice(&numbers[..layout.dimension]);
        let mut position = DVec3::from_array(position);
        if layout.weight {
            let weight = numbers[layout.dimension];
            if weight == 0.0 {
                let fault = Fault::new("E-off-weight", place, "the weight 0", "a homogeneous weight that is not zero");
                return Err(fault.within(within()).advice("a point of weight 0 is infinitely far away").into());
            }
            position /= weight;
        }
        body.positions.push(memory, position)?;
        let beside = &mut numbers[spatial..];
        let colors = layout.color_at()..layout.color_at() + layout.color;
        if beside.iter().enumerate().any(|(at, number)| !number.is_finite() && !colors.contains(&at)) {
            body.odd_numbers(place.clone());
        }
        if layout.color > 0 {
            let color = &mut beside[colors];
            let channels: [Channel; 4] = std::array::from_fn(|index| Channel::Fraction(color[index]));
            let Some(found) = stored(&channels) else {
                let fault = Fault::new("E-off-color", place, "a colour outside of its range", "fractions from 0");
                return Err(fault.within(within()).into());
            };
            if found[0].is_nan() {
                body.odd_color(place);
            } else {
                body.vertex_colors.note(&channels);
            }
            color.copy_from_slice(&found[..layout.color]);
        }
        Ok(body.beside.extend(memory, beside)?)
    }

    fn face(
        &mut self,
        face: u64,
        counts: &Counts,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        body: &mut Body,
        corners: &mut Vec<u32>,
    ) -> Result<(), ReadError> {
        let place = self.place();
        let within = || format!("face {face}");
        let count = self.count("the number of corners of a face")?;
        let left = (self.input.len() - self.at) as u64;
        if count * NUMBER > left {
            let found = format!("a face of {count} corners");
            let expected = format!("no more than the {left} bytes that follow can hold");
            return Err(Fault::new("E-off-claim", place, found, expected).within(within()).into());
        }
        let most = u64::from(context.limits.max_polygon);
        if count > most {
            let fault = Fault::new("E-off-limit", place, format!("{count} corners"), format!("at most {most} corners"));
            return Err(fault.category(Category::OverLimit).within(within()).into());
        }
        corners.clear();
        for _ in 0..count {
            let corner = i32::from_be_bytes(self.take("the number of a vertex")?);
            match u32::try_from(corner) {
                Ok(corner) if u64::from(corner) < counts.vertices => corners.push(corner),
                _ => {
                    let place = Place::Byte(self.at as u64 - NUMBER);
                    let expected = format!("the number of one of {} vertices, counted from 0", counts.vertices);
                    let fault = Fault::new("E-off-index", place, corner.to_string(), expected);
                    return Err(fault.within(within()).into());
                }
            }
        }
        self.color(memory, body, count >= 3).map_err(|error| match error {
            ReadError::Input(fault) => fault.within(within()).into(),
            error => error,
        })?;
        if count < 3 {
            return body.skip(memory, place, count);
        }
        body.faces.push(memory, corners)
    }

    /// The number of channels of a colour, and the channels.
    fn color(&mut self, memory: &mut Memory<'_>, body: &mut Body, keep: bool) -> Result<(), ReadError> {
        let place = self.place();
        let channels = self.count("the number of channels of a colour")?;
        let mut found = [Channel::Fraction(0.0); 4];
        match channels {
            0 => {}
            1 => {
                let index = self.float("an index into a colour map")?;
                if index.fract() != 0.0 || !(0.0..f64::from(NO_INDEX)).contains(&index) {
                    let fault = Fault::new("E-off-color", place, index.to_string(), "an index into a colour map");
                    return Err(fault.into());
                }
                if keep {
                    body.put_index(memory, index as u32)?;
                }
            }
            3 | 4 => {
                let found = &mut found[..channels as usize];
                for channel in &mut *found {
                    *channel = Channel::Fraction(self.float("a channel of a colour")?);
                }
                let Some(color) = stored(found) else {
                    let fault = Fault::new("E-off-color", place, "a colour outside of its range", "fractions from 0");
                    return Err(fault.into());
                };
                if color[0].is_nan() {
                    body.odd_color(place);
                } else if keep {
                    let face = body.faces.len();
                    body.face_colors.put(memory, face, color, found)?;
                }
            }
            other => {
                let expected = "0, 1, 3 or 4 channels of a colour";
                return Err(Fault::new("E-off-row", place, other.to_string(), expected).into());
            }
        }
        Ok(())
    }
}

/// Where a face of a file that was read begins.
fn place_of_face(input: &[u8], first: usize, face: usize) -> Place {
    let mut bytes = Bytes { input, at: first };
    for _ in 0..face {
        for _ in 0..2 {
            let count = bytes.count("").unwrap_or(0) as usize;
            bytes.at += count * NUMBER as usize;
        }
    }
    bytes.place()
}
