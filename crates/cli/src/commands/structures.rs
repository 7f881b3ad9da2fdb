//! `structures`: the data structures that can hold a mesh, side by side.

use std::fmt::Write;

use serde_json::{Map, Value, json};
use shapeloom_convert::Job;
use shapeloom_core::{Convert, Exec, OverBudget};
use shapeloom_mesh::TriangulatePolygons;
use shapeloom_mesh::structures::{
    Cost, Incidence, IndexedPolygons, IndexedTriangles, Query, StructureError, StructureKind,
};
use shapeloom_shape::{Geometry, Kind};

use super::convert::{absolute, wish};
use crate::arguments::StructuresArguments;
use crate::failure::Failure;
use crate::input;
use crate::session::Session;
use crate::settings::Settings;
use crate::structure_costs::StructureCosts;
use crate::subjects::{Gathering, no_surface, subjects};
use crate::workload::Workload;

pub(crate) fn run(arguments: &StructuresArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let workload = Workload::parse(&arguments.mix)?;
    let tolerance = arguments.way.tolerance()?;
    let settings = Settings::sort(&arguments.way.settings);
    settings.no_writing()?;
    let input = input::open(&arguments.input, &arguments.source, &settings, session)?;
    let wish = wish(&arguments.way, &[Kind::TriMesh])?;
    let tolerance = absolute(tolerance, &input.read.shape, &wish)?;
    let job = Job { wish, tolerance, settings: settings.converting(input.format) };
    let exec = session.exec();
    session.stage("measuring");
    let gathering = Gathering { weld: arguments.weld, together: true };
    let mut words = Vec::new();
    let subjects = subjects(&input.read.shape, &job, gathering, &exec, &mut words)?;
    let Some(subject) = subjects.first() else {
        return Err(no_surface("structures", &input.read.shape));
    };
    words.extend(subject.remarks.iter().cloned());
    let faces = faces(&subject.mesh, arguments.triangles, &exec)?;
    let mut rows = Vec::new();
    for (done, kind) in StructureKind::ALL.into_iter().enumerate() {
        exec.progress(done as f64 / StructureKind::ALL.len() as f64);
        rows.push((kind, StructureCosts::measure(kind, &faces, &exec)?));
    }
    if let Some(over) = nothing_fits(&rows) {
        return Err(Failure::from(over).about(input.name.as_ref()));
    }
    let ranking = Ranking::new(&rows, &workload);
    if session.globals.json {
        let object = told_as_json(&input.name, &faces, &rows, &workload, &ranking);
        return session.print_json(&object);
    }
    for word in words {
        session.say(word);
    }
    session.print(told(&input.name, &faces, &rows, arguments, &ranking).trim_end())
}

/// A kind with its costs, or the reason why it cannot hold the mesh.
type Row = (StructureKind, Result<StructureCosts, StructureError>);

/// The smallest need that was not met, where no structure holds the mesh and the memory is why at least one does not.
fn nothing_fits(rows: &[Row]) -> Option<OverBudget> {
    let over = |row: &Row| match &row.1 {
        Err(StructureError::OverBudget(over)) => Some(*over),
        _ => None,
    };
    if rows.iter().any(|(_, row)| row.is_ok()) {
        return None;
    }
    rows.iter().filter_map(over).min_by_key(|over| over.taken.saturating_add(over.wanted))
}

fn faces(mesh: &Geometry, triangles: bool, exec: &Exec) -> Result<IndexedPolygons, Failure> {
    let _memory = exec.reserve(mesh.memory_bytes() as u64)?;
    Ok(match mesh {
        Geometry::PolyMesh(mesh) if triangles => {
            let mesh = TriangulatePolygons::new().convert_with(mesh, exec)?.value;
            IndexedPolygons::from(&IndexedTriangles::from(&mesh))
        }
        Geometry::TriMesh(mesh) => IndexedPolygons::from(&IndexedTriangles::from(mesh)),
        Geometry::PolyMesh(mesh) => IndexedPolygons::from(mesh),
        _ => IndexedPolygons::default(),
    })
}

