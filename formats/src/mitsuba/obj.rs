//! Materials of OBJ files as Mitsuba 0.6 has them: those of the material library, and those that the scene gives by
//! name. Later versions know neither.

use std::path::{Path, PathBuf};

use super::object::{Class, ObjectIndex, Value};
use super::reader::Reader;
use super::version::Dialect;
use crate::diagnostic::{Diagnostic, Span};
use crate::files::{MAX_FILE_BYTES, is_gzip, unpack};
use crate::ir::{
    Bitmap, Bsdf, BsdfKind, Color, ColorInput, Conductor, ConductorMaterial, Dielectric, FloatInput, Id, Ior,
    Mapping, MeshFormat, Origin, PerturbedShading, Shape, ShapeKind, Texture, TextureEncoding, TextureFilter,
    TextureKind, Transform, WrapMode,
};
use crate::mesh::{ObjMaterial, obj_parts, read_mtl};

/// Which parts of an OBJ file are wanted, and the bsdf of each.
pub(super) struct ObjParts(Vec<(MeshFormat, Option<Id<Bsdf>>)>);

impl ObjParts {
    /// `shape`, which has all of the file, once for each part.
    pub fn apply(self, shape: Shape) -> Vec<Shape> {
        let ShapeKind::Mesh(file) = &shape.kind else { return vec![shape] };
        let part = |(format, bsdf)| {
            let mut file = file.clone();
            file.format = format;
            Shape { kind: ShapeKind::Mesh(file), bsdf, ..shape.clone() }
        };
        self.0.into_iter().map(part).collect()
    }
}

impl<'a> Reader<'a> {
    /// The parts of an OBJ file of 0.6 that has materials; `None` for any other shape, which is of one piece.
    pub fn obj_materials(&mut self, index: ObjectIndex) -> Option<ObjParts> {
        let object = &self.objects[index];
        if object.plugin != "obj" || self.dialect != Dialect::Old {
            return None;
        }
        let given = self.given_bsdfs(index);
        let lamp = object.entries.iter().any(|e| self.class_of(&e.value) == Some(Class::Emitter));
        // The last bsdf without a name has all faces, but for those that later ones have by name.
        let all = given.iter().rposition(|(name, ..)| name.is_empty());
        let named = &given[all.map_or(0, |at| at + 1)..];
        if lamp || (all.is_some() && named.is_empty()) {
            return None;
        }
        let mut props = self.props(index);
        let loads = props.boolean("load_materials", true);
        let collapse = props.boolean("collapse", false);
        let only = props.optional_integer("shape_index").filter(|index| *index >= 0);
        let path = self.asset(&mut props, "mesh")?;
        let bytes = self.file(&path).ok()?;
        let bytes = if is_gzip(&bytes) { unpack(&bytes, MAX_FILE_BYTES).ok()? } else { bytes };
        let parts = obj_parts(&bytes);
        if let Some(only) = only {
            let span = self.objects[index].span;
            let text = format!(
                "`shapeIndex` {only} counts materials here, of which the file has {}",
                parts.materials.len()
            );
            self.problems.push(Diagnostic::warning(text, Some(span)));
        }
        for (name, _, span) in named.iter().filter(|(name, ..)| !parts.materials.contains(name)) {
            let text = format!("no face of `{}` has the material `{name}`", path.display());
            self.problems.push(Diagnostic::warning(text, Some(*span)));
        }
        let library = parts.library.as_deref().filter(|_| loads && all.is_none());
        let library =
            library.map_or_else(Vec::new, |name| self.library(&path, name, self.objects[index].span));
        if library.is_empty() && named.is_empty() {
            return None;
        }
        let everywhere = all.map(|at| self.bsdf(given[at].1));
        let mut out = Vec::new();
        for (i, material) in parts.materials.iter().enumerate() {
            if only.is_some_and(|only| only != i as i64) {
                continue;
            }
            let named = named.iter().rfind(|(name, ..)| name == material).map(|&(_, bsdf, _)| bsdf);
            let listed = library.iter().rfind(|m| m.name == *material);
            let bsdf = match (named, listed) {
                (Some(named), _) => Some(self.bsdf(named)),
                (None, Some(listed)) => Some(self.of_library(listed, &path, self.objects[index].span)),
                (None, None) => everywhere,
            };
            out.push((MeshFormat::ObjPart { index: i as u32 }, bsdf));
        }
        if let [(format, _)] = &mut out[..]
            && parts.materials.len() == 1
        {
            *format = MeshFormat::Obj;
        }
        // Joined into one shape, the faces have one bsdf: that of the last material.
        match out.last().map(|(_, bsdf)| *bsdf) {
            Some(bsdf) if collapse => Some(ObjParts(vec![(MeshFormat::Obj, bsdf)])),
            _ => Some(ObjParts(out)),
        }
    }

