//! `enfilade view`: the interactive viewer.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use super::Answer;
#[cfg(feature = "viewer")]
use {
    super::level_args::open,
    super::output,
    super::render::files,
    crate::viewer::{self, Loaded, Services, Voice},
    std::path::Path,
    std::sync::Arc,
};

/// Walk through a level in a window: what is visible from where, why, and what it costs.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Level file: .toml, or a Doom .wad; more can be opened in the window
    level: Option<PathBuf>,
    /// Map of a WAD that has several
    #[arg(long, value_name = "NAME")]
    map: Option<String>,
    /// Write a line to standard error whenever the eye comes into another cell
    #[arg(long)]
    log: bool,
}

/// Findings and explanations in the words of `check` and `explain`.
#[cfg(feature = "viewer")]
const VOICE: Voice = Voice {
    findings: crate::report::check::of_cells,
    why: |level, graph, pvs, cells, heights| {
        use crate::pvs::explain::ExplainOptions;
        use crate::report::explain::{Account, Asked, explain, text};

        let asked = cells.map(|cell| Asked {
            cell,
            point: None,
            beside: None,
        });
        let options = ExplainOptions {
            heights: heights.then(Default::default),
            ..ExplainOptions::default()
        };
        let explained = explain(graph, pvs, asked, &options)?;
        Some(text::of(level, &Account::of(level, graph, &explained)))
    },
};

/// Reads levels as every command does, with the pictures and meshes that they name.
#[cfg(feature = "viewer")]
fn read(path: &Path, map: Option<&str>) -> Result<Loaded> {
    let source = open(path)?;
    let level = source.level(map)?;
    let files = files::read(path, &source, &level)?;
    Ok(Loaded { level, files })
}

/// Writes a file, whole or not at all.
#[cfg(feature = "viewer")]
fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = output::Output::create(path)?;
    file.write(|out| out.write_all(bytes))?;
    output::commit([file])
}

/// What the viewer needs of the rest of the program: how files are read and written, and words.
#[cfg(feature = "viewer")]
pub fn services() -> Services {
    Services {
        load: Arc::new(|path, map| read(path, map).map_err(|e| format!("{e:#}"))),
        save: |path, bytes| write(path, bytes).map_err(|e| format!("{e:#}")),
        voice: VOICE,
    }
}

/// Runs `enfilade view`.
#[cfg(feature = "viewer")]
pub(super) fn run(args: &ViewArgs) -> Result<Answer> {
    let level = args.level.clone().map(|path| (path, args.map.clone()));
    if let Some((path, map)) = &level {
        // Said where it was asked for, before a window opens.
        read(path, map.as_deref())?;
    }
    let log = args
        .log
        .then_some((|line: &str| super::complain(line)) as fn(&str));
    viewer::run(level, services(), log)?;
    Ok(Answer::Yes)
}

/// Says how to get it.
#[cfg(not(feature = "viewer"))]
pub(super) fn run(args: &ViewArgs) -> Result<Answer> {
    _ = (&args.level, &args.map, args.log);
    anyhow::bail!(
        "this enfilade was built without the viewer; build it with `cargo build --release --features viewer`"
    )
}

#[cfg(all(test, feature = "viewer", unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn a_saved_file_keeps_its_permissions_and_links_stay_links() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("a.toml"), folder.path().join("b.toml"));
        std::fs::write(&file, "old").unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        (services().save)(&link, b"new").unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "new");
        let mode = std::fs::metadata(&file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        assert!(link.is_symlink());
        let said = (services().save)(&folder.path().join("no/c.toml"), b"new").unwrap_err();
        assert!(said.contains("no/c.toml"), "{said}");
    }
}
