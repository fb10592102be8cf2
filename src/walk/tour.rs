//! A walk through everything that can be reached on foot.
//!
//! In: a level with its cells, and who walks. Out: a [`Tour`]: the way, the sectors that it visits, in
//! order, and those that it does not, each with the reason. The level is taken as it stands; a tour
//! through doors is one of the level that [`opened`] makes of it.
//!
//! A net of places to stand (`net`) says where one can go. Where a drop leads to
//! places from which there is no way back, the tour sees everything before it jumps, and jumps where
//! most is to be seen afterwards. Within such a part, the nearest sector not yet seen is next; its
//! middle is walked to, and what is passed on the way has been seen. Then the order is improved by
//! turning round pieces of it (2-opt, G. A. Croes 1958) and by moving single stops. The nearest
//! neighbour alone may take longer than the best order by a factor that grows with the logarithm of
//! their number (Rosenkrantz, Stearns, Lewis 1977); with 2-opt it is some five per cent in practice.
//! Last, the way is pulled taut and rounded (`taut`); a sector that it then no longer
//! touches becomes a stop of its own.

use glam::{DVec2, DVec3};

use super::net::{Clearance, Net, Place};
use super::obstacle::footprint;
use super::person::{Barrier, Person, pass};
use super::rise::{self, Ground, cross};
use super::search::{NONE, parts, ways};
use super::stops::{self, Part};
use super::taut::{self, Corner};
use super::track::{Track, TrackOptions};
use crate::cells::CellGraph;
use crate::level::{Interior, Level, SectorId};
use crate::trace::Space;

/// A thing is in the way if it is higher than this share of a step.
const FLAT: f64 = 0.5;
/// How often sectors that the finished way misses may be put in.
const ROUNDS: u32 = 6;

/// A way through a level.
#[derive(Clone, Debug)]
pub struct Tour {
    /// The eye's way: a line of short straight parts; never empty.
    pub points: Vec<DVec3>,
    /// The sectors that the way passes through, in the order in which it comes to them.
    pub visits: Vec<SectorId>,
    /// The sectors that it does not pass through, ascending, and why.
    pub missed: Vec<(SectorId, Barrier)>,
    /// Who walks.
    pub person: Person,
}

impl Tour {
    /// The walk at the person's pace.
    pub fn track(&self, options: &TrackOptions) -> Track {
        Track::along(self.points.clone(), self.person.speed, options)
    }
}

/// The level with everything that is too low to stand in moved out of the way as far as it goes:
/// ceilings up (doors), then floors down. Cells and visibility do not change with it, if doors count
/// as open.
pub fn opened(level: &Level, person: &Person) -> Level {
    let mut level = level.clone();
    for sector in &mut level.sectors {
        let low = |ceiling: f64, floor: f64| ceiling - floor < person.height;
        if low(sector.ceiling.rest, sector.floor.rest) {
            sector.ceiling.rest = sector.ceiling.high;
        }
        if low(sector.ceiling.rest, sector.floor.rest) {
            sector.floor.rest = sector.floor.low;
        }
    }
    level
}

