//! What an eye sees, on the plan: the lecture's result (d).

use glam::DVec2;
use svg::node::element::{Circle, Group, Path};

use super::layers::Layers;
use super::palette;
use super::sheet::{PathData, Sheet, short};
use crate::cells::{CellGraph, CellId};
use crate::pvs::Pvs;
use crate::pvs::eye::Vista;

/// What an eye sees.
pub struct EyeView<'a> {
    /// Cells and area in view.
    pub vista: &'a Vista<'a>,
    /// Who sees whom.
    pub pvs: &'a Pvs,
    /// The middle of the view, in degrees.
    pub direction: f64,
    /// The angle of view in degrees; 360 is all around.
    pub fov: f64,
}

impl EyeView<'_> {
    /// Whether a cell is in the PVS of a cell that touches the eye.
    pub fn in_pvs(&self, cell: CellId) -> bool {
        let own = self.vista.own_cells();
        own.iter().any(|&own| self.pvs.sees(own, cell))
    }

    /// How many cells are.
    pub fn n_pvs(&self, graph: &CellGraph) -> usize {
        graph.cell_ids().filter(|&cell| self.in_pvs(cell)).count()
    }

    fn eye(&self) -> DVec2 {
        self.vista.eye().approx()
    }
}

/// The ground: cells in view blue, further cells of the PVS green.
pub fn cells(layers: &Layers, graph: &CellGraph, view: &EyeView) -> Group {
    let [seen, culled, other] = palette::EYE_VIEW;
    let mut in_view = vec![false; graph.cells.len()];
    for cell in view.vista.cells() {
        in_view[cell.0 as usize] = true;
    }
    layers.ground(|cell| match cell {
        _ if in_view[cell.0 as usize] => seen,
        _ if view.in_pvs(cell) => culled,
        _ => other,
    })
}

/// The exact visible area.
pub fn area(sheet: &Sheet, view: &EyeView) -> Group {
    let mut data = PathData::default();
    data.polygon(&outline(sheet, view));
    let path = Path::new()
        .set("d", data.0)
        .set("fill", palette::IN_SIGHT)
        .set("stroke", palette::EYE)
        .set("stroke-width", 0.8)
        .set("stroke-linejoin", "round");
    Group::new().set("id", "area").add(path)
}

/// The eye, and the edges of its cone as far as it sees along them.
pub fn eye(sheet: &Sheet, view: &EyeView) -> Group {
    let at = sheet.at(view.eye());
    let corners = outline(sheet, view);
    let n = corners.len();
    let mut data = PathData::default();
    // The outline passes through the eye between the cone's edges.
    for i in (0..n).filter(|&i| corners[i] == at) {
        data.segment(at, corners[(i + 1) % n]);
        data.segment(at, corners[(i + n - 1) % n]);
    }
    let edges = Path::new()
        .set("d", data.0)
        .set("stroke", palette::EYE)
        .set("stroke-width", 1.8)
        .set("stroke-linecap", "round")
        .set("fill", "none");
    Group::new().set("id", "eye").add(edges).add(dot(at))
}

/// An eye on the page.
pub fn dot(at: DVec2) -> Circle {
    Circle::new()
        .set("cx", short(at.x))
        .set("cy", short(at.y))
        .set("r", 5.2)
        .set("fill", palette::EYE)
        .set("stroke", "white")
        .set("stroke-width", 1.6)
}

fn outline(sheet: &Sheet, view: &EyeView) -> Vec<DVec2> {
    let mut corners = Vec::new();
    view.vista.outline(&mut corners);
    corners.into_iter().map(|p| sheet.at(p)).collect()
}
