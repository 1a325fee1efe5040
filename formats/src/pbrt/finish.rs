//! What can be said only when everything is read.

use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    BsdfKind, ColorInput, ConductorMaterial, FloatInput, Id, PartialQuadric, Scene, Shape, ShapeKind,
    Transform,
};

impl Reader<'_> {
    pub fn finish(&mut self) {
        self.check_materials();
        self.check_objects();
        let mut shapes = std::mem::take(&mut self.scene.shapes);
        shapes.iter_mut().for_each(|shape| self.finish_shape(shape));
        self.scene.shapes = shapes;
        let ids: Vec<_> = self.scene.groups.iter().map(|(id, _)| id).collect();
        for id in ids {
            let mut shapes = std::mem::take(&mut self.scene.groups[id].shapes);
            shapes.iter_mut().for_each(|shape| self.finish_shape(shape));
            self.scene.groups[id].shapes = shapes;
        }
        let shines = self.scene.shapes.iter().any(|shape| shape.emission.is_some());
        if !shines && self.scene.emitters.is_empty() && self.world.is_some() {
            self.problems.push(Diagnostic::warning("the scene has no light and will be black", self.world));
        }
    }

    fn finish_shape(&mut self, shape: &mut Shape) {
        let Some(bsdf) = shape.bsdf else { return };
        if let (BsdfKind::Null, Some(emission)) = (&self.scene.bsdfs[bsdf].kind, &shape.emission) {
            let text = "a shape of material `interface` does not shine: the area light is ignored";
            self.problems.push(Diagnostic::warning(text, emission.origin.0.or(shape.origin.0)));
            shape.emission = None;
        }
        // Their uv differ from those of the plain kinds.
        let textured = uses_texture(&self.scene, bsdf)
            || matches!(shape.alpha, Some(FloatInput::Texture(_)))
            || shape.emission.as_ref().is_some_and(|e| matches!(e.radiance, ColorInput::Texture(_)));
        if !textured && let ShapeKind::Partial(quadric) = shape.kind {
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

/// Whether a material depends on where on the surface it is.
fn uses_texture(scene: &Scene, bsdf: Id<crate::ir::Bsdf>) -> bool {
    let color = |input: &ColorInput| matches!(input, ColorInput::Texture(_));
    let float = |input: &FloatInput| matches!(input, FloatInput::Texture(_));
    let rough = |m: &crate::ir::Microfacet| float(&m.alpha_u) || float(&m.alpha_v);
    // Anisotropy follows ∂p/∂u.
    let turned = |m: &crate::ir::Microfacet| rough(m) || m.alpha_u != m.alpha_v;
    let metal = |c: &crate::ir::Conductor| match &c.material {
        ConductorMaterial::EtaK { eta, k, .. } => color(eta) || color(k),
        ConductorMaterial::Reflectance(reflectance) => color(reflectance),
        ConductorMaterial::Mirror | ConductorMaterial::Named { .. } => false,
    };
    let coat =
        |c: &crate::ir::Coat| turned(&c.microfacet) || float(&c.thickness) || float(&c.g) || color(&c.albedo);
    match &scene.bsdfs[bsdf].kind {
        BsdfKind::Diffuse { reflectance } => color(reflectance),
        BsdfKind::TwoSided { front, .. } => uses_texture(scene, *front),
        BsdfKind::Conductor(c) => metal(c),
        BsdfKind::RoughConductor { conductor, microfacet } => metal(conductor) || turned(microfacet),
        BsdfKind::RoughDielectric { microfacet, .. } => turned(microfacet),
        BsdfKind::DiffuseTransmission { reflectance, transmittance } => {
            color(reflectance) || color(transmittance)
        }
        BsdfKind::CoatedDiffuse { reflectance, coat: c } => color(reflectance) || coat(c),
        BsdfKind::CoatedConductor { conductor, microfacet, coat: c } => {
            metal(conductor) || turned(microfacet) || coat(c)
        }
        BsdfKind::Blend { weight, first, second } => {
            float(weight) || uses_texture(scene, *first) || uses_texture(scene, *second)
        }
        BsdfKind::BumpMap { .. } | BsdfKind::NormalMap { .. } => true,
        _ => false,
    }
}
