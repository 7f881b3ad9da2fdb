//! Edges on the vertices of faces.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{Column, Domain};
use shapeloom_shape::Geometry;

use crate::placed::{columns_of, points_of};

/// For each part the numbers of vertices of other parts, in the file, that serve as its own; none for parts that bring
/// their own. A graph needs none where a mesh before it has a vertex for each of its own: at the same position to the
/// bit, with the same values in all columns that the graph has. Reading gives such graphs copies of those vertices.
pub(super) fn shared_vertices(parts: &[Arc<Geometry>]) -> Vec<Option<Vec<u32>>> {
    let mut shared: Vec<Option<Vec<u32>>> = vec![None; parts.len()];
    let graphs = || parts.iter().any(|part| matches!(**part, Geometry::GeometricGraph(_)));
    let mesh = parts.iter().position(|part| matches!(**part, Geometry::TriMesh(_) | Geometry::PolyMesh(_)));
    let Some(host) = mesh.filter(|_| graphs()) else {
        return shared;
    };
    let points = |part: &Geometry| points_of(part).map_or(0, <[_]>::len);
    let first: usize = parts[..host].iter().map(|part| points(part)).sum();
    let bits = |point: &DVec3| point.to_array().map(f64::to_bits);
    let mut at: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    for (vertex, point) in points_of(&parts[host]).unwrap_or(&[]).iter().enumerate() {
        at.entry(bits(point)).or_default().push(vertex as u32);
    }
    for (index, part) in parts.iter().enumerate().skip(host + 1) {
        let Geometry::GeometricGraph(graph) = &**part else { continue };
        let columns = graph.vertex_attributes();
        let hosts = columns_of(&parts[host], Domain::Vertex);
        let pairs: Option<Vec<(&Column, &Column)>> =
            columns.iter().map(|column| Some((column, hosts?.get(column.name())?))).collect();
        let Some(pairs) = pairs.filter(|_| columns.lists().is_empty()) else { continue };
        let mut taken = HashSet::new();
        let own = graph.positions().iter().enumerate().map(|(vertex, point)| {
            let same = |&&other: &&u32| {
                !taken.contains(&other) && pairs.iter().all(|(own, host)| equal(own, vertex, host, other as usize))
            };
            let found = *at.get(&bits(point))?.iter().find(same)?;
            taken.insert(found);
            Some(first as u32 + found)
        });
        shared[index] = own.collect();
    }
    shared
}

fn equal(a: &Column, i: usize, b: &Column, j: usize) -> bool {
    let alike = a.width() == b.width() && a.values().type_name() == b.values().type_name();
    alike && a.text(i) == b.text(j) && {
        let same = |k: usize| a.text(i).is_some() || a.number(i, k).to_bits() == b.number(j, k).to_bits();
        (0..a.width()).all(same)
    }
}
