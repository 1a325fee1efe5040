//! Absurd numbers in scene files: each of them, at every place of a scene, is refused with a message or gives a
//! finite picture.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica::session::Session;
use caustica_formats::files::Memory;

use super::record;
use crate::support::{Stage, outcome as rendered, picture, plain};

const NUMBERS: [&str; 10] = ["nan", "inf", "-inf", "0", "-0", "-1", "1e38", "-1e38", "1e-40", "1e300"];

/// Every number between `{` and `}` is replaced in turn.
const MITSUBA: &str = "<scene version='3.0.0'>
<integrator type='sppm'><integer name='max_depth' value='{5}'/><float name='initial_radius' value='{0.1}'/></integrator>
<sensor type='thinlens'><float name='fov' value='{40}'/><float name='aperture_radius' value='{0.01}'/>
<float name='focus_distance' value='{4}'/><float name='near_clip' value='{0.1}'/><float name='far_clip' value='{100}'/>
<float name='principal_point_offset_x' value='{0.1}'/>
<transform name='to_world'><lookat origin='{0},0,{4}' target='0,{0},0' up='0,{1},0'/></transform>
<film type='hdrfilm'><integer name='width' value='{3}'/><integer name='height' value='{2}'/>
<rfilter type='gaussian'><float name='stddev' value='{0.5}'/></rfilter></film>
<sampler type='independent'><integer name='sample_count' value='{4}'/></sampler></sensor>
<shape type='sphere'><point name='center' value='{0},{1},0'/><float name='radius' value='{0.3}'/>
<bsdf type='dielectric'><float name='int_ior' value='{1.5}'/><float name='ext_ior' value='{1}'/></bsdf></shape>
<shape type='sphere'><transform name='to_world'><scale x='{0.3}' y='0.3' z='0.3'/><translate x='{1}'/>
<rotate x='{1}' angle='{30}'/></transform><bsdf type='roughconductor'><float name='alpha' value='{0.1}'/>
<rgb name='eta' value='{0.2},1,1'/><rgb name='k' value='{3},2,2'/></bsdf></shape>
<shape type='rectangle'><transform name='to_world'><matrix value='{2} 0 0 0  0 {2} 0 0  0 0 2 {-1}  0 0 0 {1}'/></transform>
<bsdf type='twosided'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='map.pfm'/>
<transform name='to_uv'><scale x='{2}'/></transform></texture></bsdf></bsdf></shape>
<shape type='obj'><string name='filename' value='mesh.obj'/><bsdf type='roughdielectric'><float name='alpha' value='{0.2}'/></bsdf></shape>
<shape type='cylinder'><point name='p0' value='{-1},0,0'/><point name='p1' value='-1,{1},0'/><float name='radius' value='{0.1}'/>
<bsdf type='principled'><float name='roughness' value='{0.3}'/><float name='metallic' value='{0.5}'/><float name='clearcoat' value='{1}'/></bsdf></shape>
<shape type='disk'><transform name='to_world'><scale value='{0.2}'/><rotate x='1' angle='90'/><translate y='{2}'/></transform>
<bsdf type='blendbsdf'><float name='weight' value='{0.5}'/><bsdf type='plastic'><rgb name='diffuse_reflectance' value='{0.5}'/></bsdf>
<bsdf type='phong'><float name='exponent' value='{20}'/></bsdf></bsdf>
<emitter type='area'><rgb name='radiance' value='{5},5,5'/></emitter></shape>
<emitter type='point'><point name='position' value='0,{3},2'/><rgb name='intensity' value='{9}'/></emitter>
<emitter type='spot'><float name='cutoff_angle' value='{20}'/><float name='beam_width' value='{10}'/>
<transform name='to_world'><lookat origin='0,3,{3}' target='0,0,0' up='0,1,0'/></transform></emitter>
<emitter type='directional'><vector name='direction' value='0,{-1},0'/><rgb name='irradiance' value='{1}'/></emitter>
<emitter type='envmap'><string name='filename' value='map.pfm'/><float name='scale' value='{0.5}'/></emitter>
</scene>";

