//! Films and pixel filters.

use super::params::Params;
use super::reader::Reader;
use super::sensor::default_film;
use super::space::ColorSpace;
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{ComponentFormat, CoordinateSystem, Crop, Film, Filter};
use crate::plugin::{Plugin, approximated, read};

type ReadFilm = fn(&mut Params, &mut Film);

pub(super) const FILMS: &[Plugin<ReadFilm>] = &[
    read("rgb", |_, _| {}),
    read("gbuffer", gbuffer),
    approximated("spectral", |p, _| spectral(p), "as `rgb`"),
];

type ReadFilter = fn(&mut Params) -> Filter;

pub(super) const FILTERS: &[Plugin<ReadFilter>] = &[
    read("box", boxed),
    read("gaussian", |p| Filter::TruncatedGaussian {
        radius: radius(p, if p.policy.is_three() { 2.0 } else { 1.5 }),
        sigma: p.positive("sigma", 0.5),
    }),
    read("mitchell", |p| Filter::ScaledMitchell {
        radius: radius(p, 2.0),
        b: p.float("B", 1.0 / 3.0),
        c: p.float("C", 1.0 / 3.0),
    }),
    read("sinc", |p| Filter::WindowedSinc { radius: radius(p, 4.0), tau: p.positive("tau", 3.0) }),
    read("triangle", |p| match radius(p, 2.0) {
        [x, y] if x == y => Filter::Tent { radius: x },
        radius => Filter::WideTent { radius },
    }),
];

/// Extensions of the output file and what Mitsuba calls the formats.
const FORMATS: &[(&str, &str)] = &[("exr", "openexr"), ("png", "png"), ("pfm", "pfm"), ("hdr", "rgbe")];

/// Largest width and height.
const MAX_SIDE: u32 = 1 << 16;

/// Sensors pbrt knows beside `cie1931`.
const SENSORS: &[&str] = &[
    "canon_eos_100d",
    "canon_eos_1dx_mkii",
    "canon_eos_200d",
    "canon_eos_200d_mkii",
    "canon_eos_5d",
    "canon_eos_5d_mkii",
    "canon_eos_5d_mkiii",
    "canon_eos_5d_mkiv",
    "canon_eos_5ds",
    "canon_eos_m",
    "hasselblad_l1d_20c",
    "nikon_d810",
    "nikon_d850",
    "sony_ilce_6400",
    "sony_ilce_7m3",
    "sony_ilce_7rm3",
    "sony_ilce_9",
];

impl Reader<'_> {
    /// The film of a camera whose shutter is open for `exposure` seconds.
    pub fn film(&mut self, world: Span, exposure: f64) -> Film {
        let mut film = default_film();
        film.filter = self.filter(world);
        let common = self.common();
        let given = self.head.film.take();
        let mut p = given.unwrap_or_else(|| Params::new("film", "rgb", world, Vec::new(), common));
        film.origin = p.origin();
        if let Some(reader) = self.plugin(FILMS, &mut p, "the rgb film is used") {
            reader(&mut p, &mut film);
        }
        let p_ref = &mut p;
        film.width = side(p_ref, "xresolution", film.width);
        film.height = side(p_ref, "yresolution", film.height);
        film.crop = crop(p_ref, film.width, film.height);
        if let Some((name, span)) = p_ref.optional_string("filename") {
            let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
            match FORMATS.iter().find(|row| row.0 == extension) {
                Some((_, format)) => film.file_format = (*format).to_owned(),
                None => {
                    let text = format!("pictures are not written as `{name}`; OpenEXR is used");
                    p_ref.problems.push(Diagnostic::warning(text, Some(span)));
                }
            }
        }
        if !p_ref.boolean("savefp16", true) {
            film.component_format = ComponentFormat::Float32;
        }
        film.imaging_ratio = exposure * p_ref.positive("iso", 100.0) / 100.0;
        p_ref.ignore(&["diagonal"]);
        p_ref.ignore_with_warning("maxcomponentvalue", "samples are not clamped");
        film.white_balance = response(p_ref);
        if p_ref.space != ColorSpace::Srgb {
            let text = format!("the picture is written in linear Rec.709, not in {}", p_ref.space.name());
            p_ref.problems.push(Diagnostic::warning(text, Some(p_ref.span)));
        }
        self.done(p);
        film
    }

    fn filter(&mut self, world: Span) -> Filter {
        let common = self.common();
        let given = self.head.filter.take();
        let default = if self.policy.is_three() { "box" } else { "gaussian" };
        let mut p = given.unwrap_or_else(|| Params::new("filter", default, world, Vec::new(), common));
        let filter = match self.plugin(FILTERS, &mut p, "the gaussian filter is used") {
            Some(reader) => reader(&mut p),
            None => default_film().filter,
        };
        self.done(p);
        filter
    }
}

