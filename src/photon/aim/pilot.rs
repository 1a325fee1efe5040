//! Paths that are traced to learn where others should start.

use rayon::prelude::*;

use super::lines::{Brought, Lines};
use super::seen::Discs;
use crate::emitter::{EmissionBounds, EntrySegment, PathFound, SceneSphere, Start, Starts};
use crate::math::Vec3;
use crate::photon::trace::{self, Halt, TraceJob, follow, in_chunks, path_sampler};
use crate::photon::volume::Beam;
use crate::sampling::{Discrete, Found, Sampler, mix};
use crate::scene::Scene;

/// What all pilots of a map share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub scene: &'a Scene,
    pub job: &'a TraceJob,
    pub seen: &'a Seen<'a>,
    /// Around most of what the camera sees.
    pub around: SceneSphere,
    pub halt: Halt<'a>,
}

impl Task<'_> {
    /// How many paths a pilot traces instead of `paths`: in media they tell more.
    pub fn paths(&self, paths: u64) -> u64 {
        match self.seen {
            Seen::Surfaces(_) => paths,
            Seen::Media(_) => paths / 2,
        }
    }
}

/// Parts of the picture, by which photons are valued.
#[derive(Debug)]
pub(super) enum Seen<'a> {
    Surfaces(Discs),
    Media(Lines<'a>),
}

impl Seen<'_> {
    /// Whether the map is read nowhere, as far as is known: photons are worth the same everywhere then.
    fn is_empty(&self) -> bool {
        match self {
            Self::Surfaces(discs) => discs.is_empty(),
            Self::Media(lines) => lines.lines.is_empty(),
        }
    }

    /// How many parts there are.
    fn len(&self) -> usize {
        match self {
            Self::Surfaces(discs) => discs.len(),
            Self::Media(lines) => lines.light.len(),
        }
    }

    /// By part: what the square of a photon's flux is worth, or of the radiance that it brings, from what all bring.
    fn worth(&self, landed: &[f64]) -> Vec<f64> {
        match self {
            Self::Surfaces(discs) => discs.worth(landed),
            Self::Media(lines) => lines.worth(landed),
        }
    }
}

/// A path and what it met.
#[derive(Clone, Copy, Debug)]
struct Path {
    start: Start,
    cost: f32,
    /// Flux of its photons, if it had started by power and even numbers.
    flux: f32,
    /// From where it started, and where it met a surface first.
    way: Option<[Vec3; 2]>,
    from_infinity: bool,
    /// Density of the lamp's own choice of a heading over that of the choice made.
    weight: f32,
}

/// A photon on a disc: its path, the disc, and its flux. Or a piece of a beam near a line, and what it brings there.
#[derive(Clone, Copy, Debug)]
struct Landed {
    path: u32,
    spot: u32,
    flux: f32,
}

/// Paths of one or several densities.
#[derive(Debug, Default)]
pub(super) struct Pilot {
    paths: Vec<Path>,
    landed: Vec<Landed>,
    rounds: Vec<Round>,
}

/// How many paths were started by which density; `None` is by power and even numbers.
#[derive(Debug)]
struct Round {
    count: usize,
    starts: Option<Starts>,
}

/// Time of a path beside that of its rays, and of a photon, in that of a ray.
const OVERHEAD: f32 = 0.5;

/// Photons on discs after which a chunk of paths ends: where light hardly loses anything a path leaves hundreds, each on
/// several discs, and fewer paths tell as much.
const MOST_LANDED: usize = 1 << 16;
const MOST_BEAMS: usize = 1 << 12;

