//! Colour parameters: numbers, spectra and the spectrum plugins.

use super::number;
use super::object::{Class, Entry, Object, ObjectIndex, Value};
use super::props::Props;
use super::reader::Reader;
use super::texture::is_texture_plugin;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{Color, ColorInput, ColorSlot, FloatInput};
use crate::plugin::{Plugin, read};
use crate::range::doubt;
use crate::spectrum::to_linear_rgb;

type ReadSpectrum = fn(&mut Props<'_>) -> Option<Color>;

/// Spectrum plugins.
pub(super) const SPECTRA: &[Plugin<ReadSpectrum>] = &[
    read("d65", d65),
    read("uniform", uniform),
    read("srgb", srgb),
    read("blackbody", blackbody),
    read("irregular", irregular),
    read("regular", regular),
    read("rawconstant", raw_constant),
    read("srgb_d65", d65),
];

/// In Mitsuba 2 and 3, spectra and textures differ only by the name of the plugin.
pub(super) fn is_texture(object: &Object) -> bool {
    let is_spectrum = SPECTRA.iter().any(|row| row.name == object.plugin);
    match object.class {
        Class::Texture => !is_spectrum,
        Class::Spectrum => !is_spectrum && is_texture_plugin(&object.plugin),
        _ => false,
    }
}

/// Whether it is one colour everywhere: a spectrum plugin, perhaps written as a texture.
pub(super) fn is_spectrum(object: &Object) -> bool {
    matches!(object.class, Class::Texture | Class::Spectrum) && !is_texture(object)
}

impl<'a> Reader<'a> {
    /// Reads a texture or spectrum to report its problems; it is used only where something refers to it.
    pub fn top_level_texture(&mut self, index: ObjectIndex) {
        if is_texture(&self.objects[index]) {
            self.texture(index);
        } else {
            self.spectrum(index);
        }
    }

    /// A colour or texture; `default` when it is not given or was reported.
    pub fn color_input(
        &mut self,
        props: &mut Props<'a>,
        name: &'static str,
        slot: ColorSlot,
        default: f64,
    ) -> ColorInput {
        let default = ColorInput::Color(Color::Gray(default));
        let Some(entry) = props.entry(name) else { return default };
        self.color_value(props, entry, slot).unwrap_or(default)
    }

    /// A colour that may not be textured.
    pub fn color(
        &mut self,
        props: &mut Props<'a>,
        name: &'static str,
        slot: ColorSlot,
        default: f64,
    ) -> Color {
        self.optional_color(props, name, slot).unwrap_or(Color::Gray(default))
    }

    pub fn optional_color(
        &mut self,
        props: &mut Props<'a>,
        name: &'static str,
        slot: ColorSlot,
    ) -> Option<Color> {
        let entry = props.entry(name)?;
        match self.color_value(props, entry, slot)? {
            ColorInput::Color(color) => Some(color),
            ColorInput::Texture(_) => {
                let text = format!("a texture for `{name}` of {} is not supported", props.object.plugin);
                props.problems.push(Diagnostic::error(text, Some(entry.span)));
                None
            }
        }
    }

    /// A number or texture.
    pub fn float_input(&mut self, props: &mut Props<'a>, name: &'static str, default: f64) -> FloatInput {
        self.optional_float_input(props, name).unwrap_or(FloatInput::Value(default))
    }

    pub fn optional_float_input(&mut self, props: &mut Props<'a>, name: &'static str) -> Option<FloatInput> {
        let entry = props.entry(name)?;
        let input = self.float_input_of(props, name, entry);
        if let Some(FloatInput::Value(value)) = input
            && let Some(text) = doubt(name, value)
        {
            props.problems.push(Diagnostic::warning(text, Some(entry.span)));
        }
        input
    }

    fn float_input_of(&mut self, props: &mut Props<'a>, name: &str, entry: &Entry) -> Option<FloatInput> {
        match &entry.value {
            Value::Float(v) => Some(FloatInput::Value(*v)),
            Value::Integer(v) => Some(FloatInput::Value(*v as f64)),
            Value::Color { color: Color::UniformSpectrum(v), .. } => Some(FloatInput::Value(*v)),
            // 0.6 masks have coloured opacities; a float is their luminance.
            Value::Color { color: Color::Rgb([r, g, b]), .. } => {
                if r != g || g != b {
                    let text = format!("`{name}` is one number: the luminance of the colour is used");
                    props.problems.push(Diagnostic::warning(text, Some(entry.span)));
                }
                let luminance = 0.212671 * r + 0.715160 * g + 0.072169 * b;
                Some(FloatInput::Value(if r == g && g == b { *r } else { luminance }))
            }
            Value::Object(index) if is_texture(&self.objects[*index]) => {
                Some(self.texture(*index).map_or(FloatInput::Value(0.5), FloatInput::Texture))
            }
            Value::Object(index) if is_spectrum(&self.objects[*index]) => {
                let color = self.spectrum(*index);
                Some(FloatInput::Value(color.map_or(0.5, |color| self.number(props, entry, &color))))
            }
            _ => props.wrong(entry, "a float or texture"),
        }
    }

    /// The number that Mitsuba makes of a spectrum plugin where it wants one: the luminance of a colour.
    fn number(&self, props: &mut Props<'a>, entry: &Entry, color: &Color) -> f64 {
        match color {
            Color::Gray(v) | Color::UniformPlugin(v) | Color::D65 { scale: v, color: None } => return *v,
            Color::Rgb(rgb) if rgb[0] == rgb[1] && rgb[1] == rgb[2] => return rgb[0],
            _ => {}
        }
        let name = entry.name.as_deref().unwrap_or_default();
        let text = format!("`{name}` is one number: the luminance of the colour is used");
        props.problems.push(Diagnostic::warning(text, Some(entry.span)));
        let rule = self.dialect.spectrum_rule();
        match to_linear_rgb(color, ColorSlot::Unbounded, rule) {
            Ok(rgb) => 0.212671 * rgb[0] + 0.715160 * rgb[1] + 0.072169 * rgb[2],
            Err(e) => {
                props.problems.push(Diagnostic::error(e.to_string(), Some(entry.span)));
                0.5
            }
        }
    }

    /// A texture of colours or a spectrum plugin in its place.
    pub fn nested_color(&mut self, index: ObjectIndex) -> Option<ColorInput> {
        if is_texture(&self.objects[index]) {
            return self.texture(index).map(ColorInput::Texture);
        }
        self.spectrum(index).map(ColorInput::Color)
    }

    pub fn color_value(
        &mut self,
        props: &mut Props<'a>,
        entry: &Entry,
        slot: ColorSlot,
    ) -> Option<ColorInput> {
        let color = match &entry.value {
            Value::Float(v) => Color::Gray(*v),
            Value::Integer(v) => Color::Gray(*v as f64),
            Value::Color { color, .. } => color.clone(),
            Value::Object(index) => {
                let object = &self.objects[*index];
                match object.class {
                    Class::Texture | Class::Spectrum if is_texture(object) => {
                        let gray = ColorInput::Color(Color::Gray(0.5));
                        let outer = self.in_emitter;
                        self.in_emitter |= slot == ColorSlot::Emission;
                        let texture = self.texture(*index);
                        self.in_emitter = outer;
                        return Some(texture.map_or(gray, ColorInput::Texture));
                    }
                    Class::Texture | Class::Spectrum => self.spectrum(*index).unwrap_or(Color::Gray(0.5)),
                    _ => return props.wrong(entry, "a colour or texture"),
                }
            }
            _ => return props.wrong(entry, "a colour or texture"),
        };
        self.check_range(props, entry, &color, slot);
        Some(ColorInput::Color(color))
    }

    fn check_range(&self, props: &mut Props<'a>, entry: &Entry, color: &Color, slot: ColorSlot) {
        let (Color::Rgb(rgb) | Color::Srgb(rgb)) = color else { return };
        let name = entry.name.as_deref().unwrap_or_default();
        let shown = rgb.map(|v| v.to_string()).join(", ");
        if slot == ColorSlot::Reflectance && self.in_emitter && rgb.iter().all(|v| *v >= 0.0) {
            if self.dialect != Dialect::Old && rgb.iter().any(|v| *v > 1.0) {
                let text = format!("`{name}` is light here and may be more than 1: [{shown}]");
                let problem = Diagnostic::warning(text, Some(entry.span));
                props.problems.push(problem.help("Mitsuba takes it so up to 3.6, and rejects it later"));
            }
        } else if slot == ColorSlot::Reflectance && rgb.iter().any(|v| !(0.0..=1.0).contains(v)) {
            let text = format!("`{name}` is a reflectance and must lie between 0 and 1, not [{shown}]");
            props.problems.push(Diagnostic::new(self.strict(), text, Some(entry.span)));
        } else if rgb.iter().any(|v| *v < 0.0) {
            let text = format!("`{name}` is negative: [{shown}]");
            props.problems.push(Diagnostic::warning(text, Some(entry.span)));
        }
    }

    /// A spectrum plugin as a colour.
    pub fn spectrum(&mut self, index: ObjectIndex) -> Option<Color> {
        let reader = self.plugin(SPECTRA, index, "gray 0.5 is used")?;
        let mut props = self.props(index);
        let color = reader(&mut props);
        self.finish(props);
        color
    }
}

/// A colour times a number.
pub(super) fn times(color: Color, factor: f64) -> Color {
    match color {
        Color::Gray(v) => Color::Gray(v * factor),
        Color::UniformPlugin(v) => Color::UniformPlugin(v * factor),
        Color::UniformSpectrum(v) => Color::UniformSpectrum(v * factor),
        Color::Rgb(rgb) => Color::Rgb(rgb.map(|c| c * factor)),
        Color::D65 { scale, color } => Color::D65 { scale: scale * factor, color },
        Color::Blackbody { kelvin, scale } => Color::Blackbody { kelvin, scale: scale * factor },
        Color::Samples(samples) => {
            Color::Samples(samples.into_iter().map(|[nm, v]| [nm, v * factor]).collect())
        }
        Color::BoundedRgb(rgb) => Color::Rgb(rgb.map(|c| c * factor)),
        // Decoding is no linear thing; a library has no factor of its own.
        other @ (Color::Srgb(_) | Color::Library(_) | Color::WithLuminance { .. }) => other,
    }
}

fn rgb(props: &mut Props<'_>, name: &'static str) -> Option<[f64; 3]> {
    let entry = props.entry(name)?;
    match &entry.value {
        Value::Color { color: Color::Rgb(rgb), .. } => Some(*rgb),
        Value::Color { color: Color::UniformSpectrum(v), .. } | Value::Float(v) => Some([*v; 3]),
        Value::Integer(v) => Some([*v as f64; 3]),
        _ => props.wrong(entry, "an rgb colour"),
    }
}

fn d65(props: &mut Props<'_>) -> Option<Color> {
    let scale = props.float("scale", 1.0);
    let color = rgb(props, "color").or_else(|| {
        let entry = props.object.entries.iter().find(|e| matches!(e.value, Value::Color { .. }))?;
        let Value::Color { color: Color::Rgb(rgb), .. } = entry.value else { return None };
        props.ignore_rest();
        Some(rgb)
    });
    Some(Color::D65 { scale, color })
}

fn uniform(props: &mut Props<'_>) -> Option<Color> {
    props.ignore(&["wavelength_min", "wavelength_max", "lambda_min", "lambda_max"]);
    Some(Color::UniformPlugin(props.float("value", 1.0)))
}

/// The value of a number that is not light, in any slot.
fn raw_constant(props: &mut Props<'_>) -> Option<Color> {
    let Some(entry) = props.entry("value") else {
        props.complain("value", "rawconstant needs the parameter `value`");
        return None;
    };
    match &entry.value {
        Value::Float(v) => Some(Color::Gray(*v)),
        Value::Integer(v) => Some(Color::Gray(*v as f64)),
        Value::Vector(v) => Some(Color::Rgb(*v)),
        _ => props.wrong(entry, "a float or vector"),
    }
}

fn srgb(props: &mut Props<'_>) -> Option<Color> {
    let color = rgb(props, "color");
    if color.is_none() && !props.has("color") {
        props.complain("color", "srgb needs the parameter `color`");
    }
    Some(Color::BoundedRgb(color?))
}

fn blackbody(props: &mut Props<'_>) -> Option<Color> {
    props.ignore(&["wavelength_min", "wavelength_max"]);
    let kelvin = props.positive("temperature", 5000.0);
    Some(Color::Blackbody { kelvin, scale: props.float("scale", 1.0) })
}

fn numbers(props: &mut Props<'_>, name: &'static str) -> Option<Vec<f64>> {
    let entry = props.entry(name);
    let Some(entry) = entry else {
        let text = format!("{} needs the parameter `{name}`", props.object.plugin);
        props.complain(name, text);
        return None;
    };
    let Value::String(text) = &entry.value else {
        return props.wrong(entry, "a string of numbers");
    };
    let list = number::floats(text);
    if list.is_none() {
        props.complain(name, format!("`{name}` is not a list of numbers"));
    }
    list
}

fn irregular(props: &mut Props<'_>) -> Option<Color> {
    let (wavelengths, values) = (numbers(props, "wavelengths"), numbers(props, "values"));
    let (wavelengths, values) = (wavelengths?, values?);
    if wavelengths.len() != values.len() {
        let text = format!("{} wavelengths but {} values", wavelengths.len(), values.len());
        props.complain("values", text);
        return None;
    }
    samples(props, wavelengths.into_iter().zip(values).map(|(w, v)| [w, v]).collect())
}

fn regular(props: &mut Props<'_>) -> Option<Color> {
    let min = props.optional_float("wavelength_min").or_else(|| props.optional_float("lambda_min"));
    let max = props.optional_float("wavelength_max").or_else(|| props.optional_float("lambda_max"));
    let values = numbers(props, "values")?;
    let (min, max) = (min.unwrap_or(360.0), max.unwrap_or(830.0));
    let step = (max - min) / (values.len().max(2) - 1) as f64;
    samples(props, values.into_iter().enumerate().map(|(i, v)| [min + step * i as f64, v]).collect())
}

fn samples(props: &mut Props<'_>, samples: Vec<[f64; 2]>) -> Option<Color> {
    match number::ascending(samples) {
        Ok(samples) => Some(Color::Samples(samples)),
        Err(reason) => {
            props.complain("values", reason);
            None
        }
    }
}
