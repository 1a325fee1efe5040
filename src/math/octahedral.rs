use super::Vec3;

/// −1 or 1, by the sign bit.
fn sign(x: f32) -> f32 {
    1.0f32.copysign(x)
}

/// Packs a unit vector into 32 bits by the octahedral map, 16 bits a coordinate (Cigolle et al. 2014,
/// "A Survey of Efficient Representations for Independent Unit Vectors", JCGT). The error is below 1e-4 rad.
#[inline]
pub fn encode_direction(v: Vec3) -> u32 {
    let p = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let (x, y) =
        if p.z >= 0.0 { (p.x, p.y) } else { ((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) };
    let quantise = |c: f32| (((c.clamp(-1.0, 1.0) + 1.0) * 32767.5).round() as u32).min(65535);
    quantise(x) | quantise(y) << 16
}

/// The unit vector that [`encode_direction`] packed; every code is valid.
#[inline]
pub fn decode_direction(code: u32) -> Vec3 {
    let x = (code & 0xffff) as f32 / 32767.5 - 1.0;
    let y = (code >> 16) as f32 / 32767.5 - 1.0;
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold * sign(x), y - fold * sign(y), z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_is_within_a_ten_thousandth_of_a_radian() {
        for i in 0..10_000 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 10_000.0;
            let phi = i as f32 * 2.399_963;
            let r = (1.0 - z * z).sqrt();
            let v = Vec3::new(r * phi.cos(), r * phi.sin(), z);
            assert!((decode_direction(encode_direction(v)) - v).length() < 1e-4, "{v}");
        }
    }
}
