//! Files that hold walks alone, beside the level that they lead through: `[[path]]` tables as in a level
//! file, and nothing else. So a map in another format gets walks too.
//!
//! In: such a text. Out: the paths. [`write::path`](super::write::path) is the way back.
//!
//! ```
//! let text = "[[path]]\nname = 'in'\npoints = [[1, 1, 1.6], [5, 1, 1.6]]\nspeed = 1.5";
//! let walks = enfilade::level::toml::walks::read(text).unwrap();
//! assert_eq!(walks[0].points.len(), 2);
//! ```

use super::error::TomlError;
use super::furnish::path;
use super::names::Names;
use super::record::WalksFile;
use super::source::SourceText;
use crate::level::scene::CameraPath;

/// Reads the walks of a file that holds nothing else.
///
/// # Errors
/// The first mistake, with its place: another table, a path that goes nowhere, two of the same name.
pub fn read(text: &str) -> Result<Vec<CameraPath>, TomlError> {
    let source = SourceText::new(text.trim_start_matches('\u{feff}'));
    let file: WalksFile = source.parse()?;
    Names::of(&source, "path", file.path.iter().map(|p| &p.get_ref().name))?;
    file.path.iter().map(|p| path(&source, p)).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::write;
    use super::*;
    use crate::level::scene::{PathLook, PathPace};

    #[test]
    fn walks_are_written_and_read_back() {
        let path = |name: &str, eye, look| CameraPath {
            name: name.to_string(),
            points: vec![DVec3::new(0.25, -3.5, 0.0), DVec3::new(1.0 / 3.0, 4.0, 0.0)],
            eye,
            closed: false,
            look,
            pace: PathPace::Seconds(12.5),
            fov: 75.0,
        };
        let walks = [
            path("a \"b\"", Some(1.6), PathLook::Ahead),
            path("c", None, PathLook::At(DVec3::ONE)),
        ];
        let text: String = walks.iter().map(write::path).collect();
        assert_eq!(read(&text).expect("it reads"), walks);
        // And at the end of a level.
        let level = format!("[[room]]\nname = \"A\"\nrect = [0, 0, 9, 9]\n{text}");
        let level = super::super::read(&level, "a.toml").expect("it reads");
        assert_eq!(level.scene.paths, walks);
    }

    #[test]
    fn nothing_else_may_stand_there() {
        let place = |text: &str| read(text).expect_err("it is wrong").to_string();
        let walk = "[[path]]\nname = \"a\"\npoints = [[0, 0, 1], [1, 0, 1]]\nseconds = 1\n";
        assert!(
            place(&format!("{walk}[[room]]\n")).contains("line 5"),
            "{}",
            place(&format!("{walk}[[room]]\n"))
        );
        assert!(place(&format!("{walk}{walk}")).contains("`a`"));
        assert!(
            place("[[path]]\nname = \"a\"\npoints = [[0, 0, 1]]\nseconds = 1")
                .contains("two points")
        );
        assert_eq!(read("").expect("no walks"), []);
    }
}
