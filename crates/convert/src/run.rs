//! Running plans on whole shapes.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use shapeloom_core::{Affine, AffineClass, ConvertError, Deviation, Exec, Loss, OptionValue, Report};
use shapeloom_shape::{Geometry, Kind, Part, Shape};

use crate::{Plan, PlanError, Request, Wish, plan};

/// A conversion of a whole shape.
#[derive(Clone, Debug)]
pub struct Job {
    /// Where each part must arrive.
    pub wish: Wish,
    /// The tolerance in the units of the shape.
    pub tolerance: f64,
    /// Options as `name` or `converter.name`, and their values.
    pub settings: Vec<(String, String)>,
}

/// One converter at work on one geometry.
#[derive(Clone, Debug)]
pub struct Step {
    /// The converter.
    pub converter: &'static str,
    /// The parts of the shape that have the geometry.
    pub parts: Vec<usize>,
    /// What went in.
    pub from: Kind,
    /// What came out.
    pub to: Kind,
    /// The options that it ran with.
    pub options: Vec<(&'static str, OptionValue)>,
    /// What it cost, in the geometry's own units.
    pub report: Report,
}

/// Seconds by step, in the order of the steps. Apart from the reports, so that those are the same in every run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timings {
    /// Wall-clock seconds of each step.
    pub seconds: Vec<f64>,
}

/// A converted shape with the account of how it came about.
#[derive(Clone, Debug)]
pub struct Conversion {
    /// The result: the same parts, names, materials and placements.
    pub shape: Shape,
    /// Every step on every geometry.
    pub steps: Vec<Step>,
    /// The largest deviation of a part, in the units of the shape.
    pub deviation: Deviation,
    /// Parts that were left out, each with why.
    pub losses: Vec<Loss>,
    /// How long each step took.
    pub timings: Timings,
}

/// Converts every part of a shape to the kinds wished for. A geometry that several parts share is converted once. A part
/// of a kind from which nothing leads there, such as loose edges beside faces, is left out and named in the losses; if
/// that is so for all parts it is an error.
///
/// The tolerance holds for the shape: a part that is placed larger is converted finer. Each lossy step on a way gets an
/// equal share of it.
///
/// # Errors
/// No way for any part, an option that no step has, or a step's own error.
pub fn convert_shape(shape: &Shape, job: &Job, exec: &Exec) -> Result<Conversion, ConvertError> {
    let mut groups: Vec<Group> = Vec::new();
    let mut known: HashMap<*const Geometry, usize> = HashMap::new();
    let mut losses = Vec::new();
    let mut left_out = vec![false; shape.parts.len()];
    let anywhere = Wish::to(job.wish.targets.clone());
    // A method that is named may lead where nothing else does.
    let reaches = |part: &Part| [&anywhere, &job.wish].iter().any(|wish| plan(part.geometry.kind(), wish).is_ok());
    let some_arrive = shape.parts.iter().any(reaches);
    for (index, part) in shape.parts.iter().enumerate() {
        if some_arrive && !reaches(part) {
            let targets: Vec<&str> = job.wish.targets.iter().map(|kind| kind.name()).collect();
            let what = format!("part {index}, a {}", part.geometry.kind());
            losses.push(Loss::new(what, format!("nothing leads from it to {}: it was left out", targets.join(" or "))));
            left_out[index] = true;
            continue;
        }
        let group = *known.entry(Arc::as_ptr(&part.geometry)).or_insert(groups.len());
        if group == groups.len() {
            let plan = plan(part.geometry.kind(), &job.wish)?;
            groups.push(Group { geometry: &part.geometry, parts: Vec::new(), plan, stretch: 0.0 });
        }
        groups[group].parts.push(index);
        groups[group].stretch = groups[group].stretch.max(stretch(&part.placement));
    }
    check_settings(&groups, &job.settings)?;
    check_must_set(&groups, &job.settings)?;

    let mut result = Conversion {
        shape: Shape { parts: shape.parts.clone(), ..shape.clone() },
        steps: Vec::new(),
        deviation: Deviation::Exact,
        losses,
        timings: Timings::default(),
    };
    let share = 1.0 / groups.len().max(1) as f64;
    for (number, group) in groups.iter().enumerate() {
        let exec = exec.part(number as f64 * share, (number + 1) as f64 * share);
        let (geometry, deviation) = group.convert(job, &exec, &mut result)?;
        for &part in &group.parts {
            let Part { name, placement, material, .. } = shape.parts[part].clone();
            result.shape.parts[part] = Part { name, geometry: Arc::clone(&geometry), placement, material };
        }
        result.deviation = result.deviation.or(deviation);
    }
    let mut kept = left_out.iter().map(|left_out| !left_out);
    result.shape.parts.retain(|_| kept.next().unwrap_or(true));
    exec.progress(1.0);
    Ok(result)
}

