//! Light of every kind, looked for and sent out.

use std::f64::consts::PI;

use caustica::math::{Frame, Ray, Vec2, Vec3};
use caustica::sampling::{CounterRng, warp};
use caustica::scene::{Scene, Surface};
use caustica::transport::visibility;

use crate::support::Stage;

use super::{Tally, green, mitsuba, pbrt, same};

const SIZE: f32 = 0.8;

fn emitter(kind: &str, rest: &str) -> String {
    format!("<emitter type='{kind}'>{rest}</emitter>")
}

fn shining(shape: &str, place: &str, kind: &str, picture: &str) -> String {
    let radiance = format!(
        "<texture name='radiance' type='bitmap'><string name='filename' value='{picture}'/></texture>"
    );
    format!(
        "<shape type='{shape}'><transform name='to_world'>{place}</transform>{}</shape>",
        emitter(kind, &radiance)
    )
}

/// Looking at the receiver, whose middle is (0.2, 0.1, 0), from the side.
const AIM: &str =
    "<transform name='to_world'><lookat origin='1,-0.7,2' target='0.1,0.2,0' up='0,1,0.2'/></transform>";

/// Every kind of light over a receiver.
fn lights() -> Vec<(&'static str, Stage)> {
    let receiver = format!(
        "<shape type='rectangle'><transform name='to_world'><scale value='{SIZE}'/>\
         <translate x='0.2' y='0.1'/></transform></shape>"
    );
    let with = |light: &str| mitsuba(&format!("{receiver}{light}"));
    let quad = format!(
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [{} {} 0  {} {} 0  {} {} 0  {} {} 0]",
        0.2 - SIZE,
        0.1 - SIZE,
        0.2 + SIZE,
        0.1 - SIZE,
        0.2 + SIZE,
        0.1 + SIZE,
        0.2 - SIZE,
        0.1 + SIZE
    );
    let of_pbrt = |light: &str| pbrt(&format!("{quad}\n{light}"));
    // From (1, −0.7, 2) along its own +Z towards the receiver.
    let place = "AttributeBegin\nTranslate 1 -0.7 2\nRotate 200 1 0.1 0\n";
    let colour = |name: &str| format!("<rgb name='{name}' value='3,2,1'/>");
    let spot = |rest: &str| {
        let angles = "<float name='cutoff_angle' value='25'/><float name='beam_width' value='10'/>";
        emitter("spot", &format!("{AIM}{angles}{rest}"))
    };
    let image = |name: &str| {
        format!("<texture name='{name}' type='bitmap'><string name='filename' value='square.pfm'/></texture>")
    };
    let sky = "<string name='filename' value='sky.pfm'/><transform name='to_world'><rotate x='1' angle='70'/></transform>";
    let turned = "<rotate y='1' angle='150'/><translate x='0.7' z='1.5'/>";
    let point =
        emitter("point", &format!("<point name='position' value='0.5,0.3,1.2'/>{}", colour("intensity")));
    let lamp = shining("rectangle", turned, "area", "square.pfm");
    let ball = shining("sphere", "<scale value='0.3'/><translate x='0.7' z='1.5'/>", "area", "square.pfm");
    let constant = emitter("constant", &colour("radiance"));
    vec![
        ("point", with(&point)),
        ("spot", with(&spot(&colour("intensity")))),
        ("spot with a picture", with(&spot(&(colour("intensity") + &image("texture"))))),
        (
            "directional",
            with(&emitter(
                "directional",
                &format!("<vector name='direction' value='0.3,0.2,-1'/>{}", colour("irradiance")),
            )),
        ),
        ("constant", with(&constant)),
        ("envmap", with(&emitter("envmap", sky))),
        (
            "projector",
            with(&emitter(
                "projector",
                &format!("{AIM}<float name='fov' value='40'/>{}", image("irradiance")),
            )),
        ),
        ("area", with(&lamp)),
        ("sphere", with(&ball)),
        (
            "cylinder",
            with(&shining(
                "cylinder",
                "<scale value='0.4'/><translate y='-0.5' z='1.5'/>",
                "area",
                "square.pfm",
            )),
        ),
        (
            "directionalarea",
            with(&shining(
                "rectangle",
                &format!("<scale value='0.4'/>{turned}"),
                "directionalarea",
                "square.pfm",
            )),
        ),
        ("many", with(&[lamp, ball, point, constant].concat())),
        (
            "goniometric",
            of_pbrt(&format!(
                "{place}LightSource \"goniometric\" \"string filename\" \"square.pfm\"\nAttributeEnd"
            )),
        ),
        (
            "projection",
            of_pbrt(&format!(
                "{place}LightSource \"projection\" \"string filename\" \"square.pfm\" \"float fov\" 50\nAttributeEnd"
            )),
        ),
        (
            "smooth spot",
            of_pbrt(
                "LightSource \"spot\" \"point3 from\" [1 -0.7 2] \"point3 to\" [0.1 0.2 0] \"float coneangle\" 25",
            ),
        ),
        ("distant", of_pbrt("LightSource \"distant\" \"point3 from\" [0.3 0.2 1] \"point3 to\" [0 0 0]")),
        ("infinite", of_pbrt("LightSource \"infinite\" \"string filename\" \"square.pfm\"")),
        (
            "two-sided",
            of_pbrt(
                "Translate 0.4 0.2 1.2\nAreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"bool twosided\" true\n\
                 Shape \"disk\" \"float radius\" 0.5",
            ),
        ),
    ]
}

