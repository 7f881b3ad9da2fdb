//! Blobs of molecules/7DDO.pdb (else of atoms made up) on a lattice: found by a hierarchy, and all of them at each point; and their surface.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, Exec, Field};
use shapeloom_implicit::{Atom, AtomBlobs, Blobs, Element, Molecule};
use shapeloom_io::{ReadContext, read_pdb};
use shapeloom_isosurface::{FieldSlabs, Lattice, ManifoldSurfaceNets, Slabs};

use crate::{Outcome, Setting, measure};

/// How many points all blobs are added up at.
const BRUTE_FORCE: u32 = 4000;

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let side = setting.size.clamp(8, 256);
    let mut outcomes = Vec::new();
    for (name, molecule) in molecules(setting, side)? {
        let (blobs, build) = measure::fastest(setting.runs, || {
            molecule.blobs(&AtomBlobs::default()).map_err(|error| error.to_string())
        })?;
        let count = molecule.atoms.len();
        outcomes.push(outcome(&name, "build", build, [("blobs", json!(count))]));
        let lattice = lattice(&blobs, side)?;
        let slabs = FieldSlabs::new(&blobs, lattice);
        let (inside, times) = measure::fastest(setting.runs, || sampled(&slabs, side))?;
        let rate = f64::from(side).powi(3) / times.cpu;
        let figures =
            [("inside", json!(inside)), ("samples", json!(lattice.samples())), ("samples_per_cpu_s", json!(rate))];
        outcomes.push(outcome(&name, "lattice", times, figures));
        let (worst, times) = measure::fastest(1, || Ok(brute_force(&blobs, &lattice)))?;
        let rate = f64::from(BRUTE_FORCE) / times.cpu;
        let figures = [("largest_difference", json!(worst)), ("samples_per_cpu_s", json!(rate))];
        outcomes.push(outcome(&name, "all blobs at each point", times, figures));
        let (mesh, times) = measure::fastest(setting.runs, || {
            ManifoldSurfaceNets::new().convert_with(&slabs, &Exec::default()).map_err(|error| error.to_string())
        })?;
        outcomes.push(outcome(&name, "surface", times, [("triangles", json!(mesh.value.triangles().len()))]));
    }
    Ok(outcomes)
}

fn outcome<const N: usize>(
    name: &str,
    what: &str,
    times: measure::Times,
    figures: [(&str, serde_json::Value); N],
) -> Outcome {
    // Every task says how many triangles came of it.
    let none = [("triangles", json!(0))];
    let figures: Map<String, serde_json::Value> =
        none.into_iter().chain(figures).map(|(key, value)| (key.to_owned(), value)).collect();
    Outcome { input: format!("{name}: {what}"), times, figures }
}

fn molecules(setting: &Setting, side: u32) -> Result<Vec<(String, Molecule)>, String> {
    let path = setting.data.join("molecules/7DDO.pdb");
    let mut molecules = Vec::new();
    if path.exists() {
        let said = |error: String| format!("{}: {error}", path.display());
        let bytes = std::fs::read(&path).map_err(|error| said(error.to_string()))?;
        let read = read_pdb(&bytes, &ReadContext::default()).map_err(|error| said(error.to_string()))?;
        molecules.push(("7DDO".to_owned(), read.molecule));
    }
    // 50,000 for the largest lattice.
    let count = if side < 64 { 500 } else { 50_000 };
    molecules.push((format!("{count} atoms"), made_up(count)));
    Ok(molecules)
}

/// Carbon, nitrogen, oxygen and hydrogen in a ball, as dense as proteins.
fn made_up(count: u32) -> Molecule {
    let elements = [Element::CARBON, Element::NITROGEN, Element::OXYGEN, Element::HYDROGEN];
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    // Ten cubic ångströms each.
    let radius = (10.0 * f64::from(count) * 0.75 / std::f64::consts::PI).cbrt();
    let mut atoms = Vec::new();
    while atoms.len() < count as usize {
        let place = DVec3::new(random(), random(), random());
        if place.length() <= 1.0 {
            atoms.push(Atom { element: elements[atoms.len() % 4], position: place * radius });
        }
    }
    Molecule { atoms, title: String::new() }
}

fn lattice(blobs: &Blobs, side: u32) -> Result<Lattice, String> {
    let bounds = blobs.bounds();
    let spacing = bounds.size().max_element() / f64::from(side - 1);
    Lattice::along_axes([side; 3], bounds.min, DVec3::splat(spacing)).map_err(|error| error.to_string())
}

/// How many samples are inside.
fn sampled(slabs: &FieldSlabs<'_, Blobs>, side: u32) -> Result<u64, String> {
    let mut buffer = Vec::new();
    let mut inside = 0;
    for k in 0..side {
        let slab = slabs.slab(k, &mut buffer).map_err(|error| error.to_string())?;
        inside += slab.iter().filter(|&&value| value < 0.0).count() as u64;
    }
    Ok(inside)
}

/// The largest difference to the sum of all blobs in double precision.
fn brute_force(blobs: &Blobs, lattice: &Lattice) -> f64 {
    let step = lattice.samples() / u64::from(BRUTE_FORCE);
    let difference = |at: u32| {
        let point = lattice.position(lattice.coordinates(u64::from(at) * step));
        let mut sum = 0.0;
        for blob in blobs.blobs() {
            let [radius, blobbiness] = blob.parameters;
            sum += (blobbiness - blobbiness * point.distance_squared(blob.center) / (radius * radius)).exp();
        }
        (blobs.value(point) - (blobs.threshold() - sum)).abs()
    };
    (0..BRUTE_FORCE).map(difference).fold(0.0, f64::max)
}
