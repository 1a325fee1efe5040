//! Spheres that light is sent towards.

use std::collections::BTreeMap;

use super::super::SceneSphere;
use crate::math::{Frame, Vec2, Vec3};
use crate::sampling::{Density, Discrete, warp};

/// Spheres that get more of the paths than the rest of the scene: those through which paths came that left photons
/// (windows, for example), those around what the camera sees, or those around glass. Each path towards them carries
/// less, so the light stays the same.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Includes the whole scene, so that no light is lost.
    targets: Vec<SceneSphere>,
    /// Probabilities of the targets.
    choice: Discrete,
    /// The target that is the whole scene.
    everywhere: usize,
}

/// The first segment of a light path from infinity: from outside of the scene to what it meets there.
#[derive(Clone, Copy, Debug)]
pub struct EntrySegment {
    /// Where it starts, before the scene.
    pub from: Vec3,
    /// The first surface point that it meets.
    pub to: Vec3,
    /// Flux of the photons that the path left, of the channel with most.
    pub weight: f32,
}

/// Most targets.
const MOST: usize = 64;

/// Sizes of targets to try: the scene's radius over these. The first is taken whose targets have [`HITS`] segments each
/// on average.
const ACROSS: [f32; 4] = [16.0, 8.0, 4.0, 2.0];

/// With fewer segments a target, much of the light would pass outside of all targets and get a large weight.
const HITS: usize = 4;

/// Share of the paths that are not aimed: what the pilot missed is not lost, and its weight is at most four.
const EVERYWHERE: f64 = 0.25;

/// If the scene is this many times larger than what the camera sees of it, hardly any unaimed light arrives there.
const VAST: f32 = 8.0;

/// Ratio of the radii of consecutive spheres around what the camera sees.
const WIDER: f32 = 2.0;

/// Smallest radius, as a share of the scene's: single precision places light on the disk in steps of 2⁻²⁴ of it.
const FINEST: f32 = 1.0 / 16384.0;

impl Targets {
    /// From the first segments of paths that left photons. `None` if few targets do not cover them.
    pub fn new(scene: &SceneSphere, segments: &[EntrySegment]) -> Option<Self> {
        ACROSS.into_iter().find_map(|across| {
            let size = scene.radius / across;
            let found = cover(scene, segments, size).filter(|cells| cells.len() * HITS <= segments.len())?;
            let center = |cell: Cell| scene.center + (Vec3::from(cell.map(|x| x as f32)) + 0.5) * size;
            // Half of a cell's diagonal.
            let radius = size * 0.75f32.sqrt();
            let shares = found.iter().map(|c| c.1);
            let cells = found.iter().map(|c| SceneSphere { center: center(c.0), radius });
            Some(Self::with(scene, cells.zip(shares)))
        })
    }

    /// Equal shares to some of the things that photons can come from. `None` without any.
    pub fn toward(scene: &SceneSphere, bodies: &[SceneSphere]) -> Option<Self> {
        let some = bodies.iter().step_by(bodies.len().div_ceil(MOST).max(1));
        let least = FINEST * scene.radius;
        let wide = |body: &SceneSphere| SceneSphere { radius: body.radius.max(least), ..*body };
        (!bodies.is_empty()).then(|| Self::with(scene, some.map(|body| (wide(body), 1.0))))
    }

    /// Targets and their weights, beside the whole scene.
    fn with(scene: &SceneSphere, targets: impl Iterator<Item = (SceneSphere, f64)>) -> Self {
        let (targets, weights): (Vec<_>, Vec<f64>) = targets.unzip();
        let all: f64 = weights.iter().sum();
        let shares = weights.iter().map(|weight| (1.0 - EVERYWHERE) * weight / all);
        Self {
            targets: std::iter::once(*scene).chain(targets).collect(),
            choice: Discrete::new(std::iter::once(EVERYWHERE).chain(shares)),
            everywhere: 0,
        }
    }

    /// Equal shares to `seen`, to spheres around it that double in radius, and to the whole scene: on a vast floor,
    /// hardly any unaimed light comes near the camera. `None` if the scene is not that large.
    pub fn around(scene: &SceneSphere, seen: &SceneSphere) -> Option<Self> {
        if seen.radius.is_nan() || seen.radius <= 0.0 || scene.radius <= VAST * seen.radius {
            return None;
        }
        let radii = std::iter::successors(Some(seen.radius.max(FINEST * scene.radius)), |r| Some(r * WIDER));
        let near = radii
            .take_while(|r| *r < 0.5 * scene.radius)
            .map(|radius| SceneSphere { center: seen.center, radius });
        let targets: Vec<SceneSphere> = near.chain([*scene]).collect();
        let choice = Discrete::new(targets.iter().map(|_| 1.0));
        let everywhere = targets.len() - 1;
        Some(Self { targets, choice, everywhere })
    }

