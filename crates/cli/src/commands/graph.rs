//! `graph`: the converters and the kinds that they join.

use std::fmt::Write;

use serde_json::json;
use shapeloom_convert::registry;
use shapeloom_core::OptionKind;
use shapeloom_shape::Kind;

use crate::account;
use crate::arguments::GraphArguments;
use crate::failure::Failure;
use crate::session::Session;

pub(crate) fn run(arguments: &GraphArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    if session.globals.json {
        let kinds: Vec<&str> = Kind::ALL.into_iter().map(Kind::name).collect();
        let converters: Vec<_> = registry()
            .iter()
            .map(|converter| {
                json!({
                    "name": converter.name,
                    "from": converter.from.name(),
                    "to": converter.to.name(),
                    "only_by_name": converter.only_by_name,
                    "summary": converter.summary(),
                    "options": converter.specs().iter().map(account::option_spec).collect::<Vec<_>>(),
                })
            })
            .collect();
        let object = json!({ "schema": "shapeloom.graph/1", "kinds": kinds, "converters": converters });
        return session.print_json(&object);
    }
    let mut text = String::new();
    if arguments.dot {
        text += "digraph shapeloom {\n  rankdir=LR;\n  node [shape=box];\n";
        for kind in Kind::ALL {
            let _ = writeln!(text, "  \"{kind}\";");
        }
        for converter in registry() {
            let _ = writeln!(text, "  \"{}\" -> \"{}\" [label=\"{}\"];", converter.from, converter.to, converter.name);
        }
        text += "}";
        return session.print(text);
    }
    for converter in registry() {
        let when =
            if converter.only_by_name { format!(", only by --method {}", converter.name) } else { String::new() };
        let _ = writeln!(text, "{}: {} -> {}{when}", converter.name, converter.from, converter.to);
        let _ = writeln!(text, "  {}", converter.summary());
        for spec in converter.specs() {
            let default = spec.default.as_ref().map_or("from the tolerance".to_owned(), ToString::to_string);
            let takes = match spec.kind {
                OptionKind::Float | OptionKind::Integer => format!("{} {}", spec.kind, spec.bounds),
                _ => spec.kind.to_string(),
            };
            let _ = writeln!(text, "  --set {}={default}  {} ({takes})", spec.name, spec.doc);
        }
    }
    session.print(text.trim_end())
}
