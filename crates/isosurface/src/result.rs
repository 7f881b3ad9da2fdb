//! What dual surfaces become.

use shapeloom_core::{ConvertError, Converted, Deviation, Exec, Report};
use shapeloom_mesh::{Blend, Column, Domain, MeshError, NORMAL, TransformRule, TriMesh, Values};

use crate::dual::DualSurface;
use crate::{Border, IsoWords, Lattice, Level, Slabs};

/// The mesh of a dual surface, and the report.
pub(crate) fn finish<S: Slabs + ?Sized>(
    step: &'static str,
    source: &S,
    surface: DualSurface,
    (level, how): (Level, IsoWords),
    border: Border,
    exec: &Exec,
) -> Result<Converted<TriMesh>, ConvertError> {
    let DualSurface { positions, normals, triangles, not_finite, held: _ } = surface;
    let mut mesh = TriMesh::try_new(positions, triangles)?;
    if !normals.is_empty() {
        mesh.insert_attribute(Domain::Vertex, normal_column(normals)?).map_err(MeshError::from)?;
    }
    let (deviation, basis) = if not_finite > 0 {
        (Deviation::Unknown, "samples that are not finite leave holes in the interpolant")
    } else if border == Border::Open {
        (Deviation::Unknown, "with an open border the surface ends up to a cell before it")
    } else {
        let bound = cell_bound(source.lattice());
        (
            Deviation::AtMost(bound),
            "the diagonal of a cell, against the surface of the trilinear interpolant, cut off at the border: each cell with a \
             piece of it has a vertex, and each triangle lies between cells around one crossing",
        )
    };
    let mut report = Report::new(step, deviation, format!("{basis}; {how}"));
    report.figure("vertices", mesh.positions().len() as f64);
    report.figure("triangles", mesh.triangles().len() as f64);
    level.tell(source, &how, not_finite, mesh.triangles().len() as u64, &mut report, exec)?;
    Ok(Converted::new(mesh, report))
}

/// The diagonal of a cell, and the rounding of positions.
pub(crate) fn cell_bound(lattice: &Lattice) -> f64 {
    let bounds = lattice.bounds();
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    lattice.cell_diagonal() * (1.0 + 1e-12) + 16.0 * f64::EPSILON * farthest
}

/// Unit normals of vertices as a column, in place: three numbers are a vector.
pub(crate) fn normal_column(normals: Vec<[f64; 3]>) -> Result<Column, MeshError> {
    let column = Column::try_new(NORMAL, 3, Values::F64(normals.into_flattened()))?;
    Ok(column.with_blend(Blend::Direction).with_transform(TransformRule::Normal))
}
