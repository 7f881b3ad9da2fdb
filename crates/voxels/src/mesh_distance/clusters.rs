//! Groups of triangles as seen from afar.

use std::f64::consts::PI;
use std::ops::Range;

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
    pub dipole: DVec3,
    pub quadrupole: Quadratic,
    pub octupole: Cubic,
}

impl Cluster {
    const EMPTY: Self = Self {
        center: DVec3::ZERO,
        radius: 0.0,
        area: 0.0,
        dipole: DVec3::ZERO,
        quadrupole: [0.0; 6],
        octupole: [0.0; 10],
    };

    /// A triangle around its centroid, where its second moment is a twelfth of the corners'.
    pub fn of_triangle(corners: &[DVec3; 3]) -> Self {
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

    /// What leaving out all terms of the Taylor series of a cluster's winding number from the third degree on changes at most within
    /// `radius` of a place `way` before it.
    ///
    /// With t the sum of both radii over the distance D, the term of degree k of the gradient of 1/r is at most (k + 1) tᵏ / D²: as a
    /// form it is (k + 1) times a harmonic one that is at most 1 on the sphere. Σ (k + 1) tᵏ from k = 3 is t³ (4 − 3 t) / (1 − t)².
    /// Rounding adds some ulps of the whole.
    #[inline(always)]
    pub fn error_of(center: DVec3, cluster_radius: f64, area: f64, place: DVec3, radius: f64) -> f64 {
        let squared = (center - place).length_squared();
        let reach = cluster_radius + radius;
        if reach * reach > MOST_RATIO * MOST_RATIO * squared {
            return f64::INFINITY;
        }
        let t = reach / squared.sqrt();
        let truncation = t * t * t * (4.0 - 3.0 * t) / ((1.0 - t) * (1.0 - t));
        area / squared * (truncation * (1.0 + 1e-9) + ROUNDING)
    }

    /// Adds a cluster's winding number around `place`; see [`Taylor::error_of`] for what that neglects.
    ///
    /// It is −1/4π ∫ n·∇G(D + η − ξ) with G = 1/r, D the way to the cluster's centre, η from there to the triangles, ξ from the place.
    #[inline(always)]
    pub fn add(&mut self, cluster: &Cluster, place: DVec3) {
        let x = cluster.center - place;
        let squared = x.length_squared();
        let inverse = 1.0 / squared;
        let third = inverse * inverse.sqrt() * (-1.0 / (4.0 * PI));
        let fifth = third * inverse;
        let seventh = fifth * inverse;
        let along = cluster.dipole.dot(x);
        let bent = quadratic(&cluster.quadrupole, x);
        self.value += -along * third + 3.0 * bent * fifth - 7.5 * cubic(&cluster.octupole, x) * seventh;
        self.slope += cluster.dipole * third - x * (3.0 * along * fifth) + x * (15.0 * bent * seventh)
            - gradient(&cluster.quadrupole, x) * (3.0 * fifth);
        add(&mut self.bend, &square(x), -7.5 * along * seventh);
        add(&mut self.bend, &product(cluster.dipole, x), 3.0 * fifth);
        self.bend[..3].iter_mut().for_each(|diagonal| *diagonal += 1.5 * along * fifth);
    }

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

/// Clusters nearer than the radii over this are never added.
const MOST_RATIO: f64 = 0.75;

/// Rounding of a cluster's series, of moments and of moving it, in shares of area over squared distance: some hundred ulps.
const ROUNDING: f64 = 1.0 / (1u64 << 44) as f64;

/// How many triangles are in a group.
const GROUP: usize = 4;

/// Triangles in a complete binary tree of clusters: node `i` has the nodes `2 i + 1` and `2 i + 2` in it, the last level triangles.
pub(super) struct Clusters {
    pub triangles: Vec<[DVec3; 3]>,
    nodes: Vec<Cluster>,
    levels: u32,
    _memory: Reservation,
}

/// A cluster or a triangle of the tree.
#[derive(Clone, Copy)]
pub(super) enum Part {
    Node(u32),
    Triangle(u32),
}

impl Clusters {
    /// Puts near triangles together by halving along the longest axis.
    pub fn new(mut triangles: Vec<[DVec3; 3]>, exec: &Exec) -> Result<Self, ConvertError> {
        let len = triangles.len();
        let levels = len.div_ceil(GROUP).max(1).next_power_of_two().trailing_zeros();
        let memory = exec.reserve_elements(2u64 << levels, size_of::<Cluster>())?;
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
        let mut nodes = vec![Cluster::EMPTY; (2usize << levels) - 1];
        for level in (0..=levels).rev() {
            for part in 0..1usize << level {
                if part % 1024 == 0 {
                    exec.check()?;
                }
                let at = (1usize << level) - 1 + part;
                nodes[at] = if level == levels {
                    let inner = triangles[span(len, levels, level, part)].iter().map(Cluster::of_triangle);
                    inner.fold(Cluster::EMPTY, |sum, one| Cluster::of_two(&sum, &one))
                } else {
                    Cluster::of_two(&nodes[2 * at + 1], &nodes[2 * at + 2])
                };
            }
        }
        Ok(Self { triangles, nodes, levels, _memory: memory })
    }

    pub fn node(&self, at: u32) -> &Cluster {
        &self.nodes[at as usize]
    }

    /// Tells `visit` what is in a node: nodes or triangles.
    #[inline(always)]
    pub fn open(&self, at: u32, mut visit: impl FnMut(Part)) {
        let below = 2 * at + 1;
        if (below as usize) < self.nodes.len() {
            visit(Part::Node(below));
            visit(Part::Node(below + 1));
        } else {
            let part = at as usize + 1 - (1usize << self.levels);
            for triangle in span(self.triangles.len(), self.levels, self.levels, part) {
                visit(Part::Triangle(triangle as u32));
            }
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
