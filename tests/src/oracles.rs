//! Distances by brute force, sharing nothing with the crates but their vectors.

use shapeloom::core::glam::DVec3;
use shapeloom::isosurface::{Inside, Slabs};
use shapeloom::mesh::{HeightField, PolyMesh, TriMesh};
use shapeloom::shape::Geometry;
use shapeloom::voxels::VoxelGrid;

/// The distance from a point to a segment.
pub fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let length = along.length_squared();
    let t = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + along * t)
}

/// The distance from a point to a triangle.
pub fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let left = |from: DVec3, to: DVec3| normal.cross(to - from).dot(p - from) >= 0.0;
    if normal.length_squared() > 0.0 && left(a, b) && left(b, c) && left(c, a) {
        return (p - a).dot(normal.normalize()).abs();
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}

/// The straight pieces that a geometry is made of.
pub enum Pieces {
    Triangles(Vec<[DVec3; 3]>),
    Segments(Vec<[DVec3; 2]>),
    Points(Vec<DVec3>),
}

impl Pieces {
    pub fn of(geometry: &Geometry) -> Option<Self> {
        match geometry {
            Geometry::TriMesh(mesh) => Some(Self::Triangles(triangles(mesh))),
            Geometry::PolyMesh(mesh) => Some(Self::Triangles(fans(mesh))),
            Geometry::Polyline(line) => Some(Self::Segments(line.segments().collect())),
            Geometry::GeometricGraph(graph) => Some(Self::Segments(graph.segments().collect())),
            Geometry::PointCloud(cloud) => Some(Self::Points(cloud.positions().to_vec())),
            _ => None,
        }
    }

    /// The distance from a point, by trying every piece.
    pub fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Triangles(all) => all.iter().map(|&t| to_triangle(p, t)).fold(f64::INFINITY, f64::min),
            Self::Segments(all) => all.iter().map(|&[a, b]| to_segment(p, a, b)).fold(f64::INFINITY, f64::min),
            Self::Points(all) => all.iter().map(|&q| p.distance(q)).fold(f64::INFINITY, f64::min),
        }
    }

    /// Points spread over the pieces: corners, middles of sides, and a lattice inside.
    pub fn samples(&self) -> Vec<DVec3> {
        match self {
            Self::Points(points) => points.clone(),
            Self::Segments(all) => {
                all.iter().flat_map(|[a, b]| (0..=4).map(|k| a.lerp(*b, f64::from(k) / 4.0))).collect()
            }
            Self::Triangles(all) => {
                let weights = [
                    [1.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0],
                    [0.0, 0.0, 1.0],
                    [0.5, 0.5, 0.0],
                    [0.0, 0.5, 0.5],
                    [0.5, 0.0, 0.5],
                    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
                ];
                let mix = |t: &[DVec3; 3], w: [f64; 3]| t[0] * w[0] + t[1] * w[1] + t[2] * w[2];
                all.iter().flat_map(|t| weights.map(|w| mix(t, w))).collect()
            }
        }
    }
}

pub fn triangles(mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    mesh.triangles().iter().map(|triangle| triangle.map(|vertex| mesh.positions()[vertex as usize])).collect()
}

/// The fan of each face from its first corner: the face itself where it is convex and flat.
fn fans(mesh: &PolyMesh) -> Vec<[DVec3; 3]> {
    let at = |vertex: u32| mesh.positions()[vertex as usize];
    mesh.faces()
        .flat_map(|face| (1..face.len() - 1).map(move |k| [at(face[0]), at(face[k]), at(face[k + 1])]))
        .collect()
}

/// Points of a geometry itself, by its definition and not by any converter: Bernstein sums, bilinear cells.
pub fn samples(geometry: &Geometry) -> Vec<DVec3> {
    match geometry {
        Geometry::BezierCurve(curve) => {
            (0..=400).map(|k| bernstein(curve.control_points(), f64::from(k) / 400.0)).collect()
        }
        Geometry::BezierSurface(surface) => {
            let mut points = Vec::new();
            for patch in &surface.patches {
                let width = patch.degree_u() + 1;
                const STEPS: u32 = 24;
                for j in 0..=STEPS {
                    for i in 0..=STEPS {
                        let (u, v) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
                        let rows: Vec<DVec3> =
                            patch.control_points().chunks_exact(width).map(|row| bernstein(row, u)).collect();
                        points.push(bernstein(&rows, v));
                    }
                }
            }
            points
        }
        Geometry::HeightField(field) => bilinear(field),
        Geometry::VoxelGrid(grid) => trilinear_surface(grid),
        other => Pieces::of(other).map_or(Vec::new(), |pieces| pieces.samples()),
    }
}

