//! Surfaces: Phong's model, and materials made ready for shading.

use glam::{DVec2, DVec3};

use crate::level::scene::Material;
use crate::trace::effects::{Effect, Effects};
use crate::trace::world::{Hit, What, World};

/// Phong's model: kd·(N·L) + ks·(R·V)^n, for unit vectors N, L (to the light) and V (to the eye), L on
/// the side of N. R is L mirrored about N.
pub fn phong((kd, ks, shininess): (DVec3, DVec3, f64), n: DVec3, l: DVec3, v: DVec3) -> DVec3 {
    let cos = n.dot(l);
    let diffuse = kd * cos;
    if ks == DVec3::ZERO {
        return diffuse;
    }
    let r = n * (2.0 * cos) - l;
    let along = r.dot(v);
    if along <= 0.0 {
        return diffuse;
    }
    diffuse + ks * along.powf(shininess)
}

/// A material as far as a picture's effects go.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    /// Diffuse colour.
    pub(super) kd: DVec3,
    /// Highlight.
    pub ks: DVec3,
    /// Its exponent.
    pub shininess: f64,
    /// Reflected share, by colour.
    pub km: DVec3,
    /// Passing share that rays from the eye follow.
    pub kt: f64,
    /// Passing share for light on its way to a surface.
    clear: f64,
    /// Hue of what passes.
    tint: DVec3,
    /// Index of refraction.
    pub ior: f64,
    /// Half the angle of the cone into which it scatters, in radians.
    pub cone: f64,
    /// Light given off.
    pub emission: DVec3,
    /// Number of its picture, and the length that one repetition covers.
    pub(super) picture: Option<(u32, f64)>,
}

/// A colour made as bright as can be; white for black.
fn hue(colour: DVec3) -> DVec3 {
    match colour.max_element() {
        0.0 => DVec3::ONE,
        most => colour / most,
    }
}

impl Finish {
    fn new(material: &Material, picture: Option<u32>, effects: Effects) -> Self {
        let has = |effect| effects.has(effect);
        let rough = material.roughness > 0.0;
        // Without the blurred effect, the sharp one stands for it.
        let mirrors = has(Effect::Mirror) || rough && has(Effect::Glossy);
        let passes = has(Effect::Refraction) || rough && has(Effect::Translucency);
        let blurred = if material.transmit > 0.0 && material.mirror == 0.0 {
            has(Effect::Translucency)
        } else if material.transmit == 0.0 {
            has(Effect::Glossy)
        } else {
            has(Effect::Glossy) || has(Effect::Translucency)
        };
        let [kd, ks] = [material.diffuse, material.specular].map(DVec3::from_array);
        let texture = material.texture.as_ref().map_or(1.0, |t| t.scale);
        Self {
            kd,
            ks,
            shininess: material.shininess,
            km: if mirrors {
                hue(ks) * material.mirror
            } else {
                DVec3::ZERO
            },
            kt: if passes { material.transmit } else { 0.0 },
            clear: material.transmit,
            tint: hue(kd),
            ior: material.ior,
            cone: if blurred {
                material.roughness * std::f64::consts::FRAC_PI_4
            } else {
                0.0
            },
            emission: DVec3::from_array(material.emission),
            picture: (picture.filter(|_| has(Effect::Textures))).map(|p| (p, texture)),
        }
    }

    /// Whether it gives off light.
    pub fn glows(&self) -> bool {
        self.emission != DVec3::ZERO
    }

    /// The diffuse colour at a point: the picture's, if there is one.
    #[inline]
    pub fn colour(&self, world: &World, hit: &Hit) -> DVec3 {
        match self.picture {
            None => self.kd,
            Some((number, scale)) => {
                let image = &world.pictures[number as usize];
                let place = match hit.what {
                    What::Surface(surface) => {
                        let place = world.place_on(surface, hit.point);
                        place / (scale * DVec2::new(1.0, image.aspect()))
                    }
                    What::Object(_) => hit.uv,
                };
                image.at(place)
            }
        }
    }

    /// The share of light that passes at a point, by colour: the picture's own colours, or the hue
    /// of kd.
    pub fn pass(&self, world: &World, hit: &Hit) -> DVec3 {
        let tint = match self.picture {
            None => self.tint,
            Some(_) => self.colour(world, hit),
        };
        tint * self.clear
    }
}

/// Every material of a world, as far as the effects go.
pub fn finishes(world: &World, effects: Effects) -> Vec<Finish> {
    let materials = world.materials.iter().zip(&world.picture_of);
    materials
        .map(|(material, picture)| Finish::new(material, *picture, effects))
        .collect()
}
