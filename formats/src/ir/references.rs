//! Who refers to whom: the one place that knows every id in a scene.

use super::{
    Arena, Bsdf, BsdfKind, Coat, ColorInput, Conductor, ConductorMaterial, Dielectric, EmitterKind,
    FloatInput, Id, Microfacet, MixAmount, Plastic, Scene, Shape, ShapeGroup, ShapeKind, Texture,
    TextureKind,
};

/// Is shown every reference of an object, and may change it.
pub trait References {
    fn bsdf(&mut self, id: &mut Id<Bsdf>);
    fn texture(&mut self, id: &mut Id<Texture>);
    fn group(&mut self, id: &mut Id<ShapeGroup>);
}

impl ColorInput {
    fn references(&mut self, to: &mut dyn References) {
        if let Self::Texture(id) = self {
            to.texture(id);
        }
    }
}

impl FloatInput {
    fn references(&mut self, to: &mut dyn References) {
        if let Self::Texture(id) = self {
            to.texture(id);
        }
    }
}

fn colors<const N: usize>(inputs: [&mut ColorInput; N], to: &mut dyn References) {
    inputs.into_iter().for_each(|input| input.references(to));
}

fn floats<const N: usize>(inputs: [&mut FloatInput; N], to: &mut dyn References) {
    inputs.into_iter().for_each(|input| input.references(to));
}

impl Microfacet {
    fn references(&mut self, to: &mut dyn References) {
        floats([&mut self.alpha_u, &mut self.alpha_v], to);
    }
}

impl Dielectric {
    fn references(&mut self, to: &mut dyn References) {
        colors([&mut self.specular_reflectance, &mut self.specular_transmittance], to);
    }
}

impl Plastic {
    fn references(&mut self, to: &mut dyn References) {
        colors([&mut self.diffuse_reflectance, &mut self.specular_reflectance], to);
    }
}

impl Conductor {
    fn references(&mut self, to: &mut dyn References) {
        self.specular_reflectance.references(to);
        match &mut self.material {
            ConductorMaterial::Mirror | ConductorMaterial::Named { .. } => {}
            ConductorMaterial::EtaK { eta, k, .. } => colors([eta, k], to),
            ConductorMaterial::Reflectance(reflectance) => reflectance.references(to),
        }
    }
}

impl Coat {
    fn references(&mut self, to: &mut dyn References) {
        self.microfacet.references(to);
        floats([&mut self.thickness, &mut self.g], to);
        self.albedo.references(to);
    }
}

