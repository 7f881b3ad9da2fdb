//! Whether the zero set of samples comes near every part of a mesh.

use shapeloom_core::{ConvertError, Exec, parallel};

/// What looking for lost parts found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Lost {
    /// How many cells that the mesh may pass have no zero set in them or in a cell beside them.
    pub cells: u64,
    /// The first of them, if any.
    pub first: Option<[u32; 3]>,
}

/// A bit for each cell of a slab of cells, rows padded to whole words.
struct CellBits {
    /// All corners are near the mesh, so that it may pass the cell: where it does, no corner is farther than the cell's diagonal.
    near: Vec<u64>,
    /// Corners on both sides, so that the zero set passes the cell.
    mixed: Vec<u64>,
}

/// Counts cells that the mesh may pass while neither they nor any of the 26 around them have corners on both sides.
///
/// `values` are signed distances in cells, exact up to √3 at least. Without such cells every place of the mesh has zeros of the
/// trilinear interpolant within two diagonals: in its own cell or in one beside it. Memory: a quarter of a byte a sample.
pub(crate) fn lost_cells(values: &[f32], dimensions: [u32; 3], exec: &Exec) -> Result<Lost, ConvertError> {
    if dimensions.contains(&1) {
        return Ok(Lost { cells: 1, first: None });
    }
    let [columns, rows, slabs] = dimensions.map(|count| count as usize);
    let words = columns.div_ceil(64);
    let _memory = exec.reserve_elements(words as u64 * rows as u64 * slabs as u64, 4 * size_of::<u64>())?;
    let cells = parallel::map_chunks(exec, slabs - 1, 1, |range| {
        let slab_len = columns * rows;
        let pair = &values[range.start * slab_len..(range.start + 2) * slab_len];
        Ok::<_, ConvertError>(cell_bits(pair, columns, rows))
    })?;
    let parts = parallel::map_chunks(exec, slabs - 1, 1, |range| {
        let k = range.start;
        let around = &cells[k.saturating_sub(1)..(k + 2).min(cells.len())];
        let mut lost = Lost::default();
        let mut row = vec![0u64; words];
        for j in 0..rows - 1 {
            row.fill(0);
            for slab in around {
                for beside in j.saturating_sub(1)..(j + 2).min(rows - 1) {
                    let mixed = &slab.mixed[beside * words..(beside + 1) * words];
                    row.iter_mut().zip(mixed).for_each(|(sum, bits)| *sum |= bits);
                }
            }
            for (word, &near) in cells[k].near[j * words..(j + 1) * words].iter().enumerate() {
                let before = if word > 0 { row[word - 1] >> 63 } else { 0 };
                let after = row.get(word + 1).map_or(0, |next| next << 63);
                let reached = row[word] | row[word] << 1 | row[word] >> 1 | before | after;
                let left = near & !reached;
                if left != 0 && lost.first.is_none() {
                    lost.first = Some([word as u32 * 64 + left.trailing_zeros(), j as u32, k as u32]);
                }
                lost.cells += u64::from(left.count_ones());
            }
        }
        Ok::<_, ConvertError>(lost)
    })?;
    let first = parts.iter().find_map(|lost| lost.first);
    Ok(Lost { cells: parts.iter().map(|lost| lost.cells).sum(), first })
}

/// The cells between two slabs.
fn cell_bits(pair: &[f32], columns: usize, rows: usize) -> CellBits {
    let words = columns.div_ceil(64);
    let mut near = vec![0u64; words * 2 * rows];
    let mut negative = vec![0u64; words * 2 * rows];
    // The diagonal of a cell, and what distances are rounded by.
    const DIAGONAL: f32 = 1.732_06;
    for (row, values) in pair.chunks(columns).enumerate() {
        for (word, values) in values.chunks(64).enumerate() {
            let (mut close, mut inside) = (0u64, 0u64);
            for (i, &value) in values.iter().enumerate() {
                close |= u64::from(value.abs() < DIAGONAL) << i;
                inside |= u64::from(value < 0.0) << i;
            }
            near[row * words + word] = close;
            negative[row * words + word] = inside;
        }
    }
    let mut cells = CellBits { near: vec![0; words * rows], mixed: vec![0; words * rows] };
    let last = columns - 2;
    for j in 0..rows - 1 {
        let corners = |bits: &[u64], word: usize| {
            let of = |row: usize| if word < words { bits[row * words + word] } else { 0 };
            [of(j), of(j + 1), of(rows + j), of(rows + j + 1)]
        };
        let all = |bits: [u64; 4]| bits[0] & bits[1] & bits[2] & bits[3];
        let any = |bits: [u64; 4]| bits[0] | bits[1] | bits[2] | bits[3];
        for word in 0..words {
            let shifted = |here: u64, next: u64| here >> 1 | next << 63;
            let (near, next) = (all(corners(&near, word)), all(corners(&near, word + 1)));
            let (full, next_full) = (all(corners(&negative, word)), all(corners(&negative, word + 1)));
            let (some, next_some) = (any(corners(&negative, word)), any(corners(&negative, word + 1)));
            // Cells end one before the samples do.
            let valid = if word < last / 64 {
                u64::MAX
            } else if word == last / 64 {
                u64::MAX >> (63 - last % 64)
            } else {
                0
            };
            let at = j * words + word;
            cells.near[at] = near & shifted(near, next) & valid;
            cells.mixed[at] = (some | shifted(some, next_some)) & !(full & shifted(full, next_full)) & valid;
        }
    }
    cells
}
