//! Layers of an EXR beside the picture itself.

use std::str::FromStr;

use thiserror::Error;

use crate::film::LAYERS;

/// Layers that may be asked for, in the order in which `all` stores them: the parts of the picture, which
/// add up to it, then the variance of each pixel's mean luminance and the number of camera samples.
pub const KNOWN: [&str; LAYERS.len() + 2] = {
    let mut known = ["variance"; LAYERS.len() + 2];
    let mut i = 0;
    while i < LAYERS.len() {
        known[i] = LAYERS[i].1;
        i += 1;
    }
    known[LAYERS.len() + 1] = "samples";
    known
};

/// A layer was asked for that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no layer `{name}`; there are {}", names())]
pub struct UnknownLayer {
    /// As it was asked for.
    pub name: String,
}

/// The names, for people.
fn names() -> String {
    KNOWN.join(", ")
}

/// Which layers to store: each once, in the order asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layers(Vec<&'static str>);

impl Layers {
    /// What is stored when nothing is asked for: the parts of the picture.
    pub fn parts() -> Self {
        Self(LAYERS.map(|(_, name)| name).to_vec())
    }

    /// Their names.
    pub fn iter(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().copied()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromStr for Layers {
    type Err = UnknownLayer;

    /// A list of names of [`KNOWN`] with commas between them, among which `all` stands for every one and
    /// `none` for nothing. A layer that is named twice is stored once.
    fn from_str(list: &str) -> Result<Self, UnknownLayer> {
        let mut layers = Self::default();
        for name in list.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            let wanted = match name {
                "none" => &[],
                "all" => &KNOWN[..],
                _ => match KNOWN.iter().position(|known| *known == name) {
                    Some(i) => &KNOWN[i..=i],
                    None => return Err(UnknownLayer { name: name.to_owned() }),
                },
            };
            for layer in wanted {
                if !layers.0.contains(layer) {
                    layers.0.push(layer);
                }
            }
        }
        Ok(layers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layer_is_stored_once() {
        let of = |list: &str| list.parse::<Layers>().unwrap().iter().collect::<Vec<_>>().join(" ");
        assert_eq!(of("all,direct"), "emission direct caustic indirect variance samples");
        assert_eq!(of("direct,all"), "direct emission caustic indirect variance samples");
        assert_eq!(of("samples, direct,samples"), "samples direct");
        assert_eq!(of("none"), "");
        assert!("all,direkt".parse::<Layers>().is_err());
    }
}
