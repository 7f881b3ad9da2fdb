//! The finished picture.

use std::io::Cursor;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::RenderError;

/// A picture of 8-bit sRGB pixels with opacity, in rows from the top, each from the left.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Image").field("width", &self.width).field("height", &self.height).finish_non_exhaustive()
    }
}

impl Image {
    /// A picture from its pixels; none unless there are `width * height` of them.
    pub fn try_new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Option<Self> {
        (u64::from(width) * u64::from(height) == pixels.len() as u64).then_some(Self { width, height, pixels })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green, blue and opacity, row by row; colours are not multiplied by the opacity.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// The pixel at a column and row; none outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        (x < self.width && y < self.height).then(|| self.pixels[y as usize * self.width as usize + x as usize])
    }

    /// The picture as a PNG file, without opacity where every pixel is opaque. The bytes depend on the pixels alone.
    ///
    /// # Errors
    /// The encoder refuses, as it does for a picture without pixels.
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        let encoder =
            PngEncoder::new_with_quality(Cursor::new(&mut bytes), CompressionType::Best, FilterType::Adaptive);
        let opaque = self.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
        let written = if opaque {
            let colors: Vec<u8> = self.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            encoder.write_image(&colors, self.width, self.height, ExtendedColorType::Rgb8)
        } else {
            encoder.write_image(self.pixels.as_flattened(), self.width, self.height, ExtendedColorType::Rgba8)
        };
        written.map_err(|error| RenderError::Encode { message: error.to_string() })?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_decodes_to_the_same_pixels() {
        for opacity in [255, 80] {
            let pixels = (0..35u8).map(|i| [i * 7, 255 - i, i ^ 91, opacity]).collect();
            let image = Image::try_new(7, 5, pixels).unwrap();
            let png = image.to_png().unwrap();
            let decoded = ::image::load_from_memory(&png).unwrap();
            assert_eq!(decoded.color().has_alpha(), opacity != 255);
            assert_eq!(decoded.to_rgba8().into_raw(), image.pixels().as_flattened());
            assert_eq!(png, image.to_png().unwrap());
        }
    }

    #[test]
    fn wrong_sizes_make_no_picture() {
        assert!(Image::try_new(2, 2, vec![[0; 4]; 3]).is_none());
        let image = Image::try_new(1, 2, vec![[1; 4], [2; 4]]).unwrap();
        assert_eq!((image.pixel(0, 1), image.pixel(1, 0)), (Some([2; 4]), None));
        assert!(matches!(Image::try_new(0, 0, vec![]).unwrap().to_png(), Err(RenderError::Encode { .. })));
    }
}
