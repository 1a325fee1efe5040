//! Where discs lie free the boundary test needs no rays, and its answer is the same.

use caustica::math::kernel::KernelKind;
use caustica::math::{Ray, Vec3};
use caustica::photon::{Boundary, Clearance, Query, Surroundings};
use caustica::sampling::{Sampler, warp};

use crate::support::{Stage, UP, box_camera, diffuse, lamp, rectangle, scene, sphere, walls};

/// Things that touch, thin and free ones, and one that is round.
fn room() -> Stage {
    let standing = rectangle(0.3, "<translate y='-0.7' z='0.3'/>", &diffuse("0.5"));
    let lying = rectangle(0.2, &format!("{UP}<translate x='-0.5' y='-0.95' z='-0.5'/>"), &diffuse("0.5"));
    scene(
        &[
            box_camera(8),
            walls("0.7"),
            lamp(0.4, "3"),
            standing,
            lying,
            sphere("0.6,-0.7,-0.5", 0.3, &diffuse("0.5")),
        ]
        .concat(),
    )
}

#[test]
fn free_discs_are_known_without_rays() {
    let stage = room();
    let (scene, facts) = (&stage.0.scene, &stage.0.facts);
    let widest = 0.1;
    let clearance = Clearance::new(widest);
    let mut rays = [0u64; 2];
    for i in 0..4000 {
        let mut sampler = Sampler::new(5, i);
        let [u, v] = [sampler.next_2d(), sampler.next_2d()];
        let from = Vec3::new(0.2 * u.x - 0.1, 0.5 * u.y, 0.1);
        let d = warp::sphere(v);
        let ray = Ray::new(from, d);
        let Some(hit) = scene.geometry.closest(&ray) else { continue };
        let s = scene.surface(&ray, &hit);
        let n = scene.photon_side(&s, -d).n;
        let radius = widest * (0.2 + 0.8 * sampler.next_1d());
        let q = Query { p: s.p, n, lift: s.lift, radius };
        let answer = |clearance: Option<&Clearance>, rays: &mut u64| {
            let around = Surroundings { scene, facts, clearance };
            let mut sampler = sampler;
            let mut boundary = Boundary { around, sampler: &mut sampler, rays };
            let found = boundary.correction(&q, radius, KernelKind::Epanechnikov);
            (found.factor, found.obstructed, sampler.random())
        };
        let [with, without] = [Some(&clearance), None]
            .into_iter()
            .zip(&mut rays)
            .map(|(c, r)| answer(c, r))
            .collect::<Vec<_>>()[..]
        else {
            unreachable!("two answers")
        };
        assert_eq!(with, without, "at {:?}, radius {radius}", s.p);
    }
    // At least half of the room's surface is farther than 2.1 widest radii from any edge.
    assert!(2 * rays[0] < rays[1], "{rays:?}");
}
