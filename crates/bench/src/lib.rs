//! Measures what the libraries do: one JSON line for each set of runs.
//!
//! `cargo run --release -p shapeloom-bench -- TASK [--data DIR] [--runs N] [--threads N] [--json]`. Inputs are loaded
//! before the clock starts, unless reading is the task. Wall and CPU seconds are those of the fastest run.

mod blobs;
mod closest;
mod delaunay2d;
mod field_eval;
mod files;
mod half_edges;
mod hausdorff;
mod heightfield;
mod implicit_surface;
mod isosurface;
mod measure;
mod mesh_to_sdf;
mod octree;
mod queries;
mod rays;
mod redistance;
mod self_intersection;
mod signed_distance;
mod surface_nets;
mod surface_queries;
mod table;
mod tessellate;
mod topology;
mod winding;

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use serde_json::{Map, Value, json};

/// Measures one task.
#[derive(Debug, Parser)]
#[command(name = "shapeloom-bench", version)]
struct Arguments {
    /// What to measure
    task: Task,
    /// The folder with the inputs
    #[arg(long, default_value = "data")]
    data: PathBuf,
    /// How many runs; the fastest counts
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    /// How many threads; by default one for each processor
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// The tolerance of conversions, relative to the diagonal of the input's bounding box
    #[arg(long, default_value_t = 1e-4)]
    tolerance: f64,
    /// How many samples a side has a terrain made by formula
    #[arg(long, default_value_t = 2048, value_parser = clap::value_parser!(u32).range(2..=16_384))]
    size: u32,
    /// A file with the JSON lines of peers: print a table of their figures beside these instead
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    against: Option<PathBuf>,
    /// Print JSON, which is what is printed anyhow
    #[arg(long)]
    json: bool,
}

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Task {
    /// The teapot's patches to triangles.
    Tessellate,
    /// Mesh files of a million triangles (blob_1m.ply, .stl, .obj, .off, .glb) to meshes, from the disk.
    Read,
    /// The same mesh to every format, in memory.
    Write,
    /// The topology report of the same mesh (PLY alone).
    Topology,
    /// All faces of the same mesh that meet each other, exactly.
    SelfIntersection,
    /// Winding numbers of blob_1m.ply at points near it (qry_surface.f32) and in its box (qry_box.f32, every tenth).
    Winding,
    /// Signed distances to the same mesh at the same points.
    SignedDistance,
    /// How far meshes are apart, bounded from both sides.
    Hausdorff,
    /// A hierarchy over blob_1m.ply, and the rays of rays_random.f32 and rays_camera.f32 (else of a formula) on it.
    Rays,
    /// Closest points of blob_1m.ply to qry_surface.f32 and every tenth of qry_box.f32 (else to points of a formula).
    Closest,
    /// Half-edges of blob_1m.ply, from its triangles.
    Halfedge,
    /// Sweeps over the one-rings of the same mesh: a sum over neighbours, and the vertices' normals.
    Onering,
    /// A terrain made by formula to triangles: regular, and adaptive.
    Heightfield,
    /// Isosurfaces of vol_blend.f32 and vol_gyroid.f32 (else of a formula).
    Isosurface,
    /// The Delaunay triangulation of the points of pts2d.f64 (else of a formula).
    Delaunay2d,
    /// Surface nets of vol_blend.f32 and vol_gyroid.f32 (else of a small volume of a formula).
    #[value(name = "surfacenets")]
    SurfaceNets,
    /// Signed distances of blob_1m.ply (else of a torus) on 256³ samples.
    MeshToSdf,
    /// Values of the implicits in .vm files (else of a formula) at many points, beside fidget's interpreter.
    FieldEval,
    /// Bounds of the same over boxes, and simplification there, beside fidget's.
    IntervalEval,
    /// The same to triangles at 256³ samples: with samples left out where bounds settle the sign, and without.
    ImplicitSurface,
    /// An octree over blob_1m.ply beside the hierarchy: build, the rays of rays_random.f32, boxes; and a grid to an
    /// octree and back.
    Octree,
    /// Signed distances of vol_blend.f32, vol_gyroid.f32 and tooth.nrrd (else of a small volume of a formula): all, and
    /// those of a narrow band.
    Redistance,
    /// Blobs of molecules/7DDO.pdb and of atoms made up: on a lattice, beside all blobs at each point, and their surface.
    Blobs,
}

