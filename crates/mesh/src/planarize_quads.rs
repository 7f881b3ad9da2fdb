//! Quadrilaterals made flat.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Severity, options,
};

use crate::normals::length;
use crate::{MeshError, PolyMesh, QuadPlanarity, newell_vector};

options! {
    /// Moves the vertices of a polygon mesh a little, so that its quadrilaterals become flat.
    ///
    /// Each quadrilateral asks that its diagonals meet. All these equations are solved together by Newton steps of least
    /// norm, as in guided projection (Tang, Sun, Gomes, Wallner and Pottmann 2014): the nearest place, to first order,
    /// where all are flat. Connectivity, triangles and attributes stay; polygons of more corners are left as they are. Not
    /// every mesh has flat quadrilaterals near it: where the planarity asked for is not reached, a finding says which faces
    /// miss it. Cost: a step takes a solve by conjugate gradients, linear in the number of faces for each of its
    /// iterations.
    pub struct PlanarizeQuads("planarize-quads") {
        required {
            /// How far a corner may be from the mean plane of its quadrilateral, in model units.
            planarity: f64 [Bounds::POSITIVE],
        }
        optional {
            /// Whether the vertices on the border stay where they are.
            hold_border: bool = false,
            /// How many Newton steps at most.
            max_steps: u32 [Bounds::closed(1.0, 1000.0)] = 30,
        }
    }
}

impl FromTolerance<PolyMesh> for PlanarizeQuads {
    fn from_tolerance(_: &PolyMesh, tolerance: f64) -> Self {
        Self::new(tolerance)
    }
}

impl Convert<PolyMesh> for PlanarizeQuads {
    type Output = PolyMesh;

    fn convert_with(&self, source: &PolyMesh, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        if let Some(vertex) = source.first_non_finite() {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        let faces = source.face_count() as u64;
        let _memory = exec.reserve(
            (source.memory_bytes() as u64 * 2)
                .saturating_add(faces.saturating_mul(BYTES_A_FACE))
                .saturating_add((source.positions().len() as u64).saturating_mul(4 * 24 + 1)),
        )?;
        exec.check()?;
        let mut problem = Problem::new(source, self.hold_border, exec)?;
        let wanted = 2.0 * self.planarity * problem.scale;
        let before = problem.worst();
        let steps = problem.solve(wanted, self.max_steps, exec)?;

        let mut mesh = source.clone();
        for (position, &moved) in mesh.positions_mut().iter_mut().zip(&problem.offsets) {
            *position += moved / problem.scale;
        }
        let pairs = || source.positions().iter().zip(mesh.positions());
        let moved = pairs().map(|(before, after)| length(*after - *before)).fold(0.0, f64::max);
        let mut report = Report::new(Self::NAME, Deviation::Exact, "no vertex moved");
        if moved > 0.0 {
            report.deviation = Deviation::AtMost(moved * (1.0 + 8.0 * f64::EPSILON));
            report.basis = "the largest move of a vertex: points of faces are the same mixtures of corners before and \
                            after"
                .to_owned();
        }
        account(self, source, &mesh, &problem.quads, &mut report);
        report.figure("planarity_before", before / 2.0 / problem.scale);
        report.figure("moved", moved);
        report.figure("newton_steps", f64::from(steps));
        exec.progress(1.0);
        Ok(Converted::new(mesh, report))
    }
}

/// A quadrilateral with its row of derivatives and its place in five vectors of the solver.
const BYTES_A_FACE: u64 = 4 + 16 + 4 * 24 + 6 * 8;

/// Measures what came out, from its own coordinates, and names the faces that are not flat enough or turned over.
fn account(options: &PlanarizeQuads, source: &PolyMesh, mesh: &PolyMesh, quads: &[u32], report: &mut Report) {
    let (mut worst, mut missed, mut turned) = (0.0f64, Vec::new(), Vec::new());
    let corners = |mesh: &PolyMesh, face: u32| {
        let mut corners = mesh.outline(face as usize);
        std::array::from_fn(|_| corners.next().unwrap_or_default())
    };
    for &face in quads {
        let planarity = QuadPlanarity::of(corners(mesh, face)).from_plane();
        worst = worst.max(planarity);
        if planarity > options.planarity {
            missed.push(face);
        }
        let [was, is] = [source, mesh].map(|mesh| newell_vector(mesh.outline(face as usize)).normalize_or_zero());
        if was.dot(is) < 0.0 {
            turned.push(face);
        }
    }
    let place = |&face: &u32| Place::element("face", u64::from(face));
    let message = "quadrilaterals are still farther from flat than was asked for";
    report.findings.push_all(
        "W-planarity-missed",
        Severity::Warning,
        message,
        missed.len() as u64,
        missed.iter().map(place),
    );
    let message = "quadrilaterals turned by more than a right angle on the way to flat";
    report.findings.push_all(
        "W-face-turned",
        Severity::Warning,
        message,
        turned.len() as u64,
        turned.iter().map(place),
    );
    let larger: Vec<u32> = (0..mesh.face_count()).filter(|&face| mesh.face(face).len() > 4).map(|f| f as u32).collect();
    let message = "polygons of more than four corners are not made flat, and may be bent by those around them";
    report.findings.push_all(
        "W-planarize-polygons",
        Severity::Note,
        message,
        larger.len() as u64,
        larger.iter().map(place),
    );
    report.figure("quads", quads.len() as f64);
    report.figure("planarity", worst);
}

/// Offsets of the vertices, such that the diagonals of every quadrilateral meet.
struct Problem<'a> {
    mesh: &'a PolyMesh,
    /// The faces with four corners.
    quads: Vec<u32>,
    held: Vec<bool>,
    /// A power of two by which lengths are multiplied, so that the mesh is of size 1.
    scale: f64,
    center: DVec3,
    /// In units of the scaled mesh.
    offsets: Vec<DVec3>,
    /// The derivative of each quadrilateral's distance between diagonals by its four corners.
    rows: Vec<[DVec3; 4]>,
    /// That distance.
    distances: Vec<f64>,
}