/// A geometry, the parts that have it, and its way.
struct Group<'a> {
    geometry: &'a Arc<Geometry>,
    parts: Vec<usize>,
    plan: Plan,
    /// The largest factor by which a placement stretches distances.
    stretch: f64,
}

impl Group<'_> {
    fn convert(
        &self,
        job: &Job,
        exec: &Exec,
        result: &mut Conversion,
    ) -> Result<(Arc<Geometry>, Deviation), ConvertError> {
        let mut geometry = Arc::clone(self.geometry);
        let mut deviation = Deviation::Exact;
        let lossy = self.plan.lossy_steps().max(1) as f64;
        // A part without size under its placement is converted as if it were placed as it is.
        let stretch = if self.stretch > 0.0 && self.stretch.is_finite() { self.stretch } else { 1.0 };
        let tolerance = job.tolerance / (lossy * stretch);
        let count = self.plan.steps.len() as f64;
        for (number, step) in self.plan.steps.iter().enumerate() {
            let exec = exec.part(number as f64 / count, (number + 1) as f64 / count);
            let settings: Vec<(String, String)> = job
                .settings
                .iter()
                .filter_map(|setting| setting_for(step.name, &step_options(step), setting))
                .collect();
            let request = Request { tolerance, settings: &settings };
            let options = step.settle(&geometry, &request)?;
            let start = Instant::now();
            let converted = step.run(&geometry, &request, &exec)?;
            result.timings.seconds.push(start.elapsed().as_secs_f64());
            deviation = deviation.then(converted.report.deviation);
            result.steps.push(Step {
                converter: step.name,
                parts: self.parts.clone(),
                from: step.from,
                to: step.to,
                options,
                report: converted.report,
            });
            geometry = Arc::new(converted.value);
        }
        Ok((geometry, scaled(deviation, stretch)))
    }
}

/// The largest factor by which a map stretches distances: exact for similarities, else bounded from above.
fn stretch(map: &Affine) -> f64 {
    // Within this relative tolerance a similarity's own rounding stays below what `scaled` adds.
    match map.class(1e-12) {
        AffineClass::Rigid => 1.0,
        AffineClass::Similarity { scale } => scale,
        AffineClass::General | AffineClass::Singular => map.stretch_bound(),
    }
}

fn scaled(deviation: Deviation, factor: f64) -> Deviation {
    match deviation {
        Deviation::AtMost(bound) if factor != 1.0 => Deviation::AtMost(bound * factor * (1.0 + 1e-11)),
        Deviation::Estimated(value) => Deviation::Estimated(value * factor),
        other => other,
    }
}

fn step_options(step: &crate::Converter) -> Vec<&'static str> {
    step.specs().iter().map(|spec| spec.name).collect()
}

/// The setting as the converter sees it, if it is meant for it: `name` if it has such an option, `converter.name` always.
fn setting_for(converter: &str, options: &[&str], (key, value): &(String, String)) -> Option<(String, String)> {
    match key.split_once('.') {
        Some((owner, name)) => (owner == converter).then(|| (name.to_owned(), value.clone())),
        None => options.contains(&key.as_str()).then(|| (key.clone(), value.clone())),
    }
}

