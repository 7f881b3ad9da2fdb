//! Faces turned over so that neighbours agree.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Aabb, Convert, ConvertError, Converted, Deviation, Exec, Findings, FromTolerance, Options, Place, Report, Severity,
    choice, options,
};

use crate::structures::{FaceList, Orientation, StructureError};
use crate::{MeshAttributes, MeshError, MeshOrigins, Origins, PolyMesh, TriMesh, carry};

choice! {
    /// Which of the two orientations a part gets.
    pub enum Outside {
        /// The one that most of its faces have; where they are even, that of the first.
        Majority = "majority",
        /// Closed parts get a positive volume; open ones the majority's. Of a shape with cavities the shells around them are
        /// turned outward too.
        Volume = "volume",
    }
}

options! {
    /// Turns faces over until neighbours across every edge agree on an outside.
    ///
    /// Faces are neighbours across an edge that exactly two have; edges with more bind nothing. Parts that are joined by
    /// neighbours are oriented one by one. A part that has no orientation, such as a Möbius strip or a Klein bottle, is an
    /// error that names a ring of faces which shows it, or is left as it is with a finding. No position moves; corners of turned
    /// faces keep their attributes, the first corner stays first. Cost: linear but for sorting the sides by edge.
    pub struct OrientFaces("orient-faces") {
        required {}
        optional {
            /// Which of the two orientations a part gets.
            outside: Outside = Outside::Majority,
            /// Whether parts without an orientation are left as they are, instead of an error.
            leave_one_sided: bool = false,
        }
    }
}

