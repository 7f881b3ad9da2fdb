//! docs/verification.toml: for each requirement that works, the test that shows it and against which truth.

use std::fmt::Write;

use crate::documents::check;
use crate::support::{root, text};

const TRUTHS: [&str; 4] = ["closed form", "brute force", "published value", "other implementation"];

#[test]
fn what_the_lines_name_is_there_and_the_page_says_the_same() {
    let table: toml::Table = text("docs/verification.toml").parse().expect("docs/verification.toml is TOML");
    let mut page = String::from(
        "# Verification\n\nMade from docs/verification.toml by the tests, which fail if a test, command or example named \
         here is missing.\n\n| row | what | truth | test | try it |\n|---|---|---|---|---|\n",
    );
    let lines = table["row"].as_array().expect("rows");
    assert!(!lines.is_empty());
    for line in lines {
        let word = |key: &str| {
            line.get(key).and_then(|value| value.as_str()).unwrap_or_else(|| panic!("{key} is missing in {line}"))
        };
        let (id, what, test, truth) = (word("id"), word("what"), word("test"), word("truth"));
        assert!(TRUTHS.contains(&truth), "{id}: found truth \"{truth}\", expected one of {TRUTHS:?}");
        let (file, function) = test.split_once("::").unwrap_or_else(|| panic!("{id}: {test} is no file::function"));
        let source = text(file);
        let declared =
            source.find(&format!("fn {function}(")).unwrap_or_else(|| panic!("{id}: no {function} in {file}"));
        assert!(source[..declared].trim_end().ends_with("#[test]"), "{id}: {function} in {file} is no test");
        let try_it = match (line.get("example"), line.get("command")) {
            (Some(example), None) => {
                let example = example.as_str().expect("a name");
                assert!(root().join(format!("examples/{example}.rs")).exists(), "{id}: no example {example}");
                format!("`cargo run --release --example {example}`")
            }
            (None, Some(command)) => {
                let command = command.as_str().expect("words");
                let name = command.split_whitespace().next().unwrap_or_default();
                let known = ["convert", "info", "compare", "render", "make", "formats", "graph", "explain"];
                assert!(known.contains(&name), "{id}: no command {name}");
                format!("`shapeloom {command}`")
            }
            _ => panic!("{id}: expected either an example or a command"),
        };
        let _ = writeln!(page, "| {id} | {what} | {truth} | `{file}` {function} | {try_it} |");
    }
    check("docs/verification.md", &page);
}
