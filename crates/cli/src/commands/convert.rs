//! `convert`: any file to any file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;
use shapeloom_convert::{Conversion, Job, Wish, convert_shape, plan};
use shapeloom_core::{Category, Deviation, Report, Tolerance, ToleranceError};
use shapeloom_io::{Format, WriteContext, WriteOptions, format_by_id, format_for_output, write};
use shapeloom_shape::{Kind, Shape};

use super::draw;
use super::render::check_png;
use crate::account;
use crate::arguments::{ConvertArguments, TargetArguments, WayArguments};
use crate::failure::Failure;
use crate::input::{self, is_stream};
use crate::output::{Beside, check_apart, check_free, commit, is_regular, stage};
use crate::session::Session;
use crate::settings::Settings;

pub(crate) fn run(arguments: &ConvertArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let settings = Settings::sort(&arguments.way.settings);
    let delivery = Delivery::new(&arguments.target, &settings)?;
    let tolerance = arguments.way.tolerance()?;
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    delivery.check(session)?;
    let wish = wish(&arguments.way, delivery.format.kinds)?;
    delivery.check_picture(&input.read.shape)?;
    let tolerance = absolute(tolerance, &input.read.shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.converting(input.format) };
    let source = json!({
        "name": input.name, "format": input.format.id, "bytes": input.bytes,
        "findings": account::findings(&input.read.findings), "losses": account::losses(&input.read.losses),
    });
    delivery.deliver(source, &input.read.shape, Deviation::Exact, &job, session)
}

/// The format to write: the one named, else by extension.
fn output_format(path: &Path, to: Option<&str>) -> Result<&'static Format, Failure> {
    let format = match to {
        Some(id) => format_by_id(id)?,
        None if is_stream(path) => {
            let message = "standard output: found no format, expected one with --to";
            return Err(Failure::usage("E-usage-format", message));
        }
        None => format_for_output(&path.display().to_string()).map_err(|error| Failure::from(error).about(path))?,
    };
    if format.writes.is_none() {
        return Err(Failure::Own {
            code: "E-output-format",
            category: Category::Unsupported,
            message: format!("{}: {} cannot be written yet", path.display(), format.name),
            advice: Some("`shapeloom formats` lists what can".into()),
        });
    }
    Ok(format)
}

/// What a way must do to end in one of these kinds.
pub(crate) fn wish(way: &WayArguments, kinds: &[Kind]) -> Result<Wish, Failure> {
    let via = match &way.via {
        Some(name) => Some(Kind::from_name(name).ok_or_else(|| {
            let known: Vec<&str> = Kind::ALL.into_iter().map(Kind::name).collect();
            Failure::usage("E-usage-kind", format!("found kind \"{name}\", expected one of {}", known.join(", ")))
        })?),
        None => None,
    };
    Ok(Wish { targets: kinds.to_vec(), method: way.method.clone(), via })
}

/// The tolerance in the units of a shape. A shape without size has none in per cent, and needs none where every step is
/// exact or says its own error: it is 0 then.
pub(crate) fn absolute(tolerance: Tolerance, shape: &Shape, wish: &Wish) -> Result<f64, Failure> {
    let needed =
        shape.parts.iter().any(|part| plan(part.geometry.kind(), wish).is_ok_and(|plan| plan.lossy_steps() > 0));
    let bounds = shape.bounds();
    match tolerance.resolve(bounds.diagonal()) {
        Err(ToleranceError::NoScale { .. }) if !needed => Ok(0.0),
        // Of nothing every tolerance is met.
        Err(ToleranceError::NoScale { .. }) if bounds.is_empty() => Ok(f64::MIN_POSITIVE),
        resolved => Ok(resolved?),
    }
}

/// Where a result goes, in which forms.
pub(crate) struct Delivery<'a> {
    target: &'a TargetArguments,
    pub(crate) format: &'static Format,
    options: WriteOptions,
}

impl<'a> Delivery<'a> {
    /// # Errors
    /// No format that can be written is named or told by the extension.
    pub(crate) fn new(target: &'a TargetArguments, settings: &Settings) -> Result<Self, Failure> {
        let format = output_format(&target.output, target.to.as_deref())?;
        Ok(Self { target, format, options: settings.writing(format)? })
    }

