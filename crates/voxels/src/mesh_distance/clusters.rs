//! Groups of triangles as seen from afar.

use std::f64::consts::PI;
use std::ops::Range;

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, ConvertError, Exec, Reservation};

/// The coefficients of xx, yy, zz, xy, xz, yz.
pub(super) type Quadratic = [f64; 6];

/// The coefficients of xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz.
type Cubic = [f64; 10];

/// What triangles do far away: the integrals of n·x, (n·x)(η·x) and (n·x)(η·x)² over them as forms in x, n being the normal and η
/// the way from the centre. The latter two may lack multiples of x², which harmonic functions do not see.
#[derive(Clone, Copy)]
pub(super) struct Cluster {
    pub center: DVec3,
    /// No triangle reaches farther from the centre.
    pub radius: f64,
    /// The sum of areas, over 4π.
    pub area: f64,
    /// The mean squared distance from the centre.
    pub spread: f64,
    pub dipole: DVec3,
    pub quadrupole: Quadratic,
    pub octupole: Cubic,
}

impl Cluster {
    const EMPTY: Self = Self {
        center: DVec3::ZERO,
        radius: 0.0,
        area: 0.0,
        spread: 0.0,
        dipole: DVec3::ZERO,
        quadrupole: [0.0; 6],
        octupole: [0.0; 10],
    };

    /// A triangle around its centroid, where its second moment is a twelfth of the corners'.
    fn of_triangle(corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = *corners;
        let dipole = (b - a).cross(c - a) * 0.5;
        let center = (a + b + c) / 3.0;
        let mut second = [0.0; 6];
        let mut radius = 0f64;
        for corner in [a, b, c] {
            let at = corner - center;
            radius = radius.max(at.length());
            add(&mut second, &square(at), 1.0 / 12.0);
        }
        let mut octupole = times(dipole, &second);
        without_trace(&mut octupole);
        Self {
            center,
            radius: radius * (1.0 + 1e-12),
            spread: (second[0] + second[1] + second[2]) * (1.0 + 1e-12),
            area: dipole.length() / (4.0 * PI),
            dipole,
            quadrupole: [0.0; 6],
            octupole,
        }
    }

    /// Both in one.
    fn of_two(one: &Self, other: &Self) -> Self {
        if one.area == 0.0 || other.area == 0.0 {
            return if one.area == 0.0 { *other } else { *one };
        }
        let area = one.area + other.area;
        let center = one.center + (other.center - one.center) * (other.area / area);
        let mut sum = Self { center, area, ..Self::EMPTY };
        for part in [one, other] {
            let moved = part.center - center;
            sum.radius = sum.radius.max((moved.length() + part.radius) * (1.0 + 1e-12));
            sum.spread += (part.spread + moved.length_squared()) * (part.area / area) * (1.0 + 1e-12);
            sum.dipole += part.dipole;
            let shift = product(part.dipole, moved);
            add(&mut sum.quadrupole, &part.quadrupole, 1.0);
            add(&mut sum.quadrupole, &shift, 1.0);
            add(&mut sum.octupole, &part.octupole, 1.0);
            add(&mut sum.octupole, &times(moved, &part.quadrupole), 2.0);
            add(&mut sum.octupole, &times(moved, &shift), 1.0);
        }
        let third = (sum.quadrupole[0] + sum.quadrupole[1] + sum.quadrupole[2]) / 3.0;
        sum.quadrupole[..3].iter_mut().for_each(|x| *x -= third);
        without_trace(&mut sum.octupole);
        sum
    }
}

/// The winding number near a place as far triangles make it: a Taylor series of second degree, in cells.
#[derive(Clone, Copy)]
pub(super) struct Taylor {
    pub value: f64,
    pub slope: DVec3,
    pub bend: Quadratic,
    /// No value within the radius that clusters were added for is wrong by more.
    pub error: f64,
}

impl Taylor {
    pub const ZERO: Self = Self { value: 0.0, slope: DVec3::ZERO, bend: [0.0; 6], error: 0.0 };

    /// The same series about another place.
    pub fn moved(&self, by: DVec3) -> Self {
        Self { value: self.at(by), slope: self.slope + gradient(&self.bend, by), ..*self }
    }

