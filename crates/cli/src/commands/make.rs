//! `make`: ready shapes.

use serde_json::json;
use shapeloom_convert::{Job, Wish};
use shapeloom_core::{ChoiceOption, ConvertError, Converted, Exec, Options, Tolerance};
use shapeloom_mesh::PolyMesh;
use shapeloom_mesh::primitives::{Cone, Cylinder, Ellipsoid, Grid, Platonic, Quadric, Solid, Sphere, Torus};
use shapeloom_shape::{Part, Shape, UpAxis};

use super::convert::Delivery;
use crate::account;
use crate::arguments::MakeArguments;
use crate::failure::Failure;
use crate::session::Session;
use crate::settings;

pub(crate) fn run(arguments: &MakeArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let settings = settings::Settings::of_made(&arguments.settings);
    let delivery = Delivery::new(&arguments.target, &settings)?;
    delivery.check(session)?;
    let made = make(&arguments.shape, settings.making(), &session.exec())?;
    session.say(format_args!(
        "{}: {} faces; error {}",
        arguments.shape,
        made.value.face_count(),
        made.report.deviation
    ));
    let diagonal = made.value.bounds().diagonal();
    let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(made.value).named(arguments.shape.as_str())) };
    let source = json!({ "shape": arguments.shape, "report": account::report(&made.report) });
    // For judging the facets, which are fixed by the shape's own options.
    let tolerance = Tolerance::OfDiagonal(1e-3).resolve(diagonal)?;
    let job = Job { wish: Wish::to(delivery.format.kinds), tolerance, settings: Vec::new() };
    delivery.deliver(source, &shape, made.report.deviation, &job, session)
}

type Settings<'a> = &'a [(String, String)];

fn make(name: &str, settings: Settings<'_>, exec: &Exec) -> Result<Converted<PolyMesh>, Failure> {
    fn with<O: Options>(
        mut options: O,
        settings: Settings<'_>,
        mesh: impl Fn(&O) -> Result<Converted<PolyMesh>, ConvertError>,
    ) -> Result<Converted<PolyMesh>, Failure> {
        for (key, value) in settings {
            options.set(key, value)?;
        }
        Ok(mesh(&options)?)
    }
    if let Some(solid) = Solid::from_name(name) {
        return with(Platonic::new(solid), settings, |shape| shape.mesh(exec));
    }
    match name {
        Sphere::NAME => with(Sphere::new(), settings, |shape| shape.mesh(exec)),
        Torus::NAME => with(Torus::new(), settings, |shape| shape.mesh(exec)),
        Cylinder::NAME => with(Cylinder::new(), settings, |shape| shape.mesh(exec)),
        Cone::NAME => with(Cone::new(), settings, |shape| shape.mesh(exec)),
        Grid::NAME => with(Grid::new(), settings, |shape| shape.mesh(exec)),
        Ellipsoid::NAME => with(Ellipsoid::new(), settings, |shape| shape.mesh(exec)),
        Quadric::NAME => with(Quadric::new(), settings, |shape| shape.mesh(exec)),
        _ => {
            let mut known = Solid::NAMES.to_vec();
            known.extend([Sphere::NAME, Torus::NAME, Cylinder::NAME, Cone::NAME, Grid::NAME]);
            known.extend([Ellipsoid::NAME, Quadric::NAME]);
            let message = format!("found shape \"{name}\", expected one of {}", known.join(", "));
            Err(Failure::usage("E-usage-shape", message))
        }
    }
}
