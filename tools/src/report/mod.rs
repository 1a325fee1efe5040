//! The HTML page of comparisons.

use crate::compare::{Compared, Report};
use crate::pixels::Pixels;

/// Collects what the page shows.
#[derive(Debug, Default)]
pub struct Page {}

impl Page {
    pub fn add(&mut self, _: &Compared, _: &Pixels, _: &Pixels) {}
    pub fn render(&self, _: &Report) -> String {
        String::new()
    }
}
