//! Photon mapping in media: the pictures of path tracing, layer by layer, and the power that photons carry.

use caustica::film::Layer;
use caustica::integrator::photon_map::decided;
use caustica::photon::trace::{TraceJob, Traced, trace};
use caustica::transport::Owner;

use super::{container, dense_fog, eye, fog, hg, vol};
use crate::support::{
    Stage, area, assert_agree, box_camera, diffuse, lamp, rectangle, render, scene, scene_with_bytes, sphere,
    walls,
};

/// Layers of both, and their sum; `bounds` by layer. Kernels blur over borders, and lose what is beyond: so the radius is
/// a hundredth of the box.
fn agree(stage: &Stage, ways: &[(&str, &str)], passes: [u32; 2], bounds: &[(Layer, f64)], sum: f64) {
    let path = render(stage, &[("integrator", "path")], passes[1]);
    for &(key, value) in ways {
        let mapped = render(stage, &[(key, value), ("volume_radius", "0.01")], passes[0]);
        for channel in 0..3 {
            for &(layer, bound) in bounds {
                let what = format!("{key}={value}, {layer:?}, {channel}");
                let expected = path.estimate(&[layer], channel);
                assert_agree(&what, mapped.estimate(&[layer], channel), expected, bound);
            }
            let what = format!("{key}={value}, sum, {channel}");
            assert_agree(&what, mapped.beauty(channel), path.beauty(channel), sum);
        }
    }
}

const FOG: &str = "0.2,0.5,0.9";

/// A Cornell box in coloured fog that scatters forwards.
#[test]
fn fog_in_a_box_is_that_of_path_tracing() {
    let inside = fog("interior", FOG, "0.9,0.9,0.5", &hg(0.5));
    let body = [box_camera(16), walls("0.7,0.7,0.7"), lamp(0.25, "15,12,8")].concat();
    let stage = scene(&(body + &container("<scale value='1.001'/>", &inside)));
    let bounds = [(Layer::Direct, 0.01), (Layer::Indirect, 0.08), (Layer::Medium, 0.05)];
    let ways = [("beams", "points"), ("beams", "beams")];
    agree(&stage, &ways, [128, 2048], &bounds, 0.045);
}

/// Light through a ball of glass, focused in the fog and on the floor behind it.
#[test]
fn caustics_in_fog_are_those_of_path_tracing() {
    let medium = |name| fog(name, "0.3,0.3,0.3", "0.9,0.9,0.9", "");
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let ball = sphere("0,0.1,0", 0.4, &format!("{glass}{}", medium("exterior")));
    let body = [box_camera(16), walls("0.7,0.7,0.7"), lamp(0.4, "5,5,5"), ball].concat();
    let stage = scene(&(body + &container("<scale value='1.001'/>", &medium("interior"))));
    // Written in two places, it is one medium: nothing to warn about.
    assert!(stage.0.warnings().is_empty(), "{}", stage.0.warnings());
    let bounds = [(Layer::Caustic, 0.1), (Layer::Medium, 0.04)];
    agree(&stage, &[("beams", "points"), ("beams", "beams")], [128, 4096], &bounds, 0.03);
}

/// A drop of milk, whose light scatters hundreds of times.
#[test]
fn milk_is_that_of_path_tracing() {
    let milk = dense_fog("interior", 20.0, "0.999,0.99,0.95", "");
    let drop = sphere("0,-0.3,0", 0.6, &format!("<bsdf type='null'/>{milk}"));
    let body = [box_camera(16), walls("0.7,0.7,0.7"), lamp(0.25, "15,15,15"), drop].concat();
    let stage = scene(&body);
    agree(&stage, &[("beams", "points"), ("beams", "beams")], [64, 2048], &[(Layer::Medium, 0.07)], 0.02);
}

