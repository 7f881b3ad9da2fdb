//! What readers look for in every mesh: faces without area, positions that are not finite.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{CHUNK, map_chunks};
use shapeloom_core::{Exec, Findings, Place, Severity, Stop};
use shapeloom_mesh::{GeometricGraph, PointCloud};
use shapeloom_shape::{Geometry, Shape};

use crate::cut::cut;
use crate::{Fault, ReadError};

/// What to do about positions that are not finite.
pub(crate) const DROP_ADVICE: &str =
    "repair the file, or leave such vertices out with the option drop_non_finite (--drop-non-finite)";

/// Remarks on the faces of a mesh that name a vertex twice or whose corners lie on one line; `place` says where in the
/// input a face is. Cost: one pass over the faces, parallel.
pub(crate) fn degenerate_faces(
    geometry: &Geometry,
    code: &'static str,
    exec: &Exec,
    findings: &mut Findings,
    place: impl Fn(usize) -> Place,
) -> Result<(), Stop> {
    let (count, first) = match geometry {
        Geometry::TriMesh(mesh) => {
            let (positions, triangles) = (mesh.positions(), mesh.triangles());
            find(exec, triangles.len(), |face| {
                let corners = triangles[face];
                let [a, b, c] = corners.map(|corner| positions[corner as usize]);
                // By far the most faces are triangles with an area.
                let cross = (b - a).cross(c - a);
                let has_area = (cross.x != 0.0) | (cross.y != 0.0) | (cross.z != 0.0);
                !has_area && (repeats(&corners) || on_one_line(&[a, b, c]))
            })?
        }
        Geometry::PolyMesh(mesh) => find(exec, mesh.face_count(), |face| {
            let corners = mesh.face(face);
            repeats(corners) || {
                let outline: Vec<DVec3> = mesh.outline(face).collect();
                on_one_line(&outline)
            }
        })?,
        _ => return Ok(()),
    };
    for (rank, face) in first.into_iter().enumerate() {
        let message = format!("face {face} names a vertex twice or has no area; it was kept");
        let seen = if rank == 0 { count - (Findings::PLACES_KEPT.min(count) - 1) } else { 1 };
        // The places of the first ones; the rest are counted with the first.
        findings.push_many(code, Severity::Warning, place(face), message, seen as u64);
    }
    Ok(())
}

/// How many faces are so, and the first few.
fn find(exec: &Exec, faces: usize, is_so: impl Fn(usize) -> bool + Sync) -> Result<(usize, Vec<usize>), Stop> {
    let parts = map_chunks(exec, faces, CHUNK, |range| {
        let found = range.filter(|&face| is_so(face));
        let mut first = Vec::new();
        let mut count = 0;
        for face in found {
            count += 1;
            if first.len() < Findings::PLACES_KEPT {
                first.push(face);
            }
        }
        Ok::<_, Stop>((count, first))
    })?;
    let count = parts.iter().map(|(count, _)| count).sum();
    let first = parts.into_iter().flat_map(|(_, first)| first).take(Findings::PLACES_KEPT).collect();
    Ok((count, first))
}

fn repeats(corners: &[u32]) -> bool {
    match corners {
        [a, b, c] => a == b || b == c || c == a,
        [a, b, c, d] => a == b || a == c || a == d || b == c || b == d || c == d,
        corners if corners.len() <= 16 => corners.iter().enumerate().any(|(i, corner)| corners[..i].contains(corner)),
        corners => {
            let mut sorted = corners.to_vec();
            sorted.sort_unstable();
            sorted.windows(2).any(|pair| pair[0] == pair[1])
        }
    }
}

/// Whether all points lie on one line or in one point, up to rounding of one product.
fn on_one_line(points: &[DVec3]) -> bool {
    let Some((&first, others)) = points.split_first() else {
        return true;
    };
    // Against the corner that is farthest along an axis, in units in which it is one away: nothing underflows then.
    let reach = |point: &DVec3| (*point - first).abs().max_element();
    let Some(far) =
        others.iter().copied().reduce(|best, point| if reach(&point) > reach(&best) { point } else { best })
    else {
        return true;
    };
    let size = reach(&far);
    if size == 0.0 || !size.is_finite() {
        return size == 0.0;
    }
    let along = (far - first) / size;
    others.iter().all(|&point| along.cross((point - first) / size) == DVec3::ZERO)
}

