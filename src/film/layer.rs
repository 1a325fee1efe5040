//! The layers of a picture, and one camera sample divided among them.

use serde::{Deserialize, Serialize};

use crate::math::Color;

/// The parts a picture is made of; they sum to the beauty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layer {
    /// Lamps and environment seen directly or through specular surfaces.
    Emission,
    /// Light that reaches the first rough surface straight from a lamp.
    Direct,
    /// Light that reaches it through specular surfaces only.
    Caustic,
    /// Everything else that a rough surface scattered last.
    Indirect,
    /// Light that a medium scattered last, on its way to the camera or to the first rough surface in sight.
    Medium,
}

/// Layers in storage order with their names in files.
pub const LAYERS: [(Layer, &str); 5] = [
    (Layer::Emission, "emission"),
    (Layer::Direct, "direct"),
    (Layer::Caustic, "caustic"),
    (Layer::Indirect, "indirect"),
    (Layer::Medium, "medium"),
];

/// One camera sample, by layer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Radiance {
    /// Radiance by layer, indexed by `Layer as usize`.
    pub layers: [Color; LAYERS.len()],
    /// 1 where the camera ray met a surface.
    pub alpha: f32,
}

impl Radiance {
    /// Adds light to a layer.
    #[inline]
    pub fn add(&mut self, layer: Layer, value: Color) {
        self.layers[layer as usize] += value;
    }

    /// Changes the light, not the coverage.
    #[inline]
    pub fn map(&mut self, change: impl Fn(Color) -> Color) {
        self.layers.iter_mut().for_each(|l| *l = change(*l));
    }

    /// The beauty: all layers together.
    pub fn sum(&self) -> Color {
        self.layers.iter().copied().sum()
    }
}
