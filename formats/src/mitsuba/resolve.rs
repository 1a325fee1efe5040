//! Fourth pass: elements become objects with typed entries; ids, aliases and references are resolved.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::expand::{Expanded, check_attributes};
use super::object::{Class, Entry, Object, ObjectIndex, Value};
use super::policy::Policy;
use super::property::{PROPERTY_TAGS, PropertyReader};
use super::tree::{Element, MAX_DEPTH};
use super::version::{Dialect, Version};
use crate::diagnostic::{Diagnostic, SourceMap, Span, nearest};
use crate::files::Files;

pub(super) struct Resolver<'a> {
    pub files: &'a dyn Files,
    pub sources: &'a SourceMap,
    pub folders: &'a [PathBuf],
    pub problems: &'a mut Vec<Diagnostic>,
    pub policy: Policy,
    versions: Vec<Version>,
    objects: Vec<Object>,
    ids: HashMap<String, (ObjectIndex, Span)>,
    aliases: Vec<(String, String, Span)>,
}

impl<'a> Resolver<'a> {
    pub fn new(
        files: &'a dyn Files,
        sources: &'a SourceMap,
        folders: &'a [PathBuf],
        problems: &'a mut Vec<Diagnostic>,
        policy: Policy,
    ) -> Self {
        Self {
            files,
            sources,
            folders,
            problems,
            policy,
            versions: Vec::new(),
            objects: Vec::new(),
            ids: HashMap::new(),
            aliases: Vec::new(),
        }
    }

    /// All objects; the scene is number 0. References are resolved and free of cycles.
    pub fn objects(mut self, tree: Expanded) -> Vec<Object> {
        self.versions = tree.versions;
        self.object(&tree.root, Class::Scene);
        self.link_aliases(tree.incomplete);
        self.link_references(tree.incomplete);
        self.cut_cycles();
        self.mark_used();
        self.objects
    }

    fn object(&mut self, element: &Element, class: Class) -> ObjectIndex {
        let index = self.objects.len();
        let allowed: &[&str] = match class {
            Class::Scene => &["version", "type", "id", "name"],
            _ => &["type", "id", "name", "version"],
        };
        check_attributes(element, allowed, self.problems);
        let mut plugin = element.value("type").unwrap_or_default().to_owned();
        if element.broken {
            plugin.clear();
        } else if plugin.is_empty() && !matches!(class, Class::Scene | Class::Null) {
            let text = format!("<{}> needs the attribute `type`", element.tag);
            self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
        }
        let dialect = self.versions[element.tag_span.file as usize].dialect();
        let id = element.value("id").filter(|_| !element.broken).map(str::to_owned);
        self.objects.push(Object {
            class,
            plugin,
            span: element.place("type"),
            id: id.clone(),
            entries: Vec::new(),
            used: false,
            camel_case: dialect == Dialect::Old,
        });
        // An empty id names nothing.
        if let Some(id) = id.filter(|id| !id.is_empty()) {
            self.register(id, index, element.place("id"));
        }
        let mut entries: Vec<Entry> = Vec::with_capacity(element.children.len());
        let mut seen = HashMap::new();
        for child in &element.children {
            let Some(entry) = self.entry(child) else { continue };
            self.report_repeated(&mut seen, &entry, dialect != Dialect::Three);
            entries.push(entry);
        }
        self.objects[index].entries = entries;
        index
    }

    fn entry(&mut self, element: &Element) -> Option<Entry> {
        let tag = element.tag.as_str();
        let name = element.value("name").map(str::to_owned);
        let name_span = element.place("name");
        let spelling = self.spelling(element);
        let class = Class::of_tag(tag).filter(|_| tag != "spectrum" || element.attribute("type").is_some());
        if let Some(class) = class {
            if class == Class::Scene {
                let text = "<scene> is not allowed inside another element";
                self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
                return None;
            }
            let index = self.object(element, class);
            let value = Value::Object(index);
            return Some(Entry { name, spelling, name_span, span: element.place("type"), value });
        }
        if tag == "ref" {
            check_attributes(element, &["id", "name"], self.problems);
            let span = element.place("id");
            let value = match element.value("id") {
                _ if element.broken => Value::Broken,
                Some(id) => Value::Reference(id.to_owned()),
                None => {
                    self.problems.push(Diagnostic::error("<ref> needs the attribute `id`", Some(span)));
                    Value::Broken
                }
            };
            return Some(Entry { name, spelling, name_span, span, value });
        }
        if tag == "alias" {
            check_attributes(element, &["id", "as"], self.problems);
            match (element.value("id"), element.value("as")) {
                (Some(id), Some(new)) => {
                    self.aliases.push((id.to_owned(), new.to_owned(), element.place("as")))
                }
                _ => self
                    .problems
                    .push(Diagnostic::error("<alias> needs `id` and `as`", Some(element.tag_span))),
            }
            return None;
        }
        if PROPERTY_TAGS.contains(&tag) {
            let value = self.property(element);
            if name.is_none() {
                let text = format!("<{tag}> needs the attribute `name`");
                self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
                return None;
            }
            return Some(Entry { name, spelling, name_span, span: element.place("value"), value });
        }
        self.unknown_element(element);
        None
    }

