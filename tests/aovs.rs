//! Pictures of the surfaces that camera rays meet first: their values, and that they change nothing else.

use std::path::{Path, PathBuf};

use caustica::film::{Aov, Pixels};
use caustica::render::{Budget, Checkpoint, Head, Sums};
use caustica::session::{Layers, Options, Session};
use caustica_formats::files::Memory;
use caustica_formats::image::{Image, read};
use caustica_formats::ir::{Crop, Filter};

use crate::support::{box_camera, camera, diffuse, plain, rectangle, sphere, walls};

/// Samples at the centres of pixels, nearly.
const CENTRES: Filter = Filter::Box { radius: 1e-5 };

fn layers(list: &str) -> Option<Layers> {
    Some(list.parse().unwrap())
}

fn open(file: &str, text: &str, options: &Options) -> Session {
    let memory = Memory([(PathBuf::from(file), text.as_bytes().to_vec())].into_iter().collect());
    Session::open_in(&memory, Path::new(file), options).unwrap_or_else(|e| panic!("{e}"))
}

fn mitsuba(body: &str, options: &Options) -> Session {
    open("scene.xml", &format!("<scene version='3.0.0'>{body}</scene>"), options)
}

fn pixels(session: &Session, passes: u32) -> Pixels {
    session.render(Budget::passes(passes), &mut |_| {}).pixels
}

/// Every number of every layer, pixel by pixel.
fn values(session: &Session, passes: u32) -> Vec<Vec<f64>> {
    let (list, pixels) = (&session.view.aovs, pixels(session, passes));
    (0..pixels.len())
        .map(|i| list.iter().flat_map(|aov| pixels.aov(i, *aov, list, passes)).collect())
        .collect()
}

/// Every shape and what albedo knows of BSDFs: a rectangle, a plastic sphere, a metal cylinder, a principled disk, a
/// glass cube, and an instance of a masked blend.
const SHAPES: &str = "
<sensor type='perspective'><float name='fov' value='45'/><float name='near_clip' value='0.5'/>
<transform name='to_world'><lookat origin='1,3,7' target='0,0.6,0' up='0,1,0'/></transform>
<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='12'/><rfilter type='box'/></film></sensor>
<emitter type='constant'/>
<shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate x='1' angle='-90'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0.1,0.2,0.3'/></bsdf></shape>
<shape type='sphere'><point name='center' x='-1.3' y='1' z='0'/><float name='radius' value='1'/><bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.2,0.5,0.3'/></bsdf></shape>
<shape type='cylinder'><point name='p0' x='1.5' y='0' z='0'/><point name='p1' x='1.7' y='1.6' z='0.3'/><float name='radius' value='0.5'/><bsdf type='twosided'><bsdf type='roughconductor'><rgb name='eta' value='0.2,0.9,1.1'/><rgb name='k' value='3.9,2.4,2.2'/><float name='alpha' value='0.3'/></bsdf></bsdf></shape>
<shape type='disk'><transform name='to_world'><rotate y='1' angle='20'/><translate x='0.3' y='1.2' z='-2'/></transform><bsdf type='principled'><rgb name='base_color' value='0.8,0.1,0.1'/><float name='roughness' value='0.4'/></bsdf></shape>
<shape type='cube'><transform name='to_world'><scale x='0.4' y='0.5' z='0.3'/><rotate y='1' angle='30'/><translate x='0.2' y='0.55' z='1.8'/></transform><bsdf type='dielectric'/></shape>
<shape type='shapegroup' id='group'><shape type='cube'><bsdf type='mask'><float name='opacity' value='0.5'/><bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='diffuse'><rgb name='reflectance' value='0.4,0.8,0'/></bsdf><bsdf type='roughplastic'><rgb name='diffuse_reflectance' value='0,0,0.8'/></bsdf></bsdf></bsdf></shape></shape>
<shape type='instance'><ref id='group'/><transform name='to_world'><scale x='0.6' y='0.4' z='0.6'/><rotate x='1' angle='35'/><rotate y='1' angle='20'/><translate x='-1.8' y='0.7' z='2.2'/></transform></shape>";

