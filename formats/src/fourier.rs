//! Tabulated BSDFs of pbrt-v3 (`.bsdf`): for each pair of cosines a Fourier series of the azimuth (Jakob, d'Eon, Jakob
//! and Marschner 2014). Little endian.

/// An isotropic BSDF.
#[derive(Clone, Debug, PartialEq)]
pub struct FourierTable {
    /// Index of refraction below over that above.
    pub eta: f32,
    /// Roughness of the upper side, as a Beckmann α; 0 where the file does not say.
    pub alpha: f32,
    /// 1: luminance; 3: luminance, red and blue.
    pub channels: usize,
    /// Cosines, ascending within −1..1.
    pub mu: Vec<f32>,
    /// For each cosine of the outgoing direction and then of the incident one, which points into the surface: where the
    /// coefficients begin, and how many each channel has.
    pub series: Vec<(u32, u32)>,
    /// Of f·|cosine| as a sum of cos(kφ), channel by channel in each series.
    pub coefficients: Vec<f32>,
}

/// Why a file is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FourierError {
    /// Not of this format.
    #[error("not a tabulated BSDF (it does not begin with SCATFUN)")]
    Magic,
    /// Of the format, but not as pbrt-v3 reads it.
    #[error("a tabulated BSDF {0} is not supported")]
    Unsupported(String),
    /// Shorter than it says.
    #[error("the file ends early: {needed} bytes are needed, {found} are there")]
    Short {
        /// By its header.
        needed: u64,
        /// Its size.
        found: u64,
    },
    /// Numbers that cannot be.
    #[error("{0}")]
    Invalid(&'static str),
}

const HEADER: usize = 64;

/// More cosines than any file has; sampling takes memory with the square of them.
const MAX_COSINES: u32 = 2048;

/// Reads the file. Takes no more memory than it is long.
///
/// # Errors
/// When the file is malformed, or has what pbrt-v3 does not read either: textured BSDFs and extrapolated series.
pub fn read(bytes: &[u8]) -> Result<FourierTable, FourierError> {
    let short = |needed: u64| FourierError::Short { needed, found: bytes.len() as u64 };
    if !bytes.starts_with(b"SCATFUN") {
        return Err(FourierError::Magic);
    }
    let header = bytes.get(..HEADER).ok_or_else(|| short(HEADER as u64))?;
    let word = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let [version, flags, cosines, coefficients] = [u32::from(header[7]), word(8), word(12), word(16)];
    let [channels, bases] = [word(24), word(28)];
    let unsupported = |what: String| Err(FourierError::Unsupported(what));
    match (version, flags, channels, bases) {
        (1, 1, 1 | 3, 1) => {}
        (1, 1, 1 | 3, _) => return unsupported(format!("of {bases} bases (with textures)")),
        (1, 1, ..) => return unsupported(format!("of {channels} channels")),
        (1, ..) => return unsupported(format!("with the flags {flags:#x}")),
        _ => return unsupported(format!("of version {version}")),
    }
    if !(2..=MAX_COSINES).contains(&cosines) {
        return unsupported(format!("of {cosines} cosines"));
    }
    let pairs = u64::from(cosines) * u64::from(cosines);
    let needed = HEADER as u64 + 4 * (u64::from(cosines) + 3 * pairs + u64::from(coefficients));
    if (bytes.len() as u64) < needed {
        return Err(short(needed));
    }
    let (n, pairs, coefficients) = (cosines as usize, pairs as usize, coefficients as usize);
    let words =
        |first: usize, count: usize| bytes[HEADER + 4 * first..][..4 * count].as_chunks::<4>().0.iter();
    let floats = |first, count| -> Vec<f32> { words(first, count).map(|w| f32::from_le_bytes(*w)).collect() };
    let table = FourierTable {
        eta: f32::from_bits(word(44)),
        alpha: f32::from_bits(word(48)),
        channels: channels as usize,
        mu: floats(0, n),
        // Between them are distribution functions, which follow from the rest.
        series: words(n + pairs, 2 * pairs)
            .map(|w| u32::from_le_bytes(*w))
            .collect::<Vec<_>>()
            .as_chunks::<2>()
            .0
            .iter()
            .map(|&[first, length]| (first, length))
            .collect(),
        coefficients: floats(n + 3 * pairs, coefficients),
    };
    check(&table)?;
    Ok(table)
}

