//! The way from one kind to another.

use std::collections::VecDeque;

use shapeloom_shape::Kind;

use crate::{Converter, Effect, PlanError, registry};

/// What a way must do.
#[derive(Clone, Debug, Default)]
pub struct Wish {
    /// The kinds that will do, the best first.
    pub targets: Vec<Kind>,
    /// A converter that must be on the way.
    pub method: Option<String>,
    /// A kind that must be on the way.
    pub via: Option<Kind>,
}

impl Wish {
    /// Any way to one of these kinds.
    pub fn to(targets: impl Into<Vec<Kind>>) -> Self {
        Self { targets: targets.into(), ..Self::default() }
    }
}

/// Converters to run one after the other; none where the source will do as it is.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The converters in order.
    pub steps: Vec<&'static Converter>,
}

impl Plan {
    /// How many of the steps use up some of the tolerance.
    pub fn lossy_steps(&self) -> usize {
        self.steps.iter().filter(|step| step.effect == Effect::WithinTolerance).count()
    }
}

/// The shortest way from a kind that does what is wished; between ways of equal length the one whose converters stand
/// first in the registry. Converters that are [`only_by_name`](field@Converter::only_by_name) are on it only where they are named:
/// by `method`, or, where nothing else leads to the kind of `via`, by that kind. Of several that make it the one is taken to which
/// the fewest steps lead, the first in the registry between equals.
///
/// # Errors
/// There is no such way, or no converter of that name.
pub fn plan(from: Kind, wish: &Wish) -> Result<Plan, PlanError> {
    let mut steps = Vec::new();
    let mut at = from;
    if let Some(name) = &wish.method {
        let (before, method) = reach(at, name)?.map_err(|method| PlanError::MethodOffTheWay {
            method: method.name,
            takes: method.from,
            gives: method.to,
            from,
            to: wish.targets.clone(),
        })?;
        steps.extend(before);
        steps.push(method);
        at = method.to;
    }
    let no_way = |from: Kind, to: &[Kind]| {
        let (to, reachable, by_name) = (to.to_vec(), reachable(from), by_name(from, to));
        PlanError::NoWay { from, to, reachable, by_name }
    };
    if let Some(via) = wish.via
        && !steps.iter().any(|step| step.to == via)
        && at != via
    {
        let way = shortest(at, &[via]).or_else(|| named_by_kind(at, via));
        steps.extend(way.ok_or_else(|| no_way(at, &[via]))?);
        at = via;
    }
    steps.extend(shortest(at, &wish.targets).ok_or_else(|| no_way(at, &wish.targets))?);
    Ok(Plan { steps })
}

/// The converter of that name that is nearest to a kind, and the steps that lead to it; the first of that name if none can
/// be reached. One name may serve several kinds.
fn reach(
    from: Kind,
    name: &str,
) -> Result<Result<(Vec<&'static Converter>, &'static Converter), &'static Converter>, PlanError> {
    let named: Vec<&'static Converter> = registry().iter().filter(|converter| converter.name == name).collect();
    let Some(&first) = named.first() else {
        let mut known = Vec::new();
        for converter in registry() {
            if !known.contains(&converter.name) {
                known.push(converter.name);
            }
        }
        return Err(PlanError::UnknownMethod { found: name.to_owned(), known });
    };
    let ways = named.into_iter().filter_map(|method| Some((shortest(from, &[method.from])?, method)));
    Ok(ways.min_by_key(|(steps, _)| steps.len()).ok_or(first))
}

/// Breadth first over kinds; a target earlier in the list wins only between ways of equal length.
fn shortest(from: Kind, targets: &[Kind]) -> Option<Vec<&'static Converter>> {
    if targets.contains(&from) {
        return Some(Vec::new());
    }
    let mut reached: Vec<(Kind, Option<(usize, &'static Converter)>)> = vec![(from, None)];
    let mut queue = VecDeque::from([0]);
    let mut found: Option<(usize, usize, usize)> = None;
    let mut depth = vec![0];
    while let Some(index) = queue.pop_front() {
        let at = reached[index].0;
        for step in registry().iter().filter(|step| step.from == at && !step.only_by_name) {
            if reached.iter().any(|(kind, _)| *kind == step.to) {
                continue;
            }
            reached.push((step.to, Some((index, step))));
            depth.push(depth[index] + 1);
            let node = reached.len() - 1;
            if let Some(rank) = targets.iter().position(|&target| target == step.to) {
                let candidate = (depth[node], rank, node);
                found = Some(found.map_or(candidate, |best| best.min(candidate)));
            }
            queue.push_back(node);
        }
    }
    let (_, _, mut node) = found?;
    let mut steps = Vec::new();
    while let Some((before, step)) = reached[node].1 {
        steps.push(step);
        node = before;
    }
    steps.reverse();
    Some(steps)
}

/// The shortest way whose last step is a converter that must be named and makes the kind asked for.
fn named_by_kind(from: Kind, to: Kind) -> Option<Vec<&'static Converter>> {
    let makes = registry().iter().filter(|step| step.only_by_name && step.to == to);
    let ways = makes.filter_map(|step| {
        let mut steps = shortest(from, &[step.from])?;
        steps.push(step);
        Some(steps)
    });
    ways.min_by_key(Vec::len)
}

/// The converters that would lead there if they were named.
fn by_name(from: Kind, to: &[Kind]) -> Vec<&'static str> {
    let leads = |step: &&Converter| shortest(from, &[step.from]).is_some() && shortest(step.to, to).is_some();
    registry().iter().filter(|step| step.only_by_name).filter(leads).map(|step| step.name).collect()
}

