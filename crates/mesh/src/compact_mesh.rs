//! Triangle meshes in few bits.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Loss, Options, Place, Report, Severity,
    options,
};

use crate::normals::length;
use crate::{Domain, MeshError, TriMesh};

options! {
    /// Rounds the positions of a triangle mesh to a number of bits for each coordinate, as a compact store keeps them.
    ///
    /// Each coordinate becomes one of 2ⁿ equal steps across the bounding box, so a vertex moves by at most half the diagonal
    /// of a step; the report has the largest move. `pack` gives the store itself: a `CompactMesh`. As a conversion the
    /// mesh comes back out of it, with its attributes. Cost: linear.
    pub struct Compact("compact") {
        required {
            /// Bits for each coordinate.
            bits: u32 [Bounds::closed(1.0, 32.0)],
        }
        optional {}
    }
}

/// The fewest bits whose steps keep vertices within the tolerance; 32 at most. Far from the origin numbers themselves may be
/// coarser than the tolerance: then no bits keep vertices within it, and the report has how far they move.
impl FromTolerance<TriMesh> for Compact {
    fn from_tolerance(source: &TriMesh, tolerance: f64) -> Self {
        let bounds = source.bounds();
        let half = if bounds.is_empty() { 0.0 } else { ((bounds.max * 0.5 - bounds.min * 0.5) / tolerance).length() };
        // One step in a thousand is kept for rounding.
        Self::new((1..32).find(|&bits| half * 1.001 <= steps(bits)).unwrap_or(32))
    }
}

/// How many steps that many bits tell apart.
fn steps(bits: u32) -> f64 {
    ((1u64 << bits) - 1) as f64
}

/// A triangle mesh with coordinates of n bits and vertex numbers of ⌈log₂ V⌉ bits, packed bit by bit.
///
/// With twice as many triangles as vertices, as in a large closed mesh, that is 3n + 6⌈log₂ V⌉ bits a vertex. Each position
/// and triangle is read in constant time. It has no attributes.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactMesh {
    bits: u32,
    index_bits: u32,
    vertices: u32,
    triangles: u32,
    lowest: DVec3,
    /// Half, because a step of one bit across all numbers is none.
    half_step: DVec3,
    coordinates: Vec<u64>,
    indices: Vec<u64>,
}

/// Numbers of the same few bits one after the other.
fn write(words: &mut [u64], number: u64, bits: u32, value: u64) {
    let start = number * u64::from(bits);
    let (word, shift) = ((start / 64) as usize, start % 64);
    words[word] |= value << shift;
    if shift + u64::from(bits) > 64 {
        words[word + 1] |= value >> (64 - shift);
    }
}

fn read(words: &[u64], number: u64, bits: u32) -> u64 {
    if bits == 0 {
        return 0;
    }
    let start = number * u64::from(bits);
    let (word, shift) = ((start / 64) as usize, start % 64);
    let low = words[word] >> shift;
    let value = if shift + u64::from(bits) > 64 { low | words[word + 1] << (64 - shift) } else { low };
    value & ((1 << bits) - 1)
}

fn words(count: u64, bits: u32) -> u64 {
    (count * u64::from(bits)).div_ceil(64)
}

