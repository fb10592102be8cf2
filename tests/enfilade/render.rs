//! Whole pictures: the same by every way, on any number of threads, with and without what is not seen;
//! and without spots.

use std::fmt::Write;

use enfilade::trace::Tracer;
use enfilade::trace::accel::Kind;
use enfilade::trace::camera::Camera;
use enfilade::trace::effects::{Effect, Effects, survey};
use enfilade::trace::picture::Exposure;
use enfilade::trace::render::{Adaptive, RenderOptions};
use enfilade::trace::shade::Limits;
use glam::DVec3;

use crate::scene::Scene;

const SAMPLES: [&str; 12] = [
    "tiny",
    "museum",
    "cathedral",
    "house",
    "office",
    "maze",
    "enfilade",
    "gallery",
    "mirrors",
    "polished",
    "frosted",
    "still-life",
];

/// Few samples, for speed.
fn quick() -> RenderOptions {
    RenderOptions {
        limits: Limits {
            light_samples: 2,
            scatter_samples: 2,
            ..RenderOptions::default().limits
        },
        ..RenderOptions::default()
    }
}

/// A room `at` some place with every shape and every effect.
fn still_life(at: f64) -> Scene {
    let mut text = format!(
        "[[room]]\nname = \"Room\"\nrect = [{at}, {at}, {}, {}]\nceiling = 4\n\
         [[room]]\nname = \"Next\"\nrect = [{}, {at}, {}, {}]\nceiling = 3\n\
         [[window]]\nbetween = [\"Room\", \"Next\"]\nwidth = 4\nsill = 1\nheight = 1.5\nmaterial = \"frosted\"\n\
         [[archway]]\nbetween = [\"Room\", \"Next\"]\nat = [{}, {}]\nwidth = 1\n\
         [[window]]\nroom = \"Room\"\nside = \"south\"\nwidth = 3\nsill = 1\nheight = 2\n\
         [[material]]\nname = \"chrome\"\nkd = [0.1, 0.1, 0.1]\nks = [0.8, 0.8, 0.8]\nmirror = 0.8\n\
         [[material]]\nname = \"brushed\"\nkd = [0.2, 0.2, 0.2]\nks = [0.8, 0.7, 0.4]\nmirror = 0.6\nroughness = 0.3\n\
         [[material]]\nname = \"glass\"\nkd = [0, 0, 0]\nmirror = 0.1\ntransmit = 0.9\n\
         [[material]]\nname = \"frosted\"\nkd = [0.1, 0.1, 0.1]\ntransmit = 0.8\nroughness = 0.2\n\
         [[light]]\nkind = \"directional\"\ndirection = [0.2, 1, -0.8]\nintensity = 1\n",
        at + 10.0,
        at + 8.0,
        at + 10.0,
        at + 16.0,
        at + 8.0,
        at + 10.0,
        at + 7.0,
    );
    let mut object = |kind: &str, [x, y, z]: [f64; 3], keys: &str, material: &str| {
        _ = write!(
            text,
            "[[object]]\nkind = \"{kind}\"\nposition = [{}, {}, {z}]\n{keys}\nmaterial = \"{material}\"\n",
            at + x,
            at + y
        );
    };
    object("sphere", [5.0, 4.0, 0.8], "radius = 0.8", "glass");
    object("sphere", [5.0, 4.0, 0.8], "radius = 0.3", "chrome");
    object(
        "box",
        [7.0, 5.5, 0.0],
        "size = [1, 1, 2]\nrotation = [0, 0, 30]",
        "chrome",
    );
    object("box", [8.5, 1.5, 0.0], "size = [1, 1, 1]", "brushed");
    object(
        "cylinder",
        [6.0, 2.0, 0.0],
        "radius = 0.4\nheight = 1.5",
        "glass",
    );
    object(
        "cone",
        [3.0, 6.0, 0.0],
        "radius = 0.7\nheight = 1.6",
        "brushed",
    );
    object(
        "sphere",
        [10.0, 4.0, 0.5],
        "radius = 0.5\nscale = [1, 2, 1]",
        "brushed",
    );
    object(
        "polygon",
        [9.0, 6.5, 1.0],
        "points = [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0.4, 0.4], [0, 0, 1]]",
        "chrome",
    );
    for i in 0..12 {
        let x = 1.0 + 0.7 * f64::from(i);
        object(
            "sphere",
            [x, 7.4, 0.2],
            "radius = 0.2",
            ["glass", "brushed", "chrome"][i as usize % 3],
        );
    }
    _ = write!(
        text,
        "[[light]]\nkind = \"sphere\"\nposition = [{}, {}, 3]\nradius = 0.3\nintensity = 5\n\
         [[light]]\nkind = \"rectangle\"\nposition = [{}, {}, 3]\nedges = [[0, 1, 0], [1, 0, 0]]\nintensity = 4\n\
         [[camera]]\nname = \"all\"\neye = [{}, {}, 1.7]\nlook = [{}, {}, 0.7]\nfov = 80\n",
        at + 4.0,
        at + 2.0,
        at + 13.0,
        at + 4.0,
        at + 0.5,
        at + 1.0,
        at + 7.0,
        at + 5.0,
    );
    Scene::of(&text, 0.12)
}

