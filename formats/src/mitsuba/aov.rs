//! Integrators that ask for pictures of something else than light: `aov`, `multichannel`, `field` and `depth`.

use super::integrator::{INTEGRATORS, Rendering};
use super::object::{Class, Value};
use super::props::{Nested, Props};
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Severity, Span};
use crate::ir::{Aov, AovKind, Integrator, Origin};
use crate::plugin::{Status, find};

/// Longest name of a layer: a channel adds a letter, and files have room for 255 in all.
const LONGEST: usize = 200;

impl<'a> Reader<'a> {
    /// `depth` or `field` by itself, or what `moment` and the like are wrapped around, with the layers that are asked
    /// for.
    pub fn wrapped(&mut self, mut props: Props<'a>) -> Option<Integrator> {
        let plugin = props.object.plugin.as_str();
        let mut aovs = Vec::new();
        let names = if plugin == "multichannel" { self.channel_names() } else { Vec::new() };
        let mut picture: Option<(Span, Option<Integrator>)> = None;
        let mut number = 0;
        while let Some(nested) = props.child(Class::Integrator) {
            let name = names.get(number).cloned().or_else(|| self.name_of(&props, nested));
            number += 1;
            if self.is_surface(nested) {
                let mut inner = self.props(nested.index);
                aovs.extend(self.surface(&mut inner, name));
                self.finish(inner);
                continue;
            }
            if let Some((first, _)) = &picture {
                let text = format!("only the first integrator of `{plugin}` that gathers light is rendered");
                let problem = Diagnostic::warning(text, Some(nested.span));
                self.problems.push(problem.label(*first, "this one"));
                continue;
            }
            let mut integrator = self.integrator(nested.index);
            if let Some(integrator) = &mut integrator {
                aovs.extend(renamed(std::mem::take(&mut integrator.aovs), name.as_deref()));
            }
            aovs.extend(name.map(|name| Aov {
                origin: Origin(Some(nested.span)),
                name,
                kind: AovKind::Picture,
            }));
            picture = Some((nested.span, integrator));
        }
        if plugin == "aov" {
            aovs.extend(self.listed(&mut props));
        }
        if self.is_surface_plugin(plugin) {
            let name = props.object.id.clone();
            aovs.extend(self.surface(&mut props, name));
            let text =
                format!("`{plugin}` is rendered as a layer beside the picture, which is that of `path`");
            self.problems.push(Diagnostic::warning(text, Some(props.object.span)));
        } else if picture.is_none() {
            let text = format!("`{plugin}` contains no integrator that gathers light: `path` is used");
            self.problems.push(Diagnostic::warning(text, Some(props.object.span)));
        }
        let aovs = self.distinct(aovs);
        match picture {
            // A broken one was reported; what else is wrong is not known.
            Some((_, integrator)) => {
                // The others have parameters of their own, which do not matter to what they wrap.
                if matches!(plugin, "aov" | "multichannel") {
                    self.finish(props);
                }
                integrator.map(|i| Integrator { aovs, ..i })
            }
            None => Some(Integrator { aovs, ..self.as_path(props) }),
        }
    }

    fn is_surface(&self, nested: Nested) -> bool {
        self.is_surface_plugin(&self.objects[nested.index].plugin)
    }

    fn is_surface_plugin(&self, plugin: &str) -> bool {
        matches!(find(INTEGRATORS, plugin), Some(Status::Read(Rendering::Surface)))
    }

    /// The layer of a `depth` or `field` integrator.
    fn surface(&mut self, props: &mut Props<'a>, name: Option<String>) -> Option<Aov> {
        let origin = props.origin();
        let kind = if props.object.plugin == "depth" {
            AovKind::Depth
        } else {
            props.ignore_with_warning(&["undefined"], "where a ray meets nothing every layer is 0");
            let kind = props.optional_choice("field", &AovKind::FIELDS);
            if kind.is_none() && !props.has("field") {
                props.complain("field", "`field` needs the name of a field");
            }
            kind?
        };
        // The names of our own command line where the author gives none.
        let own = kind.mitsuba3().map_or("", |(name, _)| name);
        Some(Aov { origin, name: name.unwrap_or_else(|| own.to_owned()), kind })
    }

    /// `name:type` pairs.
    fn listed(&mut self, props: &mut Props<'a>) -> Vec<Aov> {
        let Some((text, span)) = props.optional_string("aovs") else { return Vec::new() };
        let mut aovs = Vec::new();
        for pair in text.split([',', ' ', '\t', '\n', '\r']).filter(|pair| !pair.is_empty()) {
            let Some((name, kind)) = pair.split_once(':').filter(|(name, _)| !name.is_empty()) else {
                let text = format!("`{pair}` is no layer: write NAME:TYPE, such as `dd.y:depth`");
                self.problems.push(Diagnostic::new(self.strict(), text, Some(span)));
                continue;
            };
            if kind == "boundary_test" {
                let text = format!("layer `{name}` is left out: `boundary_test` is not rendered");
                self.problems.push(Diagnostic::warning(text, Some(span)));
                continue;
            }
            match AovKind::TYPES.iter().find(|(word, _)| *word == kind) {
                Some((_, kind)) => {
                    aovs.push(Aov { origin: Origin(Some(span)), name: name.to_owned(), kind: *kind });
                }
                None => {
                    let words = AovKind::TYPES.map(|(word, _)| word);
                    let text = format!("layer `{name}` has an unknown type `{kind}`");
                    let problem = Diagnostic::new(self.strict(), text, Some(span));
                    let all = || format!("possible: {}", words.join(", "));
                    self.problems.push(problem.suggest_or(kind, words, all));
                }
            }
        }
        aovs
    }

    /// The first layer of each name, and only names that fit into a file.
    fn distinct(&mut self, aovs: Vec<Aov>) -> Vec<Aov> {
        let mut kept: Vec<Aov> = Vec::new();
        for aov in aovs {
            let why = if kept.iter().any(|other| other.name == aov.name) {
                "there is one of that name"
            } else if aov.name.len() > LONGEST || aov.name.contains('\0') {
                "its name does not fit into a file"
            } else {
                kept.push(aov);
                continue;
            };
            let text =
                format!("layer `{}` is left out: {why}", aov.name.chars().take(64).collect::<String>());
            self.problems.push(Diagnostic::new(Severity::Warning, text, aov.origin.0));
        }
        kept
    }

    /// The name by which an object holds another one.
    fn name_of(&self, props: &Props<'a>, nested: Nested) -> Option<String> {
        let named = |value: &Value| matches!(value, Value::Object(index) if *index == nested.index);
        let entry = props.object.entries.iter().find(|e| named(&e.value))?;
        entry.name.clone().or_else(|| self.objects[nested.index].id.clone()).filter(|name| !name.is_empty())
    }

    /// The names that a film of version 0.6 gives to the pictures of `multichannel`, in order.
    fn channel_names(&self) -> Vec<String> {
        let films = self.objects.iter().filter(|object| object.class == Class::Film);
        let mut lists = films.flat_map(|film| &film.entries).filter_map(|entry| match &entry.value {
            Value::String(list) if entry.name.as_deref() == Some("channel_names") => Some(list),
            _ => None,
        });
        let names = lists.next().map_or("", |list| list.as_str());
        names.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
    }
}

/// Layers of a nested integrator, which stand below its name.
fn renamed(aovs: Vec<Aov>, name: Option<&str>) -> impl Iterator<Item = Aov> {
    aovs.into_iter().map(move |aov| match name {
        Some(prefix) => Aov { name: format!("{prefix}.{}", aov.name), ..aov },
        None => aov,
    })
}
