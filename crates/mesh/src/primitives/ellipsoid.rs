//! Ellipsoids, cut in three ways.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, ConvertError, Converted, Exec, Options, choice, options};

use super::{FaceList, LENGTH, Platonic, Solid, Sphere, finish, proven};
use crate::{Column, Domain, MeshError, PolyMesh, TEXCOORD};

choice! {
    /// How a sphere is cut into facets.
    pub enum SphereCut {
        /// The faces of an icosahedron, cut into steps squared and put on the sphere: triangles whose areas are
        /// within a factor of about 2.
        Icosphere = "icosphere",
        /// Along meridians and parallels: four times as many meridians as steps, twice as many bands.
        Meridians = "meridians",
        /// The faces of a cube at equal angles (Ronchi, Iacono and Paolucci 1996), each square cut into two triangles.
        CubeSphere = "cube-sphere",
    }
}

options! {
    /// An ellipsoid about the origin with its axes along those of space.
    ///
    /// Vertices and normals are the ellipsoid's own. Texture coordinates are longitude and latitude, from 0 to 1; on a face
    /// across the seam they run beyond 1.
    pub struct Ellipsoid("ellipsoid") {
        required {}
        optional {
            /// Half its extent along x, in model units.
            a: f64 [LENGTH] = 1.0,
            /// Half its extent along y, in model units.
            b: f64 [LENGTH] = 1.0,
            /// Half its extent along z, in model units.
            c: f64 [LENGTH] = 1.0,
            /// How its sphere is cut.
            cut: SphereCut = SphereCut::Icosphere,
            /// How many steps the cut takes.
            steps: u32 [Bounds::closed(1.0, 4096.0)] = 16,
        }
    }
}

impl Ellipsoid {
    /// The facets, triangles but for the quadrilaterals between parallels.
    ///
    /// Facets of the sphere are within its radius less the distance of their planes from the centre, both ways, as rays
    /// from the centre meet each once. The map to the ellipsoid stretches distances by the longest half axis at most, so
    /// the bound is sharp for spheres and up to that generous else.
    ///
    /// # Errors
    /// Options out of bounds; over the memory budget; cancellation.
    pub fn mesh(&self, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        self.validate()?;
        let _memory = exec.reserve_elements(20 * u64::from(self.steps).pow(2), 3 * (4 + 24 + 16) + 24 + 40)?;
        let (unit, starts, corners) = match self.cut {
            SphereCut::Icosphere => icosphere(self.steps, exec)?,
            SphereCut::CubeSphere => cube_sphere(self.steps, exec)?,
            SphereCut::Meridians => {
                let (segments, bands) = (4 * self.steps, 2 * self.steps);
                let sphere = Sphere { radius: 1.0, segments, bands }.mesh(exec)?.value;
                (sphere.positions().to_vec(), sphere.face_starts().to_vec(), sphere.wedge_vertices().to_vec())
            }
        };
        exec.check()?;
        let mut nearest = 1.0f64;
        let (mut normals, mut coordinates) = (Vec::with_capacity(corners.len()), Vec::with_capacity(corners.len()));
        let axes = DVec3::new(self.a, self.b, self.c);
        let longest = axes.max_element();
        for (index, bounds) in starts.windows(2).enumerate() {
            if index % 4096 == 0 {
                exec.check()?;
            }
            let facet = &corners[bounds[0] as usize..bounds[1] as usize];
            let [p, q, r] = [facet[0], facet[1], facet[2]].map(|vertex| unit[vertex as usize]);
            nearest = nearest.min((q - p).cross(r - p).normalize_or_zero().dot(p).abs());
            let directions = || facet.iter().map(|&vertex| unit[vertex as usize]);
            normals.extend(directions().map(|n| (n * (axes.min_element() / axes)).normalize_or_zero()));
            coordinates.extend(longitudes_and_latitudes(directions()));
        }
        let deviation = proven((1.0 - nearest) * longest, longest);
        let positions = unit.iter().map(|&direction| direction * axes).collect();
        let mut made = finish(Self::NAME, positions, (starts, corners), Some(normals), deviation, exec)?;
        let column = Column::texcoords(TEXCOORD, &coordinates);
        made.value.insert_attribute(Domain::Wedge, column).map_err(MeshError::from)?;
        Ok(made)
    }
}

