//! From trees to steps.

use std::collections::HashMap;
use std::fmt::Write;

use super::VmWriteError;
use crate::operator::{Binary, Unary};
use crate::program::{Linear, Step};
use crate::tree::{Operation, Tree, post_order};

/// The tree as a list of arithmetic steps: those of its program.
///
/// [`parse_vm`](super::parse_vm) reads it back to a tree of the same values up to rounding; names, and what the parts
/// mean, are lost. `pow` is an opcode that other programs may not know; it stands only where the tree has powers that
/// are not whole.
///
/// # Errors
/// A field from elsewhere, or a tree that does not compile.
pub fn print_vm(tree: &Tree) -> Result<String, VmWriteError> {
    let program = tree.compile().map_err(VmWriteError::Compile)?;
    let (steps, result) = program.steps();
    let mut writer = Writer::default();
    let mut names = Vec::new();
    for step in steps {
        let of = |value: crate::program::Value| names.get(value.index()).copied().unwrap_or(0);
        let name = match *step {
            Step::Constant(value) => writer.constant(value),
            Step::Linear(linear) => writer.linear(linear),
            Step::Unary(operator, a) => writer.unary(operator, of(a)),
            Step::Binary(operator, a, b) => writer.binary(operator, of(a), of(b)),
            Step::Power(a, exponent) => writer.power(of(a), exponent),
            Step::Call(..) => return Err(VmWriteError::Foreign { source: foreign(tree) }),
        };
        names.push(name);
    }
    let result = names.get(result.index()).copied().unwrap_or(0);
    if result + 1 != writer.count {
        // The last line is the field.
        let zero = writer.constant(0.0);
        writer.binary(Binary::Add, result, zero);
    }
    Ok(writer.out)
}

/// The words of the first field from elsewhere.
fn foreign(tree: &Tree) -> String {
    let mut sources = post_order(tree).into_iter().filter_map(|tree| match tree.operation() {
        Operation::Foreign(foreign) => Some(foreign.source().to_owned()),
        Operation::Blobs(blobs) => Some(format!("{}(...)", blobs.form().name())),
        _ => None,
    });
    sources.next().unwrap_or_default()
}

#[derive(Default)]
struct Writer {
    out: String,
    count: usize,
    constants: HashMap<u64, usize>,
    coordinates: [Option<usize>; 3],
}

impl Writer {
    fn line(&mut self, rest: std::fmt::Arguments<'_>) -> usize {
        let _ = writeln!(self.out, "_{:x} {rest}", self.count);
        self.count += 1;
        self.count - 1
    }

    fn constant(&mut self, value: f64) -> usize {
        if let Some(&known) = self.constants.get(&value.to_bits()) {
            return known;
        }
        let name = self.line(format_args!("const {value:?}"));
        self.constants.insert(value.to_bits(), name);
        name
    }

    fn coordinate(&mut self, axis: usize) -> usize {
        if let Some(Some(known)) = self.coordinates.get(axis) {
            return *known;
        }
        let name = self.line(format_args!("var-{}", ["x", "y", "z"].get(axis).copied().unwrap_or("x")));
        if let Some(slot) = self.coordinates.get_mut(axis) {
            *slot = Some(name);
        }
        name
    }

    fn unary(&mut self, operator: Unary, a: usize) -> usize {
        self.line(format_args!("{} _{a:x}", operator.name()))
    }

    fn binary(&mut self, operator: Binary, a: usize, b: usize) -> usize {
        self.line(format_args!("{} _{a:x} _{b:x}", operator.name()))
    }

    /// In the order in which programs add.
    fn linear(&mut self, linear: Linear) -> usize {
        let mut sum = (linear.offset != 0.0).then(|| self.constant(linear.offset));
        for (axis, slope) in linear.slope.to_array().into_iter().enumerate() {
            if slope == 0.0 {
                continue;
            }
            let mut part = self.coordinate(axis);
            if slope == -1.0 && sum.is_none() {
                part = self.unary(Unary::Negate, part);
            } else if slope != 1.0 {
                let slope = self.constant(slope);
                part = self.binary(Binary::Multiply, part, slope);
            }
            sum = Some(match sum {
                Some(sum) => self.binary(Binary::Add, sum, part),
                None => part,
            });
        }
        sum.unwrap_or_else(|| self.constant(linear.offset))
    }

    /// By repeated squaring, as programs compute it.
    fn power(&mut self, base: usize, exponent: i32) -> usize {
        let mut left = exponent.unsigned_abs();
        let (mut square, mut product) = (base, None);
        while left > 0 {
            if left & 1 == 1 {
                product = Some(match product {
                    Some(product) => self.binary(Binary::Multiply, product, square),
                    None => square,
                });
            }
            left >>= 1;
            if left > 0 {
                square = self.unary(Unary::Square, square);
            }
        }
        let up = product.unwrap_or_else(|| self.constant(1.0));
        if exponent < 0 { self.unary(Unary::Reciprocal, up) } else { up }
    }
}
