//! `compare`: how far shapes are apart.

mod comparison;
mod report;
mod subject;

pub(crate) use subject::Subject;

use std::path::Path;

use serde_json::{Map, Value, json};
use shapeloom_core::{Tolerance, ToleranceError, Words};
use shapeloom_io::format_by_id;
use shapeloom_judge::Distances;

use crate::account;
use crate::arguments::CompareArguments;
use crate::failure::Failure;
use crate::input::is_stream;
use crate::output::{check_free, commit};
use crate::session::Session;
use crate::settings::Settings;
use comparison::{Comparison, Verdict};

pub(crate) fn run(arguments: &CompareArguments, session: &mut Session<'_>) -> Result<(), Failure> {
    let paths: Vec<&Path> = arguments.truth.iter().chain(&arguments.shapes).map(|path| path.as_path()).collect();
    if paths.len() < 2 {
        let message = "found one shape, expected two or more, or one and --truth";
        return Err(Failure::usage("E-usage-shapes", message));
    }
    if paths.iter().filter(|path| is_stream(path)).count() > 1 {
        let message = "found standard input more than once: expected it for one shape at most";
        return Err(Failure::usage("E-usage-shapes", message));
    }
    arguments.way.tolerance()?;
    let limit = arguments.fail_above.as_deref().map(limit).transpose()?;
    if let Some(folder) = &arguments.report {
        report::files(folder, &paths).iter().try_for_each(|path| check_free(path, arguments.force))?;
    }
    session.several_inputs = true;
    let first = Subject::open(paths[0], &arguments.way, &arguments.source, None, session)?;
    let limit = limit.map(|limit| absolute_limit(limit, &first)).transpose()?;
    let mut subjects = vec![first];
    for path in &paths[1..] {
        let up = subjects[0].shape.up;
        subjects.push(Subject::open(path, &arguments.way, &arguments.source, up, session)?);
    }
    let formats = subjects.iter().map(|subject| format_by_id(subject.format)).collect::<Result<Vec<_>, _>>()?;
    Settings::for_several(&arguments.way.settings).check_heeded(&formats)?;
    let options = Distances {
        relative_gap: arguments.accuracy,
        max_splits: arguments.max_splits,
        samples: arguments.samples,
        ..Distances::new()
    };
    session.stage("comparing");
    let mut comparisons = Vec::new();
    for other in 1..subjects.len() {
        comparisons.push(Comparison::measure(&subjects, other, &options, limit, &session.exec())?);
    }
    for subject in &subjects {
        session.say_findings_about(&subject.name, &subject.judged);
    }
    if let Some(folder) = &arguments.report {
        session.stage("drawing");
        let staged = report::stage_all(folder, arguments.force, &subjects, &comparisons, session)?;
        commit(staged, session)?;
        session.say(format_args!("wrote {}", folder.join(report::INDEX).display()));
    }
    if session.globals.json {
        session.print_json(&told(&subjects, &comparisons, arguments, limit))?;
    } else {
        for comparison in &comparisons {
            session.print(comparison.words(&subjects))?;
        }
    }
    // All comparisons are told; what was found is the exit code's to say.
    if comparisons.iter().any(|comparison| comparison.verdict.is_some_and(|verdict| verdict != Verdict::Within)) {
        return Err(Failure::Found);
    }
    Ok(())
}

/// A limit; none for 0, which identical shapes keep, however large they are.
fn limit(text: &str) -> Result<Option<Tolerance>, ToleranceError> {
    let number = text.trim();
    let number = number.strip_suffix('%').unwrap_or(number).trim_end();
    if number.parse() == Ok(0.0) { Ok(None) } else { text.parse().map(Some) }
}

/// The limit in the units of the first shape.
fn absolute_limit(limit: Option<Tolerance>, first: &Subject) -> Result<f64, ToleranceError> {
    limit.map_or(Ok(0.0), |limit| limit.resolve(first.simplices.bounds().diagonal()))
}

fn told(subjects: &[Subject], comparisons: &[Comparison], arguments: &CompareArguments, limit: Option<f64>) -> Value {
    let mut object = Map::new();
    object.insert("schema".into(), json!("shapeloom.compare/1"));
    object.insert("shapes".into(), subjects.iter().map(|subject| Value::Object(subject.account())).collect());
    object.insert("truth".into(), json!(arguments.truth.as_ref().map(|_| subjects[0].name.as_str())));
    object.insert("diagonal".into(), account::number(subjects[0].simplices.bounds().diagonal()));
    object.insert("diagonal_of".into(), json!(subjects[0].name));
    object.insert("accuracy".into(), account::number(arguments.accuracy));
    object.insert("fail_above".into(), json!(limit.map(account::number)));
    let accounts: Vec<Map<String, Value>> = comparisons.iter().map(|comparison| comparison.account(subjects)).collect();
    if let [only] = &accounts[..] {
        object.extend(only.clone());
    }
    object.insert("comparisons".into(), accounts.into_iter().map(Value::Object).collect());
    Value::Object(object)
}

/// A number with six digits.
pub(crate) fn short(value: f64) -> String {
    let [text] = apart([value]);
    text
}

/// Numbers with six digits, or as many more as tell those apart that differ.
fn apart<const N: usize>(values: [f64; N]) -> [String; N] {
    let with = |digits: usize| values.map(|value| format!("{value:.digits$e}").parse().unwrap_or(value));
    let told = |rounded: &[f64; N]| {
        let pairs = (0..N).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs.into_iter().all(|(i, j)| (values[i] == values[j]) == (rounded[i] == rounded[j]))
    };
    // 17 digits tell all numbers apart.
    (5..16).map(with).find(told).unwrap_or(values).map(|value| Words(value).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_differ_are_told_apart() {
        assert_eq!(apart([0.123_456_789, 2.0]), ["0.123457", "2"]);
        assert_eq!(apart([0.123_456_789, 0.123_456_712, 0.123_456_789]), ["0.1234568", "0.1234567", "0.1234568"]);
        assert_eq!(apart([0.1, 0.1f64.next_up()]), ["0.1", "0.10000000000000002"]);
        assert_eq!(apart([1e300, f64::INFINITY]), ["1e300", "inf"]);
        assert_eq!(apart([f64::MAX, f64::MAX.next_down()]), [f64::MAX, f64::MAX.next_down()].map(|x| format!("{x:e}")));
        assert_eq!(short(1.0 / 3.0), "0.333333");
    }

    #[test]
    fn nothing_is_a_limit() {
        for text in ["0", "0.0", " 0 % ", "0%", "-0", "0e5"] {
            assert_eq!(limit(text), Ok(None), "{text}");
        }
        assert_eq!(limit("0.5%"), Ok(Some(Tolerance::OfDiagonal(0.005))));
        for text in ["-1", "nan", "near", "", "%"] {
            assert!(limit(text).is_err(), "{text}");
        }
    }
}
