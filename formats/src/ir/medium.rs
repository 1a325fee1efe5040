//! Participating media, their phase functions, and volumes: what varies in space.

use serde::{Deserialize, Serialize};

use super::Origin;
use super::arena::{Id, Store, Stored};
use super::table::{kinds, record};
use super::volume::Volume;

record! {
    /// What fills a part of space. Coefficients are in 1/length of the world.
    ///
    /// A grid of `coefficients` or of `density` confines the medium to its box: beyond it there is nothing.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Medium {
        /// The author's id, if any.
        pub name: Option<String>,
        /// Where it was written.
        pub origin: Origin,
        /// How much is absorbed and scattered.
        pub coefficients: Coefficients,
        /// Factor on all coefficients (pbrt's `density`); `None` is 1.
        pub density: Option<Volume>,
        /// Another factor on all coefficients, that of σ where there is an albedo.
        pub scale: f64,
        /// Light that it sends out.
        pub emission: Option<MediumEmission>,
        /// Where scattered light goes.
        pub phase: Phase,
        /// Axis of the fibres or flakes by the place (Mitsuba 0.6); zero is none.
        pub orientation: Option<Volume>,
    }
}

impl Medium {
    /// Whether it is the same everywhere.
    pub fn is_homogeneous(&self) -> bool {
        let varies = |volume: &Option<Volume>| volume.as_ref().is_some_and(Volume::varies);
        let [first, second] = self.coefficients.volumes();
        let emission = self.emission.as_ref().is_some_and(MediumEmission::varies);
        !first.varies()
            && !second.varies()
            && !varies(&self.density)
            && !varies(&self.orientation)
            && !emission
            && !self.phase.varies()
    }
}

impl Stored for Medium {
    const STORE: Store = Store::Media;
}

kinds! {
    /// The two numbers that say how much a medium absorbs and scatters, as the author chose them.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum Coefficients {
        /// Mitsuba's.
        "extinction and albedo" => Extinction {
            /// σt, 1/length.
            sigma_t: Volume,
            /// σs/σt.
            albedo: Volume,
        },
        /// pbrt's, and Mitsuba 0.6's as well.
        "absorption and scattering" => Parts {
            /// σa, 1/length.
            sigma_a: Volume,
            /// σs, 1/length.
            sigma_s: Volume,
        },
    }
}

impl Coefficients {
    /// Both.
    pub fn volumes(&self) -> [&Volume; 2] {
        match self {
            Self::Extinction { sigma_t, albedo } => [sigma_t, albedo],
            Self::Parts { sigma_a, sigma_s } => [sigma_a, sigma_s],
        }
    }
}

kinds! {
    /// Light that a medium sends out: per length it adds σa times this radiance.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum MediumEmission {
        /// pbrt's `Le`.
        "radiance" => Radiance {
            /// W·m⁻²·sr⁻¹.
            radiance: Volume,
            /// Factor on it.
            scale: Volume,
        },
        /// A black body of (`kelvin` − `offset`)·`factor`; none up to 100 K.
        "temperature" => Temperature {
            /// As stored.
            kelvin: Volume,
            /// Taken off first.
            offset: f64,
            /// On the difference.
            factor: f64,
            /// The maximum that its spectrum is scaled to, in units in which a spectrum of 1 has luminance 1. pbrt's
            /// is 1 where that has 106.857, the integral of ȳ.
            peak: f64,
            /// Factor on the radiance.
            scale: Volume,
        },
    }
}

impl MediumEmission {
    fn varies(&self) -> bool {
        let (Self::Radiance { radiance: first, scale } | Self::Temperature { kelvin: first, scale, .. }) =
            self;
        first.varies() || scale.varies()
    }
}

kinds! {
    /// The directions of scattered light. cos θ = 1 is straight on.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum Phase {
        /// All directions alike.
        "isotropic" => Isotropic,
        /// Henyey and Greenstein 1941.
        "Henyey-Greenstein" => HenyeyGreenstein {
            /// Mean cosine, between −1 and 1; above 0 light goes on.
            g: f64,
        },
        /// Particles smaller than the wavelength.
        "Rayleigh" => Rayleigh,
        /// Fibres along the medium's `orientation` (Kajiya and Kay 1989); isotropic with `kd` where there is none.
        "Kajiya-Kay" => KajiyaKay {
            /// Of the specular part, which keeps all light that comes across the fibre at 1.
            ks: f64,
            /// Of the isotropic part.
            kd: f64,
            /// Of the specular part.
            exponent: f64,
        },
        /// Each with its weight; their sum is at most 1, and what is missing is lost.
        "mixture" => Mixture(parts: Vec<(f64, Phase)>),
        /// (1 − weight)·first + weight·second.
        "blend" => Blend {
            /// Share of the second; clamped to 0..1.
            weight: Volume,
            /// The two.
            parts: Box<[Phase; 2]>,
        },
        /// A linearly interpolated table, of any integral, over cos θ from −1 to 1.
        "tabulated" => Tabulated {
            /// At evenly spaced cosines, two or more.
            values: Vec<f64>,
        },
        /// Microflakes by the SGGX distribution (Heitz et al. 2015). σt times their projected area counts.
        "SGGX" => Sggx {
            /// Six channels: Sxx Syy Szz Sxy Sxz Syz.
            matrix: Volume,
        },
        /// Microflakes of rough fibres along the medium's `orientation` (Zhao et al. 2011): the density of flake
        /// normals falls as a Gaussian of the cosine to the fibre. Twice their projected area times σt counts.
        "microflake" => Microflake {
            /// Of that Gaussian.
            stddev: f64,
        },
    }
}

impl Phase {
    /// Whether flakes along the medium's `orientation` scatter any of the light; without one there are none.
    pub fn has_flakes(&self) -> bool {
        match self {
            Self::Microflake { .. } => true,
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.has_flakes()),
            Self::Blend { parts, .. } => parts.iter().any(Self::has_flakes),
            _ => false,
        }
    }

    /// Whether it depends on the place.
    pub fn varies(&self) -> bool {
        match self {
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.varies()),
            Self::Blend { weight, parts } => weight.varies() || parts.iter().any(Self::varies),
            Self::Sggx { matrix } => matrix.varies(),
            _ => false,
        }
    }
}

record! {
    /// The media on both sides of a surface; `None` is vacuum.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub struct MediumInterface {
        /// On the side that the normal points away from.
        pub interior: Option<Id<Medium>>,
        /// On the side of the normal.
        pub exterior: Option<Id<Medium>>,
    }
}

/// A sum, product or quotient of decimal numbers, without the noise that it has in its last digits.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().expect("a number that was written")
}
