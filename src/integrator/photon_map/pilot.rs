//! What error an estimator leaves and what work it is, measured before the render on patches of the picture that
//! are spread over it. Work is counted, never timed: a resumed render measures the same.

use std::sync::Arc;

use rayon::prelude::*;

use super::super::{CameraSample, Integrator, PassStats, Scratch};
use super::maps::{Map, PassMap};
use super::{Maps, PhotonMapper, work};
use crate::film::Layer;
use crate::math::Vec2;
use crate::sampling::{Sampler, mix};

/// Passes, each with photons of its own.
const PASSES: usize = 3;

/// Camera samples of a pixel, which are the same in all passes: only the photons differ.
const SAMPLES: usize = 4;

/// Width of a patch in pixels, which is also that of the blur.
const SIDE: u32 = 4;

/// Patches along each side of the picture.
const ALONG: u32 = 8;

/// How much the error that is left after a blur counts beside that of single pixels. Noise that differs from pixel to
/// pixel hardly survives a blur, neither here nor in the eye; blotches do. With 2 an error of blotches counts
/// almost as three times that variance in fine noise, between what relMSE (1) and LDR-FLIP (about 6) make of it.
const BLURRED: f64 = 2.0;

/// Luminance below this share of the picture's mean counts as if it were this.
const DARK: f64 = 0.1;

/// Pixels of a patch, the first at this position.
type Patch = [u32; 2];

/// One of the things that a render spends its time on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    /// Relative variance that one unit leaves; n units leave an n-th of it.
    pub variance: f64,
    /// Of one unit, in camera rays.
    pub work: f64,
}

impl Part {
    /// Best share of this in a render, up to a common factor: variance/n + work·n is least there.
    pub fn share(&self) -> f64 {
        if self.work > 0.0 { (self.variance / self.work).sqrt() } else { 0.0 }
    }

    /// What it adds to the root of variance × work where all shares are best.
    pub fn root(&self) -> f64 {
        (self.variance * self.work).sqrt()
    }
}

/// What was measured: of a camera sample of every pixel, and of a light path of each map.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts {
    pub camera: Part,
    pub maps: [Part; 2],
    /// Of the variance of camera samples, the part that is of light which samples nearby may share.
    pub shareable: f64,
    /// Photons that a light path leaves in each map.
    pub stored: [f64; 2],
}

/// Luminance that one camera sample brings, how much of it is caustic, and how much samples nearby may share.
#[derive(Clone, Copy, Debug, Default)]
struct Light {
    all: f64,
    caustic: f64,
    shared: f64,
}

/// Samples of all patches in all passes.
pub(super) struct Seen {
    /// By pass, patch, pixel and number of the sample.
    light: Vec<Light>,
    patches: usize,
    pixels: usize,
    /// Of a camera sample.
    work: f64,
    /// By map, in all passes.
    maps: [Built; 2],
}

/// What building a map took: work, light paths (none where there is no map) and photons.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Built {
    work: f64,
    paths: u64,
    photons: u64,
}

/// A map, if there is one, and what it took.
pub(super) type BuiltMap = (Option<Arc<PassMap>>, Built);

