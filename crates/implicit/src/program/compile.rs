//! From trees to programs.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, Field};

use super::builder::{Builder, Place};
use super::{Program, Value};
use crate::operator::Unary;
pub use crate::shapes::ParameterError;
use crate::shapes::{SetOperation, stretches};
use crate::tree::{Operation, Tree};

/// The most steps that a program may have. A tree with shared parts in bent space may stand for very many more than it has nodes.
pub(crate) const MOST_STEPS: usize = 1 << 21;

/// Why a tree makes no program.
#[derive(Clone, Debug, PartialEq)]
pub enum CompileError {
    /// A parameter outside its range.
    Parameter(ParameterError),
    /// A union, intersection or difference of nothing.
    Empty {
        /// Which.
        operation: &'static str,
        /// The named part in which it stands, where there is one.
        part: Option<String>,
    },
    /// More steps than a program may have.
    TooLarge {
        /// How many there may be.
        most: usize,
    },
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => error.fmt(f),
            Self::Empty { operation, part } => {
                if let Some(part) = part {
                    write!(f, "part {part}: ")?;
                }
                write!(f, "{operation}: found no parts, expected at least one")
            }
            Self::TooLarge { most } => {
                write!(f, "implicit: found more than {most} steps once shared parts are written out, expected fewer")
            }
        }
    }
}

impl std::error::Error for CompileError {}

impl From<ParameterError> for CompileError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl Diagnostic for CompileError {
    fn code(&self) -> &'static str {
        match self {
            Self::Parameter(error) => error.code(),
            Self::Empty { .. } => "E-implicit-empty",
            Self::TooLarge { .. } => "E-implicit-steps",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Parameter(_) | Self::Empty { .. } => Category::Malformed,
            Self::TooLarge { .. } => Category::OverLimit,
        }
    }
}

impl Tree {
    /// The program that evaluates the tree.
    ///
    /// What is shared is computed once, where it is asked at the same place; affine maps are folded into the steps that read the
    /// coordinates. Takes time and memory in proportion to the steps, and no stack.
    ///
    /// # Errors
    /// A parameter outside its range, a union of nothing, or more than 2²¹ steps.
    pub fn compile(&self) -> Result<Program, CompileError> {
        self.check()?;
        let mut lowering = Lowering { builder: Builder::default(), done: HashMap::new() };
        let result = lowering.run(self)?;
        let (steps, calls) = lowering.builder.into_parts();
        Ok(Program::compact(&steps, &calls, result, self.nature()))
    }

    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// The first that is not, with the innermost named part around it.
    pub fn check(&self) -> Result<(), CompileError> {
        let mut stack: Vec<(&Tree, Option<&str>)> = vec![(self, None)];
        let mut seen = std::collections::HashSet::new();
        while let Some((tree, mut part)) = stack.pop() {
            if !seen.insert(tree.address()) {
                continue;
            }
            if let Operation::Named(name, _) = tree.operation() {
                part = Some(name);
            }
            tree.operation().check().map_err(|error| match error {
                CompileError::Parameter(error) => {
                    CompileError::Parameter(ParameterError { part: part.map(str::to_owned), ..error })
                }
                CompileError::Empty { operation, .. } => {
                    CompileError::Empty { operation, part: part.map(str::to_owned) }
                }
                other => other,
            })?;
            stack.extend(tree.operation().children().rev().map(|child| (child, part)));
        }
        Ok(())
    }
}

impl Operation {
    /// Whether the node's own parameters are in their ranges.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), CompileError> {
        match self {
            Self::Primitive(primitive) => primitive.check()?,
            Self::Blend(blend, ..) => blend.check()?,
            Self::Domain(domain, _) => domain.check()?,
            Self::Offset(distance, _) => crate::shapes::finite("offset", "distance", *distance)?,
            Self::Shell(thickness, _) => crate::shapes::positive("shell", "thickness", *thickness)?,
            Self::Set(operation, parts) if parts.is_empty() => {
                return Err(CompileError::Empty { operation: operation.name(), part: None });
            }
            Self::Transform(map, _) => {
                if let Err(error) = map.inverse() {
                    return Err(CompileError::Parameter(ParameterError {
                        operation: "transform",
                        parameter: "determinant",
                        found: error.determinant,
                        expected: "finite entries and a determinant other than 0",
                        part: None,
                    }));
                }
            }
            _ => {}
        }
        Ok(())
    }
}

struct Lowering {
    builder: Builder,
    done: HashMap<(usize, Place), Value>,
}

