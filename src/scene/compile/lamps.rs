//! Shapes that emit.

use caustica_formats::ir::{self, ColorSlot};

use super::Compiler;
use crate::emitter::{Area, Collimated, Emitter, Sides, Surface};
use crate::spectrum::luminance;

impl Compiler<'_> {
    /// The light of a shape with the given surface.
    pub(super) fn lamp(&mut self, e: &ir::AreaEmission, surface: Surface, lift: f32) -> Option<Emitter> {
        let radiance = self.param(&e.radiance, ColorSlot::Emission, e.origin);
        let radiance = self.scaled(radiance, e.scale as f32);
        if e.collimated {
            let Surface::Mesh { triangles, .. } = surface else {
                self.error("only a lamp of flat faces can shine along its normals", e.origin);
                return None;
            };
            return Some(Emitter::Collimated(Box::new(Collimated::new(triangles, radiance, lift))));
        }
        let sides = if e.two_sided { Sides::Both } else { Sides::Front };
        let mut lamp = Area::new(surface, radiance, sides, lift, self.textures_of(radiance));
        if let Some(wanted) = e.power {
            let emitted = luminance(lamp.flux());
            if emitted > 0.0 {
                // pbrt multiplies its power by the scale.
                let radiance = self.scaled(radiance, (wanted * e.scale) as f32 / emitted);
                lamp = Area::new(lamp.surface, radiance, sides, lift, self.textures_of(radiance));
            }
        }
        Some(Emitter::Area(lamp))
    }
}
