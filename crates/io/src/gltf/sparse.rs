//! Elements of an accessor that are replaced one by one.

use super::accessor::component_size;
use super::bin::{UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use super::buffers::{Buffer, Strip};
use super::json::At;
use crate::Fault;

/// The elements that are replaced, in rising order, and what they become.
#[derive(Clone, Debug)]
pub(super) struct Sparse<'a> {
    indices: Strip<'a>,
    index_size: u64,
    count: usize,
    /// The new elements, in the order of the indices.
    pub values: Strip<'a>,
}

impl<'a> Sparse<'a> {
    /// The list of an accessor of `elements` elements of `size` bytes each. Indices must rise and be in range.
    pub fn open(
        document: &At<'_>,
        sparse: &At<'_>,
        buffers: &'a [Buffer<'_>],
        elements: u64,
        size: u64,
    ) -> Result<Self, Box<Fault>> {
        let count_at = sparse.require("count")?;
        let count = count_at.count_value()?;
        if !(1..=elements).contains(&count) {
            let expected = format!("a number from 1 to {elements}, the count of the accessor");
            return Err(count_at.fault("E-gltf-count", count.to_string(), expected));
        }
        let indices_at = sparse.require("indices")?;
        let component_type = indices_at.require("componentType")?;
        let number = component_type.count_value()?;
        let index_size = component_size(number)
            .filter(|_| matches!(number, UNSIGNED_BYTE | UNSIGNED_SHORT | UNSIGNED_INT))
            .ok_or_else(|| component_type.fault("E-gltf-type", number.to_string(), "an unsigned type for indices"))?;
        let indices = Strip::open(document, &indices_at, buffers, count, index_size)?;
        let values = Strip::open(document, &sparse.require("values")?, buffers, count, size)?;
        let open = Self { indices, index_size, count: count as usize, values };
        let mut before = None;
        for at in 0..open.count {
            let index = open.index(at);
            let wrong = |expected: String| {
                let mut fault = sparse.fault("E-gltf-sparse", format!("index {index} at {at}"), expected);
                fault.place = open.indices.place(at);
                fault
            };
            if before.is_some_and(|before| index <= before) {
                return Err(wrong("indices that strictly rise".into()));
            }
            if index as u64 >= elements {
                return Err(wrong(format!("an index below {elements}, the count of the accessor")));
            }
            before = Some(index);
        }
        Ok(open)
    }

    /// How many elements are replaced.
    pub fn len(&self) -> usize {
        self.count
    }

    fn index(&self, at: usize) -> usize {
        match self.index_size {
            1 => usize::from(u8::from_le_bytes(self.indices.bytes(at, 0))),
            2 => usize::from(u16::from_le_bytes(self.indices.bytes(at, 0))),
            _ => u32::from_le_bytes(self.indices.bytes(at, 0)) as usize,
        }
    }

    /// Which of the values an element of the accessor has, if it is replaced.
    pub fn find(&self, element: usize) -> Option<usize> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            match self.index(middle).cmp(&element) {
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }
}
