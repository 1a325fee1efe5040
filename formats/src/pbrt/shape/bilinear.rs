//! Bilinear patches → triangles: two where that is exact, a grid where the patch is curved.

use super::mesh::Cage;
use crate::ir::InlineMesh;

/// How far the triangles may leave the patch, in parts of its size (of the uv range for uv).
const TOLERANCE: f64 = 1e-3;
/// Most cells along a side.
const MAX_CELLS: usize = 32;
/// Most triangles of a mesh because of curvature alone.
const MAX_TRIANGLES: usize = 1 << 22;

/// The corners of a patch in the order 00 10 01 11 of (u, v).
type Corners<const N: usize> = [[f64; N]; 4];

pub(super) fn tessellate(cage: &Cage) -> InlineMesh {
    let patches = cage.indices.as_chunks::<4>().0;
    // The same grid for all patches, so that those with a common edge keep it.
    let cells = patches.iter().map(|patch| cells(cage, patch)).max().unwrap_or(1);
    let most = (MAX_TRIANGLES / (2 * patches.len().max(1))).isqrt().max(1);
    let cells = cells.min(most);
    let mut mesh = InlineMesh { made_from: Some("bilinearmesh".to_owned()), ..InlineMesh::default() };
    for patch in patches {
        add(&mut mesh, cage, patch, cells);
    }
    mesh
}

fn corners<const N: usize>(items: &[[f32; N]], patch: &[u32; 4]) -> Option<Corners<N>> {
    (!items.is_empty()).then(|| patch.map(|i| items[i as usize].map(f64::from)))
}

/// p00 − p10 − p01 + p11: zero for a parallelogram.
fn twist<const N: usize>(c: &Corners<N>) -> [f64; N] {
    std::array::from_fn(|i| c[0][i] - c[1][i] - c[2][i] + c[3][i])
}

fn length<const N: usize>(v: [f64; N]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn size<const N: usize>(c: &Corners<N>) -> f64 {
    let diagonal = |a: usize, b: usize| length::<N>(std::array::from_fn(|i| c[a][i] - c[b][i]));
    diagonal(0, 3).max(diagonal(1, 2))
}

/// Cells along a side that keep geometry and uv within the tolerance.
fn cells(cage: &Cage, patch: &[u32; 4]) -> usize {
    let Some(p) = corners(&cage.positions, patch) else { return 1 };
    let t = twist(&p);
    let sub = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| p[a][i] - p[b][i]) };
    let n = cross(sub(3, 0), sub(2, 1));
    let area = length(n);
    // What of the twist leaves the plane bends the surface; the rest only the coordinates on it.
    let bend = if area > 0.0 { dot(t, n).abs() / area } else { length(t) };
    let mut worst = relative(bend, size(&p));
    if let Some(uv) = corners(&cage.uvs, patch) {
        worst = worst.max(relative(length(twist(&uv)), size(&uv))).max(relative(length(t), size(&p)));
    }
    // The middle of a cell of n × n is a quarter of the twist / n² away from its diagonal.
    ((worst / 4.0 / TOLERANCE).sqrt().ceil() as usize).clamp(1, MAX_CELLS)
}

fn relative(deviation: f64, size: f64) -> f64 {
    if size > 0.0 && deviation > 1e-6 * size { deviation / size } else { 0.0 }
}

fn at<const N: usize>(c: &Corners<N>, u: f64, v: f64) -> [f64; N] {
    let w = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    std::array::from_fn(|i| (0..4).map(|k| w[k] * c[k][i]).sum())
}

fn add(mesh: &mut InlineMesh, cage: &Cage, patch: &[u32; 4], cells: usize) {
    const UNIT: Corners<2> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let Some(p) = corners(&cage.positions, patch) else { return };
    let uv = corners(&cage.uvs, patch).unwrap_or(UNIT);
    let normals = corners(&cage.normals, patch);
    let first = mesh.positions.len() as u32;
    for j in 0..=cells {
        for i in 0..=cells {
            let (u, v) = (i as f64 / cells as f64, j as f64 / cells as f64);
            mesh.positions.push(at(&p, u, v).map(|x| x as f32));
            mesh.uvs.push(at(&uv, u, v).map(|x| x as f32));
            if let Some(normals) = &normals {
                mesh.normals.push(at(normals, u, v).map(|x| x as f32));
            } else if cells > 1 {
                mesh.normals.push(normal(&p, u, v));
            }
        }
    }
    let row = cells as u32 + 1;
    for j in 0..cells as u32 {
        for i in 0..cells as u32 {
            let a = first + j * row + i;
            mesh.triangles.push([a, a + 1, a + row + 1]);
            mesh.triangles.push([a, a + row + 1, a + row]);
        }
    }
}

/// ∂p/∂u × ∂p/∂v of the exact patch.
fn normal(p: &Corners<3>, u: f64, v: f64) -> [f32; 3] {
    let du = std::array::from_fn(|i| (1.0 - v) * (p[1][i] - p[0][i]) + v * (p[3][i] - p[2][i]));
    let dv = std::array::from_fn(|i| (1.0 - u) * (p[2][i] - p[0][i]) + u * (p[3][i] - p[1][i]));
    let n = cross(du, dv);
    let length = length(n);
    if length > 0.0 { n.map(|x| (x / length) as f32) } else { [0.0; 3] }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(p: [[f32; 3]; 4]) -> InlineMesh {
        let cage = Cage { positions: p.to_vec(), normals: vec![], uvs: vec![], indices: vec![0, 1, 2, 3] };
        tessellate(&cage)
    }

    #[test]
    fn a_flat_patch_is_two_triangles_facing_du_cross_dv() {
        let mesh = patch([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
        assert_eq!(mesh.triangles, [[0, 1, 3], [0, 3, 2]]);
        assert!(mesh.normals.is_empty());
        assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    }

    /// z = uv. The middle of each cell's diagonal is the worst place: within the tolerance of the size,
    /// √3, along the normal in the middle, whose z is 2/√6, plus rounding to f32.
    #[test]
    fn a_saddle_is_followed() {
        let mesh = patch([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]);
        assert!(mesh.triangles.len() > 100, "{}", mesh.triangles.len());
        for t in &mesh.triangles {
            let [a, _, c] = t.map(|i| mesh.positions[i as usize]);
            let m: [f64; 3] = std::array::from_fn(|i| f64::from(a[i] + c[i]) / 2.0);
            assert!(
                (m[2] - m[0] * m[1]).abs() < TOLERANCE * 3.0_f64.sqrt() * 6.0_f64.sqrt() / 2.0 + 1e-6,
                "{m:?}"
            );
        }
        let last = mesh.normals.last().unwrap();
        let expected = [-1.0, -1.0, 1.0].map(|x| x / 3.0_f32.sqrt());
        assert!((0..3).all(|i| (last[i] - expected[i]).abs() < 1e-6), "{last:?}");
    }
}
