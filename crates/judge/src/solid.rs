//! Where a point lies relative to a closed mesh, exactly.

use std::cmp::Ordering;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};
use shapeloom_core::{Aabb, Exec, Reservation};
use shapeloom_mesh::TriMesh;

use crate::columns::Columns;
use crate::{JudgeError, Scaled};

/// Where a point lies relative to triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// On this triangle, the smallest of those that it lies on.
    On(u32),
    /// On none; the surface winds around it that often. For a closed mesh with faces outward: 1 inside, 0 outside, less than
    /// 0 inside a shell that is inside out.
    Off {
        /// The winding number.
        winding: i64,
    },
}

impl Location {
    /// Whether the point is inside: the surface winds around it.
    pub fn is_inside(self) -> bool {
        matches!(self, Self::Off { winding } if winding != 0)
    }
}

/// The triangles of a mesh, prepared to say exactly where points lie.
///
/// A point's winding number is the sum of the signed crossings of a ray along +x. The ray is moved by less than anything so
/// that it meets no edge and no vertex; every decision is the sign of a determinant in exact arithmetic. The answer is right
/// for every closed mesh, whatever it crosses. For an open one it counts the crossings of that ray and no more.
///
/// Cost: about the triangles that one of √n × √n columns along x holds, for n triangles; 24 bytes a vertex and up to 40 a
/// triangle.
#[derive(Debug)]
pub struct Solid<'a> {
    triangles: &'a [[u32; 3]],
    positions: Vec<DVec3>,
    bounds: Aabb,
    exponent: i32,
    columns: Columns,
    _memory: Reservation,
}

impl<'a> Solid<'a> {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// A position that is not finite or loses bits (see [`Scaled`]), or the memory budget.
    pub fn new(mesh: &'a TriMesh, exec: &Exec) -> Result<Self, JudgeError> {
        let memory = exec.reserve_elements(mesh.positions().len() as u64, size_of::<DVec3>())?;
        let Scaled { positions, exponent } = Scaled::new(mesh.positions())?;
        let corners = mesh.triangles().as_flattened().iter();
        let bounds = Aabb::from_points(corners.map(|&vertex| mesh.positions()[vertex as usize]));
        let columns = Columns::new(mesh.triangles(), &positions, exec)?;
        Ok(Self { triangles: mesh.triangles(), positions, bounds, exponent, columns, _memory: memory })
    }

    /// Six times the signed volume under some triangles to one of their corners, on the scale of the mesh, in floating point.
    pub(crate) fn volume_of(&self, triangles: &[u32]) -> f64 {
        let corners = |triangle: u32| self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize]);
        let Some(&first) = triangles.first() else { return 0.0 };
        let center = corners(first)[0];
        let under = |&triangle: &u32| {
            let [a, b, c] = corners(triangle).map(|corner| corner - center);
            a.dot(b.cross(c))
        };
        triangles.iter().map(under).sum()
    }

    /// Where a point lies relative to the mesh.
    ///
    /// # Errors
    /// A point that is not finite, or loses bits on the mesh's scale. Points outside the mesh's box are outside, whatever
    /// their bits.
    pub fn locate(&self, point: DVec3) -> Result<Location, JudgeError> {
        if point.is_finite() && !self.bounds.contains(point) {
            return Ok(Location::Off { winding: 0 });
        }
        let point = Scaled::point(point, self.exponent).ok_or(JudgeError::Query { found: point })?;
        let (mut on, mut winding) = (None, 0);
        self.each_met(point, |triangle, met| match met {
            Met::On => on = Some(on.map_or(triangle, |before: u32| before.min(triangle))),
            Met::Ahead(turns) => winding += turns,
        });
        Ok(on.map_or(Location::Off { winding }, Location::On))
    }

    /// The position of a vertex on the mesh's scale.
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    /// Calls `visit` with each triangle that a point on the mesh's scale lies on, and with those that a ray from it along
    /// +x passes through; rising.
    pub(crate) fn each_met(&self, point: DVec3, mut visit: impl FnMut(u32, Met)) {
        for &triangle in self.columns.around(point) {
            let [a, b, c] = self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            if point.y < low.y || point.y > high.y || point.z < low.z || point.z > high.z || point.x > high.x {
                continue;
            }
            let turns = turns_around(point, [a, b, c]);
            let near = point.x >= low.x;
            if turns == 0 && !near {
                continue;
            }
            // Beyond the box along x the side is known.
            let side = if near { orient3d(a, b, c, point) } else { Ordering::Greater };
            if near && side == Ordering::Equal {
                if in_triangle(point, [a, b, c]) {
                    visit(triangle, Met::On);
                }
                continue;
            }
            // The plane lies ahead if the point is behind it as the ray sees it.
            if turns != 0 && (!near || (side == Ordering::Less) == (turns > 0)) {
                visit(triangle, Met::Ahead(turns));
            }
        }
    }
}

/// How a point and the ray from it along +x meet a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Met {
    /// The point is on it.
    On,
    /// The ray passes through, out of the surface or into it.
    Ahead(i64),
}

/// How often the triangle, seen along −x, runs around the point, which is moved by less than anything towards −z and by less
/// than that towards +y.
fn turns_around(point: DVec3, corners: [DVec3; 3]) -> i64 {
    let flat = |p: DVec3| DVec2::new(p.y, p.z);
    let place = flat(point);
    let mut turns = 0;
    for k in 0..3 {
        let (u, v) = (flat(corners[k]), flat(corners[(k + 1) % 3]));
        let up = u.y <= place.y && place.y < v.y;
        let down = v.y <= place.y && place.y < u.y;
        // A point on the side is moved to its right where it runs up, the same for both triangles there.
        if up && orient2d(u, v, place) == Ordering::Greater {
            turns += 1;
        } else if down && orient2d(u, v, place) == Ordering::Less {
            turns -= 1;
        }
    }
    turns
}