impl PhotonMapper<'_> {
    /// Maps for all passes, of which `same` are taken from those of another estimator.
    pub(super) fn build_all(&self, others: Option<(&[[BuiltMap; 2]], [bool; 2])>) -> Vec<[BuiltMap; 2]> {
        let build = |pass: usize, i: usize| match others {
            Some((built, same)) if same[i] => built[pass][i].clone(),
            _ => self.build_counted(self.maps()[i], pass as u32),
        };
        (0..PASSES).map(|pass| [0, 1].map(|i| build(pass, i))).collect()
    }

    /// Samples the patches with the maps of all passes.
    pub(super) fn look(&self, built: &[[BuiltMap; 2]]) -> Seen {
        let of_pass = |[(global, a), (caustic, b)]: [BuiltMap; 2]| {
            (Arc::new(Maps { global, caustic, volume: None }), [a, b])
        };
        self.look_through(built.iter().cloned().map(of_pass), true)
    }

    /// The same with passes as the render makes them: what all maps of a pass take counts as one light path of the
    /// first map.
    pub(super) fn look_at_passes(&self) -> Seen {
        let of_pass = |pass: usize| {
            let (maps, stats) = self.begin_pass(pass as u32);
            let work = work::of_pass_in_media(&stats, maps.volume.as_ref());
            let paths = u64::from(stats.light_paths > 0);
            (maps, [Built { work, paths, photons: stats.photons }, Built::default()])
        };
        let mapped = self.maps().iter().any(|map| map.wanted()) || self.volume.paths > 0;
        self.look_through((0..PASSES).map(of_pass), mapped)
    }

    /// Samples the patches in several passes: of each its maps and what they took. Where there are `mapped` photons, the
    /// camera samples are the same in all.
    fn look_through(&self, passes: impl Iterator<Item = (Arc<Maps>, [Built; 2])>, mapped: bool) -> Seen {
        let [_, _, width, height] = self.task.view.film.crop;
        let size = [width.min(SIDE), height.min(SIDE)];
        let patches = self.patches(size);
        let mut seen = Seen {
            light: Vec::new(),
            patches: patches.len(),
            pixels: (size[0] * size[1]) as usize,
            work: 0.0,
            maps: Default::default(),
        };
        let mut rays = 0.0;
        for (number, (maps, took)) in passes.enumerate() {
            let seed = self.settings.seed ^ if mapped { 0 } else { mix(number as u64) };
            for (sum, one) in seen.maps.iter_mut().zip(took) {
                sum.work += one.work;
                sum.paths += one.paths;
                sum.photons += one.photons;
            }
            let looks: Vec<(Vec<Light>, f64)> =
                patches.par_iter().map(|&patch| self.look_at(&maps, seed, patch, size)).collect();
            for (light, work) in looks {
                seen.light.extend(light);
                rays += work;
            }
        }
        seen.work = rays / seen.light.len().max(1) as f64;
        seen
    }

    /// A map of a pass and what it took.
    fn build_counted(&self, map: &Map, pass: u32) -> BuiltMap {
        let mut stats = PassStats::default();
        let built = self.build(map, pass, self.halts[0], &mut stats);
        let places = built.as_ref().and_then(|m| m.irradiance.as_ref()).map_or(0, |known| known.count());
        let work = work::of_map(&stats, places);
        let paths = if built.is_some() { map.paths } else { 0 };
        (built, Built { work, paths, photons: stats.photons })
    }

    /// Where patches begin.
    fn patches(&self, size: [u32; 2]) -> Vec<Patch> {
        let [x0, y0, width, height] = self.task.view.film.crop;
        let along = |i: u32, n: u32, length: u32, patch: u32| (length - patch) * (2 * i + 1) / (2 * n);
        let [nx, ny] = [(width / size[0].max(1)).min(ALONG), (height / size[1].max(1)).min(ALONG)];
        (0..nx * ny)
            .map(|i| {
                [
                    x0 + along(i % nx.max(1), nx, width, size[0]),
                    y0 + along(i / nx.max(1), ny, height, size[1]),
                ]
            })
            .collect()
    }

    fn look_at(&self, maps: &Arc<Maps>, seed: u64, patch: Patch, size: [u32; 2]) -> (Vec<Light>, f64) {
        let view = self.task.view;
        let full = view.film.size();
        let mut samples = Vec::new();
        for i in 0..size[0] * size[1] {
            let [x, y] = [patch[0] + i % size[0], patch[1] + i / size[0]];
            let key = mix(seed ^ mix(u64::from(y) << 32 | u64::from(x)));
            for number in 0..SAMPLES as u32 {
                let mut sampler = Sampler::new(key, number);
                let place = (Vec2::new(x as f32, y as f32) + sampler.next_2d()) / full;
                let aperture = if view.sensor.has_aperture() { sampler.next_2d() } else { Vec2::ZERO };
                let ray = view.sensor.ray(place, aperture);
                samples.push(CameraSample::new(ray, sampler));
            }
        }
        let mut scratch = Scratch::default();
        self.sample(maps, &mut samples, &mut scratch);
        let work = match self.task.facts.media {
            true => work::of_camera_in_media(&scratch, maps.volume.as_ref()),
            false => work::of_camera(&scratch),
        };
        (samples.iter().map(light).collect(), work)
    }
}

