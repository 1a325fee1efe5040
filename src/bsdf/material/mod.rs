//! What a surface is made of: nests of models, and what they are at a point.

mod closure;
mod composite;
mod shown;
mod tilt;

pub use closure::Closure;
use closure::{Content, Lambertian};
use composite::Component;
pub(super) use composite::Composite;
use tilt::Tilt;
pub use tilt::{Perturbation, Relief};

use super::{Model, Nature, Point, Range};
use crate::math::{Vec2, Vec3};
use crate::texture::{Param, Textures};

/// Models and what wraps them.
#[derive(Clone, Debug)]
pub enum Node {
    /// A model by itself.
    Model(Box<Model>),
    /// Index-matched boundary: light passes straight through.
    Null,
    /// The second serves directions below the surface, mirrored.
    TwoSided(Box<[Node; 2]>),
    /// The rest goes straight through.
    Mask(Param, Box<Node>),
    /// (1 − weight)·first + weight·second.
    Blend(Param, Box<[Node; 2]>),
    /// Weights of sum 1 at most.
    Mixture(Vec<(f32, Node)>),
    /// A bump or normal map over what it tilts.
    Tilted(Perturbation, Box<Node>),
}

impl<M: Into<Model>> From<M> for Node {
    fn from(model: M) -> Self {
        Self::Model(Box::new(model.into()))
    }
}

/// Where in the nest a model stands.
#[derive(Clone, Copy)]
struct Place {
    weight: f32,
    mirrored: bool,
    tilt: Option<Tilt>,
    mirrored_inside: bool,
}

impl Node {
    /// Adds the models that light along `wi` (as this node sees it) meets.
    fn flatten(&self, point: &Point<'_>, wi: Vec3, place: Place, out: &mut Composite) {
        match self {
            Self::Null => out.through += place.weight,
            Self::Model(m) => {
                let Place { weight, mirrored, tilt, mirrored_inside } = place;
                if weight > 0.0 {
                    out.components.push(Component {
                        weight,
                        mirrored,
                        tilt,
                        mirrored_inside,
                        bxdf: m.at(point),
                    });
                }
            }
            Self::TwoSided(sides) => {
                if wi.z >= 0.0 {
                    return sides[0].flatten(point, wi, place, out);
                }
                let mut place = place;
                match place.tilt {
                    None => place.mirrored = !place.mirrored,
                    Some(_) => place.mirrored_inside = !place.mirrored_inside,
                }
                sides[1].flatten(point, Vec3::new(wi.x, wi.y, -wi.z), place, out);
            }
            Self::Mask(opacity, nested) => {
                let opacity = point.scalar(*opacity).clamp(0.0, 1.0);
                out.through += place.weight * (1.0 - opacity);
                nested.flatten(point, wi, Place { weight: place.weight * opacity, ..place }, out);
            }
            Self::Blend(weight, nested) => {
                let second = point.scalar(*weight).clamp(0.0, 1.0);
                for (node, share) in nested.iter().zip([1.0 - second, second]) {
                    node.flatten(point, wi, Place { weight: place.weight * share, ..place }, out);
                }
            }
            Self::Mixture(nested) => {
                for (share, node) in nested {
                    node.flatten(point, wi, Place { weight: place.weight * share, ..place }, out);
                }
            }
            Self::Tilted(perturbation, nested) => {
                let tilt = perturbation.at(point);
                nested.flatten(
                    point,
                    tilt.frame(tilt.flipped(wi)).to_local(wi),
                    Place { tilt: Some(tilt), ..place },
                    out,
                );
            }
        }
    }

    /// The lists of models and of wrappers' parameters below.
    fn visit(&self, see: &mut impl FnMut(&Node)) {
        see(self);
        match self {
            Self::Model(_) | Self::Null => {}
            Self::TwoSided(nested) | Self::Blend(_, nested) => nested.iter().for_each(|n| n.visit(see)),
            Self::Mask(_, nested) | Self::Tilted(_, nested) => nested.visit(see),
            Self::Mixture(nested) => nested.iter().for_each(|(_, n)| n.visit(see)),
        }
    }

    /// What is true of it at every point.
    pub fn nature(&self) -> Nature {
        let mut nature = Nature::default();
        self.visit(&mut |node| match node {
            Self::Model(m) => {
                let own = m.nature();
                let diffuses_through = own.transmits && own.smooth.is_some();
                nature = nature.with(Nature { diffuses_through, ..own });
            }
            Self::Null | Self::Mask(..) => nature.transmits = true,
            Self::Tilted(..) => nature.oriented = true,
            Self::TwoSided(_) | Self::Blend(..) | Self::Mixture(_) => {}
        });
        nature
    }

    /// Whether the scattering differs from point to point.
    pub(in crate::bsdf) fn varies(&self) -> bool {
        let mut varies = false;
        self.visit(&mut |node| {
            varies |= match node {
                Self::Model(m) => m.varies(),
                Self::Mask(p, _) | Self::Blend(p, _) => p.constant().is_none(),
                // A constant map tilts by what ∂p/∂u and the viewer say, too.
                Self::Tilted(..) => true,
                Self::Null | Self::TwoSided(_) | Self::Mixture(_) => false,
            }
        });
        varies
    }

