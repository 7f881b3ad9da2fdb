//! What the command line understands.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use shapeloom_core::{ChoiceOption, Tolerance, ToleranceError};
use shapeloom_judge::Profile;
use shapeloom_render::Mode;

use crate::commands::coloring::{ColorBy, range};

/// Represents shapes in many forms, converts any of them into any other, and says what each conversion cost.
#[derive(Debug, Parser)]
#[command(name = "shapeloom", version, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) globals: Globals,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Options of every command.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct Globals {
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say more: the options of each step, every loss and finding
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,
    /// Print one JSON object on standard output
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// How many threads to use; by default one for each processor
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// The seed of everything random; only the noise of pictures is
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u32,
    /// The most memory for data, in bytes or with K, M or G (1024, 1024², 1024³)
    #[arg(long, global = true, value_name = "BYTES", value_parser = bytes, default_value = "4G")]
    pub(crate) max_memory: u64,
    /// The longest time to work, in seconds
    #[arg(long, global = true, value_name = "S", value_parser = seconds)]
    pub(crate) max_time: Option<f64>,
    /// Fail where the result is not proven to be within the tolerance
    #[arg(long, global = true)]
    pub(crate) strict: bool,
    /// Say how long each step took
    #[arg(long, global = true)]
    pub(crate) timings: bool,
    /// Say which way was chosen, and why
    #[arg(long, global = true)]
    pub(crate) explain: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Convert a file to another format or representation
    Convert(ConvertArguments),
    /// Say what a file holds
    Info(InfoArguments),
    /// Say whether a file is sound for a purpose; exit code 1 if it is not
    Check(CheckArguments),
    /// Measure how far shapes are apart
    Compare(CompareArguments),
    /// Draw a picture of a file
    Render(RenderArguments),
    /// Make a ready shape
    Make(MakeArguments),
    /// Make one solid of two volumes: both, what they share, the first without the second, or one between them
    Boolean(BooleanArguments),
    /// Compare the data structures that can hold a mesh: their size, what they can answer, and how fast
    Structures(StructuresArguments),
    /// List the file formats
    Formats,
    /// List the converters and the kinds that they join
    Graph(GraphArguments),
    /// Say what an error or warning code means
    Explain(ExplainArguments),
}

/// How to convert, for every command that does.
#[derive(Clone, Debug, Args)]
pub(crate) struct WayArguments {
    /// How far the result may be from the input: a length (0.01), or per cent of the bounding box's diagonal (0.1%)
    #[arg(long, value_name = "T", default_value = "0.1%", allow_hyphen_values = true)]
    pub(crate) tolerance: String,
    /// The converter to use; `shapeloom graph` lists them
    #[arg(long, value_name = "NAME")]
    pub(crate) method: Option<String>,
    /// A kind that the way must pass through; `shapeloom graph` lists them
    #[arg(long, value_name = "KIND")]
    pub(crate) via: Option<String>,
    /// An option of a converter on the way, of the input or of the output, as often as needed: key=value, or
    /// converter.key=value, read.key=value, write.key=value
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub(crate) settings: Vec<(String, String)>,
}

/// How an input is read, for every command that reads one.
#[derive(Debug, Args)]
pub(crate) struct SourceArguments {
    /// The format of the input, if its content does not tell
    #[arg(long, value_name = "FORMAT")]
    pub(crate) from: Option<String>,
    /// Leave out vertices at positions that are infinite or not a number, with all that uses them
    #[arg(long)]
    pub(crate) drop_non_finite: bool,
}

/// Where a result goes, for every command that writes a shape.
#[derive(Debug, Args)]
pub(crate) struct TargetArguments {
    /// The file to write, or - for standard output; missing folders are made
    pub(crate) output: PathBuf,
    /// The format of the output, if its extension does not tell
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Option<String>,
    /// Also draw the result
    #[arg(long, value_name = "OUT.png")]
    pub(crate) picture: Option<PathBuf>,
    /// Also write the account of what was done
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    pub(crate) force: bool,
}

impl WayArguments {
    /// The tolerance as it was written. Read here and not by the parser, so that a wrong one has a code of its own.
    pub(crate) fn tolerance(&self) -> Result<Tolerance, ToleranceError> {
        self.tolerance.parse()
    }
}

