//! What several test modules use.

use std::ffi::OsString;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use shapeloom::core::CancelFlag;
use shapeloom_cli::Streams;

/// The root of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie inside the workspace")
}

/// A file under the root, as text.
pub fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Files of a larger collection beside the workspace, which is not part of it: none where it is not there.
pub fn shared_data(path: &str) -> Option<PathBuf> {
    let beside = root().ancestors().skip(1).take(2).map(|folder| folder.join("shared/data").join(path));
    beside.into_iter().find(|path| path.exists())
}

/// Every file below a folder whose name ends so, in order.
pub fn files_below(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("an entry of a folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// What a command printed, and its exit code.
pub struct Outcome {
    pub code: u8,
    pub out: Vec<u8>,
    pub err: String,
}

impl Outcome {
    /// Standard output as JSON.
    pub fn json(&self) -> serde_json::Value {
        let text = String::from_utf8_lossy(&self.out);
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}\n{}", self.err))
    }
}

#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("no test panics while it writes").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Runs a command line in this process, on an input.
pub fn run_on<S: AsRef<std::ffi::OsStr>>(input: &[u8], arguments: &[S]) -> Outcome {
    let (out, err) = (Shared::default(), Shared::default());
    let mut streams = Streams {
        input: Box::new(Cursor::new(input.to_vec())),
        out: Box::new(out.clone()),
        err: Box::new(err.clone()),
        err_is_terminal: false,
    };
    let program = std::iter::once(OsString::from("shapeloom"));
    let words = program.chain(arguments.iter().map(|word| word.as_ref().to_owned()));
    let code = shapeloom_cli::run(words, &mut streams, &CancelFlag::default());
    drop(streams);
    let take = |shared: Shared| std::mem::take(&mut *shared.0.lock().expect("no test panics while it writes"));
    Outcome { code, out: take(out), err: String::from_utf8_lossy(&take(err)).into_owned() }
}

/// Runs a command line in this process, with no input.
pub fn run<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Outcome {
    run_on(b"", arguments)
}

/// The path of a file in the repository's data.
pub fn data(name: &str) -> String {
    root().join("data").join(name).display().to_string()
}

/// A small generator of numbers that look random (SplitMix64), so that tests are the same each time.
pub struct Dice(pub u64);

impl Dice {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}
