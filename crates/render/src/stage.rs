//! A scene made ready: one hierarchy over all meshes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec, Hit, Interval, Ray, Rays, Reservation};
use shapeloom_spatial::TriangleBvh;

use crate::surface_point::SurfacePoint;
use crate::{RenderError, Scene, SceneMesh};

/// The scene with what all samples share.
pub(crate) struct Stage<'a> {
    bvh: TriangleBvh,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    meshes: &'a [SceneMesh],
    /// The first triangle of each mesh.
    starts: Vec<u32>,
    pub bounds: Aabb,
    center: DVec3,
    radius_squared: f64,
    /// How far rays start off the surface.
    pub lift: f64,
    _memory: Reservation,
}

impl<'a> Stage<'a> {
    /// Joins the meshes and builds the hierarchy.
    pub fn new(scene: &'a Scene, exec: &Exec) -> Result<Self, RenderError> {
        let (triangle_count, position_count) = scene.validate()?;
        let memory = exec.reserve((triangle_count * 12 + position_count * 24) as u64)?;
        let mut positions = Vec::with_capacity(position_count);
        let mut triangles = Vec::with_capacity(triangle_count);
        let mut starts = Vec::with_capacity(scene.surfaces.len());
        for mesh in &scene.surfaces {
            let base = positions.len() as u32;
            starts.push(triangles.len() as u32);
            positions.extend_from_slice(&mesh.positions);
            triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|corner| base + corner)));
        }
        let bvh = TriangleBvh::build(&positions, &triangles, exec)?;
        let bounds = bvh.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        // Far from the origin the rounding of coordinates, not the size of the shape, is what must be passed.
        let lift = (bounds.diagonal() * 1e-6).max(reach * 1e-14);
        Ok(Self {
            bvh,
            positions,
            triangles,
            meshes: &scene.surfaces,
            starts,
            bounds,
            center: bounds.center(),
            radius_squared: (bounds.diagonal() * 0.51).powi(2),
            lift,
            _memory: memory,
        })
    }

    /// The first hit of a ray from the camera.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        self.bvh.first_hit(ray)
    }

    /// Whether something stands within `reach` of `point` toward `direction`.
    ///
    /// `direction` is a unit vector.
    pub fn shadowed(&self, point: DVec3, direction: DVec3, reach: f64) -> bool {
        // Most rays from the ground pass the ball around the shape; a little more than it, for rounding.
        let to_center = self.center - point;
        let (along, far) = (to_center.dot(direction), to_center.length_squared());
        let outside = far > self.radius_squared;
        if outside && (along < 0.0 || far - along * along > self.radius_squared) {
            return false;
        }
        Ray::new(point, direction).is_ok_and(|ray| self.bvh.any_hit(&ray.within(Interval::new(0.0, reach))))
    }

    /// The mesh of an element, and the element's place in it.
    pub fn owner(&self, element: u32) -> (&'a SceneMesh, usize) {
        let mesh = self.starts.partition_point(|&start| start <= element) - 1;
        (&self.meshes[mesh], (element - self.starts[mesh]) as usize)
    }

    /// The corners of an element.
    pub fn corners(&self, element: u32) -> [DVec3; 3] {
        self.triangles[element as usize].map(|corner| self.positions[corner as usize])
    }

    /// What shading needs to know of a hit; `smooth` asks for interpolated normals.
    pub fn surface_point(&self, ray: &Ray, hit: &Hit, smooth: bool) -> SurfacePoint {
        let (mesh, triangle) = self.owner(hit.element);
        let normals = mesh.normals.as_ref().filter(|_| smooth);
        let normals = normals.map(|normals| std::array::from_fn(|corner| normals[3 * triangle + corner]));
        SurfacePoint::new(&self.corners(hit.element), normals, ray, hit)
    }
}
