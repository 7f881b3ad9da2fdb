//! Simpler programs for parts of space.

use std::sync::Arc;

use super::interval::{Trace, chooses};
use super::step::{Call, Step};
use super::{Program, Value};
use crate::operator::Choice;
use crate::tree::Nature;

impl Program {
    /// The program without what a box's trace shows to play no part there (Keeter, 2020; Duff, 1992). Inside the box its values
    /// are those of the whole program, to the bit.
    ///
    /// The trace must come from this program.
    pub fn simplified(&self, trace: Trace<'_>) -> Self {
        let parts = &*self.0;
        let result = parts.result.index();
        let mut needed = vec![false; parts.steps.len()];
        needed[result] = true;
        // What a step's value is instead; itself where nothing was decided.
        let mut instead: Vec<u32> = (0..parts.steps.len() as u32).collect();
        let mut choices = trace.0.iter().rev();
        for (i, step) in parts.steps.iter().enumerate().rev() {
            let choice = if chooses(step) { choices.next() } else { None };
            if !needed[i] {
                continue;
            }
            let chosen = match (*step, choice) {
                (Step::Binary(_, a, _), Some(Choice::Left)) => a,
                (Step::Binary(_, _, b), Some(Choice::Right)) => b,
                _ => {
                    step.operands().for_each(|operand| needed[operand.index()] = true);
                    continue;
                }
            };
            needed[chosen.index()] = true;
            instead[i] = chosen.0;
        }
        let is_kept = |i: usize, instead: &[u32]| needed[i] && instead[i] as usize == i;
        // From here on the places of values among the steps that are kept.
        let mut kept = Vec::with_capacity(needed.iter().filter(|needed| **needed).count());
        let mut kept_calls = KeptCalls::new(&parts.calls);
        for (i, step) in parts.steps.iter().enumerate().filter(|(i, _)| needed[*i]) {
            if is_kept(i, &instead) {
                kept.push(kept_calls.keep(step.with_operands(|value| Value(instead[value.index()]))));
                instead[i] = kept.len() as u32 - 1;
            } else {
                instead[i] = instead[instead[i] as usize];
            }
        }
        Self::new(kept, kept_calls.kept, Value(instead[result]), parts.nature)
    }

    /// The program of those steps alone that the result needs.
    pub(super) fn compact(steps: &[Step], calls: &[Call], result: Value, nature: Nature) -> Self {
        let mut needed = vec![false; steps.len()];
        needed[result.index()] = true;
        for (i, step) in steps.iter().enumerate().rev() {
            if needed[i] {
                step.operands().for_each(|operand| needed[operand.index()] = true);
            }
        }
        let mut place = vec![Value(0); steps.len()];
        let mut kept: Vec<Step> = Vec::new();
        let mut kept_calls = KeptCalls::new(calls);
        for (i, step) in steps.iter().enumerate().filter(|(i, _)| needed[*i]) {
            place[i] = Value(kept.len() as u32);
            kept.push(kept_calls.keep(step.with_operands(|value| place[value.index()])));
        }
        Self::new(kept, kept_calls.kept, place[result.index()], nature)
    }

    /// The same program with other fields in place of those it calls. Values inside the box stay as they are.
    pub(super) fn with_calls(&self, calls: Vec<Call>) -> Self {
        let parts = &*self.0;
        Self(Arc::new(super::Parts {
            steps: parts.steps.clone(),
            codes: parts.codes.clone(),
            calls,
            result: parts.result,
            tape: parts.tape.clone(),
            choices: parts.choices,
            nature: parts.nature,
        }))
    }
}

/// The calls that remain, renumbered.
struct KeptCalls<'a> {
    all: &'a [Call],
    place: Vec<u32>,
    kept: Vec<Call>,
}

impl<'a> KeptCalls<'a> {
    fn new(all: &'a [Call]) -> Self {
        Self { all, place: vec![u32::MAX; all.len()], kept: Vec::new() }
    }

    fn keep(&mut self, mut step: Step) -> Step {
        if let Step::Call(call, _) = &mut step {
            let at = &mut self.place[*call as usize];
            if *at == u32::MAX {
                *at = self.kept.len() as u32;
                self.kept.push(self.all[*call as usize].clone());
            }
            *call = *at;
        }
        step
    }
}

impl Step {
    #[inline(always)]
    fn with_operands(self, place: impl Fn(Value) -> Value) -> Self {
        match self {
            Self::Constant(_) | Self::Linear(_) => self,
            Self::Unary(operator, a) => Self::Unary(operator, place(a)),
            Self::Binary(operator, a, b) => Self::Binary(operator, place(a), place(b)),
            Self::Power(a, exponent) => Self::Power(place(a), exponent),
            Self::Call(call, at) => Self::Call(call, at.map(place)),
        }
    }
}
