//! How much light a lamp gives where its author says the sum of it, as pbrt allows, and lamps of two sides.

use std::f64::consts::PI;
use std::sync::Arc;

use super::image::{Pixels, from_square};
use super::mesh::{cross, tessellate};
use super::{Output, WriteError};
use crate::ir::{
    AreaEmission, ColorInput, ColorSlot, InlineMesh, LightImage, PartialQuadric, Shape, ShapeKind, Transform,
};
use crate::mesh::Mesh;
use crate::spectrum::luminance;

/// How far behind a lamp its other side lies, in parts of what tells places apart: of the largest coordinate, and of
/// the distance to the camera. Single precision tells 6e-8 apart.
const BEHIND: f64 = 3e-6;

/// A lamp is not thinner than this, in parts of its radius.
const THICKEST: f64 = 0.01;

impl Output<'_> {
    /// The factor that gives a plane facing the +Z of an equal-area picture the illuminance that is asked for.
    pub fn illuminance_factor(&self, image: &LightImage) -> Result<f64, WriteError> {
        let Some(wanted) = image.illuminance else { return Ok(1.0) };
        let pixels = self.pixels(&image.path, image.encoding, None)?;
        // pbrt's sum over the square, with the solid angle of half of it.
        let received = mean(&pixels, |s, t| 2.0 * PI * from_square([s, t])[2].max(0.0));
        Ok(if received > 0.0 { wanted / received } else { 1.0 })
    }

    /// The factor that gives a projection the power that is asked for; the shorter side of its picture is at
    /// `tangent` of its half angle.
    pub fn projection_factor(
        &self,
        image: &LightImage,
        tangent: f64,
        power: Option<f64>,
    ) -> Result<f64, WriteError> {
        let Some(wanted) = power else { return Ok(1.0) };
        let pixels = self.pixels(&image.path, image.encoding, None)?;
        let shorter = pixels.width.min(pixels.height) as f64;
        let half = [pixels.width, pixels.height].map(|n| tangent * n as f64 / shorter);
        // Solid angle of the part of a plane at distance 1 from its middle to a corner.
        let corner = |x: f64, y: f64| (x * y / (1.0 + x * x + y * y).sqrt()).atan();
        let (w, h) = (pixels.width as f64, pixels.height as f64);
        let mut sum = 0.0;
        for (i, rgb) in pixels.rgb.iter().enumerate() {
            let (x, y) = ((i % pixels.width) as f64, (i / pixels.width) as f64);
            let edge = |at: f64, n: f64, half: f64| (2.0 * at / n - 1.0) * half;
            let [x0, x1] = [x, x + 1.0].map(|x| edge(x, w, half[0]));
            let [y0, y1] = [y, y + 1.0].map(|y| edge(y, h, half[1]));
            sum += luminance(*rgb) * (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0));
        }
        Ok(if sum > 0.0 { wanted / sum } else { 1.0 })
    }

    /// The factor that gives a lamp the power that is asked for; where it is not known, the power is a loss.
    pub fn lamp_factor(&mut self, shape: &Shape, e: &AreaEmission) -> Result<f64, WriteError> {
        let Some(power) = e.power else { return Ok(1.0) };
        let factor = self.factor_of_power(shape, e, power)?;
        if factor.is_none() {
            self.lose(e.origin, format!("the power of a light, {power} W"), "its radiance as written");
        }
        Ok(factor.unwrap_or(1.0))
    }

    fn factor_of_power(
        &mut self,
        shape: &Shape,
        e: &AreaEmission,
        wanted: f64,
    ) -> Result<Option<f64>, WriteError> {
        let radiance = match &e.radiance {
            ColorInput::Color(color) => self.rgb(color, ColorSlot::Emission, e.origin),
            ColorInput::Texture(id) => match self.sampled(*id)? {
                Some(sampled) => sampled.mean(),
                None => return Ok(None),
            },
        };
        let Some(area) = self.world_area(shape)? else { return Ok(None) };
        let sides = if e.two_sided { 2.0 } else { 1.0 };
        let emitted = luminance(radiance) * PI * area * sides;
        Ok(Some(if emitted > 0.0 { wanted / emitted } else { 1.0 }))
    }

    fn world_area(&self, shape: &Shape) -> Result<Option<f64>, WriteError> {
        let area = |mesh: &Mesh| -> f64 {
            let place = |p: &[f32; 3]| shape.to_world.point(p.map(f64::from)).map(|v| v as f32);
            let positions = mesh.positions.iter().map(place).collect();
            flat_area(&Mesh { positions, triangles: mesh.triangles.clone(), ..Mesh::default() })
        };
        let curved = |quadric: &PartialQuadric| {
            let mesh = tessellate(quadric);
            // What the flat faces lack.
            area(&mesh) * quadric_area(quadric) / flat_area(&mesh)
        };
        Ok(Some(match &shape.kind {
            ShapeKind::Mesh(file) => area(&*self.mesh(file)?),
            ShapeKind::Inline(mesh) => {
                let (positions, triangles) = (mesh.positions.clone(), mesh.triangles.clone());
                area(&Mesh { positions, triangles, ..Mesh::default() })
            }
            ShapeKind::Partial(quadric) => curved(quadric),
            ShapeKind::Sphere { radius, .. } => curved(&PartialQuadric::Sphere {
                radius: *radius,
                z_min: -radius,
                z_max: *radius,
                phi_max: 360.0,
            }),
            ShapeKind::Disk => curved(&UNIT_DISK),
            // It stays round.
            ShapeKind::Cylinder { p0, p1, radius } => {
                let length = (0..3).map(|i| (p1[i] - p0[i]).powi(2)).sum::<f64>().sqrt();
                2.0 * PI * radius * length * shape.to_world.determinant3().abs().powf(2.0 / 3.0)
            }
            _ => return Ok(None),
        }))
    }

    /// The other side of a lamp that shines on both, as a surface of its own just behind it. `None` where there is
    /// no such surface.
    pub fn back_of_lamp(&self, shape: &Shape) -> Result<Option<Shape>, WriteError> {
        let scale = shape.to_world.determinant3().abs().cbrt();
        let distance = BEHIND * self.largest_distance(shape)? / scale;
        // The front of a quadric is turned by a mirror, but not that of a whole cylinder.
        let turned = !matches!(shape.kind, ShapeKind::Cylinder { .. }) && shape.to_world.determinant3() < 0.0;
        let inwards = shape.flip_normals == turned;
        let towards = if inwards { -distance } else { distance };
        let smaller = |radius: f64| radius + towards;
        if let ShapeKind::Disk = shape.kind {
            // Its front is where its third axis points to, mirrored or not.
            let axis = shape.to_world.vector([0.0, 0.0, 1.0]);
            let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
            let along = distance * scale / length * if shape.flip_normals { 1.0 } else { -1.0 };
            let to_world = shape.to_world.after(&Transform::translate([0.0, 0.0, along]));
            let flip_normals = !shape.flip_normals;
            return Ok(Some(Shape { name: None, to_world, flip_normals, ..shape.clone() }));
        }
        let kind = match &shape.kind {
            ShapeKind::Sphere { center, radius } if distance < THICKEST * radius => {
                ShapeKind::Sphere { center: *center, radius: smaller(*radius) }
            }
            ShapeKind::Cylinder { p0, p1, radius } if distance < THICKEST * radius => {
                ShapeKind::Cylinder { p0: *p0, p1: *p1, radius: smaller(*radius) }
            }
            ShapeKind::Partial(PartialQuadric::Sphere { radius, z_min, z_max, phi_max })
                if distance < THICKEST * radius =>
            {
                let ratio = smaller(*radius) / radius;
                ShapeKind::Partial(PartialQuadric::Sphere {
                    radius: smaller(*radius),
                    z_min: z_min * ratio,
                    z_max: z_max * ratio,
                    phi_max: *phi_max,
                })
            }
            ShapeKind::Partial(PartialQuadric::Cylinder { radius, z_min, z_max, phi_max })
                if distance < THICKEST * radius =>
            {
                let (radius, z_min, z_max, phi_max) = (smaller(*radius), *z_min, *z_max, *phi_max);
                ShapeKind::Partial(PartialQuadric::Cylinder { radius, z_min, z_max, phi_max })
            }
            ShapeKind::Partial(PartialQuadric::Disk { height, radius, inner_radius, phi_max }) => {
                ShapeKind::Partial(PartialQuadric::Disk {
                    height: height + towards,
                    radius: *radius,
                    inner_radius: *inner_radius,
                    phi_max: *phi_max,
                })
            }
            ShapeKind::Inline(mesh) => {
                let whole = Mesh {
                    positions: mesh.positions.clone(),
                    normals: mesh.normals.clone(),
                    uvs: mesh.uvs.clone(),
                    triangles: mesh.triangles.clone(),
                    computed_normals: false,
                    attributes: Vec::new(),
                };
                behind(whole, if shape.flip_normals { distance } else { -distance })
            }
            ShapeKind::Mesh(file) if file.authored_normals => {
                behind(Mesh::clone(&*self.mesh(file)?), if shape.flip_normals { distance } else { -distance })
            }
            _ => return Ok(None),
        };
        Ok(Some(Shape { name: None, kind, flip_normals: !shape.flip_normals, ..shape.clone() }))
    }

    /// The largest coordinate of a shape in the world or from where a camera stands.
    fn largest_distance(&self, shape: &Shape) -> Result<f64, WriteError> {
        let largest = |points: &[[f32; 3]]| {
            let points = points.iter().map(|p| shape.to_world.point(p.map(f64::from)));
            let cameras = self.scene.sensors.iter().map(|sensor| sensor.to_world.point([0.0; 3]));
            let cameras: Vec<[f64; 3]> = cameras.chain([[0.0; 3]]).collect();
            points.fold(0.0, |most: f64, p| {
                let from = |c: &[f64; 3]| (0..3).map(|i| (p[i] - c[i]).abs()).fold(0.0, f64::max);
                cameras.iter().map(from).fold(most, f64::max)
            })
        };
        Ok(match &shape.kind {
            ShapeKind::Mesh(file) => largest(&self.mesh(file)?.positions),
            ShapeKind::Inline(mesh) => largest(&mesh.positions),
            ShapeKind::Partial(quadric) => largest(&tessellate(quadric).positions),
            ShapeKind::Sphere { center, radius } => {
                let corners = [-1.0, 1.0].map(|s| center.map(|c| (c + s * radius) as f32));
                largest(&corners)
            }
            ShapeKind::Disk => largest(&tessellate(&UNIT_DISK).positions),
            ShapeKind::Cylinder { p0, p1, radius } => {
                let ends = [p0, p1].map(|p| [-1.0, 1.0].map(|s| p.map(|c| (c + s * radius) as f32)));
                largest(ends.as_flattened())
            }
            _ => 0.0,
        })
    }
}

