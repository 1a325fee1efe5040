//! Surface scattering models.

mod basic;
mod old;
mod principled;
mod wrappers;

use super::object::{Class, ObjectIndex};
use super::props::Props;
use super::reader::Reader;
use crate::ir::{Bsdf, BsdfKind, Color, ColorInput, ColorSlot, Id};
use crate::plugin::{Plugin, approximated, read, unsupported};

type ReadBsdf = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<BsdfKind>;

const AS_PRINCIPLED: &str = "as `principled`";

pub(super) const BSDFS: &[Plugin<ReadBsdf>] = &[
    read("diffuse", basic::diffuse),
    read("dielectric", |r, p| Some(BsdfKind::Dielectric(basic::dielectric(r, p)))),
    read("thindielectric", |r, p| Some(BsdfKind::ThinDielectric(basic::dielectric(r, p)))),
    read("roughdielectric", basic::rough_dielectric),
    read("conductor", |r, p| Some(BsdfKind::Conductor(basic::conductor(r, p)))),
    read("roughconductor", basic::rough_conductor),
    read("plastic", |r, p| Some(BsdfKind::Plastic(basic::plastic(r, p)))),
    read("roughplastic", basic::rough_plastic),
    read("twosided", wrappers::two_sided),
    read("mask", wrappers::mask),
    read("null", |_, _| Some(BsdfKind::Null)),
    read("bumpmap", wrappers::bump_map),
    read("normalmap", wrappers::normal_map),
    read("blendbsdf", wrappers::blend),
    read("principled", principled::principled),
    read("principledthin", principled::thin),
    approximated("disneybsdf", principled::disney, AS_PRINCIPLED),
    approximated("disneydiffuse", principled::disney, AS_PRINCIPLED),
    approximated("disneymetal", principled::disney, AS_PRINCIPLED),
    approximated("disneyglass", principled::disney, AS_PRINCIPLED),
    unsupported("hair"),
    unsupported("measured"),
    unsupported("measured_polarized"),
    unsupported("measuredbtf"),
    unsupported("polarizer"),
    unsupported("retarder"),
    unsupported("circular"),
    unsupported("mueller"),
    unsupported("pplastic"),
    read("phong", old::phong),
    read("ward", old::ward),
    read("coating", old::coating),
    read("roughcoating", old::rough_coating),
    read("difftrans", old::diffuse_transmitter),
    read("roughdiffuse", old::rough_diffuse),
    read("mixturebsdf", wrappers::mixture),
    unsupported("hk"),
    unsupported("irawan"),
    unsupported("rtrans"),
];

const HALF: ColorInput = ColorInput::Color(Color::Gray(0.5));

impl<'a> Reader<'a> {
    /// The BSDF at `index`. A diffuse gray, or the nested BSDF, replaces one that could not be read.
    pub fn bsdf(&mut self, index: ObjectIndex) -> Id<Bsdf> {
        if let Some(id) = self.bsdfs.get(&index) {
            return *id;
        }
        let nested = {
            let mut props = self.props(index);
            props.child(Class::Bsdf)
        };
        let instead = match nested {
            Some(_) => "its nested bsdf is used",
            None => "diffuse gray 0.5 is used",
        };
        let reader = self.plugin(BSDFS, index, instead);
        let mut props = self.props(index);
        let kind = match (reader, nested) {
            (Some(reader), _) => reader(self, &mut props),
            (None, Some(nested)) => {
                let id = self.bsdf(nested.index);
                self.bsdfs.insert(index, id);
                return id;
            }
            (None, None) => {
                props.ignore_rest();
                None
            }
        };
        let kind = kind.unwrap_or(BsdfKind::Diffuse { reflectance: HALF });
        let (name, origin) = (props.name(), props.origin());
        self.finish(props);
        let id = self.scene.bsdfs.push(Bsdf { name, origin, kind });
        self.bsdfs.insert(index, id);
        id
    }

    fn factor(&mut self, props: &mut Props<'a>, name: &'static str) -> ColorInput {
        self.color_input(props, name, ColorSlot::Reflectance, 1.0)
    }
}
