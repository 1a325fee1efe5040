//! Builds scenes from text, renders them with error estimates, and compares the results.

use std::ops::Range;
use std::path::{Path, PathBuf};

use caustica::film::{LAYERS, Layer, Pixels, Rejected};
use caustica::render::{Budget, Checkpoint, Outcome, Progress, Sums};
use caustica::scene::Scene;
use caustica::session::{Options, Session};
use caustica::settings::Settings;
use caustica_formats::files::Memory;

/// Standard errors by which an unbiased estimate may be off: if errors are normal, one in 150 000 is further off.
/// Seeds are fixed, so a test that passes keeps passing until the code changes.
pub const SIGMAS: f64 = 4.5;

/// An opened scene; where only the scene itself is wanted, it stands for that.
#[derive(Debug)]
pub struct Stage(pub Session);

impl std::ops::Deref for Stage {
    type Target = Scene;
    fn deref(&self) -> &Scene {
        &self.0.scene
    }
}

/// Compiles `body` inside a scene of version 3.
pub fn scene(body: &str) -> Stage {
    scene_with(body, &[])
}

/// The same with further text files in memory.
pub fn scene_with(body: &str, files: &[(&str, &str)]) -> Stage {
    scene_with_bytes(body, files.iter().map(|(path, text)| (*path, text.as_bytes().to_vec())).collect())
}

/// The same with binary files.
pub fn scene_with_bytes(body: &str, files: Vec<(&str, Vec<u8>)>) -> Stage {
    scene_of("scene.xml", &format!("<scene version='3.0.0'>{body}</scene>"), files)
}

/// Compiles `body` as the content of a Mitsuba scene of the given version.
pub fn scene_of_version(version: &str, body: &str) -> Stage {
    scene_of("scene.xml", &format!("<scene version='{version}'>{body}</scene>"), Vec::new())
}

/// Compiles a pbrt scene from what follows `WorldBegin`.
pub fn pbrt_scene(world: &str, files: Vec<(&str, Vec<u8>)>) -> Stage {
    pbrt_scene_seen("LookAt 0 0 9 0 0 0 0 1 0\nCamera \"perspective\"", world, files)
}

/// The same with what precedes `WorldBegin`.
pub fn pbrt_scene_seen(view: &str, world: &str, files: Vec<(&str, Vec<u8>)>) -> Stage {
    scene_of("scene.pbrt", &format!("{view}\nWorldBegin\n{world}\n"), files)
}

/// How tests open scenes: spectra mean what the file's own renderer makes of them.
pub fn plain() -> Options {
    Options { spectrum_rule: None, ..Options::default() }
}

/// Opens a file in the language of its name.
fn scene_of(file: &str, text: &str, files: Vec<(&str, Vec<u8>)>) -> Stage {
    let all = files.into_iter().chain([(file, text.as_bytes().to_vec())]);
    let memory = Memory(all.map(|(path, bytes)| (PathBuf::from(path), bytes)).collect());
    Stage(Session::open_in(&memory, Path::new(file), &plain()).unwrap_or_else(|e| panic!("{e}")))
}

/// A PFM file of the given texels, top row first.
pub fn picture(width: usize, texel: impl Fn(usize, usize) -> [f32; 3], height: usize) -> Vec<u8> {
    let data = (0..width * height).flat_map(|i| texel(i % width, i / width)).collect::<Vec<f32>>();
    caustica_formats::image::encode_pfm(width, height, &data).unwrap()
}

/// A box-filtered film.
pub fn film(width: u32, height: u32) -> String {
    format!(
        "<film type='hdrfilm'><integer name='width' value='{width}'/><integer name='height' value='{height}'/>
         <rfilter type='box'/></film>"
    )
}

/// A pinhole camera with a square film.
pub fn camera(origin: &str, target: &str, fov: f64, size: u32) -> String {
    format!(
        "<sensor type='perspective'><float name='fov' value='{fov}'/>
         <transform name='to_world'><lookat origin='{origin}' target='{target}' up='0,1,0.01'/></transform>
         {}</sensor>",
        film(size, size)
    )
}

pub fn diffuse(reflectance: &str) -> String {
    format!("<bsdf type='diffuse'><rgb name='reflectance' value='{reflectance}'/></bsdf>")
}

pub fn area(radiance: &str) -> String {
    format!("<emitter type='area'><rgb name='radiance' value='{radiance}'/></emitter>")
}

/// A sphere with the given XML inside its element.
pub fn sphere(center: &str, radius: f64, inside: &str) -> String {
    format!(
        "<shape type='sphere'><point name='center' value='{center}'/><float name='radius' value='{radius}'/>{inside}</shape>"
    )
}

