//! The report of a comparison: a page with tables and pictures, and the numbers as CSV.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Category, Options};
use shapeloom_judge::{DirectedHausdorff, MeanDistance};
use shapeloom_render::{Picture, scene_of_shape, sensible_camera, sequential_color};
use shapeloom_shape::UpAxis;

use super::comparison::Comparison;
use super::{Subject, short};
use crate::commands::coloring::color_by_distance;
use crate::failure::Failure;
use crate::output::{Output, stage};
use crate::session::Session;
use crate::soundness::Soundness;

pub(crate) const INDEX: &str = "index.html";
const TABLE: &str = "distances.csv";
/// Many pictures, each no larger than a page shows it.
const SIZE: (u32, u32) = (480, 360);

/// Every file that a report may have.
pub(super) fn files(folder: &Path, shapes: &[&Path]) -> Vec<PathBuf> {
    let mut names = vec![INDEX.to_owned(), TABLE.to_owned()];
    names.extend((0..shapes.len()).map(shape_picture));
    names.extend((1..shapes.len()).flat_map(|other| [0, other].map(|on| distance_picture(other, on))));
    names.iter().map(|name| folder.join(name)).collect()
}

fn shape_picture(index: usize) -> String {
    format!("shape-{index}.png")
}

/// The picture of shape `on`, coloured by its distance to the other of the comparison with shape `other`.
fn distance_picture(other: usize, on: usize) -> String {
    format!("distance-{other}-on-{on}.png")
}

/// A picture that is drawn, and the distances at the ends of its colours.
struct Drawn {
    name: String,
    png: Vec<u8>,
    range: Option<(f64, f64)>,
}

/// Makes all files of a report; none has its place yet.
pub(super) fn stage_all(
    folder: &Path,
    force: bool,
    subjects: &[Subject],
    comparisons: &[Comparison],
    session: &mut Session<'_>,
) -> Result<Vec<Output>, Failure> {
    // One view for all, so that pictures can be laid over each other.
    let bounds = subjects.iter().fold(Aabb::EMPTY, |bounds, subject| bounds.union(subject.simplices.bounds()));
    // What is measured is told, whether or not it can be drawn.
    let (drawn, remark) = match draw_all(subjects, comparisons, &bounds, session) {
        Ok(drawn) => (drawn, None),
        Err(Failure::Narrow { error, .. }) if is_of_shapes(error.category()) => {
            (Vec::new(), Some(format!("pictures are left out: shapes of this size cannot be drawn ({error})")))
        }
        Err(error) => return Err(error),
    };
    if let Some(remark) = &remark {
        session.say(remark);
    }
    let page = page(subjects, comparisons, &drawn, remark.as_deref());
    let table = table(subjects, comparisons);
    let mut files: Vec<(String, &[u8])> =
        vec![(INDEX.to_owned(), page.as_bytes()), (TABLE.to_owned(), table.as_bytes())];
    files.extend(drawn.iter().map(|drawn| (drawn.name.clone(), drawn.png.as_slice())));
    let one = |(name, bytes): (String, &[u8])| {
        let path = folder.join(name);
        stage(&path, force, |out| out.write_all(bytes).map_err(|error| Failure::write(&path, &error)))
    };
    files.into_iter().map(one).collect()
}

/// Whether an error is about what is drawn, and not about memory, time or files.
fn is_of_shapes(category: Category) -> bool {
    matches!(category, Category::Usage | Category::Malformed | Category::Unsupported | Category::Failed)
}

fn draw_all(
    subjects: &[Subject],
    comparisons: &[Comparison],
    bounds: &Aabb,
    session: &Session<'_>,
) -> Result<Vec<Drawn>, Failure> {
    let mut drawn = Vec::new();
    for (index, subject) in subjects.iter().enumerate() {
        drawn.extend(draw(shape_picture(index), subject, None, bounds, session)?);
    }
    for comparison in comparisons {
        // One scale of colours for both ways.
        let hausdorff = &comparison.measured.hausdorff;
        let range = (0.0, hausdorff.upper());
        for (on, to) in [(0, comparison.other), (comparison.other, 0)] {
            let name = distance_picture(comparison.other, on);
            drawn.extend(draw(name, &subjects[on], Some((&subjects[to], range)), bounds, session)?);
        }
    }
    Ok(drawn)
}

