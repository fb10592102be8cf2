//! What stands in a level: materials, lights, objects, cameras, paths and the budget.

use std::collections::BTreeSet;

use super::super::super::model::Level;
use super::super::super::scene::{
    Camera, CameraPath, Light, LightShape, Material, Object, PathLook, PathPace, Shape,
};
use super::super::furnish::{
    USUAL_DIFFUSE, USUAL_FOV, USUAL_IOR, USUAL_SHININESS, USUAL_SPOT_ANGLE,
};
use super::text::{Text, number, numbers, point, point3};

/// Writes everything that is no plan.
pub(super) fn scene(text: &mut Text, level: &Level, left_out: &mut Vec<String>) {
    let scene = &level.scene;
    let budget = &scene.budget;
    if *budget != Default::default() {
        text.head("[budget]");
        let count = |n: Option<u64>| n.map(|n| n.to_string());
        for (key, value) in [
            ("max_visible_cells", count(budget.max_visible_cells)),
            ("max_visible_walls", count(budget.max_visible_walls)),
            ("max_density", budget.max_density.map(number)),
        ] {
            if let Some(value) = value {
                text.key(key, &value);
            }
        }
    }
    for m in &scene.materials {
        material(text, m);
    }
    let mere_names = mere_names(level);
    for name in &mere_names {
        text.head("[[material]]");
        text.string("name", Some(name));
    }
    if !scene.dress.is_empty() {
        left_out.push("the textures of walls, and the sky".into());
    }
    if !mere_names.is_empty() {
        left_out.push(
            "the pictures on floors and ceilings; their names are kept as materials, to which a \
             `texture` can be given"
                .into(),
        );
    }
    for l in &scene.lights {
        light(text, l);
    }
    for o in &scene.objects {
        object(text, o, &scene.materials);
    }
    for c in &scene.cameras {
        camera(text, c);
    }
    for p in &scene.paths {
        path(text, p);
    }
}

/// Names on floors and ceilings that are no materials of the level.
fn mere_names(level: &Level) -> BTreeSet<&str> {
    let known = |name: &str| level.scene.materials.iter().any(|m| m.name == name);
    (level.sectors.iter())
        .flat_map(|s| [&s.floor_material, &s.ceiling_material])
        .filter_map(|name| name.as_deref())
        .filter(|name| !known(name))
        .collect()
}

fn material(text: &mut Text, m: &Material) {
    text.head("[[material]]");
    text.string("name", Some(&m.name));
    for (key, value, usual) in [
        ("kd", m.diffuse, USUAL_DIFFUSE),
        ("ks", m.specular, 0.0),
        ("emission", m.emission, 0.0),
    ] {
        if value != [usual; 3] {
            text.key(key, &numbers(&value));
        }
    }
    text.unusual("shininess", m.shininess, USUAL_SHININESS);
    text.unusual("mirror", m.mirror, 0.0);
    text.unusual("transmit", m.transmit, 0.0);
    text.unusual("ior", m.ior, USUAL_IOR);
    text.unusual("roughness", m.roughness, 0.0);
    if let Some(texture) = &m.texture {
        text.string("texture", Some(&texture.file));
        text.unusual("texture_scale", texture.scale, 1.0);
    }
}

