//! Every crossing of a ray, by intervals.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Bounds as OptionBounds, Exec, Field, Interval, Options, Ray, Restricted, options};

use super::bounds::{Bounds, reach};
use super::root::side_change;
use super::survey::AsField;
use super::{Certainty, QueryError, Side};

options! {
    /// Every place where a ray crosses the surface of a field, by interval arithmetic (Mitchell, 1990).
    ///
    /// The ray is halved until the field's bounds over the box of a piece show one side, or the piece is shorter than the tolerance. Every
    /// zero within the reach lies in the interval of one of the crossings found: that is proven as far as the field's
    /// bounds are. That there is one crossing alone in an interval is not.
    pub struct RayIntervals("ray-intervals") {
        required {
            /// The length along the ray below which a piece is not divided. What lies closer together may be told as one.
            tolerance: f64 [OptionBounds::POSITIVE],
        }
        optional {
            /// How many pieces are looked at. What is left then is told as one unresolved interval.
            max_steps: u32 [OptionBounds::closed(1.0, 1e9)] = 100_000,
        }
    }
}

/// How a ray passes the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossingKind {
    /// From outside to inside.
    Entering,
    /// From inside to outside.
    Leaving,
    /// The same side before and after, or a side that is not known: the ray touches the surface, passes it twice within the
    /// tolerance, runs along it or starts on it, or misses it by less than bounds can tell.
    Unresolved,
}

/// A place where a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCrossing {
    /// The distance along the ray: where the side changes, to a few units in the last place; where it does not, the place of the value next
    /// to 0 among some.
    pub distance: f64,
    /// Every zero near this one lies in here.
    pub interval: Interval,
    /// The point.
    pub point: DVec3,
    /// The unit normal outward; zero where the field has no gradient.
    pub normal: DVec3,
    /// The side before the interval; none where the ray starts on the surface.
    pub before: Option<Side>,
    /// The side behind the interval; none where the ray ends on the surface.
    pub after: Option<Side>,
    /// Whether the sides before and behind are proven.
    pub certainty: Certainty,
}

impl RayCrossing {
    /// How the ray passes.
    pub fn kind(&self) -> CrossingKind {
        match (self.before, self.after) {
            (Some(Side::Outside), Some(Side::Inside)) => CrossingKind::Entering,
            (Some(Side::Inside), Some(Side::Outside)) => CrossingKind::Leaving,
            _ => CrossingKind::Unresolved,
        }
    }
}

/// Where a ray meets the surface, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct RayCrossings {
    /// The places. Their intervals do not overlap but at ends.
    pub crossings: Vec<RayCrossing>,
    /// Whether the whole reach was looked at; if not, the last interval holds all that is left.
    pub complete: bool,
    /// How many pieces were looked at.
    pub steps: u32,
}

impl RayCrossings {
    /// The places where the side changes.
    pub fn changes(&self) -> impl Iterator<Item = &RayCrossing> {
        self.crossings.iter().filter(|crossing| crossing.kind() != CrossingKind::Unresolved)
    }
}

impl RayIntervals {
    /// Every place where the ray meets the surface within its reach.
    ///
    /// # Errors
    /// Options out of range, a reach that is not finite, or stopped.
    pub fn intersect<F: Field + ?Sized>(&self, field: &F, ray: &Ray, exec: &Exec) -> Result<RayCrossings, QueryError> {
        self.run(field, ray, exec, |_| false)
    }

    /// The first place where the side changes: what [`RayIntervals::intersect`] has as its first change, found without the rest.
    ///
    /// # Errors
    /// As [`RayIntervals::intersect`].
    pub fn first_change<F: Field + ?Sized>(
        &self,
        field: &F,
        ray: &Ray,
        exec: &Exec,
    ) -> Result<Option<RayCrossing>, QueryError> {
        let found = self.run(field, ray, exec, |crossing| crossing.kind() != CrossingKind::Unresolved)?;
        Ok(found.changes().next().copied())
    }

    fn run<F: Field + ?Sized>(
        &self,
        field: &F,
        ray: &Ray,
        exec: &Exec,
        enough: impl Fn(&RayCrossing) -> bool,
    ) -> Result<RayCrossings, QueryError> {
        self.validate()?;
        let Interval { lo, hi } = ray.reach;
        if !(lo.is_finite() && hi.is_finite() && lo <= hi) {
            return Err(QueryError::Reach { found: ray.reach });
        }
        let mut walk =
            Walk { bounds: Bounds::new(field), ray, tolerance: self.tolerance, open: None, found: Vec::new() };
        let (mut pieces, mut steps, mut complete) = (vec![Piece { span: ray.reach, part: None }], 0_u32, true);
        let mut last = walk.bounds.side_at(ray.at(lo));
        while let Some(piece) = pieces.pop() {
            if walk.found.iter().any(&enough) {
                return Ok(RayCrossings { crossings: walk.found, complete: false, steps });
            }
            if steps.is_multiple_of(256) {
                exec.check()?;
            }
            if steps >= self.max_steps {
                complete = false;
                walk.absorb(Interval::new(piece.span.lo, hi), last);
                break;
            }
            steps += 1;
            let (side, simpler) = walk.look(&piece);
            if let Some(side) = side {
                last = Some((side, true));
                walk.close(last);
                continue;
            }
            let Interval { lo: a, hi: b } = piece.span;
            let middle = a + (b - a) * 0.5;
            // The more pieces an unresolved stretch has, the longer its pieces may be: at a double root or along a face there would be
            // millions else. With the square of their number a face of 10⁷ tolerances takes 10⁴, and the stretch at a double root
            // grows a few times; in proportion to the stretch it would take fewer, and grow a hundred times.
            let growth = walk.open.as_ref().map_or(0.0, |open| f64::from(open.pieces) / 256.0);
            let fine = self.tolerance * (growth * growth).max(1.0);
            if b - a <= fine || middle <= a || middle >= b {
                walk.absorb(piece.span, last);
            } else {
                let part = simpler.or(piece.part);
                pieces.push(Piece { span: Interval::new(middle, b), part: part.clone() });
                pieces.push(Piece { span: Interval::new(a, middle), part });
            }
        }
        let end = walk.bounds.side_at(ray.at(hi));
        walk.close(end);
        Ok(RayCrossings { crossings: walk.found, complete, steps })
    }
}

