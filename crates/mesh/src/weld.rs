//! Merging of vertices.

use std::collections::HashMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Loss, Options, Report, Stop, options,
};

use crate::collapsed::leave_traces;
use crate::{Column, ListColumn, MeshAttributes, MeshError, MeshOrigins, Origins, PolyMesh, TriMesh, carry};

options! {
    /// Merges vertices that lie within a distance of each other, and drops faces that collapse.
    ///
    /// Vertices are taken in order; each joins the nearest vertex kept so far within the distance, else it is kept. No
    /// vertex moves farther than the distance, and chains do not creep. At distance 0 vertices with equal coordinates
    /// merge (-0 equals 0). Corners of a face that follow one another at one vertex become one; what is left with fewer than
    /// three is dropped. Where merged vertices disagree about an attribute it moves to the wedges, so that nothing
    /// is lost. Vertices without faces are kept if no other is near. Cost: linear in the number of vertices for
    /// reasonable distances.
    pub struct Weld("weld") {
        required {}
        optional {
            /// The largest distance between vertices that merge, in model units.
            distance: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// Whether corners that merge with the next one of their face are dropped, and faces that keep fewer than three.
            drop_collapsed: bool = true,
        }
    }
}

/// Welds equal positions only: a tolerance for a whole conversion is no licence to merge what is apart.
impl<S> FromTolerance<S> for Weld {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<TriMesh> for Weld {
    type Output = TriMesh;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        let bytes = source.memory_bytes() as u64;
        let faces = source.triangles().iter().map(<[u32; 3]>::as_slice);
        let mut welded = self.weld(source.positions(), faces, source.attributes(), bytes, exec)?;
        welded.report.figure("triangles_dropped", (source.triangles().len() + 1 - welded.starts.len()) as f64);
        // A triangle that lost a corner is gone.
        let triangles = welded.corners.as_chunks().0.to_vec();
        let mesh = TriMesh::with_attributes(welded.positions, triangles, welded.attributes)?;
        Ok(Converted::new(mesh, welded.report))
    }
}

impl Convert<PolyMesh> for Weld {
    type Output = PolyMesh;

    fn convert_with(&self, source: &PolyMesh, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        let bytes = source.memory_bytes() as u64;
        let mut welded = self.weld(source.positions(), source.faces(), source.attributes(), bytes, exec)?;
        welded.report.figure("faces_dropped", (source.face_count() + 1 - welded.starts.len()) as f64);
        let mesh = PolyMesh::with_attributes(welded.positions, welded.starts, welded.corners, welded.attributes)?;
        Ok(Converted::new(mesh, welded.report))
    }
}

/// What becomes of a mesh.
struct Welded {
    positions: Vec<DVec3>,
    starts: Vec<u32>,
    corners: Vec<u32>,
    attributes: MeshAttributes,
    report: Report,
}

