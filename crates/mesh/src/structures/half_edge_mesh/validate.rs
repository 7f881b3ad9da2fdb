//! Everything that must hold of half-edges, checked.

use super::{GONE, HalfEdgeMesh, NONE};
use crate::structures::StructureError;
use crate::structures::face_list::ordered;

/// What was found, all of it.
#[derive(Default)]
struct Findings(Vec<StructureError>);

impl Findings {
    fn expect(&mut self, holds: bool, kind: &'static str, index: usize, what: &'static str) {
        if !holds {
            self.0.push(StructureError::Inconsistent { kind, index: index as u32, what });
        }
    }
}

/// Validation.
impl HalfEdgeMesh {
    /// All that is wrong with the structure; nothing where it is sound, as it is after every operator.
    ///
    /// Checks that arrays fit together, that links name elements in use and run both ways, that faces and border loops
    /// are single cycles of three sides and more with different corners, that every edge has a face and no other edge
    /// has its vertices, that the faces at each vertex form one fan, that border vertices know the border, and the
    /// counts. What follows links is checked only where all links are right. Cost: linear, but for the sorting of
    /// edges.
    pub fn validate(&self) -> Vec<StructureError> {
        let mut findings = Findings::default();
        let halves = self.origin.len();
        let lengths = [self.next.len(), self.previous.len(), self.face.len()];
        findings.expect(halves.is_multiple_of(2), "half-edge", halves, "the last one has no twin");
        findings.expect(lengths == [halves; 3], "half-edge", halves, "columns of different lengths");
        if !findings.0.is_empty() {
            return findings.0;
        }
        self.check_links(&mut findings);
        if findings.0.is_empty() {
            self.check_cycles(&mut findings);
            self.check_fans(&mut findings);
            self.check_edges(&mut findings);
            let live = |slots: &[u32]| slots.iter().filter(|&&slot| slot != GONE).count() as u32;
            let counts = self.counts;
            findings.expect(counts.vertices == live(&self.leaving), "mesh", 0, "the count of vertices is wrong");
            findings.expect(2 * counts.edges == live(&self.origin), "mesh", 0, "the count of edges is wrong");
            findings.expect(counts.faces == live(&self.first), "mesh", 0, "the count of faces is wrong");
        }
        findings.0
    }

    fn check_links(&self, findings: &mut Findings) {
        let live = |slots: &[u32], index: u32| slots.get(index as usize).is_some_and(|&slot| slot != GONE);
        for h in 0..self.origin.len() {
            if self.origin[h] == GONE {
                let all = [self.origin[h ^ 1], self.next[h], self.previous[h], self.face[h]];
                findings.expect(all == [GONE; 4], "half-edge", h, "deleted in part");
                continue;
            }
            let (next, previous) = (self.next[h], self.previous[h]);
            findings.expect(live(&self.leaving, self.origin[h]), "half-edge", h, "starts at no vertex in use");
            findings.expect(self.origin[h] != self.origin[h ^ 1], "half-edge", h, "ends where it starts");
            let face = self.face[h];
            findings.expect(face == NONE || live(&self.first, face), "half-edge", h, "its face is not in use");
            findings.expect(face != NONE || self.face[h ^ 1] != NONE, "half-edge", h, "its edge has no face");
            if !live(&self.origin, next) || !live(&self.origin, previous) {
                findings.expect(false, "half-edge", h, "linked to a half-edge not in use");
                continue;
            }
            findings.expect(
                self.previous[next as usize] as usize == h,
                "half-edge",
                h,
                "the next one does not lead back",
            );
            findings.expect(
                self.next[previous as usize] as usize == h,
                "half-edge",
                h,
                "the previous one does not lead on",
            );
            findings.expect(
                self.origin[next as usize] == self.origin[h ^ 1],
                "half-edge",
                h,
                "the next one starts elsewhere",
            );
            findings.expect(self.face[next as usize] == face, "half-edge", h, "the next one has another face");
        }
        for (vertex, &leaving) in self.leaving.iter().enumerate().filter(|&(_, &leaving)| leaving < GONE) {
            let own = self.origin.get(leaving as usize).is_some_and(|&origin| origin as usize == vertex);
            findings.expect(own, "vertex", vertex, "its half-edge starts elsewhere");
        }
        for (face, &first) in self.first.iter().enumerate().filter(|&(_, &first)| first != GONE) {
            let own = self.face.get(first as usize).is_some_and(|&left| left as usize == face);
            findings.expect(own, "face", face, "its half-edge belongs elsewhere");
        }
    }

    fn check_cycles(&self, findings: &mut Findings) {
        let mut sides = vec![0usize; self.first.len()];
        for &face in self.face.iter().filter(|&&face| face < GONE) {
            sides[face as usize] += 1;
        }
        let mut sorted = Vec::new();
        for face in self.live_faces() {
            sorted.clear();
            sorted.extend(self.corners(face));
            let index = face.index();
            findings.expect(sorted.len() == sides[index], "face", index, "its half-edges form several cycles");
            findings.expect(sorted.len() > 2, "face", index, "fewer than three sides");
            sorted.sort_unstable();
            findings.expect(sorted.windows(2).all(|pair| pair[0] != pair[1]), "face", index, "a corner twice");
        }
        for start in self.border_loops() {
            let long = self.cycle(start.0).take(3).count() == 3;
            findings.expect(long, "half-edge", start.index(), "its border loop has fewer than three sides");
        }
    }

    fn check_fans(&self, findings: &mut Findings) {
        let mut leaving = vec![0usize; self.leaving.len()];
        let mut border = vec![0usize; self.leaving.len()];
        for (h, &origin) in self.origin.iter().enumerate().filter(|&(_, &origin)| origin != GONE) {
            leaving[origin as usize] += 1;
            border[origin as usize] += usize::from(self.face[h] == NONE);
        }
        for vertex in self.live_vertices() {
            let (index, known) = (vertex.index(), self.leaving(vertex));
            let around = self.around_vertex(vertex).count();
            findings.expect(around == leaving[index], "vertex", index, "its half-edges form several fans");
            findings.expect(border[index] < 2, "vertex", index, "several borders");
            let knows = border[index] == 0 || known.is_some_and(|half| self.is_border(half));
            findings.expect(knows, "vertex", index, "its half-edge is not the one on the border");
        }
    }

    fn check_edges(&self, findings: &mut Findings) {
        let mut edges: Vec<([u32; 2], u32)> =
            self.live_edges().map(|edge| (ordered([self.start(2 * edge.0), self.end(2 * edge.0)]), edge.0)).collect();
        edges.sort_unstable();
        for pair in edges.windows(2) {
            let (edge, other) = (pair[0], pair[1]);
            findings.expect(edge.0 != other.0, "edge", other.1 as usize, "another edge has the same vertices");
        }
    }
}
