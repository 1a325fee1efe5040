//! Shapes, groups and instances.

use super::Writer;
use super::element::Element;
use super::substitute;
use crate::ir::{
    AreaEmission, ColorInput, FloatInput, Id, MeshFile, MeshFormat, Origin, PartialQuadric, Shape,
    ShapeGroup, ShapeKind, Transform,
};
use crate::write::WriteError;

impl Writer<'_, '_> {
    pub fn group(&mut self, id: Id<ShapeGroup>) -> Result<Option<Element>, WriteError> {
        let scene = self.scene;
        let mut element = Element::plugin("shape", "shapegroup").id(self.ids.groups[id.index()].as_deref());
        for shape in &scene.groups[id].shapes {
            if let Some(emission) = &shape.emission {
                self.out.lose(
                    emission.origin,
                    "light from a shape of a group",
                    "a shape that does not emit light",
                );
                let dark = Shape { emission: None, ..shape.clone() };
                element = element.children(self.shape(&dark)?);
            } else {
                element = element.children(self.shape(shape)?);
            }
        }
        Ok(Some(element))
    }

    #[allow(unreachable_patterns, reason = "kinds added later are reported as losses by name")]
    pub fn shape(&mut self, shape: &Shape) -> Result<Option<Element>, WriteError> {
        let plugin = |name: &str| Element::plugin("shape", name).id(shape.name.as_deref());
        let label = shape.name.as_deref().unwrap_or("mesh");
        let element = match &shape.kind {
            ShapeKind::Mesh(file) => self.mesh(file, shape.origin, &|name| plugin(name))?,
            ShapeKind::Inline(mesh) => {
                let name = mesh.made_from.as_deref().filter(|_| shape.name.is_none()).unwrap_or(label);
                let file = self.out.make_inline_ply(mesh, name)?;
                // Without normals it is flat.
                plugin("ply").string("filename", &file).boolean_unless(
                    "face_normals",
                    mesh.normals.is_empty(),
                    false,
                )
            }
            ShapeKind::Sphere { center, radius } => {
                let mut element = plugin("sphere");
                if *center != [0.0; 3] {
                    element = element.triple("point", "center", *center);
                }
                element.float_unless("radius", *radius, 1.0)
            }
            ShapeKind::Partial(quadric) => self.quadric(shape, quadric, &|name| plugin(name))?,
            ShapeKind::Rectangle => plugin("rectangle"),
            ShapeKind::Cube => plugin("cube"),
            ShapeKind::Disk => plugin("disk"),
            ShapeKind::Cylinder { p0, p1, radius } => plugin("cylinder")
                .triple("point", "p0", *p0)
                .triple("point", "p1", *p1)
                .float_unless("radius", *radius, 1.0),
            ShapeKind::Instance { group } => {
                let id = self.ids.groups[group.index()].clone().unwrap_or_default();
                plugin("instance").child(Element::new("ref").with("id", id))
            }
            other => {
                self.out.lose(shape.origin, format!("a shape of kind `{}`", other.name()), "no shape");
                return Ok(None);
            }
        };
        // Mitsuba's side of a mirrored mesh is that of its mirrored winding, pbrt's is not.
        let by_object = match &shape.kind {
            ShapeKind::Mesh(file) => file.authored_normals,
            ShapeKind::Inline(_) => true,
            _ => false,
        };
        let mut flip = shape.flip_normals ^ (by_object && shape.to_world.determinant3() < 0.0);
        let mut to_world = shape.to_world;
        if matches!(&shape.kind, ShapeKind::Partial(quadric) if whole_sphere(quadric).is_some())
            && self.query.textured(&self.scene.bsdfs, shape)
        {
            // pbrt's v runs from −Z upwards, Mitsuba's from +Z downwards; mirroring turns the normals.
            to_world = to_world.after(&Transform::scale([1.0, 1.0, -1.0]));
            flip = !flip;
        }
        let mut element =
            element.transform("to_world", &to_world).boolean_unless("flip_normals", flip, false);
        element = element.children(self.material(shape)?);
        if let Some(emission) = &shape.emission {
            element = element.child(self.emission(emission)?);
        }
        Ok(Some(element))
    }

