//! From trees to text.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use shapeloom_core::Aabb;

use super::foreign::written;
use super::number::shortest;
use super::parser::{is_reserved, is_sharing};
use super::quoted::quoted;
use super::transforms;
use super::value::{Infix, POWER, PREFIX, PRIMARY};
use crate::blobs::Blobs;
use crate::operator::{Binary, Unary};
use crate::shapes::{Blend, BlendForm, Domain, Primitive, Quadric, SetOperation};
use crate::tree::{Axis, Operation, Tree, post_order};

/// How deep an expression may be nested, and how many bytes long a part of one may be, before it gets a line of its
/// own.
const DEEPEST: usize = 16;
const LONGEST: usize = 100;

/// The tree as text of the language, with the bounds if there are some.
///
/// It reads back to an equal tree: names, numbers and fields from elsewhere included, if the parameters are in their
/// ranges. Named parts become definitions, so do shared ones and parts of deep or long expressions, under names such as
/// `_1`. The same tree gives the same text. Time and memory are in proportion to the nodes.
pub fn to_text(tree: &Tree, bounds: Option<&Aabb>) -> String {
    let order = post_order(tree);
    let mut uses: HashMap<usize, usize> = HashMap::new();
    for child in order.iter().flat_map(|tree| tree.operation().children()) {
        *uses.entry(child.address()).or_default() += 1;
    }
    let mut named = HashSet::new();
    for node in &order {
        if let Operation::Named(name, of) = node.operation()
            && is_plain(name)
        {
            named.insert(of.address());
        }
    }
    let names = HashSet::new();
    let mut printer = Printer { done: HashMap::new(), uses, named, names, generated: 0, out: String::new() };
    if let Some(bounds) = bounds {
        let corners: Vec<f64> = bounds.min.to_array().into_iter().chain(bounds.max.to_array()).collect();
        let _ = writeln!(printer.out, "bounds({});", listed(&corners));
    }
    for node in order {
        let written = printer.written(node.operation());
        let shown = printer.settled(node, tree, written);
        printer.done.insert(node.address(), shown);
    }
    let root = printer.take(tree).text;
    printer.out + &root + "\n"
}

/// An expression as text.
#[derive(Clone)]
struct Written {
    text: String,
    /// How tightly it binds.
    level: u8,
    /// The reader takes it for a number, not for a field.
    number: bool,
    /// The operation of many parts that it is, if more parts could be added behind it.
    open: Option<SetOperation>,
    depth: usize,
}

impl Written {
    fn new(text: String, level: u8, depth: usize) -> Self {
        Self { text, level, number: false, open: None, depth }
    }

    /// In parentheses unless it binds so tightly.
    fn at(self, level: u8) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text }
    }

    /// As what a method is called on.
    fn receiver(self) -> String {
        if self.number { format!("({})", self.text) } else { self.at(PRIMARY) }
    }

    /// As a field, which the reader does not compute with.
    fn field(self) -> Self {
        if self.number { Self::new(format!("constant({})", self.text), PRIMARY, self.depth) } else { self }
    }
}

/// Numbers with commas.
pub(super) fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|&value| number(value)).collect::<Vec<String>>().join(", ")
}

/// A number, finite or not, as an expression.
fn number(value: f64) -> String {
    match value {
        _ if value.is_finite() => shortest(value),
        _ if value.is_nan() => "0 / 0".to_owned(),
        _ if value > 0.0 => "1 / 0".to_owned(),
        _ => "-1 / 0".to_owned(),
    }
}

struct Printer<'a> {
    done: HashMap<usize, Written>,
    uses: HashMap<usize, usize>,
    /// The nodes of which a name is the next thing said.
    named: HashSet<usize>,
    /// Those that definitions have taken.
    names: HashSet<&'a str>,
    generated: usize,
    out: String,
}

impl<'a> Printer<'a> {
    /// The text of a part. What is used again is a short name by now.
    fn take(&mut self, tree: &Tree) -> Written {
        let address = tree.address();
        let once = self.uses.get(&address).is_none_or(|&uses| uses < 2);
        let known = if once { self.done.remove(&address) } else { self.done.get(&address).cloned() };
        // Parts come before what is made of them.
        known.unwrap_or_else(|| Written::new(String::new(), PRIMARY, 0))
    }

    /// What stands for the node from here on: the text itself, or a name that is defined with it.
    fn settled(&mut self, node: &'a Tree, root: &Tree, written: Written) -> Written {
        let address = node.address();
        if let Operation::Named(name, _) = node.operation() {
            if is_plain(name) && self.names.insert(name) {
                return self.defined(name, written.field());
            }
            let depth = written.depth + 1;
            let text = format!("{}.named({})", written.receiver(), quoted(name));
            return self.unless_long(address, root, Written::new(text, PRIMARY, depth));
        }
        if matches!(node.operation(), Operation::Constant(_) | Operation::Coordinate(_)) {
            return written;
        }
        self.unless_long(address, root, written)
    }

