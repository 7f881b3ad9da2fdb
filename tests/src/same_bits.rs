//! Same bits for any number of threads, through the whole program.

use crate::support::{data, run};

#[test]
fn files_and_pictures_are_the_same_on_one_two_and_three_threads() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut before: Option<Vec<Vec<u8>>> = None;
    for threads in ["1", "2", "3"] {
        let name = |file: &str| folder.path().join(format!("{threads}-{file}")).display().to_string();
        let (glb, picture, report) = (name("t.glb"), name("t.png"), name("t.json"));
        let teapot = data("teapot.bpt");
        let small = run(&["convert", &teapot, &glb, "--tolerance", "0.5%", "--threads", threads, "--report", &report]);
        assert_eq!(small.code, 0, "{}", small.err);
        let drawn = run(&["render", &glb, &picture, "--size", "160x120", "--threads", threads]);
        assert_eq!(drawn.code, 0, "{}", drawn.err);
        let mut files: Vec<Vec<u8>> =
            [&glb, &picture].map(|file| std::fs::read(file).expect("it was written")).to_vec();
        // The report names its output, and nothing else of it may differ.
        let words = std::fs::read_to_string(&report).expect("it was written");
        files.push(words.replace(&glb, "t.glb").into_bytes());
        if let Some(before) = &before {
            assert!(*before == files, "{threads} threads give other bytes");
        }
        before = Some(files);
    }
}