    /// The shape's material, under its opacity.
    fn material(&mut self, shape: &Shape) -> Result<Option<Element>, WriteError> {
        let bsdf = shape.bsdf.map(|id| self.bsdf(id)).transpose()?;
        let Some(alpha) = shape.alpha.as_ref().filter(|alpha| **alpha != FloatInput::Value(1.0)) else {
            return Ok(bsdf);
        };
        if shape.emission.is_some() {
            self.out.lose(
                shape.origin,
                "the opacity of a lamp",
                "a mask on its material; it emits everywhere",
            );
        }
        // What a shape without material has.
        let bsdf =
            bsdf.unwrap_or_else(|| substitute::diffuse(if shape.emission.is_some() { 0.0 } else { 0.5 }));
        let opacity = self.float_input("opacity", alpha, None)?;
        Ok(Some(Element::plugin("bsdf", "mask").children(opacity).child(bsdf)))
    }

    fn mesh(
        &mut self,
        file: &MeshFile,
        origin: Origin,
        plugin: &dyn Fn(&str) -> Element,
    ) -> Result<Element, WriteError> {
        let keep = file.max_smooth_angle.is_none()
            && match file.format {
                MeshFormat::Obj | MeshFormat::Serialized { .. } => true,
                MeshFormat::ObjPart { .. } => false,
                MeshFormat::Ply => self.out.is_triangle_ply(file)?,
            };
        if !keep {
            let name = self.out.make_ply(file, origin)?;
            let element = plugin("ply").comment(format!("made from {}", file.path.display()));
            let flat = file.face_normals || self.out.mesh(file)?.normals.is_empty();
            return Ok(element.string("filename", &name).boolean_unless("face_normals", flat, false));
        }
        let name = self.out.carry(&file.path, "meshes");
        let flat = file.face_normals || file.authored_normals && self.out.mesh(file)?.normals.is_empty();
        Ok(match file.format {
            MeshFormat::Obj | MeshFormat::ObjPart { .. } => plugin("obj")
                .string("filename", &name)
                .boolean_unless("flip_tex_coords", file.flip_tex_coords, true),
            MeshFormat::Ply => plugin("ply").string("filename", &name).boolean_unless(
                "flip_tex_coords",
                file.flip_tex_coords,
                false,
            ),
            MeshFormat::Serialized { index } => {
                let element = plugin("serialized").string("filename", &name);
                if index == 0 { element } else { element.integer("shape_index", i64::from(index)) }
            }
        }
        .boolean_unless("face_normals", flat, false))
    }

    /// Whole spheres and cylinders stay analytic; other quadrics are tessellated.
    fn quadric(
        &mut self,
        shape: &Shape,
        quadric: &PartialQuadric,
        plugin: &dyn Fn(&str) -> Element,
    ) -> Result<Element, WriteError> {
        if let Some(radius) = whole_sphere(quadric) {
            return Ok(plugin("sphere").float_unless("radius", radius, 1.0));
        }
        match *quadric {
            PartialQuadric::Cylinder { radius, z_min, z_max, phi_max } if phi_max >= 360.0 => {
                Ok(plugin("cylinder")
                    .triple("point", "p0", [0.0, 0.0, z_min])
                    .triple("point", "p1", [0.0, 0.0, z_max])
                    .float_unless("radius", radius, 1.0))
            }
            _ => {
                self.out.lose(shape.origin, "a partial quadric", "a mesh of 64 segments around");
                let name = self.out.make_quadric_ply(quadric, shape.name.as_deref().unwrap_or("quadric"))?;
                Ok(plugin("ply").string("filename", &name))
            }
        }
    }

    fn emission(&mut self, e: &AreaEmission) -> Result<Element, WriteError> {
        if e.two_sided {
            self.out.lose(e.origin, "a lamp that emits on both sides", "the side of its normal only");
        }
        if let Some(power) = e.power {
            self.out.lose(e.origin, format!("the power of a lamp, {power} W"), "its radiance as written");
        }
        let plugin = if e.collimated { "directionalarea" } else { "area" };
        let radiance = match &e.radiance {
            ColorInput::Color(color) => self.light("radiance", color, e.scale, e.origin),
            ColorInput::Texture(id) => self.scaled_texture("radiance", *id, e.scale * self.light)?,
        };
        Ok(Element::plugin("emitter", plugin).child(radiance))
    }
}

/// The radius of a sphere that is not cut.
fn whole_sphere(quadric: &PartialQuadric) -> Option<f64> {
    match *quadric {
        PartialQuadric::Sphere { radius, z_min, z_max, phi_max } => {
            (phi_max >= 360.0 && z_min <= -radius && z_max >= radius).then_some(radius)
        }
        _ => None,
    }
}
