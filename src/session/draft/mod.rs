//! A scene that was read and not compiled yet: its values can be read and changed by name.

mod array;
mod assets;
mod leaf;
mod names;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica_formats::confined::Confined;
use caustica_formats::ir::{
    Bitmap, Color, ColorInput, ColorSlot, FloatInput, Id, Ior, LightImage, Mapping, SpectrumRule, Texture,
    TextureEncoding, TextureKind, Transform,
};
use caustica_formats::spectrum::{ior, to_linear_rgb};
use caustica_formats::{Read, read_scene};

use super::beside::Beside;
use super::hashing::{Hashing, Served};
use super::{Error, Layers, Options, Session};
use crate::settings::Settings;

pub use array::{Array, NumberKind, ValueError};
use leaf::Leaf;
use names::Names;

/// A scene between reading and compiling. Values are named `OBJECT.FIELD`: `white.reflectance`,
/// `lamp.emission.radiance`, `bunny.vertex_positions`, `wood.data`.
#[derive(Debug)]
pub struct Draft {
    read: Read,
    files: Confined,
    served: Served,
    path: PathBuf,
    options: Options,
    names: Names,
    /// Meshes and pictures that were made of arrays.
    made: BTreeMap<PathBuf, Vec<u8>>,
    changed: BTreeMap<String, Array>,
}

impl Draft {
    /// Reads the scene file at `path` and what it includes; meshes and pictures are not opened yet.
    ///
    /// # Errors
    /// As [`Session::open`], as far as reading goes.
    pub fn open(path: &Path, options: &Options) -> Result<Self, Error> {
        options.override_settings(&mut Settings::default())?;
        let files = Confined::new(path, &options.allow_paths);
        let hashing = Hashing::new(&files, path);
        let read = read_scene(&hashing, path, &options.reading())?;
        let served = hashing.into_served();
        let names = Names::of(&read.scene);
        let (path, options) = (path.to_path_buf(), options.clone());
        let (made, changed) = (BTreeMap::new(), BTreeMap::new());
        Ok(Self { read, files, served, path, options, names, made, changed })
    }

    /// Compiles the scene as it is now, for `layers` where some are given instead of those of the options.
    ///
    /// # Errors
    /// As [`Session::open`], as far as compiling goes.
    pub fn compile(&self, layers: Option<Layers>) -> Result<Session, Error> {
        let mut options = self.options.clone();
        options.layers = layers.or(options.layers);
        let files = Beside { below: &self.files, made: &self.made };
        let mut hashing = Hashing::going_on(&files, &self.path, self.served.clone());
        self.changed.iter().for_each(|(key, array)| hashing.change(key, &array.data));
        Session::compiled(self.read.clone(), hashing, &self.path, &options).map_err(|error| self.told(error))
    }

    /// An error of compiling, with the values that were changed: the file, to which it points, does not have them.
    fn told(&self, error: Error) -> Error {
        let Error::Scene(mut failure) = error else { return error };
        if !self.changed.is_empty() {
            let keys: Vec<String> = self.changed.keys().map(|key| format!("`{key}`")).collect();
            let changed = format!(" (changed since the file was read: {})", keys.join(", "));
            failure.diagnostics.iter_mut().for_each(|problem| problem.message.push_str(&changed));
        }
        Error::Scene(failure)
    }

    /// The names of all values, those of one object together.
    pub fn keys(&mut self) -> Vec<String> {
        let mut keys = Vec::new();
        names::walk(&mut self.read.scene, &self.names, None, &mut |path, field| match Leaf::of(field) {
            Some(leaf) => {
                keys.extend(leaf.parts().iter().map(|part| format!("{path}{part}")));
                false
            }
            None => true,
        });
        keys
    }

