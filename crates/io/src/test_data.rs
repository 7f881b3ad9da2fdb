//! Files that are not part of the repository.

use std::path::{Path, PathBuf};

/// The path of a file of the shared collection beside the workspace; none where the collection is not there, and the
/// test that asked has nothing to look at.
pub(crate) fn shared_data(name: &str) -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates = ["../shared/data", "../../shared/data"].map(|folder| workspace.join(folder).join(name));
    candidates.into_iter().find(|path| path.exists())
}
