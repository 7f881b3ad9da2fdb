//! Inputs of tests.

use glam::DVec3;

/// A small deterministic generator (splitmix64).
pub(crate) struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[-1, 1)`.
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A point of the cube `[-1, 1)³`.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A point with whole coordinates from 0 to `top`.
    pub fn lattice(&mut self, top: u64) -> DVec3 {
        let mut one = || (self.next() % (top + 1)) as f64;
        DVec3::new(one(), one(), one())
    }

    /// Triangles with corners of their own.
    pub fn soup(
        &mut self,
        count: u32,
        mut corner: impl FnMut(&mut Self, usize) -> DVec3,
    ) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let positions = (0..3 * count as usize).map(|i| corner(self, i)).collect();
        (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    }
}

/// A closed sphere-like mesh of `rings` by `2 * rings` cells with irregular radii, outward.
pub(crate) fn bumpy_ball(rings: u32, center: DVec3, radius: f64, bump: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let sectors = 2 * rings;
    let mut draws = Draws::new(11);
    let mut positions = vec![center + DVec3::Z * radius];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let direction = DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos());
            positions.push(center + direction * (radius * (1.0 + bump * draws.signed())));
        }
    }
    positions.push(center - DVec3::Z * radius);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, sector: u32| match ring {
        0 => 0,
        ring if ring == rings => last,
        ring => 1 + (ring - 1) * sectors + sector % sectors,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for sector in 0..sectors {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            if ring > 0 {
                triangles.push([a, d, b]);
            }
            if ring + 1 < rings {
                triangles.push([a, c, d]);
            }
        }
    }
    (positions, triangles)
}
