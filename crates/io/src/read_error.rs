//! Why an input was not read.

use std::fmt;

use shapeloom_core::{Category, Diagnostic, OverBudget, Place, Stop};

/// What is wrong with an input, where, and what was expected there.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// A stable code such as `E-bpt-count`.
    pub code: &'static str,
    /// The broad kind of failure.
    pub category: Category,
    /// What the caller calls the input; empty until [`read`](crate::read()) has put it in.
    pub input: String,
    /// Where, in lines or bytes.
    pub place: Place,
    /// Where, in the format's own terms: `accessors[3].count`, `patch 2, control point 5`.
    pub within: Option<String>,
    /// What was found, quoted where it is text of the input.
    pub found: String,
    /// What was expected.
    pub expected: String,
    /// What to do about it, if that is known.
    pub advice: Option<String>,
}

impl Fault {
    /// A malformed input. Faults live in a box from the start: results that carry one stay small.
    pub fn new(code: &'static str, place: Place, found: impl Into<String>, expected: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            code,
            category: Category::Malformed,
            input: String::new(),
            place,
            within: None,
            found: found.into(),
            expected: expected.into(),
            advice: None,
        })
    }

    /// The same with the place in the format's own terms.
    #[must_use]
    pub fn within(mut self: Box<Self>, within: impl Into<String>) -> Box<Self> {
        self.within = Some(within.into());
        self
    }

    /// The same as another kind of failure.
    #[must_use]
    pub fn category(mut self: Box<Self>, category: Category) -> Box<Self> {
        self.category = category;
        self
    }

    /// The same with advice.
    #[must_use]
    pub fn advice(mut self: Box<Self>, advice: impl Into<String>) -> Box<Self> {
        self.advice = Some(advice.into());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.input.is_empty() { "input" } else { &self.input })?;
        if self.place != Place::Whole {
            write!(f, ": {}", self.place)?;
        }
        if let Some(within) = &self.within {
            write!(f, ": {within}")?;
        }
        write!(f, ": found {}, expected {} ({})", self.found, self.expected, self.code)
    }
}

/// Why an input was not read: it is at fault, or the caller's [`Exec`](shapeloom_core::Exec) stopped the reader.
#[derive(Clone, Debug, PartialEq)]
pub enum ReadError {
    /// Something is wrong with the input.
    Input(Box<Fault>),
    /// The caller stopped it.
    Stop(Stop),
    /// The memory budget does not have what the input needs.
    OverBudget(OverBudget),
}

impl ReadError {
    /// What is wrong with the input, if that is the reason.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Input(fault) => Some(fault),
            Self::Stop(_) | Self::OverBudget(_) => None,
        }
    }

    /// The same error with the name of the input, where it has none yet.
    #[must_use]
    pub fn in_input(mut self, name: &str) -> Self {
        if let Self::Input(fault) = &mut self
            && fault.input.is_empty()
        {
            name.clone_into(&mut fault.input);
        }
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(fault) => fault.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
            Self::OverBudget(over) => over.fmt(f),
        }
    }
}

impl std::error::Error for ReadError {}

impl Diagnostic for ReadError {
    fn code(&self) -> &'static str {
        match self {
            Self::Input(fault) => fault.code,
            Self::Stop(stop) => stop.code(),
            Self::OverBudget(over) => over.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Input(fault) => fault.category,
            Self::Stop(stop) => stop.category(),
            Self::OverBudget(over) => over.category(),
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::Input(fault) => fault.advice.clone().or_else(|| usual_advice(fault.code).map(str::to_owned)),
            Self::Stop(stop) => stop.advice(),
            Self::OverBudget(_) => Some("raise the memory limit, or read a smaller file".into()),
        }
    }
}

