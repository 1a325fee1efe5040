//! Second pass: `$parameters`, `<default>`, `<path>` and `<include>`. Its result is one tree with
//! none of them left.

use std::path::{Path, PathBuf};

use super::foreign;
use super::object::Class;
use super::parameters::Parameters;
use super::policy::{Policy, changes_light};
use super::tree::{Element, MAX_DEPTH};
use super::version::Version;
use super::xml;
use crate::diagnostic::{Diagnostic, SourceMap, Span};
use crate::encoding::{as_declared, into_utf8};
use crate::files::{Files, Included};
use crate::misnamed;
use crate::missing::{find, not_found};
use crate::read::ReadOptions;

const MAX_INCLUDE_DEPTH: usize = 32;

/// The expanded tree of a scene.
#[derive(Debug)]
pub(super) struct Expanded {
    pub root: Element,
    /// By file number of the source map.
    pub versions: Vec<Version>,
    /// `<path>` folders, the last one given first.
    pub folders: Vec<PathBuf>,
    /// An included file could not be read. What it defines is missing for that reason alone.
    pub incomplete: bool,
}

pub(super) struct Expander<'a> {
    files: &'a dyn Files,
    options: &'a ReadOptions,
    sources: &'a mut SourceMap,
    problems: &'a mut Vec<Diagnostic>,
    parameters: Parameters,
    versions: Vec<Version>,
    folders: Vec<PathBuf>,
    scene_folder: PathBuf,
    /// Files being expanded, outermost first, and the `<include>` that led to each.
    stack: Vec<(PathBuf, Option<Span>)>,
    /// All `<default>`s of each file of `stack`, to recognise a use before the definition.
    defaults: Vec<Vec<(String, String)>>,
    /// The files each file of `stack` includes, until one had to be searched for a definition.
    later_includes: Vec<Vec<PathBuf>>,
    /// Depth of the root element of each file of `stack`.
    root_depths: Vec<usize>,
    repeats: Included,
    incomplete: bool,
    /// Within something that does not change the light.
    harmless: bool,
}

impl<'a> Expander<'a> {
    pub fn new(
        files: &'a dyn Files,
        options: &'a ReadOptions,
        sources: &'a mut SourceMap,
        problems: &'a mut Vec<Diagnostic>,
    ) -> Self {
        Self {
            files,
            options,
            sources,
            problems,
            parameters: Parameters::new(&options.defines),
            versions: Vec::new(),
            folders: Vec::new(),
            scene_folder: PathBuf::new(),
            stack: Vec::new(),
            defaults: Vec::new(),
            later_includes: Vec::new(),
            root_depths: Vec::new(),
            repeats: Included::default(),
            incomplete: false,
            harmless: false,
        }
    }

    /// Reads and expands the scene at `path`. `None` when there is no tree to go on with.
    pub fn scene(mut self, path: &Path) -> Option<Expanded> {
        self.scene_folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let root = self.file(path, None, 0)?;
        if let Some(problem) = foreign::of_another_program(&root) {
            // Nothing else about the file matters then.
            self.problems.clear();
            self.problems.push(problem);
            return None;
        }
        if root.tag != "scene" {
            let mut problem = Diagnostic::error(
                format!("a scene file begins with <scene>, not <{}>", root.tag),
                Some(root.tag_span),
            );
            if is_object_tag(&root.tag) {
                problem = problem.help("a single object can only be included by a scene");
            }
            self.problems.push(problem);
            return None;
        }
        if !self.incomplete {
            let policy = Policy { lenient: self.options.lenient };
            self.problems.extend(self.parameters.report_undefined(path, policy));
            self.problems.extend(self.parameters.unused());
        }
        let Self { versions, folders, incomplete, .. } = self;
        Some(Expanded { root, versions, folders, incomplete })
    }

