//! The figures by room: designers think in rooms.

use serde::Serialize;

use super::Tally;
use crate::cells::CellGraph;
use crate::level::Level;
use crate::pvs::Pvs;

/// A room, zone or sector.
#[derive(Clone, Debug, Serialize)]
pub struct Room {
    /// Its name, or `sector 12`.
    pub name: String,
    /// Its number in the source.
    pub sector: Option<u32>,
    /// Its cells and what they hold.
    pub own: Tally,
    /// The mean of what its cells see, by ground: what somebody sees who stands anywhere in it.
    pub mean: Tally,
    /// The most that one of its cells sees, each figure by itself.
    pub most: Tally,
    /// The rooms that it sees, itself included: their index and the ordered pairs of cells, the one in
    /// this room and the other in that, that see each other.
    pub sees: Vec<(u32, u64)>,
}

/// All rooms that have cells, in the source's order; ground without a sector comes last.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Rooms {
    /// The rooms.
    pub list: Vec<Room>,
    /// Of each cell, its room.
    #[serde(skip)]
    pub of_cell: Vec<u32>,
}

impl Rooms {
    /// The rooms of a level.
    pub fn of(level: &Level, graph: &CellGraph, pvs: &Pvs, own: &[Tally], seen: &[Tally]) -> Self {
        let key = |cell| graph.cell(cell).sector.map_or(u32::MAX, |s| s.0);
        let mut keys: Vec<u32> = graph.cell_ids().map(key).collect();
        keys.sort_unstable();
        keys.dedup();
        let of_cell: Vec<u32> = graph
            .cell_ids()
            .map(|cell| keys.partition_point(|&k| k < key(cell)) as u32)
            .collect();
        let mut list: Vec<Room> = keys
            .iter()
            .map(|&k| Room {
                name: match level.sectors.get(k as usize) {
                    None => "no sector".to_string(),
                    Some(s) => s.name.clone().unwrap_or_else(|| format!("sector {k}")),
                },
                sector: (k != u32::MAX).then_some(k),
                own: Tally::default(),
                mean: Tally::default(),
                most: Tally::default(),
                sees: Vec::new(),
            })
            .collect();
        let mut cells: Vec<Vec<usize>> = vec![Vec::new(); list.len()];
        for (cell, &room) in of_cell.iter().enumerate() {
            cells[room as usize].push(cell);
        }
        let mut pairs = vec![0u64; list.len()];
        for (room, cells) in list.iter_mut().zip(&cells) {
            for &cell in cells {
                room.own.add(&own[cell]);
                let weight = own[cell].area;
                each(&mut room.mean, &seen[cell], |sum, x| sum + x * weight);
                each(&mut room.most, &seen[cell], f64::max);
                for other in pvs.visible.ones(cell) {
                    pairs[of_cell[other] as usize] += 1;
                }
            }
            let area = room.own.area;
            let zero = Tally::default();
            each(&mut room.mean, &zero, |sum, _| sum / area);
            let counts = (0u32..).zip(&mut pairs).filter(|(_, n)| **n > 0);
            room.sees = counts.map(|(k, n)| (k, std::mem::take(n))).collect();
        }
        Rooms { list, of_cell }
    }

    /// Ordered pairs of cells of two rooms that see each other.
    pub fn pairs(&self, from: usize, to: usize) -> u64 {
        let sees = &self.list[from].sees;
        let at = sees.binary_search_by_key(&(to as u32), |s| s.0);
        at.map_or(0, |i| sees[i].1)
    }
}

/// Combines each figure of one tally with that of another.
fn each(tally: &mut Tally, other: &Tally, combine: impl Fn(f64, f64) -> f64) {
    let Tally {
        cells,
        polygons,
        walls,
        wall_length,
        area,
        materials,
    } = tally;
    for (mine, theirs) in [
        (cells, other.cells),
        (polygons, other.polygons),
        (walls, other.walls),
        (wall_length, other.wall_length),
        (area, other.area),
        (materials, other.materials),
    ] {
        *mine = combine(*mine, theirs);
    }
}
