//! The graphics state: transforms, material, light, colour space.

use std::collections::HashMap;
use std::rc::Rc;

use super::directive::Param;
use super::params::Params;
use super::space::ColorSpace;
use crate::diagnostic::Span;
use crate::ir::{Bsdf, ColorInput, FloatInput, Id, Medium, Transform};

/// The two transforms of a moving scene.
pub(super) type Ctm = [Transform; 2];

/// Saved and restored by AttributeBegin and AttributeEnd.
#[derive(Clone, Debug)]
pub(super) struct Graphics {
    pub ctm: Ctm,
    /// Their inverses, made of the inverses of the directives: a camera stands exactly where LookAt says.
    /// `None`: one of them flattens space.
    pub inverse: [Option<Transform>; 2],
    /// Which of the two transforms change.
    pub active: [bool; 2],
    pub reverse: bool,
    /// `None`: diffuse gray, pbrt's default.
    pub material: Option<Id<Bsdf>>,
    /// What it was made of, in pbrt-v3: a shape may change that.
    pub material_params: Option<Rc<Params>>,
    pub area_light: Option<Rc<Params>>,
    pub space: ColorSpace,
    /// The media inside and outside of shapes; the second is around lights and the camera.
    pub media: [Option<Id<Medium>>; 2],
    /// Parameters given by `Attribute`, by target.
    pub attributes: HashMap<&'static str, Rc<Vec<Param>>>,
}

impl Default for Graphics {
    fn default() -> Self {
        Self {
            ctm: [Transform::IDENTITY; 2],
            inverse: [Some(Transform::IDENTITY); 2],
            active: [true; 2],
            reverse: false,
            material: None,
            material_params: None,
            area_light: None,
            space: ColorSpace::Srgb,
            media: [None; 2],
            attributes: HashMap::new(),
        }
    }
}

impl Graphics {
    /// CTM = CTM · M for the active transforms.
    pub fn concat(&mut self, m: &Transform, inverse: Option<Transform>) {
        for i in self.active_indices() {
            self.ctm[i] = self.ctm[i].after(m);
            self.inverse[i] = inverse.zip(self.inverse[i]).map(|(new, old)| new.after(&old));
        }
    }

    pub fn set(&mut self, ctm: &Ctm) {
        for i in self.active_indices() {
            self.ctm[i] = ctm[i];
            self.inverse[i] = ctm[i].inverse();
        }
    }

    fn active_indices(&self) -> impl Iterator<Item = usize> + use<> {
        let active = self.active;
        (0..2).filter(move |i| active[*i])
    }

    pub fn moves(&self) -> bool {
        self.ctm[0] != self.ctm[1]
    }
}

/// Something named that may be used before it is defined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named<T> {
    pub id: Id<T>,
    pub defined: Option<Span>,
    pub used: Option<Span>,
}

/// What names stand for.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    pub float_textures: HashMap<String, (FloatInput, Span)>,
    pub color_textures: HashMap<String, (ColorInput, Span)>,
    pub materials: HashMap<String, Named<Bsdf>>,
    /// What they were made of, in pbrt-v3.
    pub material_params: HashMap<String, Rc<Params>>,
}

/// What opened a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    Attribute,
    /// Of pbrt-v3: the transforms only.
    Transform,
    Object,
}

/// A saved state.
#[derive(Clone, Debug)]
pub(super) struct Saved {
    pub scope: Scope,
    pub graphics: Graphics,
    /// Of pbrt-v3, where names end with their scope.
    pub names: Option<Rc<Names>>,
    pub span: Span,
}
