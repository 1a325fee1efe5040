//! Sun and sky: `sunsky` and `timed_sunsky` of Mitsuba 3, `sky`, `sun` and `sunsky` of Mitsuba 0.6.

use super::object::{Class, Value};
use super::props::Props;
use super::reader::Reader;
use super::turned::turned;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{Color, ColorSlot, Day, Emitter, EmitterKind, Place, SunModel, SunPosition, SunSky};
use crate::sky::{Daylight, FROM_OLD, sun_direction};

pub(super) fn sunsky<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    if reader.dialect == Dialect::Old {
        return old_sunsky(reader, props);
    }
    let position = position(props, &TIME_AND_PLACE);
    new(reader, props, position)
}

pub(super) fn timed_sunsky<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let position = days(reader, props);
    new(reader, props, position)
}

/// Mitsuba 3's.
fn new<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>, sun: SunPosition) -> Option<EmitterKind> {
    let mut light = SunSky::new(sun);
    light.turbidity = within(props, "turbidity", light.turbidity, 1.0, 10.0);
    light.albedo = reader.color(props, "albedo", ColorSlot::Reflectance, 0.3);
    light.sky_scale = not_negative(props, "sky_scale", 1.0);
    light.sun_scale = not_negative(props, "sun_scale", 1.0);
    light.sun_aperture = props.positive("sun_aperture", SunSky::APERTURE);
    if light.sun_aperture >= 180.0 {
        props.complain("sun_aperture", "`sun_aperture` must be below 180 degrees");
        light.sun_aperture = SunSky::APERTURE;
    }
    if props.boolean("complex_sun", false) {
        light.sun_model = SunModel::LimbDarkened;
    }
    light.to_world = turned(props);
    checked(props, light).map(EmitterKind::SunSky)
}

/// 0.6's `sky`.
pub(super) fn old_sky<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let scale = not_negative(props, "scale", 1.0);
    old(reader, props, [scale, 0.0])
}

/// 0.6's `sun`.
pub(super) fn old_sun<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let scale = not_negative(props, "scale", 1.0);
    old(reader, props, [0.0, scale])
}

fn old_sunsky<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let scale = not_negative(props, "scale", 1.0);
    let scales = [not_negative(props, "sky_scale", scale), not_negative(props, "sun_scale", scale)];
    old(reader, props, scales)
}

/// What 0.6 divides the sky's RGB by, under Mitsuba 3's.
const OLD_SKY: f64 = 106.750_259_399_414_06 / 106.856_980;

/// 0.6's lights, with the scales of sky and sun.
fn old<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>, [sky, sun]: [f64; 2]) -> Option<EmitterKind> {
    // It looks at fewer of them.
    let mut light = SunSky::new(position(props, &["latitude", "longitude", "timezone", "day"]));
    light.turbidity = within(props, "turbidity", light.turbidity, 1.0, 10.0);
    light.albedo = reader.color(props, "albedo", ColorSlot::Reflectance, 0.2);
    light.sky_scale = sky * OLD_SKY;
    light.sun_scale = sun;
    light.sun_model = SunModel::Preetham;
    light.stretch = within(props, "stretch", 1.0, 1.0, 2.0);
    light.extend = props.boolean("extend", false);
    // Of the picture that 0.6 makes of it.
    props.ignore(&["resolution"]);
    let radius = not_negative(props, "sun_radius_scale", 1.0);
    light.sun_aperture = SunSky::APERTURE * radius;
    if light.sun_aperture >= 180.0 {
        props.complain("sun_radius_scale", "`sun_radius_scale` makes the sun larger than the sky");
        return None;
    }
    light.to_world = turned(props).after(&FROM_OLD);
    let mut light = checked(props, light)?;
    if radius > 0.0 || sun == 0.0 {
        return Some(EmitterKind::SunSky(light));
    }
    light.sun_aperture = SunSky::APERTURE;
    let parallel = parallel(&light)?;
    if sky == 0.0 {
        return Some(parallel);
    }
    light.sun_scale = 0.0;
    reader.scene.emitters.push(Emitter { name: None, origin: props.origin(), kind: parallel, medium: None });
    Some(EmitterKind::SunSky(light))
}

/// The sun as parallel light of the same irradiance.
fn parallel(light: &SunSky) -> Option<EmitterKind> {
    let daylight = Daylight::new(light, sun_direction(light)?, [0.0; 3]);
    let sun = daylight.sun()?;
    let direction = light.to_world.vector(sun.direction).map(|x| -x);
    Some(EmitterKind::Directional { direction, irradiance: Color::Rgb(sun.irradiance()) })
}