    /// Names of the nested bsdfs, which may be empty, in the order of the file.
    fn given_bsdfs(&self, index: ObjectIndex) -> Vec<(String, ObjectIndex, Span)> {
        let entries = self.objects[index].entries.iter();
        let bsdfs = entries.filter_map(|entry| match entry.value {
            Value::Object(bsdf) if self.objects[bsdf].class == Class::Bsdf => {
                Some((entry.name.clone().unwrap_or_default(), bsdf, entry.span))
            }
            _ => None,
        });
        bsdfs.collect()
    }

    fn class_of(&self, value: &Value) -> Option<Class> {
        match value {
            Value::Object(index) => Some(self.objects[*index].class),
            _ => None,
        }
    }

    /// The materials of the library that an OBJ file names, which stands beside it.
    fn library(&mut self, mesh: &Path, name: &str, span: Span) -> Vec<ObjMaterial> {
        let folders = [mesh.parent().unwrap_or(Path::new("")).to_path_buf()];
        let found = self.beside(name, &folders).map(|path| self.file(&path));
        match found {
            Some(Ok(bytes)) => read_mtl(&bytes),
            Some(Err(e)) => {
                self.problems
                    .push(Diagnostic::warning(format!("cannot read materials `{name}`: {e}"), Some(span)));
                Vec::new()
            }
            None => {
                let text =
                    format!("materials `{name}` of `{}` not found: its default is used", mesh.display());
                self.problems.push(Diagnostic::warning(text, Some(span)));
                Vec::new()
            }
        }
    }

