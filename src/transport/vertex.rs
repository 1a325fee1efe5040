use crate::bsdf::Closure;
use crate::math::Vec3;
use crate::scene::{Scene, Surface};

/// A point of a surface where a path scatters.
#[derive(Clone, Debug)]
pub struct Vertex<'a> {
    /// The point.
    pub surface: &'a Surface,
    /// Unit, in the world: back to where the path came from.
    pub back: Vec3,
    /// The same in the shading frame of the surface.
    pub wi: Vec3,
    /// How light scatters here.
    pub closure: Closure<'a>,
}

impl<'a> Vertex<'a> {
    /// Of a path that came against the unit direction `back`.
    #[inline(always)]
    pub fn new(scene: &'a Scene, surface: &'a Surface, back: Vec3) -> Self {
        let wi = surface.frame.to_local(back);
        Self { surface, back, wi, closure: scene.closure(surface, wi) }
    }
}
