//! Several lamps: a surface looks at a point of each before it sends one shadow ray.

use caustica::film::Layer;

use crate::support::{
    DOWN, Estimate, Stage, UP, area, assert_agree, camera, diffuse, rectangle, render, scene, sphere,
};

const POINT: &str = "<emitter type='point'><point name='position' value='3,0,4'/><rgb name='intensity' value='10'/></emitter>";
const SUN: &str = "<emitter type='directional'><vector name='direction' value='0.6,0,-0.8'/>\
                   <rgb name='irradiance' value='2'/></emitter>";
const DARK: &str =
    "<emitter type='point'><point name='position' value='0,0,1'/><rgb name='intensity' value='0'/></emitter>";

/// A diffuse plane under lamps without size, none of which is hidden: whichever is chosen, it stands for all of them.
/// The only noise is that of the place within the pixel, over which the irradiance changes by less than 10⁻³.
#[test]
fn where_nothing_is_hidden_the_choice_makes_no_noise() {
    let floor = rectangle(50.0, "", &diffuse("0.5"));
    let stage = scene(&format!("{}{floor}{POINT}{DARK}{SUN}", camera("0,0.0001,10", "0,0,0", 0.011, 1)));
    // E = I·cosθ/d² of the point, cosθ = 4/5, d² = 25.
    let irradiance = 10.0 * 0.8 / 25.0 + 2.0 * 0.8;
    let expected = 0.5 * irradiance / std::f64::consts::PI;
    for integrator in ["path", "photonmap"] {
        let settings = [("integrator", integrator), ("max_depth", "2")];
        let got = render(&stage, &settings, 32).beauty(0);
        assert_agree(integrator, got, Estimate::exact(expected), 1e-3);
        assert!(got.sigma < 1e-3 * expected, "{integrator}: {got:?}");
    }
}

/// Lamps of all kinds: wide and small ones with a surface, the sky, a point that a box hides from most places, a sun, and one
/// that does not shine. The surfaces are there whether they shine or not.
fn lamps(lit: impl Fn(usize) -> bool) -> String {
    let shining = |i: usize, radiance: &str| if lit(i) { area(radiance) } else { diffuse("0") };
    let wide = rectangle(0.8, &format!("{DOWN}<translate x='-1.2' y='2'/>"), &shining(0, "1,2,1"));
    let small = sphere("1.2,1,0.3", 0.1, &shining(1, "40,20,30"));
    let others = [
        "<emitter type='constant'><rgb name='radiance' value='0.2,0.3,0.5'/></emitter>",
        "<emitter type='point'><point name='position' value='0,0.6,0'/><rgb name='intensity' value='3,3,2'/></emitter>",
        "<emitter type='directional'><vector name='direction' value='0.6,-0.8,0'/>\
         <rgb name='irradiance' value='2'/></emitter>",
        DARK,
    ];
    let others = others.iter().zip(2..).filter(|(_, i)| lit(*i)).map(|(lamp, _)| *lamp);
    others.fold(wide + &small, |all, lamp| all + lamp)
}

const LAMPS: usize = 6;

/// A floor, a glossy ball, and a box without a lid around the middle, with `more` beside them.
fn furnished(more: &str) -> Stage {
    let metal = "<bsdf type='roughconductor'><float name='alpha' value='0.12'/></bsdf>";
    let floor = rectangle(3.0, UP, &diffuse("0.6"));
    let wall =
        |place: &str| rectangle(0.4, place, &format!("<bsdf type='twosided'>{}</bsdf>", diffuse("0.5")));
    let walls = [
        "<translate y='0.4' z='0.4'/>",
        "<translate y='0.4' z='-0.4'/>",
        "<rotate y='1' angle='90'/><translate x='0.4' y='0.4'/>",
        "<rotate y='1' angle='90'/><translate x='-0.4' y='0.4'/>",
    ]
    .map(wall)
    .concat();
    let ball = sphere("-0.9,0.5,0.8", 0.5, metal);
    scene(&format!("{}{floor}{walls}{ball}{more}", camera("0,3,4", "0,0.3,0", 45.0, 12)))
}

