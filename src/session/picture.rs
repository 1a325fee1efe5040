//! A picture in memory.

use std::ops::Range;

use super::Session;
use super::layers::Content;
use crate::film::Pixels;
use crate::render::Statistics;

/// What a render has made of the rendered part of the film: radiance in linear Rec.709, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    pub(super) session: &'a Session,
    pub(super) pixels: &'a Pixels,
    pub(super) passes: u32,
    pub(super) statistics: &'a Statistics,
}

impl Picture<'_> {
    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.session.size()
    }

    /// Camera samples of each pixel.
    fn samples(&self) -> u64 {
        u64::from(self.passes) * u64::from(self.pixels.samples_a_pass)
    }

    /// Red, green and blue at column `x` from the left and row `y` from the top.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn pixel(&self, x: usize, y: usize) -> [f64; 3] {
        let [width, height] = self.size();
        assert!(x < width && y < height, "there is no pixel {x}, {y} in a picture of {width} × {height}");
        self.pixels.beauty(y * width + x, self.passes)
    }

    /// Red, green and blue of every pixel, row by row.
    pub fn rgb(&self) -> impl Iterator<Item = [f64; 3]> {
        (0..self.pixels.len()).map(|i| self.pixels.beauty(i, self.passes))
    }

    /// The numbers of a layer for some of the pixels, counted row by row.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn channels(&self, content: Content, range: Range<usize>) -> Vec<f32> {
        let (pixels, passes) = (self.pixels, self.passes);
        let alpha = |i: usize| pixels.alpha(i, passes) as f32;
        match content {
            Content::Part(layer) => {
                range.flat_map(|i| pixels.layer(i, layer, passes)).map(|v| v as f32).collect()
            }
            Content::Picture => range
                .flat_map(|i| {
                    let [r, g, b] = pixels.beauty(i, passes).map(|v| v as f32);
                    [r, g, b, alpha(i)]
                })
                .collect(),
            Content::Variance => {
                range.map(|i| pixels.variance(i, passes).min(f64::from(f32::MAX)) as f32).collect()
            }
            Content::Samples => vec![passes as f32 * pixels.samples_a_pass as f32; range.len()],
            Content::Surface(aov) => {
                let list = &self.session.view.aovs;
                range.flat_map(|i| pixels.aov(i, aov, list, passes)).map(|v| v as f32).collect()
            }
        }
    }

    /// What the picture is and how to make it again: names and values. No times: the same render gives the
    /// same bytes.
    pub fn metadata(&self) -> Vec<(String, String)> {
        let settings = self.session.settings.values().filter(|(name, _)| *name != "passes");
        let settings: Vec<String> = settings.map(|(name, value)| format!("{name}={value}")).collect();
        let mut rows = vec![
            ("generatedBy".to_owned(), format!("caustica {}", env!("CARGO_PKG_VERSION"))),
            ("scene".to_owned(), self.session.name()),
            ("sceneHash".to_owned(), self.session.hash.clone()),
            ("passes".to_owned(), self.passes.to_string()),
            ("samplesPerPixel".to_owned(), self.samples().to_string()),
            ("settings".to_owned(), settings.join(" ")),
        ];
        let s = self.statistics;
        let radii = [("firstRadius", s.first_radius), ("firstCausticRadius", s.first_caustic_radius)];
        let radii = radii.into_iter().filter(|(_, radius)| *radius > 0.0);
        rows.extend(radii.map(|(name, radius)| (name.to_owned(), radius.to_string())));
        rows
    }
}