/// Refuses a way with a converter whose options are not all told by the tolerance, and are not set either.
fn check_must_set(groups: &[Group<'_>], settings: &[(String, String)]) -> Result<(), PlanError> {
    for step in groups.iter().flat_map(|group| &group.plan.steps) {
        for &option in step.must_set {
            let sets = |setting| setting_for(step.name, &[option], setting).is_some_and(|(name, _)| name == option);
            if !settings.iter().any(sets) {
                return Err(PlanError::MissingOption { method: step.name, option });
            }
        }
    }
    Ok(())
}

/// Refuses options that no step on any way has.
fn check_settings(groups: &[Group<'_>], settings: &[(String, String)]) -> Result<(), PlanError> {
    let steps = || groups.iter().flat_map(|group| group.plan.steps.iter().copied());
    for setting in settings {
        if !steps().any(|step| setting_for(step.name, &step_options(step), setting).is_some()) {
            let mut known: Vec<String> = Vec::new();
            for step in steps() {
                for option in step_options(step) {
                    let name = format!("{}.{option}", step.name);
                    if !known.contains(&name) {
                        known.push(name);
                    }
                }
            }
            return Err(PlanError::UnknownOption { found: setting.0.clone(), known });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;
    use shapeloom_mesh::primitives::{Platonic, Solid};
    use shapeloom_mesh::{PointCloud, PolyMesh};
    use shapeloom_parametric::{BezierPatch, BezierSurface};

    fn saddle() -> BezierSurface {
        let net = (0..4).map(|k| DVec3::new(f64::from(k % 2), f64::from(k / 2), f64::from(u8::from(k == 3))));
        BezierSurface::new(vec![BezierPatch::try_new(1, 1, net.collect()).unwrap()])
    }

    fn job(settings: &[(&str, &str)]) -> Job {
        let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        Job { wish: Wish::to([Kind::TriMesh]), tolerance: 0.01, settings }
    }

    #[test]
    fn instances_are_converted_once_and_the_largest_sets_the_tolerance() {
        let part = Part::new(saddle());
        let large = Part { placement: Affine::from_scale(DVec3::splat(10.0)), ..part.clone() };
        let shape = Shape { parts: vec![part.clone(), large], ..Shape::default() };
        let both = convert_shape(&shape, &job(&[]), &Exec::default()).unwrap();
        assert_eq!((both.steps.len(), both.timings.seconds.len()), (1, 1));
        assert!(Arc::ptr_eq(&both.shape.parts[0].geometry, &both.shape.parts[1].geometry));
        assert!(both.deviation.is_within(0.01));
        let alone = convert_shape(&Shape::new(part), &job(&[]), &Exec::default()).unwrap();
        let triangles = |conversion: &Conversion| conversion.steps[0].report.find("triangles").unwrap();
        assert!(triangles(&both) > 5.0 * triangles(&alone));
    }

    #[test]
    fn settings_reach_their_step_or_are_refused() {
        let shape = Shape::new(Part::new(saddle()));
        let plain = convert_shape(&shape, &job(&[("normals", "false")]), &Exec::default()).unwrap();
        assert!(plain.steps[0].options.contains(&("normals", OptionValue::Bool(false))));
        let exact = job(&[("tessellate-patches.chord_tolerance", "0.5")]);
        assert_eq!(
            convert_shape(&shape, &exact, &Exec::default()).unwrap().steps[0].report.find("triangles"),
            Some(2.0)
        );
        let error = convert_shape(&shape, &job(&[("colour", "red")]), &Exec::default()).unwrap_err();
        assert!(matches!(error.narrow(), Some(PlanError::UnknownOption { .. })));
        assert!(convert_shape(&shape, &job(&[("normals", "maybe")]), &Exec::default()).is_err());
    }

    #[test]
    fn nothing_to_do_is_exact_and_empty_shapes_pass() {
        let cube = Platonic::new(Solid::Cube).mesh(&Exec::default()).unwrap().value;
        let shape = Shape::new(Part::new(cube));
        let keep = Job { wish: Wish::to([Kind::PolyMesh]), ..job(&[]) };
        let conversion = convert_shape(&shape, &keep, &Exec::default()).unwrap();
        assert_eq!((conversion.shape, conversion.deviation), (shape, Deviation::Exact));
        assert!(convert_shape(&Shape::default(), &job(&[]), &Exec::default()).unwrap().steps.is_empty());
    }

    #[test]
    fn parts_that_lead_nowhere_are_left_out_beside_others() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let cloud = Part::new(PointCloud::new(points.clone()));
        let mesh = Part::new(PolyMesh::from_faces(points, &[[0, 1, 2]]).unwrap()).named("mesh");
        let job = Job { wish: Wish::to([Kind::TriMesh]), tolerance: 1.0, settings: Vec::new() };
        let shape = Shape { parts: vec![cloud.clone(), mesh, cloud.clone()], ..Shape::default() };
        let conversion = convert_shape(&shape, &job, &Exec::default()).unwrap();
        assert_eq!((conversion.shape.parts.len(), conversion.shape.parts[0].name.as_str()), (1, "mesh"));
        assert_eq!(conversion.losses.len(), 2);
        assert!(conversion.losses[1].what.contains("part 2, a point-cloud"), "{:?}", conversion.losses);
        assert!(convert_shape(&Shape::new(cloud), &job, &Exec::default()).is_err());
    }
}