    fn unless_long(&mut self, address: usize, root: &Tree, written: Written) -> Written {
        let shared = self.uses.get(&address).is_some_and(|&uses| uses > 1);
        let long = written.depth > DEEPEST || written.text.len() > LONGEST;
        let own_line = address == root.address() || self.named.contains(&address);
        if !shared && (!long || own_line) {
            return written;
        }
        self.generated += 1;
        let name = format!("_{}", self.generated);
        self.defined(&name, written)
    }

    fn defined(&mut self, name: &str, written: Written) -> Written {
        let _ = writeln!(self.out, "{name} = {};", written.text);
        Written::new(name.to_owned(), PRIMARY, 0)
    }

    /// The operation as text; of a name what it names.
    fn written(&mut self, operation: &Operation) -> Written {
        let parts: Vec<&Tree> = operation.children().collect();
        let mut parts: Vec<Written> = parts.into_iter().map(|part| self.take(part)).collect();
        let depth = parts.iter().map(|part| part.depth).max().unwrap_or(0) + 1;
        let computed = parts.iter().all(|part| part.number);
        let mut parts = parts.drain(..);
        let mut next = || parts.next().unwrap_or_else(|| Written::new(String::new(), PRIMARY, 0));
        let whole = |text: String| Written::new(text, PRIMARY, depth);
        match operation {
            Operation::Constant(value) => {
                let level = match value {
                    _ if !value.is_finite() => Infix::Arithmetic(Binary::Divide).level(),
                    _ if value.is_sign_negative() => PREFIX,
                    _ => PRIMARY,
                };
                Written { number: true, ..Written::new(number(*value), level, 0) }
            }
            Operation::Coordinate(axis) => Written::new(axis_name(*axis).to_owned(), PRIMARY, 0),
            Operation::Unary(Unary::Negate, _) => {
                Written::new(format!("-{}", next().field().at(PREFIX)), PREFIX, depth)
            }
            Operation::Unary(operator, _) => whole(format!("{}({})", operator.name(), next().field().text)),
            Operation::Binary(operator, ..) => {
                let (left, right) = (next(), next());
                let left = if computed { left.field() } else { left };
                match sign(*operator) {
                    Some((sign, level)) => {
                        let text = format!("{} {sign} {}", left.at(level), right.at(level + 1));
                        Written::new(text, level, depth)
                    }
                    None => whole(format!("{}({}, {})", operator.name(), left.text, right.text)),
                }
            }
            Operation::Power(_, exponent) => {
                Written::new(format!("{} ^ {exponent}", next().field().at(POWER + 1)), POWER, depth)
            }
            Operation::Primitive(primitive) => whole(of_primitive(primitive)),
            Operation::Set(set, all) => of_set(*set, all.len(), parts, depth),
            Operation::Complement(_) => Written::new(format!("~{}", next().at(PREFIX)), PREFIX, depth),
            Operation::Blend(blend, ..) => {
                let (first, second) = (next().text, next().text);
                whole(format!("{}({first}, {second}, {})", blend.name(), of_blend(blend)))
            }
            Operation::Offset(distance, _) => whole(format!("{}.offset({})", next().receiver(), number(*distance))),
            Operation::Shell(thickness, _) => whole(format!("{}.shell({})", next().receiver(), number(*thickness))),
            Operation::Displace(..) => whole(format!("{}.displace({})", next().receiver(), next().text)),
            Operation::Transform(map, _) => whole(format!("{}.{}", next().receiver(), transforms::written(map))),
            Operation::Domain(domain, _) => whole(format!("{}.{}", next().receiver(), of_domain(domain))),
            Operation::Substitute(..) => {
                let [x, y, z] = [next().text, next().text, next().text];
                whole(format!("{}.substitute({x}, {y}, {z})", next().receiver()))
            }
            Operation::Named(..) => next(),
            Operation::Blobs(blobs) => whole(of_blobs(blobs)),
            Operation::Foreign(foreign) => whole(written(foreign.source())),
        }
    }
}

/// Whether a definition can have the name and give it to a part.
fn is_plain(name: &str) -> bool {
    let letters = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    letters && name.starts_with(|first: char| first.is_ascii_alphabetic()) && !is_reserved(name) && !is_sharing(name)
}

fn axis_name(axis: Axis) -> &'static str {
    ["x", "y", "z"][axis.index()]
}

