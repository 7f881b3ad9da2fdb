//! Finer triangles for finer colours.

use shapeloom_core::glam::DVec3;

use crate::SceneMesh;

/// A side is divided into this many parts at most.
const MOST_PARTS: u32 = 256;

impl SceneMesh {
    /// The same surface in triangles whose sides are no longer than `edge_length`, as far as that takes no more than
    /// about `most` triangles and 256 parts a side, so that colours of vertices can vary within a large triangle.
    /// Normals and the sides that are drawn are those of the triangles that were there; colours are dropped, and each
    /// triangle has corners of its own.
    #[must_use]
    pub fn refined(&self, edge_length: f64, most: usize) -> Self {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| self.positions[corner as usize]);
        let parts_at = |edge_length: f64, triangle: &[u32; 3]| {
            let [a, b, c] = corners(triangle);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            // NaN and infinity give one part.
            let parts = (longest / edge_length).ceil();
            if parts.is_finite() { (parts as u32).clamp(1, MOST_PARTS) } else { 1 }
        };
        let count = |edge_length: f64| -> usize {
            self.triangles.iter().map(|triangle| parts_at(edge_length, triangle).pow(2) as usize).sum()
        };
        let longest = self.triangles.iter().map(|triangle| {
            let [a, b, c] = corners(triangle);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        });
        let longest = longest.fold(0.0, f64::max);
        let mut edge_length =
            if edge_length.is_nan() { longest } else { edge_length.max(longest / f64::from(MOST_PARTS)) };
        while edge_length < longest && count(edge_length) > most.max(self.triangles.len()) {
            edge_length *= 1.25;
        }
        let mut fine = Self {
            normals: self.normals.as_ref().map(|_| Vec::new()),
            edges: Some(Vec::new()),
            ..Self::new(vec![], vec![])
        };
        fine.color = self.color;
        for (index, triangle) in self.triangles.iter().enumerate() {
            let parts = parts_at(edge_length, triangle);
            let normals = self.normals.as_ref().map(|normals| [0, 1, 2].map(|corner| normals[3 * index + corner]));
            let drawn = self.edges.as_ref().map_or([true; 3], |edges| edges[index]);
            fine.add_divided(corners(triangle), normals, drawn, parts);
        }
        fine
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
        let fine = mesh.refined(0.5, 1000);
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
    fn limits_are_kept_and_fine_meshes_stay() {
        assert!(square().refined(1e-9, 500).triangles.len() <= 500);
        let same = square().refined(10.0, 500);
        assert_eq!((same.triangles.len(), same.positions.len()), (2, 6));
        assert_eq!(square().refined(f64::NAN, 10).triangles.len(), 2);
        assert_eq!(square().refined(0.0, 10).triangles.len(), 8);
        assert_eq!(square().refined(f64::INFINITY, 10).triangles.len(), 2);
    }
}
