//! The benchmark program on tiny work, so that no task rots.

use shapeloom_bench::Task;

use crate::support::root;

#[test]
fn every_task_prints_one_line_of_json() {
    for task in Task::ALL {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let data = root().join("data").display().to_string();
        let words =
            ["shapeloom-bench", task.name(), "--runs", "1", "--threads", "2", "--tolerance", "0.05", "--data", &data];
        let code = shapeloom_bench::run(words.map(Into::into), &mut out, &mut err);
        assert_eq!(code, 0, "{}", String::from_utf8_lossy(&err));
        let line = String::from_utf8(out).expect("UTF-8");
        assert_eq!(line.lines().count(), 1);
        let found: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        assert_eq!(found["task"], task.name());
        for key in ["input", "wall_s", "cpu_s", "threads"] {
            assert!(!found[key].is_null(), "{key} is missing: {line}");
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
}
