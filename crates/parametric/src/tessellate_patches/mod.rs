//! Bézier patches to triangles.

mod edges;
mod emit;
mod layout;
mod plan;

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Severity,
    options, parallel,
};
use shapeloom_mesh::TriMesh;

use crate::tessellate_curve::{chord_share, rounding};
use crate::{BezierSurface, TessellationError};
use edges::EdgeTable;
use plan::{Demand, MAX_ROUNDS, PatchPlan, examine, layout_for};

options! {
    /// Tessellates Bézier patches with a proven chord error; neighbours meet without cracks.
    ///
    /// Edge first: each boundary curve is sampled once, in at least as many equal steps as its own second differences
    /// ask for (Filip, Magedson and Markot 1986), and every patch that has it as a side uses the same vertices. Sides
    /// are shared when their control points are equal to the bit, in either direction. Inside, each patch has a uniform
    /// grid from its own bound, and strips of triangles join the grid to sides that are sampled otherwise. Every
    /// triangle is then bounded by the second differences of just its part of the control net; where that is not within
    /// the tolerance the side, for all its patches, or the grid is made finer.
    ///
    /// The certificate of a patch, in the report, is the largest of these bounds and the rounding of evaluation: surface
    /// and mesh are that close at equal parameters, so in both directions. The bound counts acceleration along the
    /// surface, which does no harm, as much as curvature, so the measured error may be several times smaller.
    ///
    /// Sides that collapse to a point become one vertex without triangles of zero area; closed seams close. Wedges
    /// carry the patch's normal (its limit at poles) and its (u, v) as texture coordinates, faces the label "patch". Not
    /// guaranteed: that different parts of the surface do not cross after tessellation if they nearly touched before.
    /// Cost: linear in the number of triangles, which grows as one over the tolerance.
    pub struct TessellatePatches("tessellate-patches") {
        required {
            /// The largest distance between the surface and its triangles, in model units.
            chord_tolerance: f64 [Bounds::POSITIVE],
        }
        optional {
            /// Whether wedges get the surface's normals.
            normals: bool = true,
            /// Whether wedges get the parameters (u, v) as texture coordinates.
            texcoords: bool = true,
            /// The most segments along a side of a patch.
            max_segments: u32 [Bounds::closed(1.0, 1048576.0)] = 65_536,
        }
    }
}

impl FromTolerance<BezierSurface> for TessellatePatches {
    fn from_tolerance(_: &BezierSurface, tolerance: f64) -> Self {
        Self::new(tolerance)
    }
}

impl Convert<BezierSurface> for TessellatePatches {
    type Output = TriMesh;

    fn convert_with(&self, source: &BezierSurface, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let roundings: Vec<f64> = source
            .patches
            .iter()
            .map(|patch| rounding(patch.control_points(), patch.degree_u() + patch.degree_v()))
            .collect();
        let rounding = roundings.iter().copied().fold(0.0, f64::max);
        let share = chord_share(self.chord_tolerance, rounding)?;
        exec.check()?;
        let _plan_memory = exec.reserve_elements(source.control_point_count() as u64, 4 * 3 * 8)?;

        let mut table = EdgeTable::new(source);
        table.sample(share, self.max_segments)?;
        let own: Vec<u32> = table.edges.iter().map(|edge| edge.segments).collect();
        let demands = self.refine(source, &mut table, share, &exec.part(0.0, 0.5))?;

        let emitted = emit::emit(self, source, &table, &demands, &exec.part(0.5, 1.0))?;
        let certificates: Vec<f64> =
            demands.iter().zip(&roundings).map(|(demand, rounding)| demand.certificate + rounding).collect();
        let worst = certificates.iter().copied().fold(0.0, f64::max);
        let deviation = if source.patches.is_empty() { Deviation::Exact } else { Deviation::AtMost(worst) };
        let mut report = Report::new(
            Self::NAME,
            deviation,
            "second differences of the control nets (Filip, Magedson and Markot 1986)",
        );
        report.figure("patches", source.patches.len() as f64);
        report.figure("edges", table.edges.len() as f64);
        report.figure("edges_shared", table.edges.iter().filter(|edge| edge.uses > 1).count() as f64);
        report.figure("poles", table.edges.iter().filter(|edge| edge.collapsed).count() as f64);
        let refined = table.edges.iter().zip(&own).filter(|(edge, own)| edge.segments > **own).count();
        report.figure("edges_refined", refined as f64);
        report.figure("vertices", emitted.mesh.positions().len() as f64);
        report.figure("triangles", emitted.mesh.triangles().len() as f64);
        for &patch in &emitted.degenerate {
            let place = Place::element("patch", u64::from(patch));
            let message = "triangles of zero area where the patch itself has none";
            report.findings.push("W-patch-degenerate", Severity::Warning, place, message);
        }
        for &patch in &emitted.vanished {
            let place = Place::element("patch", u64::from(patch));
            let message = "a part that is a point or a line left no triangle; the error is not known there";
            report.findings.push("W-patch-vanished", Severity::Warning, place, message);
            report.deviation = Deviation::Unknown;
        }
        report.certificates = certificates;
        Ok(Converted::new(emitted.mesh, report))
    }
}

