//! Documents that are made from tables say what the tables say.

use std::fmt::Write;

use shapeloom::convert::{Effect, registry};
use shapeloom::io::FORMATS;
use shapeloom::shape::Kind;

use crate::support::{root, text};

/// Compares a document with what it is made from, or writes it anew.
pub fn check(path: &str, wanted: &str) {
    if std::env::var_os("SHAPELOOM_BLESS").is_some() {
        std::fs::write(root().join(path), wanted).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
    assert!(text(path) == wanted, "{path} is not what its table says: run the tests with SHAPELOOM_BLESS=1");
}

#[test]
fn formats_are_documented_from_their_table() {
    let mut page = String::from(
        "# File formats\n\nMade from the table in `crates/io` by the tests; `shapeloom formats --json` prints the same.\n\n\
         | id | name | extensions | reads | writes | positions | up | kinds | keeps | options |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for format in FORMATS {
        let kinds: Vec<&str> = format.kinds.iter().map(|kind| kind.name()).collect();
        let keeps: Vec<&str> = format.keeps.iter().map(|keeps| keeps.name()).collect();
        let options: Vec<&str> = format.read_options.iter().chain(format.write_options).copied().collect();
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            format.id,
            format.name,
            format.extensions.join(" "),
            if format.reads.is_some() { "yes" } else { "not yet" },
            if format.writes.is_some() { "yes" } else { "not yet" },
            format.precision.name(),
            format.up.map_or("-", |up| up.name()),
            kinds.join(" "),
            keeps.join(", "),
            if options.is_empty() { "-".to_owned() } else { options.join(", ") },
        );
    }
    page += "\n";
    page += &text("docs/formats-notes.md");
    check("docs/formats.md", &page);
}

#[test]
fn the_conversion_matrix_is_the_registry() {
    let mut page = String::from(
        "# The conversion matrix\n\nMade from the registry by the tests; `shapeloom graph` prints the same. Rows convert \
         into columns. In italics what is done only where it is named with `--method`.\n\n| from \\ to |",
    );
    for kind in Kind::ALL {
        let _ = write!(page, " {kind} |");
    }
    page += "\n|---|";
    page += &"---|".repeat(Kind::ALL.len());
    for from in Kind::ALL {
        let _ = write!(page, "\n| {from} |");
        for to in Kind::ALL {
            let names: Vec<String> = registry()
                .iter()
                .filter(|converter| converter.from == from && converter.to == to)
                .map(|converter| {
                    let link = format!("[{}](algorithms/{}.md)", converter.name, converter.name.replace('-', "_"));
                    if converter.only_by_name { format!("*{link}*") } else { link }
                })
                .collect();
            let _ = write!(page, " {} |", names.join(", "));
        }
    }
    page += "\n\n| converter | what it does | error |\n|---|---|---|\n";
    // One name may serve several kinds.
    let first = |at: usize| !registry()[..at].iter().any(|other| other.name == registry()[at].name);
    for converter in (0..registry().len()).filter(|&at| first(at)).map(|at| &registry()[at]) {
        let effect = match converter.effect {
            Effect::Exact => "exact",
            Effect::WithinTolerance => "proven within the tolerance",
            Effect::Reported => "said by its report",
        };
        let _ = writeln!(page, "| {} | {} | {effect} |", converter.name, converter.summary());
    }
    check("docs/conversion-matrix.md", &page);
}

#[test]
fn the_readmes_commands_are_those_that_are_run() {
    let readme = text("README.md");
    let main = "cargo run --release -- convert data/teapot.bpt out/teapot.glb --tolerance 0.1% --picture out/teapot.png --force";
    let ci = text(".ci/run");
    for command in [main, "cargo test --workspace"] {
        assert!(readme.contains(command), "README.md lacks: {command}");
        assert!(ci.contains(command), ".ci/run does not run: {command}");
    }
    assert!(readme.contains("docs/pictures/teapot.png") && root().join("docs/pictures/teapot.png").exists());
}

#[test]
fn links_between_documents_lead_somewhere() {
    let mut pages = vec![root().join("README.md"), root().join("CHANGELOG.md"), root().join("data/README.md")];
    pages.extend(crate::support::files_below("docs", ".md"));
    for page in pages {
        let words = std::fs::read_to_string(&page).expect("a page");
        for target in words.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = target.split('#').next().unwrap_or_default();
            if target.is_empty() || target.contains("://") {
                continue;
            }
            let place = page.parent().expect("a folder").join(target);
            assert!(place.exists(), "{}: {target} is not there", page.display());
        }
    }
}
