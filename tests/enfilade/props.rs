//! Textures and meshes of the sample levels: what made them.
//!
//! `ENFILADE_WRITE=1 cargo test --release props` writes `levels/textures/*.png` and
//! `levels/objects/*.obj` anew; the difference is to be reviewed. Nothing is drawn at random: noise
//! comes from a hash of whole numbers.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use resvg::tiny_skia::{IntSize, Pixmap};

// ------ noise

/// A number in [0, 1) for a place.
fn hash(x: i64, y: i64, seed: u64) -> f64 {
    let mut z = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ seed.wrapping_mul(0x1656_67b1_9e37_79f9);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// Smooth noise, 0 to 1, that repeats after `period` whole numbers each way.
fn noise(p: DVec2, period: [i64; 2], seed: u64) -> f64 {
    let (x, y) = (p.x.floor(), p.y.floor());
    let (fx, fy) = (smooth(p.x - x), smooth(p.y - y));
    let at = |dx: i64, dy: i64| {
        let (x, y) = (x as i64 + dx, y as i64 + dy);
        hash(x.rem_euclid(period[0]), y.rem_euclid(period[1]), seed)
    };
    mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fy)
}

/// Noise in several sizes, each half as large and half as strong as the last.
fn clouds(p: DVec2, period: i64, octaves: u32, seed: u64) -> f64 {
    let (mut sum, mut all, mut strength, mut scale) = (0.0, 0.0, 1.0, 1i64);
    for octave in 0..octaves {
        let period = [period * scale; 2];
        sum += strength * noise(p * scale as f64, period, seed + u64::from(octave));
        all += strength;
        strength /= 2.0;
        scale *= 2;
    }
    sum / all
}

// ------ textures: a colour (sRGB, 0 to 1) for each place, both coordinates 0 to 1, y downwards

type Colour = [f64; 3];

fn blend(a: Colour, b: Colour, t: f64) -> Colour {
    std::array::from_fn(|i| mix(a[i], b[i], t.clamp(0.0, 1.0)))
}

fn shade(c: Colour, by: f64) -> Colour {
    c.map(|c| c * by)
}

/// Eight oak boards, each with its own tone, joints here and there.
fn planks(p: DVec2) -> Colour {
    let board = (p.y * 8.0).floor();
    let within = p.y * 8.0 - board;
    let start = hash(board as i64, 0, 7);
    let along = (p.x + start).fract();
    let half = (along * 2.0).floor();
    let tone = hash(board as i64, half as i64, 11);
    let seed = 100 + (board * 2.0 + half) as u64;
    let grain = noise(DVec2::new(p.x * 6.0, p.y * 96.0), [6, 96], seed);
    let fine = noise(DVec2::new(p.x * 16.0, p.y * 128.0), [16, 128], seed + 50);
    let rings = ((grain * 3.0 + within * 1.5).fract() * 2.0 - 1.0).abs();
    let wood = blend([0.56, 0.38, 0.22], [0.72, 0.53, 0.33], 0.25 + 0.5 * tone);
    let wood = blend(wood, [0.42, 0.26, 0.14], 0.35 * rings + 0.2 * fine);
    let joint = within < 0.035 || (along * 2.0).fract() < 0.006;
    if joint { shade(wood, 0.45) } else { wood }
}

/// White marble with grey veins.
fn marble(p: DVec2) -> Colour {
    let warp = DVec2::new(clouds(p * 4.0, 4, 4, 21), clouds(p * 4.0, 4, 4, 31));
    let veins = |scale: i64, seed| {
        let v = clouds(p * scale as f64 + warp * 1.5, scale, 3, seed);
        let ridge = 1.0 - (2.0 * v - 1.0).abs();
        let sharp = ridge * ridge * ridge * ridge;
        sharp * sharp * sharp
    };
    let vein = (0.8 * veins(2, 41) + 0.4 * veins(5, 51)).min(1.0);
    let ground = 0.9 + 0.05 * clouds(p * 3.0, 3, 3, 61);
    blend(
        [ground, ground * 0.99, ground * 0.97],
        [0.42, 0.44, 0.47],
        vein,
    )
}

