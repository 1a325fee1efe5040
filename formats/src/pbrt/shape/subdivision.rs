//! Loop's subdivision surfaces (Loop 1987) with the boundary rules of Hoppe et al. 1994: refined control
//! meshes, then limit positions and normals.

use std::collections::HashMap;
use std::f64::consts::PI;

use crate::ir::InlineMesh;

type Point = [f64; 3];

/// The new vertex in its middle, and the corners opposite to it.
type Edge = (u32, [Option<u32>; 2]);

/// Refines `levels` times and moves the vertices to the limit surface.
pub(super) fn subdivide(
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    levels: u32,
) -> Result<InlineMesh, String> {
    let mut points: Vec<Point> = positions.into_iter().map(|p| p.map(f64::from)).collect();
    let mut triangles = triangles;
    for _ in 0..levels {
        (points, triangles) = refine(&points, &triangles)?;
    }
    let rings = rings(points.len(), &triangles)?;
    let limit: Vec<Point> = points.iter().zip(&rings).map(|(p, ring)| limit(*p, ring, &points)).collect();
    // The tangents want the control points' ring; of the limit points they have the same directions.
    let normals = limit.iter().zip(&rings).map(|(p, ring)| normal(*p, ring, &limit)).collect();
    Ok(InlineMesh {
        positions: limit.iter().map(|p| p.map(|x| x as f32)).collect(),
        normals,
        uvs: Vec::new(),
        triangles,
        made_from: Some("loopsubdiv".to_owned()),
    })
}

/// The neighbours of a vertex, counter-clockwise.
struct Ring {
    vertices: Vec<u32>,
    /// The first and last of them are on the boundary, as the vertex itself.
    boundary: bool,
}

/// The rings of all vertices; fails where the surface is not a manifold.
fn rings(count: usize, triangles: &[[u32; 3]]) -> Result<Vec<Ring>, String> {
    // Around each vertex the corner after it leads to the one before it.
    let mut steps: Vec<Vec<(u32, u32)>> = vec![Vec::new(); count];
    for t in triangles {
        for corner in 0..3 {
            let (v, a, b) = (t[corner], t[(corner + 1) % 3], t[(corner + 2) % 3]);
            if v == a || v == b {
                return Err(format!("a triangle has vertex {v} twice"));
            }
            if steps[v as usize].iter().any(|step| step.0 == a) {
                return Err(format!(
                    "the edge from vertex {v} to vertex {a} has two triangles on the same side: \
                     the surface is no manifold"
                ));
            }
            steps[v as usize].push((a, b));
        }
    }
    steps.iter().enumerate().map(|(vertex, steps)| ring(vertex, steps)).collect()
}

fn ring(vertex: usize, steps: &[(u32, u32)]) -> Result<Ring, String> {
    let start = steps.iter().find(|(a, _)| steps.iter().all(|(_, b)| b != a));
    let boundary = start.is_some();
    let Some(&(first, _)) = start.or(steps.first()) else {
        return Ok(Ring { vertices: Vec::new(), boundary: false });
    };
    let mut vertices = vec![first];
    let mut at = first;
    while let Some((_, next)) = steps.iter().find(|(a, _)| *a == at) {
        if *next == first {
            break;
        }
        vertices.push(*next);
        at = *next;
        if vertices.len() > steps.len() + 1 {
            break;
        }
    }
    if vertices.len() != steps.len() + usize::from(boundary) {
        return Err(format!("the triangles around vertex {vertex} do not form a single fan"));
    }
    Ok(Ring { vertices, boundary })
}

