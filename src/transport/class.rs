//! The table of path classes: class → owner → layer.
//!
//! A path from camera to lamp is described by what scatters it: S stands for a specular or glossy surface, M for a
//! medium, D for a rough surface or a medium, `*` for any number and `+` for at least one. Straight passages count as
//! nothing.
//!
//! | class | camera … lamp | owner | layer |
//! |---|---|---|---|
//! | emission | S* | camera | emission |
//! | direct | S* D | next event estimation, or else the global map | direct |
//! | caustic | S* D S+ | the caustic map, or else the global map | caustic |
//! | indirect | S* D … D S* | the global map | indirect |
//! | medium | S* M … | volume maps; straight from the lamp, next event estimation | medium |
//!
//! The class of the path that has a medium where these have their first rough surface is always medium.
//!
//! Of emission, glints (`glint`) belong to photons of the caustic map instead.
//!
//! Both directions use it. A camera path carries the class that it has if it meets a lamp next; a light
//! path carries the class that it has if it meets next the rough surface that the camera path ends at.

use crate::bsdf::Event;
use crate::film::Layer;

/// What lies between camera and lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum PathClass {
    /// No rough surface: the lamp is seen, in mirrors and through glass too.
    Emission,
    /// One rough surface, lit straight by the lamp.
    Direct,
    /// One rough surface, lit through specular and glossy surfaces.
    Caustic,
    /// More than one rough surface.
    Indirect,
    /// A medium comes before any rough surface.
    Medium,
}

/// What accounts for the paths of a class. Every class has exactly one owner, so that no path is lost or
/// counted twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Camera paths that meet the lamp.
    Camera,
    /// A shadow ray from the first rough surface.
    NextEvent,
    /// Photons of the global map.
    GlobalMap,
    /// Photons of the caustic map.
    CausticMap,
    /// Photons and beams in media, but for light straight from a lamp.
    VolumeMaps,
}

impl PathClass {
    /// All classes; the index of each is its tag.
    pub const ALL: [Self; 5] = [Self::Emission, Self::Direct, Self::Caustic, Self::Indirect, Self::Medium];

    /// Of a camera path that has not scattered yet.
    pub const FROM_CAMERA: Self = Self::Emission;

    /// Of a light path that has not scattered yet.
    pub const FROM_LAMP: Self = Self::Direct;

    /// The layer of the picture that its light goes to.
    #[inline(always)]
    pub fn layer(self) -> Layer {
        match self {
            Self::Emission => Layer::Emission,
            Self::Direct => Layer::Direct,
            Self::Caustic => Layer::Caustic,
            Self::Indirect => Layer::Indirect,
            Self::Medium => Layer::Medium,
        }
    }

    /// Its owner in photon mapping, by what the settings use: next event estimation, and a caustic map.
    #[inline(always)]
    pub fn owner(self, next_event: bool, caustic_map: bool) -> Owner {
        match self {
            Self::Emission => Owner::Camera,
            Self::Direct if next_event => Owner::NextEvent,
            Self::Caustic if caustic_map => Owner::CausticMap,
            Self::Medium => Owner::VolumeMaps,
            Self::Direct | Self::Caustic | Self::Indirect => Owner::GlobalMap,
        }
    }

    /// Of a camera path that has scattered once more.
    #[must_use]
    #[inline(always)]
    pub fn after_camera_event(self, event: Event) -> Self {
        match (self, event) {
            (class, Event::Null) => class,
            (Self::Medium, _) => Self::Medium,
            (Self::Emission, Event::Delta | Event::Glossy) => Self::Emission,
            (Self::Emission, Event::Smooth) => Self::Direct,
            (Self::Direct | Self::Caustic, Event::Delta | Event::Glossy) => Self::Caustic,
            (Self::Direct | Self::Caustic | Self::Indirect, _) => Self::Indirect,
        }
    }