/// A cube of dense fog, seen and lit from all sides at a slant, with kernels a quarter of a mean free path wide. Half of
/// a kernel's disc reaches over the border where the border is not across the ray; were that half lost, the light of the
/// medium would be 4 % too dark.
#[test]
fn boundaries_at_a_slant_keep_their_light() {
    let fog = dense_fog("interior", 10.0, "0.99,0.99,0.99", "");
    let turned = "<scale value='0.5'/><rotate x='1' y='2' z='0.5' angle='50'/>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
    let stage = scene(&[eye("0,0,-4", 25.0, 12, ""), sky.to_owned(), container(turned, &fog)].concat());
    let path = render(&stage, &[("integrator", "path")], 2048).estimate(&[Layer::Medium], 1);
    for beams in ["points", "beams"] {
        let fixed = [
            ("beams", beams),
            ("volume_radius", "0.025"),
            ("volume_alpha", "0.999"),
            ("volume_photons", "30000"),
        ];
        let mapped = render(&stage, &fixed, 96).estimate(&[Layer::Medium], 1);
        assert_agree(beams, mapped, path, 0.025);
    }
}

/// Lamps that say nothing of what they stand in: one that reaches through the border of the fog, and a point within it.
/// Were light to start in vacuum there, or in fog outside, the layer would be off by tens of percent.
#[test]
fn light_starts_in_what_its_place_is_in() {
    let tall = "<scale x='0.2' y='1.6' z='1'/><translate y='0.9'/>";
    let reaching = rectangle(1.0, tall, &format!("{}{}", area("3"), diffuse("0,0,0")));
    let point = "<emitter type='point'><point name='position' value='0.3,0.2,0.4'/>
                 <rgb name='intensity' value='2,2,2'/></emitter>";
    for (what, lamp) in [("a lamp through the border", &*reaching), ("a point within", point)] {
        let medium = fog("interior", "1.5,1.5,1.5", "0.95,0.95,0.95", "");
        let stage = scene(&[&eye("0.2,0.3,-5", 35.0, 12, ""), lamp, &container("", &medium)].concat());
        let path = render(&stage, &[("integrator", "path")], 24576).estimate(&[Layer::Medium], 1);
        for beams in ["points", "beams"] {
            let mapped = render(&stage, &[("beams", beams), ("volume_radius", "0.05")], 320);
            assert_agree(&format!("{what}, {beams}"), mapped.estimate(&[Layer::Medium], 1), path, 0.03);
        }
    }
}

/// Fog without end lets nothing through from infinity. A cube with air in it, which the sky is not in either, changes
/// nothing.
#[test]
fn endless_fog_hides_the_sky() {
    let medium = |name| fog(name, "0.3,0.3,0.3", "0.9,0.9,0.9", "");
    let sky = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
    let floor = rectangle(2.0, "<rotate x='1' angle='-90'/>", &diffuse("0.5,0.5,0.5"));
    let camera = eye("0,1,-4", 45.0, 12, &medium("medium"));
    let air = container("<scale value='0.3'/><translate y='0.5'/>", &medium("exterior"));
    for more in ["", &*air] {
        let stage = scene(&[&camera, sky, &floor, more].concat());
        for integrator in ["path", "photonmap"] {
            let picture = render(&stage, &[("integrator", integrator)], 4);
            assert!(picture.beauty(1).mean == 0.0, "{integrator}: {:?}", picture.beauty(1));
        }
    }
}

/// A cube of fog on a floor of a kilometre under the sun: of a million light paths over all of the disk four meet the
/// cube. They are sent there, and the light that the fog scatters again and again is not lost. The floor is black: from
/// afar it would send the fog few photons that carry much.
#[test]
fn fog_on_a_vast_floor_is_lit() {
    let floor = rectangle(500.0, "<rotate x='1' angle='-90'/><translate y='-1.05'/>", &diffuse("0,0,0"));
    let sun = "<emitter type='directional'><vector name='direction' value='1,-1,0.5'/>
               <rgb name='irradiance' value='3,3,3'/></emitter>";
    let medium = fog("interior", "0.9,0.9,0.9", "0.95,0.95,0.95", "");
    let stage = scene(&[eye("0,0,-6", 25.0, 16, ""), floor, sun.to_owned(), container("", &medium)].concat());
    let path = render(&stage, &[("integrator", "path")], 512);
    for kind in ["points", "beams"] {
        let set = [("beams", kind), ("volume_radius", "0.05")];
        let mapped = render(&stage, &set, 32);
        let what = format!("{kind} on a vast floor");
        let layer = [Layer::Medium];
        assert_agree(&what, mapped.estimate(&layer, 0), path.estimate(&layer, 0), 0.05);
    }
}

