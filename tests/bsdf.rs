//! Laws that every BSDF obeys, and numbers printed by Mitsuba 3.9.1. Materials come through scene files,
//! so the defaults of the format are part of what is checked.

use std::f32::consts::PI;

use caustica::bsdf::{Closure, Event, Transport, fresnel};
use caustica::math::{Rgb, Vec2, Vec3};
use caustica::sampling::CounterRng;
use caustica::scene::Scene;

use crate::support::{camera, scene};

const RHO: &str = "<rgb name='reflectance' value='0.2,0.5,0.8'/>";

fn material(bsdf: &str) -> Scene {
    scene(&format!("{}<shape type='rectangle'>{bsdf}</shape>", camera("0,0,3", "0,0,0", 40.0, 4)))
}

fn closure(scene: &Scene, wi: Vec3) -> Closure {
    scene.materials[scene.shapes[0].material as usize].closure(&scene.textures, Vec2::ZERO, wi)
}

fn plastic(rest: &str) -> String {
    format!("<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.2,0.5,0.8'/>{rest}</bsdf>")
}

/// Every model that is rendered, by name.
fn examples() -> Vec<(&'static str, Scene)> {
    let diffuse = format!("<bsdf type='diffuse'>{RHO}</bsdf>");
    [
        ("diffuse", diffuse.clone()),
        ("plastic", plastic("")),
        ("plastic, nonlinear", plastic("<boolean name='nonlinear' value='true'/>")),
        ("plastic, dim", plastic("<rgb name='specular_reflectance' value='0.2'/>")),
        ("twosided", format!("<bsdf type='twosided'>{diffuse}</bsdf>")),
        ("twosided plastic", format!("<bsdf type='twosided'>{}</bsdf>", plastic(""))),
        ("mask", format!("<bsdf type='mask'><float name='opacity' value='0.3'/>{diffuse}</bsdf>")),
        (
            "masked plastic",
            format!("<bsdf type='mask'><float name='opacity' value='0.6'/>{}</bsdf>", plastic("")),
        ),
        ("dielectric", "<bsdf type='dielectric'/>".to_owned()),
        ("thindielectric", "<bsdf type='thindielectric'/>".to_owned()),
        ("conductor", "<bsdf type='conductor'><string name='material' value='Au'/></bsdf>".to_owned()),
        ("null", "<bsdf type='null'/>".to_owned()),
    ]
    .map(|(name, bsdf)| (name, material(&bsdf)))
    .into()
}

/// Degrees from the normal and around it.
fn direction(theta: f32, phi: f32) -> Vec3 {
    let (t, p) = (theta.to_radians(), phi.to_radians());
    Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos())
}

const VIEWS: [(f32, f32); 5] = [(0.5, 10.0), (30.0, 0.0), (60.0, 200.0), (85.0, 90.0), (140.0, 0.0)];

/// Frequencies of 200 000 sampled directions in 10 × 16 cells of (cosθ, φ) against the integral of the
/// density (midpoint rule, 16² points a cell: exact for cosines). Events that are not smooth share one
/// cell, whose probability is what the density leaves. By Wilson and Hilferty the cube root of χ²/k is
/// normal; 4 sigma in some 30 tests of fixed seed.
#[test]
fn samples_follow_the_density() {
    const ROWS: usize = 10;
    const COLUMNS: usize = 16;
    let n = 200_000;
    for (name, scene) in examples() {
        for (theta, phi) in VIEWS {
            let wi = direction(theta, phi);
            let c = closure(&scene, wi);
            let mut counts = vec![0u32; ROWS * COLUMNS + 1];
            let mut rng = CounterRng::new(17, 0);
            for _ in 0..n {
                let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
                let cell = match c.sample(wi, lobe, u, Transport::Importance) {
                    Some(s) if s.event == Event::Smooth => {
                        let phi = s.wo.y.atan2(s.wo.x) / (2.0 * PI) + 0.5;
                        let row = ((s.wo.z * 0.5 + 0.5) * ROWS as f32) as usize;
                        row.min(ROWS - 1) * COLUMNS + ((phi * COLUMNS as f32) as usize).min(COLUMNS - 1)
                    }
                    _ => ROWS * COLUMNS,
                };
                counts[cell] += 1;
            }
            let mut expected = vec![0.0f64; ROWS * COLUMNS];
            let fine = 16;
            for (cell, e) in expected.iter_mut().enumerate() {
                for i in 0..fine * fine {
                    let at = |i: usize| (i as f32 + 0.5) / fine as f32;
                    let z = ((cell / COLUMNS) as f32 + at(i % fine)) / ROWS as f32 * 2.0 - 1.0;
                    let phi = (((cell % COLUMNS) as f32 + at(i / fine)) / COLUMNS as f32 - 0.5) * 2.0 * PI;
                    let r = (1.0 - z * z).sqrt();
                    *e += f64::from(c.pdf(wi, Vec3::new(r * phi.cos(), r * phi.sin(), z)));
                }
                *e *= 4.0 * std::f64::consts::PI / (ROWS * COLUMNS * fine * fine) as f64;
            }
            expected.push(1.0 - expected.iter().sum::<f64>());
            let (mut square, mut cells) = (0.0, 0);
            for (&count, &probability) in counts.iter().zip(&expected) {
                let e = probability * f64::from(n);
                if e > 5.0 {
                    square += (f64::from(count) - e).powi(2) / e;
                    cells += 1;
                } else {
                    // What should not happen may happen as often as rounding of the rest (1e-5 of all).
                    assert!(
                        f64::from(count) <= e.max(0.0) + 12.0,
                        "{name} at {theta}: {count}, expected {e}"
                    );
                }
            }
            let k = f64::from(cells - 1);
            if k > 0.0 {
                let z = ((square / k).cbrt() - 1.0 + 2.0 / (9.0 * k)) / (2.0 / (9.0 * k)).sqrt();
                assert!(z < 4.0, "{name} at {theta}: χ² {square:.1} of {k} cells, {z:.2} sigma");
            }
        }
    }
}

