//! What a ray sees on a surface of a Doom map: the texel of a picture, or the sky.
//!
//! In: a level with a [`Dress`], its cells and space, and the pictures.
//! Out: a [`Wardrobe`]: for every surface an affine map from points of the level to texels, made once.
//! The rules are the game's (`r_segs.c`, `r_plane.c`, `r_sky.h`), for pictures of any size:
//!
//! - On walls a picture begins at the left end of its linedef, seen from its side; columns go right,
//!   rows go down, offsets are added. The middle texture of a wall hangs from the ceiling, or stands
//!   on the floor if the lower texture is unpegged. An upper texture stands on its lower edge,
//!   or hangs from the ceiling if unpegged. A lower texture hangs from its upper edge, or is
//!   counted from the ceiling if unpegged.
//! - On floors and ceilings pictures lie side by side from the origin of coordinates, north up; in text
//!   maps they may be turned about it, then moved, then scaled (GZDoom's `hw_flats.cpp`).
//! - A middle texture in an opening is drawn once, not repeated upwards; its holes let rays pass.
//! - The sky is a cylinder infinitely far away, 256 columns to a quarter turn, running to the *left* as
//!   in the game, row 100 at the horizon. Towards its top it fades into the mean colour of its uppermost row,
//!   which goes on above.
//! - Between two sky ceilings of different heights there is sky.
//! - Where a step or a lintel names no picture, that of the floor or ceiling beyond goes on down or
//!   up, as ports of the game do.
//! - Walls along the x axis are a little darker, those along the y axis lighter.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::image::{decode, to_linear};
use super::space::{Border, Space, Surface, WALL};
use crate::cells::{CellGraph, EdgeId};
use crate::level::doom::graphics::Picture;
use crate::level::dress::{Cover, Dress, Hanging, LineDress, PictureId, SideDress};
use crate::level::{Level, SectorId, WallKind};

/// Row of the sky's picture that lies at the horizon.
const HORIZON: f64 = 100.0;
/// Columns of the sky in a full turn.
pub const SKY_TURN: f64 = 1024.0;
/// Rows over which the upper part of the sky fades into one colour.
const SKY_FADE: f64 = 24.0;
/// How much darker or lighter walls along an axis are, on the scale of sector light.
const CONTRAST: f64 = 16.0 / 255.0;

/// Everything that surfaces wear.
#[derive(Clone, Debug)]
pub struct Wardrobe {
    pictures: Vec<Picture>,
    /// By cell.
    floors: Vec<Wear>,
    ceilings: Vec<Wear>,
    /// By edge: the wall, or the step below an opening.
    walls: Vec<Wear>,
    /// By edge: what hangs above an opening.
    lintels: Vec<Wear>,
    /// By edge: what fills an opening.
    gratings: Vec<Wear>,
    /// Sector light as a factor, by cell and by edge.
    cell_light: Vec<f64>,
    edge_light: Vec<f64>,
    sky: Option<Sky>,
    /// From sRGB to linear.
    linear: Vec<f64>,
}

/// What one surface wears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wear {
    /// A picture.
    Picture(Layout),
    /// The sky.
    Sky,
    /// Nothing that is known.
    Bare,
}

/// Where the texels of a picture lie: a point p is in column `across · p + at.x`, row
/// `down · p + at.y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Index into [`Wardrobe::pictures`].
    pub picture: u32,
    /// Texels to the right for a unit along each axis.
    pub across: DVec3,
    /// Texels down.
    pub down: DVec3,
    /// Where the origin of coordinates lies.
    pub at: DVec2,
    /// Not repeated upwards and downwards.
    pub once: bool,
}

/// What a ray sees in a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// A colour (linear RGB) that reflects light.
    Texel(DVec3),
    /// A hole: the ray goes on.
    Hole,
    /// The sky: ask [`Wardrobe::sky`] for its colour in the ray's direction.
    Sky,
    /// Nothing is known; the renderer's usual material.
    Bare,
}

#[derive(Clone, Copy, Debug)]
struct Sky {
    picture: u32,
    /// Mean of its uppermost row, linear.
    top: DVec3,
}

