//! Triangles that close an open mesh.

use shapeloom_core::{ConvertError, Exec};

use super::in_cells::InCells;

/// Triangles whose boundary is that of the mesh, passed the other way: both together are closed. Empty for a closed mesh.
///
/// Corners at equal places count as one. The sides that are not passed as often one way as the other are followed into loops, short
/// ones first closed; each loop is halved again and again, so that large triangles are few. Their corners are vertices of the mesh.
pub(super) fn closing(mesh: &InCells<'_>, exec: &Exec) -> Result<Vec<[u32; 3]>, ConvertError> {
    let sides = boundary(mesh, exec)?;
    let _memory = exec.reserve_elements(sides.len() as u64 + mesh.positions.len() as u64, 4 * size_of::<u32>())?;
    // The sides that leave each vertex, as a range of the sorted list; those before `next` are used up.
    let mut next = vec![0u32; mesh.positions.len() + 1];
    sides.iter().for_each(|&[from, _]| next[from as usize + 1] += 1);
    for vertex in 1..next.len() {
        next[vertex] += next[vertex - 1];
    }
    let ends = next[1..].to_vec();
    const NOWHERE: u32 = u32::MAX;
    let mut place = vec![NOWHERE; mesh.positions.len()];
    let mut path: Vec<u32> = Vec::new();
    let mut triangles = Vec::new();
    for start in 0..sides.len() {
        if start % 4096 == 0 {
            exec.check()?;
        }
        let mut at = sides[start][0];
        // As many sides lead to a vertex as leave it: a way ends only where it began, and by then all of it went into loops.
        loop {
            if place[at as usize] == NOWHERE {
                place[at as usize] = path.len() as u32;
                path.push(at);
            } else {
                let from = place[at as usize] as usize;
                halve(&path[from..], &mut triangles);
                path.drain(from + 1..).for_each(|vertex| place[vertex as usize] = NOWHERE);
            }
            let used = &mut next[at as usize];
            if *used == ends[at as usize] {
                break;
            }
            at = sides[*used as usize][1];
            *used += 1;
        }
        path.drain(..).for_each(|vertex| place[vertex as usize] = NOWHERE);
    }
    Ok(triangles)
}

/// Triangles in a loop: its ends and its middle, then both halves.
fn halve(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let mut waiting = vec![(0, corners.len() - 1)];
    while let Some((low, high)) = waiting.pop() {
        if high - low > 1 {
            let middle = low + (high - low) / 2;
            triangles.push([corners[low], corners[middle], corners[high]]);
            waiting.extend([(low, middle), (middle, high)]);
        }
    }
}

/// The sides that are passed too often, turned around, each as often as that; sorted.
fn boundary(mesh: &InCells<'_>, exec: &Exec) -> Result<Vec<[u32; 2]>, ConvertError> {
    let count = mesh.triangles.len() as u64 * 3;
    let _memory = exec.reserve_elements(count, size_of::<(u32, u32, i32)>() + size_of::<[u32; 2]>())?;
    let _order = exec.reserve_elements(mesh.positions.len() as u64, 2 * size_of::<u32>())?;
    let key = |index: u32| mesh.positions[index as usize].to_array().map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_unstable_by_key(|&index| (key(index), index));
    exec.check()?;
    let mut first = vec![0u32; order.len()];
    for equal in order.chunk_by(|&a, &b| key(a) == key(b)) {
        equal.iter().for_each(|&index| first[index as usize] = equal[0]);
    }
    let mut passed: Vec<(u32, u32, i32)> = Vec::with_capacity(count as usize);
    for triangle in mesh.triangles {
        let [a, b, c] = triangle.map(|corner| first[corner as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                passed.push((from.min(to), from.max(to), if from < to { 1 } else { -1 }));
            }
        }
    }
    exec.check()?;
    passed.sort_unstable();
    exec.check()?;
    let mut sides = Vec::new();
    for same in passed.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let net: i64 = same.iter().map(|side| i64::from(side.2)).sum();
        let side = if net > 0 { [same[0].1, same[0].0] } else { [same[0].0, same[0].1] };
        sides.extend((0..net.unsigned_abs()).map(|_| side));
    }
    sides.sort_unstable();
    Ok(sides)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{block, icosahedron, some, soup, together, torus};
    use shapeloom_core::glam::DVec3;
    use shapeloom_isosurface::Lattice;
    use shapeloom_mesh::TriMesh;
    use shapeloom_spatial::is_closed;

    /// Mesh and closing together have no boundary, which `is_closed` counts on its own; closed meshes need nothing.
    #[test]
    fn what_closes_a_mesh_closes_it() {
        let exec = Exec::default();
        let ball = icosahedron();
        let flipped = some(&ball, |i| i % 5 == 0).reversed();
        let fan = TriMesh::try_new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y, DVec3::Z, DVec3::ONE],
            vec![[0, 1, 2], [0, 3, 4], [0, 5, 6], [0, 1, 2], [1, 1, 2]],
        );
        for (mesh, count) in [
            (ball.clone(), Some(0)),
            (together(&[ball.clone(), block(DVec3::ZERO, DVec3::ONE)]), Some(0)),
            (some(&ball, |i| i != 3), Some(1)),
            (some(&ball, |i| i == 3), Some(1)),
            (together(&[some(&ball, |i| i % 5 != 0), flipped]), Some(8)),
            (soup(30, 0.2, 5), Some(30)),
            (some(&torus(40, 20), |i| i % 97 > 9), None),
            (some(&torus(40, 20), |i| (i * i / 7) % 2 == 0), None),
            (fan.unwrap(), Some(4)),
        ] {
            let lattice = Lattice::along_axes([2; 3], DVec3::ZERO, DVec3::ONE).unwrap();
            let cells = InCells::new(&mesh, &lattice, 1.0, &exec).unwrap();
            let found = closing(&cells, &exec).unwrap();
            assert!(count.is_none_or(|count| count == found.len()), "{} of {count:?}", found.len());
            let all: Vec<[u32; 3]> = mesh.triangles().iter().chain(&found).copied().collect();
            assert!(is_closed(mesh.positions(), &all, &exec).unwrap(), "{found:?}");
        }
    }
}
