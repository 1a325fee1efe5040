//! How much memory there is to read into.

/// Free memory in bytes; where the system does not tell, that of a large machine.
pub fn available() -> u128 {
    let told = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
        line.split_whitespace().next()?.parse::<u128>().ok()
    });
    told.map_or(1 << 38, |kb| kb * 1024)
}
