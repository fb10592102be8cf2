//! A folder of frames: numbered PNG files, each with its figures and a key of all that made it.
//!
//! The key is a checksum of the level's files, the options and the pose. A frame that is there
//! already and has the key that it should have is not drawn again. Key and figures are a text in
//! the file itself, so frames stay what they are when they are copied, and an interrupted walk goes
//! on where it was. Frames are written beside and renamed: there are no half-written ones.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::cli::output::{self, Output};
use crate::walk::figures::Frame;

/// The key of the text in a file.
const KEYWORD: &str = "enfilade walk";

/// What a frame says of itself.
#[derive(Deserialize, Serialize)]
struct Note {
    key: String,
    figures: Frame,
}

/// A folder of frames.
pub struct Folder {
    path: PathBuf,
    size: [u32; 2],
}

/// A frame that was there already.
pub struct Kept {
    /// Its figures when it was drawn.
    pub figures: Frame,
}

impl Folder {
    /// Opens a folder, or makes it.
    pub fn open(path: &Path, size: [u32; 2]) -> Result<Self> {
        fs::create_dir_all(path).with_context(|| format!("cannot make {}", path.display()))?;
        Ok(Self {
            path: path.to_path_buf(),
            size,
        })
    }

    /// Where a frame is.
    pub fn file(&self, number: u32) -> PathBuf {
        self.path.join(format!("frame-{number:05}.png"))
    }

    /// Another file in the folder.
    pub fn beside(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The frame of this number, if it is there, whole, and has this key.
    pub fn kept(&self, number: u32, key: &str) -> Option<Kept> {
        let file = self.file(number);
        let note = note(&file)?;
        (note.key == key && self.pixels(number).is_ok()).then_some(Kept {
            figures: note.figures,
        })
    }

    /// The frame's pixels, three bytes each.
    pub fn pixels(&self, number: u32) -> Result<Vec<u8>> {
        let file = self.file(number);
        let read = || -> Result<Vec<u8>> {
            let mut reader = png::Decoder::new(BufReader::new(File::open(&file)?)).read_info()?;
            let [width, height] = self.size.map(|n| n as usize);
            anyhow::ensure!(
                (reader.info().width, reader.info().height) == self.size.into(),
                "it has another size"
            );
            let mut pixels = vec![0; reader.output_buffer_size().context("it is too large")?];
            reader.next_frame(&mut pixels)?;
            anyhow::ensure!(pixels.len() == 3 * width * height, "it has other colours");
            Ok(pixels)
        };
        read().with_context(|| format!("cannot read {}", file.display()))
    }

    /// Writes a frame.
    pub fn write(&self, key: &str, figures: &Frame, pixels: &[u8]) -> Result<()> {
        let note = Note {
            key: key.to_string(),
            figures: figures.clone(),
        };
        let mut bytes = Vec::new();
        let [width, height] = self.size;
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.add_text_chunk(KEYWORD.to_string(), serde_json::to_string(&note)?)?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(pixels)?;
        writer.finish()?;
        let mut file = Output::create(&self.file(figures.frame))?;
        file.write(|out| out.write_all(&bytes))?;
        output::commit([file])
    }

    /// Takes away the frames of an earlier, longer walk, from this number on. How many there were.
    pub fn shorten(&self, n: u32) -> Result<usize> {
        let mut taken = 0;
        let entries = fs::read_dir(&self.path);
        for entry in entries.with_context(|| format!("cannot read {}", self.path.display()))? {
            let file = entry?.path();
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let number = name
                .strip_prefix("frame-")
                .and_then(|n| n.strip_suffix(".png"));
            let number = number.and_then(|n| n.parse::<u32>().ok());
            // Whatever else is called so is not ours.
            if number.is_some_and(|k| k >= n) && note(&file).is_some() {
                fs::remove_file(&file)?;
                taken += 1;
            }
        }
        Ok(taken)
    }

    /// Takes the frames away, and the folder if nothing else is in it.
    pub fn remove(self) -> Result<()> {
        self.shorten(0)?;
        // Somebody else's files may stay.
        _ = fs::remove_dir(&self.path);
        Ok(())
    }
}

/// What a file says of itself, if it is a frame.
fn note(file: &Path) -> Option<Note> {
    let reader = png::Decoder::new(BufReader::new(File::open(file).ok()?)).read_info();
    let reader = reader.ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    let text = texts.iter().find(|t| t.keyword == KEYWORD)?;
    serde_json::from_str(&text.text).ok()
}
