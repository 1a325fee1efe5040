//! Shapes that emit.

use caustica_formats::ir;

use super::super::Compiler;
use crate::emitter::{Emitter, MeshTriangle, Surface};
use crate::math::{LIFT, Vec2, Vec3};
use crate::scene::ShapeRecord;
use crate::scene::geometry::Primitive;
use crate::shape::triangle;

/// Makes the shape of `record`, which is `surface` in the world, a lamp.
pub fn add_lamp(
    b: &mut Compiler<'_>,
    emission: &ir::AreaEmission,
    shape: &ir::Shape,
    surface: Surface,
    record: &mut ShapeRecord,
    emitters: &mut Vec<Emitter>,
) {
    let extent = match &surface {
        Surface::Mesh { triangles, .. } => {
            triangles.iter().flat_map(|t| t.v).map(|v| Vec3::from(v).abs().max_element()).fold(0.0, f32::max)
        }
        Surface::Analytic(a) => a.bounds().magnitude(),
    };
    if surface.area() > 0.0 {
        let lamp = b.lamp(emission, shape.alpha.as_ref(), surface, extent * LIFT);
        record.emitter = lamp.is_some().then_some(emitters.len() as u32);
        emitters.extend(lamp);
    } else {
        b.warn("a lamp without area gives no light", shape.origin);
    }
}

/// The lamp's triangles with the normal of the side that shines: the side of the shading normals.
pub fn lamp_mesh(primitives: &[Primitive], record: &ShapeRecord) -> Surface {
    let flip = if record.flip { -1.0 } else { 1.0 };
    let triangles = primitives.iter().enumerate().map(|(i, p)| {
        let geometric = triangle::cross_product(p.corners()).normalize_or_zero() * flip;
        let corner = |k: usize| record.triangles.get(i).map(|t| t[k] as usize);
        let shading: Vec3 = (0..3)
            .filter_map(|k| corner(k).and_then(|v| record.normals.get(v)))
            .map(|&n| Vec3::from(n) * flip)
            .sum();
        let uv = std::array::from_fn(|k| match corner(k).and_then(|v| record.uvs.get(v)) {
            Some(&uv) => Vec2::from(uv),
            None => [Vec2::ZERO, Vec2::X, Vec2::Y][k],
        });
        let normal = if shading.dot(geometric) < 0.0 { -geometric } else { geometric };
        MeshTriangle { v: *p.corners(), uv, normal }
    });
    Surface::mesh(triangles.collect())
}
