//! Quadrics that are not closed.

use std::f64::consts::TAU;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, OptionError, Options, choice, options};

use super::{FaceList, LENGTH, finish, proven};
use crate::{Column, Domain, MeshError, PolyMesh, TEXCOORD};

choice! {
    /// Which quadric; φ is u turns.
    pub enum QuadricShape {
        /// x²/a² + y²/b² = z/c: (u, v, c (u²/a² + v²/b²)).
        EllipticParaboloid = "elliptic-paraboloid",
        /// x²/a² − y²/b² = z/c: (u, v, c (u²/a² − v²/b²)).
        HyperbolicParaboloid = "hyperbolic-paraboloid",
        /// x²/a² + y²/b² = 1: (a cos φ, b sin φ, c v).
        EllipticCylinder = "elliptic-cylinder",
        /// x²/a² + y²/b² = z²/c²: (a v cos φ, b v sin φ, c v), v from 0 on.
        EllipticCone = "elliptic-cone",
        /// x²/a² + y²/b² − z²/c² = 1: (a cosh v cos φ, b cosh v sin φ, c sinh v).
        OneSheet = "one-sheet",
        /// x²/a² + y²/b² − z²/c² = −1: (a sinh v cos φ, b sinh v sin φ, ± c cosh v), v from 0 on; both sheets.
        TwoSheet = "two-sheet",
    }
}

options! {
    /// A quadric over a box of its parameters, cut into triangles between equal steps.
    ///
    /// Vertices and normals are the quadric's own; a whole turn closes without a seam, an apex is one vertex. The front is
    /// where the left side of the equation is larger than the right: outside. Texture coordinates run from 0 to 1 over the
    /// box.
    pub struct Quadric("quadric") {
        required {}
        optional {
            /// Which one.
            shape: QuadricShape = QuadricShape::OneSheet,
            /// The length along x in its equation, in model units.
            a: f64 [LENGTH] = 1.0,
            /// The length along y in its equation, in model units.
            b: f64 [LENGTH] = 1.0,
            /// The length along z in its equation, in model units.
            c: f64 [LENGTH] = 1.0,
            /// Where u begins: in turns about the axis, of paraboloids in model units.
            u_from: f64 [Bounds::closed(-1e6, 1e6)] = 0.0,
            /// Where u ends.
            u_to: f64 [Bounds::closed(-1e6, 1e6)] = 1.0,
            /// Where v begins: of paraboloids in model units, of others in parts of c or as a hyperbolic angle.
            v_from: f64 [Bounds::closed(-100.0, 100.0)] = 0.0,
            /// Where v ends.
            v_to: f64 [Bounds::closed(-100.0, 100.0)] = 1.0,
            /// How many steps along u; at least 3 in a whole turn.
            u_steps: u32 [Bounds::closed(1.0, 32768.0)] = 64,
            /// How many steps along v.
            v_steps: u32 [Bounds::closed(1.0, 32768.0)] = 16,
        }
    }
}