/// Checks that pictures are the same to the last bit.
fn same(one: &[DVec3], two: &[DVec3], what: &str) {
    assert_eq!(one.len(), two.len());
    let differ = one.iter().zip(two).filter(|(a, b)| a != b).count();
    let first = one.iter().zip(two).position(|(a, b)| a != b);
    assert!(
        differ == 0,
        "{what}: {differ} pixels differ, first {:?}",
        first.map(|i| (i, one[i], two[i]))
    );
}

/// The picture by the walk is that by brute force, and by every structure.
fn every_way(scene: &Scene, cameras: &[Camera], kinds: &[Kind], what: &str) {
    let options = quick();
    let walk = Tracer::new(&scene.world);
    let tracers: Vec<(String, Tracer)> = kinds
        .iter()
        .map(|&kind| match kind {
            Kind::Brute => ("brute".to_string(), Tracer::brute(&scene.world)),
            _ => (kind.to_string(), Tracer::with_structure(&scene.world, kind)),
        })
        .collect();
    for camera in cameras {
        let expected = scene.render_by(&walk, camera, &options);
        assert!(expected.picture.pixels.iter().all(|p| p.is_finite()));
        for (name, tracer) in &tracers {
            let found = scene.render_by(tracer, camera, &options);
            let what = format!("{what} by {name} from {}", camera.eye);
            same(&expected.picture.pixels, &found.picture.pixels, &what);
            assert_eq!(expected.work.rays, found.work.rays, "{what}");
        }
    }
}

#[test]
fn the_same_picture_by_every_way() {
    let size = [36, 24];
    let scene = still_life(0.0);
    every_way(
        &scene,
        &[scene.camera(0, [60, 40])],
        &Kind::ALL,
        "still life",
    );
    for name in ["museum", "cathedral"] {
        let scene = Scene::sample(name);
        let cameras: Vec<Camera> = (0..2).map(|i| scene.camera(i, size)).collect();
        every_way(&scene, &cameras, &Kind::ALL, name);
    }
    if let Some(scene) = Scene::freedoom("E1M1") {
        every_way(&scene, &scene.cameras_about(90, size), &Kind::ALL, "E1M1");
    }
}

#[test]
fn beams_and_single_rays_give_the_same_picture() {
    for scene in [still_life(0.0), Scene::sample("cathedral")] {
        let camera = scene.camera(0, [64, 48]);
        let whole = scene.render(&camera, &quick()).picture;
        let brute = scene.render_by(&Tracer::brute(&scene.world), &camera, &quick());
        same(&whole.pixels, &brute.picture.pixels, "beams");
    }
}

