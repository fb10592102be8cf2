//! The tables of a TOML level as they are written, before names are looked up and shapes checked.
//!
//! A number that is not finite, not positive or no share is already an error here, with its place:
//! the types of the fields say which numbers may stand there.

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

/// A finite number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Finite(pub f64);

impl<'de> Deserialize<'de> for Finite {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let x = f64::deserialize(deserializer)?;
        if x.is_finite() {
            Ok(Finite(x))
        } else {
            Err(D::Error::custom(format!(
                "{x} is not a finite number; write a plain decimal"
            )))
        }
    }
}

/// A finite number above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Positive(pub f64);

impl<'de> Deserialize<'de> for Positive {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Finite(x) = Finite::deserialize(deserializer)?;
        if x > 0.0 {
            Ok(Positive(x))
        } else {
            Err(D::Error::custom(format!("{x} is not above zero")))
        }
    }
}

/// A finite number not below zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NotNegative(pub f64);

impl<'de> Deserialize<'de> for NotNegative {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Finite(x) = Finite::deserialize(deserializer)?;
        if x >= 0.0 {
            Ok(NotNegative(x))
        } else {
            Err(D::Error::custom(format!("{x} is below zero")))
        }
    }
}

/// A number from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share(pub f64);

impl<'de> Deserialize<'de> for Share {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Finite(x) = Finite::deserialize(deserializer)?;
        if (0.0..=1.0).contains(&x) {
            Ok(Share(x))
        } else {
            Err(D::Error::custom(format!("{x} is not between 0 and 1")))
        }
    }
}

/// One factor for all axes, or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale(pub [f64; 3]);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrThree;
        impl<'de> Visitor<'de> for OneOrThree {
            type Value = [f64; 3];
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a positive number, or three of them")
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<[f64; 3], E> {
                Ok([x as f64; 3])
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<[f64; 3], E> {
                Ok([x; 3])
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[f64; 3], A::Error> {
                let mut axes = [0.0; 3];
                for (i, axis) in axes.iter_mut().enumerate() {
                    *axis = seq
                        .next_element()?
                        .ok_or_else(|| A::Error::invalid_length(i, &self))?;
                }
                match seq.next_element::<f64>()? {
                    Some(_) => Err(A::Error::invalid_length(4, &self)),
                    None => Ok(axes),
                }
            }
        }
        let axes = deserializer.deserialize_any(OneOrThree)?;
        if axes.iter().all(|x| x.is_finite() && *x > 0.0) {
            Ok(Scale(axes))
        } else {
            Err(D::Error::custom("a scale must be above zero"))
        }
    }
}

pub(super) type Point2 = [Finite; 2];
pub(super) type Point3 = [Finite; 3];
/// Tables of one kind, in file order.
pub(super) type Tables<T> = Vec<Spanned<T>>;
pub(super) type Name = Spanned<String>;
pub(super) type Corners = Spanned<Vec<Spanned<Point2>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub name: Option<String>,
    pub unit: Option<String>,
    #[serde(default)]
    pub numbers: NumbersKind,
    #[serde(default)]
    pub start: Vec<Spanned<Point2>>,
    #[serde(default)]
    pub defaults: Defaults,
    #[serde(default)]
    pub room: Tables<Room>,
    #[serde(default)]
    pub zone: Tables<Zone>,
    #[serde(default)]
    pub sector: Tables<SectorTable>,
    #[serde(default)]
    pub line: Tables<LineTable>,
    #[serde(default)]
    pub wall: Tables<WallTable>,
    #[serde(default)]
    pub pillar: Tables<Pillar>,
    #[serde(default)]
    pub opening: Tables<OpeningTable>,
    #[serde(default)]
    pub door: Tables<OpeningTable>,
    #[serde(default)]
    pub window: Tables<OpeningTable>,
    #[serde(default)]
    pub archway: Tables<OpeningTable>,
    #[serde(default)]
    pub material: Tables<MaterialTable>,
    #[serde(default)]
    pub light: Tables<LightTable>,
    #[serde(default)]
    pub object: Tables<ObjectTable>,
    #[serde(default)]
    pub camera: Tables<CameraTable>,
    #[serde(default)]
    pub path: Tables<PathTable>,
    #[serde(default)]
    pub budget: BudgetTable,
}

