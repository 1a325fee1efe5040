//! Media and the interfaces between them.

use caustica_formats::ir::{
    Coefficients, Color, Medium, MediumEmission, Phase, Scene, Transform, Volume, VolumeData, VolumeGrid,
    WrapMode,
};

use caustica_formats::ReadOptions;

use crate::{problems, scene, try_read, world};

fn only(scene: &Scene) -> &Medium {
    let media: Vec<_> = scene.media.iter().collect();
    assert_eq!(media.len(), 1);
    media[0].1
}

fn medium(text: &str) -> Medium {
    only(&world(&format!("MakeNamedMedium \"m\" {text}"))).clone()
}

fn gray(v: f64) -> Volume {
    Volume::Constant(Color::Gray(v))
}

fn rgb(v: [f64; 3]) -> Volume {
    Volume::Constant(Color::Rgb(v))
}

fn grid(volume: &Volume) -> (&VolumeGrid, &[f32]) {
    let Volume::Grid(grid) = volume else { panic!("{volume:?}") };
    let VolumeData::Inline(values) = &grid.data else { panic!() };
    (grid, &values.values)
}

#[test]
fn homogeneous_media() {
    let plain = medium("\"string type\" \"homogeneous\"");
    assert_eq!(plain.coefficients, Coefficients::Parts { sigma_a: gray(1.0), sigma_s: gray(1.0) });
    assert_eq!((plain.scale, &plain.phase, &plain.emission), (1.0, &Phase::Isotropic, &None));
    let full = medium(
        "\"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [4 5 6] \"float scale\" 7 \"float g\" .5 \
         \"rgb Le\" [1 1 0] \"float Lescale\" 3",
    );
    let (sigma_a, sigma_s) = (rgb([1.0, 2.0, 3.0]), rgb([4.0, 5.0, 6.0]));
    assert_eq!(full.coefficients, Coefficients::Parts { sigma_a, sigma_s });
    assert_eq!((full.scale, full.phase), (7.0, Phase::HenyeyGreenstein { g: 0.5 }));
    let (radiance, scale) = (rgb([1.0, 1.0, 0.0]), gray(3.0));
    assert_eq!(full.emission, Some(MediumEmission::Radiance { radiance, scale }));
}

/// Fire needs no lamp.
#[test]
fn a_medium_may_be_all_the_light() {
    let text = "WorldBegin MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb Le\" [1 1 1]\n\
        MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
    assert_eq!(problems(text), [""; 0]);
    assert_eq!(problems(&text.replace("\"rgb Le\" [1 1 1]", "")).len(), 1);
}

/// A preset wins over the coefficients in pbrt-v4. In pbrt-v3 they win, and without either there is milk.
#[test]
fn presets() {
    let given = "\"string type\" \"homogeneous\" \"string preset\" \"Coke\" \"rgb sigma_a\" [1 2 3]";
    let coke = Coefficients::Parts {
        sigma_a: rgb([0.10014, 0.16503, 0.2468]),
        sigma_s: rgb([8.9053e-5, 8.372e-5, 0.0]),
    };
    assert_eq!(medium(given).coefficients, coke);
    let old = |text: &str| only(&version3(&format!("MakeNamedMedium \"m\" {text}"))).coefficients.clone();
    let Coefficients::Parts { sigma_a, .. } = old(given) else { panic!() };
    assert_eq!(sigma_a, rgb([1.0, 2.0, 3.0]));
    let milk =
        Coefficients::Parts { sigma_a: rgb([0.0011, 0.0024, 0.014]), sigma_s: rgb([2.55, 3.21, 3.77]) };
    assert_eq!(old("\"string type\" \"homogeneous\""), milk);
}

