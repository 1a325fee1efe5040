//! The camera of a scene that has none: it looks along +Z at all of the scene, as that of Mitsuba 0.x.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_8;

use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{Fov, FovAxis, MeshFile, Projection, Sampler, Sensor, Shape, ShapeKind, Transform};
use crate::mesh::{self, MeshOptions, builtin};

/// The least and the greatest coordinates.
type Bounds = [[f64; 3]; 2];

const NOTHING: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Positions of mesh files, by path and format.
type Positions = HashMap<(std::path::PathBuf, String), Vec<[f32; 3]>>;

impl Reader<'_> {
    /// Adds a camera to a scene without one, unless there is nothing to see.
    pub fn default_sensor(&mut self) {
        let mut bounds = NOTHING;
        let mut positions = Positions::new();
        for shape in &self.scene.shapes {
            self.expand(&mut bounds, &mut positions, shape, &Transform::IDENTITY);
        }
        let [low, high] = bounds;
        let size: [f64; 3] = std::array::from_fn(|i| high[i] - low[i]);
        let wide = size[0].max(size[1]);
        if !(wide.is_finite() && wide > 0.0) {
            return;
        }
        let distance = wide / (2.0 * FRAC_PI_8.tan());
        let middle = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
        let origin = self.scene.origin;
        let text = "the scene has no sensor: a perspective one looks at all of it along +Z";
        self.problems.push(Diagnostic::warning(text, origin.0));
        let film = self.film(None, origin);
        self.scene.sensors.push(Sensor {
            name: None,
            origin,
            to_world: Transform::translate([middle[0], middle[1], low[2] - distance]),
            projection: Projection::Perspective { fov: Fov::Degrees(45.0), axis: FovAxis::X },
            screen_window: None,
            near_clip: distance / 100.0,
            far_clip: 5.0 * wide.max(size[2]) + distance,
            principal_point_offset: [0.0; 2],
            lens: None,
            film,
            sampler: Sampler { plugin: "independent".to_owned(), sample_count: 4, seed: 0 },
            medium: None,
        });
    }

    /// Makes room for a shape that is placed by `outer` once more.
    fn expand(&self, bounds: &mut Bounds, positions: &mut Positions, shape: &Shape, outer: &Transform) {
        let place = outer.after(&shape.to_world);
        let add = |bounds: &mut Bounds, p: [f64; 3]| {
            let p = place.point(p);
            for i in 0..3 {
                bounds[0][i] = bounds[0][i].min(p[i]);
                bounds[1][i] = bounds[1][i].max(p[i]);
            }
        };
        let add_all = |bounds: &mut Bounds, points: &[[f32; 3]]| {
            points.iter().for_each(|p| add(bounds, p.map(f64::from)));
        };
        match &shape.kind {
            ShapeKind::Mesh(file) => {
                let key = (file.path.clone(), format!("{:?}", file.format));
                let points = positions.entry(key).or_insert_with(|| self.positions(file));
                add_all(bounds, points);
            }
            ShapeKind::Inline(mesh) => add_all(bounds, &mesh.positions),
            ShapeKind::Rectangle => add_all(bounds, &builtin::rectangle(false).positions),
            ShapeKind::Cube => add_all(bounds, &builtin::cube().positions),
            ShapeKind::Sphere { center, radius } => grow(bounds, &place, *center, axes(*radius)),
            ShapeKind::Disk => {
                grow(bounds, &place, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]]);
            }
            ShapeKind::Cylinder { p0, p1, radius } => {
                let axis: [f64; 3] = std::array::from_fn(|i| p1[i] - p0[i]);
                let square: f64 = axis.iter().map(|v| v * v).sum();
                // Each axis without its part along the cylinder: how far a ring reaches along it.
                let across = |i: usize| {
                    let part = if square > 0.0 { axis[i] / square } else { 0.0 };
                    std::array::from_fn(|j| radius * (f64::from(u8::from(i == j)) - part * axis[j]))
                };
                for end in [p0, p1] {
                    grow(bounds, &place, *end, std::array::from_fn(across));
                }
            }
            ShapeKind::Instance { group } => {
                for shape in &self.scene.groups[*group].shapes {
                    self.expand(bounds, positions, shape, &place);
                }
            }
            // Of pbrt.
            ShapeKind::Partial(_) => {}
        }
    }

    /// What cannot be read is reported where it is rendered.
    fn positions(&self, file: &MeshFile) -> Vec<[f32; 3]> {
        let options = MeshOptions { face_normals: true, ..MeshOptions::default() };
        let bytes = self.file(&file.path).unwrap_or_default();
        mesh::read(file.format, &bytes, &options).map(|mesh| mesh.positions).unwrap_or_default()
    }
}

fn axes(length: f64) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { length } else { 0.0 }))
}

/// Makes room for the ellipsoid around `center` that the transform makes of one with these half axes.
fn grow(bounds: &mut Bounds, place: &Transform, center: [f64; 3], half: [[f64; 3]; 3]) {
    let center = place.point(center);
    let turned = half.map(|axis| place.vector(axis));
    for i in 0..3 {
        let reach = turned.iter().map(|axis| axis[i] * axis[i]).sum::<f64>().sqrt();
        bounds[0][i] = bounds[0][i].min(center[i] - reach);
        bounds[1][i] = bounds[1][i].max(center[i] + reach);
    }
}
