//! Checks and changes that need the whole scene.

use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{BsdfKind, PartialQuadric, Query, Shape, ShapeKind, Transform, emits};

impl Reader<'_> {
    pub fn finish(&mut self) {
        self.check_materials();
        self.check_objects();
        self.check_media();
        self.check_integrator();
        // Materials stay as they are from here on.
        let mut query = Query::default();
        let mut shapes = std::mem::take(&mut self.scene.shapes);
        shapes.iter_mut().for_each(|shape| self.finish_shape(shape, &mut query));
        self.scene.shapes = shapes;
        let ids: Vec<_> = self.scene.groups.iter().map(|(id, _)| id).collect();
        for id in ids {
            let mut shapes = std::mem::take(&mut self.scene.groups[id].shapes);
            shapes.iter_mut().for_each(|shape| self.finish_shape(shape, &mut query));
            self.scene.groups[id].shapes = shapes;
        }
        if !emits(&self.scene) && self.world.is_some() {
            self.problems.push(Diagnostic::warning("the scene has no light and will be black", self.world));
        }
    }

    fn finish_shape(&mut self, shape: &mut Shape, query: &mut Query) {
        let Some(bsdf) = shape.bsdf else { return };
        if let (BsdfKind::Null, Some(emission)) = (&self.scene.bsdfs[bsdf].kind, &shape.emission) {
            let text = "a shape with material `interface` does not emit light: the area light is ignored";
            self.problems.push(Diagnostic::warning(text, emission.origin.0.or(shape.origin.0)));
            shape.emission = None;
        }
        // Partial quadrics have other uv than the plain kinds.
        let bsdfs = &self.scene.bsdfs;
        let uv_matter = query.textured(bsdfs, shape) || query.bsdf(bsdfs, bsdf).anisotropic;
        if !uv_matter && let ShapeKind::Partial(quadric) = shape.kind {
            plain(shape, quadric);
        }
    }
}

/// Turns an uncut quadric into the kind both languages have.
fn plain(shape: &mut Shape, quadric: PartialQuadric) {
    match quadric {
        PartialQuadric::Sphere { radius, z_min, z_max, phi_max }
            if z_min == -radius && z_max == radius && phi_max == 360.0 =>
        {
            shape.kind = ShapeKind::Sphere { center: [0.0; 3], radius };
        }
        PartialQuadric::Disk { height, radius, inner_radius: 0.0, phi_max: 360.0 } => {
            let place =
                Transform::translate([0.0, 0.0, height]).after(&Transform::scale([radius, radius, 1.0]));
            shape.kind = ShapeKind::Disk;
            shape.to_world = shape.to_world.after(&place);
        }
        PartialQuadric::Cylinder { radius, z_min, z_max, phi_max: 360.0 } => {
            shape.kind = ShapeKind::Cylinder { p0: [0.0, 0.0, z_min], p1: [0.0, 0.0, z_max], radius };
        }
        _ => {}
    }
}