    /// A value by its name.
    ///
    /// # Errors
    /// When there is none of this name, or its file cannot be read, or it is no array, such as a procedural texture.
    pub fn get(&mut self, key: &str) -> Result<Array, ValueError> {
        let (leaf, part) = self.find(key)?;
        if let Some(array) = leaf.numbers() {
            return Ok(array);
        }
        let files = Beside { below: &self.files, made: &self.made };
        match leaf {
            Leaf::Color(color) | Leaf::ColorInput(ColorInput::Color(color)) => self.rgb(key, &color),
            Leaf::ColorInput(ColorInput::Texture(id)) | Leaf::FloatInput(FloatInput::Texture(id)) => {
                self.bitmap_array(key, self.bitmap_of(key, id)?)
            }
            Leaf::Ior(Ior::Named(name)) => {
                let value =
                    ior(&name).ok_or_else(|| ValueError::invalid(key, format!("no index `{name}`")))?;
                Ok(Array::doubles(&[], [value]))
            }
            Leaf::Bitmap(bitmap) => self.bitmap_array(key, &bitmap),
            Leaf::Light(LightImage { path, encoding, scale, .. }) => {
                assets::picture_array(&files, &path, encoding, None, (scale, false), key)
            }
            Leaf::File(file) => Ok(assets::mesh_array(&assets::read_mesh(&files, &file, key)?, part)),
            Leaf::Inline(mesh) => Ok(assets::mesh_array(&assets::of_inline(&mesh), part)),
            // Those are numbers.
            _ => Err(ValueError::invalid(key, "it cannot be read")),
        }
    }

    /// Changes a value. Pictures take the place of constant colours; vertices keep their number.
    ///
    /// # Errors
    /// When there is none of this name, or it cannot have this shape or these numbers.
    pub fn set(&mut self, key: &str, array: Array) -> Result<(), ValueError> {
        if let Some(bad) = array.data.iter().find(|v| !v.is_finite()) {
            return Err(ValueError::invalid(key, format!("{bad} is not a finite number")));
        }
        // Readers refuse it in a file, and nothing after them looks at it again.
        if let Some(bad) = array.data.iter().find(|v| key.ends_with(".radius") && **v <= 0.0) {
            return Err(ValueError::invalid(key, format!("{bad} is not a positive radius")));
        }
        let (leaf, part) = self.find(key)?;
        let leaf = match leaf.with(key, &array)? {
            Some(leaf) => {
                self.check_range(key, &leaf)?;
                leaf
            }
            None => self.asset(key, leaf, part, &array)?,
        };
        let path = &key[..key.len() - part.len()];
        let mut value = Some(leaf);
        names::walk(&mut self.read.scene, &self.names, Some(key), &mut |at, field| {
            if at == path
                && Leaf::of(field).is_some()
                && let Some(leaf) = value.take()
            {
                leaf.store(field);
            }
            value.is_some()
        });
        self.changed.insert(key.to_owned(), array);
        Ok(())
    }

    /// Makes sure that a surface may have this value, as compiling does, whose errors are about the file.
    fn check_range(&self, key: &str, leaf: &Leaf) -> Result<(), ValueError> {
        let field = key.rsplit('.').next().unwrap_or_default();
        let bounded = ["reflectance", "transmittance", "base_color"].iter().any(|end| field.ends_with(end));
        match leaf {
            Leaf::Color(color) | Leaf::ColorInput(ColorInput::Color(color)) if bounded => {
                self.rgb(key, color).map(drop)
            }
            Leaf::Ior(Ior::Value(index)) if *index <= 0.0 => {
                Err(ValueError::invalid(key, format!("{index} is not a positive index of refraction")))
            }
            _ => Ok(()),
        }
    }

    /// The field of a key, and the part of the key that says which of its arrays is meant.
    fn find(&mut self, key: &str) -> Result<(Leaf, &'static str), ValueError> {
        let mut found = None;
        names::walk(&mut self.read.scene, &self.names, Some(key), &mut |path, field| {
            let Some(rest) = key.strip_prefix(path).filter(|_| found.is_none()) else { return false };
            let Some(leaf) = Leaf::of(field) else { return true };
            found = leaf.parts().iter().find(|part| **part == rest).map(|part| (leaf, *part));
            false
        });
        found.ok_or_else(|| ValueError::unknown(key, &self.keys()))
    }

    /// Linear Rec.709, as the scene is rendered.
    fn rgb(&self, key: &str, color: &Color) -> Result<Array, ValueError> {
        let spectral = !matches!(color, Color::Gray(_) | Color::Rgb(_) | Color::Srgb(_));
        let rule = self.options.spectrum_rule.filter(|_| spectral).unwrap_or(self.read.scene.spectrum_rule);
        let slot = match key.rsplit('.').next().unwrap_or_default() {
            "radiance" | "intensity" | "irradiance" => ColorSlot::Emission,
            "eta" | "k" | "sigma_a" | "sigma_s" | "sigma_t" => ColorSlot::Unbounded,
            _ => ColorSlot::Reflectance,
        };
        let rgb = to_linear_rgb(color, slot, rule).map_err(|e| ValueError::invalid(key, e))?;
        Ok(Array::doubles(&[3], rgb))
    }