/// The structures by what the workload takes with them.
struct Ranking {
    /// The place in the table, the time in seconds, and the time weighed by size.
    ranked: Vec<(usize, f64, f64)>,
    /// The place in the table, and what cannot be answered.
    unranked: Vec<(usize, Vec<Query>)>,
}

impl Ranking {
    fn new(rows: &[Row], workload: &Workload) -> Self {
        let (mut ranked, mut unranked) = (Vec::new(), Vec::new());
        let held = || rows.iter().enumerate().filter_map(|(i, (_, row))| Some((i, row.as_ref().ok()?)));
        for (i, costs) in held() {
            match costs.time(workload) {
                Ok(time) => ranked.push((i, time, costs.bytes_in_all)),
                Err(missing) => unranked.push((i, missing)),
            }
        }
        let smallest = ranked.iter().map(|&(_, _, bytes)| bytes).min().unwrap_or(1).max(1) as f64;
        let weigh =
            |(i, time, bytes): (usize, f64, usize)| (i, time, time * (bytes as f64 / smallest).powf(workload.size));
        let mut ranked: Vec<_> = ranked.into_iter().map(weigh).collect();
        ranked.sort_by(|a, b| a.2.total_cmp(&b.2));
        Self { ranked, unranked }
    }
}

fn told(
    name: &str,
    faces: &IndexedPolygons,
    rows: &[Row],
    arguments: &StructuresArguments,
    ranking: &Ranking,
) -> String {
    let (vertices, count) = (faces.vertex_count(), faces.face_count());
    let mut text = String::new();
    let _ = writeln!(text, "{name}: {vertices} vertices, {count} faces, {} corners", faces.corners().len());
    text += "B/vert and B/face: bytes of connectivity a vertex and a face. In words of four bytes a vertex: as measured, as\n\
             laid out for a large closed triangle mesh, and as textbooks count, with three words of coordinates. Queries:\n\
             mean time of one; with a star it looks at all elements. Update: of a flip, split or collapse of an edge; with an\n\
             r the structure is made anew.\n";
    let _ = write!(
        text,
        "\n{:<24}{:>8}{:>8}{:>8}{:>8}{:>6}{:>9}",
        "", "B/vert", "B/face", "words", "layout", "book", "build"
    );
    for query in Query::ALL {
        let _ = write!(text, "{:>9}", query.name());
    }
    let _ = writeln!(text, "{:>9}", "update");
    for (kind, row) in rows {
        let Ok(costs) = row else { continue };
        let per = |count: usize| costs.bytes as f64 / count.max(1) as f64;
        let _ = write!(text, "{:<24}{:>8.1}{:>8.1}", kind.name(), per(vertices), per(count));
        let book = kind.textbook_words_per_vertex().map_or_else(String::new, |words| words.to_string());
        let _ = write!(text, "{:>8.2}{:>8.1}{book:>6}", per(vertices) / 4.0, kind.words_per_vertex());
        let _ = write!(text, "{:>9}", seconds(costs.build));
        for (cost, time) in costs.queries {
            let cell = match (cost, time) {
                (Cost::Unanswered, _) => "-".to_owned(),
                (_, None) => "none".to_owned(),
                (Cost::Local, Some(time)) => seconds(time),
                (Cost::Scan, Some(time)) => format!("{}*", seconds(time)),
            };
            let _ = write!(text, "{cell:>9}");
        }
        let mark = match costs.in_place {
            Cost::Local => "",
            Cost::Scan => "*",
            Cost::Unanswered => "r",
        };
        let _ = writeln!(text, "{:>9}", seconds(costs.update) + mark);
    }
    for (kind, row) in rows {
        if let Err(error) = row {
            let _ = writeln!(text, "{}: cannot hold it: {error}", kind.name());
        }
        if let Ok(StructureCosts { no_room_for_updates: Some(over), .. }) = row {
            let _ = writeln!(text, "{}: cannot be changed in place, but made anew: {over}", kind.name());
        }
    }
    let _ = writeln!(text, "\nfor {} (made from indexed polygons first):", arguments.mix);
    for (rank, &(i, time, weighed)) in ranking.ranked.iter().enumerate() {
        let _ = write!(text, "{:>3}. {:<24}{:>9}", rank + 1, rows[i].0.name(), seconds(time));
        if weighed != time {
            let _ = write!(text, ", by size as if {}", seconds(weighed));
        }
        let _ = writeln!(text);
    }
    for (i, missing) in &ranking.unranked {
        let names: Vec<&str> = missing.iter().map(|query| query.name()).collect();
        let _ = writeln!(text, "   - {:<24}cannot answer {}", rows[*i].0.name(), names.join(", "));
    }
    text
}

