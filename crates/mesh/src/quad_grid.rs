//! Grids of points as quadrilaterals.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec};

use crate::{Column, Domain, HeightField, MeshError, PolyMesh, TEXCOORD};

/// Points in columns along u and rows along v, as a surface of quadrilaterals between neighbours.
///
/// In a direction that is closed the last point is a neighbour of the first, which is not repeated. A point with a NaN is
/// a hole: quadrilaterals that touch it are left out.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadGrid {
    columns: u32,
    rows: u32,
    points: Vec<DVec3>,
    closed: [bool; 2],
}

impl QuadGrid {
    /// A grid of `columns × rows` points, row by row, closed along u and v or not.
    ///
    /// # Errors
    /// Fewer than two points along a direction, or than three along a closed one; another number of points; an infinite
    /// coordinate.
    pub fn try_new(columns: u32, rows: u32, points: Vec<DVec3>, closed: [bool; 2]) -> Result<Self, MeshError> {
        let least = closed.map(|closed| if closed { 3 } else { 2 });
        let wanted = u64::from(columns) * u64::from(rows);
        if columns < least[0] || rows < least[1] || wanted != points.len() as u64 {
            let (columns, rows) = (u64::from(columns), u64::from(rows));
            return Err(MeshError::GridSize { columns, rows, found: points.len() as u64 });
        }
        crate::poly_mesh::check_count("points", points.len())?;
        let infinite = |point: &DVec3| point.to_array().into_iter().any(f64::is_infinite);
        if let Some(index) = points.iter().position(infinite) {
            return Err(MeshError::NotFinite { kind: "point", index: index as u64 });
        }
        Ok(Self { columns, rows, points, closed })
    }

    /// The number of points along u.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// The number of points along v.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// The points, row by row.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Whether the last point is a neighbour of the first, along u and along v.
    pub fn closed(&self) -> [bool; 2] {
        self.closed
    }

    /// The quadrilaterals, counter-clockwise in (u, v), over the points that some quadrilateral has, in their order. Texture coordinates
    /// are u and v from 0 to 1: on vertices where the grid is open, on wedges where it is closed, as the first points are
    /// then at 0 and at 1. Cost: linear.
    ///
    /// # Errors
    /// More corners than 32 bits can tell apart; over the memory budget; cancellation.
    pub fn to_mesh(&self, exec: &Exec) -> Result<PolyMesh, ConvertError> {
        let cells = [(self.columns, 0), (self.rows, 1)].map(|(count, axis)| count - u32::from(!self.closed[axis]));
        let most = u64::from(cells[0]) * u64::from(cells[1]);
        let _memory = exec.reserve_elements(most, 4 * (4 + 16) + 8)?;
        let _points = exec.reserve_elements(self.points.len() as u64, 24 + 16 + 4 + 1)?;
        let seam = self.closed[0] || self.closed[1];
        let part = |i: u32, axis: usize| f64::from(i) / f64::from(cells[axis]);
        let mut used = vec![false; self.points.len()];
        // No list grows beyond what is reserved.
        let wedges = 4 * cells[0] as usize * cells[1] as usize;
        let mut corners = Vec::with_capacity(wedges);
        let mut coordinates = Vec::with_capacity(if seam { wedges } else { self.points.len() });
        for row in 0..cells[1] {
            exec.check()?;
            exec.progress(f64::from(row) / f64::from(cells[1]));
            for column in 0..cells[0] {
                let places = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| (column + i, row + j));
                let ids = places.map(|(i, j)| (j % self.rows) * self.columns + i % self.columns);
                if ids.iter().any(|&id| self.points[id as usize].is_nan()) {
                    continue;
                }
                ids.into_iter().for_each(|id| used[id as usize] = true);
                corners.extend(ids);
                if seam {
                    coordinates.extend(places.map(|(i, j)| [part(i, 0), part(j, 1)]));
                }
            }
        }
        let mut vertex_of = vec![u32::MAX; self.points.len()];
        let mut positions = Vec::with_capacity(self.points.len());
        for (id, point) in self.points.iter().enumerate().filter(|(id, _)| used[*id]) {
            vertex_of[id] = positions.len() as u32;
            positions.push(*point);
            if !seam {
                coordinates.push([part(id as u32 % self.columns, 0), part(id as u32 / self.columns, 1)]);
            }
        }
        corners.iter_mut().for_each(|corner| *corner = vertex_of[*corner as usize]);
        crate::poly_mesh::check_count("wedges", corners.len())?;
        let starts = (0..=corners.len() as u32 / 4).map(|face| 4 * face).collect();
        let mut mesh = PolyMesh::try_new(positions, starts, corners)?;
        let domain = if seam { Domain::Wedge } else { Domain::Vertex };
        mesh.insert_attribute(domain, Column::texcoords(TEXCOORD, &coordinates)).map_err(MeshError::from)?;
        Ok(mesh)
    }
}

