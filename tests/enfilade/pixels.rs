//! Pixels that can be worked out by hand, one for each formula of the lecture.

use enfilade::level::read;
use enfilade::trace::render::RenderOptions;
use enfilade::trace::shade::{Limits, phong};
use enfilade::trace::shapes::mesh::Points;
use enfilade::trace::world::Files;
use glam::{DVec2, DVec3};

use crate::scene::Scene;

/// A room of 10 by 10 by 4 whose surfaces are as given.
const ROOM: &str = "[[room]]\nname = \"Room\"\nrect = [0, 0, 10, 10]\nceiling = 4\n\
    materials = { walls = \"m\", floor = \"m\", ceiling = \"m\" }\n";

fn material(name: &str, keys: &str) -> String {
    format!("[[material]]\nname = \"{name}\"\n{keys}\n")
}

fn point_light(at: [f64; 3], intensity: f64) -> String {
    format!("[[light]]\nkind = \"point\"\nposition = {at:?}\nintensity = {intensity:?}\n")
}

fn near(found: DVec3, expected: [f64; 3]) {
    let off = (found - DVec3::from(expected)).abs().max_element();
    assert!(off < 1e-4, "{found} instead of {expected:?}");
}

fn usual() -> RenderOptions {
    RenderOptions::default()
}

#[test]
fn diffuse_and_the_square_of_the_distance() {
    let matt = material("m", "kd = [0.8, 0.4, 0.2]");
    for height in [1.0, 2.0, 3.0] {
        let text = format!("{ROOM}{matt}{}", point_light([5.0, 5.0, height], 4.0));
        let scene = Scene::of(&text, 0.0);
        // Straight below: cos = 1.
        let i = 4.0 / (height * height);
        let found = scene.pixel([5.0, 1.0, 1.0], [5.0, 5.0, 0.0], &usual());
        near(found, [0.8 * i, 0.4 * i, 0.2 * i]);
    }
    // Three to the side and two below: d² = 13, cos = 2/√13.
    let text = format!("{ROOM}{matt}{}", point_light([5.0, 5.0, 2.0], 4.0));
    let found = Scene::of(&text, 0.0).pixel([5.0, 1.0, 1.0], [5.0, 8.0, 0.0], &usual());
    let i = 4.0 / 13.0 * 2.0 / 13f64.sqrt();
    near(found, [0.8 * i, 0.4 * i, 0.2 * i]);
}

#[test]
fn several_sources_are_summed() {
    let lights = point_light([5.0, 5.0, 2.0], 4.0) + &point_light([5.0, 8.0, 3.0], 9.0);
    let text = format!("{ROOM}{}{lights}", material("m", "kd = [0.5, 0.5, 0.5]"));
    let found = Scene::of(&text, 0.0).pixel([5.0, 1.0, 1.0], [5.0, 8.0, 0.0], &usual());
    let i = 0.5 * (4.0 / 13.0 * 2.0 / 13f64.sqrt() + 9.0 / 9.0);
    near(found, [i; 3]);
}

#[test]
fn ambient() {
    // The only light is in another room, without a door.
    let other = "[[room]]\nname = \"Other\"\nrect = [20, 0, 30, 10]\nceiling = 4\n";
    let matt = material("m", "kd = [0.8, 0.4, 0.2]");
    let light = point_light([25.0, 5.0, 2.0], 4.0);
    let scene = Scene::of(&format!("{ROOM}{other}{matt}{light}"), 0.25);
    let found = scene.pixel([5.0, 1.0, 1.0], [5.0, 5.0, 0.0], &usual());
    near(found, [0.2, 0.1, 0.05]);
}