impl Wardrobe {
    /// Dresses the surfaces of a space. `pictures` are those that the level's dress names, in its
    /// order (as from [`pictures`](crate::level::doom::graphics::pictures)). `None` for a level without
    /// a dress.
    pub fn new(
        level: &Level,
        graph: &CellGraph,
        space: &Space,
        pictures: Vec<Option<Picture>>,
    ) -> Option<Self> {
        let dress = &level.scene.dress;
        if dress.is_empty() {
            return None;
        }
        let linear: Vec<f64> = (0..=255u8).map(to_linear).collect();
        let tailor = Tailor {
            level,
            graph,
            space,
            dress,
            pictures: &pictures,
        };
        let sectors = || graph.cells.iter().map(|c| c.sector);
        let flat = |cover: fn(&Dress, SectorId) -> Cover| {
            let wear = |s: Option<SectorId>| s.map_or(Wear::Bare, |s| tailor.flat(cover(dress, s)));
            sectors().map(wear).collect()
        };
        let edges = || (0..graph.edges.len() as u32).map(EdgeId);
        let light = |s: Option<SectorId>| {
            let sector = s.and_then(|s| level.sectors.get(s.0 as usize));
            sector.and_then(|s| s.light).unwrap_or(1.0)
        };
        let edge_light = |e: EdgeId| {
            let cell = graph.cell(graph.edge(e).cell);
            decode((light(cell.sector) + contrast(space, e)).clamp(0.0, 1.0))
        };
        Some(Self {
            floors: flat(Dress::floor),
            ceilings: flat(Dress::ceiling),
            walls: edges().map(|e| tailor.wall_or_step(e)).collect(),
            lintels: edges().map(|e| tailor.lintel(e)).collect(),
            gratings: edges().map(|e| tailor.grating(e)).collect(),
            cell_light: sectors().map(|s| decode(light(s))).collect(),
            edge_light: edges().map(edge_light).collect(),
            sky: dress.sky.and_then(|id| sky(id, &pictures, &linear)),
            // Pictures that are missing are worn nowhere.
            pictures: pictures
                .into_iter()
                .map(Option::unwrap_or_default)
                .collect(),
            linear,
        })
    }

    /// What a surface wears.
    #[inline]
    pub fn wear(&self, surface: Surface) -> &Wear {
        match surface {
            Surface::Floor(c) => &self.floors[c.0 as usize],
            Surface::Ceiling(c) => &self.ceilings[c.0 as usize],
            Surface::Wall(e) | Surface::Step(e) => &self.walls[e.0 as usize],
            Surface::Lintel(e) => &self.lintels[e.0 as usize],
            Surface::Pane(e) => &self.gratings[e.0 as usize],
            // Doom maps have no windows.
            Surface::Outside(_) => &Wear::Bare,
        }
    }

    /// What is seen in a point of a surface: the nearest texel.
    #[inline]
    pub fn look(&self, surface: Surface, point: DVec3) -> Look {
        match self.wear(surface) {
            Wear::Sky => Look::Sky,
            // A picture that is missing hides nothing.
            Wear::Bare if matches!(surface, Surface::Pane(_)) => Look::Hole,
            Wear::Bare => Look::Bare,
            Wear::Picture(layout) => match self.texel(layout, point) {
                // Only what hangs free in an opening has holes.
                None if !layout.once => Look::Texel(DVec3::ZERO),
                None => Look::Hole,
                Some(colour) => Look::Texel(colour),
            },
        }
    }

    /// Whether a ray that meets the pane of an opening in a point goes on.
    #[inline]
    pub fn lets_pass(&self, surface: Surface, point: DVec3) -> bool {
        self.look(surface, point) == Look::Hole
    }

    /// The factor by which the sector's light dims a surface; 1 is full.
    #[inline]
    pub fn light(&self, surface: Surface) -> f64 {
        match surface {
            Surface::Floor(c) | Surface::Ceiling(c) => self.cell_light[c.0 as usize],
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => self.edge_light[e.0 as usize],
        }
    }

    /// The factor by which the sector's light dims what stands in a cell.
    #[inline]
    pub fn light_in(&self, cell: crate::cells::CellId) -> f64 {
        self.cell_light[cell.0 as usize]
    }

