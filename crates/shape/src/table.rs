//! Tables.

use shapeloom_mesh::Attributes;

/// Rows of a file that are no elements of a geometry, such as an element of a PLY file that no one knows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What the file calls its rows.
    pub name: String,
    /// The columns, with an element for each row.
    pub columns: Attributes,
}

impl Table {
    /// The memory that the table takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.name.len() + self.columns.memory_bytes()
    }
}
