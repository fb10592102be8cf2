//! Pictures as files: an SVG as it is, or drawn as a PNG.

use std::path::Path;

use anyhow::{Result, bail};

use super::output::{self, Output};
use super::progress;
use crate::pvs::Progress;
use crate::report::picture;

/// Whether a picture is to be a PNG, by the file's ending; else it is an SVG.
pub fn is_png(path: &Path) -> Result<bool> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    match ending.to_lowercase().as_str() {
        "png" => Ok(true),
        "svg" => Ok(false),
        _ if output::is_stdout(path) => Ok(false),
        _ => bail!(
            "{}: a picture is an .svg or a .png file; choose one by the ending",
            path.display()
        ),
    }
}

/// Writes a picture: as it is, or as a PNG so many pixels wide.
pub fn write(output: &mut Output, svg: &str, png: Option<u32>, quiet: bool) -> Result<()> {
    let Some(width) = png else {
        return output.write(|out| writeln!(out, "{svg}"));
    };
    let drawn = progress::show("drawing", quiet, &Progress::default(), || {
        picture::png(svg, width)
    })?;
    output.write(|out| out.write_all(&drawn))
}