impl Compact {
    /// Packs a mesh. The report has the largest move of a vertex, counts as findings the triangles that collapse because
    /// their corners become one, and names the attributes as lost.
    ///
    /// # Errors
    /// Bits out of bounds; a position that is not finite; over the memory budget; cancellation.
    pub fn pack(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<CompactMesh>, ConvertError> {
        self.validate()?;
        if let Some(vertex) = source.first_non_finite() {
            return Err(MeshError::NotFinite { kind: "vertex", index: vertex as u64 }.into());
        }
        let (vertices, triangles) = (source.positions().len() as u64, source.triangles().len() as u64);
        // ⌈log₂ V⌉: none tell one vertex from itself.
        let index_bits = 64 - vertices.saturating_sub(1).leading_zeros();
        let sizes = [words(3 * vertices, self.bits), words(3 * triangles, index_bits)];
        let _memory = exec.reserve_elements(sizes[0] + sizes[1], 8)?;
        exec.check()?;
        let bounds = source.bounds();
        let (lowest, highest) = if vertices > 0 { (bounds.min, bounds.max) } else { (DVec3::ZERO, DVec3::ZERO) };
        let most = steps(self.bits);
        let mut made = CompactMesh {
            bits: self.bits,
            index_bits,
            vertices: vertices as u32,
            triangles: triangles as u32,
            lowest,
            half_step: highest * 0.5 / most - lowest * 0.5 / most,
            coordinates: vec![0; sizes[0] as usize],
            indices: vec![0; sizes[1] as usize],
        };
        let mut moved = 0.0f64;
        for (vertex, &position) in source.positions().iter().enumerate() {
            if vertex.is_multiple_of(4096) {
                exec.check()?;
                exec.progress(vertex as f64 / vertices as f64 * 0.5);
            }
            // Halves, because the difference of two numbers may be none.
            let from_lowest = position * 0.5 - lowest * 0.5;
            for axis in 0..3 {
                let step = made.half_step[axis];
                let steps = if step > 0.0 { (from_lowest[axis] / step).round().clamp(0.0, most) } else { 0.0 };
                write(&mut made.coordinates, 3 * vertex as u64 + axis as u64, self.bits, steps as u64);
            }
            moved = moved.max(2.0 * length(made.unpacked(vertex as u64) * 0.5 - position * 0.5));
        }
        let mut report = Report::exact(Compact::NAME, "every position is a step of the store");
        let bound = moved * (1.0 + 8.0 * f64::EPSILON);
        if bound.is_infinite() {
            report.deviation = Deviation::Unknown;
            report.basis = "a vertex moves as far as the largest number, or farther".to_owned();
        } else if moved > 0.0 {
            report.deviation = Deviation::AtMost(bound);
            report.basis = "the largest move of a vertex, at most half the diagonal of a step and rounding".to_owned();
        }
        for (triangle, corners) in source.triangles().iter().enumerate() {
            if triangle.is_multiple_of(4096) {
                exec.check()?;
                exec.progress(0.5 + triangle as f64 / triangles as f64 * 0.5);
            }
            if index_bits > 0 {
                for (corner, &vertex) in corners.iter().enumerate() {
                    write(&mut made.indices, 3 * triangle as u64 + corner as u64, index_bits, u64::from(vertex));
                }
            }
            let [a, b, c] = source.corners(triangle);
            let [p, q, r] = corners.map(|vertex| made.unpacked(u64::from(vertex)));
            let one = |a: DVec3, b: DVec3, c: DVec3| a == b || b == c || c == a;
            if one(p, q, r) && !one(a, b, c) {
                let place = Place::element("triangle", triangle as u64);
                let message = "triangles collapsed, because two of their corners are the same step of the store";
                report.findings.push("W-compact-collapsed", Severity::Warning, place, message);
            }
        }
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            let attributes = source.attributes().of(domain);
            let names = attributes.iter().map(|column| format!("{domain} attribute \"{}\"", column.name()));
            let lists = attributes.lists().iter().map(|list| format!("{domain} list \"{}\"", list.name()));
            report.losses.extend(names.chain(lists).map(|what| Loss::new(what, "a compact store has no attributes")));
        }
        report.figure("half_step_diagonal", length(made.half_step));
        report.figure("bits_a_vertex", made.bits_stored() as f64 / vertices.max(1) as f64);
        report.figure("bytes", made.memory_bytes() as f64);
        let before = size_of_val(source.positions()) + size_of_val(source.triangles());
        report.figure("bytes_before", before as f64);
        Ok(Converted::new(made, report))
    }
}

/// Into the store and out of it. The triangles and vertices are the same, so attributes stay.
impl Convert<TriMesh> for Compact {
    type Output = TriMesh;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        let Converted { value: store, mut report } = self.pack(source, exec)?;
        let _memory = exec.reserve((source.memory_bytes() as u64).saturating_add(store.memory_bytes() as u64))?;
        report.losses.clear();
        let mut positions = Vec::with_capacity(store.vertices as usize);
        for vertex in 0..u64::from(store.vertices) {
            if vertex.is_multiple_of(4096) {
                exec.check()?;
            }
            positions.push(store.unpacked(vertex));
        }
        exec.check()?;
        let mesh = TriMesh::with_attributes(positions, source.triangles().to_vec(), source.attributes().clone())?;
        Ok(Converted::new(mesh, report))
    }
}