/// Two light and two dark tiles of marble, with joints.
fn chequers(p: DVec2) -> Colour {
    let tile = (p * 2.0).floor();
    let within = p * 2.0 - tile;
    let stone = marble((p * 0.5 + tile * 0.37).fract());
    let edge = within.min(DVec2::ONE - within).min_element();
    let stone = if (tile.x + tile.y) % 2.0 == 0.0 {
        stone
    } else {
        // Black, with white veins.
        let light = (0.95 - stone[0]).max(0.0) * 1.2;
        [0.07 + light * 0.7, 0.07 + light * 0.72, 0.08 + light * 0.75]
    };
    if edge < 0.012 {
        shade(stone, 0.6)
    } else {
        stone
    }
}

/// Evening at the sea.
fn sea(p: DVec2) -> Colour {
    let horizon = 0.58;
    let sun = DVec2::new(0.64, 0.47);
    if p.y < horizon {
        let t = p.y / horizon;
        let sky = blend([0.16, 0.20, 0.42], [0.95, 0.55, 0.30], smooth(t));
        let cloud = clouds(DVec2::new(p.x * 3.0, p.y * 12.0), 64, 4, 71);
        let sky = blend(
            sky,
            [0.98, 0.80, 0.62],
            smooth(((cloud - 0.5) * 3.0).clamp(0.0, 1.0)) * 0.7,
        );
        let d = (p - sun) * DVec2::new(1.33, 1.0);
        let d = d.length();
        if d < 0.055 {
            return [1.0, 0.93, 0.72];
        }
        return blend(
            sky,
            [1.0, 0.85, 0.55],
            0.7 * (1.0 - d / 0.4).max(0.0).powi(2),
        );
    }
    let depth = (p.y - horizon) / (1.0 - horizon);
    let wave = noise(
        DVec2::new(p.x * (10.0 - 6.0 * depth), 60.0 * depth * (1.5 - depth)),
        [64, 64],
        81,
    );
    let water = blend([0.42, 0.36, 0.44], [0.05, 0.12, 0.24], depth);
    let width = 0.03 + 0.16 * depth;
    let glitter = (1.0 - (p.x - sun.x).abs() / width).max(0.0);
    let water = blend(water, [0.02, 0.06, 0.14], 0.5 * wave);
    let lit = if wave > 0.48 {
        glitter.sqrt()
    } else {
        0.15 * glitter
    };
    blend(water, [1.0, 0.78, 0.45], lit)
}

/// Ranges of hills in the morning, each bluer the farther.
fn hills(p: DVec2) -> Colour {
    let mut colour = blend([0.62, 0.78, 0.92], [0.98, 0.93, 0.80], p.y * 1.8);
    for range in 0..5i64 {
        let r = range as f64;
        let height = 0.36 + 0.12 * r;
        let shape = clouds(
            DVec2::new(p.x * (2.0 + r * 0.6) + 7.0 * r, 0.5),
            64,
            5,
            90 + range as u64,
        );
        let top = height - 0.28 * (shape - 0.4);
        if p.y > top {
            let far = [0.55, 0.66, 0.80];
            let near = [0.16, 0.30, 0.14];
            let body = blend(far, near, r / 4.0);
            let mist = (1.0 - (p.y - top) * 5.0).max(0.0);
            let leaves = clouds(p * 24.0, 64, 2, 99) - 0.5;
            colour = shade(
                blend(
                    body,
                    [0.85, 0.88, 0.86],
                    0.25 * (1.0 - mist) * (1.0 - r / 4.0),
                ),
                1.0 + 0.5 * leaves * r / 4.0,
            );
        }
    }
    colour
}

