//! A Python that has Mitsuba: the one given, or a virtual environment that is made when it is first needed.

use crate::bench::error::BenchError;
use crate::bench::process::{self, Watch};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The version to install.
const MITSUBA: &str = "3.9.1";

#[derive(Clone, Debug)]
pub struct Python {
    pub program: PathBuf,
    /// Where a virtual environment may be made; `None` if the program was given.
    venv: Option<PathBuf>,
}

impl Python {
    /// The given program; else `python3`, until [`Self::missing`] finds that it lacks Mitsuba.
    pub fn new(given: Option<&Path>) -> Self {
        match given {
            Some(program) => Self { program: program.to_path_buf(), venv: None },
            None => Self { program: PathBuf::from("python3"), venv: cache().map(|c| c.join("mitsuba")) },
        }
    }

    /// Why a variant of Mitsuba cannot be used; `None` if it can. Installs Mitsuba unless the program was
    /// given.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn missing(&mut self, variant: &str, out: &mut dyn Write) -> Result<Option<String>, BenchError> {
        let first = match self.try_variant(variant) {
            Ok(()) => return Ok(None),
            Err(why) => why,
        };
        let Some(venv) = self.venv.take() else { return Ok(Some(first)) };
        let ours = Self { program: venv.join("bin/python"), venv: None };
        if !ours.program.is_file() || !ours.imports() {
            writeln!(out, "installing mitsuba {MITSUBA} into {} (once)", venv.display())?;
            out.flush()?;
            if let Err(e) = install(&self.program, &venv) {
                return Ok(Some(format!(
                    "{first}, and it could not be installed ({e}); give a Python that has it with --python PATH"
                )));
            }
        }
        *self = ours;
        Ok(self.try_variant(variant).err())
    }

    fn imports(&self) -> bool {
        Command::new(&self.program).args(["-c", "import mitsuba"]).output().is_ok_and(|o| o.status.success())
    }

    fn try_variant(&self, variant: &str) -> Result<(), String> {
        let job = serde_json::json!({ "variant": variant, "check": true }).to_string();
        let python = self.program.display();
        match Command::new(&self.program).arg("-c").arg(SCRIPT).arg(job).output() {
            Ok(out) if out.status.success() => Ok(()),
            Ok(out) => {
                let said = String::from_utf8_lossy(&out.stderr);
                let why = said.lines().rfind(|l| !l.trim().is_empty()).unwrap_or("no message");
                let llvm = if variant.starts_with("llvm") {
                    ", and LLVM with `apt-get install libllvm19`"
                } else {
                    ""
                };
                Err(format!(
                    "`{python}` cannot use Mitsuba's {variant} ({}); install it with `{python} -m pip install \
                     mitsuba=={MITSUBA}`{llvm}",
                    why.trim()
                ))
            }
            Err(e) => {
                Err(format!("cannot start `{python}` ({e}); install python3, or give one with --python PATH"))
            }
        }
    }
}

/// The script that renders a job; with `check` in the job it only tests the variant.
pub const SCRIPT: &str = include_str!("mitsuba.py");

fn install(python: &Path, venv: &Path) -> Result<(), BenchError> {
    process::run(Command::new(python).args(["-m", "venv", "--clear"]).arg(venv), &Watch::default())?;
    let packages = [format!("mitsuba=={MITSUBA}"), "numpy".to_owned()];
    let mut pip = Command::new(venv.join("bin/python"));
    process::run(pip.args(["-m", "pip", "install", "--quiet"]).args(packages), &Watch::default())?;
    Ok(())
}

/// The cache folder of this program.
fn cache() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base = set("XDG_CACHE_HOME").or_else(|| set("HOME").map(|home| home.join(".cache")))?;
    Some(base.join("caustica"))
}
