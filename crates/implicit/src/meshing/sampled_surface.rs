//! Fields to triangles by samples on a lattice.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Aabb, Bounds, Convert, ConvertError, Converted, Deviation, Exec, Field, FromTolerance, Options, Place, Report,
    Severity, choice, options,
};
use shapeloom_isosurface::{
    Border, DualContouring, Lattice, LatticeError, ManifoldSurfaceNets, MarchingCubes, MarchingTetrahedra, Slabs,
};
use shapeloom_mesh::TriMesh;

use super::refine::{Path, refine};
use super::{MeshingError, PrunedField, Region, find_bounds, measured, normals};

choice! {
    /// How triangles are drawn among samples.
    pub enum SurfaceMethod {
        /// Surface nets, always manifold: see [`ManifoldSurfaceNets`].
        SurfaceNets = "surface-nets",
        /// See [`MarchingCubes`].
        MarchingCubes = "marching-cubes",
        /// See [`MarchingTetrahedra`].
        MarchingTetrahedra = "marching-tetrahedra",
        /// Sharp edges and corners: see [`DualContouring`].
        DualContouring = "dual-contouring",
    }
}

options! {
    /// Draws the zero of a field by samples on a lattice along the axes, asked only where bounds do not settle the sign
    /// (interval arithmetic, Duff 1992; programs simplified by parts of space, Keeter 2020).
    ///
    /// With a closed border the mesh is closed and oriented, with every method 2-manifold but for marching tetrahedra and dual contouring,
    /// which inherit what isosurface says of them; triangles may cross each other where the surface is folded below the
    /// size of a cell. Parts smaller than a cell may be missed: nothing between samples of one sign is drawn.
    ///
    /// Refined vertices lie on the zero to rounding where the field is smooth: those of marching methods move along their edge, those
    /// of surface nets along the gradient within their cell; dual contouring refines its crossings itself. The
    /// deviation is measured to first order, |f| / |∇f|, at all vertices and middles of triangles: an estimate.
    ///
    /// Cost: about 12 (size / cell)² blocks' samples of 512 for a surface, a restriction for each box around it, and
    /// memory for those and half a byte for each 64 samples of the box.
    pub struct SampledSurface("sampled-surface") {
        required {
            /// The distance of samples, in model units. Cells are made a little smaller to fit the region.
            cell_size: f64 [Bounds::POSITIVE],
        }
        optional {
            /// How triangles are drawn.
            method: SurfaceMethod = SurfaceMethod::SurfaceNets,
            /// Where to look: six numbers, the least corner first, and the shape is cut off there; or `auto`, the box that the field
            /// names, else one found by intervals.
            region: Region = Region::Auto,
            /// Whether vertices are moved to the zero of the field.
            refine: bool = true,
            /// Whether vertices get normals, from the field's gradient.
            normals: bool = false,
            /// Whether the surface is closed where the shape is cut off.
            border: Border = Border::Closed,
            /// Whether samples are left out where bounds settle the sign.
            prune: bool = true,
        }
    }
}

/// The cell size for which a surface with radii of curvature of a 16th of its box's diagonal is off by the tolerance, with the
/// sagitta h² / 8r: from a 192nd to a 1024th of the diagonal.
impl<F: Field + ?Sized> FromTolerance<F> for SampledSurface {
    fn from_tolerance(source: &F, tolerance: f64) -> Self {
        let find = || find_bounds(source, &Exec::default()).map_or(Aabb::EMPTY, |found| found.bounds);
        let found = source.extent().unwrap_or_else(find);
        let diagonal = if found.is_empty() { 1.0 } else { found.diagonal() };
        let size = (tolerance * diagonal / 2.0).sqrt();
        Self::new(if size.is_nan() { size } else { size.clamp(diagonal / 1024.0, diagonal / 192.0) })
    }
}

impl<F: Field + ?Sized> Convert<F> for SampledSurface {
    type Output = TriMesh;

