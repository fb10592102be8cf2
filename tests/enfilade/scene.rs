//! Scenes for tests of pictures: from the text of a level to single pixels and whole pictures.

use std::path::Path;

use enfilade::cells::{CellGraph, CellId, Locator, Options, subdivide};
use enfilade::level::doom::graphics;
use enfilade::level::scene::Shape;
use enfilade::level::{Level, read, snap, wad};
use enfilade::pvs::{Progress, Pvs, sweep};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::image::Image;
use enfilade::trace::render::{RenderOptions, Rendered, render};
use enfilade::trace::shapes::mesh::obj;
use enfilade::trace::world::{Files, World, locate};
use glam::{DVec2, DVec3};

/// A level with everything that a picture of it needs.
pub struct Scene {
    pub level: Level,
    pub graph: CellGraph,
    pub pvs: Pvs,
    pub world: World,
}

/// Where Debian's Freedoom is.
pub const FREEDOOM: &str = "/usr/share/games/doom/freedoom1.wad";

impl Scene {
    pub fn new(level: Level, files: &Files, ambient: f64) -> Self {
        Self::split(level, files, ambient, &Options::default())
    }

    /// With cells of a certain kind.
    pub fn split(level: Level, files: &Files, ambient: f64, options: &Options) -> Self {
        let graph = subdivide(&level, options);
        let pvs = sweep::sweep(&graph, &Progress::default());
        let world = World::new(&level, &graph, &pvs, files, ambient).unwrap();
        Self {
            level,
            graph,
            pvs,
            world,
        }
    }

    /// From the text of a TOML level.
    pub fn of(text: &str, ambient: f64) -> Self {
        let level = read::read(text.into(), "scene.toml", None).unwrap();
        Self::new(level, &Files::default(), ambient)
    }

    /// One of the sample levels, with its meshes and textures.
    pub fn sample(name: &str) -> Self {
        Self::sample_split(name, &Options::default())
    }

    /// One of them with cells of a certain kind.
    pub fn sample_split(name: &str, options: &Options) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
        let text = std::fs::read(folder.join(format!("{name}.toml"))).unwrap();
        let level = read::read(text, "scene.toml", None).unwrap();
        let mut files = Files::default();
        for object in &level.scene.objects {
            if let Shape::Mesh { file } = &object.shape {
                let text = std::fs::read(folder.join(file)).unwrap();
                files.meshes.insert(file.clone(), obj::read(&text).unwrap());
            }
        }
        for texture in level
            .scene
            .materials
            .iter()
            .filter_map(|m| m.texture.as_ref())
        {
            let picture = image::open(folder.join(&texture.file)).unwrap().to_rgb8();
            let picture = Image::from_srgb(picture.width(), picture.height(), &picture);
            files
                .pictures
                .insert(texture.file.clone(), picture.unwrap());
        }
        Self::split(level, &files, 0.12, options)
    }

    /// A map of Freedoom; `None`, with a word on standard error, where it is not installed.
    pub fn freedoom(map: &str) -> Option<Self> {
        Self::of_wad(FREEDOOM, map)
    }

    /// A map of a WAD; `None`, with a word on standard error, where it is not there.
    pub fn of_wad(path: &str, map: &str) -> Option<Self> {
        Self::of_wad_changed(path, map, |level| level)
    }

    /// As [`Scene::of_wad`], with a change to the level.
    pub fn of_wad_changed(
        path: &str,
        map: &str,
        change: impl FnOnce(Level) -> Level,
    ) -> Option<Self> {
        let Ok(bytes) = std::fs::read(path) else {
            assert!(
                std::env::var_os("CI").is_none(),
                "{path} is missing: install the package freedoom"
            );
            eprintln!("skipped: {path} is missing");
            return None;
        };
        let wad = wad::Wad::parse(bytes).unwrap();
        let draft = enfilade::level::doom::read_map(&wad, map, path).unwrap();
        let level = change(snap::snap(draft).unwrap());
        let files = Files {
            dress: graphics::pictures(&wad, &level.scene.dress),
            ..Files::default()
        };
        Some(Self::new(level, &files, 0.12))
    }

    pub fn cell(&self, eye: DVec3) -> CellId {
        let locator = Locator::new(&self.graph);
        locate(&self.world, &self.graph, &locator, eye).unwrap()
    }

    /// The camera of that number.
    pub fn camera(&self, number: usize, size: [u32; 2]) -> Camera {
        let camera = &self.level.scene.cameras[number];
        Camera::new(camera.eye, camera.direction, camera.fov, size)
    }

    /// A picture.
    pub fn render(&self, camera: &Camera, options: &RenderOptions) -> Rendered {
        self.render_by(&Tracer::new(&self.world), camera, options)
    }

    /// A picture by a certain way.
    pub fn render_by(&self, tracer: &Tracer, camera: &Camera, options: &RenderOptions) -> Rendered {
        let cell = self.cell(camera.eye);
        render(tracer, camera, cell, options, &Progress::default())
    }

    /// The light that comes from the point `look` to the eye.
    pub fn pixel(&self, eye: [f64; 3], look: [f64; 3], options: &RenderOptions) -> DVec3 {
        let (eye, look) = (DVec3::from(eye), DVec3::from(look));
        let camera = Camera::new(eye, look - eye, 60.0, [1, 1]);
        self.render(&camera, options).picture.pixels[0]
    }

    /// Cameras in the middles of some cells, looking about; of levels without cameras.
    pub fn cameras_about(&self, every: usize, size: [u32; 2]) -> Vec<Camera> {
        let cells = self.graph.cell_ids().step_by(every);
        cells
            .filter_map(|id| {
                let cell = self.world.space.cell(id.0);
                let (at, _) = self.world.middle(id);
                let z = (cell.floor + cell.ceiling) / 2.0;
                let ahead = DVec2::from_angle(f64::from(id.0)).extend(0.1);
                (cell.floor < cell.ceiling).then(|| Camera::new(at.extend(z), ahead, 90.0, size))
            })
            .collect()
    }
}
