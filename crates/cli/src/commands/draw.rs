//! Drawing shapes of any kind: what is not triangles is converted for the picture.

use shapeloom_convert::{Job, Wish, convert_shape, plan};
use shapeloom_core::{Aabb, Camera, Category, Deviation, Options, Reservation, Words};
use shapeloom_judge::Simplices;
use shapeloom_render::{Image, Picture, Scene, camera_from, scene_of_shape, sensible_camera, turntable};
use shapeloom_shape::{Kind, Shape, UpAxis};

use super::coloring::color_by_distance;
use crate::failure::Failure;
use crate::session::Session;

/// How a picture is to look.
pub(crate) struct Look {
    pub(crate) picture: Picture,
    /// Azimuth and elevation in degrees; a three-quarter view if none is given.
    pub(crate) view: Option<(f64, f64)>,
}

impl Look {
    /// The usual look, with the seed of the command line.
    pub(crate) fn of_session(session: &Session<'_>) -> Self {
        Self { picture: Picture { seed: session.globals.seed, ..Picture::new() }, view: None }
    }

    fn aspect(&self) -> f64 {
        f64::from(self.picture.width) / f64::from(self.picture.height)
    }
}

/// What is needed to draw a shape from anywhere.
pub(crate) struct Stage {
    scene: Scene,
    up: UpAxis,
    /// How far the triangles that are drawn may be from the shape.
    pub(crate) deviation: Deviation,
    _memory: Reservation,
}

impl Stage {
    /// Sets up the parts of a shape that can become triangles within the tolerance; others are named and left out.
    pub(crate) fn new(shape: &Shape, job: &Job, session: &mut Session<'_>) -> Result<Self, Failure> {
        let mut drawable = Shape { parts: Vec::new(), ..shape.clone() };
        for (index, part) in shape.parts.iter().enumerate() {
            match plan(part.geometry.kind(), &job.wish) {
                Ok(_) => drawable.parts.push(part.clone()),
                Err(error) if job.wish.method.is_some() || job.wish.via.is_some() => return Err(error.into()),
                Err(_) => session.say(format_args!("not drawn: part {index}, a {}", part.geometry.kind())),
            }
        }
        if drawable.parts.is_empty() {
            let kinds: Vec<&str> = shape.kinds().into_iter().map(Kind::name).collect();
            let found = if kinds.is_empty() { "nothing".to_owned() } else { kinds.join(", ") };
            return Err(empty(&found));
        }
        let exec = session.exec();
        let conversion = convert_shape(&drawable, job, &exec)?;
        conversion.steps.iter().for_each(|step| session.say_findings(&step.report.findings));
        let (scene, memory) = scene_of_shape(&conversion.shape, &exec)?;
        let bounds = scene.bounds();
        if bounds.is_empty() {
            return Err(empty("no triangles"));
        }
        if largest(&bounds) >= TOO_LARGE {
            return Err(wrong_size(&bounds));
        }
        let up = shape.up.unwrap_or(UpAxis::Z);
        Ok(Self { scene, up, deviation: conversion.deviation, _memory: memory })
    }

    /// Colours the surfaces by their distance to a shape, and returns the distances at the ends of the colours.
    pub(crate) fn color_by_distance(
        &mut self,
        to: &Simplices<'_>,
        range: Option<(f64, f64)>,
        session: &Session<'_>,
    ) -> Result<(f64, f64), Failure> {
        color_by_distance(&mut self.scene, to, range, &session.exec())
    }

    /// Draws one picture.
    pub(crate) fn draw(&self, look: &Look, camera: &Camera, session: &Session<'_>) -> Result<Image, Failure> {
        Ok(look.picture.draw(&self.scene, camera, self.up.vector(), &session.exec())?)
    }

    /// The camera that a look asks for.
    pub(crate) fn camera(&self, look: &Look) -> Result<Camera, Failure> {
        let (bounds, up, aspect) = (self.scene.bounds(), self.up.vector(), look.aspect());
        let camera = match look.view {
            Some((azimuth, elevation)) => {
                camera_from(&bounds, up, azimuth.to_radians(), elevation.to_radians(), aspect)
            }
            None => sensible_camera(&bounds, up, aspect),
        };
        camera.map_err(|_| wrong_size(&bounds))
    }

    /// The cameras of a turntable.
    pub(crate) fn turntable(&self, look: &Look, frames: u32) -> Result<Vec<Camera>, Failure> {
        let bounds = self.scene.bounds();
        turntable(&bounds, self.up.vector(), look.aspect(), frames).map_err(|_| wrong_size(&bounds))
    }
}

/// Why there is no picture of nothing.
fn empty(found: &str) -> Failure {
    Failure::Own {
        code: "E-picture-empty",
        category: Category::Unsupported,
        message: format!("picture: found {found}, expected something with a surface"),
        advice: None,
    }
}

/// Coordinates from here on are not drawn, as their squares are hardly numbers.
const TOO_LARGE: f64 = 1e150;

/// Why there is no picture of what no view takes in. Angles and proportions are checked by then: it is the size.
fn wrong_size(bounds: &Aabb) -> Failure {
    let size = Words(largest(bounds));
    Failure::Own {
        code: "E-picture-size",
        category: Category::Unsupported,
        message: format!("picture: found coordinates up to {size}, expected a size between about 1e-150 and 1e150"),
        advice: Some("scale the shape".into()),
    }
}

fn largest(bounds: &Aabb) -> f64 {
    bounds.max.abs().max(bounds.min.abs()).max_element()
}

/// A picture of a shape as it is.
pub(crate) fn picture_of(
    shape: &Shape,
    tolerance: f64,
    look: &Look,
    session: &mut Session<'_>,
) -> Result<Image, Failure> {
    look.picture.validate()?;
    let job = Job { wish: Wish::to([Kind::TriMesh]), tolerance, settings: Vec::new() };
    let stage = Stage::new(shape, &job, session)?;
    let camera = stage.camera(look)?;
    stage.draw(look, &camera, session)
}