/// A composition of rectangles.
fn fields(p: DVec2) -> Colour {
    const RED: Colour = [0.80, 0.10, 0.08];
    const BLUE: Colour = [0.08, 0.18, 0.50];
    const YELLOW: Colour = [0.95, 0.80, 0.15];
    const WHITE: Colour = [0.93, 0.92, 0.88];
    const BLACK: Colour = [0.07, 0.07, 0.07];
    // left, top, right, bottom
    let fields: [([f64; 4], Colour); 9] = [
        ([0.0, 0.0, 0.26, 0.34], WHITE),
        ([0.26, 0.0, 1.0, 0.62], RED),
        ([0.0, 0.34, 0.26, 0.62], WHITE),
        ([0.0, 0.62, 0.26, 1.0], BLUE),
        ([0.26, 0.62, 0.82, 1.0], WHITE),
        ([0.82, 0.62, 1.0, 0.82], WHITE),
        ([0.82, 0.82, 1.0, 1.0], YELLOW),
        ([0.62, 0.0, 0.82, 0.16], WHITE),
        ([0.82, 0.0, 1.0, 0.16], YELLOW),
    ];
    let mut colour = WHITE;
    for ([left, top, right, bottom], paint) in fields {
        if (left..=right).contains(&p.x) && (top..=bottom).contains(&p.y) {
            let edge = |inner: f64| {
                if inner <= 0.0 || inner >= 1.0 {
                    -1.0
                } else {
                    1.0
                }
            };
            let lines = [
                (p.x - left, left),
                (right - p.x, right),
                (p.y - top, top),
                (bottom - p.y, bottom),
            ];
            let black = lines.iter().any(|&(d, at)| edge(at) > 0.0 && d < 0.014);
            colour = if black { BLACK } else { paint };
        }
    }
    let canvas = 0.97 + 0.03 * noise(p * 96.0, [96, 96], 5);
    shade(colour, canvas)
}

/// Four by three squares with rings in many colours.
fn rings(p: DVec2) -> Colour {
    let at = DVec2::new(p.x * 4.0, p.y * 3.0);
    let square = at.floor();
    let wobble = clouds(p * 6.0, 64, 3, 131) - 0.5;
    let radius = (at - square - 0.5).length() + 0.12 * wobble;
    let ring = (radius * 7.0).floor().min(4.0) as i64;
    let which = (square.x + 4.0 * square.y) as i64;
    let pick = (hash(which, ring, 141) * 8.0) as usize;
    const PAINTS: [Colour; 8] = [
        [0.85, 0.25, 0.15],
        [0.95, 0.70, 0.15],
        [0.15, 0.35, 0.60],
        [0.30, 0.60, 0.50],
        [0.55, 0.20, 0.45],
        [0.92, 0.85, 0.70],
        [0.20, 0.20, 0.30],
        [0.75, 0.45, 0.55],
    ];
    shade(PAINTS[pick], 0.9 + 0.2 * wobble)
}

/// Stained glass: panes around scattered points (Worley, 1996), with lead between them.
fn stained(p: DVec2) -> Colour {
    const PANES: [Colour; 7] = [
        [0.85, 0.12, 0.10],
        [0.12, 0.22, 0.80],
        [0.12, 0.40, 0.90],
        [0.95, 0.72, 0.15],
        [0.15, 0.60, 0.30],
        [0.55, 0.15, 0.60],
        [0.90, 0.88, 0.80],
    ];
    const N: i64 = 7;
    let at = p * N as f64;
    let (mut first, mut second, mut pick) = (f64::MAX, f64::MAX, 0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (x, y) = (at.x.floor() as i64 + dx, at.y.floor() as i64 + dy);
            let (wx, wy) = (x.rem_euclid(N), y.rem_euclid(N));
            let jitter = DVec2::new(hash(wx, wy, 151), hash(wx, wy, 152)) * 0.8 + 0.1;
            let d = (DVec2::new(x as f64, y as f64) + jitter - at).length();
            if d < first {
                (second, first) = (first, d);
                pick = (hash(wx, wy, 153) * 7.0) as usize;
            } else if d < second {
                second = d;
            }
        }
    }
    if second - first < 0.09 {
        return [0.03, 0.03, 0.03];
    }
    shade(PANES[pick], 0.85 + 0.15 * clouds(p * 8.0, 8, 2, 161))
}

