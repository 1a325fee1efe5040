//! Phase functions of the IR → phase functions.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorSlot};

use super::super::Compiler;
use crate::medium::phase::{
    Blend, HenyeyGreenstein, Isotropic, KajiyaKay, Microflake, Mixture, Rayleigh, Sggx, Tabulated,
};
use crate::medium::{Matrices, Phase, Symmetric, Volume};

impl Compiler<'_> {
    pub(super) fn phase(
        &mut self,
        phase: &ir::Phase,
        orientation: Option<&Volume>,
        at: ir::Origin,
    ) -> Option<Phase> {
        Some(match phase {
            ir::Phase::Isotropic => Isotropic.into(),
            ir::Phase::HenyeyGreenstein { g } => HenyeyGreenstein::new(*g as f32).into(),
            ir::Phase::Rayleigh => Rayleigh.into(),
            ir::Phase::KajiyaKay { ks, kd, exponent } => {
                let phase = KajiyaKay::new(*kd as f32, *ks as f32, *exponent as f32, orientation.cloned());
                Phase::KajiyaKay(Box::new(phase))
            }
            ir::Phase::Mixture(parts) => {
                let mut made = Vec::new();
                for (weight, part) in parts {
                    made.push((*weight as f32, self.phase(part, orientation, at)?));
                }
                let Some(mixture) = Mixture::new(made) else {
                    self.error("a mixture of phase functions needs a weight above 0", at);
                    return None;
                };
                mixture.into()
            }
            ir::Phase::Blend { weight, parts } => {
                let weight = self.volume(weight, ColorSlot::Unbounded, at)?;
                let [first, second] = parts.as_ref();
                let parts = [self.phase(first, orientation, at)?, self.phase(second, orientation, at)?];
                Phase::Blend(Box::new(Blend { weight, parts }))
            }
            ir::Phase::Tabulated { values } => {
                let Some(table) = Tabulated::new(values) else {
                    self.error(
                        "a table of a phase function needs two values or more, none negative and one above 0",
                        at,
                    );
                    return None;
                };
                table.into()
            }
            ir::Phase::Sggx { matrix } => Phase::Sggx(Box::new(Sggx::new(self.matrices(matrix, at)?))),
            ir::Phase::Microflake { stddev } => {
                Phase::Microflake(Box::new(Microflake::new(*stddev, orientation.cloned())))
            }
        })
    }

    fn matrices(&mut self, volume: &ir::Volume, at: ir::Origin) -> Option<Matrices> {
        match volume {
            ir::Volume::Grid(grid) => {
                let grid = self.load_grid(grid, at)?.grid;
                if grid.channels != 6 {
                    self.error(
                        format!("the matrices of flakes need a volume of 6 channels, not {}", grid.channels),
                        at,
                    );
                    return None;
                }
                Some(Matrices::Grid(Arc::new(grid)))
            }
            ir::Volume::Constant(color) => {
                let [x, y, z] = self.color(color, ColorSlot::Unbounded, at).lanes();
                Some(Matrices::Constant(Symmetric([x, y, z, 0.0, 0.0, 0.0])))
            }
            _ => {
                self.refuse("such a volume of matrices", at);
                None
            }
        }
    }
}