/// The transform in force places the grid.
#[test]
fn grids_of_density() {
    let text = "Translate 1 2 3 MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer nz\" 3 \
        \"float density\" [0 1 2 3 4 5] \"point3 p0\" [-1 -1 -1] \"float temperature\" [0 100 200 300 400 500] \
        \"float temperaturecutoff\" 20 \"float temperaturescale\" 2";
    let scene = world(text);
    let smoke = only(&scene);
    let (density, values) = grid(smoke.density.as_ref().unwrap());
    assert_eq!(values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(density.bounds, Some([[-1.0; 3], [1.0; 3]]));
    assert_eq!((density.to_world, density.wrap), (Transform::translate([1.0, 2.0, 3.0]), WrapMode::Zero));
    let Some(MediumEmission::Temperature { kelvin, offset, factor, peak, scale }) = &smoke.emission else {
        panic!()
    };
    assert_eq!((grid(kelvin).1[5], *offset, *factor), (500.0, 20.0, 2.0));
    // Of pbrt's own pictures: a peak of 1 makes a spectrum's luminance the integral of ȳ, and one value alone falls to
    // half at the sides.
    assert!((peak - 106.857).abs() < 1e-3);
    let (tent, values) = grid(scale);
    assert_eq!((values, tent.bounds, tent.wrap), (&[1.0][..], Some([[-1.0; 3], [1.0; 3]]), WrapMode::Zero));
    let colours = medium(
        "\"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_a\" [1 2 3 4 5 6] \"rgb Le\" [1 1 1 0 0 0]",
    );
    let Coefficients::Parts { sigma_a, sigma_s } = &colours.coefficients else { panic!() };
    assert_eq!((grid(sigma_a).1, sigma_s), (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0][..], &gray(1.0)));
    // Not scaled to luminance 1, unlike the emission of other media.
    let Some(MediumEmission::Radiance { scale: Volume::Constant(Color::Gray(scale)), .. }) = colours.emission
    else {
        panic!()
    };
    assert!((scale - 106.857).abs() < 1e-3);
    let cloud = medium("\"string type\" \"cloud\" \"float wispiness\" 2");
    assert!(
        matches!(cloud.density, Some(Volume::Cloud(cloud)) if (cloud.wispiness, cloud.frequency) == (2.0, 5.0))
    );
    // The grid of pbrt-v3.
    let old =
        "MakeNamedMedium \"m\" \"string type\" \"heterogeneous\" \"integer nx\" 2 \"float density\" [1 2]";
    assert_eq!(grid(only(&version3(old)).density.as_ref().unwrap()).1, [1.0, 2.0]);
}

fn version3(body: &str) -> Scene {
    let text = format!("Film \"image\" WorldBegin LightSource \"infinite\"\n{body} WorldEnd");
    try_read(&text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene
}

#[test]
fn grids_must_hold_what_they_say() {
    let of = |text: &str| {
        problems(&format!(
            "WorldBegin LightSource \"infinite\"\nMakeNamedMedium \"m\" \"string type\" {text}"
        ))
    };
    assert_eq!(
        of("\"uniformgrid\" \"integer nx\" 3 \"float density\" [1 2]"),
        ["scene.pbrt:2:64: `density` has 2 numbers, but a grid of 3 × 1 × 1 points"]
    );
    assert!(of("\"uniformgrid\"")[0].contains("needs the parameter \"float density\""));
    assert!(of("\"uniformgrid\" \"float density\" [-1]")[0].contains("must not be negative"));
    assert!(of("\"rgbgrid\"")[0].contains("needs the parameter \"rgb sigma_a\" or \"rgb sigma_s\""));
    assert!(of("\"homogeneous\" \"float g\" 1")[0].contains("`g` must lie between -1 and 1"));
    let missing = of("\"nanovdb\" \"string filename\" \"no.nvdb\" \"float temperaturescale\" 2");
    assert!(missing[0].contains("volume `no.nvdb` not found") && missing.len() == 1, "{missing:?}");
    let huge = "\"uniformgrid\" \"integer nx\" 2000000000 \"integer ny\" 2000000000 \"integer nz\" 9 \"float density\" [1]";
    assert!(of(huge)[0].contains("has 1 numbers"));
}

/// The graphics state has the medium inside and that outside: shapes part them, lights and the camera stand in the
/// second. Where both are one there is no boundary.
#[test]
fn interfaces() {
    let text = "MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin\n\
        MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" MakeNamedMedium \"milk\" \"string type\" \"homogeneous\"\n\
        LightSource \"point\" LightSource \"infinite\" Shape \"sphere\"\n\
        AttributeBegin MediumInterface \"milk\" \"fog\" Shape \"sphere\" AttributeEnd\n\
        MediumInterface \"fog\" Shape \"sphere\" MediumInterface \"\" \"\" LightSource \"point\" Shape \"sphere\"";
    let scene = scene(text);
    let id = |name: &str| scene.media.iter().find(|(_, m)| m.name.as_deref() == Some(name)).unwrap().0;
    let (fog, milk) = (Some(id("fog")), Some(id("milk")));
    assert_eq!(scene.sensors[0].medium, fog);
    let lights: Vec<_> = scene.emitters.iter().map(|light| light.medium).collect();
    assert_eq!(lights, [fog, None, None]);
    let sides: Vec<_> = scene.shapes.iter().map(|s| s.media.map(|m| (m.interior, m.exterior))).collect();
    assert_eq!(sides, [Some((None, fog)), Some((milk, fog)), None, None]);
}
