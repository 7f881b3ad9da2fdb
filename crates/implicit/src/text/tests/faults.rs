//! What is wrong is said, with its place.

use shapeloom_core::Diagnostic;

use super::*;

#[test]
fn faults_have_places_and_words() {
    for (text, line, column, code, words) in [
        ("", 1, 1, "syntax", "found the end, expected a shape after the definitions"),
        ("# nothing\n", 2, 1, "syntax", "found the end"),
        ("a = 1;", 1, 7, "syntax", "found the end"),
        ("x +", 1, 4, "syntax", "found the end, expected a number, a name or \"(\""),
        ("x\n  + )", 2, 5, "syntax", "found \")\""),
        ("(x", 1, 3, "syntax", "expected an operator or \")\""),
        ("x)", 1, 2, "syntax", "found \")\", expected an operator or \";\""),
        ("x, y", 1, 2, "syntax", "found \",\""),
        ("(x, y)", 1, 3, "syntax", "found \",\", expected an operator or \")\""),
        ("sphere(1", 1, 9, "syntax", "expected an operator, \",\" or \")\""),
        ("sphere(1,)", 1, 10, "syntax", "found \")\""),
        ("2 x", 1, 3, "syntax", "found x, expected an operator or \";\""),
        ("x; y", 1, 4, "syntax", "expected the end after the shape"),
        ("x deg", 1, 3, "syntax", "deg after numbers alone"),
        ("x.5", 1, 2, "syntax", "found the number 0.5"),
        ("x.y", 1, 4, "syntax", "expected \"(\""),
        ("x.(1)", 1, 3, "syntax", "expected the name of a function"),
        ("é = x; é", 1, 1, "syntax", "found the character 'é'"),
        ("sphere(1, 2 = 3)", 1, 13, "syntax", "found \"=\""),
        ("sphere(radius: 1, 2)", 1, 19, "syntax", "expected the name of a parameter"),
        ("ramp(\"a", 1, 6, "syntax", "a text without end"),
        ("ramp(\"a\n\")", 1, 6, "syntax", "a text without end"),
        ("ramp(\"\\q\")", 1, 7, "syntax", "after a backslash"),
        ("bounds(0,0,0,1,1,1) x", 1, 21, "syntax", "found x"),
        ("bounds(0,0,0,1,1,1); bounds(0,0,0,1,1,1); x", 1, 22, "syntax", "bounds a second time"),
        ("\"text\"", 1, 1, "syntax", "found a text, expected a shape"),
        ("1e999", 1, 1, "number", "found 1e999, expected a number below 1.8e308"),
        ("x + inf", 1, 5, "name", "found the unknown name inf"),
        ("NaN", 1, 1, "name", "found the unknown name NaN"),
        ("plate = sphere(1);\n plaet", 2, 2, "name", "found the unknown name plaet, expected plate?"),
        ("a = b;\nb = x; a", 1, 5, "order", "found b, which line 2 defines"),
        ("a = b;\nb = a; a", 1, 5, "order", "needs this one, expected no circle"),
        ("a = b; b = c; c = d;\n d = a; a", 1, 5, "order", "line 1 needs this one, expected no circle"),
        ("a = a + 1; a", 1, 5, "order", "needs this one, expected no circle"),
        ("a = x;\na = y; a", 2, 1, "twice", "found a, which line 1 defines, expected a new name"),
        ("x = 1; x", 1, 1, "twice", "a word of the language"),
        ("deg = 1; x", 1, 1, "twice", "a word of the language"),
        ("x | shpere(1)", 1, 5, "function", "found the unknown function shpere, expected sphere?"),
        ("mesh(\"a.stl\")", 1, 1, "function", "found the unknown function mesh"),
        ("rmap(1)", 1, 1, "function", "expected ramp?"),
        ("x.(", 1, 3, "syntax", "the name of a function"),
        ("sphere()", 1, 1, "argument", "sphere: found no radius, expected sphere(radius, x = 0, y = 0, z = 0)"),
        ("box(1, 2, 3,\n 4)", 2, 2, "argument", "box: found 4 arguments, expected box(x, y, z)"),
        ("box(1, 2, height: 3)", 1, 11, "argument", "found the unknown parameter height"),
        ("cylinder(raduis: 3)", 1, 10, "argument", "expected radius?"),
        ("sphere(1, radius: 2)", 1, 11, "argument", "found radius twice"),
        ("sphere(x)", 1, 8, "argument", "sphere: found a shape or formula, expected a number as radius"),
        ("x.sphere()", 1, 2, "argument", "found a shape or formula, expected a number as radius"),
        ("offset(\"a\", 1)", 1, 8, "argument", "offset: found a text, expected a shape or formula as a"),
        ("union()", 1, 1, "argument", "union: found no parts, expected at least one"),
        ("union(x, b: y)", 1, 10, "argument", "found the parameter b"),
        ("x + \"a\"", 1, 3, "argument", "operator +: found a text"),
        ("-\"a\"", 1, 1, "argument", "operator -: found a text"),
        ("x | bounds(0,0,0,1,1,1)", 1, 3, "argument", "operator |: found bounds"),
        ("ramp(\"a\", 2)", 1, 11, "argument", "expected finite numbers with different names"),
        ("ramp(\"a\", b: 1/0)", 1, 11, "argument", "found a number b"),
        ("x |\n  sphere(-1)", 2, 3, "parameter", "sphere: found radius -1, expected a finite number above 0"),
        ("sphere(1/0)", 1, 1, "parameter", "found radius inf"),
        ("x.scale(0)", 1, 3, "parameter", "found determinant 0"),
        ("x.scale(1, 2)", 1, 3, "parameter", "expected one factor or three"),
        ("x.rotate(0, 0, 0, 1)", 1, 3, "parameter", "rotate: found an axis of length 0"),
        ("x.rotate_x(0/0)", 1, 3, "parameter", "rotate_x: found angle NaN"),
        ("prism(6.5, 1, 1)", 1, 1, "parameter", "found sides 6.5, expected a whole number"),
        ("x.repeat(1, copies_y: -1)", 1, 3, "parameter", "repeat: found copies_y -1"),
        ("bounds(0, 0, 0, 1, -1, 1); x", 1, 1, "parameter", "bounds: found y2 -1, expected no less"),
        ("bounds(0, 0, 1/0, 1, 1, 1); x", 1, 1, "parameter", "bounds: found z1 inf"),
        ("ramp(\"broken\")", 1, 1, "foreign", "ramp(\"broken\"): found no file"),
    ] {
        let error = fault(text);
        let found = (error.line, error.column, error.code());
        assert_eq!(found, (line, column, format!("E-shape-text-{code}").as_str()), "{text}: {error}");
        assert!(error.to_string().contains(words), "{text}: {error}");
        assert!(error.to_string().starts_with(&format!("line {line}, column {column}: ")));
    }
    let alone = parse(b"x | ramp(\"a\")", None).unwrap_err();
    assert_eq!((alone.column, alone.code()), (5, "E-shape-text-resolver"));
    let bytes = parse(b"# \xC3\xA9\n x + \xFF", None).unwrap_err();
    assert_eq!((bytes.line, bytes.column, bytes.code()), (2, 6, "E-shape-text-encoding"));
    assert!(bytes.to_string().contains("0xFF"));
}

