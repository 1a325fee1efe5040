//! Colours, spectra and textured inputs.

use super::directive::{ParamType, Values};
use super::params::Params;
use super::policy::Fault;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Span, nearest};
use crate::ir::{Color, ColorInput, ColorSlot, FloatInput, Ior, SpectrumRule};
use crate::missing::{find, not_found};
use crate::range::doubt;
use crate::spectrum::{
    LibrarySpectrum, greatest_planck, library_names, library_spectrum, parse_spd, to_linear_rgb,
};

use ParamType as T;

/// What a colour is for: pbrt bounds albedos, and scales what shines to luminance 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Albedo,
    Unbounded,
    Illuminant,
}

const SPECTRA: &[ParamType] = &[T::Rgb, T::Spectrum, T::Blackbody];
const SPECTRA_OR_TEXTURE: &[ParamType] = &[T::Rgb, T::Spectrum, T::Blackbody, T::Texture];
const FLOAT_OR_TEXTURE: &[ParamType] = &[T::Float, T::Texture];
const FLOAT_OR_SPECTRUM: &[ParamType] = &[T::Float, T::Rgb, T::Spectrum, T::Blackbody];

/// The Fraunhofer d line, nm, to which indices of glasses refer.
const D_LINE: f64 = 587.56;

impl Reader<'_> {
    /// A literal colour.
    pub fn color(&mut self, p: &mut Params, name: &'static str, usage: Use) -> Option<Color> {
        let param = p.take(name, SPECTRA)?;
        self.literal(p, name, param.kind, &param.values, param.value_span, usage)
    }

    /// A literal colour or a spectrum texture.
    pub fn optional_color_input(
        &mut self,
        p: &mut Params,
        name: &'static str,
        usage: Use,
    ) -> Option<ColorInput> {
        let param = p.take(name, SPECTRA_OR_TEXTURE)?;
        if param.kind == T::Texture {
            let texture = single(&param.values)?;
            return self.color_texture(p, texture, param.value_span);
        }
        self.literal(p, name, param.kind, &param.values, param.value_span, usage).map(ColorInput::Color)
    }

    pub fn color_input(
        &mut self,
        p: &mut Params,
        name: &'static str,
        usage: Use,
        default: f64,
    ) -> ColorInput {
        self.optional_color_input(p, name, usage).unwrap_or(ColorInput::Color(Color::Gray(default)))
    }

    /// A float or a float texture.
    pub fn optional_float_input(&mut self, p: &mut Params, name: &'static str) -> Option<FloatInput> {
        if p.type_of(name) != Some(T::Texture) {
            if p.type_of(name).is_some_and(|kind| !FLOAT_OR_TEXTURE.contains(&kind)) {
                p.take(name, FLOAT_OR_TEXTURE);
                return None;
            }
            let value = p.optional_float(name)?;
            if let Some(text) = doubt(name, value) {
                p.warn(name, text);
            }
            return Some(FloatInput::Value(value));
        }
        let (texture, span) = p.text(name, &[T::Texture])?;
        self.float_texture(p, &texture, span)
    }

    pub fn float_input(&mut self, p: &mut Params, name: &'static str, default: f64) -> FloatInput {
        self.optional_float_input(p, name).unwrap_or(FloatInput::Value(default))
    }

    /// `eta`: a number or a spectrum, of which the index at the d line is used.
    pub fn index(&mut self, p: &mut Params, name: &'static str) -> Ior {
        const GLASS: Ior = Ior::Value(1.5);
        if p.type_of(name).is_none_or(|kind| kind == T::Float || !FLOAT_OR_SPECTRUM.contains(&kind)) {
            return Ior::Value(p.float(name, 1.5));
        }
        let Some(color) = self.color(p, name, Use::Unbounded) else { return GLASS };
        let index = match &color {
            Color::Samples(samples) => at(samples, D_LINE),
            Color::Rgb(rgb) => rgb[1],
            Color::Library(spectrum) => match library_spectrum(spectrum) {
                Some(LibrarySpectrum::Index(index)) => index,
                _ => {
                    p.complain(name, format!("`{spectrum}` is not an index of refraction"));
                    return GLASS;
                }
            },
            _ => {
                p.complain(name, format!("`{name}` expects an index of refraction"));
                return GLASS;
            }
        };
        p.warn(name, format!("dispersion is not rendered: the index is {index:.4} for all light"));
        Ior::Value(index)
    }

    pub fn color_texture(&mut self, p: &mut Params, name: &str, span: Span) -> Option<ColorInput> {
        if let Some((input, _)) = self.names.color_textures.get(name) {
            return Some(input.clone());
        }
        let known: Vec<&str> = self.names.color_textures.keys().map(String::as_str).collect();
        let other = self.names.float_textures.contains_key(name).then_some("a float texture");
        let problem = no_texture("spectrum", name, span, &known, other);
        self.undefined_texture(p, problem);
        None
    }

    fn float_texture(&mut self, p: &mut Params, name: &str, span: Span) -> Option<FloatInput> {
        if let Some((input, _)) = self.names.float_textures.get(name) {
            return Some(input.clone());
        }
        let known: Vec<&str> = self.names.float_textures.keys().map(String::as_str).collect();
        let other = self.names.color_textures.contains_key(name).then_some("a spectrum texture");
        let problem = no_texture("float", name, span, &known, other);
        self.undefined_texture(p, problem);
        None
    }

    fn undefined_texture(&self, p: &mut Params, problem: Diagnostic) {
        if !self.incomplete {
            p.problems.push(self.policy.judge(Fault::Mistake, problem, "the default is used"));
        }
    }

    fn literal(
        &mut self,
        p: &mut Params,
        name: &'static str,
        kind: ParamType,
        values: &Values,
        span: Span,
        usage: Use,
    ) -> Option<Color> {
        let mut fail = |text: String| {
            p.problems.push(Diagnostic::error(text, Some(span)));
            None
        };
        let spectrum = match (kind, values) {
            (T::Rgb, Values::Floats(v)) => match v[..] {
                [r, g, b] => return self.rgb(p, name, [r, g, b], span, usage),
                _ => return fail(format!("`{name}` expects 3 values, got {}", v.len())),
            },
            (T::Blackbody, Values::Floats(v)) => match v[..] {
                [kelvin] if kelvin > 0.0 => {
                    // pbrt scales the peak to 1.
                    Color::Blackbody { kelvin, scale: 1.0 / greatest_planck(kelvin) }
                }
                // pbrt-v3.
                [kelvin, scale] if kelvin > 0.0 && self.policy.is_three() => {
                    Color::Blackbody { kelvin, scale: scale / greatest_planck(kelvin) }
                }
                [kelvin] => return fail(format!("a temperature must be positive, not {kelvin} K")),
                _ => return fail(format!("`{name}` expects 1 value, got {}", v.len())),
            },
            (T::Spectrum, Values::Floats(v)) => {
                if v.len() % 2 != 0 {
                    let text =
                        format!("a spectrum expects pairs of wavelength and value, got {} numbers", v.len());
                    return fail(text);
                }
                let samples = v.as_chunks::<2>().0.to_vec();
                if let Some(pair) = samples.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
                    let text =
                        format!("wavelengths must increase, but {} nm follows {} nm", pair[1][0], pair[0][0]);
                    return fail(text);
                }
                if samples.len() == 1 {
                    return fail("a spectrum of one wavelength is black everywhere else".to_owned());
                }
                Color::Samples(samples)
            }
            (T::Spectrum, Values::Texts(v)) => match &v[..] {
                [text] => self.named_spectrum(p, text, span)?,
                _ => return fail(format!("`{name}` expects 1 name, got {}", v.len())),
            },
            _ => return None,
        };
        Some(if usage == Use::Illuminant {
            Color::WithLuminance { spectrum: Box::new(spectrum), luminance: 1.0 }
        } else {
            spectrum
        })
    }

    fn rgb(
        &mut self,
        p: &mut Params,
        name: &str,
        mut rgb: [f64; 3],
        span: Span,
        usage: Use,
    ) -> Option<Color> {
        let shown = format!("({}, {}, {})", rgb[0], rgb[1], rgb[2]);
        if rgb.iter().any(|c| *c < 0.0) {
            let text = format!("`{name}` {shown} may not be negative");
            p.problems.push(p.policy.report(Fault::Mistake, &text, span, "0 is used"));
            rgb = rgb.map(|c| c.max(0.0));
        }
        if usage == Use::Albedo && rgb.iter().any(|c| *c > 1.0) {
            let text = format!("`{name}` {shown} reflects more light than arrives: the maximum is 1");
            p.problems.push(p.policy.report(Fault::Mistake, &text, span, "at most 1 is used"));
            rgb = rgb.map(|c| c.min(1.0));
        }
        if usage == Use::Illuminant {
            return Some(Color::Rgb(p.space.light_to_rec709(rgb)));
        }
        let converted = p.space.reflectance_to_rec709(rgb);
        let top = if usage == Use::Albedo { 1.0 } else { f64::INFINITY };
        let clamped = converted.map(|c| c.clamp(0.0, top));
        if (0..3).any(|i| (clamped[i] - converted[i]).abs() > 1e-3) {
            let text = format!("`{name}` lies outside Rec.709 and is moved to its border");
            p.problems.push(Diagnostic::warning(text, Some(span)));
        }
        Some(Color::Rgb(clamped))
    }

    /// A name of pbrt's library, or a file.
    fn named_spectrum(&mut self, p: &mut Params, name: &str, span: Span) -> Option<Color> {
        if library_spectrum(name).is_some() {
            return Some(Color::Library(name.to_owned()));
        }
        let Some(path) = find(self.files, name, self.folders) else {
            let known: Vec<String> = library_names().collect();
            let mut problem = not_found(self.files, "spectrum", name, span, self.folders);
            if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
                problem.help = vec![format!("did you mean `{near}`?")];
            }
            p.problems.push(problem);
            return None;
        };
        let read = self.files.read(&path).map_err(|e| e.to_string());
        match read.and_then(|bytes| parse_spd(&bytes).map_err(|e| e.to_string())) {
            Ok(samples) if samples.len() > 1 => Some(Color::Samples(samples)),
            Ok(_) => {
                let text = format!("the spectrum file `{}` has fewer than two wavelengths", path.display());
                p.problems.push(Diagnostic::error(text, Some(span)));
                None
            }
            Err(e) => {
                let text = format!("cannot read spectrum `{}`: {e}", path.display());
                p.problems.push(Diagnostic::error(text, Some(span)));
                None
            }
        }
    }

    /// The light of the current colour space at luminance 1.
    pub fn white_light(p: &Params) -> Color {
        Color::Rgb(p.space.light_to_rec709([1.0; 3]))
    }
}

