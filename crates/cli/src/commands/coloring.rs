//! What the colours of a picture say.

use clap::ValueEnum;
use shapeloom_core::glam::DVec3;
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
/// this many at most, over all surfaces.
const EDGE: f64 = 1.0 / 100.0;
const MOST: u64 = 500_000;
/// Bytes for each triangle, its indices, normals and drawn sides, and for each position, its distance and colour beside it.
const BYTES: [u64; 2] = [12 + 72 + 3, 24 + 8 + 12];

/// Colours every surface of a scene by its distance to a shape. Returns the distances that stand for the ends of the
/// colour map: those asked for, or from 0 to the largest at a vertex.
pub(crate) fn color_by_distance(
    scene: &mut Scene,
    to: &Simplices<'_>,
    range: Option<(f64, f64)>,
    exec: &Exec,
) -> Result<(f64, f64), Failure> {
    let edge = scene.bounds().diagonal() * EDGE;
    let fine = scene.refinement(edge, MOST, exec)?;
    let bytes = [fine.triangles, fine.positions].into_iter().zip(BYTES).map(|(count, each)| count.saturating_mul(each));
    let _memory = exec.reserve(bytes.fold(0, u64::saturating_add))?;
    let bvh = TriangleBvh::build(&to.positions, &to.triangles, exec)?;
    let mut all = Vec::with_capacity(scene.surfaces.len());
    for surface in &mut scene.surfaces {
        *surface = surface.refined(fine.edge_length, exec)?;
        let mut distances = vec![0.0f64; surface.positions.len()];
        parallel::fill_chunks(exec, &mut distances, 256, |first, part| {
            for (position, distance) in surface.positions[first..].iter().zip(part) {
                *distance = bvh.closest(*position).map_or(f64::NAN, |closest| length(closest.point - *position));
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

/// The length of a vector of any size: squares neither overflow nor vanish.
fn length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).length() * largest } else { largest }
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
    fn sizes_at_both_ends_have_their_distances() {
        for size in [1e-170, 1e170] {
            let positions = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * size).to_vec();
            let mut scene = Scene { surfaces: vec![SceneMesh::new(positions, vec![[0, 1, 2]])] };
            let to = [DVec3::Z * size * 2.0];
            let found = color_by_distance(&mut scene, &Simplices::points(&to[..]), None, &Exec::default()).unwrap();
            assert_eq!(found.0, 0.0);
            assert!((found.1 / size - 5f64.sqrt()).abs() < 1e-12, "{found:?}");
        }
    }

    /// Many large surfaces take no more than a few.
    #[test]
    fn one_budget_holds_for_all_surfaces() {
        let square = |k: u32| {
            let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
            let positions = positions.map(|p| p + DVec3::Z * (f64::from(k) / 400.0)).to_vec();
            SceneMesh::new(positions, vec![[0, 1, 3], [0, 3, 2]])
        };
        let scene = || Scene { surfaces: (0..400).map(square).collect() };
        let origin = [DVec3::ZERO];
        let to = Simplices::points(&origin[..]);
        let mut colored = scene();
        color_by_distance(&mut colored, &to, None, &Exec::default()).unwrap();
        let count: usize = colored.surfaces.iter().map(|surface| surface.triangles.len()).sum();
        assert!((100_000..=500_000).contains(&count), "{count}");
        let small = Exec::default().with_memory(20_000_000);
        assert!(color_by_distance(&mut scene(), &to, None, &small).is_err());
        assert_eq!(small.memory_taken(), 0);
    }

    #[test]
    fn ranges_rise() {
        assert_eq!(range("0, 0.5"), Ok((0.0, 0.5)));
        for wrong in ["", "1", "1,1", "2,1", "0,nan", "0,inf", "a,b"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
    }
}
