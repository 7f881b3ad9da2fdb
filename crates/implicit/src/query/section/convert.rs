//! Adaptive marching squares as a conversion.

use shapeloom_core::glam::DVec2;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, Field, Frame, FromTolerance, Options, Place, Report,
    Severity, VectorWords, options,
};
use shapeloom_mesh::Polyline;

use super::cells::{Cells, Fineness};
use super::chains::chains;
use super::error::SectionError;
use super::plane::{DEEPEST, Lattice, PlaneWindow};

options! {
    /// The curves where a field is zero in a plane, as polylines with the inside on their left.
    ///
    /// A quadtree whose cells are dropped where the field's bounds show one side, and halved until each holds one piece of the curve that is near
    /// its chord (marching squares on a quadtree; Lorensen and Cline, 1987, in the plane; Snyder, 1992, for the pruning). Crossings
    /// with edges are the field's zeros to a few units in the last place. Cells with several pieces are halved too, down to the
    /// tolerance; there the side of the middle decides.
    pub struct AdaptiveMarchingSquares("adaptive-marching-squares") {
        required {
            /// How far the curve may lie from its chords, in model units.
            chord_tolerance: f64 [Bounds::POSITIVE],
        }
        optional {
            /// The largest cell that the curve may pass, in model units; 0 is a sixty-fourth of the window's longer side. What is smaller may
            /// be missed where the field's bounds do not show it.
            cell_size: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How often cells that may hold a piece of the curve, but show none, are halved beyond the cell size in search of it.
            search_depth: u32 [Bounds::closed(0.0, 20.0)] = 4,
            /// Whether cells are halved until the deviation is proven, rather than estimated at three places of each chord.
            proven: bool = false,
            /// How many cells are looked at before it is an error.
            max_cells: u32 [Bounds::closed(1.0, 4e9)] = 1 << 22,
        }
    }
}

/// Curves in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneCurves {
    /// The plane: its first two axes.
    pub frame: Frame,
    /// The curves in the frame's coordinates, z being 0, with the inside on their left seen from where the third axis points. Those that
    /// leave the window are open.
    pub curves: Vec<Polyline>,
}

impl PlaneCurves {
    /// The curves in space.
    pub fn in_space(&self) -> Vec<Polyline> {
        let map = self.frame.to_world();
        self.curves.iter().map(|curve| curve.transformed(&map)).collect()
    }

    /// The area within closed curves: what is inside counts, holes do not.
    pub fn closed_area(&self) -> f64 {
        let of =
            |curve: &Polyline| curve.segments().map(|[a, b]| a.truncate().perp_dot(b.truncate())).sum::<f64>() * 0.5;
        self.curves.iter().filter(|curve| curve.is_closed()).map(of).sum()
    }
}

impl<F: Field + ?Sized> Convert<PlaneWindow<'_, F>> for AdaptiveMarchingSquares {
    type Output = PlaneCurves;

    fn convert_with(&self, source: &PlaneWindow<'_, F>, exec: &Exec) -> Result<Converted<PlaneCurves>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let lattice = Lattice::new(source.lo, source.hi, 0);
        let cell_size = if self.cell_size == 0.0 { source.longer() / 64.0 } else { self.cell_size };
        // A cell is about square: its side is its diagonal over the root of 2.
        let base = halvings(&lattice, "cell_size", cell_size * std::f64::consts::SQRT_2)?;
        let finest = halvings(&lattice, "chord_tolerance", self.chord_tolerance)?;
        let depth = finest.max(base);
        let lattice = Lattice::new(source.lo, source.hi, depth);
        let fineness = Fineness {
            base,
            search: (base + self.search_depth).min(depth),
            tolerance: self.chord_tolerance,
            proven: self.proven,
            max_cells: self.max_cells,
        };
        let mut cells = Cells::new(source, lattice, fineness, exec)?;
        let found = chains(&mut cells);
        let bound = found.diagonal * (1.0 + 1e-12);
        let (deviation, basis) = if found.uncertain == 0 && bound <= self.chord_tolerance {
            let basis = "every cell that is not proven free holds a piece of the curve and of the polyline, so that they are at \
                         most its diagonal apart";
            (Deviation::AtMost(bound), basis)
        } else {
            (
                Deviation::Estimated(self.chord_tolerance),
                "the sides of the field at three places of each chord, a tolerance to its left and right",
            )
        };
        let mut report = Report::new(Self::NAME, deviation, basis);
        if let Some(at) = found.first_uncertain {
            report.findings.push_many(
                "W-section-uncertain",
                Severity::Warning,
                Place::Whole,
                format!(
                    "cells may hold parts of the curve that were not found: bounds do not show one side, and the corners show no \
                     change; the first at {}",
                    VectorWords(at.extend(0.0))
                ),
                found.uncertain,
            );
        }
        if found.undefined > 0 {
            report.findings.push_many(
                "W-section-undefined",
                Severity::Warning,
                Place::Whole,
                "the field is not a number on one side of the curve; that side counts as outside, and the curve follows its border",
                found.undefined,
            );
        }
        report.figure("curves", found.curves.len() as f64);
        report.figure("points", found.curves.iter().map(|curve| curve.points().len()).sum::<usize>() as f64);
        report.figure("cells", cells.asked as f64);
        report.figure("uncertain_cells", found.uncertain as f64);
        report.figure("ambiguous_cells", found.ambiguous as f64);
        report.figure("largest_cell_diagonal", found.diagonal);
        exec.progress(1.0);
        Ok(Converted::new(PlaneCurves { frame: source.frame, curves: found.curves }, report))
    }
}

/// How often root cells are halved until their diagonal is no longer than that.
fn halvings(lattice: &Lattice, option: &'static str, diagonal: f64) -> Result<u32, SectionError> {
    let fits = |level: &u32| lattice.diagonal(*level) <= diagonal;
    let least = lattice.diagonal(DEEPEST);
    (0..=DEEPEST).find(fits).ok_or(SectionError::Fine { option, found: diagonal, least })
}

impl<F: Field + ?Sized> FromTolerance<PlaneWindow<'_, F>> for AdaptiveMarchingSquares {
    fn from_tolerance(_: &PlaneWindow<'_, F>, tolerance: f64) -> Self {
        Self::new(tolerance)
    }
}

/// The section of a solid with a plane: [`AdaptiveMarchingSquares`] on the window between two corners of the plane that the frame's first
/// two axes span.
///
/// # Errors
/// A window or tolerance that cannot be used, too many cells, budgets passed, cancelled.
pub fn section<F: Field + ?Sized>(
    field: &F,
    frame: Frame,
    [lo, hi]: [DVec2; 2],
    chord_tolerance: f64,
    exec: &Exec,
) -> Result<Converted<PlaneCurves>, ConvertError> {
    AdaptiveMarchingSquares::new(chord_tolerance).convert_with(&PlaneWindow::new(field, frame, lo, hi)?, exec)
}
