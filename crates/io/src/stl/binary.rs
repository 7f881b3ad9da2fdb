//! Binary STL.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Loss, Place, Severity};
use shapeloom_mesh::{Domain, TriMesh};
use shapeloom_shape::{Part, Shape};

use super::weld::Welder;
use super::write::WORDS;
use super::{COUNT, FACET, HEADER, color};
use crate::audit::degenerate_faces;
use crate::memory::{Growing, Memory};
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// How many facets are read at once, between polls.
const BLOCK: usize = 64;

fn count(input: &[u8]) -> Option<u32> {
    input.get(COUNT..HEADER).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes)
}

/// Whether the file is exactly as long as its count says.
pub(super) fn length_fits(input: &[u8]) -> bool {
    count(input).is_some_and(|count| HEADER as u64 + u64::from(count) * FACET as u64 == input.len() as u64)
}

/// What facets say apart from where they are.
#[derive(Default)]
struct Seen {
    /// All bits of their last two bytes.
    words: u16,
    /// Facets whose corners lie on one line, as far as a quick look says.
    flat: bool,
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let facets = facets(input, context, &mut findings)?;
    let exec = &context.exec;
    let memory = &mut Memory::new(exec);
    let count = facets.len() / FACET;
    let (mesh, seen) = if context.options.weld {
        let mut welder = Welder::new(memory, count)?;
        let mut triangles = Growing::with_room(memory, count)?;
        let mut numbers = [0u32; 3 * BLOCK];
        let seen = blocks(facets, context, &mut findings, |points, finite| {
            let numbers = &mut numbers[..points.len()];
            if finite {
                welder.number(memory, points, numbers)?;
            } else {
                for (point, number) in points.iter().zip(&mut *numbers) {
                    if point.is_finite() {
                        welder.number(memory, &[*point], std::slice::from_mut(number))?;
                    } else {
                        *number = welder.apart(memory, *point)?;
                    }
                }
            }
            Ok(triangles.extend(memory, numbers.as_chunks().0)?)
        })?;
        (TriMesh::try_new(welder.into_positions(), triangles.into_vec()), seen)
    } else {
        let mut positions = Growing::with_room(memory, count * 3)?;
        let seen = blocks(facets, context, &mut findings, |points, _| Ok(positions.extend(memory, points)?))?;
        memory.take(count, size_of::<[u32; 3]>())?;
        let triangles = (0..count as u32).map(|facet| [3 * facet, 3 * facet + 1, 3 * facet + 2]).collect();
        (TriMesh::try_new(positions.into_vec(), triangles), seen)
    };
    let mut mesh = mesh.map_err(|error| too_many(error.to_string()))?;
    let mut losses = Vec::new();
    let header =
        input.get(..COUNT).unwrap_or_default().split(|&byte| byte == 0).next().unwrap_or_default().trim_ascii();
    let own = header.is_empty() || header.starts_with(WORDS) || color::in_header(input);
    if !own {
        losses.push(Loss::new(format!("the header {}", quoted(header)), "shapes have no place for it"));
    }
    if (seen.words & color::OWN != 0 || color::in_header(input))
        && let Some(column) = color::column(&input[..HEADER + facets.len()], memory, &mut findings)?
    {
        mesh.insert_attribute(Domain::Face, column).map_err(|error| too_many(error.to_string()))?;
    } else if seen.words != 0 {
        losses
            .push(Loss::new("attribute words of facets", "they are no colours, and shapes have no other use for them"));
    }
    let geometry = mesh.into();
    if seen.flat {
        let place = |facet: usize| Place::Byte((HEADER + facet * FACET) as u64);
        degenerate_faces(&geometry, "W-stl-degenerate", exec, &mut findings, place)?;
    }
    Ok(ReadShape { findings, losses, ..ReadShape::new(Shape::new(Part::new(geometry))) })
}

