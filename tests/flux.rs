//! Energy: what lamps emit is stored, absorbed or has left; nothing else happens to it.

use caustica::emitter::Aim;
use caustica::math::{Color, Vec3};
use caustica::photon::aim::{Sights, aim};
use caustica::photon::radius::Place;
use caustica::photon::trace::{Halt, TraceJob, Traced, trace, trace_until};
use caustica::sampling::Sampler;
use caustica::scene::Scene;
use caustica::spectrum::rgb;
use caustica::transport::Owner;

use crate::support::{
    DOWN, SIGMAS, Stage, UP, area, camera, diffuse, pbrt_scene, rectangle, room_with_window, scene, sphere,
};

fn job(key: u64, paths: u64, max_depth: u32) -> TraceJob {
    TraceJob {
        beams: false,
        all: false,
        glints: false,
        focused: false,
        key,
        paths,
        owner: Owner::GlobalMap,
        next_event: false,
        caustic_map: false,
        glossy: 0.2,
        max_depth,
    }
}

/// Mean stored flux of `jobs` independent traces, so that not all photons are in memory together.
fn stored(scene: &Scene, jobs: u64, paths: u64, max_depth: u32) -> f64 {
    let flux = |key| -> f64 {
        trace(scene, &job(key, paths, max_depth)).photons.iter().map(|p| f64::from(p.flux.lanes()[1])).sum()
    };
    (0..jobs).map(flux).sum::<f64>() / jobs as f64
}

fn closed(albedo: &str, lamp: &str) -> Stage {
    let room =
        format!("<shape type='cube'><boolean name='flip_normals' value='true'/>{}</shape>", diffuse(albedo));
    scene(&format!("{}{room}{lamp}", camera("0,0,0", "0,0,1", 40.0, 4)))
}

const POINT: &str = "<emitter type='point'><point name='position' value='0.3,0.2,-0.4'/><rgb name='intensity' value='2'/></emitter>";

/// Every path of a closed box ends on its walls: the first hits carry all power. The only error is the
/// f32 sum of 2¹⁷ equal fluxes, done here in f64: a part in 10⁶.
#[test]
fn first_hits_in_a_closed_box_carry_all_emitted_power() {
    for lamp in [POINT.to_owned(), rectangle(0.3, &format!("{DOWN}<translate y='0.9'/>"), &area("3"))] {
        let scene = closed("0.5", &lamp);
        let ratio = stored(&scene, 1, 1 << 17, 2) / f64::from(scene.power().lanes()[1]);
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    }
}

/// Each hit absorbs 1 − ρ, so all hits together store Φ/(1 − ρ): "emitted minus absorbed" holds within
/// 0.1 %. A path makes a geometric number of hits, whose relative deviation is √ρ: for ρ = 0.2 and
/// 4.2 million paths one sigma is 0.022 %, and the bound is 4.6 of them.
#[test]
fn stored_flux_is_emitted_flux_minus_what_was_absorbed() {
    let scene = closed("0.2", POINT);
    let ratio = stored(&scene, 16, 1 << 18, u32::MAX) / f64::from(scene.power().lanes()[1]) * 0.8;
    println!("stored · (1 − ρ) / emitted: {ratio:.6}");
    assert!((ratio - 1.0).abs() < 0.001, "{ratio}");
}

/// The same with surfaces that absorb nothing in the way: light inside glass, and between mirrors, still
/// ends on the walls. Here hits vary with geometry too; 2.1 million paths at ρ = 0.2 leave 0.04 % noise,
/// and the bound is 4.5 of it. Mirror and glass lose only what f32 rounding loses.
#[test]
fn mirrors_and_glass_lose_no_flux() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let mirror = "<bsdf type='conductor'><string name='material' value='none'/></bsdf>";
    let inside = [POINT.to_owned(), sphere("-0.5,-0.5,0", 0.4, glass), sphere("0.5,-0.5,0", 0.4, mirror)];
    let scene = closed("0.2", &inside.concat());
    let ratio = stored(&scene, 8, 1 << 18, u32::MAX) / f64::from(scene.power().lanes()[1]) * 0.8;
    println!("stored · (1 − ρ) / emitted with glass and mirror: {ratio:.6}");
    assert!((ratio - 1.0).abs() < 0.0018, "{ratio}");
}

