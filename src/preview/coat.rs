//! What the polygons of a level are painted with, made once.
//!
//! In: a [`World`], its [`Polygons`] and a [`Finish`]. Out: [`Coats`]: for each polygon a colour, a
//! picture with the map from points of the level to it, the sky, or glass.
//!
//! Everything is done on the scale of the screen (sRGB bytes), as games and level editors do: a light
//! that depends on the surface's direction (walls along one axis are brighter than those along the
//! other, floors than ceilings), on the brightness of a Doom map's sector, and on the distance.
//! There are no lamps and no shadows; for those there is the ray tracer.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::polygon::Polygons;
use crate::cells::CellId;
use crate::trace::dress::{SKY_TURN, Wear};
use crate::trace::image::{to_linear, to_srgb};
use crate::trace::picture::tone;
use crate::trace::space::{Pane, Surface};
use crate::trace::world::{MaterialIndex, World};

/// How a picture looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Finish {
    /// Every polygon has one colour: its material's, or the mean of its picture. Gratings keep their
    /// holes, and so their pictures.
    Flat,
    /// Polygons show their pictures, the nearest texel on each pixel.
    #[default]
    Textured,
}

/// Red, green, blue and opacity, from the lowest byte on.
pub type Packed = u32;

/// A picture, repeated without end.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Row after row; not opaque: a hole.
    pub texels: Vec<Packed>,
    /// Mean colour of what is not a hole.
    mean: DVec3,
}

/// Where a picture lies: a point p is `across · p + at.x` widths of it to the right, and `down · p + at.y`
/// heights down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Index into [`Coats::textures`].
    pub texture: u32,
    /// Widths to the right.
    pub across: DVec3,
    /// Heights down.
    pub down: DVec3,
    /// Where the origin of coordinates lies.
    pub at: DVec2,
}

/// What a polygon is painted with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stuff {
    /// Nothing: an opening.
    Nothing,
    /// A colour.
    Colour(Packed),
    /// A picture.
    Picture(Map),
    /// A picture that is not repeated upwards and downwards, with holes.
    Grating(Map),
    /// The sky, which is infinitely far away.
    Sky,
    /// Glass: of what is behind, this share passes in each channel (255 is all); and a colour is added.
    Glass(Packed, Packed),
    /// Glass that lets the colours of a picture pass.
    Stained(Map),
}

/// What a polygon is painted with, and how brightly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// What.
    pub stuff: Stuff,
    /// How bright, 1 being its full colour.
    pub light: f64,
}

impl Coat {
    const NOTHING: Self = Self {
        stuff: Stuff::Nothing,
        light: 1.0,
    };

    /// Whether what was painted before shows through.
    pub fn is_clear(&self) -> bool {
        use Stuff::{Colour, Glass, Grating, Nothing, Picture, Sky, Stained};
        match self.stuff {
            Colour(_) | Picture(_) | Sky => false,
            Nothing | Grating(_) | Glass(..) | Stained(_) => true,
        }
    }
}

/// The coats of a level.
#[derive(Clone, Debug)]
pub struct Coats {
    /// The pictures.
    pub textures: Vec<Texture>,
    /// By polygon.
    pub list: Vec<Coat>,
    /// Second coats, and on which polygon: of glass, on windows to the outside.
    over: Vec<(u32, Coat)>,
    /// The sky's picture, one turn across; `None` for the usual sky.
    pub sky: Option<Texture>,
    /// Number of the first texture that is a material's picture.
    first: u32,
    /// Pictures are brightened by this factor of light.
    exposure: f64,
    /// At this distance half of the light is lost that is lost on the way to infinity.
    dusk: f64,
}

/// Doom's pictures are dark, and the game brightens what is near: so does this, by a little more than two
/// stops.
const DOOM: f64 = 4.5;
/// The share of the light that remains far away.
pub const AFAR: f64 = 0.4;

/// Bytes of a colour in linear light.
pub fn pack(colour: DVec3) -> Packed {
    let [r, g, b] = tone(colour).to_array().map(|c| u32::from(to_srgb(c)));
    r | g << 8 | b << 16 | 0xff << 24
}