#[test]
fn the_same_picture_on_one_thread_and_two_and_again() {
    let scene = still_life(0.0);
    let camera = scene.camera(0, [90, 60]);
    let options = RenderOptions {
        samples: 4,
        adaptive: Some(Adaptive {
            samples: 9,
            contrast: 0.05,
            exposure: Exposure::Auto,
        }),
        ..quick()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| scene.render(&camera, &options))
    };
    let one = on(1);
    assert!(one.refined > 500, "{}", one.refined);
    for threads in [2, 2, 1] {
        let again = on(threads);
        same(&one.picture.pixels, &again.picture.pixels, "threads");
        assert_eq!(one.work.rays, again.work.rays);
    }
    let other = RenderOptions { seed: 2, ..options };
    assert_ne!(one.picture, scene.render(&camera, &other).picture);
}

#[test]
fn what_is_left_out_changes_nothing() {
    let mut left_out = 0;
    let mut compare = |scene: &Scene, camera: &Camera, name: &str| {
        let needed = survey(&scene.world, &scene.pvs, scene.cell(camera.eye)).needed;
        let with = |effects| scene.render(camera, &RenderOptions { effects, ..quick() });
        let [auto, all] = [needed, Effects::ALL].map(with);
        same(&auto.picture.pixels, &all.picture.pixels, name);
        assert_eq!(auto.work.rays, all.work.rays, "{name}");
        left_out += Effect::ALL.len() - needed.iter().count();
    };
    for name in SAMPLES {
        let scene = Scene::sample(name);
        for camera in 0..scene.level.scene.cameras.len() {
            compare(&scene, &scene.camera(camera, [72, 48]), name);
        }
    }
    let scene = still_life(0.0);
    compare(&scene, &scene.camera(0, [72, 48]), "still life");
    if let Some(scene) = Scene::freedoom("E1M1") {
        for camera in scene.cameras_about(60, [72, 48]) {
            compare(&scene, &camera, "E1M1");
        }
    }
    assert!(left_out > 40, "{left_out}");
}

/// Scenes call for the effects that they are there to show, from their first camera.
#[test]
fn scenes_show_their_effects() {
    use Effect::{Glossy, Mirror, Refraction, Shadows, Soft, Textures, Translucency};
    let scenes: [(&str, &[Effect]); 6] = [
        ("gallery", &[Shadows, Soft, Mirror, Refraction, Textures]),
        ("mirrors", &[Shadows, Soft, Mirror, Textures]),
        ("polished", &[Shadows, Soft, Glossy, Textures]),
        (
            "frosted",
            &[Shadows, Soft, Refraction, Translucency, Textures],
        ),
        (
            "still-life",
            &[Shadows, Soft, Mirror, Glossy, Refraction, Textures],
        ),
        ("cathedral", &[Shadows, Soft, Textures]),
    ];
    for (name, effects) in scenes {
        let scene = Scene::sample(name);
        let camera = scene.camera(0, [36, 24]);
        let needed = survey(&scene.world, &scene.pvs, scene.cell(camera.eye)).needed;
        for &effect in effects {
            assert!(needed.has(effect), "{name}: {}", effect.as_str());
        }
        every_way(&scene, &[camera], &[Kind::Brute], name);
    }
}

