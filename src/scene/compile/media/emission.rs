//! What media emit.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorSlot, MediumEmission};
use caustica_formats::spectrum::greatest_planck;

use super::super::Compiler;
use crate::math::Color;
use crate::medium::{Ramp, Volume};

/// Kelvin up to which pbrt's black bodies are dark, and beyond which no table goes.
const DARK: f64 = 100.0;
const HOTTEST: f64 = 1e6;

/// Entries of the table of a black body's colours.
const STEPS: usize = 512;

impl Compiler<'_> {
    /// The radiance of what absorbs.
    pub(super) fn medium_emission(&mut self, e: &MediumEmission, at: ir::Origin) -> Option<Volume> {
        let (first, scale) = match e {
            MediumEmission::Radiance { radiance, scale } => {
                (self.volume(radiance, ColorSlot::Emission, at)?, scale)
            }
            MediumEmission::Temperature { kelvin, offset, factor, peak, scale } => {
                let kelvin = self.volume(kelvin, ColorSlot::Unbounded, at)?;
                (self.hot(kelvin, (*offset, *factor), *peak, at), scale)
            }
        };
        let scale = self.volume(scale, ColorSlot::Unbounded, at)?;
        Some(match (first, scale) {
            (Volume::Constant(a), Volume::Constant(b)) => Volume::Constant(a * b),
            (Volume::Grid(grid, tint), Volume::Constant(c))
            | (Volume::Constant(c), Volume::Grid(grid, tint)) => Volume::Grid(grid, tint * c),
            (first, scale) => Volume::Product(Box::new([first, scale])),
        })
    }

    /// The colours of black bodies, whose spectra have this `peak`.
    fn hot(&mut self, kelvin: Volume, (offset, factor): (f64, f64), peak: f64, at: ir::Origin) -> Volume {
        let hottest = ((f64::from(kelvin.largest()) - offset) * factor).clamp(DARK, HOTTEST);
        let mut colors = Vec::new();
        for i in 0..=STEPS {
            let t = DARK + (hottest - DARK) * i as f64 / STEPS as f64;
            let color = ir::Color::Blackbody { kelvin: t, scale: peak / greatest_planck(t) };
            colors.push(self.color(&color, ColorSlot::Emission, at));
        }
        // pbrt's are dark up to and with the coldest.
        let ramp = Ramp { begin: DARK as f32, end: hottest as f32, colors, below: Color::ZERO };
        let (factor, offset) = (factor as f32, offset as f32);
        match kelvin {
            Volume::Grid(grid, tint) => {
                Volume::Ramp(Arc::new(ramp), grid, [tint.lanes()[0] * factor, -offset * factor])
            }
            other => Volume::Constant(
                ramp.color((other.color(crate::math::Vec3::ZERO).lanes()[0] - offset) * factor),
            ),
        }
    }
}
