//! Names and comments, which shapes keep in UTF-8.

use std::borrow::Cow;

use shapeloom_core::{Findings, Place, Severity};

/// A name or comment as text. Bytes that are no UTF-8 become replacement characters, and a finding says so.
pub(crate) fn lossy<'a>(bytes: &'a [u8], place: Place, findings: &mut Findings) -> Cow<'a, str> {
    let text = String::from_utf8_lossy(bytes);
    if matches!(text, Cow::Owned(_)) {
        let message = "a name or comment is not in UTF-8: what could not be read was replaced";
        findings.push("W-text-encoding", Severity::Warning, place, message);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_replaced_is_told() {
        let mut findings = Findings::default();
        assert_eq!(lossy("gr\u{fc}n".as_bytes(), Place::line(1), &mut findings), "gr\u{fc}n");
        assert!(findings.is_empty());
        assert_eq!(lossy(b"gr\xfcn", Place::line(2), &mut findings), "gr\u{fffd}n");
        assert_eq!(findings.iter().next().unwrap().places, [Place::line(2)]);
    }
}
