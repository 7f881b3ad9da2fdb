//! Finer triangles for finer colours.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Stop};

use crate::{Scene, SceneMesh};

/// A side is divided into this many parts at most.
const MOST_PARTS: u32 = 256;

/// How finely the surfaces of a scene are divided, and how much they become in all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// No side of a triangle is longer.
    pub edge_length: f64,
    /// The triangles of all surfaces.
    pub triangles: u64,
    /// Their positions: each triangle that was there has corners of its own.
    pub positions: u64,
}

impl Scene {
    /// The refinement with sides no longer than `edge_length`, as far as that takes no more than `most` triangles in all,
    /// or one each, and 256 parts a side. An edge length that is no number divides nothing.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn refinement(&self, edge_length: f64, most: u64, exec: &Exec) -> Result<Refinement, Stop> {
        let mut longest = 0.0f64;
        for surface in &self.surfaces {
            for triangles in surface.triangles.chunks(BATCH) {
                exec.check()?;
                longest = triangles.iter().map(|triangle| surface.longest(triangle)).fold(longest, f64::max);
            }
        }
        let edge_length = if edge_length.is_nan() { longest } else { edge_length.max(longest / f64::from(MOST_PARTS)) };
        let mut found = self.refined_to(edge_length, exec)?;
        while found.edge_length < longest && found.triangles > most {
            found = self.refined_to(found.edge_length * 1.25, exec)?;
        }
        Ok(found)
    }

    fn refined_to(&self, edge_length: f64, exec: &Exec) -> Result<Refinement, Stop> {
        let mut found = Refinement { edge_length, triangles: 0, positions: 0 };
        for surface in &self.surfaces {
            let [triangles, positions] = surface.refined_size(edge_length, exec)?;
            found.triangles += triangles;
            found.positions += positions;
        }
        Ok(found)
    }
}

/// Triangles between looks at whether to stop.
const BATCH: usize = 1 << 14;

