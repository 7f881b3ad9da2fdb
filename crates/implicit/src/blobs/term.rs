//! One blob, ready to be added up.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Interval};

use super::{Blob, BlobForm};

/// How a term falls from its centre to its reach, over q, the squared share of the reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fall {
    /// `size (exp(shift - decay q) - exp(shift - decay))`: an exponential that is 0 at the reach.
    Exponential,
    /// Nishimura's two parabolas.
    Metaball,
    /// Wyvill's polynomial of sixth degree.
    Soft,
}

impl Fall {
    pub(super) fn of(form: BlobForm) -> Self {
        match form {
            BlobForm::Blinn | BlobForm::Blobby => Self::Exponential,
            BlobForm::Metaballs => Self::Metaball,
            BlobForm::SoftObjects => Self::Soft,
        }
    }
}

/// A blob that ends at its reach: nothing from there on, and continuous there.
///
/// Every computation of q takes the same steps, each of which rounds without changing the order of its arguments: what q is at the
/// nearest and the farthest point of a box is then no more and no less than what it is at any point of it, to the bit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub(super) center: DVec3,
    pub(super) reach: f64,
    /// 1 over the reach.
    pub(super) scale: f64,
    pub(super) size: f64,
    pub(super) shift: f64,
    pub(super) decay: f64,
    /// What the exponential is at the reach, taken off everywhere. Has the sign of the size.
    pub(super) floor: f64,
}

/// Boxes of terms are this share of the reach wider: room for rounding, also of single precision.
pub(super) const ROOM: f64 = 1e-5;

impl Term {
    /// The term of a blob; of an exponential, up to where it falls to `floor`. None where it is nowhere above that.
    pub(super) fn new(form: BlobForm, blob: &Blob, floor: f64) -> Option<Self> {
        let [first, second] = blob.parameters;
        let compact = |size: f64| Self {
            center: blob.center,
            reach: first,
            scale: 1.0 / first,
            size,
            shift: 0.0,
            decay: 0.0,
            floor: 0.0,
        };
        let (size, shift) = match form {
            BlobForm::Metaballs | BlobForm::SoftObjects => return Some(compact(second)),
            BlobForm::Blinn => (first, 0.0),
            BlobForm::Blobby => (1.0, second),
        };
        // decay = b reach², where the exponential is at the floor.
        let decay = shift + (size.abs() / floor).ln();
        if decay.is_nan() || decay <= 0.0 {
            return None;
        }
        let reach = match form {
            // The quotient alone would overflow for the smallest decays.
            BlobForm::Blinn => decay.sqrt() / second.sqrt(),
            _ => first * (decay / second).sqrt(),
        };
        let floor = size * (shift - decay).exp();
        Some(Self { center: blob.center, reach, scale: 1.0 / reach, size, shift, decay, floor })
    }

    /// A box around all points that the term reaches, with [`ROOM`].
    pub(super) fn bounds(&self) -> Aabb {
        let reach = DVec3::splat(self.reach * (1.0 + ROOM));
        let (min, max) = (self.center - reach, self.center + reach);
        Aabb {
            min: DVec3::from_array(min.to_array().map(f64::next_down)),
            max: DVec3::from_array(max.to_array().map(f64::next_up)),
        }
    }

    /// The square of the distance in reaches.
    pub(super) fn q(&self, point: DVec3) -> f64 {
        let [x, y, z] = (point - self.center).to_array().map(|away| away * self.scale);
        (x * x + y * y) + z * z
    }

    /// q at the nearest and the farthest point of a box.
    pub(super) fn q_over(&self, region: &Aabb) -> (f64, f64) {
        let (below, above) = ((region.min - self.center).to_array(), (region.max - self.center).to_array());
        let (mut near, mut far) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            near[axis] = below[axis].max(-above[axis]).max(0.0) * self.scale;
            far[axis] = below[axis].abs().max(above[axis].abs()) * self.scale;
        }
        let square = |[x, y, z]: [f64; 3]| (x * x + y * y) + z * z;
        (square(near), square(far))
    }

    /// The value where q is below 1.
    pub(super) fn value(&self, fall: Fall, q: f64) -> f64 {
        match fall {
            Fall::Exponential => self.size * (self.shift - self.decay * q).exp() - self.floor,
            Fall::Metaball if q <= 1.0 / 9.0 => self.size * (1.0 - 3.0 * q),
            Fall::Metaball => {
                let left = 1.0 - q.sqrt();
                self.size * (1.5 * left * left)
            }
            Fall::Soft => {
                // The same polynomial with its double zero taken out, which keeps it from falling below 0.
                let left = 1.0 - q;
                self.size * (left * left * (1.0 - (4.0 / 9.0) * q))
            }
        }
    }

    /// The gradient where q is below 1.
    pub(super) fn gradient(&self, fall: Fall, point: DVec3, q: f64) -> DVec3 {
        let by_q = match fall {
            Fall::Exponential => -self.decay * self.size * (self.shift - self.decay * q).exp(),
            Fall::Metaball if q <= 1.0 / 9.0 => -3.0 * self.size,
            Fall::Metaball => -1.5 * self.size * (1.0 - q.sqrt()) / q.sqrt(),
            Fall::Soft => self.size * (-22.0 + q * (34.0 - 12.0 * q)) / 9.0,
        };
        (point - self.center) * self.scale * (2.0 * by_q * self.scale)
    }

    /// Bounds of what the term adds in a box where q runs between two numbers: no value computed there lies outside.
    pub(super) fn over(&self, fall: Fall, (near, far): (f64, f64)) -> Interval {
        let at = |q: f64| if q < 1.0 { self.value(fall, q) } else { 0.0 };
        let (a, b) = (at(near), at(far));
        // Values fall with q up to a few units in the last place: where the two parabolas meet, and by the library's exponential.
        let room = 8.0 * f64::EPSILON * (a.abs().max(b.abs()) + self.floor.abs());
        Interval::new(a.min(b) - room, a.max(b) + room)
    }

    /// The largest slope.
    pub(super) fn steepest(&self, fall: Fall) -> f64 {
        let share = match fall {
            // At decay q = 1/2, or at the reach where that is nearer.
            Fall::Exponential if self.decay >= 0.5 => (self.shift - 0.5).exp() * (2.0 * self.decay).sqrt(),
            Fall::Exponential => 2.0 * self.decay * (self.shift - self.decay).exp(),
            Fall::Metaball => 2.0,
            // At ρ² = (51 - √1281) / 60.
            Fall::Soft => 1.583_429_747_740_171,
        };
        self.size.abs() * share * self.scale * (1.0 + 1e-12)
    }
}
