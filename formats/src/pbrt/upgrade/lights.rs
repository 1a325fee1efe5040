//! Lights of pbrt-v3: colours that v4 has no place for.

use super::super::directive::{Directive, Param, ParamType, Values};
use super::{Old, kind, made};
use crate::ir::{Color, ColorSlot, SpectrumRule};
use crate::spectrum::{luminance, planck, to_linear_rgb};

/// Wien's displacement constant in nm·K, as pbrt-v3 has it.
const WIEN: f64 = 2.897_772_1e6;

impl Old {
    /// A blackbody had a scale beside its temperature. Of lights, v3 takes the spectrum whose peak is 1 and v4 the one
    /// whose luminance is 1.
    pub(super) fn blackbodies(&mut self, d: &mut Directive) {
        let light = is_light(d);
        let (mut factor, mut place) = (1.0, d.span);
        for p in d.params.iter_mut().filter(|p| p.kind == ParamType::Blackbody) {
            if let Values::Floats(v) = &mut p.values
                && let [kelvin, scale] = v[..]
            {
                self.found(p.value_span, "a blackbody with a scale", "the temperature, and \"float scale\"");
                (factor, place) = (factor * scale, p.span);
                if light {
                    factor *= luminance_at_peak_one(kelvin);
                }
                v.truncate(1);
            }
        }
        if factor != 1.0 {
            multiply(d, factor, place);
        }
    }

    /// What is left of a light's colours once v4 can say them.
    pub(super) fn light(&mut self, d: &mut Directive) {
        if !is_light(d) {
            return;
        }
        self.coloured_scale(d);
        let kind = kind(d);
        let has_picture = d.params.iter().any(|p| p.name == "mapname");
        if d.name != "LightSource" {
            return;
        }
        if has_picture && matches!(kind.as_str(), "projection" | "infinite" | "exinfinite") {
            self.coloured_picture(d);
        }
        if has_picture && kind == "projection" && d.params.iter().all(|p| p.name != "fov") {
            // v4's default is 90.
            d.params.push(made(ParamType::Float, "fov", Values::Floats(vec![45.0]), d.span));
        }
        let delta = d.params.iter().rfind(|p| p.name == "conedeltaangle").map(|p| &p.values);
        if kind == "spot" && !matches!(delta, Some(Values::Floats(v)) if v[..] == [0.0]) {
            self.spots.push(d.span);
        }
    }

    /// `scale` was a colour: the light's own colour takes it, where that is one of three numbers.
    fn coloured_scale(&mut self, d: &mut Directive) {
        let Some(at) = d.params.iter().rposition(|p| p.name == "scale" && p.kind == ParamType::Rgb) else {
            return;
        };
        let Values::Floats(scale) = &d.params[at].values else { return };
        let Ok([r, g, b]) = <[f64; 3]>::try_from(scale.clone()) else { return };
        let span = d.params[at].span;
        d.params.remove(at);
        let name = color_name(d);
        let color = d.params.iter_mut().rfind(|p| p.name == name);
        if r == g && g == b {
            return multiply(d, r, span);
        }
        match color {
            Some(Param { kind: ParamType::Rgb, values: Values::Floats(v), .. }) if v.len() == 3 => {
                v.iter_mut().zip([r, g, b]).for_each(|(v, s)| *v *= s);
            }
            None => d.params.push(made(ParamType::Rgb, name, Values::Floats(vec![r, g, b]), span)),
            Some(_) => {
                let text = format!("the colour ({r}, {g}, {b}) of `scale` is left out: its mean is kept");
                self.lost(span, text);
                multiply(d, (r + g + b) / 3.0, span);
            }
        }
    }

    /// v3 multiplies the picture of a light by a colour; v4 has a number for it.
    fn coloured_picture(&mut self, d: &mut Directive) {
        let name = color_name(d);
        let Some(at) = d.params.iter().rposition(|p| p.name == name) else { return };
        let color = d.params[at].clone();
        let what =
            format!("the colour of `{name}` is left out: the picture shines by itself, and its mean is kept");
        match (&color.kind, &color.values) {
            (ParamType::Rgb, Values::Floats(v)) if v.len() == 3 => {
                if v.iter().any(|c| *c != v[0]) {
                    self.lost(color.span, format!("{what} (it was {}, {}, {})", v[0], v[1], v[2]));
                }
                multiply(d, v.iter().sum::<f64>() / 3.0, color.span);
            }
            // Its luminance is in `scale` already.
            (ParamType::Blackbody, _) => self.lost(color.span, what),
            _ => {
                self.lost(
                    color.span,
                    format!("`{name}` is left out: the picture shines by itself, unscaled"),
                );
            }
        }
        d.params.retain(|p| p.name != name);
    }

    /// The shutter of v3 decides how far things move while it is open, never how bright the picture is.
    pub fn shutters(&self, directives: &mut [Directive]) {
        if !self.found.is_empty() {
            for camera in directives.iter_mut().filter(|d| d.name == "Camera") {
                camera.params.retain(|p| !matches!(p.name.as_str(), "shutteropen" | "shutterclose"));
            }
        }
    }
}

fn is_light(d: &Directive) -> bool {
    matches!(d.name.as_str(), "LightSource" | "AreaLightSource")
}

/// The parameter that holds a light's colour.
fn color_name(d: &Directive) -> &'static str {
    match kind(d).as_str() {
        "point" | "spot" | "goniometric" | "projection" => "I",
        _ => "L",
    }
}

/// Multiplies the number `scale`, which is added where it is not given.
fn multiply(d: &mut Directive, factor: f64, place: crate::diagnostic::Span) {
    let given = d.params.iter_mut().rfind(|p| p.name == "scale");
    match given.map(|p| &mut p.values) {
        Some(Values::Floats(v)) => v.iter_mut().for_each(|v| *v *= factor),
        _ => d.params.push(made(ParamType::Float, "scale", Values::Floats(vec![factor]), place)),
    }
}

/// Y of a blackbody that is scaled so that its highest value is 1.
fn luminance_at_peak_one(kelvin: f64) -> f64 {
    let peak = planck(WIEN / kelvin, kelvin);
    let samples = (360..=830).map(|nm| [f64::from(nm), planck(f64::from(nm), kelvin) / peak]).collect();
    let rgb = to_linear_rgb(&Color::Samples(samples), ColorSlot::Emission, SpectrumRule::Pbrt);
    rgb.map_or(1.0, luminance)
}
