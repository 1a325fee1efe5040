//! The scripts of a render on many machines, in plain bash.

use std::path::{Path, PathBuf};

/// Renders the passes of one task.
const RENDER: &str = "render.sh";

/// Makes the picture.
const MERGE: &str = "merge.sh";

/// Hands both to Slurm.
pub const SUBMIT: &str = "submit.sh";

/// What goes into the scripts. Paths are absolute.
#[derive(Debug)]
pub struct Scripts {
    pub program: PathBuf,
    pub scene: PathBuf,
    pub folder: PathBuf,
    /// Files of the picture.
    pub output: Vec<PathBuf>,
    /// Of the scene.
    pub name: String,
    pub passes: u32,
    /// The passes of each task: the first and the one after the last.
    pub tasks: Vec<[u32; 2]>,
    /// Further options of `render`.
    pub render: Vec<String>,
    /// Further options of `merge`.
    pub merge: Vec<String>,
    /// Options of sbatch.
    pub sbatch: Vec<String>,
    pub threads: Option<u32>,
}

/// A word that bash takes as it is.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

fn path(path: &Path) -> String {
    quoted(&path.to_string_lossy())
}

fn words(list: &[String]) -> String {
    list.iter().map(|word| format!(" {}", quoted(word))).collect()
}

impl Scripts {
    /// Names and contents.
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        vec![(RENDER, self.render_script()), (MERGE, self.merge_script()), (SUBMIT, self.submit_script())]
    }

    /// What they do.
    pub fn summary(&self) -> String {
        let missing: u32 = self.tasks.iter().map(|[first, end]| end - first).sum();
        let plural = |n: usize| if n == 1 { "" } else { "s" };
        let count = self.tasks.len();
        match count {
            0 => format!("all {} passes are there; what is left is to merge them", self.passes),
            _ => format!("{missing} passes in {count} task{}, then a merge", plural(count)),
        }
    }

    fn render_script(&self) -> String {
        let ranges: Vec<String> = self.tasks.iter().map(|[first, end]| format!("{first}..{end}")).collect();
        let threads = match self.threads {
            Some(n) => format!("--threads {n}"),
            // One thread for each core that the scheduler gives to the task, where it says how many those are.
            None => "${SLURM_CPUS_PER_TASK:+--threads \"$SLURM_CPUS_PER_TASK\"}".to_owned(),
        };
        format!(
            "#!/bin/bash\n\
             # Renders the passes of one task of {count}: the one whose number, from 0, is the argument or Slurm's.\n\
             # Run again, it goes on where it was ended.\n\
             set -eu\n\
             ranges=({ranges})\n\
             range=${{ranges[${{1:-$SLURM_ARRAY_TASK_ID}}]}}\n\
             exec {program} render {scene}{options} {threads} --quiet \\\n    \
             --pass-range \"$range\" --checkpoint {folder}/\"${{range/../-}}.ckpt\" --resume\n",
            count = self.tasks.len(),
            ranges = ranges.join(" "),
            program = path(&self.program),
            scene = path(&self.scene),
            options = words(&self.render),
            folder = path(&self.folder),
        )
    }

    fn merge_script(&self) -> String {
        let (main, png) = (self.output.first(), self.output.get(1));
        let output = main.map_or_else(String::new, |file| format!(" -o {}", path(file)));
        let png = png.map_or_else(String::new, |file| format!(" --png {}", path(file)));
        format!(
            "#!/bin/bash\n\
             # Makes the picture of all passes; says which are missing, if any are.\n\
             exec {program} merge {folder} --passes {passes}{output}{png}{options}\n",
            program = path(&self.program),
            folder = path(&self.folder),
            passes = self.passes,
            options = words(&self.merge),
        )
    }

    fn submit_script(&self) -> String {
        // In patterns of Slurm, % begins a placeholder.
        let logs = path(&self.folder).replace('%', "%%");
        let name = quoted(&format!("caustica-{}", self.name));
        let script = |name: &str| path(&self.folder.join(name));
        let options = words(&self.sbatch);
        let merge = |dependency: &str| {
            format!(
                "sbatch --job-name={name}-merge --output={logs}/merge.log{dependency}{options} {}\n",
                script(MERGE)
            )
        };
        let head = "#!/bin/bash\nset -eu\n";
        let Some(last) = self.tasks.len().checked_sub(1) else { return format!("{head}{}", merge("")) };
        format!(
            "{head}# A task that was ended by a kill, a preemption or a failed machine is queued again by Slurm where its\n\
             # settings say so; it goes on from its part. The merge begins when no task is left, whatever became of them.\n\
             tasks=$(sbatch --parsable --job-name={name} --array=0-{last} --requeue --open-mode=append \\\n    \
             --output={logs}/task-%a.log{options} {render})\n\
             tasks=${{tasks%%;*}}\n\
             echo \"Submitted batch job $tasks, {count} tasks\"\n\
             {merge}",
            count = last + 1,
            render = script(RENDER),
            merge = merge(" --dependency=afterany:\"$tasks\""),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_bash() {
        assert_eq!(quoted("/a/b-c.xml"), "/a/b-c.xml");
        assert_eq!(quoted("a b"), "'a b'");
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
        assert_eq!(quoted(""), "''");
    }
}