/// The same in pbrt.
const PBRT: &str = "LookAt 0 0 {4} 0 {0} 0 0 1 0 Scale {-1} 1 1
Camera \"perspective\" \"float fov\" {40} \"float lensradius\" {0.01} \"float focaldistance\" {4} \"float screenwindow\" [{-1} 1 -1 {1}]
Film \"rgb\" \"integer xresolution\" {3} \"integer yresolution\" {2} \"float cropwindow\" [{0} 1 0 {1}] \"float iso\" {100}
PixelFilter \"mitchell\" \"float B\" {0.3} \"float xradius\" {2} Sampler \"halton\" \"integer pixelsamples\" {2}
Integrator \"sppm\" \"integer maxdepth\" {5} \"float radius\" {0.1} \"integer photonsperiteration\" {99}
WorldBegin
LightSource \"infinite\" \"rgb L\" [{1} 1 1] \"float scale\" {1} \"float illuminance\" {1}
LightSource \"spot\" \"point3 from\" [0 {3} 0] \"float coneangle\" {30} \"float conedeltaangle\" {5} \"float power\" {10}
LightSource \"distant\" \"blackbody L\" {5000} \"point3 to\" [0 0 {1}]
Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" {4} \"rgb tex1\" [{0.1} 0.2 0.3]
Texture \"f\" \"float\" \"fbm\" \"integer octaves\" {3} \"float roughness\" {0.5}
Material \"coateddiffuse\" \"texture reflectance\" \"t\" \"float roughness\" {0.1} \"float thickness\" {0.01} \"float eta\" {1.5} \"texture displacement\" \"f\"
AttributeBegin Translate {0.5} 0 0 Rotate {30} {1} 0 0 Shape \"sphere\" \"float radius\" {0.5} \"float zmin\" {-0.4} \"float phimax\" {270} AttributeEnd
Material \"dielectric\" \"float eta\" {1.5} \"float roughness\" {0.2}
Shape \"trianglemesh\" \"point3 P\" [{0} 0 0 1 0 0 0 {1} 0] \"integer indices\" [0 1 2] \"normal N\" [0 0 {1} 0 0 1 0 0 1] \"point2 uv\" [{0} 0 1 0 0 1]
Material \"conductor\" \"rgb reflectance\" [{0.5} 0.5 0.5]
Shape \"cylinder\" \"float radius\" {0.2} \"float zmin\" {-1} \"float zmax\" {1}
AreaLightSource \"diffuse\" \"rgb L\" [{5} 5 5] \"float scale\" {1}
Shape \"disk\" \"float height\" {1} \"float radius\" {0.3}
ConcatTransform [{1} 0 0 0 0 1 0 0 0 0 {1} 0 0 0 0 {1}] Shape \"bilinearmesh\" \"point3 P\" [0 0 {0} 1 0 0 0 1 0 1 1 1]
";

/// The scene with `number` at place `which` and the original values elsewhere; `None` if it has no such place.
fn with(template: &str, which: usize, number: &str) -> Option<String> {
    let mut out = String::new();
    let (mut rest, mut place, mut found) = (template, 0, false);
    while let Some((before, after)) = rest.split_once('{') {
        let (original, after) = after.split_once('}').expect("closed");
        out.push_str(before);
        found |= place == which;
        out.push_str(if place == which { number } else { original });
        (rest, place) = (after, place + 1);
    }
    found.then(|| out + rest)
}

/// Reads, compiles and renders a scene, and says whether it was refused or rendered.
fn outcome(name: &str, text: String) -> &'static str {
    let map = picture(2, |x, y| [0.2, 0.1 * x as f32, 0.3 * y as f32], 2);
    let mesh = b"v 0 0 -0.5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec();
    let files = [(name, text.clone().into_bytes()), ("map.pfm", map), ("mesh.obj", mesh)];
    let files = Memory(files.into_iter().map(|(n, b)| (PathBuf::from(n), b)).collect::<BTreeMap<_, _>>());
    let mut scene = match Session::open_in(&files, Path::new(name), &plain()) {
        Ok(session) => Stage(session),
        Err(problem) => {
            assert!(!problem.to_string().is_empty());
            return "refused";
        }
    };
    let crop = &mut scene.0.view.film.crop;
    (crop[2], crop[3]) = (crop[2].min(3), crop[3].min(3));
    for integrator in ["path", "photonmap"] {
        for nee in ["true", "false"] {
            let changes = [
                ("integrator", integrator),
                ("nee", nee),
                ("photons", "100"),
                ("caustic_photons", "100"),
                // Its pilots, once for each scene.
                ("indirect", if nee == "true" { "auto" } else { "density" }),
            ];
            let done = rendered(&scene, &changes, 2, &mut |_| {});
            for i in 0..done.pixels.len() {
                let value = done.pixels.beauty(i, 2);
                assert!(value.iter().all(|v| v.is_finite()), "{integrator}: {value:?}\n{text}");
            }
            if integrator == "path" {
                break;
            }
        }
    }
    "rendered"
}

/// Tries each of the numbers at every place of a scene; some must be refused and some rendered.
fn check(name: &str, template: &str, numbers: &[&str]) {
    assert_eq!(outcome(name, with(template, 0, "5").expect("has numbers")), "rendered", "unchanged");
    let mut counts = BTreeMap::new();
    for number in numbers {
        for place in 0.. {
            let Some(text) = with(template, place, number) else { break };
            *counts.entry(outcome(name, text)).or_insert(0) += 1;
        }
    }
    let measured = format!("{counts:?}");
    let what = format!("{} absurd numbers at every place of {name}", numbers.len());
    record(&what, "a message or a finite picture", &measured, "—");
    assert_eq!(counts.len(), 2, "{measured}");
}

#[test]
fn every_number_is_refused_or_gives_a_finite_picture() {
    check("scene.xml", MITSUBA, &NUMBERS);
}

/// Fewer numbers, because each partial quadric of pbrt becomes 20 000 triangles.
#[test]
fn every_number_of_pbrt_is_refused_or_gives_a_finite_picture() {
    check("scene.pbrt", PBRT, &["nan", "0", "1e38", "-1e38", "1e-40"]);
}
