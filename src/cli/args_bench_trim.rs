//! `trimray bench trim` as clap sees it.

use super::args::{parse_counts, parse_resolution};
use crate::scene::{MAX_DEGREE, TrimMethod};
use clap::Args;
use std::path::PathBuf;

/// The trimming study: all thirty trim methods on the same queries, relative to horizontal slabs (3-HS).
///
/// Rows and columns are those of Tables 2 and 3 of Sloup and Havran 2021. Queries are those of a tracer that asks at every hit on a trimmed
/// face: of primary rays of the default camera, and of random chords of the scene's bounding sphere. Each method answers them all in the
/// same order; the fastest run counts. Memory of trims is relative to 1-LC. Methods that answer otherwise than the first are told below
/// the table. Several files get a table of the means of their percentages.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench trim part.step
  trimray bench trim *.step --methods 3,12,29,packed --csv trim.csv
  trimray bench trim engine.step --replicate 4,4,4 --repeat 5
  trimray bench trim part.step --degrees 1-15 --plot degrees.svg
  trimray bench trim *.step --check 10000000")]
pub(super) struct BenchTrim {
    /// STEP or IGES files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// Measure so many copies of each model along x, y and z, side by side, each with faces of its own.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_counts)]
    pub(super) replicate: Option<[u32; 3]>,
    /// Methods by number or name, and ranges of numbers, such as 1-4,12,kcs+rbem,packed; or all.
    #[arg(long, value_name = "LIST", default_value = "all", value_parser = parse_methods)]
    pub(super) methods: Methods,
    /// How many random rays.
    #[arg(long, value_name = "N", default_value_t = 500_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub(super) rays: u64,
    /// Pixels across and down; a primary ray each.
    #[arg(long, value_name = "W,H", default_value = "960,540", value_parser = parse_resolution)]
    pub(super) resolution: [u32; 2],
    /// How many rays of each kind are traced to the end when whole rays are timed; queries come from all.
    #[arg(long, value_name = "N", default_value_t = 50_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    pub(super) timed_rays: u64,
    /// Keep so many queries of primary and of random rays at most.
    #[arg(long, value_name = "N", default_value_t = 2_000_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub(super) queries: u64,
    /// How many runs count, after a third as many that warm up.
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(super) repeat: u16,
    /// Ask the same queries of the GPU too, whose kernel alone is timed: it holds the queries.
    #[arg(long)]
    pub(super) gpu: bool,
    /// Write all numbers here, as comma-separated values.
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// One JSON object a line: one for each file.
    #[arg(long)]
    pub(super) json: bool,
    /// Measure trims by the degree of the curves instead: all curves are raised to these degrees, such as 1-15 or 1,3,7.
    #[arg(long, value_name = "LIST", value_parser = parse_degrees)]
    pub(super) degrees: Option<Degrees>,
    /// Write a plot of the time by degree here, as SVG.
    #[arg(long, value_name = "FILE", requires = "degrees")]
    pub(super) plot: Option<PathBuf>,
    /// Ask every method of so many points of each file instead, and compare with a judge that uses the f64 curves.
    #[arg(long, value_name = "N", conflicts_with = "degrees", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub(super) check: Option<u64>,
}

/// Methods in the order asked for, each once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Methods {
    pub(super) list: Vec<TrimMethod>,
    /// Whether all were asked for.
    pub(super) is_all: bool,
}

/// Degrees in rising order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Degrees(pub(super) Vec<usize>);

fn parse_methods(text: &str) -> Result<Methods, String> {
    if text == "all" {
        return Ok(Methods { list: TrimMethod::all().collect(), is_all: true });
    }
    let mut list: Vec<TrimMethod> = Vec::new();
    for item in text.split(',').map(str::trim) {
        let found = match range(item) {
            Some([first, last]) => {
                TrimMethod::all().filter(|m| (first..=last).contains(&m.number())).collect()
            }
            None => vec![item.parse::<TrimMethod>().map_err(|error| error.to_string())?],
        };
        if found.is_empty() {
            return Err(format!("`{item}` holds no method"));
        }
        list.extend(found);
    }
    let mut seen = std::collections::HashSet::new();
    list.retain(|method| seen.insert(*method));
    Ok(Methods { list, is_all: false })
}

fn parse_degrees(text: &str) -> Result<Degrees, String> {
    let mut degrees = Vec::new();
    for item in text.split(',').map(str::trim) {
        let ends = range(item).or_else(|| item.parse().ok().map(|degree| [degree; 2]));
        match ends {
            Some([first, last]) if 1 <= first && first <= last && last <= MAX_DEGREE => {
                degrees.extend(first as usize..=last as usize);
            }
            _ => return Err(format!("`{item}` is no degree, or range of degrees, from 1 to {MAX_DEGREE}")),
        }
    }
    degrees.sort_unstable();
    degrees.dedup();
    Ok(Degrees(degrees))
}

/// Two numbers with a dash between them.
fn range(text: &str) -> Option<[u32; 2]> {
    let (first, last) = text.split_once('-')?;
    Some([first.trim().parse().ok()?, last.trim().parse().ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_methods() {
        let numbers = |text: &str| {
            parse_methods(text).map(|found| found.list.iter().map(|m| m.number()).collect::<Vec<_>>())
        };
        assert_eq!(numbers("all").expect("all").len(), 31);
        assert_eq!(numbers("3-5, packed,hs+b,4"), Ok(vec![3, 4, 5, 30]));
        for wrong in ["", "0", "32", "5-3", "x", "1,,2"] {
            assert!(parse_methods(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lists_of_degrees() {
        assert_eq!(parse_degrees("7,1-3,2"), Ok(Degrees(vec![1, 2, 3, 7])));
        for wrong in ["", "0", "0-3", "3-1", "1-99", "x", "1,"] {
            assert!(parse_degrees(wrong).is_err(), "{wrong}");
        }
    }
}