/// Three lamps in three foggy rooms: nearly all light paths start in the one that is seen.
#[test]
fn light_paths_in_fog_start_where_they_are_seen() {
    let fog = |name| fog(name, "0.3,0.3,0.3", "0.9,0.9,0.9", "");
    let rooms = "<scale x='9' y='1' z='1'/>";
    let gray = format!("<bsdf type='twosided'>{}</bsdf>", diffuse("0.5,0.5,0.5"));
    let shell = format!(
        "<shape type='cube'><transform name='to_world'>{rooms}</transform>{gray}{}</shape>",
        fog("interior")
    );
    let wall = |x: &str| rectangle(1.0, &format!("<rotate y='1' angle='90'/><translate x='{x}'/>"), &gray);
    let lamp = |x: &str| {
        format!(
            "<emitter type='point'><point name='position' value='{x},0.5,0'/>
             <rgb name='intensity' value='9,9,9'/>{}</emitter>",
            fog("medium")
        )
    };
    let parts = [
        eye("0,0,-0.9", 60.0, 16, &fog("medium")),
        shell,
        wall("-3"),
        wall("3"),
        lamp("-6"),
        lamp("0"),
        lamp("6"),
    ];
    let volume = decided(scene(&parts.concat()).0.task()).volume.expect("photons in fog");
    let aim = volume.aim.expect("a third of the paths start in the room");
    assert!(aim.landing > 0.25, "{aim:?}");
    // All but the even share of the paths, which is a fifth: 1 − 0.2·2/3 of them, over a third, is 2.6.
    assert!(matches!(aim.lamps[..], [(1, times)] if times > 2.4), "{aim:?}");
}

/// Smoke in a grid of colours that differ: flights change their colours on the way.
#[test]
fn smoke_in_a_grid_is_that_of_path_tracing() {
    let value = |at: [usize; 3], c: usize| ((at[0] * 5 + at[1] * 3 + at[2] * 7 + c * 2) % 7) as f32 / 7.0;
    let bytes = vol([6, 5, 7], 3, |at| (0..3).map(|c| value(at, c)).collect());
    let grid = "<volume type='gridvolume' name='sigma_t'><string name='filename' value='a.vol'/>
        <boolean name='raw' value='true'/>
        <transform name='to_world'><translate x='-0.5' y='-0.5' z='-0.5'/><scale value='1.6'/></transform></volume>";
    let medium = format!(
        "<medium type='heterogeneous' name='interior'>{grid}<float name='scale' value='4'/>
         <rgb name='albedo' value='0.9,0.8,0.7'/></medium>"
    );
    let body = [box_camera(16), walls("0.7,0.7,0.7"), lamp(0.25, "15,12,8")].concat();
    let stage =
        scene_with_bytes(&(body + &container("<scale value='0.8'/>", &medium)), vec![("a.vol", bytes)]);
    let ways = [("beams", "points"), ("beams", "beams"), ("indirect", "trace")];
    agree(&stage, &ways, [128, 2048], &[(Layer::Medium, 0.04)], 0.03);
}

