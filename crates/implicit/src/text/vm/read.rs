//! From steps to trees.

use std::collections::HashMap;

use super::{VmError, VmProblem};
use crate::operator::{Binary, Unary};
use crate::text::error::shortened;
use crate::text::names::nearest;
use crate::tree::Tree;

/// The most steps: as many as a program may have.
const MOST: usize = 1 << 21;

/// Reads a list of steps; the last is the field.
///
/// # Errors
/// The first line that is wrong.
pub fn parse_vm(text: &[u8]) -> Result<Tree, VmError> {
    let utf8 = std::str::from_utf8(text).map_err(|error| {
        let line = crate::text::error::line_of(text, error.valid_up_to());
        VmError { line, problem: VmProblem::Encoding }
    })?;
    let mut steps: HashMap<&str, Tree> = HashMap::new();
    let mut last = None;
    let mut line = 0;
    for content in utf8.lines() {
        line += 1;
        let mut words = content.split_ascii_whitespace();
        let Some(name) = words.next().filter(|word| !word.starts_with('#')) else { continue };
        let fault = |problem| VmError { line, problem };
        let opcode = words.next().unwrap_or("");
        let tree = step(opcode, words, &steps).map_err(fault)?;
        if steps.len() == MOST {
            return Err(fault(VmProblem::TooLarge { most: MOST }));
        }
        if steps.insert(name, tree.clone()).is_some() {
            return Err(fault(VmProblem::Twice { name: shortened(name) }));
        }
        last = Some(tree);
    }
    last.ok_or(VmError { line: line.max(1), problem: VmProblem::Empty })
}

fn step<'a>(
    opcode: &str,
    words: impl Iterator<Item = &'a str>,
    steps: &HashMap<&str, Tree>,
) -> Result<Tree, VmProblem> {
    let coordinate = match opcode {
        "var-x" => Some(Tree::x()),
        "var-y" => Some(Tree::y()),
        "var-z" => Some(Tree::z()),
        _ => None,
    };
    let find = |name: &str| {
        steps
            .get(name)
            .cloned()
            .ok_or_else(|| VmProblem::Name { found: shortened(name), nearest: nearest(name, steps.keys().copied()) })
    };
    if let Some(tree) = coordinate {
        let [] = operands(opcode, words)?;
        return Ok(tree);
    }
    if opcode == "const" {
        let [written] = operands(opcode, words)?;
        return constant(written);
    }
    if let Some(operator) = Unary::from_name(opcode) {
        let [a] = operands(opcode, words)?;
        return Ok(find(a)?.unary(operator));
    }
    if let Some(operator) = Binary::from_name(opcode) {
        let [a, b] = operands(opcode, words)?;
        return Ok(find(a)?.binary(operator, find(b)?));
    }
    let known = Unary::ALL.map(Unary::name).into_iter().chain(Binary::ALL.map(Binary::name));
    let nearest = nearest(opcode, known.chain(["const", "var-x", "var-y", "var-z"]));
    Err(VmProblem::Opcode { found: shortened(opcode), nearest })
}

fn operands<'a, const N: usize>(opcode: &str, words: impl Iterator<Item = &'a str>) -> Result<[&'a str; N], VmProblem> {
    let mut found = 0;
    let mut operands = [""; N];
    for word in words {
        if let Some(operand) = operands.get_mut(found) {
            *operand = word;
        }
        found += 1;
    }
    if found == N { Ok(operands) } else { Err(VmProblem::Operands { opcode: opcode.to_owned(), found, expected: N }) }
}

/// `inf` and `NaN` are numbers here, but digits that are too many are none.
fn constant(written: &str) -> Result<Tree, VmProblem> {
    let wanted = !written.bytes().any(|byte| byte.is_ascii_digit());
    match written.parse::<f64>() {
        Ok(value) if value.is_finite() || wanted => Ok(value.into()),
        _ => Err(VmProblem::Number { found: shortened(written) }),
    }
}