/// Takes out every vertex whose position is not finite, with the faces and segments that use it.
pub(crate) fn drop_non_finite(shape: &mut Shape, exec: &Exec, findings: &mut Findings) -> Result<(), ReadError> {
    // Instances stay instances.
    let mut known: HashMap<*const Geometry, Option<Arc<Geometry>>> = HashMap::new();
    let mut old = Vec::new();
    for (index, part) in shape.parts.iter_mut().enumerate() {
        exec.check()?;
        let kept = match known.entry(Arc::as_ptr(&part.geometry)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(slot) => {
                // The copy of what is kept, and the lists that say what that is.
                let _memory = exec.reserve(2 * part.geometry.memory_bytes() as u64)?;
                let kept = finite_part(&part.geometry)?;
                if let Some((_, vertices, faces)) = &kept {
                    let message = format!(
                        "left out {vertices} vertices that are not finite, and {faces} faces or segments of them"
                    );
                    let place = Place::element("part", index as u64);
                    findings.push("W-read-dropped", Severity::Warning, place, message);
                }
                slot.insert(kept.map(|(kept, ..)| Arc::new(kept)))
            }
        };
        if let Some(kept) = kept {
            // Held until the end, so that no other geometry comes to lie at its address.
            old.push(std::mem::replace(&mut part.geometry, Arc::clone(kept)));
        }
    }
    Ok(())
}

type Kept = (Geometry, usize, usize);

/// The finite part of a geometry, how many vertices and how many faces it lost; none if it is finite.
fn finite_part(geometry: &Geometry) -> Result<Option<Kept>, ReadError> {
    let Some(points) = crate::placed::points_of(geometry) else { return Ok(None) };
    if points.iter().all(|point| point.is_finite()) {
        return Ok(None);
    }
    let wrong = |error: String| Fault::new("E-read-elements", Place::Whole, error, "a mesh");
    let finite = |vertex: &u32| points[*vertex as usize].is_finite();
    let kept: Vec<u32> = (0..points.len() as u32).filter(finite).collect();
    let lost = points.len() - kept.len();
    let mut new_of_old = vec![u32::MAX; points.len()];
    kept.iter().enumerate().for_each(|(new, &old)| new_of_old[old as usize] = new as u32);
    let gathered = || kept.iter().map(|&vertex| points[vertex as usize]).collect();
    let (rest, lost_faces) = match geometry {
        Geometry::PointCloud(cloud) => {
            let mut rest = PointCloud::new(gathered());
            for column in cloud.attributes() {
                rest.insert_attribute(column.gathered(&kept)).map_err(|error| wrong(error.to_string()))?;
            }
            for list in cloud.attributes().lists() {
                rest.insert_list(list.gathered(&kept)).map_err(|error| wrong(error.to_string()))?;
            }
            (Some(rest.into()), 0)
        }
        // A polyline that loses a point falls apart: what is left of it is a graph.
        Geometry::Polyline(line) => {
            let (graph, edges) = finite_graph(&GeometricGraph::from(line.clone()), &kept, &new_of_old)?;
            (Some(graph.into()), edges)
        }
        Geometry::GeometricGraph(graph) => {
            let (graph, edges) = finite_graph(graph, &kept, &new_of_old)?;
            (Some(graph.into()), edges)
        }
        Geometry::TriMesh(mesh) => {
            let whole = |face: &u32| mesh.triangles()[*face as usize].iter().all(finite);
            let faces: Vec<u32> = (0..mesh.triangles().len() as u32).filter(whole).collect();
            let lost_faces = mesh.triangles().len() - faces.len();
            (cut(geometry, kept, faces, &new_of_old).map_err(|error| wrong(error.to_string()))?, lost_faces)
        }
        Geometry::PolyMesh(mesh) => {
            let whole = |face: &u32| mesh.face(*face as usize).iter().all(finite);
            let faces: Vec<u32> = (0..mesh.face_count() as u32).filter(whole).collect();
            let lost_faces = mesh.face_count() - faces.len();
            (cut(geometry, kept, faces, &new_of_old).map_err(|error| wrong(error.to_string()))?, lost_faces)
        }
        _ => return Ok(None),
    };
    Ok(rest.map(|rest| (rest, lost, lost_faces)))
}