/// What to do about an error of which nothing more is known than its kind: the last word of its code.
fn usual_advice(code: &str) -> Option<&'static str> {
    Some(match code.rsplit('-').next()? {
        "truncated" | "length" | "buffer" => {
            "get a complete copy of the file: this one was cut off, or its header is wrong"
        }
        "claim" | "bounds" | "chunk" => {
            "get a complete copy of the file, or mend the number that promises more than it holds"
        }
        "count" | "degree" => "mend this number; it must be a whole number that agrees with what follows",
        "number" => "write decimal numbers with a point, such as -1.5e3, apart by blanks",
        // Where leaving vertices out helps, the reader says so.
        "finite" => "mend this number: it must be finite",
        "index" | "reference" => "mend the index, or remove the element that has it",
        "row" => "make the row complete, one row a line, or mend what the header says of it",
        "header" | "format" | "type" | "duplicate" | "property" => {
            "mend the header; `shapeloom explain` says what it must have"
        }
        "magic" => "name the right format if the file is another one than its name says",
        "version" | "extension" | "feature" | "dimension" | "mode" => {
            "export the file anew without it, or convert it with another program"
        }
        "limit" | "elements" => "cut the file into parts, or make it smaller with the program that wrote it",
        "line" => "break the line into shorter ones, or get another copy: text has no lines of this length",
        "strip" => "get a complete copy of the file, or write it anew with another program",
        "spacing" => "mend the distances between samples in the header: they are above 0",
        "stack" => "give the slices one size and depth, and names with numbers that follow each other",
        "trailing" => "mend the sizes or the type in the header, or get another copy of the file",
        "xml" => "mend the text at this place: it is no XML",
        "json" => "mend the text at this place: it is no JSON",
        "missing" | "uri" | "path" => "put the file where it is looked for, or export with everything in one file",
        "cycle" | "parents" | "depth" | "sparse" | "order" => "export the file anew: it breaks a rule of its format",
        "color" | "weight" | "mesh" | "patch" => "mend the value in the file, or export it anew",
        "checksum" | "data" => "get the file again: what it holds was damaged",
        "size" => {
            "use a picture or grid of at least two columns and two rows, or a volume of a sample in each direction"
        }
        "option" => "leave the option out, or give it a value that `shapeloom explain` allows",
        "channels" => "save the picture in grey, or say how its colours encode heights",
        "maxval" | "value" | "cell" | "grid" | "profile" | "spread" => "mend this number, or export the file anew",
        "io" => "check that the input can be read",
        _ => return None,
    })
}

impl From<Box<Fault>> for ReadError {
    fn from(fault: Box<Fault>) -> Self {
        Self::Input(fault)
    }
}

impl From<Stop> for ReadError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<OverBudget> for ReadError {
    fn from(over: OverBudget) -> Self {
        Self::OverBudget(over)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the format, an error says what to do.
    #[test]
    fn every_error_of_reading_has_advice() {
        for (code, _) in crate::EXPLANATIONS.iter().filter(|(code, _)| code.starts_with("E-")) {
            if !matches!(code.split('-').nth(1), Some("write" | "format")) {
                let own = ["E-text-encoding", "E-obj-freeform", "E-read-format", "E-read-size"].contains(code);
                assert!(own || usual_advice(code).is_some(), "{code}");
            }
        }
    }

    /// No option raises a limit on elements, and readers that can leave something out say so themselves.
    #[test]
    fn no_advice_promises_an_option_that_does_nothing() {
        for (code, _) in crate::EXPLANATIONS.iter().filter(|(code, _)| code.starts_with("E-")) {
            let advice = usual_advice(code).unwrap_or_default();
            assert!(!advice.contains("raise the limit") && !advice.contains("drop"), "{code}: {advice}");
        }
    }

    #[test]
    fn errors_read_like_sentences() {
        let fault = Fault::new("E-bpt-number", Place::line(17), "\"abc\"", "a number");
        let error = ReadError::from(fault.clone()).in_input("teapot.bpt").in_input("other");
        assert_eq!(error.to_string(), "teapot.bpt: line 17: found \"abc\", expected a number (E-bpt-number)");
        let within = ReadError::from(fault.within("patch 0"));
        assert_eq!(within.to_string(), "input: line 17: patch 0: found \"abc\", expected a number (E-bpt-number)");
        assert_eq!(ReadError::from(Stop::Cancelled).category(), Category::Cancelled);
    }
}