/// Colours by place.
type Paint = fn(DVec2) -> Colour;

/// Name, size and colours of every texture.
const TEXTURES: [(&str, [u32; 2], Paint); 8] = [
    ("planks", [256, 256], planks),
    ("marble", [192, 192], marble),
    ("chequers", [192, 192], chequers),
    ("sea", [256, 192], sea),
    ("hills", [256, 192], hills),
    ("fields", [192, 192], fields),
    ("rings", [256, 192], rings),
    ("stained", [192, 192], stained),
];

/// The picture, in steps of 3 of 255, so that it packs well.
fn pixels(size: [u32; 2], colour: Paint) -> Vec<u8> {
    let [width, height] = size;
    let pixel = |i: u32| {
        let at = DVec2::new(f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
        let c = colour(at / DVec2::new(f64::from(width), f64::from(height)));
        let [r, g, b] = c.map(|c| ((c.clamp(0.0, 1.0) * 85.0).round() * 3.0) as u8);
        [r, g, b, 255]
    };
    (0..width * height).flat_map(pixel).collect()
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(name)
}

fn writing() -> bool {
    std::env::var_os("ENFILADE_WRITE").is_some()
}

#[test]
fn props_textures_are_what_their_generator_makes() {
    for (name, size, colour) in TEXTURES {
        let path = folder("textures").join(format!("{name}.png"));
        let made = pixels(size, colour);
        if writing() {
            let size = IntSize::from_wh(size[0], size[1]).expect("a size");
            let picture = Pixmap::from_vec(made.clone(), size).expect("a picture");
            let packed = picture.encode_png().expect("a PNG");
            fs::write(&path, packed).expect("levels/textures can be written");
        }
        let bytes = fs::read(&path).unwrap_or_default();
        assert!(bytes.len() < 100_000, "{name}: {} bytes", bytes.len());
        let found = Pixmap::decode_png(&bytes)
            .map(Pixmap::take)
            .unwrap_or_default();
        assert!(
            found == made,
            "{name}.png is not what its generator makes; ENFILADE_WRITE=1 writes it anew"
        );
    }
}

// ------ meshes

/// A mesh under construction, z up.
#[derive(Default)]
struct Mesh {
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<Vec<usize>>,
}

impl Mesh {
    /// A sheet of rows of points, each row closed in a ring; neighbours in a ring go counterclockwise
    /// seen along the rows' order. Normals are mixed from the faces around.
    fn add_rings(&mut self, rings: &[Vec<DVec3>]) {
        let first = self.points.len();
        let n = rings[0].len();
        self.points.extend(rings.iter().flatten());
        let at = |r: usize, i: usize| first + r * n + i % n;
        let mut normals = vec![DVec3::ZERO; rings.len() * n];
        for r in 0..rings.len() - 1 {
            for i in 0..n {
                let corners = [at(r, i), at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)];
                let [a, b, c, d] = corners.map(|k| self.points[k]);
                let normal = (c - a).cross(d - b);
                for corner in corners {
                    normals[corner - first] += normal;
                }
                // Where a ring is one point, the face is a triangle.
                let mut face = Vec::new();
                for (corner, p) in corners.into_iter().zip([a, b, c, d]) {
                    if face.iter().all(|&f: &usize| self.points[f] != p) {
                        face.push(corner);
                    }
                }
                if face.len() > 2 {
                    self.faces.push(face);
                }
            }
        }
        // All points of a ring that is one point share a normal.
        for (r, ring) in rings.iter().enumerate() {
            if ring.iter().all(|&p| p == ring[0]) {
                let sum: DVec3 = normals[r * n..(r + 1) * n].iter().sum();
                normals[r * n..(r + 1) * n].fill(sum);
            }
        }
        self.normals
            .extend(normals.iter().map(|n| n.normalize_or(DVec3::Z)));
    }

    /// A body of revolution about the z axis: radius and height, from the bottom up outside (and down
    /// again inside).
    fn turn(&mut self, profile: &[DVec2], sides: usize) {
        let ring = |p: &DVec2| -> Vec<DVec3> {
            let corner = |i: usize| {
                let angle = TAU * i as f64 / sides as f64;
                (DVec2::from_angle(angle) * p.x).extend(p.y)
            };
            (0..sides).map(corner).collect()
        };
        let rings: Vec<Vec<DVec3>> = profile.iter().map(ring).collect();
        self.add_rings(&rings);
    }

    /// A tube along a curve in the plane y = 0, with a radius for each point.
    fn tube(&mut self, curve: &[(DVec2, f64)], sides: usize) {
        let n = curve.len();
        let ring = |k: usize| -> Vec<DVec3> {
            let (p, radius) = curve[k];
            let along = curve[(k + 1).min(n - 1)].0 - curve[k.saturating_sub(1)].0;
            let across = along.normalize().perp();
            let corner = |i: usize| {
                let (sin, cos) = (TAU * i as f64 / sides as f64).sin_cos();
                let q = p + across * (radius * cos);
                DVec3::new(q.x, -radius * sin, q.y)
            };
            (0..sides).map(corner).collect()
        };
        let rings: Vec<Vec<DVec3>> = (0..n).map(ring).collect();
        self.add_rings(&rings);
    }

    fn obj(&self, heading: &str) -> String {
        let mut out = format!("# {heading}\n# Made by tests/enfilade/props.rs. z is up.\n");
        for p in &self.points {
            _ = writeln!(out, "v {:.4} {:.4} {:.4}", p.x, p.y, p.z);
        }
        for n in &self.normals {
            _ = writeln!(out, "vn {:.3} {:.3} {:.3}", n.x, n.y, n.z);
        }
        for face in &self.faces {
            out += "f";
            for &corner in face {
                _ = write!(out, " {0}//{0}", corner + 1);
            }
            out += "\n";
        }
        out.replace("-0.0000", "0.0000")
            .replace("-0.000 ", "0.000 ")
            .replace("-0.000\n", "0.000\n")
    }
}