/// Mean flux over 2¹⁶ stratified light paths against the power.
fn emitted(scene: &Scene) -> Color {
    let n = 1 << 16;
    let mut sum = [0.0f64; 3];
    for i in 0..n {
        let mut sampler = Sampler::new(11, i);
        let (pick, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
        if let Some(e) = scene.sample_emission(pick, place, direction) {
            (0..3).for_each(|c| sum[c] += f64::from(e.emission.flux.lanes()[c]));
        }
    }
    rgb(sum.map(|s| (s / f64::from(n)) as f32))
}

#[test]
fn emission_samples_add_up_to_the_power_of_every_lamp() {
    let spot =
        "<emitter type='spot'><rgb name='intensity' value='2,1,0.5'/><float name='cutoff_angle' value='35'/>
                <float name='beam_width' value='10'/></emitter>";
    let sun = "<emitter type='directional'><vector name='direction' value='0,-1,0'/><rgb name='irradiance' value='1,2,3'/></emitter>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='0.3,0.2,0.1'/></emitter>";
    let checks = "<emitter type='area'><texture name='radiance' type='checkerboard'>
                  <rgb name='color0' value='0.2'/><rgb name='color1' value='0.9'/></texture></emitter>";
    let panel = rectangle(0.3, &format!("{DOWN}<translate y='0.9'/>"), &area("3,1,2"));
    let disk = format!("<shape type='disk'>{}</shape>", area("3"));
    let tube = format!("<shape type='cylinder'>{}</shape>", area("2"));
    // Lamps whose samples all carry the same power have no error but rounding; the falloff of a spot and
    // the checks are piecewise smooth in two stratified numbers (error below 2⁻⁸ of their spread); the
    // choice among lamps is stratified in one number (2⁻¹⁶ each).
    let projector = "<emitter type='projector'><float name='fov' value='50'/><rgb name='irradiance' value='2,1,3'/></emitter>";
    let beam = rectangle(
        0.3,
        DOWN,
        "<emitter type='directionalarea'><rgb name='radiance' value='1,2,3'/></emitter>",
    );
    let rows: [(&str, Vec<&str>, f32); 11] = [
        ("projector", vec![projector], 1e-5),
        ("directionalarea", vec![&beam], 1e-5),
        ("point", vec![POINT], 1e-5),
        ("spot", vec![spot], 1e-3),
        ("directional", vec![sun], 1e-5),
        ("constant", vec![sky], 1e-5),
        ("panel", vec![&panel], 1e-5),
        ("disk", vec![&disk], 1e-5),
        ("cylinder", vec![&tube], 1e-5),
        ("several", vec![POINT, spot, sun, &panel, &disk], 1e-3),
        ("textured", vec![], 4e-3),
    ];
    let textured = rectangle(0.3, "", checks);
    for (name, mut lamps, bound) in rows {
        if lamps.is_empty() {
            lamps.push(&textured);
        }
        let floor = sphere("0,0,0", 1.0, "");
        let scene = scene(&format!("{}{floor}{}", camera("0,0,4", "0,0,0", 40.0, 4), lamps.concat()));
        let (got, power) = (emitted(&scene), scene.power());
        println!("{name}: {got} of {power}");
        assert!(((got - power) / power).abs().max_element() < bound, "{name}: {got} against {power}");
    }
}

/// A unit sphere stretched to twice its length: 2π(1 + 2·asin(e)/e) with e = √¾; facets lose 2.7e-4. Of pbrt, since
/// Mitsuba's spheres stay round.
#[test]
fn a_stretched_sphere_shines_by_its_area() {
    let lamp = "AttributeBegin\nScale 2 1 1\nAreaLightSource \"diffuse\" \"rgb L\" [ 3 3 3 ]\nShape \"sphere\"\nAttributeEnd";
    let scene = pbrt_scene(lamp, vec![]);
    let (e, pi) = (0.75f64.sqrt(), std::f64::consts::PI);
    let power = 3.0 * pi * 2.0 * pi * (1.0 + 2.0 * e.asin() / e);
    let ratio = f64::from(scene.power().lanes()[1]) / power;
    assert!((ratio - 1.0).abs() < 3e-4, "{ratio}");
    // Seen from outside it is bright, in the middle of the film.
    let film = &scene.0.view.film;
    let seen = crate::support::render(&scene, &[("max_depth", "1")], 4);
    let middle = seen.pixel((film.height / 2 * film.width + film.width / 2) as usize)[0];
    assert!((middle / 3.0 - 1.0).abs() < 1e-6, "{middle}");
}

/// Sun and sky through a window of 1 % of the ceiling: aimed light leaves as much in the room as light that is sent
/// everywhere, in many more photons.
#[test]
fn light_aimed_through_a_window_is_not_more() {
    let room = room_with_window(0.1, "0.5");
    let lights = "<emitter type='constant'/><emitter type='directional'><vector name='direction' value='0.2,0.1,-1'/>\
                  <rgb name='irradiance' value='5'/></emitter>";
    let scene = scene(&format!("{}{room}{lights}", camera("0,0,0", "0,1,0", 40.0, 4)));
    let job = |key, paths| TraceJob { next_event: true, ..job(key, paths, u32::MAX) };
    // Nothing tells where the map is read: photons count alike.
    let aim = aimed(&scene, &job(7, 1 << 17), &[]).expect("few paths find the window");
    let stored = |aim, traces: u64| {
        let flux = |key| brought(&scene, &job(key, 1 << 20), aim, |_| true);
        mean((0..traces).map(flux).collect())
    };
    let (even, even_error, few) = stored(None, 16);
    let (aimed, aimed_error, many) = stored(Some(&aim), 4);
    println!(
        "even {even:.4} ± {even_error:.4} in {few} photons, aimed {aimed:.4} ± {aimed_error:.4} in {many}"
    );
    assert!(many > 50.0 * few);
    assert!((aimed - even).abs() < SIGMAS * even_error.hypot(aimed_error));
}

/// How paths start for a map that is read at `places`, which stand for pixels of the size 0.1.
fn aimed(scene: &Scene, job: &TraceJob, places: &[Place]) -> Option<Aim> {
    let sights = Sights { places, apart: 1.0, first: true, second: false, direct: true };
    aim(scene, job, &sights, Halt::default())
}

/// Flux and number of the photons of a trace that land where `counts` says.
fn brought(scene: &Scene, job: &TraceJob, aim: Option<&Aim>, counts: impl Fn(Vec3) -> bool) -> [f64; 2] {
    let Traced { photons, .. } = trace_until(scene, job, aim, Halt::default());
    let found = photons.iter().filter(|p| counts(p.p));
    found.fold([0.0, 0.0], |[flux, n], p| [flux + f64::from(p.flux.lanes()[1]), n + 1.0])
}

/// Mean flux, its standard error, and the mean number of photons.
fn mean(traces: Vec<[f64; 2]>) -> (f64, f64, f64) {
    let n = traces.len() as f64;
    let [flux, photons] = [0, 1].map(|i| traces.iter().map(|t| t[i]).sum::<f64>() / n);
    let square = traces.iter().map(|t| (t[0] - flux).powi(2)).sum::<f64>() / (n - 1.0);
    (flux, (square / n).sqrt(), photons)
}

const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

/// Places all over the square of the half side `half` on the floor, around `center`.
fn floor_places(center: Vec3, half: f32) -> Vec<Place> {
    let at = |i: u32| ((i as f32 + 0.5) / 8.0 - 1.0) * half;
    let place = |i: u32| {
        let p = center + Vec3::new(at(i % 16), 0.0, at(i / 16));
        Place { p, n: Vec3::Y, lift: 1e-6, footprint: 0.15 * half }
    };
    (0..256).map(place).collect()
}

/// A ball of glass of a tenth of the floor, five times as far from the lamp as the floor is wide. Aimed light brings
/// as much through it as light that is sent everywhere, in over a hundred times as many photons a path; lamps of every kind
/// that has a heading of its own.
#[test]
fn light_that_heads_for_a_small_ball_is_not_more() {
    let floor = rectangle(0.5, UP, &diffuse("0.5"));
    let ball = sphere("0,0.05,0", 0.05, GLASS);
    let down = "<transform name='to_world'><lookat origin='0,5,0' target='0,0,0' up='1,0,0'/></transform>";
    let panel = rectangle(0.3, "<lookat origin='0,5,0' target='0,0,0' up='1,0,0'/>", &area("3"));
    let lamps = [
        "<emitter type='point'><point name='position' value='0,5,0'/></emitter>".to_owned(),
        format!("<emitter type='spot'><float name='cutoff_angle' value='20'/>{down}</emitter>"),
        panel,
    ];
    for lamp in lamps {
        let scene = scene(&format!("{}{floor}{ball}{lamp}", camera("0,0.3,0.5", "0,0,0", 20.0, 4)));
        let job = |key, paths| TraceJob {
            beams: false,
            owner: Owner::CausticMap,
            next_event: true,
            caustic_map: true,
            ..job(key, paths, u32::MAX)
        };
        let center = -Vec3::from(scene.origin.map(|x| x as f32));
        let places = floor_places(center, 0.2);
        let aim = aimed(&scene, &job(7, 1 << 17), &places).expect("few paths find the ball");
        let stored = |aim, traces: u64, paths| {
            mean((0..traces).map(|key| brought(&scene, &job(key, paths), aim, |_| true)).collect())
        };
        let (even, even_error, few) = stored(None, 32, 1 << 18);
        let (aimed, aimed_error, many) = stored(Some(&aim), 16, 1 << 14);
        println!(
            "even {even:.4e} ± {even_error:.1e} in {few}, aimed {aimed:.4e} ± {aimed_error:.1e} in {many}"
        );
        assert!(many / f64::from(1 << 14) > 100.0 * few / f64::from(1 << 18), "{lamp}");
        assert!((aimed - even).abs() < SIGMAS * even_error.hypot(aimed_error), "{lamp}");
        assert!(aimed_error < 0.05 * aimed, "{lamp}");
    }
}

/// Half of the metal is a mirror, where photons are of no use. The density next to it would be too low without them:
/// so each half takes as many (4.5 sigmas of a share of ½).
#[test]
fn a_surface_that_is_rough_in_places_takes_photons_everywhere() {
    let alpha = "<texture type='checkerboard' name='alpha'><float name='color0' value='0.001'/><float name='color1' \
                 value='0.5'/></texture>";
    let metal = format!("<bsdf type='roughconductor'>{alpha}</bsdf>");
    let sun = "<emitter type='directional'><vector name='direction' value='0,0,-1'/></emitter>";
    let scene = scene(&format!("{}{}{sun}", camera("0,0,3", "0,0,0", 40.0, 4), rectangle(1.0, "", &metal)));
    let photons = trace(&scene, &job(3, 1 << 16, 2)).photons;
    let cell = |x: f32| (x > 0.0) as u32;
    let even = photons.iter().filter(|p| (cell(p.p.x) + cell(p.p.y)).is_multiple_of(2)).count() as f64;
    let all = photons.len() as f64;
    assert!(all > 30_000.0, "{all}");
    assert!((even / all - 0.5).abs() < 4.5 * 0.5 / all.sqrt(), "{even} of {all}");
}
