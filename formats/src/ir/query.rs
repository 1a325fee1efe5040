//! What a thing is, with everything it refers to. Answers are remembered by arena index, so that each object is
//! looked at once, however many refer to it.

use super::Scene;
use super::arena::{Arena, Id};
use super::bsdf::{Bsdf, BsdfKind};
use super::color::SpectrumRule;
use super::shape::Shape;
use super::table::Part;
use super::texture::Texture;

/// What is true of a BSDF or of any that is nested in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nature {
    /// Light reaches the other side of the surface.
    pub transmits: bool,
    /// Some light passes straight through: by a mask, or a boundary of one index.
    pub passes: bool,
    /// A texture decides what it looks like.
    pub textured: bool,
    /// What it looks like depends on the direction of ∂p/∂u.
    pub anisotropic: bool,
}

impl Nature {
    /// No light reaches the other side.
    pub fn opaque(self) -> bool {
        !self.transmits
    }

    fn or(self, other: Self) -> Self {
        Self {
            transmits: self.transmits || other.transmits,
            passes: self.passes || other.passes,
            textured: self.textured || other.textured,
            anisotropic: self.anisotropic || other.anisotropic,
        }
    }
}

/// Answers about the BSDFs of one arena. The arena may grow between questions; a BSDF that was asked about, and
/// what is nested in it, must stay as it is.
#[derive(Clone, Debug, Default)]
pub struct Query {
    /// By arena index.
    bsdfs: Vec<State>,
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    #[default]
    Unknown,
    /// Its nested ones are being looked at; meeting it again is a cycle, which adds nothing.
    Open,
    Known(Nature),
}

impl Query {
    /// The nature of a BSDF. Every BSDF is visited once, whatever the number and depth of references.
    pub fn bsdf(&mut self, bsdfs: &Arena<Bsdf>, id: Id<Bsdf>) -> Nature {
        self.bsdfs.resize(bsdfs.len().max(self.bsdfs.len()), State::Unknown);
        // By hand, because nested materials may be deeper than the stack of a thread.
        let mut path = vec![id];
        while let Some(&top) = path.last() {
            match self.bsdfs[top.index()] {
                State::Known(_) => {
                    path.pop();
                }
                State::Unknown => {
                    self.bsdfs[top.index()] = State::Open;
                    bsdfs[top].kind.references(&mut |to| {
                        if let Some(nested) = to.to::<Bsdf>()
                            && matches!(self.bsdfs[nested.index()], State::Unknown)
                        {
                            path.push(nested);
                        }
                    });
                }
                State::Open => {
                    self.bsdfs[top.index()] = State::Known(self.nature(&bsdfs[top]));
                    path.pop();
                }
            }
        }
        match self.bsdfs[id.index()] {
            State::Known(nature) => nature,
            State::Unknown | State::Open => Nature::default(),
        }
    }

    /// Of one BSDF, when all that are nested in it are known.
    fn nature(&self, bsdf: &Bsdf) -> Nature {
        let kind = &bsdf.kind;
        let transmits = kind.transmits();
        let passes = matches!(kind, BsdfKind::Mask { .. } | BsdfKind::Null);
        let mut nature = Nature { transmits, passes, textured: false, anisotropic: kind.anisotropic() };
        kind.references(&mut |to| {
            nature.textured |= to.to::<Texture>().is_some();
            if let Some(nested) = to.to::<Bsdf>()
                && let State::Known(of_nested) = self.bsdfs[nested.index()]
            {
                nature = nature.or(of_nested);
            }
        });
        nature
    }

    /// Whether a texture decides anything about the shape: its material, its opacity or its light.
    pub fn textured(&mut self, bsdfs: &Arena<Bsdf>, shape: &Shape) -> bool {
        let mut textured = false;
        shape.references(&mut |to| textured |= to.to::<Texture>().is_some());
        textured || shape.bsdf.is_some_and(|id| self.bsdf(bsdfs, id).textured)
    }
}

/// Whether anything of the shape, its material or its light follows a texture.
pub fn uses_textures(scene: &Scene, shape: &Shape) -> bool {
    Query::default().textured(&scene.bsdfs, shape)
}

/// Whether light that goes straight through a `thindielectric` counts as not scattered in a scene with media, so that
/// shadow rays go through it. There are such panes, and the scene is not pbrt's, for which they are glass like other.
pub fn panes_pass_in_media(scene: &Scene) -> bool {
    let is_pane = |bsdf: &Bsdf| matches!(bsdf.kind, BsdfKind::ThinDielectric(_));
    scene.spectrum_rule != SpectrumRule::Pbrt && scene.bsdfs.iter().any(|(_, bsdf)| is_pane(bsdf))
}

/// Whether some light passes straight through some surfaces: cut out, masked, or boundaries of one index.
pub fn has_passages(scene: &Scene) -> bool {
    let mut query = Query::default();
    let groups = scene.groups.iter().flat_map(|(_, group)| &group.shapes);
    scene.shapes.iter().chain(groups).any(|shape| {
        let by_bsdf = shape.bsdf.is_some_and(|bsdf| query.bsdf(&scene.bsdfs, bsdf).passes);
        by_bsdf || shape.alpha.is_some()
    })
}

/// Whether such a passage is a segment of a path. It is for Mitsuba's integrators, but for `volpath` and `volpathmis`, and
/// never for pbrt's.
pub fn passages_count(scene: &Scene) -> bool {
    let plugin = scene.integrator.as_ref().map_or("", |integrator| integrator.plugin.as_str());
    scene.spectrum_rule != SpectrumRule::Pbrt && !matches!(plugin, "volpath" | "volpathmis")
}

/// Whether a checkerboard has its colours exchanged where one number is wanted: they are so in Mitsuba 2 and 3.
pub fn exchanges_numbers(scene: &Scene) -> bool {
    matches!(scene.spectrum_rule, SpectrumRule::Mitsuba2 | SpectrumRule::Mitsuba3)
}

/// Whether surfaces reflect at most what they receive, whatever their textures say: for pbrt, they do.
pub fn clamps_reflectance(scene: &Scene) -> bool {
    scene.spectrum_rule == SpectrumRule::Pbrt
}

/// Whether the scene has any light outside of its shape groups.
pub fn emits(scene: &Scene) -> bool {
    !scene.emitters.is_empty()
        || scene.shapes.iter().any(|shape| shape.emission.is_some())
        || scene.media.iter().any(|(_, medium)| medium.emission.is_some())
}
