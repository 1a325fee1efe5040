//! What is converted shows the same picture: every shape with every use of a texture, in both directions.

mod accepted;
mod daylight;
mod extremes;
mod faults;
mod sides;
mod table;
mod version3;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica::session::{Options, Session};
use caustica_formats::files::Memory;
use caustica_formats::{Content, Loss, ReadOptions, read_scene, write_scene};

use crate::support::{Picture, Stage, render};

pub const PASSES: u32 = 64;

/// A scene and the files beside it.
pub struct Source {
    pub name: &'static str,
    pub files: BTreeMap<PathBuf, Vec<u8>>,
}

/// The converted scene, with what is beside it.
pub struct Converted {
    pub text: String,
    pub losses: Vec<Loss>,
    pub files: Memory,
    pub name: &'static str,
}

impl Source {
    pub fn new(name: &'static str, text: &str, beside: &[(&str, Vec<u8>)]) -> Self {
        let beside = beside.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.clone()));
        let scene = (PathBuf::from(name), text.as_bytes().to_vec());
        Self { name, files: beside.chain([scene]).collect() }
    }

    /// To the other language.
    pub fn convert(&self) -> Converted {
        self.convert_to(if self.name.ends_with("xml") { "made.pbrt" } else { "made.xml" })
    }

    pub fn convert_to(&self, name: &'static str) -> Converted {
        let files = Memory(self.files.clone());
        let read = read_scene(&files, Path::new(self.name), &ReadOptions::default())
            .unwrap_or_else(|e| panic!("{e}"));
        let written = write_scene(&read, &files, Path::new(name)).unwrap();
        let mut beside = self.files.clone();
        for asset in &written.assets {
            let bytes = match &asset.content {
                Content::Bytes(bytes) => bytes.clone(),
                Content::Copy(path) => self.files[path].clone(),
            };
            beside.insert(asset.path.clone(), bytes);
        }
        beside.insert(PathBuf::from(name), written.text.clone().into_bytes());
        Converted { text: written.text, losses: written.losses, files: Memory(beside), name }
    }

    pub fn picture(&self, seed: u64) -> Picture {
        picture(&Memory(self.files.clone()), self.name, seed)
    }
}

impl Converted {
    /// What our reader says of it.
    pub fn open(&self) -> Result<Session, String> {
        let options = Options { spectrum_rule: None, ..Options::default() };
        Session::open_in(&self.files, Path::new(self.name), &options).map_err(|e| e.to_string())
    }

    pub fn picture(&self, seed: u64) -> Picture {
        picture(&self.files, self.name, seed)
    }
}

fn picture(files: &Memory, name: &str, seed: u64) -> Picture {
    let options = Options { spectrum_rule: None, ..Options::default() };
    let session = Session::open_in(files, Path::new(name), &options).unwrap_or_else(|e| panic!("{e}"));
    let seed = seed.to_string();
    render(&Stage(session), &[("integrator", "path"), ("max_depth", "6"), ("seed", &seed)], PASSES)
}

/// How a picture differs from its source, in parts of the mean.
#[derive(Debug)]
pub struct Difference {
    pub noise: f64,
    pub rmse: f64,
    pub bias: f64,
}

impl Difference {
    /// The noise is the difference of two renders of the source with other seeds.
    pub fn of(source: &Source, made: &Converted) -> Self {
        let [first, second] = [1, 2].map(|seed| source.picture(seed).pixel_values());
        let found = made.picture(3).pixel_values();
        let mean = mean_of(&first);
        let bias = mean_of(&found) / (0.5 * (mean + mean_of(&second))) - 1.0;
        Self { noise: rmse(&first, &second) / mean, rmse: rmse(&first, &found) / mean, bias }
    }

    /// Two renders of a scene differ by √2 standard errors a pixel. Over 3000 values chance does not make
    /// that a quarter more. Pictures that are made have pixels: 0.3 % of the mean at edges is theirs.
    pub fn is_noise(&self) -> bool {
        self.is_noise_and(0.0)
    }

    /// The same with room for a known difference of so many parts of the mean.
    pub fn is_noise_and(&self, known: f64) -> bool {
        self.rmse <= (1.25 * self.noise.hypot(known)).max(0.003)
    }
}

pub fn mean_of(pixels: &[[f64; 3]]) -> f64 {
    pixels.as_flattened().iter().sum::<f64>() / pixels.as_flattened().len() as f64
}

fn rmse(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    (pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.as_flattened().len() as f64).sqrt()
}

/// A picture that no turn or mirror leaves alone: 4×3 pixels, colours from 0.05 to 0.95.
pub fn asymmetric(factor: f32) -> Vec<u8> {
    let texel = |x: usize, y: usize| {
        let (u, v) = (x as f32 / 3.0, y as f32 / 2.0);
        [0.05 + 0.9 * u, 0.05 + 0.9 * v * v, if x == 1 && y == 0 { 0.95 } else { 0.1 }].map(|c| c * factor)
    };
    crate::support::picture(4, texel, 3)
}
