//! The sRGB transfer curve (IEC 61966-2-1). Values outside 0..1 continue the curve's own formula;
//! negative values stay on its linear part.

/// Encoded component → linear.
pub fn srgb_to_linear(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear component → encoded.
pub fn linear_to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// [`srgb_to_linear`] in single precision.
pub fn srgb_to_linear_f32(encoded: f32) -> f32 {
    srgb_to_linear(f64::from(encoded)) as f32
}

/// [`srgb_to_linear_f32`] for whole pictures: what an 8-bit image holds is looked up, to the same bits.
#[derive(Clone, Debug)]
pub struct SrgbTable([f32; 256]);

impl SrgbTable {
    /// Tabulates the curve.
    pub fn new() -> Self {
        Self(std::array::from_fn(|i| srgb_to_linear_f32(i as f32 / 255.0)))
    }

    /// Linear value of an encoded one.
    pub fn decode(&self, encoded: f32) -> f32 {
        let step = (encoded * 255.0 + 0.5) as usize;
        match self.0.get(step) {
            Some(linear) if step as f32 / 255.0 == encoded => *linear,
            _ => srgb_to_linear_f32(encoded),
        }
    }
}

impl Default for SrgbTable {
    fn default() -> Self {
        Self::new()
    }
}

/// [`linear_to_srgb`] in single precision.
pub fn linear_to_srgb_f32(linear: f32) -> f32 {
    linear_to_srgb(f64::from(linear)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_changes_no_bit() {
        let table = SrgbTable::new();
        let values = (0..=255).map(|i| i as f32 / 255.0);
        for x in values.chain([-1.0, 0.1234, 0.999, 1.5, 3e38, f32::NAN, f32::INFINITY]) {
            assert_eq!(table.decode(x).to_bits(), srgb_to_linear_f32(x).to_bits(), "{x}");
        }
    }

    #[test]
    fn bytes_decode_as_measured_in_mitsuba() {
        assert!((srgb_to_linear(64.0 / 255.0) - 0.051_269_4).abs() < 1e-7);
        assert!((srgb_to_linear(128.0 / 255.0) - 0.215_860_5).abs() < 1e-7);
    }

    #[test]
    fn the_curves_invert_each_other() {
        for byte in 0..=255 {
            let encoded = f64::from(byte) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(encoded)) - encoded).abs() < 1e-6);
        }
        assert_eq!(srgb_to_linear(1.0), 1.0);
    }
}
