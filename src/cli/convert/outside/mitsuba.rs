//! Mitsuba 3, as a module of `python3`.

use std::path::Path;
use std::process::{Command, Stdio};

use super::installed::{Rendered, SEEDS, skipped};
use crate::cli::convert::check::{PASSES, SIDE};
use crate::cli::failure::Failure;

/// Renders a copy of a Mitsuba scene with its film shrunk, with several seeds: arguments are the scene, the longer side,
/// the samples a pixel, the file for the pictures (linear RGB, float32), and the number of seeds.
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
    if longest > side:
        for name, e in sizes.items():
            if name.startswith('crop'):
                film.remove(e)
        for name in ('width', 'height'):
            sizes[name].set('value', str(max(1, int(sizes[name].get('value')) * side // longest)))
handle, copy = tempfile.mkstemp(suffix='.xml', prefix='.check-', dir=os.path.dirname(os.path.abspath(scene)))
os.close(handle)
try:
    document.write(copy)
    scene = mi.load_file(copy, parallel=False)
    image = np.stack([np.array(mi.render(scene, spp=spp, seed=seed))[..., :3] for seed in range(int(sys.argv[5]))])
finally:
    os.remove(copy)
np.ascontiguousarray(image, dtype='<f4').tofile(out)
print(mi.__version__)
"#;

/// Pictures of a scene of Mitsuba's, one a seed.
///
/// # Errors
/// When Mitsuba refuses the scene.
pub fn render(scene: &Path, out: &Path) -> Result<Rendered, Failure> {
    let [side, passes, seeds] = [SIDE.to_string(), PASSES.to_string(), SEEDS.to_string()];
    let arguments = [scene.display().to_string(), side, passes, out.display().to_string(), seeds];
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
    let pictures = pixels.chunks(pixels.len().div_ceil(SEEDS as usize).max(1)).map(<[_]>::to_vec).collect();
    Ok(Some((format!("Mitsuba {}", version.lines().last().unwrap_or_default()), pictures)))
}