/// The Bernstein form, term by term.
pub fn bernstein(control: &[DVec3], t: f64) -> DVec3 {
    let n = control.len() - 1;
    let mut binomial = 1.0;
    let mut sum = DVec3::ZERO;
    for (i, &point) in control.iter().enumerate() {
        sum += point * (binomial * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32));
        binomial *= (n - i) as f64 / (i + 1) as f64;
    }
    sum
}

/// Points where the trilinear interpolant of a grid reaches its iso value, on lines through each cell, and places of the border
/// that are inside.
pub fn trilinear_surface(grid: &VoxelGrid) -> Vec<DVec3> {
    const LINES: u32 = 4;
    let [nx, ny, nz] = grid.lattice().dimensions();
    let iso = grid.default_iso().expect("a grid that says where its surface is");
    let sign = if grid.inside() == Inside::Below { 1.0 } else { -1.0 };
    let mut points = Vec::new();
    let cells = (0..nz - 1).flat_map(|k| (0..ny - 1).flat_map(move |j| (0..nx - 1).map(move |i| [i, j, k])));
    for [i, j, k] in cells {
        let corner = |c: u32| f64::from(grid.sample([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)]));
        // The interpolant is between its corners: cells of one side only have nothing but the border.
        let inside = (0..8).filter(|&c| sign * (corner(c) - iso) < 0.0).count();
        let at_border = [i, j, k].contains(&0) || [i + 2 == nx, j + 2 == ny, k + 2 == nz].contains(&true);
        if inside == 0 || (inside == 8 && !at_border) {
            continue;
        }
        let value = |at: DVec3| {
            let weight = |c: u32| {
                let part = |bit: u32, x: f64| if c >> bit & 1 == 1 { x } else { 1.0 - x };
                part(0, at.x) * part(1, at.y) * part(2, at.z)
            };
            sign * ((0..8).map(|c| weight(c) * corner(c)).sum::<f64>() - iso)
        };
        let place = |at: DVec3| {
            let base = DVec3::new(f64::from(i), f64::from(j), f64::from(k));
            grid.lattice().placement().point(base + at)
        };
        for axis in 0..3 {
            for line in 0..(LINES + 1) * (LINES + 1) {
                let mut at = DVec3::ZERO;
                at[(axis + 1) % 3] = f64::from(line % (LINES + 1)) / f64::from(LINES);
                at[(axis + 2) % 3] = f64::from(line / (LINES + 1)) / f64::from(LINES);
                // Along a line parallel to an edge the interpolant is linear.
                let end = at + DVec3::AXES[axis];
                let (a, b) = (value(at), value(end));
                if (a < 0.0) != (b < 0.0) {
                    points.push(place(at.lerp(end, a / (a - b))));
                }
                let (low, high) = ([i, j, k][axis] == 0, [i, j, k][axis] + 2 == [nx, ny, nz][axis]);
                points.extend((low && a < 0.0).then(|| place(at)));
                points.extend((high && b < 0.0).then(|| place(end)));
            }
        }
    }
    points
}

fn bilinear(field: &HeightField) -> Vec<DVec3> {
    let mut points = Vec::new();
    for row in 0..field.rows() - 1 {
        for column in 0..field.columns() - 1 {
            let corner = |i: u32, j: u32| field.sample(column + i, row + j);
            let (Some(a), Some(b), Some(c), Some(d)) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)) else {
                continue;
            };
            for k in 0..25 {
                let (s, t) = (f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
                points.push(a.lerp(b, s).lerp(d.lerp(c, s), t));
            }
        }
    }
    points
}