struct Piece {
    span: Interval,
    /// The field restricted to something around the piece.
    part: Option<Arc<dyn Field>>,
}

/// An unresolved stretch that goes on.
struct Open {
    span: Interval,
    pieces: u32,
    before: Option<(Side, bool)>,
}

struct Walk<'a, F: ?Sized> {
    bounds: Bounds<'a, F>,
    ray: &'a Ray,
    tolerance: f64,
    open: Option<Open>,
    found: Vec<RayCrossing>,
}

impl<F: Field + ?Sized> Walk<'_, F> {
    /// The side of a piece if it lies on one, else the field restricted to it if that is simpler.
    fn look(&self, piece: &Piece) -> (Option<Side>, Option<Arc<dyn Field>>) {
        let Interval { lo, hi } = piece.span;
        // Rounding is monotonous: the points computed between lie in the box of the points computed at the ends.
        let region = Aabb::from_corners(self.ray.at(lo), self.ray.at(hi));
        let restricted = match &piece.part {
            Some(part) => part.restrict(&region),
            None => AsField(self.bounds.field).restrict(&region),
        };
        match restricted {
            Restricted::Positive => (Some(Side::Outside), None),
            Restricted::Negative => (Some(Side::Inside), None),
            other => {
                let middle = self.ray.at(lo + (hi - lo) * 0.5);
                let side = Side::of_bounds(self.bounds.by_slope(middle, reach(&region, middle)));
                let simpler = if let Restricted::Simpler(part) = other { Some(part) } else { None };
                (side, simpler)
            }
        }
    }

    fn absorb(&mut self, span: Interval, before: Option<(Side, bool)>) {
        match &mut self.open {
            Some(open) => {
                open.span.hi = span.hi;
                open.pieces = open.pieces.saturating_add(1);
            }
            None => self.open = Some(Open { span, pieces: 1, before }),
        }
    }

    /// Tells what lies in the stretch that ends here.
    fn close(&mut self, after: Option<(Side, bool)>) {
        let Some(Open { span, before, .. }) = self.open.take() else { return };
        // Sides at some places between may show more than one crossing.
        let samples = (span.length() / self.tolerance).ceil().clamp(1.0, 256.0) as u32;
        let mut known = (span.lo, before);
        let mut start = span.lo;
        let mut changes = Vec::new();
        for sample in 1..=samples {
            let place = span.at(f64::from(sample) / f64::from(samples));
            let side = if sample == samples { after } else { self.bounds.side_at(self.ray.at(place)) };
            let Some((now, _)) = side else { continue };
            if let Some((was, _)) = known.1
                && was != now
            {
                changes.push((Interval::new(start, place), known, (place, side)));
                start = place;
            }
            known = (place, side);
        }
        if let Some((last, ..)) = changes.last_mut() {
            last.hi = span.hi;
        } else {
            let at = self.least(span);
            self.tell(at, span, before, after);
        }
        for (interval, (from, was), (to, now)) in changes {
            let value = |place: f64| self.bounds.field.value(self.ray.at(place));
            let at = side_change(value, (from, value(from)), (to, value(to)));
            self.tell(at, interval, was, now);
        }
    }

    /// The place of the value next to 0 among some.
    fn least(&self, span: Interval) -> f64 {
        let size = |place: f64| self.bounds.field.value(self.ray.at(place)).abs();
        let mut best = (f64::INFINITY, span.at(0.5));
        let mut around = span;
        for _ in 0..16 {
            for part in 0..=8 {
                let place = around.at(f64::from(part) / 8.0);
                let size = size(place);
                if size < best.0 {
                    best = (size, place);
                }
            }
            let quarter = around.length() * 0.25;
            around = Interval::new((best.1 - quarter).max(span.lo), (best.1 + quarter).min(span.hi));
        }
        best.1
    }

    fn tell(&mut self, distance: f64, interval: Interval, before: Option<(Side, bool)>, after: Option<(Side, bool)>) {
        let proven = before.is_some_and(|side| side.1) && after.is_some_and(|side| side.1);
        let point = self.ray.at(distance);
        self.found.push(RayCrossing {
            distance,
            interval,
            point,
            normal: self.bounds.field.gradient(point).normalize_or_zero(),
            before: before.map(|side| side.0),
            after: after.map(|side| side.0),
            certainty: Certainty::proven_if(proven),
        });
    }
}

#[cfg(test)]
#[path = "ray_tests.rs"]
mod tests;