/// From 0 to 1; across the seam beyond 1, so that no face runs back through all of the picture. A pole takes the mean of the
/// others.
fn longitudes_and_latitudes(corners: impl Iterator<Item = DVec3> + Clone) -> Vec<[f64; 2]> {
    let of = |p: DVec3| (p.x != 0.0 || p.y != 0.0).then(|| p.y.atan2(p.x).rem_euclid(TAU) / TAU);
    let most = corners.clone().filter_map(of).fold(0.0, f64::max);
    let turned = |longitude: f64| if most - longitude > 0.5 { longitude + 1.0 } else { longitude };
    let known: Vec<f64> = corners.clone().filter_map(of).map(turned).collect();
    let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
    corners.map(|p| [of(p).map_or(mean, turned), 0.5 + p.z.clamp(-1.0, 1.0).asin() / PI]).collect()
}

type Facets = (Vec<DVec3>, Vec<u32>, Vec<u32>);

fn icosphere(steps: u32, exec: &Exec) -> Result<Facets, ConvertError> {
    let solid = Platonic::new(Solid::Icosahedron).mesh(exec)?.value;
    let corner = |vertex: u32| solid.positions()[vertex as usize].normalize_or_zero();
    let mut unit: Vec<DVec3> = (0..solid.positions().len() as u32).map(corner).collect();
    // Vertices inside the sides of the icosahedron, by its ends and the steps from the lower one.
    let mut on_sides: HashMap<(u32, u32, u32), u32> = HashMap::new();
    let mut faces = FaceList::new();
    for face in solid.faces() {
        let [a, b, c] = [face[0], face[1], face[2]];
        let mut rows: Vec<Vec<u32>> = Vec::new();
        for j in 0..=steps {
            exec.check()?;
            let mut row = Vec::new();
            for i in 0..=steps - j {
                let weights = [(a, steps - i - j), (b, i), (c, j)];
                let mut present = weights.into_iter().filter(|(_, weight)| *weight > 0);
                let vertex = match (present.next(), present.next(), present.next()) {
                    (Some((vertex, _)), None, _) => vertex,
                    (Some(one), Some(other), None) => {
                        let (low, high) = if one.0 < other.0 { (one, other) } else { (other, one) };
                        *on_sides.entry((low.0, high.0, high.1)).or_insert_with(|| {
                            let sum = corner(low.0) * f64::from(low.1) + corner(high.0) * f64::from(high.1);
                            unit.push(sum.normalize_or_zero());
                            unit.len() as u32 - 1
                        })
                    }
                    _ => {
                        let sum: DVec3 = weights.into_iter().map(|(v, weight)| corner(v) * f64::from(weight)).sum();
                        unit.push(sum.normalize_or_zero());
                        unit.len() as u32 - 1
                    }
                };
                row.push(vertex);
            }
            rows.push(row);
        }
        for (low, high) in rows.iter().zip(rows.iter().skip(1)) {
            for i in 0..high.len() {
                faces.push(&[low[i], low[i + 1], high[i]]);
                if i + 1 < high.len() {
                    faces.push(&[low[i + 1], high[i + 1], high[i]]);
                }
            }
        }
    }
    let (starts, corners) = faces.into_parts();
    Ok((unit, starts, corners))
}

