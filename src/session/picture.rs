//! A picture in memory.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::layers::{Content, Layers};
use super::{Session, passes};
use crate::film::{Aov, Pixels};

/// What a picture is and how it is written, beside its sums. Checkpoints hold it, so that parts of a render are merged
/// without its scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureInfo {
    /// The program.
    pub program: String,
    /// The scene file's name without folder and extension.
    pub scene: String,
    /// Of the scene's files.
    pub hash: String,
    /// All settings but the number of passes.
    pub settings: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Of an EXR, beside the picture.
    pub layers: Layers,
    /// What the passes have summed up of the surfaces.
    pub aovs: Vec<Aov>,
    /// The scene's film keeps coverage.
    pub alpha: bool,
    /// The scene's exposure for a PNG, in stops.
    pub exposure: f64,
    /// Exponent of the scene's curve for a PNG; `None` is the sRGB curve.
    pub gamma: Option<f64>,
}

impl PictureInfo {
    pub(super) fn of(session: &Session) -> Self {
        let settings = session.settings.values().filter(|(name, _)| *name != "passes");
        let settings: Vec<String> = settings.map(|(name, value)| format!("{name}={value}")).collect();
        let tonemap = session.film.tonemap;
        let [_, _, width, height] = session.view.film.crop;
        Self {
            program: format!("caustica {}", env!("CARGO_PKG_VERSION")),
            scene: session.name(),
            hash: session.hash.clone(),
            settings: settings.join(" "),
            size: [width, height],
            layers: session.layers.clone(),
            aovs: session.view.aovs.clone(),
            alpha: session.wants_alpha(),
            exposure: tonemap.map_or(0.0, |t| t.exposure),
            gamma: tonemap.and_then(|t| t.gamma),
        }
    }
}

/// What a render has made of the rendered part of the film: radiance in linear Rec.709, rows from the top.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    pub(super) info: PictureInfo,
    pub(super) pixels: &'a Pixels,
    /// The first one and how many.
    pub(super) passes: [u32; 2],
    /// Of those that were to be in the picture; each the first one and the one after the last.
    pub(super) missing: Vec<[u32; 2]>,
}

impl Picture<'_> {
    /// What it is and how it is written.
    pub fn info(&self) -> &PictureInfo {
        &self.info
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.info.size.map(|n| n as usize)
    }

    /// Camera samples of a pixel, on average.
    pub fn samples(&self) -> u64 {
        let pixels = self.pixels.len();
        let sum: u128 = self.samples_of(0..pixels).map(u128::from).sum();
        let count = pixels.max(1) as u128;
        ((sum + count / 2) / count) as u64
    }

    /// Camera samples of each of some pixels.
    fn samples_of(&self, range: Range<usize>) -> impl Iterator<Item = u64> {
        let even = self.pixels.common.even_passes;
        let there = |pass: &u32| !self.missing.iter().any(|[from, to]| (*from..*to).contains(pass));
        let first = (self.passes[0]..even).filter(there).count() as u32;
        let passes = self.passes();
        range.map(move |pixel| self.pixels.samples(pixel, passes, first.min(passes)))
    }

    /// Passes in the picture.
    pub fn passes(&self) -> u32 {
        self.passes[1]
    }

    /// Red, green and blue at column `x` from the left and row `y` from the top.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn pixel(&self, x: usize, y: usize) -> [f64; 3] {
        let [width, height] = self.size();
        assert!(x < width && y < height, "there is no pixel {x}, {y} in a picture of {width} × {height}");
        self.pixels.beauty(y * width + x, self.passes())
    }

    /// Red, green and blue of every pixel, row by row.
    pub fn rgb(&self) -> impl Iterator<Item = [f64; 3]> {
        self.pixels.beauties(self.passes())
    }

    /// The numbers of a layer for some of the pixels, counted row by row.
    ///
    /// # Panics
    /// Outside of the picture.
    pub fn channels(&self, content: Content, range: Range<usize>) -> Vec<f32> {
        let (pixels, passes) = (self.pixels, self.passes());
        match content {
            Content::Part(layer) => {
                pixels.layers_of(range, layer, passes).as_flattened().iter().map(|v| *v as f32).collect()
            }
            Content::Picture => {
                let colours = pixels.beauties_of(range.clone(), passes);
                let pixels = colours.into_iter().zip(pixels.alphas_of(range, passes));
                pixels.flat_map(|([r, g, b], [a])| [r, g, b, a].map(|v| v as f32)).collect()
            }
            Content::Variance => {
                range.map(|i| pixels.variance(i, passes).min(f64::from(f32::MAX)) as f32).collect()
            }
            Content::Samples => self.samples_of(range).map(|count| count as f32).collect(),
            Content::Surface(aov) => {
                let list = &self.info.aovs;
                range.flat_map(|i| pixels.aov(i, aov, list, passes)).map(|v| v as f32).collect()
            }
        }
    }

    /// What the picture is and how to make it again: names and values. No times: the same render gives the
    /// same bytes.
    pub fn metadata(&self) -> Vec<(String, String)> {
        let info = &self.info;
        let [first, count] = self.passes;
        let row = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let mut rows = vec![
            row("generatedBy", &info.program),
            row("scene", &info.scene),
            row("sceneHash", &info.hash),
            row("passes", &count.to_string()),
            row("samplesPerPixel", &self.samples().to_string()),
            row("settings", &info.settings),
        ];
        let [global, caustic] = self.pixels.common.first_radii;
        let radii = [("firstRadius", global), ("firstCausticRadius", caustic)];
        let radii = radii.into_iter().filter(|(_, radius)| *radius > 0.0);
        rows.extend(radii.map(|(name, radius)| row(name, &radius.to_string())));
        // Of all passes from the first on, nothing is to be said.
        if !self.missing.is_empty() {
            rows.push(row("missingPasses", &passes::listed(&self.missing)));
        } else if first > 0 {
            rows.push(row("passRange", &passes::listed(&[[first, first + count]])));
        }
        rows
    }
}
