//! Numbers as Mitsuba writes them. NaN and infinities are refused.

/// Decimal number with blanks around; `2.0f`, `nan` and `inf` are refused.
pub(super) fn float(text: &str) -> Option<f64> {
    let text = text.trim();
    // Rust would also take `inf`, `nan` and `infinity`.
    if text.contains(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E'))) {
        return None;
    }
    text.parse().ok().filter(|v: &f64| v.is_finite())
}

/// Decimal integer with blanks around.
pub(super) fn integer(text: &str) -> Option<i64> {
    text.trim().parse().ok()
}

/// Numbers separated by commas or blanks.
pub(super) fn floats(text: &str) -> Option<Vec<f64>> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
    parts.map(float).collect()
}

/// `rrggbb` as three numbers in 0..1.
pub(super) fn hex(digits: &str) -> Option<[f64; 3]> {
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let channel =
        |i: usize| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok().map(|v| f64::from(v) / 255.0);
    Some([channel(0)?, channel(1)?, channel(2)?])
}

/// `λ:v, λ:v, …`
pub(super) fn wavelengths(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
    let pair = |part: &str| {
        let (wavelength, value) = part.split_once(':')?;
        Some([float(wavelength)?, float(value)?])
    };
    let samples: Result<Vec<_>, _> =
        parts.map(|part| pair(part).ok_or_else(|| format!("`{part}` is not `wavelength:value`"))).collect();
    ascending(samples?)
}

/// The samples, when they are finite and their wavelengths ascend.
pub(super) fn ascending(samples: Vec<[f64; 2]>) -> Result<Vec<[f64; 2]>, String> {
    if samples.is_empty() {
        return Err("the spectrum has no samples".to_owned());
    }
    if samples.as_flattened().iter().any(|v| !v.is_finite()) {
        return Err("the spectrum has a value that is not a number".to_owned());
    }
    match samples.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
        Some(pair) => Err(format!("wavelengths must ascend, but {} follows {}", pair[1][0], pair[0][0])),
        None => Ok(samples),
    }
}