/// In f64, since variances are sums of squares; what is not finite never reaches the film and counts as nothing.
fn light(sample: &CameraSample) -> Light {
    let out = &sample.out;
    let of = |c: crate::math::Color| {
        let sum: f64 = c.lanes().iter().map(|&v| f64::from(v)).sum();
        if sum.is_finite() { sum / crate::math::LANES as f64 } else { 0.0 }
    };
    let layer = |layer: Layer| of(out.layers[layer as usize]);
    let shared = if sample.diffuse.is_some() { layer(Layer::Indirect) } else { 0.0 };
    Light { all: of(out.sum()), caustic: layer(Layer::Caustic), shared }
}

/// Mean luminance of each pixel over several looks: errors are relative to it.
pub(super) struct Reference {
    pixels: Vec<f64>,
    /// Of the whole picture.
    mean: f64,
}

impl Reference {
    /// The mean of all `looks`, which are at the same pixels.
    pub fn of(looks: &[&Seen]) -> Self {
        let count = looks.first().map_or(0, |seen| seen.patches * seen.pixels);
        let mut pixels = vec![0.0; count];
        let share = 1.0 / (looks.len() * PASSES * SAMPLES).max(1) as f64;
        for seen in looks {
            for (i, light) in seen.light.iter().enumerate() {
                pixels[i / SAMPLES % count] += light.all * share;
            }
        }
        let mean = pixels.iter().sum::<f64>() / count.max(1) as f64;
        Self { pixels, mean }
    }

    /// Weight of a squared error where the mean is `m`.
    fn weight(&self, m: f64) -> f64 {
        let dark = DARK * self.mean;
        let square = m * m + dark * dark;
        if square > 0.0 { 1.0 / square } else { 0.0 }
    }
}

/// Variance within passes, and between passes by map.
#[derive(Clone, Copy, Debug, Default)]
struct Variance {
    camera: f64,
    /// The same without what may be shared.
    alone: f64,
    maps: [f64; 2],
}

impl Seen {
    /// Variance and work of the parts. `scale` says by how much the variance of a map's photon differs in the render,
    /// whose radii are others. `pixels` is how many the whole picture has.
    pub fn parts(&self, reference: &Reference, scale: [f64; 2], pixels: usize) -> Parts {
        let mut sum = Variance::default();
        for patch in 0..self.patches {
            let of = |i: usize| reference.pixels[patch * self.pixels + i];
            let each: Vec<Variance> = (0..self.pixels).map(|i| self.variance(patch, i..i + 1)).collect();
            for (i, v) in each.iter().enumerate() {
                sum.add(v, reference.weight(of(i)) / self.pixels as f64);
            }
            let mean = (0..self.pixels).map(of).sum::<f64>() / self.pixels as f64;
            let blurred = self.variance(patch, 0..self.pixels);
            sum.add(&blurred, BLURRED * reference.weight(mean));
        }
        let n = self.patches.max(1) as f64;
        let map = |i: usize| {
            let Built { work, paths, .. } = self.maps[i];
            let a_pass = paths as f64 / PASSES as f64;
            let each = if paths > 0 { work / paths as f64 } else { 0.0 };
            Part { variance: sum.maps[i].max(0.0) / n * a_pass * scale[i], work: each }
        };
        Parts {
            camera: Part { variance: sum.camera / n, work: self.work * pixels as f64 },
            shareable: if sum.camera > 0.0 { (1.0 - sum.alone / sum.camera).max(0.0) } else { 0.0 },
            maps: [map(0), map(1)],
            stored: self.maps.map(|map| map.photons as f64 / map.paths.max(1) as f64),
        }
    }