    fn file(&mut self, path: &Path, from: Option<Span>, depth: usize) -> Option<Element> {
        let text = self.text(path).and_then(|text| {
            self.repeats.count(path, text.len())?;
            Ok(text)
        });
        let text = match text {
            Ok(text) => text,
            Err(reason) => {
                self.problems.push(Diagnostic::error(format!("{}: {reason}", path.display()), from));
                return None;
            }
        };
        let file = self.sources.add(path.to_path_buf(), text);
        let root = xml::parse(file, self.sources.text(file), self.problems);
        // Spans may point into a file without a tree; every file has a version.
        let inherited = self.versions.first().copied();
        self.versions.push(inherited.unwrap_or(Version(3, 0, 0)));
        let root = root?;
        let mut defaults = Vec::new();
        collect_defaults(&root, &mut defaults);
        self.defaults.push(defaults);
        self.stack.push((path.to_path_buf(), from));
        self.root_depths.push(depth);
        let names = root.children.iter().filter(|c| c.tag == "include").filter_map(|c| c.value("filename"));
        let folders = self.include_folders();
        self.later_includes.push(names.filter_map(|name| find(self.files, name, &folders)).collect());
        self.versions[file as usize] = self.version(&root, inherited);
        let mut out = Vec::new();
        self.element(root, depth, &mut out);
        self.stack.pop();
        self.root_depths.pop();
        self.defaults.pop();
        self.later_includes.pop();
        out.pop()
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        let bytes = as_declared(into_utf8(self.files.read(path).map_err(|e| e.to_string())?));
        if let Some(what) = misnamed::named(&bytes) {
            return Err(format!("it is {what}"));
        }
        if u32::try_from(bytes.len()).is_err() {
            return Err("a scene file must be smaller than 4 GiB".to_owned());
        }
        String::from_utf8(bytes)
            .map_err(|e| format!("not UTF-8 text at byte {}", e.utf8_error().valid_up_to()))
    }

    fn version(&mut self, root: &Element, inherited: Option<Version>) -> Version {
        let Some(attribute) = root.attribute("version") else {
            return inherited.unwrap_or_else(|| {
                let guess = Version::guess(root);
                if root.tag == "scene" {
                    let text = format!("<scene> has no version; read as {}.{}", guess.0, guess.1);
                    self.problems.push(Diagnostic::warning(text, Some(root.tag_span)).help(
                        "Mitsuba rejects this; add version=\"3.0.0\" or the version it was written for",
                    ));
                }
                guess
            });
        };
        let value = self.substituted(&attribute.value, attribute.value_span).unwrap_or_default();
        Version::parse(value.as_deref().unwrap_or(&attribute.value)).unwrap_or_else(|| {
            if value.is_some() || !attribute.value.contains('$') {
                let text =
                    format!("`{}` is not a version number", value.as_ref().unwrap_or(&attribute.value));
                self.problems.push(
                    Diagnostic::error(text, Some(attribute.value_span))
                        .help("write three numbers, as in 3.0.0"),
                );
            }
            inherited.unwrap_or_else(|| Version::guess(root))
        })
    }

    fn substituted(&mut self, text: &str, span: Span) -> Result<Option<String>, ()> {
        let before = (self.problems.len(), self.parameters.undefined_count());
        let result = self.substitute(text, span);
        if result.is_ok() || self.later_includes.iter().all(Vec::is_empty) {
            return result;
        }
        // Perhaps a file that is included further down defines it.
        self.problems.truncate(before.0);
        self.parameters.forget_undefined(before.1);
        for level in 0..self.later_includes.len() {
            for path in std::mem::take(&mut self.later_includes[level]) {
                let Some(root) = self.text(&path).ok().and_then(|text| xml::parse(0, &text, &mut Vec::new()))
                else {
                    continue;
                };
                collect_defaults(&root, &mut self.defaults[level]);
            }
        }
        self.substitute(text, span)
    }

    fn substitute(&mut self, text: &str, span: Span) -> Result<Option<String>, ()> {
        let defaults = &self.defaults;
        let later = |rest: &str| {
            let all = defaults.iter().rev().flatten().filter(|(name, _)| rest.starts_with(name.as_str()));
            all.max_by_key(|(name, _)| name.len()).cloned()
        };
        self.parameters.substitute(text, span, self.harmless, &later, self.problems)
    }

    fn element(&mut self, mut element: Element, depth: usize, out: &mut Vec<Element>) {
        if depth >= MAX_DEPTH {
            let text = format!("elements are nested more than {MAX_DEPTH} deep");
            self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
            return;
        }
        let outer = self.harmless;
        self.harmless |= Class::of_tag(&element.tag).is_some_and(|class| !changes_light(class));
        for attribute in &mut element.attributes {
            match self.substituted(&attribute.value, attribute.value_span) {
                Ok(Some(value)) => attribute.value = value,
                Ok(None) => {}
                Err(()) => element.broken = true,
            }
        }
        match element.tag.as_str() {
            "default" => {
                if let Some([name, value]) = self.required(&element, ["name", "value"]) {
                    self.parameters.default_value(&name, &value);
                }
            }
            "path" => self.path(&element, depth),
            "include" => self.include(&element, depth, out),
            _ => {
                for child in std::mem::take(&mut element.children) {
                    self.element(child, depth + 1, &mut element.children);
                }
                out.push(element);
            }
        }
        self.harmless = outer;
    }

