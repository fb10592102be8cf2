//! Inside and outside: which cells of a mesh belong to the level, and to which sector.
//!
//! Cells that no wall parts form a *face* of the arrangement; a face gets one label, by the level's
//! [`Interior`] rule, so all subdivisions of a level label the same ground alike.

use std::collections::BTreeMap;

use super::arrangement::{Arrangement, Cover, Piece};
use super::locate::contains;
use super::mesh::{HalfEdge, Mesh};
use crate::geom::Vertex;
use crate::level::{Finding, Interior, Level, OutlineId, SectorId, Severity};

/// What a cell of a mesh is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Label {
    /// Whether it belongs to the level.
    pub inside: bool,
    /// Its sector; `None` outside, and where the level has no sectors.
    pub sector: Option<SectorId>,
    /// Further sectors that walls name for this ground (a defect of the level), ascending. Another
    /// program may well take one of these for its sector.
    pub also: Vec<SectorId>,
}

/// Labels every cell; the findings say where the level contradicts itself.
pub fn label(level: &Level, arrangement: &Arrangement, mesh: &Mesh) -> (Vec<Label>, Vec<Finding>) {
    match &level.interior {
        Interior::Sides => by_sides(level, arrangement, mesh),
        Interior::Outlines => (by_outlines(level, arrangement, mesh), Vec::new()),
        Interior::Enclosed { starts } => {
            let starts: Vec<Vertex> = starts
                .iter()
                .map(|&p| arrangement.frame.enter(p).into())
                .collect();
            (by_enclosure(level, arrangement, mesh, &starts), Vec::new())
        }
    }
}

/// Joins cells into faces. The last element stands for the unbounded outside.
struct Faces {
    parent: Vec<u32>,
}

impl Faces {
    /// Joins neighbouring cells unless `parted` by the piece between them.
    fn new(arrangement: &Arrangement, mesh: &Mesh, parted: impl Fn(&Piece) -> bool) -> Self {
        let outside = mesh.n_cells() as u32;
        let mut faces = Faces {
            parent: (0..=outside).collect(),
        };
        for edge in &mesh.edges {
            if edge.piece.is_none_or(|p| !parted(arrangement.piece(p))) {
                let other = edge.twin.map_or(outside, |t| mesh.edges[t as usize].cell);
                let (a, b) = (faces.find(edge.cell), faces.find(other));
                faces.parent[a.max(b) as usize] = a.min(b);
            }
        }
        faces
    }

    fn find(&mut self, mut cell: u32) -> u32 {
        while self.parent[cell as usize] != cell {
            let up = self.parent[cell as usize];
            self.parent[cell as usize] = self.parent[up as usize];
            cell = up;
        }
        cell
    }

    fn outside(&mut self) -> u32 {
        self.find(self.parent.len() as u32 - 1)
    }
}

/// What the sides of the walls around a face name.
#[derive(Clone, Copy, PartialEq)]
enum Said {
    Nothing,
    /// All the same sector, or all none.
    All(Option<SectorId>),
    Mixed,
}

