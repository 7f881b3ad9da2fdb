//! JSON values that know where they stand.

use serde_json::Value;
use shapeloom_core::{OverBudget, Place};

use crate::Fault;
use crate::memory::Memory;
use crate::text::quoted;

/// Parses a document.
///
/// Memory for the values is reserved first, from a count of the brackets and commas outside of strings: the text of a
/// value may be eighty times smaller than the value.
///
/// # Errors
/// The outer ones are of the budget, the inner ones of the text, with the place by `place_of` its line, column and
/// offset.
pub(super) fn parse(
    text: &[u8],
    memory: &mut Memory<'_>,
    place_of: impl Fn(u64, u64, usize) -> Place,
) -> Result<Result<Value, Box<Fault>>, OverBudget> {
    let mut weight = text.len();
    let mut in_string = false;
    let mut escaped = false;
    for &byte in text {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => {
                in_string = !in_string;
                weight += 24;
            }
            _ if in_string => {}
            // A node of a tree map, with room for eleven members, is allocated at the first.
            b'{' => weight += 700,
            b'[' => weight += 160,
            b',' => weight += 128,
            _ => {}
        }
    }
    memory.take(weight, 1)?;
    Ok(serde_json::from_slice(text).map_err(|error| {
        let (line, column) = (error.line() as u64, error.column() as u64);
        let start = text.split(|&byte| byte == b'\n').take(error.line().saturating_sub(1)).map(|line| line.len() + 1);
        let offset = start.sum::<usize>() + error.column().saturating_sub(1);
        let message = error.to_string();
        // The place is said apart.
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(said, _)| said);
        Fault::new("E-gltf-json", place_of(line, column, offset), message, "JSON")
    }))
}

/// A value with its path from the root of the document, a JSON pointer (RFC 6901): `/accessors/3/count`.
#[derive(Clone, Debug)]
pub(super) struct At<'j> {
    pub value: &'j Value,
    pub path: String,
}

impl<'j> At<'j> {
    pub fn root(value: &'j Value) -> Self {
        Self { value, path: String::new() }
    }

    /// An error here.
    pub fn fault(&self, code: &'static str, found: impl Into<String>, expected: impl Into<String>) -> Box<Fault> {
        let fault = Fault::new(code, Place::Whole, found, expected);
        if self.path.is_empty() { fault } else { fault.within(&self.path) }
    }

    fn wrong(&self, expected: &str) -> Box<Fault> {
        let found = match self.value {
            Value::Array(values) => format!("an array of {}", values.len()),
            Value::Object(_) => "an object".into(),
            Value::String(text) => quoted(text.as_bytes()),
            other => other.to_string(),
        };
        self.fault("E-gltf-type", found, expected)
    }

    pub fn child(&self, key: &str) -> String {
        if key.contains(['~', '/']) {
            return format!("{}/{}", self.path, key.replace('~', "~0").replace('/', "~1"));
        }
        format!("{}/{key}", self.path)
    }

