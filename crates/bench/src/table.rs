//! Figures beside those of peers, as a table for docs/PERFORMANCE.md.

use serde_json::Value;

use crate::{Outcome, Task};

/// A peer's figures for one piece of work.
struct Peer {
    name: String,
    cpu: f64,
    wall: f64,
}

/// A Markdown table: for each outcome the peers that did the same work, the fastest first. `lines` are JSON objects with
/// `task`, `peer`, `version`, `wall_s` and `cpu_s`.
pub(crate) fn markdown(task: Task, outcomes: &[Outcome], lines: &str) -> Result<String, String> {
    let mut table = String::from(
        "| work | shapeloom, CPU s (wall) | peer | CPU s (wall) | peer's CPU over ours |\n|---|---:|---|---:|---:|\n",
    );
    for outcome in outcomes {
        let ours = format!("{:.4} ({:.4})", outcome.times.cpu, outcome.times.wall);
        let name = outcome.input.rsplit('/').next().unwrap_or_default();
        let mut peers = peers(&task.peer_tasks(&outcome.input), lines)?;
        peers.sort_by(|a, b| a.cpu.total_cmp(&b.cpu));
        // A peer that ran several times counts with its fastest run.
        let mut seen = std::collections::HashSet::new();
        peers.retain(|peer| seen.insert(peer.name.clone()));
        if peers.is_empty() {
            table += &format!("| {} {name} | {ours} | | | |\n", task.name());
        }
        for (rank, peer) in peers.iter().take(4).enumerate() {
            let work = if rank == 0 { format!("{} {name}", task.name()) } else { String::new() };
            let ours = if rank == 0 { ours.as_str() } else { "" };
            let ratio = peer.cpu / outcome.times.cpu;
            table +=
                &format!("| {work} | {ours} | {} | {:.4} ({:.4}) | {ratio:.2} |\n", peer.name, peer.cpu, peer.wall);
        }
    }
    Ok(table)
}

fn peers(tasks: &[String], lines: &str) -> Result<Vec<Peer>, String> {
    let mut found = Vec::new();
    for (number, line) in lines.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let line: Value = serde_json::from_str(line).map_err(|error| format!("line {}: {error}", number + 1))?;
        let text = |key: &str| line[key].as_str().unwrap_or_default().to_owned();
        if !tasks.contains(&text("task")) {
            continue;
        }
        if let (Some(cpu), Some(wall)) = (line["cpu_s"].as_f64(), line["wall_s"].as_f64()) {
            let threads = match text("task").rsplit(['.', '_']).next() {
                Some("t1") => ", one thread",
                Some("tall") => ", all threads",
                _ => "",
            };
            found.push(Peer { name: format!("{} {}{threads}", text("peer"), text("version")), cpu, wall });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Times;

    #[test]
    fn the_fastest_peer_of_the_same_work_comes_first() {
        let outcome = Outcome {
            input: "a/blob_1m.obj".into(),
            times: Times { wall: 0.1, cpu: 0.2 },
            figures: Default::default(),
        };
        let lines = "{\"task\":\"m.read_1m_obj\",\"peer\":\"slow\",\"version\":\"1\",\"wall_s\":2,\"cpu_s\":2}\n\
            {\"task\":\"m.read_1m_off\",\"peer\":\"other\",\"version\":\"1\",\"wall_s\":0.1,\"cpu_s\":0.1}\n\
            {\"task\":\"m.read_1m_obj\",\"peer\":\"fast\",\"version\":\"2\",\"wall_s\":0.5,\"cpu_s\":0.5}\n";
        let table = markdown(Task::Read, &[outcome], lines).unwrap();
        let rows: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(rows[0], "| read blob_1m.obj | 0.2000 (0.1000) | fast 2 | 0.5000 (0.5000) | 2.50 |");
        assert!(rows[1].contains("slow 1") && rows.len() == 2);
        assert!(markdown(Task::Read, &[], "nonsense").is_ok());
    }

    #[test]
    fn winding_numbers_and_signed_distances_are_set_beside_their_own() {
        let outcome = |file: &str| Outcome {
            input: file.into(),
            times: Times { wall: 1.0, cpu: 1.0 },
            figures: Default::default(),
        };
        let names = [
            "j.signed_near_1m.build+winding",
            "j.signed_near_1m.build+signed",
            "j.closest_near_1m.signed_tall",
            "j.closest_near_1m.tall",
            "j.signed_box_100k.build+winding",
            "j.closest_box_100k.signed",
        ];
        let line = |name: &&str| {
            format!("{{\"task\":\"{name}\",\"peer\":\"{name}\",\"version\":\"1\",\"wall_s\":2,\"cpu_s\":2}}\n")
        };
        let lines: String = names.iter().map(line).collect();
        let files = ["a/qry_surface.f32", "a/qry_box.f32"].map(outcome);
        for (task, wanted) in [(Task::Winding, [names[0], names[4]]), (Task::SignedDistance, [names[2], names[5]])] {
            let table = markdown(task, &files, &lines).unwrap();
            let rows: Vec<&str> = table.lines().skip(2).collect();
            assert!(rows.len() == 2 && rows.iter().zip(wanted).all(|(row, name)| row.contains(name)), "{table}");
        }
    }
}
