//! The arguments of `walk`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::level_args::LevelArgs;
use crate::cli::render::trace_args::{TraceArgs, not_negative, positive};
use crate::cli::render::{Renderer, viewpoint};
use crate::cli::stage::StageArgs;
use crate::level::Level;
use crate::walk::Person;

/// Draw a walk through a level: numbered frames, an animated GIF, or a film.
///
/// Frames that are there already and need no change are kept, so a walk that was interrupted goes on
/// where it was.
#[derive(Debug, Args)]
pub struct WalkArgs {
    #[command(flatten)]
    pub level: LevelArgs,
    /// Folder for frames frame-00000.png …, or a .gif, or (with ffmpeg on the path) an .mp4
    #[arg(short, long, value_name = "DIR|FILE")]
    pub output: PathBuf,
    /// Along this path of the level [default: its only one]
    #[arg(long, value_name = "NAME")]
    pub path: Option<String>,
    /// File of [[path]] tables, as the viewer saves them, besides those of the level
    #[arg(long, value_name = "FILE", conflicts_with = "tour")]
    pub walks: Option<PathBuf>,
    /// Through every room or sector that can be reached on foot
    #[arg(long, conflicts_with = "path")]
    pub tour: bool,
    /// Ray tracing, or the polygons painted from back to front
    #[arg(long, value_enum, value_name = "HOW", default_value = "trace")]
    pub renderer: Renderer,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "640x400", value_parser = viewpoint::size)]
    pub size: [u32; 2],
    /// Frames per second
    #[arg(long, value_name = "N", default_value_t = 25.0, value_parser = positive)]
    pub fps: f64,
    /// Horizontal angle of view in degrees, below 180 [default: the path's, or 75]
    #[arg(long, value_name = "DEGREES", value_parser = viewpoint::angle)]
    pub fov: Option<f64>,
    /// Begin so many seconds after the start of the walk
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    #[arg(value_parser = not_negative)]
    pub from: f64,
    /// End so many seconds after the start of the walk
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub to: Option<f64>,
    /// Write a row of figures for each frame: .csv or .json (`-`: JSON on standard output)
    #[arg(long, value_name = "FILE")]
    pub figures: Option<PathBuf>,
    /// Write a page with charts of what culling saves along the walk
    #[arg(long, value_name = "FILE.html")]
    pub chart: Option<PathBuf>,
    /// With a .gif or .mp4: leave the frames in FILE.frames afterwards
    #[arg(long)]
    pub keep_frames: bool,
    /// Find out anew in every frame what neighbouring frames share, to see what that saves
    #[arg(long)]
    pub no_reuse: bool,
    #[command(flatten)]
    pub person: PersonArgs,
    #[command(flatten)]
    pub trace: TraceArgs,
    #[command(flatten)]
    pub stage: StageArgs,
}

/// Who goes on a tour; lengths in the level's unit.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Who goes on a tour [default: an adult, in metres; Doom's player]")]
pub struct PersonArgs {
    /// Half of the width that he needs
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub radius: Option<f64>,
    /// Height that he needs
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub stature: Option<f64>,
    /// Height of his eyes over the floor
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub eye_height: Option<f64>,
    /// Highest step that he takes
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub step: Option<f64>,
    /// Deepest drop that he takes
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub drop: Option<f64>,
    /// Length that he walks in a second
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub speed: Option<f64>,
}

impl PersonArgs {
    /// The usual person for the level's unit, but for what was said.
    pub fn person(&self, level: &Level) -> Person {
        let usual = Person::of_unit(&level.unit);
        Person {
            radius: self.radius.unwrap_or(usual.radius),
            height: self.stature.unwrap_or(usual.height),
            eye: self.eye_height.unwrap_or(usual.eye),
            step: self.step.unwrap_or(usual.step),
            drop: self.drop.unwrap_or(usual.drop),
            speed: self.speed.unwrap_or(usual.speed),
        }
    }
}
