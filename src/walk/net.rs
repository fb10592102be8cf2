//! Places to stand, and steps between them.
//!
//! In: the cells, a person, and what stands in the way. Out: a [`Net`]. The plan is laid out in tiles
//! as wide as a person's radius. A tile has a place where the body, as a disc, keeps clear of
//! everything that cannot be passed both ways: walls, high steps and drops, things. If its middle is
//! none, a finer lattice is tried; so a passage counts as wide enough from about 0.93 of the body's
//! width on (an opening in a wall without thickness from 0.9). Neighbouring places are joined where the straight way between them is clear too. Down a
//! drop leads a jump from a place before the edge to one beyond it.

use glam::{DVec2, IVec2};
use rustc_hash::FxHashMap;

use super::obstacle::{Obstacles, within};
use super::person::{Person, heights};
use super::rise::cross;
use crate::cells::CellGraph;
use crate::trace::Space;
use crate::trace::space::WALL;

/// Width of a tile in radii.
const TILE: f64 = 1.0;
/// Parts of a tile's side in the finer lattice.
const FINE: i32 = 8;
/// By how much of a tile the lattices are off the round numbers on which levels are drawn, so that
/// straight ways between places rarely meet a border lengthwise or in its ends.
const OFF: DVec2 = DVec2::new(0.0317, 0.0173);
/// Share of the radius that a place keeps clear.
pub(super) const PLACE: f64 = 0.93;
/// Share of the radius that a way between two places keeps clear.
pub(super) const WAY: f64 = 0.9;
/// Clearances above so many radii are not told apart.
const CAP: f64 = 3.0;
/// Distance from an edge, in radii, at which one lands and from which one jumps.
const JUMP: f64 = 1.02;

/// A place to stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub at: DVec2,
    pub cell: u32,
    /// Distance to the nearest obstacle, at most [`CAP`] radii.
    pub clear: f64,
}

/// A way from a place to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    pub to: u32,
    pub cost: f64,
    pub jump: bool,
}

/// Places and moves.
pub(super) struct Net {
    pub places: Vec<Place>,
    moves: Vec<Vec<Move>>,
}

/// What a body keeps clear of.
pub(super) struct Clearance {
    /// Everything that cannot be passed both ways.
    pub all: Obstacles,
    /// Without the edges that one can jump down from.
    pub walls: Obstacles,
    /// By edge, whether it can be passed from its cell's side.
    pub passes: Vec<bool>,
    /// Feet of objects.
    pub things: Vec<Vec<DVec2>>,
}

impl Clearance {
    /// What `passes` leaves, and things.
    pub fn new(space: &Space, passes: Vec<bool>, things: Vec<Vec<DVec2>>, radius: f64) -> Self {
        let (mut all, mut walls) = (Vec::new(), Vec::new());
        for (e, edge) in space.edges.iter().enumerate() {
            let back = edge.twin != WALL && passes[edge.twin as usize];
            if passes[e] && back || edge.twin < e as u32 {
                continue;
            }
            let line = [space.vertex(edge.from), space.vertex(edge.to)];
            all.push(line);
            if !passes[e] && !back {
                walls.push(line);
            }
        }
        for thing in &things {
            let n = thing.len();
            let sides = (0..n).map(|i| [thing[i], thing[(i + 1) % n]]);
            walls.extend(sides.clone());
            all.extend(sides);
        }
        let reach = radius * CAP;
        Self {
            all: Obstacles::new(all, reach),
            walls: Obstacles::new(walls, reach),
            passes,
            things,
        }
    }

    /// Whether a thing stands there.
    fn taken(&self, p: DVec2) -> bool {
        self.things.iter().any(|t| within(t, p))
    }
}

impl Net {
    /// Lays out the tiles and joins them.
    pub fn new(graph: &CellGraph, space: &Space, clearance: &Clearance, person: &Person) -> Self {
        let width = person.radius * TILE;
        let (places, tiles) = lay(graph, space, clearance, person, width);
        let mut net = Net {
            moves: vec![Vec::new(); places.len()],
            places,
        };
        net.join(&tiles, clearance, person, width);
        net.add_jumps(&tiles, space, clearance, person, width);
        net
    }

