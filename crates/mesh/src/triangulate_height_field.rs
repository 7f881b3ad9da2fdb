//! Height fields to triangles.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Report, choice, options,
};

use crate::stray_samples::tell_strays;
use crate::{Column, Domain, HeightField, MeshError, TEXCOORD, TriMesh};

choice! {
    /// Which diagonal cuts a cell of a grid into two triangles.
    pub enum Diagonal {
        /// The shorter one in space; between equal ones the first.
        Shorter = "shorter",
        /// From the corner with the smallest to the one with the largest column and row.
        First = "first",
        /// The other one.
        Second = "second",
    }
}

options! {
    /// Cuts each cell of a height field into two triangles.
    ///
    /// Every sample that borders a whole cell becomes a vertex; cells that touch a hole are left out, and the
    /// report counts the samples that border no whole cell. Against the
    /// bilinear surface a cell deviates by at most a quarter of |h00 - h10 - h01 + h11|, in the middle of its diagonal:
    /// the report has the largest, stretched as the placement stretches heights. Texture coordinates run from 0 to 1
    /// over the grid. Cost: linear.
    pub struct TriangulateHeightField("triangulate-height-field") {
        required {}
        optional {
            /// Which diagonal cuts a cell.
            diagonal: Diagonal = Diagonal::Shorter,
        }
    }
}

impl FromTolerance<HeightField> for TriangulateHeightField {
    fn from_tolerance(_: &HeightField, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<HeightField> for TriangulateHeightField {
    type Output = TriMesh;

    fn convert_with(&self, source: &HeightField, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (columns, rows) = (source.columns(), source.rows());
        let samples = source.heights().len() as u64;
        let _memory = exec.reserve_elements(samples, 2 * (size_of::<DVec3>() + 12 + 3 * 16))?;
        let index = |column: u32, row: u32| row * columns + column;
        let at = |column: u32, row: u32| source.sample(column, row);
        let mut cells = Vec::new();
        let mut twist = 0.0f64;
        for row in 0..rows - 1 {
            exec.check()?;
            exec.progress(f64::from(row) / f64::from(rows));
            for column in 0..columns - 1 {
                let ids = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| index(column + i, row + j));
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| at(column + i, row + j));
                let [Some(a), Some(b), Some(c), Some(d)] = corners else { continue };
                let [ha, hb, hc, hd] = ids.map(|id| source.heights()[id as usize]);
                twist = twist.max((ha - hb + hc - hd).abs());
                let first = match self.diagonal {
                    Diagonal::First => true,
                    Diagonal::Second => false,
                    Diagonal::Shorter => a.distance_squared(c) <= b.distance_squared(d),
                };
                let [a, b, c, d] = ids;
                cells.extend(if first { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
        let mut vertex_of = vec![u32::MAX; source.heights().len()];
        let (mut positions, mut coordinates) = (Vec::new(), Vec::new());
        for sample in cells.as_flattened_mut() {
            let vertex = &mut vertex_of[*sample as usize];
            if *vertex == u32::MAX {
                *vertex = positions.len() as u32;
                let (column, row) = (*sample % columns, *sample / columns);
                positions.push(at(column, row).unwrap_or_default());
                let part = |i: u32, count: u32| f64::from(i) / f64::from(count - 1);
                coordinates.push([part(column, columns), part(row, rows)]);
            }
            *sample = *vertex;
        }
        let mut mesh = TriMesh::try_new(positions, cells)?;
        mesh.insert_attribute(Domain::Vertex, Column::texcoords(TEXCOORD, &coordinates)).map_err(MeshError::from)?;
        let mesh = if source.placement().reverses_orientation() { mesh.reversed() } else { mesh };

        let stretch = source.placement().vector(DVec3::Z).length();
        let deviation = if twist == 0.0 { Deviation::Exact } else { Deviation::AtMost(twist / 4.0 * stretch) };
        let mut report =
            Report::new(Self::NAME, deviation, "a quarter of each cell's twist, against the bilinear surface");
        report.figure("vertices", mesh.positions().len() as f64);
        report.figure("triangles", mesh.triangles().len() as f64);
        tell_strays(source, &mut report, exec)?;
        Ok(Converted::new(mesh, report))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Affine;
    use shapeloom_core::glam::DVec2;

    #[test]
    fn a_saddle_deviates_by_a_quarter_of_its_twist() {
        let field = HeightField::try_new(2, 2, DVec2::ONE, vec![0.0, 1.0, 1.0, 0.0]).unwrap();
        for diagonal in [Diagonal::First, Diagonal::Second] {
            let converted = TriangulateHeightField { diagonal }.convert(&field).unwrap();
            assert_eq!(converted.report.deviation, Deviation::AtMost(0.5));
            // The bilinear surface has the height 1/2 in the middle, the diagonal 0 or 1.
            let [a, b, c] = converted.value.corners(0);
            let (p, q) = if diagonal == Diagonal::First { (a, c) } else { (b, c) };
            assert_eq!(((p + q) / 2.0 - DVec3::splat(0.5)).length(), 0.5);
        }
    }

    #[test]
    fn holes_are_left_out_and_planes_are_exact() {
        let mut heights: Vec<f64> = (0..16).map(|i| f64::from(i % 4) + 2.0 * f64::from(i / 4)).collect();
        heights[0] = f64::NAN;
        let field = HeightField::try_new(4, 4, DVec2::ONE, heights).unwrap();
        let converted = TriangulateHeightField::new().convert(&field).unwrap();
        assert_eq!(converted.report.deviation, Deviation::Exact);
        assert_eq!((converted.value.triangles().len(), converted.value.positions().len()), (16, 15));
        // 8 cells of slope (1, 2): area √6 each.
        assert!((converted.value.area() - 8.0 * 6f64.sqrt()).abs() < 1e-13);
    }

    #[test]
    fn mirrored_fields_still_look_up() {
        let field = HeightField::try_new(2, 2, DVec2::ONE, vec![0.0; 4]).unwrap();
        let mesh = TriangulateHeightField::new().convert(&field).unwrap().value;
        assert!(crate::face_normals(&mesh).iter().all(|normal| *normal == DVec3::Z));
        let mirrored = field.placed(Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
        let mesh = TriangulateHeightField::new().convert(&mirrored).unwrap().value;
        assert!(crate::face_normals(&mesh).iter().all(|normal| *normal == DVec3::Z));
    }
}