fn side(p: &mut Params, name: &'static str, default: u32) -> u32 {
    let side = p.count(name, default, 1);
    if side > MAX_SIDE {
        p.complain(name, format!("`{name}` may be at most {MAX_SIDE}"));
        return default;
    }
    side
}

fn gbuffer(p: &mut Params, film: &mut Film) {
    let systems = [("camera", CoordinateSystem::Camera), ("world", CoordinateSystem::World)];
    film.gbuffer = Some(CoordinateSystem::Camera);
    if let Some((name, span)) = p.optional_string("coordinatesystem") {
        match systems.iter().find(|(word, _)| *word == name) {
            Some((_, system)) => film.gbuffer = Some(*system),
            None => {
                let text = format!("there is no coordinate system `{name}`");
                let problem = Diagnostic::error(text, Some(span));
                p.problems.push(problem.help("a gbuffer film has `camera` or `world`"));
            }
        }
    }
}

fn spectral(p: &mut Params) {
    p.ignore(&["nbuckets", "lambdamin", "lambdamax"]);
    p.problems.push(Diagnostic::warning(
        "the spectral film is read as rgb: light is rendered in three channels",
        Some(p.span),
    ));
}

fn boxed(p: &mut Params) -> Filter {
    match radius(p, 0.5) {
        [x, y] if x == y => Filter::Box { radius: x },
        radius => Filter::WideBox { radius },
    }
}

fn radius(p: &mut Params, default: f64) -> [f64; 2] {
    [p.positive("xradius", default), p.positive("yradius", default)]
}

/// The response of the sensor to light is that of the standard observer. What it balances to white: a temperature
/// in kelvin.
fn response(p: &mut Params) -> Option<f64> {
    if let Some((name, _)) = p.optional_string("sensor") {
        if SENSORS.contains(&name.as_str()) {
            let text = format!("sensor `{name}` is approximated by the standard observer `cie1931`");
            p.warn("sensor", text);
        } else if name != "cie1931" {
            p.complain("sensor", format!("no sensor named `{name}`; the exact one is cie1931"));
        }
    }
    let kelvin = p.float("whitebalance", 0.0);
    if kelvin == 0.0 {
        return None;
    }
    // Outside of these the formula of daylight is no colour of light.
    if !(1500.0..=25000.0).contains(&kelvin) {
        p.complain(
            "whitebalance",
            format!("{kelvin} K is not a daylight temperature: use 1500 to 25000, or 0 for no balance"),
        );
        return None;
    }
    Some(kelvin)
}

/// `cropwindow` wins over `pixelbounds`.
fn crop(p: &mut Params, width: u32, height: u32) -> Option<Crop> {
    let bounds = p.integers::<4>("pixelbounds").map(|b| b.map(i64::from));
    let window = p.floats::<4>("cropwindow").map(|w| {
        let pixels = |fraction: f64, side: u32| (fraction.clamp(0.0, 1.0) * f64::from(side)).ceil() as i64;
        [pixels(w[0], width), pixels(w[1], width), pixels(w[2], height), pixels(w[3], height)]
    });
    let name = if window.is_some() { "cropwindow" } else { "pixelbounds" };
    let [x0, x1, y0, y1] = window.or(bounds)?;
    let inside = |v: i64, side: u32| v.clamp(0, i64::from(side)) as u32;
    let (x0, x1) = (inside(x0, width), inside(x1, width));
    let (y0, y1) = (inside(y0, height), inside(y1, height));
    if x0 >= x1 || y0 >= y1 {
        p.complain(name, format!("`{name}` leaves no pixels of the {width}×{height} film"));
        return None;
    }
    let crop = Crop { x: x0, y: y0, width: x1 - x0, height: y1 - y0 };
    (crop.width < width || crop.height < height).then_some(crop)
}
