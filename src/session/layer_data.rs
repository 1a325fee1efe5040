//! What a picture is made of, by name.

use super::Picture;
use super::layers::{Content, KNOWN, LayerRequest};
use crate::film::Layer;

/// The numbers of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerData {
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Row by row from the top, the channels of a pixel together.
    pub data: Vec<f32>,
}

/// What the layer is called that holds the channels of pbrt's `gbuffer` film.
const GBUFFER: &str = "gbuffer";

impl Picture<'_> {
    /// Names for [`Self::layer`]: the layers that an EXR stores, and those that every picture has.
    pub fn layer_names(&self) -> Vec<String> {
        let name = |layer: &LayerRequest| match layer.name.as_str() {
            "" => GBUFFER.to_owned(),
            name => name.to_owned(),
        };
        let mut names: Vec<String> = self.info.layers.iter().map(name).collect();
        for known in KNOWN.into_iter().filter_map(LayerRequest::known) {
            let there = match known.content {
                Content::Part(layer) => layer != Layer::Medium,
                Content::Variance | Content::Samples => true,
                Content::Picture | Content::Surface(_) => false,
            };
            if there && !names.contains(&known.name) {
                names.push(known.name);
            }
        }
        names
    }

    /// A layer by its name; `None` where the picture has none of it.
    pub fn layer(&self, name: &str) -> Option<LayerData> {
        let asked = if name == GBUFFER { "" } else { name };
        let stored = self.info.layers.iter().find(|layer| layer.name == asked).cloned();
        let known = || LayerRequest::known(name).filter(|_| self.layer_names().iter().any(|n| n == name));
        let layer = stored.or_else(known)?;
        Some(LayerData { channels: layer.channels, data: self.channels(layer.content) })
    }

    /// See [`Pixels::relative_error`](crate::film::Pixels::relative_error); infinite where it is not known.
    pub fn relative_error(&self) -> f64 {
        self.pixels.relative_error(self.passes())
    }

    /// Coverage of every pixel, row by row.
    pub fn alpha(&self) -> Vec<f32> {
        (0..self.pixels.len()).map(|i| self.pixels.alpha(i, self.passes()) as f32).collect()
    }

    /// The numbers of a layer, pixel by pixel.
    pub(super) fn channels(&self, content: Content) -> Vec<f32> {
        let (pixels, passes) = (self.pixels, self.passes());
        let count = pixels.len();
        let alpha = |i: usize| pixels.alpha(i, passes) as f32;
        match content {
            Content::Part(layer) => {
                (0..count).flat_map(|i| pixels.layer(i, layer, passes)).map(|v| v as f32).collect()
            }
            Content::Picture => {
                let rgb = self.rgb().enumerate();
                rgb.flat_map(|(i, [r, g, b])| [r as f32, g as f32, b as f32, alpha(i)]).collect()
            }
            Content::Variance => {
                (0..count).map(|i| pixels.variance(i, passes).min(f64::from(f32::MAX)) as f32).collect()
            }
            Content::Samples => vec![passes as f32 * pixels.common.samples_a_pass as f32; count],
            Content::Surface(aov) => {
                let list = &self.info.aovs;
                (0..count).flat_map(|i| pixels.aov(i, aov, list, passes)).map(|v| v as f32).collect()
            }
        }
    }
}
