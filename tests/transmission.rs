//! Photon mapping and path tracing agree on light transmitted by rough and diffuse surfaces.

use caustica::film::Layer;

use crate::support::{SIGMAS, assert_agree, box_camera, camera, lamp, render, scene, sphere, walls};

/// A transmitting ball in the box: light enters and leaves it, and its inside is seen through its surface.
#[test]
fn rough_glass_and_diffuse_transmitters_agree_between_integrators() {
    for (name, bsdf) in [
        ("rough glass", "<bsdf type='roughdielectric'><float name='alpha' value='0.4'/></bsdf>"),
        ("diffuse transmitter", "<bsdf type='difftrans'><rgb name='transmittance' value='0.7'/></bsdf>"),
        (
            "thin principled",
            "<bsdf type='principledthin'><rgb name='base_color' value='0.8'/>
             <float name='diff_trans' value='1.2'/><float name='roughness' value='0.6'/></bsdf>",
        ),
    ] {
        let body = [box_camera(24), walls("0.5"), lamp(0.6, "5"), sphere("0,0,0.2", 0.6, bsdf)].concat();
        let scene = scene(&body);
        let path = render(&scene, &[("integrator", "path")], 2048).beauty(1);
        let maps = render(&scene, &[("photons", "20000"), ("caustic_photons", "20000")], 96).beauty(1);
        // Discs, at first a tenth of the ball's radius, overlap its silhouette. That changes its light, a fifth of
        // the picture's, by a few percent.
        assert_agree(name, maps, path, 0.02);
    }
}

/// Light that comes through rough glass to the camera is met by camera paths: none of it waits for photons, and
/// photon mapping is as free of noise as path tracing. In an even sky of radiance 1 the ball shows the sky's
/// light less what the masking of the facets loses, whichever way it is found.
#[test]
fn rough_glass_is_seen_without_photons() {
    let glass = "<bsdf type='roughdielectric'><float name='alpha' value='0.3'/></bsdf>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    let scene =
        scene(&[camera("0,0,3", "0,0,0", 30.0, 12).as_str(), sky, &sphere("0,0,0", 1.0, glass)].concat());
    let maps = render(&scene, &[("camera_samples", "1")], 256);
    let path = render(&scene, &[("integrator", "path")], 256);
    let waiting = maps.estimate(&[Layer::Direct, Layer::Caustic, Layer::Indirect], 1);
    assert_eq!((waiting.mean, waiting.sigma), (0.0, 0.0));
    let (a, b) = (maps.beauty(1), path.beauty(1));
    assert_agree("rough glass in an even sky", a, b, 0.01);
    assert!(
        a.sigma < 2.0 * b.sigma && (a.mean - b.mean).abs() < SIGMAS * a.sigma.hypot(b.sigma),
        "{a:?} {b:?}"
    );
}
