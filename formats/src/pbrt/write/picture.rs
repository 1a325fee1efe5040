//! Pictures that pbrt reads by rules of its own: those of lamps, slides and normals, and textures made into one.

use super::Writer;
use super::text::Params;
use crate::ir::{
    Bitmap, Color, ColorInput, ColorSlot, Id, Mapping, Origin, Shape, ShapeKind, SpotFalloff, Texture,
    TextureEncoding, TextureFilter, TextureKind, Transform, WrapMode,
};
use crate::write::{Cone, Sampled, WriteError};

/// The widest spot that is written as a picture on a plane, in degrees of its half angle.
pub const WIDEST: f64 = 85.0;

impl Writer<'_, '_> {
    /// The parameters that give a lamp its picture: pbrt takes no more of it than the file's name.
    pub fn emitted_picture(
        &mut self,
        id: Id<Texture>,
        shape: &Shape,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        let none = Params::default();
        if let TextureKind::Bitmap(b) = &self.scene.textures[id].kind
            && plain(b)
            && [b.wrap_u, b.wrap_v] == [WrapMode::Clamp; 2]
            && matches!(b.encoding, TextureEncoding::Auto)
            && !self.out.is_gray(&b.path)
            && self.out.is_well_named(&b.path)
        {
            let name = self.out.carry(&b.path, "textures");
            return Ok(none.string("filename", &name));
        }
        match self.out.sampled(id)? {
            Some(sampled) => {
                if self.out.leaves_the_square(shape)? {
                    self.out.lose(origin, "the picture of a light beyond uv 0 to 1", "its border");
                }
                let name = self.out.make_square(id, &sampled, [1.0; 3], false)?;
                Ok(none.string("filename", &name))
            }
            None => {
                let mean = self.shown_mean(id, shape)?;
                let what = "the texture of a light that does not follow uv";
                self.out.lose(origin, what, format!("its mean, rgb {mean:?}"));
                Ok(none.rgb("L", mean))
            }
        }
    }

    /// The mean of what cannot be said: of a mesh's attribute over its vertices, else of a gray 0.5.
    fn shown_mean(&mut self, id: Id<Texture>, shape: &Shape) -> Result<[f64; 3], WriteError> {
        let (TextureKind::MeshAttribute { name, scale }, ShapeKind::Mesh(file)) =
            (&self.scene.textures[id].kind, &shape.kind)
        else {
            return Ok([0.5; 3]);
        };
        let mesh = self.out.mesh(file)?;
        let Some(attribute) = mesh.attributes.iter().find(|attribute| attribute.name == *name) else {
            return Ok([0.5; 3]);
        };
        let sum = attribute
            .values
            .iter()
            .fold([0.0; 3], |sum: [f64; 3], v| std::array::from_fn(|c| sum[c] + f64::from(v[c])));
        Ok(sum.map(|v| scale * v / attribute.values.len().max(1) as f64))
    }

    /// A texture that pbrt has no words for, as a picture for uv from 0 to 1.
    pub fn baked(
        &mut self,
        id: Id<Texture>,
        what: &str,
        origin: Origin,
    ) -> Result<Option<Params>, WriteError> {
        let Some(sampled) = self.out.sampled(id)? else { return Ok(None) };
        if !sampled.repeats() && self.out.any_leaves_the_square()? {
            self.out.lose(origin, format!("{what}, beyond uv 0 to 1"), "the part from 0 to 1, repeated");
        }
        let name = self.out.make_square(id, &sampled, [1.0; 3], true)?;
        let p = Params::default().string("filename", &name).string("filter", "bilinear");
        Ok(Some(p.float("vscale", -1.0).float("vdelta", 1.0)))
    }

    /// A normal map's file: pbrt looks it up by uv as they are, repeated and interpolated.
    pub fn normal_picture(
        &mut self,
        normals: &ColorInput,
        origin: Origin,
    ) -> Result<Option<String>, WriteError> {
        let id = match normals {
            ColorInput::Color(Color::Gray(_)) => return Ok(None),
            ColorInput::Color(color) => {
                let rgb = self.out.rgb(color, ColorSlot::Unbounded, origin);
                return self.out.make_plain(rgb).map(Some);
            }
            ColorInput::Texture(id) => *id,
        };
        if let TextureKind::Bitmap(b) = &self.scene.textures[id].kind
            && plain(b)
            && [b.wrap_u, b.wrap_v] == [WrapMode::Repeat; 2]
            && b.encoding == TextureEncoding::Linear
            && !self.out.is_gray(&b.path)
            && self.out.is_well_named(&b.path)
        {
            return Ok(Some(self.out.carry(&b.path, "textures")));
        }
        let Some(sampled) = self.out.sampled(id)? else { return Ok(None) };
        if !sampled.repeats() && self.out.any_leaves_the_square()? {
            self.out.lose(origin, "a normal map beyond uv 0 to 1", "the part from 0 to 1, repeated");
        }
        self.out.make_square(id, &sampled, [1.0; 3], false).map(Some)
    }

    /// A spot with a texture by uv as the parameters of a projection.
    pub fn textured_spot(
        &mut self,
        intensity: &Color,
        [cutoff, beam]: [f64; 2],
        falloff: SpotFalloff,
        texture: Id<Texture>,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        let rgb = self.out.rgb(intensity, ColorSlot::Emission, origin);
        let sampled = self.out.sampled(texture)?.unwrap_or(Sampled::Constant([1.0; 3]));
        let cone = Cone::new(cutoff, beam, falloff);
        let name = self.out.spot_intensity(texture, &sampled, rgb, &cone)?;
        Ok(Params::default().string("filename", &name).float("fov", 2.0 * cutoff))
    }

    /// The mean of a texture over its square, or gray 0.5 where it is not by uv.
    pub fn mean_of(&mut self, texture: Id<Texture>) -> Result<[f64; 3], WriteError> {
        Ok(self.out.sampled(texture)?.map_or([0.5; 3], |sampled| sampled.mean()))
    }
}

/// A picture as it is, upright by pbrt's uv.
fn plain(b: &Bitmap) -> bool {
    b.channel.is_none()
        && b.scale == 1.0
        && !b.invert
        && b.filter == TextureFilter::Bilinear
        && super::super::texture::upside_down(b.mapping) == Mapping::Uv(Transform::IDENTITY)
}

/// Whether an `imagemap` says it.
pub fn sayable(b: &Bitmap) -> bool {
    let straight = match b.mapping {
        Mapping::Uv(m) => m.0[0][1] == 0.0 && m.0[1][0] == 0.0,
        _ => true,
    };
    straight && b.wrap_u == b.wrap_v && !matches!(b.wrap_u, WrapMode::Mirror | WrapMode::One)
}