#[test]
fn columns_count_characters() {
    let error = fault("ramp(\"äöü€\u{1F600}\") ! x");
    assert_eq!((error.line, error.column), (1, 15));
}

/// Texts with a few bytes changed give a tree or an error, never a panic; what they give is written and reads back.
#[test]
fn changed_bytes_never_panic() {
    let mut texts: Vec<Vec<u8>> = crate::laws::samples().iter().map(|tree| to_text(tree, None).into_bytes()).collect();
    for text in [
        "a = x; b = a ^ 2 + y; bounds(-1, -1, -1, 1, 1, 1); (b | a) \\ ~a.move(1, 2, 3).scale(2) # end",
        "wheel = ramp(\"a\\\"b.stl\", height: -2e-3); wheel.repeat(1, copies_x: 2).named(\"four wheels\") & 30 deg",
        "plate = rounded_box(60, 40, 6, radius: 2);\nholes = cylinder(4, 10) | cylinder(4, 9);\nplate \\ holes;",
    ] {
        texts.extend(vec![text.as_bytes().to_vec(); 40]);
    }
    let mut numbers = crate::laws::Numbers::new(21);
    let signs = b"()\"\\.,;:=+-*/^|&~#_xyz019e \n\xFF";
    let (mut read, mut refused) = (0, 0);
    for round in 0..5000 {
        let mut text = texts[round % texts.len()].clone();
        for _ in 0..=round % 3 {
            let at = numbers.within(0.0, text.len() as f64) as usize;
            let sign = signs[numbers.within(0.0, signs.len() as f64) as usize];
            match numbers.within(0.0, 4.0) as u32 {
                0 => text[at] = sign,
                1 => text.insert(at, sign),
                2 if text.len() > 1 => drop(text.remove(at)),
                _ => text[at] ^= 1 << (numbers.within(0.0, 8.0) as u32),
            }
        }
        match parse(&text, Some(&Ramps)) {
            Ok(parsed) => {
                read += 1;
                let again = parse(to_text(&parsed.tree, parsed.bounds.as_ref()).as_bytes(), Some(&Ramps)).unwrap();
                assert!(again.tree == parsed.tree && again.bounds == parsed.bounds);
            }
            Err(error) => {
                refused += 1;
                let lines = text.iter().filter(|&&byte| byte == b'\n').count() as u64 + 1;
                assert!((1..=lines).contains(&error.line) && error.column <= text.len() as u64 + 1, "{error}");
            }
        }
    }
    assert!(read > 300 && refused > 300, "{read} {refused}");
}
