//! `boolean`: two volumes made one.

use serde_json::json;
use shapeloom_convert::Job;
use shapeloom_core::{Category, ConvertError, Deviation, Exec, Findings, Place, Report, Severity};
use shapeloom_shape::{Geometry, Kind, Part, Shape};
use shapeloom_voxels::isosurface::{InsideChoice, IsoValue, Level};
use shapeloom_voxels::{Blend, GridField, Interpolation, Octree, VoxelGrid, blend, sample_field};

use super::convert::{Delivery, absolute, wish};
use crate::account;
use crate::arguments::BooleanArguments;
use crate::failure::Failure;
use crate::input::{self, Input, is_stream};
use crate::session::Session;
use crate::settings::Settings;

pub(crate) fn run(arguments: &BooleanArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    if is_stream(&arguments.first) && is_stream(&arguments.second) {
        let message = "found standard input more than once: expected it for one shape at most";
        return Err(Failure::usage("E-usage-shapes", message));
    }
    let operation = Operation::asked(arguments)?;
    session.several_inputs = true;
    let settings = Settings::for_several(&arguments.way.settings);
    let delivery = Delivery::new(&arguments.target, &settings)?;
    let tolerance = arguments.way.tolerance()?;
    let first = input::open(&arguments.first, &arguments.source, &settings, session)?;
    let second = input::open(&arguments.second, &arguments.source, &settings, session)?;
    settings.check_heeded(&[first.format, second.format])?;
    delivery.check(session)?;
    let wish = wish(&arguments.way, delivery.format.kinds)?;
    session.stage("combining");
    let exec = session.exec();
    let _memory = exec.reserve((first.read.shape.memory_bytes() + second.read.shape.memory_bytes()) as u64)?;
    let (one, other) = (volume(&first)?, volume(&second)?);
    let mut findings = Findings::default();
    let resampled = match one.lattice() == other.lattice() {
        false if arguments.resample => Some(resample(&other, &one, &mut findings, &exec)?),
        _ => None,
    };
    let made = operation.of(&one, resampled.as_ref().unwrap_or(&other), &exec).map_err(|error| match error {
        error if !arguments.resample && error.diagnostic().code() == "E-voxels-lattices" => Failure::Own {
            code: "E-voxels-lattices",
            category: Category::Usage,
            message: error.to_string(),
            advice: Some("--resample samples the second on the lattice of the first".into()),
        },
        error => error.into(),
    })?;
    let mut report = operation.report(resampled.is_some());
    report.findings = findings;
    report.figure("samples", made.lattice().samples() as f64);
    session.say(format_args!("{}: {}; error {}", operation.name(), report.basis, report.deviation));
    session.say_findings(&report.findings);
    let like = &first.read.shape;
    let name = like.parts.first().map_or("", |part| part.name.as_str());
    let shape = Shape { units: like.units, up: like.up, ..Shape::new(Part::new(made).named(name)) };
    let tolerance = absolute(tolerance, &shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.converting(first.format) };
    let told = |input: &Input| {
        json!({
            "name": input.name, "format": input.format.id, "bytes": input.bytes,
            "findings": account::findings(&input.read.findings), "losses": account::losses(&input.read.losses),
        })
    };
    let source = json!({
        "operation": operation.name(),
        "inputs": [told(&first), told(&second)],
        "report": account::report(&report),
    });
    delivery.deliver(source, &shape, report.deviation, &job, session)
}

/// What becomes of two volumes.
enum Operation {
    /// Of their samples.
    Samples(Blend),
    /// Of their full cells.
    Cells(Blend),
}