    /// The name of an element as its file has it, if it was upgraded.
    fn spelling(&self, element: &Element) -> Option<String> {
        let name = element.attribute("name").filter(|name| name.value_span != element.tag_span)?;
        let text = self.sources.text(name.value_span.file);
        let written = text.get(name.value_span.start as usize..name.value_span.end as usize)?;
        // What was substituted stands there as `$` or an entity.
        (written != name.value && !written.contains(['$', '&'])).then(|| written.to_owned())
    }

    fn property(&mut self, element: &Element) -> Value {
        let file = element.tag_span.file;
        let mut folders = self.folders.to_vec();
        folders.push(self.sources.path(file).parent().unwrap_or(Path::new("")).to_path_buf());
        let dialect = self.versions[file as usize].dialect();
        PropertyReader { files: self.files, folders, dialect, problems: self.problems }.value(element)
    }

    fn unknown_element(&mut self, element: &Element) {
        let objects =
            ["bsdf", "emitter", "film", "integrator", "medium", "rfilter", "sampler", "sensor", "shape"];
        let others = ["texture", "include", "default", "ref", "alias", "path"];
        let known = PROPERTY_TAGS.iter().chain(&objects).chain(&others).copied();
        let text = format!("unknown element <{}>", element.tag);
        let problem = self.policy.judge(&text, "it is skipped", element.tag_span);
        self.problems.push(match nearest(&element.tag, known) {
            Some(known) => problem.help(format!("did you mean <{known}>?")),
            None => problem,
        });
    }

    fn report_repeated(&mut self, seen: &mut HashMap<String, Span>, new: &Entry, tolerant: bool) {
        if matches!(new.value, Value::Object(_) | Value::Reference(_)) {
            return;
        }
        let Some(name) = &new.name else { return };
        if let Some(first) = seen.insert(name.clone(), new.name_span) {
            let name = new.spelling.as_ref().unwrap_or(name);
            let text = format!("parameter `{name}` is given twice");
            // Mitsuba 0.6 and 2 warned and went on with the later value.
            let problem = if tolerant {
                Diagnostic::warning(text, Some(new.name_span)).help("the last one is used")
            } else {
                Diagnostic::error(text, Some(new.name_span))
            };
            self.problems.push(problem.label(first, "first given here"));
        }
    }

    fn register(&mut self, id: String, index: ObjectIndex, span: Span) {
        if let Some((_, first)) = self.ids.get(&id) {
            let problem = Diagnostic::error(format!("the id `{id}` is given twice"), Some(span));
            self.problems.push(problem.label(*first, "first given here"));
            return;
        }
        self.ids.insert(id, (index, span));
    }

    fn link_aliases(&mut self, incomplete: bool) {
        let mut aliases = std::mem::take(&mut self.aliases);
        // An alias of an alias may come in any order; each round links at least one or ends.
        loop {
            let before = aliases.len();
            let mut rest = Vec::new();
            for (id, new, span) in aliases {
                match self.ids.get(&id).map(|(index, _)| *index) {
                    Some(index) => self.register(new, index, span),
                    None => rest.push((id, new, span)),
                }
            }
            if rest.len() == before || rest.is_empty() {
                for (id, new, span) in rest.into_iter().filter(|_| !incomplete) {
                    let text = format!("alias `{new}` names the object `{id}`, which does not exist");
                    self.problems.push(Diagnostic::error(text, Some(span)));
                }
                return;
            }
            aliases = rest;
        }
    }

