//! XYZ files of molecules, whole and damaged.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, Exec, Limits, Place};

use super::{looks_like_xyz_molecule, read_xyz_molecule};
use crate::read_molecule::at;
use crate::{ReadContext, ReadError, ReadMolecule};

const WATER: &str = "3\nwater\nO 0.0 0.0 0.117\n  H 0 0.757 -0.469\nH\t0 -0.757 -4.69e-1 0.4\n";

fn xyz(input: &str) -> Result<ReadMolecule, ReadError> {
    let exec = Exec::default().with_memory(1 << 20);
    read_xyz_molecule(input.as_bytes(), &ReadContext { exec, ..ReadContext::named("x.xyz") })
}

fn symbols(read: &ReadMolecule) -> Vec<&'static str> {
    read.molecule.atoms.iter().map(|atom| atom.element.symbol()).collect()
}

#[test]
fn atoms_come_with_their_elements() {
    for text in [WATER.to_owned(), WATER.replace('\n', "\r\n"), format!("\u{feff}{WATER}\n\n")] {
        let read = xyz(&text).unwrap();
        assert_eq!((read.molecule.title.as_str(), read.findings.iter().count()), ("water", 0));
        assert_eq!(symbols(&read), ["O", "H", "H"]);
        assert_eq!(read.molecule.atoms[2].position, DVec3::new(0.0, -0.757, -0.469));
    }
    let odd = xyz("4\n\n8 0 0 0\nC12 1 0 0\nQz 2 0 0\nfe 3 0 0\n1\nnext\nH 0 0 0\n").unwrap();
    assert_eq!(symbols(&odd), ["O", "C", "X", "Fe"]);
    let codes: Vec<&str> = odd.findings.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["W-molecule-label", "W-molecule-unknown", "W-molecule-frames"]);
}

#[test]
fn molecules_are_told_from_points() {
    for yes in [WATER, "1\r\n\r\nHe 0 0 0\r\n", "\u{feff}2\ncomment 1 2 3\ncl 0 0 0\nCl 0 0 1"] {
        assert!(looks_like_xyz_molecule(yes.as_bytes()), "{yes}");
    }
    for no in [
        "",
        "3\n",
        "3\nwater\n",
        "0 0 0\n1 1 1\n2 2 2\n",
        "3\n0 0 0\n1 1 1\n2 2 2\n",
        "3 1\n\nH 0 0 0\n",
        "3\n\nX 0 0 0\n",
    ] {
        assert!(!looks_like_xyz_molecule(no.as_bytes()), "{no}");
    }
}

#[test]
fn faults_have_line_and_column() {
    for (text, code, place) in [
        ("", "E-molecule-count", Place::line(1)),
        ("0\n\n", "E-molecule-count", Place::line(1)),
        ("three\n\nH 0 0 0\n", "E-molecule-count", Place::line(1)),
        ("-3\n\nH 0 0 0\n", "E-molecule-count", Place::line(1)),
        ("2\n\nH 0 0 0\n", "E-molecule-truncated", Place::line(4)),
        ("99999999999999999\n\nH 0 0 0\n", "E-molecule-truncated", Place::line(4)),
        ("1\n\nH 0 0\n", "E-molecule-number", at(3, 6)),
        ("1\n\nH  0 1,5 0\n", "E-molecule-number", at(3, 6)),
        ("1\n\nH 0 0 inf\n", "E-molecule-finite", at(3, 7)),
        ("2\n\n\nH 0 0 0\n", "E-molecule-number", at(3, 1)),
    ] {
        let error = xyz(text).unwrap_err();
        assert_eq!(error.fault().map(|fault| (fault.code, fault.place.clone())), Some((code, place)), "{error}");
        assert!(error.advice().is_some(), "{error}");
    }
    let limits = Limits { max_elements: 2, ..Limits::default() };
    let error = read_xyz_molecule(WATER.as_bytes(), &ReadContext { limits, ..ReadContext::default() }).unwrap_err();
    assert_eq!((error.code(), error.category()), ("E-molecule-limit", Category::OverLimit));
}

#[test]
fn damaged_files_never_panic() {
    let context = ReadContext { exec: Exec::default().with_memory(1 << 20), ..ReadContext::default() };
    crate::test_data::shake(WATER.as_bytes(), 5000, |bytes| {
        looks_like_xyz_molecule(bytes);
        match read_xyz_molecule(bytes, &context) {
            Ok(read) => read.molecule.atoms.iter().all(|atom| atom.position.is_finite()),
            Err(_) => false,
        }
    });
}

/// Buckminsterfullerene: each carbon has three neighbours, two along the sides of its pentagon and one across.
#[test]
fn the_fullerene_of_the_data_has_its_bonds() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/c60.xyz");
    let bytes = std::fs::read(path).unwrap();
    assert!(looks_like_xyz_molecule(&bytes));
    let read = read_xyz_molecule(&bytes, &ReadContext::default()).unwrap();
    let atoms = &read.molecule.atoms;
    assert_eq!((atoms.len(), read.findings.iter().count()), (60, 0));
    for atom in atoms {
        let mut near: Vec<f64> = atoms.iter().map(|other| other.position.distance(atom.position)).collect();
        near.sort_unstable_by(f64::total_cmp);
        let bonds = [near[1], near[2], near[3]];
        for (bond, published) in bonds.into_iter().zip([1.401, 1.458, 1.458]) {
            assert!((bond - published).abs() < 1e-5, "{bonds:?}");
        }
        assert!(near[4] > 2.3);
    }
}
