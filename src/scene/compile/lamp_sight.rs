//! How much of the light of each lamp arrives where the camera looks. Surfaces compare a point of each of a few lamps as if
//! nothing stood between: without this, a sky would outshine the lamps of a room that it never enters.

use crate::math::Vec2;
use crate::sampling::{CounterRng, mix};
use crate::scene::{LampChoice, Scene, View};
use crate::spectrum::luminance;

/// Places on a side of the picture.
const SIDE: u32 = 24;

/// Of the irradiance that each lamp would bring to what the camera sees first were nothing in its way, the share that
/// arrives.
pub(super) fn shares(scene: &Scene, view: &View) -> [f32; LampChoice::FEW] {
    let mut sums = [[0.0f64; 2]; LampChoice::FEW];
    for cell in 0..SIDE * SIDE {
        let mut rng = CounterRng::new(mix(0x1a_3b51), u64::from(cell));
        let within = Vec2::new((cell % SIDE) as f32, (cell / SIDE) as f32) + Vec2::from(rng.next_2d());
        let ray = view.sensor.ray(view.place_in_crop(within / SIDE as f32), Vec2::splat(0.5));
        let Some(hit) = scene.geometry.closest(&ray) else { continue };
        let s = scene.surface(&ray, &hit);
        for (lamp, sums) in sums.iter_mut().enumerate().take(scene.emitters.len()) {
            let Some(light) = scene.sample_lamp(lamp, s.p, Vec2::from(rng.next_2d())) else { continue };
            // What lies behind the surface is not wanted there.
            let same_side = s.ng.dot(light.dir) * s.ng.dot(ray.d) < 0.0;
            let light_there = f64::from(luminance(light.value) * s.ng.dot(light.dir).abs());
            if !same_side || !light_there.is_finite() {
                continue;
            }
            let shadow = light.ray_from(s.origin(light.dir));
            sums[0] += light_there;
            sums[1] += if scene.geometry.occluded(&shadow) { 0.0 } else { light_there };
        }
    }
    sums.map(|[all, seen]| if all > 0.0 { (seen / all) as f32 } else { 1.0 })
}