impl TessellatePatches {
    /// Makes sides and grids finer until every patch is within `share`.
    fn refine(
        &self,
        source: &BezierSurface,
        table: &mut EdgeTable,
        share: f64,
        exec: &Exec,
    ) -> Result<Vec<Demand>, ConvertError> {
        let count = source.patches.len();
        let allowed = self.max_segments;
        let too_many = |patch: usize, found: f64| {
            let index = patch;
            ConvertError::from(TessellationError::TooManySegments { kind: "patch", index, found, allowed })
        };
        let mut plans: Vec<PatchPlan> = parallel::map_chunks(exec, count, 1, |part| {
            PatchPlan::new(source, part.start, share, allowed).map_err(ConvertError::from)
        })?;
        for round in 0..MAX_ROUNDS {
            let layouts: Vec<_> = (0..count).map(|patch| layout_for(table, patch, plans[patch].grid)).collect();
            if let Some(patch) = layouts.iter().position(|layout| layout.columns.max(layout.rows) > allowed) {
                let found = layouts[patch].columns.max(layouts[patch].rows);
                return Err(too_many(patch, f64::from(found)));
            }
            emit::check_size(table, &layouts, exec)?;
            let stale: Vec<usize> = (0..count)
                .filter(|&patch| plans[patch].demand.as_ref().is_none_or(|demand| demand.layout != layouts[patch]))
                .collect();
            if stale.is_empty() {
                break;
            }
            let found: Vec<Demand> = parallel::map_chunks(exec, stale.len(), 1, |part| {
                let patch = stale[part.start];
                let demand = examine(&plans[patch].nets, layouts[patch], share, exec)?;
                exec.progress(
                    f64::from(round) / f64::from(round + 1) + part.start as f64 / (stale.len() as f64 + 1.0) / 2.0,
                );
                Ok::<_, ConvertError>(demand)
            })?;
            for (&patch, demand) in stale.iter().zip(found) {
                if demand.finer {
                    plans[patch].grid = [demand.layout.columns, demand.layout.rows]
                        .map(|cells| cells.saturating_add(cells.div_ceil(4)));
                }
                for (side, &wanted) in table.sides[patch].iter().zip(&demand.sides) {
                    let edge = &mut table.edges[side.edge as usize];
                    if !edge.collapsed {
                        edge.segments = edge.segments.max(wanted);
                    }
                }
                plans[patch].demand = Some(demand);
            }
        }
        let unmet = |plan: &PatchPlan| plan.demand.as_ref().is_none_or(|demand| demand.certificate > share);
        if let Some(patch) = plans.iter().position(unmet) {
            return Err(too_many(patch, f64::from(allowed) + 1.0));
        }
        Ok(plans.into_iter().filter_map(|plan| plan.demand).collect())
    }
}

#[cfg(test)]
mod tests;