impl Task {
    /// Every task.
    pub fn all() -> &'static [Self] {
        Self::value_variants()
    }

    /// The name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl Task {
    /// What peers call the same work on the same input; some have a name for each way to run it.
    pub(crate) fn peer_tasks(self, input: &str) -> Vec<String> {
        let last = |separator: [char; 2]| input.rsplit(separator).next().unwrap_or_default();
        let names = |task: &str, ways: &[&str]| ways.iter().map(|way| format!("{task}{way}")).collect();
        match self {
            Self::Read => vec![format!("m.read_1m_{}", last(['.', '.']))],
            Self::Rays => match input.rsplit(": ").next().unwrap_or_default() {
                "build" => names("j.rays.build_", &["bvh", "aabb"]),
                "random first" => names("j.rays.random", &["", "_t1", "_tall"]),
                "camera first" => names("j.rays.camera", &["", "_t1", "_tall"]),
                "random any" => names("j.rays.any_random", &["_t1", "_tall"]),
                _ => Vec::new(),
            },
            Self::Closest => {
                let size = if last([':', ' ']) == "near" { "near_1m" } else { "box_100k" };
                names(&format!("j.closest_{size}"), &[".query", ".build+query", ".t1", ".tall"])
            }
            Self::Delaunay2d => vec!["k.delaunay2d_1m".into(), "k.delaunay2d_1m.f32".into()],
            Self::SurfaceNets => {
                let volume = if input.contains("blend") { "b.mc256_blend" } else { "b.mc256_gyroid" };
                if input.contains(".f32: open") { vec![volume.into()] } else { Vec::new() }
            }
            // Other borders, other topology: other work.
            Self::Isosurface if !input.contains("cubes, open") => Vec::new(),
            Self::Isosurface if input.contains("blend") => vec!["b.mc256_blend".into()],
            Self::Isosurface => vec!["b.mc256_gyroid".into()],
            Self::MeshToSdf => vec!["o.mesh1m_to_sdf256.narrow3".into()],
            Self::SelfIntersection => vec!["j.self_intersection".into()],
            Self::Winding | Self::SignedDistance => {
                let points = if input.contains("qry_surface") { "near_1m" } else { "box_100k" };
                match self {
                    Self::Winding => vec![format!("j.signed_{points}.build+winding")],
                    // Not those that build too: here the clock starts after that.
                    _ => names(&format!("j.closest_{points}"), &[".signed_tall", ".signed"]),
                }
            }
            Self::Halfedge => {
                vec![
                    "p.openmesh.build_from_indices".into(),
                    "p.adjacency_1m.halfedge_build_from_numpy".into(),
                    "p.adjacency_1m.halfedge_build".into(),
                ]
            }
            Self::Onering => match last([':', ' ']) {
                "sum" => vec!["p.openmesh.one_ring_sum".into()],
                _ => vec!["p.adjacency_1m.one_ring_vertex_normals".into()],
            },
            Self::Tessellate | Self::Write | Self::Topology | Self::Hausdorff | Self::Heightfield => Vec::new(),
            Self::FieldEval | Self::IntervalEval | Self::ImplicitSurface => Vec::new(),
            Self::Octree | Self::Redistance | Self::Blobs => Vec::new(),
        }
    }
}

/// What a task found: the input's name, sizes and quality figures, and the times.
pub(crate) struct Outcome {
    pub(crate) input: String,
    pub(crate) times: measure::Times,
    pub(crate) figures: Map<String, Value>,
}

/// What a task needs to know.
pub(crate) struct Setting {
    pub(crate) data: PathBuf,
    pub(crate) runs: u32,
    pub(crate) tolerance: f64,
    pub(crate) size: u32,
}

/// Runs a command line, the program's name first, and returns its exit code: 0, or 2 for anything that went wrong.
pub fn run(arguments: impl IntoIterator<Item = OsString>, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            let (written, code) = match error.use_stderr() {
                true => (write!(err, "{}", error.render()), 2),
                false => (write!(out, "{}", error.render()), 0),
            };
            return if written.is_ok() { code } else { 2 };
        }
    };
    let Arguments { task, data, runs, threads, tolerance, size, against, json: _ } = arguments;
    let setting = Setting { data, runs, tolerance, size };
    let work = || match task {
        Task::Tessellate => tessellate::run(&setting).map(|outcome| vec![outcome]),
        Task::Read => files::read_files(&setting),
        Task::Write => files::write_files(&setting),
        Task::Topology => topology::run(&setting).map(|outcome| vec![outcome]),
        Task::SelfIntersection => self_intersection::run(&setting).map(|outcome| vec![outcome]),
        Task::Winding => winding::run(&setting),
        Task::SignedDistance => signed_distance::run(&setting),
        Task::Hausdorff => hausdorff::run(&setting),
        Task::Rays => rays::run(&setting),
        Task::Closest => closest::run(&setting),
        Task::Halfedge => half_edges::build(&setting).map(|outcome| vec![outcome]),
        Task::Onering => half_edges::sweep(&setting),
        Task::Heightfield => heightfield::run(&setting),
        Task::Isosurface => isosurface::run(&setting),
        Task::Delaunay2d => delaunay2d::run(&setting).map(|outcome| vec![outcome]),
        Task::SurfaceNets => surface_nets::run(&setting),
        Task::MeshToSdf => mesh_to_sdf::run(&setting),
        Task::FieldEval => field_eval::points(&setting),
        Task::IntervalEval => field_eval::boxes(&setting),
        Task::ImplicitSurface => implicit_surface::run(&setting),
        Task::Octree => octree::run(&setting),
        Task::Redistance => redistance::run(&setting),
        Task::Blobs => blobs::run(&setting),
    };
    // Always in a pool of its own, so that runs with and without a number of threads differ in nothing else.
    let threads = threads.map_or_else(rayon::current_num_threads, usize::from);
    let outcome = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        Err(error) => Err(format!("{threads} threads cannot be started: {error}")),
    };
    let outcome = outcome.and_then(|outcomes| match against {
        None => Ok((outcomes, None)),
        Some(path) => {
            let said = |error: String| format!("{}: {error}", path.display());
            let lines = std::fs::read_to_string(&path).map_err(|error| said(error.to_string()))?;
            let table = table::markdown(task, &outcomes, &lines).map_err(said)?;
            Ok((outcomes, Some(table)))
        }
    });
    match outcome {
        Ok((_, Some(table))) => {
            let _ = write!(out, "{table}");
            0
        }
        Ok((outcomes, None)) => {
            for Outcome { input, times, figures } in outcomes {
                let mut line = json!({
                    "task": task.name(),
                    "input": input,
                    "runs": runs,
                    "threads": threads,
                    "wall_s": times.wall,
                    "cpu_s": times.cpu,
                });
                if let Some(object) = line.as_object_mut() {
                    object.extend(figures);
                }
                let _ = writeln!(out, "{line}");
            }
            0
        }
        Err(message) => {
            let _ = writeln!(err, "error: {message}");
            2
        }
    }
}
