//! A list of shapes with their bounds, as primitives of a structure.

use super::{Hit, Shape};
use crate::trace::accel::{Bounds, Cast, Contact, Count, Found, Primitives, Want};
use crate::trace::ray::{Ray, Start};

/// Shapes in a row. A shape's number is its place.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    shapes: Vec<Shape>,
    bounds: Vec<Bounds>,
}

impl Objects {
    /// Takes the shapes over.
    pub fn new(shapes: Vec<Shape>) -> Self {
        let bounds = shapes.iter().map(Shape::bounds).collect();
        Self { shapes, bounds }
    }

    /// The shapes.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// What the shape is like where the ray met it.
    pub fn hit(&self, ray: &Ray, found: &Found) -> Hit {
        self.shapes[found.primitive as usize].hit(ray, &found.contact)
    }
}

impl Primitives for Objects {
    fn len(&self) -> usize {
        self.shapes.len()
    }

    #[inline]
    fn bounds(&self, primitive: u32) -> Bounds {
        self.bounds[primitive as usize]
    }

    #[inline]
    fn contact<C: Count>(
        &self,
        primitive: u32,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        self.shapes[primitive as usize].contact(cast, from, want, limit, count)
    }
}