impl BsdfKind {
    /// Shows `to` every reference of the model itself, in a fixed order.
    pub fn references(&mut self, to: &mut dyn References) {
        match self {
            Self::Null => {}
            Self::Diffuse { reflectance } => reflectance.references(to),
            Self::Dielectric(d) | Self::ThinDielectric(d) => d.references(to),
            Self::RoughDielectric { interface, microfacet } => {
                interface.references(to);
                microfacet.references(to);
            }
            Self::Conductor(conductor) => conductor.references(to),
            Self::RoughConductor { conductor, microfacet } => {
                conductor.references(to);
                microfacet.references(to);
            }
            Self::Plastic(plastic) => plastic.references(to),
            Self::RoughPlastic { plastic, microfacet } => {
                plastic.references(to);
                microfacet.references(to);
            }
            Self::TwoSided { front, back } => {
                to.bsdf(front);
                back.iter_mut().for_each(|back| to.bsdf(back));
            }
            Self::Mask { opacity, nested } => {
                opacity.references(to);
                to.bsdf(nested);
            }
            Self::BumpMap { height, nested, .. } => {
                height.references(to);
                to.bsdf(nested);
            }
            Self::NormalMap { normals, nested, .. } => {
                normals.references(to);
                to.bsdf(nested);
            }
            Self::Blend { weight, first, second } => {
                weight.references(to);
                to.bsdf(first);
                to.bsdf(second);
            }
            Self::Mixture { parts } => parts.iter_mut().for_each(|(_, part)| to.bsdf(part)),
            Self::Principled(p) => {
                p.base_color.references(to);
                floats(
                    [
                        &mut p.roughness,
                        &mut p.anisotropic,
                        &mut p.metallic,
                        &mut p.spec_trans,
                        &mut p.spec_tint,
                        &mut p.sheen,
                        &mut p.sheen_tint,
                        &mut p.flatness,
                        &mut p.clearcoat,
                        &mut p.clearcoat_gloss,
                    ],
                    to,
                );
            }
            Self::PrincipledThin(p) => {
                p.base_color.references(to);
                floats(
                    [
                        &mut p.roughness,
                        &mut p.anisotropic,
                        &mut p.spec_trans,
                        &mut p.eta,
                        &mut p.spec_tint,
                        &mut p.sheen,
                        &mut p.sheen_tint,
                        &mut p.flatness,
                        &mut p.diff_trans,
                    ],
                    to,
                );
            }
            Self::RoughDiffuse { reflectance, alpha, .. } => {
                reflectance.references(to);
                alpha.references(to);
            }
            Self::Phong { exponent, diffuse_reflectance, specular_reflectance } => {
                exponent.references(to);
                colors([diffuse_reflectance, specular_reflectance], to);
            }
            Self::Ward { alpha_u, alpha_v, diffuse_reflectance, specular_reflectance, .. } => {
                floats([alpha_u, alpha_v], to);
                colors([diffuse_reflectance, specular_reflectance], to);
            }
            Self::Coating { sigma_a, specular_reflectance, microfacet, nested, .. } => {
                colors([sigma_a, specular_reflectance], to);
                microfacet.iter_mut().for_each(|m| m.references(to));
                to.bsdf(nested);
            }
            Self::DiffuseTransmission { reflectance, transmittance } => {
                colors([reflectance, transmittance], to);
            }
            Self::CoatedDiffuse { reflectance, coat } => {
                reflectance.references(to);
                coat.references(to);
            }
            Self::CoatedConductor { conductor, microfacet, coat } => {
                conductor.references(to);
                microfacet.references(to);
                coat.references(to);
            }
        }
    }
}

impl TextureKind {
    pub fn references(&mut self, to: &mut dyn References) {
        match self {
            Self::Bitmap(_) | Self::MeshAttribute { .. } | Self::Bilerp { .. } | Self::Noise { .. } => {}
            Self::Checkerboard { color0, color1, .. }
            | Self::Grid { color0, color1, .. }
            | Self::MappedCheckerboard { color0, color1, .. } => colors([color0, color1], to),
            Self::Scale { value, factor } => colors([value, factor], to),
            Self::Dots { inside, outside, .. } => colors([inside, outside], to),
            Self::Mix { first, second, amount } => {
                colors([first, second], to);
                if let MixAmount::Input(amount) = amount {
                    amount.references(to);
                }
            }
        }
    }
}

impl Shape {
    pub fn references(&mut self, to: &mut dyn References) {
        if let ShapeKind::Instance { group } = &mut self.kind {
            to.group(group);
        }
        self.bsdf.iter_mut().for_each(|bsdf| to.bsdf(bsdf));
        self.alpha.iter_mut().for_each(|alpha| alpha.references(to));
        self.emission.iter_mut().for_each(|emission| emission.radiance.references(to));
    }
}

impl EmitterKind {
    pub fn references(&mut self, to: &mut dyn References) {
        match self {
            Self::Spot { texture, .. } => texture.iter_mut().for_each(|texture| to.texture(texture)),
            Self::Projector { irradiance, .. } => irradiance.references(to),
            Self::Point { .. }
            | Self::Directional { .. }
            | Self::Constant { .. }
            | Self::Environment { .. }
            | Self::Projection { .. }
            | Self::Goniometric { .. } => {}
        }
    }
}

