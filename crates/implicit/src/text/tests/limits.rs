//! Deep, long and large texts.

use std::fmt::Write;

use shapeloom_core::Diagnostic;

use super::*;
use crate::text::parser::counted;

fn on_small_stack(run: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(128 << 10).spawn(run).unwrap().join().unwrap();
}

#[test]
fn depth_takes_no_stack() {
    on_small_stack(|| {
        const DEEP: usize = 100_000;
        let wrapped = |before: &str, inner: &str, after: &str| before.repeat(DEEP) + inner + &after.repeat(DEEP);
        assert!(read(&wrapped("(", "x", ")")) == Tree::x());
        assert_eq!(read(&wrapped("-", "x", "")).node_count(), DEEP + 1);
        assert_eq!(read(&wrapped("", "x", " + y")).node_count(), DEEP + 2);
        assert_eq!(read(&wrapped("x ^ y ^ ", "x", "")).node_count(), 2 * DEEP + 2);
        assert_eq!(read(&wrapped("", "x", " | y")).node_count(), 3);
        let deep = read(&wrapped("sin(y | (", "x", "))"));
        assert_eq!(deep.node_count(), 2 * DEEP + 2);
        let methods = read(&wrapped("", "x", ".offset(1)"));
        for tree in [deep, methods, read(&wrapped("~", "x", ""))] {
            let text = to_text(&tree, None);
            assert!(read(&text) == tree);
        }
        for text in
            [wrapped("(", "", ""), wrapped("(", "x", ")) "), wrapped("sin(", "1", ""), wrapped("union(x, ", "x", "]")]
        {
            assert_eq!(fault(&text).code(), "E-shape-text-syntax");
        }
        let mut chain = "a0 = x;\n".to_owned();
        for i in 1..DEEP {
            let _ = writeln!(chain, "a{i} = a{} + 1;", i - 1);
        }
        let tree = read(&(chain.clone() + "a99999"));
        assert!(read(&to_text(&tree, None)) == tree);
        // A circle of definitions is followed without recursion.
        let circle = chain.replacen("a0 = x;", "a0 = a99999;", 1) + "a0";
        assert!(fault(&circle).to_string().contains("no circle"));
    });
}

#[test]
fn ten_megabytes_take_steps_in_proportion() {
    let steps = |text: &str| counted(text.as_bytes(), Some(&Ramps)).unwrap().1;
    let definitions = |count: usize| -> String {
        let mut text = String::new();
        for i in 0..count {
            let _ = writeln!(
                text,
                "_part_number_{i} = sphere(radius: 1.0e0000).move(1, 2, 3) | (x + 2 * 3); # ü{}",
                "-".repeat(80)
            );
        }
        text + "x"
    };
    let (small, large) = (definitions(7_000), definitions(70_000));
    assert!(large.len() > 10 << 20, "{}", large.len());
    let (few, many) = (steps(&small), steps(&large));
    assert!(many < large.len() && many <= 10 * few + 100, "{few} {many}");
    let comment = "#".repeat(10 << 20) + "\nx";
    assert!(steps(&comment) < 10);
    assert!(read(&("1.".to_owned() + &"0".repeat(10 << 20))) == Tree::constant(1.0));
    let name = "n".repeat(5 << 20);
    assert!(read(&format!("{name} = 2;{name}")) == Tree::constant(2.0));
    assert!(fault(&name).to_string().len() < 200);
    // A long text used often is kept once.
    let text = format!("t = \"{}\"; ramp(t) | {}", "n".repeat(1 << 20), "f(t, ".repeat(10_000));
    assert_eq!(fault(&text).code(), "E-shape-text-syntax");
}

#[test]
fn too_many_operations_are_refused() {
    for text in [
        "x+".repeat(5 << 20) + "x",
        "(".repeat(10 << 20),
        "-".repeat(10 << 20),
        "union(".to_owned() + &"x,".repeat(5 << 20),
    ] {
        assert_eq!(fault(&text).code(), "E-shape-text-size");
    }
}