impl CompactMesh {
    /// Bits for each coordinate.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// Bits for each corner of a triangle.
    pub fn index_bits(&self) -> u32 {
        self.index_bits
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> u32 {
        self.vertices
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> u32 {
        self.triangles
    }

    /// How far apart neighbouring positions are along each axis; the largest number where that is more.
    pub fn step(&self) -> DVec3 {
        (self.half_step * 2.0).min(DVec3::MAX)
    }

    fn unpacked(&self, vertex: u64) -> DVec3 {
        let at = |axis: u64| read(&self.coordinates, 3 * vertex + axis, self.bits) as f64;
        let half_way = self.half_step * DVec3::new(at(0), at(1), at(2));
        // Rounding may take the last step past all numbers.
        (self.lowest + half_way + half_way).min(DVec3::MAX)
    }

    /// The position of a vertex, in constant time; none if there is no such vertex.
    pub fn position(&self, vertex: u32) -> Option<DVec3> {
        (vertex < self.vertices).then(|| self.unpacked(u64::from(vertex)))
    }

    /// The vertices of a triangle, in constant time; none if there is no such triangle.
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        let corner = |corner: u64| read(&self.indices, 3 * u64::from(triangle) + corner, self.index_bits) as u32;
        (triangle < self.triangles).then(|| [corner(0), corner(1), corner(2)])
    }

    /// The bits of coordinates and vertex numbers, without the words that they fill up.
    pub fn bits_stored(&self) -> u64 {
        3 * u64::from(self.vertices) * u64::from(self.bits) + 3 * u64::from(self.triangles) * u64::from(self.index_bits)
    }

    /// The memory that the store takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(self.coordinates.as_slice()) + size_of_val(self.indices.as_slice())
    }
}

