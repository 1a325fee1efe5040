//! Ray queries: no gaps at shared edges, traversal finds what testing every triangle finds, and instances equal
//! copies.

use std::collections::HashMap;

use caustica::math::{Ray, Vec3};
use caustica::sampling::CounterRng;
use caustica::scene::Scene;

use crate::support::{Stage, camera, scene, scene_with};

/// Unit icosphere after `levels` subdivisions.
pub fn icosphere(levels: u32) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let unit = |v: [f64; 3]| {
        let l = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / l)
    };
    let mut points: Vec<[f64; 3]> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(unit)
    .to_vec();
    #[rustfmt::skip]
    let mut faces: Vec<[usize; 3]> = vec![
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
        [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5],
        [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middle = HashMap::new();
        let mut half = |points: &mut Vec<[f64; 3]>, a: usize, b: usize| {
            *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push(unit(std::array::from_fn(|i| points[a][i] + points[b][i])));
                points.len() - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) =
                    (half(&mut points, a, b), half(&mut points, b, c), half(&mut points, c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (points, faces)
}

pub fn obj(points: &[[f64; 3]], faces: &[[usize; 3]]) -> String {
    let mut text = String::new();
    points
        .iter()
        .for_each(|[x, y, z]| text.push_str(&format!("v {} {} {}\n", *x as f32, *y as f32, *z as f32)));
    faces.iter().for_each(|f| text.push_str(&format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1)));
    text
}

/// A scene of the triangles as one mesh, and the triangles in its coordinates.
fn soup(triangles: &[[Vec3; 3]]) -> (Stage, Vec<[Vec3; 3]>) {
    let points: Vec<[f64; 3]> = triangles.iter().flatten().map(|v| v.to_array().map(f64::from)).collect();
    let faces: Vec<[usize; 3]> = (0..triangles.len()).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let scene = mesh_scene(&obj(&points, &faces));
    let moved = triangles.iter().map(|t| t.map(|v| ours(&scene, v.to_array()))).collect();
    (scene, moved)
}

fn mesh_scene(text: &str) -> Stage {
    let shape = "<shape type='obj'><string name='filename' value='mesh.obj'/>
                 <boolean name='face_normals' value='true'/></shape>";
    scene_with(&format!("{}{shape}", camera("0,0,0", "0,0,1", 40.0, 4)), &[("mesh.obj", text)])
}

/// A point of the scene file in the coordinates of the compiled scene.
pub fn ours(scene: &Scene, p: [f32; 3]) -> Vec3 {
    Vec3::from(std::array::from_fn(|i| (f64::from(p[i]) - scene.origin[i]) as f32))
}

/// Random numbers, uniform in [−1, 1).
pub struct Floats(CounterRng);

impl Floats {
    pub fn new(seed: u64) -> Self {
        Self(CounterRng::new(seed, 0))
    }

    pub fn next(&mut self) -> f32 {
        self.0.next_f32() * 2.0 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n as u64) as usize
    }
}

/// A million rays from inside a closed mesh, aimed at vertices and at points of shared edges: all hit, and shadow
/// rays agree.
#[test]
fn no_ray_escapes_through_the_edges_of_a_closed_mesh() {
    let (points, faces) = icosphere(4);
    let scene = mesh_scene(&obj(&points, &faces));
    let corner = |i: usize| ours(&scene, points[i].map(|c| c as f32));
    let mut floats = Floats::new(1);
    let mut missed = 0;
    let rays = 1_000_000;
    for i in 0..rays {
        let o = floats.vector() * 0.45;
        let face = faces[floats.below(faces.len())];
        let (a, b) = (corner(face[i % 3]), corner(face[(i + 1) % 3]));
        let target = match i % 4 {
            0 => a,
            1 => (a + b) * 0.5,
            _ => a + (b - a) * (floats.next() * 0.5 + 0.5),
        };
        let ray = Ray::new(o, target - o);
        missed += u32::from(scene.geometry.closest(&ray).is_none());
        missed += u32::from(!scene.geometry.occluded(&ray));
    }
    assert_eq!(missed, 0, "of {rays} rays");
}

/// The nearest hit of a ray, found by testing all triangles by signed volumes in f64.
#[derive(Debug, PartialEq)]
enum Truth {
    Miss,
    At(f64),
    /// The ray passes an edge or an end of its range within f32 rounding: both answers are right.
    Close,
}

fn truth(triangles: &[[Vec3; 3]], ray: &Ray) -> Truth {
    let d = ray.d.as_dvec3();
    let mut nearest = f64::from(ray.tmax);
    let mut found = Truth::Miss;
    for t in triangles {
        let [a, b, c] = t.map(|v| v.as_dvec3() - ray.o.as_dvec3());
        if a == b || b == c || c == a {
            continue;
        }
        let volumes = [d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a))];
        let rounding =
            1e-5 * d.length() * [a, b, c].map(|v| v.length_squared()).into_iter().fold(0.0, f64::max);
        let sides = |sign: f64| volumes.iter().any(|v| v * sign > rounding);
        if sides(1.0) && sides(-1.0) {
            continue;
        }
        if volumes.iter().any(|v| v.abs() <= rounding) {
            return Truth::Close;
        }
        let [u, v, w] = volumes;
        let at = ((a * u + b * v + c * w) / (u + v + w)).dot(d) / d.length_squared();
        if at.abs() < 1e-4 || (at - f64::from(ray.tmax)).abs() < 1e-4 {
            return Truth::Close;
        }
        if at > 0.0 && at < nearest {
            nearest = at;
            found = Truth::At(at);
        }
    }
    found
}

