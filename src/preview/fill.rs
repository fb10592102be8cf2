//! Pixels of a row.
//!
//! Every pixel's colour is computed from its own column, never from its neighbour's: so the same pixel gets
//! the same bytes, in whatever pieces a row is painted. Sixteen at a time, so that the compiler makes
//! vectors of them. On a picture, places are counted in repetitions: in a number to which 1.5·2^20 was
//! added the last 32 bits are the part behind the point, which times the picture's width, without the
//! last 32 bits, is the column.

use glam::DVec3;

use super::coat::{Coats, Packed, Stuff, Texture, dim};
use super::view::{Shown, View};
use crate::trace::beam::middle;
use crate::trace::dress::{SKY_TURN, sky_place};
use crate::trace::world::World;

const N: usize = 16;
/// A float to which this was added has its last 32 bits behind the point.
const PART: f64 = 1.5 * (1u64 << 20) as f64;
/// And with this, none.
const WHOLE: f64 = 1.5 * (1u64 << 52) as f64;

/// Sixteen texels or fewer: where they are in the picture, how bright, and the row before the point.
struct Places {
    at: [u32; N],
    light: [u32; N],
    repeat: [u32; N],
}

/// Paints the columns of a row that are `row` from column `first` on.
#[inline(always)]
pub fn fill(
    (world, coats, view): (&World, &Coats, &View),
    shown: &Shown,
    (first, y): (u32, u32),
    row: &mut [Packed],
) {
    let light = |x: u32| brightness(shown, x, y);
    match shown.coat.stuff {
        Stuff::Nothing => {}
        Stuff::Colour(colour) => {
            for (k, part) in row.chunks_mut(N).enumerate() {
                let light = light(first + (k * N) as u32);
                for (pixel, light) in part.iter_mut().zip(light) {
                    *pixel = dim(colour, light);
                }
            }
        }
        Stuff::Glass(tint, own) => {
            for pixel in row {
                *pixel = through(*pixel, tint, own);
            }
        }
        Stuff::Sky => sky((world, coats, view), (first, y), row),
        Stuff::Picture(map) => {
            let texture = &coats.textures[map.texture as usize];
            for (k, part) in row.chunks_mut(N).enumerate() {
                let places = places(shown, texture, first + (k * N) as u32, y);
                for (k, pixel) in part.iter_mut().enumerate() {
                    *pixel = dim(texture.texels[places.at[k] as usize], places.light[k]);
                }
            }
        }
        Stuff::Grating(map) => {
            let texture = &coats.textures[map.texture as usize];
            for (k, part) in row.chunks_mut(N).enumerate() {
                let places = places(shown, texture, first + (k * N) as u32, y);
                for (k, pixel) in part.iter_mut().enumerate() {
                    let texel = texture.texels[places.at[k] as usize];
                    if texel >> 24 != 0 && places.repeat[k] == 0 {
                        *pixel = dim(texel, places.light[k]);
                    }
                }
            }
        }
        Stuff::Stained(map) => {
            let texture = &coats.textures[map.texture as usize];
            for (k, part) in row.chunks_mut(N).enumerate() {
                let places = places(shown, texture, first + (k * N) as u32, y);
                for (k, pixel) in part.iter_mut().enumerate() {
                    let texel = texture.texels[places.at[k] as usize];
                    *pixel = through(*pixel, texel, 0);
                }
            }
        }
    }
}

/// Which pixels of a grating are no holes.
#[inline(always)]
pub fn solid(coats: &Coats, shown: &Shown, (x, y): (u32, u32)) -> bool {
    let Stuff::Grating(map) = shown.coat.stuff else {
        return true;
    };
    let texture = &coats.textures[map.texture as usize];
    let places = places(shown, texture, x, y);
    places.repeat[0] == 0 && texture.texels[places.at[0] as usize] >> 24 != 0
}

/// What is seen through glass.
#[inline(always)]
pub fn through(behind: Packed, tint: Packed, own: Packed) -> Packed {
    let channel = |k: usize| {
        let shift = 8 * k as u32;
        let passing = ((behind >> shift & 0xff) * ((tint >> shift & 0xff) + 1)) >> 8;
        (passing + (own >> shift & 0xff)).min(255) << shift
    };
    channel(0) | channel(1) | channel(2) | 0xff << 24
}