/// Light adds up: the lamps together bring what each brings alone, where there is nothing to choose, by all kinds of
/// direct light: of path tracing, of photon mapping and of a scene with fog. Shares of shadow rays and of scattered
/// rays that did not add up to 1 would show on the ball, under the wide lamp and the sky, and in the fog. Both sides
/// have 0.3 % of noise together at most, of which 4.5 standard errors are allowed for.
#[test]
fn lamps_together_bring_what_each_brings_alone() {
    let layers = [Layer::Direct, Layer::Indirect];
    let fog = "<shape type='cube'><transform name='to_world'><scale value='2.9'/></transform><bsdf type='null'/>\
               <medium type='homogeneous' name='interior'><rgb name='albedo' value='0.7'/>\
               <float name='sigma_t' value='0.1'/></medium></shape>";
    let cases = [("path", "path", "", 1024), ("photons", "photonmap", "", 256), ("fog", "path", fog, 1024)];
    for (name, integrator, more, passes) in cases {
        let seen = |lit: &dyn Fn(usize) -> bool| {
            let settings = [("integrator", integrator), ("max_depth", "3")];
            render(&furnished(&(lamps(lit) + more)), &settings, passes).estimate(&layers, 1)
        };
        let all = seen(&|_| true);
        let each: Vec<Estimate> = (0..LAMPS).map(|lamp| seen(&|i| i == lamp)).collect();
        let mean = each.iter().map(|e| e.mean).sum();
        let sigma = each.iter().map(|e| e.sigma.powi(2)).sum::<f64>().sqrt();
        assert_agree(name, all, Estimate { mean, sigma }, 0.015);
    }
}

/// A closed room with a lamp, in the middle of a bright sky that no light of comes in.
fn closed_room(sky: &str) -> Stage {
    let two_sided = format!("<bsdf type='twosided'>{}</bsdf>", diffuse("0.5"));
    let walls = [
        format!("{UP}<translate y='-1'/>"),
        format!("{DOWN}<translate y='1'/>"),
        "<translate z='-1'/>".to_owned(),
        "<rotate y='1' angle='180'/><translate z='1'/>".to_owned(),
        "<rotate y='1' angle='90'/><translate x='-1'/>".to_owned(),
        "<rotate y='1' angle='-90'/><translate x='1'/>".to_owned(),
    ];
    let walls = walls.map(|place| rectangle(1.0, &place, &two_sided)).concat();
    let lamp = rectangle(0.2, &format!("{DOWN}<translate y='0.95'/>"), &area("5"));
    scene(&format!("{}{walls}{lamp}{sky}", camera("0,0,0.9", "0,-0.3,-1", 60.0, 12)))
}

/// The sky would outshine the lamp a thousand times. A tenth of the shadow rays go there in spite of the walls: half of what
/// is chosen evenly. A sample x of the lamp that is taken nine times in ten has the variance (var x + x̄²/10)/0.9, and
/// variances over 144 pixels and 256 passes are known to 2 %; a tenth more is allowed.
#[test]
fn a_hidden_sky_takes_few_rays_from_a_lamp() {
    let measured = |sky: &str| {
        let picture = render(&closed_room(sky), &[("integrator", "path"), ("max_depth", "2")], 256);
        let pixels = 0..picture.pixels.len();
        let square: f64 = pixels.clone().map(|i| picture.pixel(i)[1].powi(2)).sum();
        let variance: f64 = pixels.map(|i| picture.pixels.variance(i, 256) * 256.0).sum();
        [variance, square]
    };
    let sky = "<emitter type='constant'><rgb name='radiance' value='100'/></emitter>";
    let ([alone, square], [hidden, _]) = (measured(""), measured(sky));
    let bound = 1.1 * (alone + 0.1 * square) / 0.9;
    println!("{alone} {hidden}, at most {bound}");
    assert!(hidden < bound, "{hidden} {bound}");
}
