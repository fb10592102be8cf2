//! `enfilade study`: what the methods gain, lose and cost. One file per study.

mod stability;
mod visibility;

use anyhow::Result;
use clap::{Args, Subcommand};

use super::{Answer, Memory};

/// Compare the methods: where they err, and what accuracy costs.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Visibility(visibility::VisibilityArgs),
    Stability(stability::StabilityArgs),
}

/// Runs `enfilade study`.
pub fn run(args: &StudyArgs, memory: Option<Memory>) -> Result<Answer> {
    match &args.study {
        Study::Visibility(args) => visibility::run(args, memory),
        Study::Stability(args) => stability::run(args),
    }
}
