//! What the formats of height fields share: samples made heights, rows turned so that north is up, and the way back.
//!
//! Conventions: files begin with the northern row, fields with the southern one: x grows along the columns to the east, y
//! along the rows to the north, z upward, so that the frame is right-handed and front faces look up. Samples are the
//! middles of pixels and cells. A height that is not a number is a hole.

mod field;
mod level;
mod pixels;
mod scale;

pub(crate) use field::{HOLE_ADVICE, NorthFirst, check_size, room};
pub(crate) use level::Level;
pub(crate) use pixels::{Channels, Pixels};
pub(crate) use scale::{DEGREES, guess_spacing, no_height, no_voxel_size, part_of, picture_scale};

use shapeloom_core::Options;
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Part, Shape, UpAxis};

/// A shape of one height field.
pub(crate) fn shape_of(field: HeightField) -> Shape {
    Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(field)) }
}

/// Refuses options that are out of bounds, whoever set them.
pub(crate) fn check_options(options: &crate::ReadOptions) -> Result<(), Box<crate::Fault>> {
    options.validate().map_err(|error| {
        let place = shapeloom_core::Place::Whole;
        crate::Fault::new("E-heights-option", place, error.to_string(), "options within their bounds")
            .category(shapeloom_core::Category::Usage)
    })
}
