//! The benchmark program on tiny work, so that no task rots.

use shapeloom_bench::Task;

use crate::support::{data, run};

#[test]
fn every_task_prints_lines_of_json() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::copy(data("teapot.bpt"), folder.path().join("teapot.bpt")).expect("the teapot");
    for extension in ["ply", "stl", "obj", "off", "glb"] {
        let file = folder.path().join(format!("blob_1m.{extension}")).display().to_string();
        assert_eq!(run(&["make", "sphere", &file]).code, 0, "{extension}");
    }
    let inputs = folder.path().display().to_string();
    for &task in Task::all() {
        let name = task.name();
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let words = [
            "shapeloom-bench",
            &name,
            "--runs",
            "1",
            "--threads",
            "2",
            "--tolerance",
            "0.05",
            "--size",
            "33",
            "--data",
            &inputs,
        ];
        let code = shapeloom_bench::run(words.map(Into::into), &mut out, &mut err);
        assert_eq!(code, 0, "{}", String::from_utf8_lossy(&err));
        let lines = String::from_utf8(out).expect("UTF-8");
        let expected = match task {
            Task::Tessellate | Task::Topology | Task::SelfIntersection | Task::Halfedge | Task::Delaunay2d => 1,
            Task::FieldEval | Task::IntervalEval | Task::ImplicitSurface => 2,
            Task::Winding | Task::SignedDistance | Task::Hausdorff => 2,
            Task::Isosurface => 6,
            Task::Closest | Task::Onering | Task::Heightfield | Task::MeshToSdf | Task::Redistance => 2,
            Task::Read | Task::Write | Task::Rays => 5,
            Task::Octree => 7,
            Task::Blobs | Task::SurfaceNets => 4,
        };
        assert_eq!(lines.lines().count(), expected, "{lines}");
        for line in lines.lines() {
            let found: serde_json::Value = serde_json::from_str(line).expect("JSON");
            assert_eq!(found["task"], name);
            let of_triangles = !matches!(task, Task::FieldEval | Task::IntervalEval);
            let size = if of_triangles { "triangles" } else { "steps" };
            for key in ["input", "wall_s", "cpu_s", "threads", size] {
                assert!(!found[key].is_null(), "{key} is missing: {line}");
            }
        }
    }
}

#[test]
fn wrong_words_and_missing_inputs_are_told() {
    let run = |words: &[&str]| {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let code = shapeloom_bench::run(words.iter().map(Into::into), &mut out, &mut err);
        (code, String::from_utf8_lossy(&err).into_owned())
    };
    assert_eq!(run(&["shapeloom-bench", "dance"]).0, 2);
    let (code, err) = run(&["shapeloom-bench", "tessellate", "--data", "nowhere"]);
    assert!(code == 2 && err.contains("nowhere"), "{err}");
    for task in ["read", "rays", "closest"] {
        let (code, err) = run(&["shapeloom-bench", task, "--data", "nowhere"]);
        assert!(code == 2 && err.contains("blob_1m"), "{err}");
    }
}
