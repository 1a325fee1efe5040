//! Fresnel reflectance, unpolarised.

use crate::math::Color;

/// Result at a smooth dielectric boundary.
#[derive(Clone, Copy, Debug)]
pub struct Refraction {
    /// Reflectance in 0..=1.
    pub reflectance: f32,
    /// Signed cosine of the transmitted direction (opposite side from `cos_i`); 0 under total reflection.
    pub cos_t: f32,
    /// Index on the far side over index on the near side, seen from the incident direction.
    pub eta: f32,
}

/// Exact dielectric Fresnel for a signed `cos_i` against the normal; `eta` = index behind the normal
/// over index in front of it.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> Refraction {
    let eta = if cos_i >= 0.0 { eta } else { 1.0 / eta };
    if eta == 1.0 {
        return Refraction { reflectance: 0.0, cos_t: -cos_i, eta };
    }
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return Refraction { reflectance: 1.0, cos_t: 0.0, eta };
    }
    let ci = cos_i.abs();
    let ct = (1.0 - sin2_t).sqrt();
    if ci == 0.0 {
        return Refraction { reflectance: 1.0, cos_t: -ct.copysign(cos_i), eta };
    }
    let s = (ci - eta * ct) / (ci + eta * ct);
    let p = (ct - eta * ci) / (ct + eta * ci);
    Refraction { reflectance: 0.5 * (s * s + p * p), cos_t: -ct.copysign(cos_i), eta }
}

/// Exact conductor Fresnel for complex index eta + i·k relative to the outside, per channel.
pub fn conductor(cos_i: f32, eta: Color, k: Color) -> Color {
    eta.zip(k, |eta, k| conductor1(cos_i, eta, k))
}

fn conductor1(cos_i: f32, eta: f32, k: f32) -> f32 {
    // f64: eta² − k² − sin² cancels badly for weakly absorbing metals near grazing.
    let (c, n, k) = (f64::from(cos_i), f64::from(eta), f64::from(k));
    let (c2, s2) = (c * c, 1.0 - c * c);
    let t = n * n - k * k - s2;
    let a2b2 = (t * t + 4.0 * n * n * k * k).max(0.0).sqrt();
    let a = (0.5 * (a2b2 + t)).max(0.0).sqrt();
    let rs = (a2b2 + c2 - 2.0 * a * c) / (a2b2 + c2 + 2.0 * a * c);
    let (x, y) = (c2 * a2b2 + s2 * s2, 2.0 * a * c * s2);
    let rp = rs * (x - y) / (x + y);
    (0.5 * (rs + rp)) as f32
}

/// Hemispherical-diffuse reflectance for relative index `eta`, the fit that Mitsuba 3 uses.
/// Call with 1/eta for light coming from inside.
pub fn diffuse_reflectance(eta: f32) -> f32 {
    if eta < 1.0 {
        -1.4399 * eta * eta + 0.7099 * eta + 0.6681 + 0.0636 / eta
    } else {
        let y = 1.0 / eta;
        0.919317 + y * (-3.4793 + y * (6.75335 + y * (-7.80989 + y * (4.98554 - 1.36881 * y))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::rgb;

    /// Values printed by Mitsuba 3.9.1 for bk7 in air.
    #[test]
    fn dielectric_matches_mitsuba() {
        let eta = 1.5046 / 1.000277;
        let cos = |deg: f32| deg.to_radians().cos();
        assert!((dielectric(cos(30.0), eta).reflectance - 0.042068).abs() < 1e-6);
        assert!((dielectric(cos(60.0), eta).reflectance - 0.089880).abs() < 1e-6);
        assert!((dielectric(-cos(30.0), eta).reflectance - 0.056095).abs() < 1e-6);
        assert_eq!(dielectric(-cos(60.0), eta).reflectance, 1.0);
        assert_eq!(dielectric(0.3, 1.0).reflectance, 0.0);
    }

    /// Gold and aluminium at normal incidence, as Mitsuba 3.9.1 prints them.
    #[test]
    fn conductor_matches_mitsuba_at_normal_incidence() {
        let r = conductor(1.0, rgb([0.14304, 0.37531, 1.44205]), rgb([3.98300, 2.38556, 1.60336]));
        assert!((r - rgb([0.9667, 0.8020, 0.3241])).abs().max_element() < 1e-4);
    }

    #[test]
    fn internal_diffuse_reflectance_matches_mitsuba() {
        assert!((diffuse_reflectance(1.000277 / 1.49) - 0.590479).abs() < 1e-5);
    }
}