fn check(table: &FourierTable) -> Result<(), FourierError> {
    let invalid = |what| Err(FourierError::Invalid(what));
    if !(table.eta.is_finite() && table.eta > 0.0) {
        return invalid("its index of refraction must be positive");
    }
    if !table.mu.is_sorted_by(|a, b| a < b) || table.mu.iter().any(|mu| !(-1.0..=1.0).contains(mu)) {
        return invalid("its cosines must ascend from -1 to 1");
    }
    let count = table.coefficients.len() as u64;
    let end = |&(first, length): &(u32, u32)| u64::from(first) + u64::from(length) * table.channels as u64;
    if table.series.iter().any(|series| end(series) > count) {
        return invalid("a series has coefficients that are not there");
    }
    // Sums of what is read stay finite.
    if table.coefficients.iter().any(|a| a.is_nan() || a.abs() >= 1e20) {
        return invalid("a coefficient is not a number, or too large");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cosines, of which the second pair has a series of two coefficients.
    fn file() -> Vec<u8> {
        let mut bytes = b"SCATFUN\x01".to_vec();
        let mut word = |w: u32| bytes.extend(w.to_le_bytes());
        [1, 2, 2, 2, 1, 1, 0, 0, 0].into_iter().for_each(&mut word);
        [1.5f32, 0.1, 0.1, 0.0, 0.0, -1.0, 1.0].into_iter().for_each(|x| word(x.to_bits()));
        [0, 0, 0, 0, 0, 0, 0, 2, 2, 0, 0, 0].into_iter().for_each(&mut word);
        [0.25f32, 0.5].into_iter().for_each(|x| word(x.to_bits()));
        bytes
    }

    #[test]
    fn a_file_is_read() {
        let table = read(&file()).expect("a whole file");
        assert_eq!((table.eta, table.alpha, table.channels), (1.5, 0.1, 1));
        assert_eq!(table.mu, [-1.0, 1.0]);
        assert_eq!(table.series, [(0, 0), (0, 2), (2, 0), (0, 0)]);
        assert_eq!(table.coefficients, [0.25, 0.5]);
    }

    #[test]
    fn every_shorter_file_is_refused() {
        let bytes = file();
        for length in 0..bytes.len() {
            let error = read(&bytes[..length]).expect_err("a part of a file");
            assert_eq!(error == FourierError::Magic, length < 7, "{length}: {error}");
        }
    }

    #[test]
    fn what_is_said_of_broken_files() {
        let with = |at: usize, value: u32| {
            let mut bytes = file();
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            read(&bytes).expect_err("broken").to_string()
        };
        assert_eq!(with(8, 3), "a tabulated BSDF with the flags 0x3 is not supported");
        assert_eq!(with(12, u32::MAX), "a tabulated BSDF of 4294967295 cosines is not supported");
        assert_eq!(with(16, 1 << 31), "the file ends early: 8589934712 bytes are needed, 128 are there");
        assert_eq!(with(24, 2), "a tabulated BSDF of 2 channels is not supported");
        assert_eq!(with(28, 4), "a tabulated BSDF of 4 bases (with textures) is not supported");
        assert_eq!(with(44, 0), "its index of refraction must be positive");
        assert_eq!(with(64, 2.0f32.to_bits()), "its cosines must ascend from -1 to 1");
        assert_eq!(with(100, 3), "a series has coefficients that are not there");
        assert_eq!(with(120, f32::NAN.to_bits()), "a coefficient is not a number, or too large");
    }
}
