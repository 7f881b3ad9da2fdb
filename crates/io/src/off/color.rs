//! Colours as bytes or fractions.

use shapeloom_core::OverBudget;
use shapeloom_mesh::{COLOR, Column, Values};

use crate::memory::{Growing, Memory};

/// The channel of a face without a colour among others that have one, as Geomview takes it: two thirds.
pub(super) const GREY: f64 = 170.0;
/// That of a vertex without a colour among others that have one.
pub(super) const WHITE: f64 = 255.0;

/// A channel of a colour as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Channel {
    /// A whole number.
    Whole(u64),
    /// A number with a point or an exponent.
    Fraction(f64),
}

/// A colour on its way: fractions as they are, bytes below zero, so that one number tells which it is; no number where
/// there is none, and where a channel is not finite. Whole numbers of which none is above 1 are the same in both.
pub(super) fn stored(channels: &[Channel]) -> Option<[f64; 4]> {
    let mut color = [f64::NAN; 4];
    if channels.iter().any(|channel| matches!(channel, Channel::Fraction(fraction) if !fraction.is_finite())) {
        return Some(color);
    }
    let bytes = channels.iter().all(|channel| matches!(channel, Channel::Whole(_)))
        && channels.iter().any(|channel| matches!(channel, Channel::Whole(2..)));
    for (stored, channel) in color.iter_mut().zip(channels) {
        *stored = match *channel {
            Channel::Whole(256..) => return None,
            Channel::Whole(byte) if bytes => -1.0 - byte as f64,
            Channel::Whole(number) => number as f64,
            Channel::Fraction(fraction) if fraction >= 0.0 => fraction,
            Channel::Fraction(_) => return None,
        };
    }
    Some(color)
}

/// What is known of many colours.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    /// There is some colour.
    pub any: bool,
    /// Some number has a point or an exponent.
    pub fractions: bool,
    /// Some colour is in bytes beyond 1.
    pub bytes: bool,
    /// Some fraction is above 1.
    pub bright: bool,
    /// Some colour has four channels.
    pub alpha: bool,
}

impl Seen {
    pub(super) fn note(&mut self, channels: &[Channel]) {
        for channel in channels {
            match *channel {
                Channel::Whole(number) => self.bytes |= number > 1,
                Channel::Fraction(fraction) => {
                    self.fractions = true;
                    self.bright |= fraction > 1.0;
                }
            }
        }
        self.any = true;
        self.alpha |= channels.len() == 4;
    }

    pub(super) fn join(&mut self, other: Self) {
        self.any |= other.any;
        self.fractions |= other.fractions;
        self.bytes |= other.bytes;
        self.bright |= other.bright;
        self.alpha |= other.alpha;
    }
}

/// The column of colours stored so, `missing` in bytes where there is none; `whole_bytes` says what whole numbers are of
/// which none is above 1.
pub(super) fn column<'c>(
    colors: impl ExactSizeIterator<Item = &'c [f64]>,
    seen: Seen,
    whole_bytes: bool,
    missing: f64,
    memory: &mut Memory<'_>,
) -> Result<Option<Column>, OverBudget> {
    let width = if seen.alpha { 4 } else { 3 };
    let bytes = !seen.fractions && (seen.bytes || whole_bytes);
    let count = colors.len() * width;
    memory.take(count, if bytes { 1 } else { size_of::<f64>() })?;
    let channel = |color: &[f64], index: usize| {
        let stored = color.get(index).copied().unwrap_or(f64::NAN);
        match (stored.is_nan(), index) {
            // A colour of three channels is opaque.
            (true, 3) => -1.0 - 255.0,
            (true, _) => -1.0 - missing,
            (false, _) => stored,
        }
    };
    let colors = colors.flat_map(|color| (0..width).map(move |index| channel(color, index)));
    let values = if bytes {
        let mut values = Vec::with_capacity(count);
        values.extend(colors.map(|stored| if stored < 0.0 { -1.0 - stored } else { stored } as u8));
        Values::U8(values)
    } else {
        let mut values = Vec::with_capacity(count);
        values.extend(colors.map(|stored| if stored < 0.0 { (-1.0 - stored) / 255.0 } else { stored }));
        Values::F64(values)
    };
    Ok(Column::try_new(COLOR, width, values).ok())
}

/// The colours of faces, from the first that has one.
#[derive(Debug, Default)]
pub(super) struct FaceColors {
    colors: Growing<[f64; 4]>,
    pub seen: Seen,
    /// Faces that have one.
    pub count: usize,
}

impl FaceColors {
    /// The colour of the face of that number; faces before it that have none yet have none.
    pub(super) fn put(
        &mut self,
        memory: &mut Memory<'_>,
        face: usize,
        color: [f64; 4],
        channels: &[Channel],
    ) -> Result<(), OverBudget> {
        self.fill(memory, face)?;
        self.seen.note(channels);
        self.count += 1;
        self.colors.push(memory, color)
    }

    fn fill(&mut self, memory: &mut Memory<'_>, faces: usize) -> Result<(), OverBudget> {
        while self.colors.len() < faces {
            self.colors.push(memory, [f64::NAN; 4])?;
        }
        Ok(())
    }

    /// Adds those of another list of faces behind these, which are as many as `faces`.
    pub(super) fn append(&mut self, memory: &mut Memory<'_>, faces: usize, other: &Self) -> Result<(), OverBudget> {
        if other.count > 0 {
            self.fill(memory, faces)?;
            self.colors.extend(memory, other.colors.as_slice())?;
            self.seen.join(other.seen);
            self.count += other.count;
        }
        Ok(())
    }

    /// The column, if any face has a colour.
    pub(super) fn column(&mut self, memory: &mut Memory<'_>, faces: usize) -> Result<Option<Column>, OverBudget> {
        if self.count == 0 {
            return Ok(None);
        }
        self.fill(memory, faces)?;
        column(self.colors.as_slice().iter().map(|color| &color[..]), self.seen, true, GREY, memory)
    }
}
