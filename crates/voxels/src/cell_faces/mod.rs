//! The faces between full and empty cells.

mod corner;
mod merged;
mod separate;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Affine, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Severity, options,
};
use shapeloom_isosurface::{InsideChoice, IsoValue, Lattice, Level, Slabs};
use shapeloom_mesh::{MeshError, PolyMesh};

use crate::full_cells::FullCells;
use corner::{EDGES, around, crossed_edges};
use separate::Pairings;

options! {
    /// The faces between full and empty cells, as quadrilaterals that face outward.
    ///
    /// The cell of a sample is the parallelepiped around it that reaches half a step to each side; it is full where the
    /// sample is inside. The solid is the union of the full cells, the lattice is surrounded by empty ones, and the
    /// result is exactly the border of the solid.
    ///
    /// Where full cells touch along an edge or in a corner alone, that border is no manifold: four faces meet in such
    /// an edge. With `separate` vertices are doubled there, so that the result is a closed, oriented 2-manifold
    /// whatever the cells: two faces share each edge, and the faces at a vertex form one fan. The sheets still touch in
    /// space. At an edge, the faces of the same cell stay together; where both ends of the edge join the cells anyway,
    /// those of the same gap do. Without `separate` there is one vertex a place, and the report counts the edges of
    /// four faces.
    ///
    /// With `merge` coplanar faces become rectangles, as large as a greedy search makes them: first along one
    /// direction, then across. Rectangles meet in T-junctions, so edges do not match and the mesh is not closed as a
    /// graph, though it covers the same points. `separate` has no effect then.
    ///
    /// Cost: linear in cells and faces.
    pub struct CellFaces("cell-faces") {
        required {}
        optional {
            /// The value that parts inside and outside; auto for what the samples suggest.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of the value the inside is.
            inside: InsideChoice = InsideChoice::Auto,
            /// Whether coplanar faces become larger rectangles, whose edges then do not match.
            merge: bool = false,
            /// Whether cells that touch along an edge or in a corner alone get vertices of their own there.
            separate: bool = true,
        }
    }
}

impl<S: Slabs + ?Sized> FromTolerance<S> for CellFaces {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

/// The directions in which a face may look: axis and side.
const DIRECTIONS: [(usize, i64); 6] = [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)];

/// The corners of a face as offsets in the two directions after its axis, counter-clockwise seen from the side of the
/// axis.
const SQUARE: [(u32, u32); 4] = [(0, 0), (1, 0), (1, 1), (0, 1)];

/// Corner places of a lattice: between cells, one more than cells in each direction. Place `(i, j, k)` is the smallest
/// corner of cell `(i, j, k)`.
fn position(placement: &Affine, place: [u32; 3]) -> DVec3 {
    placement.point(DVec3::from(place.map(f64::from)) - DVec3::splat(0.5))
}

/// Cells between two polls.
const POLL: u32 = 1 << 12;

impl<S: Slabs + ?Sized> Convert<S> for CellFaces {
    type Output = PolyMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let lattice = *source.lattice();
        let _bits = exec.reserve(FullCells::bytes(lattice.samples()))?;
        let (level, words) = Level::settle(source, self.iso, self.inside, exec)?;
        let cells = FullCells::of(source, level, &exec.part(0.0, 0.2))?;
        let faces = count_faces(&cells, &lattice, exec)?;
        if faces * 4 >= u64::from(u32::MAX) {
            return Err(MeshError::TooMany { kind: "wedges", found: faces * 4 }.into());
        }
        // Four corners of four bytes and a start; a vertex a face in the middle, four at most.
        let _memory = exec.reserve_elements(faces, 4 * 4 + 4 + 4 * size_of::<DVec3>())?;
        let built = if self.merge {
            merged::build(&cells, &lattice, &exec.part(0.2, 1.0))?
        } else {
            build(&cells, &lattice, self.separate, faces, &exec.part(0.2, 1.0))?
        };
        let Built { mesh, touching, doubled } = built;
        let mesh = if lattice.placement().reverses_orientation() { mesh.reversed() } else { mesh };

        // A face lies between a sample inside and one outside, and the interpolant has its value between the two: no
        // coordinate of the two points differs by more than half a step. The other way: a cube between samples with
        // surface in it has corners on both sides, so its middle lies on a face.
        let (deviation, basis) = match cells.not_finite {
            0 => (
                Deviation::AtMost((lattice.cell_diagonal() * 0.5).next_up()),
                "half the diagonal of a cell, against the surface of the trilinear interpolant; of the union of full cells the border exactly",
            ),
            _ => (
                Deviation::Unknown,
                "samples that are not finite have no interpolant; of the union of full cells the border exactly",
            ),
        };
        let mut report = Report::new(Self::NAME, deviation, format!("{words}; {basis}"));
        level.tell(source, &words, cells.not_finite, mesh.face_count() as u64, &mut report, exec)?;
        report.figure("vertices", mesh.positions().len() as f64);
        report.figure("faces", mesh.face_count() as f64);
        report.figure("cell_faces", faces as f64);
        report.figure("touching_edges", touching as f64);
        report.figure("doubled_vertices", doubled as f64);
        if touching > 0 && !self.merge && !self.separate {
            let message = "edges along which cells touch have four faces: the mesh is not a manifold there";
            report.findings.push_many("W-cells-touch", Severity::Warning, Place::Whole, message, touching);
        }
        if self.merge && faces > mesh.face_count() as u64 {
            let message = "merged rectangles meet in T-junctions: their edges do not match";
            report.findings.push("W-cells-merged", Severity::Note, Place::Whole, message);
        }
        exec.progress(1.0);
        Ok(Converted::new(mesh, report))
    }
}

