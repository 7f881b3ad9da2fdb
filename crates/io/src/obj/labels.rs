//! What the statements `o`, `g`, `s` and `usemtl` say about faces, lines, points and vertices.

use std::collections::HashMap;
use std::ops::Range;

use shapeloom_core::{Findings, Place, Severity};

use super::read::Whole;
use super::statements::EventKind;
use crate::ReadError;
use crate::memory::Memory;
use crate::text::{Scanner, lossy, parse_count, quoted};

/// Names are repeated for every part that has them: longer ones would take memory out of proportion to the file.
const MOST_NAME: usize = 1024;

/// Names that occur, each once, the first one empty: what holds before any statement.
pub(super) struct Names {
    pub list: Vec<String>,
    known: HashMap<Vec<u8>, u32>,
}

impl Default for Names {
    fn default() -> Self {
        Self { list: vec![String::new()], known: HashMap::from([(Vec::new(), 0)]) }
    }
}

impl Names {
    fn id(
        &mut self,
        words: &[u8],
        place: Place,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<u32, ReadError> {
        // Several names are kept as one, a space between them. They are told apart by their bytes.
        let parts: Vec<&[u8]> = words.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
        let bytes = parts.join(&b' ');
        if let Some(&id) = self.known.get(&bytes) {
            return Ok(id);
        }
        memory.take(1, 4 * (bytes.len() + size_of::<String>()))?;
        let id = self.list.len() as u32;
        self.list.push(lossy(&bytes, place, findings).into_owned());
        self.known.insert(bytes, id);
        Ok(id)
    }
}

/// What holds for elements in a row.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Labels {
    pub object: u32,
    pub group: u32,
    pub smoothing: u32,
    pub material: u32,
}

/// Elements in a row for which the same holds.
#[derive(Clone)]
pub(super) struct Run {
    pub elements: Range<usize>,
    pub labels: Labels,
    /// Whether no corner of these faces names a texture coordinate, and whether none names a normal.
    pub bare: [bool; 2],
}

/// The statements of a whole file.
pub(super) struct Statements {
    /// Objects in the order of the file: every `o` begins one, even under a name that was there before.
    pub objects: Vec<String>,
    pub groups: Names,
    pub materials: Names,
    /// Material libraries as they are written, with where.
    pub libraries: Vec<(String, usize)>,
    /// Where a material was first used.
    pub material_places: Vec<usize>,
    pub faces: Vec<Run>,
    pub lines: Vec<Run>,
    pub points: Vec<Run>,
    pub vertices: Vec<Run>,
}

impl Statements {
    pub fn read(whole: &Whole<'_>, memory: &mut Memory<'_>, findings: &mut Findings) -> Result<Self, ReadError> {
        let mut all = Self {
            objects: vec![String::new()],
            groups: Names::default(),
            materials: Names::default(),
            libraries: Vec::new(),
            material_places: vec![0],
            faces: Vec::new(),
            lines: Vec::new(),
            points: Vec::new(),
            vertices: Vec::new(),
        };
        let mut labels = Labels::default();
        let mut from = [0usize; 4];
        for event in &whole.events {
            let mut words = &whole.text[event.start..event.end];
            let place = Place::Byte(event.start as u64);
            if words.len() > MOST_NAME && event.kind != EventKind::Library {
                let message = format!("a name of {} bytes was cut after {MOST_NAME}", words.len());
                findings.push("W-obj-name", Severity::Warning, place.clone(), message);
                words = &words[..MOST_NAME];
            }
            let mut next = labels;
            match event.kind {
                EventKind::Object => {
                    memory.take(1, 2 * (words.len() + size_of::<String>()))?;
                    next.object = all.objects.len() as u32;
                    all.objects.push(lossy(words, place, findings).into_owned());
                }
                EventKind::Group => next.group = all.groups.id(words, place, memory, findings)?,
                EventKind::Material => {
                    let none = words == super::NO_MATERIAL.as_bytes();
                    next.material = if none { 0 } else { all.materials.id(words, place, memory, findings)? };
                    if all.material_places.len() < all.materials.list.len() {
                        all.material_places.push(event.start);
                    }
                }
                EventKind::Smoothing => next.smoothing = smoothing(whole.text, event.start, words, findings),
                EventKind::Library => {
                    // Several files in one statement; a name with spaces is one where it is written so.
                    memory.take(1, 2 * (words.len() + size_of::<(String, usize)>()))?;
                    all.libraries.push((String::from_utf8_lossy(words).into_owned(), event.start));
                }
            }
            if next != labels {
                let here = [event.faces, event.lines, event.points, event.vertices].map(|count| count as usize);
                all.close(&mut from, here, labels, memory)?;
                labels = next;
            }
        }
        let ends = [whole.faces.len(), whole.line_ends.len(), whole.points.len(), whole.positions.len()];
        all.close(&mut from, ends, labels, memory)?;
        Ok(all)
    }

    fn close(
        &mut self,
        from: &mut [usize; 4],
        to: [usize; 4],
        labels: Labels,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let lists = [&mut self.faces, &mut self.lines, &mut self.points, &mut self.vertices];
        for (list, (from, to)) in lists.into_iter().zip(from.iter_mut().zip(to)) {
            if to > *from {
                memory.take(1, 2 * size_of::<Run>())?;
                list.push(Run { elements: *from..to, labels, bare: [true; 2] });
                *from = to;
            }
        }
        Ok(())
    }
}

fn smoothing(text: &[u8], start: usize, words: &[u8], findings: &mut Findings) -> u32 {
    let word = Scanner::new(words, 0).word();
    match parse_count(word) {
        Ok(number) if number <= u64::from(u32::MAX) => number as u32,
        _ if word.is_empty() || word.eq_ignore_ascii_case(b"off") => 0,
        _ => {
            let place = Scanner::new(text, start).place();
            let message = format!("smoothing group {} is neither a number nor off; off was taken", quoted(word));
            findings.push("W-obj-smoothing", Severity::Warning, place, message);
            0
        }
    }
}

/// Runs of the same object in a row.
pub(super) fn by_object(runs: &[Run]) -> impl Iterator<Item = &[Run]> {
    runs.chunk_by(|a, b| a.labels.object == b.labels.object)
}