    fn link_references(&mut self, incomplete: bool) {
        for object in &mut self.objects {
            for entry in &mut object.entries {
                let Value::Reference(id) = &entry.value else { continue };
                if let Some((index, _)) = self.ids.get(id) {
                    entry.value = Value::Object(*index);
                    continue;
                }
                if incomplete {
                    // The missing file may have it.
                    entry.value = Value::Broken;
                    continue;
                }
                let problem = Diagnostic::error(format!("no object has the id `{id}`"), Some(entry.span));
                let mut known: Vec<&str> = self.ids.keys().map(String::as_str).collect();
                known.sort_unstable();
                // Comparing with more would take too long.
                known.truncate(10_000);
                self.problems.push(problem.suggest(id, known));
                entry.value = Value::Broken;
            }
        }
    }

    /// Breaks every cycle of references at the entry that closes it, and every chain that is too
    /// long to be followed by recursion.
    fn cut_cycles(&mut self) {
        let mut walk = Walk {
            heights: vec![None; self.objects.len()],
            path: Vec::new(),
            objects: &mut self.objects,
            problems: self.problems,
            too_deep: false,
        };
        for index in 0..walk.objects.len() {
            walk.visit(index);
        }
    }

    fn mark_used(&mut self) {
        let mut open: Vec<ObjectIndex> = Vec::new();
        for entry in &self.objects[0].entries {
            if let Value::Object(index) = entry.value {
                let object = &self.objects[index];
                // These are at the top level only to be referred to.
                let passive = matches!(
                    object.class,
                    Class::Bsdf
                        | Class::Texture
                        | Class::Spectrum
                        | Class::Medium
                        | Class::Phase
                        | Class::Volume
                ) || matches!(object.plugin.as_str(), "area" | "directionalarea");
                if !passive {
                    open.push(index);
                }
            }
        }
        while let Some(index) = open.pop() {
            if !std::mem::replace(&mut self.objects[index].used, true) {
                open.extend(self.objects[index].entries.iter().filter_map(|e| match e.value {
                    Value::Object(child) => Some(child),
                    _ => None,
                }));
            }
        }
    }
}

struct Walk<'a> {
    /// Longest chain below each finished object.
    heights: Vec<Option<usize>>,
    /// Objects being visited and the place of the entry each goes on through.
    path: Vec<(ObjectIndex, Span)>,
    objects: &'a mut [Object],
    problems: &'a mut Vec<Diagnostic>,
    too_deep: bool,
}

impl Walk<'_> {
    fn visit(&mut self, index: ObjectIndex) -> usize {
        if let Some(height) = self.heights[index] {
            return height;
        }
        let mut height = 0;
        for entry in 0..self.objects[index].entries.len() {
            let Value::Object(child) = self.objects[index].entries[entry].value else { continue };
            let span = self.objects[index].entries[entry].span;
            self.path.push((index, span));
            let cycle = self.path.iter().position(|(open, _)| *open == child);
            if let Some(at) = cycle {
                self.report_cycle(at, span);
            }
            let below =
                if cycle.is_some() || self.path.len() > MAX_DEPTH { MAX_DEPTH } else { self.visit(child) };
            if below >= MAX_DEPTH {
                self.objects[index].entries[entry].value = Value::Broken;
                if cycle.is_none() && !std::mem::replace(&mut self.too_deep, true) {
                    let text = format!("objects refer to each other more than {MAX_DEPTH} deep");
                    self.problems.push(Diagnostic::error(text, Some(span)));
                }
            } else {
                height = height.max(below + 1);
            }
            self.path.pop();
        }
        self.heights[index] = Some(height);
        height
    }

    fn report_cycle(&mut self, at: usize, span: Span) {
        let name = |index: ObjectIndex| {
            let object = &self.objects[index];
            object.id.as_ref().map_or_else(|| format!("<{}>", object.class.name()), |id| format!("`{id}`"))
        };
        let mut chain: Vec<String> = self.path[at..].iter().map(|(index, _)| name(*index)).collect();
        chain.push(name(self.path[at].0));
        let mut problem =
            Diagnostic::error(format!("objects contain themselves: {}", chain.join(" → ")), Some(span));
        for (_, through) in &self.path[at..self.path.len() - 1] {
            problem = problem.label(*through, "through this");
        }
        self.problems.push(problem);
    }
}