/// A file of walks alone.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WalksFile {
    #[serde(default)]
    pub path: Tables<PathTable>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum NumbersKind {
    #[default]
    Decimal,
    Binary,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Defaults {
    pub floor: Option<Finite>,
    pub ceiling: Option<Spanned<Finite>>,
    #[serde(default)]
    pub materials: Surfaces,
    pub door_height: Option<Positive>,
    pub window_sill: Option<NotNegative>,
    pub window_height: Option<Positive>,
    pub archway_height: Option<Positive>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Surfaces {
    pub walls: Option<Name>,
    pub floor: Option<Name>,
    pub ceiling: Option<Name>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ZoneSurfaces {
    pub floor: Option<Name>,
    pub ceiling: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Room {
    pub name: Name,
    pub outline: Option<Corners>,
    pub rect: Option<Spanned<[Finite; 4]>>,
    pub floor: Option<Finite>,
    pub ceiling: Option<Finite>,
    pub floor_range: Option<Spanned<[Finite; 2]>>,
    pub ceiling_range: Option<Spanned<[Finite; 2]>>,
    pub light: Option<Share>,
    #[serde(default)]
    pub materials: Surfaces,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Zone {
    pub name: Option<String>,
    pub outline: Option<Corners>,
    pub rect: Option<Spanned<[Finite; 4]>>,
    pub floor: Option<Finite>,
    pub ceiling: Option<Finite>,
    pub floor_range: Option<Spanned<[Finite; 2]>>,
    pub ceiling_range: Option<Spanned<[Finite; 2]>>,
    pub light: Option<Share>,
    #[serde(default)]
    pub materials: ZoneSurfaces,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SectorTable {
    pub name: Option<String>,
    pub floor: Option<Finite>,
    pub ceiling: Option<Finite>,
    pub floor_range: Option<Spanned<[Finite; 2]>>,
    pub ceiling_range: Option<Spanned<[Finite; 2]>>,
    pub light: Option<Share>,
    #[serde(default)]
    pub materials: ZoneSurfaces,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LineTable {
    pub name: Option<String>,
    #[serde(default)]
    pub kind: LineKind,
    pub points: Corners,
    pub left: Option<Spanned<u32>>,
    pub right: Option<Spanned<u32>>,
    pub state: Option<Spanned<DoorState>>,
    pub bottom: Option<Spanned<Finite>>,
    pub top: Option<Spanned<Finite>>,
    pub material: Option<Name>,
}

#[derive(Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LineKind {
    #[default]
    Solid,
    Wall,
    Edge,
    Door,
    Window,
    Archway,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WallTable {
    pub name: Option<String>,
    pub points: Corners,
    #[serde(default)]
    pub closed: bool,
    pub material: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Pillar {
    pub name: Option<String>,
    pub center: Option<Spanned<Point2>>,
    pub centers: Option<Corners>,
    pub radius: Option<Positive>,
    pub sides: Option<Spanned<u32>>,
    pub rotation: Option<Finite>,
    pub rect: Option<Spanned<[Finite; 4]>>,
    pub outline: Option<Corners>,
    pub material: Option<Name>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OpeningTable {
    pub name: Option<String>,
    pub points: Option<Spanned<[Spanned<Point2>; 2]>>,
    pub between: Option<Spanned<[Name; 2]>>,
    pub room: Option<Name>,
    pub side: Option<Spanned<Side>>,
    pub at: Option<Spanned<Point2>>,
    pub width: Option<Spanned<Positive>>,
    pub count: Option<Spanned<u32>>,
    pub bottom: Option<Finite>,
    pub sill: Option<Spanned<NotNegative>>,
    pub top: Option<Finite>,
    pub height: Option<Spanned<Positive>>,
    pub state: Option<Spanned<DoorState>>,
    pub material: Option<Name>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Side {
    North,
    East,
    South,
    West,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum DoorState {
    Open,
    Closed,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    pub name: Name,
    pub kd: Option<[Share; 3]>,
    pub ks: Option<[Share; 3]>,
    pub shininess: Option<Spanned<Finite>>,
    pub mirror: Option<Share>,
    pub transmit: Option<Spanned<Share>>,
    pub ior: Option<Positive>,
    pub roughness: Option<Share>,
    pub emission: Option<[NotNegative; 3]>,
    pub texture: Option<String>,
    pub texture_scale: Option<Spanned<Positive>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    pub name: Option<String>,
    pub kind: Spanned<LightKind>,
    pub position: Option<Spanned<Point3>>,
    pub direction: Option<Spanned<Point3>>,
    pub angle: Option<Spanned<Positive>>,
    pub inner: Option<Spanned<NotNegative>>,
    pub edges: Option<Spanned<[Point3; 2]>>,
    pub radius: Option<Spanned<Positive>>,
    pub color: Option<Spanned<[NotNegative; 3]>>,
    pub intensity: Option<Positive>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LightKind {
    Point,
    Spot,
    Directional,
    Rectangle,
    Disc,
    Sphere,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectTable {
    pub name: Option<String>,
    pub kind: Spanned<ObjectKind>,
    pub position: Point3,
    pub rotation: Option<Point3>,
    pub scale: Option<Scale>,
    pub material: Option<Name>,
    pub radius: Option<Spanned<Positive>>,
    pub height: Option<Spanned<Positive>>,
    pub size: Option<Spanned<[Positive; 3]>>,
    pub points: Option<Spanned<Vec<Point3>>>,
    pub file: Option<Name>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ObjectKind {
    Sphere,
    Box,
    Cylinder,
    Cone,
    Polygon,
    Mesh,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    pub name: Name,
    pub eye: Point3,
    pub look: Option<Spanned<Point3>>,
    pub direction: Option<Spanned<Point3>>,
    pub fov: Option<Spanned<Positive>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PathTable {
    pub name: Name,
    pub points: Spanned<Vec<Spanned<Vec<Finite>>>>,
    pub eye: Option<Positive>,
    #[serde(default)]
    pub closed: bool,
    pub look: Option<Point3>,
    pub seconds: Option<Spanned<Positive>>,
    pub speed: Option<Spanned<Positive>>,
    pub fov: Option<Spanned<Positive>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BudgetTable {
    pub max_visible_cells: Option<u64>,
    pub max_visible_walls: Option<u64>,
    pub max_density: Option<Share>,
}
