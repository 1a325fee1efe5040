//! Runs a program and measures its cost.

use super::error::BenchError;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Cost of a process, including loading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    pub seconds: f64,
    /// User and system time of all threads and of all processes it has waited for; `None` where the system does not
    /// report it.
    pub cpu_seconds: Option<f64>,
    /// Peak resident memory, as last seen while the process ran.
    pub peak_memory_bytes: Option<u64>,
}

/// Time between two looks at the process, and so the error of `Cost::seconds`. Callers prefer the program's
/// own measurement.
const INTERVAL: Duration = Duration::from_millis(5);
/// Times that a process and its descendants are told to end: a second in all.
const KILLS: u32 = 200;
/// Clock ticks per second in /proc: 100 on every Linux, as seen by programs.
const TICKS: f64 = 100.0;

/// What ends a process early.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// Longest wall time.
    pub limit: Option<Duration>,
    /// Set by a signal to this program.
    pub stop: Arc<AtomicBool>,
}

/// Runs `command` without showing its output. When `watch` says so it is stopped with all processes it has started.
///
/// # Errors
/// It cannot be started, was stopped, or its exit status is not 0; the error then has the end of its stderr.
pub fn run(command: &mut Command, watch: &Watch) -> Result<Cost, BenchError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let shown = || {
        let args = command.get_args().map(|a| a.to_string_lossy().into_owned());
        std::iter::once(program.clone()).chain(args).collect::<Vec<_>>().join(" ")
    };
    let shown = shown();
    let errors = tempfile::tempfile()?;
    let started = Instant::now();
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(errors.try_clone()?)
        .spawn()
        .map_err(|source| BenchError::Start { program, source })?;
    let stat = format!("/proc/{}/stat", child.id());
    let memory = format!("/proc/{}/status", child.id());
    let (mut cpu_seconds, mut peak_memory_bytes) = (None, None);
    // A process that has ended keeps its times until `wait`.
    while let Some((ended, cpu)) = std::fs::read_to_string(&stat).ok().as_deref().and_then(parse_stat) {
        cpu_seconds = Some(cpu);
        if ended {
            break;
        }
        let status = std::fs::read_to_string(&memory).ok();
        peak_memory_bytes = status.as_deref().and_then(parse_peak).or(peak_memory_bytes);
        if watch.stop.load(Ordering::Acquire) {
            stop(&mut child)?;
            return Err(BenchError::Interrupted);
        }
        if let Some(limit) = watch.limit.filter(|limit| started.elapsed() > *limit) {
            stop(&mut child)?;
            return Err(BenchError::Stopped { command: shown, seconds: limit.as_secs_f64() });
        }
        std::thread::sleep(INTERVAL);
    }
    let seconds = started.elapsed().as_secs_f64();
    let status = child.wait()?;
    if !status.success() {
        return Err(BenchError::Render { command: shown, message: tail(errors, &status.to_string()) });
    }
    Ok(Cost { seconds, cpu_seconds, peak_memory_bytes })
}

/// Ends a process and its descendants. They are in the group of this program, so that Ctrl-C reaches them too, and
/// are therefore looked up one by one.
fn stop(child: &mut Child) -> Result<(), BenchError> {
    let mut family = vec![child.id()];
    // A process may start another while it is looked at, and takes a moment to end.
    for _ in 0..KILLS {
        let parents = parents();
        // Every process is started after its parent, but numbers may wrap around.
        while let Some((process, _)) =
            parents.iter().find(|(process, parent)| family.contains(parent) && !family.contains(process))
        {
            family.push(*process);
        }
        if !family.iter().any(|process| lives(*process)) {
            break;
        }
        // Without parents the others would be handed over to the system, so all of them at once.
        let numbers: Vec<String> = family.iter().map(u32::to_string).collect();
        let _gone = Command::new("sh")
            .args(["-c", "kill -KILL \"$@\"", "sh"])
            .args(numbers)
            .stderr(Stdio::null())
            .status();
        std::thread::sleep(INTERVAL);
    }
    child.kill()?;
    child.wait()?;
    Ok(())
}

fn lives(process: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat"));
    stat.ok().as_deref().and_then(parse_stat).is_some_and(|(ended, _)| !ended)
}

/// Every process of the system and its parent, where /proc tells.
fn parents() -> Vec<(u32, u32)> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let parent = |entry: std::fs::DirEntry| {
        let process = entry.file_name().to_str()?.parse().ok()?;
        let text = std::fs::read_to_string(entry.path().join("stat")).ok()?;
        let parent = text.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()?;
        Some((process, parent))
    };
    entries.filter_map(parent).collect()
}

