//! What `--version` prints.

use std::sync::LazyLock;

use crate::math::simd;

/// Version, build, features and instruction set.
pub fn long() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(text);
    &TEXT
}

fn text() -> String {
    let features = match env!("CAUSTICA_FEATURES") {
        "" => "none",
        features => features,
    };
    let rows = [
        ("commit", env!("CAUSTICA_COMMIT").to_owned()),
        ("build", env!("CAUSTICA_BUILD").to_owned()),
        ("features", features.to_owned()),
        ("SIMD", format!("{}; pictures are the same with every level", simd::level())),
    ];
    let lines = rows.map(|(name, value)| format!("\n{name:<9} {value}"));
    format!("{}{}", env!("CARGO_PKG_VERSION"), lines.concat())
}
