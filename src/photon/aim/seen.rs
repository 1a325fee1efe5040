//! What photons are worth, by where they land.

use std::collections::HashMap;

use crate::emitter::SceneSphere;
use crate::math::{Frame, Ray, Vec2, Vec3, lifted};
use crate::photon::Photon;
use crate::photon::radius::{self, Place};
use crate::sampling::{CounterRng, warp};
use crate::scene::Scene;

/// Where a map is read.
#[derive(Clone, Copy, Debug)]
pub struct Sights<'a> {
    /// Where the camera's paths meet rough surfaces first, at film positions of a regular grid.
    pub places: &'a [Place],
    /// Pixels from one to the next.
    pub apart: f32,
    /// The map is read there.
    pub first: bool,
    /// The map is read where paths go from there.
    pub second: bool,
    /// Direct light is there besides what the map holds.
    pub direct: bool,
}

/// A disc that stands for part of the picture.
#[derive(Clone, Copy, Debug)]
struct Spot {
    p: Vec3,
    n: Vec3,
    radius: f32,
    /// Irradiance by direct light, its strongest channel.
    direct: f32,
}

/// Discs around the places where a map is read, which are found by a grid.
#[derive(Debug)]
pub(super) struct Discs {
    spots: Vec<Spot>,
    cells: HashMap<[i32; 3], Vec<u32>>,
    size: f32,
    /// Around most of what the camera sees.
    pub around: SceneSphere,
}

/// A disc is at most this many times as wide as the median one.
const WIDEST: f32 = 2.0;

/// Lamp points that tell how much direct light a place gets.
const LOOKS: usize = 8;

/// No place is darker than this share of the mean: the error of what is black does not matter.
const DARKEST: f64 = 0.1;

impl Discs {
    pub fn new(scene: &Scene, sights: &Sights<'_>) -> Self {
        let mut rng = CounterRng::new(0x5ee4, 0);
        let mut spots: Vec<Spot> = Vec::new();
        for place in sights.places {
            let radius = 0.75 * place.footprint * sights.apart;
            let spot = Spot { p: place.p, n: place.n, radius, direct: 0.0 };
            if sights.first {
                spots.push(spot);
            }
            if sights.second {
                spots.extend(beyond(scene, place, Vec2::from(rng.next_2d())));
            }
        }
        spots.retain(|s| s.radius > 0.0 && s.radius.is_finite() && s.p.is_finite());
        let mut radii: Vec<f32> = spots.iter().map(|s| s.radius).collect();
        let size = radius::quantile(&mut radii, 0.5).map_or(1.0, |median| WIDEST * median);
        let mut cells: HashMap<[i32; 3], Vec<u32>> = HashMap::new();
        for (spot, i) in spots.iter_mut().zip(0..) {
            spot.radius = spot.radius.min(size);
            let [low, high] = [-spot.radius, spot.radius].map(|r| cell(spot.p + r, size));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        cells.entry([x, y, z]).or_default().push(i);
                    }
                }
            }
            if sights.direct {
                spot.direct = direct_light(scene, spot, &mut rng);
            }
        }
        Self { spots, cells, size, around: radius::around(sights.places) }
    }

    /// Whether the map is read nowhere, as far as is known: photons are worth the same everywhere then.
    pub fn is_empty(&self) -> bool {
        self.spots.is_empty()
    }

    /// Calls `found` with the number of each disc that the photon lies on.
    pub fn each(&self, photon: &Photon, mut found: impl FnMut(u32)) {
        let Some(near) = self.cells.get(&cell(photon.p, self.size)) else { return };
        for &i in near {
            let spot = &self.spots[i as usize];
            let off = photon.p - spot.p;
            if off.length_squared() < spot.radius * spot.radius
                && off.dot(spot.n).abs() < 0.25 * spot.radius
                && spot.n.dot(photon.n) > 0.5
            {
                found(i);
            }
        }
    }

    /// By disc: what the square of a photon's flux is worth, from the flux that lands on the disc. An estimate of small
    /// radius r has the variance flux²/(π²·r²·R²) from a photon somewhere on a disc of radius R; what counts is this over
    /// the square of the irradiance.
    pub fn worth(&self, landed: &[f64]) -> Vec<f64> {
        let area = |s: &Spot| std::f64::consts::PI * f64::from(s.radius).powi(2);
        let light = self.spots.iter().zip(landed).map(|(s, flux)| f64::from(s.direct) + flux / area(s));
        let light: Vec<f64> = light.collect();
        let least = DARKEST * light.iter().sum::<f64>() / light.len().max(1) as f64;
        let worth = |(s, light): (&Spot, &f64)| {
            let light = light.max(least);
            if light > 0.0 { (light * f64::from(s.radius)).powi(-2) } else { 0.0 }
        };
        self.spots.iter().zip(&light).map(worth).collect()
    }

    /// How many discs there are.
    pub fn len(&self) -> usize {
        self.spots.len()
    }
}

fn cell(p: Vec3, size: f32) -> [i32; 3] {
    // Numbers beyond the range of i32 end at its limits.
    (p / size).floor().to_array().map(|x| (x as i32).clamp(-(1 << 30), 1 << 30))
}

/// Where a diffuse ray from a place lands: a disc as wide as a tenth of its way.
fn beyond(scene: &Scene, place: &Place, u: Vec2) -> Option<Spot> {
    let d = Frame::from_normal(place.n).to_world(warp::cosine_hemisphere(u));
    let ray = Ray::new(place.p + place.n * place.lift, d);
    let hit = scene.geometry.closest(&ray)?;
    let s = scene.surface(&ray, &hit);
    let n = scene.photon_side(&s, -d).n;
    Some(Spot { p: s.p, n, radius: 0.1 * hit.t, direct: 0.0 })
}

fn direct_light(scene: &Scene, spot: &Spot, rng: &mut CounterRng) -> f32 {
    let o = lifted(spot.p, spot.n);
    let one = |_| {
        let (pick, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
        let light = scene.sample_direct(spot.p, pick, u)?;
        let value = light.value.max_element() * light.dir.dot(spot.n);
        (value > 0.0 && value.is_finite() && !scene.geometry.occluded(&light.ray_from(o))).then_some(value)
    };
    (0..LOOKS).filter_map(one).sum::<f32>() / LOOKS as f32
}