fn refine(points: &[Point], triangles: &[[u32; 3]]) -> Result<(Vec<Point>, Vec<[u32; 3]>), String> {
    let rings = rings(points.len(), triangles)?;
    let mut refined: Vec<Point> = points.iter().zip(&rings).map(|(p, ring)| even(*p, ring, points)).collect();
    let mut edges: HashMap<(u32, u32), Edge> = HashMap::new();
    let mut finer = Vec::with_capacity(triangles.len() * 4);
    for t in triangles {
        let mut middle = [0; 3];
        for corner in 0..3 {
            let (a, b, opposite) = (t[corner], t[(corner + 1) % 3], t[(corner + 2) % 3]);
            let entry = edges.entry((a.min(b), a.max(b))).or_insert_with(|| {
                refined.push([0.0; 3]);
                (refined.len() as u32 - 1, [None; 2])
            });
            middle[corner] = entry.0;
            let free = entry.1.iter_mut().find(|side| side.is_none());
            let Some(side) = free else {
                return Err(format!("the edge between vertices {a} and {b} has more than two triangles"));
            };
            *side = Some(opposite);
        }
        for corner in 0..3 {
            finer.push([t[corner], middle[corner], middle[(corner + 2) % 3]]);
        }
        finer.push(middle);
    }
    for (&(a, b), &(index, opposite)) in &edges {
        let [a, b] = [a, b].map(|v| points[v as usize]);
        refined[index as usize] = match opposite {
            [Some(c), Some(d)] => {
                let [c, d] = [c, d].map(|v| points[v as usize]);
                std::array::from_fn(|i| 0.375 * (a[i] + b[i]) + 0.125 * (c[i] + d[i]))
            }
            _ => std::array::from_fn(|i| 0.5 * (a[i] + b[i])),
        };
    }
    Ok((refined, finer))
}

fn beta(valence: usize) -> f64 {
    if valence == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * valence as f64) }
}

/// (1 − n·weight)·p + weight·Σ neighbours.
fn weighted(p: Point, neighbours: &[u32], weight: f64, points: &[Point]) -> Point {
    let own = 1.0 - neighbours.len() as f64 * weight;
    std::array::from_fn(|i| {
        own * p[i] + weight * neighbours.iter().map(|&v| points[v as usize][i]).sum::<f64>()
    })
}

fn ends(ring: &Ring) -> [u32; 2] {
    [ring.vertices[0], ring.vertices[ring.vertices.len() - 1]]
}

fn even(p: Point, ring: &Ring, points: &[Point]) -> Point {
    match ring.vertices.len() {
        0 => p,
        _ if ring.boundary => weighted(p, &ends(ring), 1.0 / 8.0, points),
        valence => weighted(p, &ring.vertices, beta(valence), points),
    }
}

fn limit(p: Point, ring: &Ring, points: &[Point]) -> Point {
    match ring.vertices.len() {
        0 => p,
        // pbrt's weight; the limit of the rule above would have 1/6.
        _ if ring.boundary => weighted(p, &ends(ring), 1.0 / 5.0, points),
        valence => {
            let weight = 1.0 / (valence as f64 + 3.0 / (8.0 * beta(valence)));
            weighted(p, &ring.vertices, weight, points)
        }
    }
}