/// The kinds that can be made from one, itself left out.
fn reachable(from: Kind) -> Vec<Kind> {
    Kind::ALL.into_iter().filter(|&kind| kind != from && shortest(from, &[kind]).is_some()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Diagnostic;

    fn names(plan: &Plan) -> Vec<&'static str> {
        plan.steps.iter().map(|step| step.name).collect()
    }

    #[test]
    fn everything_with_a_surface_reaches_triangles() {
        for kind in [Kind::BezierSurface, Kind::HeightField, Kind::PolyMesh, Kind::TriMesh] {
            assert!(plan(kind, &Wish::to([Kind::TriMesh])).is_ok(), "{kind}");
        }
    }

    #[test]
    fn methods_and_vias_are_on_the_way() {
        let wish = Wish { method: Some("weld".into()), ..Wish::to([Kind::TriMesh]) };
        assert_eq!(names(&plan(Kind::BezierSurface, &wish).unwrap()), ["tessellate-patches", "weld"]);
        assert_eq!(names(&plan(Kind::PolyMesh, &wish).unwrap()), ["weld", "triangulate-polygons"]);
        let wish = Wish { via: Some(Kind::TriMesh), ..Wish::to([Kind::PolyMesh, Kind::TriMesh]) };
        assert_eq!(names(&plan(Kind::PolyMesh, &wish).unwrap()), ["triangulate-polygons"]);
        assert!(plan(Kind::TriMesh, &Wish::to([Kind::TriMesh])).unwrap().steps.is_empty());
    }

    /// A kind that stands first in the wish wins only between ways of equal length.
    #[test]
    fn the_source_will_do_where_it_is_wished_at_all() {
        let wish = Wish::to([Kind::TriMesh, Kind::PolyMesh]);
        assert!(plan(Kind::PolyMesh, &wish).unwrap().steps.is_empty());
        assert_eq!(
            names(&plan(Kind::BezierCurve, &Wish::to([Kind::TriMesh, Kind::Polyline])).unwrap()),
            ["tessellate-curve"]
        );
    }

    /// Triangles between scattered points are one reading of them among others.
    #[test]
    fn readings_of_a_shape_are_taken_only_where_they_are_named() {
        for (kind, name) in [
            (Kind::PointCloud, "delaunay-triangulation"),
            (Kind::GeometricGraph, "constrained-delaunay"),
            (Kind::BezierCurve, "triangulate-region"),
        ] {
            let error = plan(kind, &Wish::to([Kind::TriMesh])).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
            assert!(error.advice().is_some_and(|advice| advice.contains(&format!("--method {name}"))), "{kind}");
            let wish = Wish { method: Some(name.into()), ..Wish::to([Kind::TriMesh]) };
            assert_eq!(names(&plan(kind, &wish).unwrap()).last(), Some(&name));
        }
    }

    /// A kind on the way names what makes it, but only where no other converter does.
    #[test]
    fn a_kind_on_the_way_names_the_converter_that_makes_it() {
        let through = |from: Kind, via: Kind, method: Option<&str>, to: Kind| {
            let wish = Wish { via: Some(via), method: method.map(str::to_owned), ..Wish::to([to]) };
            plan(from, &wish).map(|plan| names(&plan))
        };
        let made = through(Kind::TriMesh, Kind::VoxelGrid, None, Kind::TriMesh).unwrap();
        assert_eq!(made.first(), Some(&"mesh-to-distance"), "{made:?}");
        assert!(made.len() > 1);
        let made = through(Kind::PolyMesh, Kind::VoxelGrid, None, Kind::VoxelGrid).unwrap();
        assert_eq!(made, ["triangulate-polygons", "mesh-to-distance"]);
        let made = through(Kind::TriMesh, Kind::VoxelGrid, Some("voxelize-mesh"), Kind::VoxelGrid).unwrap();
        assert_eq!(made, ["voxelize-mesh"]);
        let made = through(Kind::PointCloud, Kind::VoxelGrid, None, Kind::VoxelGrid).unwrap();
        assert_eq!(made, ["points-to-grid"]);
        assert_eq!(through(Kind::PointCloud, Kind::TriMesh, None, Kind::TriMesh).unwrap(), ["delaunay-triangulation"]);
        // An ordinary converter comes first, and without the kind on the way the error says what to name.
        assert_eq!(through(Kind::PolyMesh, Kind::TriMesh, None, Kind::TriMesh).unwrap(), ["triangulate-polygons"]);
        let error = plan(Kind::TriMesh, &Wish::to([Kind::VoxelGrid])).unwrap_err();
        assert!(error.advice().is_some_and(|advice| advice.contains("--method mesh-to-distance")), "{error}");
    }

    #[test]
    fn where_no_way_leads_the_error_says_what_can_be_reached() {
        let error = plan(Kind::BezierCurve, &Wish::to([Kind::TriMesh])).unwrap_err();
        let wanted = "found no way from bezier-curve to tri-mesh, only to polyline and, where it is named, through \
                      triangulate-region";
        assert_eq!(error.to_string(), wanted);
        let wish = Wish { method: Some("tessellate-curve".into()), ..Wish::to([Kind::TriMesh]) };
        assert!(matches!(plan(Kind::TriMesh, &wish), Err(PlanError::MethodOffTheWay { .. })));
        let wish = Wish { method: Some("magic".into()), ..Wish::to([Kind::TriMesh]) };
        assert!(matches!(plan(Kind::TriMesh, &wish), Err(PlanError::UnknownMethod { .. })));
    }
}
