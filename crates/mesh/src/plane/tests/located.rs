//! Places are found among edges that must stay.

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{Convert, Exec};
use spade::handles::FixedVertexHandle;
use spade::{PositionInTriangulation, Triangulation as _};

use super::constrained::graph;
use super::{Dice, is_sound};
use crate::ConstrainedDelaunay;
use crate::plane::constraints::constrain;
use crate::plane::location::{locate, vertices_around};
use crate::plane::triangulation::{Triangulation, position};

/// From any vertex to places anywhere, through rings of long edges that turn like a pinwheel: what is found holds the place.
#[test]
fn what_is_found_holds_the_place() {
    let mut dice = Dice(8);
    for round in 0..40 {
        let count = 12 + dice.next(30) as u32;
        let points: Vec<DVec2> = (0..count)
            .map(|k| {
                let radius = [1.0, 1.0, 0.5, 0.1, 3.0][dice.next(5) as usize];
                DVec2::from_angle(f64::from(k) * 2.399_963 + dice.unit() * 0.01) * radius
            })
            .collect();
        let edges: Vec<[u32; 2]> = (0..count).map(|k| [k, (k * 7 + 3) % count]).collect();
        let mut triangulation = Triangulation::new(&points, &Exec::default()).unwrap().unwrap();
        constrain(&mut triangulation, &edges, &Exec::default()).unwrap();
        let cdt = &triangulation.cdt;
        let vertices: Vec<DVec2> =
            (0..cdt.num_vertices()).map(|k| position(cdt, FixedVertexHandle::from_index(k))).collect();
        let reach = vertices.iter().map(|at| at.abs().max_element()).fold(0.0, f64::max);
        for step in 0..300 {
            let one = vertices[dice.next(vertices.len() as u64) as usize];
            let at = match step % 3 {
                0 => one,
                1 => (one + vertices[dice.next(vertices.len() as u64) as usize]) * 0.5,
                _ => DVec2::new(dice.unit() - 0.5, dice.unit() - 0.5) * 2.0 * reach,
            };
            let near = FixedVertexHandle::from_index(dice.next(vertices.len() as u64) as usize);
            let found = locate(cdt, at, near);
            let around: Vec<DVec2> = vertices_around(cdt, found).iter().map(|&vertex| position(cdt, vertex)).collect();
            let side = |a: usize, b: usize| orient2d(around[a], around[b], at);
            match found {
                PositionInTriangulation::OnVertex(_) => assert_eq!(around, [at]),
                PositionInTriangulation::OnEdge(_) => {
                    assert!(side(0, 1).is_eq() && (at - around[0]).dot(at - around[1]) < 0.0, "{round} {at}");
                }
                PositionInTriangulation::OnFace(_) => {
                    assert!([(0, 1), (1, 2), (2, 0)].iter().all(|&(a, b)| side(a, b).is_gt()), "{round} {at}");
                }
                PositionInTriangulation::OutsideOfConvexHull(edge) => {
                    assert!(cdt.directed_edge(edge).is_outer_edge() && side(0, 1).is_gt(), "{round} {at}");
                }
                PositionInTriangulation::NoTriangulation => panic!("{round} {at}"),
            }
        }
    }
}

/// Points and edges among which spade's own walk goes round in a circle and ends in a panic.
#[test]
fn a_walk_that_would_go_in_a_circle_ends() {
    let points = CIRCLE_POINTS.map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)) / f64::from(1 << 30));
    let refine = ConstrainedDelaunay { angle: 33.0, max_area: 1.0, max_added: 3000, ..ConstrainedDelaunay::new() };
    is_sound(&refine.convert(&graph(&points, &CIRCLE_EDGES)).unwrap().value);
}

const CIRCLE_EDGES: [[u32; 2]; 9] =
    [[19, 21], [1, 14], [35, 31], [35, 36], [20, 24], [37, 3], [18, 23], [14, 7], [34, 15]];

/// In units of 2^-30.
#[rustfmt::skip]
const CIRCLE_POINTS: [(i32, i32); 41] = [
    (882_311_391, 460_028_545), (608_273_297, 595_488_732), (66_539_253, 432_005_584), (629_178_402, 691_912_884),
    (474_033_857, 961_957_592), (840_272_349, 834_304_616), (262_676_845, 894_150_242), (807_090_101, 901_630_355),
    (250_105_175, 1_063_069_332), (1_043_914_291, 1_056_059_319), (133_348_421, 722_936_534), (772_822_379, 826_856_682),
    (661_369_480, 98_242_994), (715_595_022, 33_611_512), (620_443_631, 955_696_147), (85_797_375, 1_056_875_695),
    (310_762_495, 294_607_558), (485_352_145, 8_154_604), (76_761_566, 991_186_868), (408_645_400, 497_520_076),
    (409_494_117, 266_799_865), (490_504_769, 285_230_092), (70_245_127, 1_037_043_881), (594_549_347, 86_699_785),
    (524_161_088, 103_865_903), (427_174_818, 910_951_399), (861_660_263, 1_073_721_785), (716_106_248, 507_137_190),
    (417_672_688, 1_055_701_496), (383_492_082, 136_444_708), (1_015_773_454, 179_573_096), (892_562_034, 746_346_113),
    (274_923_876, 770_328_727), (615_906_747, 275_194_188), (864_904_302, 846_451_538), (167_741_837, 194_037_783),
    (926_855_522, 878_369_821), (1_042_320_179, 957_579_520), (168_806_064, 965_087_179), (844_448_677, 1_007_947_643),
    (840_544_545, 641_446_928),
];