#[test]
fn traversal_equals_testing_every_triangle() {
    let mut floats = Floats::new(2);
    for count in [1usize, 2, 7, 8, 9, 60, 700] {
        let mut triangles: Vec<[Vec3; 3]> = Vec::new();
        for i in 0..count {
            let (a, b, c) = (floats.vector(), floats.vector(), floats.vector());
            let small = 0.3;
            triangles.push(match i % 7 {
                // A point, a needle, one of zero area, a duplicate, an axis-aligned one, and ordinary ones.
                0 if count > 2 => [a, a, a],
                1 => [a, a + b * 1e-6, a + c * small],
                2 => [a, a + b * small, a + b * 2.0 * small],
                3 => triangles[floats.below(i)],
                4 => [a, a + Vec3::X * small, a + Vec3::Y * small],
                _ => [a, a + b * small, a + c * small],
            });
        }
        let (scene, triangles) = soup(&triangles);
        let geometry = &scene.geometry;
        let (mut hits, mut close) = (0, 0);
        for i in 0..4000 {
            let o = floats.vector() * 2.0;
            let t = triangles[floats.below(count)];
            let d = match i % 4 {
                0 => floats.vector(),
                1 => t[0] - o,
                2 => (t[0] + t[1] + t[2]) / 3.0 - o,
                _ => [Vec3::X, -Vec3::Y, Vec3::Z][i % 3],
            };
            let tmax = if i % 5 == 0 { 1.0 } else { f32::INFINITY };
            let ray = Ray { tmax, ..Ray::new(o, d) };
            let got = geometry.closest(&ray).map(|h| f64::from(h.t));
            assert_eq!(geometry.occluded(&ray), got.is_some(), "{count} triangles, {ray:?}");
            match truth(&triangles, &ray) {
                Truth::Close => close += 1,
                Truth::Miss => assert_eq!(got, None, "{count} triangles, {ray:?}"),
                Truth::At(t) => {
                    hits += 1;
                    // 16 roundings of coordinates up to 3, divided by cosines down to 1e-2.
                    let near = got.is_some_and(|g| (g - t).abs() <= 1e-3 * t.max(1.0));
                    assert!(near, "{count} triangles, {ray:?}: {got:?} against {t}");
                }
            }
        }
        // One ray in four is aimed at a vertex.
        assert!(hits > 150 && close < 2500, "{count} triangles: {hits} hits, {close} too close to tell");
    }
}

