//! Materials, lights, objects, cameras, paths and the budget: from tables to [`Scene`], checked.

use std::ops::Range;

use glam::DVec3;
use toml::Spanned;

use super::super::dress::Dress;
use super::super::scene::{
    Budget, Camera, CameraPath, Light, LightShape, Material, MaterialId, Object, PathLook,
    PathPace, Scene, Shape, Texture,
};
use super::error::TomlError;
use super::names::Names;
use super::record::{
    CameraTable, File, Finite, LightKind, LightTable, MaterialTable, ObjectKind, ObjectTable,
    PathTable, Point3, Positive,
};
use super::source::SourceText;

pub(super) const USUAL_DIFFUSE: f64 = 0.8;
pub(super) const USUAL_SHININESS: f64 = 32.0;
pub(super) const USUAL_IOR: f64 = 1.5;
pub(super) const USUAL_FOV: f64 = 60.0;
pub(super) const USUAL_SPOT_ANGLE: f64 = 45.0;

/// The scene of a file.
pub(super) fn read_scene(
    source: &SourceText,
    file: &File,
    materials: &Names,
) -> Result<Scene, TomlError> {
    let cameras = file.camera.iter().map(|c| &c.get_ref().name);
    Names::of(source, "camera", cameras)?;
    Names::of(source, "path", file.path.iter().map(|p| &p.get_ref().name))?;
    Ok(Scene {
        materials: each(&file.material, |m| material(source, m.get_ref()))?,
        lights: each(&file.light, |l| light(source, l))?,
        objects: each(&file.object, |o| object(source, o, materials))?,
        cameras: each(&file.camera, |c| camera(source, c))?,
        paths: each(&file.path, |p| path(source, p))?,
        budget: Budget {
            max_visible_cells: file.budget.max_visible_cells,
            max_visible_walls: file.budget.max_visible_walls,
            max_density: file.budget.max_density.map(|d| d.0),
        },
        dress: Dress::default(),
    })
}

fn each<T, U>(
    tables: &[T],
    read: impl FnMut(&T) -> Result<U, TomlError>,
) -> Result<Vec<U>, TomlError> {
    tables.iter().map(read).collect()
}

fn vec3([x, y, z]: Point3) -> DVec3 {
    DVec3::new(x.0, y.0, z.0)
}

fn degenerate(source: &SourceText, span: Range<usize>, what: &str) -> TomlError {
    TomlError::Degenerate {
        place: source.place(span),
        what: what.into(),
    }
}

/// A unit vector; an error for (0, 0, 0).
fn direction(source: &SourceText, given: &Spanned<Point3>) -> Result<DVec3, TomlError> {
    vec3(*given.get_ref()).try_normalize().ok_or_else(|| {
        let what = "a direction cannot be [0, 0, 0]; write the way it points";
        degenerate(source, given.span(), what)
    })
}

fn material(source: &SourceText, table: &MaterialTable) -> Result<Material, TomlError> {
    let mirror = table.mirror.map_or(0.0, |s| s.0);
    let transmit = table.transmit.as_ref().map_or(0.0, |s| s.get_ref().0);
    if let Some(given) = &table.transmit
        && mirror + transmit > 1.0 + 1e-9
    {
        let what = "`mirror` and `transmit` are together more than 1; lower one";
        return Err(degenerate(source, given.span(), what));
    }
    if let Some(given) = &table.shininess
        && given.get_ref().0 < 1.0
    {
        let what = "`shininess` must be at least 1";
        return Err(degenerate(source, given.span(), what));
    }
    if let (None, Some(scale)) = (&table.texture, &table.texture_scale) {
        return Err(TomlError::Misplaced {
            place: source.place(scale.span()),
            what: "a material without `texture`",
            key: "texture_scale",
        });
    }
    let scale = (table.texture_scale.as_ref()).map_or(1.0, |s| s.get_ref().0);
    Ok(Material {
        name: table.name.get_ref().clone(),
        diffuse: table.kd.map_or([USUAL_DIFFUSE; 3], |c| c.map(|s| s.0)),
        specular: table.ks.map_or([0.0; 3], |c| c.map(|s| s.0)),
        shininess: (table.shininess.as_ref()).map_or(USUAL_SHININESS, |s| s.get_ref().0),
        mirror,
        transmit,
        ior: table.ior.map_or(USUAL_IOR, |x| x.0),
        roughness: table.roughness.map_or(0.0, |s| s.0),
        emission: table.emission.map_or([0.0; 3], |c| c.map(|s| s.0)),
        texture: (table.texture.clone()).map(|file| Texture { file, scale }),
    })
}

