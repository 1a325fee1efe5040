//! Lamps of every shape: where photons start is where rays find light.

use std::f64::consts::PI;

use caustica::emitter::Emitter;
use caustica::math::Vec3;
use caustica::sampling::CounterRng;

use crate::support::Stage;

use super::{Tally, crossings, green, line, mitsuba, pbrt, same};

const CHECKS: &str = "<emitter type='area'><texture name='radiance' type='checkerboard'>
    <rgb name='color0' value='0.2'/><rgb name='color1' value='0.9'/>
    <transform name='to_uv'><scale x='1.5' y='1'/></transform></texture></emitter>";

/// Turned, so that no face lies along an axis.
const TURN: &str = "<rotate x='0.894427191' y='0.357770876' z='-0.268328157' angle='37'/><translate x='0.3' y='-0.2' z='0.1'/>";

fn shape(kind: &str, scale: &str, rest: &str) -> String {
    format!("<shape type='{kind}'>{rest}<transform name='to_world'>{scale}{TURN}</transform>{CHECKS}</shape>")
}

fn light(shape: &str, twosided: bool) -> String {
    format!(
        "Rotate 37 1 0.4 -0.3\nAreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"bool twosided\" {twosided}\nShape {shape}\n"
    )
}

/// Every shape there is, shining.
fn shapes() -> Vec<(&'static str, Stage)> {
    let flipped = "<boolean name='flip_normals' value='true'/>";
    let mesh = "<string name='filename' value='mesh.obj'/>";
    let quarter = "\"float radius\" 1.3 \"float zmin\" -0.4 \"float zmax\" 1 \"float phimax\" 200";
    let patch = "\"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0.4  0 1 0.3  1.5 1.2 -0.2]";
    let solid = "\"point3 P\" [0 0 0  1 0 0  0 1 0  0 0 1] \"integer indices\" [0 2 1  0 1 3  0 3 2  1 2 3]";
    vec![
        ("rectangle", mitsuba(&shape("rectangle", "<scale x='2' y='0.5'/>", ""))),
        ("rectangle from behind", mitsuba(&shape("rectangle", "<scale x='-2' y='0.5'/>", flipped))),
        ("cube", mitsuba(&shape("cube", "<scale x='1' y='0.4' z='0.7'/>", ""))),
        ("disk", mitsuba(&shape("disk", "<scale value='1.2'/>", ""))),
        ("ellipse", mitsuba(&shape("disk", "<scale x='1.5' y='0.5'/>", ""))),
        ("sphere", mitsuba(&shape("sphere", "<scale value='1.2'/>", ""))),
        ("sphere from inside", mitsuba(&shape("sphere", "<scale value='1.2'/>", flipped))),
        ("ellipsoid", mitsuba(&shape("sphere", "<scale x='1.5' y='0.5' z='1'/>", ""))),
        ("cylinder", mitsuba(&shape("cylinder", "<scale value='0.8'/>", ""))),
        ("cylinder from inside", mitsuba(&shape("cylinder", "<scale value='0.8'/>", flipped))),
        ("mesh", mitsuba(&shape("obj", "<scale x='-1' y='1.2' z='1'/>", mesh))),
        ("part of a sphere", pbrt(&light(&format!("\"sphere\" {quarter}"), false))),
        ("part of a cylinder", pbrt(&light(&format!("\"cylinder\" {quarter}"), true))),
        (
            "ring",
            pbrt(&light(
                "\"disk\" \"float radius\" 1.5 \"float innerradius\" 0.7 \"float phimax\" 250",
                false,
            )),
        ),
        ("bilinear patch", pbrt(&light(patch, false))),
        ("triangles", pbrt(&light(&format!("\"trianglemesh\" {solid}"), true))),
        ("subdivided", pbrt(&light(&format!("\"loopsubdiv\" \"integer levels\" 2 {solid}"), false))),
    ]
}

const CELLS: usize = 9;

/// Cells in space, askew, so that no face lies along their sides.
fn cell(center: Vec3, radius: f32, p: Vec3) -> usize {
    let q = (p - center) / radius;
    let axes = [Vec3::new(0.8, 0.53, 0.28), Vec3::new(-0.5, 0.77, 0.4)];
    axes.iter().fold(0, |c, axis| 3 * c + ((axis.dot(q) + 1.0) * 1.5).clamp(0.0, 2.0) as usize)
}

/// Lines evenly spread through a sphere of radius R cross a surface of area A in A/(2πR²) points on
/// average, evenly spread over it, and find the radiance of its power Φ: Φ = 4π²R² times the mean of what
/// they see. So it is over every part of the surface, and so must be what photons start with there: that
/// area sampling is even, that it and the ray test mean the same surface, the same front and the same uv.
#[test]
fn photons_start_where_rays_find_light() {
    for (name, scene) in shapes() {
        let (center, radius) = (scene.sphere.center, 1.01 * scene.sphere.radius);
        let scale = 4.0 * PI * PI * f64::from(radius).powi(2);
        let n = 200_000;
        let (mut seen, mut sent) = (vec![Tally::default(); CELLS], vec![Tally::default(); CELLS]);
        let (mut area, mut all) = (Tally::default(), Tally::default());
        let mut rng = CounterRng::new(31, 0);
        for _ in 0..n {
            let ray = line(&mut rng, center, radius);
            let mut found = [0.0; CELLS];
            let mut count = 0.0;
            crossings(&scene, ray, |s| {
                found[cell(center, radius, s.p)] += scale * green(scene.emitted(s, -ray.d));
                count += scale / (2.0 * PI);
            });
            area.add(count);
            seen.iter_mut().zip(found).for_each(|(t, x)| t.add(x));
            let (pick, place, direction) = (rng.next_f32(), rng.next_2d().into(), rng.next_2d().into());
            let emission = scene.sample_emission(pick, place, direction).map(|start| start.emission);
            let at = emission.as_ref().map(|e| (cell(center, radius, e.o), green(e.flux)));
            all.add(at.map_or(0.0, |(_, flux)| flux));
            for (c, t) in sent.iter_mut().enumerate() {
                t.add(at.filter(|a| a.0 == c).map_or(0.0, |a| a.1));
            }
        }
        let stated = scene.emitters.iter().map(|e| match e {
            Emitter::Area(a) => f64::from(a.area()),
            _ => panic!("{name} is no lamp"),
        });
        let stated: f64 = stated.sum();
        let exact = |x: f64| Tally { n: 1.0, sum: x, square: x * x };
        same(&format!("area of {name}"), area, exact(stated));
        // Of textured lamps the stated power is measured at 128² places.
        let (power, off) = (green(scene.power()), all.mean() - green(scene.power()));
        assert!(off.abs() <= 4.5 * all.sigma() + 0.01 * power, "{name}: {} of {power}", all.mean());
        let mut compared = 0;
        for (c, (a, b)) in seen.iter().zip(&sent).enumerate() {
            // A normal error needs some hundred hits of either kind.
            if b.mean() > 0.01 * power && a.mean() > 20.0 * a.sigma().hypot(b.sigma()) {
                same(&format!("cell {c} of {name}"), *b, *a);
                compared += 1;
            }
        }
        assert!(compared >= 4, "{name} lies in {compared} cells only");
    }
}
