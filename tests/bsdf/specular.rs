//! Perfectly specular models: closed forms.

use caustica::bsdf::{Transport, fresnel};
use caustica::math::Vec3;

use super::{closure, direction, material};

/// Radiance entering glass is squeezed into a cone 1/η² as wide and comes out again unchanged; power is
/// not scaled. bk7 in air, 60°: R as Mitsuba prints it.
#[test]
fn glass_scales_radiance_on_the_way_in_and_back_on_the_way_out() {
    let scene = material("<bsdf type='dielectric'><string name='int_ior' value='bk7'/></bsdf>");
    let eta = 1.5046 / 1.000277;
    let lobes = |wi: Vec3, mode| closure(&scene, wi).deltas(wi, mode).iter().copied().collect::<Vec<_>>();
    let wi = direction(60.0, 0.0);
    let r = 0.089880;
    let into = lobes(wi, Transport::Radiance);
    assert!(
        (into[0].weight.lanes()[0] - r).abs() < 1e-5
            && (into[1].weight.lanes()[0] - (1.0 - r) / (eta * eta)).abs() < 1e-5
    );
    assert!((into[1].eta - eta).abs() < 1e-6 && into[0].eta == 1.0);
    let power = lobes(wi, Transport::Importance);
    assert!(
        (power[0].weight.lanes()[0] - r).abs() < 1e-5
            && (power[1].weight.lanes()[0] - (1.0 - r)).abs() < 1e-5
    );
    // Back along the refracted ray: the same reflectance, the inverse factor, the first direction.
    let inside = into[1].wo;
    assert!((inside.x + wi.x / eta).abs() < 1e-6);
    let out = lobes(inside, Transport::Radiance);
    assert!(
        (out[0].weight.lanes()[0] - r).abs() < 1e-5
            && (out[1].weight.lanes()[0] - (1.0 - r) * eta * eta).abs() < 1e-4
    );
    assert!((out[1].wo - wi).length() < 1e-5);
    assert!((into[1].weight.lanes()[0] * out[1].weight.lanes()[0] - (1.0 - r) * (1.0 - r)).abs() < 1e-5);
    // Beyond the critical angle nothing leaves.
    let beyond = direction(180.0 - 60.0, 0.0);
    let total = lobes(beyond, Transport::Radiance);
    assert_eq!((total[0].weight.lanes()[0], total[1].weight.lanes()[0]), (1.0, 0.0));
}

/// A pane reflects R + TRT + TRRRT + … = 2R/(1 + R) and lets the rest straight through, unscaled.
#[test]
fn a_pane_transmits_straight_on() {
    let scene = material("<bsdf type='thindielectric'><string name='int_ior' value='bk7'/></bsdf>");
    for theta in [0.5, 60.0, 120.0] {
        let wi = direction(theta, 30.0);
        let r = fresnel::dielectric(wi.z.abs(), 1.5046 / 1.000277).reflectance;
        let both = 2.0 * r / (1.0 + r);
        for mode in [Transport::Radiance, Transport::Importance] {
            let lobes: Vec<_> = closure(&scene, wi).deltas(wi, mode).iter().copied().collect();
            assert!(
                (lobes[0].weight.lanes()[0] - both).abs() < 1e-6
                    && (lobes[1].weight.lanes()[0] - (1.0 - both)).abs() < 1e-6
            );
            assert_eq!(lobes[1].wo, -wi);
            assert_eq!(lobes[0].wo, Vec3::new(-wi.x, -wi.y, wi.z));
        }
    }
}

/// Specular light that a normal map tilts, seen from both ends: what a photon takes from `wi` to `wo` is what
/// a viewer along `wo` sees of light along `wi`, times |wo·nt||wi·n|/(|wi·nt||wo·n|) turned round (Veach
/// 1997, eq. 5.19, n the surface's normal and nt the tilted one) and the η² of refraction. To f32 rounding.
#[test]
fn tilted_specular_light_is_the_same_from_both_ends() {
    let n = Vec3::new(0.6, 0.3, 0.7416198).normalize();
    for inside in ["<bsdf type='conductor'/>", "<bsdf type='dielectric'/>"] {
        let color = (n * 0.5 + 0.5).to_array().map(|c| c.to_string()).join(",");
        let map = format!(
            "<bsdf type='normalmap'><texture type='checkerboard' name='normalmap'><rgb name='color0' value='{color}'/>\
             <rgb name='color1' value='{color}'/></texture>{inside}</bsdf>"
        );
        let scene = material(&map);
        let lobes = |wi: Vec3, mode| closure(&scene, wi).deltas(wi, mode).iter().copied().collect::<Vec<_>>();
        let (mut met, mut flipped) = (0, 0);
        for i in 0..400 {
            let wi = direction(f64::from(i % 20) as f32 * 4.3 + 2.0, (i / 20) as f32 * 18.0);
            for photon in lobes(wi, Transport::Importance).iter().filter(|l| l.weight.lanes()[0] > 1e-4) {
                let wo = photon.wo;
                let seen = lobes(wo, Transport::Radiance);
                let back =
                    seen.iter().find(|l| l.wo.dot(wi) > 1.0 - 1e-5).expect("the viewer sees the light");
                let facet = if wo.z * wo.dot(n) > 0.0 { n } else { Vec3::new(-n.x, -n.y, n.z) };
                flipped += i32::from(facet != n);
                let correction = ((wi.dot(facet) * wo.z) / (wi.z * wo.dot(facet))).abs().min(100.0);
                let expected = back.weight.lanes()[0] * back.eta * back.eta * correction;
                let off = (photon.weight.lanes()[0] - expected).abs();
                // Near the critical angle the transmittance is as steep as a root of rounded cosines.
                assert!(
                    off < 2e-3 * expected + 2e-5,
                    "{inside} {wi} to {wo}: {} not {expected}",
                    photon.weight
                );
                met += 1;
            }
        }
        assert!(met > 300 && flipped > 20, "{inside}: {met} {flipped}");
    }
}
