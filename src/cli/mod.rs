//! The command line: arguments, files, clock and terminal. One file per subcommand.
//!
//! Exit status: 0 done; 1 the answer is no; 2 bad input, bad usage, or a file that cannot be read or
//! written. Results go to files or standard output, progress and warnings to standard error.

mod build;
mod check;
mod compute;
mod explain;
mod export;
mod level_args;
mod output;
mod picture;
mod plan;
mod progress;
mod render;
mod stage;
mod study;
mod summary;
mod verify;
pub mod view;
mod walk;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Exact cells-and-portals visibility of architectural levels.
#[derive(Debug, Parser)]
#[command(name = "enfilade", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Build(build::BuildArgs),
    Check(check::CheckArgs),
    Explain(explain::ExplainArgs),
    Export(export::ExportArgs),
    Verify(verify::VerifyArgs),
    Plan(plan::PlanArgs),
    Render(render::RenderArgs),
    Study(study::StudyArgs),
    View(view::ViewArgs),
    Walk(walk::WalkArgs),
}

/// What a command that ran to its end has to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// Done, or yes.
    Yes,
    /// No: verification failed, budget exceeded.
    No,
}

/// How a program that counts its heap tells what is on it, in bytes.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    /// What is on it now.
    pub now: fn() -> usize,
    /// The most that was on it since the last [`Memory::forget_peak`].
    pub peak: fn() -> usize,
    /// Begins anew with what is on it now.
    pub forget_peak: fn(),
}

/// Runs the program on the process's arguments. Without `memory`, studies leave out what the methods
/// need of it.
pub fn main(memory: Option<Memory>) -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        Command::Build(args) => build::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Study(args) => study::run(&args, memory),
        Command::View(args) => view::run(&args),
        Command::Walk(args) => walk::run(&args),
    };
    match result {
        Ok(Answer::Yes) => ExitCode::SUCCESS,
        Ok(Answer::No) => ExitCode::from(1),
        Err(error) => {
            complain(&format!("error: {error:#}"));
            ExitCode::from(2)
        }
    }
}

/// A line on standard error. Where even that is closed there is nobody left to tell.
fn complain(line: &str) {
    _ = writeln!(io::stderr(), "{line}");
}
