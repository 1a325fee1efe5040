//! Textures as functions of uv, so that one that the target has no words for can be written as a picture.

use std::path::Path;
use std::rc::Rc;

use super::image::{Pixels, exr};
use super::mesh::stem;
use super::{Output, WriteError};
use crate::ir::{
    Bitmap, ColorInput, ColorSlot, FloatInput, Id, Mapping, MixAmount, Origin, Query, Shape, ShapeKind,
    Texture, TextureFilter, TextureKind, Transform, WrapMode,
};
use crate::spectrum::luminance;

/// Most parts of a texture that is evaluated: what several share counts each time it is looked up.
const MOST_PARTS: usize = 64;

/// Pixels of a side of a picture that is made.
const SMALLEST: usize = 512;
const LARGEST: usize = 4096;

/// What a texture shows, by uv of the surface (v = 0 is the top row of a picture).
#[derive(Clone)]
pub(crate) enum Sampled {
    Constant([f64; 3]),
    Picture(Rc<Pixels>, Box<Bitmap>, Transform),
    /// Two cells per unit of transformed uv.
    Checkerboard(Box<[Sampled; 2]>, Transform),
    Product(Box<[Sampled; 2]>),
    /// The share of the second is the luminance of the third.
    Mix(Box<[Sampled; 3]>),
    /// Corners in the order 00 01 10 11 of (u, v).
    Bilerp([[f64; 3]; 4], Transform),
    /// Cells, lines, and the width of the lines.
    Grid(Box<[Sampled; 2]>, f64, Transform),
}

impl Sampled {
    pub fn at(&self, uv: [f64; 2]) -> [f64; 3] {
        let moved = |m: &Transform| {
            let [u, v, _] = m.point([uv[0], uv[1], 0.0]);
            [u, v]
        };
        match self {
            Self::Constant(rgb) => *rgb,
            Self::Picture(pixels, b, m) => {
                let wrap = [b.wrap_u, b.wrap_v];
                let rgb = match b.filter {
                    TextureFilter::Bilinear => pixels.bilinear(moved(m), wrap),
                    TextureFilter::Nearest => pixels.nearest_wrapped(moved(m), wrap),
                };
                rgb.map(|value| b.toned(value))
            }
            Self::Checkerboard(cells, m) => {
                let [u, v] = moved(m).map(|t| (2.0 * t).floor());
                cells[usize::from((u + v).rem_euclid(2.0) != 0.0)].at(uv)
            }
            Self::Product(parts) => {
                let (a, b) = (parts[0].at(uv), parts[1].at(uv));
                std::array::from_fn(|i| a[i] * b[i])
            }
            Self::Mix(parts) => {
                let (a, b, t) = (parts[0].at(uv), parts[1].at(uv), luminance(parts[2].at(uv)));
                std::array::from_fn(|i| a[i] * (1.0 - t) + b[i] * t)
            }
            Self::Bilerp(c, m) => {
                let [u, v] = moved(m);
                std::array::from_fn(|i| {
                    (1.0 - u) * ((1.0 - v) * c[0][i] + v * c[1][i]) + u * ((1.0 - v) * c[2][i] + v * c[3][i])
                })
            }
            Self::Grid(parts, width, m) => {
                let near = |t: f64| (t - t.round()).abs() < *width;
                let [u, v] = moved(m);
                parts[usize::from(near(u) || near(v))].at(uv)
            }
        }
    }

    /// Whether it is the same one unit of uv further, in both directions.
    pub fn repeats(&self) -> bool {
        let whole = |m: &Transform, step: f64| {
            let part = |r: usize, c: usize| (m.0[r][c] / step).fract().abs() < 1e-9;
            part(0, 0) && part(0, 1) && part(1, 0) && part(1, 1)
        };
        match self {
            Self::Constant(_) => true,
            Self::Picture(_, b, m) => match (b.wrap_u, b.wrap_v) {
                (WrapMode::Repeat, WrapMode::Repeat) => whole(m, 1.0),
                (WrapMode::Repeat | WrapMode::Mirror, WrapMode::Repeat | WrapMode::Mirror) => whole(m, 2.0),
                _ => false,
            },
            Self::Checkerboard(cells, m) => whole(m, 1.0) && cells.iter().all(Self::repeats),
            Self::Product(parts) => parts.iter().all(Self::repeats),
            Self::Mix(parts) => parts.iter().all(Self::repeats),
            Self::Bilerp(..) => false,
            Self::Grid(parts, _, m) => whole(m, 1.0) && parts.iter().all(Self::repeats),
        }
    }

