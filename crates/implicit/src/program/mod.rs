//! Compiled fields: what evaluators run.

mod batch;
pub(crate) mod builder;
mod compile;
mod field;
mod interval;
mod point;
mod registers;
mod restrict;
mod step;

use std::fmt;
use std::sync::{Arc, OnceLock};

pub use batch::BatchEvaluator;
pub use compile::{CompileError, ParameterError};
pub use interval::{IntervalEvaluator, Trace};
pub use point::PointEvaluator;

use crate::tree::Nature;
use registers::Tape;
use step::Call;
pub(crate) use step::{Linear, Step};

/// The result of a step, by the step's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Value(pub(crate) u32);

impl Value {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// A compiled field: a straight line of steps over numbers, ready to be evaluated by any number of threads at once.
///
/// Cheap to clone. Evaluators hold the memory that a run needs: one for each thread, reused from call to call. As a
/// [`Field`](shapeloom_core::Field) it keeps them itself.
#[derive(Clone)]
pub struct Program(Arc<Parts>);

struct Parts {
    steps: Vec<Step>,
    /// Of each step, for bounds.
    codes: Vec<interval::Code>,
    calls: Vec<Call>,
    result: Value,
    /// Made when values are first asked for in batches: most simplified programs are asked for bounds alone.
    tape: OnceLock<Tape>,
    choices: usize,
    nature: Nature,
}

impl Parts {
    fn tape(&self) -> &Tape {
        self.tape.get_or_init(|| Tape::new(&self.steps, self.result))
    }
}

impl Program {
    fn new(steps: Vec<Step>, calls: Vec<Call>, result: Value, nature: Nature) -> Self {
        let choices = steps.iter().filter(|step| interval::chooses(step)).count();
        let codes = steps.iter().map(interval::Code::of).collect();
        Self(Arc::new(Parts { steps, codes, calls, result, tape: OnceLock::new(), choices, nature }))
    }

    /// The steps, and which of them is the result.
    pub(crate) fn steps(&self) -> (&[Step], Value) {
        (&self.0.steps, self.0.result)
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.0.steps.len()
    }

    /// Whether there is no step. Never so.
    pub fn is_empty(&self) -> bool {
        self.0.steps.is_empty()
    }

    /// How many numbers of a point must be kept at once while batches are evaluated.
    pub fn register_count(&self) -> usize {
        self.0.tape().registers
    }

    /// How many of the steps choose one of their operands: minima, maxima and logical operators.
    pub fn choice_count(&self) -> usize {
        self.0.choices
    }

    /// About how much memory it takes, in bytes; not that of the fields that it calls.
    pub fn memory_bytes(&self) -> usize {
        let Parts { steps, tape, calls, .. } = &*self.0;
        let tape = tape
            .get()
            .map_or(0, |tape| size_of_val(tape.instructions.as_slice()) + size_of_val(tape.linears.as_slice()));
        size_of_val(steps.as_slice()) + tape + size_of_val(calls.as_slice())
    }

    /// What is known of the values.
    pub fn nature(&self) -> Nature {
        self.0.nature
    }
}

impl fmt::Debug for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Program({} steps, {} registers)", self.len(), self.register_count())
    }
}
