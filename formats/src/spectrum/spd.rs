//! Spectra in text files (`.spd`): one wavelength (nm) and value a line, `#` starts a comment.

use thiserror::Error;

use crate::misnamed;

/// Why a spectrum file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SpdError {
    /// Not UTF-8.
    #[error("the spectrum file is not text")]
    NotText,
    /// Not a spectrum file at all.
    #[error("it is {0}")]
    Other(&'static str),
    /// A line that is not a wavelength and a value.
    #[error("line {line}: expected a wavelength and a value, found \"{found}\"")]
    BadLine {
        /// From 1.
        line: usize,
        /// What stands there, shortened.
        found: String,
    },
}

/// Samples in file order; [`super::to_linear_rgb`] checks that they ascend.
///
/// # Errors
/// When the bytes are not text or a line is not a wavelength and a value.
pub fn parse_spd(bytes: &[u8]) -> Result<Vec<[f64; 2]>, SpdError> {
    if let Some(what) = misnamed::named(bytes) {
        return Err(SpdError::Other(what));
    }
    let text = std::str::from_utf8(bytes).map_err(|_| SpdError::NotText)?;
    let mut samples = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or("").trim();
        if content.is_empty() {
            continue;
        }
        let mut words = content.split_whitespace();
        let pair = (words.next(), words.next(), words.next());
        let parsed = match pair {
            (Some(nm), Some(value), None) => nm.parse().ok().zip(value.parse().ok()),
            _ => None,
        };
        let (nm, value) = parsed.ok_or_else(|| SpdError::BadLine {
            line: index + 1,
            found: content.chars().take(60).collect(),
        })?;
        samples.push([nm, value]);
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_blank_lines() {
        let samples = parse_spd(b"# gold\n400 1.5\n\n  500\t2e-1 # tail\r\n");
        assert_eq!(samples, Ok(vec![[400.0, 1.5], [500.0, 0.2]]));
    }

    #[test]
    fn a_bad_line_is_named() {
        let error = parse_spd(b"400 1\n500 2 3\n").expect_err("three numbers");
        assert_eq!(error, SpdError::BadLine { line: 2, found: "500 2 3".into() });
        assert_eq!(parse_spd(&[0xff, 0xfe]), Err(SpdError::NotText));
    }
}