/// A rectangle of side 2·`half`, facing +z before `transform`, with the given XML inside its element.
pub fn rectangle(half: f64, transform: &str, inside: &str) -> String {
    format!(
        "<shape type='rectangle'><transform name='to_world'><scale value='{half}'/>{transform}</transform>{inside}</shape>"
    )
}

/// A room of side 2 with a square window of side 2·`half` in its ceiling, which faces +z. Its walls are diffuse.
pub fn room_with_window(half: f64, reflectance: &str) -> String {
    let wall = |to_world: &str| rectangle(1.0, to_world, &diffuse(reflectance));
    // A ceiling of four strips around the window.
    let (middle, width) = ((1.0 + half) / 2.0, (1.0 - half) / 2.0);
    let strips = [
        ([0.0, middle], [1.0, width]),
        ([0.0, -middle], [1.0, width]),
        ([middle, 0.0], [width, half]),
        ([-middle, 0.0], [width, half]),
    ]
    .map(|([x, y], [w, h])| wall(&format!("<scale value='{w},{h},1'/><translate value='{x},{y},1'/>")));
    let sides =
        ["x='1' angle='90'", "x='1' angle='-90'", "y='1' angle='90'", "y='1' angle='-90'", "x='1' angle='0'"]
            .map(|turn| wall(&format!("<translate value='0,0,-1'/><rotate {turn}/>")));
    [strips.concat(), sides.concat()].concat()
}

/// Rotations that turn the front of a [`rectangle`] towards −y, +y, +x and −x.
pub const DOWN: &str = "<rotate x='1' angle='90'/>";
pub const UP: &str = "<rotate x='1' angle='-90'/>";
pub const RIGHT: &str = "<rotate y='1' angle='90'/>";
pub const LEFT: &str = "<rotate y='1' angle='-90'/>";

/// Five walls of the cube [-1, 1]³, open towards +z: red and green sides, the rest of reflectance `white`.
pub fn walls(white: &str) -> String {
    let white = diffuse(white);
    [
        rectangle(1.0, &format!("{UP}<translate y='-1'/>"), &white),
        rectangle(1.0, &format!("{DOWN}<translate y='1'/>"), &white),
        rectangle(1.0, "<translate z='-1'/>", &white),
        rectangle(1.0, &format!("{RIGHT}<translate x='-1'/>"), &diffuse("0.6,0.1,0.1")),
        rectangle(1.0, &format!("{LEFT}<translate x='1'/>"), &diffuse("0.1,0.5,0.1")),
    ]
    .concat()
}

/// A square lamp under the ceiling.
pub fn lamp(half: f64, radiance: &str) -> String {
    rectangle(half, &format!("{DOWN}<translate y='0.99'/>"), &area(radiance))
}

/// The camera that looks into [`walls`].
pub fn box_camera(size: u32) -> String {
    camera("0,0,3.6", "0,0,0", 42.0, size)
}

/// A mean with its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub sigma: f64,
}

impl Estimate {
    pub fn exact(mean: f64) -> Self {
        Self { mean, sigma: 0.0 }
    }
}

/// A finished render.
#[derive(Debug)]
pub struct Picture {
    pub pixels: Pixels,
    pub passes: u32,
    /// Means over the film of every layer and channel, pass by pass.
    means: Vec<[[f64; 3]; LAYERS.len()]>,
}

impl Picture {
    /// Mean over the film of the chosen layers. The error is measured from batches of passes (16 to 32
    /// of them): pixels share photons within a pass, and camera samples are stratified over 2ᵐ
    /// consecutive passes, so neither pixels nor passes are independent, but batches nearly are. (They
    /// are stratified among each other, which makes the true error smaller than this.)
    pub fn estimate(&self, layers: &[Layer], channel: usize) -> Estimate {
        let values: Vec<f64> =
            self.means.iter().map(|m| layers.iter().map(|&l| m[l as usize][channel]).sum()).collect();
        estimate(&values)
    }

    /// The difference to `other`, a render of the same passes. Both have the same film positions and, with the
    /// same photon settings, the same photons, so noise that they share cancels.
    pub fn minus(&self, other: &Self, layers: &[Layer], channel: usize) -> Estimate {
        assert_eq!(self.passes, other.passes);
        let part =
            |m: &[[f64; 3]; LAYERS.len()]| -> f64 { layers.iter().map(|&l| m[l as usize][channel]).sum() };
        let values: Vec<f64> = self.means.iter().zip(&other.means).map(|(a, b)| part(a) - part(b)).collect();
        estimate(&values)
    }

    pub fn beauty(&self, channel: usize) -> Estimate {
        self.estimate(&LAYERS.map(|(l, _)| l), channel)
    }

    pub fn pixel(&self, i: usize) -> [f64; 3] {
        self.pixels.beauty(i, self.passes)
    }

    pub fn pixel_values(&self) -> Vec<[f64; 3]> {
        (0..self.pixels.len()).map(|i| self.pixel(i)).collect()
    }
}