#[derive(Debug, Args)]
pub(crate) struct ConvertArguments {
    /// The file to read, or - for standard input
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) target: TargetArguments,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The file to read, or - for standard input
    pub(crate) input: PathBuf,
    /// An option of the input, as often as needed: key=value
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub(crate) settings: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// The file to read, or - for standard input
    pub(crate) input: PathBuf,
    /// What the shape is for
    #[arg(long, value_name = "PROFILE", default_value = "general",
          value_parser = PossibleValuesParser::new(<Profile as ChoiceOption>::NAMES))]
    pub(crate) profile: String,
    /// Merge vertices at exactly the same position first, as files without shared vertices need it
    #[arg(long)]
    pub(crate) weld: bool,
    /// Judge all parts as one mesh, so that parts that cross each other are found; faces and vertices are numbered on
    #[arg(long)]
    pub(crate) together: bool,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct BooleanArguments {
    /// The first volume, or - for standard input
    pub(crate) first: PathBuf,
    /// The second volume, or - for standard input
    pub(crate) second: PathBuf,
    #[command(flatten)]
    pub(crate) target: TargetArguments,
    /// What becomes of the two
    #[arg(long, value_name = "OP", required_unless_present = "morph",
          value_parser = PossibleValuesParser::new(["union", "intersection", "difference"]))]
    pub(crate) op: Option<String>,
    /// Fillet where the two of a union meet: the difference of their distances up to which they blend, above 0
    #[arg(long, value_name = "RADIUS", conflicts_with_all = ["morph", "cells"], allow_hyphen_values = true)]
    pub(crate) smooth: Option<f32>,
    /// A solid between the two instead: 0 for the first, 1 for the second
    #[arg(long, value_name = "PART", conflicts_with_all = ["op", "cells"], allow_hyphen_values = true)]
    pub(crate) morph: Option<f32>,
    /// Combine full cells, by octrees, in place of distances: the result has a bit a cell
    #[arg(long)]
    pub(crate) cells: bool,
    /// Where the second has another lattice, sample what it has between its samples on that of the first
    #[arg(long)]
    pub(crate) resample: bool,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct StructuresArguments {
    /// The file to read, or - for standard input
    pub(crate) input: PathBuf,
    /// What the structures are ranked for: how often each of VV, VE, VF, EV, EE, EF, FV, FE, FF is asked, queries=N for all nine
    /// alike, updates=N for changes of the mesh, size=W to count a structure of twice the size, coordinates
    /// included, as 2^W times as slow
    #[arg(long, value_name = "KEY=N,...", default_value = "queries=1e6")]
    pub(crate) mix: String,
    /// Cut polygons into triangles first, so that structures of triangles can hold them
    #[arg(long)]
    pub(crate) triangles: bool,
    /// Merge vertices at exactly the same position first, as files without shared vertices need it
    #[arg(long)]
    pub(crate) weld: bool,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// The file to read, or - for standard input
    pub(crate) input: PathBuf,
    /// The picture to write, or - for standard output; missing folders are made
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// The size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1280x960")]
    pub(crate) size: (u32, u32),
    /// Where to look from, in degrees: around the up axis, and above the horizon
    #[arg(long, value_name = "AZ,EL", value_parser = view, allow_hyphen_values = true)]
    pub(crate) view: Option<(f64, f64)>,
    /// How surfaces appear
    #[arg(long, value_name = "MODE", value_parser = PossibleValuesParser::new(<Mode as ChoiceOption>::NAMES))]
    pub(crate) mode: Option<String>,
    /// Draw the sides of triangles over the surface
    #[arg(long)]
    pub(crate) wires: bool,
    /// What the colours say
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = ColorBy::Material)]
    pub(crate) color: ColorBy,
    /// The shape that --color distance measures to
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,
    /// The numbers at the ends of the colours; by default from 0 to the largest
    #[arg(long, value_name = "FROM,TO", value_parser = range, allow_hyphen_values = true)]
    pub(crate) color_range: Option<(f64, f64)>,
    /// An option of the picture, as often as needed: key=value
    #[arg(long = "picture-set", value_name = "KEY=VALUE", value_parser = setting)]
    pub(crate) picture_settings: Vec<(String, String)>,
    /// Draw that many views all around, into OUT-000.png, OUT-001.png, ...
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "24",
          value_parser = clap::value_parser!(u32).range(1..=999))]
    pub(crate) turntable: Option<u32>,
    /// Replace files that exist
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArguments {
    /// The files to compare, the first with each other one; - for standard input, once
    #[arg(required = true, value_name = "FILE")]
    pub(crate) shapes: Vec<PathBuf>,
    /// The shape that all files are compared with instead
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
    /// Fail with exit code 1 where the Hausdorff distance is not proven to be within this: a length (0.01), or per cent
    /// of the diagonal of the first shape's bounding box (0.1%)
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    pub(crate) fail_above: Option<String>,
    /// How far the bounds of the Hausdorff distance may be apart: per cent of the upper one (1%), or a fraction (0.01)
    #[arg(long, value_name = "GAP", default_value = "1%", value_parser = gap, allow_hyphen_values = true)]
    pub(crate) accuracy: f64,
    /// How many cells the mean distances are taken over, at least one for each triangle
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    pub(crate) samples: u32,
    /// How many pieces may be cut to narrow the bounds, each way
    #[arg(long, value_name = "N", default_value_t = 20_000_000)]
    pub(crate) max_splits: u32,
    /// Also write a page with tables and pictures into that folder: index.html, PNG pictures, distances.csv
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Replace files of the report that exist
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) way: WayArguments,
    #[command(flatten)]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct MakeArguments {
    /// Which shape: tetrahedron, cube, octahedron, dodecahedron, icosahedron, sphere, torus, cylinder, cone, grid,
    /// ellipsoid or quadric
    pub(crate) shape: String,
    #[command(flatten)]
    pub(crate) target: TargetArguments,
    /// An option of the shape or of the output, as often as needed: key=value
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub(crate) settings: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub(crate) struct GraphArguments {
    /// Print the graph in the language of Graphviz
    #[arg(long, conflicts_with = "json")]
    pub(crate) dot: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ExplainArguments {
    /// The code, such as E-bpt-number; all of them if none is given
    pub(crate) code: Option<String>,
}

fn bytes(text: &str) -> Result<u64, String> {
    let expected = || format!("found \"{text}\", expected a whole number of bytes such as 500M or 4G");
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let shift = match text[digits.len()..].to_ascii_lowercase().trim_end_matches('b').trim_end_matches('i') {
        "" => 0,
        "k" => 10,
        "m" => 20,
        "g" => 30,
        "t" => 40,
        _ => return Err(expected()),
    };
    let number: u64 = digits.parse().map_err(|_| expected())?;
    number.checked_mul(1 << shift).ok_or_else(expected)
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err(format!("found \"{text}\", expected a number of seconds above 0")),
    }
}

fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err(format!("found \"{text}\", expected key=value")),
    }
}

fn gap(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(number) => (number.trim_end(), 0.01),
        None => (text.trim(), 1.0),
    };
    let gap = number.parse::<f64>().ok().map(|number| number * unit);
    gap.filter(|gap| *gap > 0.0 && *gap <= 1.0)
        .ok_or_else(|| format!("found \"{text}\", expected a number such as 1% or 0.01, above 0 and up to 100%"))
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let pixels = |part: &str| part.parse::<u32>().ok().filter(|n| (1..=16384).contains(n));
    text.split_once('x')
        .and_then(|(width, height)| Some((pixels(width)?, pixels(height)?)))
        .ok_or_else(|| format!("found \"{text}\", expected WIDTHxHEIGHT such as 1280x960, each from 1 to 16384"))
}

fn view(text: &str) -> Result<(f64, f64), String> {
    let angle = |part: &str| part.trim().parse::<f64>().ok().filter(|angle| angle.is_finite());
    text.split_once(',')
        .and_then(|(azimuth, elevation)| Some((angle(azimuth)?, angle(elevation)?)))
        .ok_or_else(|| format!("found \"{text}\", expected two angles in degrees such as 30,20"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_of_memory_are_read() {
        assert_eq!(bytes("4G"), Ok(4 << 30));
        assert_eq!(bytes("64MiB"), Ok(64 << 20));
        assert_eq!(bytes("1000"), Ok(1000));
        for wrong in ["", "G", "-1", "4X", "99999999999T", "1.5G"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }
}
