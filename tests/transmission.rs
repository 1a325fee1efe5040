//! Photon mapping and path tracing agree on light transmitted by rough and diffuse surfaces.

use crate::support::{assert_agree, box_camera, lamp, render, scene, sphere, walls};

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
