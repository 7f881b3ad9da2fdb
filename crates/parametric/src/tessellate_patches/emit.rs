//! Making the vertices and triangles of a planned tessellation.

use std::collections::HashMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Curve, Exec, Surface, parallel};
use shapeloom_mesh::{
    Column, Domain, MeshError, NORMAL, PATCH, TEXCOORD, TriMesh, collapsed_leave_traces, triangle_normal,
};

use super::TessellatePatches;
use super::edges::{EdgeTable, bits};
use super::layout::{Layout, Node, Piece};
use super::plan::{Demand, POLL_WORK};
use crate::bezier_patch::tangent_normal;
use crate::de_casteljau::evaluate_with_derivative;
use crate::{BezierPatch, BezierSurface, PatchSide, TessellationError};

/// A mesh, and the patches that are not what they should be.
pub(super) struct Emitted {
    pub(super) mesh: TriMesh,
    /// Patches with triangles of zero area.
    pub(super) degenerate: Vec<u32>,
    /// Patches of which a part left nothing: the bound does not hold there.
    pub(super) vanished: Vec<u32>,
}

/// Bytes while the mesh is built: positions, ids, three normals, three parameter pairs and a label a triangle, twice
/// while parts are joined.
const BYTES_A_TRIANGLE: usize = 2 * (12 + 3 * 24 + 3 * 16 + 4) + 24;

/// Refuses what 32-bit ids or the memory budget cannot hold, before anything of that size is made.
pub(super) fn check_size(table: &EdgeTable, layouts: &[Layout], exec: &Exec) -> Result<(), ConvertError> {
    let inner: u64 = layouts.iter().map(Layout::inner_count).fold(0, u64::saturating_add);
    let on_edges: u64 = table.edges.iter().map(|edge| u64::from(edge.segments)).sum();
    let triangles: u64 = layouts.iter().map(Layout::triangle_bound).fold(0, u64::saturating_add);
    let most = inner.saturating_add(on_edges).max(triangles.saturating_mul(3));
    drop(exec.reserve_elements(triangles, BYTES_A_TRIANGLE)?);
    if most >= u64::from(u32::MAX) {
        return Err(TessellationError::TooManyElements { found: most as f64 }.into());
    }
    Ok(())
}

/// The triangles of one patch.
#[derive(Default)]
struct PatchMesh {
    inner: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    parameters: Vec<[f64; 2]>,
    /// Triangles with two equal corners, which are left out.
    collapsed: Vec<[u32; 3]>,
    degenerate: bool,
    vanished: bool,
}

pub(super) fn emit(
    options: &TessellatePatches,
    source: &BezierSurface,
    table: &EdgeTable,
    demands: &[Demand],
    exec: &Exec,
) -> Result<Emitted, ConvertError> {
    let triangles: u64 = demands.iter().map(|demand| demand.layout.triangle_bound()).sum();
    let _memory = exec.reserve_elements(triangles, BYTES_A_TRIANGLE)?;
    let (vertices, mut positions) = SharedVertices::new(table);
    let mut first_inner = Vec::with_capacity(demands.len());
    let mut next = positions.len() as u32;
    for demand in demands {
        first_inner.push(next);
        next += demand.layout.inner_count() as u32;
    }
    let parts = parallel::map_chunks(exec, demands.len(), 1, |part| {
        let index = part.start;
        let job = PatchJob {
            patch: &source.patches[index],
            layout: demands[index].layout,
            table,
            index,
            vertices: &vertices,
            shared: &positions,
            first_inner: first_inner[index],
        };
        let made = job.run(options, exec)?;
        exec.progress(index as f64 / demands.len() as f64);
        Ok::<_, ConvertError>(made)
    })?;

    let total = parts.iter().map(|part| part.triangles.len()).sum();
    let mut triangles = Vec::with_capacity(total);
    let (mut normals, mut parameters) = (Vec::new(), Vec::new());
    let mut labels = Vec::with_capacity(total);
    let (mut degenerate, mut vanished) = (Vec::new(), Vec::new());
    positions.reserve_exact(next as usize - positions.len());
    for (index, part) in parts.into_iter().enumerate() {
        positions.extend(part.inner);
        labels.extend(std::iter::repeat_n(index as u32, part.triangles.len()));
        triangles.extend(part.triangles);
        normals.extend(part.normals);
        parameters.extend(part.parameters);
        if part.degenerate {
            degenerate.push(index as u32);
        }
        if part.vanished {
            vanished.push(index as u32);
        }
    }
    let mut mesh = TriMesh::try_new(positions, triangles)?;
    let mut insert = |domain, column| mesh.insert_attribute(domain, column).map_err(MeshError::from);
    if options.normals {
        insert(Domain::Wedge, Column::normals(NORMAL, &normals))?;
    }
    if options.texcoords {
        insert(Domain::Wedge, Column::texcoords(TEXCOORD, &parameters))?;
    }
    insert(Domain::Face, Column::labels(PATCH, labels))?;
    Ok(Emitted { mesh, degenerate, vanished })
}

