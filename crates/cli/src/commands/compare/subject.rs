//! A shape that is compared: its triangles, segments and points, and what is known of it.

use std::path::Path;

use serde_json::{Map, Value, json};
use shapeloom_convert::{Job, convert_shape, plan};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Convert, Deviation, Exec, Findings, Place, Reservation, Severity};
use shapeloom_judge::Simplices;
use shapeloom_mesh::Weld;
use shapeloom_shape::{Geometry, Kind, Part, Shape, UpAxis};
use shapeloom_spatial::is_closed;

use crate::account;
use crate::arguments::{SourceArguments, WayArguments};
use crate::commands::convert::{absolute, wish};
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::soundness::Soundness;

/// What can be compared without being converted, triangles first.
const KINDS: [Kind; 4] = [Kind::TriMesh, Kind::Polyline, Kind::GeometricGraph, Kind::PointCloud];

/// A shape that is compared.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) format: &'static str,
    /// The parts after conversion: triangle meshes, polylines, graphs and clouds.
    pub(crate) shape: Shape,
    /// Everything in one list of triangles, segments and points.
    pub(crate) simplices: Simplices<'static>,
    /// How far what is compared may be from what was read.
    pub(crate) deviation: Deviation,
    kinds: Vec<&'static str>,
    /// Whether the surfaces enclose a volume.
    encloses: bool,
    /// What the judge says of the surfaces, vertices at one place taken as one.
    pub(crate) soundness: Option<Soundness>,
    /// All findings, and those of them that reading did not tell.
    findings: Findings,
    pub(crate) judged: Findings,
    _memory: Reservation,
}

impl Subject {
    /// Reads a file and converts it to what can be compared. What stands upright elsewhere is turned to stand as `up`.
    pub(crate) fn open(
        path: &Path,
        way: &WayArguments,
        source: &SourceArguments,
        up: Option<UpAxis>,
        session: &mut Session<'_>,
    ) -> Result<Self, Failure> {
        let settings = Settings::for_several(&way.settings);
        settings.no_writing()?;
        let tolerance = way.tolerance()?;
        let input = input::open(path, source, &settings, session)?;
        let mut shape = input.read.shape;
        if let (Some(from), Some(to)) = (shape.up, up)
            && from != to
        {
            shape = Shape { up: Some(to), ..shape.transformed(&from.rotation_to(to)) };
            session.say(format_args!("{}: turned from {} up to {} up", input.name, from.name(), to.name()));
        }
        let kinds = shape.kinds().into_iter().map(Kind::name).collect();
        let wish = wish(way, &KINDS)?;
        let tolerance = absolute(tolerance, &shape, &wish)?;
        let job = Job { wish, tolerance, settings: settings.converting(input.format) };
        session.stage("converting");
        if let Some(part) = shape.parts.first() {
            // A clear word where no part can be compared.
            plan(part.geometry.kind(), &job.wish).map_err(|error| Failure::from(error).about(path))?;
        }
        let exec = session.exec();
        let conversion = convert_shape(&shape, &job, &exec).map_err(|error| Failure::from(error).about(path))?;
        for step in &conversion.steps {
            session.say_findings_about(&input.name, &step.report.findings);
        }
        for loss in &conversion.losses {
            session.say(format_args!("{}: not compared: {loss}", input.name));
        }
        let (simplices, memory) = simplices(&conversion.shape, &exec)?;
        if simplices.triangles.is_empty() {
            return Err(Failure::Own {
                code: "E-compare-empty",
                category: Category::Unsupported,
                message: format!("{}: found nothing, expected a surface, lines or points to compare", input.name),
                advice: None,
            });
        }
        let mut subject = Self {
            name: input.name,
            format: input.format.id,
            simplices,
            deviation: conversion.deviation,
            kinds,
            encloses: false,
            soundness: None,
            findings: input.read.findings,
            judged: Findings::default(),
            shape: conversion.shape,
            _memory: memory,
        };
        subject.measure(&exec)?;
        subject.findings.extend(subject.judged.clone());
        Ok(subject)
    }

