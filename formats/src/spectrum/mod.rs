//! CIE tables, named metals and indices, and the conversion of colours to linear Rec.709.

mod cie;
mod convert;
#[cfg(test)]
mod cornell;
mod integrate;
mod ior;
mod library;
mod media;
mod metals;
mod spd;
mod srgb;
mod white;

pub(crate) use convert::wavelength_rgb;
pub use convert::{SpectrumError, greatest_planck, luminance, planck, to_linear_rgb};
pub use ior::{ior, ior_names};
pub use library::{LibrarySpectrum, library_names, library_spectrum};
pub use media::{Preset, Reduced, medium_preset, medium_preset_names, reduced_medium, reduced_medium_names};
pub use metals::{Metal, conductor, conductor_names};
pub use spd::{SpdError, parse_spd};
pub use srgb::{SrgbTable, linear_to_srgb, linear_to_srgb_f32, srgb_to_linear, srgb_to_linear_f32};
pub use white::white_balance;
