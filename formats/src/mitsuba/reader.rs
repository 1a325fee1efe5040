//! Last pass: objects to IR. This file walks the scene and has what the readers of all concepts share.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::object::{Class, Object, ObjectIndex, Value};
use super::policy::{Policy, changes_light};
use super::props::Props;
use super::version::Dialect;
use crate::diagnostic::{Diagnostic, Severity, SourceMap};
use crate::files::Files;
use crate::ir::{AreaEmission, Arena, Bsdf, Id, Medium, Origin, Query, Scene, ShapeGroup, Texture};
use crate::misnamed;
use crate::missing::{find, not_found};
use crate::plugin::{self, Plugin, Status};

pub(super) struct Reader<'a> {
    pub objects: &'a [Object],
    pub dialect: Dialect,
    pub scene: Scene,
    pub problems: Vec<Diagnostic>,
    /// Answers about the BSDFs read so far.
    pub query: Query,
    files: &'a dyn Files,
    sources: &'a SourceMap,
    folders: &'a [PathBuf],
    policy: Policy,
    /// Objects that several others refer to are read once.
    pub bsdfs: HashMap<ObjectIndex, Id<Bsdf>>,
    pub textures: HashMap<ObjectIndex, Id<Texture>>,
    pub media: HashMap<ObjectIndex, Option<Id<Medium>>>,
    /// Of the phase function that is read now.
    pub phase_parts: u32,
    pub groups: HashMap<ObjectIndex, Id<ShapeGroup>>,
    pub emissions: HashMap<ObjectIndex, Option<AreaEmission>>,
    /// Materials of OBJ files, by file and name.
    pub obj_bsdfs: HashMap<(PathBuf, String), Id<Bsdf>>,
    /// What is read now belongs to an emitter, whose textures hold light and no reflectances.
    pub in_emitter: bool,
    /// Emitters that became lights of the scene.
    pub lights: HashSet<ObjectIndex>,
}

impl<'a> Reader<'a> {
    pub fn new(
        objects: &'a [Object],
        dialect: Dialect,
        files: &'a dyn Files,
        sources: &'a SourceMap,
        folders: &'a [PathBuf],
        policy: Policy,
    ) -> Self {
        let scene = Scene {
            origin: Origin(objects.first().map(|root| root.span)),
            spectrum_rule: dialect.spectrum_rule(),
            spectra_as: None,
            hide_emitters: dialect.hide_emitters(),
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
            objects,
            dialect,
            scene,
            problems: Vec::new(),
            query: Query::default(),
            files,
            sources,
            folders,
            policy,
            bsdfs: HashMap::new(),
            textures: HashMap::new(),
            media: HashMap::new(),
            phase_parts: 0,
            groups: HashMap::new(),
            emissions: HashMap::new(),
            obj_bsdfs: HashMap::new(),
            in_emitter: false,
            lights: HashSet::new(),
        }
    }

    /// Reads everything below the scene.
    pub fn scene(mut self) -> (Scene, Vec<Diagnostic>) {
        let root = &self.objects[0];
        let mut integrators = Vec::new();
        for entry in &root.entries {
            let Value::Object(index) = entry.value else {
                if !matches!(entry.value, Value::Broken) {
                    let name = entry.spelling.as_ref().or(entry.name.as_ref());
                    let text = format!("unknown parameter `{}` of the scene", name.map_or("", |n| n));
                    self.problems.push(self.policy.parameter(root, false, &text, entry.name_span));
                }
                continue;
            };
            match self.objects[index].class {
                Class::Shape => self.top_level_shape(index),
                Class::Bsdf => {
                    self.bsdf(index);
                }
                Class::Texture | Class::Spectrum => self.top_level_texture(index),
                Class::Emitter => self.top_level_emitter(index),
                Class::Sensor => self.sensor(index),
                Class::Integrator => integrators.push((index, entry.span)),
                Class::Medium => {
                    self.medium(index);
                }
                Class::Subsurface => self.skip_unsupported(index, "it is skipped"),
                // Only meaningful where something refers to them, and read there.
                Class::Film
                | Class::Sampler
                | Class::Rfilter
                | Class::Phase
                | Class::Volume
                | Class::Null
                | Class::Scene => {}
            }
        }
        self.integrators(&integrators);
        if self.dialect == Dialect::Old {
            // One that could not be read was reported.
            if !self.objects.iter().any(|object| object.class == Class::Sensor) {
                self.default_sensor();
            }
            self.scene.default_sensor = self.scene.sensors.len().saturating_sub(1);
        }
        self.check_emitters();
        (self.scene, self.problems)
    }

