//! The estimator of indirect light that a pilot chooses.

use caustica::film::FilmSize;
use caustica::integrator::photon_map::decided;

use crate::media::{container, fog};
use crate::support::{
    Stage, area, box_camera, camera, diffuse, lamp, outcome, rectangle, room_with_window, scene, settings,
    sphere, walls,
};

const SIDE: usize = 48;

/// Pixels and counted work of a render.
fn rendered(scene: &Stage, changes: &[(&str, &str)], seed: &str) -> (Vec<f64>, f64) {
    let changes = [changes, &[("seed", seed)]].concat();
    let done = outcome(scene, &changes, 24, &mut |_| {});
    let sum = |pixel: usize| done.pixels.numbers(pixel)[..12].iter().sum::<f64>();
    let work = done.statistics.rays + done.statistics.lookups + done.statistics.photons_stored;
    ((0..done.pixels.len()).map(sum).collect(), work as f64)
}

/// Mean relative variance of single pixels and of squares of 4 × 4, told from two renders, times the work of one.
fn error(scene: &Stage, changes: &[(&str, &str)]) -> f64 {
    let [(a, work), (b, _)] = ["1", "2"].map(|seed| rendered(scene, changes, seed));
    let of = |width: usize| {
        let n = SIDE / width;
        let mean = |of: &[f64], i: usize| {
            let [x, y] = [i % n * width, i / n * width];
            let rows = (y..y + width).map(|y| of[y * SIDE + x..][..width].iter().sum::<f64>());
            rows.sum::<f64>()
        };
        let square = |i: usize| {
            let (a, b) = (mean(&a, i), mean(&b, i));
            if a + b > 0.0 { 2.0 * ((a - b) / (a + b)).powi(2) } else { 0.0 }
        };
        (0..n * n).map(square).sum::<f64>() / (n * n) as f64
    };
    (of(1) + 2.0 * of(4)) * work
}

/// Of what a pilot chooses, the same for both renders: another seed may choose otherwise where two are about as good.
fn chosen_error(scene: &Stage) -> f64 {
    let choice = decided(scene.0.task_with(&settings(scene, &[]))).indirect.expect("indirect light");
    let samples = choice.camera_samples.expect("a number of samples").to_string();
    let (rays, photons) = (choice.gather_rays.to_string(), choice.photons.to_string());
    let radius = if choice.shared { "auto" } else { "0" };
    let mut changes =
        vec![("indirect", &*choice.indirect), ("camera_samples", &samples), ("gather_radius", radius)];
    if choice.indirect != "trace" {
        changes.extend([("gather_rays", &*rays), ("photons", &*photons)]);
    }
    error(scene, &changes)
}

fn diffuse_room() -> Stage {
    scene(&[box_camera(SIDE as u32), walls("0.7"), lamp(0.4, "3")].concat())
}

/// A ball on a floor under an even sky.
fn open_ground() -> Stage {
    let floor = rectangle(8.0, "<rotate x='1' angle='-90'/><translate y='-0.6'/>", &diffuse("0.2"));
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    scene(&[box_camera(SIDE as u32), floor, sphere("0,0,0", 0.6, &diffuse("0.2")), sky.to_owned()].concat())
}

/// A room lit through a window by a large lamp above: few of its photons land where they are seen.
fn window() -> Stage {
    let sky = sphere("4,0,12", 8.0, &area("40"));
    let view = camera("0,-0.9,0.8", "0,0.5,-1", 70.0, SIDE as u32);
    scene(&[view, room_with_window(0.8, "0.6"), sky].concat())
}

