//! How failures are told.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::json;
use shapeloom_core::{Category, ConvertError};

use crate::Streams;

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Some crate's own error, and the file that it is about if its text does not name it.
    Narrow { error: ConvertError, file: Option<PathBuf> },
    /// Whoever read standard output has had enough: nothing to tell, and no failure of ours.
    PipeClosed,
    /// A check or comparison found what it was to look for. All is told by then.
    Found,
    /// An error of the command line itself.
    Own { code: &'static str, category: Category, message: String, advice: Option<String> },
}

impl Failure {
    pub(crate) fn usage(code: &'static str, message: impl Into<String>) -> Self {
        Self::Own { code, category: Category::Usage, message: message.into(), advice: None }
    }

    pub(crate) fn read(path: &Path, error: &std::io::Error) -> Self {
        Self::Own {
            code: "E-input-open",
            category: Category::Malformed,
            message: format!("{}: cannot be read: {error}", path.display()),
            advice: None,
        }
    }

    pub(crate) fn write(path: &Path, error: &std::io::Error) -> Self {
        Self::Own {
            code: "E-output-write",
            category: Category::CannotWrite,
            message: format!("{}: cannot be written: {error}", path.display()),
            advice: None,
        }
    }

    pub(crate) fn stream(error: &std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Self::PipeClosed,
            _ => Self::write("standard output".as_ref(), error),
        }
    }

    pub(crate) fn exists(path: &Path) -> Self {
        Self::Own {
            code: "E-output-exists",
            category: Category::CannotWrite,
            message: format!("{}: found a file there, expected none", path.display()),
            advice: Some("give --force to replace it".into()),
        }
    }

    /// The same failure, said to be about a file.
    pub(crate) fn about(self, path: &Path) -> Self {
        match self {
            Self::Narrow { error, file: None } => Self::Narrow { error, file: Some(path.to_owned()) },
            other => other,
        }
    }

    fn category(&self) -> Option<Category> {
        match self {
            Self::Narrow { error, .. } => Some(error.category()),
            Self::PipeClosed | Self::Found => None,
            Self::Own { category, .. } => Some(*category),
        }
    }

    pub(crate) fn exit_code(&self) -> u8 {
        match self.category() {
            None if matches!(self, Self::Found) => 1,
            None => 0,
            Some(Category::Usage) => 2,
            Some(Category::Malformed) => 3,
            Some(Category::Unsupported) => 4,
            Some(Category::Failed) => 5,
            Some(Category::CannotWrite) => 6,
            Some(Category::OverLimit) => 7,
            Some(Category::Cancelled) => 130,
        }
    }

    /// Tells the failure on standard error, and as an object on standard output where that was asked for.
    pub(crate) fn print(&self, streams: &mut Streams, as_json: bool) {
        let (code, mut message, advice) = match self {
            Self::Narrow { error, .. } => (error.diagnostic().code(), error.to_string(), error.diagnostic().advice()),
            Self::Own { code, message, advice, .. } => (*code, message.clone(), advice.clone()),
            Self::PipeClosed | Self::Found => return,
        };
        if let Self::Narrow { file: Some(file), .. } = self {
            let name = file.display().to_string();
            if !message.starts_with(&name) {
                message = format!("{name}: {message}");
            }
        }
        // Errors of readers end with their code, which stands in front here.
        let suffix = format!(" ({code})");
        let message = message.strip_suffix(&suffix).unwrap_or(&message);
        let _ = writeln!(streams.err, "error[{code}]: {message}");
        if let Some(advice) = &advice {
            let _ = writeln!(streams.err, "  help: {advice}");
        }
        if as_json {
            let object = json!({
                "schema": "shapeloom.error/1",
                "error": {
                    "code": code,
                    "category": self.category().map(Category::phrase),
                    "message": message,
                    "advice": advice,
                    "exit_code": self.exit_code(),
                },
            });
            let _ = writeln!(streams.out, "{object:#}");
        }
    }
}

impl<E: Into<ConvertError>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Narrow { error: error.into(), file: None }
    }
}
