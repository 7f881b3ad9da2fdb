//! Merging of vertices.

use std::collections::HashMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Loss, Options, Report, options,
};

use crate::{Column, Domain, ListColumn, MeshError, MeshOrigins, Origins, TriMesh, carry, collapsed_leave_traces};

options! {
    /// Merges vertices that lie within a distance of each other, and drops triangles that collapse.
    ///
    /// Vertices are taken in order; each joins the nearest vertex kept so far within the distance, else it is kept. No
    /// vertex moves farther than the distance, and chains do not creep. At distance 0 vertices with equal coordinates
    /// merge (-0 equals 0). Where merged vertices disagree about an attribute it moves to the wedges, so that nothing
    /// is lost. Vertices without triangles are kept if no other is near. Cost: linear in the number of vertices for
    /// reasonable distances.
    pub struct Weld("weld") {
        required {}
        optional {
            /// The largest distance between vertices that merge, in model units.
            distance: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// Whether triangles with two equal corners are dropped.
            drop_collapsed: bool = true,
        }
    }
}

/// Welds equal positions only: a tolerance for a whole conversion is no licence to merge what is apart.
impl FromTolerance<TriMesh> for Weld {
    fn from_tolerance(_: &TriMesh, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<TriMesh> for Weld {
    type Output = TriMesh;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        if let Some(vertex) = source.first_non_finite() {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        // The hash table takes about 48 bytes a vertex; the result at most what the source takes, and once more for
        // attributes that move to the wedges.
        let vertices = source.positions().len() as u64;
        let _memory = exec.reserve((vertices * 64).saturating_add(3 * source.memory_bytes() as u64))?;
        let groups = self.group(source.positions(), exec)?;
        exec.check()?;

        let moved = (0..groups.of.len())
            .map(|vertex| source.positions()[vertex].distance(source.positions()[groups.leader(vertex)]))
            .fold(0.0, f64::max);
        let merged = source.triangles().iter().map(|triangle| triangle.map(|vertex| groups.of[vertex as usize]));
        let collapsed = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        let (mut triangles, mut faces, mut gone) = (Vec::new(), Vec::new(), Vec::new());
        for (face, triangle) in merged.enumerate() {
            if self.drop_collapsed && collapsed(triangle) {
                gone.push(triangle);
            } else {
                triangles.push(triangle);
                faces.push(face as u32);
            }
        }
        let mut report = Report::new(Self::NAME, Deviation::Exact, "only vertices of equal position merge");
        if moved > 0.0 {
            report.deviation = Deviation::AtMost(moved);
            report.basis = "the largest move of a vertex".to_owned();
        }
        if !collapsed_leave_traces(&gone, &triangles) {
            report.deviation = Deviation::Unknown;
            report.basis = "parts of the surface collapsed to points or segments and were dropped".to_owned();
        }

        exec.check()?;
        let mut source = source.clone();
        promote_disagreeing(&mut source, &groups, &mut report);
        let wedges = faces.iter().flat_map(|face| [face * 3, face * 3 + 1, face * 3 + 2]).collect();
        let origins = MeshOrigins {
            vertex: Origins::Copies(groups.leaders.clone()),
            face: Origins::Copies(faces),
            wedge: Origins::Copies(wedges),
        };
        let (attributes, losses) = carry(source.attributes(), &origins);
        report.losses.extend(losses);
        let positions = groups.leaders.iter().map(|&leader| source.positions()[leader as usize]).collect();
        report.figure("vertices_merged", (source.positions().len() - groups.leaders.len()) as f64);
        report.figure("triangles_dropped", gone.len() as f64);
        Ok(Converted::new(TriMesh::with_attributes(positions, triangles, attributes)?, report))
    }
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

/// Moves the vertex attributes about which merged vertices disagree to the wedges.
fn promote_disagreeing(mesh: &mut TriMesh, groups: &Groups, report: &mut Report) {
    let disagree = |column: &Column| (0..groups.of.len()).any(|vertex| !column.same(vertex, groups.leader(vertex)));
    let names: Vec<String> = mesh
        .attributes()
        .vertex
        .iter()
        .filter(|column| disagree(column))
        .map(|column| column.name().to_owned())
        .collect();
    for name in names {
        let what = format!("vertex attribute \"{name}\"");
        if mesh.attribute(Domain::Wedge, &name).is_some() {
            report.losses.push(Loss::new(what, "merged vertices disagree, and a wedge attribute has that name"));
        } else if let Some(column) = mesh.remove_attribute(Domain::Vertex, &name) {
            let corners = column.gathered(mesh.triangles().as_flattened());
            mesh.insert_attribute(Domain::Wedge, corners).expect("a wedge for each corner, and the name is free");
        }
    }
    let lists = mesh.attributes().vertex.lists().iter();
    let disagree = |list: &&ListColumn| (0..groups.of.len()).any(|vertex| !list.same(vertex, groups.leader(vertex)));
    let names: Vec<String> = lists.filter(disagree).map(|list| list.name().to_owned()).collect();
    for name in names {
        mesh.remove_list(Domain::Vertex, &name);
        report.losses.push(Loss::new(format!("vertex list \"{name}\""), "merged vertices disagree"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TEXCOORD, TriangulatePolygons, Values};

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
}