/// Whether this system reports the CPU time of other processes.
pub fn tells_cpu_time() -> bool {
    std::fs::read_to_string("/proc/self/stat").ok().as_deref().and_then(parse_stat).is_some()
}

/// Whether the process has ended, and its CPU seconds with those of its ended children, from /proc/PID/stat.
fn parse_stat(text: &str) -> Option<(bool, f64)> {
    // The name in parentheses may hold anything, so fields are counted from its end.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    // User and system time, its own and of its children.
    let ticks: Vec<f64> = fields.skip(10).take(4).filter_map(|f| f.parse().ok()).collect();
    (ticks.len() == 4).then(|| (matches!(state, "Z" | "X"), ticks.iter().sum::<f64>() / TICKS))
}

/// Peak of the resident memory in bytes, from /proc/PID/status.
fn parse_peak(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

/// The last lines of a process's stderr.
fn tail(mut file: std::fs::File, otherwise: &str) -> String {
    use std::io::{Read, Seek};
    let mut text = Vec::new();
    let _unreadable = file.rewind().and_then(|()| file.read_to_end(&mut text));
    let text = String::from_utf8_lossy(&text).into_owned();
    let lines: Vec<&str> = text.lines().filter(|l| !l.trim().is_empty()).collect();
    if lines.is_empty() {
        return otherwise.to_owned();
    }
    lines[lines.len().saturating_sub(6)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_after_a_name_with_parentheses() {
        let line = "12 (a) b (c)) Z 1 2 3 4 5 6 7 8 9 10 150 50 30 20 20 0 1 0 5 6";
        assert_eq!(parse_stat(line), Some((true, 2.5)));
        assert_eq!(parse_stat("12 (x) R 1"), None);
        assert_eq!(parse_peak("Name:\tx\nVmHWM:\t    2048 kB\n"), Some(2048 * 1024));
    }

    #[test]
    fn failures_say_what_the_program_said() {
        let failed = run(Command::new("sh").args(["-c", "echo no such lamp >&2; exit 3"]), &Watch::default());
        assert!(failed.unwrap_err().to_string().ends_with("no such lamp"));
        assert!(matches!(
            run(&mut Command::new("/no/such/program"), &Watch::default()),
            Err(BenchError::Start { .. })
        ));
        let cost = run(
            Command::new("sh").args(["-c", "i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done"]),
            &Watch::default(),
        )
        .unwrap();
        assert!(cost.seconds > 0.0 && cost.cpu_seconds.is_none_or(|c| c < 60.0));
    }

    /// Time asleep is not CPU time; that of a child is.
    #[cfg(target_os = "linux")]
    #[test]
    fn cpu_time_is_that_of_the_process_and_its_children() {
        let asleep = run(Command::new("sh").args(["-c", "sleep 1"]), &Watch::default()).unwrap();
        // Starting a shell and `sleep` takes some milliseconds; half a second leaves room for a slow machine.
        assert!(asleep.seconds >= 1.0 && asleep.cpu_seconds.unwrap() < 0.5, "{asleep:?}");
        // The inner shell ends once it has taken 20 ticks, and the outer one takes hardly any.
        let burn =
            "while read -r line < /proc/self/stat; set -- $line; [ $((${14} + ${15})) -lt 20 ]; do :; done";
        let mut command = Command::new("sh");
        command.args(["-c", "sh -c \"$0\"; exit 0", burn]);
        let busy = run(&mut command, &Watch::default()).unwrap();
        // One tick for rounding; the loop looks at its time at every turn.
        assert!((0.19..0.5).contains(&busy.cpu_seconds.unwrap()), "{busy:?}");
    }

    /// A shell that waits for another one, which would go on for ever.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_beyond_its_limit_is_stopped_with_its_children() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("child");
        let script = "sh -c 'echo $$ > \"$0\"; while :; do sleep 1; done' \"$0\" & wait";
        let mut command = Command::new("sh");
        command.args(["-c", script]).arg(&file);
        let watch = Watch { limit: Some(Duration::from_millis(500)), ..Watch::default() };
        let stopped = run(&mut command, &watch).unwrap_err();
        assert!(stopped.to_string().ends_with("was stopped after 0.5 s"), "{stopped}");
        let child = std::fs::read_to_string(&file).unwrap();
        let state = std::fs::read_to_string(format!("/proc/{}/stat", child.trim()));
        assert!(state.ok().as_deref().and_then(parse_stat).is_none_or(|(ended, _)| ended), "{child} goes on");
    }
}
