//! What the tree knows of a cluster of triangles: moments of its area vectors about a centre.

use glam::DVec3;
use shapeloom_core::Aabb;

/// Moments of a cluster about its centre, in local units.
///
/// With `d` the place relative to the centre and `n` the unit normal, integrated over the triangles: `dipole[v] = ∫
/// n·v`, `first[v, v] = ∫ (n·v)(d·v)`, `second[v, v, v] = ½ ∫ (n·v)(d·v)²`, kept as homogeneous polynomials in `v`,
/// which is all that the winding number asks of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    /// A point whose coordinates are `f32` numbers.
    pub center: DVec3,
    /// Every triangle lies within it of the centre.
    pub radius: f64,
    /// Not below the area.
    pub area: f64,
    /// `∫ d`.
    pub offset: DVec3,
    /// `∫ |d|²`, not below.
    pub square: f64,
    /// `∫ |d|³`, not below.
    pub cube: f64,
    pub bounds: Aabb,
    pub dipole: [f64; 3],
    /// Coefficients of xx, yy, zz, xy, xz, yz.
    pub first: [f64; 6],
    /// Coefficients of xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz.
    pub second: [f64; 10],
}

/// What keeps a bound a bound through the few roundings of its computation.
const UP: f64 = 1.0 + 1e-12;

/// Clusters count as this large at least, so that places keep 24 bits beside any radius. In local units.
const LEAST_RADIUS: f64 = 1.0 / (1u64 << 30) as f64;

impl Cluster {
    /// The cluster of some triangles, given by their corners in scaled units; local units are these about `origin`.
    ///
    /// Sides are taken before the origin is: a triangle that is tiny beside its distance to the origin keeps its area.
    pub fn of_triangles(triangles: &[[DVec3; 3]], origin: DVec3) -> Self {
        let bounds = Aabb::from_points(triangles.iter().flatten().map(|&corner| corner - origin));
        let weigh = |corners: &[DVec3; 3]| {
            let [a, b, c] = *corners;
            let normal = (b - a).cross(c - a) * 0.5;
            // Slivers count a little more than their area, to hold the rounding of their normal.
            (normal, normal.length() + (b - a).length() * (c - a).length() * 2f64.powi(-24))
        };
        let area: f64 = triangles.iter().map(|corners| weigh(corners).1).sum();
        let local = |corners: &[DVec3; 3]| corners.map(|corner| corner - origin);
        let middle = |corners: &[DVec3; 3]| local(corners).into_iter().sum::<DVec3>() / 3.0;
        let weighted = triangles.iter().fold(DVec3::ZERO, |sum, corners| sum + middle(corners) * weigh(corners).1);
        let center = single(if area > 0.0 { weighted / area } else { bounds.center() });
        let mut cluster = Self { center, bounds, ..Self::NOTHING };
        for corners in triangles {
            let (normal, area) = weigh(corners);
            cluster.add_triangle(&local(corners).map(|corner| corner - center), normal, area);
        }
        cluster.radius = (cluster.radius * UP).max(LEAST_RADIUS);
        cluster.square *= UP;
        cluster.cube = cluster.cube.min(cluster.radius * cluster.square) * UP;
        cluster
    }

    const NOTHING: Self = Self {
        center: DVec3::ZERO,
        radius: 0.0,
        area: 0.0,
        offset: DVec3::ZERO,
        square: 0.0,
        cube: 0.0,
        bounds: Aabb::EMPTY,
        dipole: [0.0; 3],
        first: [0.0; 6],
        second: [0.0; 10],
    };

    fn add_triangle(&mut self, d: &[DVec3; 3], normal: DVec3, area: f64) {
        let sum = d[0] + d[1] + d[2];
        let lengths = d.map(DVec3::length);
        self.radius = lengths.into_iter().fold(self.radius, f64::max);
        self.area += area;
        self.offset += sum / 3.0 * area;
        self.square += area / 12.0 * (d[0].length_squared() + d[1].length_squared() + d[2].length_squared());
        self.square += area / 12.0 * sum.length_squared();
        // A convex function is at most the mean of its corners.
        self.cube += area / 3.0 * lengths.into_iter().map(|length| length * length * length).sum::<f64>();
        for axis in 0..3 {
            self.dipole[axis] += normal[axis];
        }
        // ∫ d_j d_k over a triangle is area / 12 of (the corners' products and the product of their sum).
        self.add_product(normal, sum / 3.0);
        for v in [d[0], d[1], d[2], sum] {
            self.add_square(normal, v, 0.5 / 12.0);
        }
    }

    /// Adds `(n·v)(d·v)` to the first moment.
    fn add_product(&mut self, n: DVec3, d: DVec3) {
        let terms =
            [n.x * d.x, n.y * d.y, n.z * d.z, n.x * d.y + n.y * d.x, n.x * d.z + n.z * d.x, n.y * d.z + n.z * d.y];
        for (sum, term) in self.first.iter_mut().zip(terms) {
            *sum += term;
        }
    }