fn cube_sphere(steps: u32, exec: &Exec) -> Result<Facets, ConvertError> {
    // Symmetric, and exact in the middle and at the ends.
    let coordinate = |i: u32| match (2 * i).cmp(&steps) {
        std::cmp::Ordering::Equal => 0.0,
        _ if i == 0 || i == steps => {
            if i == 0 {
                -1.0
            } else {
                1.0
            }
        }
        std::cmp::Ordering::Less => -(FRAC_PI_4 * f64::from(steps - 2 * i) / f64::from(steps)).tan(),
        std::cmp::Ordering::Greater => (FRAC_PI_4 * f64::from(2 * i - steps) / f64::from(steps)).tan(),
    };
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut unit = Vec::new();
    let mut faces = FaceList::new();
    for axis in 0..3 {
        for side in [0, steps] {
            let mut vertex = |i: u32, j: u32| {
                let mut place = [0; 3];
                place[axis] = side;
                place[(axis + 1) % 3] = i;
                place[(axis + 2) % 3] = j;
                *known.entry(place).or_insert_with(|| {
                    unit.push(DVec3::from(place.map(coordinate)).normalize_or_zero());
                    unit.len() as u32 - 1
                })
            };
            for j in 0..steps {
                exec.check()?;
                for i in 0..steps {
                    let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| vertex(i + x, j + y));
                    // Diagonals towards the middle of the face are the longer ones.
                    let rising = (2 * i + 1 < steps) == (2 * j + 1 < steps);
                    let triangles = if rising { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
                    for [p, q, r] in triangles {
                        faces.push(&if side == 0 { [p, r, q] } else { [p, q, r] });
                    }
                }
            }
        }
    }
    let (starts, corners) = faces.into_parts();
    Ok((unit, starts, corners))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Deviation;

    const CUTS: [SphereCut; 3] = [SphereCut::Icosphere, SphereCut::Meridians, SphereCut::CubeSphere];

    fn made(cut: SphereCut, steps: u32, axes: [f64; 3]) -> Converted<PolyMesh> {
        let [a, b, c] = axes;
        Ellipsoid { a, b, c, cut, steps }.mesh(&Exec::default()).unwrap()
    }

    #[test]
    fn points_lie_on_the_ellipsoid_and_volumes_converge_at_second_order() {
        let axes = [3.0, 2.0, 0.5];
        let volume = 4.0 / 3.0 * PI * 3.0;
        for cut in CUTS {
            let missing = [8, 16, 32].map(|steps| {
                let mesh = made(cut, steps, axes).value;
                for p in mesh.positions() {
                    let value = (*p / DVec3::from(axes)).length_squared();
                    assert!((value - 1.0).abs() < 1e-15, "{value}");
                }
                volume - mesh.volume()
            });
            for pair in missing.windows(2) {
                assert!(pair[1] > 0.0 && (pair[0] / pair[1] - 4.0).abs() < 0.1, "{cut:?} {missing:?}");
            }
            // The sphere's area, too.
            let short = [8, 16].map(|steps| 4.0 * PI - made(cut, steps, [1.0; 3]).value.area());
            assert!(short[1] > 0.0 && (short[0] / short[1] - 4.0).abs() < 0.1, "{cut:?} {short:?}");
        }
    }

    /// Closed and manifold: every side twice, once each way; V − E + F = 2; valences as they must be.
    #[test]
    fn cuts_are_closed_with_their_valences() {
        for cut in CUTS {
            for steps in [1, 2, 3, 7] {
                let mesh = made(cut, steps, [1.0, 2.0, 3.0]).value;
                let mut sides = std::collections::HashSet::new();
                let mut valence = vec![0u32; mesh.positions().len()];
                for face in mesh.faces() {
                    for (i, &a) in face.iter().enumerate() {
                        assert!(sides.insert((a, face[(i + 1) % face.len()])), "a side twice the same way");
                        valence[a as usize] += 1;
                    }
                }
                assert!(sides.iter().all(|&(a, b)| sides.contains(&(b, a))));
                let (v, e, f) = (mesh.positions().len(), sides.len() / 2, mesh.face_count());
                assert_eq!(v + f, e + 2, "{cut:?} {steps}");
                let n = steps as usize;
                match cut {
                    SphereCut::Icosphere => {
                        assert_eq!((v, f), (10 * n * n + 2, 20 * n * n));
                        assert_eq!(valence.iter().filter(|&&k| k == 5).count(), 12);
                        assert!(valence.iter().all(|&k| k == 5 || k == 6));
                    }
                    SphereCut::CubeSphere => assert_eq!((v, f), (6 * n * n + 2, 12 * n * n)),
                    SphereCut::Meridians => assert_eq!(v, 4 * n * (2 * n - 1) + 2),
                }
                assert!(mesh.volume() > 0.0);
            }
        }
    }

    /// Never violated by dense sampling, and not more than 4 times too large on a sphere; normals point outward.
    #[test]
    fn bounds_hold_and_are_sharp_on_spheres() {
        for cut in CUTS {
            for (steps, axes) in [(1, [1.0; 3]), (4, [2.0; 3]), (7, [5.0; 3]), (5, [1.0, 2.0, 3.0])] {
                let Converted { value: mesh, report } = made(cut, steps, axes);
                let Deviation::AtMost(bound) = report.deviation else { panic!("a bound") };
                let mut farthest = 0.0f64;
                for face in 0..mesh.face_count() {
                    let outline: Vec<DVec3> = mesh.outline(face).collect();
                    let normal = crate::newell_vector(outline.iter().copied());
                    assert!(normal.dot(outline[0]) > 0.0);
                    for k in 0..=20 {
                        for l in 0..=20 - k {
                            let (s, t) = (f64::from(k) / 20.0, f64::from(l) / 20.0);
                            let p = outline[0] + (outline[1] - outline[0]) * s + (outline[2] - outline[0]) * t;
                            // On a sphere the distance; else no less than it.
                            let direction = p / DVec3::from(axes);
                            let over = (direction.normalize() * DVec3::from(axes)).distance(p);
                            farthest = farthest.max(over);
                        }
                    }
                }
                assert!(farthest <= bound, "{cut:?} {steps} {farthest} {bound}");
                assert!(axes[0] != axes[1] || bound < 1.6 * farthest, "{cut:?} {steps} {farthest} {bound}");
            }
        }
    }

    #[test]
    fn texture_never_runs_back() {
        for cut in CUTS {
            let mesh = made(cut, 6, [1.0; 3]).value;
            let texture = mesh.attribute(Domain::Wedge, TEXCOORD).unwrap();
            for face in 0..mesh.face_count() {
                let u: Vec<f64> = mesh.wedges(face).map(|wedge| texture.number(wedge, 0)).collect();
                let spread = u.iter().copied().fold(f64::MIN, f64::max) - u.iter().copied().fold(f64::MAX, f64::min);
                assert!(spread <= 0.5, "{cut:?} {u:?}");
            }
        }
        assert!(Ellipsoid { steps: 0, ..Ellipsoid::new() }.mesh(&Exec::default()).is_err());
        let small = Exec::default().with_memory(1000);
        assert!(Ellipsoid { steps: 4096, ..Ellipsoid::new() }.mesh(&small).is_err());
    }

    #[test]
    fn triangles_of_icospheres_are_within_a_factor_of_two() {
        let mesh = made(SphereCut::Icosphere, 40, [1.0; 3]).value;
        let areas = (0..mesh.face_count()).map(|face| crate::newell_vector(mesh.outline(face)).length());
        let (least, most) = areas.fold((f64::MAX, 0.0), |(low, high), area| (area.min(low), area.max(high)));
        assert!(most / least > 1.7 && most / least < 2.1, "{}", most / least);
    }

    #[test]
    fn polls_are_as_many_as_facets() {
        for cut in CUTS {
            let ellipsoid = Ellipsoid { cut, steps: 100, ..Ellipsoid::new() };
            let facets = ellipsoid.mesh(&Exec::default()).unwrap().value.face_count() as u64;
            let sphere = Sphere { radius: 1.0, segments: 400, bands: 200 };
            let before = if cut == SphereCut::Meridians {
                crate::poll_count::polls(&|exec| drop(sphere.mesh(exec).unwrap()))
            } else {
                6 * 100
            };
            let polls = crate::poll_count::polls(&|exec| drop(ellipsoid.mesh(exec).unwrap()));
            assert!(polls >= before + facets / 4096, "{cut:?} {polls}");
        }
    }
}
