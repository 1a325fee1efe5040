//! Media, phase functions and volumes.

use caustica_formats::ReadOptions;
use caustica_formats::ir::{
    BsdfKind, Coefficients, Color, GridSamples, Medium, Phase, Scene, Transform, Volume, VolumeData,
    VolumeFilter, VolumeGrid, WrapMode,
};

use crate::{failure, headlines, try_read, v3, v06};

fn only(scene: &Scene) -> &Medium {
    let media: Vec<_> = scene.media.iter().collect();
    assert_eq!(media.len(), 1);
    media[0].1
}

fn new(medium: &str) -> Medium {
    only(&v3(medium)).clone()
}

fn old(medium: &str) -> Medium {
    only(&v06(medium)).clone()
}

/// With a file `smoke.vol`.
fn with_file(version: &str, body: &str) -> Scene {
    let text = format!("<scene version='{version}'>{body}</scene>");
    let read = try_read(&text, &[("smoke.vol", "")], &ReadOptions::default());
    read.unwrap_or_else(|e| panic!("{e}")).scene
}

fn gray(v: f64) -> Volume {
    Volume::Constant(Color::Gray(v))
}

fn rgb(v: [f64; 3]) -> Volume {
    Volume::Constant(Color::Rgb(v))
}

fn grid(volume: &Volume) -> &VolumeGrid {
    let Volume::Grid(grid) = volume else { panic!("{volume:?}") };
    grid
}

