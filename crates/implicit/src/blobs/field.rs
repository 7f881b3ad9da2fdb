//! Blobs, checked, as a field.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec, Field, Interval, Restricted};

use super::hierarchy::{Hierarchy, sort_by_place};
use super::sum::Sum;
use super::term::{Fall, Term};
use super::{Blob, BlobForm, BlobsError};

/// A field of blobs: `threshold - sum`, negative inside.
///
/// Each blob adds what its [`BlobForm`] says; the surface is where the sum is the threshold. Tens of thousands stay fast: a hierarchy over
/// the balls that they reach finds those that count at a point, in a box or along a row of points.
///
/// Metaballs and soft objects end by themselves. Exponentials are cut off: each ends where it has fallen to an equal share of
/// `cutoff · threshold`, and that share is taken off its values everywhere, so that the field stays continuous. Values are therefore off
/// from the whole sum by at most [`Blobs::cutoff_error`], which is `cutoff · threshold`, a ten-millionth of the threshold unless another is
/// asked for; a tenth of it makes blobs reach about a twentieth farther.
///
/// As a [`Field`]: values in double precision are those of this sum up to rounding. Batches compute in single precision and are off by about
/// 1e-6 of the largest sum of sizes at a point; their bits do not depend on how points are put together, nor on the
/// machine's instructions. Blobs whose numbers single precision does not hold (reaches outside 1e-15 to 1e15) are computed in
/// double precision there too. Bounds over boxes add up the bounds of all blobs that reach into the box, rounding included. The
/// Lipschitz constant adds up the largest slopes of blobs that meet in a cell of a coarse lattice.
///
/// Two are equal when form, threshold, blobs and cutoff are.
#[derive(Clone, Debug)]
pub struct Blobs {
    form: BlobForm,
    threshold: f64,
    blobs: Vec<Blob>,
    cutoff: f64,
    sum: Arc<Sum>,
}

impl PartialEq for Blobs {
    fn eq(&self, other: &Self) -> bool {
        let content = |blobs: &Self| (blobs.form, blobs.threshold, blobs.cutoff);
        content(self) == content(other) && self.blobs == other.blobs
    }
}

impl Blobs {
    /// The share of the threshold that cut off exponentials lose together, unless another is asked for.
    pub const CUTOFF: f64 = 1e-7;

    /// The field of some blobs of one form.
    ///
    /// Cost: O(n log n), about 20 ms of CPU time for 50,000.
    ///
    /// # Errors
    /// No blobs, a centre that is not finite, a parameter outside its range, a threshold that is not above 0 or that the
    /// sum of all peaks does not reach.
    pub fn try_new(form: BlobForm, threshold: f64, blobs: Vec<Blob>) -> Result<Self, BlobsError> {
        Self::try_new_with(form, threshold, blobs, Self::CUTOFF, &Exec::default())
    }

    /// The same with another cutoff, above 0 and at most 0.1, which polls `exec` and takes the memory that it works in from its
    /// budget.
    ///
    /// # Errors
    /// As [`Blobs::try_new`], the reason to stop, and a budget that does not have what the blobs need.
    pub fn try_new_with(
        form: BlobForm,
        threshold: f64,
        blobs: Vec<Blob>,
        cutoff: f64,
        exec: &Exec,
    ) -> Result<Self, BlobsError> {
        if blobs.is_empty() {
            return Err(BlobsError::Empty);
        }
        if blobs.len() >= 1 << 31 {
            return Err(BlobsError::TooMany { found: blobs.len() });
        }
        if !(threshold > 0.0 && threshold.is_finite()) {
            return Err(BlobsError::Threshold { found: threshold });
        }
        if !(cutoff > 0.0 && cutoff <= 0.1) {
            return Err(BlobsError::Cutoff { found: cutoff });
        }
        check(form, threshold, &blobs, exec)?;
        let _room = exec.reserve_elements(blobs.len() as u64, size_of::<(u32, Term)>() + size_of::<Term>())?;
        let _tree = exec.reserve(Hierarchy::bytes_for(blobs.len()))?;
        let floor = cutoff * threshold / blobs.len() as f64;
        let mut terms = Vec::with_capacity(blobs.len());
        for (index, blob) in (0..).zip(&blobs) {
            if index % 4096 == 0 {
                exec.check()?;
            }
            terms.extend(Term::new(form, blob, floor).map(|term| (index, term)));
        }
        sort_by_place(&mut terms, exec)?;
        exec.progress(0.7);
        let terms = terms.into_iter().map(|(_, term)| term).collect();
        let sum = Arc::new(Sum::new(threshold, Fall::of(form), terms));
        Ok(Self { form, threshold, blobs, cutoff, sum })
    }

