//! Reports as JSON and as words.

use serde_json::{Value, json};
use shapeloom_convert::{Conversion, Step};
use shapeloom_core::{
    Aabb, Deviation, Figure, Findings, Loss, OptionKind, OptionSpec, OptionValue, Place, Report, Severity, Words,
};

/// A number, or nothing where JSON has none for it.
pub(crate) fn number(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or(Value::Null, Value::Number)
}

pub(crate) fn bounds(bounds: &Aabb) -> Value {
    let point = |p: [f64; 3]| Value::Array(p.into_iter().map(number).collect());
    json!({ "min": point(bounds.min.to_array()), "max": point(bounds.max.to_array()) })
}

pub(crate) fn deviation(deviation: Deviation) -> Value {
    match deviation.value() {
        Some(value) => json!({ "kind": deviation.kind(), "value": number(value) }),
        None => json!({ "kind": deviation.kind() }),
    }
}

pub(crate) fn losses(losses: &[Loss]) -> Value {
    losses.iter().map(|loss| json!({ "what": loss.what, "why": loss.why })).collect()
}

pub(crate) fn findings(findings: &Findings) -> Value {
    let place = |place: &Place| match place {
        Place::Whole => json!("whole"),
        Place::Line { line, column } => json!({ "line": line, "column": column }),
        Place::Byte(offset) => json!({ "byte": offset }),
        Place::Element { kind, index } => json!({ "kind": kind, "index": index }),
        Place::Pair { kind, indices } => json!({ "kind": kind, "indices": indices }),
        Place::Edge { vertices } => json!({ "kind": "edge", "vertices": vertices }),
    };
    let one = |finding: &shapeloom_core::Finding| {
        json!({
            "code": finding.code,
            "severity": if finding.severity == Severity::Warning { "warning" } else { "note" },
            "message": finding.message,
            "count": finding.count,
            "places": finding.places.iter().map(place).collect::<Vec<_>>(),
        })
    };
    findings.iter().map(one).collect()
}

pub(crate) fn option_value(value: &OptionValue) -> Value {
    match value {
        OptionValue::Float(value) => number(*value),
        OptionValue::Integer(value) => json!(value),
        OptionValue::Bool(value) => json!(value),
        OptionValue::Text(value) => json!(value),
    }
}

pub(crate) fn option_spec(spec: &OptionSpec) -> Value {
    let mut object = json!({
        "name": spec.name,
        "doc": spec.doc,
        "takes": spec.kind.to_string(),
        "default": spec.default.as_ref().map(option_value),
    });
    if matches!(spec.kind, OptionKind::Float | OptionKind::Integer) {
        object["bounds"] = json!(spec.bounds.to_string());
    }
    object
}

pub(crate) fn report(report: &Report) -> Value {
    let figures: serde_json::Map<String, Value> =
        report.figures.iter().map(|figure| (figure.name.clone(), number(figure.value))).collect();
    let mut object = json!({
        "deviation": deviation(report.deviation),
        "basis": report.basis,
        "losses": losses(&report.losses),
        "findings": findings(&report.findings),
        "figures": figures,
    });
    if !report.certificates.is_empty() {
        object["certificates"] = report.certificates.iter().map(|&bound| number(bound)).collect();
    }
    object
}

/// The steps of a conversion; with their seconds only where that was asked for, so that reports are reproducible.
pub(crate) fn steps(conversion: &Conversion, timings: bool) -> Value {
    let one = |(index, step): (usize, &Step)| {
        let options: serde_json::Map<String, Value> =
            step.options.iter().map(|(name, value)| ((*name).to_owned(), option_value(value))).collect();
        let mut object = json!({
            "converter": step.converter,
            "parts": step.parts,
            "from": step.from.name(),
            "to": step.to.name(),
            "options": options,
            "report": report(&step.report),
        });
        if timings {
            object["seconds"] = number(conversion.timings.seconds[index]);
        }
        object
    };
    conversion.steps.iter().enumerate().map(one).collect()
}

/// Whether a figure counts something; a value or a ratio may be whole by chance.
fn is_count(figure: &Figure) -> bool {
    figure.value.fract() == 0.0 && !["_value", "_a_sample"].iter().any(|end| figure.name.ends_with(end))
}

/// A step in a line of words.
pub(crate) fn step_words(step: &Step, seconds: Option<f64>) -> String {
    let sizes: Vec<String> = step
        .report
        .figures
        .iter()
        .filter(|figure| is_count(figure))
        .map(|figure| format!("{} {}", Words(figure.value), figure.name.replace('_', " ")))
        .collect();
    let mut words = format!("{}: {} -> {}", step.converter, step.from, step.to);
    if step.parts.len() > 1 {
        words += &format!(" for {} parts", step.parts.len());
    }
    if !sizes.is_empty() {
        words += &format!(", {}", sizes.join(", "));
    }
    words += &format!("; error {}", step.report.deviation);
    if let Some(seconds) = seconds {
        words += &format!("; {seconds:.3} s");
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_shape::Kind;

    #[test]
    fn a_step_tells_its_counts_and_huge_ones_in_short() {
        let mut report = Report::new("march", Deviation::AtMost(2.0), "");
        for (name, value) in [("triangles", 12.0), ("iso_value", 3.0), ("bytes_a_sample", 2.0), ("inner_cells", 2e28)] {
            report.figure(name, value);
        }
        let (from, to) = (Kind::VoxelGrid, Kind::TriMesh);
        let step = Step { converter: "march", parts: vec![0], from, to, options: Vec::new(), report };
        let words = step_words(&step, Some(0.25));
        assert!(words.contains(", 12 triangles, 2e28 inner cells; error "), "{words}");
        assert!(words.ends_with("; 0.250 s"), "{words}");
    }
}
