//! The attribute columns of one kind of element.

use crate::{AttributeError, Column, ListColumn};
use shapeloom_core::Affine;

/// The customary name of unit normals (width 3).
pub const NORMAL: &str = "normal";
/// The customary name of texture coordinates (width 2).
pub const TEXCOORD: &str = "texcoord";
/// The customary name of colours: linear if floating, sRGB if whole numbers (width 3 or 4).
pub const COLOR: &str = "color";
/// The customary name of the label that tells which patch of the source a face came from.
pub const PATCH: &str = "patch";
/// The customary name of the group of a file to which a face belongs: text on faces.
pub const GROUP: &str = "group";
/// The customary name of a face's material where the faces of a part differ: text on faces, the name of one of the
/// shape's materials.
pub const MATERIAL: &str = "material";
/// The customary name of a face's smoothing group: `u32` on faces, 0 for faces that are not smooth.
pub const SMOOTHING: &str = "smoothing";

/// Columns of one length, in the order in which they were added, and beside them columns of lists; each name once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    len: usize,
    columns: Vec<Column>,
    lists: Vec<ListColumn>,
}

impl Attributes {
    /// No columns, for `len` elements.
    pub fn new(len: usize) -> Self {
        Self { len, columns: Vec::new(), lists: Vec::new() }
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no columns, of lists neither.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty() && self.lists.is_empty()
    }

    /// The columns in order, without those of lists.
    pub fn iter(&self) -> std::slice::Iter<'_, Column> {
        self.columns.iter()
    }

    /// The columns of lists in order.
    pub fn lists(&self) -> &[ListColumn] {
        &self.lists
    }

    /// The column of that name.
    pub fn get(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name() == name)
    }

    /// The column of lists of that name.
    pub fn list(&self, name: &str) -> Option<&ListColumn> {
        self.lists.iter().find(|list| list.name() == name)
    }

    /// Adds a column.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert(&mut self, column: Column) -> Result<(), AttributeError> {
        self.check(column.name(), column.len())?;
        self.columns.push(column);
        Ok(())
    }

    /// Adds a column of lists.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_list(&mut self, list: ListColumn) -> Result<(), AttributeError> {
        self.check(list.name(), list.len())?;
        self.lists.push(list);
        Ok(())
    }

    fn check(&self, name: &str, found: usize) -> Result<(), AttributeError> {
        if found != self.len {
            return Err(AttributeError::Length { name: name.to_owned(), found, expected: self.len });
        }
        if self.get(name).is_some() || self.list(name).is_some() {
            return Err(AttributeError::Duplicate { name: name.to_owned() });
        }
        Ok(())
    }

    /// Takes a column out.
    pub fn remove(&mut self, name: &str) -> Option<Column> {
        let position = self.columns.iter().position(|column| column.name() == name)?;
        Some(self.columns.remove(position))
    }

    /// Takes a column of lists out.
    pub fn remove_list(&mut self, name: &str) -> Option<ListColumn> {
        let position = self.lists.iter().position(|list| list.name() == name)?;
        Some(self.lists.remove(position))
    }

    /// The columns after the shape was mapped; lists stay as they are.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let columns = self.columns.iter().map(|column| column.transformed(map)).collect();
        Self { len: self.len, columns, lists: self.lists.clone() }
    }

    /// The memory that the columns take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        let columns: usize = self.columns.iter().map(Column::memory_bytes).sum();
        columns + self.lists.iter().map(ListColumn::memory_bytes).sum::<usize>()
    }

    /// Columns of `len` elements made one from each of these; lists that make none are left out.
    pub(crate) fn mapped(
        &self,
        len: usize,
        column: impl Fn(&Column) -> Column,
        list: impl FnMut(&ListColumn) -> Option<ListColumn>,
    ) -> Self {
        let columns: Vec<Column> = self.columns.iter().map(column).collect();
        let lists: Vec<ListColumn> = self.lists.iter().filter_map(list).collect();
        debug_assert!(columns.iter().all(|column| column.len() == len));
        debug_assert!(lists.iter().all(|list| list.len() == len));
        Self { len, columns, lists }
    }
}

impl<'a> IntoIterator for &'a Attributes {
    type Item = &'a Column;
    type IntoIter = std::slice::Iter<'a, Column>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Values;

    #[test]
    fn a_name_is_taken_once_among_columns_and_lists() {
        let list = |name: &str| ListColumn::try_new(name, vec![0, 1, 3], Values::U8(vec![1, 2, 3])).unwrap();
        let mut attributes = Attributes::new(2);
        assert!(attributes.is_empty());
        attributes.insert_list(list("a")).unwrap();
        assert!(!attributes.is_empty() && attributes.memory_bytes() > 12);
        attributes.insert(Column::labels("b", vec![1, 2])).unwrap();
        assert!(matches!(attributes.insert_list(list("b")), Err(AttributeError::Duplicate { .. })));
        assert!(matches!(attributes.insert(Column::labels("a", vec![1, 2])), Err(AttributeError::Duplicate { .. })));
        assert!(matches!(Attributes::new(3).insert_list(list("a")), Err(AttributeError::Length { .. })));
        assert_eq!(attributes.transformed(&Affine::IDENTITY), attributes);
        assert_eq!(attributes.remove_list("a"), Some(list("a")));
        assert!(attributes.lists().is_empty() && attributes.remove_list("a").is_none());
    }
}
