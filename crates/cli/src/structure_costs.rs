//! What a mesh structure costs: its size, and how long things take.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use shapeloom_core::{Exec, OverBudget, Stop};
use shapeloom_mesh::structures::{
    Cost, Incidence, IndexedPolygons, Query, StructureError, StructureKind, Update, VertexId,
};

use crate::workload::Workload;

/// How long one query is measured at most, unless a single one takes longer.
const ENOUGH: Duration = Duration::from_millis(8);
/// How many different elements a query is asked about at most.
const ELEMENTS: usize = 1 << 14;

/// What was measured of a structure.
#[derive(Debug)]
pub(crate) struct StructureCosts {
    /// The size of the connectivity.
    pub(crate) bytes: usize,
    /// The size with coordinates: three numbers of eight bytes a vertex, of a soup a corner.
    pub(crate) bytes_in_all: usize,
    /// The time to make it from indexed polygons, in seconds.
    pub(crate) build: f64,
    /// What each query costs in principle, and the mean time of one in seconds, in the order of [`Query::ALL`]; none where
    /// the structure cannot answer or the mesh has no such elements.
    pub(crate) queries: [(Cost, Option<f64>); 9],
    /// The time to change the mesh at one place, in seconds: in place, or by making the structure anew.
    pub(crate) update: f64,
    /// Whether it can be changed in place, and what that costs in principle.
    pub(crate) in_place: Cost,
    /// What did not fit where it could be changed in place but for the memory: each change makes it anew then.
    pub(crate) no_room_for_updates: Option<OverBudget>,
}

impl StructureCosts {
    /// Builds a structure and measures it; the inner error says why it cannot hold the mesh.
    pub(crate) fn measure(
        kind: StructureKind,
        faces: &IndexedPolygons,
        exec: &Exec,
    ) -> Result<Result<Self, StructureError>, Stop> {
        exec.check()?;
        let start = Instant::now();
        let built = match kind.build(faces, exec) {
            Ok(built) => built,
            Err(StructureError::Stop(stop)) => return Err(stop),
            Err(error) => return Ok(Err(error)),
        };
        let build = start.elapsed().as_secs_f64();
        let mut queries = [(Cost::Unanswered, None); 9];
        let edges: Vec<u32> =
            built.edges().map(|edges| edges.into_iter().map(|edge| edge.0).collect()).unwrap_or_default();
        for (slot, query) in queries.iter_mut().zip(Query::ALL) {
            exec.check()?;
            let elements = match query.name().as_bytes()[0] {
                b'V' => some_of(built.vertex_count(), |i| i as u32),
                b'E' => some_of(edges.len(), |i| edges[i]),
                _ => some_of(built.face_count(), |i| i as u32),
            };
            *slot = (built.cost(query), time_of(&*built, query, &elements, exec)?);
        }
        let bytes = built.memory_bytes();
        drop(built);
        let mut in_place = kind.update_cost(Update::FlipEdge);
        let (mut changed, mut no_room_for_updates) = (None, None);
        if in_place != Cost::Unanswered {
            match time_of_updates(kind, faces, exec)? {
                Ok(time) => changed = time,
                Err(over) => (in_place, no_room_for_updates) = (Cost::Unanswered, Some(over)),
            }
        }
        let positions = if kind == StructureKind::TriangleSoup { faces.corners().len() } else { faces.vertex_count() };
        let bytes_in_all = bytes + 24 * positions;
        let update = changed.unwrap_or(build);
        Ok(Ok(Self { bytes, bytes_in_all, build, queries, update, in_place, no_room_for_updates }))
    }

    /// The time that a workload takes with the structure, its making included; the queries that it cannot answer instead.
    pub(crate) fn time(&self, workload: &Workload) -> Result<f64, Vec<Query>> {
        let mut missing = Vec::new();
        let mut total = self.build + workload.updates * self.update;
        for (query, count) in workload.asked() {
            let position = Query::ALL.iter().position(|other| *other == query).unwrap_or_default();
            match self.queries[position] {
                (Cost::Unanswered, _) => missing.push(query),
                (_, time) => total += count * time.unwrap_or(0.0),
            }
        }
        if missing.is_empty() { Ok(total) } else { Err(missing) }
    }
}

/// The mean time of a flip, split or collapse of an edge, one after the other all over the mesh; none where no edge lets itself be
/// changed. The inner error says that the structure to be changed does not fit.
fn time_of_updates(
    kind: StructureKind,
    faces: &IndexedPolygons,
    exec: &Exec,
) -> Result<Result<Option<f64>, OverBudget>, Stop> {
    let mut structure = match kind.build_for_updates(faces, exec) {
        Ok(Some(structure)) => structure,
        Err(StructureError::Stop(stop)) => return Err(stop),
        Err(StructureError::OverBudget(over)) => return Ok(Err(over)),
        _ => return Ok(Ok(None)),
    };
    let sides = some_of(faces.face_count(), |face| face as u32).into_iter().filter_map(|face| {
        let corners = structure.answer(Query::FV, face).ok()?;
        Some([VertexId(corners[0]), VertexId(corners[1])])
    });
    let sides: Vec<[VertexId; 2]> = sides.collect();
    let start = Instant::now();
    // Those that are refused cost time too, but are no change.
    let (mut done, mut spent) = (0u32, Duration::ZERO);
    for (i, side) in sides.into_iter().enumerate() {
        exec.check()?;
        let begun = Instant::now();
        let changed = match i % 3 {
            0 => structure.flip(side).is_ok(),
            1 => structure.split(side).is_ok(),
            _ => structure.collapse(side).is_ok(),
        };
        if changed {
            done += 1;
            spent += begun.elapsed();
        }
        if start.elapsed() >= ENOUGH {
            break;
        }
    }
    Ok(Ok((done > 0).then(|| spent.as_secs_f64() / f64::from(done))))
}

/// Elements spread evenly over all of them.
fn some_of(count: usize, element: impl Fn(usize) -> u32) -> Vec<u32> {
    let taken = count.min(ELEMENTS);
    (0..taken).map(|i| element((i as u128 * count as u128 / taken as u128) as usize)).collect()
}

/// The mean time of a query in seconds.
fn time_of(structure: &dyn Incidence, query: Query, elements: &[u32], exec: &Exec) -> Result<Option<f64>, Stop> {
    if elements.is_empty() || structure.cost(query) == Cost::Unanswered {
        return Ok(None);
    }
    let start = Instant::now();
    let (mut asked, mut step) = (0usize, 1usize);
    let mut sum = 0u64;
    loop {
        for i in asked..asked + step {
            let answered = structure.visit(query, elements[i % elements.len()], &mut |found| {
                sum += u64::from(found);
                ControlFlow::Continue(())
            });
            if answered.is_err() {
                return Ok(None);
            }
        }
        asked += step;
        exec.check()?;
        let spent = start.elapsed();
        if spent >= ENOUGH {
            black_box(sum);
            return Ok(Some(spent.as_secs_f64() / asked as f64));
        }
        step *= 2;
    }
}