#[test]
fn specular() {
    let keys = "kd = [0, 0, 0]\nks = [0.5, 0.25, 1]\nshininess = 10";
    let text = format!(
        "{ROOM}{}{}",
        material("m", keys),
        point_light([5.0, 3.0, 2.0], 8.0)
    );
    let scene = Scene::of(&text, 0.0);
    // Light and eye at 45° on both sides of the normal: R·V = 1; d² = 8.
    let found = scene.pixel([5.0, 7.0, 2.0], [5.0, 5.0, 0.0], &usual());
    near(found, [0.5, 0.25, 1.0]);
    // The eye 15° lower: cos^10 of that.
    let a = 60f64.to_radians();
    let eye = [5.0, 5.0 + 2.0 * a.sin(), 2.0 * a.cos()];
    let found = scene.pixel(eye, [5.0, 5.0, 0.0], &usual());
    let s = 15f64.to_radians().cos().powi(10);
    near(found, [0.5 * s, 0.25 * s, s]);
}

#[test]
fn the_reflection_model_is_reciprocal() {
    let ks = DVec3::new(0.3, 0.6, 0.9);
    let n = DVec3::Z;
    for i in 0..200 {
        let [a, b, c] = [1.0, 2.7, 0.31].map(|k: f64| (f64::from(i) * k).sin());
        let l = DVec3::new(a, b, 0.1 + c.abs()).normalize();
        let v = DVec3::new(c, a, 0.1 + b.abs()).normalize();
        let there = phong((DVec3::ZERO, ks, 7.0), n, l, v);
        let back = phong((DVec3::ZERO, ks, 7.0), n, v, l);
        assert!((there - back).abs().max_element() < 1e-14, "{l} {v}");
        // The lecture's form, by the bisector H: it turns half as fast, so the angle of N to H is
        // half that of R to V where all lie in one plane.
        let (a, b) = (0.9 * a.abs(), 0.9 * b.abs());
        let plane = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos());
        let (l, v) = (plane(a), plane(-b));
        let h = (l + v).normalize();
        let r_v = phong((DVec3::ZERO, DVec3::ONE, 1.0), n, l, v).x;
        assert!((n.dot(h).acos() * 2.0 - r_v.acos()).abs() < 1e-6);
    }
}

#[test]
fn a_shadow_and_its_edge() {
    let matt = material("m", "kd = [0.5, 0.5, 0.5]");
    // A block from x = 4 to 6, 0.5 high, below a lamp at 2: its shadow ends at 5 + 1·2/1.5.
    let block = "[[object]]\nkind = \"box\"\nposition = [5, 5, 0]\nsize = [2, 2, 0.5]\n";
    let text = format!("{ROOM}{matt}{block}{}", point_light([5.0, 5.0, 2.0], 4.0));
    let scene = Scene::of(&text, 0.1);
    let edge = 5.0 + 1.0 * 2.0 / 1.5;
    let at = |x: f64| scene.pixel([9.0, 1.0, 1.5], [x, 5.0, 0.0], &usual());
    near(at(edge - 1e-3), [0.05; 3]);
    let x = edge + 1e-3;
    let d2 = (x - 5.0).powi(2) + 4.0;
    near(at(x), [0.05 + 0.5 * 4.0 / d2 * 2.0 / d2.sqrt(); 3]);
    // Without shadows the light shines through.
    let mut options = usual();
    options.effects = enfilade::trace::effects::Effects::NONE;
    let x = edge - 1e-3;
    let d2 = (x - 5.0).powi(2) + 4.0;
    let found = scene.pixel([9.0, 1.0, 1.5], [x, 5.0, 0.0], &options);
    near(found, [0.05 + 0.5 * 4.0 / d2 * 2.0 / d2.sqrt(); 3]);
}