/// The ids of the vertices on boundary curves.
struct SharedVertices {
    /// The ids of each edge's two ends.
    ends: Vec<[u32; 2]>,
    /// The id of each edge's first sample after its start.
    first: Vec<u32>,
}

impl SharedVertices {
    /// Numbers the ends of edges, equal ones once, then the samples between them edge by edge.
    fn new(table: &EdgeTable) -> (Self, Vec<DVec3>) {
        let mut positions = Vec::new();
        let mut known = HashMap::new();
        let mut corner = |point: DVec3| {
            *known.entry(bits(point)).or_insert_with(|| {
                positions.push(point);
                positions.len() as u32 - 1
            })
        };
        let ends = table
            .edges
            .iter()
            .map(|edge| {
                let control = edge.curve.control_points();
                [corner(control[0]), corner(control[control.len() - 1])]
            })
            .collect();
        let mut first = Vec::with_capacity(table.edges.len());
        for edge in &table.edges {
            first.push(positions.len() as u32);
            if !edge.collapsed {
                let steps = f64::from(edge.segments);
                positions.extend((1..edge.segments).map(|k| edge.curve.point(f64::from(k) / steps)));
            }
        }
        (Self { ends, first }, positions)
    }
}

/// All that the mesh of one patch is made from.
struct PatchJob<'a> {
    patch: &'a BezierPatch,
    layout: Layout,
    table: &'a EdgeTable,
    index: usize,
    vertices: &'a SharedVertices,
    shared: &'a [DVec3],
    first_inner: u32,
}

/// A corner of a triangle: its vertex, and where it lies on the patch.
#[derive(Clone, Copy)]
struct Corner {
    node: Node,
    vertex: u32,
    parameters: [f64; 2],
}