    /// Every parameter of the models and wrappers in the nest that may be a texture.
    pub(in crate::bsdf) fn params(&self) -> Vec<Param> {
        let mut params = Vec::new();
        self.visit(&mut |node| match node {
            Self::Model(m) => params.extend(m.params()),
            Self::Mask(p, _) | Self::Blend(p, _) => params.push(*p),
            Self::Tilted(p, _) => params.push(p.relief.param()),
            Self::Null | Self::TwoSided(_) | Self::Mixture(_) => {}
        });
        params
    }

    /// Whether any light passes straight through.
    fn passes(&self) -> bool {
        let mut passes = false;
        self.visit(&mut |node| passes |= matches!(node, Self::Null | Self::Mask(..)));
        passes
    }

    /// Whether a map tilts the frame of another map, which is not modelled.
    pub fn tilts_twice(&self) -> bool {
        let mut twice = false;
        self.visit(&mut |node| {
            if let Self::Tilted(_, nested) = node {
                nested.visit(&mut |inner| twice |= matches!(inner, Self::Tilted(..)));
            }
        });
        twice
    }
}

/// What a surface is made of, on both sides.
#[derive(Debug)]
pub struct Material {
    root: Node,
    nature: Nature,
    passes: bool,
    /// Above and below the surface, for a material that is everywhere the same.
    fixed: Option<[Prepared; 2]>,
    /// A single diffuse lobe whose reflectance is a texture: no list need be made of it.
    diffuse: Option<Textured>,
}

#[derive(Debug)]
enum Prepared {
    /// One diffuse lobe.
    Diffuse(Lambertian),
    /// Anything else.
    Composite(Composite),
}

#[derive(Clone, Copy, Debug)]
struct Textured {
    reflectance: Param,
    two_sided: bool,
}

impl Material {
    /// Looks at the nest once: what is everywhere the same is made here.
    pub fn new(root: impl Into<Node>) -> Self {
        let root = root.into();
        let fixed = (!root.varies()).then(|| {
            let textures = Textures::default();
            let point = Point::flat(&textures, Vec2::ZERO);
            [Vec3::Z, -Vec3::Z].map(|wi| prepared(flat(&root, &point, wi)))
        });
        let of = |node: &Node| match node {
            Node::Model(model) => model.lambertian(),
            _ => None,
        };
        let diffuse = match &root {
            Node::TwoSided(sides) => match (of(&sides[0]), of(&sides[1])) {
                (Some(a), Some(b)) if a == b => Some(Textured { reflectance: a, two_sided: true }),
                _ => None,
            },
            node => of(node).map(|reflectance| Textured { reflectance, two_sided: false }),
        };
        let (nature, passes) = (root.nature(), root.passes());
        Self { root, nature, passes, fixed, diffuse }
    }

    /// The scattering at a point, for light handled along `wi` (local).
    #[inline(always)]
    pub fn closure<'a>(&'a self, point: &Point<'_>, wi: Vec3) -> Closure<'a> {
        match &self.fixed {
            Some(sides) => Closure(Content::Fixed(&sides[usize::from(wi.z < 0.0)])),
            None => self.textured(point, wi),
        }
    }

    #[inline(never)]
    fn textured(&self, point: &Point<'_>, wi: Vec3) -> Closure<'_> {
        if let Some(diffuse) = self.diffuse {
            let side = if diffuse.two_sided && wi.z < 0.0 { -1.0 } else { 1.0 };
            let reflectance = point.color(diffuse.reflectance);
            return Closure(Content::Diffuse(Lambertian { reflectance, opacity: 1.0, side }));
        }
        Closure(Content::Here(Box::new(flat(&self.root, point, wi))))
    }

    /// Every parameter that may be a texture.
    pub fn params(&self) -> Vec<Param> {
        self.root.params()
    }

    /// Whether the scattering differs from point to point.
    pub fn varies(&self) -> bool {
        self.fixed.is_none()
    }

    /// What is true of it at every point.
    pub fn nature(&self) -> Nature {
        self.nature
    }

    /// Whether a texture gives it lobes in `range` in some places only. It takes photons everywhere then: the density
    /// that is estimated in such a place must not end where the others begin.
    pub fn may_have(&self, range: Range) -> bool {
        self.varies() && self.nature.smooth.is_some_and(|bounds| range.begins_below(bounds[1]))
    }

    /// Whether sampling has to choose: anything but an opaque diffuse surface.
    pub fn chooses_lobes(&self) -> bool {
        let plain = |side: &Prepared| matches!(side, Prepared::Diffuse(d) if d.opacity == 1.0);
        self.diffuse.is_none() && !self.fixed.as_ref().is_some_and(|sides| sides.iter().all(plain))
    }

    /// Whether a shadow ray may pass (in part) straight through.
    pub fn passes_shadow_rays(&self) -> bool {
        self.passes
    }
}

/// What a nest is at a point, for light along `wi`.
pub(in crate::bsdf) fn flat(root: &Node, point: &Point<'_>, wi: Vec3) -> Composite {
    let mut composite = Composite::default();
    let place = Place { weight: 1.0, mirrored: false, tilt: None, mirrored_inside: false };
    root.flatten(point, wi, place, &mut composite);
    composite
}

fn prepared(composite: Composite) -> Prepared {
    if let [Component { weight, mirrored, bxdf, .. }] = &composite.components[..]
        && composite.through + weight == 1.0
        && let Some(reflectance) = bxdf.lambertian()
    {
        let side = if *mirrored { -1.0 } else { 1.0 };
        return Prepared::Diffuse(Lambertian { reflectance, opacity: *weight, side });
    }
    Prepared::Composite(composite)
}