/// A place of the author's scene without any surface.
fn place(scene: &Scene, author: [f32; 3]) -> Surface {
    let p = Vec3::from(std::array::from_fn::<f32, 3, _>(|i| (f64::from(author[i]) - scene.origin[i]) as f32));
    Surface {
        p,
        ng: Vec3::Z,
        frame: Frame::from_normal(Vec3::Z),
        uv: Vec2::ZERO,
        tangents: [Vec2::X, Vec2::Y],
        lift: 0.0,
        shape: 0,
        triangle: 0,
        weights: [0.0; 2],
    }
}

fn visible(
    scene: &Scene,
    at: &Surface,
    rng: &mut CounterRng,
) -> Option<(caustica::emitter::DirectSample, f64)> {
    let (pick, u) = (rng.next_f32(), rng.next_2d().into());
    let sample = scene.sample_direct(at.p, pick, u)?;
    let seen = visibility(scene, at, &sample, false, u32::MAX);
    (seen > 0.0).then(|| (sample, green(sample.value)))
}

/// The photons that reach a receiver carry what direct sampling says arrives there. Both sides of it
/// count. Measured noise, 4.5 sigma.
#[test]
fn photons_bring_what_direct_sampling_finds() {
    for (name, scene) in lights() {
        let mut rng = CounterRng::new(37, 0);
        let (mut brought, mut found) = (Tally::default(), Tally::default());
        let area = f64::from(4.0 * SIZE * SIZE);
        let n = if name == "envmap" || name == "infinite" || name == "many" { 1_000_000 } else { 300_000 };
        for _ in 0..n {
            let (pick, at, direction) = (rng.next_f32(), rng.next_2d().into(), rng.next_2d().into());
            let arrived = scene.sample_emission(pick, at, direction).and_then(|start| {
                let e = start.emission;
                let ray = Ray::new(e.o, e.d);
                let hit = scene.geometry.closest(&ray)?;
                let dark = !scene.is_lamp(&scene.surface(&ray, &hit));
                dark.then(|| green(e.flux))
            });
            brought.add(arrived.unwrap_or(0.0));
            let [x, y] = rng.next_2d().map(|u| 2.0 * u - 1.0);
            // A little above and below the receiver, whose own surface would hide half of the light.
            let mut light = 0.0;
            for above in [1e-4, -1e-4] {
                let at = place(&scene, [0.2 + SIZE * x, 0.1 + SIZE * y, above]);
                if let Some((s, value)) = visible(&scene, &at, &mut rng) {
                    let facing = s.dir.z * above > 0.0;
                    light += if facing { value * f64::from(s.dir.z.abs()) * area } else { 0.0 };
                }
            }
            found.add(light);
        }
        same(name, brought, found);
    }
}

/// Seen from a few places: the light that direct sampling finds is ∫L dω over the directions of rays, and
/// the densities that rays state integrate to the share of samples that find light. Light that no ray can
/// meet is not asked.
#[test]
fn densities_integrate_to_one() {
    let met = ["constant", "envmap", "area", "sphere", "cylinder", "infinite", "two-sided"];
    for (name, scene) in lights().into_iter().filter(|(name, _)| met.contains(name)) {
        for author in [[0.3, 0.1, 0.6], [-0.4, 0.5, 2.5], [1.6, -0.3, 0.9]] {
            let at = place(&scene, author);
            let mut rng = CounterRng::new(41, 0);
            let (mut light, mut share) = (Tally::default(), Tally::default());
            let (mut seen, mut density) = (Tally::default(), Tally::default());
            let (n, mut wrong) = (200_000, 0);
            for _ in 0..n {
                let sample = visible(&scene, &at, &mut rng);
                light.add(sample.as_ref().map_or(0.0, |s| s.1));
                share.add(if sample.is_some() { 1.0 } else { 0.0 });
                let ray = Ray::new(at.p, warp::sphere(rng.next_2d().into()));
                let (radiance, pdf) = towards(&scene, &ray);
                seen.add(4.0 * PI * radiance);
                density.add(if radiance > 0.0 { 4.0 * PI * pdf } else { 0.0 });
                // A sample states the density that a ray in its direction would.
                let Some((s, _)) = sample else { continue };
                let (radiance, pdf) = towards(&scene, &Ray::new(at.p, s.dir));
                // Rays along the rim of a lamp may just miss it.
                wrong += u32::from(radiance > 0.0 && (pdf / f64::from(s.pdf) - 1.0).abs() > 1e-2);
            }
            if share.mean() == 0.0 {
                assert_eq!(seen.mean(), 0.0, "{name}: rays find light that sampling does not");
                continue;
            }
            // Rounding turns a grazing ray by much, and puts another into the next texel.
            assert!(wrong <= n / 1000, "{name}: {wrong} of {n} densities differ");
            same(&format!("light of {name} from {author:?}"), light, seen);
            same(&format!("density of {name} from {author:?}"), density, share);
        }
    }
}

/// Radiance and density of what a ray meets first.
fn towards(scene: &Scene, ray: &Ray) -> (f64, f64) {
    match scene.geometry.closest(ray) {
        Some(hit) => {
            let s = scene.surface(ray, &hit);
            let pdf = scene.pdf_direct_surface(ray.o, ray.d, &s);
            (green(scene.emitted(&s, -ray.d)), f64::from(pdf))
        }
        None => scene
            .background(ray.o, ray.d)
            .fold((0.0, 0.0), |sum, (light, pdf)| (sum.0 + green(light), sum.1 + f64::from(pdf))),
    }
}
