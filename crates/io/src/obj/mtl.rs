//! Material libraries (MTL), read and written.
//!
//! Of a material the name, the diffuse colour `Kd` as base colour, the opacity `d` (or `Tr`, its complement), the
//! roughness `Pr`, the metalness `Pm` and the texture `map_Kd` are kept. Numbers are taken as they are: most programs
//! write linear colours.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;

use shapeloom_core::{Findings, Loss, Place, Severity};
use shapeloom_shape::Material;

use super::labels::Statements;
use crate::text::{Scanner, plain_text, quoted};
use crate::{ReadContext, ReadError, SiblingError, SiblingName};

/// All libraries of a file together are no longer than this: a material takes some 30 times its shortest text.
const MOST_BYTES: u64 = 1 << 21;

/// The materials that the file uses, in the order of their first use, then the others of its libraries.
pub(super) fn materials(
    statements: &Statements,
    context: &ReadContext,
    findings: &mut Findings,
    losses: &mut Vec<Loss>,
) -> Result<Vec<Material>, ReadError> {
    let mut library = Library::default();
    let mut complete = true;
    let mut seen = BTreeSet::new();
    let mut room = MOST_BYTES;
    for (words, offset) in &statements.libraries {
        if !seen.insert(words) {
            continue;
        }
        context.exec.check()?;
        let place = Place::Byte(*offset as u64);
        // A name may have spaces, or there are several.
        let several: Vec<&str> = words.split_whitespace().collect();
        let names = if several.len() > 1 && open(words, 1, context).is_err() { several } else { vec![words.as_str()] };
        for name in names {
            match open(name, room + 1, context) {
                Ok(bytes) if bytes.len() as u64 <= room => {
                    room -= bytes.len() as u64;
                    library.read(name, &bytes, &place, context, findings);
                }
                Ok(_) => {
                    complete = false;
                    let message =
                        format!("\"{name}\" was not read: found more than {MOST_BYTES} bytes of material libraries");
                    findings.push("W-obj-library", Severity::Warning, place.clone(), message);
                }
                Err(why) => {
                    complete = false;
                    let message = format!("the material library \"{name}\" was not read: {why}");
                    findings.push("W-obj-library", Severity::Warning, place.clone(), message);
                }
            }
        }
    }
    let mut materials: Vec<Material> = Vec::new();
    for (name, &offset) in statements.materials.list.iter().zip(&statements.material_places).skip(1) {
        materials.push(match library.take(name) {
            Some(material) => material,
            None => {
                if complete {
                    let severity = if statements.libraries.is_empty() { Severity::Note } else { Severity::Warning };
                    let message = format!("no material library has \"{name}\"; only its name is known");
                    findings.push("W-obj-material", severity, Place::Byte(offset as u64), message);
                }
                Material { name: name.clone(), ..Material::default() }
            }
        });
    }
    materials.extend(library.materials.into_iter().flatten());
    if !library.ignored.is_empty() {
        let words: Vec<String> = library.ignored.into_iter().collect();
        let why = "shapes keep base colour, opacity, metalness, roughness and the base colour texture";
        losses.push(Loss::new(format!("material properties {}", words.join(", ")), why));
    }
    for texture in materials.iter().filter_map(|material| material.texture.as_deref()) {
        let missing = match (&context.siblings, SiblingName::try_new(texture)) {
            (Some(siblings), Ok(name)) => siblings.open(&name, 1).is_err(),
            _ => false,
        };
        if missing {
            let message = format!("the texture \"{texture}\" is not there; its name was kept");
            findings.push("W-obj-texture", Severity::Warning, Place::Whole, message);
        }
    }
    Ok(materials)
}

fn open(name: &str, max_bytes: u64, context: &ReadContext) -> Result<Vec<u8>, SiblingError> {
    let sibling = SiblingName::try_new(name)?;
    match &context.siblings {
        None => Err(SiblingError::Io("the input stands alone".into())),
        Some(siblings) => siblings.open(&sibling, max_bytes),
    }
}

/// The materials of libraries as they are read.
#[derive(Default)]
struct Library {
    materials: Vec<Option<Material>>,
    known: HashMap<String, usize>,
    ignored: BTreeSet<String>,
}

impl Library {
    fn take(&mut self, name: &str) -> Option<Material> {
        self.materials[*self.known.get(name)?].take()
    }