    /// The direction from `o` that `u` selects, for a lamp there that chooses by `own` with the density `pdf`, and the
    /// weight of it: the lamp's own density over that of the choice made.
    fn head(
        &self,
        o: Vec3,
        u: Vec2,
        own: impl FnOnce(Vec2) -> Vec3,
        pdf: impl Fn(Vec3) -> f32,
    ) -> (Vec3, f32) {
        let (i, within) = self.choice.sample(u.x);
        let u = Vec2::new(within, u.y);
        // 1 − cos of a target's half angle; none from within, and for the scene.
        let cone = |target: &SceneSphere| {
            let (way, r2) = (target.center - o, target.radius * target.radius);
            let sine2 = r2 / way.length_squared();
            (sine2 < 1.0).then(|| (way, sine2 / (1.0 + (1.0 - sine2).sqrt())))
        };
        let chosen = if self.everywhere == i { None } else { cone(&self.targets[i]) };
        let d = match chosen {
            Some((way, gap)) => Frame::from_normal(way.normalize()).to_world(warp::cone(u, gap)),
            None => own(u),
        };
        let natural = pdf(d);
        let made = |(target, k): (&SceneSphere, usize)| {
            let density = match if self.everywhere == k { None } else { cone(target) } {
                None => natural,
                // Rounding must not put a direction outside of the cone that it was chosen in: it would get a large
                // weight.
                Some((way, gap)) if k == i || way.dot(d) > 0.0 && way.cross(d).length() <= target.radius => {
                    1.0 / (2.0 * std::f32::consts::PI * gap)
                }
                Some(_) => 0.0,
            };
            self.choice.probability(k) * density
        };
        let density: f32 = self.targets.iter().zip(0..).map(made).sum();
        (d, if natural > 0.0 { natural / density } else { 0.0 })
    }

    /// A point of the disk, and its weight: the density of an even choice over that of the choice made.
    fn place(&self, scene: &SceneSphere, frame: &Frame, u: Vec2) -> (Vec2, f32) {
        let at = |target: &SceneSphere| {
            let local = frame.to_local(target.center - scene.center);
            Vec2::new(local.x, local.y)
        };
        let (i, within) = self.choice.sample(u.x);
        let target = &self.targets[i];
        let place = at(target) + warp::disk(Vec2::new(within, u.y)) * target.radius;
        let relative: f32 = self
            .targets
            .iter()
            .zip(0..)
            // As it was chosen in target `i`, it lies there whatever rounding says.
            .filter(|(t, k)| *k == i || (at(t) - place).length_squared() <= t.radius * t.radius)
            .map(|(t, k)| self.choice.probability(k) * (scene.radius / t.radius).powi(2))
            .sum();
        (place, 1.0 / relative)
    }
}

type Cell = [i32; 3];

/// Few cells of a grid that the segments of nearly all flux pass through, chosen greedily by the flux that is not yet
/// covered. `None` if [`MOST`] cells are not enough.
fn cover(scene: &SceneSphere, segments: &[EntrySegment], size: f32) -> Option<Vec<(Cell, f64)>> {
    let mut through: BTreeMap<Cell, Vec<usize>> = BTreeMap::new();
    for (i, segment) in segments.iter().enumerate() {
        let way = segment.to - segment.from;
        let steps = (2.0 * way.length() / size).ceil().clamp(1.0, 1024.0) as u16;
        for k in 0..=steps {
            let p = segment.from + way * (f32::from(k) / f32::from(steps)) - scene.center;
            let list = through.entry((p / size).floor().to_array().map(|x| x as i32)).or_default();
            if list.last() != Some(&i) {
                list.push(i);
            }
        }
    }
    let mut left: Vec<f64> = segments.iter().map(|a| f64::from(a.weight)).collect();
    let all: f64 = left.iter().sum();
    let mut found = Vec::new();
    let mut covered = 0.0;
    while covered < 0.98 * all {
        let brought = |list: &Vec<usize>| list.iter().map(|&i| left[i]).sum::<f64>();
        let (cell, list, weight) = through
            .iter()
            .map(|(cell, list)| (cell, list, brought(list)))
            .max_by(|a, b| a.2.total_cmp(&b.2))
            .filter(|best| best.2 > 0.0 && found.len() < MOST)?;
        list.iter().for_each(|&i| left[i] = 0.0);
        covered += weight;
        found.push((*cell, weight));
    }
    (!found.is_empty()).then_some(found)
}

