//! From a folder of frames to one file: an animated GIF, or a film by ffmpeg.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use color_quant::NeuQuant;
use rustc_hash::FxHashMap;

use super::frames::Folder;
use crate::cli::output::{self, Output};
use crate::pvs::Progress;

/// Pixels that the palette is chosen from, at most.
const SAMPLES: usize = 200_000;
/// Colours; one more stands for what has not changed.
const COLOURS: usize = 255;
const UNCHANGED: u8 = 255;

/// Writes an animated GIF that goes round for ever. All frames share a palette, so that colours do
/// not flicker; pixels that do not change are left out.
pub fn gif(
    folder: &Folder,
    frames: u32,
    [width, height]: [u32; 2],
    fps: f64,
    target: &Path,
    progress: &Progress,
) -> Result<()> {
    let fits = |n: u32| u16::try_from(n).context("a GIF has at most 65535 pixels across and down");
    let (width, height) = (fits(width)?, fits(height)?);
    progress.begin(2 * frames as usize);
    let pixels = usize::from(width) * usize::from(height);
    // A prime, so that no column is favoured.
    let stride = (pixels * frames as usize / SAMPLES).max(1);
    let stride = (stride..).find(|&n| is_prime(n)).unwrap_or(stride);
    let mut samples = Vec::new();
    let mut at = 0;
    for number in 0..frames {
        let frame = folder.pixels(number)?;
        while at < pixels {
            samples.extend_from_slice(&frame[3 * at..][..3]);
            samples.push(255);
            at += stride;
        }
        at -= pixels;
        progress.advance(1);
    }
    let quant = NeuQuant::new(3, COLOURS, &samples);
    let mut palette = quant.color_map_rgb();
    palette.resize(3 * (COLOURS + 1), 0);
    let mut nearest: FxHashMap<[u8; 3], u8> = FxHashMap::default();
    let mut bytes = Vec::new();
    let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette)?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let mut before: Vec<u8> = Vec::new();
    for number in 0..frames {
        let frame = folder.pixels(number)?;
        let colours = frame.as_chunks::<3>().0;
        let indices: Vec<u8> = (colours.iter())
            .map(|&[r, g, b]| {
                let index = || quant.index_of(&[r, g, b, 255]) as u8;
                *nearest.entry([r, g, b]).or_insert_with(index)
            })
            .collect();
        let changed = if before.is_empty() {
            indices.clone()
        } else {
            let pairs = indices.iter().zip(&before);
            pairs
                .map(|(new, old)| if new == old { UNCHANGED } else { *new })
                .collect()
        };
        // In hundredths of a second; rounded so that errors do not add up.
        let time = |n: u32| (f64::from(n) * 100.0 / fps).round() as u32;
        let delay = time(number + 1) - time(number);
        encoder.write_frame(&gif::Frame {
            width,
            height,
            delay: u16::try_from(delay).unwrap_or(u16::MAX),
            transparent: (!before.is_empty()).then_some(UNCHANGED),
            dispose: gif::DisposalMethod::Keep,
            buffer: changed.into(),
            ..gif::Frame::default()
        })?;
        before = indices;
        progress.advance(1);
    }
    drop(encoder);
    let mut file = Output::create(target)?;
    file.write(|out| out.write_all(&bytes))?;
    output::commit([file])
}

fn is_prime(n: usize) -> bool {
    n >= 2
        && (2..)
            .take_while(|k| k * k <= n)
            .all(|k| !n.is_multiple_of(k))
}

/// Finds out whether there is an ffmpeg.
pub fn must_have_ffmpeg() -> Result<()> {
    let run = Command::new("ffmpeg")
        .arg("-version")
        .stdin(Stdio::null())
        .output();
    match run {
        Ok(run) if run.status.success() => Ok(()),
        _ => bail!(
            "an .mp4 needs ffmpeg on the path; install it (apt-get install ffmpeg), or give -o a folder \
             or a .gif"
        ),
    }
}

/// Has ffmpeg make a film of the frames.
pub fn mp4(
    folder: &Folder,
    frames: u32,
    [width, height]: [u32; 2],
    fps: f64,
    target: &Path,
    progress: &Progress,
) -> Result<()> {
    progress.begin(frames as usize);
    let unfinished = folder.beside("unfinished.mp4");
    let mut ffmpeg = Command::new("ffmpeg")
        .args([
            "-y",
            "-loglevel",
            "error",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
        ])
        .args([
            "-s",
            &format!("{width}x{height}"),
            "-r",
            &fps.to_string(),
            "-i",
            "-",
        ])
        // Players want 4:2:0, and that even sizes.
        .args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-pix_fmt",
            "yuv420p",
        ])
        .args(["-movflags", "+faststart", "-f", "mp4"])
        .arg(&unfinished)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .context("cannot start ffmpeg")?;
    let mut input = ffmpeg.stdin.take().context("ffmpeg takes no frames")?;
    let mut fed = Ok(());
    for number in 0..frames {
        let pixels = folder.pixels(number)?;
        fed = input.write_all(&pixels);
        if fed.is_err() {
            break;
        }
        progress.advance(1);
    }
    drop(input);
    let done = ffmpeg.wait_with_output().context("ffmpeg does not end")?;
    if !done.status.success() || fed.is_err() {
        let said = String::from_utf8_lossy(&done.stderr);
        bail!("ffmpeg failed: {}", said.trim());
    }
    let mut film = File::open(&unfinished).context("ffmpeg has left no film")?;
    let mut file = Output::create(target)?;
    file.write(|out| io::copy(&mut film, out).map(drop))?;
    output::commit([file])?;
    _ = fs::remove_file(&unfinished);
    Ok(())
}
