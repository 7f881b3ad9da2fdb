//! What the coordinates of a mesh come to: area, volume, faces without area, vertices in one place.

use std::cmp::Ordering;

use shapeloom_core::Exec;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::orient2d;
use shapeloom_mesh::{PolyMesh, TriMesh};

use crate::equal_positions::equal_positions;
use crate::{JudgeError, MeshRef, Scaled};

/// The sizes of a mesh and the elements that have none.
///
/// Cost: O(n log n) for n vertices and O(f) for f faces; 16 bytes a vertex while it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// The sum of the faces' areas. None where it is no number: too large, or so small that it vanishes.
    pub area: Option<f64>,
    /// The signed volume under the faces, to the centre of the bounding box: the volume enclosed where the mesh is closed
    /// and oriented, else it depends on that centre. None where it is no number, as for the area.
    pub volume: Option<f64>,
    /// Faces whose corners all lie on one line, decided exactly, rising.
    pub flat_faces: Vec<u32>,
    /// Vertices at exactly the position of an earlier one (−0 equals 0): the first vertex there and the later one, by the
    /// later one.
    pub coincident_vertices: Vec<[u32; 2]>,
}

impl Measures {
    /// Measures a mesh.
    ///
    /// # Errors
    /// A position that is not finite, a face whose corners differ so much in size that exact arithmetic would underflow,
    /// the memory budget, or the reason to stop.
    pub fn of<'a>(mesh: impl Into<MeshRef<'a>>, exec: &Exec) -> Result<Self, JudgeError> {
        let mesh = mesh.into();
        let positions = mesh.positions();
        if let Some(vertex) = positions.iter().position(|position| !position.is_finite()) {
            return Err(JudgeError::NotFinite { vertex: vertex as u32, found: positions[vertex] });
        }
        let [area, volume] = sizes(mesh, exec)?;
        let flat_faces = flat_faces(mesh, exec)?;
        exec.progress(0.5);
        let coincident_vertices = coincident(positions, exec)?;
        exec.progress(1.0);
        Ok(Self { area, volume, flat_faces, coincident_vertices })
    }
}

/// Area and volume, measured where products of three coordinates neither overflow nor vanish.
fn sizes(mesh: MeshRef<'_>, exec: &Exec) -> Result<[Option<f64>; 2], JudgeError> {
    let positions = mesh.positions();
    let largest = positions.iter().map(|position| position.abs().max_element()).fold(0.0, f64::max);
    let safe = largest == 0.0 || (1e-90..1e90).contains(&largest);
    if safe {
        let [area, volume] = match mesh {
            MeshRef::Triangles(mesh) => [mesh.area(), mesh.volume()],
            MeshRef::Polygons(mesh) => [mesh.area(), mesh.volume()],
        };
        return Ok([Some(area), Some(volume)]);
    }
    let corners = mesh.faces(exec)?.corners().len() as u64;
    let _memory = exec.reserve(positions.len() as u64 * size_of::<DVec3>() as u64 + corners * 12)?;
    // A power of two, taken in two steps that are both numbers. Small coordinates may round: far below the sum's error.
    let exponent = -largest.log2().floor() as i32;
    let [first, second] = [exponent / 2, exponent - exponent / 2].map(|half| 2f64.powi(half));
    let moved: Vec<DVec3> = positions.iter().map(|&position| position * first * second).collect();
    let same = "indices that made a mesh before";
    let [area, volume] = match mesh {
        MeshRef::Triangles(mesh) => {
            let mesh = TriMesh::try_new(moved, mesh.triangles().to_vec()).expect(same);
            [mesh.area(), mesh.volume()]
        }
        MeshRef::Polygons(mesh) => {
            let (starts, corners) = (mesh.face_starts().to_vec(), mesh.wedge_vertices().to_vec());
            let mesh = PolyMesh::try_new(moved, starts, corners).expect(same);
            [mesh.area(), mesh.volume()]
        }
    };
    let back = |value: f64, power: u32| {
        let sized = (0..power).fold(value, |value, _| value / first / second);
        (sized.is_normal() || value == 0.0).then_some(sized)
    };
    Ok([back(area, 2), back(volume, 3)])
}

fn flat_faces(mesh: MeshRef<'_>, exec: &Exec) -> Result<Vec<u32>, JudgeError> {
    let positions = mesh.positions();
    let faces = mesh.faces(exec)?;
    let mut found = Vec::new();
    for face in 0..faces.len() as u32 {
        if face.is_multiple_of(1 << 14) {
            exec.check()?;
        }
        let cycle = faces.face(face);
        let at = |corner: usize| positions[cycle[corner] as usize];
        // A line through the first corner and the first that lies elsewhere.
        let Some(other) = (1..cycle.len()).find(|&corner| at(corner) != at(0)) else {
            found.push(face);
            continue;
        };
        let mut flat = true;
        for corner in other + 1..cycle.len() {
            let three = [at(0), at(other), at(corner)];
            flat = flat
                && collinear(three).map_err(|which| JudgeError::Underflow {
                    vertex: cycle[[0, other, corner][which]],
                    found: three[which],
                    largest: three.map(|point| point.abs().max_element()).into_iter().fold(0.0, f64::max),
                })?;
            if !flat {
                break;
            }
        }
        if flat {
            found.push(face);
        }
    }
    Ok(found)
}

