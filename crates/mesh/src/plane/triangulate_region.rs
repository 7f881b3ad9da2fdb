//! Regions with holes to triangles.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Severity, choice, options,
};

use super::ANGLES;
use super::planar_region::PlanarRegion;
use super::projection::{Projection, ProjectionPlane};
use super::scale::Scale;
use super::sheet::{Kept, Refine, Sheet};
use super::with_earcut::with_earcut;
use crate::{MeshError, Polyline, TriMesh, newell_vector};

choice! {
    /// What is done where edges or loops cross.
    pub enum Crossings {
        /// They are split at a new vertex.
        Split = "split",
        /// It is an error that names the first two.
        Refuse = "refuse",
    }
}

choice! {
    /// How a region is cut into triangles.
    pub enum RegionMethod {
        /// By a constrained Delaunay triangulation: takes any loops, and gives the least sharp triangles.
        Delaunay = "delaunay",
        /// By clipping ears with holes bridged, as in earcut: about twice as fast for up to a thousand points, for loops that neither
        /// cross nor touch. Its result is checked. Where it will not do, or for more than 4096 points, the other way is
        /// taken, and told.
        Earcut = "earcut",
    }
}

options! {
    /// Triangulates the region inside closed loops, with holes and islands by the even-odd rule.
    ///
    /// The points are projected along the largest component of the normal of the largest loop, and the triangles face the
    /// side from which that loop runs counter-clockwise; none is turned over or without area, by exact signs. Where loops
    /// cross they are split, or the crossing is an error that names both sides. Loops that touch, points that repeat, parts
    /// that overlap and corners on straight sides are no trouble. A region whose points do not lie on one plane has no
    /// surface of its own: the report then estimates the deviation by the largest distance from the mean plane. With an
    /// angle or area wanted, vertices are added (Ruppert 1995). Cost: n log n for loops that do not cross.
    pub struct TriangulateRegion("triangulate-region") {
        required {}
        optional {
            /// How the region is cut.
            method: RegionMethod = RegionMethod::Delaunay,
            /// What is done where loops cross.
            crossings: Crossings = Crossings::Split,
            /// The smallest angle wanted, in degrees, reached by adding vertices; 0 adds none. Up to about 30 is reached,
            /// except between sides that meet in less. Takes the method `delaunay`.
            angle: f64 [ANGLES] = 0.0,
            /// The largest area wanted of a triangle in the plane of the projection, in square model units; 0 for any.
            /// Takes the method `delaunay`.
            max_area: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many vertices may be added.
            max_added: u32 = 100_000,
            /// Whether added vertices may split the sides of loops. Otherwise angles beside them may stay smaller.
            split_edges: bool = true,
        }
    }
}

impl FromTolerance<Polyline> for TriangulateRegion {
    fn from_tolerance(_: &Polyline, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<Polyline> for TriangulateRegion {
    type Output = TriMesh;

    fn convert_with(&self, source: &Polyline, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        crate::poly_mesh::check_count("points", source.points().len())?;
        let _memory = exec.reserve(source.memory_bytes() as u64)?;
        let mut converted = self.convert_with(&PlanarRegion::from(source), exec)?;
        converted.report.deviation = Deviation::Unknown;
        converted.report.basis = "the line is the border of what was made of it".to_owned();
        if !source.is_closed() && source.points().len() > 2 && source.points().first() != source.points().last() {
            let message = "the line is open: a straight side was taken to close it";
            converted.report.findings.push("W-plane-open", Severity::Warning, Place::Whole, message);
        }
        Ok(converted)
    }
}

impl Convert<PlanarRegion> for TriangulateRegion {
    type Output = TriMesh;

    fn convert_with(&self, source: &PlanarRegion, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        if let Some(index) = source.points().iter().position(|point| !point.is_finite()) {
            return Err(MeshError::NotFinite { kind: "point", index: index as u64 }.into());
        }
        let _memory = exec.reserve_elements(source.points().len() as u64, size_of::<[u32; 2]>())?;
        let (normal, off_plane) = plane(source);
        let deviation = match off_plane {
            0.0 => (Deviation::Exact, "flat regions are cut within their loops"),
            off => (Deviation::Estimated(off), "the largest distance of a point from the mean plane"),
        };
        let sides = source.sides();
        let projection = Projection::along(normal);
        let sheet = Sheet {
            name: Self::NAME,
            words: ["point", "side"],
            positions: source.points(),
            attributes: source.attributes(),
            edges: &sides,
            projection,
            kept: Kept::EvenOdd,
            refuse_crossings: self.crossings == Crossings::Refuse,
            refine: Refine {
                angle: self.angle,
                area: self.max_area,
                most: self.max_added,
                split_edges: self.split_edges,
            },
            deviation,
        };
        let wants_ears = self.method == RegionMethod::Earcut && self.angle == 0.0 && self.max_area == 0.0;
        let quick = if wants_ears { with_earcut(source, &sheet, exec)? } else { None };
        let refused = wants_ears && quick.is_none();
        let mut converted = match quick {
            Some(converted) => converted,
            None => sheet.triangulate(exec)?,
        };
        if refused {
            let message = "earcut is not for these loops: they were triangulated by constrained Delaunay";
            converted.report.findings.push("W-plane-earcut", Severity::Note, Place::Whole, message);
        }
        converted.report.figure("loops", source.loops().count() as f64);
        converted.report.figure("planarity", off_plane);
        Ok(converted)
    }
}

/// The normal of the largest loop, and how far the points are from the plane through their mean; 0 when that is within the
/// rounding of their coordinates.
fn plane(region: &PlanarRegion) -> (DVec3, f64) {
    let size = region.points().iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let scale = Scale::to_one(size);
    let vectors = region.loops().map(|points| newell_vector(points.iter().map(|&point| scale.apply_to_space(point))));
    let largest = vectors.fold(DVec3::ZERO, |best, vector| match vector.length_squared() > best.length_squared() {
        true => vector,
        false => best,
    });
    let normal = match largest.try_normalize() {
        Some(normal) => normal,
        // As for an eight whose halves are equal.
        None => Projection::new(ProjectionPlane::Fit, region.points()).normal(),
    };
    let count = region.points().len().max(1) as f64;
    let mean = region.points().iter().map(|&point| scale.apply_to_space(point)).sum::<DVec3>() / count;
    let off = |point: &DVec3| (scale.apply_to_space(*point) - mean).dot(normal).abs();
    let off = region.points().iter().map(off).fold(0.0, f64::max);
    (normal, if off <= 32.0 * f64::EPSILON { 0.0 } else { scale.length(off) })
}
