//! The functions of the language.

use std::sync::Arc;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Aabb, Exec};

use super::bind::{Bound, Kind, Missing, Parameter, Signature};
use super::transforms;
use super::value::{Value, binary, unary};
use crate::blobs::{Blob, BlobForm, Blobs, BlobsError};
use crate::operator::{Binary, Unary};
use crate::program::ParameterError;
use crate::shapes::{BlendForm, Domain, Primitive, Quadric, SetOperation};
use crate::tree::{Axis, Operation, Tree};

type Build = fn(&Bound) -> Result<Tree, ParameterError>;

/// A function of the language.
pub(super) struct Function {
    name: &'static str,
    parameters: &'static [Parameter],
    many: bool,
    group: &'static [&'static str],
    build: Build,
}

/// What a call names.
#[derive(Clone, Copy)]
pub(super) enum Callee {
    Function(&'static Function),
    Unary(Unary),
    Binary(Binary),
    Bounds,
}

const fn number(name: &'static str) -> Parameter {
    Parameter { name, kind: Kind::Number, missing: Missing::Refused }
}

const fn number_or(name: &'static str, default: f64) -> Parameter {
    Parameter { name, kind: Kind::Number, missing: Missing::Number(default) }
}

const fn number_or_none(name: &'static str) -> Parameter {
    Parameter { name, kind: Kind::Number, missing: Missing::Absent }
}

const fn field(name: &'static str) -> Parameter {
    Parameter { name, kind: Kind::Field, missing: Missing::Refused }
}

const fn value(name: &'static str) -> Parameter {
    Parameter { name, kind: Kind::Value, missing: Missing::Refused }
}

const fn function(name: &'static str, parameters: &'static [Parameter], build: Build) -> Function {
    Function { name, parameters, many: false, group: &[], build }
}

const fn set(name: &'static str, build: Build) -> Function {
    Function { name, parameters: &[], many: true, group: &[], build }
}

const A: Parameter = field("a");
const X: Parameter = number("x");
const Y: Parameter = number("y");
const Z: Parameter = number("z");
const RADIUS: Parameter = number("radius");
const HEIGHT: Parameter = number("height");
const AXES: &[Parameter] = &[number("a"), number("b"), number("c")];
const R_FUNCTION: &[Parameter] = &[A, field("b"), number("alpha")];
const DISPLACED: &[Parameter] = &[A, field("b"), number("alpha"), number("amount"), number("first"), number("second")];
const SMOOTH: &[Parameter] = &[A, field("b"), RADIUS];

/// Blobs: numbers for all, then five for each.
const fn blobs(name: &'static str, group: &'static [&'static str], build: Build) -> Function {
    Function { name, parameters: const { &[number("threshold"), number("cutoff")] }, many: false, group, build }
}

fn sum_of(form: BlobForm, bound: &Bound) -> Result<Tree, ParameterError> {
    let (groups, _) = bound.rest.as_chunks::<5>();
    let blobs = groups.iter().map(|&[x, y, z, a, b]| Blob::new(DVec3::new(x, y, z), a, b)).collect();
    let [threshold, cutoff] = bound.numbers(0);
    let made = Blobs::try_new_with(form, threshold, blobs, cutoff, &Exec::default());
    made.map(|blobs| Tree::new(Operation::Blobs(Arc::new(blobs)))).map_err(|error| {
        let (index, parameter, found, expected) = match error {
            BlobsError::Parameter { index, parameter, found, expected } => (Some(index), parameter, found, expected),
            BlobsError::Center { index, found } => (Some(index), "centre", found, "finite coordinates"),
            BlobsError::Threshold { found } => (None, "threshold", found, "a finite number above 0"),
            BlobsError::Unreachable { threshold, .. } => {
                (None, "threshold", threshold, "no more than the sum of all peaks")
            }
            BlobsError::Strength { found } => (None, "peaks that add up to", found, "less than single precision holds"),
            BlobsError::Cutoff { found } => (None, "cutoff", found, "a number above 0 and at most 0.1"),
            _ => (None, "blobs", groups.len() as f64, "some, and no more than memory holds"),
        };
        ParameterError { operation: form.name(), parameter, found, expected, part: index.map(|i| format!("blob {i}")) }
    })
}

fn solid(primitive: Primitive) -> Result<Tree, ParameterError> {
    Ok(primitive.into())
}

fn quadric(quadric: Quadric) -> Result<Tree, ParameterError> {
    Ok(quadric.into())
}

fn sets(operation: SetOperation, bound: &Bound) -> Result<Tree, ParameterError> {
    Ok(Tree::new(Operation::Set(operation, bound.parts.clone())))
}

fn blend(set: SetOperation, form: BlendForm, bound: &Bound) -> Result<Tree, ParameterError> {
    Ok(bound.field(0).blend(bound.field(1), set, form))
}

fn r_function(set: SetOperation, bound: &Bound) -> Result<Tree, ParameterError> {
    blend(set, BlendForm::RFunction { alpha: bound.number(2) }, bound)
}

fn displaced(set: SetOperation, bound: &Bound) -> Result<Tree, ParameterError> {
    let [alpha, amount, first, second] = bound.numbers(2);
    blend(set, BlendForm::Displaced { alpha, amount, first, second }, bound)
}

fn smooth(set: SetOperation, bound: &Bound) -> Result<Tree, ParameterError> {
    blend(set, BlendForm::Smooth { radius: bound.number(2) }, bound)
}

fn domain(domain: Domain, bound: &Bound) -> Result<Tree, ParameterError> {
    Ok(bound.field(0).in_domain(domain))
}

fn repeat(bound: &Bound) -> Result<Tree, ParameterError> {
    let mut copies = [0; 3];
    for (i, (count, parameter)) in copies.iter_mut().zip(["copies_x", "copies_y", "copies_z"]).enumerate() {
        *count = bound.whole(4 + i, parameter)?;
    }
    let given = (4..7).any(|i| bound.optional(i).is_some());
    domain(Domain::Repeat { spacing: bound.vector(1), copies: given.then_some(copies) }, bound)
}

/// Every function but those named after operators of one or two operands.
static FUNCTIONS: &[Function] = &[
    function("constant", &[number("value")], |b| Ok(b.number(0).into())),
    blobs("blinn", &["x", "y", "z", "amplitude", "decay"], |b| sum_of(BlobForm::Blinn, b)),
    blobs("blobby", &["x", "y", "z", "radius", "blobbiness"], |b| sum_of(BlobForm::Blobby, b)),
    blobs("metaballs", &["x", "y", "z", "radius", "amplitude"], |b| sum_of(BlobForm::Metaballs, b)),
    blobs("soft_objects", &["x", "y", "z", "radius", "weight"], |b| sum_of(BlobForm::SoftObjects, b)),
    // Solids.
    function("plane", &[X, Y, Z, number_or("offset", 0.0)], |b| {
        solid(Primitive::Plane { normal: b.vector(0), offset: b.number(3) })
    }),
    function("sphere", &[RADIUS, number_or("x", 0.0), number_or("y", 0.0), number_or("z", 0.0)], |b| {
        solid(Primitive::Sphere { center: b.vector(1), radius: b.number(0) })
    }),
    function("box", &[X, Y, Z], |b| solid(Primitive::Box { size: b.vector(0) })),
    function("rounded_box", &[X, Y, Z, RADIUS], |b| {
        solid(Primitive::RoundedBox { size: b.vector(0), radius: b.number(3) })
    }),
    function("cylinder", &[RADIUS, HEIGHT], |b| {
        solid(Primitive::Cylinder { radius: b.number(0), height: b.number(1) })
    }),
    function("cone", &[number("bottom"), number("top"), HEIGHT], |b| {
        solid(Primitive::Cone { bottom: b.number(0), top: b.number(1), height: b.number(2) })
    }),
    function(
        "capsule",
        &[number("x1"), number("y1"), number("z1"), number("x2"), number("y2"), number("z2"), RADIUS],
        |b| solid(Primitive::Capsule { start: b.vector(0), end: b.vector(3), radius: b.number(6) }),
    ),
    function("torus", &[number("major"), number("minor")], |b| {
        solid(Primitive::Torus { major: b.number(0), minor: b.number(1) })
    }),
    function("quartic_torus", &[number("major"), number("minor")], |b| {
        solid(Primitive::QuarticTorus { major: b.number(0), minor: b.number(1) })
    }),
    function("prism", &[number("sides"), RADIUS, HEIGHT], |b| {
        solid(Primitive::Prism { sides: b.whole(0, "sides")?, radius: b.number(1), height: b.number(2) })
    }),
    function("circle", &[RADIUS], |b| solid(Primitive::Circle { radius: b.number(0) })),
    function("rectangle", &[X, Y], |b| solid(Primitive::Rectangle { size: DVec2::from_array(b.numbers(0)) })),
    // Quadrics.
    function("ellipsoid", AXES, |b| quadric(Quadric::Ellipsoid(b.vector(0)))),
    function("elliptic_cylinder", &[number("a"), number("b")], |b| quadric(Quadric::EllipticCylinder(b.numbers(0)))),
    function("elliptic_cone", AXES, |b| quadric(Quadric::Cone(b.vector(0)))),
    function("hyperboloid", AXES, |b| quadric(Quadric::OneSheetHyperboloid(b.vector(0)))),
    function("two_sheet_hyperboloid", AXES, |b| quadric(Quadric::TwoSheetHyperboloid(b.vector(0)))),
    function("paraboloid", &[number("a"), number("b")], |b| quadric(Quadric::EllipticParaboloid(b.numbers(0)))),
    function("hyperbolic_paraboloid", &[number("a"), number("b")], |b| {
        quadric(Quadric::HyperbolicParaboloid(b.numbers(0)))
    }),
    function(
        "quadric",
        &[
            number_or("xx", 0.0),
            number_or("yy", 0.0),
            number_or("zz", 0.0),
            number_or("xy", 0.0),
            number_or("yz", 0.0),
            number_or("zx", 0.0),
            number_or("x", 0.0),
            number_or("y", 0.0),
            number_or("z", 0.0),
            number_or("one", 0.0),
        ],
        |b| quadric(Quadric::General(b.numbers(0))),
    ),
    // Sets and blends.
    set("union", |b| sets(SetOperation::Union, b)),
    set("intersection", |b| sets(SetOperation::Intersection, b)),
    set("difference", |b| sets(SetOperation::Difference, b)),
    function("complement", &[A], |b| Ok(b.field(0).complement())),
    function("r_union", R_FUNCTION, |b| r_function(SetOperation::Union, b)),
    function("r_intersection", R_FUNCTION, |b| r_function(SetOperation::Intersection, b)),
    function("r_difference", R_FUNCTION, |b| r_function(SetOperation::Difference, b)),
    function("blend_union", DISPLACED, |b| displaced(SetOperation::Union, b)),
    function("blend_intersection", DISPLACED, |b| displaced(SetOperation::Intersection, b)),
    function("blend_difference", DISPLACED, |b| displaced(SetOperation::Difference, b)),
    function("smooth_union", SMOOTH, |b| smooth(SetOperation::Union, b)),
    function("smooth_intersection", SMOOTH, |b| smooth(SetOperation::Intersection, b)),
    function("smooth_difference", SMOOTH, |b| smooth(SetOperation::Difference, b)),
    // Changed values.
    function("offset", &[A, number("distance")], |b| Ok(b.field(0).offset(b.number(1)))),
    function("shell", &[A, number("thickness")], |b| Ok(b.field(0).shell(b.number(1)))),
    function("displace", &[A, field("by")], |b| Ok(b.field(0).displace(b.field(1)))),
    // Placing.
    function("move", &[A, X, Y, Z], transforms::moved),
    function("rotate_x", &[A, number("angle")], |b| transforms::turned(b, Axis::X.vector(), b.number(1))),
    function("rotate_y", &[A, number("angle")], |b| transforms::turned(b, Axis::Y.vector(), b.number(1))),
    function("rotate_z", &[A, number("angle")], |b| transforms::turned(b, Axis::Z.vector(), b.number(1))),
    function("rotate", &[A, X, Y, Z, number("angle")], |b| transforms::turned(b, b.vector(1), b.number(4))),
    function("scale", &[A, X, number_or_none("y"), number_or_none("z")], transforms::scaled),
    function(
        "matrix",
        &[
            A,
            number("xx"),
            number("xy"),
            number("xz"),
            number("tx"),
            number("yx"),
            number("yy"),
            number("yz"),
            number("ty"),
            number("zx"),
            number("zy"),
            number("zz"),
            number("tz"),
        ],
        transforms::mapped,
    ),
    // Bending.
    function("twist", &[A, number("rate")], |b| domain(Domain::Twist { rate: b.number(1) }, b)),
    function("bend", &[A, number("rate")], |b| domain(Domain::Bend { rate: b.number(1) }, b)),
    function("taper", &[A, HEIGHT, number("factor")], |b| {
        domain(Domain::Taper { height: b.number(1), factor: b.number(2) }, b)
    }),
    function(
        "repeat",
        &[
            A,
            number_or("x", 0.0),
            number_or("y", 0.0),
            number_or("z", 0.0),
            number_or_none("copies_x"),
            number_or_none("copies_y"),
            number_or_none("copies_z"),
        ],
        repeat,
    ),
    function("mirror_x", &[A], |b| domain(Domain::Mirror { axis: Axis::X }, b)),
    function("mirror_y", &[A], |b| domain(Domain::Mirror { axis: Axis::Y }, b)),
    function("mirror_z", &[A], |b| domain(Domain::Mirror { axis: Axis::Z }, b)),
    function("elongate", &[A, number_or("x", 0.0), number_or("y", 0.0), number_or("z", 0.0)], |b| {
        domain(Domain::Elongate { size: b.vector(1) }, b)
    }),
    function("extrude", &[A, HEIGHT], |b| domain(Domain::Extrude { height: b.number(1) }, b)),
    function("revolve", &[A, number_or("offset", 0.0)], |b| domain(Domain::Revolve { offset: b.number(1) }, b)),
    // Structure.
    function("substitute", &[A, field("x"), field("y"), field("z")], |b| {
        Ok(b.field(0).substitute(b.field(1), b.field(2), b.field(3)))
    }),
    function("named", &[A, Parameter { name: "name", kind: Kind::Text, missing: Missing::Refused }], |b| {
        Ok(b.field(0).named(b.text(1)))
    }),
];

const BOUNDS: Signature = Signature {
    name: "bounds",
    parameters: &[number("x1"), number("y1"), number("z1"), number("x2"), number("y2"), number("z2")],
    many: false,
    group: &[],
};

impl Callee {
    /// What a name calls, unless it is a name from outside.
    pub(super) fn of(name: &str) -> Option<Self> {
        FUNCTIONS
            .iter()
            .find(|function| function.name == name)
            .map(Self::Function)
            .or_else(|| Unary::from_name(name).map(Self::Unary))
            .or_else(|| Binary::from_name(name).map(Self::Binary))
            .or_else(|| (name == BOUNDS.name).then_some(Self::Bounds))
    }

    /// Everything that can be called.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let operators = Unary::ALL.into_iter().map(Self::Unary).chain(Binary::ALL.into_iter().map(Self::Binary));
        FUNCTIONS.iter().map(Self::Function).chain(operators).chain([Self::Bounds])
    }

    /// What it takes.
    pub(super) fn signature(self) -> Signature {
        match self {
            Self::Function(Function { name, parameters, many, group, .. }) => {
                Signature { name, parameters, many: *many, group }
            }
            Self::Unary(operator) => {
                Signature { name: operator.name(), parameters: const { &[value("a")] }, many: false, group: &[] }
            }
            Self::Binary(operator) => Signature {
                name: operator.name(),
                parameters: const { &[value("a"), value("b")] },
                many: false,
                group: &[],
            },
            Self::Bounds => BOUNDS,
        }
    }

    /// What it gives for its arguments.
    pub(super) fn build(self, bound: &mut Bound) -> Result<Value, ParameterError> {
        let nothing = Value::Number(f64::NAN);
        Ok(match self {
            Self::Function(function) => Value::Field((function.build)(bound)?),
            Self::Unary(operator) => unary(operator, bound.take(0).unwrap_or(nothing)),
            Self::Binary(operator) => {
                binary(operator, bound.take(0).unwrap_or(nothing.clone()), bound.take(1).unwrap_or(nothing))
            }
            Self::Bounds => Value::Bounds(bounds(bound)?),
        })
    }
}

/// Whether the language has a function of that name.
pub(super) fn is_known(name: &str) -> bool {
    Callee::of(name).is_some()
}

fn bounds(bound: &Bound) -> Result<Aabb, ParameterError> {
    let region = Aabb { min: bound.vector(0), max: bound.vector(3) };
    let fault =
        |parameter, found, expected| ParameterError { operation: BOUNDS.name, parameter, found, expected, part: None };
    let corners = BOUNDS.parameters.iter().zip(bound.numbers::<6>(0));
    for (parameter, found) in corners.clone() {
        if !found.is_finite() {
            return Err(fault(parameter.name, found, "a finite number"));
        }
    }
    for ((parameter, found), least) in corners.skip(3).zip(region.min.to_array()) {
        if found < least {
            return Err(fault(parameter.name, found, "no less than in the first corner"));
        }
    }
    Ok(region)
}