impl<S> FromTolerance<S> for OrientFaces {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

/// What to do with each face, and what to say about it.
struct Turns {
    turned: Vec<bool>,
    report: Report,
}

impl OrientFaces {
    fn turns(&self, faces: &impl FaceList, positions: &[DVec3], exec: &Exec) -> Result<Turns, ConvertError> {
        self.validate()?;
        if let Some(vertex) = positions.iter().position(|position| !position.is_finite()) {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        let orientation = Orientation::of::<StructureError>(faces, exec)?;
        let parts = orientation.open.len();
        let mut findings = Findings::default();
        if let Some((_, ring)) = orientation.one_sided.first()
            && !self.leave_one_sided
        {
            let count = orientation.one_sided.len();
            return Err(StructureError::NotOrientable { faces: ring.clone(), count }.into());
        }
        let mut one_sided = vec![false; parts];
        for (part, ring) in &orientation.one_sided {
            one_sided[*part as usize] = true;
            let place = Place::element("face", u64::from(ring[0]));
            let text = "a ring of faces turns over: the part has no orientation, and is left as it is";
            findings.push("W-orient-one-sided", Severity::Warning, place, text);
        }
        let scale = scale_of(positions);
        let mut sums = vec![Part::default(); parts];
        for face in 0..faces.face_total() as u32 {
            if face % 4096 == 0 {
                exec.check()?;
            }
            let against = orientation.against[face as usize];
            sums[orientation.components[face as usize] as usize].add(faces.face(face), positions, scale, against);
        }
        let turn_all: Vec<bool> = (0..parts)
            .map(|part| match self.outside {
                Outside::Volume if !orientation.open[part] && sums[part].volume != 0.0 => sums[part].volume < 0.0,
                _ => sums[part].against * 2 > sums[part].faces,
            })
            .collect();
        let turned: Vec<bool> = orientation
            .components
            .iter()
            .zip(&orientation.against)
            .map(|(&part, &against)| !one_sided[part as usize] && against != turn_all[part as usize])
            .collect();
        let mut report = Report::new(OrientFaces::NAME, Deviation::Exact, "faces are turned over where they are");
        report.findings = findings;
        report.figure("faces_turned", turned.iter().filter(|&&turned| turned).count() as f64);
        report.figure("parts", parts as f64);
        report.figure("parts_one_sided", orientation.one_sided.len() as f64);
        report.figure("edges_of_more_than_two_faces", orientation.crowded_edges as f64);
        Ok(Turns { turned, report })
    }
}

/// What a part sums up to, seen from its smallest face.
#[derive(Clone, Default)]
struct Part {
    faces: usize,
    against: usize,
    /// A point of the part, from which its volume is summed.
    origin: Option<DVec3>,
    volume: f64,
}

impl Part {
    fn add(&mut self, corners: &[u32], positions: &[DVec3], scale: f64, against: bool) {
        self.faces += 1;
        self.against += usize::from(against);
        let at = |i: usize| positions[corners[i] as usize] * scale;
        let origin = *self.origin.get_or_insert_with(|| at(0));
        let corner = |i: usize| at(i) - origin;
        let volume: f64 = (1..corners.len() - 1).map(|i| corner(0).dot(corner(i).cross(corner(i + 1)))).sum();
        self.volume += if against { -volume } else { volume };
    }
}

/// A power of two that brings the mesh to a size of about 1, so that volumes neither overflow nor vanish.
fn scale_of(positions: &[DVec3]) -> f64 {
    let bounds = Aabb::from_points(positions.iter().copied());
    if bounds.is_empty() {
        return 1.0;
    }
    let size = (bounds.max / 2.0 - bounds.min / 2.0).max_element();
    let exponent = if size > 0.0 { size.log2().floor() } else { 0.0 };
    2f64.powi(-exponent.clamp(-1000.0, 1000.0) as i32)
}

/// The corners of all faces in the order after the turn, by where they were.
fn wedges_after(faces: &impl FaceList, turned: &[bool]) -> Vec<u32> {
    let mut wedges = Vec::with_capacity(faces.all_corners().len());
    for (face, &turned) in turned.iter().enumerate() {
        let part = faces.corner_range(face as u32);
        let (start, end) = (part.start as u32, part.end as u32);
        wedges.push(start);
        if turned {
            wedges.extend((start + 1..end).rev());
        } else {
            wedges.extend(start + 1..end);
        }
    }
    wedges
}

fn carried(attributes: &MeshAttributes, wedges: Vec<u32>, report: &mut Report) -> MeshAttributes {
    let origins = MeshOrigins { vertex: Origins::Same, face: Origins::Same, wedge: Origins::Copies(wedges) };
    let (attributes, losses) = carry(attributes, &origins);
    report.losses.extend(losses);
    attributes
}

impl Convert<TriMesh> for OrientFaces {
    type Output = TriMesh;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        let Turns { turned, mut report } = self.turns(source, source.positions(), exec)?;
        let _memory = exec.reserve(2 * source.memory_bytes() as u64)?;
        let turn = |(&[a, b, c], &turned): (&[u32; 3], &bool)| if turned { [a, c, b] } else { [a, b, c] };
        let triangles = source.triangles().iter().zip(&turned).map(turn).collect();
        let attributes = carried(source.attributes(), wedges_after(source, &turned), &mut report);
        let mesh = TriMesh::with_attributes(source.positions().to_vec(), triangles, attributes)?;
        Ok(Converted::new(mesh, report))
    }
}

impl Convert<PolyMesh> for OrientFaces {
    type Output = PolyMesh;

