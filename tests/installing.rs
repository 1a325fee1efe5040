//! What comes with an installed program: completions, man pages, `--version`, and the recipe for continuous integration.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use caustica_formats::image::write_pfm;

fn caustica(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_caustica")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The first words of the lines below `Commands:`, without `help`.
fn commands() -> Vec<String> {
    let help = caustica(&["--help"]);
    let list = help.split("Commands:\n").nth(1).unwrap().lines().take_while(|l| !l.trim().is_empty());
    let names: Vec<String> = list.filter_map(|l| Some(l.split_whitespace().next()?.to_owned())).collect();
    assert!(names.len() >= 7, "{help}");
    names.into_iter().filter(|name| name != "help").collect()
}

/// Every `--option` in a text.
fn options(text: &str) -> BTreeSet<String> {
    let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let name = |rest: &str| rest.chars().take_while(|c| is_part(*c)).collect::<String>();
    let all = text.match_indices("--").map(|(at, _)| name(&text[at + 2..]));
    all.filter(|name| name.starts_with(|c: char| c.is_ascii_lowercase())).collect()
}

/// Options that a command declares: those that begin a line of its help.
fn declared(command: &str) -> BTreeSet<String> {
    let help = caustica(&[command, "--help"]);
    let heads = help.lines().map(str::trim_start).filter(|l| l.starts_with('-'));
    heads.flat_map(|l| options(l.split("  ").next().unwrap())).collect()
}

/// Runs a program with this text on stdin; `None` if it is not installed.
fn fed(program: &str, arguments: &[&str], text: &str) -> Option<(bool, String)> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let Ok(mut child) = command.spawn() else {
        println!("skipped: {program} is not installed");
        return None;
    };
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    Some((output.status.success(), String::from_utf8_lossy(&said).into_owned()))
}

#[test]
fn completions_of_every_shell_know_every_command_and_option() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = caustica(&["completions", shell]);
        for command in commands() {
            assert!(script.contains(&command), "{shell}: {command}");
            for option in declared(&command) {
                let found = match shell {
                    "fish" => [' ', '\n'].iter().any(|end| script.contains(&format!("-l {option}{end}"))),
                    _ => script.contains(&format!("--{option}")),
                };
                assert!(found, "{shell}: {command} --{option}");
            }
        }
        let check: &[&str] = match shell {
            "bash" | "zsh" => &["-n"],
            // It complains about words while it runs them.
            "fish" => &["--no-config"],
            _ => continue,
        };
        if let Some((valid, said)) = fed(shell, check, &script) {
            assert!(valid && said.is_empty(), "{shell}: {said}");
        }
    }
}

/// Fish and zsh write the help of a value between double quotes, whose generator lets everything through.
#[test]
fn the_help_of_values_has_nothing_that_ends_a_quotation() {
    let script = caustica(&["completions", "fish"]);
    let mut values = 0;
    for (value, help) in script.lines().filter_map(|line| line.split_once("\\t'")) {
        values += 1;
        // The last value of an option ends with the quotation.
        let help = help.strip_suffix("'\"").or(help.strip_suffix('\'')).unwrap();
        let breaks = help.contains(['"', '$', '`']) || help.replace("\\'", "").contains(['\'', '\\']);
        assert!(!breaks, "{value}: {help}");
    }
    assert!(values > 5, "{script}");
}

/// Bash completes the name of a command, an option, and the values of an option.
#[test]
fn bash_completes() {
    let script = caustica(&["completions", "bash"]);
    for (words, expected) in [
        (&["rend"][..], "render"),
        (&["render", "--spectral-to"], "--spectral-to-rgb"),
        (&["compare", "--variance-of", "sa"], "sample"),
        (&["completions", "powers"], "powershell"),
        (&["render", "--integrator", "pa"], "path"),
        (&["inspect", "--mode", "cl"], "classic"),
        (&["render", "--filter", "gau"], "gaussian"),
        (&["render", "--layers", "alb"], "albedo"),
        // Not the files of the folder.
        (&["render", "--max-depth", "C"], "C"),
    ] {
        let (last, before) = (words[words.len() - 1], words[..words.len() - 1].last().unwrap_or(&"caustica"));
        let line = words.join(" ");
        let test = format!(
            "{script}\ncompopt() {{ :; }}\nCOMP_WORDS=(caustica {line})\nCOMP_CWORD={}\n_caustica caustica '{last}' '{before}'\n\
             printf '%s\\n' \"${{COMPREPLY[@]}}\"\n",
            words.len()
        );
        let Some((_, said)) = fed("bash", &["--norc"], &test) else { return };
        assert_eq!(said.trim(), expected, "{line}");
    }
}

