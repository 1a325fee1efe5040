//! The import graph of files has no cycle but those of parent and child modules.

use std::collections::{BTreeMap, BTreeSet};

use crate::tidy::{product, sources};

/// Source folders that are checked; each is the root of a crate.
const CHECKED: &[&str] = &["formats/src", "python/src", "tools/src", "src"];

/// Module path from the root of its crate.
type Module = Vec<String>;

/// `use` declarations of a module: the name each makes, its path, and whether it is visible outside.
struct Import {
    name: String,
    path: Vec<String>,
    public: bool,
}

struct Graph {
    texts: BTreeMap<Module, String>,
    imports: BTreeMap<Module, Vec<Import>>,
}

/// Without comments, and with string literals emptied.
fn code(text: &str) -> String {
    let mut out = String::new();
    for line in product(text).lines().filter(|line| !line.trim_start().starts_with("//")) {
        let line = line.split(" // ").next().unwrap_or(line);
        let outside = line.split('"').step_by(2);
        outside.for_each(|part| out.push_str(part));
        out.push('\n');
    }
    out
}

fn segments(path: &str) -> Vec<String> {
    path.split("::").map(str::trim).filter(|s| !s.is_empty()).map(str::to_owned).collect()
}

/// The leaves of a `use` tree.
fn leaves(prefix: &[String], tree: &str, public: bool, out: &mut Vec<Import>) {
    let tree = tree.trim();
    if let Some((before, list)) = tree.split_once('{') {
        let prefix = [prefix, &segments(before)].concat();
        let list = list.trim_end().strip_suffix('}').unwrap_or(list);
        let (mut depth, mut start) = (0, 0);
        for (at, c) in list.char_indices().chain([(list.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    leaves(&prefix, &list[start..at], public, out);
                    start = (at + 1).min(list.len());
                }
                _ => {}
            }
        }
    } else if !tree.is_empty() {
        let (path, renamed) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path = [prefix, &segments(path)].concat();
        path.pop_if(|last| last == "self");
        let name = if renamed.is_empty() { path.last().cloned() } else { Some(renamed.trim().to_owned()) };
        out.push(Import { name: name.unwrap_or_default(), path, public });
    }
}

fn imports_of(code: &str) -> Vec<Import> {
    let mut found = Vec::new();
    for statement in code.split(';') {
        let Some(at) = statement.rfind("use ") else { continue };
        let visibility = statement[..at].lines().last().unwrap_or_default().trim();
        if !visibility.is_empty() && !visibility.starts_with("pub") {
            continue;
        }
        leaves(&[], &statement[at + 4..], visibility.starts_with("pub"), &mut found);
    }
    found
}

/// Paths in the code that start with `crate`, `super` or `self`, or with a child module.
fn paths_of(code: &str, is_child: impl Fn(&str) -> bool) -> Vec<Vec<String>> {
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let paths = code.split(|c| !word(c)).filter(|path| path.contains("::")).map(segments);
    let inside = |path: &Vec<String>| match path.first().map(String::as_str) {
        Some("crate" | "super" | "self") => true,
        Some(first) => is_child(first),
        None => false,
    };
    paths.filter(inside).collect()
}

impl Graph {
    fn of(folder: &str) -> Self {
        let mut graph = Self { texts: BTreeMap::new(), imports: BTreeMap::new() };
        for source in sources() {
            let Some(inside) = source.path.strip_prefix(folder).and_then(|path| path.strip_prefix('/'))
            else {
                continue;
            };
            let mut module: Module = inside.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
            module.pop_if(|last| matches!(last.as_str(), "mod" | "lib" | "main"));
            let code = code(&source.text);
            graph.imports.entry(module.clone()).or_default().extend(imports_of(&code));
            graph.texts.entry(module).or_default().push_str(&code);
        }
        graph
    }

    fn has(&self, module: &[String]) -> bool {
        self.texts.contains_key(module)
    }