impl SceneMesh {
    /// The same surface in triangles whose sides are no longer than `edge_length`, as far as 256 parts a side do, so that
    /// colours of vertices can vary within a large triangle. Normals and the sides that are drawn are those of the
    /// triangles that were there; colours are dropped, and each triangle has corners of its own.
    ///
    /// [`Scene::refinement`] says how large all surfaces become, so that memory can be reserved.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn refined(&self, edge_length: f64, exec: &Exec) -> Result<Self, Stop> {
        let [triangles, positions] = self.refined_size(edge_length, exec)?.map(|count| count as usize);
        let mut fine = Self {
            normals: self.normals.as_ref().map(|_| Vec::with_capacity(3 * triangles)),
            edges: Some(Vec::with_capacity(triangles)),
            color: self.color,
            ..Self::new(Vec::with_capacity(positions), Vec::with_capacity(triangles))
        };
        let mut next = BATCH;
        for (index, triangle) in self.triangles.iter().enumerate() {
            if fine.triangles.len() >= next {
                exec.check()?;
                next = fine.triangles.len() + BATCH;
            }
            let corners = triangle.map(|corner| self.positions[corner as usize]);
            let normals = self.normals.as_ref().map(|normals| [0, 1, 2].map(|corner| normals[3 * index + corner]));
            let drawn = self.edges.as_ref().map_or([true; 3], |edges| edges[index]);
            fine.add_divided(corners, normals, drawn, self.parts(triangle, edge_length));
        }
        Ok(fine)
    }

    /// How many triangles and positions the refined surface has.
    fn refined_size(&self, edge_length: f64, exec: &Exec) -> Result<[u64; 2], Stop> {
        let [mut triangles, mut positions] = [0u64; 2];
        for batch in self.triangles.chunks(BATCH) {
            exec.check()?;
            for triangle in batch {
                let parts = u64::from(self.parts(triangle, edge_length));
                triangles += parts * parts;
                positions += (parts + 1) * (parts + 2) / 2;
            }
        }
        Ok([triangles, positions])
    }

    fn longest(&self, triangle: &[u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|corner| self.positions[corner as usize]);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }

    /// Into how many parts the sides of a triangle are divided.
    fn parts(&self, triangle: &[u32; 3], edge_length: f64) -> u32 {
        // NaN and infinity give one part.
        let parts = (self.longest(triangle) / edge_length).ceil();
        if parts.is_finite() { (parts as u32).clamp(1, MOST_PARTS) } else { 1 }
    }

    fn add_divided(&mut self, corners: [DVec3; 3], normals: Option<[DVec3; 3]>, drawn: [bool; 3], parts: u32) {
        let first = self.positions.len() as u32;
        let step = 1.0 / f64::from(parts);
        // The corners themselves, not what rounding makes of them.
        let mix = |values: &[DVec3; 3], i: u32, j: u32| match parts - i - j {
            _ if i == parts => values[1],
            _ if j == parts => values[2],
            k if k == parts => values[0],
            k => (values[0] * f64::from(k) + values[1] * f64::from(i) + values[2] * f64::from(j)) * step,
        };
        // Rows of `parts + 1`, `parts`, ... points.
        let at = |i: u32, j: u32| first + j * (parts + 1) - j * j.saturating_sub(1) / 2 + i;
        for j in 0..=parts {
            self.positions.extend((0..=parts - j).map(|i| mix(&corners, i, j)));
        }
        let mut add = |places: [(u32, u32); 3], sides: [bool; 3]| {
            self.triangles.push(places.map(|(i, j)| at(i, j)));
            if let (Some(all), Some(normals)) = (&mut self.normals, &normals) {
                all.extend(places.map(|(i, j)| mix(normals, i, j)));
            }
            if let Some(all) = &mut self.edges {
                all.push(sides);
            }
        };
        for j in 0..parts {
            for i in 0..parts - j {
                let on = [drawn[0] && j == 0, drawn[1] && i + j + 1 == parts, drawn[2] && i == 0];
                add([(i, j), (i + 1, j), (i, j + 1)], on);
                if i + j + 1 < parts {
                    add([(i + 1, j), (i + 1, j + 1), (i, j + 1)], [false; 3]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::square;

    #[test]
    fn pieces_cover_the_triangles_with_their_sides_and_normals() {
        let mesh = SceneMesh {
            normals: Some(vec![DVec3::Z; 6]),
            edges: Some(vec![[true, true, false], [false, true, true]]),
            ..square()
        };
        let fine = mesh.refined(0.5, &Exec::default()).unwrap();
        // Sides of 2 and a diagonal of 2.83: six parts each.
        assert_eq!((fine.triangles.len(), fine.positions.len()), (72, 56));
        let corner = |i: u32| fine.positions[i as usize];
        let doubled: f64 =
            fine.triangles.iter().map(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).z).sum();
        assert!((doubled - 8.0).abs() < 1e-12);
        assert!(
            fine.triangles.iter().all(|t| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).z > 0.0)
        );
        let drawn = fine.edges.as_ref().unwrap().iter().flatten().filter(|&&drawn| drawn).count();
        assert_eq!((drawn, fine.normals.as_ref().unwrap().len()), (24, 216));
        assert!(fine.positions.contains(&DVec3::new(1.0, 1.0, 0.0)));
    }

    #[test]
    fn limits_hold_for_all_surfaces_together_and_fine_meshes_stay() {
        let exec = Exec::default();
        let scene = Scene { surfaces: vec![square(); 10] };
        for (edge_length, most, triangles) in [
            (10.0, 500, 20..=20),
            (f64::NAN, 500, 20..=20),
            (f64::INFINITY, 500, 20..=20),
            (1e-9, 500, 200..=500),
            (0.0, 5, 20..=20),
        ] {
            let found = scene.refinement(edge_length, most, &exec).unwrap();
            assert!(triangles.contains(&found.triangles), "{edge_length}: {found:?}");
            let fine: Vec<SceneMesh> =
                scene.surfaces.iter().map(|surface| surface.refined(found.edge_length, &exec).unwrap()).collect();
            // What is said is what comes out, with no room left over.
            let sum = |of: &dyn Fn(&SceneMesh) -> usize| fine.iter().map(of).sum::<usize>() as u64;
            assert_eq!(sum(&|mesh| mesh.triangles.len()), found.triangles);
            assert_eq!(sum(&|mesh| mesh.triangles.capacity()), found.triangles);
            assert_eq!(sum(&|mesh| mesh.positions.len()), found.positions);
            assert_eq!(sum(&|mesh| mesh.positions.capacity()), found.positions);
        }
        assert_eq!(Scene { surfaces: vec![] }.refinement(1.0, 9, &exec).unwrap().triangles, 0);
        let stopped = exec.with_watch(|| Some(Stop::Cancelled));
        assert_eq!(square().refined(0.5, &stopped), Err(Stop::Cancelled));
        assert_eq!(scene.refinement(0.5, 500, &stopped), Err(Stop::Cancelled));
    }
}
