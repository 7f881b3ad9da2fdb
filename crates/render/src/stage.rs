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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{ball, scene, square};
    use crate::sampling::{cosine_direction, hash, shift};

    #[test]
    fn shadows_are_those_of_all_triangles() {
        let mut other = square();
        other.positions.iter_mut().for_each(|p| *p = *p * 0.3 + DVec3::new(1.5, 0.0, 2.0));
        let mut shape = scene(ball(8));
        shape.surfaces.push(other);
        let stage = Stage::new(&shape, &Exec::default()).unwrap();
        let mut dark = 0;
        for i in 0..4000 {
            let [a, b, c] = [1, 2, 3].map(|stream| shift(hash(i, stream)));
            let point = DVec3::new(a.x, a.y, b.x) * 8.0 - DVec3::splat(4.0);
            let direction = cosine_direction(c) * if i % 2 == 0 { 1.0 } else { -1.0 };
            let wanted = stage.bvh.any_hit(&Ray::new(point, direction).unwrap());
            assert_eq!(stage.shadowed(point, direction, f64::INFINITY), wanted, "{point} {direction}");
            dark += usize::from(wanted);
        }
        assert!(dark > 100, "{dark}");
    }

    #[test]
    fn elements_belong_to_their_meshes() {
        let mut shape = scene(square());
        shape.surfaces.push(SceneMesh::new(vec![], vec![]));
        shape.surfaces.push(SceneMesh { color: [1.0, 0.0, 0.0], ..square() });
        let stage = Stage::new(&shape, &Exec::default()).unwrap();
        let places: Vec<(f32, usize)> = (0..4).map(|i| stage.owner(i)).map(|(mesh, i)| (mesh.color[0], i)).collect();
        let blue = SceneMesh::GLAZE[0];
        assert_eq!(places, [(blue, 0), (blue, 1), (1.0, 0), (1.0, 1)]);
        assert_eq!(stage.corners(3), stage.corners(1));
    }
}
