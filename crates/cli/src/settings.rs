//! `--set`: options of files, and of converters.

use shapeloom_core::Options;
use shapeloom_io::{FORMATS, Format, ReadOptions, WriteOptions};

use crate::failure::Failure;

/// Settings told apart by what they are for.
pub(crate) struct Settings {
    read: Vec<(String, String)>,
    write: Vec<(String, String)>,
    /// Those of converters, or of a shape that is made.
    pub(crate) others: Vec<(String, String)>,
}

impl Settings {
    /// A key that reading or writing has is theirs, with or without `read.` or `write.` before it.
    pub(crate) fn sort(settings: &[(String, String)]) -> Self {
        let mut sorted = Self { read: Vec::new(), write: Vec::new(), others: Vec::new() };
        let has = |specs: Vec<shapeloom_core::OptionSpec>, key: &str| specs.iter().any(|spec| spec.name == key);
        for (key, value) in settings {
            let setting = |key: &str| (key.to_owned(), value.clone());
            if let Some(key) = key.strip_prefix("read.") {
                sorted.read.push(setting(key));
            } else if let Some(key) = key.strip_prefix("write.") {
                sorted.write.push(setting(key));
            } else if has(ReadOptions::specs(), key) {
                sorted.read.push(setting(key));
            } else if has(WriteOptions::specs(), key) {
                sorted.write.push(setting(key));
            } else {
                sorted.others.push(setting(key));
            }
        }
        sorted
    }

    /// How an input of this format is read.
    pub(crate) fn reading(&self, format: &Format, drop_non_finite: bool) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions { drop_non_finite, ..ReadOptions::new() };
        for (key, value) in &self.read {
            options.set(key, value)?;
            if key != "drop_non_finite" {
                heeded(key, format, |format| format.read_options)?;
            }
        }
        Ok(options)
    }

    /// How an output of this format is written.
    pub(crate) fn writing(&self, format: &Format) -> Result<WriteOptions, Failure> {
        let mut options = WriteOptions::new();
        for (key, value) in &self.write {
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