impl Weld {
    fn weld<'a>(
        &self,
        positions: &[DVec3],
        faces: impl Iterator<Item = &'a [u32]> + Clone,
        attributes: &MeshAttributes,
        bytes: u64,
        exec: &Exec,
    ) -> Result<Welded, ConvertError> {
        self.validate()?;
        let mut stop = None;
        let infinite = polled(positions.iter(), exec, &mut stop).position(|position| !position.is_finite());
        stopped(stop)?;
        if let Some(vertex) = infinite {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        // The hash table takes about 48 bytes a vertex; the result at most what the source takes, and once more for
        // attributes that move to the wedges.
        let _memory = exec.reserve((positions.len() as u64 * 64).saturating_add(3 * bytes))?;
        let groups = self.group(positions, exec)?;
        exec.check()?;
        let moved = polled(0..groups.of.len(), exec, &mut stop)
            .map(|vertex| positions[vertex].distance(positions[groups.leader(vertex)]))
            .fold(0.0, f64::max);
        stopped(stop)?;
        let kept = self.merge_corners(polled(faces.clone(), exec, &mut stop), &groups);
        stopped(stop)?;
        let mut report = Report::new(Self::NAME, Deviation::Exact, "only vertices of equal position merge");
        if moved > 0.0 {
            report.deviation = Deviation::AtMost(moved);
            report.basis = "the largest move of a vertex".to_owned();
        }
        let left = kept.starts.windows(2).map(|pair| &kept.corners[pair[0] as usize..pair[1] as usize]);
        let all_traced = leave_traces(&kept.gone, polled(left, exec, &mut stop));
        stopped(stop)?;
        if !all_traced {
            report.deviation = Deviation::Unknown;
            report.basis = "parts of the surface collapsed to points or segments and were dropped".to_owned();
        }
        exec.check()?;
        let mut attributes = attributes.clone();
        promote_disagreeing(&mut attributes, faces.flatten().copied(), &groups, &mut report, exec)?;
        let origins = MeshOrigins {
            vertex: Origins::Copies(groups.leaders.clone()),
            face: Origins::Copies(kept.faces),
            wedge: Origins::Copies(kept.wedges),
        };
        let (attributes, losses) = carry(&attributes, &origins);
        report.losses.extend(losses);
        report.figure("vertices_merged", (positions.len() - groups.leaders.len()) as f64);
        let positions = groups.leaders.iter().map(|&leader| positions[leader as usize]).collect();
        Ok(Welded { positions, starts: kept.starts, corners: kept.corners, attributes, report })
    }

    fn merge_corners<'a>(&self, faces: impl Iterator<Item = &'a [u32]>, groups: &Groups) -> Kept {
        let mut kept = Kept { starts: vec![0], ..Kept::default() };
        let mut first = 0;
        for (face, corners) in (0..).zip(faces) {
            let start = kept.corners.len();
            let mut before = groups.of[corners[corners.len() - 1] as usize];
            for (wedge, &vertex) in (first..).zip(corners) {
                let merged = groups.of[vertex as usize];
                if !self.drop_collapsed || merged != before {
                    kept.corners.push(merged);
                    kept.wedges.push(wedge);
                }
                before = merged;
            }
            first += corners.len() as u32;
            if kept.corners.len() - start >= 3 {
                kept.faces.push(face);
                kept.starts.push(kept.corners.len() as u32);
            } else {
                // One vertex, or two.
                let [a, b] = [0, 1].map(|i| kept.corners.get(start + i).copied().unwrap_or(before));
                kept.gone.push([a, b, b]);
                kept.corners.truncate(start);
                kept.wedges.truncate(start);
            }
        }
        kept
    }
}

/// The faces that are left, where they and their corners come from, and what the others shrank to.
#[derive(Default)]
struct Kept {
    starts: Vec<u32>,
    corners: Vec<u32>,
    faces: Vec<u32>,
    wedges: Vec<u32>,
    gone: Vec<[u32; 3]>,
}

/// Which vertices merge: the group of each, and the vertex that leads each group.
struct Groups {
    of: Vec<u32>,
    leaders: Vec<u32>,
}

impl Groups {
    fn leader(&self, vertex: usize) -> usize {
        self.leaders[self.of[vertex] as usize] as usize
    }
}

impl Weld {
    fn group(&self, positions: &[DVec3], exec: &Exec) -> Result<Groups, ConvertError> {
        let size = positions.iter().map(|position| position.abs().max_element()).fold(0.0, f64::max);
        // Under half a unit in the last place no two different coordinates are near; and cell numbers must fit in i64.
        let cell_size = self.distance;
        if cell_size <= size * f64::EPSILON / 4.0 {
            return group_equal(positions, exec);
        }
        let cell = |position: DVec3| (position / cell_size).floor().to_array().map(|coordinate| coordinate as i64);
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        let mut groups = Groups { of: Vec::with_capacity(positions.len()), leaders: Vec::new() };
        for (vertex, &position) in positions.iter().enumerate() {
            if vertex % 4096 == 0 {
                exec.check()?;
            }
            let home = cell(position);
            let mut nearest: Option<(f64, u32)> = None;
            for step in 0..27 {
                let shift = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
                let neighbour = std::array::from_fn(|axis| home[axis].saturating_add(shift[axis]));
                for &group in cells.get(&neighbour).into_iter().flatten() {
                    let leader = positions[groups.leaders[group as usize] as usize];
                    let distance = position.distance(leader);
                    if distance <= self.distance && nearest.is_none_or(|best| (distance, group) < best) {
                        nearest = Some((distance, group));
                    }
                }
            }
            let group = nearest.map_or(groups.leaders.len() as u32, |(_, group)| group);
            if nearest.is_none() {
                groups.leaders.push(vertex as u32);
                cells.entry(home).or_default().push(group);
            }
            groups.of.push(group);
        }
        Ok(groups)
    }
}

