//! Directives → IR. This file keeps the state; the concepts have files of their own.

use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use super::depths::Depths;
use super::directive::{Directive, Param, Value};
use super::params::Params;
use super::space::ColorSpace;
use super::state::{Ctm, Graphics, Saved, Scope};
use crate::diagnostic::{Diagnostic, Span, nearest};
use crate::files::Files;
use crate::ir::{
    Arena, Bsdf, ColorInput, FloatInput, HideEmitters, Id, Origin, Scene, ShapeGroup, SpectrumRule, Transform,
};
use crate::missing::{find, not_found};
use crate::plugin::{self, Plugin, Status};
use crate::read::ReadOptions;

/// Something named that may be used before it is defined.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named<T> {
    pub id: Id<T>,
    pub defined: Option<Span>,
    pub used: Option<Span>,
}

/// What stands before WorldBegin and is read there, when all of it is known.
#[derive(Debug, Default)]
pub(super) struct Head {
    /// With its place in the world.
    pub camera: Option<(Params, Transform)>,
    pub film: Option<Params>,
    pub filter: Option<Params>,
    pub sampler: Option<Params>,
    pub integrator: Option<Params>,
    /// `Option "seed"`.
    pub seed: i32,
}

pub(super) struct Reader<'a> {
    pub scene: Scene,
    pub problems: Vec<Diagnostic>,
    pub state: Graphics,
    pub head: Head,
    pub files: &'a dyn Files,
    pub folders: &'a [PathBuf],
    pub options: &'a ReadOptions,
    saved: Vec<Saved>,
    pub world: Option<Span>,
    systems: HashMap<String, Ctm>,
    pub float_textures: HashMap<String, (FloatInput, Span)>,
    pub color_textures: HashMap<String, (ColorInput, Span)>,
    pub texture_depths: Depths,
    pub materials: HashMap<String, Named<Bsdf>>,
    pub default_material: Option<Id<Bsdf>>,
    pub media: HashMap<String, Span>,
    pub groups: HashMap<String, Named<ShapeGroup>>,
    /// The object being defined; its shapes go there.
    pub open_group: Option<Id<ShapeGroup>>,
    /// Triangles of all subdivided meshes.
    pub subdivided: u64,
    warned_moving: bool,
    warned_scopes: bool,
    last: Span,
}

impl<'a> Reader<'a> {
    pub fn new(files: &'a dyn Files, folders: &'a [PathBuf], options: &'a ReadOptions, start: Span) -> Self {
        let scene = Scene {
            origin: Origin(Some(start)),
            spectrum_rule: SpectrumRule::Pbrt,
            hide_emitters: HideEmitters::Surface,
            integrator: None,
            sensors: Vec::new(),
            default_sensor: 0,
            shapes: Vec::new(),
            groups: Arena::default(),
            bsdfs: Arena::default(),
            textures: Arena::default(),
            emitters: Vec::new(),
        };
        Self {
            scene,
            problems: Vec::new(),
            state: Graphics::default(),
            head: Head::default(),
            files,
            folders,
            options,
            saved: Vec::new(),
            world: None,
            systems: HashMap::new(),
            float_textures: HashMap::new(),
            color_textures: HashMap::new(),
            texture_depths: Depths::default(),
            materials: HashMap::new(),
            default_material: None,
            media: HashMap::new(),
            groups: HashMap::new(),
            open_group: None,
            subdivided: 0,
            warned_moving: false,
            warned_scopes: false,
            last: start,
        }
    }

    /// Reads the whole scene.
    pub fn scene(mut self, directives: Vec<Directive>) -> (Scene, Vec<Diagnostic>) {
        for directive in directives {
            self.last = directive.span;
            self.directive(directive);
        }
        while let Some(saved) = self.saved.pop() {
            let (begin, end) = match saved.scope {
                Scope::Attribute => ("AttributeBegin", "AttributeEnd"),
                Scope::Object => ("ObjectBegin", "ObjectEnd"),
            };
            self.error(format!("{begin} has no {end}"), saved.span);
        }
        if self.world.is_none() {
            let last = self.last;
            self.problems.push(
                Diagnostic::error("the scene has no WorldBegin", Some(last))
                    .help("camera, film and integrator stand before it, shapes and lights after it"),
            );
        }
        self.finish();
        (self.scene, self.problems)
    }

