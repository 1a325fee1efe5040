//! The effect of each directive.

use std::rc::Rc;

use super::directive::{Directive, Param};
use super::params::Params;
use super::policy::Fault;
use super::reader::{Reader, text};
use super::space::ColorSpace;
use super::state::Scope;
use crate::diagnostic::Diagnostic;
use crate::ir::Transform;
use crate::plugin::{self, Plugin};

impl Reader<'_> {
    /// Carries a directive out.
    pub fn directive(&mut self, mut d: Directive) {
        if !self.allowed(&d) {
            return;
        }
        let params = std::mem::take(&mut d.params);
        match d.name.as_str() {
            "Accelerator" | "Camera" | "Film" | "PixelFilter" | "Sampler" | "Integrator" => {
                self.head_directive(&d, params);
            }
            "Texture" => self.texture(&d, params),
            "Material" => {
                let p = self.entity("material", &d, params, Some("material"));
                self.state.material_params = self.policy.is_three().then(|| Rc::new(p.clone()));
                self.state.material = Some(self.material(p, None));
            }
            "MakeNamedMaterial" => self.named_material(&d, params),
            "NamedMaterial" => {
                if let Some(id) = self.material_by_name(text(&d, 0), d.arguments[0].span) {
                    self.state.material = Some(id);
                    self.state.material_params = self.names.material_params.get(text(&d, 0)).cloned();
                }
            }
            "Volume" => {
                let what = format!("participating medium `{}`", text(&d, 0));
                self.unsupported(&what, "vacuum is used", d.span);
            }
            "MakeNamedMedium" => self.medium(&d, params),
            "MediumInterface" => self.medium_interface(&d),
            "AreaLightSource" => {
                let p = self.entity("area light", &d, params, Some("light"));
                self.state.area_light = Some(Rc::new(p));
            }
            "LightSource" => {
                self.report_moving("a light", d.span);
                let p = self.entity("light", &d, params, Some("light"));
                self.light(p);
            }
            "Shape" => {
                self.report_moving("a shape", d.span);
                let p = self.entity("shape", &d, params, Some("shape"));
                self.shape(p);
            }
            "ObjectBegin" => self.object_begin(&d),
            "ObjectEnd" => {
                self.open_group = None;
                self.close(Scope::Object, d.span);
            }
            "ObjectInstance" => {
                self.report_moving("an instance", d.span);
                self.object_instance(&d);
            }
            _ => self.state_directive(&d, params),
        }
    }

    /// What stands before WorldBegin and is read there.
    fn head_directive(&mut self, d: &Directive, params: Vec<Param>) {
        match d.name.as_str() {
            "Accelerator" => {
                let p = self.entity("accelerator", d, params, None);
                self.accelerator(p);
            }
            "Camera" => {
                self.report_moving("the camera", d.span);
                let [start, end] = self.state.inverse;
                if let (Some(start), Some(end)) = (start, end) {
                    self.systems.insert("camera".to_owned(), [start, end]);
                } else {
                    self.error("the transform before Camera flattens space: it has no inverse", d.span);
                }
                let to_world = start.unwrap_or(Transform::IDENTITY);
                self.head.camera =
                    Some((self.entity("camera", d, params, None), to_world, self.state.media[1]));
            }
            "Film" => self.head.film = Some(self.entity("film", d, params, None)),
            "PixelFilter" => self.head.filter = Some(self.entity("filter", d, params, None)),
            "Sampler" => self.head.sampler = Some(self.entity("sampler", d, params, None)),
            _ => self.head.integrator = Some(self.entity("integrator", d, params, None)),
        }
    }

    /// What changes the graphics state only.
    fn state_directive(&mut self, d: &Directive, params: Vec<Param>) {
        match d.name.as_str() {
            "Identity" => self.state.set(&[Transform::IDENTITY; 2]),
            "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform" | "ConcatTransform" => {
                self.transform(d);
            }
            "CoordinateSystem" => {
                let ctm = self.state.ctm;
                self.systems.insert(text(d, 0).to_owned(), ctm);
            }
            "CoordSysTransform" => self.restore_system(d),
            "ActiveTransform" => self.activate(d),
            // Times matter to moving things only.
            "TransformTimes" => {}
            "WorldBegin" => self.world_begin(d.span),
            "AttributeBegin" => self.open(Scope::Attribute, d.span),
            "AttributeEnd" => self.close(Scope::Attribute, d.span),
            "TransformBegin" if self.policy.is_three() => self.open(Scope::Transform, d.span),
            "TransformEnd" if self.policy.is_three() => self.close(Scope::Transform, d.span),
            "TransformBegin" | "TransformEnd" => {
                if !self.warned_scopes {
                    self.warned_scopes = true;
                    let instead = d.name.replace("Transform", "Attribute");
                    self.warn(format!("{} acts as {instead} in pbrt-v4", d.name), d.span);
                }
                if d.name == "TransformBegin" {
                    self.open(Scope::Attribute, d.span);
                } else {
                    self.close(Scope::Attribute, d.span);
                }
            }
            "Attribute" => self.attribute(d, params),
            "ColorSpace" => self.color_space(d),
            "ReverseOrientation" => self.state.reverse = !self.state.reverse,
            "Option" => self.option(d),
            other => self.error(format!("`{other}` is not allowed here"), d.span),
        }
    }

    /// Reports a directive on the wrong side of WorldBegin.
    fn allowed(&mut self, d: &Directive) -> bool {
        let head = matches!(
            d.name.as_str(),
            "Accelerator" | "Camera" | "Film" | "Integrator" | "PixelFilter" | "Sampler" | "TransformTimes"
        );
        let world = matches!(
            d.name.as_str(),
            "AreaLightSource"
                | "AttributeBegin"
                | "AttributeEnd"
                | "LightSource"
                | "MakeNamedMaterial"
                | "Material"
                | "NamedMaterial"
                | "ObjectBegin"
                | "ObjectEnd"
                | "ObjectInstance"
                | "ReverseOrientation"
                | "Shape"
                | "Texture"
                | "TransformBegin"
                | "TransformEnd"
                | "Volume"
        );
        match self.world {
            Some(begin) if head => {
                let text = format!("{} must come before WorldBegin", d.name);
                let problem = Diagnostic::error(text, Some(d.span)).label(begin, "the world begins here");
                self.problems.push(self.policy.judge(Fault::Mistake, problem, "it is ignored"));
                false
            }
            None if world => {
                // All that follows would say the same.
                if !std::mem::replace(&mut self.before_world, true) {
                    let text = format!("{} must come after WorldBegin", d.name);
                    let problem = Diagnostic::error(text, Some(d.span))
                        .help("a line `WorldBegin` ends the camera and film, and begins lights and shapes");
                    let instead = "it is ignored, as is all else that should";
                    self.problems.push(self.policy.judge(Fault::Mistake, problem, instead));
                }
                false
            }
            _ => true,
        }
    }

    /// Accepts an accelerator; ours is always used.
    fn accelerator(&mut self, mut p: Params) {
        type Names = &'static [&'static str];
        const ACCELERATORS: &[Plugin<Names>] = &[
            plugin::read("bvh", &["splitmethod", "maxnodeprims"]),
            plugin::read("kdtree", &["intersectcost", "traversalcost", "emptybonus", "maxprims", "maxdepth"]),
        ];
        if let Some(names) = self.plugin(ACCELERATORS, &mut p, "it does not matter") {
            p.ignore(names);
        }
        self.done(p);
    }

    fn attribute(&mut self, d: &Directive, params: Vec<Param>) {
        const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];
        let name = text(d, 0);
        let Some(target) = TARGETS.into_iter().find(|target| *target == name) else {
            let text = format!("Attribute takes {}, not `{name}`", TARGETS.join(", "));
            return self.error(text, d.arguments[0].span);
        };
        let list = self.state.attributes.entry(target).or_default();
        Rc::make_mut(list).extend(params);
    }

    fn color_space(&mut self, d: &Directive) {
        let name = text(d, 0);
        match ColorSpace::named(name) {
            Some(space) => self.state.space = space,
            None => {
                let known: Vec<_> = ColorSpace::names().collect();
                let text = format!("no colour space named `{name}`");
                let problem = Diagnostic::error(text, Some(d.arguments[0].span));
                self.problems.push(problem.help(format!("known: {}", known.join(", "))));
            }
        }
    }
}