    /// Adds `scale (n·v)(d·v)²` to the second moment.
    fn add_square(&mut self, n: DVec3, d: DVec3, scale: f64) {
        let square =
            [d.x * d.x, d.y * d.y, d.z * d.z, 2.0 * d.x * d.y, 2.0 * d.x * d.z, 2.0 * d.y * d.z].map(|q| q * scale);
        self.add_cubic(n, &square);
    }

    /// Adds the product of `n·v` and a quadratic polynomial to the second moment.
    fn add_cubic(&mut self, n: DVec3, q: &[f64; 6]) {
        let [xx, yy, zz, xy, xz, yz] = *q;
        let terms = [
            n.x * xx,
            n.y * yy,
            n.z * zz,
            n.x * xy + n.y * xx,
            n.x * xz + n.z * xx,
            n.y * xy + n.x * yy,
            n.y * yz + n.z * yy,
            n.z * xz + n.x * zz,
            n.z * yz + n.y * zz,
            n.x * yz + n.y * xz + n.z * xy,
        ];
        for (sum, term) in self.second.iter_mut().zip(terms) {
            *sum += term;
        }
    }

    /// The cluster of some clusters together.
    pub fn of_clusters(parts: &[Self]) -> Self {
        let bounds = parts.iter().fold(Aabb::EMPTY, |bounds, part| bounds.union(part.bounds));
        let area: f64 = parts.iter().map(|part| part.area).sum();
        let weighted = parts.iter().fold(DVec3::ZERO, |sum, part| sum + part.offset + part.center * part.area);
        let center = single(if area > 0.0 { weighted / area } else { bounds.center() });
        let mut whole = Self { center, bounds, ..Self::NOTHING };
        for part in parts {
            whole.add_cluster(part);
        }
        let corner = (center - bounds.min).abs().max((bounds.max - center).abs());
        whole.radius = (whole.radius.min(corner.length()) * UP).max(LEAST_RADIUS);
        whole.square *= UP;
        whole.cube = whole.cube.min(whole.radius * whole.square) * UP;
        whole
    }

    /// Adds a part, moved to this centre: with `d + s` for `d` each moment takes lower ones of the part along.
    fn add_cluster(&mut self, part: &Self) {
        let s = part.center - self.center;
        let length = s.length();
        self.radius = self.radius.max(length + part.radius);
        self.area += part.area;
        self.offset += part.offset + s * part.area;
        self.square += (part.square + 2.0 * s.dot(part.offset) + length * length * part.area).max(0.0);
        // Minkowski's inequality in the space of cubes.
        let moved = part.cube.cbrt() + length * part.area.cbrt();
        let square = (part.square + 2.0 * s.dot(part.offset) + length * length * part.area).max(0.0);
        self.cube += (moved * moved * moved).min((length + part.radius) * square * UP);
        let dipole = DVec3::from_array(part.dipole);
        for axis in 0..3 {
            self.dipole[axis] += part.dipole[axis];
        }
        for (sum, term) in self.first.iter_mut().zip(part.first) {
            *sum += term;
        }
        self.add_product(dipole, s);
        for (sum, term) in self.second.iter_mut().zip(part.second) {
            *sum += term;
        }
        self.add_cubic(s, &part.first);
        self.add_square(dipole, s, 0.5);
    }

    /// The first moment times −3, without its trace: coefficients of xx − zz, yy − zz, xy, xz, yz.
    pub fn quadrupole(&self) -> [f64; 5] {
        let [xx, yy, zz, xy, xz, yz] = self.first;
        let third = (xx + yy + zz) / 3.0;
        [xx - third, yy - third, xy, xz, yz].map(|q| -3.0 * q)
    }

    /// The second moment times 15, without its trace: coefficients of 3yyx − xxx, 3zzx − xxx, 3xxy − yyy, 3zzy − yyy,
    /// 3xxz − zzz, 3yyz − zzz and xyz.
    pub fn octupole(&self) -> [f64; 7] {
        let [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz] = self.second;
        // Entries of the symmetric tensor are a third of the mixed coefficients.
        let fifth =
            [xxx + (yyx + zzx) / 3.0, yyy + (xxy + zzy) / 3.0, zzz + (xxz + yyz) / 3.0].map(|trace| trace / 5.0);
        let [x, y, z] = fifth;
        [yyx / 3.0 - x, zzx / 3.0 - x, xxy / 3.0 - y, zzy / 3.0 - y, xxz / 3.0 - z, yyz / 3.0 - z, xyz]
            .map(|o| 15.0 * o)
    }
}

fn single(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}
