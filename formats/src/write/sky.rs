//! Sun and sky as a picture.

use std::path::Path;

use super::image::{Pixels, exr, resample};
use super::{Output, WriteError};
use crate::ir::{ColorSlot, EnvironmentMapping, Origin, SunSky};
use crate::sky::picture;

impl Output<'_> {
    /// The name of a float picture of the light, in the space that [`crate::sky::Picture::TO_LOCAL`] leads out of.
    pub fn daylight(
        &mut self,
        light: &SunSky,
        mapping: EnvironmentMapping,
        origin: Origin,
    ) -> Result<String, WriteError> {
        let albedo = self.rgb(&light.albedo, ColorSlot::Reflectance, origin);
        self.make(&format!("{mapping:?} {light:?}"), "textures", "sunsky", "exr", |_| {
            let pixels = match picture(light, albedo) {
                Some(sky) => Pixels { width: sky.width, height: sky.height, rgb: sky.rgb },
                None => Pixels { width: 1, height: 1, rgb: vec![[0.0; 3]] },
            };
            match mapping {
                EnvironmentMapping::LatLong => exr(Path::new("sunsky"), &pixels),
                EnvironmentMapping::EqualArea => exr(Path::new("sunsky"), &resample(&pixels, mapping)),
            }
        })
    }
}
