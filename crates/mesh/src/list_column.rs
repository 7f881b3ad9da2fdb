//! Attribute columns of lists.

use std::ops::Range;

use crate::{AttributeError, Values};

/// A named attribute with a list of numbers or texts for each element: the indices of a strip, the fragments of a cell.
///
/// Lists have no rules to blend or move: they are copied as they are, and of several sources the heaviest gives its list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListColumn {
    name: String,
    starts: Vec<u32>,
    values: Values,
}

impl ListColumn {
    /// Lists of which element `i` has `values[starts[i]..starts[i + 1]]`.
    ///
    /// # Errors
    /// Starts that do not rise from 0 to the number of values, or text with an index without a name.
    pub fn try_new(name: impl Into<String>, starts: Vec<u32>, values: Values) -> Result<Self, AttributeError> {
        let name = name.into();
        let ends = (starts.first().copied(), starts.last().map(|&last| last as usize));
        if ends != (Some(0), Some(values.len())) {
            return Err(AttributeError::ListStarts { name, element: starts.len().saturating_sub(2) });
        }
        if let Some(element) = starts.windows(2).position(|bounds| bounds[0] > bounds[1]) {
            return Err(AttributeError::ListStarts { name, element });
        }
        if let Values::Text { names, index } = &values
            && index.iter().any(|&i| i as usize >= names.len())
        {
            return Err(AttributeError::Text { name });
        }
        Ok(Self { name, starts, values })
    }

    /// The same lists under another name.
    #[must_use]
    pub fn renamed(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where each element's list starts; one more entry than elements.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The values of all lists, one list after the other.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where the values of an element stand.
    ///
    /// # Panics
    /// When there is no such element.
    pub fn range(&self, element: usize) -> Range<usize> {
        self.starts[element] as usize..self.starts[element + 1] as usize
    }

    /// The memory that the column takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.values.bytes() + size_of_val(self.starts.as_slice()) + self.name.len()
    }

    /// The column whose element `i` has the list of this one's element `sources[i]`.
    ///
    /// # Panics
    /// When a source does not exist, or the lists together have more values than 32 bits count.
    #[must_use]
    pub fn gathered(&self, sources: &[u32]) -> Self {
        self.picked(sources.iter().map(|&source| Some(source)))
    }

    /// How many values the lists of these elements have together.
    pub(crate) fn total(&self, sources: impl Iterator<Item = Option<u32>>) -> u64 {
        sources.flatten().map(|source| self.range(source as usize).len() as u64).sum()
    }

    /// The column of the lists of these elements, empty where there is none.
    pub(crate) fn picked(&self, sources: impl Iterator<Item = Option<u32>> + Clone) -> Self {
        let ranges = sources.map(|source| source.map_or(0..0, |source| self.range(source as usize)));
        let mut starts = vec![0];
        let mut total = 0u32;
        for range in ranges.clone() {
            total = total.checked_add(range.len() as u32).expect("lists of fewer values than 32 bits count");
            starts.push(total);
        }
        Self { name: self.name.clone(), starts, values: self.values.pieces(ranges, total as usize) }
    }

    /// Whether two elements have the same lists to the bit.
    pub(crate) fn same(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.range(a), self.range(b));
        a.len() == b.len() && a.zip(b).all(|(a, b)| self.values.same(a, b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lists() -> ListColumn {
        ListColumn::try_new("ids", vec![0, 2, 2, 5], Values::I16(vec![1, -2, 3, 4, 5])).unwrap()
    }

    #[test]
    fn starts_that_do_not_rise_to_the_end_are_refused() {
        let refused = |starts: Vec<u32>| {
            matches!(ListColumn::try_new("x", starts, Values::U8(vec![0; 4])), Err(AttributeError::ListStarts { .. }))
        };
        assert!(refused(vec![]) && refused(vec![0]) && refused(vec![1, 4]) && refused(vec![0, 5]));
        assert!(refused(vec![0, 3, 2, 4]) && !refused(vec![0, 0, 4, 4]));
        assert!(ListColumn::try_new("x", vec![0], Values::U8(vec![])).is_ok_and(|none| none.is_empty()));
        let text = Values::Text { names: vec!["a".into()], index: vec![0, 1] };
        assert!(matches!(ListColumn::try_new("x", vec![0, 2], text), Err(AttributeError::Text { .. })));
    }

    #[test]
    fn lists_are_gathered_whole() {
        let gathered = lists().gathered(&[2, 1, 0, 2]);
        assert_eq!(gathered.starts(), [0, 3, 3, 5, 8]);
        assert_eq!(gathered.values(), &Values::I16(vec![3, 4, 5, 1, -2, 3, 4, 5]));
        assert!(gathered.same(0, 3) && !gathered.same(0, 2) && !gathered.same(0, 1));
        assert_eq!((lists().range(2), lists().len()), (2..5, 3));
    }
}
