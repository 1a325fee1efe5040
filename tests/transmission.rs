//! Light that rough and diffuse surfaces let through reaches the camera by photons as by paths.

use crate::support::{assert_agree, box_camera, lamp, render, scene, sphere, walls};

/// A ball in the lamp-lit box: light enters and leaves through it, and its inside is seen through it.
#[test]
fn rough_glass_and_diffuse_transmitters_look_alike_by_both_methods() {
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
        // Discs reach over the silhouette of the ball, a tenth of its radius at first: some percent of its light,
        // which is a fifth of the picture.
        assert_agree(name, maps, path, 0.02);
    }
}
