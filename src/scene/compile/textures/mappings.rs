//! Where textures lie in space.

use caustica_formats::ir;

use super::Compiler;
use crate::texture::{Mapping, NoiseKind, ToTexture, UvTransform};

impl Compiler<'_> {
    /// World → texture, for points of the compiled scene.
    pub fn to_texture(&self, world_to_texture: &ir::Transform) -> ToTexture {
        let m = world_to_texture.after(&ir::Transform::translate(self.origin)).0;
        ToTexture(std::array::from_fn(|r| m[r].map(|x| x as f32)))
    }

    /// `None` after saying why a picture cannot be mapped so.
    pub fn mapping(&mut self, mapping: &ir::Mapping, origin: ir::Origin) -> Option<Mapping> {
        Some(match mapping {
            ir::Mapping::Uv(m) => Mapping::Uv(uv_transform(m)),
            ir::Mapping::Spherical { to_texture } => Mapping::Spherical(self.to_texture(to_texture)),
            ir::Mapping::Cylindrical { to_texture } => Mapping::Cylindrical(self.to_texture(to_texture)),
            ir::Mapping::Planar { to_texture, axes, offset } => {
                let m = to_texture.after(&ir::Transform::translate(self.origin)).0;
                Mapping::Planar(std::array::from_fn(|k| {
                    let column = |c: usize| (0..3).map(|r| axes[k][r] * m[r][c]).sum::<f64>();
                    [column(0), column(1), column(2), column(3) + offset[k]].map(|x| x as f32)
                }))
            }
            ir::Mapping::Solid { .. } => {
                self.unsupported("a flat texture mapped by all of space", "gray 0.5", origin);
                return None;
            }
        })
    }
}

pub fn noise(kind: ir::NoiseKind) -> NoiseKind {
    match kind {
        ir::NoiseKind::Fbm { octaves, roughness } => NoiseKind::Fbm { octaves, roughness: roughness as f32 },
        ir::NoiseKind::Wrinkled { octaves, roughness } => {
            NoiseKind::Wrinkled { octaves, roughness: roughness as f32 }
        }
        ir::NoiseKind::Windy => NoiseKind::Windy,
        ir::NoiseKind::Marble { octaves, roughness, scale, variation } => {
            let [roughness, scale, variation] = [roughness, scale, variation].map(|x| x as f32);
            NoiseKind::Marble { octaves, roughness, scale, variation }
        }
    }
}

pub fn uv_transform(m: &ir::Transform) -> UvTransform {
    // uv is the point (u, v, 0, 1): Mitsuba reads the upper-left 2×2 part and the translation.
    let row = |r: usize| [m.0[r][0] as f32, m.0[r][1] as f32, m.0[r][3] as f32];
    UvTransform { u: row(0), v: row(1) }
}
