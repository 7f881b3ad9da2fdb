//! JSON with its buffer inside, and instances written out.

use std::sync::Arc;

use serde_json::Value;
use shapeloom_core::Affine;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::{Part, Shape, UpAxis};

use super::{from_glb, rich, scene, to_glb, turn};
use crate::{Instances, ReadContext, WriteContext, detect, format_by_id, read, write};

#[test]
fn json_holds_the_same_as_the_binary_file() {
    let mut file = Vec::new();
    let report = write(&scene(), format_by_id("gltf").unwrap(), &WriteContext::default(), &mut file).unwrap();
    let (binary, other) = to_glb(&scene()).unwrap();
    assert_eq!((&report.losses, report.deviation), (&other.losses, other.deviation));
    assert_eq!(report.findings, other.findings);
    let format = detect(&file, None).unwrap();
    assert_eq!(format.id, "gltf");
    // A reader that is given nothing beside the file: all of it is inside.
    let back = read(&file, format, &ReadContext::default()).unwrap();
    assert_eq!(back, from_glb(&binary));
    let (document, buffers, _) = ::gltf::import_slice(&file).unwrap();
    let (other, other_buffers, _) = ::gltf::import_slice(&binary).unwrap();
    assert_eq!(document.accessors().count(), other.accessors().count());
    assert_eq!(buffers[0].0, other_buffers[0].0[..buffers[0].0.len()]);
    assert_eq!(report.find("bytes"), Some(file.len() as f64));
}

#[test]
fn a_shape_without_data_has_no_buffer() {
    let mut file = Vec::new();
    write(&Shape::default(), format_by_id("gltf").unwrap(), &WriteContext::default(), &mut file).unwrap();
    let json: Value = serde_json::from_slice(&file).unwrap();
    assert!(json.get("buffers").is_none() && file.ends_with(b"}\n"));
    let back = read(&file, format_by_id("gltf").unwrap(), &ReadContext::default()).unwrap();
    assert!(back.shape.parts.is_empty());
}

#[test]
fn instances_are_written_out_where_that_is_asked_for() {
    let part = Part::new(rich()).named("a");
    let moved = Part { placement: turn(), ..part.clone() }.named("b");
    let shear = Part { placement: Affine::from_shear(DVec3::X, DVec3::Y), ..part.clone() }.named("c");
    let shape = Shape { parts: vec![part.clone(), moved, part, shear], up: Some(UpAxis::Y), ..Shape::default() };
    let mut context = WriteContext::default();
    context.options.instances = Instances::Flatten;
    let mut file = Vec::new();
    let report = write(&shape, format_by_id("glb").unwrap(), &context, &mut file).unwrap();
    let kept = ["positions", "vertex attribute \"normal\""];
    assert!(report.losses.iter().all(|loss| kept.contains(&loss.what.as_str())), "{:?}", report.losses);
    let back = from_glb(&file).shape;
    assert_eq!(back.parts.len(), 4);
    for (index, (part, source)) in back.parts.iter().zip(&shape.parts).enumerate() {
        assert_eq!((&part.name, part.placement), (&source.name, Affine::IDENTITY));
        assert!(back.parts[..index].iter().all(|other| !Arc::ptr_eq(&other.geometry, &part.geometry)));
        let (found, wanted) = (part.geometry.bounds(), source.placed().bounds());
        assert!(found.min.distance(wanted.min) < 1e-6 && found.max.distance(wanted.max) < 1e-6, "{index}");
    }
    let (kept, _) = to_glb(&shape).unwrap();
    let kept = from_glb(&kept).shape;
    assert!(Arc::ptr_eq(&kept.parts[0].geometry, &kept.parts[1].geometry));
    assert_eq!(kept.parts[1].placement, turn());
}
