//! `convert --check-with`: does the renderer whose language it is show the same picture as we do of the source?

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use caustica_formats::image;
use caustica_formats::spectrum::luminance;

use super::args::{ConvertArgs, Renderer};
use super::check::{PASSES, SIDE, mean_error, picture, small};
use crate::cli::failure::Failure;
use crate::cli::{FAILED, report};

/// Largest relative difference of the means beyond noise.
const LARGEST_BIAS: f64 = 0.01;
/// By chance, a mean is off by more than this many standard errors once in 15 000 times.
const SIGMAS: f64 = 4.0;

/// Of Mitsuba's pictures.
const SEEDS: usize = 4;

/// Renders a copy of a Mitsuba scene with its film shrunk, with four seeds: arguments are the scene, the longer side,
/// the samples a pixel, and the file for the four pictures (linear RGB, float32).
const SCRIPT: &str = r#"
import os, sys, tempfile
import xml.etree.ElementTree as tree
try:
    import mitsuba as mi
    import numpy as np
except ImportError:
    sys.exit(77)
scene, side, spp, out = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
try:
    mi.set_variant('llvm_ad_rgb')
    mi.Float([1, 2]) + 1
except Exception:
    mi.set_variant('scalar_rgb')
mi.set_log_level(mi.LogLevel.Error)
document = tree.parse(scene)
for film in document.iter('film'):
    sizes = {e.get('name'): e for e in film.findall('integer')}
    longest = max(int(sizes[n].get('value')) for n in ('width', 'height'))
    for name, e in sizes.items():
        if name.startswith('crop'):
            film.remove(e)
    if longest > side:
        for name in ('width', 'height'):
            sizes[name].set('value', str(max(1, int(sizes[name].get('value')) * side // longest)))
handle, copy = tempfile.mkstemp(suffix='.xml', prefix='.check-', dir=os.path.dirname(os.path.abspath(scene)))
os.close(handle)
try:
    document.write(copy)
    scene = mi.load_file(copy)
    image = np.stack([np.array(mi.render(scene, spp=spp, seed=seed))[..., :3] for seed in range(4)])
finally:
    os.remove(copy)
np.ascontiguousarray(image, dtype='<f4').tofile(out)
print(mi.__version__)
"#;

/// Compares our picture of the source with the other renderer's of the result. The exit status is 0 or 1; 0 with a
/// message where the renderer is not installed.
///
/// # Errors
/// When the source cannot be opened, or the other renderer refuses the result.
pub fn run(args: &ConvertArgs, renderer: Renderer) -> Result<u8, Failure> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let theirs = match renderer {
        Renderer::Mitsuba => mitsuba(&args.output, &folder.path().join("pixels"))?,
        Renderer::Pbrt => pbrt(&args.output, &folder.path().join("pixels.exr"))?,
    };
    let Some((name, theirs)) = theirs else { return Ok(0) };
    let options = crate::session::Options {
        defines: args.define.clone(),
        allow_paths: args.allow_path.clone(),
        spectrum_rule: args.spectral_to_rgb.rule(),
        ..small(args.lenient, 1)
    };
    let ours = picture(&args.input, &options)?;
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.fold((0, 0.0), |(n, sum), v| (n + 1, sum + v));
        sum / f64::from(count.max(1))
    };
    let before = mean(&mut (0..ours.len()).map(|i| luminance(ours.beauty(i, PASSES))));
    // Their seeds tell how far their mean is off, rare bright paths included.
    let means: Vec<f64> = theirs
        .iter()
        .map(|picture| mean(&mut picture.iter().map(|rgb| luminance(rgb.map(f64::from)))))
        .collect();
    let count = means.len() as f64;
    let after = means.iter().sum::<f64>() / count;
    let spread: f64 = means.iter().map(|m| (m - after).powi(2)).sum();
    let theirs_off = (spread / (count * (count - 1.0).max(1.0))).sqrt();
    let bias = if after == before { 0.0 } else { after / before - 1.0 };
    let noise = mean_error(&ours).hypot(theirs_off) / before.max(f64::MIN_POSITIVE);
    let good = bias.abs() <= LARGEST_BIAS.max(SIGMAS * noise);
    report::data(&format!(
        "check with {name}: its mean of the result is {after:.5}, ours of the source {before:.5}: {:+.2} % (noise {:.2} %): {}",
        100.0 * bias,
        100.0 * noise,
        if good { "equal" } else { "DIFFERENT" },
    ))?;
    Ok(if good { 0 } else { FAILED })
}

/// The renderer's name, and its pictures with different seeds.
type Rendered = Option<(String, Vec<Vec<[f32; 3]>>)>;

/// Says what would install the renderer.
fn skipped(renderer: &str, command: &str) -> Result<Rendered, Failure> {
    report::data(&format!("check with {renderer}: skipped, it is not installed; {command}"))?;
    Ok(None)
}

fn mitsuba(scene: &Path, out: &Path) -> Result<Rendered, Failure> {
    let arguments =
        [scene.display().to_string(), SIDE.to_string(), PASSES.to_string(), out.display().to_string()];
    let run = Command::new("python3").arg("-c").arg(SCRIPT).args(arguments).stdin(Stdio::null()).output();
    let advice = "`python3 -m pip install mitsuba` installs it";
    let Ok(run) = run else { return skipped("mitsuba", advice) };
    if run.status.code() == Some(77) {
        return skipped("mitsuba", advice);
    }
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if !run.status.success() {
        return Err(Failure::Work(format!("mitsuba refuses {}:\n{}", scene.display(), said(&run.stderr))));
    }
    let bytes = std::fs::read(out).map_err(|e| e.to_string())?;
    let floats: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
    let version = said(&run.stdout);
    let pixels: &[[f32; 3]] = floats.as_chunks().0;
    let pictures = pixels.chunks(pixels.len().div_ceil(SEEDS).max(1)).map(<[_]>::to_vec).collect();
    Ok(Some((format!("Mitsuba {}", version.lines().last().unwrap_or_default()), pictures)))
}

fn pbrt(scene: &Path, out: &Path) -> Result<Rendered, Failure> {
    let arguments: [PathBuf; 6] = [
        "--quiet".into(),
        "--spp".into(),
        PASSES.to_string().into(),
        "--outfile".into(),
        out.into(),
        scene.into(),
    ];
    let Ok(run) = Command::new("pbrt").args(arguments).stdin(Stdio::null()).output() else {
        return skipped("pbrt", "build it from https://github.com/mmp/pbrt-v4 and put `pbrt` on the PATH");
    };
    if !run.status.success() {
        let said = String::from_utf8_lossy(&run.stderr).trim().to_owned();
        return Err(Failure::Work(format!("pbrt refuses {}:\n{said}", scene.display())));
    }
    let bytes = std::fs::read(out).map_err(|e| e.to_string())?;
    let picture = image::read(&bytes).map_err(|e| e.to_string())?;
    let places = picture.rgb().unwrap_or([0; 3]);
    let pixels = picture.data.chunks_exact(picture.channels.len().max(1));
    let pixels = pixels.map(|pixel| places.map(|place| pixel[place])).collect();
    Ok(Some(("pbrt".to_owned(), vec![pixels])))
}
