//! How much memory is available.

use std::fs::read_to_string;
use std::path::Path;

/// Memory in bytes that this process can still take: free on the machine, and below the limits of its
/// control group (containers) and of its address space (`ulimit -v`). Where the system does not say,
/// that of a large machine.
pub fn available() -> u128 {
    [of_machine(), of_group(Path::new("/sys/fs/cgroup")), of_process()]
        .into_iter()
        .flatten()
        .min()
        .unwrap_or(1 << 38)
}

/// The number after `name` in lines like `MemAvailable:  123 kB` or `inactive_file 123`.
fn row(text: &str, name: &str) -> Option<u128> {
    text.lines().find_map(|l| l.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

fn of_machine() -> Option<u128> {
    Some(row(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:")? * 1024)
}

fn of_process() -> Option<u128> {
    // "unlimited" does not parse.
    let limit = row(&read_to_string("/proc/self/limits").ok()?, "Max address space")?;
    let taken = row(&read_to_string("/proc/self/status").ok()?, "VmSize:")? * 1024;
    Some(limit.saturating_sub(taken))
}

/// Of the process's control group (version 2) and those around it, the tightest.
fn of_group(root: &Path) -> Option<u128> {
    let groups = read_to_string("/proc/self/cgroup").ok()?;
    let own = groups.lines().find_map(|l| l.strip_prefix("0::/"))?;
    let own = root.join(own);
    own.ancestors().take_while(|group| group.starts_with(root)).filter_map(free_in).min()
}

fn free_in(group: &Path) -> Option<u128> {
    let number = |name: &str| read_to_string(group.join(name)).ok()?.trim().parse::<u128>().ok();
    // "max" does not parse.
    let (limit, taken) = (number("memory.max")?, number("memory.current")?);
    // Cached file pages are reclaimable.
    let stat = read_to_string(group.join("memory.stat")).unwrap_or_default();
    let cached = row(&stat, "inactive_file ").unwrap_or(0);
    Some(limit.saturating_sub(taken.saturating_sub(cached)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_has_its_limit_without_what_it_took() {
        let group = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| std::fs::write(group.path().join(name), text).expect("writable");
        write("memory.current", "700\n");
        write("memory.max", "max\n");
        assert_eq!(free_in(group.path()), None);
        write("memory.max", "1000\n");
        assert_eq!(free_in(group.path()), Some(300));
        write("memory.stat", "anon 1\ninactive_file 200\n");
        assert_eq!(free_in(group.path()), Some(500));
        write("memory.current", "5000\n");
        assert_eq!(free_in(group.path()), Some(0));
    }
}
