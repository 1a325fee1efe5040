//! Disney's models.

use caustica_formats::ir::{self, PrincipledIndex};

use super::Compiler;
use crate::bsdf::{PrincipledModel, PrincipledThinModel};

impl Compiler<'_> {
    pub(super) fn principled(&mut self, p: &ir::Principled, origin: ir::Origin) -> PrincipledModel {
        PrincipledModel {
            base_color: self.reflectance(&p.base_color, origin),
            roughness: self.scalar_param(&p.roughness),
            anisotropic: self.scalar_param(&p.anisotropic),
            metallic: self.scalar_param(&p.metallic),
            spec_trans: self.scalar_param(&p.spec_trans),
            eta: match p.index {
                PrincipledIndex::Eta(eta) => eta as f32,
                PrincipledIndex::Specular(s) => (2.0 / (1.0 - (0.08 * s).sqrt()) - 1.0) as f32,
            },
            spec_tint: self.scalar_param(&p.spec_tint),
            sheen: self.scalar_param(&p.sheen),
            sheen_tint: self.scalar_param(&p.sheen_tint),
            flatness: self.scalar_param(&p.flatness),
            clearcoat: self.scalar_param(&p.clearcoat),
            clearcoat_gloss: self.scalar_param(&p.clearcoat_gloss),
        }
    }

    pub(super) fn principled_thin(
        &mut self,
        p: &ir::PrincipledThin,
        origin: ir::Origin,
    ) -> PrincipledThinModel {
        PrincipledThinModel {
            base_color: self.reflectance(&p.base_color, origin),
            roughness: self.scalar_param(&p.roughness),
            anisotropic: self.scalar_param(&p.anisotropic),
            spec_trans: self.scalar_param(&p.spec_trans),
            eta: self.scalar_param(&p.eta),
            spec_tint: self.scalar_param(&p.spec_tint),
            sheen: self.scalar_param(&p.sheen),
            sheen_tint: self.scalar_param(&p.sheen_tint),
            flatness: self.scalar_param(&p.flatness),
            diff_trans: self.scalar_param(&p.diff_trans),
        }
    }
}
