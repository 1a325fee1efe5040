//! The path of the sun over hours of several days.

use super::place;
use crate::ir::{Day, Place, SunPosition};

/// The time that the shutter is open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Days {
    place: Place,
    start: Day,
    count: f64,
    hours: [f64; 2],
    shutter: [f64; 2],
}

impl Days {
    /// Of a position that is the mean over days.
    pub fn of(position: &SunPosition) -> Option<Self> {
        let SunPosition::Days { place, start, end, hours, shutter } = *position else { return None };
        Some(Self { place, start, count: place::days_between(start, end), hours, shutter })
    }

    /// Days that the shutter is open, rounded up.
    pub fn length(&self) -> usize {
        ((self.shutter[1] - self.shutter[0]).abs() * self.count).clamp(1.0, 36_525.0).ceil() as usize
    }

    /// Towards the sun when the share `t` of the time is over, in the local space of a light.
    pub fn at(&self, t: f64) -> [f64; 3] {
        // The last hour of the last day is not the first one of the next.
        let days = (self.shutter[0] + (self.shutter[1] - self.shutter[0]) * t) * (self.count - 1e-7);
        let whole = days.floor();
        let hour = self.hours[0] + (self.hours[1] - self.hours[0]) * (days - whole);
        place::sun(self.place, self.start, 24.0 * whole + hour).direction()
    }
}
