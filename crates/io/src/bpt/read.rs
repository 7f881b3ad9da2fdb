//! Reading BPT.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Limits, Place, Severity};
use shapeloom_parametric::{BezierPatch, BezierSurface, MAX_DEGREE};
use shapeloom_shape::{Part, Shape, UpAxis};

use crate::memory::Memory;
use crate::text::{CountFault, NumberFault, Text, Token, Tokens, parse_count, parse_number, quoted};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// Three digits and three separators: no control point takes less.
const BYTES_A_POINT: usize = 6;

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let limits = &context.limits;
    let mut tokens = Text::try_new(input, limits)?.tokens();
    let mut memory = Memory::new(&context.exec);
    let mut findings = Findings::default();

    let Some(header) = tokens.next_token()? else {
        let place = Place::line(tokens.line().max(1));
        return Err(Fault::new("E-bpt-truncated", place, "the end of the file", "the number of patches").into());
    };
    let count = patch_count(&header, limits)?;
    let mut patches = Vec::new();
    let mut points = 0u64;
    for patch in 0..count {
        context.exec.check()?;
        let file = File { patch, count, header_line: header.line };
        let degree_v = file.degree(&mut tokens, limits)?;
        let degree_u = file.degree(&mut tokens, limits)?;
        let wanted = (degree_u as usize + 1) * (degree_v as usize + 1);
        points += wanted as u64;
        if points > limits.max_elements {
            let most = limits.max_elements;
            let found = format!("{points} control points so far");
            let fault = Fault::new("E-bpt-limit", Place::line(tokens.line()), found, format!("at most {most}"));
            return Err(fault.within(format!("patch {patch}")).category(Category::OverLimit).into());
        }
        let present = wanted.min(tokens.remaining() / BYTES_A_POINT + 1);
        // Vectors of patches double: twice the patch itself covers it.
        memory.take(1, present * size_of::<DVec3>() + 2 * size_of::<BezierPatch>())?;
        let mut control = Vec::with_capacity(present);
        for point in 0..wanted {
            control.push(file.point(&mut tokens, point, wanted)?);
        }
        let built = BezierPatch::try_new(degree_u, degree_v, control).map_err(|error| {
            Fault::new("E-bpt-patch", Place::line(tokens.line()), error.to_string(), "a Bézier patch")
        });
        patches.push(built?);
        if patch % 64 == 0 {
            context.exec.progress(1.0 - tokens.remaining() as f64 / input.len().max(1) as f64);
        }
    }
    if count == 0 {
        findings.push("W-bpt-empty", Severity::Warning, header.place(), "the file says that it has no patches");
    }
    if let Some(extra) = tokens.next_token()? {
        let message = format!(
            "found {} after the last of the {count} patches that line {} says; the rest was not read",
            quoted(extra.bytes),
            header.line
        );
        findings.push("W-bpt-trailing", Severity::Warning, extra.place(), message);
    }
    let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(BezierSurface::new(patches))) };
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}

fn patch_count(token: &Token<'_>, limits: &Limits) -> Result<u64, Box<Fault>> {
    let found = quoted(token.bytes);
    match parse_count(token.bytes) {
        Ok(count) if count <= limits.max_elements => Ok(count),
        Ok(_) => {
            let most = format!("at most {} patches", limits.max_elements);
            Err(Fault::new("E-bpt-limit", token.place(), found, most).category(Category::OverLimit))
        }
        Err(CountFault::Syntax | CountFault::Overflow) => {
            Err(Fault::new("E-bpt-count", token.place(), found, "the number of patches as a whole number"))
        }
    }
}

/// What messages say about the patch that is being read.
struct File {
    patch: u64,
    count: u64,
    header_line: u64,
}