/// The light of a nearness (one over the distance), in 256ths: `most` at the eye, less by `loss` infinitely
/// far away, and in the middle at the distance `scale`.
#[inline(always)]
pub fn faded([most, loss, scale]: [f64; 3], nearness: f64) -> u32 {
    let light = most - loss / (1.0 + scale * nearness);
    ((light.max(0.0).min(most) + WHOLE).to_bits() & 0x1ff) as u32
}

#[inline(always)]
fn brightness(shown: &Shown, x: u32, y: u32) -> [u32; N] {
    let (x, q) = (f64::from(x), shown.nearness.row(y));
    std::array::from_fn(|k| faded(shown.fade, shown.nearness.slope[0] * (x + k as f64) + q))
}

#[inline(always)]
fn places(shown: &Shown, texture: &Texture, x: u32, y: u32) -> Places {
    let mut places = Places {
        at: [0; N],
        light: [0; N],
        repeat: [0; N],
    };
    let x = f64::from(x);
    let (q, [u, v]) = (shown.nearness, shown.lay.way);
    let (q_row, u_row, v_row) = (q.row(y), u.row(y), v.row(y));
    let [u_start, v_start] = shown.lay.start;
    let (width, height) = (u64::from(texture.width), u64::from(texture.height));
    for k in 0..N {
        let x = x + k as f64;
        let nearness = q.slope[0] * x + q_row;
        let depth = 1.0 / nearness;
        let across = (u.slope[0] * x + u_row) * depth + (u_start + PART);
        let down = (v.slope[0] * x + v_row) * depth + (v_start + PART);
        let column = ((across.to_bits() & 0xffff_ffff) * width) >> 32;
        let row = ((down.to_bits() & 0xffff_ffff) * height) >> 32;
        places.at[k] = (row * width + column) as u32;
        places.light[k] = faded(shown.fade, nearness);
        places.repeat[k] = (down.to_bits() >> 32) as u32 ^ (PART.to_bits() >> 32) as u32;
    }
    places
}

/// How many columns apart the sky is asked for; between, its place changes evenly. By less than a twentieth
/// of a column of its picture that is not so: over an angle of α radians it is off by α²/12 of one.
fn stride(view: &View) -> u32 {
    const WIDEST: f64 = 0.06;
    let most = WIDEST / view.fan.across.length();
    [16, 8, 4, 2]
        .into_iter()
        .find(|&n| f64::from(n) <= most)
        .unwrap_or(1)
}

#[inline(always)]
fn sky((world, coats, view): (&World, &Coats, &View), (first, y): (u32, u32), row: &mut [Packed]) {
    let stride = stride(view);
    let mut done = 0;
    while done < row.len() {
        let x = first + done as u32;
        let start = x - x % stride;
        let n = (row.len() - done).min((start + stride - x) as usize);
        let part = &mut row[done..done + n];
        let ends = [start, start + stride].map(|x| view.fan.direction(middle(x, y)));
        match &coats.sky {
            Some(picture) => {
                let [p, mut q] = ends.map(sky_place);
                q.x -= ((q.x - p.x) / SKY_TURN).round() * SKY_TURN;
                for (k, pixel) in part.iter_mut().enumerate() {
                    let at = p.lerp(q, f64::from(x - start + k as u32) / f64::from(stride));
                    let last = (picture.height - 1) as usize;
                    // Straight up there is no row.
                    let line = (at.y.floor().max(-1.0) + 1.0) as usize;
                    let column = at.x.floor() as i64 & (SKY_TURN as i64 - 1);
                    let place = line.min(last) * picture.width as usize + column as usize;
                    *pixel = picture.texels[place];
                }
            }
            None => {
                let [p, q] = ends.map(|d| unpack(coats.sky(world, d)));
                for (k, pixel) in part.iter_mut().enumerate() {
                    let colour = p.lerp(q, f64::from(x - start + k as u32) / f64::from(stride));
                    let [r, g, b] = colour.to_array().map(|c| (c + 0.5) as u32);
                    *pixel = r | g << 8 | b << 16 | 0xff << 24;
                }
            }
        }
        done += n;
    }
}

/// Red, green and blue, 0 to 255.
fn unpack(colour: Packed) -> DVec3 {
    let [r, g, b, _] = colour.to_le_bytes();
    DVec3::new(r.into(), g.into(), b.into())
}
