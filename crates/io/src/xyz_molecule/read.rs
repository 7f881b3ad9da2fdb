//! Reading XYZ files of molecules.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_implicit::{Atom, Element, Molecule};

use crate::read_molecule::{Atoms, at, coordinate, read_with};
use crate::text::{Text, end_place, lossy, parse_count, quoted};
use crate::{Fault, ReadContext, ReadError, ReadMolecule};

/// Comments are cut here.
const TITLE: usize = 4096;

/// Whether an XYZ file is a molecule: its first line is a lone count, and its third begins with the symbol of an element. Looks at the first
/// 64 KiB.
pub fn looks_like_xyz_molecule(input: &[u8]) -> bool {
    let head = crate::detect::head(input);
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let mut lines = head.split(|&byte| byte == b'\n');
    let (Some(count), Some(_), Some(atom)) = (lines.next(), lines.next(), lines.next()) else { return false };
    let symbol = atom.trim_ascii().split(u8::is_ascii_whitespace).next().unwrap_or_default();
    parse_count(count.trim_ascii()).is_ok()
        && std::str::from_utf8(symbol).is_ok_and(|s| Element::from_symbol(s).is_some())
}

/// The atoms of an XYZ file, in ångströms; the comment is the title.
///
/// # Errors
/// A first line that is no lone count above 0, a coordinate that is no finite number, fewer atoms than counted, limits and budgets passed,
/// cancelled; each of the file's faults with line and column.
pub fn read_xyz_molecule(input: &[u8], context: &ReadContext) -> Result<ReadMolecule, ReadError> {
    read_with(input, context, |text| read(text, context))
}

fn read(text: &[u8], context: &ReadContext) -> Result<ReadMolecule, ReadError> {
    let mut findings = Findings::default();
    let mut lines = Text::try_new(text, &context.limits)?.lines();
    let first = lines.next_line()?.map(|line| line.bytes.trim_ascii()).unwrap_or_default();
    let count = parse_count(first).ok().filter(|&count| count > 0).ok_or_else(|| {
        let found = if first.is_empty() { "nothing".to_owned() } else { quoted(first) };
        Fault::new("E-molecule-count", Place::line(1), found, "the number of atoms, at least 1")
    })?;
    let comment = lines.next_line()?.map(|line| line.bytes.trim_ascii()).unwrap_or_default();
    let title = lossy(&comment[..comment.len().min(TITLE)], Place::line(2), &mut findings).into_owned();
    let mut atoms = Atoms::new(context, "E-molecule-limit");
    while (atoms.len() as u64) < count {
        if atoms.len().is_multiple_of(1024) {
            context.exec.check()?;
            context.exec.progress(atoms.len() as f64 / count as f64);
        }
        let Some(line) = lines.next_line()? else {
            let found = format!("the end of the file after {} atoms", atoms.len());
            let expected = format!("{count} atoms, as the first line says");
            return Err(Fault::new("E-molecule-truncated", end_place(text), found, expected).into());
        };
        let mut words = Words { line: line.bytes, at: 0 };
        let (column, word) = words.next();
        let element = element(word, at(line.number, column), &mut findings);
        let mut position = DVec3::ZERO;
        for axis in 0..3 {
            let (column, word) = words.next();
            let codes = ["E-molecule-number", "E-molecule-finite"];
            position[axis] = coordinate(word, at(line.number, column), axis, codes)?;
        }
        atoms.push(Atom { element, position }, Place::line(line.number))?;
    }
    while let Some(line) = lines.next_line()? {
        if line.number.is_multiple_of(1024) {
            context.exec.check()?;
        }
        if !line.bytes.trim_ascii().is_empty() {
            let again = parse_count(line.bytes.trim_ascii()).is_ok();
            let what = if again { "another frame" } else { "more lines" };
            let message = format!("found {what} after the atoms that were counted; the rest was not read");
            findings.push("W-molecule-frames", Severity::Warning, Place::line(line.number), message);
            break;
        }
    }
    Ok(ReadMolecule { molecule: Molecule { atoms: atoms.into_vec(), title }, findings })
}

/// The words of a line with their columns, counted from 1.
struct Words<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// The next word; empty at the end of the line.
    fn next(&mut self) -> (usize, &'a [u8]) {
        let rest = self.line.get(self.at..).unwrap_or_default();
        let start = self.at + rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let rest = self.line.get(start..).unwrap_or_default();
        let length = rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        self.at = start + length;
        (start + 1, &rest[..length])
    }
}

/// An element by symbol, atomic number, or a label that begins with a symbol, such as `C12`.
fn element(word: &[u8], place: Place, findings: &mut Findings) -> Element {
    let symbol = |bytes: &[u8]| std::str::from_utf8(bytes).ok().and_then(Element::from_symbol);
    if let Some(element) = symbol(word) {
        return element;
    }
    let number = parse_count(word).ok().and_then(|number| u32::try_from(number).ok());
    if let Some(element) = number.and_then(Element::from_atomic_number) {
        return element;
    }
    let letters = word.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    if let Some(element) = symbol(&word[..letters]) {
        let message = format!("{} was taken as a label of {}", quoted(word), element.symbol());
        findings.push("W-molecule-label", Severity::Note, place, message);
        return element;
    }
    let message = format!("{} is no element: the atom counts as unknown", quoted(word));
    findings.push("W-molecule-unknown", Severity::Warning, place, message);
    Element::UNKNOWN
}