/// The bytes of the facets, as many as the header says.
fn facets<'a>(input: &'a [u8], context: &ReadContext, findings: &mut Findings) -> Result<&'a [u8], ReadError> {
    let Some(count) = count(input) else {
        let found = format!("{} bytes", input.len());
        let expected = format!("a header of {HEADER} bytes");
        return Err(Fault::new("E-stl-truncated", Place::Byte(input.len() as u64), found, expected).into());
    };
    let there = (input.len() - HEADER) / FACET;
    if u64::from(count) > there as u64 {
        let found = format!("a count of {count} facets where the file holds {there}");
        // Data that ends early is one thing; a count of more facets than the file has bytes is no count at all.
        if u64::from(count) > input.len() as u64 {
            let fault = Fault::new("E-stl-claim", Place::Byte(COUNT as u64), found, "a count that the file can hold");
            let advice = if count.swap_bytes() as usize == there {
                "the count is right in the other byte order: write the file in little endian"
            } else {
                "the file may be no STL, or cut off near its start"
            };
            return Err(fault.advice(advice).into());
        }
        let expected = format!("{} bytes", HEADER as u64 + u64::from(count) * FACET as u64);
        let fault = Fault::new("E-stl-truncated", Place::Byte(input.len() as u64), found, expected);
        return Err(fault.advice("get the file again, or correct its count").into());
    }
    // Every facet has three corners, and corners are numbered in 32 bits.
    let most = context.limits.max_elements.min(u64::from(u32::MAX / 3) - 1);
    if u64::from(count) > most {
        let fault =
            Fault::new("E-stl-limit", Place::Byte(COUNT as u64), count.to_string(), format!("at most {most} facets"));
        return Err(fault.category(Category::OverLimit).into());
    }
    let end = HEADER + count as usize * FACET;
    if input.len() > end {
        let more = input.len() - end;
        let message = format!("{more} bytes follow after {count} facets; they were not read");
        findings.push("W-stl-trailing", Severity::Warning, Place::Byte(end as u64), message);
    }
    if count == 0 {
        findings.push(
            "W-stl-empty",
            Severity::Warning,
            Place::Byte(COUNT as u64),
            "the file says that it has no facets",
        );
    }
    Ok(&input[HEADER..end])
}

/// Calls `take` with the corners of blocks of facets, three a facet, and whether all of them are finite.
fn blocks(
    facets: &[u8],
    context: &ReadContext,
    findings: &mut Findings,
    mut take: impl FnMut(&[DVec3], bool) -> Result<(), ReadError>,
) -> Result<Seen, ReadError> {
    let (facets, _) = facets.as_chunks::<FACET>();
    let mut points = [DVec3::ZERO; 3 * BLOCK];
    let mut seen = Seen::default();
    for (index, block) in facets.chunks(BLOCK).enumerate() {
        if index % 64 == 0 {
            context.exec.check()?;
            context.exec.progress((index * BLOCK) as f64 / facets.len() as f64);
        }
        // Zero times a number is zero, or no number where that is not finite.
        let (mut corners_off, mut normals_off) = (0.0, 0.0);
        for (facet, corners) in block.iter().zip(points.as_chunks_mut::<3>().0) {
            let number = |at: usize| f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]);
            normals_off += number(0) * 0.0 + number(4) * 0.0 + number(8) * 0.0;
            for (corner, at) in corners.iter_mut().zip([12, 24, 36]) {
                let [x, y, z] = [number(at), number(at + 4), number(at + 8)];
                corners_off += x * 0.0 + y * 0.0 + z * 0.0;
                *corner = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            }
            let [a, b, c] = *corners;
            let cross = (b - a).cross(c - a);
            seen.flat |= cross.x == 0.0 && cross.y == 0.0 && cross.z == 0.0;
            seen.words |= u16::from_le_bytes([facet[FACET - 2], facet[FACET - 1]]);
        }
        let start = HEADER + index * BLOCK * FACET;
        if normals_off != 0.0 {
            odd_normals(block, start, findings);
        }
        let finite = corners_off == 0.0;
        if !finite && !context.options.drop_non_finite {
            return Err(not_finite(&points[..3 * block.len()], start).into());
        }
        take(&points[..3 * block.len()], finite)?;
    }
    Ok(seen)
}

#[cold]
fn odd_normals(block: &[[u8; FACET]], start: usize, findings: &mut Findings) {
    for (facet, bytes) in block.iter().enumerate() {
        let numbers = bytes[..12].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        if !numbers.into_iter().all(f32::is_finite) {
            let place = Place::Byte((start + facet * FACET) as u64);
            let message = "the stored normal of a facet is not finite; normals follow from the corners";
            findings.push("W-stl-normal", Severity::Warning, place, message);
        }
    }
}

/// The first of these corners that is not finite, where it is.
#[cold]
fn not_finite(points: &[DVec3], start: usize) -> Box<Fault> {
    let corner = points.iter().position(|point| !point.is_finite()).unwrap_or(0);
    let (facet, point) = (corner / 3, points[corner]);
    let at = start + facet * FACET + 12 + corner % 3 * 12;
    Fault::new(
        "E-stl-finite",
        Place::Byte(at as u64),
        format!("({}, {}, {})", point.x, point.y, point.z),
        "finite numbers",
    )
    .within(format!("facet {}, corner {}", (start - HEADER) / FACET + facet, corner % 3))
    .advice(crate::audit::DROP_ADVICE)
}

#[cold]
pub(super) fn too_many(error: String) -> Box<Fault> {
    Fault::new("E-stl-limit", Place::Whole, error, "at most 4294967294 corners of facets").category(Category::OverLimit)
}