    #[inline(always)]
    pub fn at(&self, way: DVec3) -> f64 {
        self.value + self.slope.dot(way) + quadratic(&self.bend, way)
    }

    /// How far values within a radius are from the middle one, at most.
    pub fn change(&self, radius: f64) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.bend;
        let bend = (xx * xx + yy * yy + zz * zz + 0.5 * (xy * xy + xz * xz + yz * yz)).sqrt();
        radius * (self.slope.length() + radius * bend) * (1.0 + 1e-9)
    }
}

/// What is to be known of some clusters before they are added.
pub(super) struct Look {
    /// What leaving out the rest of the series is wrong by at most; infinity where it is not known.
    pub errors: [f64; LANES],
    /// What the winding number itself is at most.
    pub most: [f64; LANES],
}

/// What leaving out all terms of the Taylor series of a cluster's winding number from the third degree on changes at most within
/// `radius` of a place.
///
/// The term of degree k of the gradient of 1/r, at a distance D and δ away, is at most (k + 1) δᵏ / Dᵏ⁺²: as a form it is (k + 1)
/// times a harmonic one that is at most 1 on the sphere. With t the largest δ/D, Σ (k + 1) (δ/D)ᵏ from k = 3 is at most
/// (δ/D)³ (4 − 3 t) / (1 − t)². Here δ is at most ρ + |η|, ρ being the radius around the place and η the way from the cluster's
/// centre; the mean of its cube follows from that of |η|², |η| being at most the cluster's radius. Rounding adds some ulps of all.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn look(all: &[Cluster], which: &[u32], place: DVec3, radius: f64) -> Look {
    let mut fields = [[1.0; LANES]; 6];
    for (lane, &at) in which.iter().enumerate().take(LANES) {
        let cluster = &all[at as usize];
        let way = cluster.center - place;
        let known = [way.x, way.y, way.z, cluster.radius, cluster.area, cluster.spread];
        fields.iter_mut().zip(known).for_each(|(field, value)| field[lane] = value);
    }
    let mut found = Look { errors: [0.0; LANES], most: [0.0; LANES] };
    let [x, y, z, cluster_radius, area, spread] = &fields;
    for lane in 0..LANES {
        let squared = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
        let distance = squared.sqrt();
        let reach = cluster_radius[lane] + radius;
        let inverse = 1.0 / distance;
        let t = reach * inverse;
        let cubed = spread[lane] * (cluster_radius[lane] + 3.0 * radius)
            + radius * radius * (3.0 * spread[lane].sqrt() + radius);
        let gap = 1.0 - t;
        let truncation = cubed * (inverse * inverse * inverse) * (4.0 - 3.0 * t) / (gap * gap);
        let error = area[lane] * (inverse * inverse) * (truncation * (1.0 + 1e-9) + ROUNDING);
        found.errors[lane] = if t < MOST_RATIO { error } else { f64::INFINITY };
        let left = distance - reach;
        let most = area[lane] / (left * left) * (1.0 + 1e-9);
        found.most[lane] = if left > 0.0 { most } else { f64::INFINITY };
    }
    found
}

