//! Flat shapes as meshes: two triangles are intersected faster than a special case, with the same result.

use super::Mesh;

/// [-1, 1]² at z = 0, uv from 0 to 1. A mirroring transform turns the triangles around; `mirrored`
/// turns them back, so that the normal stays the image of +Z.
pub fn rectangle(mirrored: bool) -> Mesh {
    Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        normals: Vec::new(),
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: if mirrored { vec![[0, 2, 1], [2, 0, 3]] } else { vec![[0, 1, 2], [2, 3, 0]] },
        computed_normals: false,
        attributes: Vec::new(),
    }
}

/// [-1, 1]³ with outward normals and Mitsuba's uv on each face.
pub fn cube() -> Mesh {
    type Uv = fn([f32; 3]) -> [f32; 2];
    let faces: [(usize, f32, Uv); 6] = [
        (0, 1.0, |[_, y, z]| [0.5 * (1.0 + y), 0.5 * (1.0 - z)]),
        (0, -1.0, |[_, y, z]| [0.5 * (1.0 + y), 0.5 * (1.0 + z)]),
        (1, 1.0, |[x, _, z]| [0.5 * (1.0 - x), 0.5 * (1.0 - z)]),
        (1, -1.0, |[x, _, z]| [0.5 * (1.0 + z), 0.5 * (1.0 + x)]),
        (2, 1.0, |[x, y, _]| [0.5 * (1.0 + y), 0.5 * (1.0 + x)]),
        (2, -1.0, |[x, y, _]| [0.5 * (1.0 - y), 0.5 * (1.0 + x)]),
    ];
    let mut mesh = Mesh::default();
    for (axis, sign, uv) in faces {
        let first = mesh.positions.len() as u32;
        // Counter-clockwise seen from outside: the other two axes in cyclic order, reversed for −.
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let mut p = [0.0f32; 3];
            p[axis] = sign;
            p[a] = s * sign;
            p[b] = t;
            let mut n = [0.0f32; 3];
            n[axis] = sign;
            mesh.positions.push(p);
            mesh.normals.push(n);
            mesh.uvs.push(uv(p));
        }
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.triangles.push([first + 2, first + 3, first]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_is_closed_and_faces_outwards() {
        let m = cube();
        assert_eq!((m.positions.len(), m.triangles.len()), (24, 12));
        for t in &m.triangles {
            let [a, b, c] = t.map(|i| m.positions[i as usize]);
            let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
            let n = [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]);
            let dot = |w: [f32; 3]| (0..3).map(|i| n[i] * w[i]).sum::<f32>();
            assert!(dot(m.normals[t[0] as usize]) > 0.0);
            assert!(dot(a) > 0.0);
        }
        assert!(m.uvs.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    }
}
