//! Colour and number parameters.

use super::Writer;
use super::element::{Element, number, numbers};
use crate::ir::{Color, ColorInput, ColorSlot, FloatInput, Origin, SpectrumRule};
use crate::spectrum::to_linear_rgb;
use crate::write::WriteError;

impl Writer<'_, '_> {
    pub fn rgb(&mut self, color: &Color, slot: ColorSlot, origin: Origin) -> [f64; 3] {
        self.out.rgb(color, slot, origin)
    }

    pub fn color(&mut self, name: &str, color: &Color, slot: ColorSlot, origin: Origin) -> Element {
        let rule = self.out.spectrum_rule();
        let same = to_linear_rgb(color, slot, rule) == to_linear_rgb(color, slot, SpectrumRule::Mitsuba3);
        let named = |tag: &'static str| Element::new(tag).with("name", name);
        let plugin = |kind: &str| Element::plugin("spectrum", kind).with("name", name);
        match color {
            Color::Gray(v) => named("float").with("value", number(*v)),
            Color::UniformSpectrum(v) if same => named("spectrum").with("value", number(*v)),
            Color::Samples(samples)
                if same && rises(samples) && (slot != ColorSlot::Reflectance || bounded(samples)) =>
            {
                let pair = |[nm, v]: &[f64; 2]| format!("{}:{}", number(*nm), number(*v));
                named("spectrum").with("value", samples.iter().map(pair).collect::<Vec<_>>().join(", "))
            }
            Color::UniformPlugin(v) => plugin("uniform").float("value", *v),
            Color::BoundedRgb(rgb) if rgb.iter().all(|v| (0.0..=1.0).contains(v)) => {
                plugin("srgb").child(rgb_element("color", *rgb))
            }
            Color::D65 { scale, color } => plugin("d65")
                .float_unless("scale", *scale, 1.0)
                .children(color.map(|rgb| rgb_element("color", rgb))),
            _ => {
                let mut rgb = self.rgb(color, slot, origin);
                if slot == ColorSlot::Reflectance && rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
                    let clamped = rgb.map(|v| v.clamp(0.0, 1.0));
                    let what = format!("reflectance {} outside 0..1", numbers(&rgb));
                    self.out.lose(origin, what, format!("rgb {}", numbers(&clamped)));
                    rgb = clamped;
                }
                rgb_element(name, rgb)
            }
        }
    }

    /// Nothing when the reader assumes `default` anyway.
    pub fn color_input(
        &mut self,
        name: &str,
        input: &ColorInput,
        slot: ColorSlot,
        default: Option<f64>,
        origin: Origin,
    ) -> Result<Option<Element>, WriteError> {
        match input {
            ColorInput::Color(Color::Gray(v)) if Some(*v) == default => Ok(None),
            ColorInput::Color(color) => Ok(Some(self.color(name, color, slot, origin))),
            ColorInput::Texture(id) => self.texture(name, *id).map(Some),
        }
    }

    pub fn float_input(
        &mut self,
        name: &str,
        input: &FloatInput,
        default: Option<f64>,
    ) -> Result<Option<Element>, WriteError> {
        match input {
            FloatInput::Value(v) if Some(*v) == default => Ok(None),
            FloatInput::Value(v) => {
                Ok(Some(Element::new("float").with("name", name).with("value", number(*v))))
            }
            FloatInput::Texture(id) => self.float_texture(name, *id).map(Some),
        }
    }

    /// A colour of light, brighter by `factor`.
    pub fn light(&mut self, name: &str, color: &Color, factor: f64, origin: Origin) -> Element {
        let factor = factor * self.light;
        let color = self.scaled(color, factor, origin);
        self.color(name, &color, ColorSlot::Emission, origin)
    }

    fn scaled(&mut self, color: &Color, factor: f64, origin: Origin) -> Color {
        if factor == 1.0 {
            return color.clone();
        }
        match color {
            Color::Gray(v) => Color::Gray(v * factor),
            Color::UniformSpectrum(v) => Color::UniformSpectrum(v * factor),
            Color::UniformPlugin(v) => Color::UniformPlugin(v * factor),
            Color::Rgb(rgb) | Color::BoundedRgb(rgb) => Color::Rgb(rgb.map(|v| v * factor)),
            Color::Srgb(encoded) => Color::Rgb(encoded.map(|v| crate::spectrum::srgb_to_linear(v) * factor)),
            Color::Samples(samples) => {
                Color::Samples(samples.iter().map(|[nm, v]| [*nm, v * factor]).collect())
            }
            Color::D65 { scale, color } => Color::D65 { scale: scale * factor, color: *color },
            Color::Blackbody { kelvin, scale } => Color::Blackbody { kelvin: *kelvin, scale: scale * factor },
            Color::WithLuminance { spectrum, luminance } => {
                Color::WithLuminance { spectrum: spectrum.clone(), luminance: luminance * factor }
            }
            Color::Library(_) => Color::Rgb(self.rgb(color, ColorSlot::Emission, origin).map(|v| v * factor)),
        }
    }
}

pub(super) fn rgb_element(name: &str, rgb: [f64; 3]) -> Element {
    let value = if rgb[0] == rgb[1] && rgb[1] == rgb[2] { number(rgb[0]) } else { numbers(&rgb) };
    Element::new("rgb").with("name", name).with("value", value)
}

/// Mitsuba wants two wavelengths at least, each above the one before it.
fn rises(samples: &[[f64; 2]]) -> bool {
    samples.len() > 1 && samples.windows(2).all(|pair| pair[0][0] < pair[1][0])
}

/// Mitsuba clamps the colour of other reflectances, and warns.
fn bounded(samples: &[[f64; 2]]) -> bool {
    samples.iter().all(|[_, v]| (0.0..=1.0).contains(v))
}