/// Mean of the values of passes, with the error measured from batches.
pub fn estimate(values: &[f64]) -> Estimate {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let batch = 1 << (values.len() / 16).max(1).ilog2();
    let batches: Vec<f64> =
        values.chunks_exact(batch).map(|b| b.iter().sum::<f64>() / batch as f64).collect();
    let n = batches.len() as f64;
    let square = batches.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Estimate { mean, sigma: (square / n).sqrt() }
}

/// The settings of a scene with some of them changed.
pub fn settings(scene: &Stage, changes: &[(&str, &str)]) -> Settings {
    let mut settings = scene.0.settings.clone();
    for (name, value) in changes {
        settings.set(name, value).unwrap();
    }
    settings
}

/// Renders passes 0..`passes` with some settings changed.
pub fn outcome(
    scene: &Stage,
    changes: &[(&str, &str)],
    passes: u32,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Outcome {
    let settings = settings(scene, changes);
    let sums = Sums::none(scene.0.view.film.pixel_count());
    caustica::render::render(scene.0.task_with(&settings), Budget::passes(passes), sums, progress)
}

/// The same, pass by pass.
pub fn render(scene: &Stage, changes: &[(&str, &str)], passes: u32) -> Picture {
    let count = scene.0.view.film.pixel_count();
    let mut means = Vec::new();
    let mut last = [[0.0; 3]; LAYERS.len()];
    let outcome = outcome(scene, changes, passes, &mut |progress| {
        let mut sums = [[0.0; 3]; LAYERS.len()];
        for pixel in (0..count).map(|pixel| progress.pixels.numbers(pixel)) {
            for (l, layer) in sums.iter_mut().enumerate() {
                (0..3).for_each(|c| layer[c] += pixel[3 * l + c]);
            }
        }
        means
            .push(std::array::from_fn(|l| std::array::from_fn(|c| (sums[l][c] - last[l][c]) / count as f64)));
        last = sums;
    });
    assert_eq!(outcome.statistics.rejected, Rejected::default(), "something was not finite");
    Picture { pixels: outcome.pixels, passes, means }
}

/// The part of a render with these passes. If `stopped` is not 0 it is ended after as many, saved, and goes on from there.
pub fn part(session: &Session, range: Range<u32>, stopped: u32) -> Vec<u8> {
    let outcome = if stopped > 0 {
        let begun = session.render_range(range.clone(), Budget::passes(stopped), &mut |_| {});
        let saved = Checkpoint::decode(&session.part(&begun).unwrap()).unwrap();
        assert_eq!((saved.head.first, saved.head.passes), (range.start, stopped));
        let sums = Sums { pixels: saved.pixels, first: range.start, passes: stopped };
        session.resume_range(sums, range.end, Budget::default(), &mut |_| {})
    } else {
        session.render_range(range.clone(), Budget::default(), &mut |_| {})
    };
    assert_eq!(outcome.statistics.passes, range.len() as u32);
    session.part(&outcome).unwrap()
}

/// Asserts |a − b| ≤ `relative`·b, that b is not 0, and that the bound is at least [`SIGMAS`] standard errors, so that
/// the test neither fails by chance nor passes because of noise or darkness. What `relative` allows beyond the noise is
/// room for bias; the caller says where it comes from.
#[track_caller]
pub fn assert_agree(what: &str, a: Estimate, b: Estimate, relative: f64) {
    let sigma = a.sigma.hypot(b.sigma);
    let bound = relative * b.mean.abs();
    println!(
        "{what}: {:.6} against {:.6}: {:+.3} % (noise {:.3} %, bound {:.3} %)",
        a.mean,
        b.mean,
        100.0 * (a.mean / b.mean - 1.0),
        100.0 * sigma / b.mean.abs(),
        100.0 * relative
    );
    assert!(b.mean != 0.0, "{what}: nothing is seen");
    assert!(SIGMAS * sigma <= bound, "{what}: noise {sigma:e} is too large for the bound {bound:e}");
    assert!((a.mean - b.mean).abs() <= bound, "{what}: {a:?} against {b:?}, bound {bound:e}");
}

/// [`assert_agree`] for two renders of the same passes; only the noise of their difference counts.
#[track_caller]
pub fn assert_same(what: &str, a: &Picture, b: &Picture, layers: &[Layer], channel: usize, relative: f64) {
    let (difference, whole) = (a.minus(b, layers, channel), b.estimate(layers, channel).mean);
    let shifted = Estimate { mean: whole + difference.mean, sigma: difference.sigma };
    assert_agree(what, shifted, Estimate::exact(whole), relative);
}

pub const ALL: &[Layer] = &[Layer::Emission, Layer::Direct, Layer::Caustic, Layer::Indirect, Layer::Medium];