    /// A member, if there is one.
    pub fn get(&self, key: &str) -> Result<Option<At<'j>>, Box<Fault>> {
        let object = self.value.as_object().ok_or_else(|| self.wrong("an object"))?;
        Ok(object.get(key).map(|value| At { value, path: self.child(key) }))
    }

    /// A member that must be there.
    pub fn require(&self, key: &str) -> Result<At<'j>, Box<Fault>> {
        let missing = || {
            Fault::new("E-gltf-missing", Place::Whole, "nothing", "a value: glTF requires it").within(self.child(key))
        };
        self.get(key)?.ok_or_else(missing)
    }

    /// The members in the order of their names.
    pub fn members(&self) -> Result<Vec<(&'j str, At<'j>)>, Box<Fault>> {
        let object = self.value.as_object().ok_or_else(|| self.wrong("an object"))?;
        let mut members: Vec<(&str, At<'j>)> =
            object.iter().map(|(key, value)| (key.as_str(), At { value, path: self.child(key) })).collect();
        members.sort_by_key(|(key, _)| *key);
        Ok(members)
    }

    /// The elements of an array.
    pub fn elements(&self) -> Result<impl ExactSizeIterator<Item = At<'j>> + use<'j>, Box<Fault>> {
        let array = self.value.as_array().ok_or_else(|| self.wrong("an array"))?;
        let path = self.path.clone();
        Ok(array.iter().enumerate().map(move |(i, value)| At { value, path: format!("{path}/{i}") }))
    }

    /// How many elements a member has that is an array; none if it is absent.
    pub fn count(&self, key: &str) -> Result<usize, Box<Fault>> {
        self.get(key)?.map_or(Ok(0), |array| Ok(array.elements()?.len()))
    }

    /// The element of the document's list `list` that `index` names.
    pub fn element(&self, list: &str, index: &At<'_>) -> Result<At<'j>, Box<Fault>> {
        let number = index.count_value()?;
        let path = format!("/{list}/{number}");
        let value = self.value.get(list).and_then(|list| list.get(usize::try_from(number).ok()?));
        value.map(|value| At { value, path }).ok_or_else(|| {
            let count = self.value.get(list).and_then(Value::as_array).map_or(0, Vec::len);
            index.fault("E-gltf-reference", number.to_string(), format!("one of the {count} elements of \"{list}\""))
        })
    }

    pub fn text(&self) -> Result<&'j str, Box<Fault>> {
        self.value.as_str().ok_or_else(|| self.wrong("a string"))
    }

    pub fn flag(&self) -> Result<bool, Box<Fault>> {
        self.value.as_bool().ok_or_else(|| self.wrong("true or false"))
    }

    pub fn number(&self) -> Result<f64, Box<Fault>> {
        self.value.as_f64().filter(|number| number.is_finite()).ok_or_else(|| self.wrong("a finite number"))
    }

    /// A whole number from 0; 3.0 is one too.
    pub fn count_value(&self) -> Result<u64, Box<Fault>> {
        let whole = || self.value.as_f64().filter(|n| n.fract() == 0.0 && (0.0..9e15).contains(n)).map(|n| n as u64);
        self.value.as_u64().or_else(whole).ok_or_else(|| self.wrong("a whole number from 0"))
    }

    /// A member that is a whole number, or what glTF takes where it is absent.
    pub fn count_or(&self, key: &str, default: u64) -> Result<u64, Box<Fault>> {
        self.get(key)?.map_or(Ok(default), |member| member.count_value())
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N], Box<Fault>> {
        let elements = self.elements()?;
        if elements.len() != N {
            return Err(self.wrong(&format!("{N} numbers")));
        }
        let mut numbers = [0.0; N];
        for (number, element) in numbers.iter_mut().zip(elements) {
            *number = element.number()?;
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Exec;

    #[test]
    fn paths_lead_to_the_place() {
        let value = serde_json::json!({"accessors": [{"count": -1}], "n": [1, "x"]});
        let root = At::root(&value);
        let accessor = root.require("accessors").unwrap().elements().unwrap().next().unwrap();
        let fault = accessor.require("count").unwrap().count_value().unwrap_err();
        assert_eq!(fault.within.as_deref(), Some("/accessors/0/count"));
        assert_eq!(fault.found, "-1");
        assert_eq!(accessor.require("type").unwrap_err().within.as_deref(), Some("/accessors/0/type"));
        assert_eq!(root.require("n").unwrap().numbers::<2>().unwrap_err().within.as_deref(), Some("/n/1"));
        assert_eq!(root.child("a/b~c"), "/a~1b~0c");
        let index = At { value: &serde_json::json!(7), path: "/nodes/0/mesh".into() };
        let fault = At::root(&value).element("accessors", &index).unwrap_err();
        assert_eq!((fault.code, fault.within.as_deref()), ("E-gltf-reference", Some("/nodes/0/mesh")));
    }

    #[test]
    fn faults_of_the_text_have_line_column_and_offset() {
        let exec = Exec::default();
        let fault = parse(b"{\n \"a\": 1,\n}", &mut Memory::new(&exec), |line, column, offset| {
            assert_eq!((line, column, offset), (3, 1, 11));
            Place::Byte(offset as u64)
        });
        assert_eq!(fault.unwrap().unwrap_err().code, "E-gltf-json");
    }

    #[test]
    fn small_text_that_makes_large_values_meets_the_budget() {
        let text = format!("[{}1]", "{\"\":0},".repeat(100_000));
        let exec = Exec::default().with_memory(16 << 20);
        assert!(parse(text.as_bytes(), &mut Memory::new(&exec), |_, _, _| Place::Whole).is_err());
        let deep = "[".repeat(100_000);
        let fault = parse(deep.as_bytes(), &mut Memory::new(&Exec::default()), |_, _, _| Place::Whole).unwrap();
        assert!(fault.unwrap_err().found.contains("recursion"));
    }
}