fn told_as_json(name: &str, faces: &IndexedPolygons, rows: &[Row], workload: &Workload, ranking: &Ranking) -> Value {
    let structure = |(kind, row): &Row| {
        let mut object = Map::new();
        object.insert("name".into(), json!(kind.name()));
        object.insert("theory_words_per_vertex".into(), json!(kind.words_per_vertex()));
        object.insert("textbook_words_per_vertex".into(), json!(kind.textbook_words_per_vertex()));
        match row {
            Ok(costs) => {
                let per = |count: usize| costs.bytes as f64 / count.max(1) as f64;
                object.insert("holds".into(), json!(true));
                object.insert("memory_bytes".into(), json!(costs.bytes));
                object.insert("bytes_per_vertex".into(), json!(per(faces.vertex_count())));
                object.insert("bytes_per_face".into(), json!(per(faces.face_count())));
                object.insert("words_per_vertex".into(), json!(per(faces.vertex_count()) / 4.0));
                object.insert("build_s".into(), json!(costs.build));
                object.insert("update_s".into(), json!(costs.update));
                object.insert("updates_in_place".into(), json!(costs.in_place != Cost::Unanswered));
                if let Some(over) = costs.no_room_for_updates {
                    object.insert("why_not_in_place".into(), json!(over.to_string()));
                }
                let queries = Query::ALL.into_iter().zip(costs.queries).map(|(query, (cost, time))| {
                    let cost = match cost {
                        Cost::Local => "local",
                        Cost::Scan => "scan",
                        Cost::Unanswered => "unanswered",
                    };
                    (query.name().to_owned(), json!({ "cost": cost, "seconds": time }))
                });
                object.insert("queries".into(), Value::Object(queries.collect()));
            }
            Err(error) => {
                object.insert("holds".into(), json!(false));
                object.insert("why".into(), json!(error.to_string()));
            }
        }
        Value::Object(object)
    };
    let mut mix: Map<String, Value> =
        workload.asked().map(|(query, count)| (query.name().to_owned(), json!(count))).collect();
    mix.insert("updates".into(), json!(workload.updates));
    mix.insert("size".into(), json!(workload.size));
    let ranked = ranking
        .ranked
        .iter()
        .map(|&(i, time, weighed)| json!({ "name": rows[i].0.name(), "seconds": time, "weighed_by_size": weighed }));
    let unranked = ranking.unranked.iter().map(|(i, missing)| {
        let missing: Vec<&str> = missing.iter().map(|query| query.name()).collect();
        json!({ "name": rows[*i].0.name(), "cannot_answer": missing })
    });
    json!({
        "schema": "shapeloom.structures/1",
        "file": name,
        "vertices": faces.vertex_count(),
        "faces": faces.face_count(),
        "corners": faces.corners().len(),
        "structures": rows.iter().map(structure).collect::<Vec<_>>(),
        "mix": mix,
        "ranking": ranked.collect::<Vec<_>>(),
        "unranked": unranked.collect::<Vec<_>>(),
    })
}

/// A time in a unit that suits it.
fn seconds(time: f64) -> String {
    let (value, unit) = match time {
        time if time < 1e-6 => (time * 1e9, "ns"),
        time if time < 1e-3 => (time * 1e6, "us"),
        time if time < 1.0 => (time * 1e3, "ms"),
        time => (time, "s"),
    };
    if value >= 1e9 {
        return format!("{value:.1e} {unit}");
    }
    if value < 99.95 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short_whatever_their_size() {
        let told = [0.0, 1.5e-9, 2e-3, 30.0, 200.0, 1e300, 1.5e308].map(seconds);
        assert_eq!(told, ["0.0 ns", "1.5 ns", "2.0 ms", "30.0 s", "200 s", "1.0e300 s", "1.5e308 s"]);
    }
}