fn group_equal(positions: &[DVec3], exec: &Exec) -> Result<Groups, ConvertError> {
    let mut known: HashMap<[u64; 3], u32> = HashMap::with_capacity(positions.len());
    let mut groups = Groups { of: Vec::with_capacity(positions.len()), leaders: Vec::new() };
    for (vertex, position) in positions.iter().enumerate() {
        if vertex % 4096 == 0 {
            exec.check()?;
        }
        // Adding zero turns -0 into 0.
        let key = position.to_array().map(|coordinate| (coordinate + 0.0).to_bits());
        let next = groups.leaders.len() as u32;
        let group = *known.entry(key).or_insert(next);
        if group == next {
            groups.leaders.push(vertex as u32);
        }
        groups.of.push(group);
    }
    Ok(groups)
}

/// Moves the vertex attributes about which merged vertices disagree to the wedges, whose vertices are given.
fn promote_disagreeing(
    attributes: &mut MeshAttributes,
    corners: impl Iterator<Item = u32>,
    groups: &Groups,
    report: &mut Report,
    exec: &Exec,
) -> Result<(), Stop> {
    let mut stop = None;
    let mut disagree = |column: &&Column| {
        polled(0..groups.of.len(), exec, &mut stop).any(|vertex| !column.same(vertex, groups.leader(vertex)))
    };
    let names: Vec<String> =
        attributes.vertex.iter().filter(&mut disagree).map(|column| column.name().to_owned()).collect();
    stopped(stop)?;
    let corners: Vec<u32> = if names.is_empty() { Vec::new() } else { polled(corners, exec, &mut stop).collect() };
    stopped(stop)?;
    for name in names {
        let what = format!("vertex attribute \"{name}\"");
        if attributes.wedge.get(&name).is_some() {
            report.losses.push(Loss::new(what, "merged vertices disagree, and a wedge attribute has that name"));
        } else if let Some(column) = attributes.vertex.remove(&name) {
            attributes.wedge.insert(column.gathered(&corners)).expect("a wedge for each corner, and the name is free");
        }
    }
    let disagree = |list: &&ListColumn| {
        polled(0..groups.of.len(), exec, &mut stop).any(|vertex| !list.same(vertex, groups.leader(vertex)))
    };
    let lists = attributes.vertex.lists().iter().filter(disagree);
    let names: Vec<String> = lists.map(|list| list.name().to_owned()).collect();
    stopped(stop)?;
    for name in names {
        attributes.vertex.remove_list(&name);
        report.losses.push(Loss::new(format!("vertex list \"{name}\""), "merged vertices disagree"));
    }
    Ok(())
}

/// The items, with a poll before every 4096th; at a stop they end, and `stop` has why.
fn polled<T>(items: impl Iterator<Item = T>, exec: &Exec, stop: &mut Option<Stop>) -> impl Iterator<Item = T> {
    items.enumerate().map_while(move |(index, item)| {
        if index.is_multiple_of(4096) {
            *stop = exec.check().err();
        }
        stop.is_none().then_some(item)
    })
}