impl Quadric {
    /// The triangles.
    ///
    /// A triangle over half a cell of the box of sides h and k is within (h² |r_uu| + 2 h k |r_uv| + k² |r_vv|) / 8 of the
    /// surface at the same parameters (Filip, Magedson and Markot 1986), with the largest second derivatives over the
    /// box, which are known in closed form; so it is both ways. Steps count as wider by the rounding of parameters.
    ///
    /// # Errors
    /// Options out of bounds: a box turned round, more than a turn, a whole turn in fewer than 3 steps, v below 0 where
    /// there is an apex; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        self.check_box()?;
        let closed = self.is_closed();
        let [u_from, u_to] = self.u_range();
        let [m, n] = [self.u_steps, self.v_steps];
        let sheets = if self.shape == QuadricShape::TwoSheet { 2 } else { 1 };
        let cells = (u64::from(m) + 1) * (u64::from(n) + 1) * sheets;
        let _memory = exec.reserve_elements(cells, 24 + 6 * (4 + 24 + 16) + 8)?;
        let apex = self.has_apex() && self.v_from == 0.0;
        let parameter = |from: f64, to: f64, i: u32, count: u32| {
            if i == count { to } else { from + (to - from) * f64::from(i) / f64::from(count) }
        };
        let (mut positions, mut gradients) = (Vec::new(), Vec::new());
        let mut faces = FaceList::new();
        let mut coordinates = Vec::new();
        for sheet in 0..sheets {
            let first = positions.len() as u32;
            let side = if sheet == 1 { DVec3::new(1.0, 1.0, -1.0) } else { DVec3::ONE };
            let width = if closed { m } else { m + 1 };
            for j in 0..=n {
                exec.check()?;
                let v = parameter(self.v_from, self.v_to, j, n);
                let count = if apex && j == 0 { 1 } else { width };
                for i in 0..count {
                    let u = parameter(u_from, u_to, i, m);
                    let point = self.point(u, v) * side;
                    positions.push(point);
                    gradients.push(self.gradient(point));
                }
            }
            let vertex = |i: u32, j: u32| {
                let i = if closed { i % m } else { i };
                match (apex, j) {
                    (true, 0) => first,
                    (true, _) => first + 1 + (j - 1) * width + i,
                    _ => first + j * width + i,
                }
            };
            for j in 0..n {
                exec.check()?;
                for i in 0..m {
                    for triangle in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
                        let places = triangle.map(|(x, y)| (i + x, j + y));
                        let mut ids = places.map(|(i, j)| vertex(i, j));
                        if ids[0] == ids[1] {
                            continue;
                        }
                        let mut texture =
                            places.map(|(i, j)| [f64::from(i) / f64::from(m), f64::from(j) / f64::from(n)]);
                        // The front is against the turn from u to v below paraboloids, and on the mirrored sheet.
                        if !self.has_axis() || sheet == 1 {
                            ids.swap(1, 2);
                            texture.swap(1, 2);
                        }
                        faces.push(&ids);
                        coordinates.extend(texture);
                    }
                }
            }
        }
        let (starts, corners) = faces.into_parts();
        let normals = corners.iter().map(|&vertex| gradients[vertex as usize]).collect();
        let size = positions.iter().map(|point: &DVec3| point.abs().max_element()).fold(0.0, f64::max);
        let deviation = proven(self.chord_error(), size);
        let mut made = finish(Self::NAME, positions, (starts, corners), Some(normals), deviation, exec)?;
        let column = Column::texcoords(TEXCOORD, &coordinates);
        made.value.insert_attribute(Domain::Wedge, column).map_err(MeshError::from)?;
        Ok(made)
    }

    fn has_axis(&self) -> bool {
        !matches!(self.shape, QuadricShape::EllipticParaboloid | QuadricShape::HyperbolicParaboloid)
    }

    fn has_apex(&self) -> bool {
        matches!(self.shape, QuadricShape::EllipticCone | QuadricShape::TwoSheet)
    }

    /// Whether u makes a whole turn, as near as numbers of that size tell.
    fn is_closed(&self) -> bool {
        self.has_axis() && (self.u_to == self.u_from + 1.0 || self.u_from == self.u_to - 1.0)
    }

    /// Where u begins and ends, about an axis less the whole turns before it, so that steps are not rounded with these.
    fn u_range(&self) -> [f64; 2] {
        let turns = if self.has_axis() { self.u_from.trunc() } else { 0.0 };
        let from = self.u_from - turns;
        [from, if self.is_closed() { from + 1.0 } else { self.u_to - turns }]
    }

    fn check_box(&self) -> Result<(), OptionError> {
        let most = match self.has_axis() {
            true if self.is_closed() => self.u_to,
            true => self.u_from + 1.0,
            false => 1e6,
        };
        let fewest = if self.is_closed() { 3.0 } else { 1.0 };
        let least = if self.has_apex() { 0.0 } else { -100.0 };
        let wanted = [
            ("u_to", self.u_to, Bounds { min: self.u_from, above: true, max: most }),
            ("v_from", self.v_from, Bounds::closed(least, 100.0)),
            ("v_to", self.v_to, Bounds { min: self.v_from, above: true, max: 100.0 }),
            ("u_steps", f64::from(self.u_steps), Bounds::closed(fewest, 32768.0)),
        ];
        match wanted.into_iter().find(|(_, found, bounds)| !bounds.contains(*found)) {
            Some((name, found, bounds)) => Err(OptionError::OutOfBounds { algorithm: Self::NAME, name, found, bounds }),
            None => Ok(()),
        }
    }

    fn point(&self, u: f64, v: f64) -> DVec3 {
        let ring = |factor: f64, z: f64| {
            let DVec2 { x, y } = turned(u);
            DVec3::new(self.a * factor * x, self.b * factor * y, self.c * z)
        };
        let square = |x: f64| x * x;
        match self.shape {
            QuadricShape::EllipticParaboloid => DVec3::new(u, v, self.c * (square(u / self.a) + square(v / self.b))),
            QuadricShape::HyperbolicParaboloid => DVec3::new(u, v, self.c * (square(u / self.a) - square(v / self.b))),
            QuadricShape::EllipticCylinder => ring(1.0, v),
            QuadricShape::EllipticCone => ring(v, v),
            QuadricShape::OneSheet => ring(v.cosh(), v.sinh()),
            QuadricShape::TwoSheet => ring(v.sinh(), v.cosh()),
        }
    }

    /// The unit vector along the gradient of left less right; along the axis at an apex.
    fn gradient(&self, p: DVec3) -> DVec3 {
        let q = DVec3::new(p.x / self.a, p.y / self.b, p.z / self.c);
        let across = match self.shape {
            QuadricShape::EllipticParaboloid => DVec3::new(2.0 * q.x, 2.0 * q.y, -1.0),
            QuadricShape::HyperbolicParaboloid => DVec3::new(2.0 * q.x, -2.0 * q.y, -1.0),
            QuadricShape::EllipticCylinder => DVec3::new(q.x, q.y, 0.0),
            QuadricShape::EllipticCone if p == DVec3::ZERO => DVec3::new(0.0, 0.0, -1.0),
            _ => DVec3::new(q.x, q.y, -q.z),
        };
        let least = self.a.min(self.b).min(self.c);
        let across = across * DVec3::new(least / self.a, least / self.b, least / self.c);
        (across / across.abs().max_element()).normalize_or_zero()
    }

    fn chord_error(&self) -> f64 {
        let turn = if self.has_axis() { TAU } else { 1.0 };
        // Parameters are rounded, so that steps differ.
        let widest = |[from, to]: [f64; 2], count: u32| {
            (to - from) / f64::from(count) + 4.0 * f64::EPSILON * f64::max(from.abs(), to.abs())
        };
        let h = widest(self.u_range(), self.u_steps) * turn;
        let k = widest([self.v_from, self.v_to], self.v_steps);
        let wide = self.a.max(self.b);
        let far = self.v_from.abs().max(self.v_to.abs());
        let [uu, uv, vv] = match self.shape {
            QuadricShape::EllipticParaboloid | QuadricShape::HyperbolicParaboloid => {
                [2.0 * self.c / self.a / self.a, 0.0, 2.0 * self.c / self.b / self.b]
            }
            QuadricShape::EllipticCylinder => [wide, 0.0, 0.0],
            QuadricShape::EllipticCone => [wide * far, wide, 0.0],
            QuadricShape::OneSheet => {
                let (s, c) = (far.sinh(), far.cosh());
                [wide * c, wide * s, (wide * c).hypot(self.c * s)]
            }
            QuadricShape::TwoSheet => {
                let (s, c) = (far.sinh(), far.cosh());
                [wide * s, wide * c, (wide * s).hypot(self.c * c)]
            }
        };
        (h * h * uu + 2.0 * h * k * uv + k * k * vv) / 8.0
    }
}