    /// How the blobs fall.
    pub fn form(&self) -> BlobForm {
        self.form
    }

    /// The sum at the surface.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The blobs in the order given.
    pub fn blobs(&self) -> &[Blob] {
        &self.blobs
    }

    /// The share of the threshold that cut off exponentials lose together.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// How far values may be from the sum without a cutoff; 0 for metaballs and soft objects.
    pub fn cutoff_error(&self) -> f64 {
        match Fall::of(self.form) {
            Fall::Exponential => self.cutoff * self.threshold,
            _ => 0.0,
        }
    }

    /// A box around everything inside, proven and within a thirty-second or two of its size; empty where that is seen to be empty.
    ///
    /// Halves the box of all that blobs reach five times along each side and keeps the parts that bounds do not show to be outside.
    pub fn bounds(&self) -> Aabb {
        const HALVINGS: u32 = 5;
        let mut kept = Aabb::EMPTY;
        let mut left: Vec<(Aabb, u32, Arc<dyn Field>)> = vec![(self.sum.bounds(), 0, self.sum.clone())];
        while let Some((region, depth, field)) = left.pop() {
            // A part inside the box so far cannot widen it.
            if kept.contains(region.min) && kept.contains(region.max) {
                continue;
            }
            let field = match field.restrict(&region) {
                Restricted::Positive => continue,
                Restricted::Simpler(simpler) => simpler,
                Restricted::Negative | Restricted::Same => field,
            };
            if depth == HALVINGS {
                kept = kept.union(region);
                continue;
            }
            let middle = region.center();
            for corner in region.corners() {
                left.push((Aabb::from_corners(middle, corner), depth + 1, field.clone()));
            }
        }
        kept
    }
}

fn check(form: BlobForm, threshold: f64, blobs: &[Blob], exec: &Exec) -> Result<(), BlobsError> {
    let names = form.parameters();
    let (mut above, mut sizes) = (0.0, 0.0);
    for (index, blob) in blobs.iter().enumerate() {
        if index % 4096 == 0 {
            exec.check()?;
        }
        if let Some(found) = blob.center.to_array().into_iter().find(|value| !value.is_finite()) {
            return Err(BlobsError::Center { index, found });
        }
        let [first, second] = blob.parameters;
        let expect = |place: usize, holds: bool, expected: &'static str| {
            let (parameter, found) = (names[place], blob.parameters[place]);
            if holds { Ok(()) } else { Err(BlobsError::Parameter { index, parameter, found, expected }) }
        };
        let strength = |value: f64| value.is_finite() && value != 0.0;
        let radius = |value: f64| (1e-300..=1e300).contains(&value);
        let peak = match form {
            BlobForm::Blinn => {
                expect(0, strength(first), "a finite number other than 0")?;
                expect(1, second > 0.0 && second.is_finite(), "a finite number above 0")?;
                first
            }
            BlobForm::Blobby => {
                expect(0, radius(first), "a number from 1e-300 to 1e300")?;
                expect(1, second > 0.0 && second <= 64.0, "a number above 0, at most 64 (in Blinn's words negative)")?;
                second.exp()
            }
            BlobForm::Metaballs | BlobForm::SoftObjects => {
                expect(0, radius(first), "a number from 1e-300 to 1e300")?;
                expect(1, strength(second), "a finite number other than 0")?;
                second
            }
        };
        above += peak.max(0.0);
        sizes += peak.abs();
    }
    if sizes.is_nan() || sizes > 1e37 {
        return Err(BlobsError::Strength { found: sizes });
    }
    if threshold >= above {
        return Err(BlobsError::Unreachable { threshold, peaks: above });
    }
    Ok(())
}

impl Field for Blobs {
    fn value(&self, point: DVec3) -> f64 {
        self.sum.value(point)
    }

    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        self.sum.values(origin, x, y, z, out);
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        self.sum.gradient(point)
    }

    fn range(&self, region: &Aabb) -> Interval {
        self.sum.range(region)
    }

    fn lipschitz(&self) -> Option<f64> {
        self.sum.lipschitz()
    }

    fn restrict(&self, region: &Aabb) -> Restricted {
        self.sum.restrict(region)
    }
}