    fn convert_with(&self, source: &PolyMesh, exec: &Exec) -> Result<Converted<PolyMesh>, ConvertError> {
        let Turns { turned, mut report } = self.turns(source, source.positions(), exec)?;
        let _memory = exec.reserve(2 * source.memory_bytes() as u64)?;
        let wedges = wedges_after(source, &turned);
        let corners = wedges.iter().map(|&wedge| source.wedge_vertices()[wedge as usize]).collect();
        let attributes = carried(source.attributes(), wedges, &mut report);
        let starts = source.face_starts().to_vec();
        let mesh = PolyMesh::with_attributes(source.positions().to_vec(), starts, corners, attributes)?;
        Ok(Converted::new(mesh, report))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::Torus;
    use crate::{Column, Domain, Values};

    fn shuffled(mesh: &PolyMesh, turned: impl Fn(usize) -> bool) -> PolyMesh {
        let mut faces: Vec<Vec<u32>> = mesh.faces().map(<[u32]>::to_vec).collect();
        for (face, corners) in faces.iter_mut().enumerate() {
            if turned(face) {
                corners[1..].reverse();
            }
        }
        PolyMesh::from_faces(mesh.positions().to_vec(), &faces).unwrap()
    }

    #[test]
    fn a_torus_with_turned_faces_is_as_it_was() {
        let torus = Torus { segments: 24, sides: 12, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
        let bare = shuffled(&torus, |_| false);
        for modulus in [2, 3, 7] {
            let mixed = shuffled(&torus, |face| face * 31 % modulus == 1);
            let volume = OrientFaces { outside: Outside::Volume, ..OrientFaces::new() };
            let done = volume.convert(&mixed).unwrap();
            assert_eq!(done.value, bare, "{modulus}");
            let turned = (0..torus.face_count()).filter(|face| face * 31 % modulus == 1).count();
            assert!(
                done.report.figures.iter().any(|figure| figure.name == "faces_turned" && figure.value == turned as f64)
            );
            let inside_out = volume.convert(&mixed.reversed()).unwrap().value;
            assert_eq!(inside_out.volume(), bare.volume());
        }
        // Most faces of the reversed torus agree to look inward.
        let kept = OrientFaces::new().convert(&shuffled(&torus, |face| face % 3 != 0)).unwrap().value;
        assert_eq!(kept.volume(), bare.reversed().volume());
    }

    #[test]
    fn volumes_of_any_size_tell_inside_from_outside() {
        let torus = Torus { segments: 8, sides: 6, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
        let volume = OrientFaces { outside: Outside::Volume, ..OrientFaces::new() };
        for size in [1e-300, 1e-110, 1.0, 1e110, 1e307] {
            let scaled = torus.transformed(&shapeloom_core::Affine::from_scale(DVec3::splat(size)));
            let oriented = volume.convert(&scaled.reversed()).unwrap().value;
            assert_eq!(oriented.wedge_vertices(), scaled.wedge_vertices(), "{size:e}");
        }
    }

    #[test]
    fn corners_keep_what_they_carry() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let mut mesh = TriMesh::try_new(positions, vec![[0, 1, 2], [1, 2, 3], [0, 1, 2]]).unwrap();
        mesh.insert_attribute(Domain::Wedge, Column::labels("corner", (0..9).collect())).unwrap();
        // 1-2 has three faces, so that nothing binds the second triangle, but 0-1 and 0-2 bind the first and the last.
        let done = OrientFaces::new().convert(&mesh).unwrap();
        assert_eq!(done.value.triangles(), [[0, 1, 2], [1, 2, 3], [0, 2, 1]]);
        let corners = done.value.attribute(Domain::Wedge, "corner").unwrap();
        assert_eq!(corners.values(), &Values::U32(vec![0, 1, 2, 3, 4, 5, 6, 8, 7]));
    }

    /// A strip of triangles, closed with a twist; every row of triangles beside it is flat.
    fn moebius(count: u32) -> TriMesh {
        let at = |i: u32, side: u32| if i < count { 2 * i + side } else { 2 * (i - count) + 1 - side };
        let triangles =
            (0..count).flat_map(|i| [[at(i, 0), at(i + 1, 0), at(i + 1, 1)], [at(i, 0), at(i + 1, 1), at(i, 1)]]);
        let positions = (0..2 * count).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
        TriMesh::try_new(positions, triangles.collect()).unwrap()
    }

    #[test]
    fn a_moebius_strip_has_a_ring_that_turns_over() {
        let strip = moebius(7);
        let error = OrientFaces::new().convert(&strip).unwrap_err();
        let found = error.diagnostic().to_string();
        assert!(found.starts_with("faces "), "{found}");
        assert_eq!(error.diagnostic().code(), "E-structure-one-sided");
        // All triangles are in the ring, as the strip is one triangle wide.
        let ring = Orientation::of::<StructureError>(&strip, &Exec::default()).unwrap().one_sided;
        assert_eq!((ring.len(), ring[0].1.len()), (1, 14));
        // Beside it a flat square with a turned triangle is still oriented if asked.
        let mut positions = strip.positions().to_vec();
        let first = positions.len() as u32;
        positions.extend([DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y]);
        let mut triangles = strip.triangles().to_vec();
        triangles.extend([[first, first + 1, first + 2], [first, first + 3, first + 2]]);
        let both = TriMesh::try_new(positions, triangles).unwrap();
        let left = OrientFaces { leave_one_sided: true, ..OrientFaces::new() }.convert(&both).unwrap();
        assert_eq!(left.value.triangles()[..14], *strip.triangles());
        assert_eq!(left.value.triangles()[15], [first, first + 2, first + 3]);
        assert_eq!(left.report.findings.iter().count(), 1);
    }
}
