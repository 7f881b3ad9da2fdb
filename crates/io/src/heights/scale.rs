//! How high white is, and how far samples are apart.

use shapeloom_core::{Category, Findings, Place, Severity, Words};

use crate::{Fault, ReadContext, ReadOptions};

/// What a degree or second of arc means for the proportions of a field.
pub(crate) const DEGREES: &str = "heights are of another unit than the places, so that mountains look like needles or \
                                  plains; --set exaggeration=... multiplies heights";

/// The height of white in a picture of whole numbers that says nothing of heights, and the distance between its samples:
/// as the options say, else a tenth of the longer side, which is said.
pub(crate) fn picture_scale(
    full_scale: f64,
    columns: u32,
    rows: u32,
    spacing: Option<f64>,
    context: &ReadContext,
    findings: &mut Findings,
) -> (f64, f64) {
    let options = &context.options;
    let distance = if options.spacing > 0.0 { options.spacing } else { spacing.unwrap_or(1.0) };
    if options.height != 0.0 {
        return (options.height, distance);
    }
    let height = f64::from(columns.max(rows) - 1) * distance / 10.0;
    let message = format!(
        "the picture does not say how high it is: its largest value, {}, was taken as {}, a tenth of the longer side, with \
         samples {} apart; --set height=... and --set spacing=... say it",
        Words(full_scale),
        Words(height),
        Words(distance)
    );
    findings.push("W-heights-scale", Severity::Warning, Place::Whole, message);
    (height, distance)
}

/// The distance between samples whose file does not say it: as the options say, else 1, which is said.
pub(crate) fn guess_spacing(context: &ReadContext, findings: &mut Findings) -> f64 {
    if context.options.spacing > 0.0 {
        return context.options.spacing;
    }
    let message = "the file has heights, but does not say how far apart they are: the distance was taken as 1; \
                   --set spacing=... says it";
    findings.push("W-heights-spacing", Severity::Warning, Place::Whole, message);
    1.0
}

/// Refuses the height of white where samples are heights already.
///
/// # Errors
/// It was given.
pub(crate) fn no_height(context: &ReadContext, what: &str) -> Result<(), Box<Fault>> {
    if context.options.height == 0.0 {
        return Ok(());
    }
    let found = format!("the option height = {} for {what}", Words(context.options.height));
    Err(Fault::new("E-heights-option", Place::Whole, found, "none: the samples are heights")
        .category(Category::Usage)
        .advice("multiply heights with --set exaggeration=..., or leave the option out"))
}

/// Refuses the distances of a stack of slices where a picture is a height field.
///
/// # Errors
/// They were given.
pub(crate) fn no_voxel_size(context: &ReadContext) -> Result<(), Box<Fault>> {
    let given = &context.options.voxel_size;
    if *given == ReadOptions::new().voxel_size {
        return Ok(());
    }
    let found = format!("the option voxel_size = {given} without stack = true");
    Err(Fault::new("E-heights-option", Place::Whole, found, "none: the picture is a height field")
        .category(Category::Usage)
        .advice(
            "say how far heights are apart with --set spacing=..., or read slices of a volume with --set stack=true",
        ))
}

/// A sample as a part of the largest one, of a range of heights.
pub(crate) fn part_of(value: f64, full: f64, range: f64) -> f64 {
    let product = value * range;
    // The product first: whole numbers stay whole where the range is the largest one.
    if product.is_finite() { product / full } else { value / full * range }
}
