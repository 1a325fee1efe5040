//! Many lamps, and lamps that hardly ever light what matters: which of them are chosen, and where photons go.

use std::path::Path;

use caustica::film::Layer;
use caustica::math::Vec3;
use caustica::session::{Options, Session};
use caustica::settings::IntegratorKind;

use crate::support::{Estimate, SIGMAS, Stage, render};

/// A scene of `scenes/hard/`, 16 pixels wide, with a change to its text.
fn open(name: &str, change: impl Fn(String) -> String) -> Stage {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/hard").join(name);
    let text = change(std::fs::read_to_string(&path).expect("the scene is there"));
    let at = tempfile::Builder::new().suffix(".xml").tempfile().expect("there is room");
    std::fs::write(at.path(), text).expect("there is room");
    let options = Options { size: Some([16, 16]), ..Options::default() };
    Stage(Session::open(at.path(), &options).expect("the scene is whole"))
}

/// The lamps of `many-lamps.xml` in groups of eight, which are few enough to be compared.
fn group(text: &str, number: usize) -> String {
    let mut seen = 0;
    let kept = text.lines().filter(|line| {
        let lamp = line.contains("<emitter");
        seen += usize::from(lamp);
        !lamp || (seen - 1) / 8 == number
    });
    kept.collect::<Vec<_>>().join("\n")
}

/// Light adds up: the lamps together, chosen by their distance, bring what groups bring that are compared. Both have
/// half a percent of noise at most, of which 4.5 standard errors are allowed for.
#[test]
fn many_lamps_bring_what_they_bring_in_groups() {
    let layers = [Layer::Direct, Layer::Indirect];
    let seen = |stage: &Stage, passes| {
        render(stage, &[("integrator", "path"), ("max_depth", "4")], passes).estimate(&layers, 1)
    };
    let all = seen(&open("many-lamps.xml", |text| text), 8192);
    let groups: Vec<Estimate> =
        (0..8).map(|i| seen(&open("many-lamps.xml", |text| group(&text, i)), 8192)).collect();
    let mean: f64 = groups.iter().map(|g| g.mean).sum();
    let sigma = groups.iter().map(|g| g.sigma.powi(2)).sum::<f64>().sqrt();
    crate::support::assert_agree("64 lamps", all, Estimate { mean, sigma }, 0.025);
    // A path looks at one lamp of 64 where those of the groups compare eight each. With one lamp chosen evenly from each
    // group, the groups had three times the standard error, and one chosen evenly of all has √8 times that: more than
    // eight times theirs. Chosen by distance it is about half of that.
    println!("sigma {:e} against {sigma:e}", all.sigma);
    assert!(all.sigma < 5.0 * sigma, "{} {sigma}", all.sigma);
}

/// Next event estimation chooses the lamp above a point more often than all others together, and every lamp with its
/// probability.
#[test]
fn the_nearest_lamps_are_chosen() {
    let stage = open("many-lamps.xml", |text| text);
    let scene = &stage.0.scene;
    let origin = Vec3::from(scene.origin.map(|x| x as f32));
    for p in [Vec3::new(1.0, 1.8, 1.0), Vec3::new(-5.0, 1.7, 3.1), Vec3::new(7.0, 0.0, 7.0)] {
        let p = p - origin;
        let n = 1 << 16;
        let mut counts = vec![0u32; scene.emitters.len()];
        (0..n).for_each(|i| counts[scene.direct.sample(p, (i as f32 + 0.5) / n as f32)] += 1);
        let mut total = 0.0;
        for (lamp, count) in counts.iter().enumerate() {
            let probability = scene.direct.probability(p, lamp);
            total += f64::from(probability);
            // Even numbers: the count is off by one at either end.
            assert!((*count as f32 - probability * n as f32).abs() < 2.1, "{lamp}: {count} of {probability}");
            assert!(probability > 0.1 / 64.0);
        }
        assert!((total - 1.0).abs() < 1e-5, "{total}");
        let most = (0..counts.len()).max_by_key(|&i| counts[i]).unwrap();
        let place = |i: usize| scene.emitters[i].place(Default::default()).unwrap();
        let nearest = (0..counts.len()).map(|i| place(i).distance(p)).fold(f32::INFINITY, f32::min);
        assert!(place(most).distance(p) < nearest + 0.01, "{most}");
    }
}

/// Of the light that a far lamp sends everywhere, 2·10⁻⁸ meets the ball (π·0.005² at 9.8, of 4π): aimed, a tenth of the
/// paths or more leave photons of it where the camera looks. Of 64 lamps those get more paths that light the ball, the one
/// above it most.
#[test]
fn photons_go_where_they_matter() {
    let choice = |name: &str| {
        let stage = open(name, |text| text);
        assert_eq!(stage.0.settings.integrator, IntegratorKind::PhotonMap);
        stage.0.plan().indirect.expect("it is open")
    };
    let ball = choice("small-ball.xml");
    let caustic = ball.aims[1].as_ref().expect("few paths find the ball");
    assert!(caustic.landing > 0.1, "{caustic:?}");
    let lamps = choice("many-lamps.xml");
    let caustic = lamps.aims[1].as_ref().expect("few lamps light the ball");
    assert!(caustic.landing > 0.1, "{caustic:?}");
    // The lamps stand row by row: the one above the ball is the fifth of the fifth row.
    let (lamp, times) = caustic.lamps[0];
    assert_eq!(lamp, 36);
    assert!(times > 5.0, "{caustic:?}");
}

/// The caustic of the small ball is that of the ball with a lamp that shines at nothing else.
#[test]
fn aimed_photons_bring_the_light_of_a_spot() {
    let settings = [("indirect", "density"), ("photons", "2000"), ("caustic_photons", "4000")];
    let seen = |stage: &Stage| render(stage, &settings, 256).estimate(&[Layer::Caustic], 1);
    let aimed = seen(&open("small-ball.xml", |text| text));
    // A cone of a milliradian, which the ball fills in part: its lit disk is 1 cm wide 9.8 away.
    let spot = seen(&open("small-ball.xml", |text| {
        let from = text.find("<emitter").expect("it has a lamp");
        let lamp =
            "<emitter type='spot'><rgb name='intensity' value='300'/><float name='cutoff_angle' value='0.1'/>
            <float name='beam_width' value='0.099'/><transform name='to_world'>
            <lookat origin='4, 8, 4' target='0.01, 0.006, 0.01' up='0, 1, 0'/></transform></emitter></scene>";
        format!("{}{lamp}", &text[..from])
    }));
    println!("{aimed:?} {spot:?}");
    assert!(aimed.sigma < 0.02 * aimed.mean && spot.sigma < 0.02 * spot.mean);
    assert!((aimed.mean - spot.mean).abs() < SIGMAS * aimed.sigma.hypot(spot.sigma));
}
