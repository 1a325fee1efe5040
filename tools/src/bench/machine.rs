//! The machine a time was measured on; it stands beside every table.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    pub cpu: String,
    /// Logical processors that this process may use.
    pub cores: usize,
    pub memory_bytes: Option<u64>,
    /// Threads a render used; all cores unless fewer were asked for.
    pub threads: usize,
    /// Mean number of running processes over the last minute before the first measurement.
    pub load: Option<f64>,
    pub system: String,
}

impl Machine {
    /// Of this machine, with the threads renders are given.
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

    /// One line for tables and pages.
    pub fn line(&self) -> String {
        let memory =
            self.memory_bytes.map_or_else(String::new, |b| format!(", {:.1} GB memory", b as f64 / 1e9));
        let load = self.load.map_or_else(String::new, |l| format!(", load {l:.1} before the first run"));
        format!("{}, {} cores, {} threads{memory}, {}{load}", self.cpu, self.cores, self.threads, self.system)
    }
}

/// Value of the first `name : value` line.
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