/// Whether a point in the plane of a triangle, or any if it has none, lies in the closed triangle.
fn in_triangle(point: DVec3, corners: [DVec3; 3]) -> bool {
    // In a projection that keeps the plane a plane the sides tell; one that flattens it says yes wherever the truth is yes.
    // A triangle without area is the union of its sides, and all of its projections are flat.
    [[0, 1], [1, 2], [2, 0]].into_iter().all(|[i, j]| {
        let flat = |p: DVec3| DVec2::new(p[i], p[j]);
        let (corners, point) = (corners.map(flat), flat(point));
        let low = corners[0].min(corners[1]).min(corners[2]);
        let high = corners[0].max(corners[1]).max(corners[2]);
        let signs = [0, 1, 2].map(|k| orient2d(corners[k], corners[(k + 1) % 3], point));
        let mixed = signs.contains(&Ordering::Less) && signs.contains(&Ordering::Greater);
        !mixed && point.cmpge(low).all() && point.cmple(high).all()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(size: f64) -> TriMesh {
        let positions = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * size);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::try_new(positions.collect(), triangles).unwrap()
    }

    #[test]
    fn every_lattice_point_about_a_cube_is_where_it_is() {
        for scale in [1.0, 2f64.powi(-900), 2f64.powi(900)] {
            let cube = cube(4.0 * scale);
            let solid = Solid::new(&cube, &Exec::default()).unwrap();
            for code in 0..9i32.pow(3) {
                let at = [code % 9, code / 9 % 9, code / 81].map(|x| x - 2);
                let inside = at.iter().all(|x| (1..4).contains(x));
                let outside = at.iter().any(|x| !(0..=4).contains(x));
                let found = solid.locate(DVec3::from_array(at.map(f64::from)) * scale).unwrap();
                match found {
                    Location::On(_) => assert!(!inside && !outside, "{at:?}"),
                    Location::Off { winding } => {
                        assert!(inside != outside, "{at:?}");
                        assert_eq!(winding, i64::from(inside), "{at:?}");
                    }
                }
            }
        }
    }

    /// The winding number as the sum of solid angles (Van Oosterom and Strackee 1983), in floating point.
    fn by_angles(mesh: &TriMesh, point: DVec3) -> f64 {
        let angle = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle).map(|corner| corner - point);
            let [x, y, z] = [a, b, c].map(DVec3::length);
            2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
        };
        (0..mesh.triangles().len()).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }

    /// Closed surfaces that cross themselves, wind twice and lie inside out, on a lattice so that rays meet edges and
    /// vertices all the time.
    #[test]
    fn agrees_with_solid_angles_on_closed_lattice_meshes() {
        let mut state = 3u64;
        let mut draw = |top: i32| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) as i32 % top
        };
        let (mut off, mut on) = (0, 0);
        for _ in 0..400 {
            let mut mesh = cube(1.0);
            for position in mesh.positions_mut() {
                *position = DVec3::new(f64::from(draw(4)), f64::from(draw(4)), f64::from(draw(4)));
            }
            let solid = Solid::new(&mesh, &Exec::default()).unwrap();
            for _ in 0..60 {
                let point = DVec3::new(f64::from(draw(7)), f64::from(draw(7)), f64::from(draw(7))) * 0.5;
                match solid.locate(point).unwrap() {
                    Location::Off { winding } => {
                        assert!((by_angles(&mesh, point) - winding as f64).abs() < 1e-9, "{point} {mesh:?}");
                        off += 1;
                    }
                    Location::On(triangle) => {
                        let holds = |triangle: &usize| {
                            // Whole numbers: the point is on the plane and on the inner side of every side, or on a side.
                            let corners = mesh.corners(*triangle);
                            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                            let sides = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
                            let inner = |[a, b]: &[DVec3; 2]| normal.dot((*b - *a).cross(point - *a)) >= 0.0;
                            let along = |[a, b]: &[DVec3; 2]| {
                                (*b - *a).cross(point - *a) == DVec3::ZERO && (point - *a).dot(point - *b) <= 0.0
                            };
                            let inside = normal != DVec3::ZERO
                                && normal.dot(point - corners[0]) == 0.0
                                && sides.iter().all(inner);
                            inside || sides.iter().any(along)
                        };
                        assert_eq!(
                            (0..mesh.triangles().len()).find(holds),
                            Some(triangle as usize),
                            "{point} {mesh:?}"
                        );
                        on += 1;
                    }
                }
            }
        }
        assert!(off > 5000 && on > 2000, "{off} {on}");
    }

    #[test]
    fn wild_queries_are_refused() {
        let cube = cube(1.0);
        let solid = Solid::new(&cube, &Exec::default()).unwrap();
        assert!(matches!(solid.locate(DVec3::NAN), Err(JudgeError::Query { .. })));
        assert!(matches!(solid.locate(DVec3::new(0.5, 1e-200, 0.5)), Err(JudgeError::Query { .. })));
        assert_eq!(solid.locate(DVec3::new(1e300, 1e-200, 0.5)), Ok(Location::Off { winding: 0 }));
        let nothing = TriMesh::default();
        assert!(!Solid::new(&nothing, &Exec::default()).unwrap().locate(DVec3::ZERO).unwrap().is_inside());
    }
}
