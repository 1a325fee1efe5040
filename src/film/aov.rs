//! Pictures of the surfaces that camera rays meet first, for denoisers and compositors: their depth, normals,
//! reflectance and the like (arbitrary output variables, AOVs).

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// What such a picture shows. Unless said otherwise, lengths and directions are those of the author's world, and
/// where a ray meets nothing every number is 0, as in Mitsuba.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Aov {
    /// Diffuse reflectance, as Mitsuba's BSDFs tell it.
    Albedo,
    /// Length of the camera ray from the near plane on.
    Depth,
    /// Where the surface is.
    Position,
    /// Texture coordinates.
    Uv,
    /// Of the shape itself.
    GeoNormal,
    /// Interpolated between the corners of a mesh, and bent by a bump or normal map.
    ShNormal,
    /// ∂p/∂u.
    DpDu,
    /// ∂p/∂v.
    DpDv,
    /// Change of the texture coordinates from a pixel to the next to the right, divided by the square root of the
    /// number of samples.
    DuvDx,
    /// The same for the next pixel below.
    DuvDy,
    /// Number of the triangle in its mesh, from 0.
    PrimIndex,
    /// Number of the shape in its scene, from 1; an instance counts as one shape.
    ShapeIndex,
    /// Length of the camera ray from the pinhole on.
    Distance,
    /// Where the surface is in the coordinates of the camera.
    RelPosition,
    /// Number of the shape in its scene, from 0.
    ShapeNumber,
    /// All that pbrt's film of that name holds beside the picture, under its channel names.
    GBuffer {
        /// In the coordinates of the world, not in those of the camera.
        world: bool,
    },
}

/// What may be asked for by name, with the name; the channels of its layer in the file.
pub const AOVS: [(Aov, &str, &[&str]); 12] = [
    (Aov::Albedo, "albedo", COLOR),
    (Aov::Depth, "depth", &["Z"]),
    (Aov::Position, "position", VECTOR),
    (Aov::Uv, "uv", PAIR),
    (Aov::GeoNormal, "geo_normal", VECTOR),
    (Aov::ShNormal, "sh_normal", VECTOR),
    (Aov::DpDu, "dp_du", VECTOR),
    (Aov::DpDv, "dp_dv", VECTOR),
    (Aov::DuvDx, "duv_dx", PAIR),
    (Aov::DuvDy, "duv_dy", PAIR),
    (Aov::PrimIndex, "prim_index", &["I"]),
    (Aov::ShapeIndex, "shape_index", &["I"]),
];

const COLOR: &[&str] = &["R", "G", "B"];
const VECTOR: &[&str] = &["X", "Y", "Z"];
const PAIR: &[&str] = &["U", "V"];

/// Of pbrt's `gbuffer` film.
const GBUFFER: &[&str] = &[
    "Albedo.R",
    "Albedo.G",
    "Albedo.B",
    "P.X",
    "P.Y",
    "P.Z",
    "dzdx",
    "dzdy",
    "N.X",
    "N.Y",
    "N.Z",
    "Ns.X",
    "Ns.Y",
    "Ns.Z",
    "u",
    "v",
    "Variance.R",
    "Variance.G",
    "Variance.B",
    "RelativeVariance.R",
    "RelativeVariance.G",
    "RelativeVariance.B",
];

/// What one camera sample adds to a [`Aov::GBuffer`], in the order of the sums. Where the ray meets nothing all
/// is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Visible {
    /// What the surface scatters of light from the camera.
    pub albedo: [f32; 3],
    /// Position.
    pub p: [f64; 3],
    /// Change of z from a pixel to the next, to the right and downwards.
    pub dz: [f32; 2],
    /// Geometric normal, on the camera's side.
    pub n: [f32; 3],
    /// Shading normal, on the camera's side.
    pub ns: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// The sample itself.
    pub rgb: [f32; 3],
}

/// Sums of a [`Visible`]: weight and number of the samples that met a surface, the fields but the last, the sample
/// and its square.
const VISIBLE: usize = 2 + 16 + 6;

impl Visible {
    /// Whether it holds numbers only.
    pub fn is_finite(&self) -> bool {
        let short = [&self.albedo[..], &self.dz, &self.n, &self.ns, &self.uv, &self.rgb];
        self.p.iter().all(|v| v.is_finite()) && short.iter().all(|list| list.iter().all(|v| v.is_finite()))
    }

    /// Adds the sample to a pixel: `weight` is its filter's, `share` that of one sample in a pass.
    pub fn add_to(&self, sums: &mut [f64], weight: f64, share: f64) {
        let geometry = self.albedo.iter().map(|v| f64::from(*v)).chain(self.p);
        let rest = self.dz.iter().chain(&self.n).chain(&self.ns).chain(&self.uv).map(|v| f64::from(*v));
        let light = self.rgb.map(f64::from);
        let weighted = std::iter::once(1.0).chain(geometry).chain(rest).map(|v| v * weight * share);
        let counted = std::iter::once(1.0).chain(light).chain(light.map(|v| v * v)).map(|v| v * share);
        sums.iter_mut().zip(weighted.chain(counted)).for_each(|(sum, v)| *sum += v);
    }