/// What Mitsuba 3.9.1 has where the ray through the middle of a pixel meets each shape: albedo, depth, position, uv,
/// geometric and shading normal, dp_du, dp_dv, duv_dx, duv_dy, prim_index, shape_index.
const GOLDEN: [([usize; 2], &[f64]); 6] = [
    (
        [13, 9],
        &[
            0.100000, 0.200000, 0.300000, 5.894704, 1.950670, 0.000000, 1.401456, 0.743834, 0.324818,
            0.000000, 1.000000, 0.000000, 0.000000, 1.000000, 0.000000, 8.000000, 0.000000, 0.000000,
            0.000000, 0.000000, -8.000000, 0.035784, 0.005112, -0.008371, -0.068561, 1.000000, 1.000000,
        ],
    ),
    (
        [4, 4],
        &[
            0.200000, 0.500000, 0.300000, 6.136619, -1.066057, 1.383785, 0.893297, 0.162875, 0.148386,
            0.233943, 0.383785, 0.893297, 0.233943, 0.383785, 0.893297, -2.411389, 1.469905, 0.000000,
            1.460691, 2.396274, -1.412039, -0.092170, 0.053146, -0.059544, -0.084040, 0.000000, 2.000000,
        ],
    ),
    (
        [12, 5],
        &[
            1.751160, 1.132786, 0.964559, 6.085658, 1.613967, 1.092486, 0.712389, 0.723070, 0.737728,
            -0.067157, -0.175757, 0.982140, -0.067157, -0.175757, 0.982140, 3.111001, -0.414842, 0.138487,
            0.200000, 1.600000, 0.300000, 0.092063, 0.036495, 0.023204, -0.210981, 0.000000, 3.000000,
        ],
    ),
    (
        [8, 3],
        &[
            0.800000, 0.100000, 0.100000, 8.613479, -0.032058, 1.202705, -1.879141, 0.353379, 0.498782,
            0.342020, 0.000000, 0.939693, 0.342020, 0.000000, 0.939693, -0.939665, 0.007655, 0.342010,
            -0.015971, -2.220283, 0.005813, -0.459520, 0.006976, -0.007373, 0.204961, 0.000000, 4.000000,
        ],
    ),
    (
        [6, 8],
        &[
            0.000000, 0.000000, 0.000000, 5.242694, -0.164751, 0.476452, 1.968232, 0.426452, 0.438862,
            -0.866025, 0.000000, 0.500000, -0.866025, 0.000000, 0.500000, 0.000000, 1.000000, 0.000000,
            0.300000, 0.000000, 0.519615, 0.353084, 1.293050, -0.315344, -0.043120, 9.000000, 5.000000,
        ],
    ),
    (
        [1, 7],
        &[
            0.300000, 0.600000, 0.200000, 5.021208, -1.431843, 0.928073, 2.461511, 0.286240, 0.355311,
            0.196175, 0.819152, 0.538986, 0.196175, 0.819152, 0.538986, -1.127631, 0.000000, 0.410424,
            -0.336200, 0.688292, -0.923701, -0.197942, -0.019020, -0.005603, -0.234569, 3.000000, 6.000000,
        ],
    ),
];

const ALL: &str =
    "albedo,depth,position,uv,geo_normal,sh_normal,dp_du,dp_dv,duv_dx,duv_dy,prim_index,shape_index";