/// The direction after that many turns, exact at the quarters.
fn turned(turns: f64) -> DVec2 {
    let quarters = 4.0 * turns;
    if quarters.fract() == 0.0 {
        return [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y][quarters.rem_euclid(4.0) as usize % 4];
    }
    DVec2::from_angle(TAU * turns.rem_euclid(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::{ChoiceOption, Deviation};
    use std::f64::consts::PI;

    fn all() -> Vec<Quadric> {
        let shapes = QuadricShape::NAMES.iter().map(|name| QuadricShape::from_name(name).unwrap());
        shapes.map(|shape| Quadric { shape, a: 1.5, b: 0.7, c: 0.8, v_to: 1.3, ..Quadric::new() }).collect()
    }

    /// Left less right of the equation, over the size of its terms.
    fn equation(quadric: &Quadric, p: DVec3) -> f64 {
        let (x, y, z) = (p.x / quadric.a, p.y / quadric.b, p.z / quadric.c);
        let (terms, right) = match quadric.shape {
            QuadricShape::EllipticParaboloid => ([x * x, y * y], z),
            QuadricShape::HyperbolicParaboloid => ([x * x, -y * y], z),
            QuadricShape::EllipticCylinder => ([x * x, y * y], 1.0),
            QuadricShape::EllipticCone => ([x * x, y * y], z * z),
            QuadricShape::OneSheet => ([x * x, y * y], 1.0 + z * z),
            QuadricShape::TwoSheet => ([x * x, y * y], z * z - 1.0),
        };
        (terms[0] + terms[1] - right) / (1.0 + x * x + y * y + z * z)
    }

    #[test]
    fn vertices_satisfy_the_equation_and_fronts_are_outside() {
        for quadric in all() {
            for v_from in if quadric.has_apex() { [0.0, 0.4] } else { [-0.9, 0.4] } {
                let quadric = Quadric { v_from, u_steps: 24, ..quadric.clone() };
                let mesh = quadric.mesh(&Exec::default()).unwrap().value;
                for &p in mesh.positions() {
                    assert!(equation(&quadric, p).abs() < 4e-16, "{:?} {}", quadric.shape, equation(&quadric, p));
                }
                for face in 0..mesh.face_count() {
                    let middle = mesh.outline(face).sum::<DVec3>() / 3.0;
                    let normal = crate::newell_vector(mesh.outline(face)).normalize();
                    let (out, inside) =
                        (equation(&quadric, middle + normal * 1e-4), equation(&quadric, middle - normal * 1e-4));
                    assert!(out > inside, "{:?} {face}", quadric.shape);
                    let shading = mesh.attribute(Domain::Wedge, crate::NORMAL).unwrap();
                    assert!(
                        mesh.wedges(face).all(|wedge| shading.vector(wedge).dot(normal) > 0.0),
                        "{:?}",
                        quadric.shape
                    );
                }
            }
        }
    }

    /// At the same parameters, at a lattice in every triangle.
    #[test]
    fn bounds_hold_at_the_same_parameters_and_are_not_wild() {
        for quadric in all() {
            for (u_steps, v_steps, v_to) in [(5, 3, 1.3), (12, 1, 1.3), (16, 8, 1.3), (64, 1, 0.2)] {
                let quadric = Quadric { u_steps, v_steps, v_to, ..quadric.clone() };
                let Converted { report, .. } = quadric.mesh(&Exec::default()).unwrap();
                let Deviation::AtMost(bound) = report.deviation else { panic!("a bound") };
                let at = |i: f64, j: f64| quadric.point(i / f64::from(u_steps), v_to * j / f64::from(v_steps));
                let mut farthest = 0.0f64;
                for cell in 0..u_steps * v_steps {
                    let (i, j) = (f64::from(cell % u_steps), f64::from(cell / u_steps));
                    for half in [[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]] {
                        let [p, q, r] = half.map(|(x, y)| at(i + x, j + y));
                        for k in 0..=12 {
                            for l in 0..=12 - k {
                                let w = [f64::from(12 - k - l) / 12.0, f64::from(k) / 12.0, f64::from(l) / 12.0];
                                let mix =
                                    |axis: usize| (0..3).map(|c| w[c] * [half[c].0, half[c].1][axis]).sum::<f64>();
                                let flat = p * w[0] + q * w[1] + r * w[2];
                                farthest = farthest.max(flat.distance(at(i + mix(0), j + mix(1))));
                            }
                        }
                    }
                }
                assert!(farthest <= bound, "{:?} {farthest} {bound}", quadric.shape);
                // Where the parts of the bound are largest in different places it is more generous.
                assert!(v_to < 1.0 || bound < 4.0 * farthest, "{:?} {farthest} {bound}", quadric.shape);
            }
        }
    }

    #[test]
    fn areas_converge_at_second_order_to_closed_forms() {
        let of = |shape, v_from, steps: u32| {
            let quadric = Quadric { shape, v_from, u_steps: 4 * steps, v_steps: steps, ..Quadric::new() };
            quadric.mesh(&Exec::default()).unwrap().value.area()
        };
        // Unit lengths, v to 1. The catenary-like integrals are by substitution: of one sheet 2π ∫ cosh v √(cosh 2v) dv.
        let one_sheet = {
            let s = 2f64.sqrt() * 1f64.sinh();
            2.0 * PI * (s * s.hypot(1.0) + s.asinh()) / (2.0 * 2f64.sqrt())
        };
        let cases = [
            (QuadricShape::EllipticCylinder, 2.0 * PI),
            (QuadricShape::EllipticCone, PI * 2f64.sqrt()),
            (QuadricShape::OneSheet, one_sheet),
        ];
        for (shape, area) in cases {
            let errors = [8, 16, 32].map(|steps| area - of(shape, 0.0, steps));
            for pair in errors.windows(2) {
                assert!((pair[0] / pair[1] - 4.0).abs() < 0.1, "{shape:?} {errors:?}");
            }
        }
    }

    #[test]
    fn whole_turns_close_and_apexes_are_one_vertex() {
        let border = |quadric: &Quadric| {
            let mesh = quadric.mesh(&Exec::default()).unwrap().value;
            let sides: std::collections::HashSet<(u32, u32)> =
                mesh.faces().flat_map(|face| (0..3).map(move |i| (face[i], face[(i + 1) % 3]))).collect();
            let open = sides.iter().filter(|&&(a, b)| !sides.contains(&(b, a))).count();
            let edges = (sides.len() + open) / 2;
            (open, mesh.positions().len() as i64 - edges as i64 + mesh.face_count() as i64)
        };
        let with = |shape| Quadric { shape, u_steps: 12, v_steps: 5, ..Quadric::new() };
        // Open sides, and the Euler characteristic: annuli, a disk, two disks, and a disk cut open along u.
        assert_eq!(border(&with(QuadricShape::EllipticCylinder)), (24, 0));
        assert_eq!(border(&with(QuadricShape::OneSheet)), (24, 0));
        assert_eq!(border(&with(QuadricShape::EllipticCone)), (12, 1));
        assert_eq!(border(&with(QuadricShape::TwoSheet)), (24, 2));
        assert_eq!(border(&with(QuadricShape::HyperbolicParaboloid)), (34, 1));
        assert_eq!(border(&Quadric { u_to: 0.5, ..with(QuadricShape::OneSheet) }), (34, 1));
        // Neither 1.4 - 0.4 nor -0.7 + 1 is what it would be without rounding.
        for (u_from, u_to) in [(0.4, 1.4), (-0.7, 0.3), (1e6 - 1.3, 1e6 - 0.3), (-1e6, 1.0 - 1e6)] {
            for (shape, made) in [(QuadricShape::OneSheet, (24, 0)), (QuadricShape::EllipticCone, (12, 1))] {
                assert_eq!(border(&Quadric { u_from, u_to, ..with(shape) }), made, "{u_from}");
            }
        }
        for wrong in [
            Quadric { v_from: -0.1, ..with(QuadricShape::EllipticCone) },
            Quadric { u_to: 1.01, ..with(QuadricShape::OneSheet) },
            Quadric { u_to: 0.0, ..with(QuadricShape::OneSheet) },
            Quadric { v_to: 0.0, ..with(QuadricShape::HyperbolicParaboloid) },
            Quadric { a: f64::NAN, ..with(QuadricShape::OneSheet) },
        ] {
            assert!(wrong.mesh(&Exec::default()).is_err());
        }
    }

    #[test]
    fn whole_turns_take_three_steps() {
        let with = |shape, u_to, u_steps| Quadric { shape, u_to, u_steps, ..Quadric::new() }.mesh(&Exec::default());
        for shape in [QuadricShape::EllipticCylinder, QuadricShape::EllipticCone, QuadricShape::TwoSheet] {
            for u_steps in [1, 2] {
                let bounds = Bounds::closed(3.0, 32768.0);
                let (algorithm, found) = (Quadric::NAME, f64::from(u_steps));
                let error = OptionError::OutOfBounds { algorithm, name: "u_steps", found, bounds };
                assert_eq!(with(shape, 1.0, u_steps).unwrap_err().to_string(), ConvertError::from(error).to_string());
                assert!(with(shape, 0.9, u_steps).is_ok());
            }
            assert!(with(shape, 1.0, 3).is_ok());
        }
        assert!(with(QuadricShape::EllipticParaboloid, 1.0, 1).is_ok());
    }

    #[test]
    fn steps_are_as_equal_after_many_turns() {
        let with = |u_from: f64, shape| Quadric { shape, u_from, u_to: u_from + 1.0, ..Quadric::new() };
        let fine = Quadric { u_steps: 32768, v_steps: 1, ..with(1e6 - 1.0, QuadricShape::EllipticCylinder) };
        let Converted { value: mesh, report } = fine.mesh(&Exec::default()).unwrap();
        let bound = report.deviation.value().unwrap();
        for i in 0..32768 {
            let middle = mesh.positions()[i].midpoint(mesh.positions()[(i + 1) % 32768]);
            assert!(1.0 - middle.truncate().length() <= bound, "{i}");
        }
        let near = Quadric { u_from: 0.0, u_to: 1.0, ..fine.clone() }.mesh(&Exec::default()).unwrap();
        assert_eq!((near.value.positions(), near.report.deviation), (mesh.positions(), report.deviation));
        // About no axis nothing can be subtracted: the widest step counts.
        let far = Quadric { u_steps: 32768, ..with(1e6 - 1.0, QuadricShape::EllipticParaboloid) };
        let mesh = far.mesh(&Exec::default()).unwrap();
        let x = |i: usize| mesh.value.positions()[i].x;
        let widest = (0..32768).map(|i| x(i + 1) - x(i)).fold(0.0, f64::max);
        let k = 1.0 / 16.0;
        assert!(mesh.report.deviation.value().unwrap() >= (2.0 * widest * widest + 2.0 * k * k) / 8.0);
    }
}
