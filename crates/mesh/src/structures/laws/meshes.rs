//! Meshes of every kind that structures may meet, each named for what is special about it.

use crate::structures::IndexedPolygons;

/// A mesh that structures are tried on.
pub struct Mesh {
    pub name: String,
    pub vertices: u32,
    pub faces: IndexedPolygons,
}

/// A small generator of numbers that look random (SplitMix64).
pub struct Dice(pub u64);

impl Dice {
    pub fn below(&mut self, top: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(top)) as u32
    }
}

pub fn mesh(name: &str, vertices: u32, faces: &[Vec<u32>]) -> Mesh {
    let faces = IndexedPolygons::from_faces(vertices, faces).unwrap();
    Mesh { name: name.to_owned(), vertices, faces }
}

/// A grid of quads whose sides are glued as `at` says.
fn glued(columns: u32, rows: u32, at: impl Fn(u32, u32) -> u32) -> Vec<Vec<u32>> {
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    cells.map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect()
}

pub fn torus(columns: u32, rows: u32) -> Vec<Vec<u32>> {
    glued(columns, rows, |i, j| j % rows * columns + i % columns)
}

pub fn klein_bottle(columns: u32, rows: u32) -> Vec<Vec<u32>> {
    // The last column meets the first upside down.
    glued(columns, rows, |i, j| if i < columns { j % rows * columns + i } else { (rows - j % rows) % rows * columns })
}

pub fn moebius_strip(columns: u32, rows: u32) -> Vec<Vec<u32>> {
    glued(columns, rows, |i, j| if i < columns { j * columns + i } else { (rows - j) * columns })
}

/// The faces cut into triangles from their first corners.
pub fn in_triangles(faces: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let fan = |face: &Vec<u32>| (1..face.len() - 1).map(|i| vec![face[0], face[i], face[i + 1]]).collect::<Vec<_>>();
    faces.iter().flat_map(fan).collect()
}

/// The faces with all vertices moved up.
fn moved(faces: &[Vec<u32>], by: u32) -> Vec<Vec<u32>> {
    faces.iter().map(|face| face.iter().map(|vertex| vertex + by).collect()).collect()
}

pub fn cube() -> Vec<Vec<u32>> {
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].map(Vec::from).to_vec()
}

pub fn tetrahedron() -> Vec<Vec<u32>> {
    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(Vec::from).to_vec()
}

/// A cone of triangles about the last vertex, open or closed around.
fn cone(valence: u32, closed: bool) -> Vec<Vec<u32>> {
    (0..if closed { valence } else { valence - 1 }).map(|i| vec![valence, i, (i + 1) % valence]).collect()
}

/// Every special case, some also in triangles.
pub fn special() -> Vec<Mesh> {
    let bow_tie = [vec![0, 1, 2], vec![0, 3, 4], vec![5, 3, 1]];
    let closed_bow_tie = [tetrahedron(), moved(&tetrahedron(), 3)].concat();
    let book = [vec![0, 1, 2], vec![1, 0, 3], vec![0, 1, 4, 5], vec![6, 7, 0]];
    let large: Vec<u32> = (0..20_000).collect();
    let polygons = [
        mesh("nothing", 0, &[]),
        mesh("vertices alone", 5, &[]),
        mesh("one triangle", 3, &[vec![1, 2, 0]]),
        mesh("isolated vertices", 9, &[vec![7, 2, 4, 5]]),
        mesh("cube", 8, &cube()),
        mesh("open cube", 8, &cube()[1..]),
        mesh("cube without opposite faces", 8, &cube()[2..]),
        mesh("two cubes", 17, &[cube(), moved(&cube(), 9)].concat()),
        mesh("torus", 35, &torus(7, 5)),
        mesh("small torus", 9, &torus(3, 3)),
        mesh("moebius strip", 24, &moebius_strip(8, 2)),
        mesh("klein bottle", 30, &klein_bottle(6, 5)),
        mesh("bow tie", 6, &bow_tie),
        mesh("closed bow tie", 7, &closed_bow_tie),
        mesh("three faces at an edge", 8, &book),
        mesh("faces that disagree", 6, &[vec![0, 1, 2], vec![0, 1, 3], vec![1, 2, 4], vec![2, 1, 5]]),
        mesh("a face twice", 4, &[vec![0, 1, 2, 3], vec![0, 1, 2, 3]]),
        mesh("a face and its back", 4, &[vec![0, 1, 2, 3], vec![2, 1, 0, 3]]),
        mesh("a face four times", 3, &[vec![0, 1, 2], vec![1, 2, 0], vec![2, 1, 0], vec![0, 2, 1]]),
        mesh("two faces along two edges", 4, &[vec![0, 1, 2, 3], vec![2, 1, 0]]),
        mesh("corners repeated", 6, &[vec![0, 1, 1], vec![2, 3, 4, 3], vec![5, 5, 5], vec![0, 1, 2], vec![4, 0, 4, 0]]),
        mesh("a face along itself", 7, &[vec![0, 1, 2, 3, 2, 4], vec![0, 1, 2, 0, 1, 5], vec![6, 5, 4, 3, 2, 1, 0]]),
    ];
    let mut all = Vec::new();
    for polygons in polygons {
        let lists: Vec<Vec<u32>> = super::truth::Truth::new(&polygons.faces, polygons.vertices).faces;
        if lists.iter().any(|face| face.len() > 3) {
            all.push(mesh(&format!("{} in triangles", polygons.name), polygons.vertices, &in_triangles(&lists)));
        }
        all.push(polygons);
    }
    all.push(mesh("closed cone of valence 5000", 5001, &cone(5000, true)));
    all.push(mesh("open cone of valence 5000", 5001, &cone(5000, false)));
    let back: Vec<u32> = large.iter().rev().copied().collect();
    all.push(mesh("polygons of 20000 corners", 20_000, &[large, back]));
    all
}

/// Few faces over few vertices, so that every fault turns up: triangles or polygons, with and without repeated corners.
pub fn random(dice: &mut Dice) -> Mesh {
    let vertices = 3 + dice.below(6);
    let (repeats, triangles) = (dice.below(3) == 0, dice.below(2) == 0);
    let count = dice.below(8);
    let mut faces = Vec::new();
    for _ in 0..count {
        let corners = if triangles { 3 } else { 3 + dice.below(3) };
        let mut face: Vec<u32> = (0..vertices).collect();
        for i in 0..vertices {
            let j = i + dice.below(vertices - i);
            face.swap(i as usize, j as usize);
        }
        face.truncate(corners as usize);
        if repeats {
            face = (0..corners).map(|_| dice.below(vertices)).collect();
        }
        faces.push(face);
    }
    mesh("random faces", vertices, &faces)
}

/// A patch of a surface: some faces of a torus, turned to start anywhere, some of them over. Most are manifold.
pub fn random_patch(dice: &mut Dice) -> Mesh {
    let (columns, rows) = (3 + dice.below(3), 3 + dice.below(3));
    let mut faces = torus(columns, rows);
    if dice.below(2) == 0 {
        faces = in_triangles(&faces);
    }
    let (keep, turn) = (1 + dice.below(8), dice.below(4) == 0);
    faces.retain(|_| dice.below(8) < keep);
    for face in &mut faces {
        face.rotate_left(dice.below(3) as usize);
        if turn && dice.below(8) == 0 {
            face.reverse();
        }
    }
    mesh("random patch", columns * rows + 1, &faces)
}