    /// Reads a library; what is wrong in it is a finding at the statement that named it.
    fn read(&mut self, file: &str, bytes: &[u8], place: &Place, context: &ReadContext, findings: &mut Findings) {
        let mut odd = |line: u64, what: String| {
            let message = format!("{file}: line {line}: {what}");
            findings.push("W-obj-library", Severity::Warning, place.clone(), message);
        };
        let Ok(text) = plain_text(bytes, &context.limits) else {
            return odd(1, "found no UTF-8 text".into());
        };
        let mut current: Option<usize> = None;
        let mut line = 0;
        let mut scan = Scanner::new(text, 0);
        loop {
            line += 1;
            let word = scan.word();
            let material = current.and_then(|index| self.materials.get_mut(index)?.as_mut());
            match (word, material) {
                (b"", _) => {}
                (word, _) if word.starts_with(b"#") => {}
                (b"newmtl", _) => {
                    let name = words(&scan);
                    current = Some(self.materials.len());
                    self.known.entry(name.clone()).or_insert(self.materials.len());
                    self.materials.push(Some(Material { name, ..Material::default() }));
                }
                (word, None) => odd(line, format!("found {} before any newmtl, which was passed over", quoted(word))),
                (b"Kd", Some(material)) => match [scan.number(), scan.number(), scan.number()] {
                    [Ok(r), Ok(g), Ok(b)] => {
                        if [r, g, b].iter().any(|number| !(0.0..=1.0).contains(number)) {
                            odd(line, format!("found Kd {r} {g} {b}, beyond 0 to 1: the nearer ends were taken"));
                        }
                        for (slot, number) in material.base_color.iter_mut().zip([r, g, b]) {
                            *slot = (number as f32).clamp(0.0, 1.0);
                        }
                    }
                    // One number is a grey.
                    [Ok(grey), _, _] if scan.at_line_end_or_comment() => {
                        material.base_color[..3].fill((grey as f32).clamp(0.0, 1.0));
                    }
                    _ => odd(line, "found Kd without three numbers, which was passed over".into()),
                },
                (b"d" | b"Tr" | b"Pr" | b"Pm", Some(material)) => match scan.number() {
                    Ok(number) => {
                        if !(0.0..=1.0).contains(&number) {
                            odd(
                                line,
                                format!("found {} {number}, beyond 0 to 1: the nearer end was taken", quoted(word)),
                            );
                        }
                        let number = (number as f32).clamp(0.0, 1.0);
                        match word {
                            b"d" => material.base_color[3] = number,
                            b"Tr" => material.base_color[3] = 1.0 - number,
                            b"Pr" => material.roughness = number,
                            _ => material.metallic = number,
                        }
                    }
                    Err(_) => odd(line, format!("found {} without a number, which was passed over", quoted(word))),
                },
                (b"map_Kd", Some(material)) => material.texture = texture(&mut scan),
                (word, Some(_)) => {
                    if self.ignored.len() < 64 {
                        self.ignored.insert(String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned());
                    }
                }
            }
            if !scan.next_line() {
                break;
            }
        }
    }
}

/// The rest of the line as one name, words apart by single spaces.
fn words(scan: &Scanner<'_>) -> String {
    let words: Vec<&[u8]> =
        scan.rest_of_line().split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
    String::from_utf8_lossy(&words.join(&b' ')).into_owned()
}

/// The file name after the options of a texture: those are a word from `-`, and numbers, `on` or `off` behind it.
fn texture(scan: &mut Scanner<'_>) -> Option<String> {
    loop {
        let mut ahead = scan.clone();
        if !ahead.word().starts_with(b"-") {
            break;
        }
        *scan = ahead.clone();
        loop {
            let before = ahead.clone();
            let value = ahead.number().is_ok() || matches!(ahead.word(), b"on" | b"off");
            if !value || before.offset() == ahead.offset() {
                break;
            }
            *scan = ahead.clone();
        }
    }
    let name = String::from_utf8_lossy(scan.rest_of_line()).into_owned();
    (!name.is_empty()).then_some(name)
}

/// The name of a texture, if a statement can hold it.
pub(super) fn texture_name(name: &str) -> Option<&str> {
    let plain = !name.is_empty() && !name.starts_with('-') && !name.chars().any(char::is_control);
    (plain && name.trim() == name && !name.ends_with('\\')).then_some(name)
}

/// A library of these materials.
pub(super) fn library(materials: &[Material]) -> String {
    let mut text = String::from("# written by shapeloom\n");
    for material in materials {
        let [r, g, b, a] = material.base_color.map(|number| number.to_string());
        let (roughness, metallic) = (material.roughness, material.metallic);
        // Writing to a string does not fail.
        let _ = write!(text, "newmtl {}\nKd {r} {g} {b}\nd {a}\nPr {roughness}\nPm {metallic}\n", material.name);
        if let Some(texture) = material.texture.as_deref().and_then(texture_name) {
            let _ = writeln!(text, "map_Kd {texture}");
        }
    }
    text
}
