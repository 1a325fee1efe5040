//! Progressive photon mapping converges to the path tracer's picture.

use crate::support::{box_camera, lamp, render, scene, sphere, walls};

/// Knaus and Zwicker: the error falls as n^(−½) where noise rules and as n^(−(1 − α)) = n^(−0.3) where
/// bias does; the issue allows −0.25 to −0.6 over the run. The reference's own noise (16 384 samples a pixel) is below
/// a third of the smallest error, which adds 5 % to it.
#[test]
fn error_falls_steadily_with_passes() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let scene =
        scene(&[box_camera(16), walls("0.6"), lamp(0.6, "3"), sphere("0,-0.3,0", 0.5, glass)].concat());
    let truth = render(&scene, &[("integrator", "path")], 16_384);
    let reference = truth.pixel_values();
    let error = |values: &[[f64; 3]]| {
        let square = |(a, b): (&[f64; 3], &[f64; 3])| -> f64 { (0..3).map(|c| (a[c] - b[c]).powi(2)).sum() };
        (values.iter().zip(&reference).map(square).sum::<f64>() / (3 * values.len()) as f64).sqrt()
    };
    let counts = [4u32, 16, 64, 256];
    let errors = counts.map(|n| error(&render(&scene, &[], n).pixel_values()));
    let variance: f64 = (0..reference.len()).map(|i| truth.pixels.variance(i, truth.passes)).sum();
    let noise = (variance / reference.len() as f64).sqrt();
    println!("passes {counts:?}: RMSE {errors:.5?}; noise of the reference {noise:.5}");
    assert!(3.0 * noise < errors[3], "the reference is too noisy: {noise}");
    for pair in errors.windows(2) {
        assert!(pair[1] < pair[0], "{errors:?}");
    }
    // Least squares over equal steps of ln 4 in passes.
    let y = errors.map(f64::ln);
    let slope = (-3.0 * y[0] - y[1] + y[2] + 3.0 * y[3]) / (10.0 * 4f64.ln());
    println!("slope {slope:.3}");
    assert!((-0.6..=-0.25).contains(&slope), "{slope}");
}