/// The value of a key that this kind needs.
fn needed<'t, T>(
    value: &'t Option<T>,
    table: Range<usize>,
    source: &SourceText,
    what: &str,
    key: &str,
) -> Result<&'t T, TomlError> {
    value.as_ref().ok_or_else(|| TomlError::Keys {
        place: source.place(table),
        what: what.into(),
        needed: format!("`{key}`"),
    })
}

/// An error for the first given key that this kind does not know. `given` lists keys with their
/// places, `known` those of the kind.
fn refuse(
    source: &SourceText,
    what: &'static str,
    given: &[(&'static str, Option<Range<usize>>)],
    known: &[&str],
) -> Result<(), TomlError> {
    for (key, span) in given {
        if let Some(span) = span
            && !known.contains(key)
        {
            return Err(TomlError::Misplaced {
                place: source.place(span.clone()),
                what,
                key,
            });
        }
    }
    Ok(())
}

fn span_of<T>(value: &Option<Spanned<T>>) -> Option<Range<usize>> {
    value.as_ref().map(Spanned::span)
}

fn light(source: &SourceText, table: &Spanned<LightTable>) -> Result<Light, TomlError> {
    let record = table.get_ref();
    let (what, known): (_, &[&str]) = match record.kind.get_ref() {
        LightKind::Point => ("a point light", &["position"]),
        LightKind::Spot => ("a spot light", &["position", "direction", "angle", "inner"]),
        LightKind::Directional => ("a directional light", &["direction"]),
        LightKind::Rectangle => ("a rectangle light", &["position", "edges"]),
        LightKind::Disc => ("a disc light", &["position", "direction", "radius"]),
        LightKind::Sphere => ("a sphere light", &["position", "radius"]),
    };
    let given = [
        ("position", span_of(&record.position)),
        ("direction", span_of(&record.direction)),
        ("angle", span_of(&record.angle)),
        ("inner", span_of(&record.inner)),
        ("edges", span_of(&record.edges)),
        ("radius", span_of(&record.radius)),
    ];
    refuse(source, what, &given, known)?;
    let position = || {
        needed(&record.position, table.span(), source, what, "position").map(|p| vec3(*p.get_ref()))
    };
    let towards = || {
        let given = needed(&record.direction, table.span(), source, what, "direction")?;
        direction(source, given)
    };
    let radius =
        || needed(&record.radius, table.span(), source, what, "radius").map(|r| r.get_ref().0);
    let shape = match record.kind.get_ref() {
        LightKind::Point => LightShape::Point {
            position: position()?,
        },
        LightKind::Spot => {
            let angle = (record.angle.as_ref()).map_or(USUAL_SPOT_ANGLE, |a| a.get_ref().0);
            let inner = record.inner.as_ref().map_or(0.0, |a| a.get_ref().0);
            if let Some(given) = span_of(&record.angle).or(span_of(&record.inner))
                && (angle > 90.0 || inner > angle)
            {
                let what = "a spot's `angle` is at most 90 degrees and its `inner` at most `angle`";
                return Err(degenerate(source, given, what));
            }
            LightShape::Spot {
                position: position()?,
                direction: towards()?,
                angle,
                inner,
            }
        }
        LightKind::Directional => LightShape::Directional {
            direction: towards()?,
        },
        LightKind::Rectangle => {
            let edges = needed(&record.edges, table.span(), source, what, "edges")?;
            let [a, b] = edges.get_ref().map(vec3);
            if a.cross(b).try_normalize().is_none() {
                let what = "the two edges of a rectangle light must not be parallel";
                return Err(degenerate(source, edges.span(), what));
            }
            LightShape::Rectangle {
                center: position()?,
                edges: [a, b],
            }
        }
        LightKind::Disc => LightShape::Disc {
            center: position()?,
            direction: towards()?,
            radius: radius()?,
        },
        LightKind::Sphere => LightShape::Sphere {
            center: position()?,
            radius: radius()?,
        },
    };
    let color = (record.color.as_ref()).map_or([1.0; 3], |c| c.get_ref().map(|x| x.0));
    if let Some(given) = &record.color
        && color == [0.0; 3]
    {
        let what = "a light cannot be black; remove it or give it a color";
        return Err(degenerate(source, given.span(), what));
    }
    let intensity = record.intensity.map_or(1.0, |x| x.0);
    Ok(Light {
        name: record.name.clone(),
        intensity: color.map(|c| c * intensity),
        shape,
    })
}

fn object(
    source: &SourceText,
    table: &Spanned<ObjectTable>,
    materials: &Names,
) -> Result<Object, TomlError> {
    let record = table.get_ref();
    let (what, known): (_, &[&str]) = match record.kind.get_ref() {
        ObjectKind::Sphere => ("a sphere", &["radius"]),
        ObjectKind::Box => ("a box", &["size"]),
        ObjectKind::Cylinder => ("a cylinder", &["radius", "height"]),
        ObjectKind::Cone => ("a cone", &["radius", "height"]),
        ObjectKind::Polygon => ("a polygon", &["points"]),
        ObjectKind::Mesh => ("a mesh", &["file"]),
    };
    let given = [
        ("radius", span_of(&record.radius)),
        ("height", span_of(&record.height)),
        ("size", span_of(&record.size)),
        ("points", span_of(&record.points)),
        ("file", span_of(&record.file)),
    ];
    refuse(source, what, &given, known)?;
    let length = |value: &Option<Spanned<Positive>>, key| {
        needed(value, table.span(), source, what, key).map(|x| x.get_ref().0)
    };
    let shape = match record.kind.get_ref() {
        ObjectKind::Sphere => Shape::Sphere {
            radius: length(&record.radius, "radius")?,
        },
        ObjectKind::Box => {
            let size = needed(&record.size, table.span(), source, what, "size")?;
            Shape::Box {
                size: DVec3::from(size.get_ref().map(|x| x.0)),
            }
        }
        ObjectKind::Cylinder => Shape::Cylinder {
            radius: length(&record.radius, "radius")?,
            height: length(&record.height, "height")?,
        },
        ObjectKind::Cone => Shape::Cone {
            radius: length(&record.radius, "radius")?,
            height: length(&record.height, "height")?,
        },
        ObjectKind::Polygon => {
            let points = needed(&record.points, table.span(), source, what, "points")?;
            let corners: Vec<DVec3> = points.get_ref().iter().map(|p| vec3(*p)).collect();
            let flat = |c: &[DVec3]| (c[1] - c[0]).cross(c[2] - c[0]).length_squared() == 0.0;
            if corners.len() < 3 || corners.windows(3).all(flat) {
                let what = "a polygon needs at least three corners that are not on one line";
                return Err(degenerate(source, points.span(), what));
            }
            Shape::Polygon { points: corners }
        }
        ObjectKind::Mesh => {
            let file = needed(&record.file, table.span(), source, what, "file")?;
            Shape::Mesh {
                file: file.get_ref().clone(),
            }
        }
    };
    let material = (record.material.as_ref()).map(|name| materials.find(source, name));
    Ok(Object {
        name: record.name.clone(),
        shape,
        material: material.transpose()?.map(|i| MaterialId(i as u32)),
        position: vec3(record.position),
        rotation: record.rotation.map_or(DVec3::ZERO, vec3),
        scale: record.scale.map_or(DVec3::ONE, |s| DVec3::from(s.0)),
    })
}

fn camera(source: &SourceText, table: &Spanned<CameraTable>) -> Result<Camera, TomlError> {
    let record = table.get_ref();
    let eye = vec3(record.eye);
    let direction = match (&record.look, &record.direction) {
        (Some(look), None) => (vec3(*look.get_ref()) - eye)
            .try_normalize()
            .ok_or_else(|| {
                let what = "a camera cannot look at its own `eye`; move one of the two";
                degenerate(source, look.span(), what)
            })?,
        (None, Some(given)) => direction(source, given)?,
        _ => {
            return Err(TomlError::Keys {
                place: source.place(table.span()),
                what: "a camera".into(),
                needed: "either `look` (a point) or `direction`".into(),
            });
        }
    };
    let fov = fov(source, &record.fov)?;
    Ok(Camera {
        name: record.name.get_ref().clone(),
        eye,
        direction,
        fov,
    })
}

/// The angle of view of a camera or a path.
fn fov(source: &SourceText, given: &Option<Spanned<Positive>>) -> Result<f64, TomlError> {
    match given {
        Some(fov) if fov.get_ref().0 >= 180.0 => {
            let what = "`fov` must be below 180 degrees";
            Err(degenerate(source, fov.span(), what))
        }
        Some(fov) => Ok(fov.get_ref().0),
        None => Ok(USUAL_FOV),
    }
}

pub(super) fn path(
    source: &SourceText,
    table: &Spanned<PathTable>,
) -> Result<CameraPath, TomlError> {
    let record = table.get_ref();
    let points = record.points.get_ref();
    if points.len() < 2 {
        let what = "a path needs at least two points";
        return Err(degenerate(source, record.points.span(), what));
    }
    let read = |p: &Spanned<Vec<Finite>>| match (record.eye, &p.get_ref()[..]) {
        (None, &[x, y, z]) => Ok(vec3([x, y, z])),
        (Some(_), &[x, y]) => Ok(vec3([x, y, Finite(0.0)])),
        (None, _) => {
            let what = "a point of a path is `[x, y, z]`, where the eye is; or `[x, y]` in a path \
                with `eye`, the eye's height over the floor";
            Err(degenerate(source, p.span(), what))
        }
        (Some(_), _) => {
            let what = "a point of a path with `eye`, the eye's height over the floor, is `[x, y]`";
            Err(degenerate(source, p.span(), what))
        }
    };
    let places = each(points, read)?;
    if let Some(i) = (1..places.len()).find(|&i| places[i] == places[i - 1]) {
        let what = "a path has the same point twice in a row; leave one out";
        return Err(degenerate(source, points[i].span(), what));
    }
    if let (true, Some(last)) = (record.closed, points.last())
        && places.first() == places.last()
    {
        let what = "a closed path ends where it starts by itself; leave the last point out";
        return Err(degenerate(source, last.span(), what));
    }
    let pace = match (&record.seconds, &record.speed) {
        (Some(seconds), None) => PathPace::Seconds(seconds.get_ref().0),
        (None, Some(speed)) => PathPace::Speed(speed.get_ref().0),
        _ => {
            return Err(TomlError::Keys {
                place: source.place(table.span()),
                what: "a path".into(),
                needed: "either `seconds` (for the whole) or `speed` (length per second)".into(),
            });
        }
    };
    Ok(CameraPath {
        name: record.name.get_ref().clone(),
        points: places,
        eye: record.eye.map(|z| z.0),
        closed: record.closed,
        look: match record.look {
            Some(point) => PathLook::At(vec3(point)),
            None => PathLook::Ahead,
        },
        pace,
        fov: fov(source, &record.fov)?,
    })
}
