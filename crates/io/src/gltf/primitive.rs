//! Primitives as geometries.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_mesh::{Column, Domain, PointCloud, Polyline, TriMesh};
use shapeloom_shape::Geometry;

use super::accessor::Accessor;
use super::bin::{UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use super::buffers::Buffer;
use super::columns;
use super::json::At;
use crate::memory::Memory;
use crate::placed::Losses;
use crate::{ReadContext, ReadError};

/// What all primitives of a document share.
pub(super) struct Primitives<'a, 'e> {
    pub document: At<'a>,
    pub buffers: &'a [Buffer<'a>],
    pub context: &'e ReadContext,
    pub memory: Memory<'e>,
    pub findings: Findings,
    pub losses: Losses,
}

impl Primitives<'_, '_> {
    fn accessor(&self, index: &At<'_>) -> Result<Accessor<'_>, ReadError> {
        Ok(Accessor::open(&self.document, index, self.buffers, &self.context.limits)?)
    }

    /// The geometries of a primitive: one, or as many as there are runs in a list of lines, or none.
    pub fn read(&mut self, primitive: &At<'_>) -> Result<Vec<Arc<Geometry>>, ReadError> {
        self.context.exec.check()?;
        if primitive.value.pointer("/extensions/KHR_draco_mesh_compression").is_some() {
            let fault = primitive.fault("E-gltf-feature", "Draco compression", "plain data");
            return Err(fault.category(shapeloom_core::Category::Unsupported).into());
        }
        if primitive.get("targets")?.is_some() {
            self.losses.push("morph targets", "shapes have one form: the base was read");
        }
        let mode = primitive.count_or("mode", 4)?;
        let attributes = primitive.require("attributes")?;
        let Some(position) = attributes.get("POSITION")? else {
            let message = format!("{} has no POSITION and was passed over", primitive.path);
            self.findings.push("W-gltf-position", Severity::Warning, Place::Whole, message);
            return Ok(Vec::new());
        };
        let position = self.accessor(&position)?;
        if position.width != 3 {
            let found = format!("{} numbers an element", position.width);
            return Err(position.fault("type", "E-gltf-type", found, "VEC3 for POSITION").into());
        }
        if !position.is_float() {
            let found = format!("component type {}", position.component_type);
            return Err(position.fault("componentType", "E-gltf-type", found, "5126, single precision").into());
        }
        // Vectors that grow by collecting take at most this much.
        self.memory.take(position.count, size_of::<DVec3>())?;
        let position = self.accessor(&attributes.require("POSITION")?)?;
        let at = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| position.number(i, axis)));
        let positions: Vec<DVec3> = (0..position.count).map(at).collect();
        if let Some(index) = positions.iter().position(|position| !position.is_finite()) {
            let (place, path) = (position.place(index), position.path.clone());
            let message = format!("{path} holds positions that are not finite; they were kept");
            self.findings.push("W-gltf-finite", Severity::Warning, place, message);
        }
        let columns = self.columns(&attributes, positions.len())?;
        let indices = self.indices(primitive, positions.len())?;
        self.context.exec.check()?;
        self.assemble(primitive, mode, positions, columns, indices)
    }

    fn columns(&mut self, attributes: &At<'_>, count: usize) -> Result<Vec<Column>, ReadError> {
        let mut columns: Vec<Column> = Vec::new();
        for (semantic, index) in attributes.members()? {
            if semantic == "POSITION" {
                continue;
            }
            let accessor = self.accessor(&index)?;
            if accessor.count != count {
                let found = accessor.count.to_string();
                return Err(accessor.fault("count", "E-gltf-count", found, &format!("{count}, as of POSITION")).into());
            }
            let elements = accessor.count.saturating_mul(accessor.width);
            self.memory.take(elements, size_of::<f64>())?;
            let accessor = self.accessor(&index)?;
            match columns::column(semantic, &accessor)? {
                Ok(column) if columns.iter().all(|known| known.name() != column.name()) => columns.push(column),
                Ok(_) => self.losses.column(Domain::Vertex, semantic, "another attribute has that name in shapes"),
                Err(why) => self.losses.column(Domain::Vertex, semantic, why),
            }
        }
        Ok(columns)
    }

    fn indices(&mut self, primitive: &At<'_>, vertices: usize) -> Result<Option<Vec<u32>>, ReadError> {
        let Some(index) = primitive.get("indices")? else {
            return Ok(None);
        };
        let accessor = self.accessor(&index)?;
        if !matches!(accessor.component_type, UNSIGNED_BYTE | UNSIGNED_SHORT | UNSIGNED_INT) {
            let found = format!("component type {}", accessor.component_type);
            return Err(accessor.fault("componentType", "E-gltf-type", found, "an unsigned type for indices").into());
        }
        if accessor.width != 1 {
            let found = format!("{} numbers an element", accessor.width);
            return Err(accessor.fault("type", "E-gltf-type", found, "SCALAR for indices").into());
        }
        // Indices, and triangles made from them.
        self.memory.take(accessor.count, 4 * size_of::<u32>())?;
        let accessor = self.accessor(&index)?;
        let indices: Vec<u32> = (0..accessor.count).map(|element| accessor.index(element)).collect();
        if let Some(element) = indices.iter().position(|&index| index as usize >= vertices) {
            let expected = format!("an index below {vertices}");
            let mut fault = index.fault("E-gltf-index", format!("index {} at {element}", indices[element]), expected);
            fault.place = accessor.place(element);
            return Err(fault.into());
        }
        Ok(Some(indices))
    }

    fn assemble(
        &mut self,
        primitive: &At<'_>,
        mode: u64,
        positions: Vec<DVec3>,
        columns: Vec<Column>,
        indices: Option<Vec<u32>>,
    ) -> Result<Vec<Arc<Geometry>>, ReadError> {
        if mode >= 4 {
            // An unindexed primitive is as if it were indexed in order.
            if indices.is_none() {
                self.memory.take(positions.len(), 4 * size_of::<u32>())?;
            }
            let indices = indices.unwrap_or_else(|| (0..positions.len() as u32).collect());
            let triangles = match mode {
                4 => indices.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect(),
                5 => strip(&indices),
                6 => fan(&indices),
                other => return Err(primitive.fault("E-gltf-mode", other.to_string(), "a mode from 0 to 6").into()),
            };
            if (mode == 4 && !indices.len().is_multiple_of(3)) || (mode > 4 && indices.len() < 3) {
                let message = format!("{} has corners left over, which make no triangle", primitive.path);
                self.findings.push("W-gltf-corners", Severity::Warning, Place::Whole, message);
            }
            let wrong = |error: String| primitive.fault("E-gltf-mesh", error, "a mesh");
            let mut mesh = TriMesh::try_new(positions, triangles).map_err(|error| wrong(error.to_string()))?;
            for column in columns {
                mesh.insert_attribute(Domain::Vertex, column).map_err(|error| wrong(error.to_string()))?;
            }
            return Ok(vec![Arc::new(Geometry::TriMesh(mesh))]);
        }
        let vertices = positions.len();
        let gather = |sources: Option<&[u32]>| {
            let sources = sources.filter(|sources| !sources.iter().copied().eq(0..vertices as u32));
            match sources {
                None => (positions.clone(), columns.clone()),
                Some(sources) => {
                    let points = sources.iter().map(|&source| positions[source as usize]).collect();
                    (points, columns.iter().map(|column| column.gathered(sources)).collect())
                }
            }
        };
        let bytes: usize = columns.iter().map(Column::memory_bytes).sum::<usize>() + positions.len() * 24;
        let each = bytes.div_ceil(vertices.max(1)) + 4;
        self.memory.take(indices.as_ref().map_or(vertices, Vec::len), 2 * each)?;
        let wrong = |error: String| primitive.fault("E-gltf-mesh", error, "points and lines");
        let line = |sources: Option<&[u32]>, closed: bool| {
            let (points, columns) = gather(sources);
            let mut line = Polyline::new(points, closed);
            for column in columns {
                line.insert_attribute(column).map_err(|error| wrong(error.to_string()))?;
            }
            Ok::<_, ReadError>(Arc::new(Geometry::Polyline(line)))
        };
        match mode {
            0 => {
                let (points, columns) = gather(indices.as_deref());
                let mut cloud = PointCloud::new(points);
                for column in columns {
                    cloud.insert_attribute(column).map_err(|error| wrong(error.to_string()))?;
                }
                Ok(vec![Arc::new(Geometry::PointCloud(cloud))])
            }
            1 => {
                let indices = indices.unwrap_or_else(|| (0..vertices as u32).collect());
                let runs = runs(&indices);
                self.memory.take(runs.len(), size_of::<Polyline>() + 64)?;
                runs.iter().map(|run| line(Some(run), false)).collect()
            }
            mode => Ok(vec![line(indices.as_deref(), mode == 2)?]),
        }
    }
}

