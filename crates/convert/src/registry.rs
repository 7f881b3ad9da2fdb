//! Every converter, by name.

use shapeloom_core::{Convert, ConvertError, Converted, Exec, FromTolerance, OptionSpec, OptionValue, Options};
use shapeloom_shape::{Geometry, Kind, Representation};

/// What a conversion needs to know beside its source.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// The tolerance in the units of the source.
    pub tolerance: f64,
    /// Options to set, by name.
    pub settings: &'a [(String, String)],
}

/// What a converter does to the geometry, which the conversion harness holds it to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The same points; nothing moves.
    Exact,
    /// Within the tolerance asked for, by a bound that the report states.
    WithinTolerance,
    /// A bound or estimate that the report states, whatever the tolerance.
    Reported,
}

/// A converter in its general form: from any geometry of one kind to any of another.
pub struct Converter {
    /// Its name, in lower case with hyphens.
    pub name: &'static str,
    /// What it takes.
    pub from: Kind,
    /// What it gives.
    pub to: Kind,
    /// What it does to the geometry.
    pub effect: Effect,
    /// Whether it is used only where it is named, because what it makes is one reading of its source among others:
    /// triangles between scattered points.
    pub only_by_name: bool,
    /// Options that no tolerance gives a value, so that they must be set where the converter is used.
    pub must_set: &'static [&'static str],
    /// The name of the struct that implements it.
    pub type_name: &'static str,
    summary: fn() -> String,
    specs: fn() -> Vec<OptionSpec>,
    run: RunFn,
    settle: SettleFn,
}

type RunFn = fn(&Geometry, &Request<'_>, &Exec) -> Result<Converted<Geometry>, ConvertError>;
type SettleFn = fn(&Geometry, &Request<'_>) -> Result<Vec<(&'static str, OptionValue)>, ConvertError>;

impl Converter {
    /// The same, left out of ways on which it is not named.
    #[must_use]
    pub(crate) fn only_by_name(mut self) -> Self {
        self.only_by_name = true;
        self
    }

    /// The same, used only where these options are set.
    #[must_use]
    pub(crate) fn asks_for(mut self, options: &'static [&'static str]) -> Self {
        self.must_set = options;
        self
    }

    /// What it does, in a sentence or two.
    pub fn summary(&self) -> String {
        (self.summary)()
    }

    /// Its options.
    pub fn specs(&self) -> Vec<OptionSpec> {
        (self.specs)()
    }

    /// Converts a geometry.
    ///
    /// # Errors
    /// A geometry of another kind, wrong options, or whatever the converter says.
    pub fn run(
        &self,
        source: &Geometry,
        request: &Request<'_>,
        exec: &Exec,
    ) -> Result<Converted<Geometry>, ConvertError> {
        (self.run)(source, request, exec)
    }

    /// The value of every option for a request: what was set, else what follows from the tolerance, else the default.
    ///
    /// # Errors
    /// A geometry of another kind, or wrong options.
    pub fn settle(
        &self,
        source: &Geometry,
        request: &Request<'_>,
    ) -> Result<Vec<(&'static str, OptionValue)>, ConvertError> {
        (self.settle)(source, request)
    }
}

impl std::fmt::Debug for Converter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Converter({}: {} -> {})", self.name, self.from, self.to)
    }
}

fn build<C, S>(source: &Geometry, request: &Request<'_>) -> Result<C, ConvertError>
where
    C: FromTolerance<S> + Options,
    S: Representation,
{
    let mut converter = C::from_tolerance(S::from_geometry(source)?, request.tolerance);
    for (name, value) in request.settings {
        converter.set(name, value)?;
    }
    Ok(converter)
}

fn run<C, S>(source: &Geometry, request: &Request<'_>, exec: &Exec) -> Result<Converted<Geometry>, ConvertError>
where
    C: Convert<S, Output: Into<Geometry>> + FromTolerance<S> + Options,
    S: Representation,
{
    let converter: C = build::<C, S>(source, request)?;
    Ok(converter.convert_with(S::from_geometry(source)?, exec)?.map(Into::into))
}

fn settle<C, S>(source: &Geometry, request: &Request<'_>) -> Result<Vec<(&'static str, OptionValue)>, ConvertError>
where
    C: FromTolerance<S> + Options,
    S: Representation,
{
    let converter: C = build::<C, S>(source, request)?;
    let value = |spec: OptionSpec| Ok((spec.name, converter.get(spec.name)?));
    C::specs().into_iter().map(value).collect()
}

pub(crate) fn entry<C, S>(effect: Effect) -> Converter
where
    C: Convert<S, Output: Representation> + FromTolerance<S> + Options,
    S: Representation,
{
    let path = std::any::type_name::<C>();
    Converter {
        name: C::NAME,
        from: S::KIND,
        to: <C::Output as Representation>::KIND,
        effect,
        only_by_name: false,
        must_set: &[],
        type_name: path.rsplit("::").next().unwrap_or(path),
        summary: C::summary,
        specs: C::specs,
        run: run::<C, S>,
        settle: settle::<C, S>,
    }
}

/// Every converter, in the order of [`catalog`](crate::catalog).
pub fn registry() -> &'static [Converter] {
    static REGISTRY: std::sync::OnceLock<Vec<Converter>> = std::sync::OnceLock::new();
    REGISTRY.get_or_init(crate::catalog)
}

/// The converter of that name; the first where one name serves several kinds.
pub fn converter(name: &str) -> Option<&'static Converter> {
    registry().iter().find(|converter| converter.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_mesh::TriMesh;

    #[test]
    fn names_are_different_for_each_kind_and_found() {
        for (i, converter) in registry().iter().enumerate() {
            let same = |other: &Converter| other.name == converter.name && other.from == converter.from;
            assert!(!registry()[..i].iter().any(same), "{}", converter.name);
            assert!(super::converter(converter.name).is_some());
            assert!(!converter.summary().is_empty());
        }
        assert!(converter("alchemy").is_none());
    }

    #[test]
    fn wrong_kinds_and_options_are_refused() {
        let mesh = Geometry::from(TriMesh::default());
        let settings = [("colour".to_owned(), "red".to_owned())];
        let request = Request { tolerance: 1.0, settings: &settings };
        for converter in registry() {
            assert!(converter.run(&mesh, &request, &Exec::default()).is_err(), "{}", converter.name);
        }
    }
}
