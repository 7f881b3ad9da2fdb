//! Reading Protein Data Bank files.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_implicit::{Atom, Element, Molecule};

use crate::read_molecule::{Atoms, at, coordinate, read_with};
use crate::text::{Text, end_place, lossy, quoted};
use crate::{Fault, ReadContext, ReadError, ReadMolecule};

/// Titles are cut here.
const TITLE: usize = 4096;

/// The atoms of a Protein Data Bank file, in ångströms.
///
/// # Errors
/// A coordinate that is no finite number, an atom whose line ends before its coordinates, no atom at all, limits and budgets passed,
/// cancelled; each of the file's faults with line and column.
pub fn read_pdb(input: &[u8], context: &ReadContext) -> Result<ReadMolecule, ReadError> {
    read_with(input, context, |text| read(text, context))
}

/// Where reading is with regard to models.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Models {
    /// In the first model, or none was named.
    First,
    /// After the end of the first.
    Later,
}

fn read(text: &[u8], context: &ReadContext) -> Result<ReadMolecule, ReadError> {
    let mut findings = Findings::default();
    let mut atoms = Atoms::new(context, "E-pdb-limit");
    let mut title = String::new();
    let mut models = Models::First;
    let mut named = false;
    let mut skipped = 0u64;
    let mut residue = Residue::default();
    let mut lines = Text::try_new(text, &context.limits)?.lines();
    while let Some(line) = lines.next_line()? {
        if line.number % 1024 == 1 {
            context.exec.check()?;
            context.exec.progress(1.0 - lines.remaining() as f64 / text.len().max(1) as f64);
        }
        let (number, bytes) = (line.number, line.bytes);
        match record(bytes) {
            b"ATOM" | b"HETATM" if models == Models::Later => skipped += 1,
            b"ATOM" | b"HETATM" => {
                if residue.is_other_place(bytes) {
                    let message = "atoms at alternate locations were left out: of each residue the first is kept";
                    findings.push("W-pdb-alternate", Severity::Note, Place::line(number), message);
                    continue;
                }
                let atom = Atom { element: element(bytes, number, &mut findings), position: position(bytes, number)? };
                atoms.push(atom, Place::line(number))?;
            }
            b"MODEL" => {
                // A second one begins another model even where the first was not ended.
                if named {
                    models = Models::Later;
                }
                named = true;
            }
            b"ENDMDL" => models = Models::Later,
            b"TITLE" if title.len() < TITLE => {
                // Columns 9 and 10 number the lines that go on.
                let more = lossy(columns(bytes, 11, 80).trim_ascii(), Place::line(number), &mut findings);
                if !title.is_empty() && !more.is_empty() {
                    title.push(' ');
                }
                title.push_str(&more);
            }
            _ => {}
        }
    }
    if skipped > 0 {
        let message = "the file has several models; the atoms of all but the first were left out";
        findings.push_many("W-pdb-models", Severity::Warning, Place::Whole, message, skipped);
    }
    if atoms.len() == 0 {
        let fault = Fault::new("E-pdb-truncated", end_place(text), "no atom", "records ATOM or HETATM");
        return Err(fault.advice("get a complete copy of the file: this one has no atoms").into());
    }
    Ok(ReadMolecule { molecule: Molecule { atoms: atoms.into_vec(), title }, findings })
}

/// The name of a line's record, columns 1 to 6.
fn record(line: &[u8]) -> &[u8] {
    columns(line, 1, 6).trim_ascii_end()
}

/// The bytes of columns counted from 1, as far as the line goes.
fn columns(line: &[u8], first: usize, last: usize) -> &[u8] {
    let last = last.min(line.len());
    line.get(first - 1..last).unwrap_or(&[])
}

fn position(line: &[u8], number: u64) -> Result<DVec3, Box<Fault>> {
    let mut position = DVec3::ZERO;
    for axis in 0..3 {
        let first = 31 + 8 * axis;
        // Trailing blanks may have been cut off, so that the last number ends early.
        if line.len() < first {
            let found = format!("the end of the line at column {}", line.len());
            let expected = "the coordinates of an atom in columns 31 to 54";
            return Err(Fault::new("E-pdb-row", Place::line(number), found, expected));
        }
        let word = columns(line, first, first + 7).trim_ascii();
        let codes = ["E-pdb-number", "E-pdb-finite"];
        position[axis] = coordinate(word, at(number, first), axis, codes).map_err(|fault| {
            if fault.code == codes[0] {
                fault.advice("put the number into its columns, 31 to 38, 39 to 46 or 47 to 54: a byte too few or too many moves all that follow")
            } else {
                fault
            }
        })?;
    }
    Ok(position)
}

/// The element of columns 77 and 78, else of the atom's name.
fn element(line: &[u8], number: u64, findings: &mut Findings) -> Element {
    let symbol = |bytes: &[u8]| std::str::from_utf8(bytes).ok().and_then(Element::from_symbol);
    let said = columns(line, 77, 78).trim_ascii();
    if let Some(element) = symbol(said) {
        return element;
    }
    let name = columns(line, 13, 16);
    // The symbol ends in column 14. Names of four characters begin earlier, and are of hydrogen where they begin with its letter or
    // with a digit; a single letter in column 13 is a name that was not put into its columns.
    let from_name = match *name {
        [b' ' | b'0'..=b'9', letter, ..] => symbol(&[letter]),
        [b'H' | b'h' | b'D' | b'd', _, b'!'..=b'~', b'!'..=b'~'] => Some(Element::HYDROGEN),
        [first, second, ..] => symbol(&[first, second]).or_else(|| symbol(&[first])),
        _ => None,
    };
    match from_name {
        Some(element) => {
            let message = "no element in columns 77 and 78; elements were taken from the names of the atoms";
            findings.push("W-pdb-element", Severity::Note, at(number, 13), message);
            element
        }
        None => {
            let message = format!("found no element for atom {}: it counts as unknown", quoted(name.trim_ascii()));
            findings.push("W-pdb-unknown", Severity::Warning, at(number, 13), message);
            Element::UNKNOWN
        }
    }
}

/// The residue of the last atom, and the mark of the location that was kept.
#[derive(Default)]
struct Residue {
    /// Chain, number and insertion code: columns 22 to 27. Not the name, which alternatives may change.
    key: [u8; 6],
    kept: Option<u8>,
}

impl Residue {
    /// Whether an atom stands at another location than the one that its residue named first.
    fn is_other_place(&mut self, line: &[u8]) -> bool {
        let mut key = [b' '; 6];
        for (own, &given) in key.iter_mut().zip(columns(line, 22, 27)) {
            *own = given;
        }
        if key != self.key {
            *self = Self { key, kept: None };
        }
        match columns(line, 17, 17) {
            [] | [b' '] => false,
            [mark, ..] => *self.kept.get_or_insert(*mark) != *mark,
        }
    }
}
