//! The README's table of plugins is what the code's own tables say.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use caustica_formats::language::LANGUAGES;
use caustica_formats::{Concept, Support};

const BEGIN: &str = "<!-- made by tests/readme.rs -->\n";
const END: &str = "<!-- end -->\n";

fn table(language: &str, concepts: &[Concept]) -> String {
    let mut text =
        format!("| {language} | supported | approximated | refused by name |\n|---|---|---|---|\n");
    for concept in concepts {
        let names = |wanted: fn(&Support) -> Option<String>| {
            let cell: Vec<String> = concept
                .plugins
                .iter()
                .filter_map(|(name, support)| wanted(support).map(|how| format!("`{name}`{how}")))
                .collect();
            cell.join(", ")
        };
        let full = names(|s| (*s == Support::Full).then(String::new));
        let near = names(|s| match s {
            Support::Approximated(how) => Some(format!(" ({how})")),
            _ => None,
        });
        let refused = names(|s| (*s == Support::Refused).then(String::new));
        writeln!(text, "| {} | {full} | {near} | {refused} |", concept.name).expect("a string takes all");
    }
    text
}

/// `CAUSTICA_BLESS=1 cargo test --test suite readme` writes it anew.
#[test]
fn the_table_of_plugins_is_what_the_code_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let text = fs::read_to_string(&path).expect("the README");
    let (before, rest) = text.split_once(BEGIN).expect("the README has the first mark");
    let (found, after) = rest.split_once(END).expect("the README has the last mark");
    let right: Vec<String> = LANGUAGES.iter().map(|l| table(l.name, &(l.support)())).collect();
    let right = right.join("\n");
    if std::env::var_os("CAUSTICA_BLESS").is_some() {
        fs::write(&path, [before, BEGIN, &right, END, after].concat()).expect("the README can be written");
    } else {
        assert_eq!(found, right, "CAUSTICA_BLESS=1 cargo test --test suite readme");
    }
}
