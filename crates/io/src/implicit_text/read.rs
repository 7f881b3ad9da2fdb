//! Reading implicit shapes.

use shapeloom_core::{Aabb, Category, Diagnostic, Place};
use shapeloom_implicit::{ForeignCall, ResolveError, Resolved, Resolver, parse, parse_vm};
use shapeloom_implicit::{Implicit, Tree};
use shapeloom_shape::{Part, Shape};

use super::foreign;
use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// No byte of a text makes more than so many bytes of tree and program.
const BYTES_FROM_A_BYTE: usize = 400;

pub(super) fn shape(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let _memory = room(input, context)?;
    let files = Files { context };
    let parsed = parse(input, Some(&files)).map_err(|error| {
        let place = Place::Line { line: error.line, column: Some(error.column) };
        fault(&error, error.problem.to_string(), place).advice("docs/formats/shape_language.md describes the language")
    })?;
    finished(parsed.tree, parsed.bounds, context)
}

pub(super) fn vm(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let _memory = room(input, context)?;
    let tree = parse_vm(input).map_err(|error| {
        let words = error.to_string();
        let words = words.strip_prefix(&format!("line {}: ", error.line)).unwrap_or(&words);
        fault(&error, words.to_owned(), Place::line(error.line))
    })?;
    finished(tree, None, context)
}

/// Takes the memory of the tree while it is made: few texts need as much, and none more.
fn room<'a>(input: &[u8], context: &'a ReadContext) -> Result<Memory<'a>, ReadError> {
    context.exec.check()?;
    let mut memory = Memory::new(&context.exec);
    memory.take(input.len(), BYTES_FROM_A_BYTE)?;
    Ok(memory)
}

fn finished(tree: Tree, bounds: Option<Aabb>, context: &ReadContext) -> Result<ReadShape, ReadError> {
    context.exec.check()?;
    let whole = |error: &dyn Diagnostic| fault(error, error.to_string(), Place::Whole);
    let mut implicit = Implicit::new(tree).map_err(|error| whole(&error))?;
    if let Some(bounds) = bounds {
        implicit = implicit.within(bounds).map_err(|error| whole(&error))?;
    }
    Ok(ReadShape::new(Shape::new(Part::new(implicit))))
}

/// The fault of an error whose words are `found ..., expected ...`, perhaps with a place of their own in front.
fn fault(error: &dyn Diagnostic, words: String, place: Place) -> Box<Fault> {
    let (found, expected) = words.rsplit_once(", expected ").unwrap_or((&words, "a shape"));
    let (within, found) = match found.split_once("found ") {
        Some((within, found)) => (within.trim_end_matches([':', ' ']), found),
        None => ("", found),
    };
    let fault = Fault::new(error.code(), place, found, expected).category(error.category());
    if within.is_empty() { fault } else { fault.within(within) }
}

/// The files beside a text.
struct Files<'a> {
    context: &'a ReadContext,
}

impl Resolver for Files<'_> {
    fn resolve(&self, call: &ForeignCall) -> Result<Resolved, ResolveError> {
        if !foreign::FUNCTIONS.contains(&call.function.as_str()) {
            return Err(ResolveError::UnknownFunction);
        }
        foreign::resolve(call, self.context)
            .map_err(|reason| ResolveError::Failed { reason, category: Category::Malformed })
    }

    fn functions(&self) -> Vec<String> {
        foreign::FUNCTIONS.map(str::to_owned).to_vec()
    }
}
