//! Triangle strips.

use shapeloom_mesh::Values;

use super::rows::{Lists, index_fault};
use super::types::{NO_INDEX, Number, with_values};
use crate::faces::Faces;
use crate::memory::Memory;
use crate::{Fault, ReadError};
use shapeloom_core::Place;

/// The triangles of strips: each vertex after the first two of a strip makes a triangle with the two before it, turned
/// about every other time, so that all face the same way. -1 ends a strip. Returns the rows with strips of one or two
/// vertices, which make none, as often as they have them.
///
/// # Errors
/// An index that no vertex has; `place` says where a row is.
pub(super) fn triangles(
    strips: &Lists,
    vertices: usize,
    faces: &mut Faces,
    memory: &mut Memory<'_>,
    place: impl Fn(usize) -> Place,
) -> Result<Vec<usize>, ReadError> {
    let mut short = Vec::new();
    with_values!(&strips.values, values => {
        let mut start = 0;
        for (row, &end) in strips.ends.iter().enumerate() {
            let strip = values.get(start..end as usize).unwrap_or(&[]);
            start = end as usize;
            for part in strip.split(|number| number.to_f64() == -1.0) {
                if matches!(part.len(), 1 | 2) && short.len() < MOST_SHORT {
                    short.push(row);
                }
                one_strip(part, row, vertices, faces, memory, &place)?;
            }
        }
    }, ());
    Ok(short)
}

/// As many as are counted: each takes memory.
const MOST_SHORT: usize = 1 << 20;

fn one_strip<N: Number>(
    strip: &[N],
    row: usize,
    vertices: usize,
    faces: &mut Faces,
    memory: &mut Memory<'_>,
    place: impl Fn(usize) -> Place,
) -> Result<(), ReadError> {
    let check = |number: N| -> Result<u32, Box<Fault>> {
        let index = number.index();
        if index == NO_INDEX || index as usize >= vertices {
            return Err(index_fault(place(row), row, number.to_f64(), vertices).within(format!("strip {row}")));
        }
        Ok(index)
    };
    let mut before = [0; 2];
    for (number, &value) in strip.iter().enumerate() {
        let index = check(value)?;
        match number {
            0 | 1 => before[number] = index,
            _ => {
                let [a, b] = before;
                let corners = if number % 2 == 0 { [a, b, index] } else { [b, a, index] };
                faces.push_triangle(memory, corners)?;
                before = [b, index];
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::{Diagnostic, Exec};

    fn read(values: Vec<i32>, ends: Vec<u32>, vertices: usize) -> Result<(Vec<u32>, Vec<usize>), ReadError> {
        let exec = Exec::default();
        let mut faces = Faces::default();
        let lists = Lists { ends, values: Values::I32(values) };
        let place = |row| Place::line(row as u64);
        let short = triangles(&lists, vertices, &mut faces, &mut Memory::new(&exec), place)?;
        Ok((faces.corners().to_vec(), short))
    }

    #[test]
    fn strips_turn_every_other_triangle() {
        let (corners, short) = read(vec![0, 1, 2, 3, 4, -1, 5, 6, 7], vec![9], 8).unwrap();
        assert_eq!((corners, short), (vec![0, 1, 2, 2, 1, 3, 2, 3, 4, 5, 6, 7], vec![]));
        // Turning starts anew with each strip; what dangles is told; nothing between two ends is nothing.
        let (corners, short) = read(vec![0, 1, 2, -1, 3, -1, -1, 3, 2, 1, 0, 1, 2], vec![11, 13, 13], 4).unwrap();
        assert_eq!((corners, short), (vec![0, 1, 2, 3, 2, 1, 1, 2, 0], vec![0, 1]));
        for wrong in [4, -2] {
            let error = read(vec![0, 1, wrong], vec![0, 3], 4).unwrap_err();
            assert_eq!((error.code(), error.fault().unwrap().place.clone()), ("E-ply-index", Place::line(1)));
        }
    }
}