    /// Every output, the shape's own first.
    fn paths(&self) -> impl Iterator<Item = &'a Path> {
        let TargetArguments { output, picture, report, .. } = self.target;
        std::iter::once(output).chain(picture).chain(report).map(PathBuf::as_path)
    }

    /// Refuses outputs that cannot be, before any work is done.
    pub(crate) fn check(&self, session: &Session<'_>) -> Result<(), Failure> {
        let paths: Vec<&Path> = self.paths().collect();
        check_apart(&paths)?;
        self.target.picture.as_deref().map_or(Ok(()), check_png)?;
        if session.globals.json && paths.iter().any(|path| is_stream(path)) {
            let message = "--json and an output of - both want standard output: expected one of them";
            return Err(Failure::usage("E-usage-outputs", message));
        }
        paths.into_iter().try_for_each(|path| check_free(path, self.target.force))
    }

    /// Refuses a file of heights in the format of pictures where nothing leads to heights: a picture was meant.
    fn check_picture(&self, shape: &Shape) -> Result<(), Failure> {
        let anywhere = Wish::to(self.format.kinds);
        let reaches = shape.parts.iter().any(|part| plan(part.geometry.kind(), &anywhere).is_ok());
        if self.format.id != "png" || reaches || shape.parts.is_empty() {
            return Ok(());
        }
        let kinds: Vec<&str> = shape.kinds().into_iter().map(Kind::name).collect();
        Err(Failure::Own {
            code: "E-plan-no-way",
            category: Category::Unsupported,
            message: format!("{}: found {}, expected a height field", self.target.output.display(), kinds.join(", ")),
            advice: Some("`shapeloom render IN OUT.png` draws pictures; a PNG file of a shape holds heights".into()),
        })
    }

    /// Converts a shape, itself `made` with some deviation, and writes everything, or nothing.
    pub(crate) fn deliver(
        &self,
        source: serde_json::Value,
        shape: &Shape,
        made: Deviation,
        job: &Job,
        session: &mut Session<'_>,
    ) -> Result<(), Failure> {
        if session.globals.explain {
            explain(shape, job, session)?;
        }
        session.stage("converting");
        let conversion = convert_shape(shape, job, &session.exec())?;
        let mut written = None;
        let exec = session.exec();
        session.stage("writing");
        let before = made.then(conversion.deviation);
        let strict = session.globals.strict;
        let beside = Arc::new(Beside::default());
        let output = &self.target.output;
        let context = WriteContext {
            exec,
            options: self.options.clone(),
            name: output.display().to_string(),
            siblings: if is_regular(output) { Some(beside.clone()) } else { None },
        };
        let mut staged = vec![stage(&self.target.output, self.target.force, |out| {
            let report = write(&conversion.shape, self.format, &context, out)?;
            if strict {
                check_strict(before.then(report.deviation), job.tolerance)?;
            }
            written = Some(report);
            Ok(())
        })?];
        let mut names = vec![output.display().to_string()];
        for (name, bytes) in beside.take() {
            let path = output.with_file_name(name.as_str());
            check_free(&path, self.target.force)?;
            names.push(path.display().to_string());
            staged.push(stage(&path, self.target.force, |out| {
                out.write_all(&bytes).map_err(|error| Failure::write(&path, &error))
            })?);
        }
        let written = written.unwrap_or_else(|| Report::exact("write", ""));
        let deviation = before.then(written.deviation);
        let account = json!({
            "schema": "shapeloom.convert/1",
            "input": source,
            "output": { "name": self.target.output.display().to_string(), "format": self.format.id },
            "tolerance": account::number(job.tolerance),
            "steps": account::steps(&conversion, session.globals.timings),
            "left_out": account::losses(&conversion.losses),
            "writing": account::report(&written),
            "deviation": account::deviation(deviation),
            "within_tolerance": deviation.is_within(job.tolerance),
        });
        if let Some(path) = self.target.picture.as_deref() {
            session.stage("drawing");
            let image = draw::picture_of(&conversion.shape, job.tolerance, &draw::Look::of_session(session), session)?;
            let bytes = image.to_png()?;
            staged.push(stage(path, self.target.force, |out| {
                out.write_all(&bytes).map_err(|error| Failure::write(path, &error))
            })?);
        }
        if let Some(path) = self.target.report.as_deref() {
            staged.push(stage(path, self.target.force, |out| {
                writeln!(out, "{account:#}").map_err(|error| Failure::write(path, &error))
            })?);
        }
        commit(staged, session)?;
        names.extend(self.paths().skip(1).map(|path| path.display().to_string()));
        self.tell(&conversion, &written, deviation, &names, session);
        if session.globals.json {
            session.print_json(&account)?;
        }
        Ok(())
    }

    fn tell(
        &self,
        conversion: &Conversion,
        written: &Report,
        deviation: Deviation,
        names: &[String],
        session: &mut Session<'_>,
    ) {
        for (index, step) in conversion.steps.iter().enumerate() {
            let seconds = session.globals.timings.then(|| conversion.timings.seconds[index]);
            session.say(account::step_words(step, seconds));
            if session.globals.verbose {
                for (name, value) in &step.options {
                    session.say(format_args!("  {name} = {value}"));
                }
                session.say(format_args!("  by {}", step.report.basis));
            }
            session.say_findings(&step.report.findings);
            for loss in &step.report.losses {
                session.say(format_args!("lost: {loss}"));
            }
        }
        for loss in &conversion.losses {
            session.say(format_args!("lost: {loss}"));
        }
        session.say_findings(&written.findings);
        for loss in &written.losses {
            session.say(format_args!("lost: {loss}"));
        }
        session.say(format_args!("wrote {}; error {deviation}", names.join(", ")));
    }
}

/// Under `--strict` a result that is not proven to be within the tolerance is none.
pub(crate) fn check_strict(deviation: Deviation, tolerance: f64) -> Result<(), Failure> {
    if deviation.is_within(tolerance) {
        return Ok(());
    }
    Err(Failure::Own {
        code: "E-strict-tolerance",
        category: Category::Failed,
        message: format!("found an error {deviation}, expected one proven to be within {tolerance}"),
        advice: Some("leave out --strict to accept it".into()),
    })
}

/// Says which way each part takes.
fn explain(shape: &Shape, job: &Job, session: &mut Session<'_>) -> Result<(), Failure> {
    let targets: Vec<&str> = job.wish.targets.iter().map(|kind| kind.name()).collect();
    for (index, part) in shape.parts.iter().enumerate() {
        let kind = part.geometry.kind();
        // What leads nowhere is named after the conversion.
        let Ok(plan) = plan(kind, &job.wish) else { continue };
        let steps: Vec<&str> = plan.steps.iter().map(|step| step.name).collect();
        let way = if steps.is_empty() { "as it is".to_owned() } else { format!("by {}", steps.join(", then ")) };
        session.say(format_args!(
            "part {index}: {kind} {way}: the shortest way to {}, tolerance {}",
            targets.join(" or "),
            job.tolerance
        ));
    }
    Ok(())
}
