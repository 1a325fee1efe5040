//! One-dimensional convolution of planes, written so that the compiler vectorises it.

use super::kernel::Kernel;

/// `out[x] = Σ k(i) · row[x + margin + i]`. `row` has at least `kernel.radius()` samples before `margin` and
/// as many after the `out.len()` samples from there.
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
    if kernel.odd {
        sweeps(out, kernel, tap, |a, b| a - b);
    } else {
        sweeps(out, kernel, tap, |a, b| a + b);
    }
}

/// Offsets added in one sweep over the outputs; several save memory traffic.
const SWEEP: usize = 3;

#[inline(always)]
fn sweeps<'a>(
    out: &mut [f32],
    kernel: &Kernel,
    tap: impl Fn(usize, bool) -> &'a [f32],
    join: impl Fn(f32, f32) -> f32,
) {
    let n = out.len();
    let (&centre, sides) = kernel.half.split_first().expect("a kernel has a centre");
    for (o, v) in out.iter_mut().zip(tap(0, true)) {
        *o = centre * v;
    }
    for (sweep, weights) in sides.chunks(SWEEP).enumerate() {
        let first = 1 + sweep * SWEEP;
        let of = |i: usize| (&tap(first + i, true)[..n], &tap(first + i, false)[..n]);
        if let &[u, v, w] = weights {
            let ((a, b), (c, d), (e, f)) = (of(0), of(1), of(2));
            for l in 0..n {
                out[l] += u * join(a[l], b[l]) + v * join(c[l], d[l]) + w * join(e[l], f[l]);
            }
        } else {
            for (i, &w) in weights.iter().enumerate() {
                let (a, b) = of(i);
                for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
                    *o += w * join(*a, *b);
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
            let row: Vec<f32> = (0..90).map(|i| (i * i % 7) as f32).collect();
            let mut out = vec![0.0; 80];
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