/// The lecture's example: I1 = Ida1 + ks1·I2, I2 = Ida2 + ks2·I3, I3 = Ida3.
#[test]
fn a_chain_of_three_surfaces() {
    let sheet = |points: &str, material: &str| {
        format!(
            "[[object]]\nkind = \"polygon\"\nposition = [0, 0, 0]\nmaterial = \"{material}\"\n\
             points = {points}\n"
        )
    };
    let text = [
        ROOM,
        &material("m", ""),
        &material(
            "one",
            "kd = [0.3, 0.3, 0.3]\nks = [0.5, 0.5, 0.5]\nshininess = 3\nmirror = 0.5",
        ),
        &material(
            "two",
            "kd = [0.2, 0.2, 0.2]\nks = [0.4, 0.4, 0.4]\nshininess = 2\nmirror = 0.4",
        ),
        &material(
            "three",
            "kd = [0.7, 0.7, 0.7]\nks = [0.2, 0.2, 0.2]\nshininess = 1",
        ),
        // A ray along x from (2, 2) turns at (6, 2) to y, at (6, 6) to -x, and ends at (3, 6).
        &sheet(
            "[[5, 1, 0.5], [7, 3, 0.5], [7, 3, 1.5], [5, 1, 1.5]]",
            "one",
        ),
        &sheet(
            "[[5, 7, 0.5], [7, 5, 0.5], [7, 5, 1.5], [5, 7, 1.5]]",
            "two",
        ),
        &sheet(
            "[[3, 5, 0.5], [3, 7, 0.5], [3, 7, 1.5], [3, 5, 1.5]]",
            "three",
        ),
        &point_light([4.0, 4.0, 1.0], 6.0),
    ]
    .concat();
    let ambient = 0.1;
    let scene = Scene::of(&text, ambient);
    let options = RenderOptions {
        limits: Limits {
            threshold: 0.0,
            ..usual().limits
        },
        ..usual()
    };
    let root = 0.5f64.sqrt();
    // Light along the normal (cos 1), 8 away in the square; R = L, 45° from V.
    let ida1 = 0.3 * ambient + 6.0 / 8.0 * (0.3 + 0.5 * root.powi(3));
    let ida2 = 0.2 * ambient + 6.0 / 8.0 * (0.2 + 0.4 * root.powi(2));
    // Light (1, -2) away, normal x: cos = 1/√5; R = (1, 2)/√5, V = x.
    let cos = 1.0 / 5f64.sqrt();
    let ida3 = 0.7 * ambient + 6.0 / 5.0 * (0.7 * cos + 0.2 * cos);
    let [eye, look] = [[2.0, 2.0, 1.0], [6.0, 2.0, 1.0]];
    let i2 = ida2 + 0.4 * ida3;
    near(scene.pixel(eye, look, &options), [ida1 + 0.5 * i2; 3]);
    // Cut off after one reflection, by depth and by the product of the shares.
    let mut cut = options;
    cut.limits.depth = 1;
    near(scene.pixel(eye, look, &cut), [ida1 + 0.5 * ida2; 3]);
    let mut cut = options;
    cut.limits.threshold = 0.21;
    near(scene.pixel(eye, look, &cut), [ida1 + 0.5 * ida2; 3]);
    cut.limits.threshold = 0.19;
    near(scene.pixel(eye, look, &cut), [ida1 + 0.5 * i2; 3]);
}

#[test]
fn refraction_at_three_angles() {
    let options = usual();
    for degrees in [0.0f64, 30.0, 60.0] {
        for (ior, seen) in [(1.5, true), (1.49, degrees == 0.0)] {
            let a = degrees.to_radians();
            let b = (a.sin() / 1.5).asin();
            // Down through a slab between z = 2 and z = 1, entered at (5, 5).
            let eye = [5.0 - a.tan(), 5.0, 3.0];
            let landing = 5.0 + b.tan() + (1.0 - 0.02) * a.tan();
            let text = [
                ROOM,
                &material("m", ""),
                &material("glass", &format!("kd = [0, 0, 0]\ntransmit = 0.8\nior = {ior}")),
                &material("glow", "kd = [0, 0, 0]\nemission = [3, 2, 1]"),
                "[[object]]\nkind = \"box\"\nposition = [5, 5, 1]\nsize = [8, 2, 1]\nmaterial = \"glass\"\n",
                &format!(
                    "[[object]]\nkind = \"sphere\"\nposition = [{landing:.9}, 5, 0.02]\n\
                     radius = 0.0001\nmaterial = \"glow\"\n"
                ),
                &point_light([1.0, 9.0, 3.0], 0.01),
            ]
            .concat();
            let scene = Scene::of(&text, 0.0);
            let found = scene.pixel(eye, [5.0, 5.0, 2.0], &options);
            let k = 0.8 * 0.8;
            if seen {
                near(found, [3.0 * k, 2.0 * k, k]);
            } else {
                assert!(found.x < 0.1, "{degrees}° with {ior}: {found}");
            }
        }
    }
}

