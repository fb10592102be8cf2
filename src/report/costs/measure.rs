//! What is in each cell, and what is in all that it sees.

use std::collections::HashMap;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cells::{CellGraph, EdgeId};
use crate::level::dress::Cover;
use crate::level::scene::MaterialId;
use crate::level::{Level, SectorId};
use crate::preview::Polygons;
use crate::pvs::Pvs;
use crate::trace::space::Space;

/// Things counted in one cell, or in several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Cells.
    pub cells: f64,
    /// Polygons to be drawn: walls, steps, lintels, floors, ceilings. 0 in a level without heights.
    pub polygons: f64,
    /// Walls, as edges of cells.
    pub walls: f64,
    /// Their length on the plan, in the level's unit.
    pub wall_length: f64,
    /// Ground, in square units.
    pub area: f64,
    /// Different materials, or textures; 0 in sums over several cells' own.
    pub materials: f64,
}

impl Tally {
    /// Adds all but materials, which may be the same ones.
    pub fn add(&mut self, other: &Tally) {
        self.cells += other.cells;
        self.polygons += other.polygons;
        self.walls += other.walls;
        self.wall_length += other.wall_length;
        self.area += other.area;
    }

    /// One of the counts; a sightline is none.
    pub fn get(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Cells => self.cells,
            Measure::Polygons => self.polygons,
            Measure::Walls => self.walls,
            Measure::WallLength => self.wall_length,
            Measure::Area => self.area,
            Measure::Materials => self.materials,
            Measure::Sightline => 0.0,
        }
    }
}

/// By what the cost of a place is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Polygons that it sees.
    Polygons,
    /// Cells that it sees.
    Cells,
    /// Walls that it sees.
    Walls,
    /// Their length.
    WallLength,
    /// The area of the cells that it sees.
    Area,
    /// Materials or textures that it sees.
    Materials,
    /// The distance of the farthest point seen from one of its corners.
    Sightline,
}

impl Measure {
    /// All of them.
    pub const ALL: [Measure; 7] = [
        Measure::Polygons,
        Measure::Cells,
        Measure::Area,
        Measure::Sightline,
        Measure::Walls,
        Measure::WallLength,
        Measure::Materials,
    ];

    /// The name in JSON and in the page's data.
    pub fn key(self) -> &'static str {
        match self {
            Measure::Polygons => "polygons",
            Measure::Cells => "cells",
            Measure::Walls => "walls",
            Measure::WallLength => "wall_length",
            Measure::Area => "area",
            Measure::Materials => "materials",
            Measure::Sightline => "sightline",
        }
    }

    /// What people call it.
    pub fn title(self) -> &'static str {
        match self {
            Measure::Polygons => "Visible polygons",
            Measure::Cells => "Visible cells",
            Measure::Walls => "Visible walls",
            Measure::WallLength => "Visible wall length",
            Measure::Area => "Visible area",
            Measure::Materials => "Visible materials",
            Measure::Sightline => "Longest sightline",
        }
    }

    /// Whether it is a whole number.
    pub fn is_count(self) -> bool {
        !matches!(
            self,
            Measure::WallLength | Measure::Area | Measure::Sightline
        )
    }
}

/// How a figure is distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Least.
    pub least: f64,
    /// Median.
    pub median: f64,
    /// Mean.
    pub mean: f64,
    /// Nine in ten are not above.
    pub ninth: f64,
    /// Most.
    pub most: f64,
}

impl Spread {
    /// Of some numbers; 0 of none.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let n = values.len();
        if n == 0 {
            return Self::default();
        }
        Self {
            least: values[0],
            median: values[n / 2],
            mean: values.iter().sum::<f64>() / n as f64,
            ninth: values[(n * 9).div_ceil(10) - 1],
            most: values[n - 1],
        }
    }
}