/// The choice is nearly the best of the three by the measure that it is made with. Each variance is told from 2304
/// pixels and 144 squares, whose noise is partly shared: known to about √(2/144) = 12 %, a ratio of two to 17 %; the
/// pilot knows no more, has a preference of up to 1.4, and counts work a little otherwise.
#[test]
fn the_chosen_estimator_is_nearly_the_best() {
    for (name, stage) in [("room", diffuse_room()), ("open", open_ground()), ("window", window())] {
        let chosen = chosen_error(&stage);
        // As many samples as all of them take of so small a picture, and not by noise, as the chosen one.
        let way = |indirect| error(&stage, &[("indirect", indirect), ("camera_samples", "7")]);
        let others = ["density", "gather", "trace"].map(way);
        println!("{name}: auto {chosen:.3e}, density, gather, trace {others:.3?}");
        let best = others.into_iter().fold(f64::INFINITY, f64::min);
        assert!(chosen < 1.7 * best, "{name}: {chosen} of {others:?}");
    }
}

/// What is said of the global map means density; without it the plan says what was chosen and by how much.
#[test]
fn settings_of_the_global_map_leave_nothing_to_choose() {
    let stage = diffuse_room();
    let choice = |changes: &[(&str, &str)]| decided(stage.0.task_with(&settings(&stage, changes))).indirect;
    let found = choice(&[]).expect("a room with indirect light");
    assert!(["density", "gather", "trace"].contains(&found.indirect.as_str()));
    assert_eq!(found.others.len(), 2);
    for given in [
        ("photons", "5000"),
        ("radius", "0.1"),
        ("kernel", "cone"),
        ("lookup", "nearest"),
        ("nee", "false"),
        ("mode", "classic"),
        ("indirect", "trace"),
        ("max_depth", "2"),
    ] {
        assert_eq!(choice(&[given]), None, "{given:?}");
    }
}

/// A room in fog whose mean free path is half of the room; many of the paths through it have several scatterings.
fn foggy_room(size: usize, inside: &str) -> Stage {
    let medium = fog("interior", "1,1,1", "0.9,0.9,0.9", "");
    let room = [box_camera(size as u32), walls("0.7"), lamp(0.25, "15"), inside.to_owned()].concat();
    scene(&(room + &container("<scale value='1.001'/>", &medium)))
}

/// Thin fog on an open floor under an even sky: nearly all light is scattered once.
fn misty_ground() -> Stage {
    let floor = rectangle(8.0, "<rotate x='1' angle='-90'/><translate y='-1.1'/>", &diffuse("0.2"));
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    let medium = fog("interior", "0.2,0.2,0.2", "0.5,0.5,0.5", "");
    let mist = container("<scale value='1'/>", &medium);
    scene(&[box_camera(SIDE as u32), floor, sky.to_owned(), mist].concat())
}

/// As without media. Besides, the rays that are counted here are of all kinds, and one of a path with its scattering
/// takes up to four times as long as the others: photons may look that much more expensive than they are, or less.
#[test]
fn the_chosen_way_through_media_is_nearly_the_best() {
    for (name, stage) in [("room", foggy_room(SIDE, "")), ("open", misty_ground())] {
        let task = stage.0.task_with(&stage.0.settings);
        let chosen = decided(task);
        let found = chosen.indirect.expect("a choice");
        assert_eq!(found.others.len(), 2, "{found}");
        assert_eq!(chosen.volume.is_none(), found.indirect == "trace");
        let samples = found.camera_samples.expect("a number of samples").to_string();
        let errors =
            [[("indirect", "density"), ("beams", "points")], [("indirect", "density"), ("beams", "beams")]]
                .map(|changes| error(&stage, &[&changes[..], &[("camera_samples", &*samples)]].concat()));
        let traced = error(&stage, &[("indirect", "trace"), ("camera_samples", &samples)]);
        println!("{name}: {found}; points, beams {errors:.3?}, trace {traced:.3e}");
        let [points, beams] = errors;
        let of_chosen = match chosen.volume {
            None => traced,
            Some(volume) if volume.beams => beams,
            Some(_) => points,
        };
        let best = points.min(beams).min(traced);
        assert!(of_chosen < 4.0 * 1.7 * best, "{name}: {of_chosen} of {errors:?}, {traced}");
    }
}

