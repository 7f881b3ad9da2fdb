//! Every code of an error or warning has an explanation.

use std::collections::BTreeSet;

use crate::support::{files_below, run};

/// Codes written as literals in the sources: `"E-..."` and `"W-..."`.
fn codes() -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for path in files_below("crates", ".rs") {
        let name = path.to_string_lossy().into_owned();
        if name.ends_with("explanations.rs") {
            continue;
        }
        let source = std::fs::read_to_string(&path).expect("a source file");
        for start in ["\"E-", "\"W-"] {
            for rest in source.split(start).skip(1) {
                let word = rest.split('"').next().unwrap_or_default();
                let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
                if word.len() > 2 && word.chars().all(plain) {
                    codes.insert(format!("{}{word}", &start[1..]));
                }
            }
        }
    }
    codes.remove("W-test");
    codes
}

#[test]
fn every_code_is_explained_and_every_explanation_is_used() {
    let codes = codes();
    assert!(codes.len() > 60, "{}", codes.len());
    for code in &codes {
        assert!(shapeloom_cli::explanation(code).is_some(), "{code} has no explanation");
    }
    let listed = run(&["explain", "--json"]).json();
    for entry in listed["codes"].as_array().expect("a list") {
        let code = entry["code"].as_str().expect("a code");
        assert!(codes.contains(code), "{code} is explained but never given");
    }
}

#[test]
fn explain_tells_one_code_or_says_it_is_unknown() {
    let told = run(&["explain", "E-memory-budget"]);
    assert!(told.code == 0 && String::from_utf8_lossy(&told.out).contains("--max-memory"));
    let unknown = run(&["explain", "E-none"]);
    assert!(unknown.code == 2 && unknown.err.contains("E-usage-code"));
}
