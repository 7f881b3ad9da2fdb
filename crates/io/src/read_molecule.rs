//! What readers of molecules share.

use std::sync::Arc;

use shapeloom_core::{Diagnostic, Findings, Place};
use shapeloom_implicit::{Atom, AtomBlobs, Implicit, Molecule, Operation, Tree};
use shapeloom_shape::{Part, Shape};

use crate::memory::{Growing, Memory};
use crate::read::too_long;
use crate::text::{NumberFault, parse_number, plain_text, quoted};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// The molecule of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadMolecule {
    /// The atoms.
    pub molecule: Molecule,
    /// What was odd about the file and what was made of it.
    pub findings: Findings,
}

impl ReadMolecule {
    /// The molecule as the sum of a blob for each atom.
    pub(crate) fn into_shape(self, context: &ReadContext) -> Result<ReadShape, ReadError> {
        let options = AtomBlobs {
            blobbiness: context.options.blobbiness,
            scale: context.options.atom_scale,
            ..AtomBlobs::default()
        };
        let fault = |error: &dyn Diagnostic| {
            Fault::new(error.code(), Place::Whole, error.to_string(), "atoms that make a surface")
                .category(error.category())
        };
        let blobs = self.molecule.blobs(&options).map_err(|error| fault(&error))?;
        let bounds = blobs.bounds();
        let tree = Tree::new(Operation::Blobs(Arc::new(blobs)));
        let mut implicit = Implicit::new(tree).map_err(|error| fault(&error))?;
        if !bounds.is_empty() {
            // Room of a hundredth, so that nothing touches the border.
            let padded = bounds.padded(bounds.diagonal() * 0.01);
            implicit = implicit.within(padded).map_err(|error| fault(&error))?;
        }
        let shape = Shape::new(Part::new(implicit).named(self.molecule.title));
        Ok(ReadShape { findings: self.findings, ..ReadShape::new(shape) })
    }
}

/// Runs a reader within the limits, on text without a byte order mark, and names the input in its errors.
pub(crate) fn read_with(
    input: &[u8],
    context: &ReadContext,
    reader: impl FnOnce(&[u8]) -> Result<ReadMolecule, ReadError>,
) -> Result<ReadMolecule, ReadError> {
    let run = || {
        if input.len() as u64 > context.limits.max_bytes {
            return Err(too_long(context.limits.max_bytes).into());
        }
        context.exec.check()?;
        reader(plain_text(input, &context.limits)?)
    };
    run().map_err(|error: ReadError| error.in_input(&context.name))
}

/// Atoms, counted against the limits and the budget.
pub(crate) struct Atoms<'e> {
    atoms: Growing<Atom>,
    memory: Memory<'e>,
    most: u64,
    code: &'static str,
}

impl<'e> Atoms<'e> {
    pub(crate) fn new(context: &'e ReadContext, code: &'static str) -> Self {
        let memory = Memory::new(&context.exec);
        Self { atoms: Growing::default(), memory, most: context.limits.max_elements, code }
    }

    pub(crate) fn len(&self) -> usize {
        self.atoms.len()
    }

    pub(crate) fn push(&mut self, atom: Atom, place: Place) -> Result<(), ReadError> {
        if self.atoms.len() as u64 >= self.most {
            let expected = format!("at most {} atoms", self.most);
            let fault = Fault::new(self.code, place, "one more atom", expected);
            return Err(fault.category(shapeloom_core::Category::OverLimit).into());
        }
        Ok(self.atoms.push(&mut self.memory, atom)?)
    }

    pub(crate) fn into_vec(self) -> Vec<Atom> {
        self.atoms.into_vec()
    }
}

/// A coordinate from its word.
pub(crate) fn coordinate(word: &[u8], place: Place, axis: usize, codes: [&'static str; 2]) -> Result<f64, Box<Fault>> {
    parse_number(word).map_err(|fault| {
        let code = if fault == NumberFault::Syntax { codes[0] } else { codes[1] };
        let found = if word.is_empty() { "nothing".to_owned() } else { quoted(word) };
        let axis = ["x", "y", "z"].get(axis).copied().unwrap_or("?");
        Fault::new(code, place, found, format!("{fault}, the {axis} of an atom"))
    })
}

/// A place in a line, both counted from 1.
pub(crate) fn at(line: u64, column: usize) -> Place {
    Place::Line { line, column: Some(column as u64) }
}