/// Doom: the sides of the walls around a face name its sector. Sides that disagree are outvoted by
/// length, and reported.
fn by_sides(level: &Level, arrangement: &Arrangement, mesh: &Mesh) -> (Vec<Label>, Vec<Finding>) {
    let mut faces = Faces::new(arrangement, mesh, |_| true);
    let outside = faces.outside();
    let named_at =
        |edge: &HalfEdge, cover: &Cover| arrangement.named_sector(level, cover, edge.left_of_piece);
    let covers_at = |edge: &HalfEdge| match edge.piece {
        Some(piece) => arrangement.covers(arrangement.piece(piece)),
        None => &[],
    };
    // What the walls around each face say; nearly always they agree.
    let mut said: Vec<Said> = vec![Said::Nothing; mesh.n_cells() + 1];
    for edge in &mesh.edges {
        let face = &mut said[faces.find(edge.cell) as usize];
        for cover in covers_at(edge) {
            let named = named_at(edge, cover);
            *face = match *face {
                Said::Nothing => Said::All(named),
                Said::All(sector) if sector == named => *face,
                _ => Said::Mixed,
            };
        }
    }
    if let Said::All(Some(_)) = said[outside as usize] {
        said[outside as usize] = Said::Mixed;
    }
    // For the others, per named sector (None: the back of a one-sided wall): the length that names
    // it, and the walls.
    type Votes = BTreeMap<Option<SectorId>, (f64, Vec<Cover>)>;
    let mut votes: BTreeMap<u32, Votes> = BTreeMap::new();
    for (i, edge) in mesh.edges.iter().enumerate() {
        let face = faces.find(edge.cell);
        if said[face as usize] != Said::Mixed {
            continue;
        }
        let p = arrangement.vertices.get(edge.origin).approx();
        let length = p.distance(arrangement.vertices.get(mesh.end(i)).approx());
        for cover in covers_at(edge) {
            let vote = votes
                .entry(face)
                .or_default()
                .entry(named_at(edge, cover))
                .or_default();
            vote.0 += length;
            vote.1.push(*cover);
        }
    }
    let place = |c: &Cover| level.walls[c.wall.0 as usize].place;
    let (mut disputed, mut backs, mut leaks) = (Vec::new(), Vec::new(), Vec::new());
    let mut labels: BTreeMap<u32, Label> = BTreeMap::new();
    for (&face, votes) in &votes {
        if face == outside {
            for (_, (_, covers)) in votes.iter().filter(|(named, _)| named.is_some()) {
                leaks.extend(covers.iter().map(place));
            }
            continue;
        }
        let mut ranked: Vec<_> = votes
            .iter()
            .filter_map(|(named, v)| Some(((*named)?, v)))
            .collect();
        // Longest first; the smaller number first where lengths are equal.
        ranked.sort_by(|a, b| b.1.0.total_cmp(&a.1.0).then(a.0.cmp(&b.0)));
        let Some(&(sector, _)) = ranked.first() else {
            continue;
        };
        let mut also: Vec<SectorId> = ranked[1..].iter().map(|r| r.0).collect();
        also.sort();
        for (_, (_, covers)) in &ranked[1..] {
            disputed.extend(covers.iter().map(place));
        }
        if let Some((_, covers)) = votes.get(&None) {
            backs.extend(covers.iter().map(place));
        }
        labels.insert(
            face,
            Label {
                inside: true,
                sector: Some(sector),
                also,
            },
        );
    }
    let labels = (0..mesh.n_cells() as u32)
        .map(|cell| {
            let face = faces.find(cell);
            match said[face as usize] {
                Said::All(sector) => Label {
                    inside: sector.is_some(),
                    sector,
                    also: Vec::new(),
                },
                _ => labels.get(&face).cloned().unwrap_or_default(),
            }
        })
        .collect();
    let mut findings = Vec::new();
    let mut find = |code, severity, message: &str, mut places: Vec<_>| {
        places.dedup();
        findings.extend(Finding::at(code, severity, message, places));
    };
    find(
        "disputed-sector",
        Severity::Repaired,
        "These walls name another sector than most of the walls around the same ground; the \
         majority by length was taken.",
        disputed,
    );
    find(
        "back-inside",
        Severity::Warning,
        "The back of these one-sided walls faces ground that belongs to a sector; it was taken as \
         inside.",
        backs,
    );
    find(
        "leak",
        Severity::Warning,
        "A sector named by these walls is open to the unbounded outside; that side was taken as \
         outside.",
        leaks,
    );
    (labels, findings)
}