impl Operation {
    fn asked(arguments: &BooleanArguments) -> Result<Self, Failure> {
        if let Some(fraction) = arguments.morph {
            return Ok(Self::Samples(Blend::Morph { fraction }));
        }
        let blend = match (arguments.op.as_deref(), arguments.smooth) {
            (Some("union"), Some(radius)) => Blend::SmoothUnion { radius },
            (Some(other), Some(_)) => {
                let message = format!("found --smooth with --op {other}, expected it with --op union");
                return Err(Failure::usage("E-usage-operation", message));
            }
            (Some("intersection"), None) => Blend::Intersection,
            (Some("difference"), None) => Blend::Difference,
            _ => Blend::Union,
        };
        Ok(if arguments.cells { Self::Cells(blend) } else { Self::Samples(blend) })
    }

    fn name(&self) -> &'static str {
        let (Self::Samples(blend) | Self::Cells(blend)) = self;
        match blend {
            Blend::Union => "union",
            Blend::Intersection => "intersection",
            Blend::Difference => "difference",
            Blend::SmoothUnion { .. } => "smooth union",
            Blend::Morph { .. } => "morph",
        }
    }

    fn of(&self, one: &VoxelGrid, other: &VoxelGrid, exec: &Exec) -> Result<VoxelGrid, ConvertError> {
        let how = match self {
            Self::Samples(how) => return blend(one, other, *how, exec),
            Self::Cells(how) => how,
        };
        let tree = |grid: &VoxelGrid| {
            let (level, _) = Level::settle(grid, IsoValue::Auto, InsideChoice::Auto, exec)?;
            Octree::from_slabs(grid, level, exec)
        };
        let (one, other) = (tree(one)?, tree(other)?);
        let combined = match how {
            Blend::Intersection => one.intersection(&other, exec),
            Blend::Difference => one.difference(&other, exec),
            _ => one.union(&other, exec),
        };
        combined?.to_grid(exec)
    }

    fn report(&self, resampled: bool) -> Report {
        let (deviation, basis) = match self {
            _ if resampled => (Deviation::Unknown, "the second is what it has between its samples"),
            Self::Cells(_) => (Deviation::Exact, "of the solids of full cells"),
            Self::Samples(Blend::SmoothUnion { .. } | Blend::Morph { .. }) => {
                (Deviation::Unknown, "a solid of its own")
            }
            Self::Samples(_) => (
                Deviation::Unknown,
                "every sample is on its side; what is thinner than a cell may be lost between them",
            ),
        };
        Report::new("boolean", deviation, basis)
    }
}

/// The one volume of an input, where it lies.
fn volume(input: &Input) -> Result<VoxelGrid, Failure> {
    let parts = &input.read.shape.parts;
    if let [part] = parts.as_slice()
        && let Geometry::VoxelGrid(grid) = &*part.geometry
    {
        return Ok(grid.transformed(&part.placement));
    }
    let kinds: Vec<&str> = input.read.shape.kinds().into_iter().map(Kind::name).collect();
    let found = if parts.is_empty() { "nothing".to_owned() } else { kinds.join(", ") };
    Err(Failure::Own {
        code: "E-boolean-volume",
        category: Category::Unsupported,
        message: format!("{}: found {} parts ({found}), expected one volume", input.name, parts.len()),
        advice: Some("`shapeloom convert IN OUT.nrrd --method mesh-to-distance` makes a volume of a mesh".into()),
    })
}

/// What a grid has between its samples, on the lattice of another.
fn resample(
    grid: &VoxelGrid,
    other: &VoxelGrid,
    findings: &mut Findings,
    exec: &Exec,
) -> Result<VoxelGrid, ConvertError> {
    let (level, _) = Level::settle(grid, IsoValue::Auto, InsideChoice::Auto, exec)?;
    let field = GridField::try_new(grid, level, Interpolation::Trilinear, exec)?;
    let (inner, outer) = (other.bounds(), grid.bounds());
    if !(outer.contains(inner.min) && outer.contains(inner.max)) {
        let message = "the second ends within the lattice of the first: beyond it lie the values of its border";
        findings.push("W-boolean-beyond", Severity::Warning, Place::Whole, message);
    }
    Ok(sample_field(&field, *other.lattice(), exec)?.value)
}
