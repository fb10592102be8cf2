//! A level's walls and openings as other programs want them: each stretch once, walls cut where
//! openings are.
//!
//! In: a [`Level`]. Out: [`Lines`] whose ends are grid points. In a level, two rooms side by side both
//! have the wall between them, and an opening lies on both; a drawing has it once, with a gap for the
//! opening. Together they stop sight where the level's walls do, and nowhere else.
//!
//! What leads out of the level (a window to the outside) stops sight, too; it is drawn as what it is,
//! but for archways, which have nothing that could be drawn: those are walls here.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::cells::{CellGraph, EdgeId};
use crate::geom::{GridPoint, Line};
use crate::level::{Level, Opening, OpeningStyle, Wall, WallKind, outline};

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Stops sight.
    Wall,
    /// A door, open or closed.
    Door,
    /// A window.
    Window,
    /// An opening without a leaf.
    Archway,
    /// A change of sector that stops nothing.
    Step,
}

/// A straight line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// What it is.
    pub kind: Kind,
    /// Its two ends.
    pub ends: [GridPoint; 2],
    /// The name of an opening, if it has one.
    pub name: Option<String>,
    /// Whether a leaf stands closed here.
    pub shut: bool,
}

/// All lines of a level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// In order of kind, line and place.
    pub drawn: Vec<Drawn>,
    /// The corners of solids: places inside of the level that do not belong to it.
    pub solids: Vec<Vec<GridPoint>>,
}

impl Lines {
    /// The lines of one kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &Drawn> {
        self.drawn.iter().filter(move |line| line.kind == kind)
    }

    /// The lower left and upper right corner of all there is; `None` where there is nothing.
    pub fn extent(&self) -> Option<[GridPoint; 2]> {
        let points = self.drawn.iter().flat_map(|line| line.ends);
        points.map(|p| [p, p]).reduce(|[low, high], [p, _]| {
            [
                GridPoint::new(low.x.min(p.x), low.y.min(p.y)),
                GridPoint::new(high.x.max(p.x), high.y.max(p.y)),
            ]
        })
    }

    /// The lines of one kind as chains of points, each line in one of them: fewer, longer lines for
    /// formats that have such. Chains end where more than two lines meet.
    pub fn chains(&self, kind: Kind) -> Vec<Vec<GridPoint>> {
        let lines: Vec<[GridPoint; 2]> = self.of(kind).map(|line| line.ends).collect();
        let mut at: BTreeMap<GridPoint, Vec<usize>> = BTreeMap::new();
        for (i, ends) in lines.iter().enumerate() {
            for &end in ends {
                at.entry(end).or_default().push(i);
            }
        }
        let mut used = vec![false; lines.len()];
        let mut chains = Vec::new();
        // From ends and junctions first; what is left goes in circles.
        for circles in [false, true] {
            for first in 0..lines.len() {
                for start in lines[first] {
                    if used[first] || (!circles && at[&start].len() == 2) {
                        continue;
                    }
                    let (mut chain, mut i) = (vec![start], first);
                    let mut end = start;
                    loop {
                        used[i] = true;
                        let [a, b] = lines[i];
                        end = if a == end { b } else { a };
                        chain.push(end);
                        let there = &at[&end];
                        match there.iter().find(|&&next| !used[next]) {
                            Some(&next) if there.len() == 2 => i = next,
                            _ => break,
                        }
                    }
                    chains.push(chain);
                }
            }
        }
        chains
    }

    /// Gathers the lines of a level. `graph` tells which archways lead out of it.
    pub fn of_level(level: &Level, graph: &CellGraph) -> Self {
        let mut by_line: BTreeMap<Line, Vec<(usize, [GridPoint; 2])>> = BTreeMap::new();
        for (i, wall) in level.walls.iter().enumerate() {
            let line = Line::through(wall.from, wall.to).expect("walls have two different ends");
            // Lines point right, or straight up.
            let ends = [wall.from.min(wall.to), wall.from.max(wall.to)];
            by_line.entry(line).or_default().push((i, ends));
        }
        let leads_in = leading_in(level, graph);
        let void = |wall: &Wall| {
            let outline = wall
                .outline
                .and_then(|id| level.outlines.get(id.0 as usize));
            outline.is_some_and(|o| o.sector.is_none())
        };
        let mut drawn = Vec::new();
        for walls in by_line.values() {
            let mut stops: Vec<GridPoint> = walls.iter().flat_map(|(_, ends)| *ends).collect();
            stops.sort_unstable();
            stops.dedup();
            for stretch in stops.windows(2) {
                let covers = walls
                    .iter()
                    .filter(|(_, [from, to])| *from <= stretch[0] && stretch[1] <= *to);
                let covers: Vec<usize> = covers.map(|(i, _)| *i).collect();
                let all_void = covers.iter().all(|&i| void(&level.walls[i]));
                if covers.is_empty() || all_void {
                    continue;
                }
                let line = stretch_of(level, &covers, &leads_in, [stretch[0], stretch[1]]);
                let Some(line) = line else { continue };
                match drawn.last_mut() {
                    Some(Drawn {
                        kind,
                        ends,
                        name,
                        shut,
                    }) if ends[1] == line.ends[0]
                        && Line::through(ends[0], line.ends[1])
                            == Line::through(line.ends[0], line.ends[1])
                        && (*kind, &*name, *shut) == (line.kind, &line.name, line.shut) =>
                    {
                        ends[1] = line.ends[1];
                    }
                    _ => drawn.push(line),
                }
            }
        }
        drawn.sort_by_key(|line| line.kind);
        let outlines = level.outlines.iter().zip(outline::corners(level));
        let solids = outlines.filter(|(o, _)| o.sector.is_none());
        Self {
            drawn,
            solids: solids.filter_map(|(_, corners)| corners).collect(),
        }
    }

    /// The lines of cells whose level is not at hand: walls, and nothing that is known of openings. Ends
    /// that lie on no grid point are left as they are, so these are in the level's own coordinates.
    pub fn of_cells(graph: &CellGraph) -> Vec<[DVec2; 2]> {
        let wall = |i: u32| {
            let id = EdgeId(i);
            let open = graph.edge(id).twin().is_some();
            let ends = [graph.edge(id).origin, graph.end(id)];
            (!open).then(|| ends.map(|v| graph.vertices.exact(v).to_level(&graph.grid)))
        };
        (0..graph.edges.len() as u32).filter_map(wall).collect()
    }
}

