// What a polygon or an object looks like on the screen: the software painter's rules (src/preview/fill.rs,
// src/preview/objects.rs), in whole numbers where that one counts in whole numbers.

struct Globals {
    // Products with a point's way from the eye: across and up in the picture, times the depth; the depth.
    across: vec4<f32>,
    up: vec4<f32>,
    depth: vec4<f32>,
    // The eye; and in w how near to it nothing is drawn any more.
    eye: vec4<f32>,
    // The distance at which half of the light is lost that is ever lost; the share that remains far away;
    // whether pictures are smoothed where they are small; the row of the sky at the horizon.
    light: vec4<f32>,
    // Of the sky: where its texels begin, columns, rows, whether it is a picture.
    sky: vec4<u32>,
}

@group(0) @binding(0) var<uniform> globals: Globals;
// All texels, one after the other.
@group(0) @binding(1) var texels: texture_2d<u32>;

const COLOUR: u32 = 0u;
const PICTURE: u32 = 1u;
const GRATING: u32 = 2u;
const SKY: u32 = 3u;
const GLASS: u32 = 4u;
const STAINED: u32 = 5u;
const THING: u32 = 6u;
const THING_PICTURE: u32 = 7u;
const THING_GLASS: u32 = 8u;

struct Corner {
    @location(0) place: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) normal: vec4<f32>,
    @location(3) paint: vec4<u32>,
    @location(4) light: f32,
}

struct Spot {
    @invariant @builtin(position) at: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) normal: vec3<f32>,
    // From the eye.
    @location(2) way: vec3<f32>,
    @location(3) @interpolate(flat) paint: vec4<u32>,
    @location(4) @interpolate(flat) light: f32,
}

@vertex
fn corner(in: Corner) -> Spot {
    let way = in.place - globals.eye.xyz;
    var out: Spot;
    let depth = dot(globals.depth.xyz, way);
    // One over the depth, as far as a depth buffer is concerned: 1 as near as it goes.
    out.at = vec4(dot(globals.across.xyz, way), dot(globals.up.xyz, way), globals.eye.w, depth);
    out.uv = in.uv;
    out.normal = in.normal.xyz;
    out.way = way;
    out.paint = in.paint;
    out.light = in.light;
    return out;
}

fn load(address: u32) -> vec4<u32> {
    let width = textureDimensions(texels).x;
    return textureLoad(texels, vec2(address % width, address / width), 0);
}

fn unpack(colour: u32) -> vec4<u32> {
    return (vec4(colour) >> vec4(0u, 8u, 16u, 24u)) & vec4(255u);
}

// The light of a nearness, in 256ths.
fn faded(light: f32, nearness: f32) -> u32 {
    let most = light * 256.0;
    let loss = most * (1.0 - globals.light.y);
    let left = most - loss / (1.0 + globals.light.x * nearness);
    return u32(round(clamp(left, 0.0, most)));
}

fn dim(colour: vec4<u32>, share: u32) -> vec3<u32> {
    return (colour.rgb * share) >> vec3(8u);
}

fn bytes(colour: vec3<u32>) -> vec4<f32> {
    return vec4(vec3<f32>(min(colour, vec3(255u))) / 255.0, 1.0);
}

// Where a texture's smaller copy lies: first texel, columns and rows.
fn copy_of(paint: vec4<u32>, level: u32) -> vec3<u32> {
    var found = paint.yzw;
    for (var i = 0u; i < level; i++) {
        found.x += found.y * found.z;
        found.y = max(found.y / 2u, 1u);
        found.z = max(found.z / 2u, 1u);
    }
    return found;
}

// The texel at a place counted in repetitions.
fn nearest(found: vec3<u32>, uv: vec2<f32>) -> vec4<u32> {
    let part = uv - floor(uv);
    let size = vec2<f32>(found.yz);
    let at = min(vec2<u32>(part * size), found.yz - 1u);
    return load(found.x + at.y * found.y + at.x);
}

// Mixed from the four texels around a place.
fn mixed(found: vec3<u32>, uv: vec2<f32>) -> vec4<u32> {
    let size = vec2<i32>(found.yz);
    let at = (uv - floor(uv)) * vec2<f32>(found.yz) - 0.5;
    let low = floor(at);
    let part = at - low;
    let first = (vec2<i32>(low) + size) % size;
    let next = (first + 1) % size;
    let width = size.x;
    let a = vec4<f32>(load(found.x + u32(first.y * width + first.x)));
    let b = vec4<f32>(load(found.x + u32(first.y * width + next.x)));
    let c = vec4<f32>(load(found.x + u32(next.y * width + first.x)));
    let d = vec4<f32>(load(found.x + u32(next.y * width + next.x)));
    return vec4<u32>(mix(mix(a, b, part.x), mix(c, d, part.x), part.y) + 0.5);
}