/// Photons never gain power: the mean weight of samples (with noise of 10⁵ weights below 0.3 % of 1) is
/// at most 1, and it is the albedo that the closure states for its lobes.
#[test]
fn no_surface_returns_more_than_it_received() {
    for (name, scene) in examples() {
        for (theta, phi) in VIEWS {
            let wi = direction(theta, phi);
            let c = closure(&scene, wi);
            let mut rng = CounterRng::new(19, 0);
            let n = 100_000;
            let (mut sum, mut square) = ([0.0f64; 3], [0.0f64; 3]);
            for _ in 0..n {
                let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
                let weight = c.sample(wi, lobe, u, Transport::Importance).map_or(Rgb::ZERO, |s| s.weight);
                for i in 0..3 {
                    let w = f64::from(weight[i]);
                    sum[i] += w;
                    square[i] += w * w;
                }
            }
            let through = c.transparency();
            let deltas: Rgb = c.deltas(wi, Transport::Importance).iter().map(|l| l.weight).sum();
            let stated = c.smooth_albedo(wi) + deltas * (1.0 - through) + Rgb::splat(through);
            for i in 0..3 {
                let mean = sum[i] / f64::from(n);
                let sigma = ((square[i] / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
                assert!(mean <= 1.0 + 1e-5 + 4.5 * sigma, "{name} at {theta}: {mean}");
                // 1e-3: the internal reflectance of plastic is a fit, and it enters the stated albedo.
                let error = (mean - f64::from(stated[i])).abs();
                assert!(error < 4.5 * sigma + 1e-3, "{name} at {theta}: {mean} against {}", stated[i]);
            }
        }
    }
}

/// Helmholtz: f(wi, wo) = f(wo, wi), to f32 rounding; a sample's weight is f·cos/density.
#[test]
fn scattering_is_reciprocal_and_weights_are_consistent() {
    for (name, scene) in examples() {
        let mut rng = CounterRng::new(23, 0);
        for _ in 0..2000 {
            let mut w = || {
                let [u, v] = rng.next_2d();
                direction((1.0 - 2.0 * u).acos().to_degrees(), v * 360.0)
            };
            let (wi, wo) = (w(), w());
            let (a, b) = (closure(&scene, wi), closure(&scene, wo));
            let (f, g) = (a.eval(wi, wo, Transport::Radiance), b.eval(wo, wi, Transport::Radiance));
            assert!((f - g).abs().max_element() <= 1e-5 * f.max_element(), "{name}: {f} and {g}");
            let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
            if let Some(s) = a.sample(wi, lobe, u, Transport::Radiance).filter(|s| s.event == Event::Smooth) {
                let pdf = a.pdf(wi, s.wo);
                let weight = a.eval(wi, s.wo, Transport::Radiance) * s.wo.z.abs() / pdf;
                assert!((pdf / s.pdf - 1.0).abs() < 1e-3, "{name}: densities {pdf} and {}", s.pdf);
                // Grazing directions lose digits in z.
                assert!(
                    (weight - s.weight).abs().max_element() < 2e-3 * s.weight.max_element(),
                    "{name}: {weight} and {}",
                    s.weight
                );
            }
        }
    }
}

struct Golden {
    bsdf: String,
    /// For (30,0)→(40,170) and (75,0)→(75,180): f·cosθo per channel, then the density.
    rows: [[f32; 4]; 2],
}

/// Golden values of Mitsuba 3.9.1, given to five digits: relative 1e-4.
#[test]
fn values_and_densities_match_mitsuba() {
    let diffuse = format!("<bsdf type='diffuse'>{RHO}</bsdf>");
    let goldens = [
        Golden {
            bsdf: diffuse.clone(),
            rows: [[0.048768, 0.12192, 0.19507, 0.24384], [0.016477, 0.041192, 0.065908, 0.082385]],
        },
        Golden {
            bsdf: plastic(""),
            rows: [[0.04923, 0.12307, 0.19692, 0.225], [0.010171, 0.025426, 0.040682, 0.049317]],
        },
        Golden {
            bsdf: plastic("<boolean name='nonlinear' value='true'/>"),
            rows: [[0.02286, 0.071516, 0.15284, 0.225], [0.0047228, 0.014775, 0.031576, 0.049317]],
        },
        Golden {
            bsdf: format!("<bsdf type='mask'><float name='opacity' value='0.3'/>{diffuse}</bsdf>"),
            rows: [[0.01463, 0.036576, 0.058521, 0.073152], [0.0049431, 0.012358, 0.019772, 0.024715]],
        },
    ];
    let near = |got: f32, expected: f32| (got - expected).abs() <= 1e-4 * expected;
    for golden in goldens {
        let scene = material(&golden.bsdf);
        let pairs = [((30.0, 0.0), (40.0, 170.0)), ((75.0, 0.0), (75.0, 180.0))];
        for (row, (i, o)) in golden.rows.iter().zip(pairs) {
            let (wi, wo) = (direction(i.0, i.1), direction(o.0, o.1));
            let c = closure(&scene, wi);
            let f = c.eval(wi, wo, Transport::Radiance) * wo.z;
            assert!((0..3).all(|k| near(f[k], row[k])), "{}: {f} against {row:?}", golden.bsdf);
            let pdf = c.pdf(wi, wo);
            assert!(near(pdf, row[3]), "{}: density {pdf} against {}", golden.bsdf, row[3]);
        }
        // From one side to the other, and from behind: nothing.
        for (i, o) in
            [((45.0, 0.0), (150.0, 180.0)), ((140.0, 0.0), (30.0, 180.0)), ((130.0, 0.0), (160.0, 170.0))]
        {
            let (wi, wo) = (direction(i.0, i.1), direction(o.0, o.1));
            assert_eq!(closure(&scene, wi).eval(wi, wo, Transport::Radiance), Rgb::ZERO);
        }
    }
    let scene = material(&format!("<bsdf type='twosided'>{diffuse}</bsdf>"));
    let (wi, wo) = (direction(130.0, 0.0), direction(160.0, 170.0));
    let f = closure(&scene, wi).eval(wi, wo, Transport::Radiance) * wo.z.abs();
    assert!((0..3).all(|k| near(f[k], [0.059823, 0.149557, 0.239291][k])), "twosided: {f}");
}

/// White furnace of Mitsuba's `plastic`. Its table is a mean of 20 000 samples of weights that lie
/// within 0 and 1.1 and mostly agree: an error of 4e-3 at most.
#[test]
fn albedo_of_plastic_matches_mitsuba() {
    let gray = |rho: &str, rest: &str| {
        format!("<bsdf type='plastic'><rgb name='diffuse_reflectance' value='{rho}'/>{rest}</bsdf>")
    };
    let nonlinear = "<boolean name='nonlinear' value='true'/>";
    for (bsdf, steep, slanted) in [
        (gray("0.5", ""), 0.5195, 0.5437),
        (gray("0.9", ""), 0.9042, 0.9089),
        (gray("0.9", nonlinear), 0.7949, 0.8054),
    ] {
        let scene = material(&bsdf);
        for (theta, expected) in [(0.5, steep), (60.0, slanted)] {
            let wi = direction(theta, 0.0);
            let c = closure(&scene, wi);
            let deltas: Rgb = c.deltas(wi, Transport::Radiance).iter().map(|l| l.weight).sum();
            let albedo = (c.smooth_albedo(wi) + deltas).x;
            println!("{theta}°: {albedo:.4} against {expected}");
            assert!((albedo - expected).abs() < 4e-3, "{bsdf} at {theta}: {albedo} against {expected}");
        }
    }
}

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
    assert!((into[0].weight.x - r).abs() < 1e-5 && (into[1].weight.x - (1.0 - r) / (eta * eta)).abs() < 1e-5);
    assert!((into[1].eta - eta).abs() < 1e-6 && into[0].eta == 1.0);
    let power = lobes(wi, Transport::Importance);
    assert!((power[0].weight.x - r).abs() < 1e-5 && (power[1].weight.x - (1.0 - r)).abs() < 1e-5);
    // Back along the refracted ray: the same reflectance, the inverse factor, the first direction.
    let inside = into[1].wo;
    assert!((inside.x + wi.x / eta).abs() < 1e-6);
    let out = lobes(inside, Transport::Radiance);
    assert!((out[0].weight.x - r).abs() < 1e-5 && (out[1].weight.x - (1.0 - r) * eta * eta).abs() < 1e-4);
    assert!((out[1].wo - wi).length() < 1e-5);
    assert!((into[1].weight.x * out[1].weight.x - (1.0 - r) * (1.0 - r)).abs() < 1e-5);
    // Beyond the critical angle nothing leaves.
    let beyond = direction(180.0 - 60.0, 0.0);
    let total = lobes(beyond, Transport::Radiance);
    assert_eq!((total[0].weight.x, total[1].weight.x), (1.0, 0.0));
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
                (lobes[0].weight.x - both).abs() < 1e-6 && (lobes[1].weight.x - (1.0 - both)).abs() < 1e-6
            );
            assert_eq!(lobes[1].wo, -wi);
            assert_eq!(lobes[0].wo, Vec3::new(-wi.x, -wi.y, wi.z));
        }
    }
}
