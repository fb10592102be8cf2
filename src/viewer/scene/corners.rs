//! The polygons of a level as triangles for a graphics card.
//!
//! In: [`Polygons`], their [`Coats`], and where the coats' texels lie. Out: [`Corner`]s and, polygon by
//! polygon, which of them make its triangles.
//!
//! Two polygons that meet must meet in the same corners, or pixels between them stay open. On the plan
//! they do: a cell's outline has its neighbours' corners. But over one corner of the plan walls, steps and
//! lintels end at different heights; so every upright side gets all heights at which anything ends there.

use std::ops::Range;

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::texels::Texels;
use crate::preview::coat::{Coat, Map, Stuff};
use crate::preview::{Coats, Polygon, Polygons};
use crate::trace::Space;
use crate::trace::space::Surface;

/// A corner of a triangle, as the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Corner {
    /// From the scene's own origin.
    pub place: [f32; 3],
    /// On the picture, in repetitions.
    pub uv: [f32; 2],
    /// Of an object; 32767 is 1.
    pub normal: [i16; 4],
    /// What it is painted with: see [`Paint`].
    pub paint: [u32; 4],
    /// How brightly.
    pub light: f32,
}

/// The shader's ways to paint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Paint {
    /// `[colour]`
    Colour,
    /// `[first texel, columns, rows]`
    Picture,
    /// The same, with holes, and not repeated upwards and downwards.
    Grating,
    /// The sky.
    Sky,
    /// `[what passes, what is added]`
    Glass,
    /// `[first texel, columns, rows]` of what passes.
    Stained,
    /// An object's colour.
    Thing,
    /// An object's picture.
    ThingPicture,
    /// An object of glass.
    ThingGlass,
}

/// One coat of a polygon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skin {
    /// Its triangles, in a list of numbers of corners.
    pub range: Range<u32>,
    /// Whether what is behind shows through in another colour.
    pub glass: bool,
}

/// Everything that polygons need.
#[derive(Clone, Debug, Default)]
pub struct Skins {
    /// Corners of the triangles.
    pub corners: Vec<Corner>,
    /// Three corners to each triangle.
    pub triangles: Vec<u32>,
    list: Vec<Skin>,
    /// Where those of each polygon start, and, last, their number.
    first: Vec<u32>,
}

impl Skins {
    /// Those of a level. Places are counted from `origin`.
    pub fn new(
        space: &Space,
        (polygons, coats): (&Polygons, &Coats),
        texels: &Texels,
        origin: DVec3,
    ) -> Self {
        let heights = heights(space, polygons);
        let mut skins = Self {
            first: vec![0],
            ..Self::default()
        };
        for (number, polygon) in (0..).zip(polygons.iter()) {
            let outline = Outline::of(space, polygon, &heights);
            let coat = &coats.list[number as usize];
            for coat in [Some(coat), coats.over(number)].into_iter().flatten() {
                skins.add(&outline, coat, texels, origin);
            }
            skins.first.push(skins.list.len() as u32);
        }
        skins
    }

    /// The coats of a polygon that paint anything, the one painted last at the end.
    #[inline]
    pub fn of(&self, polygon: u32) -> &[Skin] {
        let polygon = polygon as usize;
        &self.list[self.first[polygon] as usize..self.first[polygon + 1] as usize]
    }

    fn add(&mut self, outline: &Outline, coat: &Coat, texels: &Texels, origin: DVec3) {
        let Some((paint, map)) = paint(coat, texels) else {
            return;
        };
        let place = |p: DVec3| {
            map.map_or(DVec2::ZERO, |m| {
                DVec2::new(m.across.dot(p), m.down.dot(p)) + m.at
            })
        };
        // Near zero there are more digits behind the point.
        let mut whole = place(outline.corners[0]).floor();
        if paint[0] == Paint::Grating as u32 {
            whole.y = 0.0;
        }
        let first = self.corners.len() as u32;
        self.corners.extend(outline.corners.iter().map(|&p| Corner {
            place: (p - origin).as_vec3().to_array(),
            uv: (place(p) - whole).as_vec2().to_array(),
            paint,
            light: coat.light as f32,
            ..Corner::default()
        }));
        let start = self.triangles.len() as u32;
        let triangles = outline.triangles.iter().flatten();
        self.triangles.extend(triangles.map(|k| first + k));
        self.list.push(Skin {
            range: start..self.triangles.len() as u32,
            glass: matches!(coat.stuff, Stuff::Glass(..) | Stuff::Stained(_)),
        });
    }
}

