//! Thumbnails of the dearest places, and what walks reveal.

use std::collections::BTreeSet;

use anyhow::Result;
use glam::DVec3;
use image::ImageEncoder;
use rayon::prelude::*;

use crate::cells::{CellGraph, CellId};
use crate::cli::render::files;
use crate::level::Level;
use crate::level::read::Source;
use crate::preview::{self, Culling, Easel, Finish, Painter};
use crate::pvs::Pvs;
use crate::pvs::eye::{Cone, Lookout, Scratch};
use crate::report::costs::{Costs, room_of};
use crate::report::page::{Moment, Reveal};
use crate::trace::camera::Camera;
use crate::trace::space::Space;
use crate::trace::world::World;
use crate::walk::{Ground, Person, Track, TrackOptions, opened, tour};

/// Pixels of a thumbnail, twice as many as it is shown with.
const SIZE: [u32; 2] = [320, 200];
/// Its angle of view.
const FOV: f64 = 90.0;
/// Light of places without a brightness of their own.
const AMBIENT: f64 = 0.3;
/// Moments of a walk that are shown.
const MOMENTS: usize = 8;
/// Looks along a walk: one after so many seconds, but no more than so many.
const STEP: f64 = 0.25;
const MOST_LOOKS: f64 = 4000.0;
/// Seconds whose gains count as one moment.
const TOGETHER: f64 = 1.5;

/// The level as the preview paints it, with its doors open; `None` where it has no heights, or nothing
/// orders its cells.
pub fn world(
    path: &std::path::Path,
    source: &Source,
    level: &Level,
    graph: &CellGraph,
    pvs: &Pvs,
) -> Result<Option<World>> {
    if graph.tree.is_none() || level.sectors.is_empty() {
        return Ok(None);
    }
    let files = files::read(path, source, level)?;
    // Nobody stands in a closed door.
    let open = opened(level, &Person::of_unit(&level.unit));
    Ok(World::new(&open, graph, pvs, &files, AMBIENT).ok())
}

/// Pictures from the dearest places, along their longest sightlines.
pub fn of_worst(costs: &Costs, world: &World) -> Vec<Option<Vec<u8>>> {
    let Some(painter) = Painter::new(world, costs.graph, costs.pvs, Finish::Textured) else {
        return Vec::new();
    };
    let person = Person::of_unit(&costs.level.unit);
    let picture = |cell: CellId| {
        let chamber = world.space.cell(cell.0);
        let [x, y] = {
            let middle = crate::pvs::explain::middle(costs.graph, cell);
            costs
                .graph
                .grid
                .offset_to_level(middle.x, middle.y)
                .to_array()
        };
        let z = (chamber.floor + person.eye).min((chamber.floor + chamber.ceiling) / 2.0);
        let eye = DVec3::new(x, y, z.max(chamber.floor));
        let far = costs.sightline(cell)?.to;
        let far = costs.graph.grid.offset_to_level(far.x, far.y);
        let ahead = (far - eye.truncate()).extend(0.0);
        paint(&painter, eye, ahead)
    };
    let cells = costs.worst.par_iter().map(|w| CellId(w.cell));
    cells.map(picture).collect()
}

fn paint(painter: &Painter, eye: DVec3, ahead: DVec3) -> Option<Vec<u8>> {
    let ahead = if ahead == DVec3::ZERO {
        DVec3::X
    } else {
        ahead
    };
    let camera = Camera::new(eye, ahead.normalize(), FOV, SIZE);
    let options = preview::Options {
        culling: Culling::Eye,
        order: preview::Order::BackToFront,
        objects: true,
        surfaces: false,
    };
    let mut easel = Easel::default();
    painter.draw(&camera, &options, &mut easel).ok()?;
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    let [width, height] = SIZE;
    let colours = image::ExtendedColorType::Rgb8;
    let encoded = encoder.write_image(&easel.canvas.srgb(), width, height, colours);
    encoded.ok().map(|()| png)
}