/// Makes a tour that begins at the camera from which most sectors can be reached, the first of several
/// (in a map that names no rooms, at the first: the player's start), or else in the largest cell. `None` if nowhere there is room to stand.
pub fn tour(level: &Level, graph: &CellGraph, space: &Space, person: &Person) -> Option<Tour> {
    let ground = Ground::new(graph, space);
    let n_edges = space.edges.len() as u32;
    let gates = (0..n_edges).map(|e| pass((level, graph, space), person, e));
    let gates: Vec<Result<(), Barrier>> = gates.collect();
    let flat = person.step * FLAT;
    let objects = level.scene.objects.iter();
    let things = objects.filter_map(|o| footprint(o, &ground, person.height, flat));
    let passes = gates.iter().map(Result::is_ok).collect();
    let clearance = Clearance::new(space, passes, things.collect(), person.radius);
    let net = Net::new(graph, space, &clearance, person);
    let n_sectors = level.sectors.len().max(1);
    let sector = |cell: u32| {
        graph.cells[cell as usize]
            .sector
            .map_or(0, |s| s.0 as usize)
    };
    let sectors: Vec<usize> = net.places.iter().map(|p| sector(p.cell)).collect();
    let start = start(level, graph, &net, &ground, &sectors)?;
    let (part, n_parts) = parts(&net, start);
    let chain = chain(&net, &part, n_parts, &sectors);
    let mut on_chain = vec![false; n_parts as usize];
    chain.iter().for_each(|&p| on_chain[p as usize] = true);
    let goals = stops::goals(&net, &part, &chain, &sectors, n_sectors);
    let mut stops = vec![start];
    for (i, &number) in chain.iter().enumerate() {
        let here = Part {
            net: &net,
            part: &part,
            number,
        };
        stops::visit(&here, &goals, &sectors, &mut stops);
        if let Some(&next) = chain.get(i + 1) {
            // On to the nearest place of the next part.
            let from = stops[stops.len() - 1];
            let allowed = |p: u32| [number, next].contains(&part[p as usize]);
            let over = ways(&net, from, allowed, |p| part[p as usize] == next);
            stops.push(over.end);
        }
    }
    let allowed = |p: u32| part[p as usize] != NONE && on_chain[part[p as usize] as usize];
    let mut plan = Vec::new();
    let mut seen = Vec::new();
    let mut exact = Vec::new();
    for _ in 0..ROUNDS {
        let legs = stops
            .windows(2)
            .map(|pair| ways(&net, pair[0], allowed, |p| p == pair[1]).to(pair[1]));
        let legs: Vec<Vec<u32>> = legs.collect();
        let stop = |p: u32| Corner::stop(net.place(p).at, exact.contains(&p));
        let mut corners = vec![stop(start)];
        for (leg, &end) in legs.iter().zip(&stops[1..]) {
            corners.extend(taut::pull(&net, &clearance, leg, person.radius));
            corners.push(stop(end));
        }
        plan = taut::round(&clearance, &corners, person.radius);
        seen = passed(space, net.place(start).cell, &plan, &sector);
        let missing = (goals.iter().flatten()).filter(|g| !seen.contains(&sectors[**g as usize]));
        let missing: Vec<u32> = missing.copied().collect();
        if missing.is_empty() {
            break;
        }
        exact.extend(stops::insert(
            &net, allowed, &mut stops, &legs, &sectors, missing,
        ));
    }
    let points = rise::over(&ground, &plan, false, person.eye, person.radius * 2.0);
    let visits: Vec<SectorId> = (seen.iter())
        .filter(|s| **s < level.sectors.len())
        .map(|&s| SectorId(s as u32))
        .collect();
    let mut beyond = vec![false; n_sectors];
    let reached = (0..net.places.len()).filter(|&p| part[p] != NONE);
    reached.for_each(|p| beyond[sectors[p]] = true);
    let missed = missed(level, graph, space, &gates, &visits, &beyond);
    Some(Tour {
        points,
        visits,
        missed,
        person: *person,
    })
}

/// The place to start from.
fn start(
    level: &Level,
    graph: &CellGraph,
    net: &Net,
    ground: &Ground,
    sectors: &[usize],
) -> Option<u32> {
    let nearest = |at: DVec2, cell: u32| {
        let own = (0..).zip(&net.places).filter(|(_, p)| p.cell == cell);
        let off = |p: &Place| p.at.distance_squared(at);
        own.min_by(|(_, p), (_, q)| off(p).total_cmp(&off(q)))
            .map(|(i, _)| i)
    };
    let mut by_cameras = level.scene.cameras.iter().filter_map(|camera| {
        let at = camera.eye.truncate();
        nearest(at, ground.cell_at(at)?.0)
    });
    if level.interior == Interior::Sides {
        if let Some(first) = by_cameras.next() {
            return Some(first);
        }
    } else {
        let mut known: Vec<(u32, Vec<u32>)> = Vec::new();
        for place in by_cameras {
            // Whoever starts where another can come to and from reaches the same.
            if !known.iter().any(|(_, part)| part[place as usize] == 0) {
                known.push((place, parts(net, place).0));
            }
        }
        let count = |part: &[u32]| {
            let mut seen = vec![false; level.sectors.len().max(1)];
            let reached = (part.iter().zip(sectors)).filter(|(p, _)| **p != NONE);
            reached.for_each(|(_, &s)| seen[s] = true);
            seen.into_iter().filter(|s| *s).count()
        };
        // The last of the largest from behind is the first.
        let most = known.iter().rev().max_by_key(|(_, part)| count(part));
        if let Some((place, _)) = most {
            return Some(*place);
        }
    }
    let largest = graph
        .cell_ids()
        .filter(|c| net.places.iter().any(|p| p.cell == c.0))
        .max_by(|&a, &b| graph.area(a).total_cmp(&graph.area(b)))?;
    let middle = graph.polygon(largest);
    let n = middle.len() as f64;
    let sum: DVec2 = middle.iter().map(|&v| graph.vertices.approx(v)).sum();
    let at = graph.grid.offset_to_level(sum.x / n, sum.y / n);
    nearest(at, largest.0)
}

