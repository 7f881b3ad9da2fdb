//! Surface nets of the crate fast-surface-nets.

use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, ConvertError, Converted, Exec, FromTolerance, Options, Place, Severity, options};
use shapeloom_mesh::{MeshError, TriMesh};

use crate::dual::DualSurface;
use crate::result::finish;
use crate::{Border, Inside, InsideChoice, IsoValue, LatticeError, Level, Slabs};

options! {
    /// Surface nets of samples by the crate fast-surface-nets: one vertex a cell, the mean of where the surface crosses its edges
    /// (Gibson 1998).
    ///
    /// On rough samples the result is not manifold: where two pieces of the surface pass through one cell they share its vertex, and
    /// edges may have four triangles, which the report counts. The manifold surface nets have a vertex for each piece. Magnitudes are
    /// limited to 1e30, positions in the lattice are of single precision, and samples that are not finite are outside ones with the
    /// crossing at the finite end. Cost: linear; 8 bytes a sample beyond input and output; it cannot be stopped while the crate works.
    pub struct SurfaceNets("surface-nets") {
        required {}
        optional {
            /// The value that the surface is drawn at; `auto` is 0 for distances, a half for occupancy, else Otsu's threshold.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of it the inside is; `auto` is below for distances, above for densities.
            inside: InsideChoice = InsideChoice::Auto,
            /// Whether the surface is closed where the inside reaches the border of the lattice.
            border: Border = Border::Closed,
            /// Whether vertices get normals, from differences of samples.
            normals: bool = false,
        }
    }
}

/// What outside samples around the lattice have: so much that edges to them are crossed at their other end.
const OUTSIDE: f32 = 1e37;

/// The largest magnitude of the lattice's own samples.
const LARGEST: f32 = 1e30;

impl<S: Slabs + ?Sized> FromTolerance<S> for SurfaceNets {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl<S: Slabs + ?Sized> Convert<S> for SurfaceNets {
    type Output = TriMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (level, how) = Level::settle(source, self.iso, self.inside, exec)?;
        let lattice = source.lattice();
        let dimensions = lattice.dimensions();
        // The crate leaves out quads at the far side, so there is always one more layer there.
        let low = u32::from(self.border == Border::Closed);
        let sides = dimensions.map(|count| u64::from(count) + 2 * u64::from(low) + 1);
        let padded: u64 = sides.iter().product();
        if padded >= u64::from(u32::MAX) {
            return Err(MeshError::TooMany { kind: "samples", found: padded }.into());
        }
        let sides = sides.map(|side| side as u32);
        let _memory = exec.reserve_elements(padded, 8)?;
        let (samples, not_finite) = padded_samples(source, level, low, sides, exec)?;

        let mut buffer = SurfaceNetsBuffer::default();
        let shape = RuntimeShape::<u32, 3>::new(sides);
        surface_nets(&samples, &shape, [0; 3], sides.map(|side| side - 1), &mut buffer);
        exec.check()?;
        drop(samples);

        let count = buffer.positions.len() as u64;
        let corners = buffer.indices.len() as u64;
        let _mesh_memory = exec.reserve((count * 48).saturating_add(corners * 16))?;
        // An open surface ends with the cells of the lattice.
        let last = dimensions.map(|count| count - 1);
        let beyond = |corner: u32| {
            let cell = buffer.surface_points.get(corner as usize).copied().unwrap_or_default();
            low == 0 && (0..3).any(|axis| cell[axis] >= last[axis])
        };
        let mirrored = lattice.placement().reverses_orientation();
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(buffer.indices.len() / 3);
        for &[a, b, c] in buffer.indices.as_chunks().0 {
            if ![a, b, c].into_iter().any(beyond) {
                triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
            }
        }
        let place = |position: &[f32; 3]| {
            lattice.placement().point(DVec3::from(position.map(f64::from)) - DVec3::splat(f64::from(low)))
        };
        let normal = |normal: &[f32; 3]| {
            let normal = lattice.placement().normal(DVec3::from(normal.map(f64::from)));
            if normal == DVec3::ZERO { [0.0, 0.0, 1.0] } else { normal.to_array() }
        };
        let mut surface = DualSurface {
            positions: buffer.positions.iter().map(place).collect(),
            normals: if self.normals { buffer.normals.iter().map(normal).collect() } else { Vec::new() },
            triangles,
            not_finite,
            held: 0,
        };
        drop(buffer);
        surface.drop_unused(exec)?;
        let shared = shared_edges(&surface.triangles, exec)?;
        let mut converted = finish(Self::NAME, source, surface, (level, how), self.border, exec)?;
        converted.report.figure("non_manifold_edges", shared as f64);
        if shared > 0 {
            let message = "edges with more than two triangles: pieces of the surface share a cell (the manifold surface nets part them)";
            converted.report.findings.push_many(
                "W-surface-nets-edges",
                Severity::Warning,
                Place::Whole,
                message,
                shared,
            );
        }
        Ok(converted)
    }
}

/// The samples with layers of outside ones around, smaller than 0 inside; and how many are not finite.
fn padded_samples<S: Slabs + ?Sized>(
    source: &S,
    level: Level,
    low: u32,
    sides: [u32; 3],
    exec: &Exec,
) -> Result<(Vec<f32>, u64), ConvertError> {
    let shape = RuntimeShape::<u32, 3>::new(sides);
    let mut padded = vec![OUTSIDE; shape.usize()];
    let [columns, _, slabs] = source.lattice().dimensions();
    let sign = if level.inside == Inside::Below { 1.0 } else { -1.0 };
    let mut not_finite = 0;
    let mut buffer = Vec::new();
    for k in 0..slabs {
        exec.check()?;
        exec.progress(0.5 * f64::from(k) / f64::from(slabs));
        let slab = source.slab(k, &mut buffer)?;
        let (expected, found) = (source.lattice().slab_len() as u64, slab.len() as u64);
        if expected != found {
            return Err(LatticeError::SampleCount { expected, found }.into());
        }
        for (j, row) in slab.chunks_exact(columns as usize).enumerate() {
            let start = shape.linearize([low, j as u32 + low, k + low]) as usize;
            for (to, &sample) in padded[start..][..row.len()].iter_mut().zip(row) {
                let value = ((sample - level.iso) * sign).clamp(-LARGEST, LARGEST);
                *to = if !sample.is_finite() {
                    not_finite += 1;
                    OUTSIDE
                } else if level.holds(sample) {
                    // Also where the iso value is infinite, or the difference rounds.
                    if value < 0.0 { value } else { -LARGEST }
                } else if value >= 0.0 {
                    value
                } else {
                    LARGEST
                };
            }
        }
    }
    Ok((padded, not_finite))
}

/// How many edges have more than two triangles.
fn shared_edges(triangles: &[[u32; 3]], exec: &Exec) -> Result<u64, ConvertError> {
    let _memory = exec.reserve_elements(triangles.len() as u64, 24)?;
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for triangles in triangles.chunks(1 << 16) {
        exec.check()?;
        for &[a, b, c] in triangles {
            edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| u64::from(p.min(q)) << 32 | u64::from(p.max(q))));
        }
    }
    exec.check()?;
    edges.sort_unstable();
    Ok(edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() > 2).count() as u64)
}