/// The scene with its arenas in the order of first use and without what nothing uses: two scenes
/// that mean the same and were written down in another order become equal.
pub fn canonical(scene: &Scene) -> Scene {
    let mut new = Scene { bsdfs: Arena::default(), textures: Arena::default(), ..scene.clone() };
    new.groups = Arena::default();
    let mut moves = Moves {
        old: scene,
        groups: vec![None; scene.groups.len()],
        bsdfs: vec![None; scene.bsdfs.len()],
        textures: vec![None; scene.textures.len()],
        new: &mut new,
    };
    let mut shapes = scene.shapes.clone();
    shapes.iter_mut().for_each(|shape| shape.references(&mut moves));
    let mut emitters = scene.emitters.clone();
    emitters.iter_mut().for_each(|emitter| emitter.kind.references(&mut moves));
    (new.shapes, new.emitters) = (shapes, emitters);
    new
}

struct Moves<'a> {
    old: &'a Scene,
    new: &'a mut Scene,
    groups: Vec<Option<Id<ShapeGroup>>>,
    bsdfs: Vec<Option<Id<Bsdf>>>,
    textures: Vec<Option<Id<Texture>>>,
}

impl References for Moves<'_> {
    fn bsdf(&mut self, id: &mut Id<Bsdf>) {
        *id = self.bsdfs[id.index()].unwrap_or_else(|| {
            let mut moved = self.old.bsdfs[*id].clone();
            // What is nested comes first, as a reader meets it.
            moved.kind.references(self);
            let new = self.new.bsdfs.push(moved);
            self.bsdfs[id.index()] = Some(new);
            new
        });
    }

    fn texture(&mut self, id: &mut Id<Texture>) {
        *id = self.textures[id.index()].unwrap_or_else(|| {
            let mut moved = self.old.textures[*id].clone();
            moved.kind.references(self);
            let new = self.new.textures.push(moved);
            self.textures[id.index()] = Some(new);
            new
        });
    }

    fn group(&mut self, id: &mut Id<ShapeGroup>) {
        *id = self.groups[id.index()].unwrap_or_else(|| {
            let mut moved = self.old.groups[*id].clone();
            moved.shapes.iter_mut().for_each(|shape| shape.references(self));
            let new = self.new.groups.push(moved);
            self.groups[id.index()] = Some(new);
            new
        });
    }
}

/// Whether anything of the shape, its material or its light follows a texture.
pub fn uses_textures(scene: &Scene, shape: &Shape) -> bool {
    let mut finds = FindsTextures { scene, found: false };
    shape.clone().references(&mut finds);
    finds.found
}

struct FindsTextures<'a> {
    scene: &'a Scene,
    found: bool,
}

impl References for FindsTextures<'_> {
    fn bsdf(&mut self, id: &mut Id<Bsdf>) {
        // A material referred to by many is looked through many times; nests are shallow.
        if !self.found {
            self.scene.bsdfs[*id].kind.clone().references(self);
        }
    }
    fn texture(&mut self, _: &mut Id<Texture>) {
        self.found = true;
    }
    fn group(&mut self, _: &mut Id<ShapeGroup>) {}
}

/// How often each object of the arenas is referred to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Uses {
    pub bsdfs: Vec<usize>,
    pub textures: Vec<usize>,
    pub groups: Vec<usize>,
}

impl Uses {
    pub fn of(scene: &Scene) -> Self {
        let mut uses = Self {
            bsdfs: vec![0; scene.bsdfs.len()],
            textures: vec![0; scene.textures.len()],
            groups: vec![0; scene.groups.len()],
        };
        let groups = scene.groups.iter().flat_map(|(_, group)| &group.shapes);
        groups.chain(&scene.shapes).for_each(|shape| shape.clone().references(&mut uses));
        scene.bsdfs.iter().for_each(|(_, bsdf)| bsdf.kind.clone().references(&mut uses));
        scene.textures.iter().for_each(|(_, texture)| texture.kind.clone().references(&mut uses));
        scene.emitters.iter().for_each(|emitter| emitter.kind.clone().references(&mut uses));
        uses
    }
}

impl References for Uses {
    fn bsdf(&mut self, id: &mut Id<Bsdf>) {
        self.bsdfs[id.index()] += 1;
    }
    fn texture(&mut self, id: &mut Id<Texture>) {
        self.textures[id.index()] += 1;
    }
    fn group(&mut self, id: &mut Id<ShapeGroup>) {
        self.groups[id.index()] += 1;
    }
}
