//! What a mesh structure is to be used for.

use shapeloom_mesh::structures::Query;

use crate::failure::Failure;

/// How often each thing is done.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Workload {
    /// How often each query is asked, in the order of [`Query::ALL`].
    pub(crate) queries: [f64; 9],
    /// How often the mesh changes.
    pub(crate) updates: f64,
    /// How much size counts: a structure of twice the size is as if 2 to the power of this times as slow.
    pub(crate) size: f64,
}

impl Workload {
    /// Reads `VV=1e6,updates=100,size=1`.
    pub(crate) fn parse(words: &str) -> Result<Self, Failure> {
        let mut workload = Self { queries: [0.0; 9], updates: 0.0, size: 0.0 };
        for word in words.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            let wrong = |found: &str, expected: &str| {
                Failure::usage("E-structures-mix", format!("--mix {words}: found {found}, expected {expected}"))
            };
            let (key, value) = word.split_once('=').ok_or_else(|| wrong(word, "KEY=N"))?;
            let (key, value) = (key.trim(), value.trim());
            let number = value.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
            let number = number.ok_or_else(|| wrong(&format!("{key}={value}"), "a finite number from 0"))?;
            match Query::ALL.into_iter().position(|query| query.name().eq_ignore_ascii_case(key)) {
                Some(query) => workload.queries[query] += number,
                None if key == "queries" => workload.queries.iter_mut().for_each(|count| *count += number / 9.0),
                None if key == "updates" => workload.updates += number,
                None if key == "size" => workload.size += number,
                None => {
                    let known = "VV, VE, VF, EV, EE, EF, FV, FE, FF, queries, updates or size";
                    return Err(wrong(&format!("the key {key}"), known));
                }
            }
        }
        let counts = || workload.queries.iter().chain([&workload.updates, &workload.size]);
        let wrong = |found: &str, expected: &str| {
            Failure::usage("E-structures-mix", format!("--mix {words:?}: found {found}, expected {expected}"))
        };
        if counts().any(|count| !count.is_finite()) {
            return Err(wrong("numbers of one key that are beyond 1.8e308 together", "finite ones"));
        }
        if workload.updates == 0.0 && workload.asked().next().is_none() {
            return Err(wrong("no query and no update", "at least one, such as queries=1e6 or updates=100"));
        }
        Ok(workload)
    }

    /// The queries that are asked at all.
    pub(crate) fn asked(&self) -> impl Iterator<Item = (Query, f64)> + '_ {
        Query::ALL.into_iter().zip(self.queries).filter(|&(_, count)| count > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixes_are_read_and_wrong_ones_named() {
        let mix = Workload::parse("queries=9, VV=4,updates=2,size=0.5").unwrap();
        assert_eq!(mix.queries, [5.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!((mix.updates, mix.size), (2.0, 0.5));
        assert_eq!(Workload::parse("updates=1").unwrap().asked().count(), 0);
        // Nothing to rank by.
        for empty in ["", " , ", "VV=0", "queries=0,updates=0", "size=1"] {
            let error = Workload::parse(empty).unwrap_err();
            let told = format!("{error:?}");
            assert!(error.exit_code() == 2 && told.contains("no query and no update"), "{told}");
        }
        assert_eq!(Workload::parse("VV=1e308,VV=1e308").unwrap_err().exit_code(), 2);
        for wrong in ["VV", "VV=", "VV=-1", "VV=nan", "XX=3", "updates=inf", "=3"] {
            let error = Workload::parse(wrong).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{wrong}");
            assert!(format!("{error:?}").contains(wrong.split('=').next().unwrap_or_default()), "{error:?}");
        }
    }
}
