//! Files of samples beside a header.

use std::borrow::Cow;

use shapeloom_core::{Category, Place};

use super::Payload;
use crate::memory::Memory;
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError, SiblingError, SiblingName, Siblings};

/// The file of that name, of which at most as many bytes as wanted and one more are read.
///
/// # Errors
/// A name that leaves the folder, a file that is not there or unreadable, an input that is read alone, a budget passed.
pub(crate) fn open_beside(
    name: &str,
    wanted: u64,
    place: Place,
    within: &str,
    context: &ReadContext,
    memory: &mut Memory<'_>,
) -> Result<Payload<'static>, ReadError> {
    let found = || quoted(name.as_bytes());
    let fault = |code, found: String, expected: &str| Fault::new(code, place.clone(), found, expected).within(within);
    let sibling = SiblingName::try_new(name)
        .map_err(|_| fault("E-sibling-path", found(), "the name of a file in the folder of the header"))?;
    let Some(siblings) = &context.siblings else {
        let fault = fault("E-sibling-missing", found(), "samples inside the input, which is read alone");
        return Err(fault.category(Category::Unsupported).advice("read the header by its path").into());
    };
    let bytes = open(siblings.as_ref(), &sibling, wanted, context)?.map_err(|error| match error {
        SiblingError::Forbidden => fault("E-sibling-path", found(), "a file in the folder of the header"),
        error => fault("E-sibling-missing", format!("{}: {error}", found()), "a readable file"),
    })?;
    memory.take(bytes.len(), 1)?;
    Ok(Payload { bytes: Cow::Owned(bytes), at: None, name: name.to_owned() })
}

/// A file, of which at most as many bytes as wanted and one more are read, and no more than the budget has.
///
/// # Errors
/// A budget passed; the file's own errors are inside.
pub(super) fn open(
    siblings: &dyn Siblings,
    name: &SiblingName,
    wanted: u64,
    context: &ReadContext,
) -> Result<Result<Vec<u8>, SiblingError>, ReadError> {
    context.exec.check()?;
    // A header may promise anything: no more is taken than there is.
    let room = context.exec.memory_limit().saturating_sub(context.exec.memory_taken());
    let most = wanted.saturating_add(1).min(context.limits.max_bytes).min(room);
    let held = context.exec.reserve(most)?;
    let opened = siblings.open(name, most);
    drop(held);
    if let Ok(bytes) = &opened
        && most == room
        && most <= wanted
        && bytes.len() as u64 >= most
    {
        // It is longer than the budget.
        context.exec.reserve(room.saturating_add(1))?;
    }
    Ok(opened)
}
