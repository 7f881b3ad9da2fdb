//! Marching cubes.

use shapeloom_core::{Convert, ConvertError, Converted, Exec, FromTolerance, Options, choice, options};
use shapeloom_mesh::TriMesh;

use crate::cell_topology::CellTopology;
use crate::lattice_bits::LatticeBits;
use crate::marching::Marching;
use crate::marching_report::{finish, told};
use crate::pattern::cube_pattern;
use crate::{Border, InsideChoice, IsoValue, Level, Slabs};

choice! {
    /// What decides how the surface goes through a cell whose corners leave it open.
    pub enum Topology {
        /// A fixed rule: inside corners across a face are separated.
        Table = "table",
        /// The samples, so that the surface is joined as that of the trilinear interpolant, tunnels included.
        Exact = "exact",
    }
}

options! {
    /// Draws the surface where samples on a lattice reach a value, through each cell by itself, with a vertex on each crossed edge
    /// (marching cubes, Lorensen and Cline 1987).
    ///
    /// With a closed border the result is a closed, oriented 2-manifold for any samples; with an open one its only open edges are
    /// on the border. Each face of a cell is drawn by one rule, whichever cell looks at it, and no triangle has an edge inside a
    /// face, so neither cracks nor edges of four triangles arise. Triangles face outward, also where the lattice is mirrored.
    ///
    /// With exact topology faces follow the asymptotic decider (Nielson and Hamann 1991), and cells the trilinear
    /// interpolant, by slices (see Chernyaev 1995 for the cases, Grosso 2016 for the hexagon in a tunnel). Where the value at
    /// a saddle equals the iso value, the inside is separated.
    ///
    /// The deviation is that from the surface of the trilinear interpolant, of the solid cut off at the border where that is
    /// closed: at most the diagonal of a cell, as a cell has triangles exactly where it has some of that surface.
    ///
    /// Not guaranteed: triangles that do not meet inside a cell where sheets are close; triangles of positive area, as samples that
    /// equal the iso value draw several vertices to one place.
    ///
    /// Cost: each slab is read twice, with exact topology three times; about a quarter of a byte a sample beside the
    /// result where rows are long.
    pub struct MarchingCubes("marching-cubes") {
        required {}
        optional {
            /// The value that the surface is drawn at; by itself what the samples suggest.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of the value the inside is.
            inside: InsideChoice = InsideChoice::Auto,
            /// What the surface does at the border of the lattice.
            border: Border = Border::Closed,
            /// What decides how the surface goes through cells that their corners leave open.
            topology: Topology = Topology::Table,
            /// Whether vertices get normals, from differences of samples.
            normals: bool = false,
        }
    }
}

impl<S: Slabs + ?Sized> FromTolerance<S> for MarchingCubes {
    fn from_tolerance(_: &S, _: f64) -> Self {
        Self::new()
    }
}

impl<S: Slabs + ?Sized> Convert<S> for MarchingCubes {
    type Output = TriMesh;

    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let (level, how) = Level::settle(source, self.iso, self.inside, exec)?;
        let bits = LatticeBits::new(source.lattice(), self.border, exec)?;
        let mirrored = source.lattice().placement().reverses_orientation();
        let topology = (self.topology == Topology::Exact).then_some(CellTopology);
        let pattern = cube_pattern(mirrored);
        let normals = self.normals;
        let mut marching = Marching { slabs: source, level, bits, pattern, topology, mirrored, normals };
        let surface = marching.run(exec)?;
        let mut report = told(Self::NAME, source, level, &how, &marching.bits, &surface, exec)?;
        if topology.is_some() {
            report.figure("inner_vertices", surface.inner_vertices as f64);
        }
        Ok(Converted::new(finish(surface)?, report))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lattice;
    use shapeloom_core::glam::DVec3;
    use shapeloom_core::{Affine, Threads};
    use shapeloom_mesh::{Domain, NORMAL};

    struct Samples(Lattice, Vec<f32>);

    impl Slabs for Samples {
        fn lattice(&self) -> &Lattice {
            &self.0
        }

        fn slab<'a>(&'a self, k: u32, _: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
            let size = self.0.slab_len();
            Ok(&self.1[k as usize * size..][..size])
        }
    }

    /// With several threads blocks are made by themselves and put together; alone everything is written to its place.
    #[test]
    fn threads_do_not_matter() {
        let mut state = 3u32;
        let dimensions = [70, 11, 45];
        let mut samples = Vec::new();
        for _ in 0..70 * 11 * 45 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            samples.push((state >> 8) as f32 / 8e6 - 1.0);
        }
        let lattice = Lattice::try_new(dimensions, Affine::from_scale(DVec3::new(1.0, 2.0, -0.5))).unwrap();
        for (wild, topology, border) in [
            (false, Topology::Table, Border::Open),
            (false, Topology::Exact, Border::Closed),
            (true, Topology::Table, Border::Closed),
            (true, Topology::Exact, Border::Open),
        ] {
            let mut samples = Samples(lattice, samples.clone());
            if wild {
                samples.1[700] = f32::NAN;
            }
            let cubes = MarchingCubes { topology, border, normals: true, ..MarchingCubes::new() };
            let exec = Exec::default();
            let alone = cubes.convert_with(&samples, &exec.clone().with_threads(Threads::Sequential)).unwrap();
            let many = cubes.convert_with(&samples, &exec).unwrap();
            assert!(alone.value == many.value && alone.value.triangles().len() > 50_000);
            let Some(normals) = alone.value.attribute(Domain::Vertex, NORMAL) else { panic!("no normals") };
            assert_eq!(normals.len(), alone.value.positions().len());
            // Every vertex is on a line of the lattice, or inside a cell with exact topology.
            let off = |x: f64| (x - x.round()).abs() > 1e-9;
            for &position in alone.value.positions() {
                let [x, y, z] = [position.x, position.y / 2.0, position.z / -0.5];
                let several = [x, y, z].into_iter().filter(|&x| off(x)).count() > 1;
                assert!(!several || topology == Topology::Exact, "{position}");
            }
        }
    }
}
