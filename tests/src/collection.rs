//! The collection of real and malformed files beside the workspace, where it is there, with what is known of each.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use shapeloom::core::{Diagnostic, Exec, Place};
use shapeloom::io::{
    ReadContext, ReadError, ReadOptions, ReadShape, SiblingError, SiblingName, Siblings, WriteContext, WriteOptions,
    detect, format_by_id, read, write,
};
use shapeloom::mesh::{PolyMesh, TriMesh};
use shapeloom::shape::{Geometry, Shape};

use crate::support::shared_data;

/// The folder of an input.
struct Folder(PathBuf);

impl Siblings for Folder {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let bytes = fs::read(self.0.join(name.as_str())).map_err(|_| SiblingError::Missing)?;
        Ok(bytes.into_iter().take(usize::try_from(max_bytes).unwrap_or(usize::MAX)).collect())
    }
}

/// Reads a file as the program does, under a budget of 64 MB and 40 times its size.
pub fn read_file(path: &Path) -> Result<ReadShape, ReadError> {
    read_file_with(path, ReadOptions::new())
}

/// The same with options.
pub fn read_file_with(path: &Path, options: ReadOptions) -> Result<ReadShape, ReadError> {
    let bytes = fs::read(path).expect("a file of the collection");
    let name = path.display().to_string();
    let exec = Exec::default().with_memory((64 << 20) + 40 * bytes.len() as u64);
    let siblings: Option<Arc<dyn Siblings>> = Some(Arc::new(Folder(path.parent().expect("a folder").to_owned())));
    let context = ReadContext { exec, siblings, options, ..ReadContext::named(name.as_str()) };
    let format = detect(&bytes, Some(&name)).unwrap_or_else(|error| panic!("{error}"));
    read(&bytes, format, &context)
}

/// What a malformed file must come to.
#[derive(Debug)]
pub struct Case {
    pub path: PathBuf,
    outcome: String,
    kinds: Vec<String>,
    location: String,
}

/// The cases of a format; none where the collection is not there.
pub fn expected(format: &str) -> Vec<Case> {
    let Some(list) = shared_data("malformed/EXPECTED.tsv") else { return Vec::new() };
    let text = fs::read_to_string(list).expect("a list");
    let rows = text.lines().map(|line| line.split('\t').collect::<Vec<_>>()).filter(|row| row[0] == format);
    rows.map(|row| Case {
        path: shared_data(&format!("malformed/{format}/{}", row[1])).expect("the file of a case"),
        outcome: row[3].to_owned(),
        kinds: row[4].split('|').map(str::to_owned).collect(),
        location: row[5].to_owned(),
    })
    .collect()
}

impl Case {
    /// Reads the file and compares. `codes` says what the project calls a kind of defect.
    pub fn check(&self, codes: impl Fn(&str) -> &'static [&'static str]) {
        self.check_with(ReadOptions::new(), codes);
    }

    /// The same with options.
    pub fn check_with(&self, options: ReadOptions, codes: impl Fn(&str) -> &'static [&'static str]) {
        let name = self.path.file_name().expect("a name").to_string_lossy().into_owned();
        let wanted: Vec<&str> = self.kinds.iter().flat_map(|kind| codes(kind)).copied().collect();
        let result = read_file_with(&self.path, options);
        match (self.outcome.as_str(), result) {
            ("accept", Ok(read)) => {
                let warnings: Vec<_> = read.findings.iter().collect();
                assert!(warnings.is_empty(), "{name}: {warnings:?}");
            }
            ("accept+warn", Ok(read)) => {
                let finding = read.findings.iter().find(|finding| wanted.contains(&finding.code));
                let finding = finding.unwrap_or_else(|| panic!("{name}: {:?}, wanted {wanted:?}", read.findings));
                let said = format!("{} {}", finding.places[0], finding.message);
                assert!(self.is_at(&finding.places[0], &said), "{name}: {finding}, expected {}", self.location);
            }
            ("error", Err(error)) => {
                assert!(wanted.contains(&error.code()), "{name}: {error}, wanted {wanted:?}");
                let place = error.fault().map_or(Place::Whole, |fault| fault.place.clone());
                assert!(self.is_at(&place, &error.to_string()), "{name}: {error}, expected {}", self.location);
            }
            (outcome, result) => panic!("{name}: expected {outcome}, found {result:?}"),
        }
    }

    /// Whether a place is the expected one; what places cannot say must be in the message.
    fn is_at(&self, place: &Place, message: &str) -> bool {
        let (main, within) = match self.location.split_once(" (") {
            Some((main, within)) => (main, Some(within.trim_end_matches(')'))),
            None => (self.location.as_str(), None),
        };
        // "line 1" is not in "line 12".
        let said = message
            .match_indices(main)
            .any(|(at, found)| !message[at + found.len()..].starts_with(|next: char| next.is_ascii_digit()));
        let exact = place.to_string() == main || said || main == "-" || main == "last byte";
        exact && within.is_none_or(|within| message.contains(within))
    }
}