/// A picture of a shape, coloured by its distance to another if that is given; none where there is no surface.
fn draw(
    name: String,
    subject: &Subject,
    distance: Option<(&Subject, (f64, f64))>,
    bounds: &Aabb,
    session: &Session<'_>,
) -> Result<Option<Drawn>, Failure> {
    if !subject.has_surface() {
        return Ok(None);
    }
    let up = subject.shape.up.unwrap_or(UpAxis::Z).vector();
    let (width, height) = SIZE;
    let camera = sensible_camera(bounds, up, f64::from(width) / f64::from(height))?;
    let exec = session.exec();
    let (mut scene, _memory) = scene_of_shape(&subject.surface(), &exec)?;
    let mut range = None;
    if let Some((other, wanted)) = distance {
        range = Some(color_by_distance(&mut scene, &other.simplices, Some(wanted), &exec)?);
    }
    let picture = Picture {
        width,
        height,
        samples: 2,
        ambient_rays: 8,
        shadow_rays: 4,
        seed: session.globals.seed,
        ..Picture::new()
    };
    picture.validate()?;
    let png = picture.draw(&scene, &camera, up, &exec)?.to_png()?;
    Ok(Some(Drawn { name, png, range }))
}

/// The numbers, a line for each direction of each comparison.
fn table(subjects: &[Subject], comparisons: &[Comparison]) -> String {
    let mut text = String::from("from,to,mean,rms,max,hausdorff_lower,hausdorff_upper,converged,diagonal\n");
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    for comparison in comparisons {
        let found = &comparison.measured;
        let ways: [(usize, usize, &MeanDistance, &DirectedHausdorff); 2] = [
            (0, comparison.other, &found.a_to_b, &found.hausdorff.a_to_b),
            (comparison.other, 0, &found.b_to_a, &found.hausdorff.b_to_a),
        ];
        for (from, to, mean, farthest) in ways {
            let (lower, upper) = comparison.bounds_of(farthest);
            let _ = writeln!(
                text,
                "{},{},{:e},{:e},{:e},{:e},{:e},{},{:e}",
                quoted(&subjects[from].name),
                quoted(&subjects[to].name),
                mean.mean.value,
                mean.rms.value,
                farthest.lower,
                lower,
                upper,
                farthest.converged,
                subjects[0].simplices.bounds().diagonal()
            );
        }
    }
    text
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:1340px;margin:2rem auto;padding:0 1rem;color:#1b2430}\
table{border-collapse:collapse;margin:1rem 0}th,td{padding:.3rem .8rem;border-bottom:1px solid #d8dee6;text-align:right}\
th:first-child,td:first-child{text-align:left}th{border-bottom:2px solid #6b7a8c}\
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(20rem,1fr));gap:1rem}figure{margin:0}\
img{width:100%;height:auto;border-radius:.3rem}.bar{height:.9rem;border-radius:.2rem}\
.ends{display:flex;justify-content:space-between;font-variant-numeric:tabular-nums}\
.above,.undecided{color:#a02020;font-weight:600}.within{color:#186030;font-weight:600}";

/// The page, whole in itself: pictures are inside it too.
fn page(subjects: &[Subject], comparisons: &[Comparison], drawn: &[Drawn], remark: Option<&str>) -> String {
    let mut html = String::from("<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n");
    let _ = writeln!(html, "<meta name=\"viewport\" content=\"width=device-width\"><title>Shapes compared</title>");
    let _ = writeln!(html, "<style>{STYLE}</style></head>\n<body>\n<h1>Shapes compared</h1>");
    shapes(&mut html, subjects, drawn);
    if let Some(remark) = remark {
        let _ = writeln!(html, "<p>{}</p>", escaped(remark));
    }
    for comparison in comparisons {
        section(&mut html, subjects, comparison, drawn);
    }
    let _ = writeln!(
        html,
        "<p>Hausdorff distances lie between the bounds for every point of both shapes. <em>Largest found</em> is the \
         distance of a point that was found. Means are over the area; their bounds are proven for the triangles that were \
         compared. The numbers are in <a href=\"{TABLE}\">{TABLE}</a>.</p>\n</body></html>"
    );
    html
}

fn shapes(html: &mut String, subjects: &[Subject], drawn: &[Drawn]) {
    html.push_str(
        "<table><tr><th>shape</th><th>format</th><th>elements</th><th>diagonal</th><th>area</th><th>volume</th>",
    );
    html.push_str("<th>closed</th><th>components</th><th>genus</th>");
    html.push_str("<th>error of tessellation</th></tr>\n");
    for subject in subjects {
        let number = |value: Option<f64>| value.map_or("&ndash;".to_owned(), short);
        let topology =
            subject.soundness.as_ref().map_or(std::array::from_fn(|_| "&ndash;".to_owned()), Soundness::brief);
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(&subject.name),
            subject.format,
            subject.simplices.triangles.len(),
            short(subject.simplices.bounds().diagonal()),
            number(subject.area()),
            number(subject.volume()),
            topology[0],
            topology[1],
            topology[2],
            escaped(&subject.deviation.to_string())
        );
    }
    html.push_str("</table>\n<div class=\"pictures\">\n");
    for (index, subject) in subjects.iter().enumerate() {
        figure(html, drawn, &shape_picture(index), &subject.name);
    }
    html.push_str("</div>\n");
}

fn section(html: &mut String, subjects: &[Subject], comparison: &Comparison, drawn: &[Drawn]) {
    let (a, b) = (&subjects[0], &subjects[comparison.other]);
    let (_, upper) = comparison.bounds();
    let found = &comparison.measured;
    let _ = writeln!(html, "<h2>{} and {}</h2>", escaped(&a.name), escaped(&b.name));
    let diagonal = a.simplices.bounds().diagonal();
    let share = if diagonal > 0.0 {
        format!(", at most {}% of the diagonal", short(upper / diagonal * 100.0))
    } else {
        String::new()
    };
    let [low, high] = comparison.bounds_words();
    let _ = writeln!(html, "<p>Hausdorff distance from {low} to {high}{share}.");
    if comparison.slack.is_none() {
        html.push_str(" It is that of the triangles, whose own error is not proven.");
    }
    if !found.hausdorff.converged() {
        html.push_str(" The bounds hold, but are wider than asked for.");
    }
    let _ = writeln!(html, " Chamfer distance {} (mean of both means).</p>", short(found.chamfer()));
    if let Some((words, verdict)) = comparison.verdict_words().zip(comparison.verdict) {
        let class = verdict.name().rsplit(' ').next().unwrap_or_default().replace("decided", "undecided");
        let _ = writeln!(html, "<p class=\"{class}\">{}</p>", escaped(&words));
    }
    html.push_str(
        "<table><tr><th>from</th><th>to</th><th>mean</th><th>mean at least</th><th>mean at most</th><th>rms</th>",
    );
    html.push_str("<th>largest found</th><th>largest at most</th></tr>\n");
    let ways = [(a, b, &found.a_to_b, &found.hausdorff.a_to_b), (b, a, &found.b_to_a, &found.hausdorff.b_to_a)];
    for (from, to, mean, farthest) in ways {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(&from.name),
            escaped(&to.name),
            short(mean.mean.value),
            short(mean.mean.lower),
            short(mean.mean.upper),
            short(mean.rms.value),
            short(farthest.lower),
            short(comparison.bounds_of(farthest).1)
        );
    }
    html.push_str("</table>\n<div class=\"pictures\">\n");
    for (on, to) in [(0, comparison.other), (comparison.other, 0)] {
        let caption = format!("{}: distance to {}", subjects[on].name, subjects[to].name);
        figure(html, drawn, &distance_picture(comparison.other, on), &caption);
    }
    html.push_str("</div>\n");
}

