//! Measurements, and the file that keeps them: one JSON object per line, so that an interrupted run loses at
//! most the line it was writing.

use super::error::BenchError;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What ends a render.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Budget {
    /// CPU seconds of the render, without loading.
    #[serde(rename = "cpu_seconds")]
    CpuSeconds(f64),
    Passes(u32),
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CpuSeconds(s) => write!(f, "{s} CPU s"),
            Self::Passes(1) => f.write_str("1 pass"),
            Self::Passes(n) => write!(f, "{n} passes"),
        }
    }
}

/// One render, measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub scene: String,
    pub config: String,
    pub budget: Budget,
    pub seed: u64,
    /// Fingerprint of everything else that decides the result: scene, reference, mask, depth, threads.
    pub identity: String,
    /// Wall time of the render, without loading.
    pub seconds: f64,
    /// CPU time of the render, without loading; the wall time where the system does not report it.
    pub cpu_seconds: f64,
    pub peak_memory_bytes: Option<u64>,
    /// Passes or samples per pixel that were made.
    pub passes: u64,
    pub rmse: f64,
    pub relmse: f64,
    /// relMSE without the largest 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// Difference of the means, relative to the reference's.
    pub bias: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// Mean HDR-FLIP.
    pub hdr_flip: f64,
    /// The picture, relative to the folder of the run.
    pub image: PathBuf,
}

impl Record {
    /// Whether this record is of the point (scene, config, budget, seed, identity).
    pub fn same_point(&self, other: (&str, &str, Budget, u64, &str)) -> bool {
        (self.scene.as_str(), self.config.as_str(), self.budget, self.seed, self.identity.as_str()) == other
    }
}

/// Records of earlier runs; none if there is no file. A line that cannot be parsed (cut off by an
/// interruption) is dropped.
///
/// # Errors
/// The file cannot be read.
pub fn read(path: &Path) -> Result<Vec<Record>, BenchError> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(text.lines().filter_map(|l| serde_json::from_str(l).ok()).collect()),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(source) => Err(BenchError::Io { path: path.to_path_buf(), source }),
    }
}

/// Appends a record, after closing a line that an interruption left open.
///
/// # Errors
/// The file cannot be written.
pub fn append(path: &Path, record: &Record) -> Result<(), BenchError> {
    let io = |source| BenchError::Io { path: path.to_path_buf(), source };
    let open = std::fs::read(path).is_ok_and(|b| b.last().is_some_and(|c| *c != b'\n'));
    let json = serde_json::to_string(record)
        .map_err(|source| BenchError::Json { path: path.to_path_buf(), source })?;
    let mut file = OpenOptions::new().create(true).append(true).open(path).map_err(io)?;
    file.write_all(format!("{}{json}\n", if open { "\n" } else { "" }).as_bytes()).map_err(io)
}

/// FNV-1a over the parts and their lengths, as hexadecimal.
pub fn fingerprint<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut feed = |bytes: &[u8]| {
        for b in bytes {
            hash = (hash ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for part in parts {
        feed(&(part.len() as u64).to_le_bytes());
        feed(part);
    }
    format!("{hash:016x}")
}

#[cfg(test)]
pub mod tests {
    use super::*;

    pub fn record(config: &str, budget: f64, seed: u64, cpu_seconds: f64, rmse: f64) -> Record {
        Record {
            scene: "box".to_owned(),
            config: config.to_owned(),
            budget: Budget::CpuSeconds(budget),
            seed,
            identity: "0".to_owned(),
            seconds: 2.0 * cpu_seconds,
            cpu_seconds,
            peak_memory_bytes: Some(1 << 20),
            passes: (4.0 * budget) as _,
            rmse,
            relmse: rmse * rmse,
            relmse_trimmed: rmse * rmse / 2.0,
            bias: 0.0,
            flip: rmse / 2.0,
            hdr_flip: rmse,
            image: PathBuf::from("a.exr"),
        }
    }

    #[test]
    fn a_line_cut_off_is_measured_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.jsonl");
        assert!(read(&path).unwrap().is_empty());
        let (a, b) = (record("a", 1.0, 0, 1.1, 0.5), record("b", 2.0, 1, 2.1, 0.25));
        append(&path, &a).unwrap();
        OpenOptions::new().append(true).open(&path).unwrap().write_all(b"{\"scene\":\"b").unwrap();
        assert_eq!(read(&path).unwrap(), std::slice::from_ref(&a));
        append(&path, &b).unwrap();
        let all = read(&path).unwrap();
        assert_eq!(all, [a, b.clone()]);
        assert!(all[1].same_point(("box", "b", Budget::CpuSeconds(2.0), 1, "0")));
        assert!(!all[0].same_point(("box", "b", Budget::CpuSeconds(2.0), 1, "0")));
    }

    #[test]
    fn parts_are_kept_apart() {
        assert_ne!(fingerprint([b"ab".as_slice(), b"c"]), fingerprint([b"a".as_slice(), b"bc"]));
        assert_eq!(fingerprint([b"ab".as_slice()]), fingerprint([b"ab".as_slice()]));
    }
}
