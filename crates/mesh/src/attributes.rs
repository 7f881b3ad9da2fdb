//! The attribute columns of one kind of element.

use crate::{AttributeError, Column};
use shapeloom_core::Affine;

/// The customary name of unit normals (width 3).
pub const NORMAL: &str = "normal";
/// The customary name of texture coordinates (width 2).
pub const TEXCOORD: &str = "texcoord";
/// The customary name of colours: linear if floating, sRGB if whole numbers (width 3 or 4).
pub const COLOR: &str = "color";
/// The customary name of the label that tells which patch of the source a face came from.
pub const PATCH: &str = "patch";

/// Columns of one length, in the order in which they were added, each name once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    len: usize,
    columns: Vec<Column>,
}

impl Attributes {
    /// No columns, for `len` elements.
    pub fn new(len: usize) -> Self {
        Self { len, columns: Vec::new() }
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no columns.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The columns in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Column> {
        self.columns.iter()
    }

    /// The column of that name.
    pub fn get(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name() == name)
    }

    /// Adds a column.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert(&mut self, column: Column) -> Result<(), AttributeError> {
        if column.len() != self.len {
            let name = column.name().to_owned();
            return Err(AttributeError::Length { name, found: column.len(), expected: self.len });
        }
        if self.get(column.name()).is_some() {
            return Err(AttributeError::Duplicate { name: column.name().to_owned() });
        }
        self.columns.push(column);
        Ok(())
    }

    /// Takes a column out.
    pub fn remove(&mut self, name: &str) -> Option<Column> {
        let position = self.columns.iter().position(|column| column.name() == name)?;
        Some(self.columns.remove(position))
    }

    /// The columns after the shape was mapped.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        self.mapped(self.len, |column| column.transformed(map))
    }

    /// The memory that the columns take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.columns.iter().map(Column::memory_bytes).sum()
    }

    /// Columns of `len` elements made one from each of these.
    pub(crate) fn mapped(&self, len: usize, f: impl Fn(&Column) -> Column) -> Self {
        let columns: Vec<Column> = self.columns.iter().map(f).collect();
        debug_assert!(columns.iter().all(|column| column.len() == len));
        Self { len, columns }
    }
}

impl<'a> IntoIterator for &'a Attributes {
    type Item = &'a Column;
    type IntoIter = std::slice::Iter<'a, Column>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