    pub fn place(&self, i: u32) -> &Place {
        &self.places[i as usize]
    }

    pub fn moves(&self, from: u32) -> &[Move] {
        &self.moves[from as usize]
    }

    /// Whether going from one place to the next is a jump.
    pub fn jumps(&self, from: u32, to: u32) -> bool {
        let step = self.moves(from).iter().find(|m| m.to == to);
        step.is_some_and(|m| m.jump)
    }

    fn join(
        &mut self,
        tiles: &FxHashMap<IVec2, Vec<u32>>,
        clearance: &Clearance,
        person: &Person,
        width: f64,
    ) {
        let way = person.radius * WAY;
        for (i, from) in self.places.iter().enumerate() {
            let tile = tile(from.at, width);
            for (dx, dy) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y))) {
                for &j in tiles
                    .get(&(tile + IVec2::new(dx, dy)))
                    .into_iter()
                    .flatten()
                {
                    if j as usize <= i {
                        continue;
                    }
                    let to = self.places[j as usize];
                    let length = from.at.distance(to.at);
                    if from.clear.max(to.clear) <= length + way
                        && !clearance.all.clear([from.at, to.at], way)
                    {
                        continue;
                    }
                    // Where there is room, people keep two bodies' width away from walls.
                    let near = 2.0 - from.clear.min(to.clear) / person.radius;
                    let cost = length * (1.0 + near.max(0.0));
                    for (a, b) in [(i, j), (j as usize, i as u32)] {
                        self.moves[a].push(Move {
                            to: b,
                            cost,
                            jump: false,
                        });
                    }
                }
            }
        }
    }

    fn add_jumps(
        &mut self,
        tiles: &FxHashMap<IVec2, Vec<u32>>,
        space: &Space,
        clearance: &Clearance,
        person: &Person,
        width: f64,
    ) {
        for (e, edge) in space.edges.iter().enumerate() {
            if edge.twin == WALL || !clearance.passes[e] || clearance.passes[edge.twin as usize] {
                continue;
            }
            let (a, b) = (space.vertex(edge.from), space.vertex(edge.to));
            let inward = (b - a).perp().normalize() * person.radius;
            let parts = ((b - a).length() / width).ceil();
            for k in 0..parts as u32 {
                let middle = a.lerp(b, (f64::from(k) + 0.5) / parts);
                let near = |p: DVec2| {
                    let tile = tile(p, width);
                    let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| IVec2::new(x, y)));
                    let list = around.filter_map(|d| tiles.get(&(tile + d))).flatten();
                    let distance = |i: u32| self.places[i as usize].at.distance_squared(p);
                    list.copied()
                        .min_by(|&i, &j| distance(i).total_cmp(&distance(j)))
                };
                let (Some(from), Some(to)) =
                    (near(middle + inward * JUMP), near(middle - inward * JUMP))
                else {
                    continue;
                };
                let (p, q) = (*self.place(from), *self.place(to));
                let mut jumps = false;
                let end = cross(space, p.cell, [p.at, q.at], |e, edge| {
                    jumps |= !clearance.passes[edge.twin as usize];
                    clearance.passes[e as usize]
                });
                let known = self.moves[from as usize].iter().any(|m| m.to == to);
                let way = person.radius * WAY;
                if end.is_some() && jumps && !known && clearance.walls.clear([p.at, q.at], way) {
                    self.moves[from as usize].push(Move {
                        to,
                        cost: p.at.distance(q.at) * 3.0,
                        jump: true,
                    });
                }
            }
        }
    }
}

fn tile(at: DVec2, width: f64) -> IVec2 {
    (at / width).floor().as_ivec2()
}