/// Distance, geometric normal and shading normal that each ray finds; `None` for a miss.
fn look(scene: &Scene, rays: &[(Vec3, Vec3)]) -> Vec<Option<(f32, Vec3, Vec3)>> {
    let shift = Vec3::from(scene.origin.map(|x| x as f32));
    rays.iter()
        .map(|&(o, d)| {
            let ray = Ray::new(o - shift, d);
            let hit = scene.geometry.closest(&ray);
            assert_eq!(scene.geometry.occluded(&ray), hit.is_some());
            hit.map(|h| {
                let s = scene.surface(&ray, &h);
                (h.t, s.ng, s.frame.n)
            })
        })
        .collect()
}

/// An instance of a group equals its shapes placed directly with the same transform, also when mirrored (normals
/// are then compared up to sign: like Mitsuba, we flip those of a mirrored shape, but not those of a mirrored
/// instance). The two are computed in different coordinates, so distances agree to some roundings of the scene's
/// size (1e-5), and rays that graze a silhouette may differ (fewer than one in a thousand).
#[test]
fn instances_equal_copies() {
    let (points, faces) = icosphere(1);
    let text = obj(&points, &faces);
    let shapes = |round: &str, transform: &str| {
        let place = |own: &str| format!("<transform name='to_world'>{own}{transform}</transform>");
        format!(
            "<shape type='obj'><string name='filename' value='ball.obj'/><boolean name='face_normals' value='true'/>{}</shape>
             <shape type='cube'>{}</shape>
             <shape type='{round}'>{}</shape>",
            place("<translate x='-1.5'/>"),
            place("<scale value='0.4'/><translate y='1.2'/>"),
            place("<scale value='0.7'/><translate x='1.5'/>")
        )
    };
    let mut floats = Floats::new(4);
    let rays: Vec<(Vec3, Vec3)> = (0..30_000).map(|_| (floats.vector() * 4.0, floats.vector())).collect();
    // Mitsuba's spheres stay round where their own transform stretches them, but not where that of an instance does.
    for (round, transform) in [
        (
            "sphere",
            "<rotate x='0.267261242' y='0.534522484' z='0.801783726' angle='40'/><translate x='0.2' y='-0.1' z='0.3'/>",
        ),
        ("sphere", "<scale value='1.3'/><translate y='0.5'/>"),
        ("sphere", "<scale x='-1'/><rotate z='1' angle='20'/>"),
        ("disk", "<scale x='0.7' y='-1.2' z='1.1'/><translate z='0.4'/>"),
    ] {
        let view = camera("0,0,9", "0,0,0", 40.0, 4);
        let files = [("ball.obj", text.as_str())];
        let copies = scene_with(&format!("{view}{}", shapes(round, transform)), &files);
        let group = format!("<shape type='shapegroup' id='g'>{}</shape>", shapes(round, ""));
        let instance = format!(
            "{view}{group}<shape type='instance'><ref id='g'/><transform name='to_world'>{transform}</transform></shape>"
        );
        let instances = scene_with(&instance, &files);
        let (a, b) = (look(&copies, &rays), look(&instances, &rays));
        let mirrored = transform.contains("='-1");
        let (mut different, mut hits) = (0, 0);
        for (a, b) in a.iter().zip(&b) {
            match (a, b) {
                (Some((t, ng, ns)), Some((u, mg, ms))) => {
                    hits += 1;
                    let near = |a: Vec3, b: Vec3| {
                        let cos = if mirrored { a.dot(b).abs() } else { a.dot(b) };
                        cos > 1.0 - 1e-5
                    };
                    let same = (t - u).abs() < 1e-4 && near(*ng, *mg) && near(*ns, *ms);
                    different += u32::from(!same);
                }
                (None, None) => {}
                _ => different += 1,
            }
        }
        assert!(hits > 1000, "{hits}");
        assert!(different * 1000 < hits, "{transform}: {different} of {hits} differ");
    }
}

