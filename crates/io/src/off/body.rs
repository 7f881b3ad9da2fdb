//! What a file holds, on its way to a shape.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_mesh::{Column, Domain, NORMAL, TEXCOORD, TriMesh};
use shapeloom_shape::{Part, Shape};

use super::color::{FaceColors, Seen, WHITE, column};
use super::counts::Counts;
use super::header::Header;
use super::{COLORMAP, NO_INDEX};
use crate::audit::degenerate_faces;
use crate::faces::Faces;
use crate::memory::{Growing, Memory};
use crate::placed::insert_column;
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// The numbers of a vertex, in their order in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Coordinates.
    pub dimension: usize,
    /// Whether a weight follows.
    pub weight: bool,
    /// Whether three numbers of a normal follow.
    pub normal: bool,
    /// How many numbers of a colour follow: none, three or four.
    pub color: usize,
    /// Whether two texture coordinates follow.
    pub texcoord: bool,
}

impl Layout {
    pub(super) fn new(header: &Header, dimension: usize, color: usize) -> Self {
        Self { dimension, weight: header.weight, normal: header.normal, color, texcoord: header.texcoord }
    }

    /// How many numbers a vertex has.
    pub(super) fn numbers(&self) -> usize {
        self.dimension + usize::from(self.weight) + self.beside()
    }

    /// How many of them are not of its position.
    pub(super) fn beside(&self) -> usize {
        3 * usize::from(self.normal) + self.color + 2 * usize::from(self.texcoord)
    }

    /// Where the colour is among those.
    pub(super) fn color_at(&self) -> usize {
        3 * usize::from(self.normal)
    }

    /// What a vertex is made of, for a message.
    pub(super) fn words(&self) -> String {
        let mut words = ["x", "x y", "x y z"][self.dimension.clamp(1, 3) - 1].to_owned();
        for (there, word) in
            [(self.weight, " w"), (self.normal, ", normal"), (self.color > 0, ", color"), (self.texcoord, ", s t")]
        {
            words.push_str(if there { word } else { "" });
        }
        words
    }
}

/// Vertices and faces in the order of the file.
#[derive(Debug, Default)]
pub(super) struct Body {
    pub positions: Growing<DVec3>,
    /// The numbers of each vertex beside its position.
    pub beside: Growing<f64>,
    pub vertex_colors: Seen,
    pub faces: Faces,
    pub face_colors: FaceColors,
    /// Indices into a colour map, from the first face that has one.
    indices: Growing<u32>,
    /// For each face that was left out, how many were kept before it.
    pub skipped: Growing<u32>,
    pub findings: Findings,
}

impl Body {
    /// Room for what counts promise, when it is known to be there; what is here already stays.
    pub(super) fn reserve(
        &mut self,
        memory: &mut Memory<'_>,
        counts: &Counts,
        layout: &Layout,
    ) -> Result<(), ReadError> {
        let (vertices, faces) = (counts.vertices as usize, counts.faces as usize);
        self.positions.reserve(memory, vertices)?;
        self.beside.reserve(memory, vertices * layout.beside())?;
        Ok(self.faces.reserve_triangles(memory, faces)?)
    }

    /// An index into a colour map, of the next face.
    pub(super) fn put_index(&mut self, memory: &mut Memory<'_>, index: u32) -> Result<(), ReadError> {
        self.fill_indices(memory, self.faces.len())?;
        Ok(self.indices.push(memory, index)?)
    }

    fn fill_indices(&mut self, memory: &mut Memory<'_>, faces: usize) -> Result<(), ReadError> {
        while self.indices.len() < faces {
            self.indices.push(memory, NO_INDEX)?;
        }
        Ok(())
    }

    /// A face that is left out because it has no area by its number of corners.
    pub(super) fn skip(&mut self, memory: &mut Memory<'_>, place: Place, corners: u64) -> Result<(), ReadError> {
        self.skipped.push(memory, self.faces.len() as u32)?;
        let message = format!("a face of {corners} corners was left out");
        self.findings.push("W-off-skipped", Severity::Warning, place, message);
        Ok(())
    }

    /// A normal, or texture coordinates, that are not finite.
    #[cold]
    pub(super) fn odd_numbers(&mut self, place: Place) {
        let message = "a normal or texture coordinate that is not finite was kept as it is";
        self.findings.push("W-off-finite", Severity::Warning, place, message);
    }

    /// A colour that is not finite.
    #[cold]
    pub(super) fn odd_color(&mut self, place: Place) {
        let message = "a colour that is not finite was taken as none";
        self.findings.push("W-off-color", Severity::Warning, place, message);
    }

    /// Adds what follows after this.
    pub(super) fn append(&mut self, memory: &mut Memory<'_>, other: Self) -> Result<(), ReadError> {
        let faces = self.faces.len();
        self.positions.extend(memory, other.positions.as_slice())?;
        self.beside.extend(memory, other.beside.as_slice())?;
        self.vertex_colors.join(other.vertex_colors);
        self.face_colors.append(memory, faces, &other.face_colors)?;
        if !other.indices.is_empty() {
            self.fill_indices(memory, faces)?;
            self.indices.extend(memory, other.indices.as_slice())?;
        }
        for &before in other.skipped.as_slice() {
            self.skipped.push(memory, faces as u32 + before)?;
        }
        self.faces.append(memory, other.faces)?;
        self.findings.extend(other.findings);
        Ok(())
    }

