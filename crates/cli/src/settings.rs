//! `--set`: options of files, and of converters.

use shapeloom_convert::{Converter, registry};
use shapeloom_core::{OptionSpec, Options};
use shapeloom_io::{FORMATS, Format, ReadOptions, WriteOptions};

use crate::failure::Failure;

/// Settings told apart by what they are for.
pub(crate) struct Settings {
    read: Vec<(String, String)>,
    /// Those that reading and some converter have: they are reading's where the input's format heeds them.
    either: Vec<(String, String)>,
    write: Vec<(String, String)>,
    /// Those that reading and writing have, with a value that neither has.
    wrong: Vec<(String, String)>,
    others: Vec<(String, String)>,
    /// Whether they are for several inputs, each of which heeds what means something for it.
    shared: bool,
}

fn has(specs: &[OptionSpec], key: &str) -> bool {
    specs.iter().any(|spec| spec.name == key)
}

impl Settings {
    /// A key that reading or writing has is theirs, with or without `read.` or `write.` before it. One that both have is
    /// that of the one which knows the value.
    pub(crate) fn sort(settings: &[(String, String)]) -> Self {
        let mut sorted = Self {
            read: Vec::new(),
            either: Vec::new(),
            write: Vec::new(),
            wrong: Vec::new(),
            others: Vec::new(),
            shared: false,
        };
        for (key, value) in settings {
            let setting = |key: &str| (key.to_owned(), value.clone());
            if let Some(key) = key.strip_prefix("read.") {
                sorted.read.push(setting(key));
            } else if let Some(key) = key.strip_prefix("write.") {
                sorted.write.push(setting(key));
            } else if has(&ReadOptions::specs(), key)
                && (!has(&WriteOptions::specs(), key) || ReadOptions::new().set(key, value).is_ok())
            {
                let converters = registry().iter().any(|converter| has(&converter.specs(), key));
                if converters { sorted.either.push(setting(key)) } else { sorted.read.push(setting(key)) }
            } else if has(&WriteOptions::specs(), key) {
                let both = has(&ReadOptions::specs(), key) && WriteOptions::new().set(key, value).is_err();
                if both { sorted.wrong.push(setting(key)) } else { sorted.write.push(setting(key)) }
            } else {
                sorted.others.push(setting(key));
            }
        }
        sorted
    }

    /// The same for several inputs; then [`Settings::check_heeded`] must follow.
    pub(crate) fn for_several(settings: &[(String, String)]) -> Self {
        Self { shared: true, ..Self::sort(settings) }
    }

    /// Refuses options of reading that mean nothing for any of several inputs.
    pub(crate) fn check_heeded(&self, formats: &[&Format]) -> Result<(), Failure> {
        let heeds =
            |key: &str| key == "drop_non_finite" || formats.iter().any(|format| format.read_options.contains(&key));
        match (self.read.iter().find(|(key, _)| !heeds(key)), formats.first()) {
            (Some((key, _)), Some(format)) => heeded(key, format, |format| format.read_options),
            _ => Ok(()),
        }
    }

    /// The same where nothing is read: what is not for writing is for the shape that is made.
    pub(crate) fn of_made(settings: &[(String, String)]) -> Self {
        let mut sorted = Self::sort(&[]);
        for (key, value) in settings {
            let setting = |key: &str| (key.to_owned(), value.clone());
            match key.strip_prefix("write.") {
                Some(key) => sorted.write.push(setting(key)),
                None if has(&WriteOptions::specs(), key) => sorted.write.push(setting(key)),
                None => sorted.others.push(setting(key)),
            }
        }
        sorted
    }

    /// Settings of a shape that is made.
    pub(crate) fn making(&self) -> &[(String, String)] {
        &self.others
    }

    /// Settings of converters, for an input of this format.
    pub(crate) fn converting(&self, format: &Format) -> Vec<(String, String)> {
        let left = self.either.iter().filter(|(key, _)| !format.read_options.contains(&key.as_str()));
        self.others.iter().chain(left).cloned().collect()
    }

    /// How an input of this format is read.
    ///
    /// # Errors
    /// A value that the option does not have, an option that means nothing for the format, or a key that nothing has and
    /// that is nearly one that something has.
    pub(crate) fn reading(&self, format: &Format, drop_non_finite: bool) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions { drop_non_finite, ..ReadOptions::new() };
        for (key, value) in &self.read {
            options.set(key, value)?;
            if key != "drop_non_finite" && !self.shared {
                heeded(key, format, |format| format.read_options)?;
            }
        }
        for (key, value) in self.either.iter().filter(|(key, _)| format.read_options.contains(&key.as_str())) {
            options.set(key, value)?;
        }
        if let Some((key, value)) = self.wrong.first() {
            return Err(wrong(key, value, format));
        }
        self.others.iter().try_for_each(|(key, _)| check_spelling(key))?;
        Ok(options)
    }

    /// How an output of this format is written.
    pub(crate) fn writing(&self, format: &Format) -> Result<WriteOptions, Failure> {
        let mut options = WriteOptions::new();
        for (key, value) in self.write.iter().chain(&self.wrong) {
            options.set(key, value)?;
            heeded(key, format, |format| format.write_options)?;
        }
        Ok(options)
    }

    /// Refuses settings of outputs where nothing but a picture is made.
    pub(crate) fn no_writing(&self) -> Result<(), Failure> {
        match self.write.first() {
            Some((key, _)) => {
                let message = format!("found --set {key}, which is for outputs in a file format, expected none here");
                Err(Failure::usage("E-usage-setting", message))
            }
            None => Ok(()),
        }
    }
}

