//! What people read: everything goes to stderr, so that stdout stays free for data.

use std::io::Write;

/// Prints a line to stderr; a closed stderr is not worth dying for.
pub fn line(text: &str) {
    let _closed = writeln!(std::io::stderr(), "{text}");
}

/// Prints an error: a rendered diagnostic as it is, anything else with a prefix.
pub fn error(message: &str) {
    if message.starts_with("error") {
        line(message);
    } else {
        line(&format!("error: {message}"));
    }
}

/// Prints data for machines and pagers to stdout. A closed pipe is no error.
///
/// # Errors
/// When stdout cannot be written for another reason.
pub fn data(text: &str) -> Result<(), String> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(format!("cannot write to stdout: {e}")),
        _ => Ok(()),
    }
}

/// Processor time of all threads of this process so far, user and system, where the system tells.
pub fn cpu_seconds() -> Option<f64> {
    /// Of /proc: the same on every Linux, as seen by programs.
    const TICKS_PER_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name in parentheses may hold anything.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let (user, system) = (fields.next()?.parse::<f64>().ok()?, fields.next()?.parse::<f64>().ok()?);
    Some((user + system) / TICKS_PER_SECOND)
}

/// Peak resident memory of this process, where the system tells.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb * 1024)
}