/// Adds the winding numbers of clusters around `place` to a series about it; see [`look`] for what that neglects.
///
/// It is −1/4π ∫ n·∇G(D + η − ξ) with G = 1/r, D the way to the cluster's centre, η from there to the triangles, ξ from the place.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn add_all(taylor: &mut Taylor, all: &[Cluster], which: &[u32], place: DVec3) {
    let mut sums = [[0.0; LANES]; 10];
    for part in which.chunks(LANES) {
        // Lanes without a cluster see nothing, at a distance of 1.
        let (mut way, mut dipole) = ([[1.0; LANES], [0.0; LANES], [0.0; LANES]], [[0.0; LANES]; 3]);
        let (mut second, mut third) = ([[0.0; LANES]; 6], [[0.0; LANES]; 10]);
        for (lane, &at) in part.iter().enumerate() {
            let cluster = &all[at as usize];
            let x = cluster.center - place;
            (0..3).for_each(|axis| way[axis][lane] = x[axis]);
            (0..3).for_each(|axis| dipole[axis][lane] = cluster.dipole[axis]);
            second.iter_mut().zip(cluster.quadrupole).for_each(|(out, q)| out[lane] = q);
            third.iter_mut().zip(cluster.octupole).for_each(|(out, o)| out[lane] = o);
        }
        for lane in 0..LANES {
            let x = DVec3::new(way[0][lane], way[1][lane], way[2][lane]);
            let s = DVec3::new(dipole[0][lane], dipole[1][lane], dipole[2][lane]);
            let q = [0, 1, 2, 3, 4, 5].map(|i| second[i][lane]);
            let o = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(|i| third[i][lane]);
            let inverse = 1.0 / (x.x * x.x + x.y * x.y + x.z * x.z);
            let p3 = inverse * inverse.sqrt() * (-1.0 / (4.0 * PI));
            let p5 = p3 * inverse;
            let p7 = p5 * inverse;
            let along = s.x * x.x + s.y * x.y + s.z * x.z;
            let bent = quadratic(&q, x);
            let turned = gradient(&q, x);
            sums[0][lane] += 3.0 * bent * p5 - along * p3 - 7.5 * cubic(&o, x) * p7;
            let back = 15.0 * bent * p7 - 3.0 * along * p5;
            sums[1][lane] += s.x * p3 + x.x * back - turned.x * (3.0 * p5);
            sums[2][lane] += s.y * p3 + x.y * back - turned.y * (3.0 * p5);
            sums[3][lane] += s.z * p3 + x.z * back - turned.z * (3.0 * p5);
            let (one, two, same) = (-7.5 * along * p7, 3.0 * p5, 1.5 * along * p5);
            sums[4][lane] += x.x * (one * x.x + two * s.x) + same;
            sums[5][lane] += x.y * (one * x.y + two * s.y) + same;
            sums[6][lane] += x.z * (one * x.z + two * s.z) + same;
            sums[7][lane] += 2.0 * one * (x.x * x.y) + two * (s.x * x.y + s.y * x.x);
            sums[8][lane] += 2.0 * one * (x.x * x.z) + two * (s.x * x.z + s.z * x.x);
            sums[9][lane] += 2.0 * one * (x.y * x.z) + two * (s.y * x.z + s.z * x.y);
        }
    }
    let [value, x, y, z, bend @ ..] = sums.map(|[a, b, c, d]| (a + c) + (b + d));
    taylor.value += value;
    taylor.slope += DVec3::new(x, y, z);
    add(&mut taylor.bend, &bend, 1.0);
}

/// How many clusters are added together.
pub(super) const LANES: usize = 4;

/// Clusters nearer than the radii over this are never added.
const MOST_RATIO: f64 = 0.75;

/// Rounding of a cluster's series, of moments and of moving it, in shares of area over squared distance: some hundred ulps.
const ROUNDING: f64 = 1.0 / (1u64 << 44) as f64;

/// How many triangles are in a group.
const GROUP: usize = 4;

/// Triangles in a complete binary tree of clusters: node `i` has the nodes `2 i + 1` and `2 i + 2` in it, the last level triangles.
pub(super) struct Clusters {
    pub triangles: Vec<[DVec3; 3]>,
    /// The nodes, then each triangle.
    pub all: Vec<Cluster>,
    levels: u32,
    _memory: Reservation,
}

impl Clusters {
    /// Puts near triangles together by halving along the longest axis.
    pub fn new(mut triangles: Vec<[DVec3; 3]>, exec: &Exec) -> Result<Self, ConvertError> {
        let len = triangles.len();
        let levels = len.div_ceil(GROUP).max(1).next_power_of_two().trailing_zeros();
        let memory = exec.reserve_elements(2 * len as u64 + (2u64 << levels), size_of::<Cluster>())?;
        let middle_of = |[a, b, c]: &[DVec3; 3]| *a + *b + *c;
        for level in 0..levels {
            for part in 0..1usize << level {
                if part % 64 == 0 {
                    exec.check()?;
                }
                let range = span(len, levels, level, part);
                let (start, middle) = (range.start, span(len, levels, level + 1, 2 * part).end);
                if middle > range.start && middle < range.end {
                    let inner = &mut triangles[range];
                    let size = Aabb::from_points(inner.iter().map(middle_of)).size();
                    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
                    inner.select_nth_unstable_by(middle - start, |a, b| {
                        middle_of(a)[axis].total_cmp(&middle_of(b)[axis])
                    });
                }
            }
        }
        let mut single = Vec::with_capacity(len);
        for part in triangles.chunks(4096) {
            exec.check()?;
            single.extend(part.iter().map(Cluster::of_triangle));
        }
        let mut nodes = vec![Cluster::EMPTY; (2usize << levels) - 1];
        for level in (0..=levels).rev() {
            for part in 0..1usize << level {
                if part % 1024 == 0 {
                    exec.check()?;
                }
                let at = (1usize << level) - 1 + part;
                nodes[at] = if level == levels {
                    let inner = single[span(len, levels, level, part)].iter();
                    inner.fold(Cluster::EMPTY, |sum, one| Cluster::of_two(&sum, one))
                } else {
                    Cluster::of_two(&nodes[2 * at + 1], &nodes[2 * at + 2])
                };
            }
        }
        nodes.extend(single);
        Ok(Self { triangles, all: nodes, levels, _memory: memory })
    }

