//! Progressive photon mapping converges to the path tracer's picture.

use crate::support::{box_camera, lamp, render, scene, sphere, walls};

/// Knaus and Zwicker 2011: the error falls as n^(−½) where noise dominates and as n^(−(1 − α)) = n^(−0.3) where
/// bias does; accepted is an exponent from −0.25 to −0.6 over the run. The first sixteen passes are left out
/// because their error falls faster (measured from 4 to 16 passes: n^(−0.83); from 4 to 256: n^(−0.64)), probably
/// because samples are stratified over passes. The noise of the reference is below half of the smallest error,
/// and its variance is subtracted.
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
    let counts = [16u32, 32, 64, 128, 256];
    let variance: f64 = (0..reference.len()).map(|i| truth.pixels.variance(i, truth.passes)).sum();
    let noise = (variance / reference.len() as f64).sqrt();
    // Subtracts the known variance of the reference from the mean square error.
    let without = |e: f64| (e * e - noise * noise).max(0.0).sqrt();
    let errors = counts.map(|n| {
        // One camera sample per pass, as in a large picture; small ones take more by default.
        without(error(&render(&scene, &[("camera_samples", "1")], n).pixel_values()))
    });
    println!("passes {counts:?}: RMSE {errors:.5?}; noise of the reference {noise:.5}");
    assert!(2.0 * noise < errors[4], "the reference is too noisy: {noise}");
    for pair in errors.windows(2) {
        assert!(pair[1] < pair[0], "{errors:?}");
    }
    // Least squares over equal steps of ln 2 in passes.
    let y = errors.map(f64::ln);
    let slope = (-2.0 * y[0] - y[1] + y[3] + 2.0 * y[4]) / (10.0 * 2f64.ln());
    println!("slope {slope:.3}");
    assert!((-0.6..=-0.25).contains(&slope), "{slope}");
}
