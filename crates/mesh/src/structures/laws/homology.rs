//! The boundary matrices have the ranks that homology knows of surfaces.

use shapeloom_core::Exec;

use super::meshes::{Dice, cube, in_triangles, klein_bottle, mesh, moebius_strip, random, tetrahedron, torus};
use crate::structures::{IncidenceMatrices, IndexedPolygons, SignedMatrix};

/// The rank modulo a prime, by elimination in a full matrix.
fn rank(matrix: &SignedMatrix, prime: i64) -> usize {
    let full = |row: u32| {
        let mut numbers = vec![0i64; matrix.column_count()];
        matrix.row(row).for_each(|(column, sign)| numbers[column as usize] += i64::from(sign));
        numbers
    };
    let mut rows: Vec<Vec<i64>> = (0..matrix.row_count() as u32).map(full).collect();
    let mut rank = 0;
    for column in 0..matrix.column_count() {
        let Some(pivot) = (rank..rows.len()).find(|&row| rows[row][column].rem_euclid(prime) != 0) else { continue };
        rows.swap(rank, pivot);
        let pivot_row = rows[rank].clone();
        let inverse = (1..prime).find(|&x| (x * pivot_row[column]).rem_euclid(prime) == 1).expect("a prime");
        for row in rows.iter_mut().skip(rank + 1) {
            let factor = (row[column] * inverse).rem_euclid(prime);
            if factor != 0 {
                row.iter_mut().zip(&pivot_row).for_each(|(a, b)| *a = (*a - factor * b).rem_euclid(prime));
            }
        }
        rank += 1;
    }
    rank
}

fn betti(vertices: u32, faces: &[Vec<u32>], prime: i64) -> [usize; 3] {
    let faces = mesh("", vertices, faces).faces;
    let matrices = IncidenceMatrices::try_build(&faces, &Exec::default()).unwrap();
    let (d1, d2) = (matrices.vertex_edge(), matrices.edge_face());
    let [r1, r2] = [rank(d1, prime), rank(d2, prime)];
    [d1.row_count() - r1, d1.column_count() - r1 - r2, d2.column_count() - r2]
}

#[test]
fn surfaces_have_their_betti_numbers() {
    for prime in [2, 3, 7] {
        assert_eq!(betti(8, &cube(), prime), [1, 0, 1], "a sphere");
        assert_eq!(betti(4, &tetrahedron(), prime), [1, 0, 1], "a sphere");
        assert_eq!(betti(8, &cube()[1..], prime), [1, 0, 0], "a disk");
        assert_eq!(betti(8, &cube()[2..], prime), [1, 1, 0], "a ring");
        assert_eq!(betti(20, &torus(5, 4), prime), [1, 2, 1], "a torus");
        assert_eq!(betti(20, &in_triangles(&torus(5, 4)), prime), [1, 2, 1], "a torus");
        assert_eq!(betti(18, &moebius_strip(6, 2), prime), [1, 1, 0], "a Moebius strip");
        // An isolated vertex is a component.
        assert_eq!(betti(9, &cube(), prime), [2, 0, 1]);
    }
    // Only modulo 2 is a Klein bottle closed.
    assert_eq!(betti(20, &klein_bottle(5, 4), 2), [1, 2, 1]);
    assert_eq!(betti(20, &klein_bottle(5, 4), 3), [1, 1, 0]);
}

#[test]
fn a_boundary_has_no_boundary() {
    let mut dice = Dice(23);
    let mut held = 0;
    for _ in 0..500 {
        let faces: IndexedPolygons = random(&mut dice).faces;
        let Ok(matrices) = IncidenceMatrices::try_build(&faces, &Exec::default()) else { continue };
        held += 1;
        for face in 0..matrices.edge_face().column_count() as u32 {
            let mut sums = std::collections::BTreeMap::<u32, i32>::new();
            for (edge, sign) in matrices.edge_face().column(face) {
                for (vertex, end) in matrices.vertex_edge().column(edge) {
                    *sums.entry(vertex).or_default() += i32::from(sign * end);
                }
            }
            assert!(sums.values().all(|&sum| sum == 0), "{sums:?}");
        }
        // Rows and columns are the same entries.
        for matrix in [matrices.vertex_edge(), matrices.edge_face()] {
            let by_columns = (0..matrix.column_count() as u32)
                .flat_map(|column| matrix.column(column).map(move |(row, sign)| (row, column, sign)));
            let mut by_columns: Vec<_> = by_columns.collect();
            by_columns.sort_unstable();
            let by_rows = (0..matrix.row_count() as u32)
                .flat_map(|row| matrix.row(row).map(move |(column, sign)| (row, column, sign)));
            assert!(by_rows.eq(by_columns));
        }
    }
    assert!(held > 100);
}