/// A smooth curve through points (Catmull & Rom, 1974), `n` steps between each two.
fn curve(points: &[[f64; 2]], n: usize) -> Vec<DVec2> {
    let p = |i: isize| DVec2::from(points[i.clamp(0, points.len() as isize - 1) as usize]);
    let mut out = vec![p(0)];
    for i in 0..points.len() as isize - 1 {
        let [a, b, c, d] = [p(i - 1), p(i), p(i + 1), p(i + 2)];
        for k in 1..=n {
            let t = k as f64 / n as f64;
            let q = 2.0 * b
                + (c - a) * t
                + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t)
                + (3.0 * b - a - 3.0 * c + d) * (t * t * t);
            out.push(q / 2.0);
        }
    }
    out
}

/// A vase of 0.3 with a wall: closed, so that it can be of glass.
fn vase() -> Mesh {
    let mut profile = curve(
        &[
            [0.0, 0.0],
            [0.05, 0.0],
            [0.062, 0.012],
            [0.095, 0.09],
            [0.08, 0.17],
            [0.042, 0.225],
            [0.04, 0.26],
            [0.064, 0.3],
        ],
        4,
    );
    let inside = curve(
        &[
            [0.06, 0.3],
            [0.035, 0.26],
            [0.036, 0.225],
            [0.072, 0.17],
            [0.086, 0.09],
            [0.05, 0.02],
            [0.0, 0.014],
        ],
        4,
    );
    profile.extend(inside);
    // The axis belongs to it exactly.
    let last = profile.len() - 1;
    for end in [0, last] {
        profile[end].x = 0.0;
    }
    let mut mesh = Mesh::default();
    mesh.turn(&profile, 40);
    mesh
}

