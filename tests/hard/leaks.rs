//! No ray passes through a closed mesh, wherever it is aimed.

use caustica::math::{Ray, Vec3};
use rayon::prelude::*;

use super::{MAPS, METHODS, black, record};
use crate::support::{area, camera, diffuse, render, scene_with, sphere};
use crate::watertight::{Floats, icosphere, obj, ours};

const MESH: &str = "<shape type='obj'><string name='filename' value='mesh.obj'/>
    <boolean name='face_normals' value='true'/>@</shape>";

/// Ten million rays from inside a closed mesh, aimed at its vertices, the midpoints of its edges and any points of
/// them: all hit, and shadow rays agree. Half of them are in a rotated instance, whose vertices are rounded once
/// more.
#[test]
fn ten_million_rays_at_edges_and_vertices_all_hit() {
    let (points, faces) = icosphere(4);
    let turn = "<transform name='to_world'><rotate x='0.267261242' y='0.534522484' z='0.801783726' angle='40'/></transform>";
    let group = format!(
        "<shape type='shapegroup' id='g'>{}</shape><shape type='instance'><ref id='g'/>{turn}</shape>",
        MESH.replace('@', "")
    );
    let (sin, cos) = 40f64.to_radians().sin_cos();
    let axis = glam::DVec3::new(1.0, 2.0, 3.0).normalize();
    let turned = |p: [f64; 3]| {
        let p = glam::DVec3::from(p);
        (p * cos + axis.cross(p) * sin + axis * axis.dot(p) * (1.0 - cos)).to_array()
    };
    for (name, body) in [("placed directly", MESH.replace('@', "")), ("instance", group)] {
        let scene = scene_with(
            &format!("{}{body}", camera("0,0,0", "0,0,1", 40.0, 4)),
            &[("mesh.obj", &obj(&points, &faces))],
        );
        let at = |i: usize| {
            let p = points[i].map(|c| f64::from(c as f32));
            let p = if name == "instance" { turned(p) } else { p };
            ours(&scene, p.map(|c| c as f32))
        };
        let corners: Vec<Vec3> = (0..points.len()).map(at).collect();
        let missed: u64 = (0..100_u64)
            .into_par_iter()
            .map(|chunk| {
                let mut floats = Floats::new(100 + chunk);
                let mut missed = 0;
                for i in 0..50_000 {
                    let o = floats.vector() * 0.45;
                    let face = faces[floats.below(faces.len())];
                    let (a, b) = (corners[face[i % 3]], corners[face[(i + 1) % 3]]);
                    let target = match i % 4 {
                        0 => a,
                        1 => (a + b) * 0.5,
                        _ => a + (b - a) * (floats.next() * 0.5 + 0.5),
                    };
                    let ray = Ray::new(o, target - o);
                    missed += u64::from(scene.geometry.closest(&ray).is_none());
                    missed += u64::from(!scene.geometry.occluded(&ray));
                }
                missed
            })
            .sum();
        let case = format!("5e6 rays at edges and vertices of a closed mesh, {name}");
        record(&case, "all hit", &format!("{missed} missed"), "0");
        assert_eq!(missed, 0, "{case}");
    }
}

/// With bright lamps around a closed mesh, its inside is exactly black.
#[test]
fn a_closed_mesh_keeps_the_light_out() {
    let (points, faces) = icosphere(3);
    let body = [
        camera("0,0,0.2", "0,0,-1", 120.0, 32),
        MESH.replace('@', &format!("<bsdf type='twosided'>{}</bsdf>", diffuse("0.8"))),
        sphere("0,2,0", 0.5, &area("1000")),
        sphere("1.5,-1.5,1", 0.2, &area("1000")),
    ];
    let scene = scene_with(&body.concat(), &[("mesh.obj", &obj(&points, &faces))]);
    for (name, settings) in METHODS {
        black(&format!("inside of a closed mesh, {name}"), &render(&scene, settings, 32));
    }
    let settings = [MAPS.1, &[("nee", "false")]].concat();
    black("inside of a closed mesh, first photons", &render(&scene, &settings, 32));
}
