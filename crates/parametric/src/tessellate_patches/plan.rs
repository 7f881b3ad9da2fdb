//! Choosing how finely each patch is cut.

use shapeloom_core::{Exec, Interval, Stop};

use super::edges::EdgeTable;
use super::layout::{Layout, Node};
use crate::curvature_net::{CurvatureNets, Scratch};
use crate::{BezierSurface, PatchSide, SecondDerivativeBounds, TessellationError};

/// What a patch needs: its grid, and how many segments each side must have at least.
pub(super) struct Demand {
    pub(super) layout: Layout,
    /// The largest bound over the pieces; at most the share if nothing more is demanded.
    pub(super) certificate: f64,
    /// Segments wanted of the bottom, top, left and right side.
    pub(super) sides: [u32; 4],
    /// Whether the grid must be finer.
    pub(super) finer: bool,
}

/// A grid with close to the fewest cells whose cells are all within `share` by the bound over the whole patch: none if one
/// direction alone needs more than `allowed` segments.
pub(super) fn grid_for(bounds: &SecondDerivativeBounds, share: f64, allowed: u32) -> Result<[u32; 2], f64> {
    // In units of what is allowed, so that products neither vanish nor overflow at any size of the surface.
    let [uu, uv, vv] = [bounds.uu, bounds.uv, bounds.vv].map(|bound| bound / share / 8.0);
    let (least_u, least_v) = (uu.sqrt(), vv.sqrt());
    // Rows that suffice for steps of 1/columns: the positive root of vv·h² + 2·uv·w·h + uu·w² = 1, inverted.
    let rows_for = |columns: f64| {
        let w = 1.0 / columns;
        let left = 1.0 - uu * w * w;
        if left <= 0.0 {
            return f64::INFINITY;
        }
        let mixed = uv * w;
        // The conjugate form does not cancel; a flat direction gives 0 and one row.
        ((mixed + (mixed * mixed + vv * left).sqrt()) / left).ceil().max(1.0)
    };
    // At the continuous optimum both directions share alike: uu·w² = vv·h². Where one is flat only the twist counts, and
    // a square grid is as good as any.
    let twist = (2.0 * uv).sqrt();
    let guess = if uu > 0.0 && vv > 0.0 { (2.0 * uu + 2.0 * uv * (uu / vv).sqrt()).sqrt() } else { least_u.max(twist) };
    let most = least_u.max(least_v).max(guess).max(1.0);
    if most.is_nan() || most > f64::from(allowed) {
        return Err(most);
    }
    let (low, high) = ((0.5 * guess).floor().max(1.0) as u32, (2.0 * guess).ceil() as u32 + 2);
    let mut best: Option<(f64, [f64; 2])> = None;
    for columns in std::iter::once(1).chain(low..=high.min(allowed)) {
        let columns = f64::from(columns);
        let rows = rows_for(columns);
        // Of grids with nearly as many cells the squarer one makes the better triangles: two per cent for each factor e.
        let cost = columns * rows * (1.0 + 0.02 * (columns / rows).ln().abs());
        if rows <= f64::from(allowed) && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, [columns, rows]));
        }
    }
    best.map(|(_, [columns, rows])| [columns as u32, rows as u32]).ok_or(most.max(f64::from(allowed) + 1.0))
}

/// About a millisecond of multiplications.
pub(super) const POLL_WORK: usize = 1 << 20;

/// Bounds every piece of a patch with the sides as they are sampled now.
pub(super) fn examine(nets: &CurvatureNets, layout: Layout, share: f64, exec: &Exec) -> Result<Demand, Stop> {
    let mut demand = Demand { layout, certificate: 0.0, sides: layout.sides, finer: false };
    let mut scratch = Scratch::default();
    let mut work = 0;
    layout.pieces(|piece| {
        // Polled by work and not by pieces: a piece of a patch of high degree takes milliseconds.
        work += nets.work();
        if work > POLL_WORK {
            exec.check()?;
            work = 0;
        }
        let corners = piece.nodes().iter().map(|&node| layout.parameters(node));
        let span = |axis: usize| {
            let along = corners.clone().map(|corner| corner[axis]);
            let (lo, hi) = along.fold((1.0f64, 0.0f64), |(lo, hi), t| (lo.min(t), hi.max(t)));
            Interval::new(lo, hi)
        };
        let (u, v) = (span(0), span(1));
        let error = nets.bounds(u, v, &mut scratch).chord_error(u.length(), v.length());
        demand.certificate = demand.certificate.max(error);
        if error > share {
            let side = piece.nodes().iter().find_map(|node| match node {
                Node::Side(side, _) if layout.segments(*side) < layout.cells_along(*side) => Some(*side),
                _ => None,
            });
            match side {
                Some(side) => {
                    let now = layout.segments(side);
                    let wanted = (2 * u64::from(now)).min(u64::from(layout.cells_along(side)));
                    demand.sides[side as usize] = demand.sides[side as usize].max(wanted as u32);
                }
                None => demand.finer = true,
            }
        }
        Ok(())
    })?;
    Ok(demand)
}