/// What is said of photons in media means them; where light is focused, nothing but photons finds it.
#[test]
fn settings_of_media_and_glass_leave_no_path_tracing() {
    let choice = |stage: &Stage, changes: &[(&str, &str)]| {
        decided(stage.0.task_with(&settings(stage, changes))).indirect.map(|found| {
            let mut names: Vec<String> = found.others.into_iter().map(|(name, _)| name).collect();
            names.extend([found.indirect]);
            names
        })
    };
    let traced = |names: Option<Vec<String>>| names.expect("a choice").iter().any(|name| name == "trace");
    let room = foggy_room(16, "");
    assert!(traced(choice(&room, &[])));
    for given in [("volume_photons", "5000"), ("volume_radius", "0.1"), ("photons", "5000"), ("nee", "false")]
    {
        assert!(!traced(choice(&room, &[given])), "{given:?}");
    }
    for given in [("beams", "points"), ("mode", "classic"), ("indirect", "trace")] {
        assert_eq!(choice(&room, &[given]), None, "{given:?}");
    }
    let glass = "<bsdf type='dielectric'/>";
    assert!(!traced(choice(&foggy_room(16, &sphere("0,0,0", 0.3, glass)), &[])));
}

/// How far the fog goes on behind what is seen does not matter: without an end the size of a pixel in the middle of the
/// fog would make the radius as large as is allowed. The room in the fog is seen at a distance of 4 mean free paths.
#[test]
fn the_radius_in_endless_fog_is_that_of_large_fog() {
    let radius = |outside: &str| {
        let medium = fog("interior", "1,1,1", "0.9,0.9,0.9", "");
        let view = camera("0,0,4", "0,0,0", 40.0, 32);
        let view = view.replace("</sensor>", "<ref id='fog'/></sensor>");
        let lamp = "<emitter type='point'><point name='position' x='0' y='0.5' z='0'/>
            <rgb name='intensity' value='1'/><ref id='fog'/></emitter>";
        let medium = medium.replace("name='interior'", "id='fog'");
        let stage = scene(&[medium, view, lamp.to_owned(), outside.to_owned()].concat());
        let set = settings(&stage, &[("indirect", "density"), ("beams", "points")]);
        decided(stage.0.task_with(&set)).volume.expect("photons in fog").radius
    };
    let wall = |away: f64| {
        let place = format!("<translate z='{}'/>", -away);
        rectangle(2.0 * away, &place, &diffuse("0"))
    };
    let [near, far] = [wall(20.0), wall(400.0)].map(|wall| radius(&wall));
    // Few photons tell either; the scene's size has a part in it too.
    assert!((far / near - 1.0).abs() < 0.5, "{near} near, {far} far");
}

/// The picture that the pilot has in mind shows the same part of the film in the same proportions, up to a pixel.
#[test]
fn a_picture_of_fewer_pixels_is_the_same_picture() {
    let film = FilmSize { width: 1920, height: 1080, crop: [480, 270, 1200, 600] };
    let fewer = film.with_fewer_pixels(20_000);
    assert_eq!(fewer, FilmSize { width: 320, height: 180, crop: [80, 45, 200, 100] });
    assert_eq!(film.with_fewer_pixels(720_000), film);
    let line = FilmSize { width: 10_000, height: 1, crop: [9_999, 0, 1, 1] };
    assert_eq!(line.with_fewer_pixels(1), line);
    let line = FilmSize::full(10_000, 1).with_fewer_pixels(100);
    assert_eq!(line.crop, [0, 0, 1000, 1]);
}

/// The same choice on any number of threads, for it counts work and never looks at a clock.
#[test]
fn threads_do_not_change_the_choice() {
    for stage in [diffuse_room(), foggy_room(SIDE, "")] {
        let on = |n: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| decided(stage.0.task_with(&stage.0.settings)).indirect)
        };
        assert_eq!(on(1), on(3));
    }
}
