//! Layers of an EXR beside the picture itself.

use std::str::FromStr;

use caustica_formats::diagnostic::nearest;
use caustica_formats::ir::{self, AovKind, CoordinateSystem};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::film::{AOVS, Aov, LAYERS, Layer};

/// Layers that may be asked for, in the order in which `all` stores them: the parts of the picture, which
/// add up to it, then the variance of each pixel's mean luminance and the number of camera samples, then what the
/// camera sees of the surfaces.
pub const KNOWN: [&str; LAYERS.len() + 2 + AOVS.len()] = {
    let mut known = ["variance"; LAYERS.len() + 2 + AOVS.len()];
    let mut i = 0;
    while i < LAYERS.len() {
        known[i] = LAYERS[i].1;
        i += 1;
    }
    known[LAYERS.len() + 1] = "samples";
    i = 0;
    while i < AOVS.len() {
        known[LAYERS.len() + 2 + i] = AOVS[i].1;
        i += 1;
    }
    known
};

/// What is wrong with a list of layers.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LayerError {
    /// A layer was asked for that does not exist.
    #[error("there is no layer `{name}`; {}", advice(name))]
    Unknown {
        /// As it was asked for.
        name: String,
    },
    /// Nothing was asked for, and something.
    #[error("`none` stands for no layer at all, and the list also names `{other}`")]
    NoneAndOthers {
        /// The first of the others.
        other: String,
    },
}

/// What to ask for instead.
fn advice(name: &str) -> String {
    match nearest(name, KNOWN.into_iter().chain(["all", "none"])) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", KNOWN.join(", ")),
    }
}

/// What a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Content {
    /// A part of the picture.
    Part(Layer),
    /// Of each pixel's mean luminance.
    Variance,
    /// Number of camera samples.
    Samples,
    /// The picture itself, with its coverage.
    Picture,
    /// Something that the camera sees of the surfaces.
    Surface(Aov),
}

/// One layer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayerRequest {
    /// Before the point in the names of its channels; nothing where they have whole names.
    pub name: String,
    /// What it holds.
    pub content: Content,
    /// The names of its channels, after the point.
    pub channels: Vec<String>,
}

impl LayerRequest {
    fn new(name: impl Into<String>, content: Content) -> Self {
        let channels: &[&str] = match content {
            Content::Part(_) => &["R", "G", "B"],
            Content::Picture => &["R", "G", "B", "A"],
            Content::Variance | Content::Samples => &["Y"],
            Content::Surface(aov) => aov.channels(),
        };
        let channels = channels.iter().map(|&channel| channel.to_owned()).collect();
        Self { name: name.into(), content, channels }
    }

    /// The layer of this name in [`KNOWN`].
    fn known(name: &str) -> Option<Self> {
        let part = LAYERS.iter().find(|(_, known)| *known == name).map(|(layer, _)| Content::Part(*layer));
        let surface = || AOVS.iter().find(|row| row.1 == name).map(|row| Content::Surface(row.0));
        let content = match name {
            "variance" => Content::Variance,
            "samples" => Content::Samples,
            _ => part.or_else(surface)?,
        };
        Some(Self::new(name, content))
    }
}

/// Which layers to store: each once, in the order asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Layers(Vec<LayerRequest>);

impl Layers {
    /// The parts of the picture.
    pub fn parts() -> Self {
        Self(LAYERS.map(|(layer, name)| LayerRequest::new(name, Content::Part(layer))).to_vec())
    }

    /// Without what media would add.
    fn without_media(mut self) -> Self {
        self.0.retain(|layer| layer.content != Content::Part(Layer::Medium));
        self
    }

    /// What is stored when nothing is asked for: the parts of the picture that the scene may have, and what the scene itself asks for. A
    /// layer of the scene takes the place of a part of that name.
    pub(super) fn of(scene: &ir::Scene, film: Option<&ir::Film>) -> Self {
        let mut own: Vec<LayerRequest> = Vec::new();
        if let Some(integrator) = &scene.integrator {
            own.extend(integrator.aovs.iter().map(of_mitsuba));
        }
        if let Some(system) = film.and_then(|film| film.gbuffer) {
            let aov = Aov::GBuffer { world: system == CoordinateSystem::World };
            own.push(LayerRequest::new("", Content::Surface(aov)));
        }
        let all = Self::parts();
        let mut layers = if scene.media.is_empty() { all.without_media() } else { all };
        layers.0.retain(|part| !own.iter().any(|layer| layer.name == part.name));
        layers.0.extend(own);
        layers
    }