/// The layout of a patch for a grid, with its sides as they are sampled now. Poles follow the grid: every step of theirs
/// is the same vertex.
pub(super) fn layout_for(table: &EdgeTable, patch: usize, [columns, rows]: [u32; 2]) -> Layout {
    let uses = &table.sides[patch];
    // A patch that closes on itself needs three cells to enclose anything.
    let closed = |a: PatchSide, b: PatchSide| {
        let (a, b) = (uses[a as usize].edge, uses[b as usize].edge);
        if a == b && !table.edges[a as usize].collapsed { 3 } else { 1 }
    };
    // Between two poles a single row or column of cells has no triangle left.
    let poles = uses.iter().filter(|side| table.edges[side.edge as usize].collapsed).count();
    let least = if poles > 1 { 2 } else { 1 };
    let columns = columns.max(closed(PatchSide::Left, PatchSide::Right)).max(least);
    let rows = rows.max(closed(PatchSide::Bottom, PatchSide::Top)).max(least);
    let sides = |columns: u32, rows: u32| {
        PatchSide::ALL.map(|side| {
            let edge = &table.edges[uses[side as usize].edge as usize];
            let along = if matches!(side, PatchSide::Bottom | PatchSide::Top) { columns } else { rows };
            if edge.collapsed { along } else { edge.segments }
        })
    };
    let widened = Layout { columns, rows, sides: sides(columns, rows) }.widened();
    Layout { sides: sides(widened.columns, widened.rows), ..widened }
}

/// The largest number of rounds before every grid and side must have met its share: each round doubles a side or makes
/// a grid finer by a quarter.
pub(super) const MAX_ROUNDS: u32 = 256;

/// A patch with what does not change while its grid is chosen.
pub(super) struct PatchPlan {
    pub(super) nets: CurvatureNets,
    pub(super) grid: [u32; 2],
    pub(super) demand: Option<Demand>,
}

impl PatchPlan {
    /// # Errors
    /// The patch needs more than `allowed` segments along a side, or its second differences overflow.
    pub(super) fn new(
        surface: &BezierSurface,
        index: usize,
        share: f64,
        allowed: u32,
    ) -> Result<Self, TessellationError> {
        let nets = CurvatureNets::new(&surface.patches[index]);
        let bounds = nets.whole();
        if !(bounds.uu.is_finite() && bounds.uv.is_finite() && bounds.vv.is_finite()) {
            return Err(TessellationError::TooLarge { kind: "patch", index });
        }
        let too_many = |found| TessellationError::TooManySegments { kind: "patch", index, found, allowed };
        let grid = grid_for(&bounds, share, allowed).map_err(too_many)?;
        Ok(Self { nets, grid, demand: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_meet_the_bound_with_few_cells() {
        let cases =
            [(2.0, 1.0, 3.0), (8.0, 0.0, 0.0), (0.0, 5.0, 0.0), (1e-3, 2.0, 9.0), (0.0, 0.0, 0.0), (40.0, 3.0, 0.1)];
        for (uu, uv, vv) in cases {
            let bounds = SecondDerivativeBounds { uu, uv, vv };
            let share = 1e-3;
            let [columns, rows] = grid_for(&bounds, share, 10_000).unwrap();
            let fits =
                |c: u32, r: u32| bounds.chord_error(1.0 / f64::from(c), 1.0 / f64::from(r)) <= share * (1.0 + 1e-12);
            assert!(fits(columns, rows), "{bounds:?} {columns} {rows}");
            let best = (1..400u32).flat_map(|c| (1..400u32).find(|&r| fits(c, r)).map(|r| c * r)).min().unwrap();
            assert!(f64::from(columns * rows) <= 1.15 * f64::from(best), "{bounds:?} {columns} {rows} {best}");
        }
    }

    #[test]
    fn impossible_grids_say_how_many_segments_they_need() {
        let bounds = SecondDerivativeBounds { uu: 1.0, uv: 0.0, vv: 0.0 };
        assert!(grid_for(&bounds, 1e-12, 1000).unwrap_err() > 1000.0);
        assert!(grid_for(&SecondDerivativeBounds { uu: f64::INFINITY, uv: 0.0, vv: 0.0 }, 1.0, 1000).is_err());
        assert!(grid_for(&SecondDerivativeBounds { uu: 0.0, uv: 1e9, vv: 0.0 }, 1e-6, 10).is_err());
    }
}
