//! Shading normals: photons and camera paths agree on what they do to light (Veach 1997, section 5.3).

use crate::support::{assert_agree, camera, diffuse, rectangle, render, scene_with, sphere};

/// A square in the plane y = 0 whose vertex normals all lean by `angle` degrees towards +z.
fn bent(angle: f64) -> String {
    let (sin, cos) = angle.to_radians().sin_cos();
    format!("v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvn 0 {cos} {sin}\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n")
}

/// Light that a bent mirror, and a bent pane of glass's upper face, throw onto a wall. Without the correction the
/// wall is off by |cos(40°)/cos(50°)| and the like; bounds: the kernel's blur at the rim of the caustic.
#[test]
fn bent_mirrors_and_diffuse_surfaces_throw_the_same_light_by_photons_and_by_paths() {
    let lamp = sphere("0,2.4,2", 0.6, "<emitter type='area'><rgb name='radiance' value='5'/></emitter>");
    let wall = rectangle(3.0, "<translate z='-2'/>", &diffuse("0.7"));
    for (what, bsdf) in [
        ("mirror", "<bsdf type='conductor'><string name='material' value='none'/></bsdf>".to_owned()),
        ("diffuse", diffuse("0.8")),
    ] {
        let body = format!(
            "{}{lamp}{wall}<shape type='obj'><string name='filename' value='bent.obj'/>{bsdf}</shape>",
            camera("0,1,1.5", "0,1,-2", 50.0, 8)
        );
        let stage = scene_with(&body, &[("bent.obj", &bent(12.0))]);
        let path = render(&stage, &[("integrator", "path")], 4096).beauty(1);
        let maps = render(&stage, &[("photons", "20000"), ("caustic_photons", "40000")], 128).beauty(1);
        assert_agree(what, maps, path, 0.015);
    }
}
