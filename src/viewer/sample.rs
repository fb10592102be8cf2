//! Levels for tests.

use std::path::Path;

use crate::cells::{CellGraph, Doors, Options, subdivide};
use crate::level::doom::graphics;
use crate::level::scene::Shape;
use crate::level::{Level, doom, read, snap, wad};
use crate::pvs::{Progress, Pvs, sweep};
use crate::trace::image::Image;
use crate::trace::shapes::mesh::obj;
use crate::trace::world::{Files, World};

/// A level with everything that the viewer needs of it.
pub struct Sample {
    pub level: Level,
    pub graph: CellGraph,
    pub pvs: Pvs,
    pub world: World,
}

impl Sample {
    fn new(level: Level, files: &Files, doors: Doors) -> Self {
        let options = Options {
            doors,
            ..Options::default()
        };
        let graph = subdivide(&level, &options);
        let pvs = sweep::sweep(&graph, &Progress::default());
        let world = World::new(&level, &graph, &pvs, files, 0.12).expect("it has heights");
        Self {
            level,
            graph,
            pvs,
            world,
        }
    }

    /// From the text of a TOML level.
    pub fn of(text: &str, doors: Doors) -> Self {
        let level = read::read(text.into(), "sample.toml", None).expect("it is sound");
        Self::new(level, &Files::default(), doors)
    }

    /// One of the sample levels, with its meshes and pictures.
    pub fn named(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
        let text = std::fs::read(folder.join(format!("{name}.toml"))).expect("it is there");
        let level = read::read(text, "sample.toml", None).expect("it is sound");
        let mut files = Files::default();
        for object in &level.scene.objects {
            if let Shape::Mesh { file } = &object.shape {
                let text = std::fs::read(folder.join(file)).expect("it is there");
                let mesh = obj::read(&text).expect("it is sound");
                files.meshes.insert(file.clone(), mesh);
            }
        }
        for texture in level
            .scene
            .materials
            .iter()
            .filter_map(|m| m.texture.as_ref())
        {
            let picture = image::open(folder.join(&texture.file)).expect("it is there");
            let picture = picture.to_rgb8();
            let picture = Image::from_srgb(picture.width(), picture.height(), &picture);
            let picture = picture.expect("it is not empty");
            files.pictures.insert(texture.file.clone(), picture);
        }
        Self::new(level, &files, Doors::Open)
    }

    /// A map of Freedoom. `None` where that is not installed, which in CI is a failure.
    pub fn freedoom(map: &str) -> Option<Self> {
        const WAD: &str = "/usr/share/games/doom/freedoom1.wad";
        let Ok(bytes) = std::fs::read(WAD) else {
            let ci = std::env::var_os("CI").is_some();
            assert!(!ci, "{WAD} is missing: apt-get install freedoom");
            println!("skipped {map}: {WAD} is missing (apt-get install freedoom)");
            return None;
        };
        let wad = wad::Wad::parse(bytes).expect("it is sound");
        let draft = doom::read_map(&wad, map, WAD).expect("it is sound");
        let level = snap::snap(draft).expect("it fits");
        let files = Files {
            dress: graphics::pictures(&wad, &level.scene.dress),
            ..Files::default()
        };
        Some(Self::new(level, &files, Doors::Open))
    }
}
