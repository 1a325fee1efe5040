//! Films and reconstruction filters.

use super::object::{Class, ObjectIndex};
use super::props::Props;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    ComponentFormat, Crop, Film, Filter, FilterNumber, NamedFilter, Origin, PixelFormat, Tonemap,
};
use crate::plugin::{Plugin, approximated, read};

type ReadTonemap = fn(&mut Props<'_>) -> Option<Tonemap>;

const AS_HDRFILM: &str = "as `hdrfilm`";

pub(super) const FILMS: &[Plugin<ReadTonemap>] = &[
    read("hdrfilm", high_range),
    read("ldrfilm", low_range),
    read("tiledhdrfilm", high_range),
    approximated("mfilm", high_range, AS_HDRFILM),
    approximated("specfilm", high_range, AS_HDRFILM),
];

/// A plugin for each of [`Filter::NAMED`].
pub(super) fn filters() -> Vec<Plugin<&'static NamedFilter>> {
    Filter::NAMED.iter().map(|row| read(row.name, row)).collect()
}

const PIXEL_FORMATS: &[(&str, PixelFormat)] = &[
    ("rgb", PixelFormat::Rgb),
    ("rgba", PixelFormat::Rgba),
    ("luminance", PixelFormat::Luminance),
    ("luminance_alpha", PixelFormat::LuminanceAlpha),
    ("luminancealpha", PixelFormat::LuminanceAlpha),
    ("xyz", PixelFormat::Xyz),
    ("xyza", PixelFormat::Xyza),
    ("spectrum", PixelFormat::Rgb),
    ("spectrumalpha", PixelFormat::Rgba),
];

const COMPONENT_FORMATS: &[(&str, ComponentFormat)] = &[
    ("float16", ComponentFormat::Float16),
    ("float32", ComponentFormat::Float32),
    ("uint32", ComponentFormat::Uint32),
];

/// Largest width and height.
const MAX_SIDE: u32 = 1 << 16;

impl<'a> Reader<'a> {
    /// The film of a sensor, or the default one.
    pub fn film(&mut self, index: Option<ObjectIndex>, sensor: Origin) -> Film {
        let mut film = Film {
            origin: sensor,
            width: 768,
            height: 576,
            crop: None,
            filter: Filter::Gaussian { stddev: 0.5 },
            pixel_format: PixelFormat::Rgb,
            component_format: ComponentFormat::Float16,
            file_format: "openexr".to_owned(),
            sample_border: false,
            imaging_ratio: 1.0,
            white_balance: None,
            tonemap: None,
            gbuffer: None,
        };
        let Some(index) = index else { return film };
        let tonemap = self.plugin(FILMS, index, "hdrfilm is used");
        let mut props = self.props(index);
        let p = &mut props;
        film.origin = p.origin();
        film.width = p.count("width", film.width, 1..=MAX_SIDE);
        film.height = p.count("height", film.height, 1..=MAX_SIDE);
        film.crop = crop(p, film.width, film.height);
        film.pixel_format = pixel_format(p);
        film.component_format = p.choice("component_format", ComponentFormat::Float16, COMPONENT_FORMATS);
        let own_format = if p.object.plugin == "ldrfilm" { "png" } else { "openexr" };
        film.file_format =
            p.optional_string("file_format").map_or(own_format, |(text, _)| text).to_ascii_lowercase();
        film.sample_border = p.boolean("sample_border", false) | p.boolean("high_quality_edges", false);
        p.ignore(&["banner", "attach_log", "compensate", "channel_names", "filename", "size_multiplier"]);
        if let Some(read) = tonemap {
            film.tonemap = read(p);
        }
        if let Some(nested) = p.only_child(Class::Rfilter)
            && let Some(filter) = self.filter(nested.index)
        {
            film.filter = filter;
        }
        for entry in &props.object.entries {
            if let Some(name) = entry.name.as_deref().filter(|n| n.contains('[')) {
                let text = format!("the film's {name} is not written");
                props.problems.push(Diagnostic::new(
                    crate::diagnostic::Severity::Note,
                    text,
                    Some(entry.name_span),
                ));
            }
        }
        props.ignore_matching(|name| name.contains('['));
        self.finish(props);
        film
    }

    fn filter(&mut self, index: ObjectIndex) -> Option<Filter> {
        let row = self.plugin(&filters(), index, "gaussian is used")?;
        let mut props = self.props(index);
        let filter = filter(row, &mut props);
        self.finish(props);
        Some(filter)
    }
}

fn filter(row: &NamedFilter, props: &mut Props<'_>) -> Filter {
    let mut filter = row.default;
    if let Filter::Mitchell { b, c } = &mut filter {
        // Capital letters in the manual, small ones in upgraded 0.x files.
        (*b, *c) = (props.float("b", *b), props.float("c", *c));
    }
    for parameter in row.parameters {
        match (parameter.number)(&mut filter) {
            Some(FilterNumber::Positive(value)) => *value = props.positive(parameter.name, *value),
            Some(FilterNumber::Any(value)) => *value = props.float(parameter.name, *value),
            Some(FilterNumber::Count(value)) => *value = props.count(parameter.name, *value, 1..=64),
            None => {}
        }
    }
    filter
}

fn crop(props: &mut Props<'_>, width: u32, height: u32) -> Option<Crop> {
    let names = ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];
    let any = names.iter().any(|name| props.has(name));
    let x = props.count("crop_offset_x", 0, 0..=MAX_SIDE);
    let y = props.count("crop_offset_y", 0, 0..=MAX_SIDE);
    let crop = Crop {
        x,
        y,
        width: props.count("crop_width", width.saturating_sub(x), 1..=MAX_SIDE),
        height: props.count("crop_height", height.saturating_sub(y), 1..=MAX_SIDE),
    };
    if crop.x + crop.width > width || crop.y + crop.height > height || crop.width == 0 || crop.height == 0 {
        let name = names.into_iter().find(|name| props.has(name)).unwrap_or("crop_width");
        let text = format!(
            "the crop ({}×{} at {}, {}) does not lie within the film ({width}×{height})",
            crop.width, crop.height, crop.x, crop.y
        );
        props.complain(name, text);
        return None;
    }
    any.then_some(crop)
}

fn pixel_format(props: &mut Props<'_>) -> PixelFormat {
    if let Some((text, span)) = props.optional_string("pixel_format").filter(|(text, _)| text.contains(',')) {
        let text =
            format!("`{text}` is read as rgb: layers of `multichannel` have the channels of what they show");
        props.problems.push(Diagnostic::warning(text, Some(span)));
        return PixelFormat::Rgb;
    }
    props.choice("pixel_format", PixelFormat::Rgb, PIXEL_FORMATS)
}

fn high_range(_: &mut Props<'_>) -> Option<Tonemap> {
    None
}

fn low_range(props: &mut Props<'_>) -> Option<Tonemap> {
    let gamma = props.float("gamma", -1.0);
    let exposure = props.float("exposure", 0.0);
    let reinhard = props.choice("tonemap_method", false, &[("gamma", false), ("reinhard", true)]);
    if reinhard {
        props.ignore_with_warning(&["tonemap_method"], "the picture is exposed and gamma-corrected only");
    }
    props.ignore(&["key", "burn"]);
    Some(Tonemap { exposure, gamma: (gamma > 0.0).then_some(gamma) })
}