/// A colour's light scaled by a share of 256.
#[inline(always)]
pub fn dim(colour: Packed, share: u32) -> Packed {
    let even = ((colour & 0x00ff_00ff) * share) >> 8;
    let odd = (colour >> 8 & 0xff) * share;
    even & 0x00ff_00ff | odd & 0xff00 | 0xff << 24
}

impl Coats {
    /// Those of a level's polygons.
    pub fn new(world: &World, polygons: &Polygons, finish: Finish) -> Self {
        let exposure = if world.wardrobe.is_some() { DOOM } else { 1.0 };
        let mut textures: Vec<Texture> = Vec::new();
        if let Some(wardrobe) = &world.wardrobe {
            let linear: Vec<f64> = (0..=255).map(to_linear).collect();
            let opaque = |p: &[u8; 4]| {
                (p[3] > 0).then(|| DVec3::from([p[0], p[1], p[2]].map(|c| linear[usize::from(c)])))
            };
            textures.extend(wardrobe.pictures().iter().map(|picture| {
                let texels = picture.pixels.iter().map(opaque);
                Texture::new([picture.width, picture.height], texels, exposure)
            }));
        }
        let first = textures.len() as u32;
        textures.extend(
            world
                .pictures
                .iter()
                .map(|image| Texture::new(image.size(), image.pixels().map(Some), exposure)),
        );
        let mut coats = Self {
            textures,
            list: Vec::new(),
            over: Vec::new(),
            sky: sky(world, exposure),
            first,
            exposure,
            dusk: dusk(world),
        };
        let tailor = Tailor { world, finish };
        for (number, polygon) in (0..).zip(polygons.iter()) {
            let coat = tailor.coat(&coats, polygon.surface);
            coats.list.push(coat);
            if let Surface::Outside(_) = polygon.surface {
                let coat = tailor.glass(&coats, polygon.surface);
                coats.over.push((number, coat));
            }
        }
        coats.over.retain(|(_, coat)| coat.stuff != Stuff::Nothing);
        coats
    }

    /// The second coat of a polygon, if it gets one.
    pub fn over(&self, polygon: u32) -> Option<&Coat> {
        let found = self.over.binary_search_by_key(&polygon, |&(n, _)| n);
        found.ok().map(|i| &self.over[i].1)
    }

    /// What a picture shows in a point of a surface that the map lays it on.
    pub fn texel(&self, map: &Map, point: DVec3) -> Packed {
        let texture = &self.textures[map.texture as usize];
        let u = map.across.dot(point) + map.at.x;
        let v = map.down.dot(point) + map.at.y;
        let part = |x: f64, n: u32| ((x - x.floor()) * f64::from(n)) as usize;
        let column = part(u, texture.width).min(texture.width as usize - 1);
        let row = part(v, texture.height).min(texture.height as usize - 1);
        texture.texels[row * texture.width as usize + column]
    }

    /// Index into [`Coats::textures`] of a material's picture, by its number in [`World::pictures`].
    pub fn texture_of(&self, picture: u32) -> u32 {
        self.first + picture
    }

    /// The distance at which half of the light is lost that is lost on the way to infinity.
    pub fn dusk(&self) -> f64 {
        self.dusk
    }

    /// Mean colour of a material's picture, by its number in [`World::pictures`].
    pub fn mean(&self, picture: u32) -> DVec3 {
        self.textures[(self.first + picture) as usize].mean
    }

    /// A colour of linear light as the pictures have it.
    pub fn exposed(&self, colour: DVec3) -> Packed {
        pack(colour * self.exposure)
    }

    /// How bright what lies at some distance is, in 256ths: `[most, loss, scale]` for
    /// [`faded`](super::fill::faded).
    pub fn fade(&self, light: f64) -> [f64; 3] {
        let full = light * 256.0;
        [full, full * (1.0 - AFAR), self.dusk]
    }

    /// The sky's bytes in a direction.
    pub fn sky(&self, world: &World, direction: DVec3) -> Packed {
        self.exposed(world.sky(direction))
    }
}

