//! Films and reconstruction filters.

use super::Writer;
use super::element::Element;
use crate::ir::{ComponentFormat, Film, Filter, FilterNumber, FilterParameter, PixelFormat};

impl Writer<'_, '_> {
    pub fn film(&mut self, f: &Film) -> Element {
        let mut element = Element::plugin("film", "hdrfilm")
            .integer("width", i64::from(f.width))
            .integer("height", i64::from(f.height));
        if let Some(crop) = f.crop {
            for (name, value) in [
                ("crop_offset_x", crop.x),
                ("crop_offset_y", crop.y),
                ("crop_width", crop.width),
                ("crop_height", crop.height),
            ] {
                element = element.integer(name, i64::from(value));
            }
        }
        let pixels = match f.pixel_format {
            PixelFormat::Rgb => "rgb",
            PixelFormat::Rgba => "rgba",
            PixelFormat::Luminance => "luminance",
            PixelFormat::LuminanceAlpha => "luminance_alpha",
            PixelFormat::Xyz => "xyz",
            PixelFormat::Xyza => "xyza",
        };
        // Mitsuba has no others in these files, and says so.
        let float = matches!(f.file_format.as_str(), "rgbe" | "pfm");
        let components = match f.component_format {
            _ if float => "float32",
            ComponentFormat::Float16 => "float16",
            ComponentFormat::Float32 => "float32",
            ComponentFormat::Uint32 => "uint32",
        };
        element = element.string("pixel_format", pixels).string("component_format", components);
        match f.file_format.as_str() {
            "openexr" => {}
            "rgbe" | "pfm" => element = element.string("file_format", &f.file_format),
            other => {
                self.out.lose(f.origin, format!("pictures as `{other}`"), "openexr");
            }
        }
        if let Some(tonemap) = f.tonemap
            && (tonemap.exposure != 0.0 || tonemap.gamma.is_some())
        {
            self.out.lose(f.origin, "exposure and gamma of the film", "linear values");
        }
        if f.imaging_ratio != 1.0 {
            let what = format!("the film's imaging ratio {}", f.imaging_ratio);
            self.out.lose(f.origin, what, "lights brighter by the ratio of the sensor that renders");
        }
        if let Some(kelvin) = f.white_balance {
            let what = format!("the film's white balance of {kelvin} K");
            self.out.lose(f.origin, what, "colours as they are");
        }
        element = element.boolean_unless("sample_border", f.sample_border, false);
        element.child(self.filter(f))
    }

    fn filter(&mut self, f: &Film) -> Element {
        let mut filter = self.own_filter(f);
        let Some(row) = filter.row() else {
            self.out.lose(f.origin, "a filter that Mitsuba does not have", "its gaussian");
            return Element::plugin("rfilter", "gaussian");
        };
        let mut default = row.default;
        let mut element = Element::plugin("rfilter", row.name);
        for FilterParameter { name, number } in row.parameters {
            element = match (number(&mut filter), number(&mut default)) {
                (Some(FilterNumber::Count(value)), _) => element.integer(name, i64::from(*value)),
                (Some(value), Some(default)) if value == default => element,
                (Some(FilterNumber::Positive(value) | FilterNumber::Any(value)), _) => {
                    element.float(name, *value)
                }
                (None, _) => element,
            };
        }
        element
    }

    /// Mitsuba's filter that is nearest to one of pbrt's; others as they are.
    fn own_filter(&mut self, f: &Film) -> Filter {
        match f.filter {
            Filter::TruncatedGaussian { sigma, radius } => {
                if radius.iter().any(|r| (r / sigma - 4.0).abs() > 1e-9) {
                    self.lose_radius(f, "a gaussian filter", radius, "the cut at four standard deviations");
                }
                Filter::Gaussian { stddev: sigma }
            }
            Filter::ScaledMitchell { b, c, radius } => {
                if radius != [2.0; 2] {
                    self.lose_radius(f, "a mitchell filter", radius, "radius 2");
                }
                Filter::Mitchell { b, c }
            }
            Filter::WideBox { radius } => {
                if radius != [0.5; 2] {
                    self.lose_radius(f, "a box filter", radius, "radius 0.5, the only one Mitsuba 3 has");
                }
                Filter::Box { radius: 0.5 }
            }
            Filter::WideTent { radius } => {
                if radius[0] != radius[1] {
                    self.lose_radius(f, "a triangle filter", radius, "the first of them");
                }
                Filter::Tent { radius: radius[0] }
            }
            Filter::Box { radius } if radius != 0.5 => {
                self.lose_radius(f, "a box filter", [radius; 2], "radius 0.5, the only one Mitsuba 3 has");
                Filter::Box { radius: 0.5 }
            }
            Filter::WindowedSinc { tau, radius } => {
                let lobes = tau.round().clamp(1.0, 64.0);
                if radius.iter().any(|r| *r != tau) || lobes != tau {
                    self.lose_radius(f, "a sinc filter", radius, "lanczos with as many lobes as tau");
                }
                Filter::Lanczos { lobes: lobes as u32 }
            }
            own => own,
        }
    }

    fn lose_radius(&mut self, f: &Film, what: &str, [x, y]: [f64; 2], instead: &str) {
        self.out.lose(f.origin, format!("{what} of radius {x} × {y}"), instead);
    }
}