/// Where nothing is absorbed and the sky shines with radiance 1, radiance is 1 everywhere. Kernels that reach over the
/// border find nothing beyond it: the box is large beside their radius.
#[test]
fn a_furnace_of_photons_is_even() {
    let sky = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
    let medium = |name| dense_fog(name, 0.7, "1,1,1", &hg(0.3));
    let body = [eye("0,0,0", 40.0, 8, &medium("medium")), sky.to_owned(), container("", &medium("interior"))];
    let stage = scene(&body.concat());
    for beams in ["points", "beams"] {
        for nee in ["true", "false"] {
            let settings =
                [("beams", beams), ("nee", nee), ("volume_radius", "0.05"), ("volume_photons", "20000")];
            let picture = render(&stage, &settings, 32);
            for channel in 0..3 {
                let exact = crate::support::Estimate::exact(1.0);
                assert_agree(&format!("{beams}, nee={nee}"), picture.beauty(channel), exact, 0.06);
            }
        }
    }
}

fn job(beams: bool) -> TraceJob {
    TraceJob {
        glints: false,
        focused: false,
        beams,
        all: false,
        key: 5,
        paths: 400_000,
        owner: Owner::VolumeMaps,
        next_event: false,
        caustic_map: true,
        glossy: 0.2,
        max_depth: u32::MAX,
    }
}

fn left(stage: &Stage, beams: bool) -> Traced {
    trace(&stage.0.scene, &job(beams))
}

/// In endless fog of albedo a, the light of a lamp is scattered a/(1 − a) times on average: photons at collisions carry
/// that many times its power, and so do beams times their length and σs. A path's photons carry its flux each, so that
/// the deviation of their number, with n/(1 − a)² at most, is 0.8 % of 0.25 for the darkest channel.
#[test]
fn photons_carry_the_power_that_is_scattered() {
    let albedo = [0.8f64, 0.5, 0.2];
    for (sigma, phase) in
        [("1,1,1", ""), ("0.3,0.6,1", "<phase type='hg'><float name='g' value='0.6'/></phase>")]
    {
        let medium = |name| fog(name, sigma, "0.8,0.5,0.2", phase);
        let point = format!(
            "<emitter type='point'><rgb name='intensity' value='1,1,1'/>{}</emitter>",
            medium("medium")
        );
        let floor = rectangle(0.01, "<translate z='500'/>", &diffuse("0.5,0.5,0.5"));
        let stage = scene(&[eye("0,0,-5", 40.0, 2, &medium("medium")), point, floor].concat());
        let power = 4.0 * std::f64::consts::PI;
        let (points, beams) = (left(&stage, false), left(&stage, true));
        assert!(points.beams.is_empty() && beams.points.is_empty());
        let sigma: Vec<f64> = sigma.split(',').map(|s| s.parse().unwrap()).collect();
        for c in 0..3 {
            let scattered = power * albedo[c] / (1.0 - albedo[c]);
            let of_points: f64 = points.points.iter().map(|p| f64::from(p.flux.lanes()[c])).sum();
            let of_beams: f64 =
                beams.beams.iter().map(|b| f64::from(b.flux.lanes()[c] * b.length)).sum::<f64>();
            let of_beams = of_beams * sigma[c] * albedo[c];
            println!("{c}: {:.4} {:.4}", of_points / scattered, of_beams / scattered);
            assert!((of_points / scattered - 1.0).abs() < 0.04, "points, {c}");
            assert!((of_beams / scattered - 1.0).abs() < 0.04, "beams, {c}");
        }
    }
}

/// Light straight from the lamp is left to shadow rays: what is kept with them and without differs by the first
/// scattering.
#[test]
fn shadow_rays_own_the_first_scattering() {
    let medium = |name| fog(name, "1,1,1", "0.8,0.5,0.2", "");
    let lamp = sphere("0,0,0", 0.1, &format!("{}{}", area("1,1,1"), medium("exterior")));
    let stage = scene(&[eye("0,0,-5", 40.0, 2, &medium("medium")), lamp].concat());
    for beams in [false, true] {
        let all = left(&stage, beams);
        let job = TraceJob { next_event: true, ..job(beams) };
        let rest = trace(&stage.0.scene, &job);
        let first = all.points.iter().filter(|p| p.depth == 1).count()
            + all.beams.iter().filter(|b| b.depth == 1).count();
        assert!(first > 100_000);
        assert_eq!(rest.points.len() + rest.beams.len() + first, all.points.len() + all.beams.len());
    }
}