    /// Judges the surfaces, and whether they enclose a volume.
    fn measure(&mut self, exec: &Exec) -> Result<(), Failure> {
        let mut closed = true;
        let mut judged = Findings::default();
        for part in &self.shape.parts {
            let placed = part.placed();
            let Geometry::TriMesh(mesh) = &*placed else { continue };
            let welded = Weld::new().convert_with(mesh, exec)?.value;
            let (found, _) = Soundness::of(&welded, exec, &mut judged)?;
            self.soundness = Some(match self.soundness.take() {
                Some(before) => before.with(&found),
                None => found,
            });
            closed = closed && is_closed(mesh.positions(), mesh.triangles(), exec)?;
        }
        let Some(soundness) = &self.soundness else { return Ok(()) };
        self.encloses = closed;
        // Why there are no measures at all; the rest is told below, as it matters here.
        for finding in judged.iter().filter(|finding| finding.code.starts_with("E-")) {
            self.judged.push(finding.code, finding.severity, Place::Whole, finding.message.clone());
        }
        if !closed {
            let message = "the surface is not closed: it encloses no volume";
            self.judged.push("W-compare-open", Severity::Note, Place::Whole, message);
        }
        if soundness.area().is_none() || (closed && soundness.volume().is_none()) {
            let message = "the area or volume is beyond the numbers, or so small that it vanishes: it is left out";
            self.judged.push("W-compare-size", Severity::Warning, Place::Whole, message);
        }
        Ok(())
    }

    /// Whether some part has a surface that can be drawn.
    pub(crate) fn has_surface(&self) -> bool {
        self.shape.parts.iter().any(is_surface)
    }

    /// The parts with a surface.
    pub(crate) fn surface(&self) -> Shape {
        Shape {
            parts: self.shape.parts.iter().filter(|part| is_surface(part)).cloned().collect(),
            ..self.shape.clone()
        }
    }

    /// The area; none where there is no surface, or it is beyond the numbers or vanishes.
    pub(crate) fn area(&self) -> Option<f64> {
        self.soundness.as_ref().filter(|_| self.has_surface())?.area()
    }

    /// The volume; none where the surface is not closed, or it is beyond the numbers or vanishes.
    pub(crate) fn volume(&self) -> Option<f64> {
        self.soundness.as_ref().filter(|_| self.encloses)?.volume()
    }

    /// What is known of the shape alone.
    pub(crate) fn account(&self) -> Map<String, Value> {
        let bounds = self.simplices.bounds();
        let mut object = Map::new();
        if let Some(soundness) = &self.soundness {
            soundness.tell(&mut object);
        }
        let value = json!({
            "name": self.name,
            "format": self.format,
            "kinds": self.kinds,
            "elements": self.simplices.triangles.len(),
            "bounds": account::bounds(&bounds),
            "diagonal": account::number(bounds.diagonal()),
            "area": self.area().map(account::number),
            "volume": self.volume().map(account::number),
            "deviation": account::deviation(self.deviation),
            "findings": account::findings(&self.findings),
        });
        if let Value::Object(own) = value {
            object.extend(own);
        }
        object
    }
}

fn is_surface(part: &Part) -> bool {
    matches!(&*part.geometry, Geometry::TriMesh(mesh) if !mesh.triangles().is_empty())
}

/// All parts, placed, in one list.
fn simplices(shape: &Shape, exec: &Exec) -> Result<(Simplices<'static>, Reservation), Failure> {
    let (mut positions, mut triangles): (Vec<DVec3>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    // As large as the geometry itself at most, for each instance.
    let bytes = shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).fold(0, u64::saturating_add);
    let memory = exec.reserve(bytes)?;
    for part in &shape.parts {
        exec.check()?;
        let placed = part.placed();
        let found = match &*placed {
            Geometry::TriMesh(mesh) => Simplices::from(mesh),
            Geometry::Polyline(line) => Simplices::from(line),
            Geometry::GeometricGraph(graph) => Simplices::from(graph),
            Geometry::PointCloud(cloud) => Simplices::from(cloud),
            _ => continue,
        };
        let Ok(first) = u32::try_from(positions.len()) else { continue };
        positions.extend_from_slice(&found.positions);
        if positions.len() >= u32::MAX as usize {
            return Err(Failure::Own {
                code: "E-compare-count",
                category: Category::Unsupported,
                message: format!("found {} vertices, expected at most {}", positions.len(), u32::MAX - 1),
                advice: None,
            });
        }
        triangles.extend(found.triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
    }
    Ok((Simplices::new(positions, triangles), memory))
}
