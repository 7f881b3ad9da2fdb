//! Up to eight triangles side by side in `f32`, to rule most of them out at once.
//!
//! What is ruled out is surely not met or surely farther than a limit; what is left is decided in `f64` on the given
//! coordinates. Coordinates are local, where the shape reaches at most 2 from the origin.

use glam::DVec3;

use crate::triangle_ray::Shear;
use crate::wide_node::{Lanes, Mask, Node, Signs, Slabs, WIDTH, larger, not_negative, smaller};

/// The triangles of a leaf.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Block {
    /// Corner, axis, triangle; rounded to the nearest.
    corners: [[Lanes; 3]; 3],
    /// The smallest element with the corners of each; [`Block::NONE`] where there is no triangle.
    pub elements: [u32; WIDTH],
}

impl Block {
    pub const NONE: u32 = u32::MAX;
    pub const EMPTY: Self = Self { corners: [[[0.0; WIDTH]; 3]; 3], elements: [Self::NONE; WIDTH] };

    /// Triangles in scaled units about `origin`, and whether the block holds them exactly.
    pub fn of(triangles: impl Iterator<Item = (u32, [DVec3; 3])>, origin: DVec3) -> (Self, bool) {
        let mut block = Self::EMPTY;
        let mut exact = origin == DVec3::ZERO;
        for (lane, (element, triangle)) in triangles.take(WIDTH).enumerate() {
            block.elements[lane] = element;
            for (corner, &position) in triangle.iter().enumerate() {
                let local = (position - origin).to_array();
                for (axis, coordinate) in local.into_iter().enumerate() {
                    block.corners[corner][axis][lane] = coordinate as f32;
                    exact &= f64::from(coordinate as f32) == coordinate;
                }
            }
        }
        (block, exact)
    }

