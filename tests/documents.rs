//! What the documents name exists: files, folders, symbols in files, link targets.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The documents for people, relative to the workspace.
fn documents() -> Vec<String> {
    let mut pages: Vec<String> = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(str::to_owned).to_vec();
    pages.extend(
        ["tools/converted/README.md", "tools/references/README.md", "tools/studies/README.md"]
            .map(str::to_owned),
    );
    let entries = fs::read_dir(root().join("docs")).expect("docs can be read");
    let names = entries.map(|e| e.expect("docs can be read").file_name().to_string_lossy().into_owned());
    pages.extend(names.filter(|n| n.ends_with(".md")).map(|n| format!("docs/{n}")));
    pages.sort();
    pages
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap_or_else(|e| panic!("{page}: {e}"))
}

/// Text without fenced blocks.
fn prose(text: &str) -> String {
    text.split("```").step_by(2).collect::<Vec<_>>().join("\n")
}

/// `a/{b,c}/d` is `a/b/d` and `a/c/d`.
fn expanded(path: &str) -> Vec<String> {
    let Some((before, rest)) = path.split_once('{') else { return vec![path.to_owned()] };
    let Some((names, after)) = rest.split_once('}') else { return vec![path.to_owned()] };
    names.split(',').map(|name| format!("{before}{}{after}", name.trim())).collect()
}

/// Whether a text in backquotes is meant as a path of the workspace: it ends like one of our files, or begins with
/// one of our folders. What a build makes is not checked.
fn is_path(text: &str) -> bool {
    let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || "./_-{},".contains(c));
    let folder = text.split('/').next().is_some_and(|first| root().join(first).is_dir());
    plain && (text.ends_with(".rs") || (text.contains('/') && folder)) && !text.starts_with("target/")
}

/// The file or folder, or for `folder/NAME.rs` the folder in which a new one goes.
fn place(path: &str) -> PathBuf {
    let path = path.split_once("NAME").map_or(path, |(folder, _)| folder);
    root().join(path)
}

/// Parts of a symbol such as `kernel!` or `Output::{check, write}`.
fn words(symbol: &str) -> Vec<&str> {
    symbol.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect()
}

fn has_word(text: &str, word: &str) -> bool {
    let joins = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    text.match_indices(word).any(|(at, _)| {
        !joins(text[..at].chars().next_back()) && !joins(text[at + word.len()..].chars().next())
    })
}

/// Everything in `text` that does not exist; links are relative to `folder`.
fn missing(text: &str, folder: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    let pieces: Vec<&str> = text.split('`').collect();
    // Every other piece is in backquotes; `file`: `symbol`, `symbol` belong together.
    let mut file: Option<&str> = None;
    for (i, piece) in pieces.iter().enumerate().skip(1).step_by(2) {
        let before = pieces[i - 1];
        let belongs = before == ": " || before == ", ";
        if is_path(piece) {
            for path in expanded(piece).iter().filter(|p| !place(p).exists()) {
                wrong.push(format!("there is no {path}"));
            }
            file = Some(piece);
        } else if let Some(path) = file.filter(|p| belongs && p.ends_with(".rs")) {
            let source = fs::read_to_string(place(path)).unwrap_or_default();
            for word in words(piece).into_iter().filter(|w| !has_word(&source, w)) {
                wrong.push(format!("there is no {word} in {path}"));
            }
        }
        // A symbol that follows something else than a file and its symbols belongs to none.
        if !belongs && !is_path(piece) {
            file = None;
        }
    }
    for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let target = link.split('#').next().unwrap_or_default();
        if !target.is_empty() && !target.contains("://") && !folder.join(target).exists() {
            wrong.push(format!("the link to {link} leads nowhere"));
        }
    }
    wrong
}

#[test]
fn every_path_and_symbol_in_the_documents_exists() {
    let mut wrong = Vec::new();
    for page in documents() {
        let folder = root().join(&page).parent().expect("a page is in a folder").to_path_buf();
        wrong.extend(missing(&prose(&read(&page)), &folder).iter().map(|what| format!("{page}: {what}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_file_in_the_drawing_exists() {
    let drawing = read("docs/architecture.svg");
    let labels = drawing.split("<text class=\"file\"").skip(1);
    let files: Vec<&str> = labels.filter_map(|l| l.split('>').nth(1)?.split('<').next()).collect();
    assert!(files.len() > 20, "the drawing names files: {files:?}");
    let wrong: Vec<_> = files.iter().filter(|f| !root().join(f).is_file()).collect();
    assert!(wrong.is_empty(), "docs/architecture.svg: there is no {wrong:?}");
}

#[test]
fn what_is_gone_is_found() {
    let text = "See `tests/documents.rs`: `missing`, `is_path` and [a](README.md), [b](none.md), `src/none.rs`, \
                `tests/{documents,none}.rs`, `tests/NAME.rs` with `a::b` in `--set`, `other.rs`.";
    assert_eq!(
        missing(text, root()),
        [
            "there is no src/none.rs",
            "there is no tests/none.rs",
            "there is no other.rs",
            "the link to none.md leads nowhere",
        ]
    );
    // Put together here, so that this file does not contain it.
    let symbol = concat!("van", "ished");
    assert_eq!(
        missing(&format!("`tests/documents.rs`: `missing`, `{symbol}`"), root()),
        [format!("there is no {symbol} in tests/documents.rs")]
    );
}