/// A mesh, the edges along which cells touch, and the vertices that share their place with another.
struct Built {
    mesh: PolyMesh,
    touching: u64,
    doubled: u64,
}

/// The neighbour of a cell.
fn beside(cell: [u32; 3], axis: usize, side: i64) -> [i64; 3] {
    let mut cell = cell.map(i64::from);
    cell[axis] += side;
    cell
}

/// Calls `visit` for every cell in the order of the lattice.
fn for_each_cell(
    [x, y, z]: [u32; 3],
    exec: &Exec,
    mut visit: impl FnMut([u32; 3]) -> Result<(), ConvertError>,
) -> Result<(), ConvertError> {
    let mut polled = 0u32;
    for k in 0..z {
        exec.progress(f64::from(k) / f64::from(z));
        for j in 0..y {
            for i in 0..x {
                if polled.is_multiple_of(POLL) {
                    exec.check()?;
                }
                polled = polled.wrapping_add(1);
                visit([i, j, k])?;
            }
        }
    }
    Ok(())
}

fn count_faces(cells: &FullCells, lattice: &Lattice, exec: &Exec) -> Result<u64, ConvertError> {
    let mut faces = 0u64;
    for_each_cell(lattice.dimensions(), &exec.part(0.0, 0.0), |cell| {
        if cells.is_full(cell.map(i64::from)) {
            let open = |&&(axis, side): &&(usize, i64)| !cells.is_full(beside(cell, axis, side));
            faces += DIRECTIONS.iter().filter(open).count() as u64;
        }
        Ok(())
    })?;
    Ok(faces)
}

/// Every face by itself.
fn build(cells: &FullCells, lattice: &Lattice, separate: bool, faces: u64, exec: &Exec) -> Result<Built, ConvertError> {
    let places = lattice.dimensions().map(|count| count + 1);
    let [px, py, _] = places.map(|count| count as usize);
    let _layers = exec.reserve_elements(2 * (px * py) as u64, size_of::<u32>())?;
    let pairings = Pairings::settle(cells, places, separate, &exec.part(0.0, 0.5))?;
    let exec = &exec.part(0.5, 1.0);

    // The first vertex of each place of the layers below and above a slab of cells.
    let mut firsts = [vec![0u32; px * py], vec![0u32; px * py]];
    let (mut positions, mut corners) = (Vec::new(), Vec::with_capacity(faces as usize * 4));
    let mut doubled = 0u64;
    let mut number_layer = |k: u32, layer: &mut [u32], positions: &mut Vec<DVec3>| -> Result<(), ConvertError> {
        for (j, row) in (0..places[1]).zip(layer.chunks_mut(px)) {
            exec.check()?;
            for (i, first) in (0..places[0]).zip(row) {
                *first = positions.len() as u32;
                let count = pairings.fans(cells, [i, j, k]).count;
                positions.extend((0..count).map(|_| position(lattice.placement(), [i, j, k])));
                doubled += u64::from(count).saturating_sub(1);
            }
        }
        Ok(())
    };
    number_layer(0, &mut firsts[1], &mut positions)?;
    let slab = [lattice.dimensions()[0], lattice.dimensions()[1], 1];
    for k in 0..lattice.dimensions()[2] {
        exec.progress(f64::from(k) / f64::from(lattice.dimensions()[2]));
        firsts.swap(0, 1);
        number_layer(k + 1, &mut firsts[1], &mut positions)?;
        for_each_cell(slab, &exec.part(0.0, 0.0), |[i, j, _]| {
            let cell = [i, j, k];
            if !cells.is_full(cell.map(i64::from)) {
                return Ok(());
            }
            for (axis, side) in DIRECTIONS {
                if cells.is_full(beside(cell, axis, side)) {
                    continue;
                }
                let mut face = SQUARE.map(|(u, v)| {
                    let mut place = cell;
                    place[axis] += u32::from(side > 0);
                    place[(axis + 1) % 3] += u;
                    place[(axis + 2) % 3] += v;
                    let first = firsts[(place[2] - k) as usize][place[1] as usize * px + place[0] as usize];
                    first + pairings.fans(cells, place).of_face(cell, axis, place)
                });
                if side < 0 {
                    face.reverse();
                }
                corners.extend(face);
            }
            Ok(())
        })?;
    }
    let starts = (0..=corners.len() as u32 / 4).map(|face| face * 4).collect();
    let mesh = PolyMesh::try_new(positions, starts, corners)?;
    Ok(Built { mesh, touching: pairings.touching, doubled })
}

/// How many edges there are along which two full cells touch, and no other cell is full.
fn touching_edges(cells: &FullCells, places: [u32; 3], exec: &Exec) -> Result<u64, ConvertError> {
    let mut count = 0;
    for_each_cell(places, exec, |place| {
        let mask = around(cells, place);
        // Of the six edges at a place three start there: each edge once.
        count += (0..EDGES).filter(|&edge| edge % 2 == 1 && crossed_edges(mask) >> edge & 1 == 1).count() as u64;
        Ok(())
    })?;
    Ok(count)
}

#[cfg(test)]
mod tests;