/// A value that an option has neither for reading nor for writing, where an input of this format is read.
fn wrong(key: &str, value: &str, format: &Format) -> Failure {
    let kind = |specs: Vec<OptionSpec>| {
        specs.iter().find(|spec| spec.name == key).map_or_else(String::new, |spec| spec.kind.to_string())
    };
    let (read, write) = (kind(ReadOptions::specs()), kind(WriteOptions::specs()));
    let reading = if format.read_options.contains(&key) {
        format!("{read} to read {}, or {write} to write", format.id)
    } else {
        let others: Vec<&str> =
            FORMATS.iter().filter(|format| format.read_options.contains(&key)).map(|format| format.id).collect();
        format!("{write} to write, or {read} to read {}", others.join(", "))
    };
    Failure::usage("E-option-text", format!("option {key}: found \"{value}\", expected {reading}"))
}

/// Refuses an option that means nothing for a format.
fn heeded(key: &str, format: &Format, heeds: impl Fn(&Format) -> &'static [&'static str]) -> Result<(), Failure> {
    if heeds(format).contains(&key) {
        return Ok(());
    }
    let others: Vec<&str> =
        FORMATS.iter().filter(|format| heeds(format).contains(&key)).map(|format| format.id).collect();
    let message = format!("found --set {key} for {}, expected it for one of: {}", format.id, others.join(", "));
    Err(Failure::usage("E-usage-setting", message))
}

/// Refuses a key that nothing has if it is nearly the name of an option. What is like none is told later, with the
/// options that are on the way.
fn check_spelling(key: &str) -> Result<(), Failure> {
    let mut known: Vec<&str> = ReadOptions::specs().iter().map(|spec| spec.name).collect();
    known.extend(registry().iter().flat_map(Converter::specs).map(|spec| spec.name));
    known.extend(WriteOptions::specs().iter().map(|spec| spec.name));
    if key.contains('.') || known.contains(&key) {
        return Ok(());
    }
    let nearest = known.into_iter().map(|name| (distance(key, name), name)).min();
    match nearest {
        // A third of the letters at most, so that what is merely short is like nothing.
        Some((changes, name)) if changes * 3 <= name.len() => {
            let message = format!("found --set {key}, which nothing has, expected a known option such as {name}");
            Err(Failure::usage("E-usage-setting", message))
        }
        _ => Ok(()),
    }
}

/// How many letters must be put in, taken out, replaced or swapped with their neighbour to make one word of another
/// (F. J. Damerau, "A technique for computer detection and correction of spelling errors", 1964).
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let least = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    least.min(rows[i - 2][j - 2] + 1)
                } else {
                    least
                }
            };
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_io::format_by_id;

    fn settings(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn words_are_as_far_apart_as_their_typing_errors() {
        for (a, b, changes) in [
            ("height", "height", 0),
            ("heigth", "height", 1),
            ("hight", "height", 1),
            ("weld", "world", 2),
            ("", "ab", 2),
        ] {
            assert_eq!((distance(a, b), distance(b, a)), (changes, changes), "{a} {b}");
        }
    }

    #[test]
    fn a_value_that_neither_has_is_told_with_those_of_reading() {
        let sorted = Settings::sort(&settings(&[("encoding", "typo")]));
        let (png, ply) = (format_by_id("png").unwrap(), format_by_id("ply").unwrap());
        let told = |format| format!("{:?}", sorted.reading(format, false).unwrap_err());
        let read = told(png);
        assert!(read.contains("E-option-text") && read.contains("typo"), "{read}");
        assert!(
            ["grey", "mapbox", "terrarium", "to read png", "ascii"].iter().all(|word| read.contains(word)),
            "{read}"
        );
        // Meshes have none to read.
        let other = told(ply);
        assert!(other.find("ascii") < other.find("mapbox") && other.contains("to read png"), "{other}");
        assert_eq!(sorted.writing(ply).unwrap_err().exit_code(), 2);
        let prefixed = Settings::sort(&settings(&[("read.encoding", "typo")]));
        assert!(!format!("{:?}", prefixed.reading(png, false).unwrap_err()).contains("ascii"));
    }

    #[test]
    fn a_key_of_reading_and_writing_goes_where_its_value_is_known() {
        let (png, ply) = (format_by_id("png").unwrap(), format_by_id("ply").unwrap());
        let sorted = Settings::sort(&settings(&[("encoding", "mapbox"), ("encoding", "ascii"), ("height", "3")]));
        let reading = sorted.reading(png, false).unwrap_or_else(|_| panic!("png reads both"));
        assert_eq!(reading.encoding, shapeloom_io::HeightEncoding::Mapbox);
        let writing = sorted.writing(ply).unwrap_or_else(|_| panic!("ply writes it"));
        assert_eq!(writing.encoding, shapeloom_io::Encoding::Ascii);
        assert!(sorted.converting(png).is_empty());
        let made = Settings::of_made(&settings(&[("height", "3"), ("encoding", "ascii"), ("turns", "2")]));
        assert_eq!(made.making().len(), 2);
    }
}
