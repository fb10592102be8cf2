//! Many points of one surface at once: four in each vector.
//!
//! In: a [`Patch`] of a picture with the depths of its rays, and what is known of the lights. Out: the
//! colours of its pixels, to the last bit those of [`Shader::colour_of`], in which every number is
//! computed in the same order. What all points of a surface share (normal, material, brightness,
//! where its picture lies) is looked up once. Only for surfaces that local light is enough for: what
//! reflects, lets pass, has holes or shows the sky takes the long way, ray by ray.

use fearless_simd::{Level, Simd, dispatch, f64x4, mask64x4, prelude::*};
use glam::DVec3;
use smallvec::SmallVec;

use super::{Finish, Lit, Shader, Spot, Work, phong};
use crate::cells::CellId;
use crate::level::scene::LightShape;
use crate::trace::beam::{Area, Fan, Patch, depth};
use crate::trace::dress::{Layout, Wardrobe, Wear};
use crate::trace::light;
use crate::trace::space::Surface;
use crate::trace::world::Hit;

/// What the points of a surface share.
pub struct Sheet<'a> {
    surface: Surface,
    cell: CellId,
    normal: DVec3,
    /// z of a floor or ceiling.
    level: Option<f64>,
    finish: &'a Finish,
    ambient: f64,
    coat: Coat<'a>,
    lamps: SmallVec<[Lamp; 8]>,
}

/// Where the points get their colour.
enum Coat<'a> {
    /// All have the same.
    Plain(DVec3),
    /// From a picture of a Doom map.
    Texels(&'a Wardrobe, Layout),
    /// From a picture of the material.
    Picture,
}

/// A light that may reach the surface.
struct Lamp {
    /// Number among all lights.
    number: u32,
    /// Which of the cell's lights it is.
    bit: usize,
    /// Place and intensity, if it is a point.
    point: Option<(DVec3, DVec3)>,
}

/// Three coordinates or channels of four points.
type Three<S> = [f64x4<S>; 3];

#[inline(always)]
fn splat<S: Simd>(simd: S, v: DVec3) -> Three<S> {
    [v.x, v.y, v.z].map(|c| f64x4::splat(simd, c))
}

#[inline(always)]
fn dot<S: Simd>(a: Three<S>, b: Three<S>) -> f64x4<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn lane<S: Simd>(v: &Three<S>, k: usize) -> DVec3 {
    DVec3::new(v[0][k], v[1][k], v[2][k])
}

#[inline(always)]
fn put<S: Simd>(simd: S, v: &mut Three<S>, k: usize, value: DVec3) {
    for (c, v) in v.iter_mut().enumerate() {
        let mut four: [f64; 4] = **v;
        four[k] = value[c];
        *v = f64x4::simd_from(simd, four);
    }
}

#[inline(always)]
fn add<S: Simd>(simd: S, v: &mut Three<S>, k: usize, more: DVec3) {
    put(simd, v, k, lane(v, k) + more);
}

/// One point, as single rays know it.
fn hit(sheet: &Sheet, t: f64, point: DVec3) -> Hit {
    Hit::on_surface(sheet.surface, sheet.cell, t, point, sheet.normal)
}

