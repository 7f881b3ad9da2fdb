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
        let mut choices = trace.0.iter();
        let mut instead: Vec<Value> = Vec::with_capacity(parts.steps.len());
        for (i, step) in parts.steps.iter().enumerate() {
            let own = Value(i as u32);
            let chosen = match *step {
                Step::Binary(_, a, b) if chooses(step) => match choices.next() {
                    Some(Choice::Left) => instead[a.index()],
                    Some(Choice::Right) => instead[b.index()],
                    _ => own,
                },
                _ => own,
            };
            instead.push(chosen);
        }
        let steps: Vec<Step> =
            parts.steps.iter().map(|step| step.with_operands(|value| instead[value.index()])).collect();
        Self::compact(&steps, &parts.calls, instead[parts.result.index()], parts.nature)
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
        let mut call_place = vec![u32::MAX; calls.len()];
        let (mut kept, mut kept_calls): (Vec<Step>, Vec<Call>) = (Vec::new(), Vec::new());
        for (i, step) in steps.iter().enumerate().filter(|(i, _)| needed[*i]) {
            let mut step = step.with_operands(|value| place[value.index()]);
            if let Step::Call(call, _) = &mut step {
                let at = &mut call_place[*call as usize];
                if *at == u32::MAX {
                    *at = kept_calls.len() as u32;
                    kept_calls.push(calls[*call as usize].clone());
                }
                *call = *at;
            }
            place[i] = Value(kept.len() as u32);
            kept.push(step);
        }
        Self::new(kept, kept_calls, place[result.index()], nature)
    }

    /// The same program with other fields in place of those it calls. Values inside the box stay as they are.
    pub(super) fn with_calls(&self, calls: Vec<Call>) -> Self {
        let parts = &*self.0;
        Self(Arc::new(super::Parts {
            steps: parts.steps.clone(),
            calls,
            result: parts.result,
            tape: parts.tape.clone(),
            choices: parts.choices,
            nature: parts.nature,
        }))
    }
}

impl Step {
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
