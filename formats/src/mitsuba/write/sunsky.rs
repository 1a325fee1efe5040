//! Sun and sky.

use super::Writer;
use super::element::{Element, numbers};
use crate::ir::{ColorSlot, Day, EnvironmentMapping, Origin, Place, SunModel, SunPosition, SunSky};
use crate::sky::{Daylight, Picture, sun_direction};
use crate::spectrum::luminance;
use crate::write::WriteError;

impl Writer<'_, '_> {
    pub fn sunsky(
        &mut self,
        light: &SunSky,
        name: Option<&str>,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let plugin = |kind: &str| Element::plugin("emitter", kind).id(name);
        if light.stretch != 1.0 || light.extend {
            let what = "a sky that goes on below the horizon";
            self.out.lose(origin, what, "a picture of it with the same light, the sun blurred by 0.2°");
            let name = self.out.daylight(light, EnvironmentMapping::LatLong, origin)?;
            return Ok(plugin("envmap")
                .string("filename", &name)
                .float_unless("scale", self.light, 1.0)
                .transform("to_world", &light.to_world.after(&Picture::TO_LOCAL)));
        }
        let element = match light.sun {
            SunPosition::Direction(d) => plugin("sunsky").triple("vector", "sun_direction", d),
            SunPosition::Moment { place, day, hour } => {
                let element = date(on_earth(plugin("sunsky"), place), ["year", "month", "day"], day);
                element.float("hour", hour)
            }
            SunPosition::Days { place, start, end, hours, .. } => {
                let element = on_earth(plugin("timed_sunsky"), place);
                let element = date(element, ["start_year", "start_month", "start_day"], start);
                date(element, ["end_year", "end_month", "end_day"], end)
                    .float("window_start_time", hours[0])
                    .float("window_end_time", hours[1])
            }
        };
        let albedo = self.color("albedo", &light.albedo, ColorSlot::Reflectance, origin);
        let sun_scale = self.sun_scale(light, origin);
        Ok(element
            .float("turbidity", light.turbidity)
            .child(albedo)
            .float_unless("sky_scale", light.sky_scale * self.light, 1.0)
            .float_unless("sun_scale", sun_scale * self.light, 1.0)
            .float_unless("sun_aperture", light.sun_aperture, SunSky::APERTURE)
            .boolean_unless("complex_sun", light.sun_model == SunModel::LimbDarkened, false)
            .transform("to_world", &light.to_world))
    }

    /// The factor that gives Mitsuba 3's sun the luminance of the light's.
    fn sun_scale(&mut self, light: &SunSky, origin: Origin) -> f64 {
        if light.sun_model != SunModel::Preetham || light.sun_scale == 0.0 {
            return light.sun_scale;
        }
        let irradiance = |light: &SunSky| {
            let direction = sun_direction(light)?;
            Daylight::new(light, direction, [0.0; 3]).sun().map(|sun| sun.irradiance())
        };
        let own = irradiance(light).unwrap_or_default();
        let other = irradiance(&SunSky { sun_model: SunModel::Even, ..light.clone() }).unwrap_or_default();
        let (wanted, there) = (luminance(own), luminance(other));
        let factor = if there > 0.0 { wanted / there } else { 0.0 };
        let what = format!("the sun of Mitsuba 0.6, of irradiance {}", numbers(&own.map(short)));
        let instead =
            format!("Mitsuba 3's of the same luminance, {}", numbers(&other.map(|v| short(v * factor))));
        self.out.lose(origin, what, instead);
        light.sun_scale * factor
    }
}

/// Four significant digits.
fn short(v: f64) -> f64 {
    format!("{v:.3e}").parse().unwrap_or(v)
}

fn on_earth(element: Element, place: Place) -> Element {
    element
        .float("latitude", place.latitude)
        .float("longitude", place.longitude)
        .float("timezone", place.timezone)
}

fn date(element: Element, [year, month, day]: [&str; 3], date: Day) -> Element {
    element.integer(year, date.year.into()).integer(month, date.month.into()).integer(day, date.day.into())
}