    fn path(&mut self, element: &Element, depth: usize) {
        let Some([value]) = self.required(element, ["value"]) else { return };
        if self.root_depths.last().is_none_or(|root| depth != root + 1) {
            let text = "<path> is only allowed directly inside <scene>";
            self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
            return;
        }
        let value = value.replace('\\', "/");
        let folder = self.own_folder().join(&value);
        // Scenes share folders of meshes that stand beside theirs; an absolute path is for the user to allow.
        if Path::new(&value).is_relative() && self.files.declare(&folder) {
            let text = format!("meshes and pictures are read outside of the scene's folder, from `{value}`");
            self.problems.push(Diagnostic::warning(text, Some(element.place("value"))));
        }
        self.folders.insert(0, folder);
    }

    fn include(&mut self, element: &Element, depth: usize, out: &mut Vec<Element>) {
        let Some([name]) = self.required(element, ["filename"]) else { return };
        let span = element.place("filename");
        let folders = self.include_folders();
        let Some(path) = find(self.files, &name, &folders) else {
            self.incomplete = true;
            self.problems.push(not_found(self.files, "included file", &name, span, &folders));
            return;
        };
        if let Some(at) = self.stack.iter().position(|(open, _)| *open == path) {
            let mut chain: Vec<_> = self.stack[at..].iter().map(|(p, _)| p.display().to_string()).collect();
            chain.push(path.display().to_string());
            let mut problem = Diagnostic::error(format!("include cycle: {}", chain.join(" → ")), Some(span));
            for (_, from) in &self.stack[at + 1..] {
                problem.labels.extend(from.map(|from| (from, "through this".to_owned())));
            }
            self.problems.push(problem);
            return;
        }
        if self.stack.len() >= MAX_INCLUDE_DEPTH {
            let text = format!("files are included more than {MAX_INCLUDE_DEPTH} deep");
            self.problems.push(Diagnostic::error(text, Some(span)));
            return;
        }
        // Reported already.
        if self.repeats.is_full() {
            self.incomplete = true;
            return;
        }
        let Some(root) = self.file(&path, Some(span), depth) else {
            self.incomplete = true;
            return;
        };
        if root.tag == "scene" {
            out.extend(root.children);
        } else {
            out.push(root);
        }
    }

    fn include_folders(&self) -> Vec<PathBuf> {
        let own = [self.own_folder(), self.scene_folder.clone()];
        own.into_iter()
            .chain(self.folders.iter().cloned())
            .chain(self.options.search.iter().cloned())
            .collect()
    }

    fn own_folder(&self) -> PathBuf {
        let file = self.stack.last().map(|(path, _)| path.as_path());
        file.and_then(Path::parent).unwrap_or(Path::new("")).to_path_buf()
    }

    /// Values of all of `names`; reports what is missing or superfluous.
    fn required<const N: usize>(&mut self, element: &Element, names: [&str; N]) -> Option<[String; N]> {
        check_attributes(element, &names, self.problems);
        if element.broken {
            return None;
        }
        let mut missing = false;
        let values = names.map(|name| match element.value(name) {
            Some(value) => value.to_owned(),
            None => {
                let text = format!("<{}> needs the attribute `{name}`", element.tag);
                self.problems.push(Diagnostic::error(text, Some(element.tag_span)));
                missing = true;
                String::new()
            }
        });
        (!missing).then_some(values)
    }
}

/// Reports attributes of `element` other than `allowed`.
pub(super) fn check_attributes(element: &Element, allowed: &[&str], problems: &mut Vec<Diagnostic>) {
    for attribute in &element.attributes {
        if !allowed.contains(&attribute.name.as_str()) {
            let text = format!("unexpected attribute `{}` of <{}>", attribute.name, element.tag);
            let problem = Diagnostic::error(text, Some(attribute.name_span));
            problems.push(problem.suggest_or(&attribute.name, allowed.iter().copied(), || {
                format!("it takes: {}", allowed.join(", "))
            }));
        }
    }
}

fn collect_defaults(element: &Element, out: &mut Vec<(String, String)>) {
    if element.tag == "default"
        && let (Some(name), Some(value)) = (element.value("name"), element.value("value"))
    {
        out.push((name.to_owned(), value.to_owned()));
    }
    element.children.iter().for_each(|child| collect_defaults(child, out));
}

fn is_object_tag(tag: &str) -> bool {
    Class::of_tag(tag).is_some()
}
