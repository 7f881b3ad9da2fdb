//! The list of converters: a new one is one line here.

use shapeloom_core::glam::DVec3;
use shapeloom_implicit::{Implicit, SampledSurface};
use shapeloom_mesh::{
    Compact, ConstrainedDelaunay, DelaunayTriangulation, GeometricGraph, GreedyInsertion, HeightField, OrientFaces,
    PlanarizeQuads, PointCloud, PolyMesh, Polyline, TriMesh, TriangulateHeightField, TriangulatePolygons,
    TriangulateRegion, VertexNormals, Weld,
};
use shapeloom_parametric::{BezierCurve, BezierSurface, TessellateCurve, TessellatePatches};
use shapeloom_voxels::isosurface::{
    DualContouring, ManifoldSurfaceNets, MarchingCubes, MarchingTetrahedra, SurfaceNets,
};
use shapeloom_voxels::{
    CellFaces, CurvatureFlow, MeshToDistance, OffsetLevelSet, PointsToGrid, Redistance, VoxelGrid, VoxelizeMesh,
};

use crate::registry::{Converter, Effect, entry};

/// Makes the list of every converter: across kinds first, then within one.
pub fn catalog() -> Vec<Converter> {
    vec![
        entry::<TessellatePatches, BezierSurface>(Effect::WithinTolerance),
        entry::<TessellateCurve, BezierCurve<DVec3>>(Effect::WithinTolerance),
        entry::<SampledSurface, Implicit>(Effect::Reported),
        entry::<ManifoldSurfaceNets, VoxelGrid>(Effect::Reported),
        entry::<SurfaceNets, VoxelGrid>(Effect::Reported),
        entry::<DualContouring, VoxelGrid>(Effect::Reported),
        entry::<TriangulatePolygons, PolyMesh>(Effect::Reported),
        entry::<GreedyInsertion, HeightField>(Effect::WithinTolerance),
        entry::<TriangulateHeightField, HeightField>(Effect::Reported),
        entry::<MarchingCubes, VoxelGrid>(Effect::Reported),
        entry::<MarchingTetrahedra, VoxelGrid>(Effect::Reported),
        entry::<PlanarizeQuads, PolyMesh>(Effect::Reported),
        entry::<DelaunayTriangulation, PointCloud>(Effect::Reported).only_by_name(),
        entry::<ConstrainedDelaunay, GeometricGraph>(Effect::Reported).only_by_name(),
        entry::<TriangulateRegion, Polyline>(Effect::Reported).only_by_name(),
        entry::<MeshToDistance, TriMesh>(Effect::Reported).only_by_name(),
        entry::<VoxelizeMesh, TriMesh>(Effect::Reported).only_by_name(),
        entry::<PointsToGrid, PointCloud>(Effect::Reported).only_by_name(),
        entry::<CellFaces, VoxelGrid>(Effect::Reported).only_by_name(),
        entry::<Weld, TriMesh>(Effect::Reported),
        entry::<Weld, PolyMesh>(Effect::Reported),
        entry::<OrientFaces, TriMesh>(Effect::Exact),
        entry::<OrientFaces, PolyMesh>(Effect::Exact),
        entry::<Compact, TriMesh>(Effect::WithinTolerance),
        entry::<VertexNormals, TriMesh>(Effect::Exact),
        entry::<Redistance, VoxelGrid>(Effect::Reported),
        entry::<OffsetLevelSet, VoxelGrid>(Effect::Reported).asks_for(&["distance"]),
        entry::<CurvatureFlow, VoxelGrid>(Effect::Reported),
    ]
}
