//! What is drawn.

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

use crate::RenderError;

/// Triangles with one colour, or with colours at their corners.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMesh {
    /// Corners, in model units.
    pub positions: Vec<DVec3>,
    /// Triangles, counter-clockwise seen from their front.
    pub triangles: Vec<[u32; 3]>,
    /// Normals for smooth shading, one a corner of each triangle (`3 * triangles`), of any length. Where one is zero or
    /// not finite the triangle's own normal stands in.
    pub normals: Option<Vec<DVec3>>,
    /// Which sides of each triangle are drawn as wire: side `i` runs from corner `i` to the next. All, if none are given.
    pub edges: Option<Vec<[bool; 3]>>,
    /// The colour in linear sRGB, usually between 0 and 1.
    pub color: [f32; 3],
    /// Colours of the positions, blended over the triangles, in place of the one colour; both sides show them.
    pub colors: Option<Vec<[f32; 3]>>,
}

impl SceneMesh {
    /// A glazed blue that shows form well, on light and dark.
    pub const GLAZE: [f32; 3] = [0.075, 0.24, 0.48];

    /// Triangles in [`SceneMesh::GLAZE`], with facets and all sides.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, normals: None, edges: None, color: Self::GLAZE, colors: None }
    }
}

/// Everything that is in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The surfaces.
    pub surfaces: Vec<SceneMesh>,
}

impl Scene {
    /// The box around all positions that a triangle names; empty without triangles. Indices out of range and coordinates
    /// that are not finite are passed over.
    pub fn bounds(&self) -> Aabb {
        let corners = self.surfaces.iter().flat_map(|mesh| {
            mesh.triangles.iter().flatten().filter_map(|&index| mesh.positions.get(index as usize).copied())
        });
        Aabb::from_points(corners.filter(|corner| corner.is_finite()))
    }

    /// Checks lengths, indices and coordinates, and counts the triangles and positions.
    pub(crate) fn validate(&self) -> Result<(usize, usize), RenderError> {
        let (mut triangles, mut positions) = (0, 0);
        for (mesh, surface) in self.surfaces.iter().enumerate() {
            let count = surface.triangles.len();
            let length = |list, found, expected| match found == expected {
                true => Ok(()),
                false => Err(RenderError::Length { mesh, list, found, expected }),
            };
            if let Some(normals) = &surface.normals {
                length("normals", normals.len(), 3 * count)?;
            }
            if let Some(edges) = &surface.edges {
                length("edge flags", edges.len(), count)?;
            }
            if let Some(colors) = &surface.colors {
                length("colours", colors.len(), surface.positions.len())?;
            }
            for (triangle, &found) in
                surface.triangles.iter().enumerate().flat_map(|(i, t)| t.iter().map(move |c| (i, c)))
            {
                let Some(&position) = surface.positions.get(found as usize) else {
                    return Err(RenderError::Index { mesh, triangle, found, positions: surface.positions.len() });
                };
                // Squares of lengths must stay finite.
                if !position.is_finite() || position.abs().max_element() >= 1e150 {
                    return Err(RenderError::NotFinite { mesh, position: found, found: position });
                }
            }
            triangles += count;
            positions += surface.positions.len();
        }
        let most = triangles.max(positions);
        if most >= u32::MAX as usize {
            return Err(RenderError::TooMany { found: most });
        }
        if triangles == 0 { Err(RenderError::Empty) } else { Ok((triangles, positions)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one() -> SceneMesh {
        SceneMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]])
    }

    fn found(mesh: SceneMesh) -> RenderError {
        Scene { surfaces: vec![one(), mesh] }.validate().unwrap_err()
    }

    #[test]
    fn wrong_scenes_are_named() {
        assert_eq!(Scene::default().validate(), Err(RenderError::Empty));
        let wrong = found(SceneMesh { triangles: vec![[0, 1, 3]], ..one() });
        assert_eq!(wrong, RenderError::Index { mesh: 1, triangle: 0, found: 3, positions: 3 });
        for x in [f64::NAN, f64::INFINITY, 1e200] {
            let mut mesh = one();
            mesh.positions[2].y = x;
            assert!(matches!(found(mesh), RenderError::NotFinite { mesh: 1, position: 2, .. }));
        }
        let wrong = found(SceneMesh { normals: Some(vec![DVec3::Z]), ..one() });
        assert_eq!(wrong, RenderError::Length { mesh: 1, list: "normals", found: 1, expected: 3 });
        assert!(matches!(found(SceneMesh { edges: Some(vec![]), ..one() }), RenderError::Length { .. }));
        assert!(matches!(found(SceneMesh { colors: Some(vec![[0.0; 3]]), ..one() }), RenderError::Length { .. }));
    }

    #[test]
    fn bounds_hold_what_triangles_name() {
        let mut mesh = one();
        mesh.positions.push(DVec3::splat(9.0));
        assert_eq!(Scene { surfaces: vec![mesh] }.bounds(), Aabb::from_corners(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)));
    }
}