impl Pilot {
    /// Traces `paths` more, started by `starts`.
    pub fn run(&mut self, task: &Task<'_>, paths: u64, starts: Option<Starts>, bounds: &EmissionBounds<'_>) {
        let key = mix(task.job.key ^ self.rounds.len() as u64);
        let job = TraceJob { key, paths, ..*task.job };
        let chunks = in_chunks(paths, 0, task.halt, |range| {
            let mut part = Part::default();
            for i in range {
                if task.halt.stopped() || part.is_full() {
                    break;
                }
                let mut sampler = path_sampler(&job, i);
                let (pick, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
                if let Some(start) = task.scene.start(pick, place, direction, starts.as_ref()) {
                    part.add(task, &job, start, bounds, &mut sampler);
                }
            }
            part
        });
        let before = self.paths.len();
        let (mut beams, mut path_of) = (Vec::new(), Vec::new());
        for part in chunks {
            let first = self.paths.len() as u32;
            self.landed.extend(part.landed.iter().map(|l| Landed { path: l.path + first, ..*l }));
            path_of.extend(part.path_of.iter().map(|path| path + first));
            beams.extend(part.out.beams);
            self.paths.extend(part.paths);
        }
        if let Seen::Media(lines) = task.seen {
            let landed = |b: Brought| Landed { path: path_of[b.beam as usize], spot: b.place, flux: b.light };
            self.landed.extend(lines.each(&beams).into_iter().map(landed));
        }
        self.rounds.push(Round { count: self.paths.len() - before, starts });
    }

    /// All paths with what they are worth.
    pub fn found(&self, task: &Task<'_>) -> Vec<PathFound> {
        let power = &task.scene.emission;
        let weights: Vec<f32> = self.paths.par_iter().map(|p| self.weight(power, &p.start)).collect();
        let values = self.values(task.seen, &weights);
        let one = |((path, weight), value): ((&Path, &f32), &f64)| {
            let found = Found { at: path.start.at, weight: *weight, value: *value as f32, cost: path.cost };
            PathFound { lamp: path.start.lamp, found }
        };
        self.paths.iter().zip(&weights).zip(&values).map(one).collect()
    }

    /// By path: the square of what it brings to the picture, if it had started by power and even numbers, in units of the
    /// mean.
    fn values(&self, seen: &Seen<'_>, weights: &[f32]) -> Vec<f64> {
        let mut values: Vec<f64> = if seen.is_empty() {
            self.paths.iter().map(|p| f64::from(p.flux).powi(2)).collect()
        } else {
            let mut fluxes = vec![0.0f64; seen.len()];
            for l in &self.landed {
                let flux = f64::from(l.flux * weights[l.path as usize]);
                fluxes[l.spot as usize] += flux / self.paths.len() as f64;
            }
            let worth = seen.worth(&fluxes);
            let mut values = vec![0.0f64; self.paths.len()];
            for l in &self.landed {
                values[l.path as usize] += worth[l.spot as usize] * f64::from(l.flux).powi(2);
            }
            values
        };
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let sound = mean > 0.0 && mean.is_finite();
        values.iter_mut().for_each(|v| *v = if sound { *v / mean } else { 0.0 });
        values
    }

    /// One over the density with which the paths of all rounds start there.
    fn weight(&self, power: &Discrete, start: &Start) -> f32 {
        let density = |starts: &Starts| f64::from(starts.density(power, start.lamp, start.at));
        let of = |round: &Round| round.count as f64 * round.starts.as_ref().map_or(1.0, density);
        (self.paths.len() as f64 / self.rounds.iter().map(of).sum::<f64>()) as f32
    }

    /// What the last round gained against choices by power and by the lamps' own densities: time to the same error of
    /// these over that of the round.
    pub fn last_gain(&self, found: &[PathFound]) -> Gain {
        let Some(round) = self.rounds.last() else { return Gain::NONE };
        let from = self.paths.len() - round.count;
        let tried = |(path, found): (&Path, &PathFound)| {
            let density = f64::from(path.start.density);
            Tried { path: *found, density, drawn: density, weight: f64::from(path.weight) }
        };
        gain(self.paths[from..].iter().zip(&found[from..]).map(tried))
    }

    /// Share of the paths that bring something.
    pub fn share(&self, found: &[PathFound]) -> f64 {
        found.iter().filter(|p| p.found.value > 0.0).count() as f64 / found.len().max(1) as f64
    }

    /// The same of the paths of the last round.
    pub fn last_share(&self, found: &[PathFound]) -> f64 {
        let count = self.rounds.last().map_or(0, |round| round.count);
        self.share(&found[found.len() - count..])
    }

    /// The first segments of paths from infinity that brought something, how many such paths met the scene.
    pub fn entry_segments(&self, found: &[PathFound]) -> (usize, Vec<EntrySegment>) {
        let met = self.paths.iter().filter(|p| p.from_infinity && p.way.is_some()).count();
        let segment = |(path, found): (&Path, &PathFound)| {
            let [from, to] = path.way.filter(|_| path.from_infinity)?;
            let weight = found.found.weight * found.found.value.sqrt();
            (weight > 0.0).then_some(EntrySegment { from, to, weight })
        };
        (met, self.paths.iter().zip(found).filter_map(segment).collect())
    }

    /// First surface points of the paths that left photons.
    pub fn first_points(&self) -> impl Iterator<Item = Vec3> {
        self.paths.iter().filter(|p| p.flux > 0.0).filter_map(|p| p.way).map(|way| way[1])
    }
}

/// A path by which a density is judged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tried {
    pub path: PathFound,
    /// The density that is judged, over that of even numbers.
    pub density: f64,
    /// With which the path was drawn.
    pub drawn: f64,
    /// Density of the lamp's own choice over that by even numbers.
    pub weight: f64,
}