    /// The corners of a triangle as the block holds them.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [DVec3; 3] {
        let at = |corner: usize, axis: usize| f64::from(self.corners[corner][axis][lane]);
        [0, 1, 2].map(|corner| DVec3::new(at(corner, 0), at(corner, 1), at(corner, 2)))
    }

    /// Which triangles the ray's line may cross, a bit for each.
    #[inline(always)]
    // Written with iterators the compiler spills more, and rays take a seventh longer.
    #[allow(clippy::needless_range_loop)]
    pub fn may_cross(&self, line: &RoughShear, signs: impl Signs) -> Mask {
        let [x, y, z] = line.axes;
        let mut image = [[[0f32; WIDTH]; 2]; 3];
        for corner in 0..3 {
            let coordinates = &self.corners[corner];
            let (across, up, along) = (&coordinates[x], &coordinates[y], &coordinates[z]);
            for lane in 0..WIDTH {
                let depth = along[lane] - line.origin[2];
                image[corner][0][lane] = (across[lane] - line.origin[0]) - line.slope[0] * depth;
                image[corner][1][lane] = (up[lane] - line.origin[1]) - line.slope[1] * depth;
            }
        }
        let [a, b, c] = &image;
        let mut doubts = [0f32; WIDTH];
        for lane in 0..WIDTH {
            let (ax, ay, bx, by, cx, cy) = (a[0][lane], a[1][lane], b[0][lane], b[1][lane], c[0][lane], c[1][lane]);
            let u = bx * cy - by * cx;
            let v = cx * ay - cy * ax;
            let w = ax * by - ay * bx;
            let size =
                larger(larger(larger(ax.abs(), ay.abs()), larger(bx.abs(), by.abs())), larger(cx.abs(), cy.abs()));
            let error = line.error * (size + line.error);
            let least = smaller(u, smaller(v, w));
            let most = larger(u, larger(v, w));
            // Ruled out where both are beyond the error.
            let doubt = larger(least + error, error - most);
            doubts[lane] = if self.elements[lane] == Self::NONE { -1.0 } else { doubt };
        }
        not_negative(&doubts, signs)
    }

    /// Which triangles may be within the limit of a place, a bit for each.
    ///
    /// For any vector `g`, no point of a triangle is closer to the origin than the least `g · corner / |g|`. The point
    /// of the triangle that is roughly the closest is such a vector, and the better it is, the tighter is the bound.
    #[inline(always)]
    pub fn may_be_within(&self, place: &RoughPlace, signs: impl Signs) -> Mask {
        let [a, b, c] = &self.corners;
        let mut rooms = [0f32; WIDTH];
        for lane in 0..WIDTH {
            let at = &place.in_block;
            let from =
                |corner: &[Lanes; 3]| [corner[0][lane] - at[0], corner[1][lane] - at[1], corner[2][lane] - at[2]];
            let (qa, qb, qc) = (from(a), from(b), from(c));
            let ab = [qb[0] - qa[0], qb[1] - qa[1], qb[2] - qa[2]];
            let ac = [qc[0] - qa[0], qc[1] - qa[1], qc[2] - qa[2]];
            let (d1, d2) = (-dot(ab, qa), -dot(ac, qa));
            let (bb, bc, cc) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
            // Squared distances but for |qa|², as functions of the two weights.
            let on_ab = fraction(d1, bb);
            let on_ac = fraction(d2, cc);
            let on_bc = fraction((bb - d1) - (bc - d2), (bb - bc) + (cc - bc));
            let value = |v: f32, w: f32| v * ((v * bb - 2.0 * d1) + 2.0 * (w * bc)) + w * (w * cc - 2.0 * d2);
            let (mut v, mut w) = (on_ab, 0.0);
            let mut best = value(v, w);
            let other = value(0.0, on_ac);
            let better = other < best;
            (v, w) = (if better { 0.0 } else { v }, if better { on_ac } else { w });
            best = smaller(other, best);
            let other = value(1.0 - on_bc, on_bc);
            let better = other < best;
            (v, w) = (if better { 1.0 - on_bc } else { v }, if better { on_bc } else { w });
            let scale = 1.0 / (bb * cc - bc * bc);
            let (inner_v, inner_w) = ((cc * d1 - bc * d2) * scale, (bb * d2 - bc * d1) * scale);
            let inside = (inner_v > 0.0) & (inner_w > 0.0) & (inner_v + inner_w < 1.0);
            (v, w) = (if inside { inner_v } else { v }, if inside { inner_w } else { w });
            let g = [qa[0] + (ab[0] * v + ac[0] * w), qa[1] + (ab[1] * v + ac[1] * w), qa[2] + (ab[2] * v + ac[2] * w)];
            let least = smaller(dot(g, qa), smaller(dot(g, qb), dot(g, qc)));
            let square = dot(g, g);
            // The last term is above what underflow can do.
            let room = (place.limit_squared * square + 1e-37) - least * least.abs();
            rooms[lane] = if self.elements[lane] == Self::NONE { -1.0 } else { room };
        }
        not_negative(&rooms, signs)
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// A quotient held to `[0, 1]`; 0 where it is none.
#[inline(always)]
fn fraction(above: f32, below: f32) -> f32 {
    let t = above / below;
    if t > 0.0 { smaller(t, 1.0) } else { 0.0 }
}

/// The line of a ray, in `f32`, with the error that its images of corners can have.
#[derive(Debug)]
pub(crate) struct RoughShear {
    /// The start, by the order of the axes.
    origin: [f32; 3],
    axes: [usize; 3],
    slope: [f32; 2],
    error: f32,
}

impl RoughShear {
    /// How far an image's coordinate here can be from the one in `f64`, apart from what the `f64` ones can be off:
    /// corners round by 2^-24, a start of at most 8 by 2^-21, differences of at most 10 by 2^-20, each once across and
    /// once along, and the sheared difference by 2^-20 and a slope of at most 1 by 2^-24 of 10: 5e-6 in all.
    const IMAGE_ERROR: f64 = 7.7e-6;

    #[inline(always)]
    pub fn new(slabs: &Slabs, shear: &Shear, shift: DVec3) -> Self {
        let [x, y, z] = shear.axes;
        let from = [slabs.from[0] + shift.x, slabs.from[1] + shift.y, slabs.from[2] + shift.z];
        let near = from[0].abs().max(from[1].abs()).max(from[2].abs()) <= 10.0;
        let image_error = Self::IMAGE_ERROR + 2.0 * slabs.slack;
        // Images of size m that are off by e have cross products off by at most 4em + 2e², and the products, m being
        // below 32, round by less than em. An infinite error rules nothing out.
        let sure = near && slabs.slack < 1e-3;
        let from = if sure { from } else { [0.0; 3] };
        Self {
            origin: [from[x] as f32, from[y] as f32, from[z] as f32],
            axes: [x, y, z],
            slope: [shear.slope.x as f32, shear.slope.y as f32],
            error: if sure { (8.0 * image_error) as f32 } else { f32::INFINITY },
        }
    }
}

/// A place in local units in `f32`, and a squared distance that counts, with room for every rounding.
#[derive(Debug)]
pub(crate) struct RoughPlace {
    /// Among boxes.
    at: [f32; 3],
    /// Among the triangles of blocks.
    in_block: [f32; 3],
    /// The most that coordinates and distances here can be off.
    slack: f64,
    /// The square of the limit, no less.
    pub limit: f32,
    /// The square of the limit and the slack.
    limit_squared: f32,
}

impl RoughPlace {
    /// How far from the origin a place may be: beyond, `f32` tells too little apart.
    pub const FAR: f64 = 1000.0;

    /// The place, at most [`RoughPlace::FAR`] away, with what `f64` arithmetic before can be off.
    #[inline(always)]
    pub fn new(local: DVec3, shift: DVec3, slack: f64) -> Self {
        let size = local.abs().max_element() + 4.0;
        // Corners and the place round by 2^-24 of their size, and so do differences and the three terms of dot products
        // over the length of the vector: less than 9 such errors together, of 16.
        let slack = size * 2f64.powi(-20) + 2.0 * slack;
        let narrow = |place: DVec3| place.to_array().map(|x| x as f32);
        Self { at: narrow(local), in_block: narrow(local + shift), slack, limit: 1e20, limit_squared: 1e20 }
    }

    /// Sets the squared distance beyond which triangles are of no interest.
    #[inline(always)]
    pub fn set_limit(&mut self, squared: f64) {
        let limit = squared.sqrt() + self.slack;
        // Squares of rounded sums, and f32.
        self.limit_squared = (limit * limit * (1.0 + 1e-5)).min(1e20) as f32;
        self.limit = (squared * (1.0 + 1e-5)).min(1e20) as f32;
    }

    /// Squared distances to the boxes of a node, never too large, and which are within the limit.
    #[inline(always)]
    pub fn lower_bounds(&self, node: &Node, signs: impl Signs) -> (Lanes, Mask) {
        let slack = self.slack as f32;
        let (mut sum, mut room) = ([0f32; WIDTH], [0f32; WIDTH]);
        for axis in 0..3 {
            let (low, high, at) = (&node.sides[0][axis], &node.sides[1][axis], self.at[axis]);
            for lane in 0..WIDTH {
                let gap = larger(larger(low[lane] - at, at - high[lane]) - slack, 0.0);
                sum[lane] += gap * gap;
            }
        }
        // Boxes of unused places are infinitely far.
        for lane in 0..WIDTH {
            room[lane] = self.limit - sum[lane];
        }
        (sum, not_negative(&room, signs))
    }
}
