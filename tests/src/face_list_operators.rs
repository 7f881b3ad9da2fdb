//! Operators on lists of faces, done plainly, and what surface the result is, by definition.

use std::collections::{BTreeMap, BTreeSet};

use shapeloom::mesh::structures::Hole;

pub type Faces = Vec<Vec<u32>>;

/// A face from its smallest corner on, so that equal faces are equal lists.
pub fn turned(face: &[u32]) -> Vec<u32> {
    let start = (0..face.len()).min_by_key(|&i| face[i]).unwrap_or(0);
    [&face[start..], &face[..start]].concat()
}

pub fn same_faces(a: &Faces, b: &Faces) -> bool {
    let sorted = |faces: &Faces| {
        let mut all: Vec<_> = faces.iter().map(|face| turned(face)).collect();
        all.sort();
        all
    };
    sorted(a) == sorted(b)
}

pub fn sides(face: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..face.len()).map(move |i| [face[i], face[(i + 1) % face.len()]])
}

pub fn unordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// What an operator must keep: for each component V − E + F and the number of its border loops.
pub type Kind = Vec<(i64, usize)>;

/// What surface some faces make, by definition; none if they are no oriented 2-manifold, or two have the same corners
/// all around.
pub fn surface(faces: &Faces) -> Option<Kind> {
    let mut edges: BTreeMap<[u32; 2], Vec<[u32; 2]>> = BTreeMap::new();
    let mut circuits = BTreeSet::new();
    let mut links: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
    for face in faces {
        let distinct: BTreeSet<u32> = face.iter().copied().collect();
        if face.len() < 3 || distinct.len() < face.len() {
            return None;
        }
        let mut back = face.clone();
        back.reverse();
        if !circuits.insert(turned(face).min(turned(&back))) {
            return None;
        }
        for i in 0..face.len() {
            let [a, b, c] = [face[i], face[(i + 1) % face.len()], face[(i + 2) % face.len()]];
            edges.entry(unordered([a, b])).or_default().push([a, b]);
            links.entry(b).or_default().push([a, c]);
        }
    }
    if edges.values().any(|sides| sides.len() > 2 || (sides.len() == 2 && sides[0] == sides[1])) {
        return None;
    }
    // The link of each vertex is one path or one cycle: connected, as edges have two faces at most.
    for link in links.values() {
        let mut met = BTreeSet::from([link[0][0]]);
        while link.iter().any(|ends| ends.iter().any(|end| met.contains(end)) && met.extend_all(ends)) {}
        if link.iter().flatten().any(|end| !met.contains(end)) {
            return None;
        }
    }
    // Components, then what each has.
    let mut of: BTreeMap<u32, u32> = links.keys().map(|&vertex| (vertex, vertex)).collect();
    let mut changed = true;
    while changed {
        changed = false;
        for [a, b] in edges.keys() {
            let least = of[a].min(of[b]);
            for vertex in [a, b] {
                changed |= of.insert(*vertex, least) != Some(least);
            }
        }
    }
    let mut kinds: BTreeMap<u32, (i64, usize)> = BTreeMap::new();
    for &component in of.values() {
        kinds.entry(component).or_default().0 += 1;
    }
    for [a, _] in edges.keys() {
        kinds.entry(of[a]).or_default().0 -= 1;
    }
    for face in faces {
        kinds.entry(of[&face[0]]).or_default().0 += 1;
    }
    let mut border: BTreeMap<u32, u32> =
        edges.values().filter(|sides| sides.len() == 1).map(|sides| (sides[0][0], sides[0][1])).collect();
    while let Some((&start, _)) = border.iter().next() {
        kinds.entry(of[&start]).or_default().1 += 1;
        let mut at = start;
        while let Some(next) = border.remove(&at) {
            at = next;
        }
    }
    let mut all: Kind = kinds.into_values().collect();
    all.sort_unstable();
    Some(all)
}

trait ExtendAll {
    /// Adds both, and says whether one was new.
    fn extend_all(&mut self, ends: &[u32; 2]) -> bool;
}

impl ExtendAll for BTreeSet<u32> {
    fn extend_all(&mut self, ends: &[u32; 2]) -> bool {
        let before = self.len();
        self.extend(ends);
        self.len() > before
    }
}

/// The faces if they are of the same surface as before.
pub fn kept(before: &Faces, after: Faces) -> Option<Faces> {
    (surface(before)? == surface(&after)?).then_some(after)
}

