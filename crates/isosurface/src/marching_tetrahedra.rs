//! Marching tetrahedra.

use shapeloom_core::{Convert, ConvertError, Converted, Exec, FromTolerance, Options, options};
use shapeloom_mesh::TriMesh;

use crate::lattice_bits::LatticeBits;
use crate::marching::{Marching, count_all};
use crate::marching_report::{finish, told};
use crate::pattern::{cube_pattern, tetrahedra_pattern};
use crate::{Border, InsideChoice, IsoValue, Level, Slabs};

options! {
    /// Draws the surface where samples on a lattice reach a value, through six tetrahedra in each cell (Doi and Koide 1991).
    ///
    /// The tetrahedra lie around the cell's diagonal from the first corner to the last, the same in every cell, so that
    /// neighbours cut their common face alike. In a tetrahedron the samples have one linear interpolant, which leaves
    /// nothing open: with a closed border the result is a closed, oriented 2-manifold for any samples, and it is the exact
    /// surface of the piecewise linear interpolant. It has about three times as many triangles as marching cubes, and the
    /// direction of the diagonal shows in it. The report says how many triangles marching cubes has (with its table).
    ///
    /// The deviation is that from the surface of the trilinear interpolant, of the solid cut off at the border where that is
    /// closed: at most the diagonal of a cell, as a cell has triangles exactly where it has some of that surface.
    ///
    /// Not guaranteed: triangles of positive area, as samples that equal the iso value draw several vertices to one place.
    ///
    /// Cost: each slab is read twice; about a third of a byte a sample beside the result where rows are long.
    pub struct MarchingTetrahedra("marching-tetrahedra") {
        required {}
        optional {
            /// The value that the surface is drawn at; by itself what the samples suggest.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of the value the inside is.
            inside: InsideChoice = InsideChoice::Auto,
            /// What the surface does at the border of the lattice.
            border: Border = Border::Closed,
            /// Whether vertices get normals, from differences of samples.
            normals: bool = false,
        }
    }
}

impl<S: Slabs + ?Sized> FromTolerance<S> for MarchingTetrahedra {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl<S: Slabs + ?Sized> Convert<S> for MarchingTetrahedra {
    type Output = TriMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (level, how) = Level::settle(source, self.iso, self.inside, exec)?;
        let bits = LatticeBits::new(source.lattice(), self.border, exec)?;
        let mirrored = source.lattice().placement().reverses_orientation();
        let pattern = tetrahedra_pattern(mirrored);
        let normals = self.normals;
        let mut marching = Marching { slabs: source, level, bits, pattern, topology: None, mirrored, normals };
        let surface = marching.run(exec)?;
        let mut report = told(Self::NAME, source, level, &how, &marching.bits, &surface, exec)?;
        let cubes = count_all(&marching.bits, cube_pattern(false), exec)?;
        report.figure("triangles_of_marching_cubes", cubes as f64);
        if cubes > 0 {
            report.figure("times_marching_cubes", surface.triangles.len() as f64 / cubes as f64);
        }
        Ok(Converted::new(finish(surface)?, report))
    }
}