/// A picture with its caption, and the scale of its colours.
fn figure(html: &mut String, drawn: &[Drawn], name: &str, caption: &str) {
    let Some(picture) = drawn.iter().find(|drawn| drawn.name == name) else { return };
    let caption = escaped(caption);
    let _ = write!(html, "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\">", base64(&picture.png));
    if let Some((from, to)) = picture.range {
        let stops: Vec<String> = (0..=16).map(|k| css(sequential_color(f64::from(k) / 16.0))).collect();
        let _ = write!(
            html,
            "<div class=\"bar\" style=\"background:linear-gradient(to right,{})\"></div>",
            stops.join(",")
        );
        let middle = short(from.midpoint(to));
        let _ = write!(
            html,
            "<div class=\"ends\"><span>{}</span><span>{middle}</span><span>{}</span></div>",
            short(from),
            short(to)
        );
    }
    let _ = writeln!(html, "<figcaption>{caption}</figcaption></figure>");
}

/// A linear colour for a style sheet.
fn css(color: [f32; 3]) -> String {
    let linear = DVec3::from_array(color.map(f64::from));
    let channel = |x: f64| {
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round()
    };
    format!("rgb({} {} {})", channel(linear.x), channel(linear.y), channel(linear.z))
}

/// Text as it may stand in a page.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            letter => safe.push(letter),
        }
    }
    safe
}

/// Bytes in base 64 (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let at = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xff, 0xef, 0xbe]), "/+++");
    }

    #[test]
    fn names_cannot_break_the_page() {
        assert_eq!(escaped("<b>&\"x\""), "&lt;b&gt;&amp;&quot;x&quot;");
    }
}
