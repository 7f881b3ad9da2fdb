//! Normals of a field's surface.

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{CHUNK, fill_chunks};
use shapeloom_core::{Aabb, ConvertError, Exec, Field, Stop};
use shapeloom_mesh::{Blend, Column, Domain, MeshError, NORMAL, TransformRule, TriMesh, Values};

use super::measured::on_side;

/// Gives vertices normals: the field's gradient, or where there is none and on the sides of `region`, where the solid is cut off, the
/// mean of the triangles there by area.
pub(super) fn attach<F: Field + ?Sized>(
    mesh: &mut TriMesh,
    field: &F,
    region: &Aabb,
    exec: &Exec,
) -> Result<(), ConvertError> {
    let _of_normals = exec.reserve_elements(mesh.positions().len() as u64, size_of::<DVec3>())?;
    let mut normals = vec![DVec3::ZERO; mesh.positions().len()];
    for (index, corners) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(index);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|&corner| normals[corner as usize] += normal);
    }
    let rounding = 1e-9 * region.size().max_element();
    let positions = mesh.positions();
    fill_chunks(exec, &mut normals, CHUNK / 8, |first, part| {
        for (normal, &point) in part.iter_mut().zip(&positions[first..]) {
            let gradient = if on_side(region, point, rounding) { DVec3::ZERO } else { field.gradient(point) };
            let unit = (gradient / gradient.abs().max_element()).try_normalize();
            *normal = unit.or_else(|| (*normal / normal.abs().max_element()).try_normalize()).unwrap_or(DVec3::Z);
        }
        Ok::<(), Stop>(())
    })?;
    let numbers = normals.into_iter().flat_map(|normal| normal.to_array()).collect();
    let column = Column::try_new(NORMAL, 3, Values::F64(numbers)).map_err(MeshError::from)?;
    let column = column.with_blend(Blend::Direction).with_transform(TransformRule::Normal);
    mesh.insert_attribute(Domain::Vertex, column).map_err(MeshError::from)?;
    Ok(())
}