    fn convert_with(&self, source: &F, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let region = match (self.region, source.extent()) {
            (Region::Auto, Some(given)) => Region::Box(given),
            (region, _) => region,
        };
        let (region, searched) = match region {
            Region::Box(given) => {
                if !(given.min.is_finite() && given.size().is_finite() && given.min.cmplt(given.max).all()) {
                    return Err(MeshingError::Region { found: given }.into());
                }
                (given, None)
            }
            Region::Auto => {
                let found = find_bounds(source, exec)?;
                if found.bounds.is_empty() {
                    return Ok(Converted::new(TriMesh::default(), empty(found.is_proven())));
                }
                (found.bounds, Some(found))
            }
        };
        let lattice = self.lattice(&region, searched.is_none())?;
        let sampling = exec.part(0.0, 0.6);
        let (drawn, evaluations) = if self.prune {
            let samples = PrunedField::sample(source, lattice, &sampling)?;
            (self.draw(&samples, source, &exec.part(0.6, 0.8))?, samples.evaluations())
        } else {
            let samples = shapeloom_isosurface::FieldSlabs::new(source, lattice);
            (self.draw(&samples, source, &exec.part(0.0, 0.8))?, lattice.samples())
        };
        let Converted { value: mut mesh, report: of_method } = drawn;
        let path = match self.method {
            SurfaceMethod::SurfaceNets => Some(Path::Cell),
            SurfaceMethod::MarchingCubes | SurfaceMethod::MarchingTetrahedra => Some(Path::Edge),
            SurfaceMethod::DualContouring => None,
        };
        if let (Some(path), true) = (path, self.refine) {
            refine(mesh.positions_mut(), source, &lattice, path, &exec.part(0.8, 0.9))?;
        }
        let sampled = lattice.bounds();
        if self.normals {
            normals::attach(&mut mesh, source, &sampled, exec)?;
        }
        let (deviation, basis) = match measured::distance(&mesh, source, &sampled, &exec.part(0.9, 1.0))? {
            Some(distance) => (
                Deviation::Estimated(distance),
                "the largest |f| / |∇f| at vertices and middles of triangles; parts between samples of one sign do not count",
            ),
            None => (Deviation::Unknown, "the field has no gradient at some vertex or middle of a triangle"),
        };
        let mut report = Report::new(Self::NAME, deviation, basis);
        report.figures = of_method.figures;
        report.findings = of_method.findings;
        report.figure("samples", lattice.samples() as f64);
        report.figure("evaluations", evaluations as f64);
        report.figure("evaluations_saved", lattice.samples().saturating_sub(evaluations) as f64);
        if let Some(found) = searched.filter(|found| !found.is_proven()) {
            let message = format!(
                "the shape was searched for up to {:e} along each axis; what lies beyond is not drawn",
                found.searched.size().max_element() / 2.0
            );
            report.findings.push("W-implicit-searched", Severity::Note, Place::Whole, message);
        }
        Ok(Converted::new(mesh, report))
    }
}

impl SampledSurface {
    /// The lattice over a region: just over it where it is given, with a cell around it where it is found.
    fn lattice(&self, region: &Aabb, given: bool) -> Result<Lattice, ConvertError> {
        let cells = (region.size() / self.cell_size).ceil().max(DVec3::ONE);
        let dimensions = cells.to_array().map(|count| (count as u32).saturating_add(1));
        if dimensions.iter().any(|&count| count > u32::MAX - 2) {
            return Err(LatticeError::TooMany { dimensions }.into());
        }
        let spacing = region.size() / cells;
        if given {
            return Ok(Lattice::along_axes(dimensions, region.min, spacing)?);
        }
        // Where the box has no length along an axis, cells there are as large as they may be.
        let spacing = DVec3::select(spacing.cmpgt(DVec3::ZERO), spacing, DVec3::splat(self.cell_size));
        Ok(Lattice::along_axes(dimensions.map(|count| count + 2), region.min - spacing, spacing)?)
    }

    fn draw<S: Slabs + ?Sized, F: Field + ?Sized>(
        &self,
        samples: &S,
        field: &F,
        exec: &Exec,
    ) -> Result<Converted<TriMesh>, ConvertError> {
        let border = self.border;
        match self.method {
            SurfaceMethod::SurfaceNets => {
                ManifoldSurfaceNets { border, ..ManifoldSurfaceNets::new() }.convert_with(samples, exec)
            }
            SurfaceMethod::MarchingCubes => {
                MarchingCubes { border, ..MarchingCubes::new() }.convert_with(samples, exec)
            }
            SurfaceMethod::MarchingTetrahedra => {
                MarchingTetrahedra { border, ..MarchingTetrahedra::new() }.convert_with(samples, exec)
            }
            SurfaceMethod::DualContouring => {
                let contouring = DualContouring { border, ..DualContouring::new() };
                match self.refine {
                    true => contouring.sampled_field(samples, field, exec),
                    false => contouring.convert_with(samples, exec),
                }
            }
        }
    }
}

fn empty(proven: bool) -> Report {
    let (deviation, basis) = match proven {
        true => (Deviation::Exact, "the field is positive everywhere"),
        false => (Deviation::Unknown, "the field is positive everywhere where it was searched"),
    };
    let mut report = Report::new(SampledSurface::NAME, deviation, basis);
    report.findings.push("W-implicit-empty", Severity::Warning, Place::Whole, "no surface: the shape is empty");
    report
}