    /// Which of the triangles a cluster is, if it is one.
    #[inline(always)]
    pub fn triangle(&self, at: u32) -> Option<u32> {
        at.checked_sub((2u32 << self.levels) - 1)
    }

    /// Lists what is in a node: nodes or triangles.
    #[inline(always)]
    pub fn open(&self, at: u32, list: &mut Vec<u32>) {
        let (below, nodes) = (2 * at + 1, (2u32 << self.levels) - 1);
        if below < nodes {
            list.extend([below, below + 1]);
        } else {
            let part = at as usize + 1 - (1usize << self.levels);
            let triangles = span(self.triangles.len(), self.levels, self.levels, part);
            list.extend(triangles.map(|triangle| nodes + triangle as u32));
        }
    }
}

/// The triangles of a node: all are cut into as many groups as the last level has, of sizes that differ by one at most.
fn span(len: usize, levels: u32, level: u32, part: usize) -> Range<usize> {
    let groups = 1usize << levels;
    let width = 1usize << (levels - level);
    let at = |group: usize| (group as u128 * len as u128 / groups as u128) as usize;
    at(part * width)..at((part + 1) * width)
}

#[inline(always)]
fn add<const N: usize>(sum: &mut [f64; N], form: &[f64; N], factor: f64) {
    sum.iter_mut().zip(form).for_each(|(sum, x)| *sum += factor * x);
}

/// (a·x)(b·x).
#[inline(always)]
fn product(a: DVec3, b: DVec3) -> Quadratic {
    [a.x * b.x, a.y * b.y, a.z * b.z, a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y]
}

/// (a·x)².
#[inline(always)]
fn square(a: DVec3) -> Quadratic {
    product(a, a)
}

/// (a·x) q(x).
fn times(a: DVec3, [xx, yy, zz, xy, xz, yz]: &Quadratic) -> Cubic {
    [
        a.x * xx,
        a.y * yy,
        a.z * zz,
        a.x * xy + a.y * xx,
        a.x * xz + a.z * xx,
        a.y * xy + a.x * yy,
        a.y * yz + a.z * yy,
        a.z * xz + a.x * zz,
        a.z * yz + a.y * zz,
        a.x * yz + a.y * xz + a.z * xy,
    ]
}

#[inline(always)]
fn quadratic([xx, yy, zz, xy, xz, yz]: &Quadratic, x: DVec3) -> f64 {
    x.x * (xx * x.x + xy * x.y + xz * x.z) + x.y * (yy * x.y + yz * x.z) + zz * x.z * x.z
}

#[inline(always)]
fn gradient([xx, yy, zz, xy, xz, yz]: &Quadratic, x: DVec3) -> DVec3 {
    DVec3::new(
        2.0 * xx * x.x + xy * x.y + xz * x.z,
        2.0 * yy * x.y + xy * x.x + yz * x.z,
        2.0 * zz * x.z + xz * x.x + yz * x.y,
    )
}

#[inline(always)]
fn cubic([xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz]: &Cubic, p: DVec3) -> f64 {
    let (x, y, z) = (p.x, p.y, p.z);
    x * x * (xxx * x + xxy * y + xxz * z)
        + y * y * (yyy * y + yyx * x + yyz * z)
        + z * z * (zzz * z + zzx * x + zzy * y)
        + xyz * x * y * z
}

