//! Where the sun stands at a time, by the PSA algorithm (Blanco-Muriel et al., "Computing the solar vector", Solar
//! Energy 70, 2001), good to half a minute of arc from 1999 to 2015.

use crate::ir::{Day, Place};

/// Angle from the zenith, and azimuth from north by east, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Horizontal {
    pub zenith: f64,
    pub azimuth: f64,
}

impl Horizontal {
    /// In the local space of a light: −X is north and −Y east.
    pub fn direction(self) -> [f64; 3] {
        let ((sin, cos), (east, north)) = (self.zenith.sin_cos(), self.azimuth.sin_cos());
        [-sin * north, -sin * east, cos]
    }
}

/// Days from 1 January 2000, noon, to the midnight that begins `day`.
fn days_since_2000(day: Day) -> f64 {
    // Years that begin in March end with the leap day.
    let (year, month) = (i64::from(day.year), i64::from(day.month.clamp(1, 12)));
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    // Months from March on have 31, 30, 31, 30, 31, 31, 30, 31, 30, 31, 31 days.
    let before = 365 * year + leap_days + (153 * month + 2) / 5 + i64::from(day.day) - 1;
    // 730 425 is the count for 1 January 2000.
    (before - 730_425) as f64 - 0.5
}

/// The number of days from `start` to `end`, at least 1.
pub(super) fn days_between(start: Day, end: Day) -> f64 {
    (days_since_2000(end) - days_since_2000(start)).max(1.0)
}

/// Where the sun stands `hour` hours after the local midnight that begins `day`.
pub(super) fn sun(place: Place, day: Day, hour: f64) -> Horizontal {
    let universal = hour - place.timezone;
    let days = days_since_2000(day) + universal / 24.0;

    let node = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * days;
    let anomaly = 6.240_060_0 + 0.017_201_969_9 * days;
    let longitude = mean_longitude + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
        - 0.000_113_4
        - 0.000_020_3 * node.sin();
    let obliquity = 0.409_092_8 - 6.214_0e-9 * days + 0.000_039_6 * node.cos();

    let right_ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    let declination = (obliquity.sin() * longitude.sin()).asin();

    let greenwich = 6.697_424_324_2 + 0.065_709_828_3 * days + universal;
    let hour_angle = (greenwich * 15.0 + place.longitude).to_radians() - right_ascension;
    let (sin, cos) = place.latitude.to_radians().sin_cos();
    let height = cos * hour_angle.cos() * declination.cos() + declination.sin() * sin;
    let zenith = height.clamp(-1.0, 1.0).acos();
    let azimuth = (-hour_angle.sin()).atan2(declination.tan() * cos - sin * hour_angle.cos());
    // Seen from the surface, not from the centre of the Earth: its radius over the distance of the sun.
    let parallax = 6371.01 / 149_597_890.0 * zenith.sin();
    Horizontal { zenith: zenith + parallax, azimuth: azimuth.rem_euclid(std::f64::consts::TAU) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn day(year: u32, month: u32, day: u32) -> Day {
        Day { year, month, day }
    }

    #[test]
    fn days_follow_the_calendar() {
        assert_eq!(days_since_2000(day(2000, 1, 1)), -0.5);
        assert_eq!(days_since_2000(day(2000, 3, 1)), 59.5);
        assert_eq!(days_since_2000(day(2010, 7, 10)), 3842.5);
        assert_eq!(days_between(day(2025, 1, 1), day(2026, 1, 1)), 365.0);
        assert_eq!(days_between(day(2024, 2, 1), day(2024, 2, 30)), 29.0);
        assert_eq!(days_since_2000(day(2024, 2, 30)), days_since_2000(day(2024, 3, 1)));
        assert_eq!(days_between(day(2025, 5, 5), day(2025, 5, 5)), 1.0);
    }

    /// Noon of an equinox on the equator at Greenwich: the sun is in the zenith but for the equation of time (7.4
    /// minutes, 1.9°) and the declination of that hour; six hours later it sets in the west. At Tokyo in summer the
    /// height at noon is 90° − latitude + declination, from the south.
    #[test]
    fn the_sun_stands_where_almanacs_say() {
        let zero = Place { latitude: 0.0, longitude: 0.0, timezone: 0.0 };
        let noon = sun(zero, day(2010, 3, 20), 12.0).zenith.to_degrees();
        assert!((1.7..2.0).contains(&noon), "{noon}");
        let evening = sun(zero, day(2010, 3, 20), 18.0);
        assert!((evening.zenith.to_degrees() - 88.1).abs() < 0.2, "{evening:?}");
        assert!((evening.azimuth.to_degrees() - 270.0).abs() < 0.2, "{evening:?}");
        let tokyo = Place { latitude: 35.6894, longitude: 139.6917, timezone: 9.0 };
        // Culmination at 11:46 on 10 July (equation of time −5.4 minutes, 4.69° east of the zone's meridian);
        // declination 22.2°.
        let noon = sun(tokyo, day(2010, 7, 10), 11.0 + 46.6 / 60.0);
        assert!((noon.zenith.to_degrees() - (35.6894 - 22.24)).abs() < 0.1, "{noon:?}");
        assert!((noon.azimuth.to_degrees() - 180.0).abs() < 0.7, "{noon:?}");
        let morning = sun(tokyo, day(2010, 7, 10), 8.0);
        assert!((80.0..100.0).contains(&morning.azimuth.to_degrees()), "{morning:?}");
    }
}
