//! Coplanar faces merged into rectangles.

use shapeloom_core::{ConvertError, Exec};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::PolyMesh;

use super::{Built, DIRECTIONS, SQUARE, beside, position, touching_edges};
use crate::full_cells::FullCells;

/// Greedy rectangles in each layer of each direction: from the first face that is left, as far along the row as faces
/// go, then as many rows as have all of them.
pub(super) fn build(cells: &FullCells, lattice: &Lattice, exec: &Exec) -> Result<Built, ConvertError> {
    let dimensions = lattice.dimensions();
    let places = dimensions.map(|count| count + 1);
    let touching = touching_edges(cells, places, &exec.part(0.0, 0.2))?;
    // Corners as places, which become vertices afterwards.
    let mut corners: Vec<u64> = Vec::new();
    for (number, (axis, side)) in DIRECTIONS.into_iter().enumerate() {
        exec.progress(0.2 + number as f64 * 0.1);
        let (u_axis, v_axis) = ((axis + 1) % 3, (axis + 2) % 3);
        let (width, height) = (dimensions[u_axis] as usize, dimensions[v_axis] as usize);
        let _layer = exec.reserve_elements((width * height) as u64, size_of::<bool>())?;
        let mut left = vec![false; width * height];
        for layer in 0..dimensions[axis] {
            let at = |u: usize, v: usize| {
                let mut cell = [layer; 3];
                cell[u_axis] = u as u32;
                cell[v_axis] = v as u32;
                cell
            };
            for (v, row) in left.chunks_mut(width).enumerate() {
                exec.check()?;
                for (u, face) in row.iter_mut().enumerate() {
                    let cell = at(u, v);
                    *face = cells.is_full(cell.map(i64::from)) && !cells.is_full(beside(cell, axis, side));
                }
            }
            for v in 0..height {
                exec.check()?;
                let mut u = 0;
                while u < width {
                    if !left[v * width + u] {
                        u += 1;
                        continue;
                    }
                    let across = left[v * width + u..(v + 1) * width].iter().take_while(|&&face| face).count();
                    let row = |v: usize| v * width + u..v * width + u + across;
                    let rows = (v..height).take_while(|&v| left[row(v)].iter().all(|&face| face)).count();
                    (v..v + rows).for_each(|v| left[row(v)].fill(false));
                    let mut face = SQUARE.map(|(x, y)| {
                        let mut place = at(u + x as usize * across, v + y as usize * rows);
                        place[axis] += u32::from(side > 0);
                        let [i, j, k] = place.map(u64::from);
                        (k * u64::from(places[1]) + j) * u64::from(places[0]) + i
                    });
                    if side < 0 {
                        face.reverse();
                    }
                    corners.extend(face);
                    u += across;
                }
            }
        }
    }
    exec.check()?;
    let _sorted = exec.reserve_elements(corners.len() as u64, 2 * size_of::<u64>())?;
    let mut used = corners.clone();
    used.sort_unstable();
    used.dedup();
    let [px, py, _] = places.map(u64::from);
    let place = |at: u64| [(at % px) as u32, (at / px % py) as u32, (at / (px * py)) as u32];
    let positions = used.iter().map(|&at| position(lattice.placement(), place(at))).collect();
    // Every corner is among those used: the partition point is its place.
    let vertices: Vec<u32> = corners.iter().map(|&at| used.partition_point(|&other| other < at) as u32).collect();
    let starts = (0..=vertices.len() as u32 / 4).map(|face| face * 4).collect();
    Ok(Built { mesh: PolyMesh::try_new(positions, starts, vertices)?, touching, doubled: 0 })
}