/// The places, and by tile their numbers: one, but where a sector has no other.
fn lay(
    graph: &CellGraph,
    space: &Space,
    clearance: &Clearance,
    person: &Person,
    width: f64,
) -> (Vec<Place>, FxHashMap<IVec2, Vec<u32>>) {
    let mut best: FxHashMap<IVec2, Place> = FxHashMap::default();
    let enough = person.radius * PLACE;
    let high = |cell: u32| {
        let [floor, ceiling] = heights(space.cell(cell));
        ceiling - floor >= person.height
    };
    let cells = || (0..space.cells.len() as u32).filter(|&c| high(c));
    let mut middles: FxHashMap<IVec2, f64> = FxHashMap::default();
    for cell in cells() {
        lattice(space, cell, width, OFF + 0.5, |at| {
            let place = tile(at, width);
            if middles.contains_key(&place) || clearance.taken(at) {
                return;
            }
            let clear = clearance.all.distance(at);
            middles.insert(place, clear);
            if clear >= enough {
                best.insert(place, Place { at, cell, clear });
            }
        });
    }
    // No point of a tile is farther from its middle than this.
    let farthest = width * std::f64::consts::FRAC_1_SQRT_2;
    for cell in cells() {
        let fine = f64::from(FINE);
        lattice(space, cell, width / fine, OFF * fine, |at| {
            let place = tile(at, width);
            let known = best.get(&place).map_or(enough, |b| b.clear);
            let hopeless = middles
                .get(&place)
                .is_some_and(|&clear| clear >= enough || clear + farthest < enough);
            if hopeless || clearance.taken(at) {
                return;
            }
            let clear = clearance.all.distance(at);
            if clear >= known && best.get(&place).is_none_or(|b| clear > b.clear) {
                best.insert(place, Place { at, cell, clear });
            }
        });
    }
    let mut order: Vec<(IVec2, Place)> = best.into_iter().collect();
    order.sort_by_key(|(tile, _)| (tile.y, tile.x));
    let mut tiles: FxHashMap<IVec2, Vec<u32>> = FxHashMap::default();
    let mut places = Vec::with_capacity(order.len());
    let mut has_place = vec![
        false;
        1 + graph
            .cells
            .iter()
            .filter_map(|c| c.sector)
            .map(|s| s.0 as usize + 1)
            .max()
            .unwrap_or(0)
    ];
    let sector = |cell: u32| graph.cells[cell as usize].sector.map(|s| s.0 as usize);
    for (tile, place) in order {
        tiles.entry(tile).or_default().push(places.len() as u32);
        if let Some(s) = sector(place.cell) {
            has_place[s] = true;
        }
        places.push(place);
    }
    // Narrow steps between the tiles' places: a place of their own.
    for cell in cells() {
        let Some(s) = sector(cell).filter(|&s| !has_place[s]) else {
            continue;
        };
        let chamber = space.cell(cell);
        let corners = chamber.first..chamber.past;
        let n = corners.len() as f64;
        let at = corners
            .map(|e| space.vertex(space.edge(e).from))
            .sum::<DVec2>()
            / n;
        let clear = clearance.all.distance(at);
        if clear >= enough && !clearance.taken(at) {
            has_place[s] = true;
            tiles
                .entry(tile(at, width))
                .or_default()
                .push(places.len() as u32);
            places.push(Place { at, cell, clear });
        }
    }
    (places, tiles)
}

/// The points of a square lattice, shifted by a share of its width, in a cell, border included.
fn lattice(space: &Space, cell: u32, width: f64, shift: DVec2, mut visit: impl FnMut(DVec2)) {
    let chamber = space.cell(cell);
    let corners: Vec<DVec2> = (chamber.first..chamber.past)
        .map(|e| space.vertex(space.edge(e).from))
        .collect();
    let (low, high) = corners
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(*p), high.max(*p))
        });
    let first = (low / width - shift).ceil();
    let last = (high / width - shift).floor();
    let mut y = first.y;
    while y <= last.y {
        // The row's stretch within the polygon.
        let at = (y + shift.y) * width;
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if a.y.min(b.y) <= at && at <= a.y.max(b.y) {
                let ends = if a.y == b.y {
                    [a.x, b.x]
                } else {
                    [a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x); 2]
                };
                from = from.min(ends[0].min(ends[1]));
                to = to.max(ends[0].max(ends[1]));
            }
        }
        let mut x = (from / width - shift.x).ceil();
        while x <= (to / width - shift.x).floor() {
            visit(DVec2::new((x + shift.x) * width, at));
            x += 1.0;
        }
        y += 1.0;
    }
}
