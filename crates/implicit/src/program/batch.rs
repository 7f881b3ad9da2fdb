//! Many values at once, in single precision.

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;

use super::Program;
use super::registers::{Instruction, Tape};
use super::step::{Call, Linear};
use crate::operator::{Binary, Unary};
use crate::power::power_f32;

/// How many points pass through an instruction at once. So many that choosing the instruction costs little beside them, so few that
/// the registers of large programs stay in the first cache.
pub(crate) const LANES: usize = 128;

type Lanes = [f32; LANES];

/// Evaluates programs at many points in single precision. One for each thread; it keeps its memory from call to call and serves any
/// program.
#[derive(Clone, Debug, Default)]
pub struct BatchEvaluator {
    registers: Vec<Lanes>,
    linears: Vec<LinearLanes>,
    coordinates: Box<[Lanes]>,
}

/// A linear step for one origin: the offset is added up in double precision first.
#[derive(Clone, Copy, Debug)]
struct LinearLanes {
    slope: [f32; 3],
    offset: f32,
}

impl BatchEvaluator {
    /// An evaluator without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The values at points given relative to `origin`. Linear steps are taken relative to it too, so that shapes far from the
    /// world's origin keep their precision where the points lie near `origin`.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn values(&mut self, program: &Program, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let parts = &*program.0;
        let tape = parts.tape();
        if self.registers.len() < tape.registers {
            self.registers.resize(tape.registers, [0.0; LANES]);
        }
        if self.coordinates.is_empty() {
            self.coordinates = vec![[0.0; LANES]; 3].into_boxed_slice();
        }
        self.linears.clear();
        self.linears.extend(tape.linears.iter().map(|linear| LinearLanes {
            slope: linear.slope.to_array().map(|slope| slope as f32),
            offset: linear.at(origin) as f32,
        }));
        for start in (0..out.len()).step_by(LANES) {
            let count = LANES.min(out.len() - start);
            for (lanes, given) in self.coordinates.iter_mut().zip([x, y, z]) {
                lanes[..count].copy_from_slice(&given[start..start + count]);
                // The rest of the lanes are computed and thrown away; they take a point that is there.
                let last = lanes[count - 1];
                lanes[count..].fill(last);
            }
            run(tape, &parts.calls, &self.linears, &self.coordinates, origin, &mut self.registers);
            out[start..start + count].copy_from_slice(&self.registers[tape.result as usize][..count]);
        }
    }
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn run(
    tape: &Tape,
    calls: &[Call],
    linears: &[LinearLanes],
    coordinates: &[Lanes],
    origin: DVec3,
    registers: &mut [Lanes],
) {
    let [x, y, z] = coordinates else { return };
    for instruction in &tape.instructions {
        match *instruction {
            Instruction::Load(out, number) => registers[out as usize] = [number; LANES],
            Instruction::Linear(out, index) => {
                linear(&linears[index as usize], [x, y, z], &mut registers[out as usize])
            }
            Instruction::Unary(operator, out, a) => {
                if let Ok([out, a]) = registers.get_disjoint_mut([out as usize, a as usize]) {
                    unary(operator, out, a);
                }
            }
            Instruction::Power(out, a, exponent) => {
                if let Ok([out, a]) = registers.get_disjoint_mut([out as usize, a as usize]) {
                    each(out, |i| power_f32(a[i], exponent));
                }
            }
            Instruction::Binary(operator, out, a, b) if a == b => {
                if let Ok([out, a]) = registers.get_disjoint_mut([out as usize, a as usize]) {
                    binary(operator, out, |i| a[i], |i| a[i]);
                }
            }
            Instruction::Binary(operator, out, a, b) => {
                if let Ok([out, a, b]) = registers.get_disjoint_mut([out as usize, a as usize, b as usize]) {
                    binary(operator, out, |i| a[i], |i| b[i]);
                }
            }
            Instruction::WithNumber(operator, out, a, number) => {
                if let Ok([out, a]) = registers.get_disjoint_mut([out as usize, a as usize]) {
                    binary(operator, out, |i| a[i], |_| number);
                }
            }
            Instruction::NumberWith(operator, out, number, b) => {
                if let Ok([out, b]) = registers.get_disjoint_mut([out as usize, b as usize]) {
                    binary(operator, out, |_| number, |i| b[i]);
                }
            }
            Instruction::Call(out, call, place) => {
                call_field(&calls[call as usize], origin, [x, y, z], out, place, registers)
            }
        }
    }
}

