//! The machine on which times were measured. Every table names it.

use serde::{Deserialize, Serialize};

/// A machine, as far as it matters for times.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    pub cpu: String,
    /// Logical processors that this process may use.
    pub cores: usize,
    pub memory_bytes: Option<u64>,
    /// Threads of each render.
    pub threads: usize,
    /// Mean number of running processes over the last minute before the first measurement.
    pub load: Option<f64>,
    pub system: String,
}

impl Machine {
    /// This machine; `threads` is the number given to each render, `None` for all cores.
    pub fn here(threads: Option<usize>) -> Self {
        let read = |path| std::fs::read_to_string(path).unwrap_or_default();
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            cpu: field(&read("/proc/cpuinfo"), "model name")
                .unwrap_or_else(|| "unknown processor".to_owned()),
            cores,
            memory_bytes: field(&read("/proc/meminfo"), "MemTotal")
                .and_then(|v| v.split_whitespace().next()?.parse::<u64>().ok())
                .map(|kb| kb * 1024),
            threads: threads.unwrap_or(cores),
            load: read("/proc/loadavg").split_whitespace().next().and_then(|v| v.parse().ok()),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }

    /// A description in one line.
    pub fn line(&self) -> String {
        let memory =
            self.memory_bytes.map_or_else(String::new, |b| format!(", {:.1} GB memory", b as f64 / 1e9));
        let load = self.load.map_or_else(String::new, |l| format!(", load {l:.1} before the first run"));
        format!("{}, {} cores, {} threads{memory}, {}{load}", self.cpu, self.cores, self.threads, self.system)
    }
}

/// The value of the first line `name : value`.
fn field(text: &str, name: &str) -> Option<String> {
    text.lines()
        .filter_map(|l| l.split_once(':'))
        .find(|(n, _)| n.trim() == name)
        .map(|(_, v)| v.trim().to_owned())
}

#[cfg(test)]
mod tests {
    #[test]
    fn fields_of_proc() {
        let text = "processor\t: 0\nmodel name\t: A CPU @ 2: GHz\nmodel name\t: other\n";
        assert_eq!(super::field(text, "model name").as_deref(), Some("A CPU @ 2: GHz"));
        assert_eq!(super::field(text, "model"), None);
    }
}
