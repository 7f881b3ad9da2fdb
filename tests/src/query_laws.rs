//! The laws of rays and closest points, run on everything that answers them, on shapes of every kind.

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{ClosestPoint, Exec, Hit, Interval, Ray, Rays};
use shapeloom::mesh::primitives::{Platonic, Solid, Torus};
use shapeloom::mesh::{TriMesh, TriangulatePolygons};
use shapeloom::spatial::{TriangleBvh, TriangleOctree};

use crate::oracles::to_triangle;
use crate::shapes;
use crate::support::{Dice, files_below, root};

/// Everything under crates/ that implements [`Rays`] or [`ClosestPoint`], and is tried below.
const IMPLEMENTORS: &[&str] = &["TriangleBvh", "TriangleOctree"];

/// What has no triangles to compare with, and is tried against closed forms in its own crate.
const WITHOUT_TRIANGLES: &[&str] = &["FieldRays"];

/// A shape to query, and its triangles as the truth.
struct Case {
    name: &'static str,
    triangles: Vec<[DVec3; 3]>,
    center: DVec3,
    size: f64,
}

impl Case {
    fn new(name: &'static str, triangles: Vec<[DVec3; 3]>) -> Self {
        let points = triangles.as_flattened();
        let (min, max) = points.iter().fold((points[0], points[0]), |(min, max), &p| (min.min(p), max.max(p)));
        Self { name, triangles, center: (min + max) * 0.5, size: (max - min).max_element() }
    }

    fn of(name: &'static str, mesh: &TriMesh, change: impl Fn(DVec3) -> DVec3) -> Self {
        let corner = |index: u32| change(mesh.positions()[index as usize]);
        Self::new(name, mesh.triangles().iter().map(|triangle| triangle.map(corner)).collect())
    }

    fn point(&self, element: u32, parameters: DVec2) -> DVec3 {
        let [a, b, c] = self.triangles[element as usize];
        a + (b - a) * parameters.x + (c - a) * parameters.y
    }

    /// What arithmetic can do to a distance to this shape.
    fn rounding(&self) -> f64 {
        1e-13 * (self.size + self.center.length())
    }