/// What is left to do, last first.
enum Task<'a> {
    /// Ask for the tree's value at the place.
    Enter(&'a Tree, Place),
    /// The places of a substitution are known: ask for the tree itself.
    Inside(&'a Tree, Place),
    /// All parts are known: the value of the tree.
    Leave(&'a Tree, Place),
}

impl Lowering {
    fn run(&mut self, root: &Tree) -> Result<Value, CompileError> {
        let space = self.builder.coordinates();
        let mut tasks = vec![Task::Enter(root, space)];
        while let Some(task) = tasks.pop() {
            if self.builder.len() > MOST_STEPS || self.done.len() > MOST_STEPS {
                return Err(CompileError::TooLarge { most: MOST_STEPS });
            }
            match task {
                Task::Enter(tree, place) => {
                    if self.done.contains_key(&(tree.address(), place)) {
                        continue;
                    }
                    if let Operation::Substitute(places, _) = tree.operation() {
                        tasks.push(Task::Inside(tree, place));
                        tasks.extend(places.iter().rev().map(|child| Task::Enter(child, place)));
                    } else {
                        let inner = self.place_of_children(tree, place);
                        tasks.push(Task::Leave(tree, place));
                        tasks.extend(tree.operation().children().rev().map(|child| Task::Enter(child, inner)));
                    }
                }
                Task::Inside(tree, place) => {
                    if let Operation::Substitute(_, of) = tree.operation() {
                        tasks.push(Task::Leave(tree, place));
                        tasks.push(Task::Enter(of, self.place_of_children(tree, place)));
                    }
                }
                Task::Leave(tree, place) => {
                    let value = self.value(tree, place);
                    self.done.insert((tree.address(), place), value);
                }
            }
        }
        Ok(self.known(root, space))
    }

    /// The value of a tree that was entered before.
    fn known(&self, tree: &Tree, place: Place) -> Value {
        self.done[&(tree.address(), place)]
    }

    /// Where the parts of a tree are asked. The same steps each time.
    fn place_of_children(&mut self, tree: &Tree, place: Place) -> Place {
        match tree.operation() {
            Operation::Transform(map, _) => {
                let Ok(inverse) = map.inverse() else { return place };
                let rows = inverse.linear.transpose();
                let offset = inverse.translation;
                [rows.x_axis, rows.y_axis, rows.z_axis]
                    .into_iter()
                    .zip(offset.to_array())
                    .collect::<Vec<(DVec3, f64)>>()
                    .try_into()
                    .map(|rows: [(DVec3, f64); 3]| rows.map(|(row, offset)| self.builder.linear_at(place, row, offset)))
                    .unwrap_or(place)
            }
            Operation::Domain(domain, _) => domain.lower_place(&mut self.builder, place),
            Operation::Substitute(places, _) => [0, 1, 2].map(|axis| self.known(&places[axis], place)),
            _ => place,
        }
    }

    fn value(&mut self, tree: &Tree, place: Place) -> Value {
        use Operation as O;
        let inner = self.place_of_children(tree, place);
        let of = |lowering: &Self, child: &Tree| lowering.known(child, inner);
        match tree.operation() {
            O::Constant(value) => self.builder.constant(*value),
            O::Coordinate(axis) => place[axis.index()],
            O::Unary(operator, a) => {
                let a = of(self, a);
                self.builder.unary(*operator, a)
            }
            O::Binary(operator, a, b) => {
                let (a, b) = (of(self, a), of(self, b));
                self.builder.binary(*operator, a, b)
            }
            O::Power(a, exponent) => {
                let a = of(self, a);
                self.builder.power(a, *exponent)
            }
            O::Primitive(primitive) => primitive.lower(&mut self.builder, place),
            O::Set(operation, parts) => {
                let parts: Vec<Value> = parts.iter().map(|part| of(self, part)).collect();
                self.set(*operation, &parts)
            }
            O::Complement(a) => {
                let a = of(self, a);
                self.builder.unary(Unary::Negate, a)
            }
            O::Blend(blend, a, b) => {
                let (a, b) = (of(self, a), of(self, b));
                blend.lower(&mut self.builder, a, b)
            }
            O::Offset(distance, a) => {
                let a = of(self, a);
                self.builder.plus(a, -distance)
            }
            O::Shell(thickness, a) => {
                let a = of(self, a);
                let away = self.builder.absolute(a);
                self.builder.plus(away, -thickness / 2.0)
            }
            O::Displace(a, b) => {
                let (a, b) = (of(self, a), of(self, b));
                self.builder.add(a, b)
            }
            O::Transform(map, a) => {
                let a = of(self, a);
                self.builder.times(a, stretches(map).0)
            }
            O::Domain(domain, a) => {
                let a = of(self, a);
                domain.lower_value(&mut self.builder, place, a)
            }
            O::Substitute(_, a) | O::Named(_, a) => of(self, a),
            O::Foreign(foreign) => self.builder.call(foreign.field(), place),
            O::Blobs(blobs) => {
                let field: Arc<dyn Field> = blobs.clone();
                self.builder.call(&field, place)
            }
        }
    }

    fn set(&mut self, operation: SetOperation, parts: &[Value]) -> Value {
        let Some((&first, rest)) = parts.split_first() else {
            // Checked before.
            return self.builder.constant(f64::INFINITY);
        };
        rest.iter().fold(first, |sum, &part| match operation {
            SetOperation::Union => self.builder.minimum(sum, part),
            SetOperation::Intersection => self.builder.maximum(sum, part),
            SetOperation::Difference => {
                let outside = self.builder.negate(part);
                self.builder.maximum(sum, outside)
            }
        })
    }
}
