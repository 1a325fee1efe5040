//! Pictures of textures, decoded in parallel with the geometry.

use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

use caustica_formats::files::Files;
use caustica_formats::image::{self, Encoding, Samples};
use caustica_formats::ir;
use caustica_formats::spectrum::SrgbTable;
use rayon::prelude::*;

use super::super::Compiler;
use crate::texture::{Bitmap, Bytes, Param, Texels, Texture, Textures, Wrap};

/// A texture whose picture is not decoded yet.
pub struct Waiting {
    texture: u32,
    picture: Arc<Picture>,
}

/// A picture that is being decoded, shared with the decoding task.
pub struct Picture {
    of: ir::Id<ir::Texture>,
    state: Mutex<State>,
}

enum State {
    Wanted,
    Decoded(Result<Decoded, String>),
    Taken,
}

struct Decoded {
    width: usize,
    height: usize,
    texels: Texels,
}

impl Picture {
    /// Decodes it if that has not been done. Concurrent callers wait.
    fn decode(&self, ir: &ir::Scene, files: &dyn Files) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let (State::Wanted, ir::TextureKind::Bitmap(b)) = (&*state, &ir.textures[self.of].kind) {
            *state = State::Decoded(decode(b, files));
        }
    }

    /// The result, once.
    fn take(&self, ir: &ir::Scene, files: &dyn Files) -> Option<Result<Decoded, String>> {
        self.decode(ir, files);
        match mem::replace(&mut *self.state.lock().unwrap_or_else(PoisonError::into_inner), State::Taken) {
            State::Decoded(result) => Some(result),
            State::Wanted | State::Taken => None,
        }
    }
}

/// Decodes all, in parallel.
pub fn decode_all(pictures: &[Arc<Picture>], ir: &ir::Scene, files: &dyn Files) {
    pictures.par_iter().for_each(|p| p.decode(ir, files));
}

impl Compiler<'_> {
    /// The texture of a picture, which is gray until [`Self::settle`].
    pub(super) fn bitmap(&mut self, of: ir::Id<ir::Texture>, b: &ir::Bitmap) -> Option<Param> {
        let mapping = self.mapping(&b.mapping, self.ir.textures[of].origin)?;
        let param = self.textures.push(Texture::Bitmap(Bitmap {
            width: 1,
            height: 1,
            texels: Texels::Floats(vec![[0.5; 3]]),
            bilinear: b.filter == ir::TextureFilter::Bilinear,
            wrap: [wrap(b.wrap_u), wrap(b.wrap_v)],
            mapping,
            leaves_unit: leaves_unit(b),
        }));
        if let Param::Texture(texture) = param {
            let picture = Arc::new(Picture { of, state: Mutex::new(State::Wanted) });
            self.textures.waiting.push(Waiting { texture, picture });
        }
        Some(param)
    }

    /// The pictures that textures wait for.
    pub(in super::super) fn wanted_pictures(&self) -> Vec<Arc<Picture>> {
        self.textures.waiting.iter().map(|w| w.picture.clone()).collect()
    }

    /// Gives every texture its picture.
    pub(in super::super) fn settle(&mut self) {
        for Waiting { texture, picture } in mem::take(&mut self.textures.waiting) {
            match picture.take(self.ir, self.files) {
                Some(Ok(decoded)) => {
                    if let Some(Texture::Bitmap(bitmap)) = self.textures.at(texture) {
                        (bitmap.width, bitmap.height) = (decoded.width, decoded.height);
                        bitmap.texels = decoded.texels;
                    }
                }
                Some(Err(problem)) => self.error(problem, self.ir.textures[picture.of].origin),
                None => {}
            }
        }
    }

    /// The textures so far, with the picture of `param` when it shows one.
    pub(in super::super) fn textures_of(&mut self, param: Param) -> &Textures {
        if matches!(param, Param::Texture(_)) {
            self.settle();
        }
        self.textures.so_far()
    }
}

/// Told before the picture is decoded, by its name as pbrt does: only some formats hold numbers beyond 1.
fn leaves_unit(b: &ir::Bitmap) -> bool {
    let format = b.path.extension().unwrap_or_default();
    let floats = ["exr", "hdr", "pfm"].into_iter().any(|of_floats| format.eq_ignore_ascii_case(of_floats));
    floats || !(0.0..=1.0).contains(&b.scale)
}

fn decode(b: &ir::Bitmap, files: &dyn Files) -> Result<Decoded, String> {
    let picture = files
        .read(&b.path)
        .map_err(|e| e.to_string())
        .and_then(|bytes| image::read_samples(&bytes).map_err(|e| e.to_string()))
        .map_err(|e| format!("cannot read texture `{}`: {e}", b.path.display()))?;
    let channels = channels(&picture.channels, b.channel).ok_or_else(|| {
        let known = picture.channels.join(", ");
        format!("texture `{}` has channels {known}, none of them usable", b.path.display())
    })?;
    let decode = decoder(b.encoding, picture.encoding);
    let scale = b.scale as f32;
    // pbrt scales before it inverts.
    let value = |x: f32| {
        let scaled = decode(x) * scale;
        if b.invert { (1.0 - scaled).max(0.0) } else { scaled }
    };
    let stride = picture.channels.len();
    let texels = match picture.data {
        Samples::Bytes(data) => {
            let table = std::array::from_fn(|i| value(i as f32 / 255.0));
            Texels::Bytes(Box::new(Bytes { data, stride, channels, table }))
        }
        Samples::Floats(values) => {
            Texels::Floats(values.par_chunks_exact(stride).map(|p| channels.map(|c| value(p[c]))).collect())
        }
    };
    Ok(Decoded { width: picture.width, height: picture.height, texels })
}

/// Indices of the channels to use as RGB. Alpha is dropped without un-premultiplying, as Mitsuba does.
pub fn channels(names: &[String], one: Option<char>) -> Option<[usize; 3]> {
    let find = |wanted: &str| names.iter().position(|n| n.eq_ignore_ascii_case(wanted));
    if let Some(c) = one {
        return find(&c.to_string()).map(|i| [i; 3]);
    }
    match (find("R"), find("G"), find("B")) {
        (Some(r), Some(g), Some(b)) => Some([r, g, b]),
        _ => find("Y").or((names.len() == 1).then_some(0)).map(|i| [i; 3]),
    }
}

pub fn decoder(wanted: ir::TextureEncoding, stored: Encoding) -> impl Fn(f32) -> f32 {
    let srgb = SrgbTable::new();
    move |x| match (wanted, stored) {
        (ir::TextureEncoding::Auto, Encoding::Srgb) | (ir::TextureEncoding::Srgb, _) => srgb.decode(x),
        (ir::TextureEncoding::Auto, Encoding::Linear) | (ir::TextureEncoding::Linear, _) => x,
        (ir::TextureEncoding::Gamma(g), _) => x.max(0.0).powf(g as f32),
    }
}

fn wrap(mode: ir::WrapMode) -> Wrap {
    match mode {
        ir::WrapMode::Repeat => Wrap::Repeat,
        ir::WrapMode::Mirror => Wrap::Mirror,
        ir::WrapMode::Clamp => Wrap::Clamp,
        ir::WrapMode::Zero => Wrap::Zero,
        ir::WrapMode::One => Wrap::One,
    }
}
