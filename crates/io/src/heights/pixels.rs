//! Channels of pixels made heights.

use shapeloom_core::{Findings, Place, Severity};

use crate::{Fault, HeightEncoding};

/// What the numbers of a pixel are, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channels {
    Grey,
    GreyAlpha,
    Rgb,
    Rgba,
}

impl Channels {
    pub(crate) fn count(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::GreyAlpha => 2,
            Self::Rgb => 3,
            Self::Rgba => 4,
        }
    }
}

/// Takes pixels of a picture one after another and gives heights, or numbers from which heights follow by one factor.
pub(crate) struct Pixels {
    encoding: HeightEncoding,
    channels: Channels,
    columns: usize,
    /// The largest value of a channel.
    full: u32,
    seen: usize,
    /// Pixels between transparent and opaque.
    translucent: u64,
}

impl Pixels {
    /// # Errors
    /// An encoding in colours for a picture without, or of another depth than 8 bits.
    pub(crate) fn try_new(
        encoding: HeightEncoding,
        channels: Channels,
        full: u32,
        columns: u32,
    ) -> Result<Self, Box<Fault>> {
        let colored = matches!(channels, Channels::Rgb | Channels::Rgba);
        if encoding != HeightEncoding::Grey && !(colored && full == 255) {
            let found = if colored { "colours of 16 bits" } else { "shades of grey" };
            let expected = "colours of 8 bits, as the option encoding says";
            return Err(Fault::new("E-heights-channels", Place::Whole, found, expected)
                .advice("read it with --set encoding=grey"));
        }
        Ok(Self { encoding, channels, columns: columns as usize, full, seen: 0, translucent: 0 })
    }

    /// The height of the next pixel; not a number where it is transparent.
    ///
    /// # Errors
    /// A colour where shades of grey are expected.
    #[inline]
    pub(crate) fn height(&mut self, pixel: &[u32]) -> Result<f64, Box<Fault>> {
        self.seen += 1;
        let (color, alpha) = match (self.channels, pixel) {
            (Channels::Grey, &[grey]) => ([grey; 3], self.full),
            (Channels::GreyAlpha, &[grey, alpha]) => ([grey; 3], alpha),
            (Channels::Rgb, &[red, green, blue]) => ([red, green, blue], self.full),
            (Channels::Rgba, &[red, green, blue, alpha]) => ([red, green, blue], alpha),
            _ => ([0; 3], 0),
        };
        if alpha == 0 {
            return Ok(f64::NAN);
        }
        self.translucent += u64::from(alpha != self.full);
        let [red, green, blue] = color;
        match self.encoding {
            HeightEncoding::Grey if red == green && green == blue => Ok(f64::from(red)),
            HeightEncoding::Grey => Err(self.colored(color)),
            HeightEncoding::Mapbox => Ok((f64::from(red * 65536 + green * 256 + blue) - 100_000.0) / 10.0),
            HeightEncoding::Terrarium => Ok(f64::from(red * 65536 + green * 256 + blue) / 256.0 - 32_768.0),
        }
    }

    /// Says what there is to say after the last pixel.
    pub(crate) fn finish(self, findings: &mut Findings) {
        if self.translucent > 0 {
            let message = format!("{} pixels are partly transparent: they were taken as they are", self.translucent);
            findings.push_many("W-heights-alpha", Severity::Note, Place::Whole, message, self.translucent);
        }
        if self.encoding == HeightEncoding::Grey && matches!(self.channels, Channels::Rgb | Channels::Rgba) {
            let message =
                "the picture has colours or a palette, but all of its pixels are grey: they were read exactly";
            findings.push("W-heights-grey", Severity::Note, Place::Whole, message);
        }
    }

    #[cold]
    fn colored(&self, [red, green, blue]: [u32; 3]) -> Box<Fault> {
        let at = self.seen - 1;
        let (row, column) = (at / self.columns.max(1), at % self.columns.max(1));
        let found = format!("the colour {red}, {green}, {blue}");
        Fault::new("E-heights-channels", Place::Whole, found, "grey, as how bright a colour looks is no height")
            .within(format!("row {row}, column {column}"))
            .advice("say how colours encode heights with --set encoding=mapbox or terrarium, or save it in grey")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(encoding: HeightEncoding, channels: Channels, pixels: &[&[u32]]) -> Vec<f64> {
        let mut reading = Pixels::try_new(encoding, channels, 255, 2).unwrap();
        pixels.iter().map(|pixel| reading.height(pixel).unwrap()).collect()
    }

    /// The formulas of Mapbox' and Mapzen's documentation, in whole numbers: 0 m, and the highest of the Earth.
    #[test]
    fn terrain_colours_are_metres() {
        let rgb = |encoding, pixel: &[u32]| heights(encoding, Channels::Rgb, &[pixel])[0];
        // 100,000 tenths above -10,000 m; 188,488 = 2 · 65536 + 224 · 256 + 72.
        assert_eq!(rgb(HeightEncoding::Mapbox, &[1, 134, 160]), 0.0);
        assert_eq!(rgb(HeightEncoding::Mapbox, &[2, 224, 72]), 8848.8);
        assert_eq!(rgb(HeightEncoding::Mapbox, &[0, 0, 0]), -10_000.0);
        assert_eq!(rgb(HeightEncoding::Terrarium, &[128, 0, 0]), 0.0);
        assert_eq!(rgb(HeightEncoding::Terrarium, &[162, 144, 204]), 8848.796875);
        assert_eq!(rgb(HeightEncoding::Terrarium, &[0, 0, 1]), -32_767.996_093_75);
    }

    #[test]
    fn transparent_pixels_are_holes_and_colours_are_refused() {
        let found = heights(HeightEncoding::Grey, Channels::GreyAlpha, &[&[7, 255], &[7, 0], &[9, 1]]);
        assert!(found[0] == 7.0 && found[1].is_nan() && found[2] == 9.0);
        let mut reading = Pixels::try_new(HeightEncoding::Grey, Channels::Rgb, 255, 2).unwrap();
        assert_eq!(reading.height(&[5, 5, 5]), Ok(5.0));
        reading.height(&[6, 6, 6]).unwrap();
        let fault = reading.height(&[6, 6, 7]).unwrap_err();
        assert_eq!((fault.code, fault.within.as_deref()), ("E-heights-channels", Some("row 1, column 0")));
        assert!(Pixels::try_new(HeightEncoding::Mapbox, Channels::Grey, 255, 2).is_err());
        assert!(Pixels::try_new(HeightEncoding::Mapbox, Channels::Rgb, 65535, 2).is_err());
    }
}