impl PatchJob<'_> {
    fn run(&self, options: &TessellatePatches, exec: &Exec) -> Result<PatchMesh, ConvertError> {
        let (inner, inner_normals) = self.inner(options.normals, exec)?;
        let mut side_normals = [const { Vec::new() }; 4];
        for side in PatchSide::ALL {
            side_normals[side as usize] = self.side_normals(side, options.normals, exec)?;
        }
        let mut mesh = PatchMesh { inner, ..PatchMesh::default() };
        let mut made = 0u32;
        self.layout.pieces(|piece| {
            made = made.wrapping_add(1);
            if made.is_multiple_of(1024) {
                exec.check()?;
            }
            for triangle in self.triangles(&piece, &mesh.inner) {
                self.push(triangle, options, (&inner_normals, &side_normals), &mut mesh);
            }
            Ok::<_, ConvertError>(())
        })?;
        mesh.vanished = !collapsed_leave_traces(&mesh.collapsed, &mesh.triangles);
        Ok(mesh)
    }

    /// The grid points inside the patch and, if wanted, their normals.
    fn inner(&self, normals: bool, exec: &Exec) -> Result<(Vec<DVec3>, Vec<Option<DVec3>>), ConvertError> {
        let (columns, rows) = (self.layout.columns, self.layout.rows);
        let count = self.layout.inner_count() as usize;
        let mut points = Vec::with_capacity(count);
        let mut found = Vec::with_capacity(if normals { count } else { 0 });
        let mut scratch = Vec::new();
        let mut evaluate = |row: &[DVec3], u: f64| {
            scratch.clear();
            scratch.extend_from_slice(row);
            evaluate_with_derivative(&mut scratch, u)
        };
        let size = self.patch.hull_bounds().diagonal();
        let mut work = 0;
        for j in 1..rows {
            exec.check()?;
            let v = f64::from(j) / f64::from(rows);
            let [row, slopes] = self.patch.row_with_derivative(v);
            for i in 1..columns {
                work += (row.len() + 1) * (row.len() + 1);
                if work > POLL_WORK {
                    exec.check()?;
                    work = 0;
                }
                let u = f64::from(i) / f64::from(columns);
                let [point, du] = evaluate(&row, u);
                points.push(point);
                if normals {
                    let [dv, _] = evaluate(&slopes, u);
                    found.push(tangent_normal(du, dv, size).or_else(|| self.patch.normal(u, v)));
                }
            }
        }
        Ok((points, found))
    }

    /// The normals at the samples of a side, if wanted.
    fn side_normals(&self, side: PatchSide, wanted: bool, exec: &Exec) -> Result<Vec<Option<DVec3>>, ConvertError> {
        let mut normals = Vec::new();
        if wanted {
            for k in 0..=self.layout.segments(side) {
                exec.check()?;
                let [u, v] = self.layout.parameters(Node::Side(side, k));
                normals.push(self.patch.normal(u, v));
            }
        }
        Ok(normals)
    }

    /// Cuts a piece into triangles, a cell along its shorter diagonal.
    fn triangles(&self, piece: &Piece, inner: &[DVec3]) -> impl Iterator<Item = [Corner; 3]> + use<> {
        let corner = |node: Node| Corner { node, vertex: self.vertex(node), parameters: self.layout.parameters(node) };
        let pair = match *piece {
            Piece::Triangle(nodes) => [Some(nodes.map(corner)), None],
            Piece::Cell(nodes) => {
                let [a, b, c, d] = nodes.map(corner);
                let [p, q, r, s] = [a, b, c, d].map(|corner| self.position(corner.vertex, inner));
                if p.distance_squared(r) <= q.distance_squared(s) {
                    [Some([a, b, c]), Some([a, c, d])]
                } else {
                    [Some([a, b, d]), Some([b, c, d])]
                }
            }
        };
        pair.into_iter().flatten()
    }

    fn vertex(&self, node: Node) -> u32 {
        match node {
            Node::Inner(i, j) => self.first_inner + (j - 1) * (self.layout.columns - 1) + i - 1,
            Node::Side(side, k) => {
                let place = self.table.sides[self.index][side as usize];
                let edge = place.edge as usize;
                let segments = self.layout.segments(side);
                let [start, end] = self.vertices.ends[edge];
                match place.sample(k, segments) {
                    0 => start,
                    last if last == segments => end,
                    _ if self.table.edges[edge].collapsed => start,
                    sample => self.vertices.first[edge] + sample - 1,
                }
            }
        }
    }

    fn position(&self, vertex: u32, inner: &[DVec3]) -> DVec3 {
        match vertex.checked_sub(self.first_inner) {
            Some(index) if (index as usize) < inner.len() => inner[index as usize],
            _ => self.shared[vertex as usize],
        }
    }

    fn push(
        &self,
        mut triangle: [Corner; 3],
        options: &TessellatePatches,
        (inner_normals, side_normals): (&[Option<DVec3>], &[Vec<Option<DVec3>>; 4]),
        mesh: &mut PatchMesh,
    ) {
        let ids = triangle.map(|corner| corner.vertex);
        if ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0] {
            mesh.collapsed.push(ids);
            return;
        }
        let facet = triangle_normal(ids.map(|vertex| self.position(vertex, &mesh.inner)));
        mesh.degenerate |= facet == DVec3::ZERO;
        mesh.triangles.push(ids);
        let before = triangle.map(|corner| corner.parameters);
        self.center_poles(&mut triangle);
        if options.normals {
            for (corner, before) in triangle.into_iter().zip(before) {
                let [u, v] = corner.parameters;
                let normal = match corner.node {
                    _ if corner.parameters != before => self.patch.normal(u, v),
                    Node::Inner(i, j) => inner_normals[((j - 1) * (self.layout.columns - 1) + i - 1) as usize],
                    Node::Side(side, k) => side_normals[side as usize][k as usize],
                };
                mesh.normals.push(normal.unwrap_or(facet));
            }
        }
        if options.texcoords {
            mesh.parameters.extend(triangle.map(|corner| corner.parameters));
        }
    }

    /// Every parameter along a collapsed side is the same point: a triangle's corner there takes the one in the middle
    /// of the other two, so that texture and normal are even around the pole.
    fn center_poles(&self, triangle: &mut [Corner; 3]) {
        for side in PatchSide::ALL {
            if !self.table.edges[self.table.sides[self.index][side as usize].edge as usize].collapsed {
                continue;
            }
            let (across, value, along) = match side {
                PatchSide::Bottom => (1, 0.0, 0),
                PatchSide::Top => (1, 1.0, 0),
                PatchSide::Left => (0, 0.0, 1),
                PatchSide::Right => (0, 1.0, 1),
            };
            for k in 0..3 {
                if triangle[k].parameters[across] == value {
                    let [a, b] = [triangle[(k + 1) % 3], triangle[(k + 2) % 3]];
                    triangle[k].parameters[along] = (a.parameters[along] + b.parameters[along]) / 2.0;
                }
            }
        }
    }
}