/// The mesh with the positions and triangles of the store.
impl From<&CompactMesh> for TriMesh {
    fn from(store: &CompactMesh) -> Self {
        let positions = (0..store.vertices).filter_map(|vertex| store.position(vertex)).collect();
        let triangles = (0..store.triangles).filter_map(|triangle| store.triangle(triangle)).collect();
        TriMesh::try_new(positions, triangles).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::Torus;
    use crate::{Column, TriangulatePolygons};
    use shapeloom_core::Affine;

    fn torus() -> TriMesh {
        let mesh = Torus { segments: 64, sides: 32, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
        TriangulatePolygons::new().convert(&mesh).unwrap().value
    }

    #[test]
    fn bits_are_those_of_theory_and_moves_within_half_a_step() {
        let mesh = torus();
        let (v, f) = (mesh.positions().len() as u64, mesh.triangles().len() as u64);
        assert_eq!((v, f), (2048, 4096));
        for bits in 1..=32 {
            let Converted { value: store, report } = Compact::new(bits).pack(&mesh, &Exec::default()).unwrap();
            // 3n + 6⌈log₂ V⌉.
            assert_eq!(store.bits_stored(), v * (3 * u64::from(bits) + 6 * 11));
            assert!(store.memory_bytes() as u64 * 8 < store.bits_stored() + 2 * 64 + 8 * 160);
            assert!(store.memory_bytes() < mesh.memory_bytes() / 2);
            let half = (mesh.bounds().size() / (2f64.powi(bits as i32) - 1.0)).length() / 2.0;
            let Deviation::AtMost(bound) = report.deviation else { panic!("a bound") };
            let moved = (0..v as u32)
                .map(|vertex| store.position(vertex).unwrap().distance(mesh.positions()[vertex as usize]))
                .fold(0.0, f64::max);
            assert!(moved <= bound && bound <= half * (1.0 + 1e-6) && bound > 0.5 * half, "{bits} {bound} {half}");
            assert!((0..f as u32).all(|t| store.triangle(t) == Some(mesh.triangles()[t as usize])));
            let back = TriMesh::from(&store);
            assert_eq!(back.triangles(), mesh.triangles());
            assert_eq!(back.positions()[77], store.position(77).unwrap());
            // Nothing moves a second time.
            let again = Compact::new(bits).pack(&back, &Exec::default()).unwrap();
            assert!(again.report.deviation.value().unwrap() <= 1e-15);
            assert_eq!((store.position(2048), store.triangle(4096)), (None, None));
        }
    }

    #[test]
    fn attributes_are_named_as_lost_by_the_store_and_kept_by_the_conversion() {
        let mut mesh = torus();
        mesh.insert_attribute(Domain::Face, Column::labels("side", (0..4096).collect())).unwrap();
        let lost = Compact::new(8).pack(&mesh, &Exec::default()).unwrap().report.losses;
        assert!(lost.iter().any(|loss| loss.what == "face attribute \"side\""));
        assert_eq!(lost.len(), mesh.attributes().of(Domain::Wedge).iter().len() + 1);
        let made = Compact::new(8).convert(&mesh).unwrap();
        assert!(made.report.losses.is_empty());
        assert_eq!(made.value.attributes(), mesh.attributes());
        let coarse = Compact::new(1).convert(&mesh).unwrap();
        assert_eq!(coarse.report.findings.iter().next().unwrap().code, "W-compact-collapsed");
        for tolerance in [0.5, 1e-2, 1e-5, 1e-8] {
            let made = Compact::from_tolerance(&mesh, tolerance).convert(&mesh).unwrap();
            assert!(made.report.deviation.is_within(tolerance), "{tolerance}");
        }
    }

    #[test]
    fn few_vertices_flat_boxes_and_far_places() {
        let empty = Compact::new(9).pack(&TriMesh::default(), &Exec::default()).unwrap().value;
        assert_eq!((empty.vertex_count(), empty.bits_stored(), TriMesh::from(&empty)), (0, 0, TriMesh::default()));
        for (count, index_bits) in [(1u32, 0), (2, 1), (3, 2), (4, 2), (5, 3), (1025, 11)] {
            let positions: Vec<DVec3> = (0..count).map(|k| DVec3::new(f64::from(k), 7.0, 0.0)).collect();
            let triangles = vec![[0, count - 1, count / 2]; 3];
            let mesh = TriMesh::try_new(positions, triangles.clone()).unwrap();
            let store = Compact::new(32).pack(&mesh, &Exec::default()).unwrap().value;
            assert_eq!(store.index_bits(), index_bits);
            assert_eq!((0..3).filter_map(|t| store.triangle(t)).collect::<Vec<_>>(), triangles);
            // Axes without extent are exact.
            assert!((0..count).all(|v| store.position(v).is_some_and(|p| (p.y, p.z) == (7.0, 0.0))));
        }
        for map in [
            Affine::from_translation(DVec3::splat(5e6)),
            Affine::from_scale(DVec3::splat(1e150)),
            Affine::from_scale(DVec3::splat(1e-300)),
            Affine::from_scale(DVec3::splat(1.1e308)),
        ] {
            let mesh = torus().transformed(&map);
            for bits in [1, 12, 31, 32] {
                let made = Compact::new(bits).convert(&mesh).unwrap();
                let half = made.report.find("half_step_diagonal").unwrap();
                // Moves may be farther than any number.
                let Some(bound) = made.report.deviation.value() else {
                    assert!(bits == 1 && half.is_infinite());
                    continue;
                };
                // Far away numbers themselves are coarser than steps.
                let rounding = 2e-16 * mesh.bounds().max.abs().max_element() * 2.0;
                assert!(bound <= half * (1.0 + 1e-6) + rounding, "{bits} {bound} {half}");
                let moves =
                    mesh.positions().iter().zip(made.value.positions()).map(|(a, b)| (*a - *b).abs().max_element());
                assert!(moves.fold(0.0, f64::max) <= bound);
            }
        }
        let nan = TriMesh::try_new(vec![DVec3::NAN], vec![]).unwrap();
        assert!(Compact::new(8).pack(&nan, &Exec::default()).is_err());
        assert!(Compact::new(0).pack(&nan, &Exec::default()).is_err());
        assert!(Compact::new(33).pack(&nan, &Exec::default()).is_err());
    }

    #[test]
    fn boxes_across_all_numbers_have_finite_places() {
        for most in [1.7e308, f64::MAX] {
            let positions = [-most, most, 0.0, most / 3.0].map(|x| DVec3::new(x, 0.0, 0.0)).to_vec();
            let mesh = TriMesh::try_new(positions, vec![[0, 1, 2]]).unwrap();
            for bits in 1..=32 {
                let Converted { value: store, report } = Compact::new(bits).pack(&mesh, &Exec::default()).unwrap();
                for vertex in 0..4 {
                    assert!(store.position(vertex).unwrap().is_finite(), "{most} {bits} {vertex}");
                }
                assert!(store.step().is_finite(), "{most} {bits} {}", store.step());
                // With one bit the vertex in the middle goes to an end.
                let farthest = bits == 1 && most == f64::MAX;
                assert_eq!(report.deviation.value().is_some_and(f64::is_finite), !farthest, "{most} {bits}");
                assert!(!farthest || report.deviation == Deviation::Unknown);
            }
        }
    }

    #[test]
    fn the_store_counts_while_the_mesh_is_made() {
        let mesh = torus();
        let store = Compact::new(32).pack(&mesh, &Exec::default()).unwrap().value.memory_bytes() as u64;
        let bytes = mesh.memory_bytes() as u64;
        let with = |memory: u64| Compact::new(32).convert_with(&mesh, &Exec::default().with_memory(memory));
        assert!(with(bytes).is_err() && with(bytes + store - 1).is_err() && with(bytes + store).is_ok());
        let packed = crate::poll_count::polls(&|exec| drop(Compact::new(9).pack(&mesh, exec).unwrap()));
        let converted = crate::poll_count::polls(&|exec| drop(Compact::new(9).convert_with(&mesh, exec).unwrap()));
        assert!(converted > packed);
    }
}
