//! Texts held against trees built by methods, formulas and other evaluators.

mod faults;
mod language;
mod limits;
mod machine_lists;
mod round_trips;

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Field};

use super::*;
use crate::*;

struct Ramp;

impl Field for Ramp {
    fn value(&self, point: DVec3) -> f64 {
        point.x * point.y - point.z
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        DVec3::new(point.y, point.x, -1.0)
    }
}

/// Answers every function that begins with `r`, and words.
struct Ramps;

impl Resolver for Ramps {
    fn resolve(&self, call: &ForeignCall) -> Result<Resolved, ResolveError> {
        if call.argument == "broken" {
            let reason = "found no file, expected one".to_owned();
            return Err(ResolveError::Failed { reason, category: Category::Malformed });
        }
        match call.function.starts_with('r') || call.function == "foreign" {
            true => Ok(Resolved { field: Arc::new(Ramp), exact: false }),
            false => Err(ResolveError::UnknownFunction),
        }
    }

    fn functions(&self) -> Vec<String> {
        vec!["ramp".to_owned(), "relief".to_owned()]
    }
}

fn read(text: &str) -> Tree {
    match parse(text.as_bytes(), Some(&Ramps)) {
        Ok(parsed) => parsed.tree,
        Err(error) => panic!("{text}: {error}"),
    }
}

fn fault(text: &str) -> TextError {
    match parse(text.as_bytes(), Some(&Ramps)) {
        Ok(parsed) => panic!("{text}: {:?}", parsed.tree),
        Err(error) => error,
    }
}