/// What the shader is told of a coat; nothing of one that paints nothing.
fn paint<'c>(coat: &'c Coat, texels: &Texels) -> Option<([u32; 4], Option<&'c Map>)> {
    let picture = |paint: Paint, map: &'c Map| {
        let [first, width, height] = texels.of(map.texture);
        ([paint as u32, first, width, height], Some(map))
    };
    Some(match &coat.stuff {
        Stuff::Nothing => return None,
        Stuff::Colour(colour) => ([Paint::Colour as u32, *colour, 1, 1], None),
        Stuff::Sky => ([Paint::Sky as u32, 0, 1, 1], None),
        Stuff::Glass(tint, own) => ([Paint::Glass as u32, *tint, *own, 1], None),
        Stuff::Picture(map) => picture(Paint::Picture, map),
        Stuff::Grating(map) => picture(Paint::Grating, map),
        Stuff::Stained(map) => picture(Paint::Stained, map),
    })
}

/// By corner of the plan, all heights at which anything ends there, ascending.
fn heights(space: &Space, polygons: &Polygons) -> Vec<Vec<f64>> {
    let mut heights: Vec<Vec<f64>> = vec![Vec::new(); space.vertices.len()];
    for polygon in polygons.iter() {
        match polygon.surface {
            Surface::Floor(c) | Surface::Ceiling(c) => {
                let cell = space.cell(c.0);
                for e in cell.first..cell.past {
                    heights[space.edge(e).from as usize].push(polygon.bottom);
                }
            }
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                for v in [edge.from, edge.to] {
                    heights[v as usize].extend([polygon.bottom, polygon.top]);
                }
            }
        }
    }
    for list in &mut heights {
        list.sort_by(f64::total_cmp);
        list.dedup();
    }
    heights
}

/// A polygon's corners, with those of its neighbours, and triangles between them.
struct Outline {
    corners: SmallVec<[DVec3; 12]>,
    triangles: SmallVec<[[u32; 3]; 12]>,
}

impl Outline {
    fn of(space: &Space, polygon: &Polygon, heights: &[Vec<f64>]) -> Self {
        match polygon.surface {
            Surface::Floor(_) | Surface::Ceiling(_) => {
                let mut corners = SmallVec::new();
                polygon.corners(space, &mut corners);
                // Corners may lie in line, so from the middle.
                let n = corners.len();
                corners.push(corners.iter().sum::<DVec3>() / n as f64);
                let n = n as u32;
                let triangles = (0..n).map(|i| [i, (i + 1) % n, n]).collect();
                Self { corners, triangles }
            }
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let within = |z: &f64| polygon.bottom <= *z && *z <= polygon.top;
                let side = |v: u32| {
                    let at = space.vertex(v);
                    let heights = heights[v as usize].iter().rev().copied().filter(within);
                    heights.map(move |z| at.extend(z))
                };
                let mut corners: SmallVec<[DVec3; 12]> = side(edge.from).collect();
                let past = corners.len() as u32;
                corners.extend(side(edge.to));
                let triangles = zip(&corners, past);
                Self { corners, triangles }
            }
        }
    }
}

/// Triangles between two upright sides, both from the top, the left one as seen from before first:
/// always the one that goes on to the higher of the two next corners.
fn zip(corners: &[DVec3], past: u32) -> SmallVec<[[u32; 3]; 12]> {
    let (mut a, mut b, n) = (0, past, corners.len() as u32);
    let z = |k: u32| corners[k as usize].z;
    let mut triangles = SmallVec::new();
    while a + 1 < past || b + 1 < n {
        if b + 1 == n || (a + 1 < past && z(a + 1) > z(b + 1)) {
            triangles.push([a, b, a + 1]);
            a += 1;
        } else {
            triangles.push([a, b, b + 1]);
            b += 1;
        }
    }
    triangles
}
