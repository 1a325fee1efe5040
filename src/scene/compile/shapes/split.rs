//! Splits triangles that are much larger than their distance from the camera. A point on a triangle is only as
//! precise as its farthest corner, and that error must not be visible.

use caustica_formats::ir::Transform;
use caustica_formats::mesh::Mesh;

/// Largest ratio of extent to distance of a triangle that is not split. Ray origins are then lifted by at most
/// 2⁻¹¹ of that distance, less than a pixel.
const RATIO: f64 = 256.0;

/// Smallest piece relative to the whole triangle, for a camera that touches it.
const SMALLEST: f64 = 1.0 / (1 << 20) as f64;

/// Largest displacement of the surface by a cut, relative to the length of the edge that is cut.
const FLAT: f64 = 1e-6;

/// A mesh with triangles that were cut.
#[derive(Debug)]
pub struct Pieces {
    pub mesh: Mesh,
    /// Which triangle each was before.
    pub authored: Vec<u32>,
}

/// The mesh with triangles cut towards the origin of the level, or `None` when all may stay.
pub fn split(mesh: &Mesh, to_level: &Transform) -> Option<Pieces> {
    let place = |p: [f32; 3]| to_level.point(p.map(f64::from));
    let large = |t: &[u32; 3]| {
        let corners = t.map(|i| place(mesh.positions[i as usize]));
        is_large(&corners, 0.0)
    };
    let first = mesh.triangles.iter().position(large)?;
    let mut out = Mesh { triangles: mesh.triangles[..first].to_vec(), ..mesh.clone() };
    let mut origins: Vec<usize> = (0..first).collect();
    for (i, &t) in mesh.triangles.iter().enumerate().skip(first) {
        let floor = SMALLEST * extent(&t.map(|i| place(mesh.positions[i as usize])));
        let mut pending = vec![t];
        while let Some(t) = pending.pop() {
            let corners = t.map(|i| place(out.positions[i as usize]));
            let halves = if is_large(&corners, floor) { halve(&mut out, t, &corners) } else { None };
            match halves {
                Some(halves) => pending.extend(halves),
                None => {
                    out.triangles.push(t);
                    origins.push(i);
                }
            }
        }
    }
    for a in &mut out.attributes {
        if a.is_per_face() {
            a.values = origins.iter().map(|&i| a.values[i]).collect();
        }
    }
    let authored = origins.into_iter().map(|i| i as u32).collect();
    Some(Pieces { mesh: out, authored })
}

/// Largest coordinate of a corner.
fn extent(corners: &[[f64; 3]; 3]) -> f64 {
    corners.iter().flatten().fold(0.0, |m, x| m.max(x.abs()))
}

/// Whether the triangle reaches much farther than the distance at which its box begins.
fn is_large(corners: &[[f64; 3]; 3], floor: f64) -> bool {
    let gap: [f64; 3] = std::array::from_fn(|a| {
        let along = corners.map(|c| c[a]);
        let (lo, hi) =
            (along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(f64::MIN, f64::max));
        lo.max(-hi).max(0.0)
    });
    extent(corners) > RATIO * length(gap).max(floor)
}

/// The two halves on either side of the middle of the longest edge, unless rounding would bend them.
fn halve(mesh: &mut Mesh, t: [u32; 3], corners: &[[f64; 3]; 3]) -> Option<[[u32; 3]; 2]> {
    let edge = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        length(std::array::from_fn(|i| a[i] - b[i]))
    };
    let k = (0..3).max_by(|&a, &b| edge(a).total_cmp(&edge(b)))?;
    let [a, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
    let [pa, pb, pc] = [a, b, c].map(|i| mesh.positions[i as usize].map(f64::from));
    let exact: [f64; 3] = std::array::from_fn(|i| 0.5 * (pa[i] + pb[i]));
    let rounded = exact.map(|x| x as f32);
    let normal = cross(difference(pb, pa), difference(pc, pa));
    let off: f64 = (0..3).map(|i| (f64::from(rounded[i]) - exact[i]) * normal[i]).sum();
    if off.abs() > FLAT * length(difference(pb, pa)) * length(normal) {
        return None;
    }
    let m = mesh.positions.len() as u32;
    let [ia, ib] = [a as usize, b as usize];
    mesh.positions.push(rounded);
    if !mesh.normals.is_empty() {
        // Half of the sum, not of unit length, is what the whole triangle has there.
        mesh.normals.push(middle(mesh.normals[ia], mesh.normals[ib]));
    }
    if !mesh.uvs.is_empty() {
        let (p, q) = (mesh.uvs[ia], mesh.uvs[ib]);
        mesh.uvs.push([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
    }
    for attribute in mesh.attributes.iter_mut().filter(|a| !a.is_per_face()) {
        let value = middle(attribute.values[ia], attribute.values[ib]);
        attribute.values.push(value);
    }
    Some([[a, m, c], [m, b, c]])
}

fn middle(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        let half = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize].map(f64::from));
            0.5 * length(cross(difference(b, a), difference(c, a)))
        };
        mesh.triangles.iter().map(half).sum()
    }

    #[test]
    fn a_vast_plane_is_cut_near_the_camera_and_keeps_its_area() {
        let mesh = Mesh {
            positions: vec![[-1e6, -4.0, 1e6], [1e6, -4.0, 1e6], [1e6, -4.0, -1e6], [-1e6, -4.0, -1e6]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let cut = split(&mesh, &Transform::IDENTITY).expect("a plane of 1e6 seen from 4").mesh;
        assert!(cut.triangles.len() < 400, "{}", cut.triangles.len());
        assert!((area(&cut) / area(&mesh) - 1.0).abs() < 1e-6);
        for (p, uv) in cut.positions.iter().zip(&cut.uvs) {
            assert_eq!(p[1], -4.0);
            assert!((f64::from(uv[0]) - (f64::from(p[0]) / 2e6 + 0.5)).abs() < 1e-6);
        }
        assert!(split(&cut, &Transform::IDENTITY).is_none());
    }

    /// Cut where the camera touches it, to an end.
    #[test]
    fn a_plane_through_the_camera_is_cut_a_finite_number_of_times() {
        let mesh = Mesh {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let cut = split(&mesh, &Transform::IDENTITY).expect("no distance at all").mesh;
        assert!(cut.triangles.len() < 400, "{}", cut.triangles.len());
    }
}