fn sign(operator: Binary) -> Option<(char, u8)> {
    let sign = match operator {
        Binary::Add => '+',
        Binary::Subtract => '-',
        Binary::Multiply => '*',
        Binary::Divide => '/',
        _ => return None,
    };
    Some((sign, Infix::Arithmetic(operator).level()))
}

fn of_set(set: SetOperation, count: usize, parts: impl Iterator<Item = Written>, depth: usize) -> Written {
    if count < 2 {
        let text: String = parts.map(|part| part.text).collect();
        return Written::new(format!("{}({text})", set.name()), PRIMARY, depth);
    }
    let (sign, level) = match set {
        SetOperation::Union => (" | ", 1),
        SetOperation::Intersection => (" & ", 2),
        SetOperation::Difference => (" \\ ", 1),
    };
    let mut text = String::new();
    for (i, part) in parts.enumerate() {
        if i > 0 {
            text.push_str(sign);
        }
        // An operation of the same kind would take the parts that follow for its own.
        let least = if i == 0 && part.open != Some(set) { level } else { level + 1 };
        text.push_str(&part.at(least));
    }
    Written { open: Some(set), ..Written::new(text, level, depth) }
}

fn of_primitive(primitive: &Primitive) -> String {
    let name = primitive.name();
    let of = |numbers: &[f64]| format!("{name}({})", listed(numbers));
    match *primitive {
        Primitive::Plane { normal, offset } => of(&[normal.x, normal.y, normal.z, offset]),
        Primitive::Sphere { center, radius } => match center.to_array().map(f64::to_bits) {
            [0, 0, 0] => of(&[radius]),
            _ => of(&[radius, center.x, center.y, center.z]),
        },
        Primitive::Box { size } => of(&size.to_array()),
        Primitive::RoundedBox { size, radius } => of(&[size.x, size.y, size.z, radius]),
        Primitive::Cylinder { radius, height } => of(&[radius, height]),
        Primitive::Cone { bottom, top, height } => of(&[bottom, top, height]),
        Primitive::Capsule { start: a, end: b, radius } => of(&[a.x, a.y, a.z, b.x, b.y, b.z, radius]),
        Primitive::Torus { major, minor } | Primitive::QuarticTorus { major, minor } => of(&[major, minor]),
        Primitive::Prism { sides, radius, height } => of(&[f64::from(sides), radius, height]),
        Primitive::Circle { radius } => of(&[radius]),
        Primitive::Rectangle { size } => of(&size.to_array()),
        Primitive::Quadric(quadric) => match quadric {
            Quadric::Ellipsoid(axes)
            | Quadric::Cone(axes)
            | Quadric::OneSheetHyperboloid(axes)
            | Quadric::TwoSheetHyperboloid(axes) => of(&axes.to_array()),
            Quadric::EllipticCylinder(axes)
            | Quadric::EllipticParaboloid(axes)
            | Quadric::HyperbolicParaboloid(axes) => of(&axes),
            Quadric::General(coefficients) => of(&coefficients),
        },
    }
}

fn of_blobs(blobs: &Blobs) -> String {
    let mut numbers = vec![blobs.threshold(), blobs.cutoff()];
    for blob in blobs.blobs() {
        numbers.extend(blob.center.to_array());
        numbers.extend(blob.parameters);
    }
    format!("{}({})", blobs.form().name(), listed(&numbers))
}

fn of_blend(blend: &Blend) -> String {
    match blend.form {
        BlendForm::RFunction { alpha } => format!("alpha: {}", number(alpha)),
        BlendForm::Displaced { alpha, amount, first, second } => {
            let [alpha, amount, first, second] = [alpha, amount, first, second].map(number);
            format!("alpha: {alpha}, amount: {amount}, first: {first}, second: {second}")
        }
        BlendForm::Smooth { radius } => format!("radius: {}", number(radius)),
    }
}

fn of_domain(domain: &Domain) -> String {
    let name = domain.name();
    let of = |numbers: &[f64]| format!("{name}({})", listed(numbers));
    match *domain {
        Domain::Twist { rate } | Domain::Bend { rate } => of(&[rate]),
        Domain::Taper { height, factor } => of(&[height, factor]),
        Domain::Repeat { spacing, copies: None } => of(&spacing.to_array()),
        Domain::Repeat { spacing, copies: Some([x, y, z]) } => {
            let spacing = listed(&spacing.to_array());
            format!("{name}({spacing}, copies_x: {x}, copies_y: {y}, copies_z: {z})")
        }
        Domain::Mirror { axis } => format!("{name}_{}()", axis_name(axis)),
        Domain::Elongate { size } => of(&size.to_array()),
        Domain::Extrude { height } => of(&[height]),
        Domain::Revolve { offset } => of(&[offset]),
    }
}