/// Whether three points lie on one line, exactly; an error with the point whose bits exact products would lose.
fn collinear([a, b, c]: [DVec3; 3]) -> Result<bool, usize> {
    let (u, v) = (b - a, c - a);
    for [i, j] in [[0, 1], [1, 2], [2, 0]] {
        let (left, right) = (u[i] * v[j], u[j] * v[i]);
        // Each difference, product and their difference round by 2^-53: eight times that is safe above the numbers that
        // lose bits. Infinite and absent numbers fail the comparison.
        if (left - right).abs() > 1e-15 * (left.abs() + right.abs()) && (left - right).abs() > 1e-280 {
            return Ok(false);
        }
    }
    let scaled = Scaled::new(&[a, b, c]).map_err(|error| match error {
        JudgeError::Underflow { vertex, .. } => vertex as usize,
        _ => 0,
    })?;
    let [a, b, c] = [0, 1, 2].map(|k| scaled.positions[k]);
    let flat = |i: usize, j: usize| {
        let [a, b, c] = [a, b, c].map(|p| DVec2::new(p[i], p[j]));
        orient2d(a, b, c) == Ordering::Equal
    };
    Ok(flat(0, 1) && flat(1, 2) && flat(2, 0))
}

fn coincident(positions: &[DVec3], exec: &Exec) -> Result<Vec<[u32; 2]>, JudgeError> {
    let _memory = exec.reserve_elements(positions.len() as u64, 32)?;
    let first = equal_positions(positions);
    exec.check()?;
    let later = first.iter().enumerate().filter(|&(vertex, &first)| vertex as u32 != first);
    Ok(later.map(|(vertex, &first)| [first, vertex as u32]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(size: f64, at: DVec3) -> PolyMesh {
        let positions =
            (0..8).map(|i| at + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * size);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        PolyMesh::from_faces(positions.collect(), &faces).unwrap()
    }

    #[test]
    fn sizes_far_from_one_are_right_or_none() {
        let of = |size: f64, at: f64| Measures::of(&cube(size, DVec3::splat(at)), &Exec::default()).unwrap();
        for exponent in [-300, -100, -30, 0, 22, 100, 300] {
            let (size, found) = (2f64.powi(exponent), of(2f64.powi(exponent), 0.0));
            assert_eq!((found.area, found.volume), (Some(6.0 * size * size), Some(size * size * size)), "{exponent}");
            assert!(found.flat_faces.is_empty() && found.coincident_vertices.is_empty());
        }
        let huge = of(1e150, 0.0);
        assert!((huge.area.unwrap() / 6e300 - 1.0).abs() < 1e-12);
        assert_eq!(huge.volume, None);
        assert_eq!((of(1e200, 0.0).area, of(1e-200, 0.0).area), (None, None));
        let tiny = of(1e-150, 0.0);
        assert!((tiny.area.unwrap() / 6e-300 - 1.0).abs() < 1e-12 && tiny.volume.is_none());
        assert_eq!(of(1.0, 5e6).volume, Some(1.0));
        assert_eq!(of(0.0, 0.0).area, Some(0.0));
    }

    #[test]
    fn flatness_is_exact() {
        let unit = 2f64.powi(-53);
        let triangle = |third: DVec3| {
            let positions = vec![DVec3::splat(0.5), DVec3::splat(12.0), third];
            TriMesh::try_new(positions, vec![[0, 1, 2]]).unwrap()
        };
        // A point on the diagonal, and the next number beside it.
        for (third, flat) in [
            (DVec3::splat(24.0), true),
            (DVec3::new(24.0, 24.0, 24.0f64.next_up()), false),
            (DVec3::new(0.5 + unit, 0.5 + unit, 0.5 + unit), true),
            (DVec3::new(0.5 + 2.0 * unit, 0.5, 0.5), false),
            (DVec3::splat(12.0), true),
        ] {
            let found = Measures::of(&triangle(third), &Exec::default()).unwrap();
            assert_eq!(!found.flat_faces.is_empty(), flat, "{third}");
        }
        // On a line through the origin, where the differences round.
        for k in 1..200 {
            let p = DVec3::new(0.1, 0.7, 0.3) * f64::from(k);
            let mesh = TriMesh::try_new(vec![p, p * 2.0, p * 4.0], vec![[0, 1, 2]]).unwrap();
            assert_eq!(Measures::of(&mesh, &Exec::default()).unwrap().flat_faces, [0], "{k}");
        }
        let positions = (0..5).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 4), 0.0)).collect();
        let polygons = PolyMesh::from_faces(positions, &[&[0, 1, 2, 3][..], &[0, 0, 0], &[0, 1, 2, 4]]).unwrap();
        assert_eq!(Measures::of(&polygons, &Exec::default()).unwrap().flat_faces, [0, 1]);
    }

    #[test]
    fn vertices_in_one_place_are_paired_with_the_first() {
        let positions = vec![DVec3::X, DVec3::ZERO, -DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, -0.0, 0.0)];
        let mesh = TriMesh::try_new(positions, vec![]).unwrap();
        let found = Measures::of(&mesh, &Exec::default()).unwrap();
        assert_eq!(found.coincident_vertices, [[1, 2], [0, 3], [0, 5]]);
    }

    #[test]
    fn what_cannot_be_decided_is_refused_and_named() {
        let mesh = |third: DVec3| TriMesh::try_new(vec![DVec3::ZERO, DVec3::X, third], vec![[2, 0, 1]]).unwrap();
        let found = Measures::of(&mesh(DVec3::new(0.5, f64::NAN, 0.0)), &Exec::default());
        assert!(matches!(found, Err(JudgeError::NotFinite { vertex: 2, .. })));
        let found = Measures::of(&mesh(DVec3::new(0.5, 1e-290, 0.0)), &Exec::default());
        assert!(matches!(found, Err(JudgeError::Underflow { vertex: 2, .. })), "{found:?}");
    }
}