#[test]
fn man_pages_name_every_option() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share/man1");
    caustica(&["man", pages.to_str().unwrap()]);
    let read = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap().replace("\\-", "-");
    let whole = read("caustica.1");
    for command in commands() {
        assert!(whole.contains(&format!("caustica-{command}(1)")), "{command}: {whole}");
        let page = read(&format!("caustica-{command}.1"));
        let title = format!(".TH caustica-{command} 1  \"caustica {}\"", env!("CARGO_PKG_VERSION"));
        assert!(page.contains(&title), "{page}");
        let (named, missing) = (options(&page), declared(&command));
        let missing: Vec<_> = missing.difference(&named).collect();
        assert!(missing.is_empty(), "caustica-{command}.1 lacks {missing:?}");
    }
    let page = read("caustica-render.1");
    assert!(page.contains(".SH SYNOPSIS\n\\fBcaustica render\\fR [OPTIONS] [SCENE]\n"), "{page}");
    let version = whole.split(".SH VERSION\n").nth(1).unwrap().lines().next();
    assert_eq!(version, Some(concat!("v", env!("CARGO_PKG_VERSION"))), "{whole}");
    assert!(!whole.contains("opt-level"), "{whole}");
    let plain = folder.path().join("plain");
    std::fs::write(&plain, "").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_caustica")).arg("man").arg(&plain).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said.starts_with("error: cannot write man pages into `"), "{said}");
}

#[test]
fn version_tells_the_build() {
    assert_eq!(caustica(&["-V"]), format!("caustica {}\n", env!("CARGO_PKG_VERSION")));
    let text = caustica(&["--version"]);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(&*format!("caustica {}", env!("CARGO_PKG_VERSION"))));
    let rows: Vec<(&str, &str)> = lines.filter_map(|l| l.split_once(' ')).collect();
    assert_eq!(rows.iter().map(|r| r.0).collect::<Vec<_>>(), ["commit", "build", "features", "SIMD"]);
    let row = |name: &str| rows.iter().find(|r| r.0 == name).unwrap().1.trim();
    assert!(!row("commit").is_empty());
    assert!(row("build").contains("opt-level") && row("build").contains("rustc"), "{text}");
    let level = row("SIMD").split(';').next().unwrap();
    #[cfg(target_arch = "x86_64")]
    assert_eq!(level != "portable", is_x86_feature_detected!("avx2"), "{text}");
    assert!(["AVX-512", "AVX2", "portable"].contains(&level), "{text}");
}

/// The command of the workflow in the documents, on pictures of which one is wrong.
#[test]
fn the_recipe_of_the_documents_finds_a_wrong_picture() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/compare-and-bench.md");
    let page = std::fs::read_to_string(page).unwrap();
    let recipe = page.split("```").skip(1).step_by(2).find(|block| block.starts_with("yaml")).unwrap();
    assert_eq!(recipe.trim().lines().count(), 11, "ten lines below the name of the language");
    let command = recipe.lines().find_map(|l| l.split_once("run: caustica ")).unwrap().1;
    let folder = tempfile::tempdir().unwrap();
    for (name, value) in [("out/a", 0.5), ("out/b", 0.9), ("references/a", 0.5), ("references/b", 0.5)] {
        let path = folder.path().join(name).with_extension("pfm");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        write_pfm(&path, 8, 8, &[value; 64]).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(command.split_whitespace())
        .current_dir(folder.path())
        .env("GITHUB_WORKSPACE", folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stdout).unwrap();
    let annotation = said.lines().find(|l| l.starts_with("::")).unwrap();
    assert!(annotation.starts_with("::error file=references/b.pfm,title=b::out/b.pfm against "), "{said}");
    let junit = std::fs::read_to_string(folder.path().join("junit.xml")).unwrap();
    assert!(junit.contains("tests=\"2\" failures=\"1\" errors=\"0\""), "{junit}");
    assert!(folder.path().join("report.html").is_file());
}