/// The outlines around each cell, ascending: crossing a wall enters or leaves those that it is an
/// edge of, and nothing is around the unbounded outside.
fn outlines_around(level: &Level, arrangement: &Arrangement, mesh: &Mesh) -> Vec<Vec<OutlineId>> {
    let mut within: Vec<Option<Vec<OutlineId>>> = vec![None; mesh.n_cells()];
    let crossing = |from: &[OutlineId], piece: Option<_>| -> Vec<OutlineId> {
        let mut set = from.to_vec();
        let covers = piece.map_or(&[][..], |p| arrangement.covers(arrangement.piece(p)));
        for id in covers
            .iter()
            .filter_map(|c| level.walls[c.wall.0 as usize].outline)
        {
            match set.binary_search(&id) {
                Ok(i) => _ = set.remove(i),
                Err(i) => set.insert(i, id),
            }
        }
        set
    };
    let mut queue: Vec<u32> = Vec::new();
    for edge in mesh.edges.iter().filter(|e| e.twin.is_none()) {
        if within[edge.cell as usize].is_none() {
            within[edge.cell as usize] = Some(crossing(&[], edge.piece));
            queue.push(edge.cell);
        }
    }
    while let Some(cell) = queue.pop() {
        let set = within[cell as usize].clone().expect("set when queued");
        for edge in &mesh.edges[mesh.range(cell as usize)] {
            let Some(twin) = edge.twin else { continue };
            let next = mesh.edges[twin as usize].cell as usize;
            if within[next].is_none() {
                within[next] = Some(crossing(&set, edge.piece));
                queue.push(next as u32);
            }
        }
    }
    within
        .into_iter()
        .map(|set| set.unwrap_or_default())
        .collect()
}

/// Rooms: the last outline around a place that is not a zone decides whether it is inside; the last
/// of all gives the sector.
fn by_outlines(level: &Level, arrangement: &Arrangement, mesh: &Mesh) -> Vec<Label> {
    let outline = |id: &OutlineId| &level.outlines[id.0 as usize];
    let label = |set: Vec<OutlineId>| {
        let inside = set
            .iter()
            .map(outline)
            .rfind(|o| !o.zone)
            .is_some_and(|o| o.sector.is_some());
        let sector = set
            .last()
            .map(outline)
            .and_then(|o| o.sector)
            .filter(|_| inside);
        Label {
            inside,
            sector,
            also: Vec::new(),
        }
    };
    outlines_around(level, arrangement, mesh)
        .into_iter()
        .map(label)
        .collect()
}

/// Plans: inside is what walls and openings part from the unbounded outside, and, given start
/// points, what can be reached from one of them without crossing an opaque wall. Inside an outline
/// without a sector (a pillar) is outside. The last zone around a place gives its sector, or else it
/// is the first one, if there is any.
fn by_enclosure(
    level: &Level,
    arrangement: &Arrangement,
    mesh: &Mesh,
    starts: &[Vertex],
) -> Vec<Label> {
    let sector = (!level.sectors.is_empty()).then_some(SectorId(0));
    let around = outlines_around(level, arrangement, mesh);
    let zone = |cell: u32| {
        let last = around[cell as usize].last()?;
        level.outlines[last.0 as usize].sector
    };
    let solid = |cell: u32| {
        let outline = |id: &OutlineId| &level.outlines[id.0 as usize];
        around[cell as usize]
            .iter()
            .map(outline)
            .any(|o| o.sector.is_none())
    };
    let mut faces = Faces::new(arrangement, mesh, |p| p.opaque || p.opening);
    let outside = faces.outside();
    let mut reach = Faces::new(arrangement, mesh, |p| p.opaque && !p.opening);
    let mut reached = Vec::new();
    for cell in 0..mesh.n_cells() {
        let corners = mesh.edges[mesh.range(cell)].iter();
        let corners: Vec<_> = corners
            .map(|e| arrangement.vertices.get(e.origin))
            .collect();
        if starts.iter().any(|start| contains(&corners, start)) {
            reached.push(reach.find(cell as u32));
        }
    }
    (0..mesh.n_cells() as u32)
        .map(|cell| {
            let enclosed = faces.find(cell) != outside && !solid(cell);
            let inside = enclosed && (starts.is_empty() || reached.contains(&reach.find(cell)));
            Label {
                inside,
                sector: zone(cell).or(sector).filter(|_| inside),
                also: Vec::new(),
            }
        })
        .collect()
}