impl<'a> Problem<'a> {
    fn new(mesh: &'a PolyMesh, hold_border: bool, exec: &Exec) -> Result<Self, ConvertError> {
        let quads: Vec<u32> = (0..mesh.face_count()).filter(|&f| mesh.face(f).len() == 4).map(|f| f as u32).collect();
        let bounds = mesh.bounds();
        let (low, high) = if bounds.is_empty() { (DVec3::ZERO, DVec3::ZERO) } else { (bounds.min, bounds.max) };
        let size = (high * 0.5 - low * 0.5).abs().max_element();
        // Between the smallest normal number and its inverse, so that it has an inverse too.
        let scale = if size > 0.0 { 2f64.powi(-(size.log2().floor() as i32).clamp(-1000, 1000)) } else { 1.0 };
        let held = if hold_border { on_border(mesh, exec)? } else { vec![false; mesh.positions().len()] };
        let offsets = vec![DVec3::ZERO; mesh.positions().len()];
        let mut made = Self {
            mesh,
            held,
            scale,
            center: low * 0.5 + high * 0.5,
            offsets,
            rows: vec![[DVec3::ZERO; 4]; quads.len()],
            distances: vec![0.0; quads.len()],
            quads,
        };
        made.linearize(exec)?;
        Ok(made)
    }

    fn worst(&self) -> f64 {
        self.distances.iter().copied().map(f64::abs).fold(0.0, f64::max)
    }

    fn vertices(&self, quad: usize) -> [u32; 4] {
        let face = self.mesh.face(self.quads[quad] as usize);
        std::array::from_fn(|corner| face.get(corner).copied().unwrap_or_default())
    }

    fn point(&self, vertex: u32) -> DVec3 {
        let vertex = vertex as usize;
        (self.mesh.positions()[vertex] - self.center) * self.scale + self.offsets[vertex]
    }

    /// The distances at the offsets, and their derivatives: a corner moves the point of its diagonal that is nearest to
    /// the other diagonal, by its share in that point. (How the nearest points slide along does not matter to first order.)
    fn linearize(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        for quad in 0..self.quads.len() {
            if quad.is_multiple_of(4096) {
                exec.check()?;
            }
            let vertices = self.vertices(quad);
            let corners = vertices.map(|vertex| self.point(vertex));
            self.distances[quad] = QuadPlanarity::of(corners).between_diagonals;
            let (first, second) = (corners[2] - corners[0], corners[3] - corners[1]);
            let across = first.cross(second);
            let square = across.length_squared();
            // Diagonals that are nearly parallel cross too far away to be told.
            let crossing = square > 1e-20 * first.length_squared() * second.length_squared();
            let between = corners[1] - corners[0];
            let s = between.cross(second).dot(across) / square;
            let t = between.cross(first).dot(across) / square;
            let normal = across / square.sqrt();
            self.rows[quad] = match crossing && s.is_finite() && t.is_finite() && normal.is_finite() {
                true => [normal * (s - 1.0), normal * (1.0 - t), normal * -s, normal * t],
                false => [DVec3::ZERO; 4],
            };
            for (vertex, derivative) in vertices.into_iter().zip(&mut self.rows[quad]) {
                if self.held[vertex as usize] {
                    *derivative = DVec3::ZERO;
                }
            }
        }
        Ok(())
    }

