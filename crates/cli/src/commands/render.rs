//! `render`: pictures with no display.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use shapeloom_convert::Job;
use shapeloom_core::{Camera, Category, Options};
use shapeloom_render::Picture;
use shapeloom_shape::Kind;

use super::coloring::ColorBy;
use super::compare::{Subject, short};
use super::convert::{absolute, check_strict, wish};
use super::draw::{Look, Stage};
use crate::account;
use crate::arguments::{RenderArguments, SourceArguments, WayArguments};
use crate::failure::Failure;
use crate::input::{self, is_stream};
use crate::output::{check_free, commit, stage};
use crate::session::Session;
use crate::settings::Settings;

pub(crate) fn run(arguments: &RenderArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let tolerance = arguments.way.tolerance()?;
    let look = look(arguments, session)?;
    check_png(&arguments.output)?;
    check_coloring(arguments)?;
    let paths = match arguments.turntable {
        Some(_) if is_stream(&arguments.output) => {
            let message = "--turntable draws many pictures: expected a file name, found standard output";
            return Err(Failure::usage("E-usage-outputs", message));
        }
        Some(frames) => (0..frames).map(|frame| numbered(&arguments.output, frame)).collect(),
        None => vec![arguments.output.clone()],
    };
    if session.globals.json && is_stream(&arguments.output) {
        let message = "--json and an output of - both want standard output: expected one of them";
        return Err(Failure::usage("E-usage-outputs", message));
    }
    paths.iter().try_for_each(|path| check_free(path, arguments.force))?;
    let settings = Settings::sort(&arguments.way.settings);
    settings.no_writing()?;
    session.several_inputs = arguments.reference.is_some();
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    let wish = wish(&arguments.way, &[Kind::TriMesh])?;
    let tolerance = absolute(tolerance, &input.read.shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.converting(input.format) };
    session.stage("converting");
    let mut scene = Stage::new(&input.read.shape, &job, session)?;
    if session.globals.strict {
        check_strict(scene.deviation, tolerance)?;
    }
    // Before the work of colouring: where there is no view there is no picture.
    let cameras: Vec<Camera> = match arguments.turntable {
        Some(frames) => scene.turntable(&look, frames)?,
        None => vec![scene.camera(&look)?],
    };
    let mut colors = Value::Null;
    if let Some(reference) = &arguments.reference {
        let plain = WayArguments { method: None, via: None, settings: Vec::new(), ..arguments.way.clone() };
        let as_it_is = SourceArguments { from: None, ..arguments.source };
        let other = Subject::open(reference, &plain, &as_it_is, input.read.shape.up, session)?;
        session.stage("measuring");
        let (from, to) = scene.color_by_distance(&other.simplices, arguments.color_range, session)?;
        let [dark, light] = [from, to].map(short);
        session.say(format_args!("colours: distance to {} from {dark} (dark) to {light} (light)", other.name));
        let error = account::deviation(other.deviation.then(scene.deviation));
        colors = json!({ "by": "distance", "reference": other.name, "from": from, "to": to, "error": error });
    }
    session.stage("drawing");
    let mut staged = Vec::new();
    for (path, camera) in paths.iter().zip(&cameras) {
        let bytes = scene.draw(&look, camera, session)?.to_png()?;
        staged.push(stage(path, arguments.force, |out| {
            out.write_all(&bytes).map_err(|error| Failure::write(path, &error))
        })?);
    }
    commit(staged, session)?;
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    session.say(format_args!("wrote {}", names.join(", ")));
    if session.globals.json {
        let object = json!({
            "schema": "shapeloom.render/1",
            "pictures": names,
            "width": look.picture.width,
            "height": look.picture.height,
            "colors": colors,
        });
        session.print_json(&object)?;
    }
    Ok(())
}

/// Refuses options of colours that do not go together.
fn check_coloring(arguments: &RenderArguments) -> Result<(), Failure> {
    let told = |message: &str| Err(Failure::usage("E-usage-color", message));
    match (arguments.color, &arguments.reference) {
        (ColorBy::Distance, None) => told("--color distance: found no shape to measure to, expected --reference FILE"),
        (ColorBy::Distance, Some(path)) if is_stream(path) && is_stream(&arguments.input) => {
            told("found standard input as the shape and as the reference, expected it once")
        }
        (ColorBy::Material, Some(_)) => told("found --reference, expected --color distance with it"),
        (ColorBy::Material, None) if arguments.color_range.is_some() => {
            told("found --color-range, expected --color distance with it")
        }
        _ => Ok(()),
    }
}

/// Refuses a picture whose name promises another format.
pub(crate) fn check_png(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => Err(Failure::Own {
            code: "E-picture-format",
            category: Category::Unsupported,
            message: format!("{}: found a picture with another extension, expected png", path.display()),
            advice: None,
        }),
        _ => Ok(()),
    }
}

fn look(arguments: &RenderArguments, session: &Session<'_>) -> Result<Look, Failure> {
    let (width, height) = arguments.size;
    let mut picture = Picture { width, height, wires: arguments.wires, seed: session.globals.seed, ..Picture::new() };
    if let Some(mode) = &arguments.mode {
        picture.set("mode", mode)?;
    }
    for (key, value) in &arguments.picture_settings {
        picture.set(key, value)?;
    }
    Ok(Look { picture, view: arguments.view })
}

/// `out.png` as `out-007.png`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{frame:03}."));
    name.push(path.extension().unwrap_or("png".as_ref()));
    path.with_file_name(name)
}
