//! A light tracer made of the library's parts: emitters start its paths, the sensor says where they fall, the
//! film adds them. Its picture of direct light is the path tracer's.

use caustica::bsdf::{Range, Transport};
use caustica::film::{Layer, Pixels, SplatList, Splats};
use caustica::math::Ray;
use caustica::sampling::Sampler;
use caustica::transport::Vertex;

use crate::support::{
    Estimate, Picture, Stage, area, camera, diffuse, estimate, film, rectangle, render, scene, walls,
};

/// Light paths of a chunk.
const CHUNK: u64 = 2048;

/// Adds what one path brings from the lamps to the first surface and from there to the sensor.
fn trace(stage: &Stage, sampler: &mut Sampler, list: &mut SplatList) {
    let (scene, sensor) = (&stage.0.scene, &stage.0.view.sensor);
    let (pick, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
    let aperture = sampler.next_2d();
    let Some(start) = scene.sample_emission(pick, place, direction) else { return };
    let ray = Ray::new(start.emission.o, start.emission.d);
    let Some(hit) = scene.geometry.closest(&ray) else { return };
    let s = scene.surface(&ray, &hit);
    let vertex = Vertex::new(scene, &s, -ray.d);
    let Some(seen) = sensor.connect(s.p, aperture) else { return };
    let o = s.origin(seen.dir);
    if scene.geometry.occluded(&Ray { o, d: seen.target - o, tmax: 1.0 }) {
        return;
    }
    let wo = s.frame.to_local(seen.dir);
    let f = vertex.closure.eval(vertex.wi, wo, Transport::Importance, Range::ALL);
    let value = start.emission.flux * f * (seen.value * wo.z.abs());
    list.add(seen.importance.film, Layer::Direct, value);
}

fn light_traced(stage: &Stage, seed: u64, chunks: u64) -> Pixels {
    let view = &stage.0.view;
    let mut splats = Splats::new(view.film, &view.filter);
    splats.collect(chunks, |chunk, list| {
        for i in chunk * CHUNK..(chunk + 1) * CHUNK {
            trace(stage, &mut Sampler::new(seed, i as u32), list);
        }
    });
    assert_eq!(splats.rejected().total(), 0);
    let mut pixels = Pixels::new(view.film.pixel_count());
    splats.add_to(&mut pixels, chunks * CHUNK);
    pixels
}

const SIDE: u32 = 4;

/// The box, lit by a lamp, a point, a spot, the sun and the sky, through its open side.
fn lit_box(camera: &str) -> Stage {
    let point = "<emitter type='point'><point name='position' value='0.5,0.3,0.2'/><rgb name='intensity' value='0.3,0.2,0.1'/></emitter>";
    let spot = "<emitter type='spot'><rgb name='intensity' value='2'/><transform name='to_world'>
        <lookat origin='-0.5,0.6,0.7' target='0,-1,0' up='1,0,0'/></transform></emitter>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='0.2,0.3,0.4'/></emitter>";
    let sun = "<emitter type='directional'><vector name='direction' value='0.2,-0.3,-1'/><rgb name='irradiance' value='0.5'/></emitter>";
    // The lamp shines up, so that it hides nothing that it lights; the camera sees a black underside.
    let lamp = rectangle(
        0.3,
        "<rotate x='1' angle='-90'/><translate y='0.3'/>",
        &format!("{}{}", area("2"), diffuse("0")),
    );
    scene(&[camera, &walls("0.6"), &lamp, point, spot, sky, sun].concat())
}

fn sensors() -> [(&'static str, String); 3] {
    let film = film(SIDE, SIDE);
    let place = "<lookat origin='0.2,0.1,3.4' target='0,0,0' up='0,1,0.01'/>";
    let lens = format!(
        "<sensor type='thinlens'><float name='fov' value='34'/><float name='aperture_radius' value='0.15'/>
         <float name='focus_distance' value='3'/><transform name='to_world'>{place}</transform>{film}</sensor>"
    );
    let parallel = format!(
        "<sensor type='orthographic'><transform name='to_world'><scale x='0.9' y='0.8'/>{place}</transform>{film}</sensor>"
    );
    [
        ("perspective", camera("0.2,0.1,3.4", "0,0,0", 34.0, SIDE)),
        ("thinlens", lens),
        ("orthographic", parallel),
    ]
}

const RUNS: u64 = 16;

/// Every pixel of direct light, by 16 independent light tracings of 2¹⁷ paths (standard error 2 % at most, in the
/// darkest pixel) and 16 independent path tracings of 4096 samples a pixel (0.6 %): their difference is within 5 of its
/// standard errors, which 144 values of Student's distribution with about 15 degrees of freedom exceed once in 50 choices
/// of seeds.
#[test]
fn light_tracing_gives_the_direct_light_of_path_tracing() {
    for (what, camera) in sensors() {
        let stage = lit_box(&camera);
        let paths: Vec<_> = (0..RUNS)
            .map(|seed| {
                let changes = [("integrator", "path"), ("max_depth", "2"), ("seed", &seed.to_string())];
                render(&stage, &changes, 4096)
            })
            .collect();
        let runs: Vec<Pixels> = (0..RUNS).map(|seed| light_traced(&stage, 100 + seed, 64)).collect();
        for pixel in 0..(SIDE * SIDE) as usize {
            for channel in 0..3 {
                let of_path = |p: &Picture| p.pixels.layer(pixel, Layer::Direct, p.passes)[channel];
                let of_run = |run: &Pixels| run.layer(pixel, Layer::Direct, 1)[channel];
                let Estimate { mean: want, sigma: noise } =
                    estimate(&paths.iter().map(of_path).collect::<Vec<_>>());
                let Estimate { mean, sigma } = estimate(&runs.iter().map(of_run).collect::<Vec<_>>());
                assert!(
                    sigma < 0.04 * want && noise < 0.01 * want,
                    "{what}, pixel {pixel}: {mean} ± {sigma}, {want} ± {noise}"
                );
                assert!(
                    (mean - want).abs() < 5.0 * sigma.hypot(noise),
                    "{what}, pixel {pixel}: {mean} ± {sigma}, not {want} ± {noise}"
                );
            }
        }
    }
}

#[test]
fn light_tracing_has_the_same_bytes_on_any_number_of_threads() {
    let stage = lit_box(&sensors()[0].1);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| light_traced(&stage, 7, 150))
    };
    let one = run(1);
    assert!(one.beauty(0, 1)[0] > 0.0);
    assert!(one == run(2) && one == run(7));
}
