//! `explain`: what a code means.

use serde_json::json;

use crate::arguments::ExplainArguments;
use crate::explanations::{all, explanation};
use crate::failure::Failure;
use crate::session::Session;

pub(crate) fn run(arguments: &ExplainArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let entries: Vec<(&str, &str)> = match &arguments.code {
        Some(code) => match explanation(code) {
            Some(text) => vec![(code.as_str(), text)],
            None => {
                let message = format!("found code \"{code}\", expected one that `shapeloom explain` lists");
                return Err(Failure::usage("E-usage-code", message));
            }
        },
        None => all().collect(),
    };
    if session.globals.json {
        let codes: Vec<_> = entries.iter().map(|(code, text)| json!({ "code": code, "text": text })).collect();
        return session.print_json(&json!({ "schema": "shapeloom.explain/1", "codes": codes }));
    }
    entries.into_iter().try_for_each(|(code, text)| session.print(format_args!("{code}: {text}")))
}
