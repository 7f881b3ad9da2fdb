//! Reading inputs.

use std::fs::File;
use std::path::Path;

use shapeloom_io::{Format, ReadContext, ReadShape, detect, format_by_id, read, slurp};

use crate::failure::Failure;
use crate::session::Session;

/// A shape as it was read.
pub(crate) struct Input {
    /// What errors and messages call it.
    pub(crate) name: String,
    pub(crate) format: &'static Format,
    pub(crate) read: ReadShape,
    pub(crate) bytes: u64,
}

/// Whether a path means a standard stream.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a file or standard input, in the format named or else told by its content and extension.
pub(crate) fn open(path: &Path, from: Option<&str>, session: &mut Session<'_>) -> Result<Input, Failure> {
    session.stage("reading");
    let limits = session.limits();
    let (name, bytes) = if is_stream(path) {
        let name = "standard input".to_owned();
        (name, slurp(&mut session.streams.input, &limits).map_err(|error| Failure::from(error).about(path))?)
    } else {
        let file = File::open(path).map_err(|error| Failure::read(path, &error))?;
        if file.metadata().is_ok_and(|data| data.is_dir()) {
            let folder = std::io::Error::new(std::io::ErrorKind::IsADirectory, "it is a folder");
            return Err(Failure::read(path, &folder));
        }
        (path.display().to_string(), slurp(file, &limits).map_err(|error| Failure::from(error).about(path))?)
    };
    let exec = session.exec();
    let _memory = exec.reserve(bytes.len() as u64)?;
    let format = match from {
        Some(id) => format_by_id(id)?,
        None => {
            let file_name = (!is_stream(path)).then_some(name.as_str());
            detect(&bytes, file_name).map_err(|error| Failure::from(error).about(name.as_ref()))?
        }
    };
    let context = ReadContext { limits, exec, ..ReadContext::named(name.as_str()) };
    let read = read(&bytes, format, &context).map_err(|error| Failure::from(error).about(name.as_ref()))?;
    session.say_findings(&read.findings);
    for loss in &read.losses {
        session.say(format_args!("not read: {loss}"));
    }
    Ok(Input { name, format, read, bytes: bytes.len() as u64 })
}
