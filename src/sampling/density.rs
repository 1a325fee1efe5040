/// How densely a random choice lies where it fell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Per unit of what is chosen from: of an area (1/m², world units) or of a solid angle (1/sr).
    Finite(f32),
    /// Only this can be chosen: a Dirac delta. It has no number, and the quantity that it goes with (an
    /// intensity instead of a radiance) has its mass integrated already.
    Delta,
}

impl Density {
    /// Its factor in a product of densities: 1 for a delta.
    #[inline(always)]
    pub fn factor(self) -> f32 {
        match self {
            Self::Finite(density) => density,
            Self::Delta => 1.0,
        }
    }
}