/// Five times the height of a usual room.
fn dusk(world: &World) -> f64 {
    let cells = world.space.cells.iter();
    let mut heights: Vec<f64> = cells
        .map(|c| c.ceiling - c.floor)
        .filter(|h| *h > 0.0)
        .collect();
    heights.sort_by(f64::total_cmp);
    heights.get(heights.len() / 2).map_or(1.0, |h| h * 5.0)
}

/// One turn of the sky's picture, faded into its upper colour as by [`World::sky`].
fn sky(world: &World, exposure: f64) -> Option<Texture> {
    let wardrobe = world.wardrobe.as_ref()?;
    let [_, height] = wardrobe.sky_size()?;
    let width = SKY_TURN as u32;
    let places = (0..height + 1).flat_map(|y| (0..width).map(move |x| (x, y)));
    // The first row is what lies above the picture.
    let colour = |(x, y): (u32, u32)| wardrobe.sky_at(f64::from(x) + 0.5, f64::from(y) - 0.5);
    Some(Texture::new(
        [width, height + 1],
        places.map(colour),
        exposure,
    ))
}

impl Texture {
    fn new(
        [width, height]: [u32; 2],
        pixels: impl Iterator<Item = Option<DVec3>>,
        exposure: f64,
    ) -> Self {
        let (mut sum, mut n) = (DVec3::ZERO, 0.0);
        // Pictures have far fewer colours than texels, and encoding one takes long.
        let mut packed: FxHashMap<[u64; 3], Packed> = FxHashMap::default();
        let texels = pixels.map(|pixel| {
            pixel.map_or(0, |colour| {
                sum += colour;
                n += 1.0;
                let bits = colour.to_array().map(f64::to_bits);
                *packed
                    .entry(bits)
                    .or_insert_with(|| pack(colour * exposure))
            })
        });
        let texels = texels.collect();
        Self {
            width,
            height,
            texels,
            mean: sum / f64::max(n, 1.0),
        }
    }
}

/// What is needed to dress one polygon after the other.
struct Tailor<'a> {
    world: &'a World,
    finish: Finish,
}