/// Takes away the multiple of x² that makes the form harmonic: a tenth of its Laplacian times x².
fn without_trace(form: &mut Cubic) {
    let [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, _] = *form;
    let x = (3.0 * xxx + yyx + zzx) / 5.0;
    let y = (3.0 * yyy + xxy + zzy) / 5.0;
    let z = (3.0 * zzz + xxz + yyz) / 5.0;
    for (at, part) in [x, y, z, y, z, x, z, x, y].into_iter().enumerate() {
        form[at] -= part;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Dice, icosahedron, some, soup, torus};
    use shapeloom_mesh::TriMesh;
    use shapeloom_spatial::generalized_winding_number;

    fn clusters(mesh: &TriMesh) -> Clusters {
        let triangles = (0..mesh.triangles().len()).map(|i| mesh.corners(i)).collect();
        Clusters::new(triangles, &Exec::default()).unwrap()
    }

    /// Series of whole meshes, moved and not, against sums over all triangles: never wrong by more than said, at times by a good part
    /// of it.
    #[test]
    fn series_are_as_right_as_they_say() {
        let mut dice = Dice(4);
        let mut worst = 0f64;
        let single = |seed| soup(1, 0.7, seed);
        let mut meshes = vec![some(&icosahedron(), |i| i % 4 != 1), soup(41, 0.3, 2), torus(12, 7)];
        meshes.extend((5..25).map(single));
        for mesh in meshes {
            let clusters = clusters(&mesh);
            let root = clusters.all[0];
            for turn in 0..60 {
                let place = root.center + dice.point().normalize() * root.radius * (1.3 + 3.0 * dice.unit());
                let distance = (place - root.center).length();
                let radius =
                    if turn % 3 == 0 { 0.0 } else { (distance * MOST_RATIO - root.radius).max(0.0) * dice.unit() };
                let found = look(&clusters.all, &[0], place, radius);
                let (error, found_most) = (found.errors[0], found.most[0]);
                if error == f64::INFINITY {
                    assert!(distance < 1.01 * (root.radius + radius) / MOST_RATIO);
                    continue;
                }
                let mut series = Taylor::ZERO;
                add_all(&mut series, &clusters.all, &[0], place);
                let aside = dice.point() * radius;
                let elsewhere = series.moved(aside);
                for way in [DVec3::ZERO, dice.point().normalize() * radius, (root.center - place).normalize() * radius]
                {
                    let exact =
                        generalized_winding_number(mesh.positions(), mesh.triangles(), place + way, &Exec::default());
                    let exact = exact.unwrap().value;
                    let found = series.at(way);
                    assert!((found - exact).abs() <= error + 1e-13, "{found} {exact} {error}");
                    assert!(exact.abs() <= found_most + 1e-15, "{exact} {found_most}");
                    assert!((elsewhere.at(way - aside) - found).abs() < 1e-12);
                    assert!((found - series.value).abs() <= series.change(radius) + 1e-15);
                    worst = worst.max((found - exact).abs() / error);
                }
            }
        }
        assert!(worst > 0.2, "{worst}");
    }

    /// Every node's series is of the triangles in it, and its ball holds them.
    #[test]
    fn nodes_hold_what_they_say() {
        let mesh = soup(77, 0.2, 8);
        let clusters = clusters(&mesh);
        let mut waiting = vec![0u32];
        let mut seen = 0;
        while let Some(at) = waiting.pop() {
            let node = clusters.all[at as usize];
            let (mut inner, mut next) = (Vec::new(), vec![at]);
            while let Some(below) = next.pop() {
                match clusters.triangle(below) {
                    Some(triangle) => inner.push(clusters.triangles[triangle as usize]),
                    None => clusters.open(below, &mut next),
                }
            }
            seen = seen.max(inner.len());
            let corners = inner.as_flattened();
            assert!(corners.iter().all(|corner| corner.distance(node.center) <= node.radius), "{at}");
            let area: f64 = inner.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).length() * 0.5).sum();
            assert!((area - node.area * 4.0 * PI).abs() < 1e-12);
            if clusters.triangle(at).is_none() {
                clusters.open(at, &mut waiting);
            }
        }
        assert_eq!(seen, 77);
    }
}
