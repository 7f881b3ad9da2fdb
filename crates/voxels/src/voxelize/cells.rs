//! Full cells, a block of slabs at a time.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec};

use super::box_overlap::Overlap;
use crate::mesh_distance::{Rows, whole_numbers};

/// A bit for each sample of some slabs.
pub(super) struct Cells {
    words: Vec<u64>,
    columns: u32,
    rows: u32,
    slabs: Range<u32>,
}

impl Cells {
    /// Slabs without full cells.
    pub fn new([columns, rows]: [u32; 2], slabs: Range<u32>) -> Self {
        let count = columns as usize * rows as usize * slabs.len();
        Self { words: vec![0; count.div_ceil(64)], columns, rows, slabs }
    }

    /// How many samples there are.
    pub fn count(&self) -> usize {
        self.columns as usize * self.rows as usize * self.slabs.len()
    }

    fn fill(&mut self, [i, j, k]: [u32; 3]) {
        let row = (k - self.slabs.start) as usize * self.rows as usize + j as usize;
        let at = row * self.columns as usize + i as usize;
        self.words[at / 64] |= 1 << (at % 64);
    }

    /// Fills cells whose closed cube a triangle meets.
    pub fn fill_met(&mut self, corners: &[DVec3; 3], exec: &Exec) -> Result<(), ConvertError> {
        let overlap = Overlap::new(corners);
        let [low, high] = overlap.bounds();
        for k in whole_numbers(low.z, high.z, &self.slabs.clone()) {
            for j in whole_numbers(low.y, high.y, &(0..self.rows)) {
                let (y, z) = (f64::from(j), f64::from(k));
                let (from, to) = overlap.row(y, z);
                let columns = whole_numbers(low.x.max(from), high.x.min(to), &(0..self.columns));
                for i in columns {
                    if overlap.meets(DVec3::new(f64::from(i), y, z)) {
                        self.fill([i, j, k]);
                    }
                }
            }
            exec.check()?;
        }
        Ok(())
    }

    /// Fills cells in which a triangle crosses a line through the centre, parallel to an axis.
    pub fn fill_crossed(&mut self, corners: &[DVec3; 3], exec: &Exec) -> Result<(), ConvertError> {
        let size = [0..self.columns, 0..self.rows, self.slabs.clone()];
        for axis in 0..3 {
            exec.check()?;
            let across = [size[(axis + 1) % 3].clone(), size[(axis + 2) % 3].clone()];
            // Faces between cells stand half a step before their samples; there is one more of them than of cells.
            let along = Rows { axis, offset: -0.5, count: size[axis].end + 1, across };
            along.cross(corners, |crossing| {
                let cell = crossing.first_beyond.wrapping_sub(1);
                if size[axis].contains(&cell) {
                    let mut place = [cell; 3];
                    place[(axis + 1) % 3] = crossing.row[0];
                    place[(axis + 2) % 3] = crossing.row[1];
                    self.fill(place);
                }
            });
        }
        Ok(())
    }

    /// Puts the bits behind `count` others.
    pub fn append_to(&self, all: &mut [u64], count: usize) {
        let (start, shift) = (count / 64, count % 64);
        for (place, &word) in self.words.iter().enumerate() {
            all[start + place] |= word << shift;
            if shift > 0 && word >> (64 - shift) != 0 {
                all[start + place + 1] |= word >> (64 - shift);
            }
        }
    }
}
