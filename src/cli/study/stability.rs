//! `enfilade study stability`: hard levels whose answer is known, and what each method says.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

use crate::cli::Answer;

/// Compare what the methods answer on levels whose comments state the answer, worked out by hand.
///
/// Prints one Markdown table: where exact, floating-point linear programme and portal flow go wrong.
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Folder of .toml levels that state their answer (levels/hard)
    folder: PathBuf,
    /// Write the table, as Markdown (`-`: standard output, where it goes anyway)
    #[arg(short, long, value_name = "FILE.md")]
    output: Option<PathBuf>,
    /// Write all comparisons as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Runs `enfilade study stability`.
pub fn run(_args: &StabilityArgs) -> Result<Answer> {
    bail!("`study stability` is not written yet")
}