/// The parts to go through, one after the other: the way down with most sectors.
fn chain(net: &Net, part: &[u32], n_parts: u32, sectors: &[usize]) -> Vec<u32> {
    let n = n_parts as usize;
    let mut own = vec![Vec::new(); n];
    let mut next = vec![Vec::new(); n];
    for (place, &p) in part.iter().enumerate().filter(|(_, p)| **p != NONE) {
        own[p as usize].push(sectors[place]);
        for step in net.moves(place as u32) {
            let q = part[step.to as usize];
            if q != p {
                next[p as usize].push(q);
            }
        }
    }
    let mut best: Vec<(usize, Option<u32>)> = vec![(0, None); n];
    for p in (0..n).rev() {
        own[p].sort_unstable();
        own[p].dedup();
        let (mut most, mut to) = (0, None);
        next[p].sort_unstable();
        next[p].dedup();
        for &q in &next[p] {
            if best[q as usize].0 > most {
                (most, to) = (best[q as usize].0, Some(q));
            }
        }
        best[p] = (most + own[p].len(), to);
    }
    let mut chain = vec![0];
    while let Some(to) = best[chain[chain.len() - 1] as usize].1 {
        chain.push(to);
    }
    chain
}

/// The sectors that a line passes through, in order.
fn passed(space: &Space, first: u32, plan: &[DVec2], sector: &impl Fn(u32) -> usize) -> Vec<usize> {
    let mut seen = vec![sector(first)];
    let mut cell = first;
    for pair in plan.windows(2) {
        let end = cross(space, cell, [pair[0], pair[1]], |_, edge| {
            let beyond = sector(space.edge(edge.twin).cell);
            if seen.last() != Some(&beyond) {
                seen.push(beyond);
            }
            true
        });
        cell = end.unwrap_or(cell);
    }
    let mut once = Vec::new();
    for s in seen {
        if !once.contains(&s) {
            once.push(s);
        }
    }
    once
}

/// The sectors not visited, with what keeps one from them: at the border of what is visited, what is
/// least in the way there; farther off, what keeps one from the sector before.
fn missed(
    level: &Level,
    graph: &CellGraph,
    space: &Space,
    gates: &[Result<(), Barrier>],
    visits: &[SectorId],
    beyond: &[bool],
) -> Vec<(SectorId, Barrier)> {
    let n = level.sectors.len();
    let mut reason: Vec<Option<Barrier>> = vec![None; n];
    let mut visited = vec![false; n];
    visits.iter().for_each(|s| visited[s.0 as usize] = true);
    // What lies on the other side of each edge, walls included.
    let mut sides = rustc_hash::FxHashMap::default();
    for (e, edge) in space.edges.iter().enumerate() {
        sides.insert((edge.from, edge.to), e);
    }
    let sector = |cell: u32| graph.cells[cell as usize].sector.map(|s| s.0 as usize);
    let mut borders: Vec<Vec<(usize, usize)>> = vec![Vec::new(); n];
    for (e, edge) in space.edges.iter().enumerate() {
        let Some(&other) = sides.get(&(edge.to, edge.from)) else {
            continue;
        };
        let (a, b) = (sector(edge.cell), sector(space.edge(other as u32).cell));
        if let (Some(a), Some(b)) = (a, b)
            && a != b
            && gates[e] != Err(Barrier::Wall)
        {
            borders[a].push((e, b));
        }
    }
    let mut queue: std::collections::VecDeque<usize> = (0..n).filter(|&s| visited[s]).collect();
    while let Some(from) = queue.pop_front() {
        for &(e, to) in &borders[from] {
            if visited[to] {
                continue;
            }
            let here = match (reason[from], gates[e]) {
                (Some(before), _) => before,
                (None, Err(barrier)) => barrier,
                (None, Ok(())) if beyond[to] => Barrier::NoWayBack,
                (None, Ok(())) => Barrier::Narrow,
            };
            let better =
                reason[to].is_none_or(|known| reason[from].is_none() && rank(&here) < rank(&known));
            if better {
                if reason[to].is_none() {
                    queue.push_back(to);
                }
                reason[to] = Some(here);
            }
        }
    }
    let mut present = vec![false; n];
    for cell in &graph.cells {
        if let Some(s) = cell.sector {
            present[s.0 as usize] = true;
        }
    }
    (0..n)
        .filter(|&s| present[s] && !visited[s])
        .map(|s| (SectorId(s as u32), reason[s].unwrap_or(Barrier::Wall)))
        .collect()
}

/// Least for what is least in the way.
fn rank(barrier: &Barrier) -> u32 {
    match barrier {
        Barrier::NoWayBack => 0,
        Barrier::Narrow => 1,
        Barrier::Door => 2,
        Barrier::Step(_) => 3,
        Barrier::Drop(_) => 4,
        Barrier::Low(_) => 5,
        Barrier::Window => 6,
        Barrier::Wall => 7,
    }
}
