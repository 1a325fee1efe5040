//! The generated parts of the documents: the support tables and the table of settings say what the code says.
//! `CAUSTICA_BLESS=1 cargo test --test suite readme` writes them anew.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use caustica_formats::language::LANGUAGES;
use caustica_formats::{Concept, Support};

const BEGIN: &str = "<!-- made by tests/readme.rs -->\n";
const END: &str = "<!-- end -->\n";

/// The text between the marks of `page` is `right`.
fn check(page: &str, right: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    let text = fs::read_to_string(&path).expect("the page can be read");
    let (before, rest) = text.split_once(BEGIN).expect("the page has the first mark");
    let (found, after) = rest.split_once(END).expect("the page has the last mark");
    if std::env::var_os("CAUSTICA_BLESS").is_some() {
        fs::write(&path, [before, BEGIN, right, END, after].concat()).expect("the page can be written");
    } else {
        assert_eq!(found, right, "{page}: run CAUSTICA_BLESS=1 cargo test --test suite readme");
    }
}

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

#[test]
fn the_support_tables_are_what_the_code_says() {
    let right: Vec<String> = LANGUAGES.iter().map(|l| table(l.name, &(l.support)())).collect();
    check("docs/support.md", &right.join("\n"));
}

#[test]
fn the_table_of_settings_is_what_the_program_prints() {
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(["render", "--help-settings"])
        .output()
        .expect("the program starts");
    let help = String::from_utf8(output.stdout).expect("the help is text");
    let (rows, kernels) = help.split_once("\n\n").expect("the kernels follow the settings");
    let mut right = String::from("| setting | default | value | meaning |\n|---|---|---|---|\n");
    for row in rows.lines() {
        let (name, rest) = row.split_once(' ').expect("a name");
        let (meaning, rest) = rest.rsplit_once(" [").expect("the value in brackets");
        let (value, default) = rest.split_once("; default ").expect("a default");
        let default = default.trim_end_matches(']');
        writeln!(right, "| `{name}` | `{default}` | {value} | {} |", meaning.trim())
            .expect("a string takes all");
    }
    let names: Vec<String> =
        kernels.trim().trim_start_matches("kernels: ").split(", ").map(|name| format!("`{name}`")).collect();
    writeln!(right, "\nKernels: {}.", names.join(", ")).expect("a string takes all");
    check("docs/settings.md", &right);
}

#[test]
fn the_readme_is_short() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md"));
    let lines = text.expect("the README can be read").lines().count();
    assert!(lines <= 150, "README.md has {lines} lines; 150 is the limit: move the details to docs/");
}