/// No less than the distance from a point to a curved geometry: descent from the nearest of many samples for curves and
/// patches, straight up or down for height fields. None for geometry that is made of straight pieces.
pub fn to_curved(geometry: &Geometry, p: DVec3) -> Option<f64> {
    match geometry {
        Geometry::BezierCurve(curve) => {
            let at = |[t, _]: [f64; 2]| bernstein(curve.control_points(), t);
            Some(descend(&at, p, (0..=64).map(|k| [f64::from(k) / 64.0, 0.0])))
        }
        Geometry::BezierSurface(surface) => {
            let nearest = surface.patches.iter().filter(|patch| !patch.control_points().is_empty()).map(|patch| {
                let width = patch.degree_u() + 1;
                let at = move |[u, v]: [f64; 2]| {
                    let rows: Vec<DVec3> =
                        patch.control_points().chunks_exact(width).map(|row| bernstein(row, u)).collect();
                    bernstein(&rows, v)
                };
                let grid = (0..81).map(|k| [f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0]);
                (patch.hull_bounds().distance_squared(p).sqrt(), at, grid)
            });
            let mut candidates: Vec<_> = nearest.collect();
            candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut best = f64::INFINITY;
            for (lower, at, grid) in candidates {
                if lower < best {
                    best = best.min(descend(&at, p, grid));
                }
            }
            Some(best)
        }
        Geometry::HeightField(field) => {
            let (x, y) = (p.x / field.spacing().x, p.y / field.spacing().y);
            let column = (x.floor() as u32).min(field.columns() - 2);
            let row = (y.floor() as u32).min(field.rows() - 2);
            let height = |i: u32, j: u32| field.sample(column + i, row + j).map(|sample| sample.z);
            let (s, t) = (x - f64::from(column), y - f64::from(row));
            let mix = |a: f64, b: f64, k: f64| a * (1.0 - k) + b * k;
            let corners = [height(0, 0), height(1, 0), height(0, 1), height(1, 1)];
            let [Some(a), Some(b), Some(c), Some(d)] = corners else {
                // Nothing may lie over a hole but the borders of the cells around it.
                let on_border = s == 0.0 || t == 0.0 || s == 1.0 || t == 1.0;
                return Some(if on_border { 0.0 } else { f64::INFINITY });
            };
            // Outside the grid the way goes on from its border.
            let (ns, nt) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
            let up = (p.z - mix(mix(a, b, ns), mix(c, d, ns), nt)).abs();
            let aside = ((s - ns) * field.spacing().x).hypot((t - nt) * field.spacing().y);
            Some(up.hypot(aside))
        }
        _ => None,
    }
}

/// The smallest distance found on the ways down from the nearest starts.
fn descend(at: &impl Fn([f64; 2]) -> DVec3, p: DVec3, starts: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut starts: Vec<(f64, [f64; 2])> = starts.map(|start| (at(start).distance(p), start)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A surface that comes near more than once has several ways down.
    starts.into_iter().take(6).map(|start| descend_from(at, p, start)).fold(f64::INFINITY, f64::min)
}

/// Pattern search: to the best neighbour, or half the step where none is better. Slow, and needs no slopes.
fn descend_from(at: &impl Fn([f64; 2]) -> DVec3, p: DVec3, (mut best, mut here): (f64, [f64; 2])) -> f64 {
    let mut step = 0.125;
    while step > 1e-9 {
        let around = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
        let moved = |(i, j): (i32, i32)| {
            [(here[0] + f64::from(i) * step).clamp(0.0, 1.0), (here[1] + f64::from(j) * step).clamp(0.0, 1.0)]
        };
        let tried = around.map(moved).map(|there| (at(there).distance(p), there));
        let least = tried.into_iter().fold((best, here), |least, new| if new.0 < least.0 { new } else { least });
        if least.0 < best {
            (best, here) = least;
        } else {
            step /= 2.0;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oracle_knows_faces_sides_and_corners() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (p, wanted) in [
            (DVec3::new(0.2, 0.2, 3.0), 3.0),
            (DVec3::new(0.5, -2.0, 0.0), 2.0),
            (DVec3::new(-3.0, -4.0, 0.0), 5.0),
            (DVec3::new(1.0, 1.0, 0.0), 0.5f64.sqrt()),
        ] {
            assert!((to_triangle(p, t) - wanted).abs() < 1e-15);
        }
    }
}