    /// The shape; `place` says where the face of that number, counted with those left out, is in the file.
    pub(super) fn into_shape(
        mut self,
        layout: &Layout,
        memory: &mut Memory<'_>,
        context: &ReadContext,
        place: impl Fn(usize) -> Place,
    ) -> Result<ReadShape, ReadError> {
        let faces = self.faces.len();
        let mut columns = self.vertex_columns(layout, memory)?;
        if let Some(colors) = self.face_colors.column(memory, faces)? {
            self.note_face_colors(faces);
            columns.push((Domain::Face, colors));
        }
        if !self.indices.is_empty() {
            self.fill_indices(memory, faces)?;
            columns.push((Domain::Face, Column::labels(COLORMAP, self.indices.into_vec())));
        }
        let positions = self.positions.into_vec();
        if positions.is_empty() {
            let message = "the file has no vertices; the mesh is empty";
            self.findings.push("W-off-empty", Severity::Warning, Place::Whole, message);
        }
        let mut geometry = match self.faces.is_empty() {
            true if positions.is_empty() => TriMesh::default().into(),
            true => shapeloom_mesh::PointCloud::new(positions).into(),
            false => self.faces.into_geometry(positions).map_err(|error| inconsistent(error.to_string()))?,
        };
        for (domain, column) in columns {
            insert_column(&mut geometry, domain, column).map_err(|error| inconsistent(error.to_string()))?;
        }
        let skipped = self.skipped.into_vec();
        let place = |face: usize| place(face + skipped.partition_point(|&before| before as usize <= face));
        degenerate_faces(&geometry, "W-off-degenerate", &context.exec, &mut self.findings, place)?;
        Ok(ReadShape { findings: self.findings, ..ReadShape::new(Shape::new(Part::new(geometry))) })
    }

    fn vertex_columns(&mut self, layout: &Layout, memory: &mut Memory<'_>) -> Result<Vec<(Domain, Column)>, ReadError> {
        let mut columns = Vec::new();
        let beside = layout.beside();
        if beside == 0 || self.positions.is_empty() {
            return Ok(columns);
        }
        let vertices = || self.beside.as_slice().chunks_exact(beside);
        let count = self.positions.len();
        if layout.normal {
            // Once as vectors and once in the column.
            memory.take(count, 2 * size_of::<DVec3>())?;
            let normals: Vec<DVec3> = vertices().map(|row| DVec3::new(row[0], row[1], row[2])).collect();
            columns.push((Domain::Vertex, Column::normals(NORMAL, &normals)));
        }
        if layout.color > 0 && self.vertex_colors.any {
            let at = layout.color_at();
            let colors = vertices().map(|row| &row[at..at + layout.color]);
            columns.extend(
                column(colors, self.vertex_colors, false, WHITE, memory)?.map(|column| (Domain::Vertex, column)),
            );
            let seen = self.vertex_colors;
            if !seen.fractions && !seen.bytes {
                let message = "colours of vertices in whole numbers of which none is above 1 were taken as fractions";
                self.findings.push("W-off-fractions", Severity::Note, Place::Whole, message);
            }
            self.note_bright(seen);
        }
        if layout.texcoord {
            memory.take(count, 2 * size_of::<[f64; 2]>())?;
            let rows = self.beside.as_slice().chunks_exact(beside);
            let coordinates: Vec<[f64; 2]> = rows.map(|row| [row[beside - 2], row[beside - 1]]).collect();
            columns.push((Domain::Vertex, Column::texcoords(TEXCOORD, &coordinates)));
        }
        Ok(columns)
    }

    fn note_face_colors(&mut self, faces: usize) {
        let seen = self.face_colors.seen;
        if self.face_colors.count < faces {
            let message = "faces without a colour among others that have one were taken as grey";
            let without = (faces - self.face_colors.count) as u64;
            self.findings.push_many("W-off-grey", Severity::Note, Place::Whole, message, without);
        }
        if !seen.fractions && !seen.bytes {
            let message = "colours of faces in whole numbers are bytes, and all of these are nearly black; fractions have \
                           a decimal point";
            self.findings.push("W-off-dark", Severity::Note, Place::Whole, message);
        }
        self.note_bright(seen);
    }

    fn note_bright(&mut self, seen: Seen) {
        if seen.bright {
            let message = "fractions of colours above 1 were kept as they are";
            self.findings.push("W-off-bright", Severity::Note, Place::Whole, message);
        }
        if seen.fractions && seen.bytes {
            let message = "colours in bytes among others in fractions became fractions of 255";
            self.findings.push("W-off-mixed", Severity::Note, Place::Whole, message);
        }
    }
}

#[cold]
fn inconsistent(error: String) -> Box<Fault> {
    Fault::new("E-off-limit", Place::Whole, error, "a mesh of fewer elements").category(Category::OverLimit)
}