#[test]
fn homogeneous_media_of_version_3() {
    let medium = new("<medium type='homogeneous'/>");
    assert_eq!(medium.coefficients, Coefficients::Extinction { sigma_t: gray(1.0), albedo: gray(0.75) });
    assert_eq!((medium.scale, &medium.phase, medium.is_homogeneous()), (1.0, &Phase::Isotropic, true));
    let medium =
        new("<medium type='homogeneous'><rgb name='sigma_t' value='1 2 3'/><float name='scale' value='4'/>
        <rgb name='albedo' value='.1 .2 .3'/><boolean name='sample_emitters' value='false'/>
        <phase type='hg'><float name='g' value='-.3'/></phase></medium>");
    let (sigma_t, albedo) = (rgb([1.0, 2.0, 3.0]), rgb([0.1, 0.2, 0.3]));
    assert_eq!(medium.coefficients, Coefficients::Extinction { sigma_t, albedo });
    assert_eq!((medium.scale, medium.phase), (4.0, Phase::HenyeyGreenstein { g: -0.3 }));
}

/// 0.6 has skin by default, takes the table's 1/mm for 1/cm, and reduces scattering by the mean cosine.
#[test]
fn measured_media_of_version_06() {
    let skin = Coefficients::Parts { sigma_a: rgb([3.2, 17.0, 48.0]), sigma_s: rgb([74.0, 88.0, 101.0]) };
    assert_eq!(old("<medium type='homogeneous'/>").coefficients, skin);
    let medium = old("<medium type='homogeneous'><string name='material' value='lowfat milk'/></medium>");
    let Coefficients::Parts { sigma_a, sigma_s: Volume::Constant(Color::Rgb(sigma_s)) } = medium.coefficients
    else {
        panic!()
    };
    assert_eq!(sigma_a, rgb([0.287, 0.575, 1.15]));
    let wanted = [13.1157 * 0.068, 15.4445 * 0.098, 17.9572 * 0.141].map(|v| 100.0 * v);
    assert!((0..3).all(|i| (sigma_s[i] - wanted[i]).abs() < 1e-9 * wanted[i]), "{sigma_s:?}");
    let medium =
        old("<medium type='homogeneous'><rgb name='sigmaS' value='1 2 4'/><rgb name='sigmaA' value='.5'/>
        <float name='g' value='.5'/></medium>");
    let sigma_a = rgb([0.5; 3]);
    assert_eq!(medium.coefficients, Coefficients::Parts { sigma_a, sigma_s: rgb([0.5, 1.0, 2.0]) });
    let medium = old("<medium type='homogeneous'><rgb name='sigmaT' value='2 2 2'/>
        <rgb name='albedo' value='.25 .5 1'/><string name='strategy' value='maximum'/></medium>");
    let Coefficients::Extinction { sigma_t, .. } = medium.coefficients else { panic!() };
    assert_eq!(sigma_t, rgb([2.0; 3]));
    let mixed = failure(
        "<scene version='0.6.0'><medium type='homogeneous'><rgb name='sigmaT' value='2'/>
        <rgb name='sigmaA' value='1'/></medium></scene>",
    );
    assert!(mixed.contains("homogeneous takes either `sigmaA` or `sigmaT`, not both"), "{mixed}");
    let unknown = failure(
        "<scene version='0.6.0'><medium type='homogeneous'><string name='material' value='skin3'/>
        </medium></scene>",
    );
    assert!(unknown.contains("no medium named `skin3`") && unknown.contains("did you mean"), "{unknown}");
}

#[test]
fn grids_of_both_generations() {
    let scene = with_file(
        "3.0.0",
        "<medium type='heterogeneous' id='m'><float name='scale' value='9'/>
        <volume name='sigma_t' type='gridvolume'><string name='filename' value='smoke.vol'/>
        <transform name='to_world'><scale value='2'/></transform><string name='wrap_mode' value='repeat'/>
        <string name='filter_type' value='nearest'/></volume></medium>",
    );
    let medium = only(&scene);
    let Coefficients::Extinction { sigma_t, albedo } = &medium.coefficients else { panic!() };
    assert_eq!(
        (albedo, medium.scale, &medium.density, medium.is_homogeneous()),
        (&gray(0.75), 9.0, &None, false)
    );
    let sigma_t = grid(sigma_t);
    assert!(matches!(&sigma_t.data, VolumeData::File(file) if file.path.ends_with("smoke.vol")));
    assert_eq!((sigma_t.bounds, sigma_t.to_world), (Some([[0.0; 3], [1.0; 3]]), Transform::scale([2.0; 3])));
    assert_eq!((sigma_t.wrap, sigma_t.filter), (WrapMode::Repeat, VolumeFilter::Nearest));
    assert_eq!(sigma_t.samples, GridSamples::Centers);
    let scene = with_file(
        "0.6.0",
        "<medium type='heterogeneous'><string name='method' value='woodcock'/>
        <volume name='density' type='volcache'><volume type='gridvolume'>
            <string name='filename' value='smoke.vol'/></volume></volume>
        <volume name='albedo' type='constvolume'><rgb name='color' value='.5 .6 .7'/></volume>
        <volume name='orientation' type='constvolume'><vector name='value' x='0' y='1' z='0'/></volume>
        <phase type='microflake'><float name='stddev' value='.2'/></phase></medium>",
    );
    let medium = only(&scene);
    let Coefficients::Extinction { sigma_t, albedo } = &medium.coefficients else { panic!() };
    let sigma_t = grid(sigma_t);
    assert_eq!((sigma_t.bounds, sigma_t.wrap, sigma_t.samples), (None, WrapMode::Zero, GridSamples::Corners));
    assert_eq!(
        (albedo, &medium.orientation),
        (&rgb([0.5, 0.6, 0.7]), &Some(Volume::Direction([0.0, 1.0, 0.0])))
    );
    assert_eq!(medium.phase, Phase::Microflake { stddev: 0.2 });
}

/// Mitsuba 3 bounds a heterogeneous medium by the box of its extinction, and a constant has the unit cube.
#[test]
fn a_constant_extinction_fills_a_cube() {
    let medium = new("<medium type='heterogeneous'><volume name='sigma_t' type='constvolume'>
        <float name='value' value='5'/><transform name='to_world'><translate x='3'/></transform></volume></medium>");
    let Coefficients::Extinction { sigma_t, .. } = &medium.coefficients else { panic!() };
    assert_eq!(sigma_t, &gray(5.0));
    let cube = grid(medium.density.as_ref().unwrap());
    assert_eq!(
        (cube.bounds, cube.to_world),
        (Some([[0.0; 3], [1.0; 3]]), Transform::translate([3.0, 0.0, 0.0]))
    );
}

#[test]
fn phase_functions() {
    let phase = |text: &str| new(&format!("<medium type='homogeneous'>{text}</medium>")).phase;
    assert_eq!(phase("<phase type='hg'/>"), Phase::HenyeyGreenstein { g: 0.8 });
    assert_eq!(phase("<phase type='rayleigh'/>"), Phase::Rayleigh);
    let kkay = Phase::KajiyaKay { ks: 0.4, kd: 0.2, exponent: 4.0 };
    assert_eq!(phase("<phase type='kkay'/>"), kkay);
    let mixture =
        "<phase type='mixturephase'><string name='weights' value='.25;.75'/><phase type='isotropic'/>
        <phase type='rayleigh'/></phase>";
    assert_eq!(phase(mixture), Phase::Mixture(vec![(0.25, Phase::Isotropic), (0.75, Phase::Rayleigh)]));
    let blend = "<phase type='blendphase'><float name='weight' value='.3'/><phase type='isotropic'/>
        <phase type='rayleigh'/></phase>";
    let parts = Box::new([Phase::Isotropic, Phase::Rayleigh]);
    assert_eq!(phase(blend), Phase::Blend { weight: gray(0.3), parts });
    let table = phase("<phase type='tabphase'><string name='values' value='0.5, 1.0 1.5'/></phase>");
    assert_eq!(table, Phase::Tabulated { values: vec![0.5, 1.0, 1.5] });
    let sggx = with_file(
        "3.0.0",
        "<medium type='homogeneous'><phase type='sggx'><volume name='S' type='gridvolume'>
        <string name='filename' value='smoke.vol'/></volume></phase></medium>",
    );
    assert!(matches!(&only(&sggx).phase, Phase::Sggx { matrix: Volume::Grid(_) }));
    for (bad, said) in [
        ("<phase type='hg'><float name='g' value='1'/></phase>", "`g` must lie between -1 and 1, not 1"),
        ("<phase type='tabphase'><string name='values' value='1'/></phase>", "`values` must be two or more"),
        (
            "<phase type='microflake'><float name='stddev' value='.1'/></phase>",
            "needs a volume `orientation`",
        ),
        (
            "<phase type='sggx'><float name='S' value='1'/></phase>",
            "`S` must be a gridvolume with six channels",
        ),
    ] {
        let text =
            failure(&format!("<scene version='3.0.0'><medium type='homogeneous'>{bad}</medium></scene>"));
        assert!(text.contains(said), "{text}");
    }
}

/// What is shared over many levels would double with each of them.
#[test]
fn mixtures_of_mixtures_end() {
    let mut text = "<scene version='3.0.0'><phase type='isotropic' id='p0'/>".to_owned();
    for i in 1..40 {
        let below = i - 1;
        text += &format!(
            "<phase type='blendphase' id='p{i}'><float name='weight' value='.5'/><ref id='p{below}'/><ref id='p{below}'/></phase>"
        );
    }
    text += "<medium type='homogeneous'><ref id='p39'/></medium></scene>";
    assert!(failure(&text).contains("a phase function has more than 1000 parts"));
}

#[test]
fn media_of_shapes_sensors_and_emitters() {
    let body = "<medium type='homogeneous' id='fog'/><sensor type='perspective'><ref id='fog'/></sensor>
        <emitter type='point'><ref id='fog'/></emitter>
        <shape type='sphere'><ref name='exterior' id='fog'/><medium name='interior' type='homogeneous'/>
        <bsdf type='dielectric'/></shape><shape type='cube'><ref name='interior' id='fog'/><bsdf type='null'/></shape>";
    let scene = v3(body);
    let fog = scene.media.iter().find(|(_, medium)| medium.name.as_deref() == Some("fog")).unwrap().0;
    assert_eq!((scene.sensors[0].medium, scene.emitters[0].medium), (Some(fog), Some(fog)));
    let [ball, cube] = [0, 1].map(|i| scene.shapes[i].media.unwrap());
    assert_eq!((ball.exterior, cube.interior, cube.exterior), (Some(fog), Some(fog), None));
    assert!(ball.interior.is_some_and(|inside| inside != fog));
    assert_eq!(v3("<shape type='sphere'/>").shapes[0].media, None);
}

/// A boundary without bsdf is open in 0.6 and gray later.
#[test]
fn boundaries_without_a_bsdf() {
    let body = "<shape type='sphere'><medium name='interior' type='homogeneous'/></shape>";
    let scene = v06(&format!("{body}<emitter type='constant'/>"));
    assert_eq!(scene.bsdfs[scene.shapes[0].bsdf.unwrap()].kind, BsdfKind::Null);
    let lamp = v06(
        "<shape type='sphere'><emitter type='area'/><medium name='interior' type='homogeneous'/></shape>",
    );
    assert_eq!(lamp.shapes[0].bsdf, None);
    let read =
        try_read(&format!("<scene version='3.0.0'>{body}</scene>"), &[], &ReadOptions::default()).unwrap();
    assert_eq!(read.scene.shapes[0].bsdf, None);
    let said = headlines(&format!("<scene version='3.0.0'>{body}</scene>"));
    assert!(said[0].contains("no light enters the medium"), "{said:?}");
    let loose =
        failure("<scene version='3.0.0'><shape type='sphere'><medium type='homogeneous'/></shape></scene>");
    assert!(loose.contains("needs the name `interior` or `exterior`"), "{loose}");
}
