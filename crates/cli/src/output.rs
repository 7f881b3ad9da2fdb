//! Writing outputs: whole or not at all.

use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::failure::Failure;
use crate::input::is_stream;
use crate::session::Session;

/// A file that appears under its name only when it is complete.
pub(crate) struct Output {
    path: PathBuf,
    file: NamedTempFile,
    force: bool,
}

/// Refuses an output that exists, before any work is done for it.
pub(crate) fn check_free(path: &Path, force: bool) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    match path.symlink_metadata() {
        Ok(data) if data.is_dir() => {
            Err(Failure::write(path, &std::io::Error::new(ErrorKind::IsADirectory, "it is a folder")))
        }
        Ok(_) if !force => Err(Failure::exists(path)),
        _ => Ok(()),
    }
}

/// Refuses two outputs of one name, one of which would be lost.
pub(crate) fn check_apart(paths: &[&Path]) -> Result<(), Failure> {
    for (i, path) in paths.iter().enumerate() {
        if paths[..i].contains(path) {
            let message = format!("{}: found as the name of two outputs, expected each once", path.display());
            return Err(Failure::usage("E-usage-outputs", message));
        }
    }
    Ok(())
}

impl Output {
    /// Writes a temporary file beside the place where it belongs; missing folders are made.
    pub(crate) fn stage(
        path: &Path,
        force: bool,
        write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
    ) -> Result<Self, Failure> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        std::fs::create_dir_all(folder).map_err(|error| Failure::write(path, &error))?;
        let mut builder = Builder::new();
        builder.prefix(".shapeloom-");
        #[cfg(unix)]
        {
            // As any new file: what the user's mask leaves, not the private mode of temporary files.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder).map_err(|error| Failure::write(path, &error))?;
        {
            let mut buffered = BufWriter::with_capacity(1 << 16, file.as_file_mut());
            write(&mut buffered).map_err(|failure| failure.about(path))?;
            buffered.flush().map_err(|error| Failure::write(path, &error))?;
        }
        Ok(Self { path: path.to_owned(), file, force })
    }

    /// Gives the file its name.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        let Self { path, file, force } = self;
        let result = if force { file.persist(&path) } else { file.persist_noclobber(&path) };
        match result {
            Ok(_) => Ok(()),
            Err(failed) if failed.error.kind() == ErrorKind::AlreadyExists => Err(Failure::exists(&path)),
            Err(failed) => Err(Failure::write(&path, &failed.error)),
        }
    }
}

/// Writes to a file, to be committed, or at once to standard output.
pub(crate) fn stage_or_stream(
    path: &Path,
    force: bool,
    session: &mut Session<'_>,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
) -> Result<Option<Output>, Failure> {
    if is_stream(path) {
        // Nothing half-done on standard output either: a pipe cannot take it back.
        let mut whole = Vec::new();
        write(&mut whole).map_err(|failure| failure.about(path))?;
        let out = &mut session.streams.out;
        let sent = out.write_all(&whole).and_then(|()| out.flush());
        sent.map_err(|error| Failure::stream(&error))?;
        Ok(None)
    } else {
        Output::stage(path, force, write).map(Some)
    }
}
