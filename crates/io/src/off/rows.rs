//! Rows of a text: a vertex or a face each.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Place, Severity};

use super::NO_INDEX;
use super::body::{Body, Layout};
use super::color::{Channel, stored};
use super::counts::Counts;
use crate::memory::Memory;
use crate::text::{CountFault, NumberFault, Scanner, end_place, parse_count, parse_number, quoted};
use crate::{Fault, ReadContext, ReadError};

/// The most numbers of a vertex: four coordinates, a normal, a colour, texture coordinates.
const MOST: usize = 13;

/// Numbers that a comment may follow without a space.
pub(super) trait NumberText {
    fn number_text(&mut self) -> Result<f64, NumberFault>;
}

impl NumberText for Scanner<'_> {
    #[inline]
    fn number_text(&mut self) -> Result<f64, NumberFault> {
        self.number().or_else(|fault| match before_comment(self) {
            Some(word) => {
                let value = parse_number(word)?;
                self.advance(word.len());
                Ok(value)
            }
            None => Err(fault),
        })
    }
}

/// A whole number that a comment may follow without a space.
#[inline]
pub(super) fn whole(scan: &mut Scanner<'_>) -> Result<u64, CountFault> {
    scan.count().or_else(|fault| match before_comment(scan) {
        Some(word) => {
            let value = parse_count(word)?;
            scan.advance(word.len());
            Ok(value)
        }
        None => Err(fault),
    })
}

/// The next word up to the comment that begins in it, if one does.
#[cold]
fn before_comment<'a>(scan: &mut Scanner<'a>) -> Option<&'a [u8]> {
    scan.skip_blanks();
    let word = scan.clone().word();
    memchr::memchr(b'#', word).filter(|&at| at > 0).map(|at| &word[..at])
}

/// How many words are left on the line, comments not counted.
pub(super) fn words_left(scan: &Scanner<'_>) -> usize {
    let mut ahead = scan.clone();
    let mut count = 0;
    while !ahead.at_line_end_or_comment() {
        count += 1;
        if ahead.word().contains(&b'#') {
            break;
        }
    }
    count
}

/// How many lines from an offset on have words, counted up to `most`.
pub(super) fn lines_with_words(text: &[u8], from: usize, most: u64) -> u64 {
    let mut scan = Scanner::new(text, from);
    let mut count = 0;
    while count < most && scan.skip_empty_lines() {
        count += 1;
        scan.next_line();
    }
    count
}

/// What of a file is in rows.
pub(super) struct Rows<'a> {
    pub text: &'a [u8],
    pub layout: Layout,
    /// Whether the colours of vertices are a guess from the number of columns.
    pub guessed_color: bool,
    pub counts: Counts,
    pub context: &'a ReadContext,
}

