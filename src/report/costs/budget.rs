//! Limits that a level promises to keep, and whether it does.

use serde::Serialize;

use super::{Costs, Measure};
use crate::cells::CellId;
use crate::level::scene::Budget;
use crate::report::wording;

/// A limit, and what it is compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The limit's name, as in the level file: `max_visible_cells`.
    pub name: &'static str,
    /// The limit.
    pub limit: f64,
    /// What the level has.
    pub value: f64,
    /// Whether that is within the limit.
    pub kept: bool,
    /// Cells over the limit, where it is one for each cell; the worst first.
    pub cells: Vec<u32>,
}

/// The limits of `own` with those of `first` in their place where there are any.
pub fn joined(first: &Budget, own: &Budget) -> Budget {
    Budget {
        max_visible_cells: first.max_visible_cells.or(own.max_visible_cells),
        max_visible_polygons: first.max_visible_polygons.or(own.max_visible_polygons),
        max_visible_walls: first.max_visible_walls.or(own.max_visible_walls),
        max_mean_visible_cells: first.max_mean_visible_cells.or(own.max_mean_visible_cells),
        max_mean_visible_polygons: first
            .max_mean_visible_polygons
            .or(own.max_mean_visible_polygons),
        max_sightline: first.max_sightline.or(own.max_sightline),
        max_density: first.max_density.or(own.max_density),
    }
}

/// Compares a level with its limits.
pub fn check(costs: &Costs, budget: &Budget) -> Vec<Check> {
    let mut checks = Vec::new();
    for (name, limit, measure) in [
        (
            "max_visible_cells",
            budget.max_visible_cells,
            Measure::Cells,
        ),
        (
            "max_visible_polygons",
            budget.max_visible_polygons,
            Measure::Polygons,
        ),
        (
            "max_visible_walls",
            budget.max_visible_walls,
            Measure::Walls,
        ),
    ] {
        let Some(limit) = limit else { continue };
        let limit = limit as f64;
        let value = |c: &CellId| costs.value(measure, *c);
        let mut over: Vec<CellId> = costs
            .graph
            .cell_ids()
            .filter(|c| value(c) > limit)
            .collect();
        over.sort_by(|a, b| value(b).total_cmp(&value(a)));
        checks.push(Check {
            name,
            limit,
            value: costs.spread(measure).most,
            kept: over.is_empty(),
            cells: over.into_iter().map(|c| c.0).collect(),
        });
    }
    let mean = |measure| costs.spread(measure).mean;
    for (name, limit, value) in [
        (
            "max_mean_visible_cells",
            budget.max_mean_visible_cells,
            mean(Measure::Cells),
        ),
        (
            "max_mean_visible_polygons",
            budget.max_mean_visible_polygons,
            mean(Measure::Polygons),
        ),
        (
            "max_sightline",
            budget.max_sightline,
            costs.longest_sightline(),
        ),
        ("max_density", budget.max_density, costs.pvs.density()),
    ] {
        let Some(limit) = limit else { continue };
        checks.push(Check {
            name,
            limit,
            value,
            kept: value <= limit,
            cells: Vec::new(),
        });
    }
    checks
}

impl Check {
    /// What it says in a log: `over budget: max_visible_cells 194 > 150 (12 cells, the worst is 31 in Hall)`.
    pub fn line(&self, costs: &Costs) -> String {
        let [value, limit] = [self.value, self.limit].map(number);
        if self.kept {
            return format!("within budget: {} {value} <= {limit}", self.name);
        }
        let mut line = format!("over budget: {} {value} > {limit}", self.name);
        if let Some(&worst) = self.cells.first() {
            let cell = CellId(worst);
            let at = wording::in_sector(costs.level, costs.graph, cell);
            let cells = wording::count(self.cells.len(), "cell");
            line += &format!(" ({cells}, the worst is cell {worst}{at})");
        }
        line
    }
}

/// Whole numbers as such, others with up to four digits.
fn number(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e15 {
        format!("{x:.0}")
    } else {
        wording::length(x)
    }
}
