//! What stands in a level besides its walls: materials, lights, objects, cameras, paths.
//!
//! Read and checked with the level; used by `trace`, `preview` and `walk`. Points are in the
//! level's own coordinates (x right, y up on the plan, z up), angles in degrees, colours linear RGB
//! with 1 as full, names of materials already resolved to [`MaterialId`]s.

use glam::DVec3;

use super::dress::Dress;

/// Everything in a level that is not plan geometry. Empty where the source has none of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Materials, in file order; names are distinct.
    pub materials: Vec<Material>,
    /// Lights, in file order.
    pub lights: Vec<Light>,
    /// Objects, in file order.
    pub objects: Vec<Object>,
    /// Cameras, in file order; names are distinct.
    pub cameras: Vec<Camera>,
    /// Paths for walkthroughs, in file order; names are distinct.
    pub paths: Vec<CameraPath>,
    /// Limits that `report` compares the level with.
    pub budget: Budget,
    /// What walls, floors and ceilings wear one by one (Doom maps).
    pub dress: Dress,
}

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// How a surface reflects, transmits and emits light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name that walls, sectors and objects refer to.
    pub name: String,
    /// Diffuse reflection (kd), each channel 0 to 1.
    pub diffuse: [f64; 3],
    /// Highlight (ks), each channel 0 to 1.
    pub specular: [f64; 3],
    /// Exponent of the highlight, at least 1; larger is smaller and harder.
    pub shininess: f64,
    /// Share of light reflected as by a mirror, 0 to 1.
    pub mirror: f64,
    /// Share of light let through, 0 to 1; `mirror + transmit` is at most 1.
    pub transmit: f64,
    /// Index of refraction, positive; 1 lets light pass straight.
    pub ior: f64,
    /// How far mirrored and transmitted rays scatter: 0 (sharp) to 1.
    pub roughness: f64,
    /// Light given off, each channel at least 0.
    pub emission: [f64; 3],
    /// Picture that takes the place of the diffuse colour.
    pub texture: Option<Texture>,
}

/// A picture laid over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// File name, relative to the level's folder.
    pub file: String,
    /// Length in units that one repetition of the picture covers, positive.
    pub scale: f64,
}

/// A light source.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name for reports.
    pub name: Option<String>,
    /// RGB intensity; each channel at least 0, one of them positive. For a point at unit distance,
    /// facing the light; a directional light has the same everywhere.
    pub intensity: [f64; 3],
    /// Form of the source.
    pub shape: LightShape,
}

/// Forms of light sources. Directions have unit length and point the way the light goes.
#[derive(Clone, Debug, PartialEq)]
pub enum LightShape {
    /// Shines from a point in all directions.
    Point {
        /// Where it is.
        position: DVec3,
    },
    /// Shines from a point into a cone.
    Spot {
        /// The cone's apex.
        position: DVec3,
        /// The cone's axis.
        direction: DVec3,
        /// Angle between the axis and the cone's edge, above 0 and at most 90.
        angle: f64,
        /// Angle from the axis up to which the light is undiminished, 0 to `angle`.
        inner: f64,
    },
    /// Shines along one direction, from infinitely far away.
    Directional {
        /// The way the light goes.
        direction: DVec3,
    },
    /// A parallelogram that shines on the side to which `edges[0] × edges[1]` points.
    Rectangle {
        /// Its middle.
        center: DVec3,
        /// Its two edges; not parallel.
        edges: [DVec3; 2],
    },
    /// A disc that shines on one side.
    Disc {
        /// Its middle.
        center: DVec3,
        /// The side on which it shines.
        direction: DVec3,
        /// Positive.
        radius: f64,
    },
    /// A ball.
    Sphere {
        /// Its middle.
        center: DVec3,
        /// Positive.
        radius: f64,
    },
}

/// A thing that stands in the level and is no part of its plan. It does not block visibility
/// between cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Name for reports.
    pub name: Option<String>,
    /// Its form, around its own origin.
    pub shape: Shape,
    /// Its material; `None`: the renderer's default.
    pub material: Option<MaterialId>,
    /// Where its own origin stands.
    pub position: DVec3,
    /// Turns about the x, y and z axis, in that order, in degrees; applied after the scale.
    pub rotation: DVec3,
    /// Factors along its own axes, positive; applied first.
    pub scale: DVec3,
}

/// Forms of objects, around the object's own origin, z up.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Ball about the origin.
    Sphere {
        /// Positive.
        radius: f64,
    },
    /// Block that stands on the origin: its foot is centred there.
    Box {
        /// Lengths along x, y and z, positive.
        size: DVec3,
    },
    /// Cylinder that stands on the origin.
    Cylinder {
        /// Positive.
        radius: f64,
        /// Positive.
        height: f64,
    },
    /// Cone that stands on the origin, its tip up.
    Cone {
        /// Radius of the foot, positive.
        radius: f64,
        /// Positive.
        height: f64,
    },
    /// Flat polygon, its front where its corners run counterclockwise.
    Polygon {
        /// At least three corners, not all on one line.
        points: Vec<DVec3>,
    },
    /// Triangles from a file.
    Mesh {
        /// File name, relative to the level's folder.
        file: String,
    },
}

/// A standpoint for pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name for `--camera`.
    pub name: String,
    /// The eye.
    pub eye: DVec3,
    /// Unit vector along the view.
    pub direction: DVec3,
    /// Horizontal angle of view in degrees, above 0 and below 180.
    pub fov: f64,
}

/// A walk through the level.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// Name for `--path`.
    pub name: String,
    /// What the walk passes through, at least two points, no two in a row equal; of a closed path
    /// neither the last and the first. The eye itself, or, with `eye`, places on the plan (z is 0).
    pub points: Vec<DVec3>,
    /// Height of the eye over the floor that it passes, positive; `None`: the points are the eye.
    pub eye: Option<f64>,
    /// Whether the walk goes on from the last point to the first.
    pub closed: bool,
    /// Where the walker looks.
    pub look: PathLook,
    /// How fast he walks.
    pub pace: PathPace,
    /// Horizontal angle of view in degrees, above 0 and below 180.
    pub fov: f64,
}

/// How fast a walker walks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathPace {
    /// Duration of the whole walk, positive.
    Seconds(f64),
    /// Length per second, positive.
    Speed(f64),
}

/// Where a walker looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathLook {
    /// The way that he goes.
    Ahead,
    /// At one point all the time.
    At(DVec3),
}

/// Limits on visibility that a level promises to keep; `None`: no limit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Budget {
    /// Most cells that any cell may see.
    pub max_visible_cells: Option<u64>,
    /// Most polygons that may lie in what any cell sees.
    pub max_visible_polygons: Option<u64>,
    /// Most walls that any cell may see.
    pub max_visible_walls: Option<u64>,
    /// Most cells that a cell may see in the mean.
    pub max_mean_visible_cells: Option<f64>,
    /// Most polygons that a cell may see in the mean.
    pub max_mean_visible_polygons: Option<f64>,
    /// Greatest length of a sightline, in the level's unit.
    pub max_sightline: Option<f64>,
    /// Largest share of all pairs of cells that may see each other, 0 to 1.
    pub max_density: Option<f64>,
}
