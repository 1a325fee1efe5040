//! Shapes that emit.

use caustica_formats::ir::{self, ColorSlot};

use super::Compiler;
use crate::emitter::{Area, Collimated, Emitter, Sides, Surface};
use crate::spectrum::luminance;
use crate::texture::{Param, Product};

impl Compiler<'_> {
    /// The light of a shape with the given surface and opacity.
    pub(super) fn lamp(
        &mut self,
        e: &ir::AreaEmission,
        alpha: Option<&ir::FloatInput>,
        surface: Surface,
        lift: f32,
    ) -> Option<Emitter> {
        let radiance = self.param(&e.radiance, ColorSlot::Emission, e.origin);
        let radiance = self.scaled(radiance, e.scale as f32);
        let sides = if e.two_sided { Sides::Both } else { Sides::Front };
        let radiance = match e.power {
            Some(power) => {
                // pbrt multiplies its power by the scale, and knows nothing of the opacity there.
                let whole = Area::new(surface.clone(), radiance, sides, lift, self.textures_of(radiance));
                let emitted = luminance(whole.flux());
                let factor = if emitted > 0.0 { (power * e.scale) as f32 / emitted } else { 1.0 };
                self.scaled(radiance, factor)
            }
            None => radiance,
        };
        let radiance = self.cut(radiance, alpha);
        if e.collimated {
            if let Surface::Mesh { triangles, .. } = surface {
                return Some(Emitter::Collimated(Box::new(Collimated::new(triangles, radiance, lift))));
            }
            self.unsupported(
                "light along the normals of a curved surface",
                "light in all directions",
                e.origin,
            );
        }
        Some(Emitter::Area(Area::new(surface, radiance, sides, lift, self.textures_of(radiance))))
    }

    /// Radiance that opacity leaves. A lamp of no opacity at all is invisible and shines (pbrt-v4's
    /// `DiffuseAreaLight`).
    fn cut(&mut self, radiance: Param, alpha: Option<&ir::FloatInput>) -> Param {
        match alpha {
            None | Some(ir::FloatInput::Value(0.0)) => radiance,
            Some(ir::FloatInput::Value(alpha)) => self.scaled(radiance, alpha.clamp(0.0, 1.0) as f32),
            Some(texture) => {
                let opacity = self.scalar_param(texture);
                self.textures.push(Product([radiance, opacity]).into())
            }
        }
    }
}