/// The vertices that are kept with the edges between them, and how many edges are not.
fn finite_graph(
    graph: &GeometricGraph,
    kept: &[u32],
    new_of_old: &[u32],
) -> Result<(GeometricGraph, usize), ReadError> {
    let wrong = |error: String| Fault::new("E-read-elements", Place::Whole, error, "a mesh");
    let whole = |edge: &u32| graph.edges()[*edge as usize].iter().all(|&end| new_of_old[end as usize] != u32::MAX);
    let edges: Vec<u32> = (0..graph.edges().len() as u32).filter(whole).collect();
    let ends = |&edge: &u32| graph.edges()[edge as usize].map(|end| new_of_old[end as usize]);
    let positions = kept.iter().map(|&vertex| graph.positions()[vertex as usize]).collect();
    let rest = GeometricGraph::try_new(positions, edges.iter().map(ends).collect());
    let mut rest = rest.map_err(|error| wrong(error.to_string()))?;
    for column in graph.vertex_attributes() {
        rest.insert_vertex_attribute(column.gathered(kept)).map_err(|error| wrong(error.to_string()))?;
    }
    for list in graph.vertex_attributes().lists() {
        rest.insert_vertex_list(list.gathered(kept)).map_err(|error| wrong(error.to_string()))?;
    }
    for column in graph.edge_attributes() {
        rest.insert_edge_attribute(column.gathered(&edges)).map_err(|error| wrong(error.to_string()))?;
    }
    for list in graph.edge_attributes().lists() {
        rest.insert_edge_list(list.gathered(&edges)).map_err(|error| wrong(error.to_string()))?;
    }
    let lost = graph.edges().len() - edges.len();
    Ok((rest, lost))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_mesh::{Column, Domain, PolyMesh, Polyline, TriMesh};
    use shapeloom_shape::Part;

    #[test]
    fn faces_without_area_are_told_from_thin_ones() {
        let tiny = 1e-200;
        assert!(!on_one_line(&[DVec3::ZERO, DVec3::X * tiny, DVec3::Y * tiny]));
        assert!(on_one_line(&[DVec3::ZERO, DVec3::X * tiny, DVec3::X * 2.0 * tiny]));
        assert!(on_one_line(&[DVec3::ONE; 3]));
        // A figure of eight has no area by its sum, but is no line.
        assert!(!on_one_line(&[DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::X, DVec3::Y]));
        assert!(on_one_line(&[0.0, 1.0, 2.0, 3.0].map(|t| DVec3::new(t, t, t))));
        assert!(!on_one_line(&[DVec3::ZERO, DVec3::X * 1e300, DVec3::new(1e300, 1.0, 0.0)]));
        assert!(repeats(&[1, 2, 3, 4, 1]) && !repeats(&[1, 2, 3, 4, 5]));
        let long: Vec<u32> = (0..40).collect();
        assert!(!repeats(&long) && repeats(&[&long[..], &[7]].concat()));
    }

    #[test]
    fn degenerate_faces_are_counted_and_the_first_are_placed() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut triangles = vec![[0, 1, 2]];
        triangles.extend([[0, 1, 1]; 40]);
        let mesh = TriMesh::try_new(positions, triangles).unwrap().into();
        let mut findings = Findings::default();
        let place = |face: usize| Place::line(100 + face as u64);
        degenerate_faces(&mesh, "W-test", &Exec::default(), &mut findings, place).unwrap();
        let only = findings.iter().next().unwrap();
        assert_eq!((only.count, only.places.len(), &only.places[0]), (40, 16, &Place::line(101)));
    }

    #[test]
    fn dropping_keeps_what_is_finite_with_its_attributes() {
        let positions = vec![DVec3::ZERO, DVec3::NAN, DVec3::X, DVec3::Y, DVec3::ONE];
        let mut mesh = PolyMesh::from_faces(positions, &[vec![0, 1, 2], vec![0, 2, 4, 3]]).unwrap();
        mesh.insert_attribute(Domain::Vertex, Column::labels("v", vec![0, 1, 2, 3, 4])).unwrap();
        mesh.insert_attribute(Domain::Face, Column::labels("f", vec![7, 8])).unwrap();
        mesh.insert_attribute(Domain::Wedge, Column::labels("w", (0..7).collect())).unwrap();
        let part = Part::new(mesh);
        let mut shape = Shape { parts: vec![part.clone(), part], ..Shape::default() };
        let mut findings = Findings::default();
        drop_non_finite(&mut shape, &Exec::default(), &mut findings).unwrap();
        assert!(Arc::ptr_eq(&shape.parts[0].geometry, &shape.parts[1].geometry));
        let Geometry::PolyMesh(mesh) = &*shape.parts[0].geometry else { panic!("polygons") };
        assert_eq!((mesh.face_count(), mesh.face(0)), (1, &[0, 1, 3, 2][..]));
        let labels = |domain, name| mesh.attribute(domain, name).unwrap().values().clone();
        assert_eq!(labels(Domain::Vertex, "v"), shapeloom_mesh::Values::U32(vec![0, 2, 3, 4]));
        assert_eq!(labels(Domain::Face, "f"), shapeloom_mesh::Values::U32(vec![8]));
        assert_eq!(labels(Domain::Wedge, "w"), shapeloom_mesh::Values::U32(vec![3, 4, 5, 6]));
        assert_eq!(findings.iter().next().unwrap().code, "W-read-dropped");
        // A line without its second point is a point and a segment.
        let line = Polyline::new(vec![DVec3::ZERO, DVec3::NAN, DVec3::X, DVec3::Y], false);
        let mut shape = Shape::new(Part::new(line));
        drop_non_finite(&mut shape, &Exec::default(), &mut findings).unwrap();
        let Geometry::GeometricGraph(graph) = &*shape.parts[0].geometry else { panic!("a graph") };
        assert_eq!((graph.positions().len(), graph.edges()), (3, &[[1, 2]][..]));
    }
}
