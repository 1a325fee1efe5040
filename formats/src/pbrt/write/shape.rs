//! Shapes, objects and instances.

use super::Writer;
use super::text::{Params, transform};
use crate::ir::{
    FloatInput, Id, InlineMesh, MeshFile, MeshFormat, Origin, PartialQuadric, Shape, ShapeGroup, ShapeKind,
    Transform,
};
use crate::mesh::{Mesh, builtin};
use crate::write::{Facing, WriteError, about};

/// Meshes up to this size stand in the scene file.
const INLINE: usize = 64;

/// Plugin, parameters, and a transform that comes before the shape's own.
type Geometry = (&'static str, Params, Option<Transform>);

impl Writer<'_, '_> {
    pub fn group(&mut self, id: Id<ShapeGroup>) -> Result<(), WriteError> {
        let scene = self.scene;
        let name = self.free(&scene.groups[id].name, "object");
        self.objects.insert(id, name.clone());
        let outside = std::mem::take(&mut self.body);
        for shape in &scene.groups[id].shapes {
            if let Some(emission) = &shape.emission {
                self.out.lose(
                    emission.origin,
                    "light from a shape of a group",
                    "a shape that does not emit light",
                );
                self.shape(&Shape { emission: None, ..shape.clone() })?;
            } else {
                self.shape(shape)?;
            }
        }
        let inside = std::mem::replace(&mut self.body, outside);
        Params::default().write(&mut self.definitions, "", "ObjectBegin", &[&name]);
        self.definitions.push_str(&inside);
        self.definitions.push_str("ObjectEnd\n");
        Ok(())
    }

    pub fn shape(&mut self, shape: &Shape) -> Result<(), WriteError> {
        let mut text = String::new();
        self.place(&mut text, "", shape.origin);
        text.push_str("AttributeBegin\n");
        if let Some(name) = &shape.name {
            text.push_str(&format!("\t# {}\n", name.replace('\n', " ")));
        }
        if let ShapeKind::Instance { group } = shape.kind {
            let name = self.objects.get(&group).cloned().unwrap_or_default();
            self.to_world(&mut text, &shape.to_world);
            Params::default().write(&mut text, "\t", "ObjectInstance", &[&name]);
            text.push_str("AttributeEnd\n");
            self.body.push_str(&text);
            return Ok(());
        }
        let (material, mask) = self.shape_material(shape)?;
        if shape.emission.is_some() && self.interfaces.contains(&material) {
            self.out.lose(
                shape.origin,
                "an emitting surface that light passes through",
                "a light with a black surface",
            );
            return self.shape(&Shape { bsdf: None, ..shape.clone() });
        }
        Params::default().write(&mut text, "\t", "NamedMaterial", &[&material]);
        if let Some(media) = shape.media {
            self.medium_interface(&mut text, "\t", media);
        }
        if let Some(emission) = &shape.emission {
            let factor = self.despite_mask(mask.as_ref(), emission.origin);
            self.emission(&mut text, shape, emission, factor)?;
        }
        // Without normals of the author, the side of Mitsuba's meshes is that of their winding in the world, pbrt's
        // in object space.
        let by_world = match &shape.kind {
            ShapeKind::Mesh(file) => !file.authored_normals && self.out.faces_by_winding(file)?,
            _ => false,
        };
        let Some((name, mut p, inner)) = self.geometry(shape)? else { return Ok(()) };
        let mirrored = by_world && shape.to_world.determinant3() < 0.0;
        let turned = inner.is_some_and(|inner| inner.determinant3() < 0.0);
        if shape.flip_normals ^ mirrored ^ turned {
            text.push_str("\tReverseOrientation\n");
        }
        self.to_world(&mut text, &inner.map_or(shape.to_world, |inner| shape.to_world.after(&inner)));
        if let Some(alpha) = shape.alpha.clone().or(mask) {
            p = self.float_input(p, "alpha", &alpha)?;
        }
        p.write(&mut text, "\t", "Shape", &[name]);
        text.push_str("AttributeEnd\n");
        self.body.push_str(&text);
        Ok(())
    }

    fn to_world(&self, text: &mut String, m: &Transform) {
        if *m != Transform::IDENTITY {
            transform(text, "\t", m);
        }
    }

    /// `None` after a loss; instances are written by the caller.
    fn geometry(&mut self, shape: &Shape) -> Result<Option<Geometry>, WriteError> {
        let none = Params::default();
        let label = shape.name.as_deref();
        Ok(Some(match &shape.kind {
            ShapeKind::Mesh(file) => {
                ("plymesh", none.string("filename", &self.mesh(file, shape.origin)?), None)
            }
            ShapeKind::Inline(mesh) if mesh.triangles.len() > INLINE => {
                let name = self.out.make_inline_ply(mesh, Facing::FRONT, label.unwrap_or("mesh"))?;
                ("plymesh", none.string("filename", &name), None)
            }
            ShapeKind::Inline(mesh) => ("trianglemesh", triangles(mesh), None),
            ShapeKind::Sphere { center, radius } => {
                // Mitsuba's v runs from +Z downwards, pbrt's upwards.
                let mut inner = Transform::translate(*center);
                if self.query.textured(&self.scene.bsdfs, shape) {
                    inner = inner.after(&Transform::scale([1.0, 1.0, -1.0]));
                }
                ("sphere", none.float("radius", *radius), Some(inner))
            }
            ShapeKind::Partial(PartialQuadric::Sphere { radius, z_min, z_max, phi_max }) => {
                let p = none.float("radius", *radius).float_unless("zmin", *z_min, -radius);
                let p = p.float_unless("zmax", *z_max, *radius).float_unless("phimax", *phi_max, 360.0);
                ("sphere", p, None)
            }
            ShapeKind::Partial(PartialQuadric::Disk { height, radius, inner_radius, phi_max }) => {
                let p = none.float("radius", *radius).float_unless("height", *height, 0.0);
                let p = p.float_unless("innerradius", *inner_radius, 0.0);
                ("disk", p.float_unless("phimax", *phi_max, 360.0), None)
            }
            ShapeKind::Partial(PartialQuadric::Cylinder { radius, z_min, z_max, phi_max }) => {
                let p = none.float("radius", *radius).float("zmin", *z_min).float("zmax", *z_max);
                ("cylinder", p.float_unless("phimax", *phi_max, 360.0), None)
            }
            ShapeKind::Rectangle => ("trianglemesh", triangles(&inline(builtin::rectangle(false))), None),
            ShapeKind::Cube => ("trianglemesh", triangles(&inline(builtin::cube())), None),
            // Mitsuba's u is the radius and its v the angle; pbrt's are the angle and the way inwards.
            ShapeKind::Disk if self.directed(shape) => {
                let name = self.out.make_disk_ply(label.unwrap_or("disk"))?;
                ("plymesh", none.string("filename", &name), None)
            }
            ShapeKind::Disk => ("disk", none.float("radius", 1.0), None),
            ShapeKind::Cylinder { p0: [0.0, 0.0, bottom], p1: [0.0, 0.0, top], radius } if bottom < top => {
                let p = none.float("radius", *radius).float("zmin", *bottom).float("zmax", *top);
                ("cylinder", p, None)
            }
            ShapeKind::Cylinder { p0, p1, radius } => {
                let axis: [f64; 3] = std::array::from_fn(|i| p1[i] - p0[i]);
                let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
                let inner = Transform::translate(*p0).after(&about(axis.map(|v| v / length)));
                let p = none.float("radius", *radius).float("zmin", 0.0).float("zmax", length);
                ("cylinder", p, Some(inner))
            }
            other => {
                self.out.lose(shape.origin, format!("a shape of kind `{}`", other.name()), "no shape");
                return Ok(None);
            }
        }))
    }

    /// pbrt's opacity dims a lamp, a mask on its material does not: the factor that makes up for it.
    fn despite_mask(&mut self, mask: Option<&FloatInput>, origin: Origin) -> f64 {
        match mask {
            Some(FloatInput::Value(opacity)) if *opacity > 0.0 => 1.0 / opacity.min(1.0),
            Some(FloatInput::Texture(_)) => {
                let what = "a light that shines where its material is cut away";
                self.out.lose(origin, what, "light by the share of the surface that is left");
                1.0
            }
            _ => 1.0,
        }
    }

    /// Whether it shows how uv lie on the shape.
    fn directed(&mut self, shape: &Shape) -> bool {
        let bsdfs = &self.scene.bsdfs;
        self.query.textured(bsdfs, shape)
            || shape.bsdf.is_some_and(|id| self.query.bsdf(bsdfs, id).anisotropic)
    }

    /// The file itself where pbrt reads it the same way, otherwise a converted one.
    fn mesh(&mut self, file: &MeshFile, origin: Origin) -> Result<String, WriteError> {
        let keep = file.authored_normals
            && file.format == MeshFormat::Ply
            && !file.flip_tex_coords
            && self.out.is_triangle_ply(file)?;
        if keep {
            Ok(self.out.carry(&file.path, "meshes"))
        } else {
            self.out.make_ply(file, Facing::FRONT, origin)
        }
    }

    /// The named material, and the opacity of a mask around it.
    fn shape_material(&mut self, shape: &Shape) -> Result<(String, Option<FloatInput>), WriteError> {
        let Some(id) = shape.bsdf else {
            let gray = if shape.emission.is_some() { 0.0 } else { 0.5 };
            return Ok((self.plain_material(gray), None));
        };
        let (id, mask) = self.unmasked(id);
        if mask.is_some() && shape.alpha.is_some() {
            self.out.lose(shape.origin, "a mask on a shape with an opacity of its own", "the latter");
        }
        Ok((self.material(id)?, mask))
    }
}

fn inline(mesh: Mesh) -> InlineMesh {
    let Mesh { positions, normals, uvs, triangles, .. } = mesh;
    InlineMesh { positions, normals, uvs, triangles, made_from: None }
}

fn triangles(mesh: &InlineMesh) -> Params {
    Params::default()
        .coordinates("point3", "P", &mesh.positions)
        .coordinates("normal", "N", &mesh.normals)
        .coordinates("point2", "uv", &mesh.uvs)
        .integers("indices", mesh.triangles.as_flattened().iter().copied())
}