#[test]
fn a_mirror_shows_more_than_the_eye_sees() {
    // A and C lie on one side of B: from A one sees C only in the mirror on B's other side.
    let text = |mirror: &str| {
        format!(
            "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n[[room]]\nname = \"B\"\nrect = [4, 0, 8, 8]\n\
             [[room]]\nname = \"C\"\nrect = [0, 4, 4, 8]\n\
             [[archway]]\nbetween = [\"A\", \"B\"]\nat = [4, 1]\nwidth = 0.8\n\
             [[archway]]\nbetween = [\"B\", \"C\"]\nat = [4, 7]\nwidth = 0.8\n\
             [[material]]\nname = \"glass\"\nkd = [0.1, 0.1, 0.1]\nmirror = {mirror}\n\
             [[material]]\nname = \"prism\"\ntransmit = 0.9\n\
             [[object]]\nkind = \"box\"\nposition = [7.9, 4, 0]\nsize = [0.1, 7, 2]\nmaterial = \"glass\"\n\
             [[object]]\nname = \"ball\"\nkind = \"sphere\"\nposition = [2, 6, 1]\nradius = 0.3\nmaterial = \"prism\"\n\
             [[light]]\nkind = \"point\"\nposition = [2, 2, 2]\nintensity = 3\n"
        )
    };
    let eye = DVec3::new(0.5, 0.7, 1.5);
    let found = |mirror: &str| {
        let scene = Scene::of(&text(mirror), 0.1);
        let survey = survey(&scene.world, &scene.pvs, scene.cell(eye));
        survey
            .verdicts
            .into_iter()
            .find(|v| v.effect == Effect::Refraction)
            .unwrap()
    };
    let plain = found("0.0");
    assert!(!plain.needed, "{}", plain.reason);
    assert!(plain.reason.contains("`prism`"), "{}", plain.reason);
    let mirrored = found("0.9");
    assert!(mirrored.needed, "{}", mirrored.reason);
    assert!(
        mirrored.reason.contains("sphere `ball`") && mirrored.reason.contains("by way of"),
        "{}",
        mirrored.reason
    );
}

/// In an empty convex room nothing is in the way of any light, at however flat an angle.
#[test]
fn no_spots_on_walls_and_floors() {
    for at in [0.0, 1e6] {
        // Lamps so low, and so near to the walls, that light only just grazes them.
        let text = format!(
            "[[room]]\nname = \"Room\"\n\
             outline = [[{at}, {at}], [{}, {at}], [{}, {}], [{}, {}], [{at}, {}]]\nceiling = 3\n\
             [[light]]\nkind = \"point\"\nposition = [{}, {}, 0.000001]\nintensity = 9\n\
             [[light]]\nkind = \"point\"\nposition = [{}, {}, 2.999999]\nintensity = 9\n\
             [[light]]\nkind = \"disc\"\nposition = [{}, {}, 3]\ndirection = [0, 0, -1]\nradius = 1\nintensity = 9\n",
            at + 9.0,
            at + 10.0,
            at + 4.0,
            at + 7.0,
            at + 9.0,
            at + 8.0,
            at + 3.0,
            at + 3.0,
            at + 0.000_1,
            at + 4.0,
            at + 5.0,
            at + 4.0,
        );
        let scene = Scene::of(&text, 0.1);
        for z in [0.001, 1.5, 2.999] {
            for look in [[9.0, 9.0, 0.0], [0.0, 8.0, 3.0], [9.0, 0.5, 1.0]] {
                let eye = DVec3::new(at + 2.0, at + 2.5, z);
                let look = DVec3::from(look) + DVec3::new(at, at, 0.0);
                let camera = Camera::new(eye, look - eye, 100.0, [120, 80]);
                let with = |effects| scene.render(&camera, &RenderOptions { effects, ..quick() });
                let shadows = Effects::NONE.with(Effect::Soft);
                let [with, without] = [shadows.with(Effect::Shadows), shadows].map(with);
                assert!(with.work.rays.shadow > 9000);
                same(&with.picture.pixels, &without.picture.pixels, "spots");
            }
        }
    }
}

