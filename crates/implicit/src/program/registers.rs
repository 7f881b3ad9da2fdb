//! Which register holds which value, and for how long.

use super::Value;
use super::step::{Linear, Step};
use crate::operator::{Binary, Unary};

/// One instruction of a batch: results and operands by register, numbers by value. A result never overwrites its own operands.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Instruction {
    Load(u32, f32),
    Linear(u32, u32),
    Unary(Unary, u32, u32),
    Power(u32, u32, i32),
    /// Two registers.
    Binary(Binary, u32, u32, u32),
    /// A register and a number.
    WithNumber(Binary, u32, u32, f32),
    /// A number and a register.
    NumberWith(Binary, u32, f32, u32),
    Call(u32, u32, [u32; 3]),
}

/// The instructions of a program, with registers given to values while they are needed.
#[derive(Clone, Debug)]
pub(crate) struct Tape {
    pub(crate) instructions: Vec<Instruction>,
    pub(crate) linears: Vec<Linear>,
    pub(crate) registers: usize,
    pub(crate) result: u32,
}

const NONE: u32 = u32::MAX;

impl Tape {
    /// Linear scan: a register is free again after the last instruction that reads it.
    pub(crate) fn new(steps: &[Step], result: Value) -> Self {
        // Numbers need a register only where an instruction cannot take them as they are.
        let mut loaded = vec![false; steps.len()];
        let mut last_use = vec![0_u32; steps.len()];
        for (i, step) in steps.iter().enumerate() {
            for operand in step.operands() {
                last_use[operand.index()] = i as u32;
                if let (Step::Call(..) | Step::Unary(..) | Step::Power(..), Step::Constant(_)) =
                    (step, &steps[operand.index()])
                {
                    loaded[operand.index()] = true;
                }
            }
            if let Step::Binary(_, a, b) = step
                && let (Step::Constant(_), Step::Constant(_)) = (&steps[a.index()], &steps[b.index()])
            {
                loaded[a.index()] = true;
            }
        }
        loaded[result.index()] = true;
        last_use[result.index()] = u32::MAX;
        let mut allocation = Allocation { register_of: vec![NONE; steps.len()], free: Vec::new(), registers: 0 };
        let mut instructions = Vec::with_capacity(steps.len());
        let mut linears = Vec::new();
        for (i, step) in steps.iter().enumerate() {
            if let Step::Constant(value) = step {
                if loaded[i] {
                    instructions.push(Instruction::Load(allocation.take(i), *value as f32));
                }
                continue;
            }
            let out = allocation.take(i);
            let at = |value: Value| allocation.register_of[value.index()];
            instructions.push(match *step {
                Step::Constant(value) => Instruction::Load(out, value as f32),
                Step::Linear(linear) => {
                    linears.push(linear);
                    Instruction::Linear(out, linears.len() as u32 - 1)
                }
                Step::Unary(operator, a) => Instruction::Unary(operator, out, at(a)),
                Step::Power(a, exponent) => Instruction::Power(out, at(a), exponent),
                Step::Binary(operator, a, b) => match (&steps[a.index()], &steps[b.index()]) {
                    (_, Step::Constant(number)) => Instruction::WithNumber(operator, out, at(a), *number as f32),
                    (Step::Constant(number), _) => Instruction::NumberWith(operator, out, *number as f32, at(b)),
                    _ => Instruction::Binary(operator, out, at(a), at(b)),
                },
                Step::Call(call, place) => Instruction::Call(out, call, place.map(at)),
            });
            for operand in step.operands() {
                if last_use[operand.index()] == i as u32 {
                    allocation.give_back(operand);
                }
            }
        }
        let result = allocation.register_of[result.index()];
        Self { instructions, linears, registers: allocation.registers as usize, result }
    }
}

struct Allocation {
    /// The register of each value while it is needed.
    register_of: Vec<u32>,
    free: Vec<u32>,
    registers: u32,
}

impl Allocation {
    fn take(&mut self, step: usize) -> u32 {
        let register = self.free.pop().unwrap_or_else(|| {
            self.registers += 1;
            self.registers - 1
        });
        self.register_of[step] = register;
        register
    }

    /// Once for an operand that stands twice.
    fn give_back(&mut self, value: Value) {
        let register = std::mem::replace(&mut self.register_of[value.index()], NONE);
        if register != NONE {
            self.free.push(register);
        }
    }
}