pub fn flipped(faces: &Faces, edge: [u32; 2]) -> Option<Faces> {
    let beside: Vec<usize> = (0..faces.len()).filter(|&f| sides(&faces[f]).any(|s| unordered(s) == edge)).collect();
    let &[one, other] = beside.as_slice() else { return None };
    if faces[one].len() != 3 || faces[other].len() != 3 {
        return None;
    }
    let third = |face: usize| faces[face].iter().copied().find(|corner| !edge.contains(corner));
    let (c, d) = (third(one)?, third(other)?);
    let [a, b] = sides(&faces[one]).find(|&side| unordered(side) == edge)?;
    let mut after = faces.clone();
    after[one] = vec![d, c, a];
    after[other] = vec![c, d, b];
    kept(faces, after)
}

/// `from` becomes `into`; as of complexes, an edge that no face is left beside counts against it.
pub fn collapsed(faces: &Faces, from: u32, into: u32) -> Option<Faces> {
    let rename = |vertex: u32| if vertex == from { into } else { vertex };
    let mut after = Faces::new();
    for face in faces {
        let mut corners: Vec<u32> = face.iter().map(|&corner| rename(corner)).collect();
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() > 2 {
            after.push(corners);
        }
    }
    let edges = |faces: &Faces| -> BTreeSet<[u32; 2]> {
        faces.iter().flat_map(|face| sides(face).map(unordered).collect::<Vec<_>>()).collect()
    };
    let mut images: BTreeSet<[u32; 2]> =
        edges(faces).into_iter().map(|[a, b]| unordered([rename(a), rename(b)])).collect();
    images.remove(&[into, into]);
    if images != edges(&after) {
        return None;
    }
    kept(faces, after)
}

/// The outline of the faces around a vertex, and the other faces.
pub fn hole(faces: &Faces, vertex: u32) -> (Vec<u32>, Faces) {
    let (own, others): (Faces, Faces) = faces.iter().cloned().partition(|face| face.contains(&vertex));
    let mut chains: Vec<Vec<u32>> = own
        .iter()
        .map(|face| {
            let at = face.iter().position(|&corner| corner == vertex).expect("it has it");
            [&face[at + 1..], &face[..at]].concat()
        })
        .collect();
    // From the chain that no other leads to, if the fan is open.
    let start = (0..chains.len()).find(|&i| chains.iter().all(|chain| chain.last() != chains[i].first())).unwrap_or(0);
    let mut outline = chains.swap_remove(start);
    while let Some(i) = chains.iter().position(|chain| chain.first() == outline.last()) {
        let chain = chains.swap_remove(i);
        outline.extend(&chain[1..]);
    }
    if outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    (outline, others)
}

pub fn triangulations(outline: &[u32]) -> Vec<Faces> {
    if outline.len() == 2 {
        return vec![vec![]];
    }
    let last = outline.len() - 1;
    let mut all = Vec::new();
    for k in 1..last {
        for left in triangulations(&outline[..=k]) {
            for right in triangulations(&outline[k..]) {
                let own = vec![outline[0], outline[k], outline[last]];
                all.push([left.clone(), right, vec![own]].concat());
            }
        }
    }
    all
}

pub fn removed(faces: &Faces, vertex: u32, filled: Hole) -> Option<Faces> {
    let (outline, others) = hole(faces, vertex);
    // A vertex twice on the outline has edges inside the hole, which the operator would have to delete as well.
    if outline.len() < 3 || outline.iter().collect::<BTreeSet<_>>().len() < outline.len() {
        return None;
    }
    let filling = if filled == Hole::Polygon { vec![vec![outline]] } else { triangulations(&outline) };
    filling.into_iter().find_map(|filling| kept(faces, [others.clone(), filling].concat()))
}

pub fn joined(faces: &Faces, edge: [u32; 2]) -> Option<Faces> {
    let beside: Vec<usize> = (0..faces.len()).filter(|&f| sides(&faces[f]).any(|s| unordered(s) == edge)).collect();
    let &[one, other] = beside.as_slice() else { return None };
    let from = |face: &[u32], start: u32| -> Vec<u32> {
        let at = face.iter().position(|&corner| corner == start).expect("a corner");
        [&face[at..], &face[..at]].concat()
    };
    let [a, b] = sides(&faces[one]).find(|&side| unordered(side) == edge)?;
    // From b around to a, and on from a around to b.
    let (there, back) = (from(&faces[one], b), from(&faces[other], a));
    let joined = [&there[..there.len() - 1], &back[..back.len() - 1]].concat();
    let mut after: Faces = (0..faces.len()).filter(|f| *f != one && *f != other).map(|f| faces[f].clone()).collect();
    after.push(joined);
    let used = |faces: &Faces| faces.iter().flatten().copied().collect::<BTreeSet<u32>>();
    (used(faces) == used(&after)).then_some(())?;
    kept(faces, after)
}

pub fn cut(faces: &Faces, face: usize, i: usize, j: usize) -> Option<Faces> {
    let outline = &faces[face];
    let mut after = faces.clone();
    after[face] = outline[i..=j].to_vec();
    after.push([&outline[j..], &outline[..=i]].concat());
    kept(faces, after)
}
