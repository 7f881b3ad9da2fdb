//! Writing OBJ.

use std::collections::HashMap;
use std::io::Write;

use shapeloom_core::Report;
use shapeloom_mesh::{COLOR, Column, Domain, GROUP, MATERIAL, NORMAL, SMOOTHING, TEXCOORD, Values};
use shapeloom_shape::{Geometry, Material, Part, Shape};

use super::assemble::{OBJECT, WEIGHT};
use super::{FORMAT, NO_MATERIAL, mtl};
use crate::color::srgb;
use crate::placed::{Losses, columns_of, frame_losses, placed_part, points_of};
use crate::sink::Sink;
use crate::text::{push_count, push_number};
use crate::{SiblingName, WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    let mut writer = Writer {
        sink: Sink::new(out, &context.exec),
        texcoords: Pool::default(),
        normals: Pool::default(),
        first: 1,
        state: State::default(),
        materials: material_names(&shape.materials, &mut losses),
    };
    let library = library(shape, &writer.materials, context, &mut losses);
    if let Some((name, _)) = &library {
        writer.sink.text(format_args!("mtllib {}\n", name.as_str()))?;
    }
    for (index, part) in shape.parts.iter().enumerate() {
        // The placed copy, and the pools of texture coordinates and normals.
        let _memory = context.exec.reserve(part.geometry.memory_bytes() as u64 * 4)?;
        let geometry = placed_part(FORMAT.id, index, part)?;
        writer.part(index, part, &geometry, shape.parts.len(), &mut losses)?;
        context.exec.progress((index + 1) as f64 / shape.parts.len() as f64);
    }
    let vertices = writer.first - 1;
    writer.sink.finish()?;
    if let (Some((name, text)), Some(siblings)) = (library, &context.siblings) {
        siblings.put(&name, text.into_bytes())?;
    }
    let mut report = Report::exact("write-obj", "the shortest decimal numbers that read back to the same bits");
    report.losses = losses.into_vec();
    report.figure("vertices", vertices as f64);
    Ok(report)
}

/// The library beside the output: its name and text. Without a place for it only the names of materials are kept.
fn library(
    shape: &Shape,
    names: &[String],
    context: &WriteContext,
    losses: &mut Losses,
) -> Option<(SiblingName, String)> {
    if shape.materials.is_empty() {
        return None;
    }
    let base = context.name.rsplit(['/', '\\']).next().unwrap_or_default();
    let stem = base.rsplit_once('.').map_or(base, |(stem, _)| stem);
    let name = match &context.siblings {
        Some(_) if !stem.is_empty() => SiblingName::try_new(&format!("{stem}.mtl")).ok(),
        _ => None,
    };
    let Some(name) = name else {
        for material in &shape.materials {
            let why = match &context.siblings {
                None => "an output that stands alone has no material library: only the name was written",
                Some(_) => "no library can have a name made from the output's: only the name was written",
            };
            losses.push(format!("material \"{}\"", material.name), why);
        }
        return None;
    };
    for texture in shape.materials.iter().filter_map(|material| material.texture.as_deref()) {
        if mtl::texture_name(texture).is_none() {
            losses.push(format!("texture \"{}\"", texture.escape_debug()), "a line of MTL cannot hold its name");
        }
    }
    if shape.materials.iter().any(|material| material.double_sided) {
        losses.push("which materials show both sides", "MTL has no place for it");
    }
    let named = |(material, name): (&Material, &String)| Material { name: name.clone(), ..material.clone() };
    let materials: Vec<Material> = shape.materials.iter().zip(names).map(named).collect();
    Some((name, mtl::library(&materials)))
}

/// A name for each material: what words cannot hold is replaced, and no two are the same.
fn material_names(materials: &[Material], losses: &mut Losses) -> Vec<String> {
    let mut taken: HashMap<String, usize> = HashMap::new();
    let mut names = Vec::with_capacity(materials.len());
    for (index, material) in materials.iter().enumerate() {
        let mut name = clean(&material.name);
        if name.is_empty() || name == NO_MATERIAL {
            name = format!("material_{index}");
        }
        while taken.contains_key(&name) {
            name.push_str(&format!("_{index}"));
        }
        if name != material.name {
            losses.push(
                format!("material name \"{}\"", material.name.escape_debug()),
                format!("in the file it is \"{name}\""),
            );
        }
        taken.insert(name.clone(), index);
        names.push(name);
    }
    names
}