impl Tailor<'_> {
    fn coat(&self, coats: &Coats, surface: Surface) -> Coat {
        let stuff = if self.world.is_sky(surface) {
            Stuff::Sky
        } else if let Some(wear) = self.worn(surface) {
            self.doom(coats, surface, wear)
        } else if let Surface::Pane(_) = surface {
            return self.glass(coats, surface);
        } else {
            match self.world.surface_material(surface) {
                Some(material) => self.material(coats, surface, material),
                None => Stuff::Nothing,
            }
        };
        let light = match stuff {
            Stuff::Sky => 1.0,
            _ => self.light(surface),
        };
        Coat { stuff, light }
    }

    /// What a Doom map's surface wears.
    fn worn(&self, surface: Surface) -> Option<&Wear> {
        let wear = self.world.wardrobe.as_ref()?.wear(surface);
        let bare = *wear == Wear::Bare && !matches!(surface, Surface::Pane(_));
        (!bare).then_some(wear)
    }

    fn doom(&self, coats: &Coats, surface: Surface, wear: &Wear) -> Stuff {
        let Wear::Picture(layout) = wear else {
            return Stuff::Nothing;
        };
        let texture = &coats.textures[layout.picture as usize];
        let size = DVec2::new(texture.width.into(), texture.height.into());
        let map = Map {
            texture: layout.picture,
            across: layout.across / size.x,
            down: layout.down / size.y,
            at: layout.at / size,
        };
        match self.finish {
            _ if layout.once && matches!(surface, Surface::Pane(_)) => Stuff::Grating(map),
            Finish::Textured => Stuff::Picture(map),
            Finish::Flat => Stuff::Colour(coats.exposed(texture.mean)),
        }
    }

    fn material(&self, coats: &Coats, surface: Surface, index: MaterialIndex) -> Stuff {
        let material = self.world.material(index);
        match (self.map(coats, surface, index), self.finish) {
            (Some(map), Finish::Textured) => Stuff::Picture(map),
            (Some(map), Finish::Flat) => {
                let texture = &coats.textures[map.texture as usize];
                Stuff::Colour(coats.exposed(texture.mean))
            }
            (None, _) => Stuff::Colour(coats.exposed(colour(material))),
        }
    }

    /// Where the picture of a material lies on a surface.
    fn map(&self, coats: &Coats, surface: Surface, index: MaterialIndex) -> Option<Map> {
        let number = self.world.picture_of[index.0 as usize]?;
        let scale = self.world.material(index).texture.as_ref()?.scale;
        let texture = coats.first + number;
        let Texture { width, height, .. } = coats.textures[texture as usize];
        let tall = scale * f64::from(height) / f64::from(width);
        let (across, down) = match surface {
            Surface::Floor(_) => (DVec3::X, DVec3::NEG_Y),
            Surface::Ceiling(_) => (DVec3::X, DVec3::Y),
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let space = &self.world.space;
                let edge = space.edge(e.0);
                let right = (space.vertex(edge.from) - space.vertex(edge.to)).normalize();
                (right.extend(0.0), DVec3::NEG_Z)
            }
        };
        Some(Map {
            texture,
            across: across / scale,
            down: down / tall,
            at: DVec2::ZERO,
        })
    }

    /// The glass in an opening, if there is any.
    fn glass(&self, coats: &Coats, surface: Surface) -> Coat {
        let (Surface::Pane(e) | Surface::Outside(e)) = surface else {
            return Coat::NOTHING;
        };
        let Some(Pane::Glass(material)) = self.world.space.edge(e.0).pane else {
            return Coat::NOTHING;
        };
        let index = MaterialIndex(material.0);
        let material = self.world.material(index);
        if material.transmit == 0.0 {
            return Coat {
                stuff: self.material(coats, surface, index),
                light: self.light(surface),
            };
        }
        let light = self.light(surface);
        let stuff = match (self.map(coats, surface, index), self.finish) {
            (Some(map), Finish::Textured) => Stuff::Stained(map),
            (map, _) => {
                let mean = map.map(|m| coats.textures[m.texture as usize].mean);
                let [tint, own] = glass(colour(material), mean, material.transmit);
                Stuff::Glass(tint, own)
            }
        };
        Coat { stuff, light }
    }

    /// How bright a surface is for its direction and its sector.
    fn light(&self, surface: Surface) -> f64 {
        let turned = slope(self.world.normal(surface));
        match &self.world.wardrobe {
            // Seen on the screen's scale.
            Some(wardrobe) => {
                let sector = f64::from(to_srgb(wardrobe.light(surface))) / 255.0;
                (sector * (0.5 + 0.5 * turned)).min(1.0)
            }
            None => turned,
        }
    }
}

/// The light of a direction, 1 at most: from above, and from the south-east. No wall is as bright as a
/// floor or as dark as a ceiling.
pub fn slope(normal: DVec3) -> f64 {
    const TOWARDS: DVec2 = DVec2::new(0.6, -0.8);
    0.8 + 0.12 * normal.truncate().dot(TOWARDS) + 0.2 * normal.z
}

/// The light on what stands in a cell.
pub fn light_in(world: &World, cell: CellId) -> f64 {
    let wardrobe = world.wardrobe.as_ref();
    wardrobe.map_or(1.0, |w| f64::from(to_srgb(w.light_in(cell))) / 255.0)
}

/// The colour of a material that has no picture: what shines is bright, and metal has the hue of what
/// it mirrors.
pub fn colour(material: &crate::level::scene::Material) -> DVec3 {
    let of = DVec3::from_array;
    of(material.diffuse) + of(material.specular) * (0.6 * material.mirror) + of(material.emission)
}

/// Glass of a colour, or with a picture of this mean colour: what share of each channel passes, and what
/// is added.
pub fn glass(own: DVec3, picture: Option<DVec3>, transmit: f64) -> [Packed; 2] {
    let hue = |c: DVec3| match c.max_element() {
        0.0 => DVec3::ONE,
        most => c / most,
    };
    let share = |part: f64| (part * 256.0).round() as u32;
    let tint = picture.unwrap_or(hue(own)).to_array().map(to_srgb);
    let tint = u32::from_le_bytes([tint[0], tint[1], tint[2], 0xff]);
    let own = pack(own.max(DVec3::splat(0.02)));
    [dim(tint, share(transmit)), dim(own, share(1.0 - transmit))]
}
