//! What a level names: meshes and pictures, from the level's folder, and textures, from its WAD.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cli::complain;
use crate::level::Level;
use crate::level::doom::graphics;
use crate::level::read::Source;
use crate::level::scene::Shape;
use crate::trace::image::Image;
use crate::trace::shapes::mesh::obj;
use crate::trace::world::Files;

/// Reads them.
pub fn read(level_file: &Path, source: &Source, level: &Level) -> Result<Files> {
    let folder = level_file.parent().unwrap_or(Path::new("."));
    let bytes = |file: &str, of: &str| {
        let path = folder.join(file);
        fs::read(&path).with_context(|| format!("cannot read {} of {of}", path.display()))
    };
    let mut files = Files {
        dress: match source.wad() {
            Some(wad) => graphics::pictures(wad, &level.scene.dress),
            None => Vec::new(),
        },
        ..Files::default()
    };
    for object in &level.scene.objects {
        if let Shape::Mesh { file } = &object.shape
            && !files.meshes.contains_key(file)
        {
            let of = format!("mesh `{}`", object.name.as_deref().unwrap_or(file));
            let points = obj::read(&bytes(file, &of)?).with_context(|| file.clone())?;
            files.meshes.insert(file.clone(), points);
        }
    }
    for material in &level.scene.materials {
        if let Some(texture) = &material.texture
            && !files.pictures.contains_key(&texture.file)
        {
            let of = format!("material `{}`", material.name);
            let picture = picture(&bytes(&texture.file, &of)?)
                .with_context(|| format!("{} is no PNG picture", texture.file))?;
            files.pictures.insert(texture.file.clone(), picture);
        }
    }
    Ok(files)
}

/// Says on standard error which pictures a map names that its WAD does not have: maps for a game are often
/// without the game's own.
pub fn warn_of_missing(source: &Source, level: &Level, files: &Files) {
    const NAMED: usize = 3;
    let named = &level.scene.dress.pictures;
    let missing: Vec<&str> = (named.iter().zip(&files.dress))
        .filter(|(_, picture)| picture.is_none())
        .map(|(name, _)| name.as_str())
        .collect();
    if missing.is_empty() {
        return;
    }
    let why = match source.wad() {
        Some(wad) if wad.lump_named("PLAYPAL").is_none() => "it has no PLAYPAL, so ",
        _ => "",
    };
    let more = missing.len().saturating_sub(NAMED);
    let first = missing[..missing.len() - more].join(", ");
    let more = match more {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    complain(&format!(
        "warning: {}: {why}{} of {} textures and flats that the map names are not in the WAD ({first}{more}); \
         such surfaces are drawn bare",
        level.source,
        missing.len(),
        named.len(),
    ));
}

/// The files that a level names, beside its own.
pub fn named(level_file: &Path, level: &Level) -> Vec<PathBuf> {
    let folder = level_file.parent().unwrap_or(Path::new("."));
    let meshes = level.scene.objects.iter().filter_map(|o| match &o.shape {
        Shape::Mesh { file } => Some(file),
        _ => None,
    });
    let textures = level
        .scene
        .materials
        .iter()
        .filter_map(|m| m.texture.as_ref());
    let mut files: Vec<PathBuf> = meshes
        .chain(textures.map(|t| &t.file))
        .map(|file| folder.join(file))
        .collect();
    files.sort();
    files.dedup();
    files
}

fn picture(bytes: &[u8]) -> Result<Image> {
    let picture = image::load_from_memory(bytes)?.to_rgb8();
    Image::from_srgb(picture.width(), picture.height(), &picture).context("it is empty")
}