/// A name as the words of a line hold it: without control characters, single spaces between words.
fn clean(name: &str) -> String {
    let words: Vec<&str> = name.split(|c: char| c.is_control() || c.is_whitespace()).collect();
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Tuples of numbers written so far, each with its index from 1.
#[derive(Default)]
struct Pool(HashMap<[u64; 3], u32>);

/// What the statements so far say of faces to come.
#[derive(Default, PartialEq)]
struct State {
    object: String,
    group: String,
    smoothing: u32,
    material: String,
}

struct Writer<'o> {
    sink: Sink<'o>,
    texcoords: Pool,
    normals: Pool,
    /// The index of the part's first vertex, from 1.
    first: usize,
    state: State,
    materials: Vec<String>,
}

/// The labels of a part's faces.
struct Labels<'g> {
    object: Option<&'g Column>,
    group: Option<&'g Column>,
    smoothing: Option<&'g [u32]>,
    material: Option<&'g Column>,
    /// The material of all faces that have none of their own.
    part_material: String,
}

impl Labels<'_> {
    /// Whether a face has other labels than the one before it.
    fn change(&self, face: usize) -> bool {
        let differ = |column: &&Column| column.number(face, 0) != column.number(face - 1, 0);
        [self.object, self.group, self.material].iter().flatten().any(differ)
            || self.smoothing.is_some_and(|numbers| numbers[face] != numbers[face - 1])
    }
}

