//! Whether the boundaries of a scene agree about what lies between them.

use caustica_formats::diagnostic::Diagnostic;
use caustica_formats::ir;

use crate::math::{Frame, Ray, Vec2, Vec3};
use crate::medium::MediumId;
use crate::sampling::{CounterRng, warp};
use crate::scene::media::MOST_LOOKED_THROUGH;
use crate::scene::{Scene, View};

/// Lines that are looked along: from the camera, and all through the scene.
const LINES: usize = 512;

/// So many lines must find a contradiction: one may pass between two triangles.
const FEW: usize = 3;

/// A boundary that says something else of its near side than the one before, or the camera, says of its far side.
struct Contradiction {
    shape: u32,
    said: Option<MediumId>,
    arriving: Option<MediumId>,
    camera: bool,
}

/// A warning, one only, about boundaries that contradict each other.
pub fn check(ir: &ir::Scene, scene: &Scene, view: &View) -> Option<Diagnostic> {
    let found: Vec<Contradiction> = lines(scene, view)
        .filter_map(|(ray, camera)| look(scene, ray, camera.then_some(view.medium)))
        .collect();
    let first = found.first().filter(|_| found.len() >= FEW)?;
    let name = |m: Option<MediumId>| {
        m.map_or("vacuum".to_owned(), |m| format!("the medium `{}`", scene.medium_names[m.0 as usize]))
    };
    let number = scene.numbers.records.get(first.shape as usize).map_or(0, |r| r.0 as usize);
    let shape = number.checked_sub(1).and_then(|i| ir.shapes.get(i));
    let from = if first.camera { " from the camera" } else { "" };
    let text = format!(
        "this shape is the boundary of {}, but rays{from} arrive there in {}; each boundary decides what is behind it",
        name(first.said),
        name(first.arriving)
    );
    Some(Diagnostic::warning(text, shape.and_then(|s| s.origin.0)))
}

/// Lines to look along, and whether they come from the camera.
fn lines<'a>(scene: &'a Scene, view: &'a View) -> impl Iterator<Item = (Ray, bool)> + 'a {
    let mut rng = CounterRng::new(0x6d65_6469, 0);
    (0..2 * LINES).map(move |i| {
        let (a, b) = (Vec2::from(rng.next_2d()), Vec2::from(rng.next_2d()));
        if i < LINES {
            return (view.sensor.ray(a, b), true);
        }
        let d = warp::sphere(a);
        let across = warp::disk(b);
        let start = Frame::from_normal(d).to_world(Vec3::new(across.x, across.y, -1.0));
        (Ray::new(scene.sphere.center + start * scene.sphere.radius, d), false)
    })
}

/// The first contradiction along a line that begins in a medium, if that is known.
fn look(scene: &Scene, mut ray: Ray, start: Option<Option<MediumId>>) -> Option<Contradiction> {
    let (mut now, mut camera) = (start, start.is_some());
    for _ in 0..MOST_LOOKED_THROUGH {
        let hit = scene.geometry.closest(&ray)?;
        let s = scene.surface(&ray, &hit);
        if let Some(boundary) = scene.shapes[s.shape as usize].boundary {
            let leaves = s.ng.dot(ray.d) > 0.0;
            let said = if leaves { boundary.inside } else { boundary.outside };
            if let Some(arriving) = now.filter(|arriving| *arriving != said) {
                return Some(Contradiction { shape: s.shape, said, arriving, camera });
            }
            // Nothing passes through an opaque surface; what its author says of the far side does not matter.
            let passes = scene.material(&s).nature().transmits;
            now = passes.then(|| scene.medium_beyond(&s, ray.d, None));
            camera = false;
        }
        ray = s.leave(ray.d);
    }
    None
}
