//! Who accounts for which light path: one total function, so that nothing is lost or counted twice.

use crate::bsdf::Event;
use crate::film::Layer;

/// What a photon has been through since the lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum LightPath {
    /// Nothing (but straight passages).
    Direct = 0,
    /// Specular and glossy surfaces only.
    Specular = 1,
    /// At least one rough surface.
    Scattered = 2,
}

/// What estimates a light path where it ends at the camera path's gather point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    NextEvent,
    GlobalMap,
    CausticMap,
}

impl LightPath {
    /// After scattering once more.
    #[must_use]
    pub fn after(self, event: Event) -> Self {
        match (self, event) {
            (path, Event::Null) => path,
            (_, Event::Smooth) | (Self::Scattered, Event::Delta | Event::Glossy) => Self::Scattered,
            (Self::Direct | Self::Specular, Event::Delta | Event::Glossy) => Self::Specular,
        }
    }

    /// The estimator that owns it. Emission seen by the camera is no light path: the camera owns it.
    pub fn owner(self, next_event: bool, caustic_map: bool) -> Owner {
        match self {
            Self::Direct if next_event => Owner::NextEvent,
            Self::Specular if caustic_map => Owner::CausticMap,
            Self::Direct | Self::Specular | Self::Scattered => Owner::GlobalMap,
        }
    }

    /// The layer of the picture it contributes to.
    pub fn layer(self) -> Layer {
        match self {
            Self::Direct => Layer::Direct,
            Self::Specular => Layer::Caustic,
            Self::Scattered => Layer::Indirect,
        }
    }

    /// Inverse of `as u8`.
    pub fn from_tag(tag: u8) -> Self {
        match tag {
            0 => Self::Direct,
            1 => Self::Specular,
            _ => Self::Scattered,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_has_exactly_one_owner_and_null_changes_nothing() {
        for path in [LightPath::Direct, LightPath::Specular, LightPath::Scattered] {
            assert_eq!(path.after(Event::Null), path);
            assert_eq!(path.after(Event::Smooth), LightPath::Scattered);
            assert_eq!(LightPath::from_tag(path as u8), path);
        }
        for event in [Event::Delta, Event::Glossy] {
            assert_eq!(LightPath::Direct.after(event), LightPath::Specular);
            assert_eq!(LightPath::Scattered.after(event), LightPath::Scattered);
        }
        assert_eq!(LightPath::Direct.owner(true, true), Owner::NextEvent);
        assert_eq!(LightPath::Direct.owner(false, true), Owner::GlobalMap);
        assert_eq!(LightPath::Specular.owner(true, true), Owner::CausticMap);
        assert_eq!(LightPath::Specular.owner(true, false), Owner::GlobalMap);
        assert_eq!(LightPath::Scattered.owner(true, true), Owner::GlobalMap);
    }
}