    /// Of a camera path that a medium has scattered.
    #[must_use]
    #[inline(always)]
    pub fn after_camera_medium(self) -> Self {
        match self {
            Self::Emission | Self::Medium => Self::Medium,
            Self::Direct | Self::Caustic | Self::Indirect => Self::Indirect,
        }
    }

    /// Of a light path that a medium has scattered.
    #[must_use]
    #[inline(always)]
    pub fn after_light_medium(self) -> Self {
        self.after_light_event(Event::Smooth)
    }

    /// Of a light path that has scattered once more.
    #[must_use]
    #[inline(always)]
    pub fn after_light_event(self, event: Event) -> Self {
        match (self, event) {
            (class, Event::Null) => class,
            (_, Event::Smooth) | (Self::Indirect | Self::Medium, Event::Delta | Event::Glossy) => {
                Self::Indirect
            }
            (Self::Emission | Self::Direct | Self::Caustic, Event::Delta | Event::Glossy) => Self::Caustic,
        }
    }

    /// The class that `class as u8` came from.
    #[inline(always)]
    pub fn from_tag(tag: u8) -> Self {
        match tag {
            0 => Self::Emission,
            1 => Self::Direct,
            2 => Self::Caustic,
            3 => Self::Indirect,
            _ => Self::Medium,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owners_and_layers_are_those_of_the_table() {
        let rows = [
            (PathClass::Emission, [Owner::Camera; 4], Layer::Emission),
            (
                PathClass::Direct,
                [Owner::GlobalMap, Owner::GlobalMap, Owner::NextEvent, Owner::NextEvent],
                Layer::Direct,
            ),
            (
                PathClass::Caustic,
                [Owner::GlobalMap, Owner::CausticMap, Owner::GlobalMap, Owner::CausticMap],
                Layer::Caustic,
            ),
            (PathClass::Indirect, [Owner::GlobalMap; 4], Layer::Indirect),
            (PathClass::Medium, [Owner::VolumeMaps; 4], Layer::Medium),
        ];
        for (tag, (class, owners, layer)) in rows.into_iter().enumerate() {
            assert_eq!(PathClass::ALL[tag], class);
            assert_eq!(PathClass::from_tag(tag as u8), class);
            assert_eq!(class as usize, tag);
            assert_eq!(class.layer(), layer);
            for (i, owner) in owners.into_iter().enumerate() {
                assert_eq!(class.owner(i & 2 != 0, i & 1 != 0), owner, "{class:?} {i}");
            }
        }
    }

    /// What may happen to a path: one of the events of a surface, or `None`, a medium that scatters.
    const ALL_THAT_HAPPENS: [Option<Event>; 5] =
        [Some(Event::Null), Some(Event::Delta), Some(Event::Glossy), Some(Event::Smooth), None];

    /// All paths of up to five events, told from both ends. A light path has its class where it meets a
    /// rough surface that the camera sees, so the camera's part is cut off after its first rough surface.
    #[test]
    fn both_directions_give_a_path_the_same_class() {
        for length in 0..=5u32 {
            for number in 0..5usize.pow(length) {
                let path: Vec<_> =
                    (0..length).map(|i| ALL_THAT_HAPPENS[number / 5usize.pow(i) % 5]).collect();
                let camera = path.iter().fold(PathClass::FROM_CAMERA, |c, e| match e {
                    Some(event) => c.after_camera_event(*event),
                    None => c.after_camera_medium(),
                });
                let Some(first) = path.iter().position(|e| matches!(e, Some(Event::Smooth) | None)) else {
                    assert_eq!(camera, PathClass::Emission, "{path:?}");
                    continue;
                };
                if path[first].is_none() {
                    assert_eq!(camera, PathClass::Medium, "{path:?}");
                    continue;
                }
                let lamps = path[first + 1..].iter().rev();
                let light = lamps.fold(PathClass::FROM_LAMP, |c, e| match e {
                    Some(event) => c.after_light_event(*event),
                    None => c.after_light_medium(),
                });
                assert_eq!(light, camera, "{path:?}");
            }
        }
    }
}
