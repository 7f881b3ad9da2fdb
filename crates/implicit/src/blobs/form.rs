//! The classical forms of blobs.

use shapeloom_core::glam::DVec3;

/// How the blobs of a field fall with the distance r to their centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlobForm {
    /// `a exp(-b r²)` (Blinn 1982). Parameters: the amplitude a, taken off where it is negative, and the decay b above 0.
    Blinn,
    /// `exp(B - B r²/R²)` (Blinn 1982 by radius and blobbiness, who writes B negative). At threshold 1 one blob alone is the sphere of
    /// radius R. Parameters: R, and the blobbiness B above 0 and at most 64; small ones merge from afar, large ones keep their
    /// balls.
    Blobby,
    /// Metaballs (Nishimura et al. 1985): `α (1 - 3 r²/R²)` up to R/3, `3α/2 (1 - r/R)²` up to R, nothing beyond. The first derivative
    /// is continuous, the second is not. Parameters: the reach R and the amplitude α, taken off where it is negative.
    Metaballs,
    /// Soft objects (Wyvill et al. 1986): `w (1 - 22/9 ρ² + 17/9 ρ⁴ - 4/9 ρ⁶)` with ρ = r/R up to 1, nothing beyond; half of w at
    /// ρ = 1/2. Parameters: the reach R and the weight w, taken off where it is negative.
    SoftObjects,
}

impl BlobForm {
    /// All forms.
    pub const ALL: [Self; 4] = [Self::Blinn, Self::Blobby, Self::Metaballs, Self::SoftObjects];

    /// The name in text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blinn => "blinn",
            Self::Blobby => "blobby",
            Self::Metaballs => "metaballs",
            Self::SoftObjects => "soft_objects",
        }
    }

    /// What a blob's two parameters are.
    pub fn parameters(self) -> [&'static str; 2] {
        match self {
            Self::Blinn => ["amplitude", "decay"],
            Self::Blobby => ["radius", "blobbiness"],
            Self::Metaballs => ["radius", "amplitude"],
            Self::SoftObjects => ["radius", "weight"],
        }
    }
}

/// A centre with the two parameters that [`BlobForm`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// The centre.
    pub center: DVec3,
    /// Amplitude and decay, radius and blobbiness, radius and amplitude, or radius and weight.
    pub parameters: [f64; 2],
}

impl Blob {
    /// A centre with its parameters in the order of [`BlobForm::parameters`].
    pub fn new(center: DVec3, first: f64, second: f64) -> Self {
        Self { center, parameters: [first, second] }
    }
}