    /// Width and height that show its finest part.
    fn size(&self) -> [usize; 2] {
        let largest = |parts: &[Self]| {
            parts.iter().map(Self::size).fold([1; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
        };
        match self {
            Self::Constant(_) | Self::Bilerp(..) => [1; 2],
            Self::Picture(pixels, _, m) => {
                let along = |c: usize| {
                    let cells = (m.0[0][c] * pixels.width as f64).abs();
                    cells.max((m.0[1][c] * pixels.height as f64).abs()).ceil() as usize
                };
                [along(0), along(1)]
            }
            Self::Checkerboard(parts, _) | Self::Product(parts) => largest(&parts[..]),
            Self::Grid(parts, ..) => largest(&parts[..]),
            Self::Mix(parts) => largest(&parts[..]),
        }
    }

    /// Its picture for uv from 0 to 1, with v = 0 in the first row or in the last one.
    pub fn square(&self, upright: bool) -> Pixels {
        let [width, height] = self.size().map(fine);
        let mut rgb = Vec::with_capacity(width * height);
        for y in 0..height {
            let v = (y as f64 + 0.5) / height as f64;
            for x in 0..width {
                let u = (x as f64 + 0.5) / width as f64;
                rgb.push(self.at([u, if upright { v } else { 1.0 - v }]));
            }
        }
        Pixels { width, height, rgb }
    }

    /// Its mean for uv from 0 to 1.
    pub fn mean(&self) -> [f64; 3] {
        let pixels = self.square(true).rgb;
        let sum = pixels.iter().fold([0.0; 3], |sum, p| std::array::from_fn(|i| sum[i] + p[i]));
        sum.map(|v| v / pixels.len().max(1) as f64)
    }
}

/// An odd multiple of `n`, so that the middles of the old pixels are middles of new ones.
fn fine(n: usize) -> usize {
    let n = n.clamp(1, LARGEST);
    let times = SMALLEST.div_ceil(n);
    n * (times | 1)
}

impl Bitmap {
    /// The value that a decoded one stands for.
    fn toned(&self, value: f64) -> f64 {
        let scaled = value * self.scale;
        if self.invert { (1.0 - scaled).max(0.0) } else { scaled }
    }
}

impl Output<'_> {
    /// The texture by uv; `None` when it depends on anything else, or has too many parts.
    pub fn sampled(&mut self, id: Id<Texture>) -> Result<Option<Sampled>, WriteError> {
        self.sampled_within(id, &mut { MOST_PARTS })
    }

    fn sampled_within(&mut self, id: Id<Texture>, left: &mut usize) -> Result<Option<Sampled>, WriteError> {
        if *left == 0 {
            return Ok(None);
        }
        *left -= 1;
        let scene = self.scene;
        let Texture { origin, kind, .. } = &scene.textures[id];
        let by_uv = |mapping: &Mapping| match mapping {
            Mapping::Uv(m) => Some(*m),
            _ => None,
        };
        Ok(match kind {
            TextureKind::Bitmap(b) => match by_uv(&b.mapping) {
                Some(m) => {
                    let pixels = Rc::new(self.pixels(&b.path, b.encoding, b.channel)?);
                    Some(Sampled::Picture(pixels, Box::new(b.clone()), m))
                }
                None => None,
            },
            TextureKind::Checkerboard { color0, color1, to_uv } => {
                self.pair([color0, color1], *origin, left)?.map(|cells| Sampled::Checkerboard(cells, *to_uv))
            }
            TextureKind::MappedCheckerboard { color0, color1, mapping } => match by_uv(mapping) {
                // One cell per unit.
                Some(m) => self
                    .pair([color0, color1], *origin, left)?
                    .map(|cells| Sampled::Checkerboard(cells, Transform::scale([0.5, 0.5, 1.0]).after(&m))),
                None => None,
            },
            TextureKind::Scale { value, factor } => {
                self.pair([value, factor], *origin, left)?.map(Sampled::Product)
            }
            TextureKind::Mix { first, second, amount: MixAmount::Input(amount) } => {
                let amount = match amount {
                    FloatInput::Value(v) => Some(Sampled::Constant([*v; 3])),
                    FloatInput::Texture(id) => self.sampled_within(*id, left)?,
                };
                match (self.pair([first, second], *origin, left)?, amount) {
                    (Some(pair), Some(amount)) => {
                        let [first, second] = *pair;
                        Some(Sampled::Mix(Box::new([first, second, amount])))
                    }
                    _ => None,
                }
            }
            TextureKind::Bilerp { corners, mapping } => by_uv(mapping).map(|m| {
                let corners = std::array::from_fn(|i| self.rgb(&corners[i], ColorSlot::Unbounded, *origin));
                Sampled::Bilerp(corners, m)
            }),
            TextureKind::Grid { color0, color1, line_width, to_uv } => self
                .pair([color0, color1], *origin, left)?
                .map(|parts| Sampled::Grid(parts, *line_width, *to_uv)),
            TextureKind::Mix { amount: MixAmount::Direction(_), .. }
            | TextureKind::MeshAttribute { .. }
            | TextureKind::Dots { .. }
            | TextureKind::Noise { .. } => None,
        })
    }

    fn pair(
        &mut self,
        inputs: [&ColorInput; 2],
        origin: Origin,
        left: &mut usize,
    ) -> Result<Option<Box<[Sampled; 2]>>, WriteError> {
        let mut found = Vec::new();
        for input in inputs {
            found.extend(match input {
                ColorInput::Color(color) => {
                    Some(Sampled::Constant(self.rgb(color, ColorSlot::Unbounded, origin)))
                }
                ColorInput::Texture(id) => self.sampled_within(*id, left)?,
            });
        }
        Ok(<[Sampled; 2]>::try_from(found).ok().map(Box::new))
    }

    /// The name of a file made of a texture.
    pub(super) fn texture_stem(&self, id: Id<Texture>, of: &str) -> String {
        match &self.scene.textures[id].kind {
            TextureKind::Bitmap(b) => format!("{}-{of}", stem(&b.path)),
            _ => format!("texture-{of}"),
        }
    }

    /// A picture of one pixel.
    pub fn make_plain(&mut self, rgb: [f64; 3]) -> Result<String, WriteError> {
        let pixels = Pixels { width: 1, height: 1, rgb: vec![rgb] };
        self.make(&format!("plain {rgb:?}"), "textures", "plain", "exr", |_| exr(Path::new("plain"), &pixels))
    }

    /// Width and height of the picture of a texture; of a square where it is none.
    pub fn picture_size(&self, id: Id<Texture>) -> Result<[usize; 2], WriteError> {
        match &self.scene.textures[id].kind {
            TextureKind::Bitmap(b) => self.image(&b.path).map(|image| [image.width, image.height]),
            _ => Ok([1; 2]),
        }
    }

    /// A float picture of a texture for uv from 0 to 1, with v = 0 in the first row or in the last one.
    pub fn make_square(
        &mut self,
        id: Id<Texture>,
        sampled: &Sampled,
        factor: [f64; 3],
        upright: bool,
    ) -> Result<String, WriteError> {
        let stem = self.texture_stem(id, "baked");
        let key = format!("square {} {factor:?} {upright}", id.index());
        self.make(&key, "textures", &stem, "exr", |_| {
            let mut pixels = sampled.square(upright);
            for rgb in &mut pixels.rgb {
                *rgb = std::array::from_fn(|i| rgb[i] * factor[i]);
            }
            exr(Path::new(&stem), &pixels)
        })
    }

    /// A float picture of the light of a lamp that the texture `id` dims.
    pub fn make_light(
        &mut self,
        id: Id<Texture>,
        light: &Sampled,
        factor: [f64; 3],
    ) -> Result<String, WriteError> {
        let stem = self.texture_stem(id, "light");
        let light = Sampled::Product(Box::new([light.clone(), Sampled::Constant(factor)]));
        // Each lamp has a picture of its own.
        let key = format!("light {} {}", id.index(), self.assets_so_far());
        self.make(&key, "textures", &stem, "exr", |_| exr(Path::new(&stem), &light.square(true)))
    }

    /// Whether any shape that shows textures has uv outside of 0 to 1.
    pub fn any_leaves_the_square(&mut self) -> Result<bool, WriteError> {
        if let Some(known) = self.beyond {
            return Ok(known);
        }
        let scene = self.scene;
        let mut query = Query::default();
        let mut found = false;
        let grouped = scene.groups.iter().flat_map(|(_, group)| &group.shapes);
        for shape in scene.shapes.iter().chain(grouped) {
            found = found || query.textured(&scene.bsdfs, shape) && self.leaves_the_square(shape)?;
        }
        self.beyond = Some(found);
        Ok(found)
    }

    pub fn leaves_the_square(&self, shape: &Shape) -> Result<bool, WriteError> {
        let outside = |uvs: &[[f32; 2]]| uvs.as_flattened().iter().any(|t| !(-1e-3..=1.001).contains(t));
        Ok(match &shape.kind {
            ShapeKind::Mesh(file) => outside(&self.mesh(file)?.uvs),
            ShapeKind::Inline(mesh) => outside(&mesh.uvs),
            _ => false,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(filter: TextureFilter, wrap: WrapMode, m: Transform) -> Sampled {
        let rgb = [0.0, 1.0, 2.0, 3.0].map(|v| [v; 3]).to_vec();
        let bitmap = Bitmap { filter, wrap_u: wrap, wrap_v: wrap, ..Bitmap::raw("x".into(), Mapping::Uv(m)) };
        Sampled::Picture(Rc::new(Pixels { width: 2, height: 2, rgb }), Box::new(bitmap), m)
    }

    #[test]
    fn nearest_lookups_follow_the_wrapping() {
        let at = |wrap, uv| picture(TextureFilter::Nearest, wrap, Transform::IDENTITY).at(uv)[0];
        assert_eq!(at(WrapMode::Repeat, [0.2, 0.2]), 0.0);
        assert_eq!(at(WrapMode::Repeat, [-0.2, 0.2]), 1.0);
        assert_eq!(at(WrapMode::Mirror, [-0.2, 0.2]), 0.0);
        assert_eq!(at(WrapMode::Mirror, [2.2, 1.2]), 2.0);
        assert_eq!(at(WrapMode::Clamp, [7.0, 7.0]), 3.0);
        assert_eq!(at(WrapMode::Zero, [7.0, 0.2]), 0.0);
        assert_eq!(at(WrapMode::One, [0.7, -3.2]), 1.0);
    }

    /// Two periods across: the picture of the square has both, and the old middles are new ones.
    #[test]
    fn the_square_shows_every_period() {
        let twice = picture(TextureFilter::Bilinear, WrapMode::Repeat, Transform::scale([2.0, 1.0, 1.0]));
        let square = twice.square(true);
        assert_eq!((square.width % 4, (square.width / 4) % 2), (0, 1));
        let middle = |i: usize| square.rgb[(square.height / 4) * square.width + square.width * i / 8][0];
        assert!((middle(1) - 0.0).abs() < 1e-9 && (middle(3) - 1.0).abs() < 1e-9);
        assert!((middle(5) - 0.0).abs() < 1e-9 && (middle(7) - 1.0).abs() < 1e-9);
        assert!(twice.repeats());
        assert!(!picture(TextureFilter::Bilinear, WrapMode::Clamp, Transform::IDENTITY).repeats());
        assert!((twice.mean()[0] - 1.5).abs() < 1e-9);
    }
}
