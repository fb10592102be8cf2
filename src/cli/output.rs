//! Files that are written whole or not at all.
//!
//! An [`Output`] writes into a new file beside its target; only [`commit`] puts it in the target's
//! place, after everything is on the disk. So a full disk, or any failure before, leaves an old
//! file as it was. `-` is standard output; devices and pipes are written directly.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use tempfile::NamedTempFile;

/// A file in the making.
pub struct Output {
    name: PathBuf,
    sink: Sink,
}

enum Sink {
    Stdout,
    /// Something that cannot be replaced: a device or a pipe.
    Direct(File),
    Beside {
        temporary: NamedTempFile,
        target: PathBuf,
    },
}

/// Whether a path means standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Refuses two outputs that go to the same place.
pub fn must_differ(first: Option<&Path>, second: Option<&Path>) -> Result<()> {
    match (first, second) {
        (Some(a), Some(b)) if a == b && is_stdout(a) => {
            bail!("only one output can go to standard output; give the other a file's name")
        }
        (Some(a), Some(b)) if a == b => {
            bail!(
                "two outputs go to {}; give them different names",
                a.display()
            )
        }
        _ => Ok(()),
    }
}

impl Output {
    /// Prepares to write `path`. Finds out already here whether the folder can be written.
    pub fn create(path: &Path) -> Result<Output> {
        let name = path.to_path_buf();
        let sink = open(path).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Output { name, sink })
    }

    /// Writes the contents, buffered. Standard output gets them now.
    pub fn write(&mut self, contents: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        let filled = match &mut self.sink {
            Sink::Stdout => fill_stdout(contents),
            Sink::Direct(file) => fill(file, contents),
            Sink::Beside { temporary, .. } => fill(temporary.as_file_mut(), contents)
                .and_then(|()| temporary.as_file().sync_all()),
        };
        filled.with_context(|| match self.sink {
            Sink::Stdout => "cannot write to standard output".to_string(),
            _ => format!("cannot write {}", self.name.display()),
        })
    }
}

fn fill(
    sink: impl Write,
    contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffered = BufWriter::with_capacity(1 << 16, sink);
    contents(&mut buffered)?;
    buffered.flush()
}

/// Whoever closes the other end of a pipe has seen enough (`enfilade … | head`): no failure, and
/// other outputs of the same run are still to be written.
fn fill_stdout(contents: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    match fill(io::stdout().lock(), contents) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

fn open(path: &Path) -> io::Result<Sink> {
    if is_stdout(path) {
        return Ok(Sink::Stdout);
    }
    // A link is followed, so that what it points to is replaced and not the link.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let mut builder = tempfile::Builder::new();
    builder.prefix(".enfilade-");
    match fs::metadata(&target) {
        Ok(old) if old.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(old) if !old.is_file() => return Ok(Sink::Direct(File::create(&target)?)),
        Ok(old) => {
            // Replacing a file must not get around its write protection.
            File::options().append(true).open(&target)?;
            builder.permissions(old.permissions());
        }
        Err(_) => allow_all(&mut builder),
    }
    let folder = match target.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    fs::metadata(folder)?;
    // The error's kind alone: nobody has to know the temporary file's name.
    let temporary = builder
        .tempfile_in(folder)
        .map_err(|e| io::Error::from(e.kind()))?;
    Ok(Sink::Beside { temporary, target })
}

/// The permissions of any new file: what the process's mask leaves.
#[cfg(unix)]
fn allow_all(builder: &mut tempfile::Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn allow_all(_: &mut tempfile::Builder<'_, '_>) {}

/// Puts files, all completely written, in their places.
pub fn commit(outputs: impl IntoIterator<Item = Output>) -> Result<()> {
    for output in outputs {
        if let Sink::Beside { temporary, target } = output.sink {
            temporary
                .persist(&target)
                .with_context(|| format!("cannot write {}", output.name.display()))?;
        }
    }
    Ok(())
}

/// Text for people, on standard output.
pub fn print(text: &str) -> Result<()> {
    fill_stdout(|out| out.write_all(text.as_bytes())).context("cannot write to standard output")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.txt");
        fs::write(&path, "old").unwrap();
        let mut output = Output::create(&path).unwrap();
        let failed = output.write(|out| {
            out.write_all(b"new")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(failed.unwrap_err().to_string().contains("old.txt"));
        drop(output);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn nothing_changes_before_the_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.txt");
        let mut output = Output::create(&path).unwrap();
        output.write(|out| out.write_all(b"new")).unwrap();
        assert!(!path.exists());
        commit([output]).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn a_missing_folder_is_found_early() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Output::create(&folder.path().join("no/new.txt")).is_err());
        assert!(Output::create(folder.path()).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error() {
        let mut output = Output::create(Path::new("/dev/full")).unwrap();
        assert!(output.write(|out| out.write_all(b"much")).is_err());
    }
}
