//! What is not read, in words: the decoder's own texts are the names of its types.

use tiff::tags::{CompressionMethod, PhotometricInterpretation};
use tiff::{ColorType, TiffUnsupportedError as Unsupported};

/// The channels of a pixel.
pub(super) fn color_words(color: ColorType) -> String {
    let (what, bits) = match color {
        ColorType::Gray(bits) => ("grey", bits),
        ColorType::GrayA(bits) => ("grey with transparency", bits),
        ColorType::RGB(bits) => ("red, green and blue", bits),
        ColorType::RGBA(bits) => ("red, green, blue and transparency", bits),
        ColorType::Palette(bits) => ("colours of a palette", bits),
        ColorType::CMYK(bits) => ("cyan, magenta, yellow and black", bits),
        ColorType::CMYKA(bits) => ("cyan, magenta, yellow, black and transparency", bits),
        ColorType::YCbCr(bits) => ("brightness and colour differences (YCbCr)", bits),
        ColorType::Lab(bits) => ("lightness and colour (CIE L*a*b*)", bits),
        ColorType::Multiband { bit_depth, num_samples } => {
            return format!("{num_samples} channels of {bit_depth} bits");
        }
        _ => return "channels of an unknown meaning".into(),
    };
    format!("{what} of {bits} bits")
}

fn interpretation_words(interpretation: PhotometricInterpretation) -> String {
    match interpretation {
        PhotometricInterpretation::WhiteIsZero => "grey of which 0 is white".into(),
        PhotometricInterpretation::BlackIsZero => "grey".into(),
        PhotometricInterpretation::RGB => "red, green and blue".into(),
        PhotometricInterpretation::RGBPalette => "colours of a palette".into(),
        PhotometricInterpretation::TransparencyMask => "a mask of transparency".into(),
        PhotometricInterpretation::CMYK => "printing colours (CMYK)".into(),
        PhotometricInterpretation::YCbCr => "brightness and colour differences (YCbCr)".into(),
        PhotometricInterpretation::CIELab => "lightness and colour (CIE L*a*b*)".into(),
        other => format!("colours of kind {}", other.to_u16()),
    }
}

fn compression_words(method: CompressionMethod) -> String {
    match method {
        CompressionMethod::Huffman => "CCITT run lengths".into(),
        CompressionMethod::Fax3 => "CCITT group 3 (fax)".into(),
        CompressionMethod::Fax4 => "CCITT group 4 (fax)".into(),
        CompressionMethod::JPEG | CompressionMethod::ModernJPEG => "JPEG".into(),
        CompressionMethod::ZSTD => "Zstandard".into(),
        CompressionMethod::WebP => "WebP".into(),
        other => format!("number {}", other.to_u16()),
    }
}

/// What the decoder does not do.
pub(super) fn unsupported_words(error: Unsupported) -> String {
    let bits = |each: &[u8]| each.iter().map(u8::to_string).collect::<Vec<_>>().join(", ");
    match error {
        Unsupported::FloatingPointPredictor(color) => {
            format!("differences of floating numbers in {}", color_words(color))
        }
        Unsupported::HorizontalPredictor(color) => format!("differences of neighbours in {}", color_words(color)),
        Unsupported::InconsistentBitsPerSample(each) => format!("channels of different depths: {} bits", bits(&each)),
        Unsupported::InterpretationWithBits(interpretation, each) if each.is_empty() => {
            format!("{} without a depth", interpretation_words(interpretation))
        }
        Unsupported::InterpretationWithBits(interpretation, each) => {
            format!("{} of {} bits", interpretation_words(interpretation), bits(&each))
        }
        Unsupported::UnsupportedCompressionMethod(method) => {
            format!("compression of another kind: {}", compression_words(method))
        }
        Unsupported::UnsupportedSampleFormat(_) => "numbers of an unknown format or of several (SampleFormat)".into(),
        Unsupported::UnsupportedColorType(color) => color_words(color),
        Unsupported::UnsupportedPlanarConfig(_) => "channels neither side by side nor in planes".into(),
        Unsupported::UnsupportedInterpretation(interpretation) => interpretation_words(interpretation),
        other => other.to_string().trim_end_matches('.').to_owned(),
    }
}