const UNIT_DISK: PartialQuadric =
    PartialQuadric::Disk { height: 0.0, radius: 1.0, inner_radius: 0.0, phi_max: 360.0 };

/// A mesh moved along its normals, each vertex by the mean of its faces.
fn behind(mesh: Mesh, distance: f64) -> ShapeKind {
    let mut around = vec![[0.0; 3]; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let normal = cross(&mesh, *triangle);
        for &vertex in triangle {
            let vertex = vertex as usize;
            // The side is that of the normals where there are any.
            let shading = mesh.normals.get(vertex).map_or(normal, |n| n.map(f64::from));
            let sign = (0..3).map(|i| shading[i] * normal[i]).sum::<f64>().signum();
            (0..3).for_each(|i| around[vertex][i] += sign * normal[i]);
        }
    }
    let moved = mesh.positions.iter().zip(around).map(|(p, n)| {
        let length = n.iter().map(|v| v * v).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        std::array::from_fn(|i| (f64::from(p[i]) + distance * n[i] / length) as f32)
    });
    let positions = moved.collect();
    let Mesh { normals, uvs, triangles, .. } = mesh;
    ShapeKind::Inline(Arc::new(InlineMesh { positions, normals, uvs, triangles, made_from: None }))
}

/// The mean of the luminance of a picture times a weight by place.
fn mean(pixels: &Pixels, weight: impl Fn(f64, f64) -> f64) -> f64 {
    let (w, h) = (pixels.width as f64, pixels.height as f64);
    let at = |i: usize| (((i % pixels.width) as f64 + 0.5) / w, ((i / pixels.width) as f64 + 0.5) / h);
    let sum: f64 = pixels
        .rgb
        .iter()
        .enumerate()
        .map(|(i, rgb)| {
            let (s, t) = at(i);
            luminance(*rgb) * weight(s, t)
        })
        .sum();
    sum / (w * h)
}

fn flat_area(mesh: &Mesh) -> f64 {
    let area = |t: &[u32; 3]| 0.5 * cross(mesh, *t).iter().map(|v| v * v).sum::<f64>().sqrt();
    mesh.triangles.iter().map(area).sum()
}

fn quadric_area(quadric: &PartialQuadric) -> f64 {
    match *quadric {
        PartialQuadric::Sphere { radius, z_min, z_max, phi_max } => {
            phi_max.to_radians() * radius * (z_max.min(radius) - z_min.max(-radius))
        }
        PartialQuadric::Disk { radius, inner_radius, phi_max, .. } => {
            0.5 * phi_max.to_radians() * (radius * radius - inner_radius * inner_radius)
        }
        PartialQuadric::Cylinder { radius, z_min, z_max, phi_max } => {
            phi_max.to_radians() * radius * (z_max - z_min).abs()
        }
    }
}
