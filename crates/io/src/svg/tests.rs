//! What is written, read again by another program's XML reader.

use quick_xml::Reader;
use quick_xml::events::Event;
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Deviation, Report};
use shapeloom_mesh::{Column, Polyline};
use shapeloom_shape::{Part, Shape, Units};

use super::FORMAT;
use crate::{WriteContext, write};

fn written(shape: &Shape) -> (String, Report) {
    let mut bytes = Vec::new();
    let report = write(shape, &FORMAT, &WriteContext::default(), &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), report)
}

/// The value of an attribute of every element of that name.
fn attributes(text: &str, element: &str, attribute: &str) -> Vec<String> {
    let mut reader = Reader::from_str(text);
    let mut found = Vec::new();
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == element => {
                let value = tag.try_get_attribute(attribute).unwrap();
                found.extend(value.map(|value| value.value.into_owned()));
            }
            Event::Eof => return found,
            _ => {}
        }
    }
}

/// The points of a path of straight lines, y turned up again, and whether it is closed.
fn points(path: &str) -> (Vec<DVec3>, bool) {
    let closed = path.ends_with('Z');
    let line = path.trim_end_matches('Z').trim_start_matches('M').split('L');
    let point = |word: &str| {
        let (x, y) = word.split_once(' ').unwrap();
        DVec3::new(x.parse().unwrap(), -y.parse::<f64>().unwrap(), 0.0)
    };
    (line.map(point).collect(), closed)
}

#[test]
fn paths_come_back_with_y_up() {
    let triangle =
        Polyline::new(vec![DVec3::new(0.1, 0.2, 0.0), DVec3::X * 3.0, DVec3::new(1e-9, 1.0 / 3.0, 0.0)], true);
    let open = Polyline::new(vec![DVec3::new(-2.5, 1e6, 0.0), DVec3::new(4.0, -7.25, 0.0)], false);
    let moved = Part { placement: Affine::from_translation(DVec3::X), ..Part::new(open.clone()) };
    let mut shape =
        Shape { parts: vec![Part::new(triangle.clone()).named("a <b> & \"c\"\u{1}"), moved], ..Shape::default() };
    let (text, report) = written(&shape);
    assert_eq!(report.deviation, Deviation::Exact);
    let paths = attributes(&text, "path", "d");
    assert_eq!(points(&paths[0]), (triangle.points().to_vec(), true));
    let shifted: Vec<DVec3> = open.points().iter().map(|p| *p + DVec3::X).collect();
    assert_eq!(points(&paths[1]), (shifted, false));
    assert!(text.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
    assert!(attributes(&text, "svg", "width").is_empty());
    let numbers = |word: &str| word.split(' ').map(|n| n.parse().unwrap()).collect::<Vec<f64>>();
    let view = numbers(&attributes(&text, "svg", "viewBox")[0]);
    for path in &paths {
        for point in points(path).0 {
            assert!(point.x > view[0] && point.x < view[0] + view[2]);
            assert!(-point.y > view[1] && -point.y < view[1] + view[3]);
        }
    }
    shape.units = Some(Units::INCHES);
    let (text, _) = written(&shape);
    let width: f64 = attributes(&text, "svg", "width")[0].trim_end_matches("mm").parse().unwrap();
    assert!((width - view[2] * 25.4).abs() < 1e-9 * width);
}

#[test]
fn what_is_left_out_is_said() {
    let mut line = Polyline::new(vec![DVec3::Z * 0.5, DVec3::new(1.0, 0.0, -2.0)], false);
    line.insert_attribute(Column::labels("heat", vec![1, 2])).unwrap();
    let (_, report) = written(&Shape::new(Part::new(line)));
    assert_eq!(report.deviation, Deviation::AtMost(2.0));
    let said: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    assert!(said.contains(&"z") && said.contains(&"vertex attribute \"heat\""), "{said:?}");
}

#[test]
fn nothing_and_single_points_are_files_too() {
    for parts in [vec![], vec![Part::new(Polyline::default())], vec![Part::new(Polyline::new(vec![DVec3::ONE], true))]]
    {
        let (text, _) = written(&Shape { parts, ..Shape::default() });
        assert_eq!(attributes(&text, "svg", "viewBox").len(), 1);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    let broken = Shape::new(Part::new(Polyline::new(vec![DVec3::NAN], false)));
    assert!(write(&broken, &FORMAT, &WriteContext::default(), &mut Vec::new()).is_err());
}