    /// The sky's colour in a direction, linear, if there is a picture of it.
    pub fn sky(&self, direction: DVec3) -> Option<DVec3> {
        let place = sky_place(direction);
        self.sky_at(place.x, place.y)
    }

    /// The sky's colour in a place of its picture, linear, if there is one.
    pub fn sky_at(&self, column: f64, row: f64) -> Option<DVec3> {
        let sky = self.sky.as_ref()?;
        let picture = &self.pictures[sky.picture as usize];
        // Straight up and down there is no column.
        if row.is_nan() || row < 0.0 {
            return Some(sky.top);
        }
        let column = (column.floor() as i64).rem_euclid(picture.width.into());
        let last = f64::from(picture.height - 1);
        let texel = self.colour(picture, column as usize, row.min(last) as usize);
        let texel = texel.unwrap_or(sky.top);
        Some(sky.top.lerp(texel, (row / SKY_FADE).min(1.0)))
    }

    /// Columns and rows of the sky's picture, if there is one.
    pub fn sky_size(&self) -> Option<[u32; 2]> {
        let picture = &self.pictures[self.sky.as_ref()?.picture as usize];
        Some([picture.width, picture.height])
    }

    /// The pictures that are worn; those that are missing are empty.
    pub fn pictures(&self) -> &[Picture] {
        &self.pictures
    }

    /// `None` where the picture is clear.
    #[inline]
    fn texel(&self, layout: &Layout, point: DVec3) -> Option<DVec3> {
        let column = (layout.across.dot(point) + layout.at.x).floor();
        let row = (layout.down.dot(point) + layout.at.y).floor();
        self.texel_at(layout, column, row)
    }

    /// As [`Wardrobe::texel`], in this column and row (whole numbers).
    #[inline]
    pub(super) fn texel_at(&self, layout: &Layout, column: f64, row: f64) -> Option<DVec3> {
        let picture = &self.pictures[layout.picture as usize];
        if layout.once && !(0.0..f64::from(picture.height)).contains(&row) {
            return None;
        }
        let column = repeated(column, picture.width);
        self.colour(picture, column, repeated(row, picture.height))
    }

    #[inline]
    fn colour(&self, picture: &Picture, column: usize, row: usize) -> Option<DVec3> {
        let [r, g, b, a] = picture.pixels[row * picture.width as usize + column];
        let linear = |c: u8| self.linear[usize::from(c)];
        (a > 0).then(|| DVec3::new(linear(r), linear(g), linear(b)))
    }
}

/// The place in one of `n` that repeat for ever. Most pictures are powers of two wide and high.
#[inline]
fn repeated(at: f64, n: u32) -> usize {
    let at = at as i32;
    if n.is_power_of_two() {
        (at as u32 & (n - 1)) as usize
    } else {
        at.rem_euclid(n as i32) as usize
    }
}

/// Where the sky's picture shows in a direction: column, running to the left, and row; negative above
/// the picture.
pub fn sky_place(direction: DVec3) -> DVec2 {
    let flat = direction.truncate();
    let column = flat.to_angle() / TAU * SKY_TURN;
    let row = HORIZON - direction.z / flat.length() * (SKY_TURN / TAU);
    DVec2::new(column, row)
}

/// Of the linedef on which an edge lies: what hangs on it, and on its side towards the edge's cell.
pub(super) fn side_at<'a>(
    level: &'a Level,
    graph: &CellGraph,
    edge: EdgeId,
) -> Option<(&'a LineDress, SideDress)> {
    let wall = &level.walls[graph.edge(edge).wall()?.0 as usize];
    let line = level.scene.dress.line_of(wall)?;
    let side = line.sides[usize::from(!on_left(graph, edge, line))].clone();
    Some((line, side?))
}

/// Whether the edge's cell lies on the left of the linedef: then the edge runs the same way.
fn on_left(graph: &CellGraph, edge: EdgeId, line: &LineDress) -> bool {
    let point = |v| graph.vertices.approx(v);
    let along = point(graph.end(edge)) - point(graph.edge(edge).origin);
    along.dot(line.to - line.from) > 0.0
}

