//! What writers of formats without scenes share: parts put where they are, and the losses that the format's table entry
//! implies.

use std::collections::HashSet;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Loss};
use shapeloom_mesh::{Attributes, Domain};
use shapeloom_shape::{Geometry, Part, Shape};

use crate::{Format, Keeps, WriteError};

/// The losses of the shape's frame: names, parts, instances, materials, units and up axis, where the format does not
/// keep them.
pub(crate) fn frame_losses(shape: &Shape, format: &Format) -> Vec<Loss> {
    let mut losses = Vec::new();
    let keeps = |what: Keeps| format.keeps.contains(&what);
    let name = format.name;
    if !keeps(Keeps::Parts) && shape.parts.len() > 1 {
        let count = shape.parts.len();
        losses.push(Loss::new(format!("{count} separate parts"), format!("{name} holds one: they were put together")));
    }
    if !keeps(Keeps::Names) {
        for part in shape.parts.iter().filter(|part| !part.name.is_empty()) {
            losses.push(Loss::new(format!("part name \"{}\"", part.name), format!("{name} has no place for it")));
        }
    }
    if !keeps(Keeps::Instances) {
        let placed = shape.parts.iter().filter(|part| part.placement != Affine::IDENTITY).count();
        if placed > 0 {
            let why = format!("{name} has none: they were applied to the coordinates");
            losses.push(Loss::new(format!("placements of {placed} parts"), why));
        }
        let mut seen = HashSet::new();
        let repeated = shape.parts.iter().filter(|part| !seen.insert(Arc::as_ptr(&part.geometry))).count();
        if repeated > 0 {
            let why = format!("{name} has none: each was written out");
            losses.push(Loss::new(format!("{repeated} instances of shared geometries"), why));
        }
    }
    if !keeps(Keeps::Materials) {
        for material in &shape.materials {
            let why = format!("{name} has no place for it");
            losses.push(Loss::new(format!("material \"{}\"", material.name), why));
        }
    }
    if let Some(units) = shape.units.filter(|_| !keeps(Keeps::Units)) {
        let why = format!("{name} has no place for it");
        losses.push(Loss::new(format!("unit of length ({} m)", units.meters()), why));
    }
    if let Some(up) = shape.up.filter(|_| !keeps(Keeps::UpAxis)) {
        losses.push(Loss::new(format!("up axis ({})", up.name()), format!("{name} has no place for it")));
    }
    losses
}

/// The geometry of a part where it is placed, with every position checked.
pub(crate) fn placed_part(format: &'static str, index: usize, part: &Part) -> Result<Arc<Geometry>, WriteError> {
    let geometry = part.placed();
    check_finite(format, index, part, &geometry)?;
    Ok(geometry)
}

/// Refuses positions that are not finite.
pub(crate) fn check_finite(
    format: &'static str,
    index: usize,
    part: &Part,
    geometry: &Geometry,
) -> Result<(), WriteError> {
    let first = |points: &[DVec3]| points.iter().position(|point| !point.is_finite());
    let found = match geometry {
        Geometry::BezierSurface(surface) => {
            let mut before = 0;
            surface.patches.iter().find_map(|patch| {
                let found = first(patch.control_points()).map(|point| before + point);
                before += patch.control_points().len();
                found
            })
        }
        Geometry::BezierCurve(curve) => first(curve.control_points()),
        geometry => points_of(geometry).and_then(first),
    };
    let element = match geometry {
        Geometry::BezierSurface(_) | Geometry::BezierCurve(_) => "control point",
        _ => "vertex",
    };
    match found {
        Some(at) => Err(WriteError::NotFinite { format, part: index, name: part.name.clone(), element, index: at }),
        None => Ok(()),
    }
}

/// How far a point moves, rounded up.
pub(crate) fn moved(from: DVec3, to: DVec3) -> f64 {
    let apart = (to - from).abs();
    let largest = apart.max_element();
    // In units of the largest component, as squares of tiny ones vanish; and the length itself is rounded.
    if largest == 0.0 { 0.0 } else { (apart / largest).length() * largest * (1.0 + 8.0 * f64::EPSILON) }
}

/// The vertices of a geometry made of vertices.
pub(crate) fn points_of(geometry: &Geometry) -> Option<&[DVec3]> {
    match geometry {
        Geometry::PointCloud(cloud) => Some(cloud.positions()),
        Geometry::Polyline(line) => Some(line.points()),
        Geometry::PolyMesh(mesh) => Some(mesh.positions()),
        Geometry::TriMesh(mesh) => Some(mesh.positions()),
        _ => None,
    }
}

/// The columns of a geometry on one kind of element.
pub(crate) fn columns_of(geometry: &Geometry, domain: Domain) -> Option<&Attributes> {
    match (geometry, domain) {
        (Geometry::PointCloud(cloud), Domain::Vertex) => Some(cloud.attributes()),
        (Geometry::Polyline(line), Domain::Vertex) => Some(line.attributes()),
        (Geometry::PolyMesh(mesh), _) => Some(mesh.attributes().of(domain)),
        (Geometry::TriMesh(mesh), _) => Some(mesh.attributes().of(domain)),
        _ => None,
    }
}

/// Losses gathered so that each is said once, however many parts have it.
#[derive(Default)]
pub(crate) struct Losses(Vec<Loss>);

impl Losses {
    pub(crate) fn from(losses: Vec<Loss>) -> Self {
        Self(losses)
    }

    pub(crate) fn push(&mut self, what: impl Into<String>, why: impl Into<String>) {
        let loss = Loss::new(what, why);
        if !self.0.contains(&loss) {
            self.0.push(loss);
        }
    }

    pub(crate) fn column(&mut self, domain: Domain, name: &str, why: impl Into<String>) {
        self.push(format!("{domain} attribute \"{name}\""), why);
    }

    pub(crate) fn into_vec(self) -> Vec<Loss> {
        self.0
    }
}
