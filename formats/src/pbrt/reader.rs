//! Directives → IR. This file keeps the state; the concepts have files of their own.

use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use super::depths::Depths;
use super::directive::{Directive, Param, Value};
use super::params::Params;
use super::policy::{Fault, Policy, of_type, of_unknown};
use super::space::ColorSpace;
use super::state::{Ctm, Graphics, Named, Names, Saved};
use crate::diagnostic::{Diagnostic, Span};
use crate::files::Files;
use crate::ir::{Arena, Bsdf, HideEmitters, Id, Medium, Origin, Scene, ShapeGroup, SpectrumRule, Transform};
use crate::missing::{find, not_found};
use crate::plugin::{self, Plugin, Status};

/// Directives from before WorldBegin; they are read there, when all of them are known.
#[derive(Debug, Default)]
pub(super) struct Head {
    /// With its place in the world and the medium there.
    pub camera: Option<(Params, Transform, Option<Id<Medium>>)>,
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
    pub policy: Policy,
    pub saved: Vec<Saved>,
    pub world: Option<Span>,
    /// Something that belongs after it came before it, and was reported.
    pub before_world: bool,
    pub systems: HashMap<String, Ctm>,
    pub names: Rc<Names>,
    pub depths: Depths,
    pub default_material: Option<Id<Bsdf>>,
    pub media: HashMap<String, Named<Medium>>,
    /// Files are missing: what they define is not known.
    pub incomplete: bool,
    pub groups: HashMap<String, Named<ShapeGroup>>,
    /// The object being defined; its shapes go there.
    pub open_group: Option<Id<ShapeGroup>>,
    /// Triangles of all subdivided meshes.
    pub subdivided: u64,
    pub warned_moving: bool,
    pub warned_scopes: bool,
    last: Span,
}

impl<'a> Reader<'a> {
    pub fn new(files: &'a dyn Files, folders: &'a [PathBuf], policy: Policy, start: Span) -> Self {
        let scene = Scene {
            origin: Origin(Some(start)),
            spectrum_rule: SpectrumRule::Pbrt,
            spectra_as: None,
            hide_emitters: HideEmitters::Surface,
            integrator: None,
            sensors: Vec::new(),
            default_sensor: 0,
            shapes: Vec::new(),
            groups: Arena::default(),
            bsdfs: Arena::default(),
            textures: Arena::default(),
            media: Arena::default(),
            emitters: Vec::new(),
        };
        Self {
            scene,
            problems: Vec::new(),
            state: Graphics::default(),
            head: Head::default(),
            files,
            folders,
            policy,
            saved: Vec::new(),
            world: None,
            before_world: false,
            systems: HashMap::new(),
            names: Rc::default(),
            depths: Depths::default(),
            default_material: None,
            media: HashMap::new(),
            incomplete: false,
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
        self.close_all();
        if self.world.is_none() {
            let last = self.last;
            self.problems.push(
                Diagnostic::error("the scene has no WorldBegin", Some(last))
                    .help("camera, film and integrator come before it, shapes and lights after it"),
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

    /// The parameters of a directive whose first argument names the type.
    pub fn entity(
        &mut self,
        class: &'static str,
        d: &Directive,
        params: Vec<Param>,
        target: Option<&'static str>,
    ) -> Params {
        let last = d.arguments.len() - 1;
        let mut p = Params::new(class, text(d, last), d.arguments[last].span, params, self.common());
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

    /// The reader of an entity's type, or `None` after reporting that there is none and what happens instead.
    pub fn plugin<F: Copy>(&mut self, table: &[Plugin<F>], p: &mut Params, instead: &str) -> Option<F> {
        let fault = of_type(p.class);
        match plugin::find(table, &p.kind) {
            Some(Status::Read(reader)) => return Some(reader),
            Some(Status::Unsupported(_)) if fault == Fault::Light => {
                let what = p.what();
                self.unsupported(&what, instead, p.span);
            }
            Some(Status::Unsupported(_)) => {
                let text = format!("{} is not rendered", p.what());
                self.problems.push(self.policy.report(fault, &text, p.span, instead));
            }
            None => {
                let problem = plugin::unknown(table, &format!("{} type", p.class), &p.kind, p.span);
                self.problems.push(self.policy.judge(of_unknown(p.class), problem, instead));
            }
        }
        p.ignore_rest();
        None
    }

    /// Reports something of pbrt that is not supported and that the light depends on.
    pub fn unsupported(&mut self, what: &str, instead: &str, span: Span) {
        let text = format!("{what} is not supported yet");
        let problem = self.policy.report(Fault::Light, &text, span, instead);
        let help = self.policy.stops(Fault::Light).then(|| format!("with --lenient {instead}"));
        self.problems.push(Diagnostic { help: help.into_iter().collect(), ..problem.unsupported() });
    }

    /// Reports a fault: an error, or a warning that says what happens `instead`.
    pub fn fault(&mut self, fault: Fault, text: &str, span: Span, instead: &str) {
        self.problems.push(self.policy.report(fault, text, span, instead));
    }

    /// What the parameters of every entity share.
    pub fn common(&self) -> (ColorSpace, Policy) {
        (self.state.space, self.policy)
    }

    /// The file a parameter names; `None` after reporting that it is missing.
    pub fn asset(&mut self, p: &mut Params, name: &'static str, what: &str) -> Option<PathBuf> {
        if !p.has(name) {
            let text = format!("{} needs the parameter \"string {name}\"", p.what());
            p.problems.push(Diagnostic::error(text, Some(p.span)));
        }
        let (file, span) = p.optional_string(name)?;
        self.located(p, what, &file, span)
    }

    /// A file by its name; `None` after reporting that it is missing.
    pub fn located(&self, p: &mut Params, what: &str, file: &str, span: Span) -> Option<PathBuf> {
        let found = find(self.files, file, self.folders);
        if found.is_none() {
            p.problems.push(not_found(self.files, what, file, span, self.folders));
        }
        found
    }
}

/// The quoted argument at `index`; empty where the grammar has another kind there.
pub(super) fn text(d: &Directive, index: usize) -> &str {
    match d.arguments.get(index).map(|argument| &argument.value) {
        Some(Value::Text(text)) => text,
        _ => "",
    }
}
