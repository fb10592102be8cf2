//! `enfilade study`: what the methods gain, lose and cost. One file per study.

mod stability;

use anyhow::Result;
use clap::{Args, Subcommand};

use super::Answer;

/// Compare the methods: where they err, and what accuracy costs.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Stability(stability::StabilityArgs),
}

/// Runs `enfilade study`.
pub fn run(args: &StudyArgs) -> Result<Answer> {
    match &args.study {
        Study::Stability(args) => stability::run(args),
    }
}