    /// The channels of a pixel from its sums over `passes` of `samples` samples each.
    fn finish(sums: &[f64], passes: f64, samples: f64) -> Vec<f64> {
        let (weight, rest) = (sums[0], &sums[1..]);
        let mean = |v: f64| if weight > 0.0 { v / weight } else { 0.0 };
        let unit = |v: &[f64]| -> Vec<f64> {
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            v.iter().map(|x| if length > 0.0 { x / length } else { 0.0 }).collect()
        };
        let (albedo, rest) = rest.split_at(3);
        let (p, rest) = rest.split_at(3);
        let (dz, rest) = rest.split_at(2);
        let (n, rest) = rest.split_at(3);
        let (ns, rest) = rest.split_at(3);
        let (uv, light) = rest.split_at(2);
        let mut out: Vec<f64> = albedo.iter().map(|v| v / passes).collect();
        out.extend(p.iter().map(|v| mean(*v)));
        out.extend(dz.iter().map(|v| mean(*v).abs()));
        out.extend([unit(n), unit(ns)].concat());
        out.extend(uv.iter().map(|v| mean(*v)));
        // Of the samples, not of their mean.
        let count = light[0] * samples;
        let moments: Vec<[f64; 2]> = (0..3)
            .map(|c| {
                if count < 1.5 {
                    return [0.0; 2];
                }
                let average = light[1 + c] / light[0];
                let spread = (light[4 + c] / light[0] - average * average).max(0.0);
                [average, spread * count / (count - 1.0)]
            })
            .collect();
        out.extend(moments.iter().map(|[_, variance]| *variance));
        out.extend(moments.iter().map(|[average, v]| if *average == 0.0 { 0.0 } else { v / average }));
        out
    }
}

impl Aov {
    /// The channels of its layer: letters for which the layer's name is the prefix, or whole names.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Distance => &["T"],
            Self::RelPosition => VECTOR,
            Self::ShapeNumber => &["I"],
            Self::GBuffer { .. } => GBUFFER,
            named => AOVS.iter().find(|(aov, ..)| *aov == named).map_or(&[], |(_, _, channels)| channels),
        }
    }

    /// Whether it shows the texture coordinates of a surface, or what follows from them.
    pub fn needs_uvs(self) -> bool {
        use Aov::{DpDu, DpDv, DuvDx, DuvDy, GBuffer, PrimIndex, Uv};
        matches!(self, Uv | DpDu | DpDv | DuvDx | DuvDy | PrimIndex | GBuffer { .. })
    }

    /// Numbers that are summed for each pixel.
    pub fn numbers(self) -> usize {
        match self {
            Self::GBuffer { .. } => VISIBLE,
            other => other.channels().len(),
        }
    }

    /// Numbers that are summed for each pixel by all of a list.
    pub fn numbers_of(list: &[Self]) -> usize {
        list.iter().map(|aov| aov.numbers()).sum()
    }

    /// Where its sums are among those of a list.
    pub fn place_in(self, list: &[Self]) -> Option<Range<usize>> {
        let at = list.iter().position(|other| *other == self)?;
        let first = Self::numbers_of(&list[..at]);
        Some(first..first + self.numbers())
    }

    /// The channels of a pixel from its sums over `passes` of `samples` samples each.
    pub fn finish(self, sums: &[f64], passes: u32, samples: u32) -> Vec<f64> {
        let (passes, samples) = (f64::from(passes.max(1)), f64::from(samples.max(1)));
        match self {
            Self::GBuffer { .. } => Visible::finish(sums, passes, samples),
            // The width that a texture is filtered with for one of so many samples.
            Self::DuvDx | Self::DuvDy => {
                let scale = passes * (passes * samples).sqrt();
                sums.iter().map(|v| v / scale).collect()
            }
            _ => sums.iter().map(|v| v / passes).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_places_of_a_list_do_not_overlap() {
        let list = AOVS.map(|(aov, ..)| aov);
        let mut next = 0;
        for aov in list {
            let place = aov.place_in(&list).unwrap();
            assert_eq!(place.start, next);
            next = place.end;
        }
        assert_eq!(next, Aov::numbers_of(&list));
        assert_eq!(Aov::Distance.place_in(&list), None);
    }

    /// Two samples of a surface and one beside it: position and uv are those of the surface, albedo is the
    /// mean over the pixel, and the variance is that of 1 and 3.
    #[test]
    fn a_gbuffer_averages_over_what_is_seen() {
        let mut sums = vec![0.0; VISIBLE];
        for light in [1.0, 3.0] {
            let visible = Visible {
                albedo: [0.6; 3],
                p: [1.0, 2.0, 3.0],
                dz: [-0.5, 0.25],
                n: [0.0, 0.0, 2.0],
                ns: [0.0, 1.0, 0.0],
                uv: [0.25, 0.75],
                rgb: [light; 3],
            };
            visible.add_to(&mut sums, 1.0, 1.0);
        }
        let out = Aov::GBuffer { world: true }.finish(&sums, 3, 1);
        let expected = [
            &[0.4; 3][..],
            &[1.0, 2.0, 3.0, 0.5, 0.25, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.25, 0.75],
            &[2.0, 2.0, 2.0, 1.0, 1.0, 1.0],
        ]
        .concat();
        assert_eq!(out.len(), GBUFFER.len());
        for (a, b) in out.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-6, "{out:?}");
        }
        assert!(Aov::GBuffer { world: true }.finish(&[0.0; VISIBLE], 3, 1).iter().all(|v| *v == 0.0));
    }
}
