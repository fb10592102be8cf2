//! Where the eye is and where it looks.

use anyhow::{Result, bail};
use glam::{DVec2, DVec3};

use super::RenderArgs;
use crate::cells::{CellGraph, Locator};
use crate::level::read::Source;
use crate::level::{Level, doom};
use crate::trace::world::World;

/// Of a picture without a camera.
const FOV: f64 = 75.0;
/// Of the game.
const DOOM_FOV: f64 = 90.0;
/// Height of the game's eye above the floor.
const DOOM_EYE: f64 = 41.0;

/// An eye.
pub struct Viewpoint {
    /// Where it is.
    pub eye: DVec3,
    /// Where it looks; not zero.
    pub direction: DVec3,
    /// Horizontal angle of view in degrees.
    pub fov: f64,
    /// What people call it.
    pub name: String,
}

impl Viewpoint {
    /// The one that was asked for, or the level's usual one.
    pub fn choose(
        args: &RenderArgs,
        source: &Source,
        level: &Level,
        graph: &CellGraph,
        world: &World,
        locator: &Locator,
    ) -> Result<Self> {
        let mut view = if let (Some(eye), Some(look)) = (args.eye, args.look) {
            if eye == look {
                bail!("--look is where --eye is; look at another point");
            }
            Self {
                eye,
                direction: look - eye,
                fov: FOV,
                name: "from the given eye".to_string(),
            }
        } else if let Some(view) = camera(level, args.camera.as_deref())? {
            view
        } else if let Some(view) = player(args, source, graph, world, locator)? {
            view
        } else {
            largest_cell(level, graph, world)?
        };
        view.fov = args.fov.unwrap_or(view.fov);
        Ok(view)
    }
}

/// The camera of that name; without a name the first.
fn camera(level: &Level, name: Option<&str>) -> Result<Option<Viewpoint>> {
    let cameras = &level.scene.cameras;
    let found = match name {
        Some(name) => cameras.iter().find(|c| c.name == name),
        None => cameras.first(),
    };
    match (found, name) {
        (Some(camera), _) => Ok(Some(Viewpoint {
            eye: camera.eye,
            direction: camera.direction,
            fov: camera.fov,
            name: format!("camera `{}`", camera.name),
        })),
        (None, None) => Ok(None),
        (None, Some(_)) if cameras.is_empty() => {
            bail!(
                "{} has no cameras; give --eye and --look instead",
                level.name
            )
        }
        (None, Some(name)) => {
            let names: Vec<&str> = cameras.iter().map(|c| c.name.as_str()).collect();
            bail!(
                "there is no camera `{name}`; there are: {}",
                names.join(", ")
            )
        }
    }
}

/// Where a Doom map's player starts.
fn player(
    args: &RenderArgs,
    source: &Source,
    graph: &CellGraph,
    world: &World,
    locator: &Locator,
) -> Result<Option<Viewpoint>> {
    let Some(wad) = source.wad() else {
        return Ok(None);
    };
    let maps = source.maps();
    let map = args.level.map.as_ref().or(maps.first());
    let Some(map) = map else { return Ok(None) };
    let read = doom::read_doom_map(wad, map, "")?;
    let Some((at, angle)) = read.player_start() else {
        return Ok(None);
    };
    let point = graph.grid.nearest(at);
    let Some(cell) = point.and_then(|p| locator.cell_at(graph, p)) else {
        return Ok(None);
    };
    let chamber = world.space.cell(cell.0);
    let height = chamber.ceiling - chamber.floor;
    let above = if height > DOOM_EYE {
        DOOM_EYE
    } else {
        height / 2.0
    };
    Ok(Some(Viewpoint {
        eye: at.extend(chamber.floor + above),
        direction: DVec2::from_angle(angle.to_radians()).extend(0.0),
        fov: DOOM_FOV,
        name: "from the player's start".to_string(),
    }))
}

/// From the middle of the largest cell along its longest way.
fn largest_cell(level: &Level, graph: &CellGraph, world: &World) -> Result<Viewpoint> {
    let open = |id: &crate::cells::CellId| {
        let cell = world.space.cell(id.0);
        cell.floor < cell.ceiling
    };
    let size = |id: &crate::cells::CellId| world.middle(*id).1;
    let largest = (graph.cell_ids().filter(open)).max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some(cell) = largest else {
        bail!("{} has no place for an eye", level.name);
    };
    let (at, _) = world.middle(cell);
    let chamber = world.space.cell(cell.0);
    let corners = (chamber.first..chamber.past).map(|e| {
        let edge = world.space.edge(e);
        world.space.vertex(edge.from)
    });
    let farthest = corners.max_by(|a, b| a.distance(at).total_cmp(&b.distance(at)));
    let ahead = farthest.map_or(DVec2::X, |p| p - at);
    Ok(Viewpoint {
        eye: at.extend(chamber.floor + 0.55 * (chamber.ceiling - chamber.floor)),
        direction: ahead.extend(0.0),
        fov: FOV,
        name: format!("from the middle of the largest cell ({})", cell.0),
    })
}

/// `X,Y,Z`
pub fn point(text: &str) -> Result<DVec3, String> {
    let wrong =
        || "three numbers with commas between them are needed, such as 12.5,-3,1.6".to_string();
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err(wrong()),
    }
}

/// `WxH`
pub fn size(text: &str) -> Result<[u32; 2], String> {
    const MOST: u32 = 32_768;
    let wrong = || {
        format!(
            "width and height from 1 to {MOST} with an x between them are needed, such as 960x600"
        )
    };
    let (width, height) = text.split_once(['x', '×']).ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse().ok().filter(|n| (1..=MOST).contains(n));
    match (number(width), number(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err(wrong()),
    }
}

/// An angle of view.
pub fn angle(text: &str) -> Result<f64, String> {
    let angle = text.parse().ok().filter(|a| *a > 0.0 && *a < 180.0);
    angle.ok_or_else(|| "an angle above 0 and below 180 degrees is needed".to_string())
}
