//! Primitives as geometries.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_mesh::{Column, Domain, GeometricGraph, PointCloud, Polyline, TriMesh};
use shapeloom_shape::Geometry;

use super::accessor::{Accessor, Declared, is_matrix};
use super::allowance::Allowance;
use super::bin::{FLOAT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use super::buffers::Buffer;
use super::columns;
use super::ignored::Ignored;
use super::json::At;
use super::lines::chain;
use crate::memory::Memory;
use crate::placed::Losses;
use crate::{Fault, ReadContext, ReadError};

/// What all primitives of a document share.
pub(super) struct Primitives<'a, 'e> {
    pub document: At<'a>,
    pub buffers: &'a [Buffer<'a>],
    pub context: &'e ReadContext,
    pub memory: Memory<'e>,
    pub allowance: Allowance,
    pub findings: Findings,
    pub losses: Losses,
    pub ignored: Ignored<'a>,
}

impl<'a> Primitives<'a, '_> {
    fn open(&self, declared: Declared<'a>) -> Result<Accessor<'a>, ReadError> {
        Ok(declared.open(&self.document, self.buffers, &self.context.limits)?)
    }

    /// Reserves memory for what a value makes, if the document is large enough for it.
    pub fn take(&mut self, count: usize, size: usize, at: &At<'_>) -> Result<(), ReadError> {
        self.allowance.take(count, size, at)?;
        Ok(self.memory.take(count, size)?)
    }

    /// The geometry of a primitive, if it has one.
    pub fn read(&mut self, primitive: &At<'a>) -> Result<Option<Arc<Geometry>>, ReadError> {
        self.context.exec.check()?;
        if primitive.value.pointer("/extensions/KHR_draco_mesh_compression").is_some() {
            let fault = primitive.fault("E-gltf-feature", "Draco compression", "plain data");
            return Err(fault.category(Category::Unsupported).into());
        }
        if primitive.get("targets")?.is_some() {
            self.losses.push("morph targets", "shapes have one form: the base was read");
        }
        let mode = primitive.count_or("mode", 4)?;
        let attributes = primitive.require("attributes")?;
        let Some(position) = attributes.get("POSITION")? else {
            let message = format!("{} has no POSITION and was passed over", primitive.path);
            self.findings.push("W-gltf-position", Severity::Warning, Place::Whole, message);
            return Ok(None);
        };
        let positions = self.positions(&position)?;
        let columns = self.columns(&attributes, positions.len())?;
        let indices = self.indices(primitive, positions.len())?;
        self.context.exec.check()?;
        let vertices = Vertices { positions, columns };
        let geometry = match mode {
            0 => vertices.points(indices.as_deref(), self, primitive)?,
            1 => self.segments(primitive, vertices, indices)?,
            2 | 3 => vertices.line(indices.as_deref(), mode == 2, self, primitive)?,
            4..=6 => self.triangles(primitive, mode, vertices, indices)?,
            other => return Err(primitive.fault("E-gltf-mode", other.to_string(), "a mode from 0 to 6").into()),
        };
        Ok(Some(Arc::new(geometry)))
    }

    fn positions(&mut self, index: &At<'_>) -> Result<Vec<DVec3>, ReadError> {
        let declared = Declared::read(&self.document, index)?;
        if declared.width != 3 {
            let found = format!("{} numbers an element", declared.width);
            return Err(declared.fault(Some("type"), "E-gltf-type", found, "VEC3 for POSITION").into());
        }
        if declared.component_type != FLOAT {
            let found = format!("component type {}", declared.component_type);
            let key = Some("componentType");
            return Err(declared.fault(key, "E-gltf-type", found, "5126, single precision").into());
        }
        let accessor = self.open(declared)?;
        accessor.expect_backed()?;
        self.take(accessor.count, size_of::<DVec3>(), index)?;
        let at = |element: usize| DVec3::from_array([0, 1, 2].map(|axis| accessor.number(element, axis)));
        let positions: Vec<DVec3> = (0..accessor.count).map(at).collect();
        if !self.context.options.drop_non_finite
            && let Some(element) = positions.iter().position(|position| !position.is_finite())
        {
            let byte = accessor.byte(element).unwrap_or(0);
            let found = format!("{} as element {element}, at byte {byte} of its buffer", positions[element]);
            let mut fault = Fault::new("E-gltf-finite", accessor.place(element), found, "finite coordinates");
            fault = fault.within(accessor.path.clone()).advice(crate::audit::DROP_ADVICE);
            return Err(fault.into());
        }
        Ok(positions)
    }

    fn columns(&mut self, attributes: &At<'_>, count: usize) -> Result<Vec<Column>, ReadError> {
        let mut columns: Vec<Column> = Vec::new();
        for (semantic, index) in attributes.members()? {
            if semantic == "POSITION" {
                continue;
            }
            if !columns::is_known(semantic) && is_matrix(&self.document, &index)? {
                self.losses.column(Domain::Vertex, semantic, "columns of shapes have no place for matrices");
                continue;
            }
            let accessor = self.open(Declared::read(&self.document, &index)?)?;
            if accessor.count != count {
                let found = accessor.count.to_string();
                return Err(accessor.fault("count", "E-gltf-count", found, &format!("{count}, as of POSITION")).into());
            }
            let elements = accessor.count.saturating_mul(accessor.width);
            self.take(elements, size_of::<f64>(), &index)?;
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
        let declared = Declared::read(&self.document, &index)?;
        if !matches!(declared.component_type, UNSIGNED_BYTE | UNSIGNED_SHORT | UNSIGNED_INT) {
            let found = format!("component type {}", declared.component_type);
            return Err(declared.fault(None, "E-gltf-type", found, "an unsigned type for indices").into());
        }
        if declared.width != 1 {
            let found = format!("{} numbers an element", declared.width);
            return Err(declared.fault(Some("type"), "E-gltf-type", found, "SCALAR for indices").into());
        }
        let accessor = self.open(declared)?;
        accessor.expect_backed()?;
        // Indices, and triangles made from them.
        self.take(accessor.count, 4 * size_of::<u32>(), &index)?;
        let indices: Vec<u32> = (0..accessor.count).map(|element| accessor.index(element)).collect();
        if let Some(element) = indices.iter().position(|&index| index as usize >= vertices) {
            let expected = format!("an index below {vertices}");
            let mut fault = index.fault("E-gltf-index", format!("index {} at {element}", indices[element]), expected);
            fault.place = accessor.place(element);
            return Err(fault.into());
        }
        Ok(Some(indices))
    }

    /// The indices, or where there are none those of all vertices in order: an unindexed primitive means the same.
    fn in_order(
        &mut self,
        primitive: &At<'_>,
        indices: Option<Vec<u32>>,
        vertices: usize,
    ) -> Result<Vec<u32>, ReadError> {
        if indices.is_none() {
            self.take(vertices, 4 * size_of::<u32>(), primitive)?;
        }
        Ok(indices.unwrap_or_else(|| (0..vertices as u32).collect()))
    }

    fn left_over(&mut self, primitive: &At<'_>, what: &str) {
        let message = format!("{} has corners left over, which make no {what}", primitive.path);
        self.findings.push("W-gltf-corners", Severity::Warning, Place::Whole, message);
    }

    fn triangles(
        &mut self,
        primitive: &At<'_>,
        mode: u64,
        vertices: Vertices,
        indices: Option<Vec<u32>>,
    ) -> Result<Geometry, ReadError> {
        let indices = self.in_order(primitive, indices, vertices.positions.len())?;
        let triangles = match mode {
            5 => strip(&indices),
            6 => fan(&indices),
            _ => indices.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect(),
        };
        if (mode == 4 && !indices.len().is_multiple_of(3)) || (mode > 4 && indices.len() < 3) {
            self.left_over(primitive, "triangle");
        }
        let wrong = |error: String| primitive.fault("E-gltf-mesh", error, "a mesh");
        let mut mesh = TriMesh::try_new(vertices.positions, triangles).map_err(|error| wrong(error.to_string()))?;
        for column in vertices.columns {
            mesh.insert_attribute(Domain::Vertex, column).map_err(|error| wrong(error.to_string()))?;
        }
        Ok(mesh.into())
    }

    /// A list of segments: one line if each starts where the one before ended, else a graph.
    fn segments(
        &mut self,
        primitive: &At<'_>,
        vertices: Vertices,
        indices: Option<Vec<u32>>,
    ) -> Result<Geometry, ReadError> {
        let indices = self.in_order(primitive, indices, vertices.positions.len())?;
        if !indices.len().is_multiple_of(2) {
            self.left_over(primitive, "segment");
        }
        let segments: Vec<[u32; 2]> = indices.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect();
        if let Some((points, closed)) = chain(&segments) {
            return vertices.line(Some(&points), closed, self, primitive);
        }
        let wrong = |error: String| primitive.fault("E-gltf-mesh", error, "a graph");
        let graph = GeometricGraph::try_new(vertices.positions, segments);
        let mut graph = graph.map_err(|error| wrong(error.to_string()))?;
        for column in vertices.columns {
            graph.insert_vertex_attribute(column).map_err(|error| wrong(error.to_string()))?;
        }
        Ok(graph.into())
    }
}

/// Positions and attributes of a primitive.
struct Vertices {
    positions: Vec<DVec3>,
    columns: Vec<Column>,
}

impl Vertices {
    /// The vertices at these indices; all of them in order where there are none.
    fn gathered(
        self,
        sources: Option<&[u32]>,
        primitives: &mut Primitives<'_, '_>,
        at: &At<'_>,
    ) -> Result<Self, ReadError> {
        let count = self.positions.len();
        let Some(sources) = sources.filter(|sources| !sources.iter().copied().eq(0..count as u32)) else {
            return Ok(self);
        };
        let bytes: usize = self.columns.iter().map(Column::memory_bytes).sum::<usize>() + count * size_of::<DVec3>();
        primitives.take(sources.len(), 2 * (bytes.div_ceil(count.max(1)) + 4), at)?;
        Ok(Self {
            positions: sources.iter().map(|&source| self.positions[source as usize]).collect(),
            columns: self.columns.iter().map(|column| column.gathered(sources)).collect(),
        })
    }

    fn points(
        self,
        sources: Option<&[u32]>,
        primitives: &mut Primitives<'_, '_>,
        at: &At<'_>,
    ) -> Result<Geometry, ReadError> {
        let vertices = self.gathered(sources, primitives, at)?;
        let mut cloud = PointCloud::new(vertices.positions);
        for column in vertices.columns {
            cloud.insert_attribute(column).map_err(|error| at.fault("E-gltf-mesh", error.to_string(), "points"))?;
        }
        Ok(cloud.into())
    }

    fn line(
        self,
        sources: Option<&[u32]>,
        closed: bool,
        primitives: &mut Primitives<'_, '_>,
        at: &At<'_>,
    ) -> Result<Geometry, ReadError> {
        let vertices = self.gathered(sources, primitives, at)?;
        let mut line = Polyline::new(vertices.positions, closed);
        for column in vertices.columns {
            line.insert_attribute(column).map_err(|error| at.fault("E-gltf-mesh", error.to_string(), "a line"))?;
        }
        Ok(line.into())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_one_orientation() {
        assert_eq!(strip(&[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(fan(&[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        assert!(strip(&[0, 1]).is_empty() && fan(&[]).is_empty());
    }
}
