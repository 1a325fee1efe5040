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
        Some(LayerData { channels: layer.channels, data: self.channels(layer.content, 0..self.pixels.len()) })
    }

    /// See [`Pixels::relative_error`](crate::film::Pixels::relative_error); infinite where it is not known.
    pub fn relative_error(&self) -> f64 {
        self.pixels.relative_error(self.passes())
    }

    /// Coverage of every pixel, row by row.
    pub fn alpha(&self) -> Vec<f32> {
        (0..self.pixels.len()).map(|i| self.pixels.alpha(i, self.passes()) as f32).collect()
    }
}