/// A teapot: a belly, a lid with a knob, a handle and a spout.
fn teapot() -> Mesh {
    let mut mesh = Mesh::default();
    let mut belly = curve(
        &[
            [0.0, 0.0],
            [0.055, 0.0],
            [0.06, 0.008],
            [0.098, 0.06],
            [0.085, 0.115],
            [0.05, 0.135],
            [0.046, 0.14],
            [0.03, 0.15],
            [0.01, 0.155],
            [0.009, 0.162],
            [0.018, 0.172],
            [0.012, 0.183],
            [0.0, 0.185],
        ],
        3,
    );
    belly[0].x = 0.0;
    mesh.turn(&belly, 40);
    let handle: Vec<(DVec2, f64)> = (0..=16)
        .map(|i| {
            let angle = PI / 2.0 + PI * f64::from(i) / 16.0;
            let ring = DVec2::new(0.062 * angle.cos(), 0.046 * angle.sin());
            (DVec2::new(-0.082, 0.075) + ring, 0.008)
        })
        .collect();
    mesh.tube(&handle, 12);
    let middle = curve(
        &[[0.075, 0.04], [0.115, 0.06], [0.13, 0.1], [0.155, 0.135]],
        5,
    );
    let n = middle.len() as f64 - 1.0;
    let spout: Vec<(DVec2, f64)> = (0..)
        .zip(middle)
        .map(|(i, p)| (p, mix(0.026, 0.010, f64::from(i) / n)))
        .collect();
    mesh.tube(&spout, 16);
    mesh
}

/// A bowl of 0.1 with a wall.
fn bowl() -> Mesh {
    let mut profile = curve(
        &[
            [0.0, 0.0],
            [0.06, 0.0],
            [0.064, 0.012],
            [0.12, 0.05],
            [0.15, 0.1],
        ],
        4,
    );
    profile.extend(curve(
        &[[0.146, 0.1], [0.115, 0.055], [0.06, 0.022], [0.0, 0.016]],
        4,
    ));
    let last = profile.len() - 1;
    for end in [0, last] {
        profile[end].x = 0.0;
    }
    let mut mesh = Mesh::default();
    mesh.turn(&profile, 40);
    mesh
}

/// All numbers of a text, in its order.
fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(|c: char| c.is_whitespace() || c == '/');
    words.filter_map(|w| w.parse().ok()).collect()
}

#[test]
fn props_meshes_are_what_their_generator_makes() {
    let all = [
        (
            "vase",
            vase().obj("A vase, 0.3 high, a closed body of revolution"),
        ),
        (
            "teapot",
            teapot().obj("A teapot, 0.185 high, its spout to the east"),
        ),
        (
            "bowl",
            bowl().obj("A bowl, 0.1 high, a closed body of revolution"),
        ),
    ];
    for (name, text) in all {
        let path = folder("objects").join(format!("{name}.obj"));
        if writing() {
            fs::write(&path, &text).expect("levels/objects can be written");
        }
        let found = fs::read_to_string(&path).unwrap_or_default();
        // Sines and cosines may differ in their last digit from computer to computer.
        let (made, found) = (numbers(&text), numbers(&found));
        let same = made.len() == found.len()
            && made.iter().zip(&found).all(|(a, b)| (a - b).abs() < 0.0011);
        assert!(
            same && made.len() > 1000,
            "{name}.obj is not what its generator makes; ENFILADE_WRITE=1 writes it anew"
        );
    }
}