    /// The module that `path`, as written in `from`, leads to: the one that defines what it names.
    fn target(&self, from: &[String], path: &[String]) -> Option<Module> {
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (Vec::new(), &path[1..]),
            "super" => (from[..from.len().checked_sub(1)?].to_vec(), &path[1..]),
            "self" => (from.to_vec(), &path[1..]),
            first if self.has(&[from, &[first.to_owned()]].concat()) => (from.to_vec(), path),
            _ => return None,
        };
        for _ in 0..100 {
            let Some(name) = rest.first() else { break };
            let child = [&at[..], std::slice::from_ref(name)].concat();
            if name == "super" {
                at.pop();
                rest = &rest[1..];
            } else if self.has(&child) {
                at = child;
                rest = &rest[1..];
            } else {
                // What a parent passes on is its child's.
                let passed = self.imports[&at].iter().find(|import| import.public && import.name == *name);
                return match passed {
                    Some(import) => self.target(&at, &import.path).or(Some(at)),
                    None => Some(at),
                };
            }
        }
        Some(at)
    }

    /// The files that each file imports, without its own ancestors.
    fn edges(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let edges = self.texts.iter().map(|(module, code)| {
            let is_child = |name: &str| self.has(&[&module[..], &[name.to_owned()]].concat());
            let paths = paths_of(code, is_child);
            let all = paths.iter().chain(self.imports[module].iter().map(|import| &import.path));
            let targets = all.filter_map(|path| self.target(module, path));
            (module, targets.filter(|target| !module.starts_with(target)).collect())
        });
        edges.collect()
    }
}

/// A way from `start` back to it, if there is one.
fn cycle(edges: &BTreeMap<&Module, BTreeSet<Module>>, start: &Module) -> Option<Vec<Module>> {
    let mut before: BTreeMap<&Module, &Module> = BTreeMap::new();
    let mut open = vec![start];
    while let Some(module) = open.pop() {
        for next in edges.get(module).into_iter().flatten() {
            if before.contains_key(next) {
                continue;
            }
            before.insert(next, module);
            if next == start {
                let mut way = vec![start.clone()];
                let mut at = before[start];
                while at != start {
                    way.push(at.clone());
                    at = before[at];
                }
                way.push(start.clone());
                way.reverse();
                return Some(way);
            }
            open.push(next);
        }
    }
    None
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let mut circles = Vec::new();
    for folder in CHECKED {
        let graph = Graph::of(folder);
        let edges = graph.edges();
        assert!(
            edges.values().map(BTreeSet::len).sum::<usize>() > edges.len(),
            "{folder}: imports are found"
        );
        for module in edges.keys() {
            if let Some(way) = cycle(&edges, module) {
                let names: Vec<String> = way.iter().map(|m| m.join("/")).collect();
                circles.push(format!("{folder}: {}", names.join(" -> ")));
            }
        }
    }
    assert!(circles.is_empty(), "files that import each other:\n{}", circles.join("\n"));
}

#[test]
fn paths_lead_to_the_file_that_defines_what_they_name() {
    let files: [(&[&str], &str); 4] = [
        (&[], "pub mod a;\nmod b;\npub use a::one::{Thing, other as Renamed};"),
        (&["a"], "mod one;\npub use one::Thing;\nuse crate::b::{self, deep::{x}};"),
        (&["a", "one"], "use super::super::b::y;\nfn f() { super::super::b::z(); super::g(); }"),
        (&["b"], "use crate::Renamed;\nuse crate::a::Thing;"),
    ];
    let module = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Module>();
    let graph = Graph {
        texts: files.iter().map(|(m, text)| (module(m), code(text))).collect(),
        imports: files.iter().map(|(m, text)| (module(m), imports_of(&code(text)))).collect(),
    };
    let edges = graph.edges();
    let of = |names: &[&str]| edges[&module(names)].iter().map(|m| m.join("/")).collect::<Vec<_>>();
    assert_eq!(of(&[]), ["a/one"]);
    assert_eq!(of(&["a"]), ["a/one", "b"]);
    assert_eq!(of(&["a", "one"]), ["b"], "its parent does not count");
    assert_eq!(of(&["b"]), ["a/one"]);
    let found = cycle(&edges, &module(&["b"])).map(|way| way.len());
    assert_eq!(found, Some(3), "b, a/one and b again");
    assert_eq!(cycle(&edges, &module(&[])), None);
}