    fn hierarchy(&self) -> TriangleBvh {
        let indices: Vec<[u32; 3]> = (0..self.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriangleBvh::build(self.triangles.as_flattened(), &indices, &Exec::default()).expect("finite corners")
    }

    fn octree(&self) -> TriangleOctree {
        let indices: Vec<[u32; 3]> = (0..self.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriangleOctree::build(self.triangles.as_flattened(), &indices, &Exec::default()).expect("finite corners")
    }
}

fn cases() -> Vec<Case> {
    let exec = Exec::default();
    let torus = Torus::new().mesh(&exec).expect("a torus").value;
    let torus = shapeloom::core::Convert::convert(&TriangulatePolygons::new(), &torus).expect("a sound mesh").value;
    let cube = Platonic::new(Solid::Cube).mesh(&exec).expect("a cube").value;
    let cube = shapeloom::core::Convert::convert(&TriangulatePolygons::new(), &cube).expect("a sound mesh").value;
    let tagged = shapes::tagged_triangles();
    let same = |p: DVec3| p;
    let mut dice = Dice(40);
    let mut wild = || DVec3::new(dice.unit() - 0.5, dice.unit() - 0.5, dice.unit() - 0.5);
    let soup: Vec<[DVec3; 3]> = (0..150).map(|_| [wild(), wild(), wild()]).collect();
    let closed = Case::of("closed", &torus, same);
    let mut open = Case::of("open", &torus, same);
    open.triangles.truncate(open.triangles.len() / 3);
    let mut flipped = Case::of("flipped", &tagged, same);
    flipped.triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(1, 2));
    let mut duplicated = Case::of("duplicated", &cube, same);
    let again = duplicated.triangles.clone();
    duplicated.triangles.extend(again.iter().copied().chain(again.iter().map(|&[a, b, c]| [b, c, a])));
    let mut degenerate = Case::new("degenerate", soup.clone());
    degenerate.triangles.extend(soup.iter().map(|&[a, b, _]| [a, b, a.lerp(b, 0.5)]));
    degenerate.triangles.extend(soup.iter().map(|&[a, ..]| [a; 3]));
    let offset = Case::of("offset", &tagged, |p| p + DVec3::new(5e6, -3e6, 4.2e6));
    let tiny = Case::of("tiny", &tagged, |p| p * 1e-9);
    let huge = Case::of("huge", &tagged, |p| p * 1e60);
    let one = Case::new("one", vec![[DVec3::ZERO, DVec3::X, DVec3::Y]]);
    vec![closed, open, flipped, duplicated, degenerate, offset, tiny, huge, one, Case::new("soup", soup)]
}

/// The first hit is the nearest of all, `any_hit` tells whether there is one, hits lie within reach and on their
/// element, batches agree with single queries to the bit.
fn ray_laws(case: &Case, shape: &dyn Rays, rays: &[Ray]) -> usize {
    let name = case.name;
    let (mut batch, mut any) = (vec![None; rays.len()], vec![true; rays.len()]);
    shape.first_hits(rays, &mut batch, &Exec::default()).expect("nothing stops it");
    shape.any_hits(rays, &mut any, &Exec::default()).expect("nothing stops it");
    let (mut hits, mut count) = (Vec::new(), 0);
    for ((ray, together), any) in rays.iter().zip(batch).zip(any) {
        shape.all_hits(ray, &mut hits);
        let first: Option<Hit> = shape.first_hit(ray);
        assert_eq!(first, together, "{name}");
        assert_eq!(first, hits.first().copied(), "{name}");
        assert_eq!(shape.any_hit(ray), first.is_some(), "{name}");
        assert_eq!(any, first.is_some(), "{name}");
        let key = |hit: &Hit| (hit.distance, hit.element);
        assert!(hits.windows(2).all(|pair| key(&pair[0]) < key(&pair[1])), "{name}");
        for hit in &hits {
            assert!(ray.reach.contains(hit.distance), "{name}");
            let (v, w) = (hit.parameters.x, hit.parameters.y);
            assert!(v >= 0.0 && w >= 0.0 && v + w <= 1.0 + 1e-14, "{name}: {hit:?}");
            let apart = (case.point(hit.element, hit.parameters) - ray.at(hit.distance)).length();
            // A grazing ray meets its triangle at a place that rounding moves along it.
            let [a, b, c] = case.triangles[hit.element as usize];
            let slope = (b - a).normalize_or_zero().cross((c - a).normalize_or_zero()).dot(ray.direction()).abs();
            assert!(apart * slope.max(1e-9) <= 10.0 * case.rounding(), "{name}: {apart} {hit:?}");
        }
        count += hits.len();
    }
    count
}

/// No sampled point is closer than the answer, the answer lies on its element and that far away, `closest_within`
/// honours the bound, between equal distances the smallest element counts, batches agree with single queries to the
/// bit.
fn closest_laws(case: &Case, shape: &dyn ClosestPoint, queries: &[DVec3]) {
    let name = case.name;
    let mut batch = vec![None; queries.len()];
    shape.closest_points(queries, &mut batch, &Exec::default()).expect("nothing stops it");
    for (&query, together) in queries.iter().zip(batch) {
        let found = shape.closest(query);
        assert_eq!(found, together, "{name}");
        let found = found.expect("the shape is not empty");
        let distance = found.distance_squared.sqrt();
        let rounding = case.rounding() + 1e-13 * distance;
        let brute = case.triangles.iter().map(|&t| to_triangle(query, t)).fold(f64::INFINITY, f64::min);
        // Thin triangles make the oracle's feet less exact than this.
        assert!((distance - brute).abs() <= 100.0 * rounding, "{name}: {distance} {brute}");
        for [a, b, c] in &case.triangles {
            for sample in [*a, *b, *c, (a + b + c) / 3.0, (a + b) * 0.5] {
                assert!(sample.distance(query) >= distance - rounding, "{name}");
            }
        }
        assert!((found.point.distance(query) - distance).abs() <= rounding, "{name}");
        assert!(found.point.distance(case.point(found.element, found.parameters)) <= rounding, "{name}");
        let smaller = &case.triangles[..found.element as usize];
        let element = case.triangles[found.element as usize];
        assert!(!smaller.contains(&element), "{name}: an equal triangle comes before");
        assert_eq!(shape.closest_within(query, distance * 0.99 - rounding), None, "{name}");
        assert_eq!(shape.closest_within(query, distance * (1.0 + 1e-12)), Some(found), "{name}");
        assert_eq!(shape.closest_within(query, f64::INFINITY), Some(found), "{name}");
    }
    for nowhere in [DVec3::NAN, DVec3::INFINITY] {
        assert_eq!(shape.closest(nowhere), None, "{name}");
    }
    for nothing in [f64::NAN, -1.0] {
        assert_eq!(shape.closest_within(queries[0], nothing), None, "{name}");
    }
}

#[test]
fn everything_that_answers_rays_and_closest_points_keeps_the_laws() {
    for case in cases() {
        let mut dice = Dice(21);
        let mut point = |scale: f64| {
            let drawn = DVec3::new(dice.unit() - 0.5, dice.unit() - 0.5, dice.unit() - 0.5);
            case.center + drawn * (scale * case.size)
        };
        let rays: Vec<Ray> = (0..900)
            .map(|k| {
                let origin = point(3.0);
                let corner = case.triangles[k % case.triangles.len()][k % 3];
                let target = if k % 4 == 0 { corner } else { point(0.8) };
                let ray = Ray::new(origin, target - origin).expect("different points");
                if k % 3 == 0 { ray.within(Interval::new(0.5 * case.size, 1.5 * case.size)) } else { ray }
            })
            .collect();
        let queries: Vec<DVec3> = (0..250).map(|k| point(if k % 2 == 0 { 1.0 } else { 4.0 })).collect();
        let bvh = case.hierarchy();
        let octree = case.octree();
        let all_rays: [&dyn Rays; 2] = [&bvh, &octree];
        let all_closest: [&dyn ClosestPoint; 1] = [&bvh];
        for shape in all_rays {
            assert!(ray_laws(&case, shape, &rays) > 80, "{}: few hits", case.name);
        }
        for shape in all_closest {
            closest_laws(&case, shape, &queries);
        }
    }
}

/// Who adds a shape that answers queries adds it to the laws.
#[test]
fn no_implementor_is_forgotten() {
    let sources = files_below("crates", ".rs");
    assert!(sources.len() > 50);
    // Shapes made for a test are that test's affair.
    for path in sources.iter().filter(|path| !path.display().to_string().ends_with("tests.rs")) {
        let source = std::fs::read_to_string(root().join(path)).expect("a source file");
        for line in source.lines().filter(|line| line.trim_start().starts_with("impl")) {
            let Some((_, name)) = ["Rays for ", "ClosestPoint for "].iter().find_map(|words| line.split_once(words))
            else {
                continue;
            };
            let name = name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            if WITHOUT_TRIANGLES.contains(&name) {
                continue;
            }
            assert!(IMPLEMENTORS.contains(&name), "{}: {name} is not tried on the laws", path.display());
        }
    }
}
