//! Limits of size: lines of a function, and how deep blocks nest in it.
//!
//! Product code only: items under `#[cfg(test)]` do not count. A function's lines run from its first keyword to
//! its closing brace; documentation and attributes above it are free. Nesting is what indentation shows: the body
//! of a function is at depth 0, and every block and every `match` in it adds one. What macros are given, or make,
//! is not looked into.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use super::sources;

const FUNCTION_LINES: usize = 80;
const NESTING: usize = 5;

/// What is above a limit in one file.
#[derive(Default)]
struct Measure {
    found: Vec<String>,
    /// Blocks around the visited place, within its function.
    depth: usize,
    /// Greatest depth since the function began, and its line.
    deepest: (usize, usize),
}

fn only_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        a.path().is_ident("cfg") && a.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Mod(i) => &i.attrs,
        syn::Item::Fn(i) => &i.attrs,
        syn::Item::Impl(i) => &i.attrs,
        syn::Item::Use(i) => &i.attrs,
        syn::Item::Const(i) => &i.attrs,
        _ => &[],
    }
}

/// First and last line of a piece of syntax, from 1.
fn lines(span: proc_macro2::Span) -> (usize, usize) {
    (span.start().line, span.end().line)
}

impl Measure {
    /// Visits what adds one to the depth.
    fn deeper(&mut self, line: usize, visit: impl FnOnce(&mut Self)) {
        self.depth += 1;
        if self.depth > self.deepest.0 {
            self.deepest = (self.depth, line);
        }
        visit(self);
        self.depth -= 1;
    }

    fn function(&mut self, signature: &syn::Signature, body: &syn::Block) {
        let (first, last) = (lines(signature.span()).0, lines(body.span()).1);
        let (name, length) = (&signature.ident, last + 1 - first);
        if length > FUNCTION_LINES {
            self.found.push(format!("{name} (line {first}) has {length} lines"));
        }
        let outer = (self.depth, self.deepest);
        (self.depth, self.deepest) = (0, (0, first));
        for statement in &body.stmts {
            self.visit_stmt(statement);
        }
        let (depth, line) = self.deepest;
        if depth > NESTING {
            self.found.push(format!("{name} (line {first}) nests {depth} blocks at line {line}"));
        }
        (self.depth, self.deepest) = outer;
    }
}

impl<'a> Visit<'a> for Measure {
    fn visit_item(&mut self, item: &'a syn::Item) {
        if !only_for_tests(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_fn(&mut self, f: &'a syn::ItemFn) {
        self.function(&f.sig, &f.block);
    }

    fn visit_impl_item_fn(&mut self, f: &'a syn::ImplItemFn) {
        if !only_for_tests(&f.attrs) {
            self.function(&f.sig, &f.block);
        }
    }

    fn visit_trait_item_fn(&mut self, f: &'a syn::TraitItemFn) {
        if let Some(body) = &f.default {
            self.function(&f.sig, body);
        }
    }

    fn visit_block(&mut self, block: &'a syn::Block) {
        self.deeper(lines(block.span()).0, |inner| visit::visit_block(inner, block));
    }

    fn visit_expr_if(&mut self, e: &'a syn::ExprIf) {
        self.visit_expr(&e.cond);
        self.visit_block(&e.then_branch);
        // `else if` stands beside its `if`, as a block of its own would not.
        if let Some((_, otherwise)) = &e.else_branch {
            self.visit_expr(otherwise);
        }
    }

    fn visit_expr_match(&mut self, e: &'a syn::ExprMatch) {
        self.visit_expr(&e.expr);
        self.deeper(lines(e.span()).0, |inner| e.arms.iter().for_each(|arm| inner.visit_arm(arm)));
    }
}

/// What is above a limit in a file, each with its place.
fn measure(path: &str, text: &str) -> Vec<String> {
    let file = syn::parse_file(text).unwrap_or_else(|e| panic!("{path} cannot be parsed: {e}"));
    let mut measure = Measure::default();
    measure.visit_file(&file);
    measure.found.iter().map(|what| format!("{path}: {what}")).collect()
}

#[test]
fn functions_stay_short_and_shallow() {
    let folders = ["src/", "formats/src/", "tools/src/"];
    let product = |path: &str| folders.iter().any(|f| path.starts_with(f)) && !path.ends_with("/tests.rs");
    let wrong: Vec<String> =
        sources().iter().filter(|s| product(&s.path)).flat_map(|s| measure(&s.path, &s.text)).collect();
    assert!(
        wrong.is_empty(),
        "above the limits of {FUNCTION_LINES} lines and {NESTING} blocks deep:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_measure_counts_what_indentation_shows() {
    let text = r#"
        fn flat() {
            if a {} else if b {} else { "}}}}" };
        }
        fn deep(&self) {
            for x in y {
                while x {
                    match x {
                        _ => {
                            let f = |x| {
                                if x {}
                            };
                        }
                    }
                }
            }
        }
        #[cfg(test)]
        mod tests { fn long() { for a in b { for a in b { for a in b { for a in b { for a in b { if c {} } } } } } } }
    "#
    .replace("&self", "x: X");
    assert_eq!(measure("a.rs", &text), ["a.rs: deep (line 5) nests 6 blocks at line 11"]);
    let long = format!("fn long() {{\n{}}}\n", "a();\n".repeat(79));
    assert_eq!(measure("a.rs", &long), ["a.rs: long (line 1) has 81 lines"]);
    assert!(measure("a.rs", &long.replacen("a();\n", "", 1)).is_empty());
}
