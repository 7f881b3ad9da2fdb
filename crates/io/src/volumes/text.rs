//! Samples in text.

use shapeloom_core::Findings;
use shapeloom_voxels::Samples;

use super::{Intake, Scalar};
use crate::memory::Memory;
use crate::text::{NumberFault, Scanner, end_place};
use crate::{Fault, ReadContext, ReadError};

/// As many numbers as wanted, wherever lines end; `text` is what the scanner runs over, for the place of its end.
///
/// # Errors
/// A word that is no number of the type; too few numbers.
pub(crate) fn text_samples(
    scan: &mut Scanner<'_>,
    text: &[u8],
    count: u64,
    scalar: Scalar,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<Samples, ReadError> {
    let mut intake = Intake::with_room(count, scalar, memory)?;
    text_samples_into(&mut intake, scan, text, count, scalar, context)?;
    Ok(intake.finish(findings))
}

/// The same after the samples that are there already, up to `count` in all.
///
/// # Errors
/// As [`text_samples`].
pub(crate) fn text_samples_into(
    intake: &mut Intake,
    scan: &mut Scanner<'_>,
    text: &[u8],
    count: u64,
    scalar: Scalar,
    context: &ReadContext,
) -> Result<(), ReadError> {
    while intake.taken() < count {
        if intake.taken().is_multiple_of(1024) {
            context.exec.check()?;
            context.exec.progress(intake.taken() as f64 / count.max(1) as f64);
        }
        if scan.at_line_end() {
            if scan.next_line() {
                continue;
            }
            let found = format!("the end of the data after {} samples", intake.taken());
            let fault = Fault::new("E-volume-truncated", end_place(text), found, format!("{count} samples"));
            return Err(fault.within("payload").into());
        }
        let wrong = |scan: &Scanner<'_>, expected: &str| {
            let within = format!("sample {}", intake.taken());
            Fault::new("E-volume-number", scan.place(), scan.found(), expected).within(within)
        };
        let before = scan.clone();
        let value = match scan.number() {
            Ok(value) => value,
            Err(NumberFault::NotFinite | NumberFault::Overflow) if scalar.range().is_none() => not_finite(scan.word()),
            Err(fault) => return Err(wrong(scan, &fault.to_string()).into()),
        };
        if let Some((low, high)) = scalar.range()
            && !(value.fract() == 0.0 && (low..=high).contains(&value))
        {
            let expected = format!("a whole number from {low} to {high}, as its type is {}", scalar.name());
            return Err(wrong(&before, &expected).into());
        }
        intake.number(value);
    }
    Ok(())
}

/// The value of a word for infinity, for no number, or of a number beyond the largest one.
fn not_finite(word: &[u8]) -> f64 {
    let unsigned = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word);
    let size =
        if unsigned.first().is_some_and(|first| matches!(first, b'n' | b'N')) { f64::NAN } else { f64::INFINITY };
    if word.starts_with(b"-") { -size } else { size }
}
