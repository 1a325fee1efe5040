//! Laws that every lamp and every shape obeys: rays that look for light and photons that leave it tell
//! of the same light.

mod direct;
mod lamps;

use caustica::math::{Color, Frame, Ray, Vec3};
use caustica::sampling::{CounterRng, warp};
use caustica::scene::{Scene, Surface};

use crate::support::{Stage, camera, pbrt_scene, picture, scene_with_bytes};

/// What the cases refer to.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let sky = picture(8, |x, y| [x as f32 * 0.2, 0.4, if (x, y) == (5, 1) { 20.0 } else { 0.1 }], 4);
    let square = picture(4, |x, y| [0.2 + x as f32, 0.5 + y as f32, 0.3], 4);
    let mesh = "v 0 0 0\nv 2 0.3 0.1\nv 0.2 1 0.4\nv 1.5 1.2 1.1\nv 0.4 0.1 0.9\nvt 0 0\nvt 1 0\nvt 0 1\n\
                vt 1 1\nvt 0.5 0.2\nf 1/1 2/2 3/3\nf 2/2 4/4 3/3\nf 1/1 5/5 2/2\n";
    vec![("sky.pfm", sky), ("square.pfm", square), ("mesh.obj", mesh.as_bytes().to_vec())]
}

fn mitsuba(body: &str) -> Stage {
    scene_with_bytes(&format!("{}{body}", camera("0,0,9", "0,0,0", 40.0, 4)), files())
}

fn pbrt(world: &str) -> Stage {
    pbrt_scene(world, files())
}

/// The surfaces along a line, one after the other.
fn crossings(scene: &Scene, mut ray: Ray, mut see: impl FnMut(&Surface)) {
    // More than any shape here has.
    for _ in 0..100 {
        let Some(hit) = scene.geometry.closest(&ray) else { return };
        let s = scene.surface(&ray, &hit);
        see(&s);
        ray = s.leave(ray.d);
    }
    panic!("a line does not leave the scene");
}

/// One of the lines through a sphere that are evenly spread in direction and across it.
fn line(rng: &mut CounterRng, center: Vec3, radius: f32) -> Ray {
    let d = warp::sphere(rng.next_2d().into());
    let across = warp::disk(rng.next_2d().into()) * radius;
    let frame = Frame::from_normal(d);
    Ray::new(center + frame.to_world(Vec3::new(across.x, across.y, -radius)), d)
}

/// A mean of many values with its standard error.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    n: f64,
    sum: f64,
    square: f64,
}

impl Tally {
    fn add(&mut self, x: f64) {
        self.n += 1.0;
        self.sum += x;
        self.square += x * x;
    }

    fn mean(&self) -> f64 {
        self.sum / self.n
    }

    fn sigma(&self) -> f64 {
        ((self.square / self.n - self.mean().powi(2)).max(0.0) / self.n).sqrt()
    }
}

/// Two estimates of one number, with 4.5 sigma of their measured noise and what f32 rounds (1e-4: normals
/// and lifts of small lamps).
#[track_caller]
fn same(what: &str, a: Tally, b: Tally) {
    let sigma = a.sigma().hypot(b.sigma());
    let off = (a.mean() - b.mean()).abs();
    let bound = crate::support::SIGMAS * sigma + 1e-4 * b.mean().abs();
    assert!(off <= bound, "{what}: {} against {} with sigma {sigma}", a.mean(), b.mean());
    assert!(sigma <= 0.05 * b.mean().abs(), "{what}: {} is too noisy: {sigma}", b.mean());
}

fn green(light: Color) -> f64 {
    f64::from(light.lanes()[1])
}