/// `color` times `factor`.
pub(super) fn scaled(color: Color, factor: f64) -> Color {
    match color {
        Color::Rgb(rgb) => Color::Rgb(rgb.map(|c| c * factor)),
        Color::Gray(v) => Color::Gray(v * factor),
        Color::WithLuminance { spectrum, luminance } => {
            Color::WithLuminance { spectrum, luminance: luminance * factor }
        }
        Color::Samples(samples) => {
            Color::Samples(samples.into_iter().map(|[nm, v]| [nm, v * factor]).collect())
        }
        Color::Blackbody { kelvin, scale } => Color::Blackbody { kelvin, scale: scale * factor },
        other => other,
    }
}

/// The linear Rec.709 values of a literal colour, by pbrt's rule.
pub(super) fn linear(color: &Color, slot: ColorSlot) -> Option<[f64; 3]> {
    to_linear_rgb(color, slot, SpectrumRule::Pbrt).ok()
}

fn single(values: &Values) -> Option<&str> {
    match values {
        Values::Texts(texts) if texts.len() == 1 => Some(&texts[0]),
        _ => None,
    }
}

/// Piecewise linear, held constant outside.
fn at(samples: &[[f64; 2]], nm: f64) -> f64 {
    let end = samples.partition_point(|sample| sample[0] < nm);
    match (end.checked_sub(1).map(|i| samples[i]), samples.get(end)) {
        (Some([nm0, v0]), Some([nm1, v1])) => v0 + (v1 - v0) * (nm - nm0) / (nm1 - nm0),
        (Some([_, v]), None) => v,
        (None, Some([_, v])) => *v,
        (None, None) => 1.0,
    }
}

fn no_texture(kind: &str, name: &str, span: Span, known: &[&str], other: Option<&str>) -> Diagnostic {
    let text = format!("no {kind} texture named `{name}`");
    let problem = Diagnostic::error(text, Some(span));
    match (other, nearest(name, known.iter().copied())) {
        (Some(other), _) => problem.help(format!("`{name}` is {other}")),
        (None, Some(near)) => problem.help(format!("did you mean `{near}`?")),
        (None, None) => problem.help("a texture must be declared before it is used"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_at_the_d_line() {
        let samples = [[500.0, 1.52], [600.0, 1.51]];
        assert!((at(&samples, D_LINE) - 1.511_244).abs() < 1e-9);
        assert_eq!((at(&samples, 400.0), at(&samples, 700.0)), (1.52, 1.51));
    }
}