fn stopped(stop: Option<Stop>) -> Result<(), Stop> {
    stop.map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, TEXCOORD, TriangulatePolygons, Values};

    /// The cube with every corner of every triangle a vertex of its own.
    fn soup() -> TriMesh {
        let cube = TriangulatePolygons::new().convert(&crate::poly_mesh::tests::unit_cube()).unwrap().value;
        let positions = (0..12).flat_map(|triangle| cube.corners(triangle)).collect();
        let triangles = (0..12).map(|face| [face * 3, face * 3 + 1, face * 3 + 2]).collect();
        TriMesh::try_new(positions, triangles).unwrap()
    }

    #[test]
    fn a_soup_welds_to_its_cube() {
        let converted = Weld::new().convert(&soup()).unwrap();
        assert_eq!((converted.value.positions().len(), converted.value.triangles().len()), (8, 12));
        assert_eq!(converted.report.deviation, Deviation::Exact);
        assert_eq!(converted.value.volume(), 1.0);
    }

    #[test]
    fn disagreeing_attributes_move_to_the_wedges() {
        let mut mesh = soup();
        let coordinates: Vec<[f64; 2]> = (0..36).map(|i| [f64::from(i), 0.5]).collect();
        mesh.insert_attribute(Domain::Vertex, Column::texcoords(TEXCOORD, &coordinates)).unwrap();
        mesh.insert_attribute(Domain::Vertex, Column::labels("same", vec![3; 36])).unwrap();
        let converted = Weld::new().convert(&mesh).unwrap();
        let welded = converted.value;
        assert!(converted.report.losses.is_empty());
        assert_eq!(welded.attribute(Domain::Vertex, "same").unwrap().len(), 8);
        assert!(welded.attribute(Domain::Vertex, TEXCOORD).is_none());
        let moved = welded.attribute(Domain::Wedge, TEXCOORD).unwrap();
        assert!((0..36).all(|wedge| moved.number(wedge, 0) == wedge as f64));
    }

    #[test]
    fn disagreeing_lists_are_named_as_lost() {
        let mut mesh = soup();
        let starts: Vec<u32> = (0..=36).collect();
        let list = |name: &str, values: Vec<u8>| ListColumn::try_new(name, starts.clone(), Values::U8(values)).unwrap();
        mesh.insert_list(Domain::Vertex, list("same", vec![5; 36])).unwrap();
        mesh.insert_list(Domain::Vertex, list("other", (0..36).collect())).unwrap();
        let converted = Weld::new().convert(&mesh).unwrap();
        let lists = converted.value.attributes().vertex.lists();
        assert_eq!(lists.iter().map(|list| (list.name(), list.len())).collect::<Vec<_>>(), [("same", 8)]);
        assert_eq!(converted.report.losses, [Loss::new("vertex list \"other\"", "merged vertices disagree")]);
    }

    #[test]
    fn near_vertices_merge_within_the_distance_and_no_farther() {
        let mut mesh = soup();
        for (i, position) in mesh.positions_mut().iter_mut().enumerate() {
            *position += DVec3::splat(1e-4 * (i as f64 * 0.7).sin());
        }
        let near = Weld { distance: 1e-3, ..Weld::new() }.convert(&mesh).unwrap();
        assert_eq!(near.value.positions().len(), 8);
        assert!(matches!(near.report.deviation, Deviation::AtMost(moved) if moved <= 4e-4 && moved > 0.0));
        assert_eq!(Weld { distance: 1e-9, ..Weld::new() }.convert(&mesh).unwrap().value.positions().len(), 36);
    }

    #[test]
    fn chains_do_not_creep() {
        let positions = (0..100).map(|i| DVec3::X * (f64::from(i) * 0.7)).collect();
        let mesh = TriMesh::try_new(positions, vec![]).unwrap();
        let converted = Weld { distance: 1.0, ..Weld::new() }.convert(&mesh).unwrap();
        assert_eq!(converted.value.positions().len(), 50);
    }

    #[test]
    fn a_part_that_vanishes_makes_the_deviation_unknown() {
        let positions = vec![DVec3::ZERO, DVec3::X * 1e-3, DVec3::Y * 1e-3, DVec3::X * 9.0, DVec3::Y * 9.0];
        let mesh = TriMesh::try_new(positions, vec![[0, 1, 2]]).unwrap();
        let converted = Weld { distance: 0.1, ..Weld::new() }.convert(&mesh).unwrap();
        assert!(converted.value.triangles().is_empty());
        assert_eq!(converted.report.deviation, Deviation::Unknown);
        // A segment that no triangle has as its side is lost as well, though nothing moves.
        let mesh = TriMesh::try_new(vec![DVec3::ZERO, DVec3::X], vec![[0, 1, 1]]).unwrap();
        assert_eq!(Weld::new().convert(&mesh).unwrap().report.deviation, Deviation::Unknown);
    }

    #[test]
    fn minus_zero_is_zero_and_nan_is_refused() {
        let positions = vec![DVec3::ZERO, DVec3::new(-0.0, 0.0, -0.0)];
        let mesh = TriMesh::try_new(positions, vec![]).unwrap();
        assert_eq!(Weld::new().convert(&mesh).unwrap().value.positions().len(), 1);
        let mesh = TriMesh::try_new(vec![DVec3::NAN], vec![]).unwrap();
        assert!(Weld::new().convert(&mesh).is_err());
    }

    /// The cube with every corner of every face a vertex of its own.
    fn apart() -> PolyMesh {
        let cube = crate::poly_mesh::tests::unit_cube();
        let positions = (0..6).flat_map(|face| cube.outline(face)).collect();
        PolyMesh::try_new(positions, cube.face_starts().to_vec(), (0..24).collect()).unwrap()
    }

    #[test]
    fn polygons_weld_to_their_cube() {
        let mut mesh = apart();
        mesh.insert_attribute(Domain::Vertex, Column::labels("side", (0..24).map(|corner| corner / 4).collect()))
            .unwrap();
        let Converted { value: welded, report } = Weld::new().convert(&mesh).unwrap();
        assert_eq!((welded.positions().len(), welded.face_count(), welded.volume()), (8, 6, 1.0));
        assert_eq!((report.deviation, report.find("vertices_merged")), (Deviation::Exact, Some(16.0)));
        let sides = welded.attribute(Domain::Wedge, "side").unwrap();
        assert!((0..24).all(|wedge| sides.number(wedge, 0) == (wedge / 4) as f64));
    }

    #[test]
    fn corners_that_merge_become_one_and_faces_of_two_go() {
        // A pentagon whose first and last corners merge, a square that becomes a side of it, a triangle at one point of it.
        let (near, far) = (1e-6, 1.0);
        let xy = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let positions = vec![xy(0.0, 0.0), xy(far, 0.0), xy(far, far), xy(0.0, far), xy(0.0, near), xy(far, near)];
        let faces = [vec![0, 1, 2, 3, 4], vec![0, 1, 5, 4], vec![1, 5, 1]];
        let mut mesh = PolyMesh::from_faces(positions, &faces).unwrap();
        mesh.insert_attribute(Domain::Wedge, Column::labels("corner", (0..12).collect())).unwrap();
        mesh.insert_attribute(Domain::Face, Column::labels("face", vec![7, 8, 9])).unwrap();
        let weld = Weld { distance: 1e-3, ..Weld::new() };
        let Converted { value: welded, report } = weld.convert(&mesh).unwrap();
        assert_eq!((welded.positions().len(), welded.face_count()), (4, 1));
        // The later of two corners goes, also where it is the first of the face.
        assert_eq!(welded.face(0), [1, 2, 3, 0]);
        assert_eq!(welded.attribute(Domain::Wedge, "corner").unwrap().values(), &Values::U32(vec![1, 2, 3, 4]));
        assert_eq!(welded.attribute(Domain::Face, "face").unwrap().values(), &Values::U32(vec![7]));
        assert_eq!((report.deviation, report.find("faces_dropped")), (Deviation::AtMost(near), Some(2.0)));
        let all = Weld { drop_collapsed: false, ..weld }.convert(&mesh).unwrap().value;
        assert_eq!((all.face(0), all.face(1), all.face(2)), (&[0, 1, 2, 3, 0][..], &[0, 1, 1, 0][..], &[1, 1, 1][..]));
    }

    #[test]
    fn triangles_weld_alike_as_polygons() {
        let mut mesh = soup();
        mesh.insert_attribute(Domain::Vertex, Column::labels("number", (0..36).collect())).unwrap();
        mesh.insert_attribute(Domain::Face, Column::labels("face", (0..12).collect())).unwrap();
        for distance in [0.0, 1.1, 1.5] {
            let weld = Weld { distance, ..Weld::new() };
            let triangles = weld.convert(&mesh).unwrap();
            let polygons = weld.convert(&PolyMesh::from(mesh.clone())).unwrap();
            assert_eq!(PolyMesh::from(triangles.value), polygons.value, "{distance}");
            assert_eq!(triangles.report.deviation, polygons.report.deviation, "{distance}");
        }
    }

    /// Grouping, finding infinite coordinates, moves, merging of faces and traces poll each.
    #[test]
    fn every_loop_polls() {
        let count = 50 * 4096u32;
        let positions = (0..count).map(|i| DVec3::splat(f64::from(i / 4))).collect();
        let triangles = (0..count).map(|i| [i, (i + 4) % count, (i + 8) % count]).collect();
        let mut mesh = TriMesh::try_new(positions, triangles).unwrap();
        let plain = crate::poll_count::polls(&|exec| drop(Weld::new().convert_with(&mesh, exec).unwrap()));
        assert!(plain >= 4 * 50, "{plain}");
        mesh.insert_attribute(Domain::Vertex, Column::labels("quarter", (0..count).map(|i| i / 4).collect())).unwrap();
        let labelled = crate::poll_count::polls(&|exec| drop(Weld::new().convert_with(&mesh, exec).unwrap()));
        assert!(labelled >= plain + 50, "{labelled}");
        for stop_at in [1, 60, 110, 160, labelled - 10] {
            let seen = std::sync::atomic::AtomicU64::new(0);
            let exec = Exec::default().with_watch(move || {
                (seen.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= stop_at).then_some(Stop::Cancelled)
            });
            assert!(Weld::new().convert_with(&mesh, &exec).is_err(), "{stop_at}");
        }
    }
}