/// How a density does against power and the lamps' own densities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    /// Time to the same error by these, over that by the density.
    pub time: f64,
    /// Time of a path by the density, over that of a path by these.
    pub cost: f64,
}

impl Gain {
    pub const NONE: Self = Self { time: 1.0, cost: 1.0 };
}

pub(super) fn gain(paths: impl Iterator<Item = Tried>) -> Gain {
    let [mut square, mut own_square, mut cost, mut own_cost] = [0.0f64; 4];
    for Tried { path, density, drawn, weight } in paths {
        let (value, time) = (f64::from(path.found.value), f64::from(path.found.cost));
        square += value / (density * drawn);
        own_square += if weight > 0.0 { value / (weight * drawn) } else { 0.0 };
        cost += time * density / drawn;
        own_cost += time * weight / drawn;
    }
    if square > 0.0 && own_cost > 0.0 {
        Gain { time: own_square * own_cost / (square * cost), cost: cost / own_cost }
    } else {
        Gain::NONE
    }
}

/// Paths of a chunk.
#[derive(Debug, Default)]
struct Part {
    paths: Vec<Path>,
    landed: Vec<Landed>,
    out: trace::Part,
    /// Of each beam.
    path_of: Vec<u32>,
}

impl Part {
    /// Whether this tells enough.
    fn is_full(&self) -> bool {
        self.landed.len() > MOST_LANDED || self.out.beams.len() > MOST_BEAMS
    }

    fn add(
        &mut self,
        task: &Task<'_>,
        job: &TraceJob,
        start: Start,
        bounds: &EmissionBounds<'_>,
        sampler: &mut Sampler,
    ) {
        let mut path =
            Path { start, cost: OVERHEAD, flux: 0.0, way: None, from_infinity: false, weight: 1.0 };
        if let Some(light) = task.scene.emission_of(start, bounds) {
            self.out.photons.clear();
            self.out.rays = 0;
            let first = follow(task.scene, job, &light, sampler, &mut self.out);
            path.way = first.map(|to| [light.emission.o, to]);
            path.from_infinity = light.from_infinity;
            path.weight = if light.from_infinity { 1.0 } else { light.emission.weight };
            let left = self.keep(task, start.density * job.paths as f32, &mut path);
            path.cost += self.out.rays as f32 + OVERHEAD * left as f32;
        }
        self.paths.push(path);
    }

    /// Keeps what the path left, its flux times `scale`. Returns how much that is.
    fn keep(&mut self, task: &Task<'_>, scale: f32, path: &mut Path) -> usize {
        let number = self.paths.len() as u32;
        match task.seen {
            Seen::Surfaces(discs) => {
                for photon in &self.out.photons {
                    let flux = photon.flux.max_element() * scale;
                    path.flux += flux;
                    let landed = |spot| Landed { path: number, spot, flux };
                    discs.each(photon, |spot| self.landed.push(landed(spot)));
                }
                self.out.photons.len()
            }
            Seen::Media(_) => {
                let new: &mut [Beam] = &mut self.out.beams[self.path_of.len()..];
                for beam in new.iter_mut() {
                    beam.flux *= scale;
                    path.flux += beam.flux.max_element();
                }
                let left = new.len();
                self.path_of.resize(self.out.beams.len(), number);
                left
            }
        }
    }
}