/// The light, unless its sun has no direction; a warning where it stands below the horizon.
fn checked(props: &mut Props<'_>, light: SunSky) -> Option<Box<SunSky>> {
    let Some(direction) = sun_direction(&light) else {
        props.complain("sun_direction", "`sun_direction` is zero");
        return None;
    };
    if direction[2] < 0.0 && !matches!(light.sun, SunPosition::Days { .. }) {
        let text = "the sun is below the horizon: the light is black";
        let place = props.entry("sun_direction").map_or(props.origin().0, |entry| Some(entry.span));
        let help = "the models of the sky have no night; check date, time, place and what is up";
        props.problems.push(Diagnostic::warning(text, place).help(help));
    }
    Some(Box::new(light))
}

const TIME_AND_PLACE: [&str; 9] =
    ["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];

/// A direction or a moment; `exclusive` must not stand beside a direction.
fn position(props: &mut Props<'_>, exclusive: &[&str]) -> SunPosition {
    if let Some(other) = exclusive.iter().find(|other| props.has(other)) {
        props.exclusive("sun_direction", other);
    }
    let place = place(props);
    let day = day(props, ["year", "month", "day"], Day { year: 2010, month: 7, day: 10 });
    let hour =
        props.float("hour", 15.0) + props.float("minute", 0.0) / 60.0 + props.float("second", 0.0) / 3600.0;
    match props.triple("sun_direction") {
        Some(direction) => SunPosition::Direction(direction),
        None => SunPosition::Moment { place, day, hour },
    }
}

fn place(props: &mut Props<'_>) -> Place {
    Place {
        latitude: props.float("latitude", 35.6894),
        longitude: props.float("longitude", 139.6917),
        timezone: props.float("timezone", 9.0),
    }
}

fn day(props: &mut Props<'_>, [year, month, day]: [&'static str; 3], default: Day) -> Day {
    Day {
        year: props.count(year, default.year, 1..=9999),
        month: props.count(month, default.month, 1..=12),
        // Some count the days of a year in one month.
        day: props.count(day, default.day, 1..=366),
    }
}

/// The hours of many days, or the first one alone if the shutter opens for no time.
fn days(reader: &Reader<'_>, props: &mut Props<'_>) -> SunPosition {
    let place = place(props);
    let first = Day { year: 2025, month: 1, day: 1 };
    let start = day(props, ["start_year", "start_month", "start_day"], first);
    let end = day(props, ["end_year", "end_month", "end_day"], Day { year: start.year + 1, ..start });
    let first = within(props, "window_start_time", 7.0, 0.0, 24.0);
    let last = within(props, "window_end_time", 19.0, 0.0, 24.0);
    if first > last {
        props.complain("window_end_time", "`window_end_time` comes before `window_start_time`");
    }
    let open = props.float("shutter_open", 0.0);
    let close = props.float("shutter_close", 1.0);
    if open >= close {
        props.complain("shutter_close", "`shutter_close` must be after `shutter_open`");
        return SunPosition::Moment { place, day: start, hour: first };
    }
    let shutter = shutter(reader).map(|time| (time - open) / (close - open));
    if shutter[0] == shutter[1] {
        let text = "the shutter of the sensor opens for no time: the sun stands still";
        let help = "give the sensor the `shutter_open` and `shutter_close` of this emitter";
        props.problems.push(Diagnostic::warning(text, props.origin().0).help(help));
    }
    SunPosition::Days { place, start, end, hours: [first, last], shutter }
}

/// When the shutter of the first sensor opens and closes.
fn shutter(reader: &Reader<'_>) -> [f64; 2] {
    let sensor = reader.objects.iter().find(|object| object.class == Class::Sensor);
    ["shutter_open", "shutter_close"].map(|name| {
        let entry = sensor.and_then(|s| s.entries.iter().find(|e| e.name.as_deref() == Some(name)));
        match entry.map(|entry| &entry.value) {
            Some(Value::Float(v)) => *v,
            Some(Value::Integer(v)) => *v as f64,
            _ => 0.0,
        }
    })
}

fn within(props: &mut Props<'_>, name: &'static str, default: f64, least: f64, most: f64) -> f64 {
    let value = props.float(name, default);
    if (least..=most).contains(&value) {
        return value;
    }
    props.complain(name, format!("`{name}` must lie between {least} and {most}, not be {value}"));
    default
}

fn not_negative(props: &mut Props<'_>, name: &'static str, default: f64) -> f64 {
    within(props, name, default, 0.0, f64::MAX)
}