/// The scene as emitters need to know it: light from infinity starts on a disk that covers it.
#[derive(Clone, Copy, Debug)]
pub struct EmissionBounds<'a> {
    /// The sphere around everything in the scene.
    pub sphere: SceneSphere,
    /// Where on the disk light starts; evenly all over it without.
    pub entrances: Option<&'a Targets>,
    /// Where lamps in the scene send their light; as their kind does without.
    pub headings: Option<&'a Targets>,
}

/// Where light from infinity enters.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Before the scene, on the disk across the light's direction.
    pub o: Vec3,
    /// Density of an even choice over the disk against that of the choice made: 1 on the average.
    pub weight: f32,
    /// Of `o`, per area of the disk.
    pub density: Density,
}

impl EmissionBounds<'_> {
    /// Evenly.
    pub fn even(sphere: SceneSphere) -> Self {
        Self { sphere, entrances: None, headings: None }
    }

    /// The direction in which a lamp at `o` sends light, and the density of the lamp's own choice over that of the
    /// choice made. The lamp chooses by `own` with the density `pdf` per solid angle.
    #[inline(always)]
    pub fn head(
        &self,
        o: Vec3,
        u: Vec2,
        own: impl FnOnce(Vec2) -> Vec3,
        pdf: impl Fn(Vec3) -> f32,
    ) -> (Vec3, f32) {
        match self.headings {
            Some(targets) => targets.head(o, u, own, pdf),
            None => (own(u), 1.0),
        }
    }

    /// Where light that travels along the unit direction `d` enters.
    pub fn enter(&self, d: Vec3, u: Vec2) -> Entry {
        let SceneSphere { center, radius } = self.sphere;
        let frame = Frame::from_normal(d);
        let (at, weight) = match self.entrances {
            Some(entrances) => entrances.place(&self.sphere, &frame, u),
            None => (warp::disk(u) * radius, 1.0),
        };
        let o = center + frame.to_world(Vec3::new(at.x, at.y, -radius));
        let density = Density::Finite(1.0 / (self.sphere.disk() * weight));
        Entry { o, weight, density }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::CounterRng;

    /// Aimed light brings to every part of the disk what even light does: its weighted share of samples is the part's
    /// share of the area (10⁶ samples of weights below 5, so 4.5 sigmas are below 0.007).
    #[test]
    fn aimed_light_is_as_much_everywhere() {
        let sphere = SceneSphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 2.0 };
        let ends = [
            (Vec3::new(1.5, 2.0, 3.0), 3.0),
            (Vec3::new(1.0, 3.7, 3.1), 1.0),
            (Vec3::new(-0.8, 2.0, 3.0), 0.5),
        ];
        let segment = |(to, weight): (Vec3, f32)| EntrySegment { from: to - Vec3::Z * 4.0, to, weight };
        let segments: Vec<EntrySegment> = [ends; 4].concat().into_iter().map(segment).collect();
        even(sphere, &Targets::new(&sphere, &segments).expect("targets"), 4.0);
        let seen = SceneSphere { center: Vec3::new(1.5, 2.5, 3.0), radius: 0.1 };
        even(sphere, &Targets::around(&sphere, &seen).expect("much larger"), 5.0);
    }

    fn even(sphere: SceneSphere, entrances: &Targets, most: f32) {
        let bounds = EmissionBounds { sphere, entrances: Some(entrances), headings: None };
        let d = Vec3::new(0.2, -0.3, 0.9).normalize();
        let mut rng = CounterRng::new(5, 0);
        let n = 1_000_000;
        // By the first target, a quarter of the disk, all of it.
        let mut sums = [0.0f64; 3];
        let frame = Frame::from_normal(d);
        let first = frame.to_local(entrances.targets[1].center - sphere.center);
        let first = Vec2::new(first.x, first.y);
        for _ in 0..n {
            let Entry { o, weight, density } = bounds.enter(d, Vec2::from(rng.next_2d()));
            assert!((density.factor() * sphere.disk() * weight - 1.0).abs() < 1e-5);
            let local = frame.to_local(o - sphere.center);
            assert!((local.z + sphere.radius).abs() < 1e-5 && weight <= most * 1.001, "{weight}");
            let at = Vec2::new(local.x, local.y);
            if at.length() > sphere.radius {
                continue;
            }
            let parts = [(at - first).length() < 0.3, at.x > 0.0 && at.y > 0.0, true];
            for (sum, inside) in sums.iter_mut().zip(parts) {
                *sum += if inside { f64::from(weight) / f64::from(n) } else { 0.0 };
            }
        }
        for (sum, area) in sums.into_iter().zip([(0.3f64 / 2.0).powi(2), 0.25, 1.0]) {
            assert!((sum - area).abs() < 0.007 * area.sqrt(), "{sum} of {area}");
        }
    }
}
