//! One-dimensional convolution of planes, written so that the compiler vectorises it.

use super::kernel::Kernel;

/// `out[x] = Σ k(i) · row[x + margin + i]`; `row` has at least `kernel.radius()` samples on both
/// sides of the `out.len()` wanted ones, the first wanted one at `margin`.
#[inline(always)]
pub fn along_row(out: &mut [f32], row: &[f32], margin: usize, kernel: &Kernel) {
    let n = out.len();
    accumulate(out, kernel, |i, side| {
        let start = if side { margin + i } else { margin - i };
        &row[start..start + n]
    });
}

/// `out[x] = Σ k(i) · plane[(y + i), x]` for a plane of rows `out.len()` long.
#[inline(always)]
pub fn along_column(out: &mut [f32], plane: &[f32], y: usize, kernel: &Kernel) {
    let n = out.len();
    accumulate(out, kernel, |i, side| {
        let row = if side { y + i } else { y - i };
        &plane[row * n..(row + 1) * n]
    });
}

/// Adds the taps; `tap(i, true)` is the input shifted by +i, `tap(i, false)` by −i.
#[inline(always)]
fn accumulate<'a>(out: &mut [f32], kernel: &Kernel, tap: impl Fn(usize, bool) -> &'a [f32]) {
    let centre = kernel.half[0];
    for (o, v) in out.iter_mut().zip(tap(0, true)) {
        *o = centre * v;
    }
    let sign = if kernel.odd { -1.0 } else { 1.0 };
    // Two taps a sweep halve the traffic through `out`.
    for (pair, weights) in kernel.half[1..].chunks(2).enumerate() {
        let i = 1 + 2 * pair;
        let (a, b) = (tap(i, true), tap(i, false));
        match *weights {
            [w, w2] => {
                let (c, d) = (tap(i + 1, true), tap(i + 1, false));
                for ((((o, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                    *o += w * (a + sign * b) + w2 * (c + sign * d);
                }
            }
            _ => {
                let w = weights[0];
                for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
                    *o += w * (a + sign * b);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_sum() {
        for (half, odd) in [(vec![0.5, 0.2, 0.1, 0.05], false), (vec![0.0, 0.4, 0.3], true)] {
            let k = Kernel { half, odd };
            let row: Vec<f32> = (0..20).map(|i| (i * i % 7) as f32).collect();
            let mut out = vec![0.0; 10];
            along_row(&mut out, &row, 5, &k);
            for (x, o) in out.iter().enumerate() {
                let mut expected = 0.0;
                for d in -(k.radius() as i32)..=k.radius() as i32 {
                    let w = k.half[d.unsigned_abs() as usize];
                    let s = if odd && d < 0 { -1.0 } else { 1.0 };
                    expected += s * w * row[(x as i32 + 5 + d) as usize];
                }
                assert!((o - expected).abs() < 1e-5);
            }
            // A plane one column wide is the same row standing up.
            let mut one = vec![0.0; 1];
            along_column(&mut one, &row, 8, &k);
            assert_eq!(one[0], out[3]);
        }
    }
}