/// To 1e-4. The samples are up to 1e-5 of a pixel off, which moves a point by 1e-6 and no value here by more than
/// 1e-5; the rest is rounding of single precision, in both renderers.
#[test]
fn every_layer_agrees_with_mitsuba() {
    // One sample a pixel: with more, the change of uv is that of a sample's share.
    let settings = vec![("integrator".to_owned(), "path".to_owned())];
    let options = Options { filter: Some(CENTRES), layers: layers(ALL), settings, ..plain() };
    let session = mitsuba(SHAPES, &options);
    let values = values(&session, 1);
    for ([x, y], expected) in GOLDEN {
        let got = &values[y * 16 + x];
        assert_eq!(got.len(), expected.len());
        for (k, (got, expected)) in got.iter().zip(expected).enumerate() {
            assert!((got - expected).abs() < 1e-4, "number {k} at {x}, {y}: {got}, not {expected}");
        }
    }
}

/// What follows from geometry alone, at every pixel: a unit sphere 4 before the camera, on nothing.
#[test]
fn a_sphere_has_its_depth_and_its_normals() {
    let body = camera("0,0,5", "0,0,0", 30.0, 16) + &sphere("0,0,0", 1.0, &diffuse("0.25"));
    let options =
        Options { filter: Some(CENTRES), layers: layers("depth,position,geo_normal,albedo"), ..plain() };
    let session = mitsuba(&body, &options);
    let mut seen = 0;
    for got in values(&session, 1) {
        let (depth, p, n, albedo) = (got[0], &got[1..4], &got[4..7], &got[7..10]);
        if depth == 0.0 {
            assert!(got.iter().all(|v| *v == 0.0));
            continue;
        }
        seen += 1;
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length(p) - 1.0).abs() < 2e-6);
        // On a unit sphere the normal is the place.
        assert!(p.iter().zip(n).all(|(p, n)| (p - n).abs() < 2e-6));
        // The near plane is 0.01 along the axis from the pinhole.
        let from = [p[0], p[1], p[2] - 5.0];
        let near = 0.01 * length(&from) / (5.0 - p[2]);
        assert!((length(&from) - near - depth).abs() < 5e-6);
        assert!(albedo.iter().all(|a| (a - 0.25).abs() < 1e-6));
    }
    // It shows a disk whose radius is 1/√24 of a film that reaches to tan 15°: 6.09 pixels, an area of 117.
    assert!((105..=128).contains(&seen), "{seen}");
}

fn glass_box() -> String {
    [
        box_camera(20),
        walls("0.6"),
        rectangle(0.6, "<rotate x='1' angle='90'/><translate y='0.99'/>", "<emitter type='area'/>"),
        sphere("0,-0.3,0", 0.5, "<bsdf type='dielectric'/>"),
    ]
    .concat()
}

/// The rays for layers take none of the random numbers of the picture.
#[test]
fn layers_do_not_change_the_picture_and_are_the_same_for_all_integrators() {
    let with = |integrator: &str, list: &str| {
        let settings = [("integrator", integrator), ("photons", "2000"), ("camera_samples", "1")];
        let settings = settings.map(|(n, v)| (n.to_owned(), v.to_owned())).to_vec();
        mitsuba(&glass_box(), &Options { layers: layers(list), settings, ..plain() })
    };
    let mut seen = Vec::new();
    for integrator in ["path", "photonmap"] {
        let (plain, all) = (pixels(&with(integrator, "none"), 3), pixels(&with(integrator, "all"), 3));
        let ([plain, none], [light, surfaces]) = (plain.sums(), all.sums());
        assert!(plain == light, "{integrator}");
        assert!(none.is_empty());
        seen.push(surfaces.clone());
    }
    assert!(seen[0] == seen[1]);
    assert!((0..seen[0].len()).any(|i| seen[0].get(i) != 0.0));
}