/// What is in each cell.
pub fn own(level: &Level, graph: &CellGraph) -> Vec<Tally> {
    let polygons = (!level.sectors.is_empty()).then(|| Polygons::of(&Space::new(level, graph)));
    let step = graph.grid.step;
    let unit = step.to_units(1.0);
    let ids = graph.cell_ids();
    let tally = |cell| {
        let mut tally = Tally {
            cells: 1.0,
            polygons: polygons.as_ref().map_or(0, |p| p.in_cell(cell).len()) as f64,
            ..Tally::default()
        };
        let origin = graph.corners(cell).next().map(|v| graph.vertices.approx(v));
        let origin = origin.unwrap_or_default();
        for e in graph.edge_range(cell).map(EdgeId) {
            let [p, q] = [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.approx(v));
            tally.area += (p - origin).perp_dot(q - origin) / 2.0 * unit * unit;
            if graph.edge(e).twin().is_none() {
                tally.walls += 1.0;
                tally.wall_length += step.to_units(p.distance(q));
            }
        }
        tally
    };
    let mut own: Vec<Tally> = ids.map(tally).collect();
    for (tally, worn) in own.iter_mut().zip(worn(level, graph)) {
        tally.materials = worn.len() as f64;
    }
    own
}

/// What each cell sees, itself included.
pub fn seen(level: &Level, graph: &CellGraph, pvs: &Pvs, own: &[Tally]) -> Vec<Tally> {
    let worn = worn(level, graph);
    let most = worn.iter().flatten().max().map_or(0, |&m| m as usize + 1);
    let sum = |marks: &mut Vec<bool>, cell: usize| {
        let mut sum = Tally::default();
        let mut different = 0;
        marks.fill(false);
        for other in pvs.visible.ones(cell) {
            sum.add(&own[other]);
            for &m in &worn[other] {
                different += u32::from(!std::mem::replace(&mut marks[m as usize], true));
            }
        }
        sum.materials = f64::from(different);
        sum
    };
    (0..graph.cells.len())
        .into_par_iter()
        .with_min_len(16)
        .map_init(|| vec![false; most], sum)
        .collect()
}

/// Numbers of the materials, or textures, in each cell, each once.
fn worn(level: &Level, graph: &CellGraph) -> Vec<Vec<u32>> {
    let mut numbers: HashMap<Worn, u32> = HashMap::new();
    let mut cells = Vec::with_capacity(graph.cells.len());
    let dress = &level.scene.dress;
    for cell in graph.cell_ids() {
        let mut list: Vec<Worn> = Vec::new();
        if let Some(sector) = graph.cell(cell).sector {
            flats(level, sector, &mut list);
        }
        for e in graph.edge_range(cell).map(EdgeId) {
            let Some(id) = graph.edge(e).wall() else {
                continue;
            };
            let wall = &level.walls[id.0 as usize];
            list.extend(wall.material.map(Worn::Material));
            let Some(line) = dress.line_of(wall) else {
                continue;
            };
            let [p, q] = [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.approx(v));
            // The cell lies on the left of its edge.
            let with_line = (q - p).dot(line.to - line.from) > 0.0;
            if let Some(side) = &line.sides[usize::from(!with_line)] {
                let hanging = [side.upper, side.middle, side.lower];
                list.extend(hanging.iter().flatten().map(|h| Worn::Picture(h.picture.0)));
            }
        }
        let mut found: Vec<u32> = list
            .into_iter()
            .map(|w| {
                let next = numbers.len() as u32;
                *numbers.entry(w).or_insert(next)
            })
            .collect();
        found.sort_unstable();
        found.dedup();
        cells.push(found);
    }
    cells
}

/// Something that surfaces wear.
#[derive(PartialEq, Eq, Hash)]
enum Worn<'a> {
    Material(MaterialId),
    Picture(u32),
    Named(&'a str),
}

fn flats<'a>(level: &'a Level, sector: SectorId, list: &mut Vec<Worn<'a>>) {
    let dress = &level.scene.dress;
    if !dress.is_empty() {
        for cover in [dress.floor(sector), dress.ceiling(sector)] {
            if let Cover::Picture(p, _) = cover {
                list.push(Worn::Picture(p.0));
            }
        }
        return;
    }
    let Some(sector) = level.sectors.get(sector.0 as usize) else {
        return;
    };
    for name in [&sector.floor_material, &sector.ceiling_material] {
        let Some(name) = name else { continue };
        let known = level.scene.materials.iter().position(|m| m.name == *name);
        list.push(match known {
            Some(i) => Worn::Material(MaterialId(i as u32)),
            None => Worn::Named(name),
        });
    }
}
