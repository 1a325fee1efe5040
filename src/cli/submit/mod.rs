//! `caustica submit`: a render as jobs of a scheduler. It writes scripts, which call `caustica render` for a range of
//! passes each, and `caustica merge` for the picture.

mod scripts;
mod tasks;

use std::path::{Path, PathBuf};
use std::process::Command;

use caustica_formats::image::atomic_write;
use clap::Args;

use self::scripts::Scripts;
use super::failure::Failure;
use super::picture::PictureArgs;
use super::report;
use super::scene::{SceneArgs, whole};
use super::threads::MAX_THREADS;
use crate::session::Error;

/// Arguments of `submit`.
#[derive(Debug, Args)]
pub struct SubmitArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    picture: PictureArgs,
    /// Write jobs for Slurm, the only scheduler so far
    #[arg(long, required = true)]
    slurm: bool,
    /// Tasks that the passes are divided among
    #[arg(long, value_name = "N", value_parser = whole, allow_negative_numbers = true)]
    jobs: u32,
    /// Threads of a task [default: those that the scheduler gives to it, or all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS), allow_negative_numbers = true)]
    threads: Option<u32>,
    /// Folder for scripts, parts and logs, which all machines share [default: SCENE-passes here]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Write the jobs for passes that no part in the folder holds
    #[arg(long)]
    missing: bool,
    /// Submit the jobs
    #[arg(long)]
    run: bool,
    /// Options of sbatch, after `--`
    #[arg(last = true, value_name = "SBATCH OPTION")]
    sbatch: Vec<String>,
}

/// Writes the jobs of a render, and submits them with `--run`. `given` are the options of the scene as they were given.
///
/// # Errors
/// When the scene cannot be rendered, the folder is in use, or a file cannot be written; with `--run`, when sbatch fails.
pub fn run(args: &SubmitArgs, given: &[String]) -> Result<u8, Failure> {
    let Some(passes) = args.scene.passes() else {
        return Err(Failure::Usage("say how many passes there are to be: --passes N".to_owned()));
    };
    let layers = args.picture.layers()?;
    let session = args.scene.open(false, layers)?;
    let folder = args.folder.clone().unwrap_or_else(|| PathBuf::from(format!("{}-passes", session.name())));
    std::fs::create_dir_all(&folder)
        .map_err(|e| format!("cannot make the folder `{}`: {e}", folder.display()))?;
    let folder = absolute(&folder)?;
    let parts = tasks::parts(&folder)?;
    if !args.missing && !parts.is_empty() {
        return Err(Failure::Usage(format!(
            "`{}` holds parts already: --missing makes the job for what is absent, --folder names another place",
            folder.display()
        )));
    }
    let tasks = tasks::tasks(&parts, &session, passes, args.jobs)?;
    let output = args.picture.output(&session.info());
    output.check(&session, &[])?;
    let scripts = Scripts {
        program: std::env::current_exe().map_err(|e| format!("cannot find this program's file: {e}"))?,
        scene: absolute(session.path())?,
        folder,
        output: output.files.iter().map(|file| absolute(file)).collect::<Result<_, _>>()?,
        name: session.name(),
        passes,
        tasks,
        render: args.rendering(given),
        merge: args.merging(),
        sbatch: args.sbatch.clone(),
        threads: args.threads,
    };
    args.write(&scripts)
}

impl SubmitArgs {
    /// Options of `render` in each task, beside those that say which passes and how many threads.
    fn rendering(&self, given: &[String]) -> Vec<String> {
        let layers = self.picture.layers_as_given().map(|list| format!("--layers={list}"));
        given.iter().cloned().chain(layers).collect()
    }

    /// Options of `merge`.
    fn merging(&self) -> Vec<String> {
        let mut options = Vec::new();
        if self.picture.half {
            options.push("--half".to_owned());
        }
        if self.picture.exposure != 0.0 {
            options.push(format!("--exposure={}", self.picture.exposure));
        }
        options
    }

    fn write(&self, scripts: &Scripts) -> Result<u8, Failure> {
        let mut files = Vec::new();
        for (name, text) in scripts.texts() {
            let file = scripts.folder.join(name);
            atomic_write(&file, text.as_bytes())
                .map_err(|source| format!("cannot write `{}`: {source}", file.display()))?;
            files.push(file);
        }
        let submit = scripts.folder.join(scripts::SUBMIT);
        report::line(&scripts.summary());
        files.iter().for_each(|file| report::line(&format!("wrote {}", file.display())));
        if !self.run {
            report::line(&format!("submit with: bash {}", scripts::quoted(&submit.to_string_lossy())));
            return Ok(0);
        }
        submitted(&submit)
    }
}

/// Runs the script that calls sbatch, which says what is wrong itself.
fn submitted(script: &Path) -> Result<u8, Failure> {
    let status = Command::new("bash").arg(script).status().map_err(|e| format!("cannot start bash: {e}"))?;
    if status.success() {
        return Ok(0);
    }
    Err(Failure::Work("the jobs could not be submitted".to_owned()))
}

/// What leads to a file from any folder, whether it is there yet or not. Schedulers copy scripts elsewhere.
fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    let absolute =
        std::path::absolute(path).map_err(|e| Failure::Work(format!("`{}`: {e}", path.display())))?;
    // A script is text.
    match absolute.to_str() {
        Some(_) => Ok(absolute),
        None => {
            Err(Error::Unwritable { file: path.to_path_buf(), why: "its name is not UTF-8".to_owned() }
                .into())
        }
    }
}
