//! What the colours of a picture say.

use clap::ValueEnum;
use shapeloom_core::{ClosestPoint, Exec, Stop, parallel};
use shapeloom_judge::Simplices;
use shapeloom_render::{Scene, sequential_color};
use shapeloom_spatial::TriangleBvh;

use crate::failure::Failure;

/// What the colours of a picture say. Further ways to colour, such as by curvature or by an attribute, belong here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorBy {
    /// The colours of materials
    #[default]
    Material,
    /// The distance to the shape of --reference
    Distance,
}

/// Triangles of a coloured picture are this part of the diagonal at most, so that colours vary within large ones, and
/// this many at most for each surface.
const EDGE: f64 = 1.0 / 100.0;
const MOST: usize = 500_000;

/// Colours every surface of a scene by its distance to a shape. Returns the distances that stand for the ends of the
/// colour map: those asked for, or from 0 to the largest at a vertex.
pub(crate) fn color_by_distance(
    scene: &mut Scene,
    to: &Simplices<'_>,
    range: Option<(f64, f64)>,
    exec: &Exec,
) -> Result<(f64, f64), Failure> {
    let edge = scene.bounds().diagonal() * EDGE;
    let most = scene.surfaces.iter().map(|surface| surface.triangles.len()).max().unwrap_or(0).max(MOST);
    // Positions, normals, colours, indices and the flags of sides.
    let _memory = exec.reserve_elements(most.saturating_mul(scene.surfaces.len().min(4)) as u64, 200)?;
    let bvh = TriangleBvh::build(&to.positions, &to.triangles, exec)?;
    let mut all = Vec::with_capacity(scene.surfaces.len());
    for surface in &mut scene.surfaces {
        *surface = surface.refined(edge, MOST);
        let mut distances = vec![0.0f64; surface.positions.len()];
        parallel::fill_chunks(exec, &mut distances, 256, |first, part| {
            for (position, distance) in surface.positions[first..].iter().zip(part) {
                *distance = bvh.closest(*position).map_or(f64::NAN, |closest| closest.distance_squared.sqrt());
            }
            Ok::<_, Stop>(())
        })?;
        all.push(distances);
    }
    let largest = all.iter().flatten().copied().fold(0.0, f64::max);
    let (from, upto) = range.unwrap_or((0.0, largest));
    for (surface, distances) in scene.surfaces.iter_mut().zip(all) {
        let part = |distance: f64| if upto > from { (distance - from) / (upto - from) } else { 0.0 };
        surface.colors = Some(distances.into_iter().map(|distance| sequential_color(part(distance))).collect());
    }
    Ok((from, upto))
}

/// Two numbers from the smaller to the larger.
pub(crate) fn range(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    text.split_once(',')
        .and_then(|(from, to)| Some((number(from)?, number(to)?)))
        .filter(|(from, to)| from < to)
        .ok_or_else(|| format!("found \"{text}\", expected two rising numbers such as 0,0.5"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;
    use shapeloom_render::SceneMesh;

    #[test]
    fn colours_follow_the_distance() {
        let positions = vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y];
        let mut scene = Scene { surfaces: vec![SceneMesh::new(positions, vec![[0, 1, 2]])] };
        let origin = [DVec3::ZERO];
        let found = color_by_distance(&mut scene, &Simplices::points(&origin[..]), None, &Exec::default()).unwrap();
        assert_eq!(found, (0.0, 4.0));
        let surface = &scene.surfaces[0];
        assert!(surface.triangles.len() > 1000);
        for (position, color) in surface.positions.iter().zip(surface.colors.as_ref().unwrap()) {
            assert_eq!(*color, sequential_color(position.length() / 4.0));
        }
    }

    #[test]
    fn ranges_rise() {
        assert_eq!(range("0, 0.5"), Ok((0.0, 0.5)));
        for wrong in ["", "1", "1,1", "2,1", "0,nan", "0,inf", "a,b"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
    }
}
