//! Sums of passes → files.

use std::path::{Path, PathBuf};

use caustica_formats::image::{ExrLayer, ExrOptions, encode_exr, encode_hdr, encode_pfm, encode_png};
use caustica_formats::ir;

use super::load::Loaded;
use crate::film::{LAYERS, Pixels};

/// Everything that turns pixels into bytes.
#[derive(Debug)]
pub struct Output {
    pub files: Vec<PathBuf>,
    /// Extra layers of the EXR, by name.
    pub layers: Vec<String>,
    pub half: bool,
    /// Stops, for PNG only.
    pub exposure: f64,
    /// `None` is the sRGB curve.
    pub gamma: Option<f64>,
    pub alpha: bool,
}

/// Layers that `--layers` knows.
pub const KNOWN_LAYERS: [&str; 6] = ["emission", "direct", "caustic", "indirect", "variance", "samples"];

impl Output {
    /// Fails now rather than after the render: an unknown extension or a folder that cannot be written.
    pub fn check(&self) -> Result<(), String> {
        for file in &self.files {
            match extension(file).as_str() {
                "exr" | "png" | "hdr" | "pfm" => {}
                other => {
                    return Err(format!(
                        "cannot write `{}`: extension `{other}` is none of exr, png, hdr, pfm",
                        file.display()
                    ));
                }
            }
            let folder = match file.parent() {
                Some(f) if !f.as_os_str().is_empty() => f,
                _ => Path::new("."),
            };
            tempfile::Builder::new()
                .prefix(".caustica-probe")
                .tempfile_in(folder)
                .map_err(|e| format!("cannot write `{}`: {e}", file.display()))?;
            if file.is_dir() {
                return Err(format!("cannot write `{}`: it is a folder", file.display()));
            }
        }
        Ok(())
    }

    /// Encodes and writes every file, each replaced in one step.
    pub fn write(
        &self,
        loaded: &Loaded,
        pixels: &Pixels,
        passes: u32,
        extra: &[(String, String)],
    ) -> Result<(), String> {
        let [_, _, width, height] = loaded.scene.film.crop.map(|v| v as usize);
        for file in &self.files {
            let bytes = match extension(file).as_str() {
                "exr" => self.exr(loaded, pixels, passes, width, height, extra)?,
                "png" => {
                    encode_png(width, height, &self.eight_bit(pixels, passes)).map_err(|e| e.to_string())?
                }
                "hdr" => encode_hdr(width, height, &beauty(pixels, passes)).map_err(|e| e.to_string())?,
                _ => encode_pfm(width, height, &beauty(pixels, passes)).map_err(|e| e.to_string())?,
            };
            caustica_formats::image::atomic_write(file, &bytes)
                .map_err(|e| format!("cannot write `{}`: {e}", file.display()))?;
        }
        Ok(())
    }

    fn exr(
        &self,
        loaded: &Loaded,
        pixels: &Pixels,
        passes: u32,
        width: usize,
        height: usize,
        extra: &[(String, String)],
    ) -> Result<Vec<u8>, String> {
        let mut main = Vec::new();
        for (i, [r, g, b]) in rgb(pixels, passes).enumerate() {
            main.extend([r as f32, g as f32, b as f32]);
            if self.alpha {
                main.push(pixels.alpha(i, passes) as f32);
            }
        }
        let main_channels: &[&str] = if self.alpha { &["R", "G", "B", "A"] } else { &["R", "G", "B"] };
        let mut extras: Vec<(&str, &[&str], Vec<f32>)> = Vec::new();
        for name in &self.layers {
            let n = pixels.len();
            if let Some((layer, known)) = LAYERS.iter().find(|(_, known)| known == name) {
                let data = (0..n).flat_map(|i| pixels.layer(i, *layer, passes)).map(|v| v as f32).collect();
                extras.push((known, &["R", "G", "B"], data));
            } else if name == "variance" {
                extras.push((
                    "variance",
                    &["Y"],
                    (0..n).map(|i| pixels.variance(i, passes) as f32).collect(),
                ));
            } else {
                extras.push(("samples", &["Y"], vec![passes as f32; n]));
            }
        }
        let mut layers = vec![ExrLayer { name: "", channels: main_channels, data: &main }];
        layers.extend(extras.iter().map(|(name, channels, data)| ExrLayer { name, channels, data }));
        let metadata = metadata(loaded, passes, extra);
        encode_exr(width, height, &layers, &metadata, ExrOptions { half: self.half })
            .map_err(|e| e.to_string())
    }

    fn eight_bit(&self, pixels: &Pixels, passes: u32) -> Vec<u8> {
        let gain = self.exposure.exp2();
        let curve = |v: f64| {
            let v = (v * gain).clamp(0.0, 1.0);
            let encoded = match self.gamma {
                Some(g) => v.powf(1.0 / g),
                None => caustica_formats::spectrum::linear_to_srgb(v),
            };
            (encoded * 255.0).round() as u8
        };
        rgb(pixels, passes).flat_map(|c| c.map(curve)).collect()
    }
}

fn rgb(pixels: &Pixels, passes: u32) -> impl Iterator<Item = [f64; 3]> {
    (0..pixels.len()).map(move |i| pixels.beauty(i, passes))
}

fn beauty(pixels: &Pixels, passes: u32) -> Vec<f32> {
    rgb(pixels, passes).flat_map(|c| c.map(|v| v as f32)).collect()
}

fn extension(path: &Path) -> String {
    path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase())
}

/// What the picture is and how to make it again. No times: the same render gives the same bytes.
fn metadata(loaded: &Loaded, passes: u32, extra: &[(String, String)]) -> Vec<(String, String)> {
    let settings =
        loaded.settings.values().filter(|(name, _)| *name != "passes").map(|(n, v)| format!("{n}={v}"));
    let mut rows = vec![
        ("generatedBy".to_owned(), format!("caustica {}", env!("CARGO_PKG_VERSION"))),
        ("scene".to_owned(), super::load::stem(&loaded.path)),
        ("sceneHash".to_owned(), loaded.hash.clone()),
        ("passes".to_owned(), passes.to_string()),
        ("settings".to_owned(), settings.collect::<Vec<_>>().join(" ")),
    ];
    rows.extend(extra.iter().cloned());
    rows
}

/// Whether the scene's film keeps alpha.
pub fn wants_alpha(film: &ir::Film) -> bool {
    matches!(
        film.pixel_format,
        ir::PixelFormat::Rgba | ir::PixelFormat::LuminanceAlpha | ir::PixelFormat::Xyza
    )
}
