//! Sums of passes → files.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use caustica_formats::image::{ExrLayer, ExrOptions, encode_exr, encode_hdr, encode_pfm, encode_png};
use caustica_formats::ir;

use super::failure::Failure;
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
    pub fn check(&self) -> Result<(), Failure> {
        for file in &self.files {
            match extension(file).as_str() {
                "exr" | "png" | "hdr" | "pfm" => {}
                other => {
                    return Err(Failure::Usage(format!(
                        "cannot write `{}`: extension `{other}` is none of exr, png, hdr, pfm",
                        file.display()
                    )));
                }
            }
            check_place(file)?;
        }
        Ok(())
    }

    /// Encodes and writes every file, each replaced in one step. What cannot be written where it should
    /// is kept elsewhere, and the error says where.
    pub fn write(
        &self,
        loaded: &Loaded,
        pixels: &Pixels,
        passes: u32,
        extra: &[(String, String)],
    ) -> Result<(), String> {
        let [_, _, width, height] = loaded.view.film.crop.map(|v| v as usize);
        let mut problems = Vec::new();
        for file in &self.files {
            let bytes = match extension(file).as_str() {
                "exr" => self.exr(loaded, pixels, passes, width, height, extra)?,
                "png" => {
                    encode_png(width, height, &self.eight_bit(pixels, passes)).map_err(|e| e.to_string())?
                }
                "hdr" => encode_hdr(width, height, &beauty(pixels, passes)).map_err(|e| e.to_string())?,
                _ => encode_pfm(width, height, &beauty(pixels, passes)).map_err(|e| e.to_string())?,
            };
            if let Err(e) = caustica_formats::image::atomic_write(file, &bytes) {
                let kept = match keep_elsewhere(file, &bytes) {
                    Ok(place) => format!("the picture is in `{}` instead", place.display()),
                    Err(why) => format!("nor could it be kept elsewhere: {why}"),
                };
                problems.push(format!("cannot write `{}`: {e}; {kept}", file.display()));
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(problems.join("\n")) }
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
                    (0..n).map(|i| pixels.variance(i, passes).min(f64::from(f32::MAX)) as f32).collect(),
                ));
            } else {
                extras.push(("samples", &["Y"], vec![passes as f32 * pixels.samples_a_pass as f32; n]));
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

/// Fails when two outputs are one file, or one of them is a file that the scene was read from.
pub fn check_distinct(files: &[&Path], inputs: &BTreeSet<PathBuf>) -> Result<(), Failure> {
    let mut taken = BTreeSet::new();
    for file in files {
        let real = real(file);
        if inputs.contains(&real) {
            let shown = file.display();
            let text = format!("cannot write `{shown}`: the scene was read from it");
            return Err(Failure::Usage(text));
        }
        if !taken.insert(real) {
            let text = format!("`{}` is named for two outputs", file.display());
            return Err(Failure::Usage(text));
        }
    }
    Ok(())
}

/// The file that a path leads to, whether it is there yet or not.
pub fn real(file: &Path) -> PathBuf {
    if let Ok(real) = std::fs::canonicalize(file) {
        return real;
    }
    let folder = match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    match (std::fs::canonicalize(folder), file.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => file.to_path_buf(),
    }
}

/// Fails when nothing can be written to `file`.
pub fn check_place(file: &Path) -> Result<(), String> {
    let fail = |why: &dyn std::fmt::Display| Err(format!("cannot write `{}`: {why}", file.display()));
    if file.as_os_str().to_string_lossy().ends_with(std::path::is_separator) {
        return fail(&"it names a folder");
    }
    match std::fs::metadata(file) {
        Ok(old) if old.is_dir() => return fail(&"it is a folder"),
        Ok(old) if !old.is_file() => return fail(&"it is not a regular file"),
        _ => {}
    }
    let folder = match file.parent() {
        Some(f) if !f.as_os_str().is_empty() => f,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return fail(&format!("there is no folder `{}`", folder.display()));
    }
    match tempfile::Builder::new().prefix(".caustica-probe").tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(e) => fail(&e),
    }
}

/// Writes a new file here or among the temporary files; its path.
fn keep_elsewhere(file: &Path, bytes: &[u8]) -> Result<PathBuf, String> {
    let part = |p: Option<&std::ffi::OsStr>| p.unwrap_or_default().to_string_lossy().into_owned();
    let (prefix, suffix) = (format!("{}-", part(file.file_stem())), format!(".{}", part(file.extension())));
    let mut problems = Vec::new();
    for folder in [PathBuf::from("."), std::env::temp_dir()] {
        let kept = tempfile::Builder::new().prefix(&prefix).suffix(&suffix).tempfile_in(&folder).and_then(
            |mut kept| {
                kept.write_all(bytes)?;
                kept.as_file().sync_all()?;
                Ok(kept.keep()?.1)
            },
        );
        match kept {
            Ok(path) => return Ok(path),
            Err(e) => problems.push(format!("`{}`: {e}", folder.display())),
        }
    }
    Err(problems.join(", "))
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
