//! Smoothing up to a crease angle: an edge is smooth when its two faces meet at no more than that
//! angle, and the faces around a point that smooth edges connect share one normal there.

use super::Mesh;
use super::normals::{FALLBACK, add, corner_normals, dot, face_normal, unit};

/// `mesh` with its vertices split along creases and all normals computed. Vertices at the same
/// position count as one point, so seams of the texture coordinates stay smooth.
pub(super) fn split(mesh: &Mesh, degrees: f64) -> Mesh {
    let points = weld(mesh);
    let smooth = degrees.to_radians().cos();
    let faces: Vec<_> = mesh.triangles.iter().map(|&t| face_normal(mesh, t)).collect();

    let mut groups = Groups::new(mesh.triangles.len() * 3);
    for pair in edges(mesh, &points).windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        let normals = (faces[a.face()], faces[b.face()]);
        if let ((true, Some(na)), Some(nb)) = ((a.ends == b.ends, normals.0), normals.1)
            && dot(na, nb) >= smooth - 1e-9
        {
            for (ca, cb) in a.corners.into_iter().zip(b.corners) {
                groups.join(ca, cb);
            }
        }
    }

    let mut sums = vec![[0.0; 3]; mesh.triangles.len() * 3];
    for (index, &triangle) in mesh.triangles.iter().enumerate() {
        for (corner, weighted) in corner_normals(mesh, triangle).into_iter().enumerate() {
            let root = groups.root((index * 3 + corner) as u32);
            add(&mut sums[root as usize], weighted);
        }
    }
    rebuild(mesh, &mut groups, &sums)
}

/// An edge of a triangle with its ends as points, the smaller first.
struct Edge {
    ends: [u32; 2],
    /// The triangle's corners at these ends.
    corners: [u32; 2],
}

impl Edge {
    fn face(&self) -> usize {
        self.corners[0] as usize / 3
    }
}

/// All edges, those of the same two points next to each other.
fn edges(mesh: &Mesh, points: &[u32]) -> Vec<Edge> {
    let mut edges: Vec<Edge> = mesh
        .triangles
        .iter()
        .enumerate()
        .flat_map(|(face, triangle)| {
            (0..3).map(move |side| {
                let corners = [side, (side + 1) % 3];
                let ends = corners.map(|corner| points[triangle[corner] as usize]);
                let corners = corners.map(|corner| (face * 3 + corner) as u32);
                if ends[0] <= ends[1] {
                    Edge { ends, corners }
                } else {
                    Edge { ends: [ends[1], ends[0]], corners: [corners[1], corners[0]] }
                }
            })
        })
        .collect();
    edges.sort_by_key(|edge| (edge.ends, edge.corners));
    edges
}

/// For every vertex the first vertex at the same position.
fn weld(mesh: &Mesh) -> Vec<u32> {
    // Adding zero turns −0 into 0.
    let key = |vertex: &u32| mesh.positions[*vertex as usize].map(|c| (c + 0.0).to_bits());
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_by_key(|vertex| (key(vertex), *vertex));
    let mut points = vec![0; order.len()];
    for run in order.chunk_by(|a, b| key(a) == key(b)) {
        for &vertex in run {
            points[vertex as usize] = run[0];
        }
    }
    points
}

/// One vertex per pair of old vertex and group of corners.
fn rebuild(mesh: &Mesh, groups: &mut Groups, sums: &[[f64; 3]]) -> Mesh {
    let mut corners: Vec<(u32, u32, u32)> = (0..mesh.triangles.len() as u32 * 3)
        .map(|c| (mesh.triangles[c as usize / 3][c as usize % 3], groups.root(c), c))
        .collect();
    corners.sort_unstable();
    let triangles = vec![[0; 3]; mesh.triangles.len()];
    let mut result = Mesh { triangles, computed_normals: true, ..Mesh::default() };
    result.attributes = mesh.attributes.clone();
    let pairs = result.attributes.iter_mut().zip(&mesh.attributes);
    let (mut per_vertex, sources): (Vec<_>, Vec<_>) = pairs.filter(|(a, _)| !a.is_per_face()).unzip();
    per_vertex.iter_mut().for_each(|a| a.values.clear());
    let mut previous = None;
    for (vertex, group, corner) in corners {
        if previous != Some((vertex, group)) {
            previous = Some((vertex, group));
            result.positions.push(mesh.positions[vertex as usize]);
            result.normals.push(unit(sums[group as usize]).unwrap_or(FALLBACK));
            result.uvs.extend(mesh.uvs.get(vertex as usize));
            for (list, source) in per_vertex.iter_mut().zip(&sources) {
                list.values.extend(source.values.get(vertex as usize));
            }
        }
        let index = result.positions.len() as u32 - 1;
        result.triangles[corner as usize / 3][corner as usize % 3] = index;
    }
    result
}

/// Disjoint sets of triangle corners.
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Groups { parents: (0..count as u32).collect() }
    }

    fn root(&mut self, mut item: u32) -> u32 {
        while self.parents[item as usize] != item {
            let parent = self.parents[item as usize];
            self.parents[item as usize] = self.parents[parent as usize];
            item = parent;
        }
        item
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
