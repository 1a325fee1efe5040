//! Numbers as people read them.

/// 12345678 → "12.35 M".
pub fn count(n: f64) -> String {
    let units = [(1e9, " G"), (1e6, " M"), (1e3, " k")];
    match units.iter().find(|(scale, _)| n >= *scale) {
        Some((scale, unit)) => format!("{:.2}{unit}", n / scale),
        None => format!("{n:.0}"),
    }
}

/// Bytes in MB (10⁶).
pub fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
