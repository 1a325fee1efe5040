//! The Python package: installed by pip into an environment of its own, as by its users, and tested there. A named
//! trial for each file of `python/tests`; skipped by name where Python or its packages cannot be had.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};
use std::sync::OnceLock;

use libtest_mimic::{Arguments, Completion, Failed, Trial};

/// What the trials run in.
enum Environment {
    Ready(PathBuf),
    /// With the command that mends it.
    Missing(String),
    Broken(String),
}

fn main() -> ExitCode {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join("python/tests"))
        .expect("the tests of the package are there")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| name(path).starts_with("test_"))
        .collect();
    files.sort();
    let trials = files
        .into_iter()
        .map(|file| Trial::ignorable_test(format!("python::{}", name(&file)), move || tested(&file)));
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit_code()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn name(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn tested(file: &Path) -> Result<Completion, Failed> {
    static ENVIRONMENT: OnceLock<Environment> = OnceLock::new();
    let python = match ENVIRONMENT.get_or_init(prepared) {
        Environment::Ready(python) => python,
        Environment::Missing(why) => return Ok(Completion::ignored_with(why)),
        Environment::Broken(why) => return Err(why.into()),
    };
    let mut pytest = Command::new(python);
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]).arg(file);
    pytest.current_dir(root().join("python")).env("CAUSTICA", env!("CARGO_BIN_EXE_caustica"));
    let output = pytest.output()?;
    if output.status.success() { Ok(Completion::Completed) } else { Err(said(&output).into()) }
}

/// An environment in `target/` with the package as it is now, and what its tests need.
fn prepared() -> Environment {
    let folder = root().join("target/python");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if !python.is_file() {
        let made = Command::new("python3").args(["-m", "venv"]).arg(&folder).output();
        if !made.is_ok_and(|output| output.status.success()) {
            let install = "no Python with venv; install it with: apt-get install python3 python3-venv";
            return Environment::Missing(install.to_owned());
        }
    }
    // Where pip finds maturin.
    let own = python.parent().map(Path::to_path_buf);
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(own.into_iter().chain(std::env::split_paths(&others)))
        .expect("the path of the workspace can stand in PATH");
    let pip = |arguments: &[String]| {
        let mut pip = Command::new(&python);
        pip.env("PATH", &path);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(arguments);
        // Compiled as this test is, so that it shares what is compiled already.
        pip.env("CARGO_TARGET_DIR", root().join("target"))
            .env("MATURIN_PEP517_ARGS", "--profile dev --features as-in-tests");
        pip.current_dir(root()).output()
    };
    match pip(&requirements()) {
        Ok(output) if output.status.success() => {}
        Ok(output) => {
            let why = format!("packages cannot be installed by pip:\n{}", said(&output));
            // Where there is no network, nothing is wrong with the package.
            let known = std::env::var_os("CI").is_some();
            return if known { Environment::Broken(why) } else { Environment::Missing(why) };
        }
        Err(e) => return Environment::Broken(e.to_string()),
    }
    let package = ["--no-build-isolation", "--no-deps", "--force-reinstall", "./python"];
    match pip(&package.map(str::to_owned)) {
        Ok(output) if output.status.success() => Environment::Ready(python),
        Ok(output) => Environment::Broken(said(&output)),
        Err(e) => Environment::Broken(e.to_string()),
    }
}

/// What building, using and testing the package takes.
fn requirements() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("python/pyproject.toml")).expect("it can be read");
    let project: toml::Table = text.parse().expect("it is TOML");
    let list = |value: &toml::Value| -> Vec<String> {
        let words = value.as_array().into_iter().flatten();
        words.map(|word| word.as_str().expect("a requirement is text").to_owned()).collect()
    };
    let extras = project["project"]["optional-dependencies"].as_table().expect("there are extras");
    let mut all = list(&project["build-system"]["requires"]);
    all.extend(list(&project["project"]["dependencies"]));
    all.extend(extras.values().flat_map(list).filter(|word| !word.starts_with("caustica")));
    all
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}