/// pbrt's tangents span the plane the other way round: its normals point to where the triangles are
/// clockwise. `InlineMesh` lets normals decide about the side.
fn normal(p: Point, ring: &Ring, points: &[Point]) -> [f32; 3] {
    let n = ring.vertices.len();
    if n < 2 {
        return [0.0; 3];
    }
    let r = |k: usize| points[ring.vertices[k] as usize];
    let sum = |weight: &dyn Fn(usize) -> f64| -> Point {
        std::array::from_fn(|i| (0..n).map(|k| weight(k) * r(k)[i]).sum())
    };
    let (along, across) = if ring.boundary {
        let along: Point = std::array::from_fn(|i| r(0)[i] - r(n - 1)[i]);
        let inwards: Point = match n {
            2 => std::array::from_fn(|i| r(0)[i] + r(1)[i] - 2.0 * p[i]),
            3 => std::array::from_fn(|i| r(1)[i] - p[i]),
            4 => std::array::from_fn(|i| 2.0 * (r(1)[i] + r(2)[i]) - r(0)[i] - r(3)[i] - 2.0 * p[i]),
            _ => {
                let theta = PI / (n - 1) as f64;
                let weight = |k: usize| {
                    if k == 0 || k == n - 1 {
                        -theta.sin()
                    } else {
                        (2.0 - 2.0 * theta.cos()) * (k as f64 * theta).sin()
                    }
                };
                sum(&weight)
            }
        };
        (along, inwards)
    } else {
        let angle = |k: usize| 2.0 * PI * k as f64 / n as f64;
        (sum(&|k| angle(k).cos()), sum(&|k| angle(k).sin()))
    };
    let m = [
        across[1] * along[2] - across[2] * along[1],
        across[2] * along[0] - across[0] * along[2],
        across[0] * along[1] - across[1] * along[0],
    ];
    let length = m.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { m.map(|x| (x / length) as f32) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRA: [[f32; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    const TETRA_FACES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

    fn length(v: [f32; 3]) -> f32 {
        v.iter().map(|x| x * x).sum::<f32>().sqrt()
    }

    fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
        (0..3).map(|i| a[i] * b[i]).sum()
    }

    /// By symmetry the limit of a corner of the tetrahedron p is a multiple of p: with weight
    /// γ = 1/(3 + 3/(8·3/16)) = 1/5 and Σ neighbours = −p, (1 − 3/5)p − p/5 = p/5.
    #[test]
    fn the_corners_of_a_tetrahedron() {
        let mesh = subdivide(TETRA.to_vec(), TETRA_FACES.to_vec(), 0).unwrap();
        for (p, control) in mesh.positions.iter().zip(TETRA) {
            assert!((0..3).all(|i| (p[i] - control[i] / 5.0).abs() < 1e-6), "{p:?}");
        }
    }

    /// The limit does not depend on the level; counts follow from V' = V + E, F' = 4F.
    #[test]
    fn a_closed_surface() {
        for levels in 0..4 {
            let mesh = subdivide(TETRA.to_vec(), TETRA_FACES.to_vec(), levels).unwrap();
            let faces = 4 << (2 * levels);
            assert_eq!((mesh.triangles.len(), mesh.positions.len()), (faces, faces / 2 + 2));
            let corner = mesh.positions[0];
            assert!(corner.iter().all(|x| (x - 0.2).abs() < 1e-6), "{corner:?}");
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                assert!((length(*n) - 1.0).abs() < 1e-6);
                // These triangles run counter-clockwise seen from outside, so pbrt's normals point inwards.
                assert!(dot(*p, *n) < 0.0, "{p:?} {n:?}");
            }
        }
    }

    /// A flat grid stays flat and within its outline.
    #[test]
    fn a_surface_with_a_boundary() {
        let points = (0..9).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
        let mut faces = Vec::new();
        for cell in [0, 1, 3, 4] {
            faces.push([cell, cell + 1, cell + 4]);
            faces.push([cell, cell + 4, cell + 3]);
        }
        let mesh = subdivide(points, faces, 2).unwrap();
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert_eq!(p[2], 0.0);
            assert!((n[2] + 1.0).abs() < 1e-6, "{p:?} {n:?}");
            assert!(p[0] > -1e-6 && p[0] < 2.0 + 1e-6);
        }
    }

    /// 3/5·0 + 1/5 of the neighbours (1, 0) and (0, 1).
    #[test]
    fn the_corner_of_a_boundary() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = subdivide(points, vec![[0, 1, 2]], 0).unwrap();
        assert!((mesh.positions[0][0] - 0.2).abs() < 1e-6 && (mesh.positions[0][1] - 0.2).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_manifold() {
        let twice = subdivide(TETRA.to_vec(), vec![[0, 1, 2], [0, 1, 3]], 1).unwrap_err();
        assert!(twice.contains("two triangles on the same side"), "{twice}");
        let fans = subdivide([TETRA.as_slice(), &[[5.0; 3]]].concat(), vec![[0, 1, 2], [0, 3, 4]], 1);
        assert!(fans.unwrap_err().contains("do not form a single fan"));
        assert!(subdivide(TETRA.to_vec(), vec![[0, 0, 1]], 1).unwrap_err().contains("twice"));
    }
}