    pub fn error(&mut self, text: impl Into<String>, span: Span) {
        self.problems.push(Diagnostic::error(text, Some(span)));
    }

    pub fn warn(&mut self, text: impl Into<String>, span: Span) {
        self.problems.push(Diagnostic::warning(text, Some(span)));
    }

    fn directive(&mut self, mut d: Directive) {
        if !self.allowed(&d) {
            return;
        }
        let params = std::mem::take(&mut d.params);
        match d.name.as_str() {
            "Identity" => self.state.set(&[Transform::IDENTITY; 2]),
            "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform" | "ConcatTransform" => {
                self.transform(&d)
            }
            "CoordinateSystem" => {
                let ctm = self.state.ctm;
                self.systems.insert(text(&d, 0).to_owned(), ctm);
            }
            "CoordSysTransform" => self.restore_system(&d),
            "ActiveTransform" => self.activate(&d),
            // Times matter to moving things only.
            "TransformTimes" => {}
            "Accelerator" => {
                let p = self.entity("accelerator", &d, params, None);
                self.accelerator(p);
            }
            "WorldBegin" => self.world_begin(d.span),
            "AttributeBegin" => self.open(Scope::Attribute, d.span),
            "AttributeEnd" => self.close(Scope::Attribute, d.span),
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
            "Attribute" => self.attribute(&d, params),
            "ColorSpace" => self.color_space(&d),
            "ReverseOrientation" => self.state.reverse = !self.state.reverse,
            "Option" => self.option(&d),
            "Camera" => {
                self.report_moving("the camera", d.span);
                let [start, end] = self.state.inverse;
                if let (Some(start), Some(end)) = (start, end) {
                    self.systems.insert("camera".to_owned(), [start, end]);
                } else {
                    self.error("the transform before Camera flattens space: it has no inverse", d.span);
                }
                let to_world = start.unwrap_or(Transform::IDENTITY);
                self.head.camera = Some((self.entity("camera", &d, params, None), to_world));
            }
            "Film" => self.head.film = Some(self.entity("film", &d, params, None)),
            "PixelFilter" => self.head.filter = Some(self.entity("filter", &d, params, None)),
            "Sampler" => self.head.sampler = Some(self.entity("sampler", &d, params, None)),
            "Integrator" => self.head.integrator = Some(self.entity("integrator", &d, params, None)),
            "Texture" => self.texture(&d, params),
            "Material" => {
                let p = self.entity("material", &d, params, Some("material"));
                self.state.material = Some(self.material(p, None));
            }
            "MakeNamedMaterial" => self.named_material(&d, params),
            "NamedMaterial" => {
                let id = self.material_by_name(text(&d, 0), d.arguments[0].span);
                self.state.material = Some(id);
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
            other => self.error(format!("`{other}` cannot stand here"), d.span),
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
        );
        match self.world {
            Some(begin) if head => {
                let text = format!("{} must stand before WorldBegin", d.name);
                self.problems
                    .push(Diagnostic::error(text, Some(d.span)).label(begin, "the world begins here"));
                false
            }
            None if world => {
                self.error(format!("{} must stand after WorldBegin", d.name), d.span);
                false
            }
            _ => true,
        }
    }

    /// The parameters of a directive whose first argument names the type.
    fn entity(
        &mut self,
        class: &'static str,
        d: &Directive,
        params: Vec<Param>,
        target: Option<&'static str>,
    ) -> Params {
        let last = d.arguments.len() - 1;
        let mut p = Params::new(class, text(d, last), d.arguments[last].span, params, self.state.space);
        if let Some(inherited) = target.and_then(|target| self.state.attributes.get(target)) {
            p.inherit(inherited);
        }
        p
    }

    /// As [`Self::entity`], for directives that name themselves and have a parameter `type`.
    pub fn named_entity(&mut self, class: &'static str, d: &Directive, params: Vec<Param>) -> Option<Params> {
        let mut p = self.entity(class, d, params, Some(class));
        if let Some((kind, span)) = p.optional_string("type") {
            (p.kind, p.span) = (kind, span);
            return Some(p);
        }
        let name = text(d, 0);
        let text = format!("{class} `{name}` needs the parameter \"string type\"");
        self.error(text, d.arguments[0].span);
        None
    }

    /// Ends the reading of an entity.
    pub fn done(&mut self, p: Params) {
        self.problems.extend(p.finish());
    }

    /// The reader of an entity's type, or `None` after saying that there is none and what happens instead.
    pub fn plugin<F: Copy>(&mut self, table: &[Plugin<F>], p: &mut Params, instead: &str) -> Option<F> {
        match plugin::find(table, &p.kind) {
            Some(Status::Read(reader)) => Some(reader),
            Some(Status::Unsupported(_)) => {
                let what = p.what();
                self.unsupported(&what, instead, p.span);
                p.ignore_rest();
                None
            }
            None => {
                self.problems.push(plugin::unknown(table, &format!("{} type", p.class), &p.kind, p.span));
                p.ignore_rest();
                None
            }
        }
    }

    /// Reports something that pbrt has and we do not.
    pub fn unsupported(&mut self, what: &str, instead: &str, span: Span) {
        let text = format!("{what} is not supported yet");
        let problem = if self.options.allow_unsupported {
            Diagnostic::warning(format!("{text}: {instead}"), Some(span))
        } else {
            let help = format!("--allow-unsupported renders without it: {instead}");
            Diagnostic::error(text, Some(span)).help(help)
        };
        self.problems.push(problem.unsupported());
    }

    /// The file a parameter names; `None` after reporting that it is missing.
    pub fn asset(&mut self, p: &mut Params, name: &'static str, what: &str) -> Option<PathBuf> {
        if !p.has(name) {
            let text = format!("{} needs the parameter \"string {name}\"", p.what());
            p.problems.push(Diagnostic::error(text, Some(p.span)));
        }
        let (file, span) = p.optional_string(name)?;
        let found = find(self.files, &file, self.folders);
        if found.is_none() {
            p.problems.push(not_found(self.files, what, &file, span, self.folders));
        }
        found
    }

    fn transform(&mut self, d: &Directive) {
        let Value::Numbers(v) = &d.arguments[0].value else { return };
        if v.iter().any(|x| !x.is_finite()) {
            return self.error(format!("{} holds a number that is too large", d.name), d.span);
        }
        // Files list matrices by columns.
        let matrix = || Transform(std::array::from_fn(|row| std::array::from_fn(|c| v[c * 4 + row])));
        let (m, inverse) = match d.name.as_str() {
            "Translate" => {
                let by = [v[0], v[1], v[2]];
                (Transform::translate(by), Some(Transform::translate(by.map(|x| -x))))
            }
            "Scale" => {
                let by = [v[0], v[1], v[2]];
                let back = by.iter().all(|x| *x != 0.0).then(|| Transform::scale(by.map(|x| 1.0 / x)));
                (Transform::scale(by), back)
            }
            "Rotate" => match Transform::rotate([v[1], v[2], v[3]], v[0]) {
                Some(m) => (m, Transform::rotate([v[1], v[2], v[3]], -v[0])),
                None => return self.error("the axis of Rotate is zero", d.span),
            },
            "LookAt" => match look_at(v) {
                Some((to_camera, to_world)) => (to_camera, Some(to_world)),
                None => {
                    let text =
                        "LookAt has no direction: eye and target are the same, or `up` is parallel to it";
                    return self.error(text, d.span);
                }
            },
            "Transform" => return self.state.set(&[matrix(); 2]),
            _ => {
                let m = matrix();
                (m, m.inverse())
            }
        };
        self.state.concat(&m, inverse);
    }

    fn restore_system(&mut self, d: &Directive) {
        let name = text(d, 0);
        match self.systems.get(name) {
            // Only the active transforms, as every other transform directive.
            Some(ctm) => self.state.set(ctm),
            None => {
                let text = format!("no coordinate system is called `{name}`; the transform stays as it is");
                let mut problem = Diagnostic::warning(text, Some(d.arguments[0].span));
                if let Some(known) = nearest(name, self.systems.keys().map(String::as_str)) {
                    problem = problem.help(format!("did you mean `{known}`?"));
                }
                self.problems.push(problem);
            }
        }
    }

    fn activate(&mut self, d: &Directive) {
        let Value::Word(word) = &d.arguments[0].value else { return };
        self.state.active = match word.as_str() {
            "All" => [true, true],
            "StartTime" => [true, false],
            "EndTime" => [false, true],
            _ => {
                let text = format!("ActiveTransform takes All, StartTime or EndTime, not `{word}`");
                return self.error(text, d.arguments[0].span);
            }
        };
    }

    /// Motion is not rendered: the first transform is used.
    fn report_moving(&mut self, what: &str, span: Span) {
        if self.state.moves() && !self.warned_moving {
            self.warned_moving = true;
            let text = format!("{what} moves: the scene is rendered as it stands at the start time");
            self.warn(text, span);
        }
    }

    fn world_begin(&mut self, span: Span) {
        if let Some(first) = self.world {
            let problem = Diagnostic::error("a scene has one WorldBegin", Some(span));
            self.problems.push(problem.label(first, "the first one"));
            return;
        }
        self.world = Some(span);
        self.state.active = [true; 2];
        self.state.set(&[Transform::IDENTITY; 2]);
        self.systems.insert("world".to_owned(), self.state.ctm);
        self.sensor(span);
        self.integrator();
    }

    /// Begins an object definition, a scope of its own.
    pub fn open_object(&mut self, span: Span) {
        self.open(Scope::Object, span);
    }

    fn open(&mut self, scope: Scope, span: Span) {
        self.saved.push(Saved { scope, graphics: self.state.clone(), span });
    }

    fn close(&mut self, scope: Scope, span: Span) {
        let (end, begin) = match scope {
            Scope::Attribute => ("AttributeEnd", "AttributeBegin"),
            Scope::Object => ("ObjectEnd", "ObjectBegin"),
        };
        match self.saved.pop() {
            Some(saved) if saved.scope == scope => self.state = saved.graphics,
            Some(saved) => {
                let problem = Diagnostic::error(format!("{end} closes what it did not open"), Some(span));
                self.problems.push(problem.label(saved.span, "this is still open"));
                self.state = saved.graphics;
            }
            None => self.error(format!("{end} without {begin}"), span),
        }
    }

    /// Ours serves for all.
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
                let text = format!("no colour space is called `{name}`");
                let problem = Diagnostic::error(text, Some(d.arguments[0].span));
                self.problems.push(problem.help(format!("known: {}", known.join(", "))));
            }
        }
    }
}

/// The quoted argument at `index`; empty where the grammar has another kind there.
pub(super) fn text(d: &Directive, index: usize) -> &str {
    match d.arguments.get(index).map(|argument| &argument.value) {
        Some(Value::Text(text)) => text,
        _ => "",
    }
}

/// World → camera, and back. The same columns as Mitsuba's, but +X is on the right of the picture.
fn look_at(v: &[f64]) -> Option<(Transform, Transform)> {
    let to_world = Transform::look_at([v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]])?;
    Some((to_world.inverse()?, to_world))
}