    fn bitmap_of(&self, key: &str, id: Id<Texture>) -> Result<&Bitmap, ValueError> {
        let texture = &self.read.scene.textures[id];
        match &texture.kind {
            TextureKind::Bitmap(bitmap) => Ok(bitmap),
            kind => {
                let (kind, name) = (kind.name(), self.names.texture(id));
                let what = format!("it is a texture of kind `{kind}`, whose own values begin with `{name}.`");
                Err(ValueError::invalid(key, what))
            }
        }
    }

    fn bitmap_array(&self, key: &str, bitmap: &Bitmap) -> Result<Array, ValueError> {
        let Bitmap { path, encoding, channel, scale, invert, .. } = bitmap;
        let files = Beside { below: &self.files, made: &self.made };
        assets::picture_array(&files, path, *encoding, *channel, (*scale, *invert), key)
    }

    /// The value with an array that becomes a file.
    fn asset(&mut self, key: &str, leaf: Leaf, part: &str, array: &Array) -> Result<Leaf, ValueError> {
        let folder = self.path.parent().unwrap_or(Path::new("")).to_path_buf();
        let place = |name: &str, extension: &str| folder.join(format!("array {name}.{extension}"));
        let object = &key[..key.len() - part.len()];
        let files = Beside { below: &self.files, made: &self.made };
        Ok(match leaf {
            Leaf::File(file) => {
                let mut mesh = assets::read_mesh(&files, &file, key)?;
                assets::set_mesh_array(&mut mesh, part, key, array, !file.authored_normals)?;
                let (file, bytes) = assets::mesh_file(mesh, &file, place(object, "ply"));
                self.made.insert(file.path.clone(), bytes);
                Leaf::File(file)
            }
            Leaf::Inline(old) => {
                let mut mesh = assets::of_inline(&old);
                assets::set_mesh_array(&mut mesh, part, key, array, false)?;
                Leaf::Inline(assets::into_inline(mesh, &old))
            }
            Leaf::Light(old) => {
                let path = self.picture(key, place(key, "exr"), array)?;
                Leaf::Light(LightImage { path, encoding: TextureEncoding::Linear, scale: 1.0, ..old })
            }
            Leaf::Bitmap(old) => {
                let path = self.picture(key, place(key, "exr"), array)?;
                Leaf::Bitmap(shown_as_is(old, path))
            }
            Leaf::ColorInput(old) => {
                let id = if let ColorInput::Texture(id) = old { Some(id) } else { None };
                Leaf::ColorInput(ColorInput::Texture(self.texture(key, place(key, "exr"), id, array)?))
            }
            Leaf::FloatInput(old) => {
                let id = if let FloatInput::Texture(id) = old { Some(id) } else { None };
                Leaf::FloatInput(FloatInput::Texture(self.texture(key, place(key, "exr"), id, array)?))
            }
            other => other,
        })
    }

    fn picture(&mut self, key: &str, path: PathBuf, array: &Array) -> Result<PathBuf, ValueError> {
        self.made.insert(path.clone(), assets::encode_picture(key, array)?);
        Ok(path)
    }

    /// A new texture, which lies on the surface as `old` does: others may use that one.
    fn texture(
        &mut self,
        key: &str,
        path: PathBuf,
        old: Option<Id<Texture>>,
        array: &Array,
    ) -> Result<Id<Texture>, ValueError> {
        let path = self.picture(key, path, array)?;
        let scene = &mut self.read.scene;
        let bitmap = match old.map(|id| &scene.textures[id].kind) {
            Some(TextureKind::Bitmap(bitmap)) => shown_as_is(bitmap.clone(), path),
            _ => Bitmap::raw(path, Mapping::Uv(upright(scene.spectrum_rule))),
        };
        self.names.add_texture(key);
        let kind = TextureKind::Bitmap(bitmap);
        Ok(scene.textures.push(Texture { name: None, origin: scene.origin, kind }))
    }
}

fn shown_as_is(old: Bitmap, path: PathBuf) -> Bitmap {
    Bitmap { path, encoding: TextureEncoding::Linear, channel: None, scale: 1.0, invert: false, ..old }
}

/// Where the first row of a picture lies: at v = 0 in Mitsuba, at v = 1 in pbrt.
fn upright(rule: SpectrumRule) -> Transform {
    let mut m = Transform::IDENTITY;
    if rule == SpectrumRule::Pbrt {
        (m.0[1][1], m.0[1][3]) = (-1.0, 1.0);
    }
    m
}