fn light(text: &mut Text, l: &Light) {
    text.head("[[light]]");
    text.string("name", l.name.as_deref());
    let kind = match l.shape {
        LightShape::Point { .. } => "point",
        LightShape::Spot { .. } => "spot",
        LightShape::Directional { .. } => "directional",
        LightShape::Rectangle { .. } => "rectangle",
        LightShape::Disc { .. } => "disc",
        LightShape::Sphere { .. } => "sphere",
    };
    text.string("kind", Some(kind));
    match &l.shape {
        LightShape::Point { position } => text.key("position", &point3(*position)),
        LightShape::Spot {
            position,
            direction,
            angle,
            inner,
        } => {
            text.key("position", &point3(*position));
            text.key("direction", &point3(*direction));
            text.unusual("angle", *angle, USUAL_SPOT_ANGLE);
            text.unusual("inner", *inner, 0.0);
        }
        LightShape::Directional { direction } => text.key("direction", &point3(*direction)),
        LightShape::Rectangle { center, edges } => {
            text.key("position", &point3(*center));
            text.list("edges", &edges.map(point3));
        }
        LightShape::Disc {
            center,
            direction,
            radius,
        } => {
            text.key("position", &point3(*center));
            text.key("direction", &point3(*direction));
            text.number("radius", Some(*radius));
        }
        LightShape::Sphere { center, radius } => {
            text.key("position", &point3(*center));
            text.number("radius", Some(*radius));
        }
    }
    let (color, intensity) = color(l.intensity);
    if color != [1.0; 3] {
        text.key("color", &numbers(&color));
    }
    text.unusual("intensity", intensity, 1.0);
}

/// Colour and intensity whose product is exactly the light's; a colour within 0 to 1 if one is.
fn color(light: [f64; 3]) -> ([f64; 3], f64) {
    let most = light.into_iter().fold(0.0, f64::max);
    let shares = light.map(|c| c / most);
    if shares.map(|c| c * most) == light {
        (shares, most)
    } else {
        (light, 1.0)
    }
}

fn object(text: &mut Text, o: &Object, materials: &[Material]) {
    text.head("[[object]]");
    text.string("name", o.name.as_deref());
    let kind = match o.shape {
        Shape::Sphere { .. } => "sphere",
        Shape::Box { .. } => "box",
        Shape::Cylinder { .. } => "cylinder",
        Shape::Cone { .. } => "cone",
        Shape::Polygon { .. } => "polygon",
        Shape::Mesh { .. } => "mesh",
    };
    text.string("kind", Some(kind));
    match &o.shape {
        Shape::Sphere { radius } => text.number("radius", Some(*radius)),
        Shape::Box { size } => text.key("size", &point3(*size)),
        Shape::Cylinder { radius, height } | Shape::Cone { radius, height } => {
            text.number("radius", Some(*radius));
            text.number("height", Some(*height));
        }
        Shape::Polygon { points } => {
            let points: Vec<String> = points.iter().map(|p| point3(*p)).collect();
            text.list("points", &points);
        }
        Shape::Mesh { file } => text.string("file", Some(file)),
    }
    text.key("position", &point3(o.position));
    if o.rotation != glam::DVec3::ZERO {
        text.key("rotation", &point3(o.rotation));
    }
    let [x, y, z] = o.scale.to_array();
    if x == y && y == z {
        text.unusual("scale", x, 1.0);
    } else {
        text.key("scale", &point3(o.scale));
    }
    let material = o.material.and_then(|id| materials.get(id.0 as usize));
    text.string("material", material.map(|m| &*m.name));
}

fn camera(text: &mut Text, c: &Camera) {
    text.head("[[camera]]");
    text.string("name", Some(&c.name));
    text.key("eye", &point3(c.eye));
    text.key("direction", &point3(c.direction));
    text.unusual("fov", c.fov, USUAL_FOV);
}

pub(super) fn path(text: &mut Text, p: &CameraPath) {
    text.head("[[path]]");
    text.string("name", Some(&p.name));
    let written = |at: &glam::DVec3| match p.eye {
        Some(_) => point(at.truncate()),
        None => point3(*at),
    };
    let points: Vec<String> = p.points.iter().map(written).collect();
    text.list("points", &points);
    text.number("eye", p.eye);
    if p.closed {
        text.key("closed", "true");
    }
    match p.pace {
        PathPace::Seconds(seconds) => text.number("seconds", Some(seconds)),
        PathPace::Speed(speed) => text.number("speed", Some(speed)),
    }
    if let PathLook::At(at) = p.look {
        text.key("look", &point3(at));
    }
    text.unusual("fov", p.fov, USUAL_FOV);
}
