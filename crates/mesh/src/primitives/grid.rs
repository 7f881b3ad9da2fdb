//! Flat grids.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Deviation, Exec, Options, options};

use super::{BYTES_A_VERTEX, FaceList, LENGTH, finish};
use crate::{Column, Domain, MeshError, PolyMesh, TEXCOORD};

options! {
    /// A flat rectangle in the plane `z = 0`, centred at the origin, cut into quadrilaterals, facing up.
    pub struct Grid("grid") {
        required {}
        optional {
            /// Its width along x, in model units.
            width: f64 [LENGTH] = 1.0,
            /// Its depth along y, in model units.
            depth: f64 [LENGTH] = 1.0,
            /// How many cells along x.
            columns: u32 [Bounds::closed(1.0, 32768.0)] = 10,
            /// How many cells along y.
            rows: u32 [Bounds::closed(1.0, 32768.0)] = 10,
        }
    }
}

impl Grid {
    /// The cells, exact up to rounding, with texture coordinates from 0 to 1.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let (columns, rows) = (self.columns, self.rows);
        let _memory = exec.reserve_elements((u64::from(columns) + 1) * (u64::from(rows) + 1), BYTES_A_VERTEX)?;
        let (mut positions, mut coordinates) = (Vec::new(), Vec::new());
        for j in 0..=rows {
            exec.check()?;
            for i in 0..=columns {
                let (s, t) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
                positions.push(DVec3::new((s - 0.5) * self.width, (t - 0.5) * self.depth, 0.0));
                coordinates.push([s, t]);
            }
        }
        let vertex = |i: u32, j: u32| j * (columns + 1) + i;
        let mut faces = FaceList::new();
        for j in 0..rows {
            for i in 0..columns {
                faces.push(&[vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
            }
        }
        let mut made = finish(Self::NAME, positions, faces.into_parts(), None, Deviation::Exact, exec)?;
        let column = Column::texcoords(TEXCOORD, &coordinates);
        made.value.insert_attribute(Domain::Vertex, column).map_err(MeshError::from)?;
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_covers_its_rectangle() {
        let grid = Grid { width: 3.0, depth: 2.0, columns: 7, rows: 5 }.mesh(&Exec::default()).unwrap().value;
        assert_eq!((grid.face_count(), grid.positions().len()), (35, 48));
        assert!((grid.area() - 6.0).abs() < 1e-14);
        assert_eq!(grid.bounds().min, DVec3::new(-1.5, -1.0, 0.0));
    }
}