#[test]
fn threads_and_checkpoints_do_not_change_a_bit_and_a_crop_is_a_part() {
    // A part of the film by itself has other noise to follow.
    let settings = vec![("camera_samples".to_owned(), "16".to_owned())];
    let options = |crop| Options { layers: layers("all"), crop, settings: settings.clone(), ..plain() };
    let session = mitsuba(SHAPES, &options(None));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| pixels(&session, 4))
    };
    let whole = on(1);
    assert!(whole == on(3));
    let saved = Checkpoint::encode(&Head { passes: 2, ..Head::default() }, &pixels(&session, 2));
    let Checkpoint { pixels: half, .. } = Checkpoint::decode(&saved).unwrap();
    let half = Sums { pixels: half, first: 0, passes: 2 };
    let resumed = session.resume(half, Budget::passes(4), &mut |_| {});
    assert!(whole == resumed.pixels);

    let [x, y, width, height] = [3, 2, 9, 7];
    let part = pixels(&mitsuba(SHAPES, &options(Some(Crop { x, y, width, height }))), 4);
    let list = &session.view.aovs;
    for row in 0..height as usize {
        for column in 0..width as usize {
            let (there, here) = ((row + 2) * 16 + column + 3, row * 9 + column);
            for aov in list.iter().filter(|aov| !matches!(aov, Aov::DuvDx | Aov::DuvDy)) {
                let (a, b) = (part.aov(here, *aov, list, 4), whole.aov(there, *aov, list, 4));
                assert_eq!(a, b, "{aov:?}");
            }
        }
    }
}

/// The file that a session's picture makes.
fn exr(session: &Session, passes: u32) -> Image {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.exr");
    let outcome = session.render(Budget::passes(passes), &mut |_| {});
    let output = caustica::session::Output::new(session, vec![file.clone()]);
    output.write(&session.picture(&outcome)).unwrap();
    read(&std::fs::read(file).unwrap()).unwrap()
}

/// A channel, row by row.
fn channel(image: &Image, name: &str) -> Vec<f32> {
    let at = image.channels.iter().position(|c| c == name);
    let at = at.unwrap_or_else(|| panic!("no {name} in {:?}", image.channels));
    image.data.iter().skip(at).step_by(image.channels.len()).copied().collect()
}

#[test]
fn a_scene_that_asks_for_layers_gets_them_under_their_names() {
    let body = "<integrator type='aov'><string name='aovs' value='dd.y:depth,nn:sh_normal'/>
        <integrator type='path' name='img'/></integrator>"
        .to_owned()
        + &glass_box();
    let file = exr(&mitsuba(&body, &plain()), 2);
    for name in ["R", "emission.G", "img.R", "img.A", "dd.y.T", "nn.X", "nn.Y", "nn.Z"] {
        channel(&file, name);
    }
    assert_eq!(channel(&file, "R"), channel(&file, "img.R"));
    assert_eq!(file.channels.len(), 3 + 4 * 3 + 4 + 1 + 3);
    // The command line wins.
    let file = exr(&mitsuba(&body, &Options { layers: layers("depth,direct"), ..plain() }), 2);
    assert_eq!(file.channels.len(), 3 + 1 + 3);
    assert!(channel(&file, "depth.Z").iter().any(|d| *d > 1.0));
}

#[test]
fn fields_of_old_scenes_are_layers_with_the_names_of_the_film() {
    let text = "<scene version='0.6.0'>
        <integrator type='multichannel'>
            <integrator type='path'/>
            <integrator type='field'><string name='field' value='relPosition'/></integrator>
            <integrator type='field'><string name='field' value='distance'/></integrator>
            <integrator type='field'><string name='field' value='shapeIndex'/></integrator>
        </integrator>
        <sensor type='perspective'><float name='fov' value='20'/>
            <transform name='toWorld'><lookat origin='3,0,0' target='0,0,0' up='0,1,0'/></transform>
            <film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/>
                <string name='pixelFormat' value='rgb, rgb, luminance'/>
                <string name='channelNames' value='color, place, far'/><rfilter type='box'/></film></sensor>
        <shape type='rectangle'><transform name='toWorld'><rotate y='1' angle='90'/></transform></shape>
        </scene>";
    let file = exr(&open("scene.xml", text, &plain()), 16);
    assert_eq!(channel(&file, "color.R"), channel(&file, "R"));
    // All of the rectangle is at depth 3 before the camera; its mean distance is that and a little more: the film
    // spans ±tan 10°, over which the mean of √(1 + x² + y²) is 1 + tan² 10°/3.
    for (z, far) in channel(&file, "place.Z").into_iter().zip(channel(&file, "far.T")) {
        assert!((z - 3.0).abs() < 1e-5, "{z}");
        assert!((3.0..3.1).contains(&far), "{far}");
    }
    let mean = channel(&file, "far.T").iter().sum::<f32>() / 16.0;
    assert!((mean - 3.0 * (1.0 + 0.03109 / 3.0)).abs() < 2e-3, "{mean}");
    assert!(channel(&file, "shape_index.I").iter().all(|v| *v == 0.0));
}

