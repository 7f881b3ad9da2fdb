//! Protein Data Bank files, whole and damaged.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{CancelFlag, Category, Diagnostic, Exec, Limits, Place, Stop};
use shapeloom_implicit::Element;

use super::read_pdb;
use crate::read_molecule::at;
use crate::{ReadContext, ReadError, ReadMolecule};

const FILE: &str = "\
HEADER    MADE UP
TITLE     A RESIDUE WITH
TITLE    2 TWO LOCATIONS
ATOM      1  N   SER A  17     -16.074  -6.064  -3.588  1.00  0.00           N  
ATOM      2  CA ASER A  17      -1.500   2.000   3.250  0.60  0.00           C  
ATOM      3  CA BSER A  17      -9.500   2.000   3.250  0.40  0.00           C  
ATOM      4  CB CSER A  18       1.000   2.000   3.000  0.40  0.00           C1+
HETATM    5 CA    CA A 101    -910.125-120.250-130.500  1.00  0.00          CA  
TER
END
";

fn pdb(input: &[u8]) -> Result<ReadMolecule, ReadError> {
    let exec = Exec::default().with_memory(1 << 22);
    read_pdb(input, &ReadContext { exec, ..ReadContext::named("x.pdb") })
}

fn symbols(read: &ReadMolecule) -> Vec<&'static str> {
    read.molecule.atoms.iter().map(|atom| atom.element.symbol()).collect()
}

#[test]
fn columns_are_read_and_one_location_of_each_residue_kept() {
    for text in [FILE.to_owned(), FILE.replace('\n', "\r\n"), FILE.replace("  \n", "\n")] {
        let read = pdb(text.as_bytes()).unwrap();
        assert_eq!(read.molecule.title, "A RESIDUE WITH TWO LOCATIONS");
        assert_eq!(symbols(&read), ["N", "C", "C", "Ca"]);
        assert_eq!(read.molecule.atoms[0].position, DVec3::new(-16.074, -6.064, -3.588));
        assert_eq!(read.molecule.atoms[1].position, DVec3::new(-1.5, 2.0, 3.25));
        assert_eq!(read.molecule.atoms[3].position, DVec3::new(-910.125, -120.25, -130.5));
        let codes: Vec<(&str, u64)> = read.findings.iter().map(|finding| (finding.code, finding.count)).collect();
        assert_eq!(codes, [("W-pdb-alternate", 1)]);
    }
}

#[test]
fn the_first_model_alone_is_read() {
    let atom = "ATOM      1  N   SER A  17     -16.074  -6.064  -3.588  1.00  0.00           N\n";
    for (text, atoms, left) in [
        (format!("MODEL        1\n{atom}{atom}ENDMDL\nMODEL        2\n{atom}ENDMDL\n"), 2, 1),
        (format!("MODEL 1\n{atom}MODEL 2\n{atom}{atom}"), 1, 2),
        (format!("{atom}ENDMDL\n{atom}"), 1, 1),
    ] {
        let read = pdb(text.as_bytes()).unwrap();
        let models = read.findings.iter().find(|finding| finding.code == "W-pdb-models").unwrap();
        assert_eq!((read.molecule.atoms.len(), models.count), (atoms, left));
    }
}

/// Without columns 77 and 78 the name decides, by its place in columns 13 to 16.
#[test]
fn elements_come_from_names_in_old_files() {
    for (name, symbol) in [
        (" CA ", "C"),
        ("CA  ", "Ca"),
        ("1HB ", "H"),
        ("HG11", "H"),
        ("HG  ", "Hg"),
        (" OXT", "O"),
        ("FE  ", "Fe"),
        (" SG ", "S"),
        ("SE  ", "Se"),
        ("ZN  ", "Zn"),
        ("N   ", "N"),
        ("CX1 ", "C"),
        (" D2 ", "H"),
        (" ?? ", "X"),
        ("    ", "X"),
    ] {
        let read = pdb(format!("ATOM      1 {name} SER A  17       1.000   2.000   3.000\n").as_bytes()).unwrap();
        assert_eq!(symbols(&read), [symbol], "{name}");
        let code = if symbol == "X" { "W-pdb-unknown" } else { "W-pdb-element" };
        assert_eq!(read.findings.iter().next().map(|finding| finding.code), Some(code));
    }
}

