//! Molecules: atoms with their elements and places, and the blobs that they make.

mod element;
mod element_tables;

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

pub use element::Element;

use crate::blobs::{Blob, BlobForm, Blobs, BlobsError};

/// Atoms in space. Lengths are in ångströms, as in all files of molecules.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Molecule {
    /// The atoms, in the order of the file.
    pub atoms: Vec<Atom>,
    /// What the file calls it; empty where it says nothing.
    pub title: String,
}

/// An element at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// The element.
    pub element: Element,
    /// The place of the nucleus, in ångströms.
    pub position: DVec3,
}

/// How atoms become blobs by radius and blobbiness ([`BlobForm::Blobby`]) at threshold 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtomBlobs {
    /// The blobbiness, above 0 and at most 64. Small ones blur molecules to one lump, from 8 on atoms keep their balls.
    pub blobbiness: f64,
    /// What van der Waals radii are multiplied by, so that a lone atom is a sphere of this radius.
    pub scale: f64,
    /// The radius of elements without a published one, in ångströms.
    pub unknown_radius: f64,
}

impl Default for AtomBlobs {
    fn default() -> Self {
        Self { blobbiness: 2.0, scale: 1.0, unknown_radius: 2.0 }
    }
}

impl Molecule {
    /// The box around the nuclei; empty where there are none.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.atoms.iter().map(|atom| atom.position))
    }

    /// The field of a blob for each atom: Blinn's picture of a molecule (1982).
    ///
    /// # Errors
    /// No atoms, a position that is not finite, an option outside its range.
    pub fn blobs(&self, options: &AtomBlobs) -> Result<Blobs, BlobsError> {
        let blob = |atom: &Atom| {
            let radius = atom.element.van_der_waals_radius().unwrap_or(options.unknown_radius) * options.scale;
            Blob::new(atom.position, radius, options.blobbiness)
        };
        Blobs::try_new(BlobForm::Blobby, 1.0, self.atoms.iter().map(blob).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Field;

    #[test]
    fn a_lone_atom_is_a_ball_of_its_radius() {
        let carbon = Element::from_symbol("C").unwrap();
        let atom = Atom { element: carbon, position: DVec3::new(5e6, -3e6, 1.0) };
        let molecule = Molecule { atoms: vec![atom], title: String::new() };
        assert_eq!(molecule.bounds().size(), DVec3::ZERO);
        for scale in [0.4, 1.0] {
            let blobs = molecule.blobs(&AtomBlobs { scale, ..AtomBlobs::default() }).unwrap();
            let on = atom.position + DVec3::new(2.0, -1.0, 2.0) / 3.0 * (1.7 * scale);
            assert!(blobs.value(on).abs() < 1e-6, "{}", blobs.value(on));
            assert!(blobs.value(atom.position) < -5.0);
        }
    }

    #[test]
    fn elements_without_a_radius_get_the_one_given() {
        let molecule = |symbol: &str| Molecule {
            atoms: vec![Atom { element: Element::from_symbol(symbol).unwrap(), position: DVec3::ZERO }],
            title: String::new(),
        };
        let blobs = molecule("Og").blobs(&AtomBlobs { unknown_radius: 3.0, ..AtomBlobs::default() }).unwrap();
        assert_eq!(blobs.blobs()[0].parameters, [3.0, 2.0]);
        let bad = molecule("H").blobs(&AtomBlobs { blobbiness: -2.0, ..AtomBlobs::default() });
        assert!(matches!(bad, Err(BlobsError::Parameter { index: 0, parameter: "blobbiness", .. })));
        assert_eq!(Molecule::default().blobs(&AtomBlobs::default()), Err(BlobsError::Empty));
    }
}