impl<'a, const SHADOWS: bool, const SOFT: bool, const SECONDARY: bool, const SCATTER: bool>
    Shader<'a, SHADOWS, SOFT, SECONDARY, SCATTER>
{
    /// What the points of a surface share as seen from a cell; `None` if more than local light shows
    /// on it.
    pub fn sheet(&self, surface: Surface, cell: CellId) -> Option<Sheet<'a>> {
        let world = self.tracer.world;
        let clear = matches!(surface, Surface::Pane(_) | Surface::Outside(_));
        if clear || world.is_sky(surface) {
            return None;
        }
        let finish = &self.finishes[world.surface_material(surface)?.0 as usize];
        if SECONDARY && (finish.km != DVec3::ZERO || finish.kt > 0.0) {
            return None;
        }
        let mut lamps = SmallVec::new();
        for (bit, &number) in world.lights_of(cell).iter().enumerate() {
            let source = &world.lights[number as usize];
            if SOFT && light::is_area(source) {
                return None;
            }
            let point = match source.shape {
                LightShape::Point { position } => {
                    Some((position, DVec3::from_array(source.intensity)))
                }
                _ => None,
            };
            lamps.push(Lamp { number, bit, point });
        }
        let worn = world.wardrobe.as_ref().map(|w| (w, w.wear(surface)));
        let coat = match (worn, finish.picture) {
            (Some((wardrobe, &Wear::Picture(layout))), _) if self.textures => {
                Coat::Texels(wardrobe, layout)
            }
            (_, None) => Coat::Plain(finish.kd),
            (_, Some(_)) => Coat::Picture,
        };
        let level = match surface {
            Surface::Floor(c) => Some(world.space.cell(c.0).floor),
            Surface::Ceiling(c) => Some(world.space.cell(c.0).ceiling),
            _ => None,
        };
        Some(Sheet {
            surface,
            cell,
            normal: world.normal(surface),
            level,
            finish,
            ambient: world.ambient_on(surface, cell),
            coat,
            lamps,
        })
    }

    /// Colours the pixels of a patch, all on this sheet. `depths` and `lit` go by pixel of the patch's
    /// rectangle; no `lit` if nothing is known. `out` is told each pixel's place and colour.
    pub fn spread(
        &self,
        sheet: &Sheet,
        fan: &Fan,
        patch: &Patch,
        (depths, lit): (&[f64], &[Lit]),
        work: &mut Work,
        mut out: impl FnMut(u32, u32, DVec3),
    ) {
        work.touch(sheet.cell.0);
        let simd_level = Level::new();
        patch.mask.rectangles(&patch.area, |part| {
            work.rays.primary += part.len() as u64;
            dispatch!(simd_level, simd => {
                self.part(simd, sheet, fan, &patch.area, &part, (depths, lit), work, &mut out);
            });
        });
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn part<S: Simd>(
        &self,
        simd: S,
        sheet: &Sheet,
        fan: &Fan,
        whole: &Area,
        part: &Area,
        (depths, lit): (&[f64], &[Lit]),
        work: &mut Work,
        out: &mut impl FnMut(u32, u32, DVec3),
    ) {
        for y in part.y.0..part.y.1 {
            let row = (y - whole.y.0) as usize * whole.width() as usize;
            let mut x = part.x.0;
            while x < part.x.1 {
                let n = (part.x.1 - x).min(4) as usize;
                let i = row + (x - whole.x.0) as usize;
                let mut t = [depths[i + n - 1]; 4];
                t[..n].copy_from_slice(&depths[i..i + n]);
                let mut known = [Lit::default(); 4];
                if SHADOWS && !lit.is_empty() {
                    known[..n].copy_from_slice(&lit[i..i + n]);
                }
                let colours = self.four(simd, sheet, fan, [x, y], n, (t, known), work);
                for (k, colour) in colours.into_iter().take(n).enumerate() {
                    out(x + k as u32, y, colour);
                }
                x += 4;
            }
        }
    }

    /// Four pixels side by side, of which the first `n` count.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn four<S: Simd>(
        &self,
        simd: S,
        sheet: &Sheet,
        fan: &Fan,
        [x, y]: [u32; 2],
        n: usize,
        (t, lit): ([f64; 4], [Lit; 4]),
        work: &mut Work,
    ) -> [DVec3; 4] {
        let d = depth::directions(simd, fan, x, y);
        let ts = f64x4::simd_from(simd, t);
        let o = splat(simd, fan.origin);
        let mut p = [o[0] + d[0] * ts, o[1] + d[1] * ts, o[2] + d[2] * ts];
        if let Some(level) = sheet.level {
            p[2] = f64x4::splat(simd, level);
        }
        let colour = self.coats(simd, sheet, t, p);
        let view = |k: usize| -fan.ray(x + k as u32, y).direction.normalize();
        let mut sum = splat(simd, DVec3::ZERO);
        for lamp in &sheet.lamps {
            let Some((at, intensity)) = lamp.point else {
                for (k, lit) in lit.into_iter().enumerate().take(n) {
                    let hit = hit(sheet, t[k], lane(&p, k));
                    let spot = Spot {
                        hit: &hit,
                        view: view(k),
                        outer: sheet.normal,
                        normal: sheet.normal,
                        colour: lane(&colour, k),
                    };
                    let source = &self.tracer.world.lights[lamp.number as usize];
                    let seen = (light::middle(source), lit.of(lamp.bit));
                    let more = self.light_from(&spot, sheet.finish, lamp.number, seen, work);
                    add(simd, &mut sum, k, more);
                }
                continue;
            };
            let at = splat(simd, at);
            let to = [at[0] - p[0], at[1] - p[1], at[2] - p[2]];
            let distance = dot(to, to).sqrt();
            let zero = f64x4::splat(simd, 0.0);
            let inverse = f64x4::splat(simd, 1.0) / distance;
            let l = to.map(|c| c * inverse);
            let normal = splat(simd, sheet.normal);
            let cos = dot(normal, l);
            let facing = distance.simd_gt(zero) & cos.simd_gt(zero);
            if facing.to_bitmask() == 0 {
                continue;
            }
            let mut reflected = colour.map(|c| c * cos);
            if sheet.finish.ks != DVec3::ZERO {
                for k in 0..n {
                    let finish = (lane(&colour, k), sheet.finish.ks, sheet.finish.shininess);
                    let phong = phong(finish, sheet.normal, lane(&l, k), view(k));
                    put(simd, &mut reflected, k, phong);
                }
            }
            let some = |c: f64x4<S>| !c.simd_eq(zero);
            let bright = some(reflected[0]) | some(reflected[1]) | some(reflected[2]);
            let lanes = (1u64 << n) - 1;
            let counts = (facing & bright).to_bitmask() & lanes;
            let attenuation = inverse * inverse;
            let come = splat(simd, intensity);
            let more: Three<S> = std::array::from_fn(|c| (come[c] * attenuation) * reflected[c]);
            let mut reach = counts;
            if SHADOWS {
                work.rays.shadow += u64::from(counts.count_ones());
                let mut unknown = 0;
                for (k, lit) in lit.into_iter().enumerate() {
                    match lit.of(lamp.bit) {
                        Some(true) => {}
                        Some(false) => reach &= !(1 << k),
                        None => unknown |= 1 << k,
                    }
                }
                for k in (0..n).filter(|k| (unknown & counts) >> k & 1 == 1) {
                    reach &= !(1 << k);
                    let hit = hit(sheet, t[k], lane(&p, k));
                    let share = self.visible(&hit, lamp.number, lane(&l, k), distance[k]);
                    add(simd, &mut sum, k, lane(&more, k) * share);
                }
            }
            if reach != 0 {
                let reach = mask64x4::from_bitmask(simd, reach);
                for (sum, more) in sum.iter_mut().zip(more) {
                    *sum += reach.select(more, zero);
                }
            }
        }
        let emission = splat(simd, sheet.finish.emission);
        let light: Three<S> =
            std::array::from_fn(|c| (emission[c] + colour[c] * sheet.ambient) + sum[c]);
        std::array::from_fn(|k| lane(&light, k))
    }

    /// The diffuse colours of four points.
    #[inline(always)]
    fn coats<S: Simd>(&self, simd: S, sheet: &Sheet, t: [f64; 4], p: Three<S>) -> Three<S> {
        let colours: [DVec3; 4] = match &sheet.coat {
            &Coat::Plain(colour) => return splat(simd, colour),
            Coat::Texels(wardrobe, layout) => {
                let column = dot(splat(simd, layout.across), p) + layout.at.x;
                let row = dot(splat(simd, layout.down), p) + layout.at.y;
                let (column, row) = (column.floor(), row.floor());
                std::array::from_fn(|k| {
                    let texel = wardrobe.texel_at(layout, column[k], row[k]);
                    texel.unwrap_or_default()
                })
            }
            Coat::Picture => std::array::from_fn(|k| {
                let hit = hit(sheet, t[k], lane(&p, k));
                sheet.finish.colour(self.tracer.world, &hit)
            }),
        };
        std::array::from_fn(|c| f64x4::simd_from(simd, colours.map(|v| v[c])))
    }
}
