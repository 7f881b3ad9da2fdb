//! The list of converters: a new one is one line here.

use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{
    ConstrainedDelaunay, DelaunayTriangulation, GeometricGraph, HeightField, PointCloud, PolyMesh, Polyline, TriMesh,
    TriangulateHeightField, TriangulatePolygons, TriangulateRegion, VertexNormals, Weld,
};
use shapeloom_parametric::{BezierCurve, BezierSurface, TessellateCurve, TessellatePatches};

use crate::registry::{Converter, Effect, entry};

/// Makes the list of every converter: across kinds first, then within one.
pub fn catalog() -> Vec<Converter> {
    vec![
        entry::<TessellatePatches, BezierSurface>(Effect::WithinTolerance),
        entry::<TessellateCurve, BezierCurve<DVec3>>(Effect::WithinTolerance),
        entry::<TriangulatePolygons, PolyMesh>(Effect::Reported),
        entry::<TriangulateHeightField, HeightField>(Effect::Reported),
        entry::<DelaunayTriangulation, PointCloud>(Effect::Reported).only_by_name(),
        entry::<ConstrainedDelaunay, GeometricGraph>(Effect::Reported).only_by_name(),
        entry::<TriangulateRegion, Polyline>(Effect::Reported).only_by_name(),
        entry::<Weld, TriMesh>(Effect::Reported),
        entry::<VertexNormals, TriMesh>(Effect::Exact),
    ]
}
