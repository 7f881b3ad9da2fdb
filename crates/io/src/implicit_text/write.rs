//! Writing implicit shapes.

use std::io::Write;

use shapeloom_core::{Aabb, Affine, Diagnostic, Report};
use shapeloom_implicit::Tree;
use shapeloom_implicit::{print_vm, to_text};
use shapeloom_shape::{Geometry, Shape};

use super::{SHAPE, VM};
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::{Format, WriteContext, WriteError};

pub(super) fn shape(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let (tree, bounds) = whole(shape, &SHAPE)?;
    put(shape, &SHAPE, to_text(&tree, bounds.as_ref()), context, out)
}

pub(super) fn vm(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let (tree, _) = whole(shape, &VM)?;
    let text = print_vm(&tree).map_err(|error| WriteError::Tree {
        format: VM.id,
        reason: error.to_string(),
        code: error.code(),
        category: error.category(),
    })?;
    put(shape, &VM, text, context, out)
}

fn put(
    shape: &Shape,
    format: &Format,
    text: String,
    context: &WriteContext,
    out: &mut dyn Write,
) -> Result<Report, WriteError> {
    let mut report =
        Report::exact("write-implicit", "the same tree, its numbers the shortest that read back to the same bits");
    report.losses = frame_losses(shape, format);
    context.exec.check()?;
    let mut sink = Sink::new(out, &context.exec);
    text.as_bytes().chunks(1 << 16).try_for_each(|some| sink.bytes(some))?;
    sink.finish()?;
    Ok(report)
}

/// The union of all parts, where they are placed.
fn whole(shape: &Shape, format: &Format) -> Result<(Tree, Option<Aabb>), WriteError> {
    let mut trees = Vec::new();
    let mut bounds = Some(Aabb::EMPTY);
    for part in &shape.parts {
        let Geometry::Implicit(implicit) = &*part.geometry else { continue };
        let plain = part.placement == Affine::IDENTITY;
        let placed = if plain { implicit.clone() } else { implicit.transformed(&part.placement) };
        trees.push(placed.tree().clone());
        // A box is known where every part has one.
        bounds = bounds.zip(placed.given_bounds()).map(|(all, one)| all.union(one));
    }
    match trees.len() {
        0 => Err(WriteError::Empty { format: format.id }),
        1 => Ok((trees.swap_remove(0), bounds)),
        _ => Ok((Tree::union_of(trees), bounds)),
    }
}
