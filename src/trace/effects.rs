//! Which effects a picture calls for, and why.
//!
//! In: a [`World`], its [`Pvs`] and the cell of the eye. Out: a [`Survey`]: the effects that can matter
//! in a picture from there, each with its reason, and each that cannot, with its. The renderer is then
//! specialised for those ([`super::render`]).
//!
//! What can be seen from a cell is its PVS. A mirror in one of those cells, or a glass that bends
//! light, shows more: what its own cell sees. So the cells that can be met grow from mirror to mirror
//! until nothing is added. An effect matters if a material or light that has it is in one of them. A
//! ray of the lecture's tree always starts in a cell that has been met, so nothing is left out that
//! any ray could find: a test compares the pictures.

use std::fmt;
use std::str::FromStr;

use super::light::is_area;
use super::space::{Surface, WALL};
use super::world::{MaterialIndex, World};
use crate::cells::{CellId, EdgeId};
use crate::level::scene::Material;
use crate::pvs::Pvs;

/// Something that takes rays of its own, or look-ups.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Effect {
    /// Whether lights reach a point at all: a ray to each.
    Shadows,
    /// Penumbras: several rays to lights with an extent.
    Soft,
    /// Sharp reflection.
    Mirror,
    /// Blurred reflection.
    Glossy,
    /// Light that passes a thing, bent or straight.
    Refraction,
    /// Light that passes and scatters.
    Translucency,
    /// Pictures on surfaces.
    Textures,
}

impl Effect {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 7] = [
        Self::Shadows,
        Self::Soft,
        Self::Mirror,
        Self::Glossy,
        Self::Refraction,
        Self::Translucency,
        Self::Textures,
    ];

    /// Its name in commands and tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Shadows => "shadows",
            Self::Soft => "soft",
            Self::Mirror => "mirror",
            Self::Glossy => "glossy",
            Self::Refraction => "refraction",
            Self::Translucency => "translucency",
            Self::Textures => "textures",
        }
    }
}

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects(u8);

impl Effects {
    /// None.
    pub const NONE: Self = Self(0);
    /// All.
    pub const ALL: Self = Self((1 << Effect::ALL.len()) - 1);

    /// Whether it holds the effect.
    pub const fn has(self, effect: Effect) -> bool {
        self.0 >> effect as u8 & 1 == 1
    }

    /// The set with the effect too.
    #[must_use]
    pub const fn with(self, effect: Effect) -> Self {
        Self(self.0 | 1 << effect as u8)
    }

    /// The set without the effect.
    #[must_use]
    pub const fn without(self, effect: Effect) -> Self {
        Self(self.0 & !(1 << effect as u8))
    }

    /// The effects in it.
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |&e| self.has(e))
    }
}

impl FromIterator<Effect> for Effects {
    fn from_iter<I: IntoIterator<Item = Effect>>(effects: I) -> Self {
        effects.into_iter().fold(Self::NONE, Self::with)
    }
}

impl fmt::Display for Effects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NONE {
            return f.write_str("none");
        }
        let names: Vec<&str> = self.iter().map(Effect::as_str).collect();
        f.write_str(&names.join(","))
    }
}

impl FromStr for Effects {
    type Err = String;

    /// Names with commas between them.
    fn from_str(text: &str) -> Result<Self, String> {
        let one = |name: &str| {
            let found = Effect::ALL.into_iter().find(|e| e.as_str() == name.trim());
            found.ok_or_else(|| {
                let names = Effect::ALL.map(Effect::as_str);
                format!(
                    "no effect is called `{name}`; give `all`, `auto`, `none`, or some of {}, with \
                     commas between them",
                    names.join(", ")
                )
            })
        };
        text.split(',').map(one).collect()
    }
}

/// Whether an effect can matter, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The effect.
    pub effect: Effect,
    /// Whether it can matter.
    pub needed: bool,
    /// Why, or why not.
    pub reason: String,
}

/// What a picture from a cell calls for.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The effects that can matter.
    pub needed: Effects,
    /// One for each effect, in their order.
    pub verdicts: Vec<Verdict>,
    /// Cells that can be met, mirrors counted, by cell.
    pub met: Vec<bool>,
    /// Lights that reach a cell that can be met, ascending.
    pub lights: Vec<u32>,
}

