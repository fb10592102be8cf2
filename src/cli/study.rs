//! `enfilade study`: what the methods gain, lose and cost. One file per study.

mod desk;
mod drawing;
mod papers;
mod stability;
mod visibility;

use anyhow::Result;
use clap::{Args, Subcommand};

use super::{Answer, Memory};

/// Compare the methods, of visibility or of drawing: where they err, and what accuracy costs.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Visibility(visibility::VisibilityArgs),
    Effects(drawing::EffectsArgs),
    Antialiasing(drawing::AntialiasingArgs),
    Structures(drawing::StructuresArgs),
    Stability(stability::StabilityArgs),
}

/// Runs `enfilade study`.
pub fn run(args: &StudyArgs, memory: Option<Memory>) -> Result<Answer> {
    match &args.study {
        Study::Visibility(args) => visibility::run(args, memory),
        Study::Effects(args) => drawing::effects(args, memory),
        Study::Antialiasing(args) => drawing::antialiasing(args, memory),
        Study::Structures(args) => drawing::structures(args, memory),
        Study::Stability(args) => stability::run(args),
    }
}