    /// A material as the loader of 0.6 makes it: diffuse, modified Phong, glass or aluminium by `illum`, with bumps
    /// and opacity around it.
    fn of_library(&mut self, m: &ObjMaterial, mesh: &Path, span: Span) -> Id<Bsdf> {
        let key = (mesh.to_path_buf(), m.name.clone());
        if let Some(id) = self.obj_bsdfs.get(&key) {
            return *id;
        }
        let origin = Origin(Some(span));
        let folder = mesh.parent().unwrap_or(Path::new("")).to_path_buf();
        let diffuse = self.library_color(m.diffuse, m.diffuse_map.as_deref(), &folder, span);
        let shines = m.specular_map.is_some() || m.specular.is_some_and(|c| c != [0.0; 3]);
        let exponent = f64::from(m.exponent.unwrap_or(0.0));
        let kind = match m.model {
            2 if shines && exponent != 0.0 => BsdfKind::Phong {
                exponent: FloatInput::Value(exponent),
                diffuse_reflectance: diffuse,
                specular_reflectance: self.library_color(
                    m.specular,
                    m.specular_map.as_deref(),
                    &folder,
                    span,
                ),
            },
            4 | 6 | 7 | 9 => BsdfKind::Dielectric(Dielectric {
                int_ior: Ior::Named("bk7".to_owned()),
                ext_ior: Ior::Named("air".to_owned()),
                specular_reflectance: ColorInput::Color(Color::Gray(1.0)),
                specular_transmittance: ColorInput::Color(Color::Gray(1.0)),
            }),
            5 | 8 => BsdfKind::Conductor(Conductor {
                material: ConductorMaterial::Named {
                    name: "Al".to_owned(),
                    ext_eta: Some(Ior::Named("air".to_owned())),
                },
                specular_reflectance: ColorInput::Color(Color::Gray(1.0)),
            }),
            _ => BsdfKind::Diffuse { reflectance: diffuse },
        };
        let mut push = |kind| self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
        let mut id = push(kind);
        if let Some(name) = &m.bump_map
            && let Some(height) = self.library_picture(name, &folder, TextureEncoding::Linear, span)
        {
            let shading = PerturbedShading { flip_invalid_normals: false, shadowing: false };
            let kind =
                BsdfKind::BumpMap { height: FloatInput::Texture(height), scale: 1.0, shading, nested: id };
            id = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
        }
        let opacity = match &m.opacity_map {
            Some(name) => {
                let picture = self.library_picture(name, &folder, TextureEncoding::Auto, span);
                Some(picture.map_or(FloatInput::Value(0.0), FloatInput::Texture))
            }
            None => m.opacity.filter(|d| *d != 1.0).map(|d| FloatInput::Value(f64::from(d))),
        };
        if let Some(opacity) = opacity {
            let kind = BsdfKind::Mask { opacity, nested: id };
            id = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
        }
        self.scene.bsdfs[id].name = Some(m.name.clone()).filter(|name| self.is_free(name));
        self.obj_bsdfs.insert(key, id);
        id
    }

    /// Whether no object of the scene has this id.
    fn is_free(&self, name: &str) -> bool {
        self.objects.iter().all(|object| object.id.as_deref() != Some(name))
            && self.scene.bsdfs.iter().all(|(_, bsdf)| bsdf.name.as_deref() != Some(name))
    }

    /// A colour, black where there is none; a picture wins.
    fn library_color(
        &mut self,
        color: Option<[f32; 3]>,
        map: Option<&str>,
        folder: &Path,
        span: Span,
    ) -> ColorInput {
        let Some(map) = map else {
            return ColorInput::Color(Color::Srgb(color.unwrap_or_default().map(f64::from)));
        };
        let picture = self.library_picture(map, folder, TextureEncoding::Auto, span);
        picture.map_or(ColorInput::Color(Color::Gray(0.0)), ColorInput::Texture)
    }

    /// A picture beside the library; `None` after a warning, and 0.6 shows black.
    fn library_picture(
        &mut self,
        name: &str,
        folder: &Path,
        encoding: TextureEncoding,
        span: Span,
    ) -> Option<Id<Texture>> {
        let folders = [folder.to_path_buf()];
        // The name may follow options, and its folder may be one of another machine.
        let last = name.split_whitespace().next_back().unwrap_or(name);
        let bare = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let names = [name.to_owned(), last.to_owned(), bare(name), bare(last)];
        let Some(path) = names.iter().find_map(|name| self.beside(name, &folders)) else {
            let text = format!("the picture `{name}` of a material is not found: black is used");
            self.problems.push(Diagnostic::warning(text, Some(span)));
            return None;
        };
        let kind = TextureKind::Bitmap(bitmap(path, encoding));
        Some(self.scene.textures.push(Texture { name: None, origin: Origin(Some(span)), kind }))
    }
}

/// As Mitsuba's `bitmap` by default.
fn bitmap(path: PathBuf, encoding: TextureEncoding) -> Bitmap {
    Bitmap {
        path,
        filter: TextureFilter::Bilinear,
        wrap_u: WrapMode::Repeat,
        wrap_v: WrapMode::Repeat,
        encoding,
        channel: None,
        mapping: Mapping::Uv(Transform::IDENTITY),
        scale: 1.0,
        invert: false,
    }
}