    pub fn props(&self, index: ObjectIndex) -> Props<'a> {
        Props::new(self.objects, index)
    }

    /// Ends the reading of an object.
    pub fn finish(&mut self, props: Props<'a>) {
        self.problems.extend(props.finish(self.policy));
    }

    /// The reader of an object's plugin, or `None` after reporting that there is none and what
    /// happens instead.
    pub fn plugin<F: Copy>(&mut self, table: &[Plugin<F>], index: ObjectIndex, instead: &str) -> Option<F> {
        let object = &self.objects[index];
        if object.plugin.is_empty() {
            return None;
        }
        match plugin::find(table, &object.plugin) {
            Some(Status::Read(reader)) => {
                // Integrators have words of their own.
                let instead =
                    plugin::instead(table, &object.plugin).filter(|_| object.class != Class::Integrator);
                if let Some(instead) = instead {
                    let text = format!("{} `{}` is rendered {instead}", object.class.name(), object.plugin);
                    self.problems.push(Diagnostic::warning(text, Some(object.span)));
                }
                Some(reader)
            }
            Some(Status::Unsupported(advice)) => {
                self.unsupported(index, advice, instead);
                None
            }
            None => {
                let what = format!("unknown {} plugin `{}`", object.class.name(), object.plugin);
                let problem = self.policy.plugin(object, &what, instead);
                self.problems.push(plugin::suggest(table, &object.plugin, problem));
                None
            }
        }
    }

    /// Reports an object that is known but not rendered.
    pub fn unsupported(&mut self, index: ObjectIndex, advice: &str, instead: &str) {
        let object = &self.objects[index];
        let (class, plugin) = (object.class.name(), &object.plugin);
        let what = if object.used && changes_light(object.class) {
            format!("{class} plugin `{plugin}` is not supported yet")
        } else {
            format!("{class} plugin `{plugin}` is not rendered")
        };
        let mut problem = self.policy.plugin(object, &what, instead);
        if !advice.is_empty() {
            problem = problem.help(advice);
        }
        self.problems.push(problem);
    }

    /// [`Self::unsupported`] for classes without a table.
    pub fn skip_unsupported(&mut self, index: ObjectIndex, instead: &str) {
        if !self.objects[index].plugin.is_empty() {
            self.unsupported(index, "", instead);
        }
    }

    /// The file that parameter `filename` names; `None` after reporting that there is none.
    pub fn asset(&mut self, props: &mut Props<'a>, what: &str) -> Option<PathBuf> {
        if !props.has("filename") {
            let text = format!("{} needs the parameter `filename`", props.object.plugin);
            props.problems.push(Diagnostic::error(text, Some(props.object.span)));
        }
        let (name, span) = props.optional_string("filename")?;
        let mut folders = self.folders.to_vec();
        folders.push(self.sources.path(span.file).parent().unwrap_or(Path::new("")).to_path_buf());
        let found = find(self.files, name, &folders);
        if found.is_none() {
            props.problems.push(not_found(self.files, what, name, span, &folders));
        }
        found
    }

    /// The content of a file that was found.
    pub fn file(&self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = self.files.read(path).map_err(|e| e.to_string())?;
        misnamed::named(&bytes).map_or(Ok(bytes), |what| Err(format!("it is {what}")))
    }

    /// The file `name` in one of `folders`.
    pub fn beside(&self, name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
        find(self.files, name, folders)
    }

    /// `Error` where Mitsuba 2 and 3 refuse a scene that 0.6 renders.
    pub fn strict(&self) -> Severity {
        if self.dialect == Dialect::Old { Severity::Warning } else { Severity::Error }
    }
}
