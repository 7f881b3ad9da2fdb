//! `formats`: what can be read and written.

use serde_json::json;
use shapeloom_io::FORMATS;

use crate::failure::Failure;
use crate::session::Session;

pub(crate) fn run(session: &mut Session<'_>) -> Result<(), Failure> {
    if session.globals.json {
        let formats: Vec<_> = FORMATS
            .iter()
            .map(|format| {
                json!({
                    "id": format.id,
                    "name": format.name,
                    "extensions": format.extensions,
                    "media_type": format.media_type,
                    "text": format.text,
                    "up": format.up.map(|up| up.name()),
                    "precision": format.precision.name(),
                    "kinds": format.kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>(),
                    "keeps": format.keeps.iter().map(|keeps| keeps.name()).collect::<Vec<_>>(),
                    "read_options": format.read_options,
                    "write_options": format.write_options,
                    "reads": format.reads.is_some(),
                    "writes": format.writes.is_some(),
                })
            })
            .collect();
        return session.print_json(&json!({ "schema": "shapeloom.formats/1", "formats": formats }));
    }
    let yes = |can: bool| if can { "yes" } else { "no" };
    session.print(format_args!("{:6} {:5} {:6} {:12} name", "id", "reads", "writes", "extensions"))?;
    for format in FORMATS {
        let (reads, writes) = (yes(format.reads.is_some()), yes(format.writes.is_some()));
        let extensions = format.extensions.join(" ");
        session.print(format_args!("{:6} {reads:5} {writes:6} {extensions:12} {}", format.id, format.name))?;
    }
    Ok(())
}
