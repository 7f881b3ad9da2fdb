//! What fuzzing calls, shared with the mutation loop of the ordinary tests.

use shapeloom::core::{Exec, Threads};
use shapeloom::io::{ReadContext, WriteContext, format_by_id, read, write};

/// Reads an input as a format, under a budget of 64 MB and 40 times its size. What is read must be writable in the same
/// format where that has a writer, and what was written must be readable. Returns whether the input was read.
pub fn read_as(id: &str, input: &[u8]) -> bool {
    let format = format_by_id(id).expect("a format of the table");
    let exec = Exec::default().with_memory((64 << 20) + 40 * input.len() as u64).with_threads(Threads::Sequential);
    let context = ReadContext { exec, ..ReadContext::named("fuzz") };
    let shape = match read(input, format, &context) {
        Ok(read) => {
            assert!(read.findings.iter().all(|finding| !finding.message.is_empty() && finding.count > 0));
            read.shape
        }
        Err(error) => {
            assert!(error.to_string().starts_with("fuzz") || error.fault().is_none(), "{error}");
            return false;
        }
    };
    assert_eq!(context.exec.memory_taken(), 0, "{id}: reservations are returned");
    let holds = shape.parts.iter().all(|part| format.holds(part.geometry.kind()));
    if format.writes.is_some() && holds {
        let mut bytes = Vec::new();
        // Positions beyond single precision are an error of writers that have no more.
        if write(&shape, format, &WriteContext::default(), &mut bytes).is_ok()
            && let Err(error) = read(&bytes, format, &ReadContext::named("again"))
        {
            panic!("{id}: what was written is not read: {error}");
        }
    }
    true
}
