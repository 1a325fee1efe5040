//! What `caustica --version` tells of a build: profile, target, compiler, features, commit.

// The way to talk to cargo.
#![allow(clippy::print_stdout)]

use std::env;
use std::path::Path;
use std::process::Command;

/// What is compiled into the program.
const SOURCES: [&str; 6] = ["build.rs", "Cargo.toml", "Cargo.lock", "src", "formats", "tools"];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CAUSTICA_COMMIT");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let (profile, level) = (variable("PROFILE"), variable("OPT_LEVEL"));
    let rustc = output(&variable("RUSTC"), &["--version"]).unwrap_or_else(|| "rustc unknown".to_owned());
    let features: Vec<String> = env::vars()
        .filter_map(|(name, _)| Some(name.strip_prefix("CARGO_FEATURE_")?.to_lowercase().replace('_', "-")))
        .filter(|name| name != "default")
        .collect();
    println!("cargo:rustc-env=CAUSTICA_BUILD={profile}, opt-level {level}, {}, {rustc}", variable("TARGET"));
    println!("cargo:rustc-env=CAUSTICA_FEATURES={}", features.join(", "));
    println!("cargo:rustc-env=CAUSTICA_COMMIT={}", commit(&profile));
}

/// The commit given by a packager, or that of the repository, and whether the sources differ from it. Debug builds
/// have none, as they would be made anew after each commit.
fn commit(profile: &str) -> String {
    if let Some(given) = env::var("CAUSTICA_COMMIT").ok().filter(|given| !given.is_empty()) {
        return given;
    }
    if profile != "release" {
        return "not recorded in debug builds".to_owned();
    }
    repository_commit().unwrap_or_else(|| "unknown".to_owned())
}

fn repository_commit() -> Option<String> {
    // Sources may lie unpacked within another repository.
    let root = output("git", &["rev-parse", "--show-toplevel"])?;
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().ok()?;
    if Path::new(&root).canonicalize().ok()? != here {
        return None;
    }
    for changing in ["logs/HEAD", "HEAD"] {
        let path = output("git", &["rev-parse", "--git-path", changing])?;
        if Path::new(&path).exists() {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    SOURCES.iter().for_each(|source| println!("cargo:rerun-if-changed={source}"));
    let commit = output("git", &["log", "-1", "--format=%h, %cs", "--abbrev=12"])?;
    let changed = Command::new("git").args(["diff", "--quiet", "HEAD", "--"]).args(SOURCES).status().ok()?;
    Some(if changed.success() { commit } else { format!("{commit}, with changes") })
}

/// What a program prints, if it succeeds.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok().filter(|o| o.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
