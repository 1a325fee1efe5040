//! Shapes, groups and instances.

use super::Writer;
use super::element::Element;
use super::plain::{plain_obj, plain_ply};
use super::substitute;
use crate::ir::{
    AreaEmission, ColorInput, FloatInput, Id, MediumInterface, MeshFile, MeshFormat, PartialQuadric, Shape,
    ShapeGroup, ShapeKind, Transform,
};
use crate::write::{Facing, WriteError, about};

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
                element = element.children(self.shape(&dark, false)?);
            } else {
                element = element.children(self.shape(shape, false)?);
            }
        }
        Ok(Some(element))
    }

    /// A shape; `reversed` writes a mesh that faces the other way instead of one with `flip_normals`.
    pub fn shape(&mut self, shape: &Shape, reversed: bool) -> Result<Option<Element>, WriteError> {
        let facing = Facing {
            keeps_uvs: reversed && self.query.textured(&self.scene.bsdfs, shape),
            ..Facing::new(reversed)
        };
        let stretched = self.stretched(shape, facing)?;
        // Mitsuba's side of a mirrored mesh is that of its normals, or else of its mirrored winding; pbrt's is never
        // mirrored. That of a quadric is turned by the mirror in both, that of the mesh it becomes is not.
        let mirrored = shape.to_world.determinant3() < 0.0;
        let turned = match &shape.kind {
            ShapeKind::Mesh(file) => {
                mirrored && file.authored_normals && self.out.mesh(file)?.normals.is_empty()
            }
            ShapeKind::Inline(mesh) => mesh.normals.is_empty(),
            ShapeKind::Partial(quadric) => !stays_analytic(quadric, &shape.to_world),
            _ => stretched.is_some(),
        };
        let Some(element) = stretched.map_or_else(|| self.geometry(shape, facing), |made| Ok(Some(made)))?
        else {
            return Ok(None);
        };
        let flip = shape.flip_normals ^ (turned && mirrored) ^ reversed;
        let mut to_world = shape.to_world;
        if reversed && matches!(shape.kind, ShapeKind::Rectangle) {
            to_world = to_world.after(&Transform::scale([1.0, 1.0, -1.0]));
        }
        let mut element =
            element.transform("to_world", &to_world).boolean_unless("flip_normals", flip, false);
        element = element.children(self.material(shape)?).children(self.media(shape)?);
        if let Some(emission) = &shape.emission
            && self.out.has_area(shape)?
        {
            element = element.child(self.emission(shape, emission)?);
        }
        Ok(Some(element))
    }

    /// The shape; a lamp of two sides as two that lie back to back, where their surface lets no light through.
    pub fn sides(&mut self, shape: &Shape) -> Result<Vec<Shape>, WriteError> {
        let one = vec![shape.clone()];
        let Some(emission) = shape.emission.as_ref().filter(|e| e.two_sided) else { return Ok(one) };
        let bsdfs = &self.scene.bsdfs;
        let opaque = shape.bsdf.is_none_or(|id| self.query.bsdf(bsdfs, id).opaque());
        if !opaque || shape.alpha.as_ref().is_some_and(|alpha| *alpha != FloatInput::Value(1.0)) {
            return Ok(one);
        }
        let Some(back) = self.out.back_of_lamp(shape)? else { return Ok(one) };
        self.backs.push(back.clone());
        // Each has half of the power.
        let power = emission.power.map(|power| 0.5 * power);
        let side = |shape: &Shape| Shape {
            emission: Some(AreaEmission { two_sided: false, power, ..emission.clone() }),
            ..shape.clone()
        };
        // What is inside of the front is outside of the back.
        let media = shape.media.map(|m| MediumInterface { interior: m.exterior, exterior: m.interior });
        Ok(vec![side(shape), Shape { media, ..side(&back) }])
    }

    /// The surface, before its transform.
    #[allow(unreachable_patterns, reason = "kinds added later are reported as losses by name")]
    fn geometry(&mut self, shape: &Shape, facing: Facing) -> Result<Option<Element>, WriteError> {
        let plugin = |name: &str| Element::plugin("shape", name).id(shape.name.as_deref());
        let label = shape.name.as_deref().unwrap_or("mesh");
        Ok(Some(match &shape.kind {
            ShapeKind::Mesh(file) => self.mesh(file, shape, facing, &|name| plugin(name))?,
            ShapeKind::Inline(mesh) => {
                let name = mesh.made_from.as_deref().filter(|_| shape.name.is_none()).unwrap_or(label);
                let file = self.out.make_inline_ply(mesh, facing, name)?;
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
            ShapeKind::Partial(quadric) => self.quadric(shape, quadric, facing)?,
            ShapeKind::Rectangle => plugin("rectangle"),
            ShapeKind::Cube if facing != Facing::FRONT => {
                let file = self.out.make_cube_ply(facing, shape.name.as_deref().unwrap_or("cube"))?;
                plugin("ply").string("filename", &file)
            }
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
        }))
    }

    /// The shape's material, under its opacity.
    fn material(&mut self, shape: &Shape) -> Result<Option<Element>, WriteError> {
        let bsdf = shape.bsdf.map(|id| self.bsdf(id)).transpose()?;
        let Some(alpha) = shape.alpha.as_ref().filter(|alpha| **alpha != FloatInput::Value(1.0)) else {
            return Ok(bsdf);
        };
        // What a shape without material has.
        let bsdf =
            bsdf.unwrap_or_else(|| substitute::diffuse(if shape.emission.is_some() { 0.0 } else { 0.5 }));
        let opacity = self.float_input("opacity", alpha, None)?;
        Ok(Some(Element::plugin("bsdf", "mask").children(opacity).child(bsdf)))
    }

    fn mesh(
        &mut self,
        file: &MeshFile,
        shape: &Shape,
        facing: Facing,
        plugin: &dyn Fn(&str) -> Element,
    ) -> Result<Element, WriteError> {
        let keep = facing == Facing::FRONT
            && file.max_smooth_angle.is_none()
            && match file.format {
                MeshFormat::Serialized { .. } => true,
                MeshFormat::Obj => self.out.is("plain OBJ", &file.path, plain_obj)?,
                MeshFormat::ObjPart { .. } => false,
                MeshFormat::Ply => {
                    self.out.is("plain PLY", &file.path, plain_ply)? && self.out.is_triangle_ply(file)?
                }
            };
        if !keep {
            let mesh = self.out.mesh(file)?;
            // Those that Mitsuba computes itself are of the mirrored mesh.
            let turned = mesh.computed_normals && shape.to_world.determinant3() < 0.0;
            let facing = Facing { normals: facing.normals ^ turned, ..facing };
            let name = self.out.make_ply(file, facing, shape.origin)?;
            let element = plugin("ply").comment(format!("made from {}", file.path.display()));
            let flat = file.face_normals || mesh.normals.is_empty();
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

    /// Whole cylinders stay analytic; other quadrics that show uv, or are cut, are tessellated.
    fn quadric(
        &mut self,
        shape: &Shape,
        quadric: &PartialQuadric,
        facing: Facing,
    ) -> Result<Element, WriteError> {
        if let PartialQuadric::Cylinder { radius, z_min, z_max, .. } = *quadric
            && stays_analytic(quadric, &shape.to_world)
        {
            return Ok(Element::plugin("shape", "cylinder")
                .id(shape.name.as_deref())
                .triple("point", "p0", [0.0, 0.0, z_min])
                .triple("point", "p1", [0.0, 0.0, z_max])
                .float_unless("radius", radius, 1.0));
        }
        let file = self.out.make_quadric_ply(quadric, facing, shape.name.as_deref().unwrap_or("quadric"))?;
        Ok(self.tessellated(shape, &file))
    }

    /// Mitsuba 3 draws a stretched sphere or cylinder as a round one.
    fn stretched(&mut self, shape: &Shape, facing: Facing) -> Result<Option<Element>, WriteError> {
        let label = shape.name.as_deref().unwrap_or("quadric");
        let file = match shape.kind {
            ShapeKind::Sphere { center, radius } if !keeps_angles(&shape.to_world) => {
                self.out.make_sphere_ply(center, radius, facing, label)?
            }
            ShapeKind::Cylinder { p0, p1, radius } if !stays_round(&shape.to_world, along(p0, p1)) => {
                self.out.make_cylinder_ply(p0, p1, radius, facing, label)?
            }
            _ => return Ok(None),
        };
        Ok(Some(self.tessellated(shape, &file)))
    }

    fn tessellated(&mut self, shape: &Shape, file: &str) -> Element {
        let what = "a quadric that is cut or stretched, or textured in pbrt's way";
        let instead = "a mesh of 128 segments around, up to 0.03 % of the radius inside of it; normals mapped on it \
                       lean up to 1.4° aside";
        self.out.lose(shape.origin, what, instead);
        Element::plugin("shape", "ply").id(shape.name.as_deref()).string("filename", file)
    }

    /// pbrt's opacity dims a lamp, Mitsuba's mask does not.
    fn emission(&mut self, shape: &Shape, e: &AreaEmission) -> Result<Element, WriteError> {
        let opacity = shape.alpha.as_ref();
        if e.two_sided {
            let what = "a light that emits on both sides";
            self.out.lose_light(e.origin, what, "the side of its normal only", -0.5);
        }
        let factor = self.out.lamp_factor(shape, e)?;
        if e.scale < 0.0 {
            let what = format!("a light of negative radiance, scale {}", e.scale);
            self.out.lose(e.origin, what, "a dark one");
        }
        let scale = e.scale.max(0.0) * factor;
        let plugin = if e.collimated { "directionalarea" } else { "area" };
        // An invisible lamp shines fully.
        let share = match opacity {
            Some(FloatInput::Value(opacity)) if *opacity > 0.0 => opacity.min(1.0),
            _ => 1.0,
        };
        let radiance = match &e.radiance {
            _ if matches!(opacity, Some(FloatInput::Texture(_))) => self.masked_light(e, scale, opacity)?,
            ColorInput::Color(color) => self.light("radiance", color, scale * share, e.origin),
            ColorInput::Texture(id) => self.scaled_texture("radiance", *id, scale * share * self.light)?,
        };
        Ok(Element::plugin("emitter", plugin).child(radiance))
    }
}

/// Whether Mitsuba's analytic shape shows a quadric as pbrt does, with the same uv: whole cylinders.
fn stays_analytic(quadric: &PartialQuadric, m: &Transform) -> bool {
    match *quadric {
        PartialQuadric::Cylinder { z_min, z_max, phi_max, .. } => {
            phi_max >= 360.0 && stays_round(m, [0.0, 0.0, z_max - z_min]) && m.determinant3() > 0.0
        }
        _ => false,
    }
}

fn along(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| to[i] - from[i])
}

/// Whether the axes stay perpendicular and equally long.
fn keeps_angles(m: &Transform) -> bool {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| m.vector(axis));
    same(dot(y, y), dot(x, x)) && same(dot(z, z), dot(x, x)) && square(x, y) && square(x, z) && square(y, z)
}

/// Whether a cylinder about this axis stays one: circles across it stay circles, and across it.
fn stays_round(m: &Transform, axis: [f64; 3]) -> bool {
    let length = dot(axis, axis).sqrt();
    let frame = about(axis.map(|v| v / length));
    let [s, t, n] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| m.vector(frame.vector(axis)));
    same(dot(s, s), dot(t, t)) && square(s, t) && square(s, n) && square(t, n)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Up to the 1e-4 that matrices printed with six digits have.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs())
}

fn square(a: [f64; 3], b: [f64; 3]) -> bool {
    dot(a, b).abs() <= 1e-4 * (dot(a, a) * dot(b, b)).sqrt()
}
