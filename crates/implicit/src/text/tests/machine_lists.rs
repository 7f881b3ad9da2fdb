//! Lists of steps against an evaluator that shares nothing with the reader.

use std::collections::HashMap;
use std::path::Path;

use shapeloom_core::Diagnostic;
use shapeloom_core::glam::DVec3;

use super::*;
use crate::laws::{Numbers, samples};

/// Runs the lines one after another.
fn naive(text: &str, p: DVec3) -> f64 {
    let mut values: HashMap<&str, f64> = HashMap::new();
    let mut last = f64::NAN;
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()) {
        let words: Vec<&str> = line.split(' ').collect();
        let v = |i: usize| values[words[i]];
        last = match words[1] {
            "const" => words[2].parse().unwrap(),
            "var-x" => p.x,
            "var-y" => p.y,
            "var-z" => p.z,
            "add" => v(2) + v(3),
            "sub" => v(2) - v(3),
            "mul" => v(2) * v(3),
            "div" => v(2) / v(3),
            "min" => v(2).min(v(3)),
            "max" => v(2).max(v(3)),
            "neg" => -v(2),
            "abs" => v(2).abs(),
            "sqrt" => v(2).sqrt(),
            "square" => v(2) * v(2),
            "recip" => 1.0 / v(2),
            "sin" => v(2).sin(),
            "cos" => v(2).cos(),
            "tan" => v(2).tan(),
            "asin" => v(2).asin(),
            "acos" => v(2).acos(),
            "atan" => v(2).atan(),
            "exp" => v(2).exp(),
            "ln" => v(2).ln(),
            "floor" => v(2).floor(),
            "ceil" => v(2).ceil(),
            "round" => v(2).round(),
            "not" => f64::from(u8::from(v(2) == 0.0)),
            "and" => {
                if v(2) == 0.0 {
                    v(2)
                } else {
                    v(3)
                }
            }
            "or" => {
                if v(2) == 0.0 {
                    v(3)
                } else {
                    v(2)
                }
            }
            "atan2" => v(2).atan2(v(3)),
            "pow" => v(2).powf(v(3)),
            "mod" => v(2).rem_euclid(v(3)),
            "compare" => v(2).partial_cmp(&v(3)).map_or(f64::NAN, |order| f64::from(order as i8)),
            other => panic!("{other}"),
        };
        values.insert(words[0], last);
    }
    last
}

fn assert_same_values(text: &str, tree: &Tree, points: usize, label: &str) {
    let program = tree.compile().unwrap();
    let mut numbers = Numbers::new(3);
    let mut wrong = 0;
    for _ in 0..points {
        let p = numbers.point(2.0);
        let (found, expected) = (program.value(p), naive(text, p));
        // Sums of coordinates are one step of a program, and rounded otherwise: at a jump that may decide.
        let near = (found - expected).abs() <= 1e-9 * (1.0 + expected.abs()) || found == expected;
        let neither = found.is_nan() && expected.is_nan();
        wrong += usize::from(!(near || neither));
    }
    assert!(wrong == 0, "{label}: {wrong} of {points}\n");
}

#[test]
fn published_lists_have_the_values_of_their_lines() {
    for name in ["bear", "colonnade", "hi", "prospero", "quarter", "tanglecube"] {
        let Ok(text) = std::fs::read_to_string(Path::new("/work/shared/data/implicit").join(name).with_extension("vm"))
        else {
            continue;
        };
        let tree = parse_vm(text.as_bytes()).unwrap();
        let points = if name == "prospero" { 200 } else { 1000 };
        assert_same_values(&text, &tree, points, name);
        let again = print_vm(&tree).unwrap();
        assert_same_values(&again, &tree, points, name);
        assert_same_values(&text, &parse_vm(again.as_bytes()).unwrap(), points, name);
        // In the language too.
        assert!(read(&to_text(&tree, None)) == tree);
    }
}

const TANGLECUBE: &str = "# Published by many\n\nx var-x\ny var-y\nz var-z\nx2 square x\ny2 square y\nz2 square z\nx4 square x2\n\
    y4 square y2\nz4 square z2\na add x2 y2\nb add a z2\nfive const 5.0\nc mul b five\nd add x4 y4\ne add d z4\nf sub e c\nten const 1e1\n\
    out add f ten\n";