/// What faces the only light is lit: no shape shades itself there.
#[test]
fn no_spots_on_shapes() {
    for at in [0.0, 1e6] {
        for keys in [
            "kind = \"sphere\"\nradius = 1",
            "kind = \"sphere\"\nradius = 1\nscale = [1, 0.5, 0.7]",
            "kind = \"box\"\nsize = [1, 1.5, 1]",
            "kind = \"box\"\nsize = [1, 1.5, 1]\nrotation = [20, 30, 40]",
            "kind = \"cylinder\"\nradius = 0.7\nheight = 1\nrotation = [10, 0, 0]",
            "kind = \"cone\"\nradius = 0.7\nheight = 1.3",
        ] {
            let text = format!(
                "[[room]]\nname = \"Room\"\nrect = [{at}, {at}, {}, {}]\nceiling = 6\n\
                 [[object]]\n{keys}\nposition = [{}, {}, 2]\n\
                 [[light]]\nkind = \"point\"\nposition = [{}, {}, 4]\nintensity = 9\n",
                at + 8.0,
                at + 8.0,
                at + 4.0,
                at + 4.0,
                at + 1.0,
                at + 5.0,
            );
            let scene = Scene::of(&text, 0.0);
            for eye in [[1.0, 2.0, 3.0], [7.0, 6.0, 1.0], [4.0, 7.5, 5.5]] {
                let eye = DVec3::from(eye) + DVec3::new(at, at, 0.0);
                let look = DVec3::new(at + 4.0, at + 4.0, 2.4);
                let camera = Camera::new(eye, look - eye, 28.0, [80, 80]);
                let with = |effects| scene.render(&camera, &RenderOptions { effects, ..quick() });
                let one = with(Effects::NONE.with(Effect::Shadows)).picture;
                let two = with(Effects::NONE).picture;
                // Seen from the eye only the object and what is behind it: the walls may be shaded,
                // the object may not.
                let tracer = Tracer::new(&scene.world);
                let from = enfilade::trace::world::Departure::within(scene.cell(eye));
                let mut n = 0;
                for i in 0..80 * 80u32 {
                    let place = enfilade::trace::beam::middle(i % 80, i / 80);
                    let ray = camera.ray(place);
                    let Some(met) = tracer.nearest(&ray, &from, f64::INFINITY) else {
                        panic!("nothing met")
                    };
                    if matches!(met, enfilade::trace::world::meet::Meeting::Object(..)) {
                        n += 1;
                        assert_eq!(
                            one.pixels[i as usize], two.pixels[i as usize],
                            "{keys} at {at}"
                        );
                    }
                }
                assert!(n > 300, "{keys}: {n}");
            }
        }
    }
}

#[test]
fn far_away_as_near() {
    let [near, far] = [0.0, 1e6].map(|at| {
        let scene = still_life(at);
        scene.render(&scene.camera(0, [90, 60]), &quick()).picture
    });
    let pairs = near.pixels.iter().zip(&far.pixels);
    let off = pairs
        .filter(|(a, b)| (**a - **b).abs().max_element() > 1e-3)
        .count();
    // Only where an edge passes through the middle of a pixel.
    assert!(off < 27, "{off} of 5400 pixels differ");
}

#[test]
fn adaptive_samples_go_where_neighbours_differ() {
    let scene = Scene::sample("tiny");
    let camera = scene.camera(0, [90, 60]);
    let adaptive = |contrast| RenderOptions {
        adaptive: Some(Adaptive {
            samples: 8,
            contrast,
            exposure: Exposure::Auto,
        }),
        ..quick()
    };
    let some = scene.render(&camera, &adaptive(0.1));
    assert!(some.refined > 50 && some.refined < 2700, "{}", some.refined);
    assert_eq!(some.work.rays.primary, 5400 + 7 * some.refined);
    let none = scene.render(&camera, &adaptive(2.0));
    assert_eq!(none.refined, 0);
    let plain = scene.render(&camera, &quick());
    same(&none.picture.pixels, &plain.picture.pixels, "none refined");
    // Nearer to the picture of many samples than without.
    let many = scene.render(
        &camera,
        &RenderOptions {
            samples: 64,
            ..quick()
        },
    );
    let error = |picture: &[DVec3]| -> f64 {
        let pairs = picture.iter().zip(&many.picture.pixels);
        pairs.map(|(a, b)| (*a - *b).length_squared()).sum()
    };
    let [refined, plain] = [&some, &plain].map(|r| error(&r.picture.pixels));
    assert!(refined < 0.5 * plain, "{refined} and {plain}");
}
