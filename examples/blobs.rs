//! A molecule as blobs at three scales, and the four classical forms side by side.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Field};
use shapeloom::implicit::{AtomBlobs, Blob, BlobForm, Blobs};
use shapeloom::io::{ReadContext, looks_like_xyz_molecule, read_xyz_molecule};
use shapeloom::isosurface::{FieldSlabs, Lattice, ManifoldSurfaceNets};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

const FULLERENE: &[u8] = include_bytes!("../data/c60.xyz");

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    assert!(looks_like_xyz_molecule(FULLERENE));
    let molecule = read_xyz_molecule(FULLERENE, &ReadContext::named("c60.xyz"))?.molecule;
    println!("{}: {} atoms", molecule.title, molecule.atoms.len());
    let mut scene = Scene::default();
    for (place, (scale, blobbiness)) in [(0.38, 4.0), (0.5, 2.0), (1.0, 2.0)].into_iter().enumerate() {
        let blobs = molecule.blobs(&AtomBlobs { scale, blobbiness, ..AtomBlobs::default() })?;
        println!("scale {scale}, blobbiness {blobbiness}: value in the middle {:.3}", blobs.value(DVec3::ZERO));
        let at = DVec3::new(10.0 * (place as f64 - 1.0), 0.0, 4.0);
        scene.surfaces.push(surface(&blobs, at, 1.0, [0.45, 0.55, 0.65])?);
    }

    let pair = |form, threshold, first, second| {
        let blobs = [-1.1, 1.1].map(|x| Blob::new(DVec3::new(x, 0.0, 0.0), first, second));
        Blobs::try_new(form, threshold, blobs.to_vec())
    };
    // Alone each would be a ball of radius 1.
    let forms = [
        pair(BlobForm::Blinn, 0.5, 1.0, 2.0_f64.ln())?,
        pair(BlobForm::Blobby, 1.0, 1.0, 2.0)?,
        pair(BlobForm::Metaballs, 0.375, 2.0, 1.0)?,
        pair(BlobForm::SoftObjects, 0.5, 2.0, 1.0)?,
    ];
    for (place, blobs) in forms.iter().enumerate() {
        println!("{}: value between the two {:.3}", blobs.form().name(), blobs.value(DVec3::ZERO));
        let at = DVec3::new(7.5 * (place as f64 - 1.5), 0.0, -4.2);
        scene.surfaces.push(surface(blobs, at, 1.7, [0.75, 0.55, 0.35])?);
    }
    println!("{}", output.draw("blobs", &scene, [0.0, 0.0], Picture::new())?.display());
    Ok(())
}

/// The surface of blobs, scaled, moved and coloured, smooth by the normals of the field.
fn surface(blobs: &Blobs, shift: DVec3, scale: f64, color: [f32; 3]) -> Result<SceneMesh, Box<dyn Error>> {
    let bounds = blobs.bounds();
    let spacing = bounds.size().max_element() / 60.0;
    let dimensions = (bounds.size() / spacing).to_array().map(|length| length.ceil() as u32 + 1);
    let lattice = Lattice::along_axes(dimensions, bounds.min, DVec3::splat(spacing))?;
    let mesh = ManifoldSurfaceNets::new().convert(&FieldSlabs::new(blobs, lattice))?.value;
    println!("  {} triangles", mesh.triangles().len());
    let smooth: Vec<DVec3> = mesh.positions().iter().map(|&p| blobs.gradient(p).normalize_or_zero()).collect();
    let normals = mesh.triangles().as_flattened().iter().map(|&vertex| smooth[vertex as usize]).collect();
    let positions = mesh.positions().iter().map(|&position| position * scale + shift).collect();
    Ok(SceneMesh { normals: Some(normals), color, ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