// A picture's colour at a place, `detail` being the logarithm of how many texels a pixel covers.
fn picture(paint: vec4<u32>, uv: vec2<f32>, detail: f32) -> vec4<u32> {
    if globals.light.z == 0.0 || detail < 0.5 {
        return nearest(paint.yzw, uv);
    }
    let last = firstLeadingBit(max(paint.z, paint.w));
    let level = min(u32(detail + 0.5), last);
    return mixed(copy_of(paint, level), uv);
}

fn sky(way: vec3<f32>) -> vec3<u32> {
    let sky = globals.sky;
    if sky.w == 0u {
        // By the root of the upward part, evenly.
        let up = sqrt(max(normalize(way).z, 0.0)) * f32(sky.y - 1u);
        let low = min(u32(up), sky.y - 2u);
        let a = vec4<f32>(load(sky.x + low));
        let b = vec4<f32>(load(sky.x + low + 1u));
        return vec3<u32>(mix(a, b, up - f32(low)).rgb + 0.5);
    }
    let turn = f32(sky.y);
    let circle = 6.283185307179586;
    let column = atan2(way.y, way.x) / circle * turn;
    let row = globals.light.w - way.z / max(length(way.xy), 1e-20) * (turn / circle);
    let x = u32(i32(floor(column)) & i32(sky.y - 1u));
    let y = u32(clamp(floor(row), -1.0, f32(sky.z) - 2.0) + 1.0);
    return load(sky.x + y * sky.y + x).rgb;
}

// How bright an object is: `slope` of src/preview/coat.rs, and brighter what faces the eye.
fn facing(in: Spot) -> vec2<f32> {
    let normal = normalize(in.normal);
    let facing = max(dot(normal, -normalize(in.way)), 0.0);
    let slope = 0.8 + 0.12 * dot(normal.xy, vec2(0.6, -0.8)) + 0.2 * normal.z;
    return vec2(min(slope * (0.6 + 0.4 * facing) * in.light, 1.0), facing);
}

// What covers what was painted before.
@fragment
fn solid(in: Spot) -> @location(0) vec4<f32> {
    let size = vec2<f32>(in.paint.zw);
    let dx = dpdx(in.uv) * size;
    let dy = dpdy(in.uv) * size;
    let detail = 0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1e-12));
    let nearness = in.at.w;
    switch in.paint.x {
        case SKY: {
            return bytes(sky(in.way));
        }
        case THING: {
            let light = facing(in).x;
            return bytes(dim(unpack(in.paint.y), faded(light, nearness)));
        }
        case THING_PICTURE: {
            let light = facing(in).x;
            return bytes(dim(mixed(in.paint.yzw, in.uv), faded(light, nearness)));
        }
        case PICTURE: {
            return bytes(dim(picture(in.paint, in.uv, detail), faded(in.light, nearness)));
        }
        case GRATING: {
            let texel = picture(in.paint, in.uv, detail);
            if in.uv.y < 0.0 || in.uv.y >= 1.0 || texel.a < 128u {
                discard;
            }
            return bytes(dim(texel, faded(in.light, nearness)));
        }
        default: {
            return bytes(dim(unpack(in.paint.y), faded(in.light, nearness)));
        }
    }
}

// What share of each channel passes through glass.
@fragment
fn tint(in: Spot) -> @location(0) vec4<f32> {
    var tint = unpack(in.paint.y);
    if in.paint.x == STAINED {
        tint = nearest(in.paint.yzw, in.uv);
    }
    return vec4((vec3<f32>(tint.rgb) + 1.0) / 256.0, 1.0);
}

// What glass adds.
@fragment
fn add(in: Spot) -> @location(0) vec4<f32> {
    if in.paint.x == STAINED {
        return vec4(0.0);
    }
    if in.paint.x == THING_GLASS {
        let facing = facing(in);
        // At its rim one sees more of the glass itself.
        let rim = u32(pow(1.0 - facing.y, 3.0) * 120.0);
        let own = unpack(in.paint.z) | vec4(rim);
        return bytes(dim(own, faded(facing.x, in.at.w)));
    }
    return bytes(unpack(in.paint.z).rgb);
}