impl File {
    fn next<'a>(&self, tokens: &mut Tokens<'a>, wanted: impl FnOnce() -> String) -> Result<Token<'a>, Box<Fault>> {
        let token = tokens.next_token()?;
        token.ok_or_else(|| {
            let (patch, count, line) = (self.patch, self.count, self.header_line);
            let found = format!("the end of the file after {patch} complete patches");
            let expected = format!("{} and {count} patches as line {line} says", wanted());
            Fault::new("E-bpt-truncated", Place::line(tokens.line()), found, expected)
                .within(format!("patch {patch}"))
                .advice(format!("the file was cut off, or line {line} should say {patch}"))
        })
    }

    fn degree(&self, tokens: &mut Tokens<'_>, limits: &Limits) -> Result<u32, Box<Fault>> {
        let token = self.next(tokens, || "two degrees".into())?;
        let most = limits.max_degree.min(MAX_DEGREE as u32);
        let fault = |code: &'static str, expected: String| {
            Fault::new(code, token.place(), quoted(token.bytes), expected).within(format!("patch {}", self.patch))
        };
        match parse_count(token.bytes) {
            Ok(degree @ 1..) if degree <= u64::from(most) => Ok(degree as u32),
            Ok(1..) | Err(CountFault::Overflow) => {
                Err(fault("E-bpt-limit", format!("a degree of at most {most}")).category(Category::OverLimit))
            }
            Ok(0) | Err(CountFault::Syntax) => {
                Err(fault("E-bpt-degree", format!("a degree as a whole number from 1 to {most}")))
            }
        }
    }

    fn point(&self, tokens: &mut Tokens<'_>, point: usize, wanted: usize) -> Result<DVec3, Box<Fault>> {
        let mut coordinates = [0.0; 3];
        for coordinate in &mut coordinates {
            let token = self.next(tokens, || format!("control point {point} of {wanted}"))?;
            *coordinate = parse_number(token.bytes).map_err(|fault| {
                let code = if fault == NumberFault::Syntax { "E-bpt-number" } else { "E-bpt-finite" };
                Fault::new(code, token.place(), quoted(token.bytes), fault.to_string())
                    .within(format!("patch {}, control point {point}", self.patch))
            })?;
        }
        Ok(DVec3::from_array(coordinates))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{format_by_id, read};
    use shapeloom_core::{Diagnostic, Exec, Surface};
    use shapeloom_shape::Geometry;
    use shapeloom_shape::Representation;

    const TEAPOT: &[u8] = include_bytes!("../../../../data/teapot.bpt");

    fn bpt(input: &[u8]) -> Result<ReadShape, ReadError> {
        read(input, format_by_id("bpt").unwrap(), &ReadContext::named("x.bpt"))
    }

    fn surface(shape: &ReadShape) -> &BezierSurface {
        BezierSurface::from_geometry(&shape.shape.parts[0].geometry).unwrap()
    }

    fn fault(input: &str) -> Box<Fault> {
        Box::new(bpt(input.as_bytes()).unwrap_err().fault().unwrap().clone())
    }

    #[test]
    fn the_teapot_has_32_bicubic_patches_that_face_outward() {
        let teapot = bpt(TEAPOT).unwrap();
        assert!(teapot.findings.is_empty() && teapot.losses.is_empty());
        assert_eq!(teapot.shape.up, Some(UpAxis::Z));
        let surface = surface(&teapot);
        assert_eq!((surface.patches.len(), surface.control_point_count()), (32, 512));
        // The rim and the body, patches 0 to 11, are a surface of revolution about z: outward is away from the axis.
        for patch in &surface.patches[4..12] {
            let (point, normal) = (patch.point(0.4, 0.6), patch.normal(0.4, 0.6).unwrap());
            assert!(normal.dot(DVec3::new(point.x, point.y, 0.0)) > 0.0);
        }
    }

    #[test]
    fn the_first_degree_runs_across_rows() {
        let net = "1\n1 2 # degrees\n0 0 0  1 0 0  2 0 0\n0 1 0\n1 1 0 2 1\n0";
        let read = bpt(net.as_bytes()).unwrap();
        let patch = &surface(&read).patches[0];
        assert_eq!((patch.degree_u(), patch.degree_v()), (2, 1));
        assert_eq!(patch.control_point(2, 1), DVec3::new(2.0, 1.0, 0.0));
    }

    #[test]
    fn counts_that_lie_name_the_line_where_the_data_ended() {
        let file = "3\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n1 1\n0 0 0\n";
        let fault = fault(file);
        assert_eq!((fault.code, &fault.place), ("E-bpt-truncated", &Place::line(8)));
        assert!(
            fault.found.contains("after 1 complete patches") && fault.expected.contains("3 patches as line 1 says")
        );
        let short = file.replacen('3', "1", 1);
        let read = bpt(short.as_bytes()).unwrap();
        assert_eq!(surface(&read).patches.len(), 1);
        let finding = read.findings.iter().next().unwrap();
        assert_eq!((finding.code, &finding.places[..]), ("W-bpt-trailing", &[Place::line(7)][..]));
    }

    #[test]
    fn counts_that_wrap_are_refused_before_anything_is_allocated() {
        let exec = Exec::default().with_memory(1 << 16);
        let context = ReadContext { exec, ..ReadContext::default() };
        for (count, code) in [
            ("4294967297", "E-bpt-limit"),
            ("4294967294", "E-bpt-truncated"),
            ("-1", "E-bpt-count"),
            ("1e3", "E-bpt-count"),
            ("99999999999999999999", "E-bpt-count"),
            ("abc", "E-bpt-count"),
            ("", "E-bpt-truncated"),
        ] {
            let error = read(count.as_bytes(), format_by_id("bpt").unwrap(), &context).unwrap_err();
            assert_eq!(error.code(), code, "{count}");
        }
        let wide = read(b"1\n255 255\n0 0 0", format_by_id("bpt").unwrap(), &context).unwrap_err();
        assert_eq!(wide.code(), "E-bpt-truncated");
    }

    #[test]
    fn degrees_and_coordinates_are_checked_where_they_stand() {
        let with = |degrees: &str, point: &str| fault(&format!("1\n{degrees}\n0 0 0\n1 0 0\n0 1 0\n{point}\n"));
        for (degrees, code) in [
            ("0 1", "E-bpt-degree"),
            ("1 -3", "E-bpt-degree"),
            ("1 1.5", "E-bpt-degree"),
            ("256 1", "E-bpt-limit"),
            ("1 99999999999999999999", "E-bpt-limit"),
        ] {
            let fault = with(degrees, "1 1 0");
            assert_eq!((fault.code, fault.place), (code, Place::line(2)), "{degrees}");
        }
        for (point, code) in [("1 abc 0", "E-bpt-number"), ("nan 1 0", "E-bpt-finite"), ("1 1 1e400", "E-bpt-finite")] {
            let fault = with("1 1", point);
            assert_eq!((fault.code, fault.place), (code, Place::line(6)), "{point}");
            assert_eq!(fault.within.as_deref(), Some("patch 0, control point 3"));
        }
        let text = ReadError::from(with("1 1", "1 abc 0")).in_input("x.bpt").to_string();
        assert_eq!(text, "x.bpt: line 6: patch 0, control point 3: found \"abc\", expected a number (E-bpt-number)");
        let empty = bpt(b"0\n").unwrap();
        assert_eq!(empty.findings.iter().next().unwrap().code, "W-bpt-empty");
    }

    #[test]
    fn damaged_teapots_never_panic_and_stay_within_the_budget() {
        let context = ReadContext { exec: Exec::default().with_memory(1 << 20), ..ReadContext::default() };
        let format = format_by_id("bpt").unwrap();
        let whole = read(TEAPOT, format, &context).unwrap();
        for end in 0..TEAPOT.len() {
            match read(&TEAPOT[..end], format, &context) {
                // The last digits of the last number may go without being missed by a reader.
                Ok(cut) => assert!(cut == whole || end + 8 > TEAPOT.len(), "{end}"),
                Err(error) => assert_eq!(error.category(), Category::Malformed, "{end}: {error}"),
            }
        }
        let mut state = 7u64;
        for _ in 0..4000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut damaged = TEAPOT.to_vec();
            damaged[(state >> 20) as usize % TEAPOT.len()] ^= 1 << (state >> 60 & 7);
            damaged[(state >> 33) as usize % TEAPOT.len()] = (state >> 8) as u8;
            if let Ok(read) = read(&damaged, format, &context) {
                let Geometry::BezierSurface(surface) = &*read.shape.parts[0].geometry else { panic!("a surface") };
                assert!(surface.control_point_count() <= damaged.len() / 6 + 1);
            }
        }
    }
}