#[inline(always)]
fn each(out: &mut Lanes, value: impl Fn(usize) -> f32) {
    for (i, out) in out.iter_mut().enumerate() {
        *out = value(i);
    }
}

#[inline(always)]
fn linear(linear: &LinearLanes, [x, y, z]: [&Lanes; 3], out: &mut Lanes) {
    let LinearLanes { slope: [a, b, c], offset } = *linear;
    match [a != 0.0, b != 0.0, c != 0.0] {
        [true, false, false] => each(out, |i| a * x[i] + offset),
        [false, true, false] => each(out, |i| b * y[i] + offset),
        [false, false, true] => each(out, |i| c * z[i] + offset),
        [true, true, false] => each(out, |i| a * x[i] + b * y[i] + offset),
        _ => each(out, |i| a * x[i] + b * y[i] + c * z[i] + offset),
    }
}

#[inline(always)]
fn unary(operator: Unary, out: &mut Lanes, a: &Lanes) {
    match operator {
        Unary::Negate => each(out, |i| -a[i]),
        Unary::Absolute => each(out, |i| a[i].abs()),
        Unary::Reciprocal => each(out, |i| 1.0 / a[i]),
        Unary::SquareRoot => each(out, |i| a[i].sqrt()),
        Unary::Square => each(out, |i| a[i] * a[i]),
        Unary::Sine => each(out, |i| a[i].sin()),
        Unary::Cosine => each(out, |i| a[i].cos()),
        Unary::Tangent => each(out, |i| a[i].tan()),
        Unary::ArcSine => each(out, |i| a[i].asin()),
        Unary::ArcCosine => each(out, |i| a[i].acos()),
        Unary::ArcTangent => each(out, |i| a[i].atan()),
        Unary::Exponential => each(out, |i| a[i].exp()),
        Unary::Logarithm => each(out, |i| a[i].ln()),
        Unary::Not => each(out, |i| f32::from(u8::from(a[i] == 0.0))),
        Unary::Floor => each(out, |i| a[i].floor()),
        Unary::Ceiling => each(out, |i| a[i].ceil()),
        Unary::Round => each(out, |i| a[i].round()),
    }
}

#[inline(always)]
fn binary(operator: Binary, out: &mut Lanes, a: impl Fn(usize) -> f32, b: impl Fn(usize) -> f32) {
    match operator {
        Binary::Add => each(out, |i| a(i) + b(i)),
        Binary::Subtract => each(out, |i| a(i) - b(i)),
        Binary::Multiply => each(out, |i| a(i) * b(i)),
        Binary::Divide => each(out, |i| a(i) / b(i)),
        Binary::Minimum => each(out, |i| if a(i) < b(i) || b(i).is_nan() { a(i) } else { b(i) }),
        Binary::Maximum => each(out, |i| if a(i) > b(i) || b(i).is_nan() { a(i) } else { b(i) }),
        Binary::Compare => each(out, |i| a(i).partial_cmp(&b(i)).map_or(f32::NAN, |order| f32::from(order as i8))),
        Binary::Modulo => each(out, |i| a(i).rem_euclid(b(i))),
        Binary::And => each(out, |i| if a(i) == 0.0 { a(i) } else { b(i) }),
        Binary::Or => each(out, |i| if a(i) == 0.0 { b(i) } else { a(i) }),
        Binary::ArcTangent2 => each(out, |i| a(i).atan2(b(i))),
        Binary::Power => each(out, |i| a(i).powf(b(i))),
    }
}

/// Another field, at the place that the registers hold, or relative to an origin of its own.
fn call_field(call: &Call, origin: DVec3, space: [&Lanes; 3], out: u32, place: [u32; 3], registers: &mut [Lanes]) {
    let mut values = [0.0; LANES];
    match &call.map {
        Some(map) => {
            let there = map.map(|linear| linear.at(origin));
            let offsets = map.map(|Linear { slope, .. }| {
                let mut lanes = [0.0; LANES];
                let slope = slope.to_array().map(|slope| slope as f32);
                linear(&LinearLanes { slope, offset: 0.0 }, space, &mut lanes);
                lanes
            });
            call.field.values(DVec3::from_array(there), &offsets[0], &offsets[1], &offsets[2], &mut values);
        }
        None => {
            let [x, y, z] = place.map(|register| &registers[register as usize]);
            call.field.values(DVec3::ZERO, x, y, z, &mut values);
        }
    }
    registers[out as usize] = values;
}