/// A material on something, somewhere.
struct Use {
    material: MaterialIndex,
    cell: CellId,
    thing: Thing,
}

#[derive(Clone, Copy)]
enum Thing {
    Surface(Surface),
    Object(u32),
}

/// Looks at what can be seen from a cell, as far as mirrors lead.
pub fn survey(world: &World, pvs: &Pvs, eye: CellId) -> Survey {
    let n = world.space.cells.len();
    // By which cell's mirror a cell is met; itself for those that the eye's cell sees.
    let mut by: Vec<Option<CellId>> = vec![None; n];
    let mut pending = Vec::new();
    for cell in pvs.seen_from(eye) {
        by[cell.0 as usize] = Some(cell);
        pending.push(cell);
    }
    pending.reverse();
    let mut uses = Vec::new();
    while let Some(cell) = pending.pop() {
        let own = uses_in(world, cell);
        if own.iter().any(|u| leads_on(world, u)) {
            for next in pvs.seen_from(cell) {
                let met = &mut by[next.0 as usize];
                if met.is_none() {
                    *met = Some(cell);
                    pending.push(next);
                }
            }
        }
        uses.extend(own);
    }
    uses.sort_by_key(|u| (by[u.cell.0 as usize] != Some(u.cell), u.cell));
    let mut lights: Vec<u32> = (world.space.cells.iter().zip(0..))
        .filter(|(_, id)| by[*id as usize].is_some())
        .flat_map(|(_, id)| world.lights_of(CellId(id)).iter().copied())
        .collect();
    lights.sort_unstable();
    lights.dedup();
    let verdicts: Vec<Verdict> = Effect::ALL
        .into_iter()
        .map(|effect| {
            let found = match effect {
                Effect::Shadows | Effect::Soft => of_lights(world, &lights, effect),
                Effect::Textures if world.wardrobe.is_some() => {
                    Ok("the map's own textures are on its walls, floors and ceilings".to_string())
                }
                _ => of_materials(world, &uses, &by, effect),
            };
            let (needed, reason) = match found {
                Ok(reason) => (true, reason),
                Err(reason) => (false, reason),
            };
            Verdict {
                effect,
                needed,
                reason,
            }
        })
        .collect();
    Survey {
        needed: (verdicts.iter().filter(|v| v.needed))
            .map(|v| v.effect)
            .collect(),
        verdicts,
        met: by.iter().map(Option::is_some).collect(),
        lights,
    }
}