#[test]
fn faults_have_line_and_column() {
    let with = |from: &str, to: &str| FILE.replacen(from, to, 1);
    for (text, code, place) in [
        (with("  -6.064", "  -6,064"), "E-pdb-number", at(4, 39)),
        (with("  -6.064", "        "), "E-pdb-number", at(4, 39)),
        (with("  -3.588", "     nan"), "E-pdb-finite", at(4, 47)),
        (with("-130.500", "  1e9999"), "E-pdb-finite", at(8, 47)),
        (with("   2.000   3.250  0.60  0.00           C  ", ""), "E-pdb-row", Place::line(5)),
        ("HEADER\nEND\n".into(), "E-pdb-truncated", Place::line(3)),
        (String::new(), "E-pdb-truncated", Place::line(1)),
    ] {
        let error = pdb(text.as_bytes()).unwrap_err();
        assert_eq!(error.fault().map(|fault| (fault.code, fault.place.clone())), Some((code, place)), "{error}");
        assert!(error.to_string().starts_with("x.pdb: ") && error.advice().is_some(), "{error}");
    }
}

#[test]
fn limits_and_budgets_are_kept() {
    let read = |limits, exec| read_pdb(FILE.as_bytes(), &ReadContext { limits, exec, ..ReadContext::default() });
    let limits = Limits { max_elements: 2, ..Limits::default() };
    let error = read(limits, Exec::default()).unwrap_err();
    assert_eq!((error.code(), error.category()), ("E-pdb-limit", Category::OverLimit));
    let limits = Limits { max_bytes: 100, ..Limits::default() };
    assert_eq!(read(limits, Exec::default()).unwrap_err().code(), "E-read-size");
    assert!(matches!(read(Limits::default(), Exec::default().with_memory(9)), Err(ReadError::OverBudget(_))));
    let flag = CancelFlag::default();
    flag.cancel();
    let cancelled = read(Limits::default(), Exec::default().with_cancel(&flag));
    assert_eq!(cancelled, Err(ReadError::Stop(Stop::Cancelled)));
}

#[test]
fn damaged_files_never_panic() {
    crate::test_data::shake(FILE.as_bytes(), 5000, |bytes| match pdb(bytes) {
        Ok(read) => {
            assert!(read.molecule.atoms.iter().all(|atom| atom.position.is_finite()));
            true
        }
        Err(error) => {
            assert!(error.advice().is_some(), "{error}");
            false
        }
    });
}

/// The counts of records are those of the collection's manifest.
#[test]
fn entries_of_the_data_bank_have_their_atoms() {
    for (name, records, alternates, sulfur, selenium, zinc) in
        [("1A8O", 644, None, 2, 4, 0), ("2BEG", 1855, Some(0), 5, 0, 0), ("7DDO", 6468, None, 37, 0, 1)]
    {
        let Some(path) = crate::test_data::shared_data(&format!("molecules/{name}.pdb")) else { continue };
        let bytes = std::fs::read(path).unwrap();
        let read = pdb(&bytes).unwrap();
        let left =
            read.findings.iter().find(|finding| finding.code == "W-pdb-alternate").map_or(0, |found| found.count);
        assert_eq!(read.molecule.atoms.len() as u64 + left, records, "{name}");
        assert!(alternates.is_none_or(|count| count == left));
        let count = |symbol: &str| symbols(&read).iter().filter(|known| **known == symbol).count();
        assert_eq!((count("S"), count("Se"), count("Zn"), count("X")), (sulfur, selenium, zinc, 0), "{name}");
        assert!(!read.molecule.title.is_empty());
        assert!(read.molecule.atoms.iter().all(|atom| atom.element != Element::UNKNOWN));
    }
}
