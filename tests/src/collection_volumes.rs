//! Real volumes, where the collection is there, with figures of other programs: VTK 9 and numpy.

use shapeloom::core::Exec;
use shapeloom::core::glam::DVec3;
use shapeloom::io::ReadShape;
use shapeloom::shape::Geometry;
use shapeloom::voxels::VoxelGrid;
use shapeloom::voxels::isosurface::sample_range;

use crate::collection::read_file;
use crate::support::shared_data;

/// The only grid of a file.
fn grid(read: &ReadShape) -> &VoxelGrid {
    match &*read.shape.parts[0].geometry {
        Geometry::VoxelGrid(grid) if read.shape.parts.len() == 1 => grid,
        other => panic!("a {} beside others", other.kind()),
    }
}

/// Sum of the samples, and of each times its place modulo 1009, as VTK's readers and numpy have it: another order of samples
/// or bytes has another sum.
#[test]
fn every_volume_is_what_other_programs_read() {
    let ball = ([30, 30, 30], 1.0, [0.0, 257.0], 3_682_296.0, 1_863_053_909.0);
    for (name, (dimensions, spacing, range, sum, weighted)) in [
        ("BallBinary30x30x30.nhdr", ball),
        ("BallBinary30x30x30.nrrd", ball),
        ("BallBinary30x30x30_gz.nrrd", ball),
        ("tooth.nrrd", ([103, 94, 161], 1.0, [0.0, 255.0], 160_814_065.0, 81_044_777_229.0)),
        ("HeadMRVolume.mhd", ([48, 62, 42], 4.0, [0.0, 255.0], 3_058_332.0, 1_540_839_958.0)),
        ("hydrogen.vti", ([64, 64, 64], 1.0, [0.0, 1.0], 4_856.008_970_333_326, 2_390_263.469_722_515)),
        ("ironProt.vtk", ([68, 68, 68], 1.0, [0.0, 255.0], 4_131_089.0, 2_081_470_883.0)),
        ("neghip.slc", ([66, 66, 66], 1.0, [0.0, 255.0], 4_824_177.0, 2_433_105_574.0)),
    ] {
        let Some(path) = shared_data(&format!("volumes/{name}")) else { continue };
        let read = read_file(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(read.findings.is_empty(), "{name}: {:?}", read.findings);
        let grid = grid(&read);
        assert_eq!(grid.lattice().dimensions(), dimensions, "{name}");
        assert_eq!(grid.lattice().steps(), [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * spacing), "{name}");
        assert_eq!(grid.lattice().position([0; 3]), DVec3::ZERO, "{name}");
        assert_eq!(sample_range(grid, &Exec::default()).unwrap().finite, Some(range), "{name}");
        let samples = (0..grid.lattice().samples()).map(|at| (at, f64::from(grid.samples().get(at))));
        let (mut all, mut all_weighted) = (0.0, 0.0);
        for (at, sample) in samples {
            all += sample;
            all_weighted += sample * (at % 1009) as f64;
        }
        // Floating sums depend on their order by some ulps; whole ones are exact.
        assert!((all - sum).abs() <= 1e-10 * sum, "{name}: {all}");
        assert!((all_weighted - weighted).abs() <= 1e-10 * weighted, "{name}: {all_weighted}");
    }
}