    /// Newton steps until every distance is within `wanted`; returns how many.
    fn solve(&mut self, wanted: f64, max_steps: u32, exec: &Exec) -> Result<u32, ConvertError> {
        let square = |distances: &[f64]| distances.iter().map(|distance| distance * distance).sum::<f64>();
        let mut error = square(&self.distances);
        for step in 0..max_steps {
            // A little more than asked for, as offsets are rounded when they are added to positions.
            if self.worst() <= 0.999 * wanted {
                return Ok(step);
            }
            exec.progress(f64::from(step) / f64::from(max_steps));
            let multipliers = self.conjugate_gradients(exec)?;
            let change = self.transposed(&multipliers);
            let start = self.offsets.clone();
            let mut part = 1.0;
            loop {
                for ((offset, &from), &change) in self.offsets.iter_mut().zip(&start).zip(&change) {
                    *offset = from - change * part;
                }
                self.linearize(exec)?;
                let now = square(&self.distances);
                if now < error {
                    error = now;
                    break;
                }
                part /= 2.0;
                if part < 1e-3 {
                    self.offsets = start;
                    self.linearize(exec)?;
                    return Ok(step);
                }
            }
        }
        Ok(max_steps)
    }

    /// Jᵀ·x, by vertices.
    fn transposed(&self, multipliers: &[f64]) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.offsets.len()];
        for (quad, &multiplier) in multipliers.iter().enumerate() {
            for (vertex, row) in self.vertices(quad).into_iter().zip(self.rows[quad]) {
                sums[vertex as usize] += row * multiplier;
            }
        }
        sums
    }

    /// Solves (J·Jᵀ + ε)·x = distances, with the diagonal as preconditioner. The ε keeps equations that say the same thing
    /// from pulling against each other.
    fn conjugate_gradients(&self, exec: &Exec) -> Result<Vec<f64>, ConvertError> {
        let diagonal: Vec<f64> =
            self.rows.iter().map(|row| row.iter().map(|derivative| derivative.length_squared()).sum()).collect();
        let ridge = 1e-10 * diagonal.iter().sum::<f64>() / diagonal.len().max(1) as f64;
        let inverse: Vec<f64> =
            diagonal.iter().map(|&entry| if entry > 0.0 { 1.0 / (entry + ridge) } else { 0.0 }).collect();
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let mut x = vec![0.0; self.quads.len()];
        // Equations without a derivative cannot be met: they are left out.
        let mut residual: Vec<f64> = self
            .distances
            .iter()
            .zip(&inverse)
            .map(|(&distance, &inverse)| if inverse > 0.0 { distance } else { 0.0 })
            .collect();
        let mut z: Vec<f64> = residual.iter().zip(&inverse).map(|(r, i)| r * i).collect();
        let mut direction = z.clone();
        let mut product = dot(&residual, &z);
        let target = product * 1e-8;
        for _ in 0..500 {
            exec.check()?;
            if product <= target || product <= 0.0 {
                break;
            }
            let by_vertices = self.transposed(&direction);
            let image: Vec<f64> = (0..self.quads.len())
                .map(|quad| {
                    let row = self.vertices(quad).into_iter().zip(self.rows[quad]);
                    let sum: f64 = row.map(|(vertex, row)| row.dot(by_vertices[vertex as usize])).sum();
                    sum + ridge * direction[quad]
                })
                .collect();
            let step = product / dot(&direction, &image);
            if !step.is_finite() {
                break;
            }
            for quad in 0..x.len() {
                x[quad] += step * direction[quad];
                residual[quad] -= step * image[quad];
                z[quad] = residual[quad] * inverse[quad];
            }
            let next = dot(&residual, &z);
            let share = next / product;
            product = next;
            for (direction, z) in direction.iter_mut().zip(&z) {
                *direction = z + share * *direction;
            }
        }
        Ok(x)
    }
}

