//! `enfilade verify`: a finished PVS against its level.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use super::level_args::LevelArgs;
use super::{Answer, complain, output, progress};
use crate::pvs::verify::{VerifyOptions, verify};
use crate::pvs::{Progress, file};

/// Check a .pvs file against its level, with none of the code that made it.
///
/// Prints what was checked. The exit status is 1, and the message names the place, if anything is
/// wrong. A file is held to what its class promises: pairs missing from an aggressive or approximate
/// one are counted, not wrong.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// The .pvs file
    file: PathBuf,
    #[command(flatten)]
    level: LevelArgs,
    /// Random segments to cast through the original walls
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().segments)]
    segments: u64,
    /// Random points to look up in the cells
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().points)]
    points: u64,
    /// Seed of all that is random
    #[arg(long, value_name = "N", default_value_t = VerifyOptions::default().seed)]
    seed: u64,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Runs `enfilade verify`.
pub fn run(args: &VerifyArgs) -> Result<Answer> {
    let name = args.file.display();
    let bytes = fs::read(&args.file).with_context(|| format!("cannot read {name}"))?;
    let file = file::decode(&bytes).with_context(|| name.to_string())?;
    let source = args.level.open()?;
    // A WAD with several maps: the file knows which one it is of.
    let named = source.maps().into_iter().find(|map| *map == file.info.name);
    let map = args.level.map.clone().or(named);
    let level = source.level(map.as_deref())?;
    let options = VerifyOptions {
        segments: args.segments,
        points: args.points,
        seed: args.seed,
    };
    let counter = Progress::default();
    let result = progress::show("checking", args.quiet, &counter, || {
        verify(&file, &level, &options, &counter)
    });
    match result {
        Ok(done) => {
            if !args.quiet {
                output::print(&done.to_string())?;
            }
            Ok(Answer::Yes)
        }
        Err(failure) => {
            complain(&format!("{name}: {}", failure.describe(&file, &level)));
            Ok(Answer::No)
        }
    }
}
