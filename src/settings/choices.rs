//! Settings that are one of a few words.

use std::fmt;
use std::str::FromStr;

macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($variant:ident = $text:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = concat!("Written `", $text, "`.")] $variant),+
        }

        impl $name {
            /// The words that stand for the choices, in their order.
            pub const NAMES: &'static [&'static str] = &[$($text),+];
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$variant => $text),+ })
            }
        }

        impl FromStr for $name {
            type Err = String;
            fn from_str(s: &str) -> Result<Self, String> {
                match s { $($text => Ok(Self::$variant),)+ _ => Err(format!("one of {}", Self::NAMES.join(", "))) }
            }
        }
    };
}

choice! {
    /// What computes the picture.
    IntegratorKind { PhotonMap = "photonmap", Path = "path" }
}
choice! {
    /// One photon map for all camera samples, or a new one with a smaller radius every pass.
    Mode { Progressive = "progressive", Classic = "classic" }
}
choice! {
    /// How light that was scattered more than once reaches the first rough surface.
    Indirect { Auto = "auto", Density = "density", Gather = "gather", Trace = "trace" }
}
choice! {
    /// Density from all photons within the radius, or from the k nearest within it.
    Lookup { Radius = "radius", Nearest = "nearest" }
}
choice! {
    /// What light leaves in media.
    InMedia { Auto = "auto", Points = "points", Beams = "beams" }
}
choice! {
    /// What a camera path does with the share of light that a surface absorbs.
    Roulette { Absorb = "absorb", Retry = "retry", Renormalise = "renormalise" }
}
