//! Writing outputs: each whole or not at all.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use shapeloom_io::{SiblingName, SiblingOutputs};
use tempfile::{Builder, SpooledTempFile, TempPath};

use crate::failure::Failure;
use crate::input::is_stream;
use crate::session::Session;

/// An output that is complete and waits to be given its place.
pub(crate) struct Output {
    path: PathBuf,
    pending: Pending,
}

enum Pending {
    /// A temporary file beside the file that it becomes.
    File { staged: TempPath, target: PathBuf, force: bool },
    /// Bytes for standard output, or for a device or pipe that exists: those cannot be replaced, only written to.
    Through(SpooledTempFile),
}

/// What is spooled stays in memory up to this many bytes.
const SPOOL: usize = 1 << 20;

/// Whether an output is a file, new or replaced, and not a stream, device or pipe.
pub(crate) fn is_regular(path: &Path) -> bool {
    !is_stream(path) && !path.metadata().is_ok_and(|data| !data.is_file() && !data.is_dir())
}

/// Keeps the files that a writer wants beside its output, until that is complete.
#[derive(Default)]
pub(crate) struct Beside(Mutex<Vec<(SiblingName, Vec<u8>)>>);

impl Beside {
    /// What was kept.
    pub(crate) fn take(&self) -> Vec<(SiblingName, Vec<u8>)> {
        self.0.lock().map(|mut kept| std::mem::take(&mut *kept)).unwrap_or_default()
    }
}

impl SiblingOutputs for Beside {
    fn put(&self, name: &SiblingName, bytes: Vec<u8>) -> io::Result<()> {
        self.0.lock().map_err(|_| io::Error::other("another writer failed"))?.push((name.clone(), bytes));
        Ok(())
    }
}

/// Refuses an output that exists, before any work is done for it.
pub(crate) fn check_free(path: &Path, force: bool) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    match path.metadata() {
        Ok(data) if data.is_dir() => {
            Err(Failure::write(path, &io::Error::new(ErrorKind::IsADirectory, "it is a folder")))
        }
        Ok(data) if data.is_file() && !force => Err(Failure::exists(path)),
        // A link that leads nowhere is there all the same.
        Err(_) if !force && path.symlink_metadata().is_ok() => Err(Failure::exists(path)),
        _ => Ok(()),
    }
}

/// Refuses two outputs of one name, however it is spelled: one of them would be lost.
pub(crate) fn check_apart(paths: &[&Path]) -> Result<(), Failure> {
    let places: Vec<PathBuf> = paths.iter().map(|path| place(path)).collect();
    for (i, place) in places.iter().enumerate() {
        if places[..i].contains(place) {
            let message = format!("{}: found as the name of two outputs, expected each once", paths[i].display());
            return Err(Failure::usage("E-usage-outputs", message));
        }
    }
    Ok(())
}

/// Where a path leads, as far as it exists; the rest by its words.
fn place(path: &Path) -> PathBuf {
    if is_stream(path) {
        return path.to_owned();
    }
    if let Ok(place) = path.canonicalize() {
        return place;
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut resolved = folder.canonicalize().unwrap_or_default();
    if resolved.as_os_str().is_empty() {
        resolved = std::path::absolute(".").unwrap_or_default();
        for part in folder.components() {
            match part {
                std::path::Component::ParentDir => {
                    resolved.pop();
                }
                part => resolved.push(part),
            }
        }
    }
    resolved.join(path.file_name().unwrap_or_default())
}

/// Writes a complete output: a temporary file beside the place where it belongs, for which missing folders are made, or
/// a spool for standard output, devices and pipes.
pub(crate) fn stage(
    path: &Path,
    force: bool,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
) -> Result<Output, Failure> {
    let pending = if !is_regular(path) {
        let mut spool = SpooledTempFile::new(SPOOL);
        write_buffered(path, &mut spool, write)?;
        Pending::Through(spool)
    } else {
        let (staged, target) = stage_file(path, write)?;
        Pending::File { staged, target, force }
    };
    Ok(Output { path: path.to_owned(), pending })
}

fn write_buffered(
    path: &Path,
    out: &mut impl Write,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut buffered = BufWriter::with_capacity(1 << 16, out);
    write(&mut buffered).map_err(|failure| failure.about(path))?;
    buffered.flush().map_err(|error| Failure::write(path, &error))
}

fn stage_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
) -> Result<(TempPath, PathBuf), Failure> {
    // Through links to the file itself, so that the link stays.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    // The library's own texts name its temporary file, which means nothing to the user.
    let told = |error: io::Error| Failure::write(path, &io::Error::from(error.kind()));
    fs::create_dir_all(folder).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            let told = format!("found a file at {}, expected a folder", folder.display());
            Failure::write(path, &io::Error::new(ErrorKind::NotADirectory, told))
        }
        _ => Failure::write(path, &error),
    })?;
    let mut builder = Builder::new();
    builder.prefix(".shapeloom-");
    #[cfg(unix)]
    {
        // As any new file: what the user's mask leaves, not the private mode of temporary files.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(told)?;
    write_buffered(path, file.as_file_mut(), write)?;
    if let Ok(data) = target.metadata() {
        // A file that is replaced keeps its mode; where that is not allowed the new one's will do.
        let _ = file.as_file().set_permissions(data.permissions());
    }
    // Only the name is kept: many outputs may wait at a time.
    Ok((file.into_temp_path(), target))
}

/// Gives every output its place, files first. If one cannot be placed, those that were new are taken back.
pub(crate) fn commit(outputs: Vec<Output>, session: &mut Session<'_>) -> Result<(), Failure> {
    let mut made: Vec<PathBuf> = Vec::new();
    let mut through = Vec::new();
    for Output { path, pending } in outputs {
        let (staged, target, force) = match pending {
            Pending::File { staged, target, force } => (staged, target, force),
            Pending::Through(spool) => {
                through.push((path, spool));
                continue;
            }
        };
        let new = !target.exists();
        let result = if force { staged.persist(&target) } else { staged.persist_noclobber(&target) };
        match result {
            Ok(()) if new => made.push(target),
            Ok(()) => {}
            Err(failed) => {
                for file in made {
                    let _ = fs::remove_file(file);
                }
                return Err(match failed.error.kind() {
                    ErrorKind::AlreadyExists => Failure::exists(&path),
                    kind => Failure::write(&path, &io::Error::from(kind)),
                });
            }
        }
    }
    for (path, mut spool) in through {
        spool.rewind().map_err(|error| Failure::write(&path, &error))?;
        if is_stream(&path) {
            let out = &mut session.streams.out;
            let sent = io::copy(&mut spool, out).and_then(|_| out.flush());
            sent.map_err(|error| Failure::stream(&error))?;
        } else {
            let opened = OpenOptions::new().write(true).open(&path);
            let sent = opened.and_then(|mut device| io::copy(&mut spool, &mut device).and_then(|_| device.flush()));
            sent.map_err(|error| Failure::write(&path, &error))?;
        }
    }
    Ok(())
}