#[test]
fn the_tanglecube_is_its_formula() {
    let program = parse_vm(TANGLECUBE.as_bytes()).unwrap().compile().unwrap();
    let mut numbers = Numbers::new(9);
    for _ in 0..1000 {
        let p = numbers.point(3.0);
        let term = |t: f64| t.powi(4) - 5.0 * t * t;
        let expected = term(p.x) + term(p.y) + term(p.z) + 10.0;
        assert!((program.value(p) - expected).abs() < 1e-10);
    }
}

#[test]
fn every_operation_is_written_as_arithmetic() {
    let mut written = 0;
    for tree in samples() {
        match print_vm(&tree) {
            Ok(text) => {
                written += 1;
                assert_same_values(&text, &tree, 60, &text);
                assert_same_values(&text, &parse_vm(text.as_bytes()).unwrap(), 60, &text);
            }
            Err(error) => {
                assert_eq!(error.code(), "E-vm-foreign");
                let names = ["ramp", "blinn", "blobby", "metaballs", "soft_objects"];
                assert!(names.iter().any(|name| error.to_string().contains(name)), "{error}");
            }
        }
    }
    assert!(written > 100, "{written}");
    assert_eq!(print_vm(&Tree::constant(2.5)).unwrap(), "_0 const 2.5\n");
    assert_eq!(print_vm(&Tree::sphere(-1.0)).unwrap_err().code(), "E-implicit-parameter");
    // A constant that is there already is not the last line.
    let text = print_vm(&(Tree::x().power(5) + 2.0)).unwrap();
    assert_same_values(&text, &(Tree::x().power(5) + 2.0), 20, &text);
}

#[test]
fn faults_have_lines() {
    for (text, line, code, words) in [
        ("", 1, "empty", "found the end"),
        ("# a\n\n", 2, "empty", "found the end"),
        ("a var-x\nb sqare a", 2, "opcode", "unknown opcode sqare, expected square?"),
        ("a var-x\nb", 2, "opcode", "expected an opcode"),
        ("a var-w", 1, "opcode", "expected var-x?"),
        ("aa1 var-x\nb add aa1 aa2", 2, "name", "unknown step aa2, expected aa1?"),
        ("a add a a", 1, "name", "unknown step a, expected one of a line above"),
        ("a var-x\na var-y", 2, "twice", "second step a"),
        ("a var-x\nb add a", 2, "operands", "add: found 1 operands, expected 2"),
        ("a var-x\nb neg a a", 2, "operands", "neg: found 2 operands, expected 1"),
        ("a var-x 3", 1, "operands", "found 1 operands, expected 0"),
        ("a const", 1, "operands", "const: found 0 operands"),
        ("a const five", 1, "number", "found five"),
        ("a const 1e999", 1, "number", "found 1e999"),
    ] {
        let error = parse_vm(text.as_bytes()).unwrap_err();
        assert_eq!((error.line, error.code()), (line, format!("E-vm-{code}").as_str()), "{text}: {error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    assert_eq!(parse_vm(b"a var-x\nb \xFF").unwrap_err().code(), "E-vm-encoding");
    let infinite = parse_vm(b"a const inf\nb const -inf\nc const NaN\nd max a b").unwrap();
    assert_eq!(infinite.compile().unwrap().value(DVec3::ZERO), f64::INFINITY);
    // Lines may end as on Windows.
    assert!(parse_vm(b"a var-x\r\n\r\nb neg a\r\n").unwrap() == -Tree::x());
}

#[test]
fn changed_bytes_never_panic() {
    let mut numbers = Numbers::new(31);
    let (mut read, mut refused) = (0, 0);
    for round in 0..5000 {
        let mut text = TANGLECUBE.as_bytes().to_vec();
        for _ in 0..=round % 3 {
            let at = numbers.within(0.0, text.len() as f64) as usize;
            text[at] = numbers.within(0.0, 128.0) as u8;
        }
        match parse_vm(&text) {
            Ok(_) => read += 1,
            Err(_) => refused += 1,
        }
    }
    assert!(read > 100 && refused > 1000, "{read} {refused}");
}

#[test]
fn long_lists_take_no_stack() {
    let run = || {
        let mut text = "_0 var-x\n".to_owned();
        for i in 1..100_000 {
            text += &format!("_{i} {} _{}\n", ["neg", "sin"][i % 2], i - 1);
        }
        let tree = parse_vm(text.as_bytes()).unwrap();
        assert_eq!(tree.node_count(), 100_000);
        assert!(print_vm(&tree).unwrap().lines().count() >= 99_999);
    };
    std::thread::Builder::new().stack_size(128 << 10).spawn(run).unwrap().join().unwrap();
}