/// Shapes that name the same large mesh have one tree, and rays find what they find among all triangles. Where light
/// passes through something nothing is shared: such a scene is what the other is compared with. Bounds as for instances.
#[test]
fn many_copies_of_a_mesh_share_one_tree() {
    let (points, faces) = icosphere(4);
    let text = obj(&points, &faces);
    let mut floats = Floats::new(8);
    let mut shapes = String::new();
    let count = 1_000_000 / faces.len() + 2;
    for _ in 0..count {
        let [at, axis] = [floats.vector() * 9.0, floats.vector().normalize()];
        shapes += &format!(
            "<shape type='obj'><string name='filename' value='ball.obj'/><transform name='to_world'>
             <scale value='0.8'/><rotate x='{}' y='{}' z='{}' angle='70'/><translate x='{}' y='{}' z='{}'/>
             </transform></shape>",
            axis.x, axis.y, axis.z, at.x, at.y, at.z
        );
    }
    // Mirrored and stretched ones stand for themselves.
    for scale in ["1, 1, -1", "1, 2, 1"] {
        shapes += &format!(
            "<shape type='obj'><string name='filename' value='ball.obj'/><transform name='to_world'>
             <scale value='{scale}'/></transform></shape>"
        );
    }
    let view = camera("0,0,30", "0,0,0", 40.0, 4);
    let files = [("ball.obj", text.as_str())];
    let glass =
        "<shape type='sphere'><point name='center' value='0,900,0'/><bsdf type='dielectric'/></shape>";
    let shared = scene_with(&format!("{view}{shapes}"), &files);
    let apart = scene_with(&format!("{view}{shapes}{glass}"), &files);
    assert_eq!(shared.0.scene.geometry.instances.len(), count);
    assert_eq!(apart.0.scene.geometry.instances.len(), 0);
    assert!(shared.0.scene.geometry.bytes() * 20 < apart.0.scene.geometry.bytes());
    let rays: Vec<(Vec3, Vec3)> = (0..20_000).map(|_| (floats.vector() * 12.0, floats.vector())).collect();
    let (mut different, mut hits) = (0, 0);
    for (o, d) in &rays {
        let ray = Ray::new(*o, *d);
        let [a, b] = [&shared.0.scene, &apart.0.scene].map(|scene| {
            let hit = scene.geometry.closest(&ray)?;
            let s = scene.surface(&ray, &hit);
            Some((hit.t, s.ng, s.frame.n, scene.shape_number(&hit, &s)))
        });
        hits += u32::from(a.is_some());
        different += u32::from(match (a, b) {
            (Some((t, ng, ns, i)), Some((u, mg, ms, j))) => {
                (t - u).abs() > 1e-4 || ng.dot(mg) < 1.0 - 1e-4 || ns.dot(ms) < 1.0 - 1e-5 || i != j
            }
            (a, b) => a.is_some() != b.is_some(),
        });
    }
    assert!(hits > 1000, "{hits}");
    assert!(different * 1000 < hits, "{different} of {hits} differ");
}

/// A scene far from the origin loses no precision, because the compiled scene has an origin of its own.
#[test]
fn a_scene_far_from_the_origin_is_the_same_scene() {
    let body = |at: f64| {
        format!(
            "{}<shape type='cube'><transform name='to_world'><scale value='0.5'/><translate x='{at}'/></transform></shape>
             <shape type='sphere'><point name='center' value='{at},1,0'/><float name='radius' value='0.5'/></shape>",
            camera(&format!("{at},0,5"), &format!("{at},0,0"), 40.0, 4)
        )
    };
    let (near, far) = (scene(&body(0.0)), scene(&body(1e7)));
    assert_eq!(near.0.view.sensor.position, far.0.view.sensor.position);
    let mut floats = Floats::new(6);
    for _ in 0..2000 {
        let ray = Ray::new(floats.vector() * 3.0, floats.vector());
        let t = |s: &Scene| s.geometry.closest(&ray).map(|h| h.t);
        assert_eq!(t(&near), t(&far));
    }
}
