//! `caustica submit` on a real Slurm: tasks are killed, cancelled and queued again while they run, what is missing is
//! submitted again, and the picture has the bytes of one run. Without Slurm it is skipped by name.

#[cfg(unix)]
mod slurm_cluster;

use std::process::ExitCode;

#[cfg(unix)]
fn main() -> ExitCode {
    use libtest_mimic::{Arguments, Completion, Trial};
    let trial =
        Trial::ignorable_test("killed_tasks_are_submitted_again", || match slurm_cluster::Cluster::start() {
            Ok(cluster) => unix::killed_tasks(&cluster).map(|()| Completion::Completed),
            Err(why) => Ok(Completion::ignored_with(why)),
        });
    libtest_mimic::run(&Arguments::from_args(), vec![trial]).exit_code()
}

#[cfg(not(unix))]
fn main() -> ExitCode {
    ExitCode::SUCCESS
}

#[cfg(unix)]
mod unix {
    use std::path::Path;
    use std::process::{Command, Output};
    use std::time::{Duration, Instant};

    use libtest_mimic::Failed;

    use super::slurm_cluster::{Cluster, Job};

    /// The test is given up after this time, with what Slurm said.
    const PATIENCE: Duration = Duration::from_secs(300);

    /// A pass takes a good part of a second, so that a task can be met while it runs.
    const OPTIONS: &[&str] = &["--size", "96x96", "--photons", "60000", "--passes", "24", "--threads", "1"];

    fn caustica(cluster: &Cluster, folder: &Path, arguments: &[&[&str]]) -> Result<String, Failed> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
        cluster.environment(command.args(arguments.concat()).current_dir(folder));
        let Output { status, stderr, .. } = command.output()?;
        let text = String::from_utf8_lossy(&stderr).into_owned();
        if status.success() { Ok(text) } else { Err(format!("{arguments:?}: {text}").into()) }
    }

    fn wait(cluster: &Cluster, what: &str, done: impl Fn(&[Job]) -> bool) -> Result<Vec<Job>, Failed> {
        let begun = Instant::now();
        loop {
            let jobs = cluster.jobs()?;
            if done(&jobs) {
                return Ok(jobs);
            }
            if begun.elapsed() > PATIENCE {
                return Err(format!("{what}: still {jobs:?}\n{}", cluster.last_words()).into());
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn running(jobs: &[Job]) -> impl Iterator<Item = &Job> {
        jobs.iter().filter(|job| job.task.is_some() && job.state == "RUNNING")
    }

    /// Renders of a range in this folder: process and range.
    fn renders(folder: &Path) -> Vec<(u32, String)> {
        let mut found = Vec::new();
        for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
            let Some(process) = entry.file_name().to_str().and_then(|name| name.parse().ok()) else {
                continue;
            };
            let line = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
            let words: Vec<&str> =
                line.split(|b| *b == 0).filter_map(|word| std::str::from_utf8(word).ok()).collect();
            let range =
                words.iter().position(|word| *word == "--pass-range").and_then(|at| words.get(at + 1));
            let ours = words.iter().any(|word| word.starts_with(&*folder.to_string_lossy()));
            if let (Some(range), true) = (range, ours) {
                found.push((process, (*range).to_owned()));
            }
        }
        found
    }

    /// Waits for a render whose checkpoint is there already, and ends it as if by the system.
    fn kill_a_render(cluster: &Cluster, parts: &Path) -> Result<String, Failed> {
        let begun = Instant::now();
        loop {
            let begun_part = |range: &str| parts.join(format!("{}.ckpt", range.replace("..", "-"))).exists();
            if let Some((process, range)) = renders(parts).into_iter().find(|(_, range)| begun_part(range)) {
                let killed = Command::new("kill").args(["-9", &process.to_string()]).status()?;
                if killed.success() {
                    return Ok(range);
                }
            }
            if begun.elapsed() > PATIENCE {
                return Err(format!("no render came to its first pass\n{}", cluster.last_words()).into());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn killed_tasks(cluster: &Cluster) -> Result<(), Failed> {
        let root = tempfile::tempdir()?;
        // What has to be quoted.
        let folder = root.path().join("it's a $folder, 100 %");
        std::fs::create_dir(&folder)?;
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-glass.xml");
        std::fs::copy(scene, folder.join("s.xml"))?;
        let parts = folder.join("s-passes");
        caustica(cluster, &folder, &[&["render", "s.xml", "--quiet", "-o", "one.exr"], OPTIONS])?;

        let submit = [&["submit", "--slurm", "s.xml", "--jobs", "8", "-o", "many.exr", "--run"], OPTIONS];
        caustica(cluster, &folder, &[submit[0], submit[1], &["--", "--partition=main"]])?;
        let killed = kill_a_render(cluster, &parts)?;
        let jobs = wait(cluster, "a task to cancel", |jobs| running(jobs).count() > 1)?;
        let running: Vec<Job> = running(&jobs).cloned().collect();
        cluster.says(&["scancel", &running[0].number])?;
        cluster.says(&["scontrol", "requeue", &running[1].number])?;
        wait(cluster, "the end of the first jobs", <[Job]>::is_empty)?;

        let log = std::fs::read_to_string(parts.join("merge.log"))?;
        if !log.contains(" are missing") || folder.join("many.exr").exists() {
            return Err(format!("after a kill ({killed}) the merge must name what is missing: {log}").into());
        }
        let text =
            caustica(cluster, &folder, &[submit[0], submit[1], &["--missing", "--", "--partition=main"]])?;
        if !text.contains(" passes in ") {
            return Err(format!("nothing is said to be submitted: {text}").into());
        }
        wait(cluster, "the end of the second jobs", <[Job]>::is_empty)?;
        let at = |name: &str| std::fs::read(folder.join(name));
        if at("one.exr")? != at("many.exr")? {
            return Err("the picture of many tasks is not that of one run".into());
        }
        Ok(())
    }
}
