//! Mitsuba XML, dialects 0.4 to 3.x.
