//! Vertex normals: the sum of the adjacent faces' normals, each weighted by its angle at the vertex
//! (Thürmer and Wüthrich 1998), as Mitsuba computes them.

use super::Mesh;

/// Normalises the normals of `mesh` and computes those that are missing.
pub(super) fn complete(mesh: &mut Mesh) {
    let mut missing = mesh.normals.is_empty();
    mesh.computed_normals = missing && !mesh.positions.is_empty();
    for normal in &mut mesh.normals {
        *normal = unit(normal.map(f64::from)).unwrap_or([0.0; 3]);
        missing |= *normal == [0.0; 3];
    }
    if !missing {
        return;
    }
    let mut sums = vec![[0.0; 3]; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        for (vertex, weighted) in triangle.into_iter().zip(corner_normals(mesh, triangle)) {
            add(&mut sums[vertex as usize], weighted);
        }
    }
    mesh.normals.resize(mesh.positions.len(), [0.0; 3]);
    for (normal, sum) in mesh.normals.iter_mut().zip(sums) {
        if *normal == [0.0; 3] {
            *normal = unit(sum).unwrap_or(FALLBACK);
        }
    }
}

/// For vertices of degenerate or no triangles, where no direction is better than another.
pub(super) const FALLBACK: [f32; 3] = [0.0, 0.0, 1.0];

/// The face normal times the angle at each corner; zero for degenerate triangles.
pub(super) fn corner_normals(mesh: &Mesh, triangle: [u32; 3]) -> [[f64; 3]; 3] {
    let [p0, p1, p2] = triangle.map(|vertex| mesh.positions[vertex as usize].map(f64::from));
    let edges = [sub(p1, p0), sub(p2, p1), sub(p0, p2)];
    let Some(normal) = unit64(cross(edges[0], edges[1])) else { return [[0.0; 3]; 3] };
    std::array::from_fn(|corner| {
        let (next, previous) = (edges[corner], edges[(corner + 2) % 3].map(|c| -c));
        let across = cross(next, previous);
        let angle = dot(across, across).sqrt().atan2(dot(next, previous));
        normal.map(|c| c * angle)
    })
}

/// Unit normal of a face, `None` when it is degenerate.
pub(super) fn face_normal(mesh: &Mesh, triangle: [u32; 3]) -> Option<[f64; 3]> {
    let [p0, p1, p2] = triangle.map(|vertex| mesh.positions[vertex as usize].map(f64::from));
    unit64(cross(sub(p1, p0), sub(p2, p0)))
}

pub(super) fn unit(v: [f64; 3]) -> Option<[f32; 3]> {
    unit64(v).map(|v| v.map(|c| c as f32))
}

fn unit64(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|c| c / length))
}

pub(super) fn add(sum: &mut [f64; 3], v: [f64; 3]) {
    for (s, c) in sum.iter_mut().zip(v) {
        *s += c;
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