/// The samples of a height field in space, holes as NaN. Where the placement mirrors, rows are listed from the last to the
/// first, so that quadrilaterals still face the rising heights.
impl From<&HeightField> for QuadGrid {
    fn from(field: &HeightField) -> Self {
        let mirrored = field.placement().reverses_orientation();
        let row = |j: u32| if mirrored { field.rows() - 1 - j } else { j };
        let samples = (0..field.rows()).flat_map(|j| (0..field.columns()).map(move |i| (i, j)));
        let points = samples.map(|(i, j)| field.sample(i, row(j)).unwrap_or(DVec3::NAN)).collect();
        Self { columns: field.columns(), rows: field.rows(), points, closed: [false; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Affine;
    use shapeloom_core::glam::DVec2;
    use std::f64::consts::{PI, TAU};

    fn torus(columns: u32, rows: u32) -> QuadGrid {
        let points = (0..columns * rows).map(|k| {
            let (u, v) = (f64::from(k % columns) / f64::from(columns), f64::from(k / columns) / f64::from(rows));
            let (around, tube) = (DVec2::from_angle(TAU * u), DVec2::from_angle(TAU * v));
            (around * (3.0 + tube.x)).extend(tube.y)
        });
        QuadGrid::try_new(columns, rows, points.collect(), [true, true]).unwrap()
    }

    #[test]
    fn closed_grids_have_no_border_and_their_seam_in_the_texture() {
        let mesh = torus(200, 100).to_mesh(&Exec::default()).unwrap();
        assert_eq!((mesh.face_count(), mesh.positions().len()), (20_000, 20_000));
        let volume = 2.0 * PI * PI * 3.0;
        assert!(mesh.volume() < volume && mesh.volume() > 0.998 * volume, "{}", mesh.volume());
        let texture = mesh.attribute(Domain::Wedge, TEXCOORD).unwrap();
        // The last face: its corners are at the ends of u and v.
        let of_last = |k: usize| (texture.number(79_996 + k, 0), texture.number(79_996 + k, 1));
        assert_eq!((of_last(0), of_last(2)), ((0.995, 0.99), (1.0, 1.0)));
    }

    #[test]
    fn cylinders_close_along_one_direction() {
        let points = (0..8 * 3).map(|k| DVec2::from_angle(TAU * f64::from(k % 8) / 8.0).extend(f64::from(k / 8)));
        let tube = QuadGrid::try_new(8, 3, points.collect(), [true, false]).unwrap().to_mesh(&Exec::default()).unwrap();
        assert_eq!((tube.face_count(), tube.positions().len()), (16, 24));
        assert!((tube.area() - 16.0 * 2.0 * (PI / 8.0).sin()).abs() < 1e-14);
    }

    #[test]
    fn height_fields_keep_holes_and_fronts() {
        let heights = (0..20).map(|k| if k == 6 { f64::NAN } else { 0.0 }).collect();
        let field = HeightField::try_new(5, 4, DVec2::new(2.0, 1.0), heights).unwrap();
        for placement in [Affine::IDENTITY, Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0))] {
            let mesh = QuadGrid::from(&field.clone().placed(placement)).to_mesh(&Exec::default()).unwrap();
            assert_eq!((mesh.face_count(), mesh.positions().len()), (8, 16));
            assert!((0..8).all(|face| crate::newell_vector(mesh.outline(face)).z == 4.0));
            assert!(mesh.attribute(Domain::Vertex, TEXCOORD).is_some());
        }
    }

    #[test]
    fn impossible_grids_are_refused() {
        let points = vec![DVec3::ZERO; 4];
        assert!(QuadGrid::try_new(2, 2, points.clone(), [true, false]).is_err());
        assert!(QuadGrid::try_new(4, 1, points.clone(), [false, false]).is_err());
        assert!(QuadGrid::try_new(2, 3, points.clone(), [false, false]).is_err());
        assert!(QuadGrid::try_new(2, 2, vec![DVec3::INFINITY; 4], [false, false]).is_err());
        let holes = QuadGrid::try_new(2, 2, vec![DVec3::NAN; 4], [false, false]).unwrap();
        assert_eq!(holes.to_mesh(&Exec::default()).unwrap().face_count(), 0);
        assert!(QuadGrid::try_new(u32::MAX, u32::MAX, points, [false, false]).is_err());
    }
}
