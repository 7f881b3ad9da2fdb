//! Reading inputs.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use shapeloom_io::{
    Format, ReadContext, ReadShape, SiblingError, SiblingName, Siblings, detect, format_by_id, read, slurp, slurp_sized,
};

use crate::arguments::SourceArguments;
use crate::failure::Failure;
use crate::session::Session;
use crate::settings::Settings;

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
pub(crate) fn open(
    path: &Path,
    source: &SourceArguments,
    settings: &Settings,
    session: &mut Session<'_>,
) -> Result<Input, Failure> {
    session.stage("reading");
    let limits = session.limits();
    let exec = session.exec();
    let (name, bytes) = if is_stream(path) {
        let name = "standard input".to_owned();
        let bytes = slurp(&mut session.streams.input, &limits, &exec);
        let bytes = bytes.map_err(|error| Failure::from(error).about(name.as_ref()))?;
        (name, bytes)
    } else {
        let file = File::open(path).map_err(|error| Failure::read(path, &error))?;
        let data = file.metadata().ok();
        if data.as_ref().is_some_and(|data| data.is_dir()) {
            let folder = std::io::Error::new(std::io::ErrorKind::IsADirectory, "it is a folder");
            return Err(Failure::read(path, &folder));
        }
        let hint = data.filter(|data| data.is_file()).map_or(0, |data| data.len());
        let bytes = slurp_sized(file, hint, &limits, &exec);
        (path.display().to_string(), bytes.map_err(|error| Failure::from(error).about(path))?)
    };
    let _memory = exec.reserve(bytes.len() as u64)?;
    let format = match source.from.as_deref() {
        Some(id) => format_by_id(id)?,
        None => {
            let file_name = (!is_stream(path)).then_some(name.as_str());
            detect(&bytes, file_name).map_err(|error| Failure::from(error).about(name.as_ref()))?
        }
    };
    let siblings: Option<Arc<dyn Siblings>> = match path.parent() {
        Some(folder) if !is_stream(path) => Some(Arc::new(Folder(folder.to_owned()))),
        _ => None,
    };
    let options = settings.reading(format, source.drop_non_finite)?;
    let context = ReadContext { limits, exec, siblings, options, ..ReadContext::named(name.as_str()) };
    let read = read(&bytes, format, &context).map_err(|error| Failure::from(error).about(name.as_ref()))?;
    session.say_findings_about(&name, &read.findings);
    for loss in &read.losses {
        session.say_about(&name, format_args!("not read: {loss}"));
    }
    Ok(Input { name, format, read, bytes: bytes.len() as u64 })
}

/// The folder of an input, for the files that it names.
struct Folder(PathBuf);

impl Siblings for Folder {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let unreadable = |error: std::io::Error| match error.kind() {
            ErrorKind::NotFound => SiblingError::Missing,
            _ => SiblingError::Io(error.to_string()),
        };
        let folder = if self.0.as_os_str().is_empty() { Path::new(".") } else { &self.0 };
        // Where links lead, and to what: a pipe would be waited for, a device read without end.
        let path = folder.join(name.as_str()).canonicalize().map_err(unreadable)?;
        if !path.starts_with(folder.canonicalize().map_err(unreadable)?) {
            return Err(SiblingError::Forbidden);
        }
        let data = path.metadata().map_err(unreadable)?;
        if !data.is_file() {
            return Err(SiblingError::Io("it is no regular file".into()));
        }
        let file = File::open(&path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        file.take(max_bytes).read_to_end(&mut bytes).map_err(unreadable)?;
        Ok(bytes)
    }
}