/// Which vertices are on a side that one face alone has.
fn on_border(mesh: &PolyMesh, exec: &Exec) -> Result<Vec<bool>, ConvertError> {
    let _memory = exec.reserve_elements(mesh.wedge_vertices().len() as u64, 8)?;
    let mut sides: Vec<[u32; 2]> = Vec::with_capacity(mesh.wedge_vertices().len());
    for face in mesh.faces() {
        let next = face.iter().cycle().skip(1);
        sides.extend(face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]));
    }
    sides.sort_unstable();
    exec.check()?;
    let mut on_border = vec![false; mesh.positions().len()];
    for same in sides.chunk_by(|a, b| a == b) {
        if let [[a, b]] = same {
            on_border[*a as usize] = true;
            on_border[*b as usize] = true;
        }
    }
    Ok(on_border)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{QuadGrid, planarity_column};
    use shapeloom_core::glam::DVec2;

    /// A piece of a torus: flat quadrilaterals, as its parameter lines are lines of curvature of a surface of revolution.
    fn torus_piece(columns: u32, rows: u32) -> PolyMesh {
        let points = (0..columns * rows).map(|k| {
            let (u, v) = (f64::from(k % columns) * 0.12, f64::from(k / columns) * 0.15);
            let (around, tube) = (DVec2::from_angle(u), DVec2::from_angle(v));
            (around * (3.0 + tube.x)).extend(tube.y)
        });
        let grid = QuadGrid::try_new(columns, rows, points.collect(), [false; 2]).unwrap();
        grid.to_mesh(&Exec::default()).unwrap()
    }

    fn shaken(mesh: &PolyMesh, distance: f64) -> PolyMesh {
        let mut state = 11u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut mesh = mesh.clone();
        mesh.positions_mut().iter_mut().for_each(|p| *p += DVec3::new(draw(), draw(), draw()) * distance);
        mesh
    }

    /// The volume of a tetrahedron over the areas of its faces: flat by a measure that the solver does not use.
    fn flatness(mesh: &PolyMesh) -> f64 {
        (0..mesh.face_count())
            .map(|face| {
                let [a, b, c, d]: [DVec3; 4] = std::array::from_fn(|k| mesh.outline(face).nth(k).unwrap());
                // The distance of each corner from the plane of the other three.
                let height =
                    |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).normalize_or_zero().dot(d - a).abs();
                height(a, b, c, d).max(height(b, c, d, a)).max(height(c, d, a, b)).max(height(d, a, b, c))
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_shaken_torus_becomes_flat_again_by_moves_like_the_shaking() {
        let flat = torus_piece(20, 15);
        assert!(flatness(&flat) < 1e-14);
        let mesh = shaken(&flat, 0.005);
        assert!(flatness(&mesh) > 0.005);
        for hold_border in [false, true] {
            let made = PlanarizeQuads { hold_border, ..PlanarizeQuads::new(1e-9) }.convert(&mesh).unwrap();
            assert!(made.report.findings.is_empty(), "{:?}", made.report.findings);
            assert!(flatness(&made.value) < 1e-7, "{}", flatness(&made.value));
            let Deviation::AtMost(moved) = made.report.deviation else { panic!("a bound") };
            assert!(moved < 0.1, "{moved}");
            let pairs = mesh.positions().iter().zip(made.value.positions());
            let moves: Vec<f64> = pairs.map(|(a, b)| a.distance(*b)).collect();
            let largest = moves.iter().copied().fold(0.0, f64::max);
            assert!(largest <= moved && largest > 0.999 * moved);
            let held = moves.iter().enumerate().filter(|(v, _)| v % 20 == 0 || v % 20 == 19 || v / 20 % 14 == 0);
            let on_border = held.map(|(_, moved)| *moved).fold(0.0, f64::max);
            assert_eq!(on_border == 0.0, hold_border);
            let column = planarity_column(&made.value).unwrap();
            assert!((0..column.len()).all(|face| column.number(face, 0) <= 1e-9));
            assert!((made.report.find("planarity_before").unwrap() - mesh.planarity_worst()).abs() < 1e-12);
        }
    }

    impl PolyMesh {
        fn planarity_worst(&self) -> f64 {
            (0..self.face_count()).map(|face| self.planarity(face)).fold(0.0, f64::max)
        }
    }

    /// A quadrilateral whose diagonals halve each other as seen from above: the least move takes each corner into the mean
    /// plane, straight.
    #[test]
    fn a_saddle_cell_moves_as_little_as_it_can() {
        let corners = [(0.0, 0.0, 0.1), (1.0, 0.0, -0.1), (1.0, 1.0, 0.1), (0.0, 1.0, -0.1)].map(DVec3::from);
        let mesh = PolyMesh::from_faces(corners.to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let made = PlanarizeQuads::new(1e-12).convert(&mesh).unwrap();
        assert!((made.report.find("planarity_before").unwrap() - 0.1).abs() < 1e-15);
        for (before, after) in corners.iter().zip(made.value.positions()) {
            assert!(after.z.abs() < 2e-12 && (before.truncate() - after.truncate()).length() < 1e-12, "{after}");
        }
        let moved = made.report.deviation.value().unwrap();
        assert!((moved - 0.1).abs() < 2e-12);
    }

    #[test]
    fn flat_meshes_stay_bit_for_bit_and_what_cannot_be_reached_is_told() {
        let flat = torus_piece(6, 5);
        let made = PlanarizeQuads::new(1e-6).convert(&flat).unwrap();
        assert_eq!((made.report.deviation, &made.value), (Deviation::Exact, &flat));
        // All four corners are on the border and held.
        let saddle = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
        let mesh = PolyMesh::from_faces(saddle.to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let held = PlanarizeQuads { hold_border: true, ..PlanarizeQuads::new(1e-6) }.convert(&mesh).unwrap();
        assert_eq!((held.value, held.report.deviation), (mesh, Deviation::Exact));
        let finding = held.report.findings.iter().next().unwrap();
        assert_eq!((finding.code, finding.count), ("W-planarity-missed", 1));
        // Five corners and three: nothing to do.
        let points = (0..7).map(|k| DVec2::from_angle(f64::from(k)).extend(f64::from(k % 3))).collect();
        let mesh = PolyMesh::from_faces(points, &[vec![0, 1, 2, 3, 4], vec![4, 5, 6]]).unwrap();
        let made = PlanarizeQuads::new(1e-6).convert(&mesh).unwrap();
        assert_eq!(made.report.findings.iter().next().unwrap().code, "W-planarize-polygons");
        assert_eq!((made.value, made.report.deviation), (mesh, Deviation::Exact));
    }

    /// Rows of derivatives are difference quotients of the distance, wherever the diagonals cross.
    #[test]
    fn derivatives_are_difference_quotients() {
        let corners = [(0.0, 0.1, 0.2), (3.0, 0.0, -0.4), (2.0, 1.0, 0.1), (0.5, 2.5, -0.3)].map(DVec3::from);
        let mesh = PolyMesh::from_faces(corners.to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let problem = Problem::new(&mesh, false, &Exec::default()).unwrap();
        let h = 1e-6;
        for corner in 0..4 {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let at = |step: f64| {
                    let mut moved = corners;
                    moved[corner] += axis * step;
                    QuadPlanarity::of(moved).between_diagonals
                };
                let quotient = (at(h) - at(-h)) / (2.0 * h);
                let found = problem.rows[0][corner].dot(axis);
                assert!((found - quotient).abs() < 1e-8, "{corner} {axis}: {found} {quotient}");
            }
        }
    }

    #[test]
    fn faces_that_turned_over_are_named() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let mesh = |corners: [DVec3; 4]| PolyMesh::from_faces(corners.to_vec(), &[[0, 1, 2, 3]]).unwrap();
        let [a, b, c, d] = corners;
        for (after, count) in [([a, d, c, b], 1), (corners, 0)] {
            let mut report = Report::exact("test", "");
            account(&PlanarizeQuads::new(1.0), &mesh(corners), &mesh(after), &[0], &mut report);
            assert_eq!(report.findings.iter().filter(|finding| finding.code == "W-face-turned").count(), count);
        }
    }

    #[test]
    fn any_size_and_degenerate_faces_are_taken() {
        let saddle = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
        for size in [1e-300, 1e-9, 1.0, 1e150] {
            let mesh = PolyMesh::from_faces(saddle.map(|p| p * size).to_vec(), &[[0, 1, 2, 3]]).unwrap();
            let made = PlanarizeQuads::new(1e-9 * size).convert(&mesh).unwrap();
            assert!(made.report.findings.is_empty(), "{size} {:?}", made.report);
        }
        let far =
            shaken(&torus_piece(8, 8), 0.003).transformed(&shapeloom_core::Affine::from_translation(DVec3::splat(5e6)));
        let made = PlanarizeQuads::new(1e-7).convert(&far).unwrap();
        assert!(made.report.findings.is_empty(), "{:?}", made.report);
        for points in [vec![DVec3::ONE; 4], vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0]] {
            let mesh = PolyMesh::from_faces(points, &[[0, 1, 2, 3], [0, 0, 1, 1]]).unwrap();
            let made = PlanarizeQuads::new(1e-9).convert(&mesh).unwrap();
            assert_eq!(made.value, mesh);
        }
        assert!(PlanarizeQuads::new(1e-9).convert(&PolyMesh::default()).unwrap().report.findings.is_empty());
        let nan = PolyMesh::from_faces(vec![DVec3::NAN; 4], &[[0, 1, 2, 3]]).unwrap();
        assert!(PlanarizeQuads::new(1e-9).convert(&nan).is_err());
        assert!(PlanarizeQuads::new(0.0).convert(&PolyMesh::default()).is_err());
    }
}
