//! The scripts of `caustica submit`, run by bash without a scheduler.
#![cfg(unix)]

use std::path::Path;
use std::process::Command;

/// A folder whose name has to be quoted, with a scene in it.
fn place() -> tempfile::TempDir {
    let folder = tempfile::Builder::new().prefix("it's a $folder ").tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-diffuse.xml");
    std::fs::copy(scene, folder.path().join("a scene.xml")).unwrap();
    folder
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(program);
    let output =
        command.args(arguments).current_dir(folder).env_remove("SLURM_ARRAY_TASK_ID").output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn caustica(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    run(folder, env!("CARGO_BIN_EXE_caustica"), arguments)
}

const OPTIONS: [&str; 6] = ["--size", "20x16", "--photons=400", "--set", "alpha=0.6", "--passes=10"];

fn submit<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let own =
        ["submit", "--slurm", "a scene.xml", "--jobs", "4", "-o", "many.exr", "--png", "--layers", "all"];
    [&own[..], &OPTIONS, more].concat()
}

/// Every option of the scene reaches the tasks; what is absent or begun is made again; the picture is that of one run.
#[test]
fn the_scripts_make_the_picture_of_one_run() {
    let folder = place();
    let (folder, parts) = (folder.path(), folder.path().join("a scene-passes"));
    let one = ["render", "a scene.xml", "--quiet", "-o", "one.exr", "--png", "--layers=all"];
    assert_eq!(caustica(folder, &[&one[..], &OPTIONS].concat()).0, Some(0));
    let (status, text) = caustica(folder, &submit(&[]));
    assert_eq!(status, Some(0), "{text}");
    assert!(
        text.contains("10 passes in 4 tasks, then a merge") && text.contains("submit with: bash "),
        "{text}"
    );

    let [render, merge] =
        ["render.sh", "merge.sh"].map(|name| parts.join(name).to_string_lossy().into_owned());
    // From any folder, in any order; the third is not run.
    for task in ["3", "0", "1"] {
        let (status, text) = run(Path::new("/"), "bash", &[&render, task]);
        assert_eq!(status, Some(0), "{text}");
    }
    let (status, text) = run(Path::new("/"), "bash", &[&merge]);
    assert_eq!(status, Some(1));
    assert!(text.contains("passes 5..7 of 0..10 are missing"), "{text}");
    let (status, text) = caustica(folder, &submit(&[]));
    assert_eq!(status, Some(2));
    assert!(text.contains("holds parts already: --missing"), "{text}");

    let (status, text) = caustica(folder, &submit(&["--missing"]));
    assert_eq!(status, Some(0), "{text}");
    assert!(text.contains("2 passes in 1 task, then a merge"), "{text}");
    assert_eq!(run(Path::new("/"), "bash", &[&render, "0"]).0, Some(0));
    let (status, text) = run(Path::new("/"), "bash", &[&merge]);
    assert_eq!(status, Some(0), "{text}");
    let at = |name: &str| std::fs::read(folder.join(name)).unwrap();
    assert!(at("one.exr") == at("many.exr") && at("one.png") == at("many.png"));

    let (status, text) = caustica(folder, &submit(&["--missing"]));
    assert_eq!((status, text.contains("all 10 passes are there")), (Some(0), true), "{text}");
    let (status, text) = caustica(folder, &submit(&["--missing", "--seed", "3"]));
    assert_eq!(status, Some(1));
    assert!(text.contains("it belongs to another render: seed was `0`, now it is `3`"), "{text}");
}

#[test]
fn what_cannot_be_submitted_is_refused() {
    let folder = place();
    let folder = folder.path();
    let refused = |status: i32, arguments: &[&str], words: &str| {
        let (found, text) = caustica(folder, arguments);
        assert_eq!(found, Some(status), "{text}");
        assert!(text.contains(words), "{text}");
    };
    refused(2, &["submit", "a scene.xml", "--passes=4", "--jobs=2"], "--slurm");
    refused(
        2,
        &["submit", "--slurm", "a scene.xml", "--jobs=2"],
        "how many passes there are to be: --passes N",
    );
    refused(2, &["submit", "--slurm", "a scene.xml", "--passes=4"], "--jobs <N>");
    refused(1, &["submit", "--slurm", "gone.xml", "--passes=4", "--jobs=2"], "gone.xml");
    refused(2, &["submit", "--slurm", "a scene.xml", "--passes=4", "--jobs=2", "-o", "a.gif"], "a.gif");
    let run = ["submit", "--slurm", "a scene.xml", "--passes=4", "--jobs=2", "--run"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    // Where there is no sbatch, bash says so.
    let output = command.args(run).current_dir(folder).env("PATH", "/bin-that-is-not").output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The commands of docs/many-machines.md that need nothing else, in their order: the last of the first block makes the
/// picture, and the tasks are those that the others describe.
#[test]
fn the_commands_of_the_page_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = std::fs::read_to_string(root.join("scenes/cornell-diffuse.xml")).unwrap();
    std::fs::write(folder.join("scene.xml"), scene.replace("512", "8")).unwrap();
    let page = std::fs::read_to_string(root.join("docs/many-machines.md")).unwrap();
    let blocks: Vec<&str> =
        page.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let ours = |line: &&str| line.starts_with("caustica ") || line.starts_with("mkdir ");
    let commands: Vec<&str> = blocks.iter().flat_map(|block| block.lines().filter(ours)).collect();
    assert_eq!(commands.len(), 7, "{commands:#?}");
    let program = Path::new(env!("CARGO_BIN_EXE_caustica")).parent().unwrap();
    let path = std::env::join_paths(
        std::iter::once(program.to_path_buf())
            .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    );
    for command in commands {
        let mut bash = Command::new("bash");
        let output =
            bash.args(["-c", command]).current_dir(folder).env("PATH", path.as_ref().unwrap()).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let shown = ["scene.exr", "scene.png", "scene-passes/render.sh", "64-128.ckpt"];
    shown.iter().for_each(|name| assert!(folder.join(name).exists(), "{name}"));
}