/// What is known of a mesh file.
#[derive(Clone, Debug)]
pub struct Facts {
    pub path: PathBuf,
    pub vertices: usize,
    pub faces: usize,
    pub area: Option<f64>,
    pub volume: Option<f64>,
    /// All that was measured, in words.
    pub words: String,
}

/// The measured facts of all mesh files with one of these beginnings of their path.
pub fn facts(beginnings: &[&str]) -> Vec<Facts> {
    let Some(manifest) = shared_data("MANIFEST.md") else { return Vec::new() };
    let text = fs::read_to_string(manifest).expect("a list");
    let mut found = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some(path) = beginnings.iter().find(|beginning| cells[1].starts_with(**beginning)).map(|_| cells[1]) else {
            continue;
        };
        // Measured facts stand behind those of the maker, if there are any.
        let facts = cells[cells.len() - 2];
        let facts = facts.rsplit_once("// measured:").map_or(facts, |(_, measured)| measured);
        let value = |name: &str| -> Option<f64> {
            let words = facts.split([' ', ';']).find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
            words?.parse().ok()
        };
        let (Some(vertices), Some(faces)) = (value("V"), value("F")) else { continue };
        found.push(Facts {
            path: shared_data(path).unwrap_or_else(|| panic!("{path} is listed but absent")),
            vertices: vertices as usize,
            faces: faces as usize,
            area: value("area"),
            volume: value("vol"),
            words: facts.to_owned(),
        });
    }
    found
}

/// Vertices, faces, area and volume of all meshes and points of a shape, where they are placed.
pub fn measured(shape: &Shape) -> (usize, usize, f64, f64) {
    let mut sums = (0, 0, 0.0, 0.0);
    for part in &shape.parts {
        let (vertices, faces, area, volume) = match &*part.placed() {
            Geometry::TriMesh(mesh) => of_triangles(mesh),
            Geometry::PolyMesh(mesh) => of_polygons(mesh),
            Geometry::PointCloud(cloud) if shape.parts.len() == 1 => (cloud.positions().len(), 0, 0.0, 0.0),
            _ => continue,
        };
        sums = (sums.0 + vertices, sums.1 + faces, sums.2 + area, sums.3 + volume);
    }
    sums
}

fn of_triangles(mesh: &TriMesh) -> (usize, usize, f64, f64) {
    (mesh.positions().len(), mesh.triangles().len(), mesh.area(), mesh.volume())
}

/// The area as the facts have it: of the fan of triangles from each face's first corner.
fn of_polygons(mesh: &PolyMesh) -> (usize, usize, f64, f64) {
    (mesh.positions().len(), mesh.face_count(), mesh.area(), mesh.volume())
}

impl Facts {
    /// The file's name, for messages.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Compares what was read with what is known.
    pub fn check(&self, shape: &Shape) {
        let (vertices, faces, area, volume) = measured(shape);
        let name = self.name();
        assert_eq!((vertices, faces), (self.vertices, self.faces), "{name}");
        let close = |found: f64, known: f64| (found - known).abs() <= 1e-5 * known.abs().max(1e-12);
        if let Some(known) = self.area {
            // The facts are of fans, which have more area than a concave polygon.
            let concave = ["concave_polygon.obj", "L.off"].iter().any(|concave| name.ends_with(concave));
            assert!(close(area, known) || (concave && area < known), "{name}: area {area}, known {known}");
        }
        // Known for closed meshes only, and there whatever the centre.
        if let Some(known) = self.volume {
            assert!(close(volume, known), "{name}: volume {volume}, known {known}");
        }
    }
}

/// Writes a shape and reads it again.
pub fn through(shape: &Shape, id: &str, options: WriteOptions) -> (Shape, shapeloom::core::Report) {
    let format = format_by_id(id).expect("a format");
    let mut bytes = Vec::new();
    let context = WriteContext { options, ..WriteContext::default() };
    let report = write(shape, format, &context, &mut bytes).unwrap_or_else(|error| panic!("{id}: {error}"));
    let again = read(&bytes, format, &ReadContext::named("again")).unwrap_or_else(|error| panic!("{id}: {error}"));
    (again.shape, report)
}