/// Why lights call for an effect, or why not.
fn of_lights(world: &World, lights: &[u32], effect: Effect) -> Result<String, String> {
    let soft = effect == Effect::Soft;
    let fits = |l: &&u32| !soft || is_area(&world.lights[**l as usize]);
    let fitting: Vec<&u32> = lights.iter().filter(fits).collect();
    let all = (world.lights.iter())
        .filter(|l| !soft || is_area(l))
        .count();
    let what = if soft {
        "lights with an extent"
    } else {
        "lights"
    };
    let Some(&&first) = fitting.first() else {
        return Err(match all {
            0 => format!("there are no {what}"),
            n => format!("none of the {n} {what} reaches a cell that can be seen"),
        });
    };
    let name = light_name(world, first);
    let others = match fitting.len() - 1 {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let hidden = match all - fitting.len() {
        0 => String::new(),
        n => format!("; {n} of {all} reach no cell that can be seen, and get no ray"),
    };
    Ok(format!(
        "{name}{others} {} cells that can be seen{hidden}",
        if fitting.len() == 1 {
            "reaches"
        } else {
            "reach"
        }
    ))
}

fn light_name(world: &World, light: u32) -> String {
    match &world.lights[light as usize].name {
        Some(name) => format!("light `{name}`"),
        None => format!("light {}", light + 1),
    }
}

/// Why materials call for an effect, or why not.
fn of_materials(
    world: &World,
    uses: &[Use],
    by: &[Option<CellId>],
    effect: Effect,
) -> Result<String, String> {
    // Behind a floor or a wall there is nothing to which light could pass.
    let through = matches!(effect, Effect::Refraction | Effect::Translucency);
    let matters = |u: &&Use| has(world, u.material, effect) && (!through || passes(u.thing));
    let found = uses.iter().find(matters);
    if let Some(found) = found {
        let way = match by[found.cell.0 as usize] {
            Some(source) if source != found.cell => {
                format!(
                    "seen by way of what reflects or bends light in cell {}",
                    source.0
                )
            }
            _ => "visible from the camera's cell".to_string(),
        };
        return Ok(format!(
            "material `{}` on {}, {way}",
            world.material(found.material).name,
            place(world, found.thing, found.cell)
        ));
    }
    let has = |i: &u32| has(world, MaterialIndex(*i), effect);
    match (0..world.materials.len() as u32).find(has) {
        None => Err(match effect {
            Effect::Mirror => "no material is a sharp mirror".to_string(),
            Effect::Glossy => "no material mirrors and is rough".to_string(),
            Effect::Refraction => "no material lets light pass unscattered".to_string(),
            Effect::Translucency => "no material lets light pass and is rough".to_string(),
            _ => "no material has a picture".to_string(),
        }),
        Some(material) => Err(format!(
            "material `{}` has it, but is on nothing that {}",
            world.materials[material as usize].name,
            if through {
                "can be seen and light can pass"
            } else {
                "can be seen"
            }
        )),
    }
}

/// Whether a material has an effect.
fn has(world: &World, index: MaterialIndex, effect: Effect) -> bool {
    let m: &Material = world.material(index);
    let rough = m.roughness > 0.0;
    match effect {
        Effect::Mirror => m.mirror > 0.0 && !rough,
        Effect::Glossy => m.mirror > 0.0 && rough,
        Effect::Refraction => m.transmit > 0.0 && !rough,
        Effect::Translucency => m.transmit > 0.0 && rough,
        Effect::Textures => world.picture_of[index.0 as usize].is_some(),
        Effect::Shadows | Effect::Soft => false,
    }
}

/// Whether there is anything behind it for light to pass to.
fn passes(thing: Thing) -> bool {
    matches!(thing, Thing::Object(_) | Thing::Surface(Surface::Pane(_)))
}

/// Whether rays go on from a thing in other directions than they came.
fn leads_on(world: &World, used: &Use) -> bool {
    let m = world.material(used.material);
    m.mirror > 0.0 || m.transmit > 0.0 && passes(used.thing)
}

/// Everything in a cell that has a material.
fn uses_in(world: &World, id: CellId) -> Vec<Use> {
    let space = &world.space;
    let cell = space.cell(id.0);
    let mut surfaces = vec![Surface::Floor(id), Surface::Ceiling(id)];
    for e in cell.first..cell.past {
        let (edge, id) = (space.edge(e), EdgeId(e));
        if edge.twin == WALL {
            surfaces.push(Surface::Wall(id));
        } else {
            if edge.bottom > cell.floor {
                surfaces.push(Surface::Step(id));
            }
            if edge.top < cell.ceiling {
                surfaces.push(Surface::Lintel(id));
            }
            if edge.pane.is_some() {
                surfaces.push(Surface::Pane(id));
            }
        }
    }
    let of_surface = |&surface: &Surface| {
        let material = world.surface_material(surface)?;
        (!world.is_sky(surface)).then_some(Use {
            material,
            cell: id,
            thing: Thing::Surface(surface),
        })
    };
    let objects = world.objects_in(id).iter().map(|&number| Use {
        material: world.standing[number as usize].material,
        cell: id,
        thing: Thing::Object(number),
    });
    // Objects first: they are what people look at.
    objects
        .chain(surfaces.iter().filter_map(of_surface))
        .collect()
}

/// Where something is, in words.
fn place(world: &World, thing: Thing, cell: CellId) -> String {
    let cell = cell.0;
    match thing {
        Thing::Object(n) => format!("{} in cell {cell}", world.standing[n as usize].name),
        Thing::Surface(Surface::Floor(_)) => format!("the floor of cell {cell}"),
        Thing::Surface(Surface::Ceiling(_)) => format!("the ceiling of cell {cell}"),
        Thing::Surface(Surface::Pane(_)) => format!("a window of cell {cell}"),
        Thing::Surface(_) => format!("a wall of cell {cell}"),
    }
}