/// What is needed to dress one surface after the other.
struct Tailor<'a> {
    level: &'a Level,
    graph: &'a CellGraph,
    space: &'a Space,
    dress: &'a Dress,
    pictures: &'a [Option<Picture>],
}

/// A side of a linedef on an edge, with the heights on both sides of it.
struct Side<'a> {
    line: &'a LineDress,
    wears: SideDress,
    on_left: bool,
    border: &'a Border,
    /// z of floor and ceiling, in the edge's cell.
    here: [f64; 2],
    /// And beyond; `None` for a wall with nothing behind it.
    beyond: Option<[f64; 2]>,
    /// Whether the ceilings are sky: here, and beyond.
    open: [bool; 2],
    /// The sector beyond.
    sector: Option<SectorId>,
}

impl<'a> Tailor<'a> {
    fn side(&self, edge: EdgeId) -> Option<Side<'a>> {
        let (line, wears) = side_at(self.level, self.graph, edge)?;
        let on_left = on_left(self.graph, edge, line);
        let border = self.space.edge(edge.0);
        let cell = self.space.cell(border.cell);
        let wall = &self.level.walls[self.graph.edge(edge).wall()?.0 as usize];
        let see_through = matches!(wall.kind, WallKind::Edge { .. });
        let heights = |s: SectorId| {
            let sector = self.level.sectors.get(s.0 as usize)?;
            Some([sector.floor.rest, sector.ceiling.rest])
        };
        let sector = if on_left { wall.right } else { wall.left };
        let sector = sector.filter(|_| see_through);
        let open = |s: Option<SectorId>| s.is_some_and(|s| self.dress.ceiling(s) == Cover::Sky);
        Some(Side {
            line,
            wears,
            on_left,
            border,
            here: [cell.floor, cell.ceiling],
            beyond: sector.and_then(heights),
            open: [
                open(self.graph.cell(self.graph.edge(edge).cell).sector),
                open(sector),
            ],
            sector,
        })
    }

    fn flat(&self, cover: Cover) -> Wear {
        match cover {
            Cover::Sky => Wear::Sky,
            Cover::Bare => Wear::Bare,
            Cover::Picture(picture, lie) => {
                let (sin, cos) = lie.turn.to_radians().sin_cos();
                self.picture(Layout {
                    picture: picture.0,
                    across: DVec3::new(cos, -sin, 0.0) * lie.scale.x,
                    down: DVec3::new(-sin, -cos, 0.0) * lie.scale.y,
                    at: lie.offset * lie.scale,
                    once: false,
                })
            }
        }
    }

    fn wall_or_step(&self, edge: EdgeId) -> Wear {
        let Some(side) = self.side(edge) else {
            return Wear::Bare;
        };
        if side.border.twin != WALL {
            return self.step(&side);
        }
        match side.beyond {
            // A door that counts as a wall.
            Some([_, ceiling]) if ceiling < side.here[1] => self.upper(&side),
            Some([floor, _]) if floor > side.here[0] => self.step(&side),
            _ => self.middle(&side),
        }
    }

    fn middle(&self, side: &Side) -> Wear {
        let Some(hanging) = side.wears.middle else {
            return Wear::Bare;
        };
        if side.line.lower_unpegged {
            self.standing(side, hanging, side.here[0])
        } else {
            self.hung(side, hanging, side.here[1])
        }
    }

    fn step(&self, side: &Side) -> Wear {
        let Some(hanging) = side.wears.lower else {
            return self.drawn_out(side, Dress::floor);
        };
        let Some([floor, ceiling]) = side.beyond else {
            return self.hung(side, hanging, side.here[1]);
        };
        let top = match side.line.lower_unpegged {
            false => floor,
            // Between two skies the game takes the ceiling beyond for both.
            true if side.open == [true, true] => ceiling,
            true => side.here[1],
        };
        self.hung(side, hanging, top)
    }

    fn lintel(&self, edge: EdgeId) -> Wear {
        self.side(edge).map_or(Wear::Bare, |side| self.upper(&side))
    }

    fn upper(&self, side: &Side) -> Wear {
        if side.open == [true, true] {
            return Wear::Sky;
        }
        match (side.wears.upper, side.beyond) {
            (None, _) if side.open.contains(&true) => Wear::Sky,
            (None, _) => self.drawn_out(side, Dress::ceiling),
            (Some(hanging), Some([_, ceiling])) if !side.line.upper_unpegged => {
                self.standing(side, hanging, ceiling)
            }
            (Some(hanging), _) => self.hung(side, hanging, side.here[1]),
        }
    }

    fn grating(&self, edge: EdgeId) -> Wear {
        let Some(side) = self.side(edge).filter(|s| s.border.twin != WALL) else {
            return Wear::Bare;
        };
        let (Some(hanging), Some([floor, ceiling])) = (side.wears.middle, side.beyond) else {
            return Wear::Bare;
        };
        let wear = if side.line.lower_unpegged {
            self.standing(&side, hanging, side.here[0].max(floor))
        } else {
            self.hung(&side, hanging, side.here[1].min(ceiling))
        };
        match wear {
            Wear::Picture(layout) => Wear::Picture(Layout {
                once: true,
                ..layout
            }),
            other => other,
        }
    }

    /// A picture whose lowest row ends at height z.
    fn standing(&self, side: &Side, hanging: Hanging, z: f64) -> Wear {
        let Some(picture) = self.found(hanging.picture) else {
            return Wear::Bare;
        };
        self.hung(
            side,
            hanging,
            z + f64::from(picture.height) / hanging.scale.y,
        )
    }

    /// A picture whose uppermost row begins at height z.
    fn hung(&self, side: &Side, hanging: Hanging, z: f64) -> Wear {
        let (across, start) = side.run();
        let across = across * hanging.scale.x;
        self.picture(Layout {
            picture: hanging.picture.0,
            across: across.extend(0.0),
            down: DVec3::NEG_Z * hanging.scale.y,
            at: hanging.offset + DVec2::new(-across.dot(start), z * hanging.scale.y),
            once: false,
        })
    }

    /// The floor's or ceiling's picture beyond, going on over the face.
    fn drawn_out(&self, side: &Side, cover: fn(&Dress, SectorId) -> Cover) -> Wear {
        let (across, start) = side.run();
        match side.sector.map(|s| self.flat(cover(self.dress, s))) {
            Some(Wear::Picture(layout)) => Wear::Picture(Layout {
                across: across.extend(0.0),
                down: DVec3::NEG_Z,
                at: DVec2::new(-across.dot(start), 0.0),
                ..layout
            }),
            Some(other) => other,
            None => Wear::Bare,
        }
    }

    fn found(&self, id: PictureId) -> Option<&'a Picture> {
        self.pictures.get(id.0 as usize)?.as_ref()
    }

    fn picture(&self, layout: Layout) -> Wear {
        match self.found(PictureId(layout.picture)) {
            Some(picture) if !picture.pixels.is_empty() => Wear::Picture(layout),
            _ => Wear::Bare,
        }
    }
}

impl Side<'_> {
    /// The way to the right as seen from this side (a unit vector), and the left end.
    fn run(&self) -> (DVec2, DVec2) {
        let [left, right] = if self.on_left {
            [self.line.to, self.line.from]
        } else {
            [self.line.from, self.line.to]
        };
        ((right - left).normalize_or_zero(), left)
    }
}

fn sky(id: PictureId, pictures: &[Option<Picture>], linear: &[f64]) -> Option<Sky> {
    let picture = pictures.get(id.0 as usize)?.as_ref()?;
    let row = picture.pixels.get(..picture.width as usize)?;
    let sum: DVec3 = row
        .iter()
        .map(|p| DVec3::from([p[0], p[1], p[2]].map(|c| linear[usize::from(c)])))
        .sum();
    (!row.is_empty()).then(|| Sky {
        picture: id.0,
        top: sum / row.len() as f64,
    })
}

fn contrast(space: &Space, edge: EdgeId) -> f64 {
    let border = space.edge(edge.0);
    let along = space.vertex(border.to) - space.vertex(border.from);
    if along.y == 0.0 {
        -CONTRAST
    } else if along.x == 0.0 {
        CONTRAST
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