/// What is seen first where along the level's paths, or along a tour.
pub fn reveals(costs: &Costs, world: Option<&World>, wants_tour: bool) -> Vec<Reveal> {
    let (level, graph) = (costs.level, costs.graph);
    let options = TrackOptions::default();
    let mut tracks: Vec<(String, Track)> = Vec::new();
    if !level.scene.paths.is_empty() {
        let space = Space::new(level, graph);
        let ground = Ground::new(graph, &space);
        for path in &level.scene.paths {
            let name = format!("Path ‘{}’", path.name);
            tracks.push((name, Track::new(path, &ground, &options)));
        }
    }
    if wants_tour {
        let person = Person::of_unit(&level.unit);
        let open = opened(level, &person);
        let space = Space::new(&open, graph);
        if let Some(tour) = tour(&open, graph, &space, &person) {
            let name = format!("Tour of {} places", tour.visits.len());
            tracks.push((name, tour.track(&options)));
        }
    }
    let painter = world.and_then(|w| Painter::new(w, costs.graph, costs.pvs, Finish::Textured));
    let lookout = Lookout::new(graph);
    let reveal =
        |(name, track): &(String, Track)| reveal(costs, name, track, &lookout, painter.as_ref());
    tracks.par_iter().filter_map(reveal).collect()
}

/// Ground that came into sight about a moment.
struct Gain {
    seconds: f64,
    cell: CellId,
    area: f64,
    all: f64,
    rooms: BTreeSet<String>,
}

fn reveal(
    costs: &Costs,
    name: &str,
    track: &Track,
    lookout: &Lookout,
    painter: Option<&Painter>,
) -> Option<Reveal> {
    let (level, graph) = (costs.level, costs.graph);
    let around = Cone::new(0.0, 360.0).ok()?;
    let mut scratch = Scratch::default();
    let mut known = vec![false; graph.cells.len()];
    let mut rooms = BTreeSet::new();
    let mut all = 0.0;
    let mut gains: Vec<Gain> = Vec::new();
    let step = STEP.max(track.seconds() / MOST_LOOKS);
    let looks = (track.seconds() / step).ceil() as u32;
    for k in 0..=looks {
        let seconds = (f64::from(k) * step).min(track.seconds());
        let eye = graph.grid.fine(track.at(seconds).eye.truncate());
        let Some(vista) = eye.and_then(|e| lookout.look(&e, &around, &mut scratch).ok()) else {
            continue;
        };
        let cell = vista.cells()[0];
        let mut area = 0.0;
        let mut new_rooms = BTreeSet::new();
        for &c in vista.cells() {
            if !std::mem::replace(&mut known[c.0 as usize], true) {
                area += costs.own[c.0 as usize].area;
                let room = room_of(level, graph, c);
                new_rooms.extend(room.filter(|r| rooms.insert(r.clone())));
            }
        }
        all += area;
        match gains.last_mut().filter(|g| seconds - g.seconds < TOGETHER) {
            Some(gain) => {
                gain.area += area;
                gain.all = all;
                gain.rooms.extend(new_rooms);
            }
            None if area > 0.0 => gains.push(Gain {
                seconds,
                cell,
                area,
                all,
                rooms: new_rooms,
            }),
            None => {}
        }
    }
    gains.sort_by(|a, b| b.area.total_cmp(&a.area));
    gains.truncate(MOMENTS);
    gains.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let moment = |gain: Gain| {
        let pose = track.at(gain.seconds);
        Moment {
            seconds: gain.seconds,
            distance: track.length() * gain.seconds / track.seconds().max(f64::MIN_POSITIVE),
            point: pose.eye.truncate().to_array(),
            cell: gain.cell.0,
            rooms: gain.rooms.into_iter().collect(),
            area: [gain.area, gain.all],
            picture: painter.and_then(|p| paint(p, pose.eye, pose.direction)),
        }
    };
    let points = track.points().iter();
    Some(Reveal {
        name: name.to_string(),
        line: points.map(|p| p.truncate().to_array()).collect(),
        moments: gains.into_iter().map(moment).collect(),
    })
}
