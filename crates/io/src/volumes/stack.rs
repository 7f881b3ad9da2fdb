//! Pictures that are the slices of a volume.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Options, Place, Severity};
use shapeloom_voxels::Quantity;

use super::neighbor::open;
use super::{Frame, Intake, Scalar, grid_shape};
use crate::memory::Memory;
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError, ReadOptions, ReadShape, SiblingError, SiblingName};

/// The samples of a picture, row by row, the upper one first.
pub(crate) struct Plane {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    pub(crate) scalar: Scalar,
    pub(crate) values: Vec<f64>,
}

/// Hands on every picture of a file.
pub(crate) type Planes =
    fn(&[u8], &ReadContext, &mut Findings, &mut dyn FnMut(Plane) -> Result<(), ReadError>) -> Result<(), ReadError>;

/// Reads pictures as slices: the pages of the input if it has several, else the input and the files beside it whose
/// numbers follow the one in its name. `i` runs along rows to the right, `j` down the columns, `k` along the slices.
///
/// # Errors
/// Pictures of different sizes or depths; a name without a number; a gap in the numbers.
pub(crate) fn read_stack(input: &[u8], context: &ReadContext, planes: Planes) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut stack = Stack { size: None, slices: 0, intake: None };
    let mut memory = Memory::new(&context.exec);
    let spacing = crate::raw::voxel_size(&context.options)?;
    no_heights(&context.options)?;
    planes(input, context, &mut findings, &mut |plane| stack.add(&plane, &context.name, context, &mut memory))?;
    if stack.slices == 1 {
        let name = Numbered::of(&context.name)?;
        let siblings = context.siblings.as_ref().ok_or_else(|| {
            let fault = Fault::new("E-sibling-missing", Place::Whole, "one picture, read alone", "slices beside it");
            fault.category(Category::Unsupported).advice("read the first slice by its path")
        })?;
        let wrong =
            |found: String| Fault::new("E-volume-stack", Place::Whole, found, "slices beside each other, one a number");
        let mut at = name.number;
        while let Some(following) = at.checked_add(1) {
            at = following;
            let next = name.with(at);
            let sibling = SiblingName::try_new(&next).map_err(|_| wrong(quoted(next.as_bytes())))?;
            match open(siblings.as_ref(), &sibling, u64::MAX, context)? {
                Ok(bytes) => {
                    let _held = context.exec.reserve(bytes.len() as u64)?;
                    let add = &mut |plane: Plane| stack.add(&plane, &next, context, &mut memory);
                    planes(&bytes, context, &mut findings, add).map_err(|error| error.in_input(&next))?;
                }
                Err(SiblingError::Missing) => break,
                Err(error) => return Err(wrong(format!("{}: {error}", quoted(next.as_bytes()))).into()),
            }
        }
        // One that is missing in the middle.
        let beyond = name.with(at.saturating_add(1));
        if let Ok(sibling) = SiblingName::try_new(&beyond)
            && siblings.open(&sibling, 1).is_ok()
        {
            let found =
                format!("no slice {}, though there is {}", quoted(name.with(at).as_bytes()), quoted(beyond.as_bytes()));
            return Err(wrong(found).into());
        }
        let last = name.with(at.saturating_sub(1));
        let message = format!("{} slices, the last of which is {}", stack.slices, quoted(last.as_bytes()));
        findings.push("W-volume-slices", Severity::Note, Place::Whole, message);
    }
    let (Some((columns, rows, _)), Some(intake)) = (stack.size, stack.intake) else {
        return Err(Fault::new("E-volume-stack", Place::Whole, "no picture", "one at least").into());
    };
    let frame = Frame::turned(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z], spacing);
    let lattice = frame.lattice([columns, rows, stack.slices], Place::Whole)?;
    let samples = intake.finish(&mut findings);
    let shape = grid_shape(lattice, samples, Quantity::Density, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}

/// Refuses options that say how a picture is a height field.
///
/// # Errors
/// One of them was given.
fn no_heights(options: &ReadOptions) -> Result<(), Box<Fault>> {
    let usual = ReadOptions::new();
    for name in ["encoding", "height", "spacing", "exaggeration"] {
        if let Ok(given) = options.get(name)
            && usual.get(name) != Ok(given.clone())
        {
            let found = format!("the option {name} = {given} with stack = true");
            let fault =
                Fault::new("E-volume-option", Place::Whole, found, "none: the pictures are slices, not heights");
            let advice = "leave it out, or leave stack out for a height field; --set voxel_size=XxYxZ says how far samples \
                          of slices are apart";
            return Err(fault.category(Category::Usage).advice(advice));
        }
    }
    Ok(())
}

/// The slices so far.
struct Stack {
    size: Option<(u32, u32, Scalar)>,
    slices: u32,
    intake: Option<Intake>,
}

impl Stack {
    fn add(
        &mut self,
        plane: &Plane,
        name: &str,
        context: &ReadContext,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let own = (plane.columns, plane.rows, plane.scalar);
        let size = *self.size.get_or_insert(own);
        let words =
            |(columns, rows, scalar): (u32, u32, Scalar)| format!("{columns} × {rows} samples of {}", scalar.name());
        if own != size {
            let fault = Fault::new(
                "E-volume-stack",
                Place::Whole,
                words(own),
                format!("{}, as in the first slice", words(size)),
            );
            return Err(fault.within(format!("slice {}, {}", self.slices, quoted(name.as_bytes()))).into());
        }
        let count = plane.values.len();
        let most = context.limits.max_elements;
        let all = (u64::from(self.slices) + 1).saturating_mul(count as u64);
        if all > most {
            let fault = Fault::new("E-volume-limit", Place::Whole, format!("{all} samples"), format!("at most {most}"));
            return Err(fault.category(Category::OverLimit).into());
        }
        let intake = match &mut self.intake {
            Some(intake) => intake,
            none => none.insert(Intake::with_room(0, plane.scalar, memory)?),
        };
        intake.more(count, memory)?;
        for row in plane.values.chunks(1 << 16) {
            context.exec.check()?;
            row.iter().for_each(|&value| intake.number(value));
        }
        self.slices += 1;
        Ok(())
    }
}

/// A file name with a number before its extension.
struct Numbered<'a> {
    stem: &'a str,
    number: u64,
    width: usize,
    extension: &'a str,
}

impl<'a> Numbered<'a> {
    fn of(name: &'a str) -> Result<Self, Box<Fault>> {
        let base = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let (stem, extension) = base.split_at(base.rfind('.').unwrap_or(base.len()));
        let letters = stem.trim_end_matches(|char: char| char.is_ascii_digit());
        let digits = &stem[letters.len()..];
        let number = digits.parse().map_err(|_| {
            let fault = Fault::new(
                "E-volume-stack",
                Place::Whole,
                quoted(base.as_bytes()),
                "a name with a number, such as slice_000",
            );
            fault.advice("name the slices with numbers, and read the first one; or write them as pages of one TIFF")
        })?;
        Ok(Self { stem: letters, number, width: digits.len(), extension })
    }

    fn with(&self, number: u64) -> String {
        format!("{}{number:0width$}{}", self.stem, self.extension, width = self.width)
    }
}