/// Of each wall, whether cells lie on both sides of a part of it that is open.
fn leading_in(level: &Level, graph: &CellGraph) -> Vec<bool> {
    let mut leads_in = vec![false; level.walls.len()];
    for edge in graph.edges.iter().filter(|edge| edge.twin().is_some()) {
        if let Some(wall) = edge.wall() {
            leads_in[wall.0 as usize] = true;
        }
    }
    leads_in
}

/// What a stretch is on which these walls lie.
fn stretch_of(
    level: &Level,
    covers: &[usize],
    leads_in: &[bool],
    ends: [GridPoint; 2],
) -> Option<Drawn> {
    let walls = || covers.iter().map(|&i| (i, &level.walls[i]));
    let plain = |kind| Drawn {
        kind,
        ends,
        name: None,
        shut: false,
    };
    if walls().any(|(_, wall)| wall.kind == WallKind::Solid) {
        return Some(plain(Kind::Wall));
    }
    let opening = walls().find_map(|(i, wall)| match &wall.kind {
        WallKind::Opening(opening) => Some((i, opening)),
        _ => None,
    });
    if let Some((i, opening)) = opening {
        return Some(drawn_opening(opening, leads_in[i], ends));
    }
    if walls().any(|(_, wall)| wall.kind == WallKind::Outline) {
        return Some(plain(Kind::Wall));
    }
    let idle = |wall: &Wall| wall.outline.is_none() && wall.left == wall.right;
    let (_, step) = walls().find(|(_, wall)| !idle(wall))?;
    let shut = step.kind == (WallKind::Edge { shut: true });
    Some(Drawn {
        shut,
        ..plain(Kind::Step)
    })
}

fn drawn_opening(opening: &Opening, leads_in: bool, ends: [GridPoint; 2]) -> Drawn {
    let kind = match opening.style {
        OpeningStyle::Door => Kind::Door,
        OpeningStyle::Window => Kind::Window,
        OpeningStyle::Archway if leads_in => Kind::Archway,
        OpeningStyle::Archway => Kind::Wall,
    };
    Drawn {
        kind,
        ends,
        name: opening.name.clone().filter(|_| kind != Kind::Wall),
        shut: opening.shut && kind != Kind::Wall,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;

    fn lines(text: &str) -> (Level, Lines) {
        let level = read(text.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let lines = Lines::of_level(&level, &graph);
        (level, lines)
    }

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
        [[pillar]]\nrect = [1, 1, 2, 2]\n\
        [[zone]]\nrect = [5, 1, 6, 2]\nfloor = 0.2\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\nname = \"D\"\n\
        [[window]]\npoints = [[0, 1], [0, 2]]\n\
        [[archway]]\npoints = [[8, 1], [8, 2]]\n";

    #[test]
    fn walls_are_there_once_and_have_gaps_for_openings() {
        let (level, lines) = lines(ROOMS);
        let at = |kind| -> Vec<[[f64; 2]; 2]> {
            let units = |p| level.grid.to_level(p).to_array();
            lines.of(kind).map(|line| line.ends.map(units)).collect()
        };
        let mut walls = at(Kind::Wall);
        walls.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(
            walls,
            [
                [[0.0, 0.0], [0.0, 1.0]],
                [[0.0, 0.0], [8.0, 0.0]],
                [[0.0, 2.0], [0.0, 4.0]],
                [[0.0, 4.0], [8.0, 4.0]],
                [[4.0, 0.0], [4.0, 1.5]],
                [[4.0, 2.5], [4.0, 4.0]],
                // An archway to the outside is a wall to whoever sees.
                [[8.0, 0.0], [8.0, 4.0]],
            ]
        );
        assert_eq!(at(Kind::Door), [[[4.0, 1.5], [4.0, 2.5]]]);
        assert_eq!(at(Kind::Window), [[[0.0, 1.0], [0.0, 2.0]]]);
        assert!(at(Kind::Archway).is_empty());
        assert_eq!(at(Kind::Step).len(), 4);
        let door = lines.of(Kind::Door).next().unwrap();
        assert_eq!((door.name.as_deref(), door.shut), (Some("D"), true));
        assert_eq!(lines.solids.len(), 1);
        assert_eq!(lines.solids[0].len(), 4);
    }

    #[test]
    fn chains_hold_every_line_once() {
        let (_, lines) = lines(ROOMS);
        let chains = lines.chains(Kind::Wall);
        let n: usize = chains.iter().map(|c| c.len() - 1).sum();
        assert_eq!(n, lines.of(Kind::Wall).count());
        assert!(chains.len() < n, "{chains:?}");
        // A circle closes.
        let (_, alone) = self::lines("[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n");
        let chains = alone.chains(Kind::Wall);
        assert_eq!((chains.len(), chains[0].len()), (1, 5));
        assert_eq!(chains[0].first(), chains[0].last());
    }
}