/// Every second triangle of a strip lists its first two corners the other way round.
fn strip(indices: &[u32]) -> Vec<[u32; 3]> {
    let turned = |(i, corner): (usize, &[u32])| {
        if i % 2 == 0 { [corner[0], corner[1], corner[2]] } else { [corner[1], corner[0], corner[2]] }
    };
    indices.windows(3).enumerate().map(turned).collect()
}

fn fan(indices: &[u32]) -> Vec<[u32; 3]> {
    let Some((&hub, rim)) = indices.split_first() else {
        return Vec::new();
    };
    rim.windows(2).map(|pair| [pair[0], pair[1], hub]).collect()
}

/// Segments in a row that meet, joined.
fn runs(indices: &[u32]) -> Vec<Vec<u32>> {
    let mut runs: Vec<Vec<u32>> = Vec::new();
    for segment in indices.chunks_exact(2) {
        match runs.last_mut() {
            Some(run) if run.last() == Some(&segment[0]) => run.push(segment[1]),
            _ => runs.push(segment.to_vec()),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_one_orientation() {
        assert_eq!(strip(&[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(fan(&[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        assert!(strip(&[0, 1]).is_empty() && fan(&[]).is_empty());
    }

    #[test]
    fn segments_that_meet_become_one_line() {
        assert_eq!(runs(&[0, 1, 1, 2, 4, 5, 6]), [vec![0, 1, 2], vec![4, 5]]);
    }
}