/// A wall at 4 that fills half of the film, in the frame of a camera that is turned: pbrt's +x is on the right and
/// +z ahead. P and the normals are those of the wall alone also where a pixel has it by half, and Albedo is the mean.
#[test]
fn a_gbuffer_film_has_the_channels_of_pbrt() {
    let scene = |system: &str| {
        format!(
            "LookAt 4 0 0  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\n
             Film \"gbuffer\" \"integer xresolution\" 5 \"integer yresolution\" 5 {system}\n
             PixelFilter \"box\"\nWorldBegin\nLightSource \"infinite\"\n
             Material \"diffuse\" \"rgb reflectance\" [0.6 0.3 0.2]\n
             Shape \"trianglemesh\" \"integer indices\" [0 1 2 2 3 0] \"point2 uv\" [0 0 1 0 1 1 0 1]
             \"point3 P\" [0 -9 0  0 -9 9  0 9 9  0 9 0]\n"
        )
    };
    let camera = exr(&open("scene.pbrt", &scene(""), &plain()), 64);
    let row = |file: &Image, name: &str| channel(file, name)[10..15].to_vec();
    // The camera looks along −x with +y up; in pbrt's left-handed world +z is on its right.
    assert_eq!(row(&camera, "P.Z")[..2], [0.0; 2]);
    for k in 2..5 {
        assert!((row(&camera, "P.Z")[k] - 4.0).abs() < 1e-4, "{:?}", row(&camera, "P.Z"));
        assert!((row(&camera, "N.Z")[k] + 1.0).abs() < 1e-5);
        assert!((row(&camera, "Ns.Z")[k] + 1.0).abs() < 1e-5);
    }
    assert!(row(&camera, "P.X")[4] > 1.0);
    // Half of the middle pixel: 64 stratified samples are off by 1/8 at most in one dimension.
    let albedo = row(&camera, "Albedo.R");
    assert!((albedo[4] - 0.6).abs() < 1e-4 && (albedo[2] - 0.3).abs() < 0.6 / 8.0, "{albedo:?}");
    // From a pixel to the next: the film spans 2·tan 22.5° at distance 1.
    let step = 4.0 * 2.0 * 22.5f32.to_radians().tan() / 5.0;
    let (u, dz) = (row(&camera, "u"), row(&camera, "dzdx"));
    assert!(((u[4] - u[3]) * 9.0 - step).abs() < 0.1, "{u:?}");
    assert!(dz[4].abs() < 1e-4, "a wall across the axis: {dz:?}");
    // A constant environment over a diffuse wall: all that varies is the noise of its samples.
    for name in ["Variance.G", "RelativeVariance.G"] {
        assert!(row(&camera, name).iter().all(|v| *v >= 0.0 && *v < 1.0));
    }

    let world = exr(&open("scene.pbrt", &scene("\"string coordinatesystem\" \"world\""), &plain()), 64);
    assert!(row(&world, "P.X")[4].abs() < 1e-4 && row(&world, "P.Z")[4] > 1.0);
    assert!((row(&world, "N.X")[4] - 1.0).abs() < 1e-5);
}