#[test]
fn total_reflection_in_a_prism() {
    // A right-angled prism; rays come in through one short face and must turn to the other.
    let places = [
        [4.0, 4.0, 1.0],
        [6.0, 4.0, 1.0],
        [4.0, 6.0, 1.0],
        [4.0, 4.0, 2.0],
        [6.0, 4.0, 2.0],
        [4.0, 6.0, 2.0],
    ];
    let points = Points {
        places: places.map(DVec3::from).to_vec(),
        triangles: vec![
            [0, 2, 1],
            [3, 4, 5],
            [0, 1, 4],
            [0, 4, 3],
            [1, 2, 5],
            [1, 5, 4],
            [2, 0, 3],
            [2, 3, 5],
        ],
        normals: Vec::new(),
        uv: Vec::<DVec2>::new(),
    };
    let mut files = Files::default();
    files.meshes.insert("prism.obj".to_string(), points);
    let pixel = |ior: f64| {
        let text = [
            ROOM,
            &material("m", "kd = [0, 0, 0]"),
            &material("glass", &format!("kd = [0, 0, 0]\ntransmit = 0.9\nior = {ior}")),
            &material("glow", "kd = [0, 0, 0]\nemission = [1, 1, 1]"),
            "[[object]]\nkind = \"mesh\"\nposition = [0, 0, 0]\nfile = \"prism.obj\"\nmaterial = \"glass\"\n",
            "[[object]]\nkind = \"sphere\"\nposition = [5.25, 2, 1.5]\nradius = 0.001\nmaterial = \"glow\"\n",
            &point_light([1.0, 9.0, 3.0], 0.01),
        ]
        .concat();
        let level = read::read(text.into(), "prism.toml", None).unwrap();
        let scene = Scene::new(level, &files, 0.0);
        // At y = 4.75 along x: the long face is met at x = 5.25.
        scene.pixel([1.0, 4.75, 1.5], [4.0, 4.75, 1.5], &usual())
    };
    // In, reflected, out: three times the share that passes.
    near(pixel(1.5), [0.9f64.powi(3); 3]);
    // 45° is below the critical angle of an index of 1.4 (45.6°): the light goes on and out.
    near(pixel(1.4), [0.0; 3]);
}

#[test]
fn the_penumbra_of_a_disc() {
    // A disc of radius 0.5 at height 3 over the edge of a sheet at height 1 that ends at x = 5: the
    // penumbra reaches 0.5·1/(3 - 1) to both sides.
    let disc = "[[light]]\nkind = \"disc\"\nposition = [5, 5, 3]\ndirection = [0, 0, -1]\n\
        radius = 0.5\nintensity = 4\n";
    let sheet = "[[object]]\nkind = \"polygon\"\nposition = [0, 0, 1]\n\
        points = [[0.5, 0.5, 0], [5, 0.5, 0], [5, 9.5, 0], [0.5, 9.5, 0]]\n";
    let matt = material("m", "kd = [0.5, 0.5, 0.5]");
    let shadowed = Scene::of(&format!("{ROOM}{matt}{disc}{sheet}"), 0.0);
    let free = Scene::of(&format!("{ROOM}{matt}{disc}"), 0.0);
    let options = RenderOptions {
        limits: Limits {
            light_samples: 4096,
            ..usual().limits
        },
        ..usual()
    };
    let share = |x: f64| {
        let [eye, look] = [[8.0, 5.0, 0.5], [x, 5.0, 0.0]];
        let [a, b] = [&shadowed, &free].map(|s| s.pixel(eye, look, &options).x);
        a / b
    };
    assert_eq!(share(4.75 - 1e-6), 0.0, "umbra");
    assert_eq!(share(5.25 + 1e-6), 1.0, "full light");
    assert!((share(5.0) - 0.5).abs() < 0.01, "{}", share(5.0));
    let inside: Vec<f64> = (0..9).map(|i| share(4.76 + 0.06 * f64::from(i))).collect();
    assert!(inside.windows(2).all(|w| w[0] < w[1]), "{inside:?}");
    // At x the disc is cut by a chord at distance 2·(5 - x): the share of the disc beyond it, nearly
    // (the nearer parts are a little brighter).
    let beyond = |c: f64| {
        let c = c / 0.5;
        (c.acos() - c * (1.0 - c * c).sqrt()) / std::f64::consts::PI
    };
    for x in [4.85, 4.95, 5.1] {
        assert!((share(x) - beyond(2.0 * (5.0 - x))).abs() < 0.02, "{x}");
    }
}

