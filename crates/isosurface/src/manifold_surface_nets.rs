//! Surface nets that are always manifold.

use shapeloom_core::{Convert, ConvertError, Converted, Exec, FromTolerance, Options, options};
use shapeloom_mesh::TriMesh;

use crate::dual::{MeanOfCrossings, extract};
use crate::result::finish;
use crate::{Border, InsideChoice, IsoValue, Level, Slabs};

options! {
    /// Surface nets of samples, always manifold: a vertex for each piece of the surface in a cell, the mean of where the piece crosses
    /// the cell's edges (Gibson 1998, Nielson 2004).
    ///
    /// Each edge of the lattice with an end inside and one outside gives a quad between the four cells around it, cut along its
    /// shorter diagonal. Inside samples that are only diagonal across a face of a cell are parted. With a closed border every edge has
    /// two triangles and every vertex one fan of them, whatever the samples; triangles may cross each other where the surface
    /// is folded below the size of a cell. With an open one quads are made only where all four cells exist, and vertices at the border may
    /// have two fans.
    ///
    /// Cost: linear in the samples, a few bits of memory each beyond input and output.
    pub struct ManifoldSurfaceNets("manifold-surface-nets") {
        required {}
        optional {
            /// The value that the surface is drawn at; `auto` is 0 for distances, a half for occupancy, else Otsu's threshold.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of it the inside is; `auto` is below for distances, above for densities.
            inside: InsideChoice = InsideChoice::Auto,
            /// Whether the surface is closed where the inside reaches the border of the lattice.
            border: Border = Border::Closed,
            /// Whether vertices get normals, from the gradient of the trilinear interpolant.
            normals: bool = false,
        }
    }
}

impl<S: Slabs + ?Sized> FromTolerance<S> for ManifoldSurfaceNets {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl<S: Slabs + ?Sized> Convert<S> for ManifoldSurfaceNets {
    type Output = TriMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (level, how) = Level::settle(source, self.iso, self.inside, exec)?;
        let surface = extract(source, &MeanOfCrossings, level, self.border, self.normals, exec)?;
        finish(Self::NAME, source, surface, (level, how), self.border, exec)
    }
}