    /// Of the mean of some pixels of a patch.
    fn variance(&self, patch: usize, pixels: std::ops::Range<usize>) -> Variance {
        let share = 1.0 / pixels.len() as f64;
        let (mut all, mut caustic, mut alone) = (Table::default(), Table::default(), Table::default());
        for (pass, i) in (0..PASSES).flat_map(|pass| pixels.clone().map(move |i| (pass, i))) {
            let at = ((pass * self.patches + patch) * self.pixels + i) * SAMPLES;
            for (number, light) in self.light[at..at + SAMPLES].iter().enumerate() {
                all[pass][number] += share * light.all;
                caustic[pass][number] += share * light.caustic;
                alone[pass][number] += share * (light.all - light.shared);
            }
        }
        let rest = std::array::from_fn(|p| std::array::from_fn(|k| all[p][k] - caustic[p][k]));
        let maps = match self.maps.map(|map| map.paths > 0) {
            [true, true] => [of_passes(&rest), of_passes(&caustic)],
            [true, false] => [of_passes(&all), 0.0],
            [false, true] => [0.0, of_passes(&all)],
            [false, false] => [0.0; 2],
        };
        Variance { camera: of_samples(&all), alone: of_samples(&alone), maps }
    }
}

/// Values by pass and sample.
type Table = [[f64; SAMPLES]; PASSES];

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

/// Variance of one sample within a pass.
fn of_samples(table: &Table) -> f64 {
    let squares = table.iter().flat_map(|row| {
        let m = mean(row.iter().copied());
        row.iter().map(move |v| (v - m) * (v - m))
    });
    squares.sum::<f64>() / (PASSES * (SAMPLES - 1)) as f64
}

/// The part of the variance between passes that all samples of a pass share: a two-way analysis of variance.
fn of_passes(table: &Table) -> f64 {
    let of_pass = table.map(|row| mean(row.into_iter()));
    let of_sample: [f64; SAMPLES] = std::array::from_fn(|k| mean(table.iter().map(|row| row[k])));
    let all = mean(of_pass.into_iter());
    let square = |d: f64| d * d;
    let passes: f64 = of_pass.iter().map(|m| square(m - all)).sum::<f64>() / (PASSES - 1) as f64;
    let apart = (0..PASSES * SAMPLES).map(|i| {
        let (p, k) = (i / SAMPLES, i % SAMPLES);
        square(table[p][k] - of_pass[p] - of_sample[k] + all)
    });
    passes - apart.sum::<f64>() / ((PASSES - 1) * (SAMPLES - 1) * SAMPLES) as f64
}

impl Variance {
    fn add(&mut self, other: &Self, weight: f64) {
        self.camera += weight * other.camera;
        self.alone += weight * other.alone;
        for (sum, v) in self.maps.iter_mut().zip(other.maps) {
            *sum += weight * v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::CounterRng;

    /// Values with a known variance between passes, between samples and of what is left. Of 20 000 tables the means are
    /// known to about √(2/(2·20 000)) = 0.7 % of the largest variance (2 degrees of freedom); 4 sigmas are 3 %.
    #[test]
    fn variances_of_passes_and_samples_are_told_apart() {
        let mut rng = CounterRng::new(3, 0);
        // Even in [-√3, √3]: variance 1.
        let mut unit = || f64::from(rng.next_2d()[0] - 0.5) * 12f64.sqrt();
        let (of_pass, of_sample, of_both) = (0.5, 2.0, 0.3);
        let mut sums = [0.0; 2];
        let tables = 20_000;
        for _ in 0..tables {
            let passes: [f64; PASSES] = std::array::from_fn(|_| unit() * of_pass);
            let samples: [f64; SAMPLES] = std::array::from_fn(|_| unit() * of_sample);
            let table: Table = std::array::from_fn(|p| {
                std::array::from_fn(|k| 7.0 + passes[p] + samples[k] + unit() * of_both)
            });
            sums[0] += of_passes(&table) / f64::from(tables);
            sums[1] += of_samples(&table) / f64::from(tables);
        }
        let largest = 0.25 + (0.09 / SAMPLES as f64);
        assert!((sums[0] - 0.25).abs() < 0.03 * largest, "passes {}", sums[0]);
        assert!((sums[1] - 4.09).abs() < 0.03 * 4.09, "samples {}", sums[1]);
    }
}