#[test]
fn glass_takes_its_share_of_the_light() {
    let pane = "[[room]]\nname = \"Next\"\nrect = [10, 0, 20, 10]\nceiling = 4\n\
        materials = { walls = \"m\", floor = \"m\", ceiling = \"m\" }\n\
        [[window]]\nbetween = [\"Room\", \"Next\"]\nwidth = 8\nsill = 0\nheight = 4\nmaterial = \"glass\"\n";
    let text = [
        ROOM,
        pane,
        &material("m", "kd = [0.5, 0.5, 0.5]"),
        &material("glass", "kd = [0.8, 0.4, 0.4]\ntransmit = 0.6"),
        &point_light([12.0, 5.0, 2.0], 4.0),
    ]
    .concat();
    let scene = Scene::of(&text, 0.0);
    let found = scene.pixel([5.0, 5.0, 1.0], [9.0, 5.0, 0.0], &usual());
    // Red passes by 0.6, the others by half of that.
    let i = 0.5 * 4.0 / 13.0 * 2.0 / 13f64.sqrt();
    near(found, [0.6 * i, 0.3 * i, 0.3 * i]);
    // And seen through the pane, from this side to the floor behind.
    let found = scene.pixel([9.0, 5.0, 1.0], [11.0, 5.0, 0.0], &usual());
    let i = 0.5 * 4.0 / 5.0 * 2.0 / 5f64.sqrt();
    let own = |kd: f64| {
        // The pane itself, lit from behind only, is dark.
        let _ = kd;
        0.0
    };
    near(
        found,
        [0.6 * i + own(0.8), 0.3 * i + own(0.4), 0.3 * i + own(0.4)],
    );
}

#[test]
fn sun_comes_in_through_a_window() {
    let window = "[[window]]\nroom = \"Room\"\nside = \"east\"\nwidth = 2\nsill = 1\nheight = 2\n";
    let sun = "[[light]]\nkind = \"directional\"\ndirection = [-1, 0, -1]\nintensity = 2\n";
    let text = [ROOM, window, &material("m", "kd = [0.5, 0.5, 0.5]"), sun].concat();
    let scene = Scene::of(&text, 0.0);
    let at = |x: f64, y: f64| scene.pixel([2.0, 2.0, 3.0], [x, y, 0.0], &usual());
    // The window's opening is z = 1 to 3 at x = 10: its light falls on x = 9 down to 7, y = 4 to 6.
    let lit = 0.5 * 2.0 * 0.5f64.sqrt();
    near(at(8.0, 5.0), [lit; 3]);
    near(at(8.999, 4.001), [lit; 3]);
    near(at(9.001, 5.0), [0.0; 3]);
    near(at(6.999, 5.0), [0.0; 3]);
    near(at(8.0, 6.001), [0.0; 3]);
    // Through the window one sees the sky, beside it the wall.
    let sky = scene.pixel([5.0, 5.0, 2.0], [10.0, 5.0, 2.0], &usual());
    assert!(sky.z > 0.5 && sky.z > sky.x, "{sky}");
    near(
        scene.pixel([5.0, 5.0, 2.0], [10.0, 5.0, 0.5], &usual()),
        [0.0; 3],
    );
}