impl Writer<'_> {
    fn object(&mut self, index: usize, part: &Part, parts: usize, losses: &mut Losses) -> Result<(), WriteError> {
        let name: String = part.name.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
        let name = name.trim();
        if name != part.name {
            losses.push(format!("part name \"{}\"", part.name.escape_debug()), format!("in the file it is \"{name}\""));
        }
        let name = match name {
            "" if parts < 2 => return Ok(()),
            "" => format!("part_{index}"),
            name => name.to_owned(),
        };
        self.sink.text(format_args!("o {name}\n"))?;
        self.state.object = clean(&name);
        Ok(())
    }

    fn part(
        &mut self,
        index: usize,
        part: &Part,
        geometry: &Geometry,
        parts: usize,
        losses: &mut Losses,
    ) -> Result<(), WriteError> {
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            for column in columns_of(geometry, domain).into_iter().flatten() {
                lose(geometry, domain, column, losses);
            }
        }
        let labels = self.labels(part, geometry);
        match labels.object {
            None => self.object(index, part, parts, losses)?,
            Some(_) if !part.name.is_empty() => {
                losses
                    .push(format!("part name \"{}\"", part.name.escape_debug()), "its faces have objects of their own");
            }
            Some(_) => {}
        }
        self.vertices(geometry)?;
        match geometry {
            Geometry::TriMesh(mesh) => {
                let faces = mesh.triangles().iter().map(|corners| &corners[..]);
                self.faces(geometry, mesh.triangles().as_flattened(), faces, &labels)?;
            }
            Geometry::PolyMesh(mesh) => self.faces(geometry, mesh.wedge_vertices(), mesh.faces(), &labels)?,
            Geometry::Polyline(line) if line.points().len() > 1 => {
                self.say(&labels, 0)?;
                self.sink.bytes(b"l")?;
                let closing = line.is_closed().then_some(0);
                for vertex in (0..line.points().len()).chain(closing) {
                    self.sink.block().push(b' ');
                    push_count(self.sink.block(), (self.first + vertex) as u64);
                    self.sink.spill()?;
                }
                self.sink.bytes(b"\n")?;
            }
            Geometry::GeometricGraph(graph) => {
                self.say(&labels, 0)?;
                let alone = graph.degrees().iter().filter(|&&degree| degree == 0).count();
                if alone > 0 {
                    losses
                        .push(format!("{alone} vertices without edges"), "OBJ has them, but nothing there names them");
                }
                for edge in graph.edges() {
                    let block = self.sink.block();
                    block.push(b'l');
                    for &end in edge {
                        block.push(b' ');
                        push_count(block, (self.first + end as usize) as u64);
                    }
                    block.push(b'\n');
                    self.sink.spill()?;
                }
            }
            Geometry::PointCloud(cloud) => {
                self.say(&labels, 0)?;
                for vertex in 0..cloud.positions().len() {
                    let block = self.sink.block();
                    block.extend_from_slice(b"p ");
                    push_count(block, (self.first + vertex) as u64);
                    block.push(b'\n');
                    self.sink.spill()?;
                }
            }
            _ => {}
        }
        self.first += points_of(geometry).map_or(0, <[_]>::len);
        Ok(())
    }

    fn labels<'g>(&self, part: &Part, geometry: &'g Geometry) -> Labels<'g> {
        let columns = columns_of(geometry, Domain::Face);
        let text = |name: &str| columns.and_then(|columns| columns.get(name)).filter(|column| is_text(column));
        let smoothing = columns.and_then(|columns| columns.get(SMOOTHING)).and_then(|column| match column.values() {
            Values::U32(numbers) if column.width() == 1 => Some(numbers.as_slice()),
            _ => None,
        });
        let part_material = part.material.and_then(|index| self.materials.get(index as usize));
        Labels {
            object: text(OBJECT),
            group: text(GROUP),
            smoothing,
            material: text(MATERIAL),
            part_material: part_material.cloned().unwrap_or_default(),
        }
    }

    /// Writes the statements by which an element's labels differ from what holds so far.
    fn say(&mut self, labels: &Labels<'_>, element: usize) -> Result<(), WriteError> {
        fn text(column: Option<&Column>, element: usize) -> &str {
            column.filter(|column| element < column.len()).and_then(|column| column.text(element)).unwrap_or_default()
        }
        let object = clean(text(labels.object, element));
        if labels.object.is_some() && object != self.state.object {
            self.sink.text(format_args!("o {object}\n"))?;
            self.state.object = object;
        }
        let group = clean(text(labels.group, element));
        if group != self.state.group {
            self.sink.text(format_args!("g{}{group}\n", if group.is_empty() { "" } else { " " }))?;
            self.state.group = group;
        }
        let smoothing = labels.smoothing.and_then(|numbers| numbers.get(element)).copied().unwrap_or(0);
        if smoothing != self.state.smoothing {
            self.sink.text(format_args!("s {smoothing}\n"))?;
            self.state.smoothing = smoothing;
        }
        let material = match labels.material {
            Some(column) => clean(text(Some(column), element)),
            None => labels.part_material.clone(),
        };
        if material != self.state.material {
            let name = if material.is_empty() { NO_MATERIAL } else { &material };
            self.sink.text(format_args!("usemtl {name}\n"))?;
            self.state.material = material;
        }
        Ok(())
    }

    fn vertices(&mut self, geometry: &Geometry) -> Result<(), WriteError> {
        let columns = columns_of(geometry, Domain::Vertex);
        let colors = columns.and_then(|columns| columns.get(COLOR)).filter(|column| is_color(column));
        let weights = floating(geometry, Domain::Vertex, WEIGHT, 1).filter(|_| colors.is_none());
        for (index, point) in points_of(geometry).unwrap_or(&[]).iter().enumerate() {
            let block = self.sink.block();
            block.push(b'v');
            for number in point.to_array() {
                block.push(b' ');
                push_number(block, number);
            }
            if let Some(colors) = colors {
                for component in 0..colors.width() {
                    block.push(b' ');
                    push_number(block, fraction(colors, index, component));
                }
            }
            if let Some(weights) = weights {
                block.push(b' ');
                push_number(block, weights.number(index, 0));
            }
            block.push(b'\n');
            self.sink.spill()?;
        }
        Ok(())
    }

    fn faces<'f>(
        &mut self,
        geometry: &Geometry,
        corners: &[u32],
        faces: impl Iterator<Item = &'f [u32]>,
        labels: &Labels<'_>,
    ) -> Result<(), WriteError> {
        let sink = &mut self.sink;
        let vt = indices(
            "vt",
            [Domain::Vertex, Domain::Wedge].map(|domain| floating(geometry, domain, TEXCOORD, 2)),
            corners,
            &mut self.texcoords,
            sink,
        )?;
        let vn = indices(
            "vn",
            [Domain::Vertex, Domain::Wedge].map(|domain| floating(geometry, domain, NORMAL, 3)),
            corners,
            &mut self.normals,
            sink,
        )?;
        let mut at = 0;
        for (index, face) in faces.enumerate() {
            if index == 0 || labels.change(index) {
                self.say(labels, index)?;
            }
            let block = self.sink.block();
            block.push(b'f');
            for &corner in face {
                block.push(b' ');
                push_count(block, (self.first + corner as usize) as u64);
                match (vt.get(at), vn.get(at)) {
                    (None, None) => {}
                    (Some(&vt), None) => {
                        block.push(b'/');
                        push_count(block, u64::from(vt));
                    }
                    (None, Some(&vn)) => {
                        block.extend_from_slice(b"//");
                        push_count(block, u64::from(vn));
                    }
                    (Some(&vt), Some(&vn)) => {
                        block.push(b'/');
                        push_count(block, u64::from(vt));
                        block.push(b'/');
                        push_count(block, u64::from(vn));
                    }
                }
                at += 1;
            }
            block.push(b'\n');
            self.sink.spill()?;
        }
        Ok(())
    }
}