    /// The layers.
    pub fn iter(&self) -> impl Iterator<Item = &LayerRequest> {
        self.0.iter()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What the render has to make for them beside the picture, each once.
    pub fn aovs(&self) -> Vec<Aov> {
        let mut aovs = Vec::new();
        for layer in &self.0 {
            if let Content::Surface(aov) = layer.content
                && !aovs.contains(&aov)
            {
                aovs.push(aov);
            }
        }
        aovs
    }
}

fn of_mitsuba(aov: &ir::Aov) -> LayerRequest {
    let content = Content::Surface(match aov.kind {
        AovKind::Picture => return LayerRequest::new(&aov.name, Content::Picture),
        AovKind::Albedo => Aov::Albedo,
        AovKind::Depth => Aov::Depth,
        AovKind::Position => Aov::Position,
        AovKind::Uv => Aov::Uv,
        AovKind::GeoNormal => Aov::GeoNormal,
        AovKind::ShNormal => Aov::ShNormal,
        AovKind::DpDu => Aov::DpDu,
        AovKind::DpDv => Aov::DpDv,
        AovKind::DuvDx => Aov::DuvDx,
        AovKind::DuvDy => Aov::DuvDy,
        AovKind::PrimIndex => Aov::PrimIndex,
        AovKind::ShapeIndex => Aov::ShapeIndex,
        AovKind::Distance => Aov::Distance,
        AovKind::RelPosition => Aov::RelPosition,
        AovKind::ShapeNumber => Aov::ShapeNumber,
    });
    let layer = LayerRequest::new(&aov.name, content);
    // What compositors look for is Z; a Mitsuba scene gets Mitsuba's name.
    if aov.kind == AovKind::Depth { LayerRequest { channels: vec!["T".to_owned()], ..layer } } else { layer }
}

impl FromStr for Layers {
    type Err = LayerError;

    /// A list of names of [`KNOWN`] with commas between them, among which `all` stands for every one; or `none` for
    /// nothing. A layer that is named twice is stored once.
    fn from_str(list: &str) -> Result<Self, LayerError> {
        let names: Vec<&str> = list.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
        let mut layers = Self::default();
        for name in &names {
            let wanted = match *name {
                "none" => Vec::new(),
                "all" => KNOWN.into_iter().filter_map(LayerRequest::known).collect(),
                name => match LayerRequest::known(name) {
                    Some(layer) => vec![layer],
                    None => return Err(LayerError::Unknown { name: name.to_owned() }),
                },
            };
            for layer in wanted {
                if !layers.0.contains(&layer) {
                    layers.0.push(layer);
                }
            }
        }
        match names.iter().find(|name| **name != "none") {
            Some(other) if names.contains(&"none") => {
                Err(LayerError::NoneAndOthers { other: (*other).to_owned() })
            }
            _ => Ok(layers),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &str) -> String {
        let layers = list.parse::<Layers>().unwrap();
        layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>().join(" ")
    }

    fn problem(list: &str) -> String {
        list.parse::<Layers>().unwrap_err().to_string()
    }

    #[test]
    fn every_layer_is_stored_once() {
        assert_eq!(names("all,direct"), KNOWN.join(" "));
        assert!(
            names("direct,all")
                .starts_with("direct emission caustic indirect medium variance samples albedo depth")
        );
        assert_eq!(names("samples, direct,samples"), "samples direct");
        assert_eq!(names("none"), "");
        assert_eq!(names("depth,direct,depth"), "depth direct");
    }

    #[test]
    fn what_is_no_layer_is_refused_with_the_nearest_name() {
        assert_eq!(problem("all,direkt"), "there is no layer `direkt`; did you mean `direct`?");
        assert_eq!(problem("shnormal"), "there is no layer `shnormal`; did you mean `sh_normal`?");
        let all = format!("there is no layer `x-ray`; there are {}", KNOWN.join(", "));
        assert_eq!(problem("x-ray"), all);
        let both = "`none` stands for no layer at all, and the list also names `direct`";
        assert_eq!(problem("none,direct"), both);
        assert_eq!(problem("direct,none"), both);
    }

    #[test]
    fn what_is_rendered_is_what_the_layers_need() {
        let aovs = |list: &str| list.parse::<Layers>().unwrap().aovs();
        assert_eq!(aovs("direct,variance"), []);
        assert_eq!(aovs("uv,direct,depth"), [Aov::Uv, Aov::Depth]);
        assert_eq!(aovs("all"), AOVS.map(|(aov, ..)| aov));
    }
}