/// Reads rows.
pub(super) struct Reader<'a> {
    pub rows: &'a Rows<'a>,
    pub scan: Scanner<'a>,
    /// The row that comes next, counted from the first vertex on.
    pub row: u64,
    /// Whether vertices lie several on a line.
    pub vertices_joined: bool,
    /// Whether faces lie several on a line; not known before the first one.
    pub faces_joined: Option<bool>,
    pub memory: Memory<'a>,
    pub body: Body,
    corners: Vec<u32>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(rows: &'a Rows<'a>, scan: Scanner<'a>, row: u64) -> Self {
        let memory = Memory::new(&rows.context.exec);
        let (body, corners) = (Body::default(), Vec::new());
        Self { rows, scan, row, vertices_joined: false, faces_joined: None, memory, body, corners }
    }

    /// Reads all rows that are there.
    pub(super) fn run(&mut self) -> Result<(), ReadError> {
        let Counts { vertices, faces } = self.rows.counts;
        let plain = self.rows.layout.numbers() == 3 && self.rows.layout.dimension == 3 && !self.vertices_joined;
        while self.scan.skip_empty_lines() {
            if self.row < vertices {
                if plain {
                    self.plain_vertex()?;
                } else {
                    self.vertex()?;
                }
            } else if self.row - vertices < faces {
                self.face()?;
            } else {
                let message = "what follows after the last face was not read";
                self.body.findings.push("W-off-trailing", Severity::Warning, self.scan.place(), message);
                return Ok(());
            }
            self.row += 1;
            if self.row.is_multiple_of(4096) {
                self.rows.context.exec.check()?;
            }
        }
        Ok(())
    }

    /// A vertex of three coordinates and nothing else, on a line of its own.
    #[inline]
    fn plain_vertex(&mut self) -> Result<(), ReadError> {
        let [x, y, z] = [self.coordinate()?, self.coordinate()?, self.coordinate()?];
        self.body.positions.push(&mut self.memory, DVec3::new(x, y, z))?;
        self.end_of_vertex()
    }

    fn vertex(&mut self) -> Result<(), ReadError> {
        let layout = &self.rows.layout;
        let mut numbers = [0.0; MOST];
        let place = self.scan.place();
        let spatial = layout.dimension + usize::from(layout.weight);
        for value in &mut numbers[..spatial] {
            *value = self.coordinate()?;
        }
        let mut position = [0.0; 3];
        position[..layout.dimension].copy_from_slice(&numbers[..layout.dimension]);
        let mut position = DVec3::from_array(position);
        if layout.weight {
            position = self.projected(position, numbers[layout.dimension], place.clone())?;
        }
        let beside = layout.beside();
        let (mut at, mut odd) = (0, false);
        while at < beside {
            if at == layout.color_at() && layout.color > 0 {
                let color = self.color(layout.color)?;
                numbers[at..at + layout.color].copy_from_slice(&color[..layout.color]);
                at += layout.color;
            } else {
                numbers[at] = self.beside()?;
                odd |= !numbers[at].is_finite();
                at += 1;
            }
        }
        if odd {
            self.body.odd_numbers(place);
        }
        self.body.positions.push(&mut self.memory, position)?;
        self.body.beside.extend(&mut self.memory, &numbers[..beside])?;
        self.end_of_vertex()
    }

    #[inline]
    fn end_of_vertex(&mut self) -> Result<(), ReadError> {
        if self.scan.at_line_end_or_comment() {
            self.scan.next_line();
        } else if !self.vertices_joined {
            return Err(self.too_many_numbers());
        }
        Ok(())
    }

    fn projected(&self, position: DVec3, weight: f64, place: Place) -> Result<DVec3, ReadError> {
        let within = || format!("vertex {}", self.row);
        if weight == 0.0 {
            let fault = Fault::new("E-off-weight", place, "the weight 0", "a homogeneous weight that is not zero");
            return Err(fault.within(within()).advice("a point of weight 0 is infinitely far away").into());
        }
        let point = position / weight;
        if !point.is_finite() && !self.rows.context.options.drop_non_finite {
            let found = format!("the weight {weight}, by which the position is not finite");
            return Err(Fault::new("E-off-finite", place, found, "a finite position")
                .within(within())
                .advice(crate::audit::DROP_ADVICE)
                .into());
        }
        Ok(point)
    }

    #[inline]
    fn coordinate(&mut self) -> Result<f64, ReadError> {
        match self.scan.number_text() {
            Ok(number) => Ok(number),
            Err(fault) => self.no_coordinate(fault),
        }
    }

    /// A number that is no coordinate, which need not be finite.
    #[inline]
    fn beside(&mut self) -> Result<f64, ReadError> {
        match self.scan.number_text() {
            Ok(number) => Ok(number),
            Err(NumberFault::Syntax) => self.no_coordinate(NumberFault::Syntax),
            Err(_) => Ok(self.odd_word()),
        }
    }

    /// Passes over a word that is a number, but not a finite one.
    #[cold]
    fn odd_word(&mut self) -> f64 {
        self.scan.skip_blanks();
        let word = self.scan.clone().word();
        let word = &word[..memchr::memchr(b'#', word).unwrap_or(word.len())];
        self.scan.advance(word.len());
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.filter(|number: &f64| !number.is_finite()).unwrap_or(f64::NAN)
    }

    #[cold]
    fn no_coordinate(&mut self, fault: NumberFault) -> Result<f64, ReadError> {
        let vertex = format!("vertex {}", self.row);
        let expected = format!("{} numbers ({})", self.rows.layout.numbers(), self.rows.layout.words());
        let place = self.scan.place();
        if self.scan.at_line_end_or_comment() {
            return Err(self.row_ends(vertex, &expected));
        }
        let found = self.scan.found();
        if fault == NumberFault::Syntax {
            let error = Fault::new("E-off-number", place, found, expected).within(vertex);
            return Err(match self.scan.word().contains(&b',') {
                true => error.advice("numbers have a decimal point, not a comma").into(),
                false => error.into(),
            });
        }
        if self.rows.context.options.drop_non_finite {
            return Ok(self.odd_word());
        }
        let error = Fault::new("E-off-finite", place, found, "a finite number of at most 1.8e308").within(vertex);
        Err(error.advice(crate::audit::DROP_ADVICE).into())
    }

    /// A row that stops before it is complete.
    #[cold]
    fn row_ends(&self, within: String, expected: &str) -> ReadError {
        let mut ahead = self.scan.clone();
        if ahead.skip_blanks().is_none() && ahead.offset() >= self.rows.text.len() {
            let place = end_place(self.rows.text);
            return Fault::new("E-off-truncated", place, "the end of the file", expected).within(within).into();
        }
        let fault = Fault::new("E-off-row", self.scan.place(), "the end of the line", expected).within(within);
        fault.advice("each vertex and each face is on one line; a number may be missing").into()
    }

    #[cold]
    fn too_many_numbers(&self) -> ReadError {
        let layout = &self.rows.layout;
        let numbers = layout.numbers();
        let found = format!("{} numbers", numbers + words_left(&self.scan));
        let expected = format!("{numbers} ({})", layout.words());
        let promised = self.rows.counts.vertices;
        let fault = Fault::new("E-off-row", self.scan.place(), found, expected).within(format!("vertex {}", self.row));
        let advice = match self.row {
            0 => "say in the keyword what follows after the position: NOFF, COFF, STOFF".to_owned(),
            before => format!(
                "the header promises {promised} vertices and {before} came before: if this line is a face, a vertex is \
                 missing or the number is wrong"
            ),
        };
        fault.advice(advice).into()
    }

    /// A colour of as many channels.
    fn color(&mut self, channels: usize) -> Result<[f64; 4], ReadError> {
        let mut found = [Channel::Whole(0); 4];
        let place = self.scan.place();
        for channel in &mut found[..channels] {
            *channel = self.channel()?;
        }
        let found = &found[..channels];
        match stored(found) {
            Some(color) if color[0].is_nan() => {
                self.body.odd_color(place);
                Ok(color)
            }
            Some(color) => {
                self.body.vertex_colors.note(found);
                Ok(color)
            }
            None if self.rows.guessed_color => {
                let found = format!("{} numbers", self.rows.layout.numbers());
                let fault = Fault::new("E-off-row", place, found, "3 (x y z)").within(format!("vertex {}", self.row));
                Err(fault.advice("say in the keyword what follows after the position: NOFF, COFF, STOFF").into())
            }
            None => Err(no_color(place, format!("vertex {}", self.row))),
        }
    }

    fn channel(&mut self) -> Result<Channel, ReadError> {
        if let Ok(number) = whole(&mut self.scan) {
            return Ok(Channel::Whole(number));
        }
        if self.row < self.rows.counts.vertices {
            return Ok(Channel::Fraction(self.beside()?));
        }
        let place = self.scan.place();
        let found = self.scan.found();
        match self.scan.number_text() {
            Ok(number) => Ok(Channel::Fraction(number)),
            Err(NumberFault::Syntax) => {
                Err(Fault::new("E-off-number", place, found, "a channel of the colour of a face").into())
            }
            Err(_) => Ok(Channel::Fraction(self.odd_word())),
        }
    }

    fn face(&mut self) -> Result<(), ReadError> {
        let start = self.scan.offset();
        let corners = match whole(&mut self.scan) {
            Ok(corners) => corners,
            Err(_) => return Err(self.no_index("the number of corners of a face")),
        };
        if corners == 3 {
            let triangle = [self.corner()?, self.corner()?, self.corner()?];
            if self.scan.at_line_end_or_comment() {
                self.scan.next_line();
                return self.body.faces.push_triangle(&mut self.memory, triangle);
            }
            self.corners.clear();
            self.corners.extend_from_slice(&triangle);
        } else {
            self.check_corners(corners, start)?;
            self.corners.clear();
            for _ in 0..corners {
                let corner = self.corner()?;
                self.corners.push(corner);
            }
        }
        self.color_of_face(start, corners)?;
        if corners < 3 {
            return self.body.skip(&mut self.memory, Place::Byte(start as u64), corners);
        }
        self.body.faces.push(&mut self.memory, &self.corners)
    }

    fn check_corners(&self, corners: u64, start: usize) -> Result<(), ReadError> {
        let place = Place::Byte(start as u64);
        let left = (self.rows.text.len() - self.scan.offset()) as u64;
        if corners.saturating_mul(2) > left + 1 {
            let found = format!("a face of {corners} corners");
            let expected = format!("no more than the {left} bytes that follow can hold");
            return Err(Fault::new("E-off-claim", place, found, expected).into());
        }
        let most = u64::from(self.rows.context.limits.max_polygon);
        if corners > most {
            let fault =
                Fault::new("E-off-limit", place, format!("{corners} corners"), format!("at most {most} corners"));
            return Err(fault.category(Category::OverLimit).into());
        }
        Ok(())
    }

    #[inline]
    fn corner(&mut self) -> Result<u32, ReadError> {
        match whole(&mut self.scan) {
            Ok(corner) if corner < self.rows.counts.vertices => Ok(corner as u32),
            Ok(corner) => Err(self.out_of_range(&corner.to_string())),
            Err(_) => Err(self.no_index("the number of a vertex")),
        }
    }

    #[cold]
    fn out_of_range(&self, found: &str) -> ReadError {
        let expected = match self.rows.counts.vertices {
            0 => "no faces, as there are no vertices".to_owned(),
            vertices => format!("the number of a vertex, 0 to {}", vertices - 1),
        };
        // It stands behind the number, on the same line.
        let place = Place::Byte((self.scan.offset() as u64).saturating_sub(1));
        let fault = Fault::new("E-off-index", place, found, expected);
        fault.within(self.face_words()).advice("vertices are counted from 0").into()
    }

    fn face_words(&self) -> String {
        format!("face {}", self.row.saturating_sub(self.rows.counts.vertices))
    }

    #[cold]
    fn no_index(&mut self, expected: &str) -> ReadError {
        if self.scan.at_line_end_or_comment() {
            return self.row_ends(self.face_words(), expected);
        }
        let word = self.scan.clone().word();
        if word.strip_prefix(b"-").is_some_and(|rest| parse_count(rest).is_ok()) {
            self.scan.advance(word.len());
            return self.out_of_range(&quoted(word));
        }
        Fault::new("E-off-number", self.scan.place(), self.scan.found(), expected).within(self.face_words()).into()
    }

    /// What follows after the corners of a face, up to the end of its line.
    fn color_of_face(&mut self, start: usize, corners: u64) -> Result<(), ReadError> {
        let words = words_left(&self.scan);
        if words > 0 && self.joined(start, corners as usize + 1 + words) {
            return Ok(());
        }
        let place = self.scan.place();
        match words {
            0 => {}
            1 => {
                let channel = self.channel()?;
                let index = match channel {
                    Channel::Whole(index) if index < u64::from(NO_INDEX) => index as u32,
                    _ => {
                        let fault = Fault::new("E-off-color", place, "no index", "an index into a colour map");
                        return Err(fault.within(self.face_words()).into());
                    }
                };
                if corners >= 3 {
                    self.body.put_index(&mut self.memory, index)?;
                }
            }
            3 | 4 => {
                let mut found = [Channel::Whole(0); 4];
                for channel in &mut found[..words] {
                    *channel = self.channel()?;
                }
                let found = &found[..words];
                let color = stored(found).ok_or_else(|| no_color(place.clone(), self.face_words()))?;
                if color[0].is_nan() {
                    self.body.odd_color(place);
                } else if corners >= 3 {
                    let face = self.body.faces.len();
                    self.body.face_colors.put(&mut self.memory, face, color, found)?;
                }
            }
            words => {
                let found = format!("{words} numbers after the corners");
                let fault = Fault::new("E-off-row", place, found, "none, an index, or a colour of 3 or 4 numbers");
                return Err(fault.within(self.face_words()).into());
            }
        }
        self.scan.next_line();
        Ok(())
    }

    /// Whether faces lie several on a line: there are fewer lines than faces, and the line of this one, which begins at
    /// `start` and has as many words, is nothing but faces.
    fn joined(&mut self, start: usize, words: usize) -> bool {
        if let Some(known) = self.faces_joined {
            return known;
        }
        let faces = self.rows.counts.faces - (self.row - self.rows.counts.vertices);
        let mut scan = Scanner::new(self.rows.text, start);
        let mut left = words;
        let mut on_line = 0;
        while left > 0 {
            let Ok(corners) = whole(&mut scan) else { break };
            if corners as usize >= left || corners == 0 {
                break;
            }
            (0..corners).for_each(|_| _ = scan.word());
            left -= corners as usize + 1;
            on_line += 1;
        }
        let joined = left == 0 && on_line > 1 && lines_with_words(self.rows.text, start, faces) < faces;
        self.faces_joined = Some(joined);
        joined
    }
}

#[cold]
fn no_color(place: Place, within: String) -> ReadError {
    let expected = "fractions from 0, or whole numbers from 0 to 255";
    Fault::new("E-off-color", place, "a colour outside of its range", expected).within(within).into()
}