/// The index of each corner's tuple, from 1; new tuples are written as they are met. Of the two columns, that of
/// vertices and that of corners, the latter comes first.
fn indices(
    word: &str,
    [vertex, wedge]: [Option<&Column>; 2],
    corners: &[u32],
    pool: &mut Pool,
    sink: &mut Sink<'_>,
) -> Result<Vec<u32>, WriteError> {
    let Some(column) = wedge.or(vertex) else {
        return Ok(Vec::new());
    };
    let mut known_of_vertex = vec![0u32; if wedge.is_none() { column.len() } else { 0 }];
    let mut found = Vec::with_capacity(corners.len());
    for (index, &corner) in corners.iter().enumerate() {
        let element = if wedge.is_some() { index } else { corner as usize };
        if let Some(&known @ 1..) = known_of_vertex.get(element) {
            found.push(known);
            continue;
        }
        let mut bits = [0; 3];
        for (component, slot) in bits.iter_mut().enumerate().take(column.width()) {
            *slot = column.number(element, component).to_bits();
        }
        let next = pool.0.len() as u32 + 1;
        let known = *pool.0.entry(bits).or_insert(next);
        if known == next {
            let block = sink.block();
            block.extend_from_slice(word.as_bytes());
            for &number in &bits[..column.width()] {
                block.push(b' ');
                push_number(block, f64::from_bits(number));
            }
            block.push(b'\n');
            sink.spill()?;
        }
        if let Some(slot) = known_of_vertex.get_mut(element) {
            *slot = known;
        }
        found.push(known);
    }
    Ok(found)
}

/// A column of finite floating numbers of that name and width.
fn floating<'g>(geometry: &'g Geometry, domain: Domain, name: &str, width: usize) -> Option<&'g Column> {
    let column = columns_of(geometry, domain)?.get(name)?;
    let floating = match column.values() {
        Values::F32(values) => values.iter().all(|value| value.is_finite()),
        Values::F64(values) => values.iter().all(|value| value.is_finite()),
        _ => false,
    };
    (floating && column.width() == width).then_some(column)
}

fn is_text(column: &Column) -> bool {
    matches!(column.values(), Values::Text { .. })
}

fn is_color(column: &Column) -> bool {
    let known = matches!(column.values(), Values::F32(_) | Values::F64(_) | Values::U8(_) | Values::U16(_));
    known && (3..=4).contains(&column.width())
}

/// A colour as fraction in sRGB, in six digits: more than bytes have. An alpha is no intensity and stays as it is.
fn fraction(column: &Column, element: usize, component: usize) -> f64 {
    let number = column.number(element, component);
    let fraction = match column.values() {
        Values::U8(_) => number / f64::from(u8::MAX),
        Values::U16(_) => number / f64::from(u16::MAX),
        // NaN becomes 0.
        _ if component == 3 => number.clamp(0.0, 1.0).max(0.0),
        _ => srgb(number.clamp(0.0, 1.0).max(0.0)),
    };
    (fraction * 1e6).round() / 1e6
}

/// Says what of a column is not written.
fn lose(geometry: &Geometry, domain: Domain, column: &Column, losses: &mut Losses) {
    let name = column.name();
    let has_faces = matches!(geometry, Geometry::TriMesh(_) | Geometry::PolyMesh(_));
    let width = if name == NORMAL { 3 } else { 2 };
    match (name, domain) {
        (COLOR, Domain::Vertex) if is_color(column) => {
            if matches!(column.values(), Values::F32(_) | Values::F64(_) | Values::U16(_)) {
                losses.column(domain, name, "colours were written as sRGB in six digits");
            }
        }
        (NORMAL | TEXCOORD, Domain::Vertex | Domain::Wedge) if has_faces => {
            if floating(geometry, domain, name, width).is_none() {
                losses.column(domain, name, format!("OBJ takes {width} finite floating numbers"));
            } else if domain == Domain::Vertex && floating(geometry, Domain::Wedge, name, width).is_some() {
                losses.column(domain, name, "the wedge attribute of that name was written");
            }
        }
        (WEIGHT, Domain::Vertex) if floating(geometry, domain, name, 1).is_some() => {
            let colors = columns_of(geometry, domain).and_then(|columns| columns.get(COLOR));
            if colors.is_some_and(is_color) {
                losses.column(domain, name, "a vertex with a colour has no place for it");
            }
        }
        (GROUP | MATERIAL | OBJECT, Domain::Face) if is_text(column) => {
            let Values::Text { names, .. } = column.values() else { return };
            if names.iter().any(|name| clean(name) != *name) {
                losses.column(domain, name, "names were written without control characters and repeated spaces");
            }
        }
        (SMOOTHING, Domain::Face) if matches!(column.values(), Values::U32(_)) && column.width() == 1 => {}
        (NORMAL | TEXCOORD, Domain::Vertex) => {
            losses.column(domain, name, "lines and points of OBJ have none");
        }
        _ => losses.column(domain, name, "OBJ has no place for it"),
    }
}
