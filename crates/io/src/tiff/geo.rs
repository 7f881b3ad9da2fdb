//! What the tags of GeoTIFF and GDAL say.

use shapeloom_core::glam::{DMat4, DVec2};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use super::source::Source;
use crate::text::{parse_number, quoted};

/// Where samples are, and what has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Geo {
    /// The distance of samples.
    pub(super) spacing: Option<DVec2>,
    /// The north-western corner of the north-western pixel.
    pub(super) north_west: Option<DVec2>,
    /// Whether that is rather the place of its sample.
    pub(super) points: bool,
    /// Whether places are degrees.
    pub(super) degrees: bool,
    /// Whether places are metres.
    pub(super) meters: bool,
    /// The number of samples without data.
    pub(super) no_data: Option<f64>,
    /// What the tag for that says instead of a number.
    pub(super) no_number: Option<String>,
    /// Why places were not understood.
    pub(super) odd: Option<&'static str>,
}

/// The tag of a matrix from samples to places.
const TRANSFORMATION: Tag = Tag::Unknown(34264);

// Keys of GeoTIFF.
const MODEL_TYPE: u64 = 1024;
const RASTER_TYPE: u64 = 1025;
const LINEAR_UNIT: u64 = 3076;
// Their values.
const GEOGRAPHIC: u64 = 2;
const PIXEL_IS_POINT: u64 = 2;
const METER: u64 = 9001;

impl Geo {
    /// Reads what is there; what cannot be read is as if it were not.
    pub(super) fn read(decoder: &mut Decoder<Source<'_>>) -> Self {
        let mut geo = Self::default();
        let mut numbers = |tag: Tag| match decoder.find_tag(tag) {
            Ok(Some(value)) => value.into_f64_vec().ok(),
            _ => None,
        };
        let (scale, tie) = (numbers(Tag::ModelPixelScaleTag), numbers(Tag::ModelTiepointTag));
        let matrix = numbers(TRANSFORMATION);
        if let Some(&[x, y, ..]) = scale.as_deref() {
            geo.scaled(DVec2::new(x, y), tie.as_deref());
        } else if let Some(matrix) = matrix.and_then(|matrix| <[f64; 16]>::try_from(matrix).ok()) {
            geo.mapped(DMat4::from_cols_array(&matrix).transpose());
        }
        let keys = match decoder.find_tag(Tag::GeoKeyDirectoryTag) {
            Ok(Some(value)) => value.into_u64_vec().unwrap_or_default(),
            _ => Vec::new(),
        };
        for key in keys.chunks_exact(4).skip(1) {
            // Values in other tags have those here.
            if key[1] == 0 {
                match (key[0], key[3]) {
                    (MODEL_TYPE, GEOGRAPHIC) => geo.degrees = true,
                    (RASTER_TYPE, PIXEL_IS_POINT) => geo.points = true,
                    (LINEAR_UNIT, METER) => geo.meters = true,
                    _ => {}
                }
            }
        }
        let said = match decoder.find_tag(Tag::GdalNodata) {
            Ok(Some(value)) => Some(value.into_string().ok()),
            Ok(None) => None,
            Err(_) => Some(None),
        };
        if let Some(None) = said {
            geo.no_number = Some("no text".into());
        }
        if let Some(Some(text)) = said {
            let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
            let word = text.trim_start_matches(['-', '+']);
            geo.no_data = if word.eq_ignore_ascii_case("nan") {
                Some(f64::NAN)
            } else if word.eq_ignore_ascii_case("inf") {
                Some(if text.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY })
            } else {
                parse_number(text.as_bytes()).ok()
            };
            geo.no_number = geo.no_data.is_none().then(|| quoted(text.as_bytes()));
        }
        geo
    }

    /// Whether the file says more of its samples than a picture does.
    pub(super) fn is_said(&self) -> bool {
        self.spacing.is_some() || self.no_data.is_some()
    }

    fn scaled(&mut self, scale: DVec2, tie: Option<&[f64]>) {
        if !(scale.is_finite() && scale.x > 0.0 && scale.y != 0.0) {
            self.odd = Some("a distance of samples that is 0 or no number");
            return;
        }
        if scale.y < 0.0 {
            self.odd = Some("rows that run to the north");
            return;
        }
        self.spacing = Some(scale);
        if let Some(&[i, j, _, x, y, ..]) = tie {
            let corner = DVec2::new(x - i * scale.x, y + j * scale.y);
            self.north_west = Some(corner).filter(|corner| corner.is_finite());
        }
    }

    fn mapped(&mut self, map: DMat4) {
        let (column, row, origin) = (map.x_axis, map.y_axis, map.w_axis);
        let along = column.y == 0.0 && row.x == 0.0;
        if !along || column.x <= 0.0 || column.x.is_nan() || row.y == 0.0 {
            self.odd = Some("a grid that is turned or has no size");
        } else {
            self.spacing = Some(DVec2::new(column.x, row.y.abs())).filter(|spacing| spacing.is_finite());
            // Rows to the north are rare, and more often meant for rows to the south of a file without a place.
            self.north_west = (row.y < 0.0 && origin.is_finite()).then(|| origin.truncate().truncate());
        }
    }
}
